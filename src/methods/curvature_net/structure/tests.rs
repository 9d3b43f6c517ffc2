//! Strips, supports, offsets and lists of nets known in closed form.

use super::flat::SAMPLES;
use super::{ConeKind, Sheet, bill, offset, strips, supports};
use crate::geometry::CyclidePatch;
use crate::methods::curvature_net::cyclide::samples::{ellipsoid, enneper, net_of, torus, vase};
use crate::methods::curvature_net::cyclide::{patches, solve};
use crate::methods::curvature_net::net::Net;
use crate::methods::curvature_net::request::Direction;
use crate::solver::Unwatched;
use nalgebra::{Point2, Point3};

fn exact(net: &Net) -> (Net, Vec<Option<CyclidePatch>>) {
    let net = solve(net, &Unwatched).expect("nobody stops it").net;
    let patches = patches(&net).into_iter().map(Result::ok).collect();
    (net, patches)
}

fn nets() -> Vec<(&'static str, Net)> {
    vec![
        ("ellipsoid", net_of([6, 7], [false; 2], ellipsoid)),
        ("enneper", net_of([6, 5], [false; 2], enneper)),
        ("vase", net_of([12, 6], [true, false], vase)),
        ("torus", net_of([12, 10], [true, true], torus)),
        (
            "tunnel",
            net_of([4, 5], [false; 2], |u, v| {
                Point3::new(5.0 * u, v.cos(), v.sin())
            }),
        ),
    ]
}

/// Arc length of a smooth curve through equally spaced samples, by the sixth
/// order closed Newton–Cotes rule on chords: Richardson from 8, 4, 2 chords.
fn length<const D: usize>(points: &[[f64; D]]) -> f64 {
    let chords = |step: usize| -> f64 {
        let picked: Vec<_> = points.iter().step_by(step).collect();
        let chord = |p: &[&[f64; D]]| -> f64 {
            p[0].iter()
                .zip(p[1])
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        picked.windows(2).map(chord).sum()
    };
    let [c8, c4, c2] = [chords(1), chords(2), chords(4)];
    let (r8, r4) = ((4.0 * c8 - c4) / 3.0, (4.0 * c4 - c2) / 3.0);
    (16.0 * r8 - r4) / 15.0
}

fn flat_lengths(edge: &[Point2<f64>]) -> Vec<f64> {
    let pieces = edge.windows(SAMPLES + 1).step_by(SAMPLES);
    pieces
        .map(|p| length(&p.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>()))
        .collect()
}

/// Every cone has its sheet's pieces in order.
fn per_piece(sheets: &[Sheet], pick: impl Fn(&Sheet) -> &Vec<Point2<f64>>) -> Vec<f64> {
    sheets.iter().flat_map(|s| flat_lengths(pick(s))).collect()
}

#[test]
fn flat_patterns_keep_lines_rulings_and_edges() {
    for (name, net) in nets() {
        let (net, patches) = exact(&net);
        for direction in [Direction::U, Direction::V] {
            for strip in strips(&net, &patches, direction) {
                let line = per_piece(&strip.sheets, |s| &s.line);
                let left = per_piece(&strip.sheets, |s| &s.left);
                assert_eq!(line.len(), strip.cones.len());
                let rulings: Vec<_> = strip.sheets.iter().flat_map(Sheet::rulings).collect();
                for (k, cone) in strip.cones.iter().enumerate() {
                    let off = (line[k] - cone.arc.length()).abs() / cone.arc.length();
                    assert!(off < 1e-7, "{name} {}: {off}", strip.name);
                    let space: Vec<[f64; 3]> =
                        cone.edges[0].iter().map(|p| [p.x, p.y, p.z]).collect();
                    let off = (left[k] - length(&space)).abs() / cone.arc.length();
                    assert!(off < 1e-5, "{name} {} edge {k}: {off}", strip.name);
                    let ruling = (cone.edges[0][0] - cone.edges[1][0]).norm();
                    let flat = rulings.iter().map(|[a, b]| ((a - b).norm() - ruling).abs());
                    assert!(flat.fold(f64::INFINITY, f64::min) < 1e-12);
                }
            }
        }
    }
}

/// Centres and apexes further than this cost the check its digits.
const FAR: f64 = 1e4;

/// The distance of two points along a cone, cylinder or plane, by its apex and
/// axis alone; none where these are too far away to tell.
fn along_the_cone(cone: &super::Cone, p: &Point3<f64>, q: &Point3<f64>) -> Option<f64> {
    let axis = cone.arc.axis()?;
    let centre = cone.arc.centre().filter(|c| (c - p).norm() < FAR)?;
    let azimuth = |p: &Point3<f64>| {
        let out = p - centre;
        out - axis * axis.dot(&out)
    };
    let (a, b) = (azimuth(p), azimuth(q));
    let turn = a.cross(&b).norm().atan2(a.dot(&b));
    // Kinds are told to a millionth only.
    let none = |bend: f64| (bend * cone.arc.length()).abs() < 1e-10;
    match (cone.kind, cone.apex()) {
        (ConeKind::Plane, _) if !none(cone.normal_curvature) => None,
        (ConeKind::Cylinder, _) if !none(cone.bend) => None,
        (ConeKind::Plane, _) => Some((q - p).norm()),
        (ConeKind::Cylinder, _) => Some((a.norm() * turn).hypot(axis.dot(&(q - p)))),
        (ConeKind::Cone, Some(apex)) if (apex - p).norm() < FAR => {
            let [r, s] = [p, q].map(|p| (p - apex).norm());
            let turn = turn * cone.half_angle().sin();
            // The law of cosines, without its loss of digits at small angles.
            let half = (0.5 * turn).sin();
            Some(((r - s).powi(2) + 4.0 * r * s * half * half).sqrt())
        }
        (ConeKind::Cone, _) => None,
    }
}

#[test]
fn flat_distances_are_those_on_the_cones() {
    let mut checked = 0;
    for (name, net) in nets() {
        let (net, patches) = exact(&net);
        for direction in [Direction::U, Direction::V] {
            for strip in strips(&net, &patches, direction) {
                let flat = strip.sheets.iter().flat_map(|sheet| {
                    let pieces = (0..sheet.line.len() / SAMPLES).map(|k| SAMPLES * k);
                    pieces.map(|at| [&sheet.left, &sheet.right].map(|e| &e[at..=at + SAMPLES]))
                });
                for (cone, flat) in strip.cones.iter().zip(flat) {
                    for (edge, flat) in cone.edges.iter().zip(flat) {
                        for (k, l) in [(0, 1), (1, 2), (3, 7), (0, SAMPLES)] {
                            let on = along_the_cone(cone, &edge[k], &edge[l]);
                            let Some(on) = on.filter(|d| *d > 1e-6) else {
                                continue;
                            };
                            let off = ((flat[k] - flat[l]).norm() - on).abs() / on;
                            assert!(off < 1e-9, "{name} {}: {off}", strip.name);
                            checked += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(checked > 3000, "{checked}");
}

#[test]
fn cones_touch_the_patches_and_each_other() {
    for (name, net) in nets() {
        let (net, patches) = exact(&net);
        for direction in [Direction::U, Direction::V] {
            for strip in strips(&net, &patches, direction) {
                for pair in strip.cones.windows(2) {
                    let [first, second] = pair else {
                        unreachable!()
                    };
                    for side in [0, 1] {
                        let apart = first.edges[side][SAMPLES] - second.edges[side][0];
                        assert!(apart.norm() < 1e-11, "{name} {}", strip.name);
                    }
                }
                for cone in &strip.cones {
                    let normal = net.normals[cone.ends[1]];
                    for edge in &cone.edges {
                        let ruling = edge[SAMPLES] - cone.arc.end();
                        assert!(ruling.dot(&normal).abs() < 1e-11, "{name}");
                        assert!(ruling.dot(&cone.arc.end_tangent()).abs() < 1e-11, "{name}");
                    }
                    // All rulings run through the apex.
                    let Some(apex) = cone.apex().filter(|_| cone.kind == ConeKind::Cone) else {
                        continue;
                    };
                    for k in 0..=SAMPLES {
                        let on = cone.arc.point(k as f64 / SAMPLES as f64);
                        let to = (apex - on).normalize();
                        let off = (cone.edges[0][k] - on).cross(&to).norm();
                        assert!(off < 1e-10, "{name} {}: {off}", strip.name);
                    }
                }
            }
        }
    }
}

#[test]
fn neighbouring_strips_share_their_edges() {
    let (net, patches) = exact(&net_of([6, 7], [false; 2], ellipsoid));
    let all = strips(&net, &patches, Direction::U);
    for pair in all.windows(2) {
        for (a, b) in pair[0].cones.iter().zip(&pair[1].cones) {
            // They run along the same conic, though not at the same shares.
            assert!((a.edges[0][0] - b.edges[1][0]).norm() < 1e-12);
            assert!((a.edges[0][SAMPLES] - b.edges[1][SAMPLES]).norm() < 1e-12);
        }
    }
    for cone in &all[0].cones {
        assert_eq!(cone.edges[1][3], cone.arc.point(3.0 / SAMPLES as f64));
    }
}

#[test]
fn a_full_ring_is_cut_where_it_would_overlap() {
    let (net, patches) = exact(&net_of([12, 6], [true, false], vase));
    let flat = |u: f64, v: f64| {
        let (s, c) = (std::f64::consts::TAU * u).sin_cos();
        Point3::new((1.0 + v) * c, (1.0 + v) * s, 0.0)
    };
    let (ring, ring_patches) = exact(&net_of([12, 4], [true, false], flat));
    for strip in strips(&ring, &ring_patches, Direction::U) {
        assert_eq!(strip.sheets.len(), 1, "a flat ring just closes");
        assert!(strip.cones.iter().all(|c| c.kind == ConeKind::Plane));
    }
    for strip in strips(&net, &patches, Direction::U) {
        let pieces: usize = strip.sheets.iter().map(|s| s.line.len() / SAMPLES).sum();
        assert_eq!(pieces, 12);
    }
    // A line that winds twice round a flat annulus must be cut.
    let coil = |u: f64, v: f64| {
        let (s, c) = (2.0 * std::f64::consts::TAU * u).sin_cos();
        Point3::new((1.0 + v) * c, (1.0 + v) * s, 0.0)
    };
    let (coil, coil_patches) = exact(&net_of([33, 3], [false; 2], coil));
    for strip in strips(&coil, &coil_patches, Direction::U) {
        assert!(strip.sheets.len() >= 2, "{}", strip.name);
    }
}

#[test]
fn supports_stand_on_their_lines() {
    let (net, _) = exact(&net_of([12, 10], [true, true], torus));
    for height in [0.3, -0.2] {
        let all = supports(&net, height);
        assert_eq!(all.len(), 22);
        for support in &all {
            assert!(support.folded.is_empty());
            for [right, left] in support.sheets.iter().flat_map(Sheet::rulings) {
                assert!(((left - right).norm() - height.abs()).abs() < 1e-12);
            }
        }
    }
    // Inwards beyond the tube's radius the meridians' supports fold.
    let folded = supports(&net, -1.1);
    let is_v = |d: Direction| d == Direction::V;
    assert!(
        folded
            .iter()
            .all(|s| is_v(s.direction) != s.folded.is_empty())
    );
}

#[test]
fn offsets_are_cyclide_splines_until_they_meet_a_focal_point() {
    let (net, patches) = exact(&net_of([12, 10], [true, true], torus));
    let near = offset(&net, &patches, -0.4);
    assert!(near.focal.is_empty());
    for patch in &near.patches {
        let point = patch.expect("a patch").point(0.3, 0.6);
        let tube = (point.x.hypot(point.y) - 3.0).hypot(point.z);
        assert!((tube - 0.6).abs() < 1e-12);
    }
    let far = offset(&net, &patches, -1.2);
    assert_eq!(far.focal.len(), 120);
    for ([i, _], radius) in &far.focal {
        assert!(*i < 12 && (radius - 1.0).abs() < 1e-9);
    }
    assert!(far.patches.iter().all(Option::is_none));
}

#[test]
fn the_bill_lists_every_arc() {
    let (net, _) = exact(&net_of([12, 10], [true, true], torus));
    let members = bill(&net);
    assert_eq!(members.len(), 240);
    let rings: f64 = members
        .iter()
        .filter(|m| m.line == "v0")
        .map(|m| m.length)
        .sum();
    assert!((rings - std::f64::consts::TAU).abs() < 1e-9);
    for member in &members {
        assert!(member.torsion.abs() < 1e-11);
        assert!((member.radius * member.angle - member.length).abs() < 1e-10);
    }
}
