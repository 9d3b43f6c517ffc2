//! The same curve in another form: reversed, raised, refined, split, moved.

use super::refine::{ControlMap, Elevation, Insertion};
use super::{BSplineCurve, Knots, SplineError};
use nalgebra::{Point3, Vector3, Vector4};

impl BSplineCurve {
    /// The same curve run through the other way, on the same domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let weights = self.weights().map(|w| w.iter().rev().copied().collect());
        let points = self.control_points().iter().rev().copied().collect();
        Self::trusted(self.knot_vector().reversed(), points, weights)
    }

    /// The same curve, parameter by parameter, with one degree more.
    ///
    /// # Errors
    /// [`SplineError::Degree`] where [`super::MAX_DEGREE`] is passed.
    pub fn elevated(&self) -> Result<Self, SplineError> {
        Ok(self.mapped(&Elevation::new(self.knot_vector())?))
    }

    /// The same curve raised to `degree`; unchanged if it has it already.
    ///
    /// # Errors
    /// [`SplineError::DegreesDiffer`] if its degree is larger,
    /// [`SplineError::Degree`] where [`super::MAX_DEGREE`] is passed.
    pub fn elevated_to(&self, degree: usize) -> Result<Self, SplineError> {
        if self.degree() > degree {
            return Err(SplineError::DegreesDiffer {
                first: self.degree(),
                second: degree,
            });
        }
        let mut curve = self.clone();
        while curve.degree() < degree {
            curve = curve.elevated()?;
        }
        Ok(curve)
    }

    /// The same curve with further knots, repetitions as often as given. In
    /// a polynomial curve, control points that need not move keep every bit.
    ///
    /// # Errors
    /// A knot not strictly inside the domain, or one that would occur more
    /// than `degree` times.
    pub fn insert_knots(&self, knots: &[f64]) -> Result<Self, SplineError> {
        Ok(self.mapped(&Insertion::new(self.knot_vector(), knots)?))
    }

    /// The parts before and after `u`, with `u` as their common end and equal
    /// end points to the bit.
    ///
    /// # Errors
    /// [`SplineError::OutsideDomain`] unless `u` is strictly inside.
    pub fn split(&self, u: f64) -> Result<(Self, Self), SplineError> {
        let p = self.degree();
        let lacking = p.saturating_sub(self.knot_vector().multiplicity(u));
        let whole = self.insert_knots(&vec![u; lacking])?;
        let [a, b] = self.domain();
        if !(u > a && u < b) {
            return Err(SplineError::OutsideDomain {
                parameter: u,
                domain: [a, b],
            });
        }
        let (knots, points) = (whole.knots(), whole.control_points());
        let from = knots.partition_point(|t| *t < u);
        let mut left = knots[..from + p].to_vec();
        left.push(u);
        let mut right = vec![u];
        right.extend_from_slice(&knots[from..]);
        let part = |knots: Vec<f64>, range: std::ops::Range<usize>| {
            let weights = whole.weights().map(|w| w[range.clone()].to_vec());
            Self::trusted(Knots::trusted(p, knots), points[range].to_vec(), weights)
        };
        Ok((part(left, 0..from), part(right, from - 1..points.len())))
    }

    /// The part between two parameters, with its own parameters kept.
    ///
    /// # Errors
    /// [`SplineError::OutsideDomain`] unless both lie in the domain, `from`
    /// before `to`.
    pub fn restricted(&self, from: f64, to: f64) -> Result<Self, SplineError> {
        let domain = self.domain();
        for (parameter, ok) in [
            (from, from >= domain[0]),
            (to, to <= domain[1] && to > from),
        ] {
            if !ok {
                return Err(SplineError::OutsideDomain { parameter, domain });
            }
        }
        let mut part = self.clone();
        if to < domain[1] {
            part = part.split(to)?.0;
        }
        if from > domain[0] {
            part = part.split(from)?.1;
        }
        Ok(part)
    }

    /// The same curve on another domain (an affine change of parameter).
    ///
    /// # Errors
    /// As [`Knots::on_domain`].
    pub fn on_domain(&self, domain: [f64; 2]) -> Result<Self, SplineError> {
        let knots = self.knot_vector().on_domain(domain)?;
        let weights = self.weights().map(<[f64]>::to_vec);
        Ok(Self::trusted(
            knots,
            self.control_points().to_vec(),
            weights,
        ))
    }

    /// The curve moved.
    #[must_use]
    pub fn translated(&self, by: &Vector3<f64>) -> Self {
        self.with_points(|p| p + by)
    }

    /// The curve scaled about the origin.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self.with_points(|p| p * factor)
    }

    fn with_points(&self, f: impl Fn(&Point3<f64>) -> Point3<f64>) -> Self {
        let points = self.control_points().iter().map(f).collect();
        let weights = self.weights().map(<[f64]>::to_vec);
        Self::trusted(self.knot_vector().clone(), points, weights)
    }

    /// The same curve with weights written out (all 1 if there were none).
    #[must_use]
    pub fn as_rational(&self) -> Self {
        let weights = self.weights().map(<[f64]>::to_vec);
        let ones = || vec![1.0; self.control_points().len()];
        let weights = Some(weights.unwrap_or_else(ones));
        Self::trusted(
            self.knot_vector().clone(),
            self.control_points().to_vec(),
            weights,
        )
    }

    /// The curve with its control points mapped onto new knots.
    pub(super) fn mapped(&self, map: &impl ControlMap) -> Self {
        let (points, weights) = map_control(map, self.control_points(), self.weights());
        Self::trusted(map.target().clone(), points, weights)
    }
}

/// Applies a map to one row of control points, homogeneous where weighted.
fn map_control(
    map: &impl ControlMap,
    points: &[Point3<f64>],
    weights: Option<&[f64]>,
) -> (Vec<Point3<f64>>, Option<Vec<f64>>) {
    let Some(weights) = weights else {
        let flat: Vec<Vector3<f64>> = points.iter().map(|p| p.coords).collect();
        return (
            map.apply(&flat).into_iter().map(Point3::from).collect(),
            None,
        );
    };
    let homogeneous: Vec<Vector4<f64>> = points
        .iter()
        .zip(weights)
        .map(|(p, w)| (p.coords * *w).push(*w))
        .collect();
    let mapped = map.apply(&homogeneous);
    let points = mapped.iter().map(|h| Point3::from(h.xyz() / h.w)).collect();
    (points, Some(mapped.iter().map(|h| h.w).collect()))
}
