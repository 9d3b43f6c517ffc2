//! `curvature_net` as the HTTP layer knows it.

use super::file::take_mesh;
use super::{Document, Fitted, Format, Header, Job, Method, Schemas, Words, misread};
use crate::http::dto::Point;
use crate::http::dto::curvature_net::{
    CurvatureNetInput, CurvatureNetOptions, CurvatureNetResult, to_request,
};
use crate::http::dto::job::{CurvatureNetJob, Normalized};
use crate::http::problem::{ApiError, Code, FieldError};
use crate::http::schema_check::Rule;
use crate::http::upload::File;
use crate::methods::curvature_net::{self, Request, request::Input};
use crate::methods::{Control, FitError, Issue};
use serde_json::Value;
use std::sync::LazyLock;

const WORDS: Words = Words {
    summary: "A surface whose patch borders are lines of curvature, and its exact cyclide spline.",
    description: "From a coarse regular net of quads: a smooth surface near it whose patch borders \
        are lines of curvature, then patches of Dupin cyclides, exactly tangent to each other, \
        with circular arcs as borders. Such a skin has exact offsets, conical strips that unroll \
        exactly in both directions, and supports along its normals that meet without torsion; all \
        come with flat patterns and a bill of quantities.",
    source: "After Zheng & Bo 2019; exact by Bobenko & Huhnen-Venedey (arXiv 1101.5955), patches \
        after Zube & Krasauskas 2015.",
    lengths: &["offsets", "supports"],
    gifts: &[
        (
            "verdict",
            "within_limits: lines of curvature, no umbilic, every proof kept",
        ),
        ("summary", "Sentences, the verdict first"),
        (
            "surfaces",
            "The smooth bicubic surface, the rational biquadratic patches of the cyclide spline and \
             of its offsets, control points [u][v]",
        ),
        (
            "method_specific.vertices",
            "Places, frames, curvatures; values to colour by",
        ),
        ("method_specific.certificates", "The proof of every patch"),
        (
            "method_specific.strips",
            "Conical strips: apex, axis and angle of every cone, flat patterns",
        ),
        (
            "method_specific.supports",
            "Supports along the normals with flat patterns",
        ),
        (
            "method_specific.offsets",
            "Offsets, and the patches that reach a focal point",
        ),
        (
            "method_specific.members",
            "The bill: radius, length, angle and node torsion of every arc",
        ),
        (
            "diagnostics",
            "Torsion of the borders, umbilics, moves, residuals of the cyclide spline, each with its \
             place",
        ),
    ],
};

static RULE: LazyLock<Result<Rule, String>> = LazyLock::new(super::rule_of::<CurvatureNetJob>);

/// The method.
#[derive(Debug)]
pub struct CurvatureNet;

impl Method for CurvatureNet {
    fn name(&self) -> &'static str {
        "curvature_net"
    }

    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn schemas(&self) -> Schemas {
        Schemas::of::<CurvatureNetInput, CurvatureNetOptions>()
    }

    fn formats(&self) -> &'static [Format] {
        &Format::ALL
    }

    fn rule(&self) -> Result<&'static Rule, &'static String> {
        RULE.as_ref()
    }

    fn read(&self, value: Value) -> Result<Box<dyn Job>, Vec<FieldError>> {
        let job: CurvatureNetJob = serde_json::from_value(value).map_err(misread)?;
        let request = to_request(&job.input, &job.options, job.units)?;
        Ok(Box::new(NetJob { job, request }))
    }

    fn take_file(&self, job: &mut Value, file: &File) -> Result<Vec<String>, ApiError> {
        take_mesh(job, file, &["grid"]).map_err(|fault| ApiError::at(Code::InvalidJob, vec![fault]))
    }

    fn open(&self, result: &[u8]) -> Result<Box<dyn Document>, ApiError> {
        super::read_back::<CurvatureNetResult>(result)
    }
}

/// A job that was read.
#[derive(Debug)]
struct NetJob {
    job: CurvatureNetJob,
    request: Request,
}

impl Job for NetJob {
    fn method(&self) -> &'static str {
        CurvatureNet.name()
    }

    fn header(&self) -> Header<'_> {
        Header {
            label: self.job.label.as_deref(),
            budget: self.job.budget,
        }
    }

    fn warnings(&self) -> Result<Vec<String>, FitError> {
        curvature_net::validate(&self.request).map_err(|e| self.renamed(e))
    }

    fn normalized(&self) -> Normalized {
        let (points, counts) = match &self.request.input {
            Input::Mesh(mesh) => {
                let counts = [
                    ("vertices", mesh.vertices.len()),
                    ("faces", mesh.faces.len()),
                ];
                (&mesh.vertices, counts)
            }
            Input::Grid(grid) => (
                &grid.points,
                [("rows", grid.rows), ("columns", grid.columns)],
            ),
        };
        let points: Vec<Point> = points.iter().map(|p| (*p).into()).collect();
        Normalized::new(&points, self.job.units, &counts)
    }

    fn fit(&self, input_sha256: String, control: &dyn Control) -> Result<Fitted, FitError> {
        let outcome = curvature_net::fit(&self.request, control).map_err(|e| self.renamed(e))?;
        Fitted::of(&CurvatureNetResult::new(&self.job, input_sha256, &outcome))
    }
}

impl NetJob {
    /// Issues with the places that they have in the job: the method counts the
    /// points of a grid through, the wire by row and column.
    fn renamed(&self, error: FitError) -> FitError {
        let FitError::Invalid(mut issues) = error else {
            return error;
        };
        if let Input::Grid(grid) = &self.request.input {
            issues
                .iter_mut()
                .for_each(|issue| by_row(issue, grid.columns));
        }
        FitError::Invalid(issues)
    }
}

fn by_row(issue: &mut Issue, columns: usize) {
    let [input, grid, rest @ ..] = &issue.path[..] else {
        return;
    };
    if input != "input" || grid != "grid" {
        return;
    }
    let place: Vec<String> = match rest {
        [points, index] if points == "points" => match index.parse::<usize>() {
            Ok(k) if columns > 0 => vec![(k / columns).to_string(), (k % columns).to_string()],
            _ => Vec::new(),
        },
        _ => Vec::new(),
    };
    issue.path.truncate(2);
    issue.path.extend(place);
}
