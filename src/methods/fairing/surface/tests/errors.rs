use super::super::request::{EnergyWeights, Solver};
use super::super::validate;
use super::*;
use crate::methods::FitError;
use crate::solver::{Control, Stop};

fn first_path(request: &Request) -> String {
    let issues = validate(request);
    assert!(!issues.is_empty());
    issues[0].path.join("/")
}

fn good_grid() -> Vec<Vec<Option<Point3<f64>>>> {
    grid(bowl, [5, 6], (0.01, &mut Noise::new(20)))
}

#[test]
fn errors_point_to_their_place() {
    let mut rows = good_grid();
    rows[3].pop();
    assert_eq!(first_path(&request(Points::Grid(rows))), "input/grid/3");
    let mut rows = good_grid();
    rows[2][4] = Some(Point3::new(0.0, f64::NAN, 1.0));
    assert_eq!(first_path(&request(Points::Grid(rows))), "input/grid/2/4");
    let one_row = good_grid().into_iter().take(1).collect();
    assert_eq!(first_path(&request(Points::Grid(one_row))), "input/grid");
    let mut column = good_grid();
    for row in &mut column {
        row[1..].fill(None);
    }
    assert_eq!(first_path(&request(Points::Grid(column))), "input/grid");
    let equal = vec![Point3::new(1.0, 2.0, 3.0); 10];
    assert_eq!(
        first_path(&request(Points::Scattered(equal))),
        "input/points"
    );
    let line = (0..10).map(|i| Point3::new(f64::from(i), 2.0 * f64::from(i), 1.0));
    let line = request(Points::Scattered(line.collect()));
    assert_eq!(validate(&line)[0].code, "collinear");
    let few = request(Points::Scattered(vec![Point3::origin(); 3]));
    assert_eq!(validate(&few)[0].code, "too-few-points");
    let mut points = cloud(bowl, 10, (0.0, &mut Noise::new(21)));
    points[6].z = f64::INFINITY;
    assert_eq!(
        first_path(&request(Points::Scattered(points))),
        "input/points/6"
    );
}

#[test]
fn options_are_checked() {
    let good = request(Points::Grid(good_grid()));
    assert!(validate(&good).is_empty());
    for tolerance in [0.0, -1.0, f64::NAN] {
        assert_eq!(
            first_path(&within(good.clone(), tolerance)),
            "options/tolerance"
        );
    }
    let mut bad = good.clone();
    bad.options.tolerance = Some(Tolerance::Each(vec![0.1; 29]));
    assert_eq!(first_path(&bad), "options/tolerance");
    let mut bad = good.clone();
    bad.options.locked = vec![3, 30];
    assert_eq!(first_path(&bad), "options/locked/1");
    let mut bad = good.clone();
    bad.options.freedom = [false; 3];
    assert_eq!(first_path(&bad), "options/freedom");
    let mut bad = good.clone();
    bad.options.control_points = Some([3, 10]);
    assert_eq!(first_path(&bad), "options/control_points");
    let mut bad = good.clone();
    bad.options.solver = Solver::Paper;
    assert_eq!(first_path(&bad), "options/tolerance");
    let mut bad = good;
    bad.options.energy = Some(EnergyWeights {
        alpha11: 1.0,
        alpha22: 0.0,
        beta11: 0.0,
        beta12: 1.0,
        beta22: 1.0,
    });
    assert_eq!(first_path(&bad), "options/energy");
}

/// Stops after so many checks.
struct After(std::sync::atomic::AtomicUsize);

impl Control for After {
    fn check(&self) -> Result<(), Stop> {
        let left = &self.0;
        let order = std::sync::atomic::Ordering::SeqCst;
        let go = left.fetch_update(order, order, |n| n.checked_sub(1));
        go.map(|_| ()).map_err(|_| Stop::Cancelled)
    }
    fn progress(&self, _phase: &'static str, _percent: f64) {}
}

#[test]
fn stops_wherever_it_is_told() {
    let grid = within(request(Points::Grid(good_grid())), 0.02);
    let cloud = request(Points::Scattered(cloud(
        shell,
        800,
        (0.002, &mut Noise::new(22)),
    )));
    for asked in [grid, cloud] {
        for checks in [0, 1, 5, 20] {
            let control = After(std::sync::atomic::AtomicUsize::new(checks));
            let ended = fit(&asked, &control);
            assert_eq!(
                ended.err(),
                Some(FitError::Stopped(Stop::Cancelled)),
                "{checks}"
            );
        }
    }
}

#[test]
fn a_tolerance_that_cannot_be_met_is_a_result() {
    let points = cloud(bowl, 3000, (0.1, &mut Noise::new(23)));
    let outcome = done(&within(request(Points::Scattered(points)), 1e-3));
    assert!(!outcome.within_tolerance);
    assert!(outcome.summary[0].contains("outside tolerance"));
}
