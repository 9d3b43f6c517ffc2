//! The figures of one patch: kind, apex, axis, radii, angles, lengths.

use super::super::outcome::{Axis, BendSide, FlatSector, Kind, Patch, Trim};
use super::flat;
use super::grid;
use super::{Fit, Link, Strip, surface};
use crate::geometry::SplineError;
use crate::geometry::cone::Frame;
use nalgebra::{Point2, Point3};

/// A patch is taken for the simpler kind where that moves nothing by more than
/// this share of the strip's size: the rounding of a fit to exact data, and
/// where a far apex would cost more digits than it tells.
const NEGLIGIBLE: f64 = 1e-11;

/// The sheet of a patch whose first ruling lies at `laid` in the flat pattern.
///
/// # Errors
/// No surface is left of it.
pub(super) fn patch(
    strip: &Strip,
    index: usize,
    laid: &Frame,
    fit: Fit,
) -> Result<Patch, SplineError> {
    let link = &strip.links[index];
    let outline: Vec<Point2<f64>> = (strip.outline.between([link.start, link.finish()]).iter())
        .map(|running| link.place(running))
        .collect();
    let lambda = range(&outline);
    let kind = kind(link, lambda, strip.size);
    let radius = |l: f64| link.strain.speed(l) / link.strain.rate();
    let ends = slant_ends(link, kind, lambda);
    let bend = bend_radius(link, kind, lambda);
    Ok(Patch {
        name: (index + 1).to_string(),
        kind,
        apex: (kind == Kind::Cone).then(|| apex(link)),
        axis: axis(strip, link, kind),
        half_angle_deg: (kind == Kind::Cone)
            .then(|| link.strain.g.abs().atan2(link.strain.k.abs()).to_degrees()),
        radius: (kind == Kind::Cylinder).then(|| 1.0 / link.strain.k.abs()),
        slant_range: ends.map(|l| slant(link, kind, l)),
        end_radii: (kind != Kind::Plane).then(|| ends.map(radius)),
        turn_deg: turn(link, kind).to_degrees(),
        min_bend_radius: bend,
        bend_strain_percent: strip.thickness.map(|t| 50.0 * t / bend),
        bend_side: match kind {
            Kind::Plane => None,
            _ if link.strain.k > 0.0 => Some(BendSide::Front),
            _ => Some(BendSide::Back),
        },
        rulings: [index, index + 1],
        trims: [0, 1].map(|side| trim(strip, link, side)),
        flat: sector(link, kind, ends, laid),
        bend_lines: (flat::rulings(strip, link).iter())
            .map(|ends| ends.map(|p| flat::place(laid, link.strain, &p)))
            .collect(),
        surface: surface::exact(&link.frame, link.strain, link.length, lambda)?,
        area: area(link.strain.g, &outline),
        outline_uv: (outline.iter())
            .map(|p| Point2::new(surface::parameter(link.strain, link.length, p.x), p.y))
            .collect(),
        grid: grid::of(link, &outline),
        outline,
        vertices: fit.vertices,
        error_max: fit.max,
        error_mean: fit.mean,
    })
}

/// Least and largest λ; an empty outline gives an empty range, of which no
/// surface can be made.
fn range(outline: &[Point2<f64>]) -> [f64; 2] {
    let lambdas = || outline.iter().map(|p| p.y);
    let low = lambdas().fold(f64::INFINITY, f64::min);
    [low, lambdas().fold(f64::NEG_INFINITY, f64::max)]
}

/// What a patch is, by what it would cost to call it something simpler: over
/// the length L a bend of k lifts the last ruling by k L²/2, and the turn of
/// rulings by g L moves a place at λ by g L λ.
fn kind(link: &Link, lambda: [f64; 2], size: f64) -> Kind {
    let reach = lambda.map(f64::abs).into_iter().fold(link.length, f64::max);
    let limit = NEGLIGIBLE * size;
    let lift = 0.5 * link.strain.k.abs() * link.length * link.length;
    // A plane's rulings may turn as they like.
    if lift <= limit {
        Kind::Plane
    } else if link.strain.g.abs() * link.length * reach <= limit {
        Kind::Cylinder
    } else {
        Kind::Cone
    }
}

fn apex(link: &Link) -> Point3<f64> {
    link.frame.at(-1.0 / link.strain.g)
}

/// λ at the end nearer to a cone's apex and at the farther one.
fn slant_ends(link: &Link, kind: Kind, [low, high]: [f64; 2]) -> [f64; 2] {
    if kind == Kind::Cone && link.strain.g < 0.0 {
        [high, low]
    } else {
        [low, high]
    }
}

fn slant(link: &Link, kind: Kind, lambda: f64) -> f64 {
    match kind {
        Kind::Cone => link.strain.speed(lambda) / link.strain.g.abs(),
        Kind::Cylinder | Kind::Plane => lambda,
    }
}

fn turn(link: &Link, kind: Kind) -> f64 {
    match kind {
        Kind::Plane => 0.0,
        _ => link.strain.rate() * link.length,
    }
}

/// (1 + gλ)/|k|, the least.
fn bend_radius(link: &Link, kind: Kind, lambda: [f64; 2]) -> f64 {
    if kind == Kind::Plane {
        return f64::INFINITY;
    }
    let radii = lambda.map(|l| link.strain.speed(l) / link.strain.k.abs());
    radii[0].min(radii[1])
}

/// The axis through p + (k n − g r)/W² along k r + g n.
fn axis(strip: &Strip, link: &Link, kind: Kind) -> Option<Axis> {
    let (frame, strain) = (&link.frame, link.strain);
    if kind == Kind::Plane {
        return None;
    }
    let square = strain.rate() * strain.rate();
    let foot = frame.point + (strain.k * frame.normal - strain.g * frame.ruling) / square;
    let along = (strain.k * frame.ruling + strain.g * frame.normal) / strain.rate();
    // Into the cone from its apex, where λ goes up with g; a cylinder's along
    // its rulings.
    let forward = match kind {
        Kind::Cone => strain.g * strain.k > 0.0,
        _ => strain.k > 0.0,
    };
    let direction = if forward { along } else { -along };
    let [a, b] = strip.outline.sides_at(link.start).map(|p| link.place(&p).y);
    let middle = frame.at(0.5 * (a + b));
    Some(Axis {
        point: foot + (middle - foot).dot(&direction) * direction,
        direction,
    })
}

fn trim(strip: &Strip, link: &Link, side: usize) -> Trim {
    let running = strip.outline.side(side, [link.start, link.finish()]);
    let parameters: Vec<Point2<f64>> = running.iter().map(|p| link.place(p)).collect();
    Trim {
        points: parameters.iter().map(|p| link.point(p)).collect(),
        parameters,
    }
}

/// The flat shape: of a cone about the unrolled apex, else a rectangle.
fn sector(link: &Link, kind: Kind, ends: [f64; 2], laid: &Frame) -> FlatSector {
    let strain = link.strain;
    if kind != Kind::Cone {
        return FlatSector::Rectangle {
            length: link.length,
            height: (ends[1] - ends[0]).abs(),
        };
    }
    let center = flat::place(laid, strain, &Point2::new(0.0, -1.0 / strain.g));
    let first = flat::place(laid, strain, &Point2::new(0.0, ends[1])) - center;
    FlatSector::Ring {
        center,
        radii: ends.map(|l| slant(link, kind, l)),
        start_deg: first.y.atan2(first.x).to_degrees(),
        // r′ = g t = g n × r, and n looks up.
        angle_deg: (strain.g * link.length).to_degrees(),
    }
}

/// ∬ (1 + gλ) ds dλ inside a polygon, by Green's theorem edge by edge.
fn area(g: f64, polygon: &[Point2<f64>]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let sum: f64 = (polygon.iter().zip(next))
        .map(|(a, b)| {
            let mean = 0.5 * (a.y + b.y);
            let square = (a.y * a.y + a.y * b.y + b.y * b.y) / 3.0;
            (b.x - a.x) * (mean + 0.5 * g * square)
        })
        .sum();
    sum.abs()
}
