//! Cone splines over HTTP: what users post and what they get back, checked on
//! the returned apexes, axes, rulings and patterns by code of its own.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::http::StatusCode;
use http_support::{Service, idle_service, real_service};
use mouldloft::http::examples::EXAMPLES;
use serde_json::{Value, json};

fn example(name: &str) -> Value {
    let example = EXAMPLES.iter().find(|e| e.name == name).unwrap();
    serde_json::from_str(example.body).unwrap()
}

fn changed(name: &str, change: impl FnOnce(&mut Value)) -> Value {
    let mut job = example(name);
    change(&mut job);
    job
}

async fn result_of(service: &Service, job: &Value) -> (String, Value) {
    let place = service.done(job).await;
    let answer = service.get(&format!("{place}/result")).await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    (place, answer.json())
}

fn list(value: &Value) -> Vec<Value> {
    value.as_array().unwrap().clone()
}

fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(|x| x.as_f64().unwrap()).collect()
}

fn distance(p: &Value, q: &Value) -> f64 {
    let squares = numbers(p)
        .into_iter()
        .zip(numbers(q))
        .map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn difference(p: &Value, q: &Value) -> Vec<f64> {
    numbers(p)
        .iter()
        .zip(numbers(q))
        .map(|(a, b)| a - b)
        .collect()
}

/// How far a ruling is from lying on the cone or cylinder of a sheet.
fn off_the_patch(sheet: &Value, ruling: &Value) -> f64 {
    let axis = &sheet["axis"];
    let off = |p: &Value| match sheet["kind"].as_str().unwrap() {
        "cone" => {
            let way = difference(p, &sheet["apex"]);
            let along = dot(&way, &numbers(&axis["direction"]));
            let half = sheet["half_angle_deg"].as_f64().unwrap().to_radians();
            let across = (dot(&way, &way) - along * along).max(0.0).sqrt();
            (across * half.cos() - along * half.sin()).abs()
        }
        "cylinder" => {
            let way = difference(p, &axis["point"]);
            let along = dot(&way, &numbers(&axis["direction"]));
            let across = (dot(&way, &way) - along * along).max(0.0).sqrt();
            (across - sheet["radius"].as_f64().unwrap()).abs()
        }
        _ => 0.0,
    };
    off(&ruling["from"]).max(off(&ruling["to"]))
}

#[tokio::test]
async fn every_example_is_what_its_sheets_say() {
    let service = real_service().await;
    for name in ["shoulder", "strake", "bent_plate"] {
        let (_, result) = result_of(&service, &example(name)).await;
        let (specific, figures) = (&result["method_specific"], &result["diagnostics"]);
        assert_eq!(
            result["verdict"], "within_limits",
            "{name}: {}",
            result["summary"]
        );
        let size = figures["model_size"].as_f64().unwrap();
        let tolerance = specific["options"]["tolerance"].as_f64().unwrap();
        assert!(figures["to_surface"]["max"].as_f64().unwrap() <= tolerance);
        assert!(
            figures["join_angle_deg"].as_f64().unwrap().to_radians() <= 1e-10,
            "{name}"
        );
        assert!(
            figures["join_gap"].as_f64().unwrap() <= 1e-10 * size,
            "{name}"
        );
        let (sheets, rulings) = (list(&specific["patches"]), list(&specific["rulings"]));
        assert_eq!(rulings.len(), sheets.len() + 1);
        assert_eq!(list(&result["surfaces"]).len(), sheets.len());
        for (i, sheet) in sheets.iter().enumerate() {
            for ruling in &rulings[i..=i + 1] {
                let off = off_the_patch(sheet, ruling);
                assert!(off <= 1e-9 * size, "{name}, patch {i}: {off}");
            }
        }
        for ruling in &rulings {
            let flat = distance(&ruling["flat"][0], &ruling["flat"][1]);
            let bent = distance(&ruling["from"], &ruling["to"]);
            assert!((flat - bent).abs() <= 1e-9 * size, "{name}: {flat} {bent}");
        }
        let sum = |list: &[Value]| {
            list.iter()
                .map(|p| p["area"].as_f64().unwrap())
                .sum::<f64>()
        };
        let (rolled, flat) = (sum(&sheets), sum(&list(&specific["pattern"])));
        assert!(
            (rolled - flat).abs() <= 2e-4 * flat,
            "{name}: {rolled} {flat}"
        );
        let fewer = list(&specific["error_curve"]);
        assert!(fewer.iter().any(|e| e["patches"] == sheets.len()), "{name}");
    }
}

#[tokio::test]
async fn a_bent_plate_is_a_plane_a_cylinder_and_a_plane() {
    let service = real_service().await;
    let (_, result) = result_of(&service, &example("bent_plate")).await;
    let sheets = list(&result["method_specific"]["patches"]);
    let kinds: Vec<&str> = sheets.iter().map(|s| s["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["plane", "cylinder", "plane"]);
    assert!((sheets[1]["radius"].as_f64().unwrap() - 250.0).abs() < 1e-5);
    assert!((sheets[1]["turn_deg"].as_f64().unwrap() - 90.0).abs() < 1e-5);
    assert!((sheets[1]["bend_strain_percent"].as_f64().unwrap() - 1.2).abs() < 1e-6);
}

#[tokio::test]
async fn the_papers_solver_gives_the_same_sheets_less_well() {
    let service = real_service().await;
    let options = |solver: &str| json!({"pieces": 4, "solver": solver, "thickness": 0.008});
    let asked = |solver: &str| changed("shoulder", |j| j["options"] = options(solver));
    let (place, paper) = result_of(&service, &asked("paper")).await;
    let (_, own) = result_of(&service, &asked("own")).await;
    let (specific, figures) = (&paper["method_specific"], &paper["diagnostics"]);
    assert_eq!(specific["options"]["solver"], "paper");
    assert_eq!(figures["pieces_from"], "asked");
    let size = figures["model_size"].as_f64().unwrap();
    let (sheets, rulings) = (list(&specific["patches"]), list(&specific["rulings"]));
    assert_eq!((sheets.len(), rulings.len()), (4, 5));
    for (i, sheet) in sheets.iter().enumerate() {
        for ruling in &rulings[i..=i + 1] {
            let off = off_the_patch(sheet, ruling);
            assert!(off <= 1e-9 * size, "patch {i}: {off}");
        }
        assert!(sheet["bend_strain_percent"].as_f64().unwrap() > 0.0);
    }
    assert!(figures["join_angle_deg"].as_f64().unwrap().to_radians() <= 1e-10);
    assert!(figures["join_gap"].as_f64().unwrap() <= 1e-10 * size);
    let far =
        |result: &Value, way: &str| result["diagnostics"][way]["max"].as_f64().unwrap() / size;
    for way in ["to_surface", "to_mesh"] {
        let (own, paper) = (far(&own, way), far(&paper, way));
        assert!(own < paper && paper < 0.02, "{way}: {own} {paper}");
    }
    let step = service.get(&format!("{place}/result.step")).await;
    let step = String::from_utf8(step.body.to_vec()).unwrap();
    assert_eq!(step.matches("ADVANCED_FACE").count(), 4);
}

#[tokio::test]
async fn every_file_can_be_had() {
    let service = real_service().await;
    let (place, result) = result_of(&service, &example("shoulder")).await;
    let file = async |ending: &str| {
        let answer = service.get(&format!("{place}/result.{ending}")).await;
        assert_eq!(answer.status, StatusCode::OK, "{ending}");
        String::from_utf8(answer.body.to_vec()).unwrap()
    };
    let patches = list(&result["surfaces"]).len();
    let obj = file("obj").await;
    assert_eq!(obj.matches("\no ").count(), patches);
    let csv = file("csv").await;
    assert_eq!(csv.lines().count(), patches + 1);
    assert!(csv.starts_with("patch,kind,bend_side,"));
    let svg = file("svg").await;
    assert!(svg.starts_with("<?xml") || svg.starts_with("<svg"));
    assert!(svg.contains("Shoulder strake") && svg.contains("1 : ") && svg.contains("cone"));
    let step = file("step").await;
    assert_eq!(step.matches("ADVANCED_FACE").count(), patches);
    // Its faces are trimmed to the strip: two sides of each are no rulings, nor
    // need the strip's ends be.
    let bent = step.matches("=PCURVE(").count();
    assert!((2 * patches..=2 * patches + 2).contains(&bent), "{bent}");
    let iges = file("igs").await;
    let trimmed = iges.lines().filter(|l| l.starts_with("     144 "));
    assert_eq!(trimmed.count(), 2 * patches);
    let dxf = file("dxf").await;
    assert!(dxf.contains("ROLL") && dxf.contains("CUT"));
    let old = file("dxf?version=r12&units=mm").await;
    assert!(old.contains("AC1009") && !old.contains("LWPOLYLINE"));
    assert!(old.contains("lengths in mm"), "the text by the pattern");
    let scene = service.get(&format!("{place}/result.glb")).await;
    assert!(scene.body.starts_with(b"glTF"));
    let table = service.get(&format!("{place}/artifacts/patch-2.csv")).await;
    assert_eq!(String::from_utf8_lossy(&table.body).lines().count(), 2);
    for patch in list(&result["method_specific"]["patches"]) {
        let grid = &patch["grid"];
        let distances = list(&grid["distances"]);
        assert_eq!(distances.len(), list(&grid["points"]).len());
        let far = distances.iter().map(|d| d.as_f64().unwrap().abs());
        let most = result["diagnostics"]["to_surface"]["max"].as_f64().unwrap();
        assert!(far.fold(0.0, f64::max) <= most * (1.0 + 1e-9));
    }
    let again = service.get(&format!("{place}/result.json")).await;
    assert_eq!(again.json(), result);
    let none = service.get(&format!("{place}/result.dwg")).await;
    assert!(none.status == StatusCode::NOT_FOUND);
}

#[tokio::test]
async fn what_is_wrong_is_named_by_its_place() {
    let service = idle_service().await;
    let shoulder = |change: fn(&mut Value)| changed("shoulder", change);
    let strake = |change: fn(&mut Value)| changed("strake", change);
    let cases = [
        (shoulder(|j| j["input"] = json!({})), "/input", "missing"),
        (
            shoulder(|j| j["input"]["surface"] = example("strake")["input"]["surface"].clone()),
            "/input",
            "ambiguous",
        ),
        (
            shoulder(|j| j["input"]["plate"] = json!(0)),
            "/input/plate",
            "unexpected",
        ),
        (
            shoulder(|j| j["options"]["pieces"] = json!(4)),
            "/options/pieces",
            "ambiguous",
        ),
        (
            shoulder(|j| j["options"] = json!({"pieces": 61})),
            "/options/pieces",
            "out-of-range",
        ),
        (
            shoulder(|j| j["options"]["solver"] = json!("paper")),
            "/options/tolerance",
            "unexpected",
        ),
        (
            shoulder(|j| j["options"] = json!({"solver": "paper"})),
            "/options/pieces",
            "missing",
        ),
        (
            shoulder(|j| {
                j["options"] = json!({"solver": "paper", "pieces": 4, "classes": ["cone"]})
            }),
            "/options/classes",
            "unexpected",
        ),
        (
            shoulder(|j| j["options"]["tolerance"] = json!(0)),
            "/options/tolerance",
            "out-of-range",
        ),
        (
            shoulder(|j| j["options"]["cut"] = json!([0, 2e6, 0])),
            "/options/cut/1",
            "out-of-range",
        ),
        (
            shoulder(|j| j["options"]["classes"] = json!(["sphere"])),
            "/options/classes/0",
            "not-one-of",
        ),
        (
            shoulder(|j| j["input"]["mesh"]["faces"][7] = json!([0, 1, 2, 999])),
            "/input/mesh/faces/7/3",
            "out-of-range",
        ),
        (
            shoulder(|j| j["input"]["mesh"]["faces"][7] = json!([3, 1, 3])),
            "/input/mesh/faces/7",
            "repeated-corner",
        ),
        (
            shoulder(|j| {
                drop(
                    j["input"]["mesh"]["faces"]
                        .as_array_mut()
                        .unwrap()
                        .remove(118),
                )
            }),
            "/input/mesh/vertices/147",
            "hole",
        ),
        (
            strake(|j| j["input"]["surface"]["degree"] = json!([3, 2])),
            "/input/surface",
            "not-a-spline",
        ),
        (
            strake(|j| j["input"]["surface"]["control_points"][4] = json!([[1, 2, 3]])),
            "/input/surface/control_points/4",
            "ragged",
        ),
    ];
    for (job, pointer, code) in cases {
        let answer = service.post("/v1/jobs", job.to_string()).await;
        let problem = answer.problem(422, "invalid-job");
        let first = &problem["errors"][0];
        assert_eq!(first["pointer"], pointer, "{problem}");
        assert_eq!(first["code"], code, "{problem}");
    }
}

#[tokio::test]
async fn a_plate_of_a_finished_job_becomes_the_input() {
    let service = real_service().await;
    let hull = service.done(&example("cone")).await;
    let id = hull.rsplit('/').next().unwrap();
    let (_, plates) = result_of(&service, &example("cone")).await;
    let named = |more: Value| {
        let mut job = json!({
            "method": "cone_spline", "units": "cm", "input": {"job": id},
            "options": {"tolerance": 0.1},
        });
        for (key, value) in more.as_object().unwrap() {
            job["input"][key] = value.clone();
        }
        job
    };
    let (place, result) = result_of(&service, &named(json!({"plate": 0}))).await;
    assert_eq!(result["verdict"], "within_limits");
    assert_eq!(result["method_specific"]["patches"][0]["kind"], "cone");
    // What is stored stands by itself, in the unit of this job.
    let input = service.get(&format!("{place}/input")).await.json();
    assert!(input["input"].get("job").is_none());
    let to_cm = match plates["units"].as_str().unwrap() {
        "m" => 100.0,
        "mm" => 0.1,
        "ft" => 30.48,
        other => panic!("{other}"),
    };
    let there = numbers(&plates["surfaces"][0]["control_points"][0][0]);
    let here = numbers(&input["input"]["surface"]["control_points"][0][0]);
    for (a, b) in there.iter().zip(&here) {
        assert!((a * to_cm - b).abs() < 1e-9, "{a} {b}");
    }
    assert_eq!(input["input"]["name"], plates["surfaces"][0]["name"]);

    let strip = result_of(&service, &example("bent_plate")).await.0;
    let strip = strip.rsplit('/').next().unwrap();
    let nobody = "00000000-0000-4000-8000-000000000000";
    for (more, pointer, code) in [
        (json!({"plate": 9}), "/input/plate", "out-of-range"),
        (
            json!({"plate": 0, "job": nobody}),
            "/input/job",
            "job-not-found",
        ),
        (json!({"job": strip}), "/input/job", "wrong-method"),
    ] {
        let answer = service.post("/v1/jobs", named(more).to_string()).await;
        let problem = answer.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
        assert_eq!(problem["errors"][0]["code"], code, "{problem}");
    }
}

#[tokio::test]
async fn a_job_that_has_not_ended_has_no_plates() {
    let service = idle_service().await;
    let answer = service
        .post("/v1/jobs", example("trawler").to_string())
        .await;
    let id = answer.json()["id"].clone();
    let job = json!({
        "method": "cone_spline", "units": "ft", "input": {"job": id, "plate": 1},
    });
    let answer = service.post("/v1/jobs", job.to_string()).await;
    let problem = answer.problem(422, "invalid-job");
    assert_eq!(
        problem["errors"][0]["code"], "result-not-ready",
        "{problem}"
    );
    assert!(
        problem["errors"][0]["hint"]
            .as_str()
            .unwrap()
            .contains("wait=55")
    );
}

#[tokio::test]
async fn a_mesh_may_come_as_a_file() {
    let service = idle_service().await;
    let mesh = example("bent_plate")["input"]["mesh"].clone();
    let mut obj = String::new();
    for vertex in list(&mesh["vertices"]) {
        let [x, y, z] = numbers(&vertex)[..] else {
            panic!()
        };
        obj += &format!("v {x} {y} {z}\n");
    }
    for face in list(&mesh["faces"]) {
        let corners: Vec<String> = numbers(&face)
            .iter()
            .map(|c| format!("{}", c + 1.0))
            .collect();
        obj += &format!("f {}\n", corners.join(" "));
    }
    let form = |job: &Value| {
        let part = |name: &str, more: &str, text: &str| {
            format!(
                "--edge\r\nContent-Disposition: form-data; name=\"{name}\"{more}\r\n\r\n{text}\r\n"
            )
        };
        let file = part("file", "; filename=\"plate.obj\"", &obj);
        part("job", "", &job.to_string()) + &file + "--edge--\r\n"
    };
    let headers = [("content-type", "multipart/form-data; boundary=edge")];
    let job = json!({"method": "cone_spline", "units": "mm", "input": {}});
    let answer = service.post_with("/v1/jobs", &headers, form(&job)).await;
    assert_eq!(answer.status, StatusCode::ACCEPTED, "{:?}", answer.body);
    let warnings = answer.json()["warnings"].to_string();
    assert!(warnings.contains("plate.obj"), "{warnings}");
    let place = answer.header("location").to_owned();
    let stored = service.get(&format!("{place}/input")).await.json();
    assert_eq!(
        list(&stored["input"]["mesh"]["faces"]).len(),
        list(&mesh["faces"]).len()
    );
    let both = json!({"method": "cone_spline", "units": "mm", "input": {"mesh": mesh}});
    let answer = service.post_with("/v1/jobs", &headers, form(&both)).await;
    let problem = answer.problem(422, "invalid-job");
    assert_eq!(problem["errors"][0]["code"], "ambiguous");
}
