//! The writers on a whole hull: a naive loft between the profiles of a fishing
//! vessel (Zheng & Bo 2018, table 1), corner to corner, with different rulings
//! on either side of every chine. The files are left in the test's folder for
//! a look and for outside readers (`.ci/run`).

use mouldloft::formats::length_unit::LengthUnit;
use mouldloft::formats::mesh_out::MeshDrawing;
use mouldloft::formats::plates::{HullDrawing, PlateDrawing, ProfileLine, RulingLine};
use mouldloft::formats::{csv, obj, svg};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

const STATIONS: [f64; 13] = [
    0.0, 7.0, 14.0, 21.0, 28.0, 35.0, 42.0, 49.0, 56.0, 59.5, 63.0, 66.5, 70.0,
];

type Offsets = ([f64; 13], [f64; 13]);

const DECK: Offsets = (
    [
        11.48, 11.48, 11.48, 11.48, 11.48, 11.49, 11.16, 9.96, 7.91, 6.54, 5.03, 3.4, 1.71,
    ],
    [
        12.72, 11.91, 11.21, 10.27, 10.27, 10.3, 10.58, 11.21, 12.06, 12.55, 13.08, 13.64, 14.19,
    ],
);
const UPPER: Offsets = (
    [
        10.36, 10.52, 10.64, 10.75, 10.82, 10.78, 10.35, 9.09, 6.84, 5.34, 3.67, 1.89, 0.0,
    ],
    [
        7.77, 6.1, 4.78, 3.71, 2.9, 2.7, 3.25, 4.46, 5.99, 6.79, 7.69, 8.35, 9.16,
    ],
);
const LOWER: Offsets = (
    [
        8.78, 8.96, 9.11, 9.23, 9.31, 9.29, 9.04, 8.23, 6.49, 5.19, 3.65, 1.86, 0.0,
    ],
    [
        6.98, 5.09, 3.59, 2.35, 1.51, 1.24, 1.77, 2.86, 4.32, 5.09, 5.85, 6.66, 7.39,
    ],
);
const KEEL: Offsets = (
    [0.0; 13],
    [
        5.71, 3.62, 1.8, 0.49, -0.12, 0.0, 0.19, 0.46, 0.71, 0.8, 0.96, 1.11, 2.99,
    ],
);

/// A cubic Hermite curve through the offsets with finite-difference slopes;
/// `s` from 0 to 1.
fn curve((y, z): &Offsets, s: f64) -> Point3<f64> {
    let x = 70.0 * s;
    let i = STATIONS.windows(2).position(|w| x <= w[1]).unwrap_or(11);
    let h = STATIONS[i + 1] - STATIONS[i];
    let t = (x - STATIONS[i]) / h;
    let slope = |v: &[f64; 13], k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(12));
        (v[b] - v[a]) / (STATIONS[b] - STATIONS[a])
    };
    let at = |v: &[f64; 13]| {
        let (p, q) = (v[i], v[i + 1]);
        let (m, n) = (slope(v, i) * h, slope(v, i + 1) * h);
        (2.0 * p - 2.0 * q + m + n) * t.powi(3)
            + (-3.0 * p + 3.0 * q - 2.0 * m - n) * t * t
            + m * t
            + p
    };
    Point3::new(x, at(y), at(z))
}

fn tangent(offsets: &Offsets, s: f64) -> Vector3<f64> {
    let h = 1e-5;
    let (a, b) = ((s - h).max(0.0), (s + h).min(1.0));
    (curve(offsets, b) - curve(offsets, a)) / (b - a)
}

/// A plate with rulings at equal `s` and a fan of half a station at the stern.
fn plate(name: &str, from: &Offsets, to: &Offsets, count: i32) -> PlateDrawing {
    let ruling = |i: i32| {
        let u = f64::from(i) / f64::from(count);
        let s = ((u - 0.05) / 0.95).max(0.0);
        let (p, q) = (curve(from, s), curve(to, u));
        let line = q - p;
        let (n, m) = (line.cross(&tangent(from, s)), line.cross(&tangent(to, u)));
        let twist = n.cross(&m).dot(&line).signum() * n.angle(&m).to_degrees();
        RulingLine {
            u,
            from: p,
            to: q,
            twist_deg: twist,
            bend_radius_from: 9.0,
            bend_radius_to: f64::INFINITY,
        }
    };
    PlateDrawing {
        name: name.into(),
        rulings: (0..=count).map(ruling).collect(),
        rolls: Vec::new(),
        within_limits: false,
    }
}

fn hull() -> HullDrawing {
    let line = |name: &str, offsets: &Offsets| ProfileLine {
        name: name.into(),
        points: (0..=280)
            .map(|i| curve(offsets, f64::from(i) / 280.0))
            .collect(),
    };
    HullDrawing {
        title: "Fishing vessel, naive loft".into(),
        units: "ft".into(),
        twist_limit_deg: 6.0,
        plates: vec![
            plate("main deck – upper chine", &DECK, &UPPER, 150),
            plate("upper chine – lower chine", &UPPER, &LOWER, 131),
            plate("lower chine – profile", &LOWER, &KEEL, 180),
        ],
        profiles: vec![
            line("main deck", &DECK),
            line("upper chine", &UPPER),
            line("lower chine", &LOWER),
            line("profile", &KEEL),
        ],
        verdict: "outside_limits".into(),
        summary: vec![
            "A loft of equal parameters, as a drawing programme makes it, twists its plates; \
             this page shows where, and how far beyond the limit that a yard sets for cold bending."
                .into(),
            "Plate 3 (lower chine – profile): far above the limit near the bow.".into(),
        ],
    }
}

fn leave(name: &str, text: &str) {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(path, text).expect("the test folder is writable");
}

#[test]
fn the_mesh_is_open_at_the_hull_s_edge_alone() {
    let text = obj::write(&MeshDrawing::of_hull(&hull(), LengthUnit::Foot));
    leave("loft.obj", &text);
    let numbers = |line: &str| -> Vec<usize> {
        line.split(' ')
            .skip(1)
            .map(|n| n.parse().expect("an index"))
            .collect()
    };
    let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
    for face in text.lines().filter(|l| l.starts_with("f ")).map(numbers) {
        for (a, b) in [(face[0], face[1]), (face[1], face[2]), (face[2], face[0])] {
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { 16 };
        }
    }
    assert!(
        edges.values().all(|n| [1, 16, 17].contains(n)),
        "a non-manifold or turned edge"
    );
    // Deck and keel carry their own plates' rulings, transom and bow one
    // ruling a plate; the chines' bow ends lie apart.
    let open = edges.values().filter(|n| **n != 17).count();
    let deck = 150 - 7;
    let keel = 180;
    assert_eq!(open, deck + keel + 2 * 3);
    assert_eq!(text.lines().filter(|l| l.starts_with("o ")).count(), 3);
}

#[test]
fn the_table_has_a_row_a_ruling() {
    let table = csv::roll_table(&hull());
    leave("loft.csv", &table);
    assert_eq!(table.matches("\r\n").count(), 1 + 151 + 132 + 181);
}

#[test]
fn the_lines_plan_is_drawn() {
    let page = svg::lines_plan(&hull(), None);
    leave("loft.svg", &page);
    assert!(page.starts_with("<svg ") && page.ends_with("</svg>\n"));
    assert!(page.len() < 300_000, "{} bytes", page.len());
}
