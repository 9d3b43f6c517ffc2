//! Why a net had to leave its start, and why it has umbilics.

use super::bend::Bend;
use super::diagnose::{At, ShapeFigures, UmbilicFigures};
use super::surface::Surface;
use nalgebra::Point3;
use std::fmt;

/// A vertex of the coarse net that went further than is usual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moved {
    /// Its index in the request.
    pub vertex: usize,
    /// Its row and column in the coarse net.
    pub place: [usize; 2],
    /// Where it is now.
    pub point: Point3<f64>,
    /// Its way, in mean edges of the result.
    pub moved: f64,
    /// The turn of its normal, degrees.
    pub turned_deg: f64,
    /// What about the start asked for it.
    pub why: Why,
}

/// What keeps lines of a start from being lines of curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Why {
    /// They do not cross at right angles, but at this angle, degrees.
    Skew(f64),
    /// They run at this angle to the lines of curvature, degrees.
    OffPrincipal(f64),
    /// Its points were smoothed, here by so much, in mean edges.
    Smoothed(f64),
    /// The line that was bent more there is bent less now.
    OtherLeads,
    /// The curvatures hardly differ: by this share of their mean difference.
    NearlyRound(f64),
    /// Nothing here: it follows its neighbours.
    Neighbours,
}

/// As part of a sentence that names the vertex.
impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Why::Skew(angle) => write!(f, "the lines of the start cross at {angle:.0}° there"),
            Why::OffPrincipal(angle) => write!(
                f,
                "the lines of the start run at {angle:.0}° to its lines of curvature there"
            ),
            Why::Smoothed(way) => {
                write!(
                    f,
                    "the points of the start were smoothed by {way:.2} edges there"
                )
            }
            Why::OtherLeads => f.write_str(
                "the curvatures of the start pass each other near there, and one has to lead \
                 all over for a net without umbilics",
            ),
            Why::NearlyRound(_) => f.write_str("the start is bent alike in all directions there"),
            Why::Neighbours => f.write_str("it follows its neighbours"),
        }
    }
}

/// Places of the start between which its curvatures pass each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Where the line along u is bent more, by most: κ_u − κ_v.
    pub u: At,
    /// Where the line along v is: κ_v − κ_u.
    pub v: At,
}

/// Mean way of the vertices, in mean edges of the result, that is usual.
pub const USUAL_MOVE: f64 = 0.5;
/// Mean turn of the normals that is usual, degrees.
pub const USUAL_TURN_DEG: f64 = 3.0;
/// So many vertices are named.
const NAMED: usize = 8;
/// Lines that miss the right angle or the lines of curvature by less, degrees,
/// are not the reason.
const TELLING_DEG: f64 = 3.0;
/// Curvatures that differ by less than this share of the mean have no clear
/// directions.
const NEARLY_ROUND: f64 = 0.1;
/// What explains this share of a way is its reason.
const MOST_OF: f64 = 0.5;
/// A lead below this share of the mean difference is an accident.
const ACCIDENT: f64 = 0.1;

/// A net, where it comes from, and what it was held to: all split alike.
pub(super) struct Nets<'a> {
    pub(super) surface: &'a Surface,
    pub(super) start: &'a Surface,
    pub(super) held: &'a Surface,
}

/// The vertices that went furthest, the furthest first; none where the net as
/// a whole keeps the shape.
pub(super) fn moved(nets: &Nets, shape: &ShapeFigures, given: &[usize]) -> Vec<Moved> {
    if shape.mean_move <= USUAL_MOVE && shape.mean_turn_deg <= USUAL_TURN_DEG {
        return Vec::new();
    }
    let Nets { surface, start, .. } = *nets;
    let mean_difference = UmbilicFigures::of(start).mean_difference;
    let mean_edge = surface.net().mean_edge();
    let coarse = coarse_vertices(surface, given.len());
    let mut found: Vec<Moved> = coarse
        .iter()
        .zip(given)
        .map(|(at, vertex)| Moved {
            vertex: *vertex,
            place: at.place,
            point: Point3::from(surface.vertices()[at.vertex].point),
            moved: shape.moves[at.vertex],
            turned_deg: shape.turns_deg[at.vertex],
            why: smoothed(nets, at.vertex, shape.moves[at.vertex], mean_edge)
                .unwrap_or_else(|| why(nets, at.vertex, mean_difference)),
        })
        .collect();
    let size = |m: &Moved| (m.moved / USUAL_MOVE).max(m.turned_deg / USUAL_TURN_DEG);
    found.sort_by(|a, b| size(b).total_cmp(&size(a)).then(a.vertex.cmp(&b.vertex)));
    found.retain(|m| size(m) > 1.0);
    found.truncate(NAMED);
    found
}

/// A vertex of the coarse net in the fine one.
struct Coarse {
    vertex: usize,
    place: [usize; 2],
}

fn coarse_vertices(surface: &Surface, count: usize) -> Vec<Coarse> {
    let layout = surface.layout();
    let counts = |step: usize| {
        let [n, m] = layout.patch_counts().map(|n| n / step);
        [
            n + usize::from(!layout.closed[0]),
            m + usize::from(!layout.closed[1]),
        ]
    };
    let steps = (0..usize::BITS).map(|level| 1_usize << level);
    let mut steps = steps.take_while(|s| *s <= layout.vertex_count());
    let fitting = steps.find(|step| counts(*step).iter().product::<usize>() == count);
    let step = fitting.unwrap_or(1);
    let [rows, columns] = counts(step);
    let place = |k: usize| [k / columns, k % columns];
    (0..rows * columns)
        .map(|k| Coarse {
            vertex: layout.vertex(place(k)[0] * step, place(k)[1] * step),
            place: place(k),
        })
        .collect()
}

/// Whether a vertex went its way, in mean edges, because it was smoothed.
fn smoothed(nets: &Nets, vertex: usize, moved: f64, mean_edge: f64) -> Option<Why> {
    let [held, start] = [nets.held, nets.start].map(|net| net.vertices()[vertex].point);
    let way = (held - start).norm() / mean_edge;
    (way > 0.0 && way >= MOST_OF * moved).then_some(Why::Smoothed(way))
}

/// The curvatures of a net at a vertex, as seen from one of its patches.
fn bend_at(net: &Surface, vertex: usize) -> Option<Bend> {
    let layout = net.layout();
    let counts = layout.patch_counts();
    let at = [vertex / layout.columns, vertex % layout.columns];
    let patch = [0, 1].map(|d| at[d].min(counts[d] - 1));
    let share = [0, 1].map(|d| (at[d] - patch[d]) as f64);
    Bend::of(&net.jet(patch, share))
}

/// What is wrong with the lines of the start at a vertex.
fn why(nets: &Nets, vertex: usize, mean_difference: f64) -> Why {
    let Nets { surface, start, .. } = *nets;
    let k = &start.vertices()[vertex];
    let angle = k.du.cross(&k.dv).norm().atan2(k.du.dot(&k.dv)).to_degrees();
    let Some(bend) = bend_at(start, vertex) else {
        return Why::Skew(angle);
    };
    let lead = |bend: &Bend| bend.along - bend.across;
    let now = bend_at(surface, vertex);
    let turned_over = lead(&bend).abs() > 2.0 * bend.twist.abs()
        && now.is_some_and(|now| lead(&now) * lead(&bend) < 0.0);
    let difference = bend.difference() / mean_difference.max(f64::MIN_POSITIVE);
    let off = bend.off_principal().to_degrees();
    if (angle - 90.0).abs() > TELLING_DEG {
        Why::Skew(angle)
    } else if turned_over {
        Why::OtherLeads
    } else if difference < NEARLY_ROUND {
        Why::NearlyRound(difference)
    } else if off > TELLING_DEG {
        Why::OffPrincipal(off)
    } else {
        Why::Neighbours
    }
}

/// The places that make umbilics between them unavoidable, if there are any.
pub(super) fn crossing(start: &Surface) -> Option<Crossing> {
    let layout = start.layout();
    let middles = layout.patches().filter_map(|(i, j)| {
        let jet = start.jet([i, j], [0.5, 0.5]);
        let bend = Bend::of(&jet)?;
        let lead = bend.along - bend.across;
        // Lines that run between the lines of curvature follow neither.
        (lead.abs() > 2.0 * bend.twist.abs()).then_some(At {
            value: lead,
            point: jet.point,
            place: [i as f64 + 0.5, j as f64 + 0.5],
        })
    });
    let middles: Vec<At> = middles.collect();
    let by_value = |a: &&At, b: &&At| a.value.total_cmp(&b.value);
    let (u, v) = (
        middles.iter().max_by(by_value)?,
        middles.iter().min_by(by_value)?,
    );
    let v = At {
        value: -v.value,
        ..*v
    };
    let least = ACCIDENT * UmbilicFigures::of(start).mean_difference;
    (u.value > least && v.value > least).then_some(Crossing { u: *u, v })
}
