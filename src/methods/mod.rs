//! The fitting methods. Each is a pure, synchronous function of a request and
//! a [`Control`]; none knows HTTP, the wire or the clock.

pub mod cone_spline;
pub mod curvature_net;
pub mod diagnostics;
pub mod fairing;
pub mod hull_plates;
mod words;

pub use crate::solver::{Control, Stop};

use thiserror::Error;

/// Why a method has no outcome to show. A fit that merely misses its goal is
/// not an error but an outcome with a verdict.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// The request breaks a rule; every issue names its place.
    #[error("the input is not usable: {}", .0.first().map_or("", |i| i.message.as_str()))]
    Invalid(Vec<Issue>),
    /// The caller stopped the fit through its [`Control`].
    #[error("stopped: {0}")]
    Stopped(Stop),
    /// The mathematics broke down in a way that the input does not explain.
    #[error("the computation broke down: {0}")]
    Numerical(String),
}

impl From<Stop> for FitError {
    fn from(stop: Stop) -> Self {
        FitError::Stopped(stop)
    }
}

/// One broken rule of a request, with the place where it is broken.
#[derive(Debug, Clone, PartialEq)]
pub struct Issue {
    /// Where: path segments below the job's `input` or `options`, for example
    /// `["input", "profiles", "1", "points", "4"]`.
    pub path: Vec<String>,
    /// A short stable word for programmes, for example `repeated-point`.
    pub code: &'static str,
    /// A sentence for people, with the offending numbers in it.
    pub message: String,
    /// What to do about it, where that is known.
    pub hint: Option<String>,
}
