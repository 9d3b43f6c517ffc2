use super::outcome::CellKind;
use super::request::Options;
use super::*;
use crate::methods::fairing::surface::tests::Noise;
use crate::solver::Unwatched;

/// Half-breadth of a Wigley-like hull of length 20, depth 2, beam 4, whose
/// stem and stern rake: outside it is negative.
fn hull(x: f64, z: f64) -> f64 {
    let ends = 9.0 + 0.4 * z;
    2.0 * (1.0 - (x / ends).powi(2)) * (1.0 - ((2.0 - z) / 2.3).powi(2))
}

fn table(sigma: f64, seed: u64) -> Request {
    let stations: Vec<f64> = (0..=20).map(|i| -10.0 + f64::from(i)).collect();
    let waterlines: Vec<f64> = (0..=8).map(|j| 0.25 * f64::from(j)).collect();
    let noise = &mut Noise::new(seed);
    let mut cell = |x: f64, z: f64| {
        let y = hull(x, z);
        Some(if y > 0.0 {
            (y + sigma * noise.normal()).max(0.001)
        } else {
            0.0
        })
    };
    let half_breadths = stations
        .iter()
        .map(|x| waterlines.iter().map(|z| cell(*x, *z)).collect())
        .collect();
    Request {
        stations,
        waterlines,
        half_breadths,
        options: Options::default(),
    }
}

fn done(request: &Request) -> Outcome {
    fit(request, &Unwatched).expect("a valid table")
}

#[test]
fn the_table_is_faired_towards_the_hull() {
    let sigma = 0.02;
    let request = table(sigma, 1);
    let outcome = done(&request);
    assert!(
        (outcome.surface.noise / sigma - 1.0).abs() < 0.25,
        "{}",
        outcome.surface.noise
    );
    let (mut before, mut after, mut cells) = (0.0, 0.0, 0);
    for (i, row) in outcome.table.iter().enumerate() {
        for (j, cell) in row.iter().enumerate() {
            let truth = hull(request.stations[i], request.waterlines[j]);
            if cell.kind == CellKind::Measured {
                let (old, new) = (cell.old.expect("measured"), cell.new.expect("inside"));
                before += (old - truth).powi(2);
                after += (new - truth).powi(2);
                cells += 1;
                assert!((cell.change.expect("both") - (new - old)).abs() < 1e-12);
            } else {
                assert!(truth < 0.05, "cell {i} {j} is {:?}", cell.kind);
            }
        }
    }
    assert!(cells > 150);
    assert!(after < 0.25 * before, "{after} {before}");
}

#[test]
fn stations_and_waterlines_stay_in_their_planes() {
    let request = table(0.01, 2);
    let outcome = done(&request);
    for (x, pieces) in request.stations.iter().zip(&outcome.stations) {
        for curve in pieces {
            let [a, b] = curve.domain();
            for k in 0..=10 {
                let p = curve.point(a + (b - a) * f64::from(k) / 10.0);
                assert!((p.x - x).abs() < 1e-6, "{p}");
                assert!(p.y > -1e-6);
            }
        }
    }
    for (z, pieces) in request.waterlines.iter().zip(&outcome.waterlines) {
        assert!(!pieces.is_empty());
        for curve in pieces {
            let [a, b] = curve.domain();
            assert!((curve.point(0.5 * (a + b)).z - z).abs() < 1e-6);
        }
    }
    assert_eq!(outcome.buttocks.len(), 3);
    for buttock in &outcome.buttocks {
        assert!(!buttock.curves.is_empty());
        for curve in &buttock.curves {
            let [a, b] = curve.domain();
            let p = curve.point(0.5 * (a + b));
            assert!((p.y - buttock.y).abs() < 1e-3, "{p} for {}", buttock.y);
            assert!((hull(p.x, p.z) - buttock.y).abs() < 0.03);
        }
    }
}

#[test]
fn no_cell_leaves_its_tolerance() {
    let mut request = table(0.02, 3);
    request.options.tolerance = Some(0.04);
    request.options.cell_tolerances = vec![(10, 4, 0.005)];
    request.options.locked = vec![[9, 5]];
    let outcome = done(&request);
    assert!(outcome.surface.within_tolerance, "{:?}", outcome.summary);
    for cell in outcome.table.iter().flatten() {
        if cell.kind == CellKind::Measured {
            assert!(cell.change.expect("both").abs() <= 0.04 + 1e-9);
        }
    }
    assert!(outcome.table[10][4].change.expect("both").abs() <= 0.005 + 1e-9);
    assert!(outcome.table[9][5].change.expect("both").abs() <= 1e-6);
}

#[test]
fn a_mistyped_cell_is_found_with_its_value() {
    let mut request = table(0.01, 4);
    request.half_breadths[8][3] = request.half_breadths[8][3].map(|y| y + 0.5);
    let outcome = done(&request);
    let slip = outcome.slips.first().expect("one slip");
    assert_eq!((slip.station, slip.waterline), (8, 3));
    let truth = hull(request.stations[8], request.waterlines[3]);
    assert!((slip.expected - truth).abs() < 0.03, "{slip:?} {truth}");
    assert!(slip.confidence > 0.99);
}

#[test]
fn gaps_inside_are_filled_and_marked() {
    let mut request = table(0.005, 5);
    request.half_breadths[10][4] = None;
    request.half_breadths[11][4] = None;
    request.half_breadths[0][0] = None;
    let outcome = done(&request);
    let cell = outcome.table[10][4];
    assert_eq!(
        (cell.kind, cell.old, cell.change),
        (CellKind::Filled, None, None)
    );
    let truth = hull(request.stations[10], request.waterlines[4]);
    assert!((cell.new.expect("filled") - truth).abs() < 0.02);
    assert_eq!(outcome.table[0][0].kind, CellKind::Outside);
    assert_eq!(outcome.table[0][0].new, None);
}

#[test]
fn a_chine_is_kept_where_it_is_told() {
    let sigma = 0.002;
    let noise = &mut Noise::new(10);
    // Above the fifth waterline the side stands upright.
    let chined = |x: f64, z: f64| hull(x, z.min(1.0)) + 0.02 * (z - 1.0).max(0.0);
    let mut request = table(0.0, 1);
    request.stations.retain(|x| x.abs() < 8.0);
    request.half_breadths = (request.stations.iter())
        .map(|x| {
            let cell = |z: &f64| Some(chined(*x, *z) + sigma * noise.normal());
            request.waterlines.iter().map(cell).collect()
        })
        .collect();
    // How much dy/dz of the middle station changes across z = 1.
    let corner = |o: &Outcome| {
        let station = &o.stations[request.stations.len() / 2][0];
        let [a, b] = station.domain();
        let at = |t: f64| station.point(a + t * (b - a));
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at(middle).z < 1.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let slope = |h: f64| (at(low + h).y - at(low).y) / (at(low + h).z - at(low).z);
        slope(-1e-4) - slope(1e-4)
    };
    let smooth = corner(&done(&request));
    let mut asked = request.clone();
    asked.options.knuckle_waterlines = vec![4];
    let kept = corner(&done(&asked));
    let want = (hull(0.0, 1.0) - hull(0.0, 1.0 - 1e-6)) / 1e-6 - 0.02;
    assert!((kept - want).abs() < 0.1 * want, "{kept} for {want}");
    assert!(smooth.abs() < 0.05 * want, "{smooth}");
    asked.options.knuckle_waterlines = vec![8];
    let issues = validate(&asked);
    assert_eq!(issues[0].path.join("/"), "options/knuckle_waterlines/0");
}

/// A stem that ends between two stations: the surface passes behind the
/// centreline at the next one, the table does not.
#[test]
fn no_half_breadth_is_negative() {
    for (seed, tolerance) in [(8, None), (9, Some(0.06))] {
        let mut request = table(0.02, seed);
        request.options.tolerance = tolerance;
        // Zeros a little beyond the ending, as tables have them, and a gap.
        request.half_breadths[0][4] = None;
        for (row, x) in request.half_breadths.iter_mut().zip(&request.stations) {
            for (cell, z) in row.iter_mut().zip(&request.waterlines) {
                if hull(*x, *z) < 0.05 {
                    *cell = cell.map(|_| 0.0);
                }
            }
        }
        let outcome = done(&request);
        let mut at_zero = 0;
        for cell in outcome.table.iter().flatten() {
            let new = cell.new.unwrap_or(1.0);
            assert!(new >= 0.0, "{cell:?}");
            at_zero += usize::from(new == 0.0);
        }
        assert!(at_zero > 0, "no ending was behind the centreline");
        for m in &outcome.surface.moves {
            assert!(m.now.y >= 0.0);
            let old = request.half_breadths[m.index / 9][m.index % 9].expect("measured");
            assert!(((m.now.y - old).abs() - m.distance.abs()).abs() < 1e-9);
        }
    }
}

#[test]
fn zeros_beyond_the_hull_do_not_bend_it() {
    let with = done(&table(0.005, 6));
    let mut without = table(0.005, 6);
    let mut outside = 0;
    for (row, cells) in with.table.iter().zip(&mut without.half_breadths) {
        for (cell, given) in row.iter().zip(cells) {
            if cell.kind == CellKind::Outside {
                *given = None;
                outside += 1;
            }
        }
    }
    assert!(outside > 5);
    let without = done(&without);
    for (a, b) in with
        .table
        .iter()
        .flatten()
        .zip(without.table.iter().flatten())
    {
        if let (Some(a), Some(b)) = (a.new, b.new) {
            assert!((a - b).abs() < 0.01);
        }
    }
    assert!(with.notes.iter().any(|n| n.contains("beyond")));
}

#[test]
fn errors_point_to_their_cell() {
    let path = |request: &Request| validate(request)[0].path.join("/");
    let mut bad = table(0.0, 7);
    bad.half_breadths[3][7] = Some(-0.1);
    assert_eq!(path(&bad), "input/offsets/y/3/7");
    let mut bad = table(0.0, 7);
    bad.half_breadths[2][1] = Some(f64::NAN);
    assert_eq!(path(&bad), "input/offsets/y/2/1");
    let mut bad = table(0.0, 7);
    bad.half_breadths[5].pop();
    assert_eq!(path(&bad), "input/offsets/y/5");
    let mut bad = table(0.0, 7);
    bad.stations[4] = bad.stations[3];
    assert_eq!(path(&bad), "input/offsets/stations/4");
    let mut bad = table(0.0, 7);
    bad.waterlines.swap(2, 3);
    assert_eq!(path(&bad), "input/offsets/waterlines/3");
    let mut bad = table(0.0, 7);
    bad.options.tolerance = Some(-1.0);
    assert_eq!(path(&bad), "options/tolerance");
    let mut bad = table(0.0, 7);
    for row in &mut bad.half_breadths {
        row.fill(Some(0.0));
    }
    assert_eq!(path(&bad), "input/offsets/y");
}

/// Tables of few lines, even or not, smooth to the last digit: fitted with what
/// they are, and no cell accused.
#[test]
fn small_tables_are_fitted_whatever_their_shape() {
    let shapes: [fn(f64, f64) -> f64; 5] = [
        |_, _| 2.0,
        |x, z| 1.0 + x + 0.5 * z,
        |x, z| 1.0 + x * z,
        |x, _| 1.0 + x * x,
        |x, z| 2.0 + (2.0 * x).sin() * (0.7 * z).cos(),
    ];
    let places = |n: usize, even: bool| {
        let place = |k: usize| {
            let t = k as f64 / (n - 1) as f64;
            if even { t } else { t * (0.3 + 0.7 * t) }
        };
        (0..n).map(place).collect::<Vec<f64>>()
    };
    for (m, n) in [
        (2, 2),
        (2, 3),
        (2, 6),
        (3, 4),
        (5, 5),
        (5, 8),
        (6, 9),
        (7, 5),
    ] {
        for even in [true, false] {
            for (k, shape) in shapes.iter().enumerate() {
                let [along, up] = [m, n].map(|n| places(n, even));
                let row = |x: &f64| up.iter().map(|z| Some(shape(*x, *z))).collect();
                let outcome = done(&Request {
                    half_breadths: along.iter().map(row).collect(),
                    stations: along.iter().map(|x| 3.0 * x).collect(),
                    waterlines: up.clone(),
                    options: Options::default(),
                });
                let name = format!("{m} by {n}, shape {k}, even {even}");
                assert!(outcome.slips.is_empty(), "{name}: {:?}", outcome.slips);
                // Fewer lines cannot tell a bend from noise.
                if m.min(n) >= 5 {
                    let moved = outcome.surface.move_max;
                    assert!(moved < 1e-5, "{name}: {moved}");
                }
            }
        }
    }
}
