use super::*;
use crate::geometry::conformance::samples;
use crate::geometry::{Parametrization, interpolate};
use nalgebra::{Vector3, point};

fn fine() -> Tolerance {
    Tolerance::absolute(1e-9).expect("positive")
}

fn polyline(points: &[Point3<f64>]) -> BSplineCurve {
    interpolate(points, 1, Parametrization::ChordLength).expect("distinct")
}

#[test]
fn parallel_lines_and_a_shifted_circle() {
    let line = samples::line();
    let d = directed_distance(&line, &line.translated(&Vector3::new(0., 0., 0.5)), fine());
    assert!(
        d.certain
            && [d.max, d.mean, d.rms]
                .iter()
                .all(|x| (x - 0.5).abs() < 1e-13)
    );
    let small = samples::quarter_circle(2.0);
    let d = directed_distance(&small, &samples::quarter_circle(2.25), {
        // Equal everywhere, so that the whole length must be resolved.
        Tolerance::absolute(1e-7).expect("positive")
    });
    assert!(d.certain && (d.max - 0.25).abs() < 1e-12 && (d.mean - 0.25).abs() < 1e-12);
}

#[test]
fn a_curve_is_no_distance_from_itself_refined() {
    for (name, c) in samples::curves() {
        let [a, b] = c.domain();
        let other = c.insert_knots(&[a + 0.321 * (b - a)]).expect("inside");
        let size = c.bounding_box().diagonal() + c.start().coords.amax();
        let resolution = Tolerance::absolute(1e-7 * size).expect("positive");
        let d = directed_distance(&c, &other, resolution);
        assert!(d.certain && d.max < 1e-13 * size, "{name}: {d:?}");
    }
}

/// A spike of width 1e-4 and height 0.01 in a line of length 10.
#[test]
fn a_narrow_spike_is_found_from_either_side() {
    let x = 6.543_21;
    let spiked = polyline(&[
        point![0., 0., 0.],
        point![x - 5e-5, 0., 0.],
        point![x, 0.01, 0.],
        point![x + 5e-5, 0., 0.],
        point![10., 0., 0.],
    ]);
    let straight = polyline(&[point![0., 0., 0.], point![10., 0., 0.]]);
    let d = directed_distance(&spiked, &straight, fine());
    assert!(d.certain && (d.max - 0.01).abs() < 1e-9, "{d:?}");
    assert!((d.point - point![x, 0.01, 0.]).norm() < 1e-8);
    // The other way about, the straight line is near the spike's flanks.
    let back = directed_distance(&straight, &spiked, fine());
    assert!(back.certain && (back.max - 5e-5).abs() < 1e-6, "{back:?}");
}

/// A corner cut off: the distance from the corner to the chord.
#[test]
fn a_cut_corner() {
    let corner = polyline(&[point![0., 0., 0.], point![1., 0., 0.], point![1., 1., 0.]]);
    let cut = polyline(&[
        point![0., 0., 0.],
        point![0.999, 0., 0.],
        point![1., 0.001, 0.],
        point![1., 1., 0.],
    ]);
    let d = directed_distance(&corner, &cut, fine());
    assert!(
        d.certain && (d.max - 0.001 / 2f64.sqrt()).abs() < 1e-9,
        "{d:?}"
    );
    assert!((d.at - 0.5).abs() < 1e-6);
}

#[test]
fn mean_and_rms_of_a_triangle() {
    let roof = polyline(&[point![0., 0., 0.], point![1., 0.1, 0.], point![2., 0., 0.]]);
    let floor = polyline(&[point![0., 0., 0.], point![2., 0., 0.]]);
    let d = directed_distance(&roof, &floor, fine());
    assert!((d.mean - 0.05).abs() < 1e-12 && (d.rms - 0.1 / 3f64.sqrt()).abs() < 1e-12);
    assert!((d.max - 0.1).abs() < 1e-12);
}

#[test]
fn dense_sampling_never_finds_more() {
    let zoo = samples::curves();
    for ((name, a), (_, b)) in zoo.iter().zip(zoo.iter().skip(5)) {
        let resolution = Tolerance::absolute(1e-6 * a.bounding_box().diagonal().max(1.0));
        let resolution = resolution.expect("positive");
        let d = directed_distance(a, b, resolution);
        let index = CurveIndex::new(b);
        let [s, t] = a.domain();
        let sampled = (0..=3000)
            .map(|i| {
                index
                    .closest(&a.point(s + (t - s) * f64::from(i) / 3000.0))
                    .distance
            })
            .fold(0.0, f64::max);
        assert!(
            d.certain && sampled <= d.upper_bound + 1e-9,
            "{name}: {sampled} {d:?}"
        );
        assert!(
            d.mean <= d.rms + 1e-12 && d.rms <= d.upper_bound + 1e-12,
            "{name}: {d:?}"
        );
    }
}
