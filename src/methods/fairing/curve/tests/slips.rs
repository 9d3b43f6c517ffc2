//! Slips: one mis-typed offset, a sign, gross outliers.

use super::super::request::Request;
use super::*;

/// Half-breadths of a waterline read off to about a centimetre.
fn waterline() -> Vec<Point3<f64>> {
    let mut noise = Noise(17);
    (0..33)
        .map(|k| {
            let x = f64::from(k) * 3.0;
            let t = (x - 48.0) / 52.0;
            Point3::new(
                x,
                12.0 * (1.0 - t * t).powf(0.8) + 0.01 * noise.normal(),
                4.0,
            )
        })
        .collect()
}

#[test]
fn a_digit_that_was_mistyped_is_found_with_its_value() {
    for (index, error) in [(9, 0.4), (20, -10.0), (27, 1.0)] {
        let mut points = waterline();
        let right = points[index];
        points[index].y += error;
        let mut request = Request::through(points, 3);
        request.options.freedom = [false, true, false];
        let o = fitted(&request);
        let slip = o.slips.first().expect("the slip is found");
        assert_eq!(slip.index, index);
        assert!(slip.chance < 1e-3 && slip.deviations > 8.0);
        assert!(
            (slip.expected.y - right.y).abs() < 0.06,
            "{} for {}",
            slip.expected.y,
            right.y
        );
        assert!(!slip.disregarded);
        request.options.robust = true;
        let robust = fitted(&request);
        assert!(robust.slips[0].disregarded);
        assert!((robust.moves[index].now.y - right.y).abs() < 0.06);
    }
}

#[test]
fn five_per_cent_of_outliers_do_not_bend_a_robust_curve() {
    let clean = frame(600, 0.005, 41);
    let mut points = clean.clone();
    let mut noise = Noise(43);
    for k in 0..30 {
        let p = &mut points[k * 20 + 7];
        p.x += 0.4 * noise.normal();
        p.y += 0.4 * noise.normal();
    }
    let mut request = Request::through(points, 2);
    request.options.robust = true;
    let o = fitted(&request);
    let ratio = o.after.curvature_variation / frame_variation();
    assert!((0.8..1.25).contains(&ratio), "roughness ratio {ratio}");
    assert!(o.slips.len() >= 24 && o.slips.iter().all(|s| s.index % 20 == 7));
}

/// At random places, so that some are neighbours.
#[test]
fn outliers_in_a_row_are_outliers_too() {
    let mut noise = Noise(47);
    let mut points = frame(2000, 0.005, 48);
    let mut bad = Vec::new();
    for (k, p) in points.iter_mut().enumerate() {
        // Three in a row among them.
        if noise.uniform() < 0.05 || (900..903).contains(&k) {
            p.x += 0.3 * noise.normal();
            p.y += 0.3 * noise.normal();
            bad.push(k);
        }
    }
    let mut request = Request::through(points, 2);
    request.options.robust = true;
    let o = fitted(&request);
    let ratio = o.after.curvature_variation / frame_variation();
    assert!((0.8..1.25).contains(&ratio), "roughness ratio {ratio}");
    let gross = 0.9 * bad.len() as f64;
    assert!(
        o.slips.len() as f64 >= gross,
        "{} of {}",
        o.slips.len(),
        bad.len()
    );
    assert!(o.slips.iter().filter(|s| bad.contains(&s.index)).count() + 3 >= o.slips.len());
}

/// The zeros beyond the end of a waterline are no slips, nor is the first
/// breadth after them.
#[test]
fn zeros_that_end_are_an_edge() {
    let breadth = |k: i32| {
        let s = f64::from(k - 3) / 18.0;
        if k < 3 {
            0.0
        } else {
            6.0 * (s * (2.0 - s)).sqrt().min(1.0) + 0.8
        }
    };
    let points = (0..22).map(|k| Point3::new(f64::from(k), breadth(k), 0.0));
    let o = fitted(&Request::through(points.collect(), 2));
    let zeros: Vec<usize> = o.slips.iter().map(|s| s.index).filter(|i| *i < 3).collect();
    assert!(zeros.is_empty(), "{zeros:?}");
}
