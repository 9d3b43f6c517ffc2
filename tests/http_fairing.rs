//! Fairing over HTTP: what users post and what they get back.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::http::StatusCode;
use http_support::{Answer, Service, idle_service, real_service};
use mouldloft::http::examples::EXAMPLES;
use serde_json::{Value, json};

async fn result_of(service: &Service, job: &Value) -> Value {
    let place = service.done(job).await;
    let answer = service.get(&format!("{place}/result")).await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    answer.json()
}

fn example(name: &str) -> Value {
    let example = EXAMPLES.iter().find(|e| e.name == name).unwrap();
    serde_json::from_str(example.body).unwrap()
}

/// Curvature of a plane B-spline at many places, by the definition alone: de
/// Boor's algorithm and central differences.
fn curvatures(curve: &Value) -> Vec<f64> {
    let numbers = |v: &Value| -> Vec<f64> {
        let list = v.as_array().unwrap().iter();
        list.map(|x| x.as_f64().unwrap()).collect()
    };
    let degree = usize::try_from(curve["degree"].as_u64().unwrap()).unwrap();
    let knots = numbers(&curve["knots"]);
    let points: Vec<Vec<f64>> = (curve["control_points"].as_array().unwrap().iter())
        .map(numbers)
        .collect();
    let at = |u: f64| -> [f64; 2] {
        let k = (degree..points.len() - 1).find(|k| u < knots[k + 1]);
        let k = k.unwrap_or(points.len() - 1);
        let mut d: Vec<[f64; 2]> = (0..=degree)
            .map(|j| [points[k - degree + j][0], points[k - degree + j][1]])
            .collect();
        for r in 1..=degree {
            for j in (r..=degree).rev() {
                let i = k - degree + j;
                let a = (u - knots[i]) / (knots[i + degree + 1 - r] - knots[i]);
                d[j] = [0, 1].map(|c| (1.0 - a) * d[j - 1][c] + a * d[j][c]);
            }
        }
        d[degree]
    };
    let (low, high) = (knots[degree], knots[points.len()]);
    let h = 1e-3 * (high - low);
    (1..200)
        .map(|i| low + (high - low) * f64::from(i) / 200.0)
        .map(|u| {
            let [a, b, c] = [at(u - h), at(u), at(u + h)];
            let first = [0, 1].map(|k| (c[k] - a[k]) / (2.0 * h));
            let second = [0, 1].map(|k| (a[k] - 2.0 * b[k] + c[k]) / (h * h));
            let cross = first[0] * second[1] - first[1] * second[0];
            cross / (first[0] * first[0] + first[1] * first[1]).powf(1.5)
        })
        .collect()
}

#[tokio::test]
async fn a_half_circle_is_a_circle() {
    let service = real_service().await;
    let result = result_of(&service, &example("half_circle")).await;
    assert_eq!(result["method"], "fairing");
    assert_eq!(result["verdict"], "within_limits");
    let curve = &result["curves"][0];
    assert_eq!(
        (&curve["role"], &curve["degree"]),
        (&json!("fair_curve"), &json!(5))
    );
    for curvature in curvatures(curve) {
        assert!((curvature - 1.0).abs() < 1e-4, "{curvature}");
    }
    let specific = &result["method_specific"];
    assert_eq!(
        (&specific["kind"], &specific["dimension"]),
        (&json!("curve"), &json!(2))
    );
    assert_eq!(specific["moves"].as_array().unwrap().len(), 13);
    assert_eq!(specific["table"], Value::Null);
}

#[tokio::test]
async fn the_slip_of_a_frame_is_named_with_its_value() {
    let service = real_service().await;
    // Of a frame in its plane x is athwartships: that is how it was read, and
    // how the point is to be mended.
    let mut job = example("frame");
    job["options"]["freedom"] = json!("x");
    let result = result_of(&service, &job).await;
    let slips = result["method_specific"]["slips"].as_array().unwrap();
    assert_eq!(slips.len(), 1, "{slips:?}");
    // It was moved by 0.1 m in y.
    assert_eq!(slips[0]["index"], 11);
    let [given, expected] = ["given", "expected"].map(|k| slips[0][k][0].as_f64().unwrap());
    assert!((given - expected - 0.1).abs() < 0.01, "{given} {expected}");
    assert_eq!(slips[0]["disregarded"], true);
}

#[tokio::test]
async fn a_table_of_offsets_is_answered_by_cell() {
    let service = real_service().await;
    let job = example("gunnerus_offsets");
    let result = result_of(&service, &job).await;
    let table = &result["method_specific"]["table"];
    let cells = table["cells"].as_array().unwrap();
    assert_eq!(
        cells.len(),
        job["input"]["offsets"]["stations"]
            .as_array()
            .unwrap()
            .len()
    );
    for (row, given) in cells
        .iter()
        .zip(job["input"]["offsets"]["y"].as_array().unwrap())
    {
        for (cell, given) in row
            .as_array()
            .unwrap()
            .iter()
            .zip(given.as_array().unwrap())
        {
            assert_eq!(&cell["old"], given);
            if let (Some(old), Some(new)) = (cell["old"].as_f64(), cell["new"].as_f64()) {
                assert!((cell["change"].as_f64().unwrap() - (new - old)).abs() < 1e-12);
            }
        }
    }
    let roles: Vec<&str> = (result["curves"].as_array().unwrap().iter())
        .map(|c| c["role"].as_str().unwrap())
        .collect();
    for role in ["station", "waterline", "buttock"] {
        assert!(roles.contains(&role), "{role}");
    }
}

#[tokio::test]
async fn no_point_of_a_grid_leaves_its_tolerance() {
    let service = real_service().await;
    let job = example("bilge_grid");
    let result = result_of(&service, &job).await;
    assert_eq!(result["verdict"], "within_limits");
    let tolerance = job["options"]["tolerance"].as_f64().unwrap();
    let moves = result["method_specific"]["moves"].as_array().unwrap();
    assert_eq!(moves.len(), 13 * 9 - 2, "two cells are missing");
    for moved in moves {
        let distance = moved["distance"].as_f64().unwrap().abs();
        assert!(distance <= tolerance, "{moved}");
    }
    let outline = &result["method_specific"]["outline"]["outer"];
    assert!(outline.as_array().is_some_and(|o| o.len() > 3), "{outline}");
}

#[tokio::test]
async fn every_file_of_every_kind_is_written() {
    let service = real_service().await;
    for name in ["half_circle", "frame", "gunnerus_offsets", "bilge_grid"] {
        let place = service.done(&example(name)).await;
        for (extension, begin) in [
            ("csv", ""),
            ("svg", "<"),
            ("json", "{"),
            ("step", "ISO-10303-21;"),
            ("igs", ""),
        ] {
            let answer = service.get(&format!("{place}/result.{extension}")).await;
            assert_eq!(answer.status, StatusCode::OK, "{name}.{extension}");
            let text = String::from_utf8(answer.body.to_vec()).unwrap();
            assert!(
                text.starts_with(begin) && text.len() > 200,
                "{name}.{extension}"
            );
        }
        let mesh = service.get(&format!("{place}/result.obj")).await;
        if name == "bilge_grid" || name == "gunnerus_offsets" {
            assert_eq!(mesh.status, StatusCode::OK);
        } else {
            // A curve has no surface to mesh.
            mesh.problem(404, "format-not-available");
            let list = service.get(&format!("{place}/artifacts")).await.json();
            let items = list["items"].as_array().unwrap();
            assert!(items.iter().all(|i| i["media_type"] != "model/gltf-binary"));
        }
    }
}

#[tokio::test]
async fn the_same_job_gives_the_same_bytes() {
    let service = real_service().await;
    for name in ["frame", "bilge_grid"] {
        let job = example(name);
        let [a, b] = [service.done(&job).await, service.done(&job).await];
        assert_ne!(a, b);
        let [a, b] = [
            service.get(&format!("{a}/result")).await,
            service.get(&format!("{b}/result")).await,
        ];
        assert_eq!(a.body, b.body, "{name}");
    }
}

async fn refused(service: &Service, input: Value, options: Value) -> Vec<(String, String)> {
    let job = json!({"method": "fairing", "units": "m", "input": input, "options": options});
    let problem = service
        .post("/v1/jobs", job.to_string())
        .await
        .problem(422, "invalid-job");
    let errors = problem["errors"].as_array().unwrap().iter();
    errors
        .map(|e| {
            (
                e["pointer"].as_str().unwrap().into(),
                e["code"].as_str().unwrap().into(),
            )
        })
        .collect()
}

#[tokio::test]
async fn every_fault_has_its_place() {
    let service = idle_service().await;
    let points = json!([[0, 0], [1, 0.1], [2, 0.3], [3, 0.2], [4, 0]]);
    let cases = [
        (json!({}), json!({}), "/input"),
        (
            json!({"points": points, "grid": [[[0,0,0]], [[1,0,0]]]}),
            json!({}),
            "/input",
        ),
        (
            json!({"points": [[0, 0], [1]]}),
            json!({}),
            "/input/points/1",
        ),
        (
            json!({"points": [[0, 0], [1, 1], [2, 0, 5], [3, 1]]}),
            json!({}),
            "/input/points/2",
        ),
        (
            json!({"points": [[0, 0], [1, 1], [2, 2e6], [3, 1]]}),
            json!({}),
            "/input/points/2/1",
        ),
        (
            json!({"points": [[0, 0], [1, 1]], "file": "points"}),
            json!({}),
            "/input/file",
        ),
        (
            json!({"points": points}),
            json!({"tolerance": -1}),
            "/options/tolerance",
        ),
        (
            json!({"points": points}),
            json!({"tolerances": [1, 2]}),
            "/options/tolerances",
        ),
        (
            json!({"points": points}),
            json!({"locked": [9]}),
            "/options/locked/0",
        ),
        (
            json!({"points": points}),
            json!({"locked_cells": [[0, 0]]}),
            "/options/locked_cells",
        ),
        (
            json!({"points": points}),
            json!({"freedom": "yx"}),
            "/options/freedom",
        ),
        (
            json!({"points": points}),
            json!({"degree": 9}),
            "/options/degree",
        ),
        (
            json!({"points": points, "kind": "surface"}),
            json!({}),
            "/input/points/0",
        ),
        (
            json!({"offsets": {"stations": [0, 1], "waterlines": [0, 1], "y": [[0, 1], [-1, 1]]}}),
            json!({}),
            "/input/offsets/y/1/0",
        ),
        (
            json!({"offsets": {"stations": [0, 0], "waterlines": [0, 1], "y": [[0, 1], [1, 1]]}}),
            json!({}),
            "/input/offsets/stations/1",
        ),
        (
            json!({"offsets": {"stations": [0, 1], "waterlines": [0, 1], "y": [[0, 1], [1]]}}),
            json!({}),
            "/input/offsets/y/1",
        ),
    ];
    for (input, options, pointer) in cases {
        let found = refused(&service, input.clone(), options.clone()).await;
        assert!(
            found.iter().any(|(p, _)| p == pointer),
            "{pointer} in {found:?} for {input} {options}"
        );
    }
}

/// Name, more of its head, text.
type Part<'a> = (&'a str, &'a str, &'a str);

const BOUNDARY: &str = "--edge-of-a-part";

fn form(parts: &[Part<'_>]) -> String {
    let mut body = String::new();
    for (name, more, text) in parts {
        body += &format!(
            "--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"{more}\r\n\r\n{text}\r\n"
        );
    }
    body + &format!("--{BOUNDARY}--\r\n")
}

async fn post_form(service: &Service, path: &str, parts: &[Part<'_>]) -> Answer {
    let kind = format!("multipart/form-data; boundary={BOUNDARY}");
    service
        .post_with(path, &[("content-type", &kind)], form(parts))
        .await
}

const FILE: &str = "; filename=\"frame.csv\"";

#[tokio::test]
async fn a_file_of_points_is_as_good_as_typing_them() {
    let service = real_service().await;
    let typed = example("frame");
    let mut csv = String::from("\u{feff}# read off the drawing\r\ny [m];z [m];note\r\n");
    for point in typed["input"]["points"].as_array().unwrap() {
        let [y, z] = [0, 1].map(|k| point[k].to_string().replace('.', ","));
        csv += &format!("{y};{z};\r\n");
    }
    let mut job = typed.clone();
    job["input"] = json!({"file": "points"});
    let answer = post_form(
        &service,
        "/v1/jobs?wait=20",
        &[("job", "", &job.to_string()), ("file", FILE, &csv)],
    )
    .await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    let told = answer.json();
    let note = told["warnings"][0].as_str().unwrap();
    assert!(note.starts_with("frame.csv: "), "{note}");
    let place = told["links"]["self"].as_str().unwrap();
    let input = service.get(&format!("{place}/input")).await.json();
    assert_eq!(input["input"]["points"], typed["input"]["points"]);
    let uploaded = service.get(&format!("{place}/result")).await.json();
    let direct = result_of(&service, &typed).await;
    assert_eq!(uploaded["curves"], direct["curves"]);
}

#[tokio::test]
async fn a_table_may_lie_either_way() {
    let service = idle_service().await;
    let across = "st\\wl,1,2,3\n0,0.5,,1.1\n5,0.7,1.2,1.4\n10,0.6,1.0,1.2\n";
    let down = "wl\\st,0,5,10\n3,1.1,1.4,1.2\n2,,1.2,1.0\n1,0.5,0.7,0.6\n";
    let mut tables = Vec::new();
    for (holds, text) in [("offsets", across), ("offsets_transposed", down)] {
        let job = json!({"method": "fairing", "units": "m", "input": {"file": holds}}).to_string();
        let answer = post_form(
            &service,
            "/v1/jobs",
            &[("job", "", &job), ("file", FILE, text)],
        )
        .await;
        assert_eq!(answer.status, StatusCode::ACCEPTED, "{:?}", answer.body);
        let place = answer.header("location").to_owned();
        let input = service.get(&format!("{place}/input")).await.json();
        tables.push(input["input"]["offsets"].clone());
    }
    assert_eq!(tables[0], tables[1]);
    assert_eq!(tables[0]["y"][0], json!([0.5, null, 1.1]));
}

#[tokio::test]
async fn a_table_comes_back_as_it_came() {
    let service = real_service().await;
    let mut text = String::from("WL;FP;3;2;1;½;AP\n");
    for j in (0..5).rev() {
        let z = f64::from(j);
        let cells = [0.0, 2.5, 5.0, 7.5, 8.75, 10.0].map(|x| {
            let y = (1.0 - ((x - 5.0) / 6.0_f64).powi(2)) * (0.5 + z).sqrt();
            format!("{y:.4}").replace('.', ",")
        });
        text.push_str(&format!("{j};{}\n", cells.join(";")));
    }
    let places = json!({
        "stations": [10, 7.5, 5, 2.5, 1.25, 0],
        "waterline_spacing": 1.0,
    });
    let job = json!({
        "method": "fairing",
        "units": "m",
        "input": {"file": "offsets_transposed", "file_places": places},
    });
    let answer = post_form(
        &service,
        "/v1/jobs?wait=50",
        &[("job", "", &job.to_string()), ("file", FILE, &text)],
    )
    .await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    let told = answer.json();
    let place = told["links"]["self"].as_str().unwrap();
    let csv = service.get(&format!("{place}/result.csv")).await;
    let csv = String::from_utf8(csv.body.to_vec()).unwrap();
    assert!(csv.lines().count() > 3, "{csv}");
    let head: Vec<&str> = csv.lines().skip(1).take(3).collect();
    assert_eq!(head[0], "waterline \\ station,z (m),FP,3,2,1,½,AP", "{csv}");
    assert_eq!(head[1], "x (m),,10,7.5,5,2.5,1.25,0");
    assert!(head[2].starts_with("4,4,"), "{}", head[2]);
    let result = service.get(&format!("{place}/result")).await.json();
    let table = &result["method_specific"]["table"];
    assert_eq!(table["stations"][0], 0.0);
    assert_eq!(table["station_names"][0], "AP");
    // Names without places: an error that says how to give them.
    let job = json!({"method": "fairing", "units": "m", "input": {"file": "offsets_transposed"}});
    let problem = post_form(
        &service,
        "/v1/jobs",
        &[("job", "", &job.to_string()), ("file", FILE, &text)],
    )
    .await
    .problem(422, "invalid-job");
    let hint = problem["errors"][0]["hint"].as_str().unwrap_or_default();
    assert!(hint.contains("file_places"), "{problem}");
}

#[tokio::test]
async fn a_form_that_is_wrong_says_where() {
    let service = idle_service().await;
    let job = json!({"method": "fairing", "units": "m", "input": {}}).to_string();
    let good = "0;0\n1;2\n2;3\n3;5\n";
    let plates = json!({"method": "hull_plates", "units": "m", "input": {}}).to_string();
    let both = json!({"method": "fairing", "units": "m", "input": {"points": [[0, 0], [1, 1]]}})
        .to_string();
    let cases: [(Vec<Part>, u16, &str, &str); 6] = [
        (vec![("job", "", &job)], 400, "syntax", "file"),
        (vec![("file", FILE, good)], 400, "syntax", "job"),
        (
            vec![("job", "", &job), ("file", FILE, good), ("extra", "", "1")],
            400,
            "syntax",
            "extra",
        ),
        (
            vec![("job", "", &job), ("file", FILE, "0;0\n1;two\n2;3\n3;1\n")],
            422,
            "invalid-job",
            "file, line 2, column 2",
        ),
        (
            vec![("job", "", &plates), ("file", FILE, good)],
            422,
            "invalid-job",
            "file",
        ),
        (
            vec![("job", "", &both), ("file", FILE, good)],
            422,
            "invalid-job",
            "/input",
        ),
    ];
    for (parts, status, code, pointer) in cases {
        let problem = post_form(&service, "/v1/jobs", &parts)
            .await
            .problem(status, code);
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
    }
    let broken = service.post_with(
        "/v1/jobs",
        &[("content-type", "multipart/form-data; boundary=x")],
        "no form at all",
    );
    broken.await.problem(400, "syntax");
}
