use super::*;
use crate::methods::cone_spline::outcome::{BendSide, FlatSector, Kind};
use nalgebra::Vector3;
use std::f64::consts::PI;

const WIDTH: f64 = 0.3;

/// A chain that begins at the origin, with these strains and lengths.
fn chain(patches: &[(f64, f64, f64)]) -> Chain {
    Chain {
        root: Frame {
            point: Point3::origin(),
            ruling: Vector3::y(),
            normal: -Vector3::z(),
        },
        middle: 0,
        strains: patches
            .iter()
            .map(|(g, k, _)| Strain { g: *g, k: *k })
            .collect(),
        reach: patches.iter().map(|(_, _, s)| [0.0, *s]).collect(),
        slides: vec![0.0; patches.len() - 1],
    }
}

/// A strip of constant width along a chain, whose outline is sampled at
/// `samples` rulings a patch.
fn strip(chain: &Chain, samples: usize) -> Target {
    let mut sides = [Vec::new(), Vec::new()];
    for (i, frame) in chain.frames().iter().enumerate() {
        for j in usize::from(i > 0)..=samples {
            let s = chain.reach[i][1] * j as f64 / samples as f64;
            let there = frame.carried(chain.strains[i], s);
            sides[0].push(there.at(-WIDTH));
            sides[1].push(there.at(WIDTH));
        }
    }
    let last = sides[0].len() - 1;
    let ends = [0, last].map(|i| vec![sides[0][i], sides[1][i]]);
    let points: Vec<Point3<f64>> = sides.concat();
    Target {
        weights: vec![1.0; points.len()],
        points,
        triangles: Vec::new(),
        sides,
        ends,
        rulings: Vec::new(),
        warnings: Vec::new(),
        closed: false,
    }
}

fn made(patches: &[(f64, f64, f64)]) -> Sheets {
    let chain = chain(patches);
    let fits = vec![Fit::default(); patches.len()];
    sheets(&chain, &strip(&chain, 24), &fits, Some(0.01)).unwrap()
}

const MIXED: [(f64, f64, f64); 5] = [
    (0.4, 1.3, 0.5),
    (0.0, 0.9, 0.4),
    (-0.7, -1.8, 0.6),
    (0.0, 0.0, 0.3),
    (0.3, -0.8, 0.7),
];

#[test]
fn kinds_and_figures_are_those_of_closed_forms() {
    let sheets = made(&MIXED);
    let kinds: Vec<Kind> = sheets.patches.iter().map(|p| p.kind).collect();
    let expected = [
        Kind::Cone,
        Kind::Cylinder,
        Kind::Cone,
        Kind::Plane,
        Kind::Cone,
    ];
    assert_eq!(kinds, expected);
    let sides: Vec<_> = sheets.patches.iter().map(|p| p.bend_side).collect();
    let (front, back) = (Some(BendSide::Front), Some(BendSide::Back));
    assert_eq!(sides, [front, front, back, None, back]);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    let cylinder = &sheets.patches[1];
    near(cylinder.radius.unwrap(), 1.0 / 0.9);
    near(cylinder.turn_deg, (0.9_f64 * 0.4).to_degrees());
    near(cylinder.min_bend_radius, 1.0 / 0.9);
    near(cylinder.bend_strain_percent.unwrap(), 50.0 * 0.01 * 0.9);
    near(cylinder.area, 0.4 * 2.0 * WIDTH);
    let cone = &sheets.patches[2];
    let (sin, cos) = cone.half_angle_deg.unwrap().to_radians().sin_cos();
    for (slant, radius) in cone.slant_range.iter().zip(cone.end_radii.unwrap()) {
        near(slant * sin, radius);
    }
    assert!(cone.slant_range[0] < cone.slant_range[1]);
    near(cone.min_bend_radius, cone.slant_range[0] * sin / cos);
    assert_eq!(sheets.patches[3].min_bend_radius, f64::INFINITY);
    assert_eq!(sheets.patches[3].turn_deg, 0.0);
}

/// The distance of a place from the cone, cylinder or plane that the figures
/// of a patch describe.
fn off(patch: &Patch, place: &Point3<f64>) -> f64 {
    match (patch.kind, patch.axis) {
        (Kind::Plane, _) | (_, None) => 0.0,
        (Kind::Cylinder, Some(axis)) => {
            let from = place - axis.point;
            (from.cross(&axis.direction).norm() - patch.radius.unwrap()).abs()
        }
        (Kind::Cone, Some(axis)) => {
            let from = place - patch.apex.unwrap();
            let angle = from
                .cross(&axis.direction)
                .norm()
                .atan2(from.dot(&axis.direction));
            from.norm() * (angle - patch.half_angle_deg.unwrap().to_radians()).abs()
        }
    }
}

#[test]
fn surfaces_outlines_and_rulings_lie_on_what_the_figures_say() {
    let sheets = made(&MIXED);
    for patch in &sheets.patches {
        for i in 0..=20 {
            let [a, b] = patch.surface.domain(crate::geometry::Axis::U);
            let u = a + (b - a) * f64::from(i) / 20.0;
            let [c, d] = patch.surface.domain(crate::geometry::Axis::V);
            for v in [c, 0.5 * (c + d), d] {
                assert!(off(patch, &patch.surface.point(u, v)) < 1e-13);
            }
        }
        for point in patch.trims.iter().flat_map(|t| &t.points) {
            assert!(off(patch, point) < 1e-13);
        }
        assert_eq!(patch.outline.len(), patch.outline_uv.len());
        let mut found = 0;
        for trim in &patch.trims {
            for (point, place) in trim.points.iter().zip(&trim.parameters) {
                let same = (patch.outline.iter()).position(|p| (p - place).norm() < 1e-14);
                let Some(i) = same else { continue };
                let [u, v] = [patch.outline_uv[i].x, patch.outline_uv[i].y];
                assert!((patch.surface.point(u, v) - point).norm() < 1e-13);
                found += 1;
            }
        }
        assert!(found >= 4, "{found}");
        let ends = patch.rulings.map(|i| sheets.rulings[i]);
        let rows = patch.surface.control_points();
        let n = rows.len();
        for (ruling, corners) in ends.iter().zip([&rows[..2], &rows[n - 2..]]) {
            assert!((ruling.from - corners[0]).norm() < 1e-13);
            assert!((ruling.to - corners[1]).norm() < 1e-13);
        }
    }
}

#[test]
fn joins_are_smooth_to_rounding() {
    for join in made(&MIXED).joins {
        assert!(join.angle_deg < 1e-12 && join.gap < 1e-13, "{join:?}");
    }
}

/// A join that is none must be told.
#[test]
fn a_crease_between_patches_is_measured() {
    let sheets = made(&MIXED);
    let mut patches = sheets.patches;
    if let Some(axis) = &mut patches[1].axis {
        axis.point.x += 1e-3;
    }
    let joins = joins::measure(&patches, &sheets.rulings);
    assert!(
        joins[0].gap > 1e-4 && joins[0].angle_deg > 0.01,
        "{joins:?}"
    );
}

fn length(points: &[Point2<f64>]) -> f64 {
    points.windows(2).map(|p| (p[1] - p[0]).norm()).sum()
}

/// Unrolling keeps areas, the lengths of rulings and, up to the sampling of
/// the outline, those of edges.
#[test]
fn the_flat_pattern_is_isometric() {
    let sheets = made(&MIXED);
    assert_eq!(sheets.pattern.len(), 1);
    let piece = &sheets.pattern[0];
    let area: f64 = sheets.patches.iter().map(|p| p.area).sum();
    assert!(
        (piece.area - area).abs() < 1e-4 * area,
        "{} {area}",
        piece.area
    );
    for ruling in &sheets.rulings {
        let flat = (ruling.flat[1] - ruling.flat[0]).norm();
        assert!((flat - (ruling.to - ruling.from).norm()).abs() < 1e-13);
    }
    let mut closed = piece.outline.clone();
    closed.push(piece.outline[0]);
    let sides: f64 = (sheets.patches.iter())
        .flat_map(|p| &p.trims)
        .map(|t| {
            t.points
                .windows(2)
                .map(|p| (p[1] - p[0]).norm())
                .sum::<f64>()
        })
        .sum();
    let around = length(&closed) - 4.0 * WIDTH;
    assert!((around - sides).abs() < 1e-3 * sides, "{around} {sides}");
}

/// Seen from above, the outline runs counter-clockwise when side 0 is above
/// and the strip runs to the right: the pattern is not mirrored.
#[test]
fn the_flat_pattern_shows_the_front() {
    let sheets = made(&[(0.0, 1.0, 0.5)]);
    let [start, finish] = [&sheets.rulings[0], &sheets.rulings[1]];
    assert!(finish.flat[0].x > start.flat[0].x && start.flat[0].y > start.flat[1].y);
    // In space the normal −z looks down on a strip along n × r = x.
    assert!(finish.from.x > start.from.x && start.from.y < start.to.y);
}

#[test]
fn rings_are_sectors_about_their_apex() {
    let sheets = made(&[(0.4, 1.3, 0.5), (-0.7, -1.8, 0.6)]);
    for patch in &sheets.patches {
        let FlatSector::Ring {
            center,
            radii,
            start_deg,
            angle_deg,
        } = patch.flat
        else {
            panic!("a cone unrolls to a ring");
        };
        let lines = &patch.bend_lines;
        for line in lines {
            let ends = line.map(|p| (p - center).norm());
            assert!((ends[0].min(ends[1]) - radii[0]).abs() < 1e-12);
            assert!((ends[0].max(ends[1]) - radii[1]).abs() < 1e-12);
        }
        let direction = |i: usize| {
            let far = lines[i]
                .iter()
                .max_by(|a, b| (*a - center).norm().total_cmp(&(*b - center).norm()));
            let from = far.unwrap() - center;
            from.y.atan2(from.x).to_degrees()
        };
        assert!((direction(0) - start_deg).abs() < 1e-9);
        let turned = direction(lines.len() - 1) - direction(0);
        assert!((turned - angle_deg).abs() < 1e-9, "{turned} {angle_deg}");
    }
}

/// A helix in a plane of more than a full turn would lie on itself.
#[test]
fn what_would_overlap_is_cut_at_a_joint() {
    let quarter = (1.0, 0.8, 0.5 * PI);
    let sheets = made(&[quarter; 5]);
    let pieces: Vec<[usize; 2]> = sheets.pattern.iter().map(|p| p.patches).collect();
    assert_eq!(pieces.len(), 2, "{pieces:?}");
    assert_eq!([pieces[0][0], pieces[1][1]], [0, 5]);
    assert_eq!(pieces[0][1], pieces[1][0]);
    let area: f64 = sheets.patches.iter().map(|p| p.area).sum();
    let flat: f64 = sheets.pattern.iter().map(|p| p.area).sum();
    assert!((flat - area).abs() < 1e-2 * area);
}

/// Ends that are no rulings: the first and last ruling stand where the outline
/// ends, and the outline of the patch is cut obliquely.
#[test]
fn oblique_ends_widen_the_first_and_last_patch() {
    let chain = chain(&[(0.0, 1.0, 0.5), (0.0, 0.5, 0.5)]);
    let mut target = strip(&chain, 24);
    let before = chain
        .root
        .carried(Strain { g: 0.0, k: 1.0 }, -0.1)
        .at(WIDTH);
    target.sides[1].insert(0, before);
    target.ends[0][1] = before;
    let sheets = sheets(&chain, &target, &[Fit::default(); 2], None).unwrap();
    let first = &sheets.patches[0];
    assert!((first.turn_deg - 0.6_f64.to_degrees()).abs() < 1e-9);
    let corner = 0.5 * 0.1 * 2.0 * WIDTH;
    assert!(
        (first.area - (0.5 * 2.0 * WIDTH + corner)).abs() < 1e-9,
        "{}",
        first.area
    );
}

#[test]
fn a_tube_of_more_than_a_half_turn_has_several_spans() {
    let sheets = made(&[(0.0, 2.0, 2.5)]);
    let surface = &sheets.patches[0].surface;
    assert_eq!(surface.counts(), [9, 2]);
    assert!(surface.weights().unwrap().iter().all(|w| *w > 0.7));
}

#[test]
fn samples_stand_for_the_whole_area() {
    let sheets = made(&MIXED);
    let whole: f64 = sheets.patches.iter().map(|p| p.area).sum();
    let sampled: f64 = sheets.samples.iter().map(|s| s.area).sum();
    assert!(
        (sampled - whole).abs() < 1e-12 * whole.max(1.0),
        "{sampled} {whole}"
    );
}
