//! From a finished chain to what a workshop gets: a sheet a patch, shared
//! rulings, joins, the flat pattern.
//!
//! On patch i a place is (s, λ): s the arc along the patch's base line from its
//! first ruling, λ the length along the ruling. In space it is
//! `frame.carried(strain, s).at(λ)`; in the flat it is the same with k = 0, for
//! unrolling undoes the bending and nothing else (g is the geodesic curvature
//! of the base line).
//!
//! The outline of the strip is projected to these coordinates and cut at the
//! joints. So that it can be cut as one polygon, all patches share the running
//! coordinates
//!
//! σ = s + lengths of the patches before, Λ = λ + slides of the joints before,
//!
//! in which the rulings of a joint are one line σ = const.

mod figures;
mod flat;
mod grid;
mod joins;
mod outline;
mod samples;
mod surface;
#[cfg(test)]
mod tests;

use super::chain::Chain;
use super::outcome::{FlatPiece, Join, Patch, Ruling};
use super::target::Target;
use crate::geometry::SplineError;
use crate::geometry::cone::{Frame, Strain};
use nalgebra::{Point2, Point3};
use outline::Outline;
pub(super) use samples::Sample;

/// Everything about a chain that a yard takes away.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheets {
    /// One a patch.
    pub patches: Vec<Patch>,
    /// One more than patches.
    pub rulings: Vec<Ruling>,
    /// One an inner ruling.
    pub joins: Vec<Join>,
    /// The flat pattern, in as few pieces as do not overlap.
    pub pattern: Vec<FlatPiece>,
    /// Places all over the trimmed patches.
    pub samples: Vec<Sample>,
}

/// What is known of the vertices on a patch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Fit {
    /// How many there are.
    pub vertices: usize,
    /// Their largest distance.
    pub max: f64,
    /// Their mean distance, by area.
    pub mean: f64,
}

/// Makes the sheets of a chain that was fitted to a strip; `fits` has one entry
/// a patch, `thickness` is that of the plate, for its strain.
///
/// # Errors
/// A patch that is no surface: its outline is empty or reaches its apex.
pub(super) fn sheets(
    chain: &Chain,
    target: &Target,
    fits: &[Fit],
    thickness: Option<f64>,
) -> Result<Sheets, SplineError> {
    let outline = Outline::project(chain, target);
    let links = Link::of(chain, outline.range());
    let strip = Strip {
        outline,
        links,
        size: size(target),
        thickness,
    };
    let laid = flat::lay(&strip);
    let mut patches = Vec::with_capacity(strip.links.len());
    for i in 0..strip.links.len() {
        patches.push(figures::patch(
            &strip,
            i,
            &laid.frames[i],
            fits.get(i).copied().unwrap_or_default(),
        )?);
    }
    let rulings = strip.rulings(&laid.frames);
    let joins = joins::measure(&patches, &rulings);
    Ok(Sheets {
        patches,
        rulings,
        joins,
        pattern: laid.pieces,
        samples: samples::of(&strip),
    })
}

/// The longest side of a strip's bounding box.
fn size(target: &Target) -> f64 {
    crate::geometry::BoundingBox::of(&target.points).map_or(0.0, |b| b.longest_side())
}

/// A patch between its first and last ruling.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Link {
    /// On the first ruling, λ = 0 on the base line.
    frame: Frame,
    /// Its strain.
    strain: Strain,
    /// Arc of the base line from the first ruling to the last.
    length: f64,
    /// σ of the first ruling.
    start: f64,
    /// Λ − λ.
    offset: f64,
}

impl Link {
    /// The patches of a chain; the first and the last reach as far as the
    /// strip's outline does.
    fn of(chain: &Chain, [first, last]: [f64; 2]) -> Vec<Link> {
        let frames = chain.frames();
        let mut links: Vec<Link> = Vec::with_capacity(frames.len());
        let mut start = 0.0;
        for (i, frame) in frames.iter().enumerate() {
            let (strain, [low, high]) = (chain.strains[i], chain.reach[i]);
            let frame = frame.carried(strain, low);
            let offset = links.last().map_or(0.0, |before: &Link| {
                let end = before.end();
                before.offset + (frame.point - end.point).dot(&end.ruling)
            });
            links.push(Link {
                frame,
                strain,
                length: high - low,
                start,
                offset,
            });
            start += high - low;
        }
        if let Some(link) = links.last_mut() {
            link.length = last - link.start;
        }
        if let Some(link) = links.first_mut() {
            link.frame = link.frame.carried(link.strain, first);
            link.length -= first;
            link.start = first;
        }
        links
    }

    /// The frame on the last ruling.
    fn end(&self) -> Frame {
        self.frame.carried(self.strain, self.length)
    }

    /// A place in space.
    fn point(&self, place: &Point2<f64>) -> Point3<f64> {
        self.frame.carried(self.strain, place.x).at(place.y)
    }

    /// (s, λ) of running coordinates.
    fn place(&self, running: &Point2<f64>) -> Point2<f64> {
        Point2::new(running.x - self.start, running.y - self.offset)
    }

    /// σ of the last ruling.
    fn finish(&self) -> f64 {
        self.start + self.length
    }
}

/// A chain with the outline of the strip it was fitted to.
struct Strip {
    links: Vec<Link>,
    outline: Outline,
    /// The longest side of the strip.
    size: f64,
    thickness: Option<f64>,
}

impl Strip {
    /// The rulings that bound the patches, with their ends on the outline.
    fn rulings(&self, flat: &[Frame]) -> Vec<Ruling> {
        (0..=self.links.len())
            .map(|id| {
                let patch = id.min(self.links.len() - 1);
                let link = &self.links[patch];
                let s = if id == patch { 0.0 } else { link.length };
                let place = self
                    .outline
                    .sides_at(link.start + s)
                    .map(|running| link.place(&running));
                let [from, to] = place.map(|p| link.point(&p));
                // Where the pattern is cut, the piece that ends there shows it.
                let before = id.saturating_sub(1);
                let (on, s) = (
                    &self.links[before],
                    if id == 0 {
                        0.0
                    } else {
                        self.links[before].length
                    },
                );
                let flat = place.map(|p| {
                    let lambda = p.y + link.offset - on.offset;
                    flat::place(&flat[before], on.strain, &Point2::new(s, lambda))
                });
                Ruling { id, from, to, flat }
            })
            .collect()
    }
}
