//! A hull's plates as every writer draws them: rulings, profile curves and the
//! sentences that go with them, sampled and free of the method's own types.

use nalgebra::{Point2, Point3};

/// A hull to be written as a file. Plate `k` lies between profile `k` and
/// profile `k + 1`; all lengths are in [`HullDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct HullDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it (`ft`, `m`, …).
    pub units: String,
    /// The largest twist that was allowed, degrees.
    pub twist_limit_deg: f64,
    /// The plates in the order of their profiles.
    pub plates: Vec<PlateDrawing>,
    /// The profile curves in order, one more than plates.
    pub profiles: Vec<ProfileLine>,
    /// The verdict for the job, as a word or a short phrase.
    pub verdict: String,
    /// Sentences: one for the job, then one a plate.
    pub summary: Vec<String>,
}

/// One plate: its rulings from end to end.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateDrawing {
    /// `"first profile – second profile"`.
    pub name: String,
    /// Rulings in order along both profiles; a fan repeats one of the ends.
    pub rulings: Vec<RulingLine>,
    /// The rulings in its flat pattern, piece by piece; empty without one.
    pub rolls: Vec<RollRow>,
    /// Whether the plate keeps every limit that was asked.
    pub within_limits: bool,
}

/// One straight line of a plate, from its first to its second profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RulingLine {
    /// Surface parameter, 0 to 1.
    pub u: f64,
    /// End on the first profile.
    pub from: Point3<f64>,
    /// End on the second profile.
    pub to: Point3<f64>,
    /// Angle between the surface normals at the two ends, signed, degrees.
    pub twist_deg: f64,
    /// Bend radius across the ruling at `from`; infinite where flat; the sign
    /// tells the side.
    pub bend_radius_from: f64,
    /// The same at `to`.
    pub bend_radius_to: f64,
}

/// A ruling in the flat pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollRow {
    /// The piece of the pattern, counted from 1.
    pub piece: usize,
    /// Which ruling of the plate, counted from 0.
    pub ruling: usize,
    /// Its ends, measured along the piece's base line and across.
    pub flat: [Point2<f64>; 2],
    /// Angle from the base line, degrees.
    pub angle_deg: f64,
    /// Bend from here to the next ruling, degrees; positive: up.
    pub bend_deg: f64,
    /// Strain that its twist leaves, percent.
    pub strain_percent: f64,
}

/// A profile curve, sampled closely enough to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileLine {
    /// The user's name for it.
    pub name: String,
    /// Points along the curve, in order.
    pub points: Vec<Point3<f64>>,
}

impl RulingLine {
    /// Whether both ends are finite, so that the ruling can be drawn at all.
    pub(crate) fn is_finite(&self) -> bool {
        is_finite(&self.from) && is_finite(&self.to)
    }
}

/// Whether all three coordinates are finite.
pub(crate) fn is_finite(point: &Point3<f64>) -> bool {
    point.iter().all(|c| c.is_finite())
}

/// Least and greatest corner of everything drawable in the hull, or `None`
/// when there is nothing to draw.
pub(crate) fn bounds(hull: &HullDrawing) -> Option<[Point3<f64>; 2]> {
    let ends = hull
        .plates
        .iter()
        .flat_map(|p| &p.rulings)
        .flat_map(|r| [r.from, r.to]);
    let curves = hull.profiles.iter().flat_map(|p| p.points.iter().copied());
    ends.chain(curves)
        .filter(is_finite)
        .fold(None, |corners, point| {
            let [low, high] = corners.unwrap_or([point, point]);
            Some([low.inf(&point), high.sup(&point)])
        })
}

/// The longest side of the bounding box: the "model size" that tolerances are
/// relative to. 0 for an empty drawing.
pub(crate) fn model_size(hull: &HullDrawing) -> f64 {
    bounds(hull).map_or(0.0, |[low, high]| (high - low).max())
}
