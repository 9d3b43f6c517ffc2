//! `hull_plates` as the HTTP layer knows it.

use super::{Document, Fitted, Format, Header, Job, Method, Schemas, Words, misread};
use crate::http::dto::Point;
use crate::http::dto::hull_plates::{
    HullPlatesInput, HullPlatesOptions, HullPlatesResult, ProfileCurve, flat_patterns, to_request,
};
use crate::http::dto::job::{HullPlatesJob, Normalized};
use crate::http::problem::{ApiError, FieldError};
use crate::http::schema_check::Rule;
use crate::methods::hull_plates::{self, Outcome, Request};
use crate::methods::{Control, FitError};
use serde_json::Value;
use std::sync::LazyLock;

const WORDS: Words = Words {
    summary: "Plates that bend from flat steel or plywood between the profile curves of a hull.",
    description: "Two neighbouring profiles bound a plate. Its rulings are chosen so \
    that the surface normals at the two ends of each differ as little as possible (twist): by a \
    search over all pairs of points for the best set of rulings, then by least squares. The \
    boundary is kept exactly, or moved within a tolerance that holds everywhere. Fans at the ends, \
    the distance of the edge of regression and bend radii are bounded, so that a yard can bend \
    what is delivered.",
    source: "After Zheng & Bo 2018 and Bo, Zheng, Zhang 2019 (arXiv 1905.07518); the \
    discrete optimum after Wang & Tang 2005.",
    lengths: &["thickness", "min_bend_radius", "boundary"],
    gifts: &[
        ("verdict", "within_limits or outside_limits"),
        (
            "summary",
            "One sentence for the job, then one a plate, with the reason, then one on the flat \
      patterns",
        ),
        (
            "surfaces",
            "One B-spline surface a plate, degree [3,1], control points [u][v]",
        ),
        ("curves", "The profiles as the plates share them"),
        (
            "method_specific.plates",
            "Rulings with twist and bend radii, fans, extensions",
        ),
        (
            "method_specific.plates.flat",
            "The flat pattern: outline, roll table, stations, strain, size of the sheet",
        ),
        (
            "method_specific.profiles",
            "How far each profile was moved, and which points",
        ),
        (
            "diagnostics",
            "Twist (max, mean, 95 %), corner warp, the discrete optimum, clearance, bend \
      radius, strain, curvature, area, termination",
        ),
    ],
};

static RULE: LazyLock<Result<Rule, String>> = LazyLock::new(super::rule_of::<HullPlatesJob>);

/// The method.
#[derive(Debug)]
pub struct HullPlates;

impl Method for HullPlates {
    fn name(&self) -> &'static str {
        "hull_plates"
    }

    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn schemas(&self) -> Schemas {
        Schemas::of::<HullPlatesInput, HullPlatesOptions>()
    }

    fn formats(&self) -> &'static [Format] {
        &[
            Format::Json,
            Format::Obj,
            Format::Stl,
            Format::Ply,
            Format::Glb,
            Format::Csv,
            Format::Svg,
            Format::Step,
            Format::Igs,
            Format::Dxf,
            Format::Zip,
        ]
    }

    fn rule(&self) -> Result<&'static Rule, &'static String> {
        RULE.as_ref()
    }

    fn read(&self, value: Value) -> Result<Box<dyn Job>, Vec<FieldError>> {
        Ok(Box::new(PlatesJob::read(value)?))
    }

    fn open(&self, result: &[u8]) -> Result<Box<dyn Document>, ApiError> {
        super::read_back::<HullPlatesResult>(result)
    }
}

/// A fit, as [`hull_plates::fit`] is one.
pub type Fit = fn(&Request, &dyn Control) -> Result<Outcome, FitError>;

/// A job that was read.
#[derive(Debug)]
pub struct PlatesJob {
    job: HullPlatesJob,
    request: Request,
}

impl PlatesJob {
    /// A job out of a value that keeps the rule.
    ///
    /// # Errors
    /// Every rule that needs two values at once and is broken.
    pub fn read(value: Value) -> Result<Self, Vec<FieldError>> {
        let job: HullPlatesJob = serde_json::from_value(value).map_err(misread)?;
        let request = to_request(&job.input, &job.options, job.units)?;
        Ok(PlatesJob { job, request })
    }

    /// Runs `fit` and writes what comes of it.
    ///
    /// # Errors
    /// Those of `fit`.
    pub fn fit_with(
        &self,
        fit: Fit,
        input_sha256: String,
        control: &dyn Control,
    ) -> Result<Fitted, FitError> {
        let outcome = fit(&self.request, control)?;
        let flats = flat_patterns(&outcome, &self.job.options, control)?;
        let result = HullPlatesResult::new(&self.job, input_sha256, &outcome, flats);
        Fitted::of(&result)
    }
}

impl Job for PlatesJob {
    fn method(&self) -> &'static str {
        HullPlates.name()
    }

    fn header(&self) -> Header<'_> {
        Header {
            label: self.job.label.as_deref(),
            budget: self.job.budget,
        }
    }

    fn warnings(&self) -> Result<Vec<String>, FitError> {
        hull_plates::validate(&self.request)
    }

    fn normalized(&self) -> Normalized {
        let profiles = &self.job.input.profiles;
        let points: Vec<Point> = profiles.iter().flat_map(points).copied().collect();
        let counts = [
            ("profiles", profiles.len()),
            ("plates", profiles.len().saturating_sub(1)),
            ("points", points.len()),
        ];
        Normalized::new(&points, self.job.units, &counts)
    }

    fn fit(&self, input_sha256: String, control: &dyn Control) -> Result<Fitted, FitError> {
        self.fit_with(hull_plates::fit, input_sha256, control)
    }
}

/// The given points, or the control points, of a profile.
fn points(profile: &ProfileCurve) -> impl Iterator<Item = &Point> {
    let given = profile.points.iter().flatten();
    given.chain(profile.bspline.iter().flat_map(|s| &s.control_points))
}
