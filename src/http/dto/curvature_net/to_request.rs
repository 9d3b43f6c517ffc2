//! From the job of `curvature_net` on the wire to
//! [`methods::curvature_net::Request`](crate::methods::curvature_net::Request).
//!
//! Bounds of single values are in the schema; what the net itself must keep is
//! the method's. This module checks that exactly one kind of input is given,
//! rows of one length, options that go together, and coordinates against the
//! unit.

use super::super::curves::{Point, check_points};
use super::super::job::Units;
use super::super::mesh::MeshInput;
use super::{
    CurvatureNetInput, CurvatureNetOptions, CurvatureNetSolver, DirectionWord, TargetOption,
    UmbilicsWord,
};
use crate::http::problem::FieldError;
use crate::methods::curvature_net::Request;
use crate::methods::curvature_net::request::{
    Grid, Input, Options, QuadMesh, Solver, Supports, Target, Umbilics,
};

/// The method's request out of a job's input and options.
///
/// # Errors
/// Every rule that is broken, with its JSON pointer into the job.
pub fn to_request(
    input: &CurvatureNetInput,
    options: &CurvatureNetOptions,
    units: Units,
) -> Result<Request, Vec<FieldError>> {
    let mut faults = Vec::new();
    let input = net(input, units, &mut faults);
    let options = asked(options, units, &mut faults);
    match (input, options) {
        (Some(input), Some(options)) if faults.is_empty() => Ok(Request { input, options }),
        _ => Err(faults),
    }
}

fn net(input: &CurvatureNetInput, units: Units, faults: &mut Vec<FieldError>) -> Option<Input> {
    let exactly = |code, message: &str| FieldError::new("/input", code, message);
    match (&input.mesh, &input.grid) {
        (Some(mesh), None) => {
            if !input.closed.is_empty() {
                let message = "\"closed\" goes with a grid; how a mesh closes is found from it";
                faults.push(FieldError::new("/input/closed", "unexpected", message));
            }
            polygons(mesh, "/input/mesh", units, faults).map(Input::Mesh)
        }
        (None, Some(rows)) => grid(rows, &input.closed, units, faults).map(Input::Grid),
        (None, None) => {
            let message = "the input needs a \"mesh\" or a \"grid\"";
            let fault = exactly("missing", message);
            faults.push(fault.hint("a mesh can also be posted as a file: part \"file\" of a form"));
            None
        }
        (Some(_), Some(_)) => {
            let message = "the input has exactly one of \"mesh\" and \"grid\"";
            faults.push(exactly("ambiguous", message));
            None
        }
    }
}

fn polygons(
    mesh: &MeshInput,
    at: &str,
    units: Units,
    faults: &mut Vec<FieldError>,
) -> Option<QuadMesh> {
    let mesh = mesh.to_mesh(at, units, faults)?;
    Some(QuadMesh {
        vertices: mesh.vertices().to_vec(),
        faces: mesh.faces().iter().map(|f| f.corners().to_vec()).collect(),
    })
}

fn grid(
    rows: &[Vec<Point>],
    closed: &[DirectionWord],
    units: Units,
    faults: &mut Vec<FieldError>,
) -> Option<Grid> {
    let columns = rows.first().map_or(0, Vec::len);
    for (i, row) in rows.iter().enumerate() {
        check_points(row, &format!("/input/grid/{i}"), units, faults);
        if row.len() != columns {
            let message = format!("this row has {} points, the first {columns}", row.len());
            let fault = FieldError::new(format!("/input/grid/{i}"), "ragged", message);
            faults.push(fault.hint("a net has rows of one length"));
        }
    }
    Some(Grid {
        rows: rows.len(),
        columns,
        closed: [DirectionWord::U, DirectionWord::V].map(|d| closed.contains(&d)),
        points: rows.iter().flatten().map(|p| (*p).into()).collect(),
    })
}

fn asked(o: &CurvatureNetOptions, units: Units, faults: &mut Vec<FieldError>) -> Option<Options> {
    if !o.cyclide {
        let needs = [
            ("strips", !o.strips.is_empty()),
            ("offsets", !o.offsets.is_empty()),
            ("supports", o.supports.is_some()),
        ];
        for (name, _) in needs.iter().filter(|(_, given)| *given) {
            let message = format!("\"{name}\" needs the cyclide spline, which is turned off");
            faults.push(FieldError::new(
                format!("/options/{name}"),
                "unexpected",
                message,
            ));
        }
    }
    let zero =
        |place: String| FieldError::new(place, "out-of-range", "this must not be 0").value("0");
    for (i, _) in o.offsets.iter().enumerate().filter(|(_, d)| **d == 0.0) {
        faults.push(zero(format!("/options/offsets/{i}")));
    }
    if o.supports.is_some_and(|s| s.height == 0.0) {
        faults.push(zero("/options/supports/height".into()));
    }
    let target = match &o.target {
        Some(target) => Some(self::target(target, units, faults)?),
        None => None,
    };
    let mut strips: Vec<_> = Vec::new();
    for word in &o.strips {
        if !strips.contains(&(*word).into()) {
            strips.push((*word).into());
        }
    }
    Some(Options {
        levels: o.levels.map(|l| l.0),
        closeness: o.closeness,
        umbilics: match o.umbilics {
            UmbilicsWord::Avoid => Umbilics::Avoid,
            UmbilicsWord::KeepShape => Umbilics::KeepShape,
        },
        target,
        cyclide: o.cyclide,
        strips,
        offsets: o.offsets.clone(),
        supports: o.supports.map(|s| Supports { height: s.height }),
        solver: match o.solver {
            CurvatureNetSolver::Own => Solver::Own,
            CurvatureNetSolver::Paper => Solver::Paper,
        },
    })
}

fn target(o: &TargetOption, units: Units, faults: &mut Vec<FieldError>) -> Option<Target> {
    let at = "/options/target";
    match (&o.mesh, &o.surface) {
        (Some(mesh), None) => {
            polygons(mesh, "/options/target/mesh", units, faults).map(Target::Mesh)
        }
        (None, Some(surface)) => {
            let read = surface.to_surface("/options/target/surface", units, faults)?;
            Some(Target::BSpline(Box::new(read)))
        }
        _ => {
            let message = "a target has exactly one of \"mesh\" and \"surface\"";
            faults.push(FieldError::new(at, "ambiguous", message));
            None
        }
    }
}
