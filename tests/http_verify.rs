//! Surfaces that are measured, whoever made them.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use http_support::{idle_service, real_service};
use serde_json::{Value, json};

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("no number: {value}"))
}

#[tokio::test]
async fn a_result_is_found_as_it_says_it_is() {
    let service = real_service().await;
    let trawler = service.get("/v1/examples/trawler").await.json();
    let place = service.done(&trawler).await;
    let result = service.get(&format!("{place}/result.json")).await.json();
    let body = json!({
        "units": result["units"],
        "surfaces": result["surfaces"],
        "target": trawler["input"]["profiles"],
    });
    let answer = service.post("/v1/verify", body.to_string()).await;
    assert_eq!(answer.status, 200);
    let measured = answer.json();
    let plates = result["diagnostics"]["plates"].as_array().unwrap();
    for (k, plate) in plates.iter().enumerate() {
        let surface = &measured["surfaces"][k];
        let ruled = &surface["ruled"];
        assert_eq!(ruled["along"], "v");
        assert_eq!(ruled["within_limits"], true);
        let twist = number(&ruled["twist_max_deg"]);
        assert!(
            (twist - number(&plate["twist_max_deg"])).abs() < 0.02,
            "{k}: {twist}"
        );
        assert!((number(&surface["area"]) / number(&plate["area"]) - 1.0).abs() < 1e-3);
        let flat = &result["method_specific"]["plates"][k]["flat"];
        let found = number(&ruled["flat"]["strain"]["twist_percent"]);
        assert!((found - number(&flat["strain"]["twist_percent"])).abs() < 1e-9);
    }
    // Each chine once; the profiles lie on the plates' edges.
    let joins = measured["joins"].as_array().unwrap();
    let pairs: Vec<&Value> = joins.iter().map(|j| &j["surfaces"]).collect();
    assert_eq!(pairs, [&json!([0, 1]), &json!([1, 2])]);
    for join in joins {
        assert_eq!(join["edges"], json!(["v1", "v0"]));
        assert!(number(&join["gap"]) < 1e-4);
        assert!(number(&join["knuckle_max_deg"]) > 10.0);
    }
    for target in measured["target"].as_array().unwrap() {
        assert!(number(&target["distance_max"]) < 7e-5, "{target}");
    }
    let sentences = measured["summary"].as_array().unwrap();
    assert!(
        sentences[3].as_str().unwrap().starts_with("Joins: 2,"),
        "{sentences:?}"
    );
}

#[tokio::test]
async fn surfaces_of_others_are_measured_too() {
    // A paraboloid z = (x² + y²)/2, and a hypar that twists by 45° at its edge.
    let paraboloid = json!({
        "name": "bowl", "degree": [2, 2],
        "knots": [[0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1]],
        "control_points": [
            [[0, 0, 0], [0, 0.5, 0], [0, 1, 0.5]],
            [[0.5, 0, 0], [0.5, 0.5, 0], [0.5, 1, 0.5]],
            [[1, 0, 0.5], [1, 0.5, 0.5], [1, 1, 1]],
        ],
    });
    let hypar = json!({
        "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
        "control_points": [[[3, 0, 0], [3, 1, 0]], [[4, 0, 0], [4, 1, 1]]],
    });
    let service = idle_service().await;
    let body = json!({"units": "m", "surfaces": [paraboloid, hypar], "max_twist_deg": 10});
    let measured = service.post("/v1/verify", body.to_string()).await.json();
    let [bowl, hypar] = [0, 1].map(|k| &measured["surfaces"][k]);
    assert_eq!(bowl["ruled"], Value::Null);
    // K = 1/(1 + r²)², radius (1 + r²)^(1/2..3/2): 1 at the bottom.
    assert!((number(&bowl["gaussian_curvature_max"]) - 1.0).abs() < 0.03);
    assert!((number(&bowl["least_radius"]) - 1.0).abs() < 0.03);
    assert_eq!(hypar["name"], "surface 2");
    assert!((number(&hypar["ruled"]["twist_max_deg"]) - 45.0).abs() < 1e-9);
    assert_eq!(hypar["ruled"]["within_limits"], false);
    assert!(number(&hypar["ruled"]["flat"]["strain"]["middle_percent"]) > 5.0);
    assert_eq!(measured["joins"], json!([]));
    assert_eq!(measured["open_edges"].as_array().unwrap().len(), 8);
}

#[tokio::test]
async fn what_cannot_be_measured_is_refused_with_its_place() {
    let surface = json!({
        "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
        "control_points": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]],
    });
    let with = |place: &str, value: Value| {
        let mut body = json!({"units": "m", "surfaces": [surface.clone()]});
        *body.pointer_mut(place).unwrap() = value;
        body
    };
    let service = idle_service().await;
    let mut stranger = with("/units", json!("m"));
    stranger["surface"] = json!(1);
    let mut many = with("/units", json!("m"));
    let row: Vec<[f64; 3]> = (0..200).map(|i| [0.0, f64::from(i), 0.0]).collect();
    many["surfaces"][0]["control_points"] = json!(vec![row; 300]);
    for (body, pointer, code) in [
        (stranger, "/surface", "unknown-field"),
        (with("/units", json!("yd")), "/units", "not-one-of"),
        (with("/surfaces", json!([])), "/surfaces", "too-few"),
        (
            with("/surfaces/0/control_points/1", json!([[1, 0, 0]])),
            "/surfaces/0/control_points/1",
            "ragged",
        ),
        (
            with("/surfaces/0/control_points/1/1/2", json!(1e7)),
            "/surfaces/0/control_points/1/1/2",
            "out-of-range",
        ),
        (
            with("/surfaces/0/knots/0", json!([0, 0, 1])),
            "/surfaces/0",
            "not-a-spline",
        ),
        (many, "/surfaces", "too-many"),
    ] {
        let answer = service.post("/v1/verify", body.to_string()).await;
        let problem = answer.problem(422, "invalid-surfaces");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
        assert_eq!(problem["errors"][0]["code"], code, "{problem}");
    }
    service.post("/v1/verify", "[").await.problem(400, "syntax");
}

#[tokio::test]
async fn a_step_file_is_measured_like_its_result() {
    let service = real_service().await;
    let trawler = service.get("/v1/examples/trawler").await.json();
    let place = service.done(&trawler).await;
    let result = service.get(&format!("{place}/result.json")).await.json();
    let step = service.get(&format!("{place}/result.step")).await;
    let kind = [("content-type", "model/step")];
    let answer = service
        .post_with("/v1/verify?max_twist_deg=0.5", &kind, step.body.clone())
        .await;
    assert_eq!(answer.status, 200);
    let from_step = answer.json();
    let body = json!({
        "units": result["units"], "surfaces": result["surfaces"], "max_twist_deg": 0.5,
    });
    let from_json = service.post("/v1/verify", body.to_string()).await.json();
    assert_eq!(from_step["units"], "ft");
    assert_eq!(from_step["warnings"], json!([]));
    // Plates are cut into faces where their fans begin; together they are the
    // same, and meet along the same chines.
    let list = |v: &Value| v.as_array().unwrap().clone();
    let total = |measured: &Value, figure: &str| -> f64 {
        let faces = list(&measured["surfaces"]);
        faces.iter().map(|s| number(&s[figure])).sum()
    };
    for figure in ["area", "total_curvature"] {
        let [a, b] = [&from_step, &from_json].map(|m| total(m, figure));
        assert!((a - b).abs() < 1e-6 * b.abs(), "{figure}: {a} {b}");
    }
    let most = |measured: &Value| -> f64 {
        let faces = list(&measured["surfaces"]);
        let twists = faces.iter().map(|s| number(&s["ruled"]["twist_max_deg"]));
        twists.fold(0.0, f64::max)
    };
    assert!((most(&from_step) - most(&from_json)).abs() < 1e-9);
    let chines = |measured: &Value| -> f64 {
        let joins = list(&measured["joins"]);
        let along = |j: &&Value| j["edges"] != json!(["u1", "u0"]);
        let lengths = joins.iter().filter(along).map(|j| number(&j["length"]));
        lengths.sum()
    };
    let [a, b] = [&from_step, &from_json].map(chines);
    assert!(b > 100.0 && (a - b).abs() < 1e-3, "{a} {b}");
    let cut = step.body.slice(..step.body.len() / 2);
    let problem = service
        .post_with("/v1/verify", &kind, cut)
        .await
        .problem(422, "invalid-surfaces");
    assert!(
        problem["errors"][0]["pointer"]
            .as_str()
            .unwrap()
            .starts_with("file, line "),
        "{problem}"
    );
}
