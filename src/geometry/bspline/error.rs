//! Why a spline cannot be.

use super::knots::MAX_DEGREE;
use thiserror::Error;

/// Why a spline cannot be. Every variant names the broken condition and
/// carries the numbers.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SplineError {
    /// The degree is 0 or above [`MAX_DEGREE`].
    #[error("degree {degree} is not in 1..={MAX_DEGREE}")]
    Degree {
        /// The degree given.
        degree: usize,
    },
    /// Fewer than `2 (degree + 1)` knots.
    #[error("{knots} knots are too few for degree {degree}: at least {} are needed", 2 * (degree + 1))]
    TooFewKnots {
        /// Number of knots given.
        knots: usize,
        /// The degree.
        degree: usize,
    },
    /// A knot is NaN or infinite.
    #[error("knot {index} is not a finite number: {value}")]
    KnotNotFinite {
        /// Its place in the knot vector.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The knots decrease somewhere.
    #[error("knot {index} ({value}) is less than the knot before it ({before})")]
    KnotsDecrease {
        /// Place of the smaller knot.
        index: usize,
        /// Its value.
        value: f64,
        /// The value before it.
        before: f64,
    },
    /// An end knot does not occur exactly `degree + 1` times.
    #[error("the {} knot {value} occurs {multiplicity} times, not degree + 1 = {} times", if *.start { "first" } else { "last" }, degree + 1)]
    NotClamped {
        /// Whether it is the first knot.
        start: bool,
        /// Its value.
        value: f64,
        /// How often it occurs.
        multiplicity: usize,
        /// The degree.
        degree: usize,
    },
    /// An inner knot occurs more than `degree` times: the curve would jump.
    #[error("inner knot {value} occurs {multiplicity} times, more than the degree {degree}")]
    Multiplicity {
        /// Its value.
        value: f64,
        /// How often it occurs.
        multiplicity: usize,
        /// The degree.
        degree: usize,
    },
    /// The number of control points does not fit knots and degree.
    #[error("{given} control points, but the knots and the degree ask for {expected}")]
    ControlPointCount {
        /// Number given.
        given: usize,
        /// Number that fits.
        expected: usize,
    },
    /// A coordinate of a control point is NaN or infinite.
    #[error("control point {index} has a coordinate that is not a finite number")]
    ControlPointNotFinite {
        /// Its index.
        index: usize,
    },
    /// The number of weights differs from the number of control points.
    #[error("{given} weights for {expected} control points")]
    WeightCount {
        /// Number given.
        given: usize,
        /// Number of control points.
        expected: usize,
    },
    /// A weight is not a positive finite number.
    #[error("weight {index} is {value}, not a positive finite number")]
    Weight {
        /// Its index.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Fewer points than an interpolation needs.
    #[error("{given} points are too few to interpolate: at least {needed} are needed")]
    TooFewPoints {
        /// Number given.
        given: usize,
        /// Number needed.
        needed: usize,
    },
    /// A coordinate of a point to interpolate is NaN or infinite, or so large
    /// that its distance from the point before it is.
    #[error("point {index} has a coordinate that is not a finite number or too large")]
    PointNotFinite {
        /// Its index.
        index: usize,
    },
    /// Two consecutive points coincide (or so nearly that their parameters do).
    #[error("point {index} repeats the point before it")]
    RepeatedPoint {
        /// Index of the second of the two.
        index: usize,
    },
    /// Interpolation parameters that do not increase.
    #[error("parameter {index} does not increase on the one before it")]
    ParametersNotIncreasing {
        /// Index of the second of the two.
        index: usize,
    },
    /// The interpolation system has no unique solution.
    #[error("the interpolation system is singular at row {row}")]
    SingularInterpolation {
        /// Where.
        row: usize,
    },
    /// A parameter must lie inside the domain.
    #[error("parameter {parameter} is not inside the domain [{}, {}]", domain[0], domain[1])]
    OutsideDomain {
        /// The parameter given.
        parameter: f64,
        /// The domain.
        domain: [f64; 2],
    },
    /// Splines that were to be combined differ in degree.
    #[error("the degrees {first} and {second} differ")]
    DegreesDiffer {
        /// Degree of the first.
        first: usize,
        /// Degree of the second.
        second: usize,
    },
    /// Splines that were to be combined do not fit in parameter.
    #[error("the domains [{}, {}] and [{}, {}] do not fit", first[0], first[1], second[0], second[1])]
    DomainsDiffer {
        /// Domain of the first.
        first: [f64; 2],
        /// Domain of the second.
        second: [f64; 2],
    },
    /// Curves that were to be joined do not meet.
    #[error("curve {index} begins {gap:e} away from the end of the curve before it")]
    Gap {
        /// Index of the second of the two.
        index: usize,
        /// Distance of the ends.
        gap: f64,
    },
    /// Nothing to join.
    #[error("there is no curve to join")]
    NoCurves,
}
