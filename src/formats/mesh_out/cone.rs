//! The mesh of a strip of cones: its patches with their distance from the
//! strip, rulings, sides.

use super::build::Heading;
use super::{MeshDrawing, Quantity, QuantityKind};
use crate::formats::cones::ConeSplineDrawing;
use crate::formats::length_unit::LengthUnit;
use nalgebra::Point3;
use std::collections::BTreeMap;

/// Places on a patch in rows along its rulings.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConeGrid {
    /// Places in a row, from side 0 to side 1.
    pub across: usize,
    /// The places, row after row, the first row on the first ruling.
    pub points: Vec<Point3<f64>>,
    /// Signed distance of each from the strip.
    pub distances: Vec<f64>,
}

/// Places nearer than this share of the largest coordinate are one.
const WELD: f64 = 1e-11;

impl MeshDrawing {
    /// A strip, whose lengths are in `units`; `tolerance` is the largest
    /// distance that was asked for. Neighbours share the vertices of their
    /// ruling.
    #[must_use]
    pub fn of_cones(strip: &ConeSplineDrawing, units: LengthUnit, tolerance: Option<f64>) -> Self {
        let heading = Heading {
            title: &strip.title,
            units,
            verdict: &strip.verdict,
        };
        let mut drawing = heading.begin(Some(Quantity {
            name: "distance".to_owned(),
            kind: QuantityKind::Length,
            limit: tolerance,
        }));
        let coordinates = strip.sheets.iter().flat_map(|s| &s.grid.points);
        let size = coordinates.fold(0.0, |most: f64, p| most.max(p.coords.amax()));
        let mut weld = Weld {
            step: WELD * size,
            places: BTreeMap::new(),
        };
        for sheet in &strip.sheets {
            let grid = &sheet.grid;
            let mut values = BTreeMap::new();
            let mut numbers = Vec::with_capacity(grid.points.len());
            for (point, distance) in grid.points.iter().zip(&grid.distances) {
                let number = weld.number(point, &mut drawing.vertices);
                values.entry(number).or_insert(*distance);
                numbers.push(number);
            }
            let triangles = triangles(&numbers, grid.across, &drawing.vertices);
            drawing.add_part(&sheet.name, &triangles, |v| values.get(&v).copied());
        }
        // The first and the last run past the strip where its ends are cut
        // askew.
        let inner = 1..strip.rulings.len().saturating_sub(1).max(1);
        let rulings = strip.rulings.get(inner).unwrap_or_default();
        drawing.add_lines("rulings", None, rulings.iter().map(|r| r.ends.to_vec()));
        for (index, sheet) in strip.sheets.iter().enumerate() {
            let name = format!("sides of {}", sheet.name);
            drawing.add_lines(&name, Some(index), sheet.sides.clone());
        }
        drawing
    }
}

/// Vertices by their rounded place.
struct Weld {
    step: f64,
    places: BTreeMap<[i64; 3], usize>,
}

impl Weld {
    /// The number of the vertex at a place, new or not.
    fn number(&mut self, point: &Point3<f64>, vertices: &mut Vec<Point3<f64>>) -> usize {
        // A place near the border of a cell may be rounded to either side of
        // it: both neighbours are looked at.
        let cell = |shift: f64| {
            let of = |c: &f64| {
                if self.step > 0.0 {
                    (c / self.step + shift).floor() as i64
                } else {
                    0
                }
            };
            [of(&point.x), of(&point.y), of(&point.z)]
        };
        let cells = [cell(0.25), cell(0.75)];
        let known = cells.iter().find_map(|c| self.places.get(c)).copied();
        let number = known.unwrap_or_else(|| {
            vertices.push(*point);
            vertices.len() - 1
        });
        for cell in cells {
            self.places.entry(cell).or_insert(number);
        }
        number
    }
}

/// Two triangles a cell, along the shorter diagonal; r × t is up, with r from
/// side 0 to side 1 and t along the strip. Cells that shrink to a line or a
/// point give fewer.
fn triangles(numbers: &[usize], across: usize, vertices: &[Point3<f64>]) -> Vec<[usize; 3]> {
    let rows: Vec<&[usize]> = numbers.chunks_exact(across.max(1)).collect();
    let apart = |a: usize, b: usize| (vertices[a] - vertices[b]).norm_squared();
    let mut triangles = Vec::new();
    for pair in rows.windows(2) {
        for k in 0..across.saturating_sub(1) {
            let [a, b, c, d] = [pair[0][k], pair[0][k + 1], pair[1][k + 1], pair[1][k]];
            triangles.extend(if apart(a, c) <= apart(b, d) {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            });
        }
    }
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::cones::{ConeSheet, EndRuling};

    /// A plane patch between two rulings, `rows` of three places each; the
    /// last row of a `pointed` one is a point.
    fn sheet(name: &str, [from, to]: [f64; 2], rows: u32, pointed: bool) -> ConeSheet {
        let place = |i: u32, k: u32| {
            let share = f64::from(i) / f64::from(rows - 1);
            let width = if pointed { 1.0 - share } else { 1.0 };
            let x = from + (to - from) * share;
            Point3::new(x, 1.0 - width * f64::from(k) / 2.0, 0.0)
        };
        let places = || (0..rows).flat_map(|i| (0..3).map(move |k| (i, k)));
        ConeSheet {
            name: name.into(),
            kind: "plane",
            apex: None,
            axis: None,
            half_angle_deg: None,
            radius: None,
            slant_range: [0.0, 1.0],
            end_radii: None,
            turn_deg: 0.0,
            min_bend_radius: None,
            bend_strain_percent: None,
            bend_side: None,
            sides: [0, 2].map(|k| vec![place(0, k), place(rows - 1, k)]),
            grid: ConeGrid {
                across: 3,
                points: places().map(|(i, k)| place(i, k)).collect(),
                distances: places().map(|(i, k)| f64::from(i) - f64::from(k)).collect(),
            },
            area: 1.0,
            errors: [0.0; 2],
        }
    }

    #[test]
    fn patches_share_their_ruling_and_shrink_to_a_corner() {
        let strip = ConeSplineDrawing {
            title: "t".into(),
            units: "m".into(),
            verdict: "within_limits".into(),
            sheets: vec![
                sheet("1", [0.0, 2.0], 4, false),
                sheet("2", [2.0, 4.0], 3, true),
            ],
            rulings: [0.0, 2.0, 4.0]
                .map(|x| EndRuling {
                    id: 0,
                    ends: [Point3::new(x, 1.0, 0.0), Point3::new(x, 0.0, 0.0)],
                    flat: [nalgebra::Point2::origin(); 2],
                })
                .to_vec(),
        };
        let mesh = MeshDrawing::of_cones(&strip, LengthUnit::Metre, Some(0.1));
        // 4 rows of 3; one more row of 3, and the corner.
        assert_eq!(mesh.vertices.len(), 12 + 3 + 1);
        let mut area = 0.0;
        for part in &mesh.parts {
            assert_eq!(part.values.len(), part.corners.len());
            for triangle in &part.triangles {
                let [a, b, c] = triangle.map(|i| mesh.vertices[part.corners[i]]);
                let up = (b - a).cross(&(c - a)).z;
                assert!(up > 0.0);
                area += up / 2.0;
            }
        }
        assert!((area - 3.0).abs() < 1e-12, "{area}");
        assert_eq!(mesh.quantity.unwrap().limit, Some(0.1));
        let names: Vec<_> = mesh.lines.iter().map(|g| g.name.as_str()).collect();
        assert_eq!(names, ["rulings", "sides of 1", "sides of 2"]);
        assert_eq!(mesh.lines[0].lines.len(), 1, "where the two meet");
    }
}
