use super::*;
use crate::formats::fair_curve::{FairPoint, Tooth};
use crate::geometry::{BSplineCurve, Parametrization, interpolate};
use nalgebra::{Point3, Vector3};

/// A wavy arc with its comb by differences of the evaluated curve.
fn drawing(dimension: usize) -> FairCurveDrawing {
    let lift = if dimension == 3 { 0.2 } else { 0.0 };
    let place = |x: f64| Point3::new(x, 2.0 * (x / 3.0).sin(), lift * x * x / 9.0);
    let through: Vec<Point3<f64>> = (0..=24).map(|i| place(f64::from(i) * 0.5)).collect();
    let curve = interpolate(&through, 3, Parametrization::ChordLength).expect("a spline");
    let points = through.iter().enumerate().map(|(i, p)| {
        let step = Vector3::new(0.0, 0.01 * (i as f64).sin(), 0.0);
        FairPoint {
            index: i + 1,
            given: p - step,
            now: *p,
            distance: step.norm(),
            tolerance: Some(0.01),
            slip: (i == 7).then_some(*p),
            at_limit: i == 11,
        }
    });
    let mut comb: Vec<Tooth> = Vec::new();
    for i in 0..=100 {
        let jet = curve.derivatives(f64::from(i) / 100.0);
        let normal = Vector3::z().cross(&jet.d1).normalize();
        let s = comb
            .last()
            .map_or(0.0, |t| t.s + (jet.point - t.point).norm());
        let curvature = jet.d2.dot(&normal) / jet.d1.norm_squared();
        comb.push(Tooth {
            s,
            point: jet.point,
            normal,
            curvature,
        });
    }
    FairCurveDrawing {
        title: "Waterline <3>".into(),
        units: "m".into(),
        dimension,
        before: Some(curve.clone()),
        curve,
        points: points.collect(),
        comb,
        verdict: "within_limits".into(),
        summary: vec!["Largest move 0.01 m.".into()],
    }
}

#[test]
fn the_page_shows_curve_curvature_and_words() {
    let page = plot(&drawing(2));
    for expected in [
        "Curve with comb (x–y, m",
        "Curvature κ (1/m)",
        "Tolerance used by each point (%)",
        "moves enlarged ",
        "suspected slip",
        "point at the limit",
        "curvature comb: 10 mm of tooth = ",
        "Waterline &lt;3&gt;",
        "within limits · lengths in m",
        "Largest move 0.01 m.",
    ] {
        assert!(page.contains(expected), "no {expected:?}");
    }
    assert!(!page.contains("NaN") && !page.contains("href") && !page.contains("<script"));
}

#[test]
fn a_curve_in_space_has_two_views() {
    let page = plot(&drawing(3));
    assert!(page.contains("(x–y, m") && page.contains("(x–z, m"));
    assert!(!plot(&drawing(2)).contains("(x–z"));
}

#[test]
fn a_tooth_stands_square_outside_the_bend() {
    let drawing = drawing(2);
    let samples = samples(&drawing.curve);
    let [view] = &view::arrange(&drawing, &samples, 20.0)[..] else {
        panic!("one view");
    };
    // The top of the first wave bends down: its tooth points up the page.
    let top = drawing
        .comb
        .iter()
        .max_by(|a, b| a.point.y.total_cmp(&b.point.y));
    let [foot, tip] = view::tooth(view, top.expect("teeth")).expect("finite");
    assert!(tip[1] < foot[1] - 5.0 && (tip[0] - foot[0]).abs() < 0.5);
}

#[test]
fn broken_and_empty_drawings_are_still_pages() {
    let mut broken = drawing(3);
    broken.points[2].given.y = f64::NAN;
    broken.points[3].tolerance = Some(f64::INFINITY);
    broken.comb[5].curvature = f64::NAN;
    broken.comb[6].normal.x = f64::INFINITY;
    let page = plot(&broken);
    assert!(!page.contains("NaN") && !page.contains("inf"));
    let mut empty = drawing(2);
    empty.points.clear();
    empty.comb.clear();
    empty.before = None;
    assert!(plot(&empty).contains("fair curve"));
    let point = Point3::new(1.0, 1.0, 1.0);
    empty.curve = BSplineCurve::line(point, point, 3).expect("a point is a curve");
    assert!(!plot(&empty).contains("NaN"));
}
