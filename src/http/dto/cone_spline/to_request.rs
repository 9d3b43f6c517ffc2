//! From the wire to the method's request.

use super::super::curves::check_points;
use super::super::job::Units;
use super::{ConeSplineInput, ConeSplineOptions, ConeSplineSolver, KindWord, NormOption};
use crate::http::problem::FieldError;
use crate::methods::cone_spline::Request;
use crate::methods::cone_spline::request::{Classes, Goal, Input, Norm, Options, Solver};

/// The name of a strip that has none.
const UNNAMED: &str = "strip";

/// The method's request.
///
/// # Errors
/// Every rule that needs two values at once and is broken.
pub fn to_request(
    input: &ConeSplineInput,
    options: &ConeSplineOptions,
    units: Units,
) -> Result<Request, Vec<FieldError>> {
    let mut faults = Vec::new();
    let strip = strip(input, units, &mut faults);
    let options = asked(options, units, &mut faults);
    match strip {
        Some(strip) if faults.is_empty() => Ok(Request {
            name: input.name.clone().unwrap_or_else(|| UNNAMED.to_owned()),
            input: strip,
            options,
        }),
        _ => Err(faults),
    }
}

fn strip(input: &ConeSplineInput, units: Units, faults: &mut Vec<FieldError>) -> Option<Input> {
    let fault = |code, message: &str| FieldError::new("/input", code, message);
    if let Some(place) = input.plate.filter(|_| input.job.is_none()) {
        let message = "\"plate\" goes with \"job\"";
        let fault = FieldError::new("/input/plate", "unexpected", message);
        faults.push(fault.value(place.0.to_string()));
    }
    match (&input.mesh, &input.surface, input.job) {
        (Some(mesh), None, None) => {
            let mesh = mesh.to_mesh("/input/mesh", units, faults)?;
            Some(Input::Mesh {
                vertices: mesh.vertices().to_vec(),
                faces: mesh.faces().iter().map(|f| f.corners().to_vec()).collect(),
            })
        }
        (None, Some(surface), None) => {
            let surface = surface.to_surface("/input/surface", units, faults)?;
            Some(Input::Ruled(surface))
        }
        // A server has put the plate in its place before a job comes here.
        (None, None, Some(job)) => {
            let message = "a job can be named only where it is posted to the server that has it";
            let fault = FieldError::new("/input/job", "unexpected", message).value(job.to_string());
            faults.push(fault.hint("give the plate as a \"surface\" of its result"));
            None
        }
        (None, None, None) => {
            let message = "the input needs a \"mesh\", a \"surface\" or a \"job\"";
            let fault = fault("missing", message);
            faults.push(fault.hint("a mesh can also be posted as a file: part \"file\" of a form"));
            None
        }
        _ => {
            let message = "the input has exactly one of \"mesh\", \"surface\" and \"job\"";
            faults.push(fault("ambiguous", message));
            None
        }
    }
}

fn asked(o: &ConeSplineOptions, units: Units, faults: &mut Vec<FieldError>) -> Options {
    let goal = match (o.tolerance, o.pieces) {
        (Some(tolerance), None) => Goal::Tolerance(tolerance),
        (None, Some(pieces)) => Goal::Pieces(pieces.0),
        (None, None) => Goal::Noise,
        (Some(_), Some(pieces)) => {
            let message = "\"tolerance\" finds the number of patches, \"pieces\" gives it; one is \
                           enough";
            let fault = FieldError::new("/options/pieces", "ambiguous", message);
            faults.push(fault.value(pieces.0.to_string()));
            Goal::Pieces(pieces.0)
        }
    };
    if let Some(cut) = &o.cut {
        let mut found = Vec::new();
        check_points(std::slice::from_ref(cut), "/options/cut", units, &mut found);
        for fault in &mut found {
            fault.pointer = fault.pointer.replacen("/cut/0", "/cut", 1);
        }
        faults.extend(found);
    }
    let has = |kind| o.classes.contains(&kind);
    Options {
        goal,
        norm: o.norm.map(|norm| match norm {
            NormOption::LeastSquares => Norm::LeastSquares,
            NormOption::EighthPowers => Norm::EighthPowers,
            NormOption::Minimax => Norm::Minimax,
        }),
        classes: Classes {
            cones: has(KindWord::Cone),
            cylinders: has(KindWord::Cylinder),
            planes: has(KindWord::Plane),
        },
        simplify: o.simplify,
        robust: o.robust,
        cut: o.cut.map(Into::into),
        thickness: o.thickness,
        min_bend_radius: o.min_bend_radius,
        solver: match o.solver {
            ConeSplineSolver::Own => Solver::Own,
            ConeSplineSolver::Paper => Solver::Paper,
        },
    }
}
