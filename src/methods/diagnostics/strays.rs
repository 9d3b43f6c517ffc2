//! How far points lie from the nearest edge of any surface.

use super::joins::Edge;
use nalgebra::Point3;

/// Distances of points from the edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strays {
    /// The largest.
    pub max: f64,
    /// Which point.
    pub max_index: usize,
    /// The mean.
    pub mean: f64,
}

/// Measures points; `None` without points or without edges.
#[must_use]
pub fn measure(points: &[Point3<f64>], edges: &[Edge<'_>]) -> Option<Strays> {
    if edges.is_empty() || points.is_empty() {
        return None;
    }
    let distance = |p: &Point3<f64>| {
        let nearest = edges.iter().map(|e| e.curve().closest(p).distance);
        nearest.fold(f64::INFINITY, f64::min)
    };
    let all: Vec<f64> = points.iter().map(distance).collect();
    let worst = all.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    Some(Strays {
        max: *worst.1,
        max_index: worst.0,
        mean: all.iter().sum::<f64>() / all.len() as f64,
    })
}
