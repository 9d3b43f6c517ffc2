//! Curvature nets over HTTP: what users post and what they get back, checked
//! on the returned control points by code of its own.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;
mod net_checker;

use axum::http::StatusCode;
use http_support::{Service, idle_service, real_service};
use mouldloft::http::examples::EXAMPLES;
use net_checker::{Net, Vec3, angle, cross, dot, norm, sub, unit, vec3};
use serde_json::{Value, json};

const PROOF: f64 = 1e-9;

fn example(name: &str) -> Value {
    let example = EXAMPLES.iter().find(|e| e.name == name).unwrap();
    serde_json::from_str(example.body).unwrap()
}

async fn result_of(service: &Service, job: &Value) -> (String, Value) {
    let place = service.done(job).await;
    let answer = service.get(&format!("{place}/result")).await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    (place, answer.json())
}

#[tokio::test]
async fn every_example_is_proved_by_its_control_points() {
    let service = real_service().await;
    for name in ["vault", "saddle", "tube", "bilge"] {
        let (_, result) = result_of(&service, &example(name)).await;
        assert_eq!(
            result["verdict"], "within_limits",
            "{name}: {}",
            result["summary"]
        );
        let net = Net::of(&result, "patch ");
        let errors = net.errors();
        assert!(errors.total() <= PROOF, "{name}: {errors:?}");
        let borders = &result["diagnostics"]["borders"];
        assert!(borders["torsion_mean"].as_f64().unwrap() <= 1e-6, "{name}");
        assert!(
            borders["torsion_max"]["value"].as_f64().unwrap() <= 2e-5,
            "{name}"
        );
        assert_eq!(
            result["diagnostics"]["umbilics"]["patches"],
            json!([]),
            "{name}"
        );
        for offset in result["method_specific"]["offsets"].as_array().unwrap() {
            let distance = offset["distance"].as_f64().unwrap();
            let moved = Net::of(&result, &format!("offset {distance}, patch "));
            let errors = moved.errors();
            assert!(errors.total() <= PROOF, "{name} {distance}: {errors:?}");
            for (patch, offset) in net.patches.iter().zip(&moved.patches) {
                let (way, n) = (
                    sub(offset.at(0.0, 0.0).0, patch.at(0.0, 0.0).0),
                    patch.normal(0.0, 0.0),
                );
                let off = norm([0, 1, 2].map(|k| way[k] - distance * n[k]));
                assert!(off < 1e-12, "{name}: {off}");
            }
        }
        cones_touch(&result, name);
        flat_lines_keep_their_lengths(&result, name);
    }
}

/// Each cone's own tangent plane, from apex and axis alone, at both of its end
/// rulings is the plane of the vertex.
fn cones_touch(result: &Value, name: &str) {
    let specific = &result["method_specific"];
    let vertices = specific["vertices"].as_array().unwrap();
    let mut checked = 0;
    for cone in specific["strips"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|s| s["cones"].as_array().unwrap())
    {
        if cone["kind"] != "cone" {
            continue;
        }
        let (apex, axis) = (vec3(&cone["apex"]), vec3(&cone["axis"]));
        for end in cone["ends"].as_array().unwrap() {
            let vertex = &vertices[end.as_u64().unwrap() as usize];
            let ruling = unit(sub(apex, vec3(&vertex["point"])));
            let plane: Vec3 = unit(cross(ruling, cross(axis, ruling)));
            let normal = vec3(&vertex["normal"]);
            let off = angle(plane, normal).min(angle(plane.map(|x| -x), normal));
            assert!(off < PROOF, "{name}: {off}");
            let half = cone["half_angle_deg"].as_f64().unwrap().to_radians();
            assert!((dot(ruling, axis).abs() - half.cos()).abs() < PROOF);
        }
        checked += 1;
    }
    assert!(checked > 100, "{name}: {checked} cones");
}

/// The unrolled line of every strip is as long as the bill says, and the bill
/// as the arcs of the patches' borders.
fn flat_lines_keep_their_lengths(result: &Value, name: &str) {
    let specific = &result["method_specific"];
    let length_on = |line: &Value| -> f64 {
        let members = specific["members"].as_array().unwrap().iter();
        members
            .filter(|m| &m["line"] == line)
            .map(|m| m["length"].as_f64().unwrap())
            .sum()
    };
    for strip in specific["strips"].as_array().unwrap() {
        let sheets = strip["sheets"].as_array().unwrap().iter();
        let flat: f64 = sheets
            .flat_map(|sheet| {
                let line: Vec<Vec3> = (sheet["line"].as_array().unwrap().iter())
                    .map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap(), 0.0])
                    .collect();
                let arcs: Vec<f64> = line
                    .windows(9)
                    .step_by(8)
                    .map(|p| arc_length(p[0], p[4], p[8]))
                    .collect();
                arcs
            })
            .sum();
        let billed = length_on(&strip["name"]);
        assert!(
            (flat - billed).abs() < 1e-9 * billed,
            "{name}: {flat} {billed}"
        );
    }
    let net = Net::of(result, "patch ");
    let along: f64 = (0..net.counts[0])
        .map(|i| {
            let [a, b, c] = [0.0, 0.5, 1.0].map(|t| net.patch(i, 0).at(t, 0.0).0);
            arc_length(a, b, c)
        })
        .sum();
    let billed = length_on(&json!("u0"));
    assert!(
        (along - billed).abs() < 1e-9 * billed,
        "{name}: {along} {billed}"
    );
}

/// Length of the arc through three points, the middle one anywhere between.
fn arc_length(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    // Half the arc's angle is the exterior angle at the middle point.
    let half = angle(unit(sub(b, a)), unit(sub(c, b)));
    let chord = norm(sub(c, a));
    if half < 1e-8 {
        chord
    } else {
        chord * half / half.sin()
    }
}

#[tokio::test]
async fn the_files_are_written() {
    let service = real_service().await;
    let mut job = example("tube");
    job["options"]["levels"] = json!(0);
    job["options"]["supports"] = json!({"height": 0.1});
    let place = service.done(&job).await;
    let text = |answer: http_support::Answer| {
        assert_eq!(answer.status, StatusCode::OK);
        String::from_utf8(answer.body.to_vec()).unwrap()
    };
    let obj = text(service.get(&format!("{place}/result.obj")).await);
    assert!(obj.contains("\no patch_0,0\n") && obj.contains("\no offset_-0.05,_patch_0,0\n"));
    let csv = text(service.get(&format!("{place}/result.csv")).await);
    // 4 rings of 5 and 5 lines of 8 arcs, and the header.
    assert_eq!(csv.lines().count(), 1 + 8 * 4 + 5 * 8);
    let svg = text(service.get(&format!("{place}/result.svg")).await);
    for words in ["Conical strips along v", "Supports along u", ">v4<", "1 : "] {
        assert!(svg.contains(words), "{words}");
    }
    let answer = service.get(&format!("{place}/diagnostics")).await.json();
    assert!(
        answer["figures"]["cyclides"]["worst"]["mirror"]
            .as_f64()
            .unwrap()
            < PROOF
    );
}

#[tokio::test]
async fn without_cyclides_there_is_the_smooth_surface() {
    let service = real_service().await;
    let mut job = example("bilge");
    job["options"] = json!({"cyclide": false, "levels": 1});
    let (place, result) = result_of(&service, &job).await;
    let surfaces = result["surfaces"].as_array().unwrap();
    assert_eq!(surfaces.len(), 1);
    assert_eq!(surfaces[0]["degree"], json!([3, 3]));
    assert_eq!(result["diagnostics"]["cyclides"], Value::Null);
    let obj = service.get(&format!("{place}/result.obj")).await;
    assert!(String::from_utf8_lossy(&obj.body).contains("\no patch_0,0\n"));
    let scene = service.get(&format!("{place}/result.glb")).await;
    let told = String::from_utf8_lossy(&scene.body).into_owned();
    assert!(told.contains("\"quantity\":\"torsion\",\"unit\":\"deg\""));
    let svg = service.get(&format!("{place}/result.svg")).await;
    assert!(String::from_utf8_lossy(&svg.body).contains("no flat patterns"));
}

#[tokio::test]
async fn an_offset_beyond_a_focal_point_is_outside_the_limits() {
    let service = real_service().await;
    let mut job = example("tube");
    job["options"] = json!({"levels": 0, "offsets": [-0.9]});
    let (_, result) = result_of(&service, &job).await;
    assert_eq!(result["verdict"], "outside_limits");
    let focal = result["method_specific"]["offsets"][0]["focal"]
        .as_array()
        .unwrap();
    assert!(!focal.is_empty());
    let summary = result["summary"].to_string();
    assert!(summary.contains("focal point"), "{summary}");
}

/// The vault's mesh with a change.
fn vault(change: impl Fn(&mut Value)) -> Value {
    let mut job = example("vault");
    change(&mut job);
    job
}

#[tokio::test]
async fn what_is_wrong_is_named_by_its_place() {
    let service = idle_service().await;
    let quad = |v: Value| vault(move |job| job["input"]["mesh"]["faces"][3] = v.clone());
    let cases = [
        (vault(|j| j["input"] = json!({})), "/input", "missing"),
        (
            vault(|j| j["input"]["grid"] = json!([[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]])),
            "/input",
            "ambiguous",
        ),
        (
            vault(|j| j["input"]["closed"] = json!(["u"])),
            "/input/closed",
            "unexpected",
        ),
        (
            vault(|j| j["input"] = json!({"grid": [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0]]]})),
            "/input/grid/1",
            "ragged",
        ),
        (quad(json!([0, 1, 2])), "/input/mesh/faces/3", "not-a-quad"),
        (
            quad(json!([0, 1, 2, 99])),
            "/input/mesh/faces/3/3",
            "out-of-range",
        ),
        (
            vault(|j| j["options"]["offsets"] = json!([0.1, 0])),
            "/options/offsets/1",
            "out-of-range",
        ),
        (
            vault(|j| j["options"]["supports"]["height"] = json!(0)),
            "/options/supports/height",
            "out-of-range",
        ),
        (
            vault(|j| j["options"]["cyclide"] = json!(false)),
            "/options/strips",
            "unexpected",
        ),
        (
            vault(|j| j["options"]["levels"] = json!(7)),
            "/options/levels",
            "too-many-patches",
        ),
        (
            vault(|j| j["options"]["levels"] = json!(9)),
            "/options/levels",
            "out-of-range",
        ),
        (
            vault(|j| j["options"]["strips"] = json!(["w"])),
            "/options/strips/0",
            "not-one-of",
        ),
        (
            vault(|j| j["options"]["target"] = json!({})),
            "/options/target",
            "ambiguous",
        ),
        (
            vault(|j| j["input"]["mesh"]["vertices"][7][1] = json!(1e8)),
            "/input/mesh/vertices/7/1",
            "out-of-range",
        ),
    ];
    for (job, pointer, code) in cases {
        let answer = service
            .post("/v1/jobs?validate_only=true", job.to_string())
            .await;
        let problem = answer.problem(422, "invalid-job");
        let errors = problem["errors"].as_array().unwrap();
        let named = errors
            .iter()
            .any(|e| e["pointer"] == pointer && e["code"] == code);
        assert!(named, "{pointer} {code}: {errors:?}");
    }
}

/// Three quads round a vertex, as in the corner of a box.
#[tokio::test]
async fn meshes_that_are_no_net_are_refused_by_name() {
    let service = idle_service().await;
    let mesh = |vertices: Value, faces: Value| {
        vault(move |j| j["input"] = json!({"mesh": {"vertices": vertices, "faces": faces}}))
    };
    let corner = mesh(
        json!([
            [0, 0, 0],
            [1, 0, 0],
            [1, 1, 0],
            [0, 1, 0],
            [0, 0, 1],
            [0, 1, 1],
            [1, 0, 1]
        ]),
        json!([[0, 1, 2, 3], [0, 3, 5, 4], [0, 4, 6, 1]]),
    );
    let apart = mesh(
        json!([
            [0, 0, 0],
            [1, 0, 0],
            [1, 1, 0],
            [0, 1, 0],
            [5, 0, 0],
            [6, 0, 0],
            [6, 1, 0],
            [5, 1, 0]
        ]),
        json!([[0, 1, 2, 3], [4, 5, 6, 7]]),
    );
    let ragged = mesh(
        json!([
            [0, 0, 0],
            [1, 0, 0],
            [2, 0, 0],
            [0, 1, 0],
            [1, 1, 0],
            [2, 1, 0],
            [0, 2, 0],
            [1, 2, 0]
        ]),
        json!([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6]]),
    );
    let collapsed = mesh(
        json!([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]]),
        json!([[0, 1, 2, 3]]),
    );
    for (job, pointer, words) in [
        (corner, "/input/mesh/vertices/0", "vertex 0"),
        (apart, "/input/mesh/faces/1", "face 1"),
        (ragged, "/input/mesh/vertices/4", "vertex 4"),
        (collapsed, "/input/mesh/vertices/1", "vertex 1"),
    ] {
        let answer = service.post("/v1/jobs", job.to_string()).await;
        let problem = answer.problem(422, "invalid-job");
        let error = &problem["errors"][0];
        assert_eq!(error["pointer"], pointer, "{problem}");
        assert!(
            error["message"].as_str().unwrap().contains(words),
            "{problem}"
        );
    }
}

#[tokio::test]
async fn a_place_on_a_grid_is_told_by_row_and_column() {
    let service = idle_service().await;
    let mut job = example("bilge");
    job["input"]["grid"][2][3] = job["input"]["grid"][2][2].clone();
    let problem = service
        .post("/v1/jobs", job.to_string())
        .await
        .problem(422, "invalid-job");
    assert_eq!(
        problem["errors"][0]["pointer"], "/input/grid/2/2",
        "{problem}"
    );
}

/// The vault's mesh as a file gives the same answer as typed.
#[tokio::test]
async fn a_mesh_comes_as_a_file() {
    let service = real_service().await;
    let mut job = example("vault");
    job["options"] = json!({"levels": 0});
    let (_, typed) = result_of(&service, &job).await;
    let rows = |list: &Value, word: &str, add: f64| -> String {
        let row = |r: &Value| {
            let numbers = r.as_array().unwrap().iter();
            let numbers: Vec<String> = numbers
                .map(|x| (x.as_f64().unwrap() + add).to_string())
                .collect();
            format!("{word} {}\n", numbers.join(" "))
        };
        list.as_array().unwrap().iter().map(row).collect()
    };
    let mesh = &job["input"]["mesh"];
    let file = rows(&mesh["vertices"], "v", 0.0) + &rows(&mesh["faces"], "f", 1.0);
    job["input"] = json!({});
    let form = |job: &Value| {
        format!(
            "--x\r\nContent-Disposition: form-data; name=\"job\"\r\n\r\n{job}\r\n--x\r\n\
             Content-Disposition: form-data; name=\"file\"; filename=\"vault.obj\"\r\n\r\n\
             {file}\r\n--x--\r\n"
        )
    };
    let headers = [("content-type", "multipart/form-data; boundary=x")];
    let answer = service
        .post_with("/v1/jobs?wait=55", &headers, form(&job))
        .await;
    assert_eq!(answer.status, StatusCode::OK, "{:?}", answer.body);
    let place = format!("{}/result", answer.header("location"));
    let uploaded = service.get(&place).await.json();
    assert_eq!(uploaded["surfaces"], typed["surfaces"]);
    job["input"] = json!({"grid": [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]});
    let answer = service.post_with("/v1/jobs", &headers, form(&job)).await;
    let problem = answer.problem(422, "invalid-job");
    assert_eq!(problem["errors"][0]["code"], "ambiguous", "{problem}");
}

#[tokio::test]
async fn the_same_job_gives_the_same_bytes() {
    let service = real_service().await;
    let mut job = example("saddle");
    job["options"]["levels"] = json!(1);
    let mut bytes = Vec::new();
    for _ in 0..2 {
        let place = service.done(&job).await;
        bytes.push(service.get(&format!("{place}/result")).await.body);
    }
    assert_eq!(bytes[0], bytes[1]);
}
