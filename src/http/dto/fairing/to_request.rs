//! From the job of `fairing` on the wire to
//! [`methods::fairing::Request`](crate::methods::fairing::Request).
//!
//! Bounds of single values are in the schema; what the points themselves must
//! keep is the method's. This module checks that exactly one kind of input is
//! given, that options go with it, and coordinates against the unit.

use super::super::curves::{Point, check_points};
use super::super::index::Index;
use super::super::job::Units;
use super::{FairingInput, FairingOptions, FairingSolver, MeasuredPoint, OffsetTable, PointsKind};
use crate::http::problem::FieldError;
use crate::methods::fairing::{Request, curve, offsets, surface};
use nalgebra::{Point3, Vector3};

/// The method's request out of a job's input and options.
///
/// # Errors
/// Every rule that is broken, with its JSON pointer into the job.
pub fn to_request(
    input: &FairingInput,
    options: &FairingOptions,
    units: Units,
) -> Result<Request, Vec<FieldError>> {
    let mut faults = Vec::new();
    if input.file.is_some() {
        let message = "\"file\" goes with a form that has a part of that name";
        let fault = FieldError::new("/input/file", "unexpected", message);
        faults.push(fault.hint("post multipart/form-data with the parts \"job\" and \"file\""));
    }
    if input.file_places.is_some() {
        let message = "\"file_places\" goes with a file of offsets";
        let fault = FieldError::new("/input/file_places", "unexpected", message);
        faults.push(fault.hint("a table in the job has its places in stations and waterlines"));
    }
    let request = match (&input.points, &input.grid, &input.offsets) {
        (Some(points), None, None) => loose(points, input, options, (units, &mut faults)),
        (None, Some(grid), None) => {
            refuse(options, &GRID_OPTIONS, "a grid", &mut faults);
            check_grid(grid, units, &mut faults);
            let points = surface::request::Points::Grid(to_grid(grid));
            Some(surface_request(points, options))
        }
        (None, None, Some(table)) => {
            refuse(options, &TABLE_OPTIONS, "a table of offsets", &mut faults);
            check_names(table, &mut faults);
            Some(offsets_request(table, options))
        }
        (None, None, None) => {
            let message = "the input needs \"points\", a \"grid\" or \"offsets\"";
            faults.push(FieldError::new("/input", "missing", message));
            None
        }
        _ => {
            let message = "the input has exactly one of \"points\", \"grid\" and \"offsets\"";
            faults.push(FieldError::new("/input", "ambiguous", message));
            None
        }
    };
    request.filter(|_| faults.is_empty()).ok_or(faults)
}

/// Options beside those that go with everything (`tolerance`, `robust`).
const CURVE_OPTIONS: [&str; 12] = [
    "tolerances",
    "stiffness",
    "locked",
    "freedom",
    "end_tangents",
    "end_curvatures",
    "knuckles",
    "straight",
    "energy",
    "degree",
    "control_points",
    "solver",
];
const SURFACE_OPTIONS: [&str; 9] = [
    "cut",
    "tolerances",
    "stiffness",
    "locked",
    "freedom",
    "surface_energy",
    "control_net",
    "solver",
    "light",
];
const GRID_OPTIONS: [&str; 11] = [
    "knuckle_rows",
    "knuckle_columns",
    "tolerances",
    "stiffness",
    "locked",
    "freedom",
    "surface_energy",
    "control_net",
    "solver",
    "light",
    "boundary_factor",
];
const TABLE_OPTIONS: [&str; 6] = [
    "cell_tolerances",
    "locked_cells",
    "knuckle_stations",
    "knuckle_waterlines",
    "buttocks",
    "light",
];

/// A fault for every option that was given and does not go with the input.
fn refuse(options: &FairingOptions, allowed: &[&str], input: &str, faults: &mut Vec<FieldError>) {
    let o = options;
    let given = [
        ("tolerances", o.tolerances.is_some()),
        ("cell_tolerances", !o.cell_tolerances.is_empty()),
        ("stiffness", o.stiffness.is_some()),
        ("locked", !o.locked.is_empty()),
        ("locked_cells", !o.locked_cells.is_empty()),
        ("freedom", o.freedom != super::Freedom::default()),
        ("end_tangents", o.end_tangents.is_some()),
        ("end_curvatures", o.end_curvatures.is_some()),
        ("knuckles", !o.knuckles.is_empty()),
        ("knuckle_stations", !o.knuckle_stations.is_empty()),
        ("knuckle_waterlines", !o.knuckle_waterlines.is_empty()),
        ("knuckle_rows", !o.knuckle_rows.is_empty()),
        ("knuckle_columns", !o.knuckle_columns.is_empty()),
        ("straight", !o.straight.is_empty()),
        ("energy", o.energy.is_some()),
        ("surface_energy", o.surface_energy.is_some()),
        ("boundary_factor", o.boundary_factor.is_some()),
        ("degree", o.degree.is_some()),
        ("control_points", o.control_points.is_some()),
        ("control_net", o.control_net.is_some()),
        ("solver", o.solver != FairingSolver::default()),
        ("cut", o.cut.is_some()),
        ("buttocks", !o.buttocks.is_empty()),
        ("light", o.light.is_some()),
    ];
    for (name, _) in given
        .iter()
        .filter(|(n, given)| *given && !allowed.contains(n))
    {
        let message = format!("\"{name}\" does not go with {input}");
        faults.push(FieldError::new(
            format!("/options/{name}"),
            "unexpected",
            message,
        ));
    }
}

fn loose(
    points: &[MeasuredPoint],
    input: &FairingInput,
    options: &FairingOptions,
    (units, faults): (Units, &mut Vec<FieldError>),
) -> Option<Request> {
    let dimension = points[0].dimension();
    let other = points.iter().position(|p| p.dimension() != dimension);
    if let Some(i) = other {
        let message = format!(
            "this point has {} coordinates, the first has {dimension}",
            points[i].dimension()
        );
        faults.push(FieldError::new(
            format!("/input/points/{i}"),
            "mixed-dimension",
            message,
        ));
    }
    let given: Vec<Point3<f64>> = points.iter().map(|p| (*p).into()).collect();
    let checked: Vec<Point> = given.iter().map(|p| (*p).into()).collect();
    check_points(&checked, "/input/points", units, faults);
    match input.kind {
        PointsKind::Curve => {
            refuse(options, &CURVE_OPTIONS, "the points of a curve", faults);
            Some(curve_request(given, dimension, input, options))
        }
        PointsKind::Surface => {
            refuse(options, &SURFACE_OPTIONS, "the points of a surface", faults);
            // That they have no order (`ordered: false`) is true of them.
            if input.closed.is_some() {
                let message = "\"closed\" goes with the points of a curve";
                faults.push(FieldError::new("/input/closed", "unexpected", message));
            }
            if dimension != 3 {
                let message = "the points of a surface need three coordinates";
                faults.push(FieldError::new("/input/points/0", "too-few", message));
            }
            let points = surface::request::Points::Scattered(given);
            Some(surface_request(points, options))
        }
    }
}

fn curve_request(
    points: Vec<Point3<f64>>,
    dimension: usize,
    input: &FairingInput,
    o: &FairingOptions,
) -> Request {
    let vector = |p: Point| Vector3::from(p.0);
    let ends = |k: usize| o.end_tangents.as_ref().and_then(|e| e[k]).map(vector);
    let bends = |k: usize| o.end_curvatures.as_ref().and_then(|e| e[k]);
    Request::Curve(curve::Request {
        name: input.name.clone().unwrap_or_default(),
        points,
        dimension,
        ordered: input.ordered,
        closed: input.closed,
        options: curve::request::Options {
            tolerance: o.tolerance,
            tolerances: o.tolerances.clone().unwrap_or_default(),
            stiffness: o.stiffness.clone().unwrap_or_default(),
            locked: o.locked.iter().map(|i| i.0).collect(),
            freedom: o.freedom.axes(),
            end_tangents: [ends(0), ends(1)],
            end_curvatures: [bends(0), bends(1)],
            knuckles: o.knuckles.iter().map(|i| i.0).collect(),
            straight: o.straight.iter().map(|p| p.numbers()).collect(),
            energy: o.energy.map(|e| curve::request::EnergyWeights {
                tension: e.tension,
                bending: e.bending,
                jerk: e.jerk,
            }),
            degree: o.degree.map(|d| d.0),
            control_points: o.control_points.map(|n| n.0),
            robust: o.robust,
            solver: match o.solver {
                FairingSolver::Own => curve::request::Solver::Own,
                FairingSolver::Paper => curve::request::Solver::Paper,
            },
        },
    })
}

fn surface_request(points: surface::request::Points, o: &FairingOptions) -> Request {
    use surface::request::{EnergyWeights, Options, Solver, Tolerance};
    let each = o.tolerances.clone().map(Tolerance::Each);
    Request::Surface(surface::Request {
        points,
        options: Options {
            tolerance: each.or(o.tolerance.map(Tolerance::Same)),
            stiffness: o.stiffness.clone(),
            locked: o.locked.iter().map(|i| i.0).collect(),
            freedom: o.freedom.axes(),
            energy: o.surface_energy.map(|e| EnergyWeights {
                alpha11: e.alpha11,
                alpha22: e.alpha22,
                beta11: e.beta11,
                beta12: e.beta12,
                beta22: e.beta22,
            }),
            boundary_factor: o.boundary_factor,
            control_points: o.control_net.map(|n| n.numbers()),
            knuckles: [&o.knuckle_rows, &o.knuckle_columns].map(|k| indices(k)),
            cut: o.cut.map(Into::into),
            robust: o.robust,
            solver: match o.solver {
                FairingSolver::Own => Solver::Own,
                FairingSolver::Paper => Solver::Paper,
            },
            light: light(o),
        },
    })
}

fn indices(list: &[Index]) -> Vec<usize> {
    list.iter().map(|i| i.0).collect()
}

fn light(o: &FairingOptions) -> Vector3<f64> {
    let usual = surface::request::Options::default().light;
    o.light.map_or(usual, |l| Vector3::from(l.0))
}

/// One name a line.
fn check_names(table: &OffsetTable, faults: &mut Vec<FieldError>) {
    let families = [
        ("station", &table.station_names, table.stations.len()),
        ("waterline", &table.waterline_names, table.waterlines.len()),
    ];
    for (family, names, lines) in families {
        if let Some(names) = names.as_ref().filter(|n| n.len() != lines) {
            let message = format!("{} names for {lines} {family}s", names.len());
            let place = format!("/input/offsets/{family}_names");
            faults.push(FieldError::new(place, "wrong-count", message));
        }
    }
}

fn offsets_request(table: &OffsetTable, o: &FairingOptions) -> Request {
    let tolerances = o.cell_tolerances.iter();
    Request::Offsets(offsets::Request {
        stations: table.stations.clone(),
        waterlines: table.waterlines.clone(),
        half_breadths: table.y.clone(),
        options: offsets::request::Options {
            tolerance: o.tolerance,
            cell_tolerances: tolerances
                .map(|c| (c.station.0, c.waterline.0, c.tolerance))
                .collect(),
            locked: o.locked_cells.iter().map(|c| c.numbers()).collect(),
            knuckle_stations: indices(&o.knuckle_stations),
            knuckle_waterlines: indices(&o.knuckle_waterlines),
            robust: o.robust,
            buttocks: o.buttocks.clone(),
            light: light(o),
        },
    })
}

fn to_grid(grid: &[Vec<Option<Point>>]) -> Vec<Vec<Option<Point3<f64>>>> {
    let row = |row: &Vec<Option<Point>>| row.iter().map(|c| c.map(Into::into)).collect();
    grid.iter().map(row).collect()
}

fn check_grid(grid: &[Vec<Option<Point>>], units: Units, faults: &mut Vec<FieldError>) {
    for (r, row) in grid.iter().enumerate() {
        for (c, point) in row.iter().enumerate() {
            let mut inner = Vec::new();
            check_points(point.as_slice(), "", units, &mut inner);
            faults.extend(inner.into_iter().map(|mut fault| {
                // The place of one point: "/0/axis".
                fault.pointer = format!("/input/grid/{r}/{c}{}", &fault.pointer[2..]);
                fault
            }));
        }
    }
}
