//! `fairing` as the HTTP layer knows it.

use super::file::input_for_file;
use super::{Document, Fitted, Format, Header, Job, Method, Schemas, Words, misread};
use crate::formats::points_in::{self, Fault, Orientation, ReadError, Ruler};
use crate::http::dto::Point;
use crate::http::dto::fairing::{
    FairingInput, FairingOptions, FairingResult, FileHolds, FilePlaces, OffsetTable, TableLayout,
    TableRows, to_request,
};
use crate::http::dto::job::{FairingJob, Normalized};
use crate::http::problem::{ApiError, Code, FieldError};
use crate::http::schema_check::Rule;
use crate::http::upload::File;
use crate::methods::fairing::{self, Request};
use crate::methods::{Control, FitError, Issue};
use nalgebra::Point3;
use serde_json::Value;
use std::sync::LazyLock;

const WORDS: Words = Words {
    summary: "The fairest curve or surface within a tolerance of measured points.",
    description: "Offsets that were measured, or lifted from a drawing, carry errors. The shape \
        is the B-spline whose curvature changes least while no point moves farther than its \
        tolerance; without a tolerance the noise is estimated from the points and the shape \
        follows them as nearly as that allows. Points of a curve or a sheet, in order or not, \
        grids with gaps, and tables of offsets, which are faired as one surface. Points that \
        look like slips are named with the value that the fair shape would have there.",
    source: "After Jing, Xi & Tang 1998, whose formulation is the solver `paper`.",
    lengths: &["tolerance", "tolerances", "buttocks", "cell_tolerances"],
    gifts: &[
        ("verdict", "within_limits: every point keeps its tolerance"),
        ("summary", "Sentences, the verdict first"),
        (
            "curves",
            "The fair curve; of a table its stations, waterlines and buttocks",
        ),
        ("surfaces", "The fair surface, control points [u][v]"),
        (
            "method_specific.moves",
            "Every point: old, new, move, what it holds the shape back",
        ),
        (
            "method_specific.table",
            "The table of offsets: old, new, move of every cell",
        ),
        (
            "method_specific.slips",
            "Suspected slips with the value to expect",
        ),
        (
            "method_specific.trade_off",
            "What other tolerances would give",
        ),
        ("method_specific.comb", "The curvature comb of a curve"),
        (
            "method_specific.outline",
            "Where a surface has data, in (u, v)",
        ),
        ("method_specific.isophotes", "Data for an isophote plot"),
        ("diagnostics", "Noise, moves, fairness before and after"),
    ],
};

static RULE: LazyLock<Result<Rule, String>> = LazyLock::new(super::rule_of::<FairingJob>);

/// The method.
#[derive(Debug)]
pub struct Fairing;

impl Method for Fairing {
    fn name(&self) -> &'static str {
        "fairing"
    }

    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn schemas(&self) -> Schemas {
        Schemas::of::<FairingInput, FairingOptions>()
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
            Format::Zip,
        ]
    }

    fn rule(&self) -> Result<&'static Rule, &'static String> {
        RULE.as_ref()
    }

    fn read(&self, value: Value) -> Result<Box<dyn Job>, Vec<FieldError>> {
        let job: FairingJob = serde_json::from_value(value).map_err(misread)?;
        let request = to_request(&job.input, &job.options, job.units)?;
        Ok(Box::new(ReadJob { job, request }))
    }

    fn take_file(&self, job: &mut Value, file: &File) -> Result<Vec<String>, ApiError> {
        take_file(job, file).map_err(|fault| ApiError::at(Code::InvalidJob, vec![fault]))
    }

    fn open(&self, result: &[u8]) -> Result<Box<dyn Document>, ApiError> {
        super::read_back::<FairingResult>(result)
    }
}

/// Puts the file's points or table in the place of `input.file`.
fn take_file(job: &mut Value, file: &File) -> Result<Vec<String>, FieldError> {
    let input = input_for_file(job, &["points", "grid", "offsets"])?;
    let holds = input.remove("file").unwrap_or_else(|| "points".into());
    let holds: FileHolds = serde_json::from_value(holds).map_err(|_| {
        let message = "this must be one of points, offsets, offsets_transposed";
        FieldError::new("/input/file", "not-one-of", message)
    })?;
    let places = input.remove("file_places");
    let reading = match holds {
        FileHolds::Points if places.is_some() => {
            let message = "\"file_places\" goes with a file of offsets";
            return Err(FieldError::new("/input/file_places", "unexpected", message));
        }
        FileHolds::Points => points_in::read(&file.bytes, points_in::Expected::Points),
        FileHolds::Offsets | FileHolds::OffsetsTransposed => {
            let orientation = match holds {
                FileHolds::OffsetsTransposed => Orientation::StationsAcross,
                _ => Orientation::WaterlinesAcross,
            };
            points_in::read_table(&file.bytes, orientation, &rulers(places)?)
        }
    };
    let reading = reading.map_err(|e| unreadable(e, holds))?;
    match reading.contents {
        points_in::Contents::Points(list) => {
            input.insert("points".into(), point_list(&list)?);
        }
        points_in::Contents::Offsets(table) => {
            let (table, layout) = ascending(table);
            let table = OffsetTable {
                stations: table.stations,
                waterlines: table.waterlines,
                y: table.half_breadths,
                station_names: table.station_names,
                waterline_names: table.waterline_names,
            };
            if !layout.is_usual() {
                input.insert("table_layout".into(), serde_json::json!(layout));
            }
            input.insert("offsets".into(), serde_json::json!(table));
        }
    }
    Ok(vec![format!("{}: {}", file.name, reading.how.sentence())])
}

/// Where the caller says that named lines are.
fn rulers(places: Option<Value>) -> Result<points_in::Places, FieldError> {
    let fault = |message: String| FieldError::new("/input/file_places", "bad-places", message);
    let Some(places) = places else {
        return Ok(points_in::Places::default());
    };
    let places: FilePlaces = serde_json::from_value(places).map_err(|e| fault(e.to_string()))?;
    let ruler = |list: Option<Vec<f64>>, spacing: Option<f64>, what: &str| match (list, spacing) {
        (Some(_), Some(_)) => Err(fault(format!(
            "the {what}s have a list and a spacing; one is enough"
        ))),
        (Some(list), None) => Ok(Ruler::Listed(list)),
        (None, Some(s)) if s.is_finite() && s > 0.0 => Ok(Ruler::Spaced(s)),
        (None, Some(s)) => Err(fault(format!("the {what} spacing {s} is not above 0"))),
        (None, None) => Ok(Ruler::Written),
    };
    Ok(points_in::Places {
        stations: ruler(places.stations, places.station_spacing, "station")?,
        waterlines: ruler(places.waterlines, places.waterline_spacing, "waterline")?,
    })
}

/// Where a file could not be read, and what to do about it.
fn unreadable(e: ReadError, holds: FileHolds) -> FieldError {
    let place = match e.column {
        Some(column) => format!("file, line {}, column {column}", e.line),
        None => format!("file, line {}", e.line),
    };
    let of_a_place = match e.fault {
        Fault::NamesWithoutPlaces | Fault::MissingPlace => true,
        Fault::NotANumber | Fault::Fraction => e.column == Some(1) || e.line == 1,
        _ => false,
    };
    let hint = if of_a_place && holds != FileHolds::Points {
        format!("{} {GIVE_PLACES}", e.hint())
    } else {
        e.hint().to_owned()
    };
    FieldError::new(place, "unreadable", e.sentence())
        .hint(hint)
        .value(e.found)
}

/// What to do about names in a table.
const GIVE_PLACES: &str = "Where stations or waterlines have names, give their places with the \
    job, \"file_places\": {\"stations\": [...]} or {\"station_spacing\": ...}, or in the file in a \
    row or column headed x, z or position.";

/// A table that runs from the bow aft, or from the top down, turned round;
/// and how it came.
fn ascending(mut table: points_in::OffsetTable) -> (points_in::OffsetTable, TableLayout) {
    let falls = |v: &[f64]| v.windows(2).all(|p| p[1] < p[0]);
    let layout = TableLayout {
        rows: match table.orientation {
            Orientation::WaterlinesAcross => TableRows::Stations,
            Orientation::StationsAcross => TableRows::Waterlines,
        },
        stations_falling: falls(&table.stations),
        waterlines_falling: falls(&table.waterlines),
    };
    let turn = |names: &mut Option<Vec<String>>| names.iter_mut().for_each(|n| n.reverse());
    if layout.stations_falling {
        table.stations.reverse();
        table.half_breadths.reverse();
        turn(&mut table.station_names);
    }
    if layout.waterlines_falling {
        table.waterlines.reverse();
        table.half_breadths.iter_mut().for_each(|row| row.reverse());
        turn(&mut table.waterline_names);
    }
    (table, layout)
}

fn point_list(list: &points_in::PointList) -> Result<Value, FieldError> {
    let dimension = list.coordinates.len();
    let row = |(row, line): (&[Option<f64>; 3], &usize)| {
        let numbers: Option<Vec<f64>> = row[..dimension].iter().copied().collect();
        numbers.map(Value::from).ok_or_else(|| {
            let place = format!("file, line {line}");
            let message = "a coordinate of this point is missing";
            FieldError::new(place, "missing", message)
                .hint("leave the whole line out if the point was not measured")
        })
    };
    let rows = list.rows.iter().zip(&list.lines).map(row);
    Ok(Value::Array(rows.collect::<Result<_, _>>()?))
}

/// A job that was read.
#[derive(Debug)]
struct ReadJob {
    job: FairingJob,
    request: Request,
}

impl Job for ReadJob {
    fn method(&self) -> &'static str {
        Fairing.name()
    }

    fn header(&self) -> Header<'_> {
        Header {
            label: self.job.label.as_deref(),
            budget: self.job.budget,
        }
    }

    fn warnings(&self) -> Result<Vec<String>, FitError> {
        let issues = fairing::validate(&self.request);
        if issues.is_empty() {
            Ok(Vec::new())
        } else {
            Err(FitError::Invalid(self.renamed(issues)))
        }
    }

    fn normalized(&self) -> Normalized {
        let points = points(&self.request);
        let mut counts = vec![("points", points.len())];
        if let Some(table) = &self.job.input.offsets {
            counts.push(("stations", table.stations.len()));
            counts.push(("waterlines", table.waterlines.len()));
        }
        if let Some(grid) = &self.job.input.grid {
            counts.push(("rows", grid.len()));
            counts.push(("columns", grid.first().map_or(0, Vec::len)));
        }
        Normalized::new(&points, self.job.units, &counts)
    }

    fn fit(&self, input_sha256: String, control: &dyn Control) -> Result<Fitted, FitError> {
        let outcome = fairing::fit(&self.request, control).map_err(|error| match error {
            FitError::Invalid(issues) => FitError::Invalid(self.renamed(issues)),
            other => other,
        })?;
        let document = FairingResult::new(&self.job, &self.request, &outcome, input_sha256);
        Fitted::of(&document)
    }
}

impl ReadJob {
    /// Issues with the places that they have in the job: one field of the wire
    /// can be two of the method, by the kind of input.
    fn renamed(&self, mut issues: Vec<Issue>) -> Vec<Issue> {
        let names: &[(&str, &str)] = match &self.request {
            Request::Curve(_) => &[],
            Request::Surface(_) if self.job.options.tolerances.is_some() => &[
                ("tolerance", "tolerances"),
                ("energy", "surface_energy"),
                ("control_points", "control_net"),
            ],
            Request::Surface(_) => &[
                ("energy", "surface_energy"),
                ("control_points", "control_net"),
            ],
            Request::Offsets(_) => &[("locked", "locked_cells")],
        };
        for issue in &mut issues {
            if let [first, second, ..] = issue.path.as_mut_slice()
                && first == "options"
                && let Some((_, name)) = names.iter().find(|(method, _)| method == second)
            {
                *second = (*name).to_owned();
            }
        }
        issues
    }
}

/// All given points, in the plane with z = 0.
fn points(request: &Request) -> Vec<Point> {
    use crate::methods::fairing::surface::request::Points;
    match request {
        Request::Curve(r) => r.points.iter().map(|p| (*p).into()).collect(),
        Request::Surface(r) => match &r.points {
            Points::Scattered(points) => points.iter().map(|p| (*p).into()).collect(),
            Points::Grid(rows) => {
                let measured = rows.iter().flatten().flatten();
                measured.map(|p| (*p).into()).collect()
            }
        },
        Request::Offsets(r) => {
            let rows = r.stations.iter().zip(&r.half_breadths);
            let cells = rows.flat_map(|(x, row)| {
                let cells = row.iter().zip(&r.waterlines);
                cells.filter_map(move |(y, z)| Some(Point3::new(*x, (*y)?, *z)))
            });
            cells.map(Into::into).collect()
        }
    }
}
