//! One vertex for all corners in the same place.

use nalgebra::Point3;
use std::collections::HashMap;

/// Numbers places in the order in which they first come.
#[derive(Debug, Default)]
pub(super) struct Weld {
    numbers: HashMap<[u64; 3], usize>,
}

impl Weld {
    /// The vertex at a place, which is added where it is new. Only the very
    /// same numbers are one place: files repeat a vertex to the last digit,
    /// and nothing else tells a small step from none. −0 is 0.
    pub fn vertex(&mut self, p: Point3<f64>, vertices: &mut Vec<Point3<f64>>) -> usize {
        let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
        *self.numbers.entry(key).or_insert_with(|| {
            vertices.push(p);
            vertices.len() - 1
        })
    }
}
