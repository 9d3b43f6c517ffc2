//! Looking at a model's point: its figures at the samples, between them, and
//! what the next run should mind more.

use super::Model;

/// Where between two samples peaks are looked for.
const PEAK_SHARES: [f64; 3] = [0.25, 0.5, 0.75];
/// Steps in which a finished plate is looked at.
const DENSE: usize = 4096;
/// Rounding in φ where an end of the rulings stands still.
const FORWARD: f64 = 1e-6;
/// A peak of the speeds is above its bound by this share.
const PEAK_SHARE: f64 = 5e-4;

/// Most that the bound on |φ − ½| ≤ ½ is tightened.
const LARGEST_TIGHTENING: f64 = 0.1;

impl Model<'_> {
    /// Twist and φ − ½ at places w of a plate.
    pub(in super::super) fn figures_at(
        &self,
        x: &[f64],
        plate: usize,
        places: &[f64],
    ) -> Vec<[f64; 2]> {
        let (y, d) = (self.path_of(x, plate), self.displacements(x));
        let model = &self.plates[plate];
        let figures = |w: &f64| {
            self.ruling(plate, model.shape.at(&y, *w), &d)
                .figures(model.speeds)
                .map_or([0.0; 2], |[turn, share]| [turn.value, share.value])
        };
        places.iter().map(figures).collect()
    }

    /// Largest |θ| at the samples of a plate.
    pub(in super::super) fn twist_max(&self, x: &[f64], plate: usize) -> f64 {
        let figures = self.figures_at(x, plate, self.plates[plate].shape.stations());
        figures.iter().map(|f| f[0].abs()).fold(0.0, f64::max)
    }

    /// Largest |θ| of a plate, looked for densely; infinite where the rulings
    /// turn back.
    pub(in super::super) fn twist_max_everywhere(&self, x: &[f64], plate: usize) -> f64 {
        let dense: Vec<f64> = (0..=DENSE).map(|i| i as f64 / DENSE as f64).collect();
        let places = [dense, self.between(plate)].concat();
        let figures = self.figures_at(x, plate, &places);
        if figures.iter().any(|f| f[1].abs() > 0.5 + FORWARD) {
            return f64::INFINITY;
        }
        let between = figures.iter().map(|f| f[0].abs()).fold(0.0, f64::max);
        between.max(self.twist_max(x, plate))
    }

    /// Tightens a plate's bound on the speeds by what is missing at `x`, so
    /// that the next run meets the bound itself although it is a penalty (a
    /// method of multipliers with one multiplier for the plate).
    pub(in super::super) fn tighten(&mut self, x: &[f64], plate: usize) {
        let missing = self.largest_share(x, plate) - self.weights.share;
        let tightening = self.plates[plate].tightening + missing;
        self.plates[plate].tightening = tightening.clamp(0.0, LARGEST_TIGHTENING);
    }

    /// Whether the bound on the speeds is met at the samples of a plate.
    pub(in super::super) fn is_clear(&self, x: &[f64], plate: usize) -> bool {
        self.largest_share(x, plate) <= self.weights.share + PEAK_SHARE
    }

    fn largest_share(&self, x: &[f64], plate: usize) -> f64 {
        let figures = self.figures_at(x, plate, self.plates[plate].shape.stations());
        figures.iter().map(|f| f[1].abs()).fold(0.0, f64::max)
    }

    fn between(&self, plate: usize) -> Vec<f64> {
        let inside = |pair: &[f64]| PEAK_SHARES.map(|share| pair[0] + share * (pair[1] - pair[0]));
        let stations = self.plates[plate].shape.stations();
        stations.windows(2).flat_map(inside).collect()
    }

    /// Places between samples where a plate's twist is above `known` or its
    /// speeds out of bounds (an exchange step, as in Remez' algorithm).
    pub(in super::super) fn peaks_between(&self, x: &[f64], plate: usize, known: f64) -> Vec<f64> {
        let places = self.between(plate);
        let figures = self.figures_at(x, plate, &places);
        let is_peak =
            |f: &[f64; 2]| f[0].abs() > known || f[1].abs() > self.weights.share + PEAK_SHARE;
        places
            .into_iter()
            .zip(&figures)
            .filter(|(_, f)| is_peak(f))
            .map(|(w, _)| w)
            .collect()
    }
}
