//! Distances both ways between a strip and the patches that stand for it, all
//! vertices and all patches, whatever the fit looked at.
//!
//! From a vertex: to the foot on the patch where distance and the way by which
//! the foot lies outside the patch's rulings are least together; an end that
//! went on without limit would catch vertices of other turns. From a patch: from places all over its
//! trimmed part to the nearest point of the triangles.

use super::chain::{Chain, Placed};
use super::outcome::Distance;
use super::sheet::{Fit, Sample};
use super::target::Target;
use crate::geometry::cone::Foot;
use crate::geometry::mesh::MeshIndex;
use nalgebra::Point3;
use rayon::prelude::*;

/// Where a vertex lies on a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Home {
    /// Its patch.
    pub patch: usize,
    /// Its signed distance.
    pub distance: f64,
}

/// The home of every vertex, in parallel and in order.
pub(super) fn homes(chain: &Chain, points: &[Point3<f64>]) -> Vec<Home> {
    let placed = Placed::new(chain);
    points.par_iter().map(|p| home(&placed, p)).collect()
}

fn home(placed: &Placed, point: &Point3<f64>) -> Home {
    let mut best = (
        f64::INFINITY,
        Home {
            patch: 0,
            distance: 0.0,
        },
    );
    for patch in 0..placed.frames.len() {
        let foot = placed.foot_on(point, patch);
        let apart = foot.distance.hypot(outside(placed, patch, &foot));
        if apart < best.0 {
            let distance = foot.distance;
            best = (apart, Home { patch, distance });
        }
    }
    best.1
}

/// How far beyond a patch's rulings a foot lies, along its own arc.
fn outside(placed: &Placed, patch: usize, foot: &Foot) -> f64 {
    let [low, high] = placed.reach[patch];
    let speed = placed.strains[patch].speed(foot.lambda);
    // Beyond the apex there is no patch.
    if speed <= 0.0 {
        return f64::INFINITY;
    }
    (low - foot.arc).max(foot.arc - high).max(0.0) * speed
}

/// What every patch's vertices come to.
pub(super) fn fits(homes: &[Home], weights: &[f64], patches: usize) -> Vec<Fit> {
    let mut fits = vec![Fit::default(); patches];
    let mut areas = vec![0.0; patches];
    for (home, weight) in homes.iter().zip(weights) {
        let fit = &mut fits[home.patch];
        fit.vertices += 1;
        fit.max = fit.max.max(home.distance.abs());
        fit.mean += weight * home.distance.abs();
        areas[home.patch] += weight;
    }
    for (fit, area) in fits.iter_mut().zip(areas) {
        if area > 0.0 {
            fit.mean /= area;
        }
    }
    fits
}

/// From the vertices to the patches.
pub(super) fn to_surface(target: &Target, homes: &[Home]) -> Distance {
    let of = |i: usize| (target.points[i], homes[i].distance.abs(), target.weights[i]);
    let (figures, at) = figures((0..homes.len()).map(of));
    Distance {
        vertex: at,
        ..figures
    }
}

/// From the patches to the triangles; `None` for a strip without triangles.
pub(super) fn to_mesh(mesh: &MeshIndex, samples: &[Sample]) -> Distance {
    let apart: Vec<f64> = (samples.par_iter())
        .map(|s| mesh.nearest(&s.point).distance)
        .collect();
    let of = |(sample, d): (&Sample, f64)| (sample.point, d, sample.area);
    figures(samples.iter().zip(apart).map(of)).0
}

/// The vertices' distances at places on the patches: within the nearest triangle
/// from its corners. (The triangles themselves leave the patches by more where
/// they are large: that is theirs, not the fit's.)
pub(super) fn carried(mesh: &MeshIndex, homes: &[Home], places: &[Point3<f64>]) -> Vec<f64> {
    let at = |place: &Point3<f64>| {
        let nearest = mesh.nearest(place);
        let corners = nearest.corners.iter().zip(nearest.shares);
        corners.map(|(c, share)| share * homes[*c].distance).sum()
    };
    places.par_iter().map(at).collect()
}

/// Figures of distances at places that stand for areas, and which is largest.
fn figures(all: impl Iterator<Item = (Point3<f64>, f64, f64)>) -> (Distance, Option<usize>) {
    let mut figures = Distance {
        max: 0.0,
        at: Point3::origin(),
        vertex: None,
        mean: 0.0,
        rms: 0.0,
    };
    let (mut largest, mut area) = (None, 0.0);
    for (i, (place, distance, weight)) in all.enumerate() {
        if largest.is_none() || distance > figures.max {
            (figures.max, figures.at, largest) = (distance, place, Some(i));
        }
        figures.mean += weight * distance;
        figures.rms += weight * distance * distance;
        area += weight;
    }
    if area > 0.0 {
        figures.mean /= area;
        figures.rms = (figures.rms / area).sqrt();
    }
    (figures, largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::cone::{Frame, Strain};
    use nalgebra::Vector3;

    fn chain() -> Chain {
        let strains = [(0.4, 1.3), (0.0, 0.9), (-0.7, -1.8)];
        Chain {
            root: Frame {
                point: Point3::origin(),
                ruling: Vector3::y(),
                normal: -Vector3::z(),
            },
            middle: 0,
            strains: strains.map(|(g, k)| Strain { g, k }).to_vec(),
            reach: vec![[0.0, 0.5], [0.0, 0.4], [0.0, 0.6]],
            slides: vec![0.0; 2],
        }
    }

    #[test]
    fn vertices_find_the_patch_and_distance_that_they_were_built_from() {
        let chain = chain();
        let mut points = Vec::new();
        let mut built = Vec::new();
        for (patch, frame) in chain.frames().iter().enumerate() {
            for (share, lambda, distance) in [(0.1, 0.2, 0.02), (0.5, -0.3, -0.01), (0.9, 0.0, 0.0)]
            {
                let s = share * chain.reach[patch][1];
                let there = frame.carried(chain.strains[patch], s);
                points.push(there.at(lambda) + distance * there.normal);
                built.push((patch, distance));
            }
        }
        let homes = homes(&chain, &points);
        for (home, (patch, distance)) in homes.iter().zip(&built) {
            assert_eq!(home.patch, *patch);
            assert!((home.distance - distance).abs() < 1e-14);
        }
        let fits = fits(&homes, &vec![2.0; points.len()], 3);
        for fit in fits {
            assert_eq!(fit.vertices, 3);
            assert!((fit.max - 0.02).abs() < 1e-14 && (fit.mean - 0.01).abs() < 1e-14);
        }
    }

    #[test]
    fn the_ends_go_on_past_the_first_and_last_ruling() {
        let chain = chain();
        let frames = chain.frames();
        let before = frames[0].carried(chain.strains[0], -0.2).at(0.1);
        let after = frames[2].carried(chain.strains[2], 0.8).at(0.1);
        let homes = homes(&chain, &[before, after]);
        assert_eq!((homes[0].patch, homes[1].patch), (0, 2));
        assert!(homes.iter().all(|h| h.distance.abs() < 1e-14));
    }

    #[test]
    fn figures_are_weighted_by_area_and_name_the_largest() {
        let places = [(1.0, 1.0, 1.0), (2.0, 3.0, 2.0), (3.0, 3.0, 1.0)];
        let all = places.map(|(x, d, w)| (Point3::new(x, 0.0, 0.0), d, w));
        let (figures, at) = figures(all.into_iter());
        assert_eq!((figures.max, at, figures.at.x), (3.0, Some(1), 2.0));
        assert!((figures.mean - 2.5).abs() < 1e-15);
        assert!((figures.rms - 7.0_f64.sqrt()).abs() < 1e-15);
    }
}
