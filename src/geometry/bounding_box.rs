//! Axis-parallel boxes.

use nalgebra::Point3;

/// The least and the largest coordinates of something that is not empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingBox {
    /// Least coordinates.
    pub min: Point3<f64>,
    /// Largest coordinates.
    pub max: Point3<f64>,
}

impl BoundingBox {
    /// The box of some points; `None` if there are none.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = *points.next()?;
        let start = BoundingBox {
            min: first,
            max: first,
        };
        Some(points.fold(start, |b, p| b.with(p)))
    }

    /// The box of this one and a point.
    #[must_use]
    pub fn with(self, point: &Point3<f64>) -> Self {
        BoundingBox {
            min: self.min.inf(point),
            max: self.max.sup(point),
        }
    }

    /// The box of two boxes.
    #[must_use]
    pub fn union(self, other: &Self) -> Self {
        self.with(&other.min).with(&other.max)
    }

    /// Length of the longest side: the "model size" of everything inside.
    #[must_use]
    pub fn longest_side(&self) -> f64 {
        (self.max - self.min).max()
    }

    /// Length of the diagonal.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).norm()
    }

    /// The middle.
    #[must_use]
    pub fn center(&self) -> Point3<f64> {
        nalgebra::center(&self.min, &self.max)
    }

    /// Whether a point lies inside or within `margin` of it.
    #[must_use]
    pub fn contains(&self, point: &Point3<f64>, margin: f64) -> bool {
        self.distance(point) <= margin
    }

    /// Distance from a point; 0 inside.
    #[must_use]
    pub fn distance(&self, point: &Point3<f64>) -> f64 {
        let nearest = point.coords.sup(&self.min.coords).inf(&self.max.coords);
        (point.coords - nearest).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_of_points() {
        let points = [Point3::new(1., 2., 3.), Point3::new(-1., 5., 3.)];
        let b = BoundingBox::of(&points).expect("two points");
        assert_eq!(b.longest_side(), 3.0);
        assert_eq!(b.center(), Point3::new(0., 3.5, 3.));
        assert_eq!(b.distance(&Point3::new(0., 9., 6.)), 5.0);
        assert!(b.contains(&points[0], 0.0));
        assert!(!b.contains(&Point3::new(0., 1., 3.), 0.5));
        assert_eq!(BoundingBox::of(&[]), None);
    }
}
