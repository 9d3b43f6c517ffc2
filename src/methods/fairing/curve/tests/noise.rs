//! Points with and without noise.

use super::super::request::{EnergyWeights, Request, Solver};
use super::*;
use crate::geometry::CurveIndex;

#[test]
fn thirteen_points_of_a_half_circle() {
    let mut request = Request::through(half_circle(13), 2);
    let o = fitted(&request);
    let (low, high) = curvature_range(&o);
    assert!(low > 1.0 - 1e-4 && high < 1.0 + 1e-4, "κ in {low}..{high}");
    request.options.tolerance = Some(0.01);
    let (low, high) = curvature_range(&fitted(&request));
    assert!(
        low > 1.0 - 1e-4 && high < 1.0 + 1e-4,
        "κ in {low}..{high} with a tolerance"
    );
    request.options.tolerance = Some(0.0);
    let o = fitted(&request);
    assert!(o.within_limits && o.move_figures.max < 1e-8);
}

#[test]
fn the_papers_solver_on_the_half_circle() {
    let mut request = Request::through(half_circle(13), 2);
    request.options.solver = Solver::Paper;
    request.options.energy = Some(EnergyWeights {
        tension: 0.1,
        bending: 0.1,
        jerk: 100.0,
    });
    let o = fitted(&request);
    assert_eq!(o.curve.degree(), 3);
    let (low, high) = curvature_range(&o);
    assert!(low > 0.998 && high < 1.002, "κ in {low}..{high}");
    request.points = shuffled(request.points);
    request.ordered = false;
    let (low, high) = curvature_range(&fitted(&request));
    let (low, high) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
    assert!(
        low > 0.998 && high < 1.002,
        "κ in {low}..{high} without order"
    );
}

#[test]
fn noise_is_told_from_shape() {
    for (count, seed) in [(200, 3), (2000, 4)] {
        let o = fitted(&Request::through(frame(count, 0.005, seed), 2));
        let noise = o.report.noise;
        assert!((noise / 0.005 - 1.0).abs() < 0.2, "σ̂ = {noise}");
        assert_eq!(o.after.inflections, 2);
        let ratio = o.after.curvature_variation / frame_variation();
        assert!(
            (0.8..1.2).contains(&ratio),
            "{count} points: roughness ratio {ratio}"
        );
        assert!(o.slips.is_empty(), "no slip was made");
    }
}

#[test]
fn a_tolerance_is_kept_by_every_point_and_used() {
    let points = frame(300, 0.005, 11);
    let mut request = Request::through(points.clone(), 2);
    request.options.tolerance = Some(0.014);
    let o = fitted(&request);
    assert!(o.within_limits, "{:?}", o.summary);
    // From outside, on the curve that is delivered.
    let index = CurveIndex::new(&o.curve);
    for p in &points {
        assert!(index.closest(p).distance <= 0.014);
    }
    assert!(o.move_figures.at_limit >= 3, "the room is used");
    assert!(o.moves.iter().any(|m| m.holds_back > 0.0));
    assert!(o.report.gap.is_some_and(|gap| gap < 1e-3));
    // A wider tolerance is fairer.
    let table: Vec<f64> = o
        .trade_off
        .iter()
        .filter(|t| t.reached)
        .map(|t| t.curvature_variation)
        .collect();
    assert!(
        table.len() >= 3 && table.windows(2).all(|w| w[1] <= w[0] * 1.001),
        "{table:?}"
    );
}

#[test]
fn one_stiffness_for_all_is_rougher_at_the_same_largest_move() {
    let mut request = Request::through(frame(200, 0.005, 21), 2);
    let free = fitted(&request).move_figures.max;
    request.options.tolerance = Some(0.9 * free);
    let own = fitted(&request);
    assert!(own.within_limits);
    request.options.solver = Solver::Paper;
    let paper = fitted(&request);
    let ratio = paper.after.curvature_variation / own.after.curvature_variation;
    assert!(ratio > 1.5, "ratio {ratio}");
}

#[test]
fn closed_curves_have_no_seam() {
    let mut noise = Noise(31);
    let at = |k: usize| 2.0 * std::f64::consts::PI * k as f64 / 80.0;
    let points: Vec<Point3<f64>> = (0..80)
        .map(|k| {
            Point3::new(
                3.0 * at(k).cos() + 0.01 * noise.normal(),
                2.0 * at(k).sin(),
                0.0,
            )
        })
        .collect();
    let mut request = Request::through(points, 2);
    request.closed = Some(true);
    for tolerance in [None, Some(0.03)] {
        request.options.tolerance = tolerance;
        let o = fitted(&request);
        assert!(o.closed && o.within_limits);
        let [a, b] = o.curve.domain();
        let (start, end) = (o.curve.derivatives(a), o.curve.derivatives_left(b));
        assert!((start.point - end.point).norm() < 1e-9);
        assert!((start.d1 - end.d1).norm() < 1e-6);
        assert!((start.d2 - end.d2).norm() < 1e-6 * start.d2.norm().max(1.0));
        assert_eq!(o.after.extrema, 4, "an ellipse has four vertices");
    }
}

#[test]
fn helices_have_curvature_and_torsion() {
    let at = |k: usize| 0.1 * k as f64;
    let points = (0..120)
        .map(|k| Point3::new(at(k).cos(), at(k).sin(), 0.5 * at(k)))
        .collect();
    let o = fitted(&Request::through(points, 3));
    // κ = 1/(1 + c²), τ = c/(1 + c²) for the pitch c = ½.
    for t in &o.comb[20..o.comb.len() - 20] {
        assert!((t.curvature - 0.8).abs() < 1e-3, "κ {}", t.curvature);
        assert!((t.torsion - 0.4).abs() < 5e-3, "τ {}", t.torsion);
    }
}

/// Tolerances from many deviations down to two: the tighter, the
/// rougher, and never a cusp (which made ∫ κ′² 1e10 before the way into the
/// bounds was a convex one).
#[test]
fn tight_tolerances_cost_fairness_by_degrees() {
    const SIGMA: f64 = 0.005;
    let points = frame(200, SIGMA, 11);
    let mut before = 0.0;
    for deviations in [4.0, 3.0, 2.5, 2.0] {
        let mut request = Request::through(points.clone(), 2);
        request.options.tolerance = Some(deviations * SIGMA);
        let outcome = fitted(&request);
        assert!(outcome.within_limits, "{deviations}: {:?}", outcome.summary);
        let rough = outcome.after.curvature_variation;
        assert!(
            rough >= before * 0.99 && rough < 1e3,
            "{deviations} deviations: {rough} after {before}"
        );
        before = rough;
    }
}

/// Of many points only some are asked at first, and only some are bounded:
/// nothing of that may show.
#[test]
fn many_points_are_all_kept() {
    let mut request = Request::through(frame(4500, 0.005, 101), 2);
    let free = fitted(&request);
    assert!((free.report.noise / 0.005 - 1.0).abs() < 0.05);
    assert!((free.after.curvature_variation / frame_variation() - 1.0).abs() < 0.05);
    request.options.tolerance = Some(0.022);
    let o = fitted(&request);
    assert!(o.within_limits);
    assert!(o.report.gap.expect("there is a gap") < 1e-3);
    assert!(o.after.curvature_variation < free.after.curvature_variation);
    // The points that hold it back are at their limit.
    let most = o.moves.iter().map(|m| m.holds_back).fold(0.0, f64::max);
    let holding = o.moves.iter().filter(|m| m.holds_back > 0.05 * most);
    assert!(holding.clone().count() >= 4);
    for m in holding {
        assert!(
            m.distance > 0.99 * 0.022,
            "point {} at {}",
            m.index,
            m.distance
        );
    }
    let wider = o
        .trade_off
        .iter()
        .filter(|t| t.reached && t.tolerance > 0.022);
    for row in wider {
        assert!(row.curvature_variation < o.after.curvature_variation);
    }
}

/// Straight or round, the curve reaches the ends of its points.
#[test]
fn stiff_curves_reach_their_ends() {
    let mut noise = Noise(7);
    let points: Vec<Point3<f64>> = (0..300)
        .map(|k| {
            let s = f64::from(k) / 299.0;
            Point3::new(
                8.0 * s + 0.005 * noise.normal(),
                0.005 * noise.normal(),
                0.0,
            )
        })
        .collect();
    let o = fitted(&Request::through(points.clone(), 2));
    assert!((o.curve.start().x - points[0].x).abs() < 1e-4);
    assert!((o.curve.end().x - points[299].x).abs() < 1e-4);
}
