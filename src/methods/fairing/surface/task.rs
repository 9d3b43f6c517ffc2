//! A request in working form: present points only, in a frame in which the
//! longest side of their box is 1 and its middle the origin.

use super::request::EnergyWeights;
use nalgebra::{Matrix3, Point3, Vector3};

/// user = middle + size · axes · unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Frame {
    pub(in super::super) middle: Point3<f64>,
    pub(in super::super) size: f64,
    /// Columns: the frame's unit vectors.
    pub(in super::super) axes: Matrix3<f64>,
}

impl Frame {
    pub(in super::super) fn to_unit(self, p: &Point3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(&(p - self.middle)) / self.size
    }

    pub(in super::super) fn to_user(self, p: &Vector3<f64>) -> Point3<f64> {
        self.middle + self.axes * p * self.size
    }

    /// The same place and size with its axes turned: third axis `up`, the
    /// first as near as may be to `along`.
    pub(in super::super) fn turned(self, up: &Vector3<f64>, along: &Vector3<f64>) -> Self {
        let flat = along - up * up.dot(along);
        let first = flat
            .try_normalize(1e-9)
            .unwrap_or_else(|| up.cross(&Vector3::x()).normalize());
        Frame {
            axes: Matrix3::from_columns(&[first, up.cross(&first), *up]),
            ..self
        }
    }
}

/// How the points were given.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) enum Layout {
    /// Row and column of each present point, and the size of the table.
    Grid {
        cell: Vec<[usize; 2]>,
        size: [usize; 2],
    },
    Scattered,
}

/// A request that can be fitted. Lists run over the present points.
#[derive(Debug, Clone)]
pub(in super::super) struct Task {
    pub(in super::super) frame: Frame,
    pub(in super::super) layout: Layout,
    /// Index in the request.
    pub(in super::super) index: Vec<usize>,
    /// Places in the frame.
    pub(in super::super) points: Vec<Vector3<f64>>,
    /// Spring stiffness, border factor included.
    pub(in super::super) weight: Vec<f64>,
    /// Tolerances in the frame; locked points have [`LOCKED`].
    pub(in super::super) tolerance: Option<Vec<f64>>,
    pub(in super::super) locked: Vec<bool>,
    pub(in super::super) freedom: [bool; 3],
    pub(in super::super) energy: Option<EnergyWeights>,
    pub(in super::super) control_points: Option<[usize; 2]>,
    /// Rows and columns with a knuckle, increasing.
    pub(in super::super) knuckles: [Vec<usize>; 2],
    /// Where a tube may be cut, in the frame.
    pub(in super::super) cut: Option<Vector3<f64>>,
    pub(in super::super) robust: bool,
    /// Unit vector to the light, user's axes.
    pub(in super::super) light: Vector3<f64>,
    pub(in super::super) warnings: Vec<String>,
}

/// How near the surface passes by a locked point, as share of the longest
/// side: a thousandth of a millimetre on a hundred-metre ship.
pub(in super::super) const LOCKED: f64 = 1e-8;

impl Task {
    /// Whether all three axes are free.
    pub(in super::super) fn slides(&self) -> bool {
        self.freedom == [true; 3]
    }

    /// The one axis that is held by scattered points with two free ones: they
    /// slide within their planes across it.
    pub(in super::super) fn held(&self) -> Option<usize> {
        let held = self.freedom.iter().position(|f| !f)?;
        let two = self.freedom.iter().filter(|f| **f).count() == 2;
        (two && self.layout == Layout::Scattered).then_some(held)
    }
}
