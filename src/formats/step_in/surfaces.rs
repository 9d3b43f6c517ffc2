//! From entities to surfaces: ISO 10303-42, 10303-41 for the unit.

use super::clamp::clamped;
use super::error::{StepFault, StepReadError};
use super::part21::{Entity, Record, Value};
use super::{StepReading, StepSurface};
use crate::geometry::{BSplineSurface, CurveIndex};
use nalgebra::Point3;
use std::collections::BTreeMap;

type Entities = BTreeMap<u64, Entity>;

const SURFACE: &str = "B_SPLINE_SURFACE_WITH_KNOTS";
const FACES: [&str; 2] = ["ADVANCED_FACE", "FACE_SURFACE"];
/// Corners of a face no further from the sides of its surface than this, of
/// its longest side, lie on them.
const ON_SIDE: f64 = 1e-4;
/// References from a face to the points of its corners, at most.
const FURTHEST_UNIT: usize = 8;

/// The surfaces of a file.
pub(super) fn collect(entities: &Entities) -> Result<StepReading, StepReadError> {
    let file = File { entities };
    let mut surfaces = Vec::new();
    let mut left_out: BTreeMap<String, usize> = BTreeMap::new();
    let has = |keyword: &str| entities.values().any(|e| e.record(keyword).is_some());
    for (number, entity) in entities {
        let face = FACES.iter().find_map(|f| entity.record(f));
        let Some(face) = face else { continue };
        let geometry = file.reference(*number, face, 2, "its surface")?;
        let basis = file.entity(geometry, entity.line)?;
        if basis.record(SURFACE).is_none() {
            let kind = basis.records.first().map_or("", |r| &r.keyword);
            *left_out.entry(kind.to_owned()).or_default() += 1;
            continue;
        }
        let surface = file.surface(geometry, basis)?;
        let is_trimmed = file.is_trimmed(*number, face, &surface)?;
        let name = name(face).or_else(|| basis.records.iter().find_map(name));
        surfaces.push(StepSurface {
            name,
            surface,
            is_trimmed,
        });
    }
    if surfaces.is_empty() && left_out.is_empty() {
        // A file without faces: bare surfaces.
        for (number, entity) in entities.iter().filter(|(_, e)| e.record(SURFACE).is_some()) {
            surfaces.push(StepSurface {
                name: entity.records.iter().find_map(name),
                surface: file.surface(*number, entity)?,
                is_trimmed: false,
            });
        }
    }
    if surfaces.is_empty() {
        return Err(StepReadError::new(1, "", StepFault::NoSurfaces));
    }
    Ok(StepReading {
        metres: file.unit()?,
        surfaces,
        left_out: left_out.into_iter().collect(),
        is_assembly: has("ITEM_DEFINED_TRANSFORMATION") || has("MAPPED_ITEM"),
    })
}

/// The name of an entity, where it has one.
fn name(record: &Record) -> Option<String> {
    let named = [
        "ADVANCED_FACE",
        "FACE_SURFACE",
        SURFACE,
        "REPRESENTATION_ITEM",
    ];
    match record.parameters.first() {
        Some(Value::Text(text)) if named.contains(&record.keyword.as_str()) => {
            let text = text.trim();
            (!text.is_empty() && text != "NONE").then(|| text.to_owned())
        }
        _ => None,
    }
}

struct File<'a> {
    entities: &'a Entities,
}

impl<'a> File<'a> {
    fn entity(&self, number: u64, line: usize) -> Result<&'a Entity, StepReadError> {
        let found = self.entities.get(&number);
        found.ok_or_else(|| StepReadError::new(line, "", StepFault::Missing(number)))
    }

    /// The line of an entity, for errors.
    fn line(&self, number: u64) -> usize {
        self.entities.get(&number).map_or(1, |e| e.line)
    }

    fn lacks(&self, entity: u64, wanted: &'static str) -> StepReadError {
        let fault = StepFault::Parameter { entity, wanted };
        StepReadError::new(self.line(entity), "", fault)
    }

    /// A parameter that refers to an entity.
    fn reference(
        &self,
        entity: u64,
        record: &Record,
        place: usize,
        wanted: &'static str,
    ) -> Result<u64, StepReadError> {
        match record.parameters.get(place) {
            Some(Value::Reference(number)) => Ok(*number),
            _ => Err(self.lacks(entity, wanted)),
        }
    }

    /// The record of a kind that an entity has to be.
    fn record(
        &self,
        number: u64,
        keyword: &'static str,
        line: usize,
    ) -> Result<&'a Record, StepReadError> {
        let entity = self.entity(number, line)?;
        let fault = StepFault::Kind {
            entity: number,
            wanted: keyword,
        };
        let record = entity.record(keyword);
        record.ok_or_else(|| StepReadError::new(entity.line, "", fault))
    }

    /// A B-spline surface, simple or rational.
    fn surface(&self, number: u64, entity: &'a Entity) -> Result<BSplineSurface, StepReadError> {
        let lacks = |wanted| self.lacks(number, wanted);
        let own = entity.record(SURFACE).ok_or_else(|| lacks("its knots"))?;
        // A simple entity has all in one record, after its name; a complex one
        // has degrees and poles in a record of their own.
        let (shape, knots) = match entity.record("B_SPLINE_SURFACE") {
            Some(base) => (&base.parameters[..], &own.parameters[..]),
            None if own.parameters.len() >= 13 => (&own.parameters[1..8], &own.parameters[8..]),
            None => return Err(lacks("13 parameters")),
        };
        let degree = |place: usize| match shape.get(place) {
            Some(Value::Number(n)) if n.fract() == 0.0 && (1.0..=1e3).contains(n) => {
                Ok(*n as usize)
            }
            _ => Err(lacks("a degree")),
        };
        let degrees = [degree(0)?, degree(1)?];
        let Some(Value::List(rows)) = shape.get(2) else {
            return Err(lacks("its poles"));
        };
        let mut poles = Vec::new();
        let mut columns = None;
        for row in rows {
            let Value::List(row) = row else {
                return Err(lacks("its poles"));
            };
            if *columns.get_or_insert(row.len()) != row.len() {
                return Err(lacks("rows of poles of one length"));
            }
            for pole in row {
                poles.push(self.point(number, pole)?);
            }
        }
        let counts = |place: usize| knots.get(place).and_then(numbers);
        let (Some(u), Some(v), Some(u_values), Some(v_values)) =
            (counts(0), counts(1), counts(2), counts(3))
        else {
            return Err(lacks("its knots"));
        };
        let knots = [
            written_out(&u, &u_values).ok_or_else(|| lacks("a multiplicity for each knot in u"))?,
            written_out(&v, &v_values).ok_or_else(|| lacks("a multiplicity for each knot in v"))?,
        ];
        let weights = match entity.record("RATIONAL_B_SPLINE_SURFACE") {
            None => None,
            Some(rational) => {
                let Some(Value::List(rows)) = rational.parameters.first() else {
                    return Err(lacks("its weights"));
                };
                let rows: Option<Vec<Vec<f64>>> = rows.iter().map(numbers).collect();
                Some(rows.ok_or_else(|| lacks("its weights"))?.concat())
            }
        };
        // Weights that are all one are those of a polynomial surface.
        let weights = weights.filter(|w| w.iter().any(|w| *w != 1.0) || w.len() != poles.len());
        let spline = match clamped(degrees, &knots, &poles, weights.as_deref()) {
            Some(c) => BSplineSurface::new(degrees, c.knots, c.poles, c.weights),
            None => BSplineSurface::new(degrees, knots, poles, weights),
        };
        spline.map_err(|e| StepReadError::new(entity.line, "", StepFault::Spline(e)))
    }

    fn point(&self, by: u64, value: &Value) -> Result<Point3<f64>, StepReadError> {
        let Value::Reference(number) = value else {
            return Err(self.lacks(by, "a point"));
        };
        let record = self.record(*number, "CARTESIAN_POINT", self.line(by))?;
        let place = record.parameters.iter().find_map(numbers);
        match place.as_deref() {
            Some([x, y, z]) => Ok(Point3::new(*x, *y, *z)),
            _ => Err(self.lacks(*number, "three coordinates")),
        }
    }

    /// Whether a face is only a part of its surface: it has holes, a corner
    /// that is on none of the four sides, or none where the surface has one.
    fn is_trimmed(
        &self,
        number: u64,
        face: &Record,
        surface: &BSplineSurface,
    ) -> Result<bool, StepReadError> {
        let Some(Value::List(bounds)) = face.parameters.get(1) else {
            return Err(self.lacks(number, "its bounds"));
        };
        if bounds.len() > 1 {
            return Ok(true);
        }
        let tolerance = ON_SIDE * surface.bounding_box().longest_side();
        let sides = surface.boundary_curves();
        let sides: Vec<CurveIndex> = sides.iter().map(CurveIndex::new).collect();
        let corners = self.corners(bounds);
        let is_inside = |p: &Point3<f64>| {
            let nearest = sides.iter().map(|side| side.closest(p).distance);
            nearest.fold(f64::INFINITY, f64::min) > tolerance
        };
        let [n, m] = surface.counts();
        let poles = surface.control_points();
        let is_missed = |k: usize| {
            let distances = corners.iter().map(|c| (c - poles[k]).norm());
            distances.fold(f64::INFINITY, f64::min) > tolerance
        };
        // Of a face without corners that could be followed nothing is known.
        let misses = !corners.is_empty()
            && [0, m - 1, (n - 1) * m, n * m - 1]
                .into_iter()
                .any(is_missed);
        Ok(misses || corners.iter().any(is_inside))
    }

    /// The ends of all edges of some bounds, as far as they can be followed.
    fn corners(&self, bounds: &[Value]) -> Vec<Point3<f64>> {
        let follow = |value: &Value, keywords: &[&str], place: usize| -> Option<&'a Value> {
            let Value::Reference(number) = value else {
                return None;
            };
            let entity = self.entities.get(number)?;
            let record = keywords.iter().find_map(|k| entity.record(k))?;
            record.parameters.get(place)
        };
        let list = |value: Option<&'a Value>| match value {
            Some(Value::List(list)) => list.as_slice(),
            _ => &[],
        };
        let mut corners = Vec::new();
        for bound in bounds {
            let edge_loop = follow(bound, &["FACE_OUTER_BOUND", "FACE_BOUND"], 1);
            let edges = edge_loop.and_then(|l| follow(l, &["EDGE_LOOP"], 1));
            for oriented in list(edges) {
                let Some(edge) = follow(oriented, &["ORIENTED_EDGE"], 3) else {
                    continue;
                };
                for end in [1, 2] {
                    let vertex = follow(edge, &["EDGE_CURVE"], end);
                    let point = vertex.and_then(|v| follow(v, &["VERTEX_POINT"], 1));
                    corners.extend(point.and_then(|p| self.point(0, p).ok()));
                }
            }
        }
        corners
    }

    /// Metres in the unit of length of all contexts.
    fn unit(&self) -> Result<f64, StepReadError> {
        let mut found: Option<f64> = None;
        for (number, entity) in self.entities {
            let Some(context) = entity.record("GLOBAL_UNIT_ASSIGNED_CONTEXT") else {
                continue;
            };
            let Some(Value::List(units)) = context.parameters.first() else {
                return Err(self.lacks(*number, "its units"));
            };
            for unit in units {
                let Value::Reference(unit) = unit else {
                    continue;
                };
                let Some(metres) = self.metres(*unit, FURTHEST_UNIT)? else {
                    continue;
                };
                let is_another = found.is_some_and(|f| (f - metres).abs() > 1e-9 * f);
                if is_another {
                    return Err(StepReadError::new(entity.line, "", StepFault::TwoUnits));
                }
                found = Some(metres);
            }
        }
        found.ok_or_else(|| StepReadError::new(1, "", StepFault::NoUnit))
    }

    /// Metres in a unit; `None` for one that is not of length.
    fn metres(&self, number: u64, left: usize) -> Result<Option<f64>, StepReadError> {
        let entity = self.entity(number, 1)?;
        if left == 0 || entity.record("LENGTH_UNIT").is_none() {
            return Ok(None);
        }
        if let Some(si) = entity.record("SI_UNIT") {
            return match (si.parameters.first(), si.parameters.get(1)) {
                (Some(Value::Nothing), Some(Value::Word(unit))) if unit == "METRE" => Ok(Some(1.0)),
                (Some(Value::Word(prefix)), Some(Value::Word(unit))) if unit == "METRE" => {
                    let known = PREFIXES.iter().find(|(name, _)| name == prefix);
                    let known = known.ok_or_else(|| self.lacks(number, "a known prefix"))?;
                    Ok(Some(known.1))
                }
                _ => Err(self.lacks(number, "the metre")),
            };
        }
        let conversion = entity.record("CONVERSION_BASED_UNIT");
        let conversion = conversion.ok_or_else(|| self.lacks(number, "its size"))?;
        let measure = self.reference(number, conversion, 1, "its size")?;
        let sized = self.entity(measure, entity.line)?;
        let keywords = ["LENGTH_MEASURE_WITH_UNIT", "MEASURE_WITH_UNIT"];
        let record = keywords.iter().find_map(|k| sized.record(k));
        let record = record.ok_or_else(|| self.lacks(measure, "a measure"))?;
        let factor = match record.parameters.first() {
            Some(Value::Typed(_, list)) => match list.first() {
                Some(Value::Number(x)) => Some(*x),
                _ => None,
            },
            Some(Value::Number(x)) => Some(*x),
            _ => None,
        };
        let factor = factor.filter(|x| *x > 0.0);
        let factor = factor.ok_or_else(|| self.lacks(measure, "a positive number"))?;
        let base = self.reference(measure, record, 1, "its unit")?;
        Ok(self.metres(base, left - 1)?.map(|metres| metres * factor))
    }
}

/// Prefixes of SI that a length in CAD has.
const PREFIXES: [(&str, f64); 8] = [
    ("KILO", 1e3),
    ("HECTO", 1e2),
    ("DECA", 1e1),
    ("DECI", 1e-1),
    ("CENTI", 1e-2),
    ("MILLI", 1e-3),
    ("MICRO", 1e-6),
    ("NANO", 1e-9),
];

/// A list of numbers.
fn numbers(value: &Value) -> Option<Vec<f64>> {
    let Value::List(list) = value else {
        return None;
    };
    let number = |v: &Value| match v {
        Value::Number(x) => Some(*x),
        _ => None,
    };
    list.iter().map(number).collect()
}

/// More knots than this are no surface that can be measured.
const MOST_KNOTS: f64 = 1e5;

/// Knots with their multiplicities written out.
fn written_out(counts: &[f64], values: &[f64]) -> Option<Vec<f64>> {
    let total: f64 = counts.iter().sum();
    let are_counts = counts.iter().all(|c| c.fract() == 0.0 && *c >= 1.0) && total <= MOST_KNOTS;
    (are_counts && counts.len() == values.len()).then(|| {
        let repeated = counts.iter().zip(values);
        repeated
            .flat_map(|(count, value)| std::iter::repeat_n(*value, *count as usize))
            .collect()
    })
}
