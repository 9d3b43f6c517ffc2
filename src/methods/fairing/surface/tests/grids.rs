use super::super::request::Solver;
use super::*;

#[test]
fn finds_noise_and_truth_without_being_told() {
    let sigma = 0.03;
    let points = grid(bowl, [25, 18], (sigma, &mut Noise::new(1)));
    let outcome = done(&request(Points::Grid(points)));
    assert!(
        (outcome.noise / sigma - 1.0).abs() < 0.15,
        "{}",
        outcome.noise
    );
    let off = from_truth(&outcome.surface, bowl);
    assert!(off < 0.3 * sigma, "{off}");
    assert!(outcome.after.isophote_roughness < 0.5 * outcome.before.isophote_roughness);
    assert_eq!(outcome.moves.len(), 25 * 18);
    assert!(outcome.slips.len() <= 2, "{:?}", outcome.slips);
}

#[test]
fn exact_points_are_met() {
    let points = grid(bowl, [25, 18], (0.0, &mut Noise::new(1)));
    let outcome = done(&request(Points::Grid(points)));
    assert!(outcome.move_max < 2e-3, "{}", outcome.move_max);
    assert!(from_truth(&outcome.surface, bowl) < 1e-3);
}

#[test]
fn no_point_leaves_its_tolerance_and_the_paper_is_rougher() {
    let points = grid(bowl, [20, 15], (0.03, &mut Noise::new(2)));
    for tolerance in [0.05, 0.1, 0.3] {
        let asked = within(request(Points::Grid(points.clone())), tolerance);
        let outcome = done(&asked);
        assert!(outcome.within_tolerance, "{:?}", outcome.summary);
        for p in points.iter().flatten().flatten() {
            let d = distance(&outcome.surface, p);
            assert!(d <= tolerance * (1.0 + 1e-9), "{d} for {tolerance}");
        }
        assert!(!outcome.active.is_empty());
        let pulls: f64 = outcome.active.iter().map(|a| a.pull_percent.abs()).sum();
        assert!((pulls - 100.0).abs() < 0.1);
        if tolerance < 0.2 {
            let mut paper = asked;
            paper.options.solver = Solver::Paper;
            paper.options.boundary_factor = Some(1.0);
            let paper = done(&paper);
            assert!(paper.within_tolerance);
            let ratio = paper.after.isophote_roughness / outcome.after.isophote_roughness;
            assert!(ratio > 1.5, "{ratio} at {tolerance}");
        }
    }
}

#[test]
fn one_tolerance_a_point_and_points_that_are_locked() {
    let points = grid(bowl, [14, 12], (0.03, &mut Noise::new(3)));
    let mut asked = request(Points::Grid(points.clone()));
    let each: Vec<f64> = (0..14 * 12)
        .map(|i| if i % 2 == 0 { 0.05 } else { 0.4 })
        .collect();
    asked.options.tolerance = Some(Tolerance::Each(each.clone()));
    asked.options.locked = vec![0, 77];
    let outcome = done(&asked);
    assert!(outcome.within_tolerance);
    for m in &outcome.moves {
        assert!(m.distance.abs() <= each[m.index], "{m:?}");
    }
    for i in [0, 77] {
        assert!(outcome.moves[i].distance.abs() < 1e-6);
    }
}

#[test]
fn points_move_along_free_axes_only() {
    let points = grid(bowl, [16, 12], (0.02, &mut Noise::new(4)));
    for tolerance in [None, Some(0.05)] {
        let mut asked = request(Points::Grid(points.clone()));
        asked.options.freedom = [false, false, true];
        asked.options.tolerance = tolerance.map(Tolerance::Same);
        let outcome = done(&asked);
        assert!(outcome.within_tolerance, "{:?}", outcome.summary);
        for (m, p) in outcome.moves.iter().zip(points.iter().flatten().flatten()) {
            assert!(
                (m.now.x - p.x).abs() < 1e-4 && (m.now.y - p.y).abs() < 1e-4,
                "{m:?} {p}"
            );
        }
    }
}

#[test]
fn a_slip_is_found_and_given_its_value() {
    let mut points = grid(bowl, [20, 15], (0.02, &mut Noise::new(5)));
    let right = points[7][9].expect("all are there");
    points[7][9] = Some(right + Vector3::new(0.0, 0.0, 1.0));
    let outcome = done(&request(Points::Grid(points)));
    let slip = &outcome.slips[0];
    assert_eq!(slip.cell, Some([7, 9]));
    assert!(slip.confidence > 0.99 && slip.sigmas > 10.0);
    let left = distance(&outcome.surface, &slip.expected);
    let off = bowl(7.0 / 19.0, 9.0 / 14.0) - slip.expected;
    // Along the normal: the slip's foot is not the cell's own place.
    assert!(left < 0.2 && off.norm() < 0.7, "{left} {off}");
    assert_eq!(outcome.moves.len(), 300);
}

#[test]
fn gross_errors_are_shrugged_off_when_asked() {
    let noise = &mut Noise::new(6);
    let mut points = grid(bowl, [24, 18], (0.02, noise));
    for p in points.iter_mut().flatten().flatten() {
        if noise.even() < 0.05 {
            p.z += 2.0;
        }
    }
    let mut asked = request(Points::Grid(points));
    asked.options.robust = true;
    let outcome = done(&asked);
    let off = from_truth(&outcome.surface, bowl);
    assert!(off < 0.01, "{off}");
    assert!(outcome.slips.len() > 10);
}

#[test]
fn missing_cells_cost_nothing_but_themselves() {
    let mut points = grid(bowl, [20, 15], (0.02, &mut Noise::new(7)));
    for row in points.iter_mut().skip(5).take(4) {
        for cell in row.iter_mut().skip(4).take(5) {
            *cell = None;
        }
    }
    let outcome = done(&request(Points::Grid(points)));
    assert_eq!(outcome.outline.holes.len(), 1);
    assert_eq!(outcome.moves.len(), 280);
    assert!(from_truth(&outcome.surface, bowl) < 0.02);
}

#[test]
fn far_from_the_origin_and_in_other_units_it_is_the_same() {
    let points = grid(bowl, [12, 10], (0.02, &mut Noise::new(8)));
    let here = done(&request(Points::Grid(points.clone())));
    let moved = |p: &Point3<f64>| Point3::from(1000.0 * p.coords + Vector3::new(1e6, -3e6, 2e6));
    let there: Vec<Vec<_>> = points
        .iter()
        .map(|row| row.iter().map(|p| p.as_ref().map(moved)).collect())
        .collect();
    let there = done(&request(Points::Grid(there)));
    assert!((there.noise / here.noise / 1000.0 - 1.0).abs() < 1e-3);
    for (a, b) in here.moves.iter().zip(&there.moves) {
        assert!((1000.0 * a.distance - b.distance).abs() < 0.01);
    }
}

#[test]
fn small_and_long_grids_are_fitted() {
    for size in [[2, 2], [2, 9], [3, 3], [5, 40], [40, 4]] {
        let points = grid(bowl, size, (0.01, &mut Noise::new(9)));
        let outcome = done(&request(Points::Grid(points)));
        assert!(outcome.move_max.is_finite(), "{size:?}");
    }
}

#[test]
fn threads_do_not_matter() {
    let points = grid(bowl, [20, 15], (0.03, &mut Noise::new(10)));
    let asked = within(request(Points::Grid(points)), 0.1);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| done(&asked))
    };
    assert_eq!(run(1), run(3));
}

/// A chine along a row and a knuckle along a column.
fn chined(u: f64, v: f64) -> Point3<f64> {
    let p = bowl(u, v);
    let corner = 2.0 * (u - 0.5).max(0.0) - 1.5 * (0.25 - v).max(0.0);
    p + Vector3::z() * corner
}

#[test]
fn knuckles_stay_where_they_are_told() {
    let sigma = 0.01;
    // Rows and columns 12 and 6 lie on the corners.
    let rows = grid(chined, [25, 25], (sigma, &mut Noise::new(31)));
    let smooth = done(&request(Points::Grid(rows.clone())));
    let mut asked = request(Points::Grid(rows));
    asked.options.knuckles = [vec![12], vec![6]];
    let kept = done(&asked);
    assert!((kept.noise / sigma - 1.0).abs() < 0.15, "{}", kept.noise);
    let [with, without] = [&kept, &smooth].map(|o| from_truth(&o.surface, chined));
    assert!(
        with < 0.5 * sigma && with < 0.6 * without,
        "{with} {without}"
    );
    // The corner is a corner: 2/10 of slope from one side to the other.
    let knots = &kept.surface.knots()[0];
    let corner = knots[6..knots.len() - 6].windows(5).find(|w| w[0] == w[4]);
    let (u, v) = (corner.expect("a knot of five")[0], kept.moves[15].at[1]);
    let slope = |h: f64| {
        let [a, b] = [0.0, h].map(|h| kept.surface.point(u + h, v));
        (b.z - a.z) / (b.x - a.x)
    };
    let change = slope(1e-4) - slope(-1e-4);
    assert!((change - 0.2).abs() < 0.03, "{change}");
    asked.options.knuckles = [vec![0], vec![24]];
    let issues = super::super::validate(&asked);
    assert_eq!(issues[0].path.join("/"), "options/knuckle_rows/0");
    assert_eq!(issues[1].path.join("/"), "options/knuckle_columns/0");
}
