//! `cone_spline` as the HTTP layer knows it.

use super::file::take_mesh;
use super::{Document, Fitted, Format, Header, Job, Method, Schemas, Words, misread};
use crate::http::dto::Point;
use crate::http::dto::cone_spline::{
    ConeSplineInput, ConeSplineOptions, ConeSplineResult, to_request,
};
use crate::http::dto::job::{ConeSplineJob, Normalized};
use crate::http::problem::{ApiError, Code, FieldError};
use crate::http::schema_check::Rule;
use crate::http::upload::File;
use crate::methods::cone_spline::{self, Request, request::Input};
use crate::methods::{Control, FitError};
use serde_json::Value;
use std::sync::LazyLock;

const WORDS: Words = Words {
    summary: "A strip as few cones, cylinders and planes, exactly tangent to each other.",
    description: "A plate roll makes cones and cylinders. From a strip (a mesh, a ruled surface, a \
        plate of a finished `hull_plates` job) the fewest patches that stay within a tolerance, or \
        the best ones of a given number. Neighbours share a ruling and the tangent plane along it, \
        by construction and as measured on the apex, axis and angle that are given. With each \
        patch comes what a workshop rolls it from; the whole strip has a flat pattern with bend \
        lines. A tolerance that no number of patches reaches is told, with the one that can be \
        reached. Rings are cut; creases, holes, Möbius bands and several pieces are refused with \
        their place.",
    source: "After Zhang, Bo, Zheng & Zhang, whose method is the solver `paper`; Chen, Lee, Leopoldseder, Pottmann, Randrup & Wallner \
        1999.",
    lengths: &["tolerance", "thickness", "min_bend_radius"],
    gifts: &[
        (
            "verdict",
            "within_limits: every limit that was asked is kept",
        ),
        ("summary", "The verdict, then what a loftsman should know"),
        ("surfaces", "The patches, exact, rational of degree [2, 1]"),
        ("curves", "The rulings between them and their edges"),
        (
            "method_specific.patches",
            "The workshop sheets: kind, apex, axis, angle or radius, turn, least bend radius, bend \
             side, trim curves, flat sector, bend lines",
        ),
        (
            "method_specific.rulings",
            "The rulings that neighbours share, in space and flat",
        ),
        (
            "method_specific.joins",
            "Angle and gap of every join, measured on the patches",
        ),
        ("method_specific.pattern", "The flat pattern"),
        (
            "method_specific.error_curve",
            "What other numbers of patches would give",
        ),
        (
            "method_specific.vertex_distances",
            "Signed distance of every vertex; values to colour by",
        ),
        (
            "diagnostics",
            "Distances both ways with their places, the floor, how the number came about",
        ),
    ],
};

static RULE: LazyLock<Result<Rule, String>> = LazyLock::new(super::rule_of::<ConeSplineJob>);

/// The method.
#[derive(Debug)]
pub struct ConeSpline;

impl Method for ConeSpline {
    fn name(&self) -> &'static str {
        "cone_spline"
    }

    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn schemas(&self) -> Schemas {
        Schemas::of::<ConeSplineInput, ConeSplineOptions>()
    }

    fn formats(&self) -> &'static [Format] {
        &Format::ALL
    }

    fn rule(&self) -> Result<&'static Rule, &'static String> {
        RULE.as_ref()
    }

    fn read(&self, value: Value) -> Result<Box<dyn Job>, Vec<FieldError>> {
        let job: ConeSplineJob = serde_json::from_value(value).map_err(misread)?;
        let request = to_request(&job.input, &job.options, job.units)?;
        Ok(Box::new(StripJob { job, request }))
    }

    fn take_file(&self, job: &mut Value, file: &File) -> Result<Vec<String>, ApiError> {
        take_mesh(job, file, &["surface", "job"])
            .map_err(|fault| ApiError::at(Code::InvalidJob, vec![fault]))
    }

    fn open(&self, result: &[u8]) -> Result<Box<dyn Document>, ApiError> {
        super::read_back::<ConeSplineResult>(result)
    }
}

/// A job that was read.
#[derive(Debug)]
struct StripJob {
    job: ConeSplineJob,
    request: Request,
}

impl Job for StripJob {
    fn method(&self) -> &'static str {
        ConeSpline.name()
    }

    fn header(&self) -> Header<'_> {
        Header {
            label: self.job.label.as_deref(),
            budget: self.job.budget,
        }
    }

    fn warnings(&self) -> Result<Vec<String>, FitError> {
        let issues = cone_spline::validate(&self.request);
        if issues.is_empty() {
            Ok(Vec::new())
        } else {
            Err(FitError::Invalid(issues))
        }
    }

    fn normalized(&self) -> Normalized {
        let (points, counts): (Vec<Point>, _) = match &self.request.input {
            Input::Mesh { vertices, faces } => (
                vertices.iter().map(|p| (*p).into()).collect(),
                [("vertices", vertices.len()), ("faces", faces.len())],
            ),
            Input::Ruled(surface) => {
                let [u, v] = surface.counts();
                let points = surface.control_points().iter();
                (
                    points.map(|p| (*p).into()).collect(),
                    [("control_points_u", u), ("control_points_v", v)],
                )
            }
        };
        Normalized::new(&points, self.job.units, &counts)
    }

    fn fit(&self, input_sha256: String, control: &dyn Control) -> Result<Fitted, FitError> {
        let outcome = cone_spline::fit(&self.request, control)?;
        let document = ConeSplineResult::new(&self.job, input_sha256, &outcome);
        Fitted::of(&document)
    }
}
