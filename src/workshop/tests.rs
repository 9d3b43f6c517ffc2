//! Closed forms: planes, cylinders, cones; what twist leaves; what overlaps.

use super::outline::{area, perimeter, polygon};
use super::*;
use crate::geometry::conformance::samples::quarter_circle;
use crate::geometry::{ArcLength, BSplineCurve, Parametrization, RuledSurface, interpolate};
use nalgebra::{Point2, Point3, Vector3, point};
use std::f64::consts::{FRAC_PI_2, PI};

const STEPS: u32 = 24;

fn ruled(first: BSplineCurve, second: BSplineCurve) -> RuledSurface {
    RuledSurface::new(first, second).unwrap()
}

fn line(a: Point3<f64>, b: Point3<f64>) -> BSplineCurve {
    BSplineCurve::line(a, b, 3).unwrap()
}

fn through(point: impl Fn(f64) -> Point3<f64>, count: u32) -> BSplineCurve {
    let u: Vec<f64> = (0..=count)
        .map(|i| f64::from(i) / f64::from(count))
        .collect();
    let points: Vec<Point3<f64>> = u.iter().map(|u| point(*u)).collect();
    let curve = interpolate(&points, 3, Parametrization::Uniform).unwrap();
    curve.on_domain([0.0, 1.0]).unwrap()
}

fn even() -> Vec<f64> {
    (0..=STEPS)
        .map(|i| f64::from(i) / f64::from(STEPS))
        .collect()
}

fn flat(plate: &RuledSurface) -> FlatPlate {
    let hull = HullFrame::around(std::slice::from_ref(plate)).unwrap();
    flatten(plate, &even(), &hull).unwrap()
}

/// The only piece.
fn piece(flat: &FlatPlate) -> &FlatPiece {
    assert_eq!(flat.pieces.len(), 1);
    &flat.pieces[0]
}

fn no_strain(f: &FlatFigures) {
    for strain in [
        f.boundary_strain_percent,
        f.ruling_strain_percent,
        f.middle_strain_percent,
        f.diagonal_strain_percent,
        f.twist_strain_percent,
    ] {
        assert!(strain < 1e-7, "{f:?}");
    }
    let areas = f.flat_area / f.surface_area - 1.0;
    assert!(areas.abs() < 1e-9, "{areas:e}");
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance, "{a} for {b}");
}

#[test]
fn a_plane_stays_as_it_is() {
    let plate = ruled(
        line(point![1.0, 2.0, 3.0], point![7.0, 2.0, 3.0]),
        line(point![2.0, 2.0, 5.0], point![6.5, 2.0, 7.0]),
    );
    let flat = flat(&plate);
    let piece = piece(&flat);
    // Seen from outside or inside, corner to corner along a boundary.
    let corners: Vec<Point2<f64>> = piece.outline.iter().map(|c| c.at).collect();
    assert_eq!(corners.len(), 4, "{corners:?}");
    let first = ArcLength::new(plate.first()).total();
    let second = ArcLength::new(plate.second()).total();
    close((corners[1] - corners[0]).norm(), first, 1e-12);
    close((corners[3] - corners[2]).norm(), second, 1e-12);
    close(
        (corners[2] - corners[0]).norm(),
        (plate.second().end() - plate.first().start()).norm(),
        1e-12,
    );
    no_strain(&flat.figures);
    close(flat.figures.bend_deg, 0.0, 1e-9);
    assert!(flat.figures.refolds.iter().all(|r| r.1 < 1e-12));
}

#[test]
fn a_cylinder_becomes_a_rectangle() {
    let arc = quarter_circle(2.0);
    let plate = ruled(arc.clone(), arc.translated(&Vector3::new(0.0, 0.0, 3.0)));
    let flat = flat(&plate);
    let piece = piece(&flat);
    let length = 2.0 * FRAC_PI_2;
    close(piece.area, 3.0 * length, 1e-9);
    close(piece.sheet[0], length, 1e-9);
    close(piece.sheet[1], 3.0, 1e-9);
    close(perimeter(&piece.outline), 2.0 * (3.0 + length), 1e-9);
    for r in &piece.rulings {
        close(r.length, 3.0, 1e-12);
        close(r.angle_deg.abs(), 90.0, 1e-9);
        let from = plate.first().point(even()[r.index]);
        let arc = 2.0 * from.y.atan2(from.x);
        let along = r.from.x.abs();
        close(
            along.min((along - length).abs()),
            arc.min((arc - length).abs()),
            1e-9,
        );
    }
    no_strain(&flat.figures);
    close(flat.figures.bend_deg, 90.0, 1e-9);
    // Falling with the square of the steps: nothing but their coarseness.
    let refolds = &flat.figures.refolds;
    assert_eq!(
        refolds.iter().map(|r| r.0).collect::<Vec<_>>(),
        [25, 49, 97]
    );
    assert!(
        refolds[2].1 < 1e-3 && refolds[2].1 < refolds[0].1 / 12.0,
        "{refolds:?}"
    );
}

#[test]
fn a_cone_becomes_a_sector() {
    let arc = quarter_circle(1.0).translated(&Vector3::new(0., 0., -1.0));
    let plate = ruled(arc, quarter_circle(2.0));
    let flat = flat(&plate);
    let piece = piece(&flat);
    // Half angle 45°: the sector's angle is (π/2)/√2, its radii √2 and 2√2.
    let turn = FRAC_PI_2 / 2f64.sqrt();
    close(piece.area, 0.5 * turn * (8.0 - 2.0), 1e-9);
    let outer = 2.0 * 2f64.sqrt();
    close(
        perimeter(&piece.outline),
        turn * (outer + outer / 2.0) + outer,
        1e-9,
    );
    let [a, b] = [&piece.rulings[0], &piece.rulings[24]];
    close((a.angle_deg - b.angle_deg).abs(), turn.to_degrees(), 1e-9);
    let chord = |a: &Point2<f64>, b: &Point2<f64>| (b - a).norm();
    close(chord(&a.to, &b.to), 2.0 * outer * (0.5 * turn).sin(), 1e-9);
    close(chord(&a.from, &b.from), outer * (0.5 * turn).sin(), 1e-9);
    no_strain(&flat.figures);
}

#[test]
fn a_fan_keeps_its_apex() {
    let apex = point![0.0, 0.0, 3.0];
    let plate = ruled(
        line(apex, apex).elevated_to(3).unwrap(),
        quarter_circle(1.5).elevated_to(3).unwrap(),
    );
    let flat = flat(&plate);
    let piece = piece(&flat);
    // The arc lies at z = 1: slant 2.5, arc 1.5 π/2.
    close(piece.area, 0.5 * 2.5 * 1.5 * FRAC_PI_2, 1e-9);
    let apexes = piece.outline.iter().filter(|c| {
        let from = piece.rulings[0].from;
        (c.at - from).norm() < 1e-9
    });
    assert_eq!(apexes.count(), 1);
    assert_eq!(piece.base_boundary, 1);
    no_strain(&flat.figures);
}

/// A plate that bends, twists, has a corner in one boundary, and whose
/// boundaries are run through at uneven speed.
fn twisted() -> RuledSurface {
    let first = through(|u| point![10.0 * u, 1.0 + (2.0 * u).sin(), 0.3 * u * u], 12);
    let second = through(
        |u| {
            point![
                0.5 + 9.0 * u * (0.8 + 0.2 * u),
                (1.7 * u).sin(),
                2.0 + 0.5 * u
            ]
        },
        12,
    );
    ruled(first, second)
}

/// Length of a flat boundary by chords of 2 n and n steps (Richardson).
fn flat_length(plate: &RuledSurface, second: bool) -> f64 {
    let development = development::Development::new(plate).unwrap();
    let v = f64::from(u8::from(second));
    let chords = |n: u32| -> f64 {
        let knots = development::breaks(plate);
        let steps = |w: &[f64]| -> f64 {
            let at =
                |i: u32| development.point(w[0] + (w[1] - w[0]) * f64::from(i) / f64::from(n), v);
            (0..n).map(|i| (at(i + 1) - at(i)).norm()).sum()
        };
        knots.windows(2).map(steps).sum()
    };
    (4.0 * chords(400) - chords(200)) / 3.0
}

#[test]
fn boundaries_keep_their_length_whatever_the_twist() {
    let kinked = BSplineCurve::new(
        1,
        vec![0.0, 0.0, 0.4, 1.0, 1.0],
        vec![
            point![0.0, 3.0, 0.0],
            point![4.0, 3.0, 1.0],
            point![10.0, 2.0, 0.0],
        ],
        None,
    );
    let other = through(|u| point![10.0 * u, 0.5 * (3.0 * u).cos(), -1.0], 9);
    let plates = [
        twisted(),
        ruled(kinked.unwrap().elevated_to(3).unwrap(), other),
    ];
    for plate in plates {
        let flat = flat(&plate);
        for (k, curve) in [plate.first(), plate.second()].into_iter().enumerate() {
            let length = ArcLength::new(curve).total();
            let flat_length = flat_length(&plate, k == 1);
            close(flat_length / length, 1.0, 1e-9);
            close(flat.figures.boundary_lengths[k], length, 1e-12);
        }
        let all: f64 = flat.figures.boundary_lengths.iter().sum();
        let piece = piece(&flat);
        let ends = piece.rulings[0].length + piece.rulings[24].length;
        close(perimeter(&piece.outline) / (all + ends), 1.0, 1e-9);
        assert!(flat.figures.boundary_strain_percent < 1e-6);
        assert!(flat.figures.ruling_strain_percent < 1e-9);
    }
}

#[test]
fn corners_stay_corners() {
    let kinked = BSplineCurve::new(
        1,
        vec![0.0, 0.0, 0.4, 1.0, 1.0],
        vec![
            point![0.0, 0.0, 0.0],
            point![4.0, 0.0, 1.0],
            point![10.0, 0.0, 0.0],
        ],
        None,
    );
    let plate = ruled(
        kinked.unwrap(),
        BSplineCurve::line(point![0.0, 0.0, 4.0], point![10.0, 0.0, 4.0], 1).unwrap(),
    );
    let flat = flat(&plate);
    let piece = piece(&flat);
    // The kink, and none where its knot stands on the second.
    assert_eq!(piece.outline.len(), 5);
    assert!(piece.outline.iter().all(|c| c.bulge == 0.0));
    let at = piece.outline[1].at;
    close((at - piece.outline[0].at).norm(), 17f64.sqrt(), 1e-12);
    close((piece.outline[2].at - at).norm(), 37f64.sqrt(), 1e-12);
    close(piece.area, 35.0, 1e-9);
}

#[test]
fn twist_is_measured_as_strain() {
    // A hypar over a square of side 1 whose fourth corner is raised.
    let plate = |rise: f64| {
        ruled(
            line(point![0., 0., 0.], point![1., 0., 0.]),
            line(point![0., 1., 0.], point![1., 1., rise]),
        )
    };
    for rise in [0.02, 0.1, 0.3] {
        let plate = plate(rise);
        let flat = flat(&plate);
        let f = &flat.figures;
        let twist = (0..=100).map(|i| plate.twist(f64::from(i) / 100.0).abs());
        let worst = twist.fold(0.0, f64::max);
        let expected = 100.0 * worst * worst / 8.0;
        close(f.twist_strain_percent / expected, 1.0, 0.1 * rise + 1e-3);
        close(f.middle_strain_percent / expected, 1.0, 0.1 * rise + 1e-2);
        assert!(f.boundary_strain_percent < 1e-7, "{f:?}");
        // Speed (1 − v) h₁ + v h₂ in the plane is never less than on the plate.
        let gain = 100.0 * (f.flat_area / f.surface_area - 1.0);
        assert!(
            gain > 0.3 * expected && gain < expected,
            "{gain} {expected}"
        );
        // No refinement brings it nearer: half the rise, in the best position
        // a quarter of it at each corner.
        let refolds = &f.refolds;
        assert!(
            refolds[2].1 > 0.15 * rise && refolds[2].1 < 0.3 * rise,
            "{refolds:?}"
        );
    }
}

#[test]
fn a_helical_ribbon_is_cut_where_it_would_lie_on_itself() {
    // Two turns of a helicoid's outer ribbon: nearly a flat ring.
    let helix = |radius: f64| {
        through(
            move |u| {
                let (sin, cos) = (4.0 * PI * u).sin_cos();
                point![radius * cos, radius * sin, 0.2 * u]
            },
            160,
        )
    };
    let plate = ruled(helix(3.0), helix(4.0));
    let flat = flat(&plate);
    // A little less than two full turns.
    assert_eq!(flat.pieces.len(), 2, "{:?}", flat.figures);
    for pair in flat.pieces.windows(2) {
        let shared = pair[0].rulings.last().unwrap().index;
        assert_eq!(pair[1].rulings[0].index, shared);
    }
    let whole: f64 = flat.pieces.iter().map(|p| p.area).sum();
    close(whole / (2.0 * PI * 7.0), 1.0, 1e-2);
    for piece in &flat.pieces {
        close(piece.base_line[0].coords.norm(), 0.0, 1e-12);
        close(piece.base_line[1].y, 0.0, 1e-9);
    }
}

#[test]
fn the_inside_lies_up() {
    // The two sides of a V-shaped hull, and its mirror image to starboard.
    for side in [1.0, -1.0] {
        let sheer = through(|u| point![10.0 * u, side * (2.0 - 2.0 * u * u), 3.0], 10);
        let chine = through(|u| point![10.0 * u, side * (1.5 - 1.5 * u * u), 1.0], 10);
        let keel = line(point![0.0, 0.0, 0.0], point![10.0, 0.0, 0.5]);
        let plates = [
            ruled(sheer.clone(), chine.clone()),
            ruled(chine, keel.elevated_to(3).unwrap()),
        ];
        // Knots differ; plates do not ask for more than one domain.
        let hull = HullFrame::around(&plates).unwrap();
        assert_eq!(hull.axis(), 0);
        for plate in &plates {
            let flat = flatten(plate, &even(), &hull).unwrap();
            assert_eq!(flat.side, Side::Inside);
            // Seen from inside with the bow to the right, the upper boundary of
            // the port side is up.
            let piece = piece(&flat);
            let [first, last] = [&piece.rulings[0], &piece.rulings[24]];
            let right = last.from.x > first.from.x;
            assert!(right, "{first:?} {last:?}");
            // y to port: seen from inside, port has the bow to the right when
            // the first boundary, the upper one, lies above.
            assert_eq!(first.from.y > first.to.y, side > 0.0, "{side}");
            // Stations stand at round x and ascend to the right.
            let at: Vec<f64> = piece.stations.iter().map(|s| s.at).collect();
            assert!(at.len() > 15 && at.is_sorted(), "{at:?}");
            for mark in &piece.stations {
                close(mark.at * 2.0, (mark.at * 2.0).round(), 1e-12);
            }
            // Bent around the hull, the plate comes up at the bow.
            let bend: f64 = piece.rulings.iter().map(|r| r.bend_deg).sum();
            assert!(bend > 5.0, "{bend}");
        }
    }
}

#[test]
fn station_marks_lie_on_their_stations() {
    let plate = twisted();
    let hull = HullFrame::around(std::slice::from_ref(&plate)).unwrap();
    let development = development::Development::new(&plate).unwrap();
    let fields = development.fields(256);
    let net = stations::Net::new(&plate, &fields, 0);
    assert!(hull.stations().len() > 8);
    // At the ends they touch a corner at the most.
    let inner = hull.stations().iter().filter(|x| **x > 0.0 && **x < 10.0);
    for at in inner {
        let chains = net.crossing(*at);
        assert_eq!(chains.len(), 1, "{at}");
        for place in &chains[0] {
            close(plate.point(place.x, place.y).x, *at, 1e-9);
        }
        for end in [chains[0][0], chains[0][chains[0].len() - 1]] {
            let border = [end.x, 1.0 - end.x, end.y, 1.0 - end.y];
            assert!(border.iter().any(|d| d.abs() < 1e-9), "{at}: {end}");
        }
    }
}

#[test]
fn rulings_in_a_station_plane_are_marked_once() {
    let plate = ruled(
        line(point![0.0, 0.0, 0.0], point![10.0, 0.0, 0.0]),
        line(point![0.0, 1.0, 2.0], point![10.0, 1.0, 2.0]),
    );
    let flat = flat(&plate);
    let marks = &piece(&flat).stations;
    assert_eq!(marks.iter().filter(|m| m.at == 5.0).count(), 1);
    for mark in marks {
        assert_eq!(mark.line.len(), 2);
        close((mark.line[1] - mark.line[0]).norm(), 5f64.sqrt(), 1e-9);
    }
}

#[test]
fn round_stations_are_round() {
    assert_eq!(stations::round_stations([0.0, 70.0], 20.0).len(), 15);
    let tenths = stations::round_stations([0.05, 0.95], 10.0);
    assert_eq!(tenths[2], 0.3);
    assert!(stations::round_stations([1.0, 1.0], 20.0).is_empty());
    assert!(stations::round_stations([1e6, 1e6 + 1e-9], 20.0).len() < 201);
}

#[test]
fn nothing_cannot_be_flattened() {
    let spot = point![1.0, 1.0, 1.0];
    let plate = ruled(line(spot, spot), line(spot, spot));
    let hull = HullFrame::around(std::slice::from_ref(&plate)).unwrap();
    assert!(flatten(&plate, &even(), &hull).is_none());
    assert!(flatten(&twisted(), &[0.5], &hull).is_none());
    // A line run through twice has a size, but no area.
    let along = line(spot, point![5.0, 1.0, 2.0]);
    assert!(flatten(&ruled(along.clone(), along), &even(), &hull).is_none());
    assert!(HullFrame::around(&[]).is_none());
}

#[test]
fn the_polygon_of_an_outline_has_its_area() {
    let flat = flat(&twisted());
    let piece = piece(&flat);
    let corners: Vec<OutlineCorner> = (polygon(&piece.outline).into_iter())
        .map(|at| OutlineCorner { at, bulge: 0.0 })
        .collect();
    close(area(&corners) / area(&piece.outline), 1.0, 1e-3);
}

/// A quarter of a cylinder of radius 1 about z, seen from its axis (the hull's
/// middle line is elsewhere: a frame around a plate alone has it inside).
#[test]
fn a_thick_cylinder_is_as_long_as_its_middle() {
    let arc = quarter_circle(1.0);
    let plate = ruled(arc.clone(), arc.translated(&Vector3::new(0.0, 0.0, 3.0)));
    let hull = HullFrame::around(std::slice::from_ref(&plate)).unwrap();
    let thickness = 0.1;
    let thick = |face: Face| flatten_thick(&plate, &even(), &hull, thickness, face).unwrap();
    let thin = flat(&plate);
    let lengths = [Face::Up, Face::Middle, Face::Down].map(|face| {
        let flat = thick(face);
        no_strain(&flat.figures);
        assert!((flat.figures.boundary_lengths[0] - flat.figures.boundary_lengths[1]).abs() < 1e-9);
        flat.figures.boundary_lengths[0]
    });
    close(lengths[1], thin.figures.boundary_lengths[0], 1e-9);
    // The face that is up is nearer to the middle line or further from it: the
    // middle of the plate is half a thickness towards the other.
    let step = 0.5 * thickness * FRAC_PI_2;
    close((lengths[0] - lengths[1]).abs(), step, 1e-9);
    close(lengths[0] + lengths[2], 2.0 * lengths[1], 1e-9);
}

#[test]
fn a_thick_cone_keeps_its_angle_and_a_knuckle_has_no_middle() {
    // Radius z tan(30°) from z = 1 to 3: the offset is a cone of the same angle.
    let circle = |z: f64| {
        through(
            |u| {
                let (sin, cos) = (FRAC_PI_2 * u).sin_cos();
                let radius = z * (PI / 6.0).tan();
                point![radius * cos, radius * sin, z]
            },
            60,
        )
    };
    let plate = ruled(circle(1.0), circle(3.0));
    let hull = HullFrame::around(std::slice::from_ref(&plate)).unwrap();
    let flat = flatten_thick(&plate, &even(), &hull, 0.02, Face::Up).unwrap();
    let (thin, thick) = (self::flat(&plate), flat);
    let opening = |flat: &FlatPlate| {
        let [a, b] = flat.figures.boundary_lengths;
        (b - a).abs() / thin_length(flat)
    };
    // Both boundaries move by the same angle at the same length of ruling.
    close(opening(&thin), opening(&thick), 1e-7);
    let change = thick.figures.boundary_lengths[0] - thin.figures.boundary_lengths[0];
    close(change.abs(), 0.01 * (PI / 6.0).cos() * FRAC_PI_2, 1e-6);
    // A whole cone keeps its tip, which moves along the axis.
    let tip = BSplineCurve::line(Point3::origin(), Point3::origin(), 3).unwrap();
    let plate = ruled(tip, circle(3.0));
    let (thin, thick) = (
        self::flat(&plate),
        flatten_thick(&plate, &even(), &hull, 0.02, Face::Up).unwrap(),
    );
    for flat in [&thin, &thick] {
        no_strain(&flat.figures);
        close(flat.figures.boundary_lengths[0], 0.0, 1e-12);
    }
    let change = thick.figures.boundary_lengths[1] - thin.figures.boundary_lengths[1];
    close(change.abs(), 0.01 * (PI / 6.0).cos() * FRAC_PI_2, 1e-6);
    // The axial way is s / sin 30°, of which the ruling sees cos 30° less s cot 30°.
    let longer = thin_length(&thick) - thin_length(&thin);
    close(longer.abs(), 0.01 / (PI / 6.0).tan(), 1e-6);
    // Two planes that meet along a ruling at a right angle.
    assert!(flatten_thick(&folded(FRAC_PI_2), &even(), &hull, 0.1, Face::Up).is_none());
}

/// Two planes of length 1 that meet along a ruling.
fn folded(angle: f64) -> RuledSurface {
    let bent = |y: f64| {
        let points = vec![
            point![0.0, y, 0.0],
            point![1.0, y, 0.0],
            point![1.0 + angle.cos(), y, angle.sin()],
        ];
        BSplineCurve::new(1, vec![0.0, 0.0, 0.5, 1.0, 1.0], points, None).unwrap()
    };
    ruled(bent(0.0), bent(2.0))
}

#[test]
fn a_slight_crease_is_a_bend_like_any_other() {
    let angle = 0.1;
    let plate = folded(angle);
    let hull = HullFrame::around(std::slice::from_ref(&plate)).unwrap();
    let thickness = 0.05;
    let lengths = [Face::Up, Face::Middle, Face::Down].map(|face| {
        let flat = flatten_thick(&plate, &even(), &hull, thickness, face).unwrap();
        assert!(
            flat.figures.middle_strain_percent < 1e-3,
            "{:?}",
            flat.figures
        );
        flat.figures.boundary_lengths
    });
    close(lengths[1][0], 2.0, 1e-12);
    // Half a thickness times the angle longer or shorter.
    for (face, sign) in [(0, 1.0), (2, -1.0)] {
        for length in lengths[face] {
            close((length - 2.0).abs(), 0.5 * thickness * angle, 1e-5);
            assert!((length - 2.0) * sign * (lengths[0][0] - 2.0) > 0.0);
        }
    }
}

/// The length of a ruling.
fn thin_length(flat: &FlatPlate) -> f64 {
    piece(flat).rulings[0].length
}
