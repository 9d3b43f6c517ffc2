//! The table of hulls: exact plates against the bounded discrete optimum.
//!
//! The optima come from a separate prototype (241 × 241 places in arc length,
//! fans ≤ 20 % of a curve, speeds within 1/8..8). Hulls that may not be copied
//! are read from `shared/data/hulls` above the checkout, if it is there.

use crate::support::*;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A plate may be this much above the optimum.
fn most(optimum: f64) -> f64 {
    (1.1 * optimum).max(optimum + 0.2)
}

/// Fits one panel exactly and holds it against its optimum, degrees; NaN for
/// panels of which none is known.
fn panel(name: &str, curves: &[Points], optimum: f64) {
    let request = request(curves, exact());
    let outcome = fitted(&request);
    let found = &sound(&request, &outcome)[0];
    eprintln!(
        "{name}: {:.3}° mean {:.3}° (optimum {optimum}, certificate {:.3}°), clearance {:.4}, fans {:.1?} %",
        found.twist_max,
        found.twist_mean,
        outcome.plates[0].diagnostics.bottleneck_deg,
        found.clearance,
        found.fans
    );
    assert!(
        !(found.twist_max > most(optimum)),
        "{name}: {:.3}° > {optimum}°",
        found.twist_max
    );
    assert_eq!(found.crossings, 0, "{name}: {found:?}");
    let size = model_size(curves);
    for (k, given) in curves.iter().enumerate() {
        let [points, curve, _] = moved(&outcome, k, given);
        assert!(
            points.max(curve) <= MET * size,
            "{name}: profile {k} moved by {points} {curve}"
        );
    }
    assert!(
        end_offset(&outcome, curves) <= MET * size,
        "{name}: a corner is not reached"
    );
    let plate = &outcome.plates[0];
    assert_eq!(
        plate.within_limits,
        found.twist_max <= 6.0,
        "{}",
        plate.sentence
    );
    if optimum > 6.0 {
        assert!(
            plate.sentence.contains("no set of rulings"),
            "{}",
            plate.sentence
        );
    }
}

fn hull(path: &Path, optima: &[f64]) {
    let text = std::fs::read_to_string(path).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    let panels = file["panels"].as_array().unwrap();
    assert_eq!(panels.len(), optima.len(), "{}", path.display());
    for (names, optimum) in panels.iter().zip(optima) {
        let names = [0, 1].map(|i| names[i].as_str().unwrap());
        let curves = names.map(|n| points_of(&file["curves"][n]));
        panel(
            &format!("{} {}", file["name"], names.join(" - ")),
            &curves,
            *optimum,
        );
    }
}

/// `shared/data/hulls` beside the checkout or above it.
fn shared() -> Option<PathBuf> {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .skip(1)
        .map(|folder| folder.join("shared/data/hulls"))
        .find(|folder| folder.is_dir())
}

fn shared_hull(name: &str, optima: &[f64]) {
    match shared() {
        Some(folder) => hull(&folder.join(format!("{name}.json")), optima),
        None => eprintln!("{name}: skipped, no shared/data/hulls above the checkout"),
    }
}

#[test]
fn bolger_cartopper() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/hulls/bolger_cartopper.json"
    );
    hull(Path::new(path), &[0.51, 8.34]);
}

#[test]
fn wigley() {
    // y = B/2 (1 − (2x/L)²)(1 − (z/T)²), L = 1, B = L/10, T = L/16; three waterlines.
    let waterline = |z: f64| {
        along(41, |t| {
            let (x, depth) = (t - 0.5, z / 0.0625);
            [x, 0.05 * (1.0 - 4.0 * x * x) * (1.0 - depth * depth), z]
        })
    };
    let lines = [0.0, -0.03, -0.05].map(waterline);
    panel("wigley upper", &[lines[1].clone(), lines[0].clone()], 0.18);
    panel("wigley lower", &[lines[2].clone(), lines[1].clone()], 4.63);
}

macro_rules! shared_hulls {
    ($($(#[$mark:meta])* $name:ident: $optima:expr;)*) => {
        $(#[test]
        $(#[$mark])*
        fn $name() {
            shared_hull(stringify!($name), &$optima);
        })*
    };
}

// An order of panels as in the files; NaN: no optimum known.
shared_hulls! {
    canoe_chucno: [15.5, 4.91, 0.33];
    cbmm_sharptown_barge: [0.14];
    culler_sharptown_barge: [2.93];
    fastship_27m_patrol: [0.69, 0.32, 2.60];
    freeship_demo_tug: [5.42, 2.12, 1.49];
    freeship_motorboat_12m: [1.59, 1.56];
    seabee_kayak_sparse: [0.17, 0.06];
    single_sheet_punt: [0.00];
    ubc_fishing_vessel: [2.69, 0.90, 5.28];
    control_edmunds_35ft_sloop: [11.4, f64::NAN];
    control_freeship_40ft_yacht: [18.7];
    control_series60: [12.0];
    control_gokstad_ship: [2.14, 0.42, 0.51, 0.55];
}
