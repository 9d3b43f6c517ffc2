//! Isophotes as bands of equal angle to the light, every second one dark: a
//! fair surface has smooth bands, and a dent breaks them.

use super::super::canvas::{Canvas, Spot};
use super::super::colour;
use super::super::key::Sample;
use super::super::layout::round_step;
use super::super::panel::Panel;
use super::chart::Chart;
use crate::formats::fair_surface::{FairSurfaceDrawing, Isophotes};

/// Bands that the range of angles is divided into, about.
const BANDS: f64 = 24.0;
/// The colour between dark bands.
const LIGHT: &str = "#eef2f6";
/// Rounds of carrying angles over the outline: so that the bands reach it.
const BEYOND: usize = 2;

/// A corner of a cell: place on the page and angle.
type Corner = (Spot, f64);

/// Draws the bands; returns what they mean.
pub(super) fn draw(
    canvas: &mut Canvas,
    drawing: &FairSurfaceDrawing,
    chart: &Chart<'_>,
    panel: &Panel,
) -> Option<(Sample, String)> {
    let isophotes = drawing.isophotes.as_ref()?;
    let nodes = nodes(isophotes, chart, panel);
    let angles = nodes.iter().flatten().flatten().map(|(_, angle)| *angle);
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = angles.fold(none, |r, a| [r[0].min(a), r[1].max(a)]);
    if low > high {
        return None;
    }
    let step = round_step((high - low) / BANDS);
    let first = (low / step).floor();
    let count = ((high / step).floor() - first) as usize + 1;
    let mut rings: Vec<Vec<Vec<Spot>>> = vec![Vec::new(); count];
    for (row, next) in nodes.iter().zip(nodes.iter().skip(1)) {
        for j in 1..row.len().min(next.len()) {
            let (Some(a), Some(b), Some(c), Some(d)) = (row[j - 1], next[j - 1], next[j], row[j])
            else {
                continue;
            };
            for triangle in [[a, b, c], [a, c, d]] {
                divide(&triangle, step, first, &mut rings);
            }
        }
    }
    canvas.areas(&[frame(panel)], LIGHT);
    for (k, band) in rings.iter().enumerate() {
        // Bands are counted from 0°, so that a colour means the same angle
        // whatever the range.
        if (first as i64 + k as i64).rem_euclid(2) == 1 {
            let shade = colour::of_share((k as f64 + 0.5) / count as f64);
            canvas.areas(band, &shade);
        }
    }
    let meaning = format!(
        "normal to light in bands of {}°, {low:.0}° to {high:.0}° (dark)",
        trim_zeros(step)
    );
    Some((Sample::Field(BAR), meaning))
}

/// The colour of the sample in the key.
const BAR: &str = "#3f9ba6";

fn frame(panel: &Panel) -> Vec<Spot> {
    let [left, top] = panel.corner;
    let [right, bottom] = [panel.right(), panel.bottom()];
    vec![[left, top], [right, top], [right, bottom], [left, bottom]]
}

/// The grid on the page, carried a little over the outline.
fn nodes(isophotes: &Isophotes, chart: &Chart<'_>, panel: &Panel) -> Vec<Vec<Option<Corner>>> {
    let given = |i: usize, j: usize| {
        let value = isophotes.values.get(i).and_then(|row| row.get(j));
        value.copied().flatten().filter(|a| a.is_finite())
    };
    let [n, m] = [isophotes.u.len(), isophotes.v.len()];
    let mut angles: Vec<Vec<Option<f64>>> = (0..n)
        .map(|i| (0..m).map(|j| given(i, j)).collect())
        .collect();
    for _ in 0..BEYOND {
        angles = carried(&angles);
    }
    let corner = |i: usize, j: usize| {
        let spot = panel.map(chart.place([isophotes.u[i], isophotes.v[j]]));
        let is_drawable = spot.iter().all(|c| c.is_finite());
        angles[i][j].filter(|_| is_drawable).map(|a| (spot, a))
    };
    (0..n)
        .map(|i| (0..m).map(|j| corner(i, j)).collect())
        .collect()
}

/// Fills every empty place that has two known ones in a row beside it with
/// their straight continuation; several are averaged.
fn carried(angles: &[Vec<Option<f64>>]) -> Vec<Vec<Option<f64>>> {
    let at = |i: i64, j: i64| {
        let row = angles.get(usize::try_from(i).ok()?)?;
        row.get(usize::try_from(j).ok()?).copied().flatten()
    };
    const DIRECTIONS: [[i64; 2]; 8] = [
        [1, 0],
        [-1, 0],
        [0, 1],
        [0, -1],
        [1, 1],
        [1, -1],
        [-1, 1],
        [-1, -1],
    ];
    let filled = |i: usize, j: usize| {
        let [i, j] = [i as i64, j as i64];
        let straight = DIRECTIONS.iter().filter_map(|[di, dj]| {
            let near = at(i + di, j + dj)?;
            let far = at(i + 2 * di, j + 2 * dj).unwrap_or(near);
            Some(2.0 * near - far)
        });
        let (sum, count) = straight.fold((0.0, 0.0), |(s, n), a| (s + a, n + 1.0));
        (count > 0.0).then(|| sum / count)
    };
    let row = |(i, row): (usize, &Vec<Option<f64>>)| {
        let value = |(j, a): (usize, &Option<f64>)| a.or_else(|| filled(i, j));
        row.iter().enumerate().map(value).collect()
    };
    angles.iter().enumerate().map(row).collect()
}

/// Cuts a triangle with angles at its corners into its bands.
fn divide(triangle: &[Corner; 3], step: f64, first: f64, rings: &mut [Vec<Vec<Spot>>]) {
    let levels = triangle.map(|(_, a)| (a / step).floor() - first);
    let low = levels
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min)
        .max(0.0) as usize;
    let high = levels.iter().copied().fold(0.0, f64::max) as usize;
    for k in low..=high.min(rings.len() - 1) {
        let bounds = [(first + k as f64) * step, (first + k as f64 + 1.0) * step];
        let above = kept(triangle, |a| a - bounds[0]);
        let within = kept(&above, |a| bounds[1] - a);
        if within.len() > 2 {
            rings[k].push(within.into_iter().map(|(spot, _)| spot).collect());
        }
    }
}

/// The part of a convex polygon where a linear function of the angle is not
/// negative (Sutherland & Hodgman 1974).
fn kept(polygon: &[Corner], side: impl Fn(f64) -> f64) -> Vec<Corner> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let next = polygon.iter().cycle().skip(1);
    for (a, b) in polygon.iter().zip(next) {
        let [sa, sb] = [side(a.1), side(b.1)];
        if sa >= 0.0 {
            kept.push(*a);
        }
        if (sa >= 0.0) != (sb >= 0.0) {
            let t = sa / (sa - sb);
            let spot = [0, 1].map(|i| a.0[i] + (b.0[i] - a.0[i]) * t);
            kept.push((spot, a.1 + (b.1 - a.1) * t));
        }
    }
    kept
}

/// A step without the dust of its computation.
fn trim_zeros(step: f64) -> String {
    let text = format!("{step:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
