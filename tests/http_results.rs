//! What jobs leave: results, files, diagnostics.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::body::Body;
use axum::http::{Method, StatusCode};
use http_support::{idle_service, job, real_service, service};
use serde_json::{Value, json};

const FORMATS: [(&str, &str); 11] = [
    ("json", "application/json"),
    ("obj", "model/obj"),
    ("stl", "model/stl"),
    ("ply", "application/x-ply"),
    ("glb", "model/gltf-binary"),
    ("csv", "text/csv; charset=utf-8"),
    ("svg", "image/svg+xml"),
    ("step", "model/step"),
    ("igs", "model/iges"),
    ("dxf", "image/vnd.dxf"),
    ("zip", "application/zip"),
];

#[tokio::test]
async fn the_result_tells_everything() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let answer = service.get(&format!("{place}/result")).await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("content-type"), "application/json");
    let result = answer.json();
    assert_eq!(result["method"], "hull_plates");
    assert_eq!(result["units"], "m");
    assert_eq!(result["verdict"], "within_limits");
    let plate = &result["surfaces"][0];
    assert_eq!(plate["role"], "plate");
    // Indexed [u][v]: three stations, first profile at v = 0.
    assert_eq!(
        plate["control_points"][2],
        json!([[2.0, 0.0, 0.5], [2.0, 1.0, 0.5]])
    );
    assert_eq!(result["curves"][1]["name"], "keel");
    let ruling = &result["method_specific"]["plates"][0]["rulings"][0];
    assert_eq!(ruling["bend_radius_from"], Value::Null, "infinite");
    assert_eq!(ruling["bend_radius_to"], -3.5);
    assert_eq!(result["method_specific"]["options"]["max_twist_deg"], 6.0);
    assert_eq!(
        result["diagnostics"]["plates"][0]["regression_clearance"],
        Value::Null
    );
}

#[tokio::test]
async fn the_same_job_gives_the_same_bytes() {
    let service = service().await;
    let (first, second) = (
        service.done(&job("deck")).await,
        service.done(&job("deck")).await,
    );
    assert_ne!(first, second);
    for (extension, _) in FORMATS {
        let [a, b] = [&first, &second].map(|place| format!("{place}/result.{extension}"));
        let (a, b) = (service.get(&a).await, service.get(&b).await);
        assert_eq!(a.body, b.body, "{extension}");
        assert_eq!(a.header("etag"), b.header("etag"));
    }
}

#[tokio::test]
async fn files_have_name_tag_length_and_ranges() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    for (extension, kind) in FORMATS {
        let path = format!("{place}/result.{extension}");
        let whole = service.get(&path).await;
        assert_eq!(whole.status, StatusCode::OK, "{extension}");
        assert_eq!(whole.header("content-type"), kind);
        assert_eq!(whole.header("content-length"), whole.body.len().to_string());
        assert!(!whole.body.is_empty());
        let tag = whole.header("etag");
        assert_eq!(tag.len(), 66, "a quoted SHA-256");
        let name = whole.header("content-disposition");
        assert!(
            name.contains(&format!("filename*=UTF-8''B%C3%A4r%201.{extension}")),
            "{name}"
        );

        let head = service.call(Method::HEAD, &path).await;
        assert_eq!(head.status, StatusCode::OK);
        assert!(head.body.is_empty());
        assert_eq!(
            head.header("content-length"),
            whole.header("content-length")
        );
        assert_eq!(head.header("etag"), tag);

        let same = service.get_with(&path, &[("if-none-match", tag)]).await;
        assert_eq!(same.status, StatusCode::NOT_MODIFIED);
        assert!(same.body.is_empty());

        let part = service.get_with(&path, &[("range", "bytes=3-9")]).await;
        assert_eq!(part.status, StatusCode::PARTIAL_CONTENT);
        assert_eq!(part.body, whole.body.slice(3..10));
        let place = format!("bytes 3-9/{}", whole.body.len());
        assert_eq!(part.header("content-range"), place);
        let stale = [("range", "bytes=3-9"), ("if-range", "\"old\"")];
        assert_eq!(service.get_with(&path, &stale).await.status, StatusCode::OK);

        let outside = service
            .get_with(&path, &[("range", "bytes=99999999-")])
            .await;
        outside.problem(416, "range-not-satisfiable");
        assert_eq!(
            outside.header("content-range"),
            format!("bytes */{}", whole.body.len())
        );
    }
}

#[tokio::test]
async fn strong_tags_are_never_compressed_the_rest_is() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let gzip = [("accept-encoding", "gzip")];
    let result = service
        .get_with(&format!("{place}/result.json"), &gzip)
        .await;
    assert_eq!(result.header("content-encoding"), "");
    let document = service.get_with("/openapi.json", &gzip).await;
    assert_eq!(document.header("content-encoding"), "gzip");
}

#[tokio::test]
async fn accept_chooses_or_is_refused() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let path = format!("{place}/result");
    for (accept, kind) in [
        ("*/*", "application/json"),
        ("text/csv", "text/csv; charset=utf-8"),
        ("image/svg+xml, */*;q=0.1", "image/svg+xml"),
    ] {
        let answer = service.get_with(&path, &[("accept", accept)]).await;
        assert_eq!(answer.header("content-type"), kind, "{accept}");
        assert_eq!(answer.header("vary"), "Accept");
    }
    let refused = service.get_with(&path, &[("accept", "text/html")]).await;
    let problem = refused.problem(406, "not-acceptable");
    assert!(problem["detail"].as_str().unwrap().contains("model/obj"));
}

#[tokio::test]
async fn unknown_formats_name_the_known() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let problem = service.get(&format!("{place}/result.dwg")).await;
    let problem = problem.problem(404, "format-not-available");
    assert_eq!(
        problem["detail"],
        "there is no result.dwg; there are json, obj, stl, ply, glb, csv, svg, step, igs, dxf, zip"
    );
}

#[tokio::test]
async fn results_that_are_not_there_say_why() {
    let service = service().await;
    let slow = service.post("/v1/jobs", job("slow").to_string()).await;
    let slow = slow.header("location").to_owned();
    for path in ["/result", "/result.json", "/result.svg"] {
        let answer = service.get(&format!("{slow}{path}")).await;
        answer.problem(409, "result-not-ready");
        assert!(!answer.header("retry-after").is_empty());
    }
    service.post(&format!("{slow}/cancel"), Body::empty()).await;
    service.get(&format!("{slow}?wait=20")).await;
    service
        .get(&format!("{slow}/result.obj"))
        .await
        .problem(409, "job-dismissed");

    let invalid = service.done(&job("invalid")).await;
    let problem = service
        .get(&format!("{invalid}/result"))
        .await
        .problem(409, "job-failed");
    assert_eq!(problem["errors"][0]["pointer"], "/input/profiles/1");
    assert_eq!(problem["errors"][0]["hint"], "reverse it");
    assert!(
        problem["detail"]
            .as_str()
            .unwrap()
            .starts_with("invalid-input: "),
        "{problem}"
    );
}

#[tokio::test]
async fn waiting_works_on_the_result_too() {
    let service = service().await;
    let posted = service.post("/v1/jobs", job("deck").to_string()).await;
    let path = format!("{}/result?wait=20", posted.header("location"));
    assert_eq!(service.get(&path).await.status, StatusCode::OK);
}

#[tokio::test]
async fn failures_have_code_sentence_and_diagnostics() {
    let service = service().await;
    for (first, code, part) in [
        ("invalid", "invalid-input", "runs against"),
        ("numerical", "numerical", "singular"),
        ("panic", "worker-panic", ""),
    ] {
        let place = service.done(&job(first)).await;
        let seen = service.get(&place).await.json();
        assert_eq!(seen["status"], "failed", "{first}");
        assert_eq!(seen["error"]["code"], code);
        let detail = seen["error"]["detail"].as_str().unwrap();
        assert!(
            detail.contains(part) && !detail.contains("on purpose"),
            "{detail}"
        );
        let answer = service.get(&format!("{place}/diagnostics")).await;
        assert_eq!(answer.status, StatusCode::OK, "{first}");
        let told = answer.json();
        assert_eq!(told["status"], "failed");
        assert_eq!(told["error"]["code"], code);
        assert_eq!(told["figures"], Value::Null);
    }
}

#[tokio::test]
async fn diagnostics_of_a_success_and_of_a_job_that_waits() {
    let running = service().await;
    let place = running.done(&job("deck")).await;
    let told = running.get(&format!("{place}/diagnostics")).await.json();
    assert_eq!(told["verdict"], "within_limits");
    assert_eq!(told["figures"]["plates"][0]["twist_max_deg"], 0.25);
    let result = running.get(&format!("{place}/result")).await.json();
    assert_eq!(told["figures"], result["diagnostics"]);

    let idle = idle_service().await;
    let posted = idle.post("/v1/jobs", job("deck").to_string()).await;
    let answer = idle
        .get(&format!("{}/diagnostics", posted.header("location")))
        .await;
    answer.problem(409, "not-started");
}

#[tokio::test]
async fn cad_files_carry_names_units_and_verdict() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let step = service.get(&format!("{place}/result.step")).await;
    let step = String::from_utf8(step.body.to_vec()).unwrap();
    assert!(step.starts_with("ISO-10303-21;\n"));
    for part in [
        "FILE_DESCRIPTION(('within_limits: ",
        "SI_UNIT($,.METRE.)",
        "OPEN_SHELL(",
        "ADVANCED_FACE('deck \\X2\\2013\\X0\\ keel'",
        "POLYLINE('ruling 1'",
    ] {
        assert!(step.contains(part), "{part}");
    }
    let iges = service.get(&format!("{place}/result.igs")).await;
    let iges = String::from_utf8(iges.body.to_vec()).unwrap();
    for part in ["within_limits: ", ",6,1HM,", "11Hdeck - keel", "8Hruling 1"] {
        assert!(iges.contains(part), "{part}");
    }
}

/// Areas of the closed polylines of a drawing's layer CUT, arcs and all.
fn cut_areas(dxf: &str) -> Vec<f64> {
    let lines: Vec<&str> = dxf.lines().collect();
    let pairs: Vec<(&str, &str)> = (lines.chunks_exact(2))
        .map(|p| (p[0].trim(), p[1].trim()))
        .collect();
    let drawn = pairs.split(|p| p.0 == "0");
    let cut = drawn.filter(|e| e.contains(&("8", "CUT")) && e.contains(&("100", "AcDbPolyline")));
    cut.map(|entity| {
        assert!(entity.contains(&("70", "1")), "not closed");
        let mut corners: Vec<[f64; 3]> = Vec::new();
        for (code, value) in entity {
            let number = || value.parse::<f64>().unwrap();
            match (*code, corners.last_mut()) {
                ("10", _) => corners.push([number(), 0.0, 0.0]),
                ("20", Some(corner)) => corner[1] = number(),
                ("42", Some(corner)) => corner[2] = number(),
                _ => {}
            }
        }
        let next = corners.iter().cycle().skip(1);
        let twice = corners.iter().zip(next).map(|(a, b)| {
            let angle = 4.0 * a[2].atan();
            let chord2 = (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2);
            let segment = if angle == 0.0 {
                0.0
            } else {
                chord2 / (4.0 * (0.5 * angle).sin().powi(2)) * (angle - angle.sin())
            };
            a[0] * b[1] - a[1] * b[0] + segment
        });
        0.5 * twice.sum::<f64>().abs()
    })
    .collect()
}

#[tokio::test]
async fn plates_come_with_flat_patterns_and_roll_tables() {
    let service = real_service().await;
    let trawler = service.get("/v1/examples/trawler").await.json();
    let place = service.done(&trawler).await;
    let result = service.get(&format!("{place}/result.json")).await.json();
    let plates = result["method_specific"]["plates"].as_array().unwrap();
    let figures = result["diagnostics"]["plates"].as_array().unwrap();
    let file = async |extension: &str| {
        let file = service.get(&format!("{place}/result.{extension}")).await;
        String::from_utf8(file.body.to_vec()).unwrap()
    };

    let dxf = file("dxf").await;
    let areas = cut_areas(&dxf);
    assert_eq!(areas.len(), 3);
    for layer in ["CUT", "ROLL", "FRAME", "TEXT"] {
        assert!(dxf.contains(&format!("\r\n{layer}\r\n")), "{layer}");
    }
    assert_eq!(dxf.matches("LIMITS MET. Plate").count(), 3);
    assert_eq!(dxf.matches("inside up - lengths in ft").count(), 3);
    assert!(dxf.contains("\r\nx = 35 ft\r\n"), "a station");

    let csv = file("csv").await;
    let mut rows = csv.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    assert_eq!(header.len(), 21);
    assert_eq!(header[13], "piece");
    assert_eq!(header[19], "bend_up_to_next (deg)");

    for (k, plate) in plates.iter().enumerate() {
        let flat = &plate["flat"];
        assert_eq!(flat["side"], "inside");
        let piece = &flat["pieces"][0];
        let rulings = piece["rulings"].as_array().unwrap();
        assert_eq!(rulings.len(), plate["rulings"].as_array().unwrap().len());
        assert_eq!(rows.by_ref().take(rulings.len()).count(), rulings.len());
        // The cut area is the plate's, but for the strain of its twist.
        let number = |value: &Value| value.as_f64().unwrap();
        let twist = number(&flat["strain"]["twist_percent"]) / 100.0;
        let area = number(&figures[k]["area"]);
        assert!((areas[k] / number(&piece["area"]) - 1.0).abs() < 1e-9);
        assert!((areas[k] / area - 1.0).abs() < twist + 1e-6, "plate {k}");
        let strain = number(&figures[k]["membrane_strain_percent"]) / 100.0;
        assert!(twist <= strain * 1.01, "{twist} {strain}");
        assert!(number(&flat["strain"]["boundary_percent"]) < 1e-4);
        // Rulings keep their lengths.
        for (ruling, on_plate) in rulings.iter().zip(plate["rulings"].as_array().unwrap()) {
            let square =
                |i: usize| (number(&on_plate["to"][i]) - number(&on_plate["from"][i])).powi(2);
            let length = (0..3).map(square).sum::<f64>().sqrt();
            assert!(
                (number(&ruling["length"]) - length).abs() < 1e-6,
                "{ruling}"
            );
        }
    }
    assert_eq!(rows.count(), 0);
    let last = result["summary"].as_array().unwrap().last().unwrap();
    assert!(
        last.as_str()
            .unwrap()
            .starts_with("The flat patterns need sheets")
    );
    let svg = file("svg").await;
    assert!(svg.contains("flat patterns, 1 : 100<") && svg.contains("Body (y–z)"));
}

#[tokio::test]
async fn a_thick_plate_is_laid_out_by_its_middle() {
    let service = real_service().await;
    let mut trawler = service.get("/v1/examples/trawler").await.json();
    let number = |value: &Value| value.as_f64().unwrap();
    let mut lengths = Vec::new();
    for side in ["inside", "middle", "outside"] {
        trawler["options"]["thickness"] = json!(0.1);
        trawler["options"]["surface_side"] = json!(side);
        let place = service.done(&trawler).await;
        let result = service.get(&format!("{place}/result.json")).await.json();
        let flat = &result["method_specific"]["plates"][0]["flat"];
        assert_eq!(flat["developed"], "middle");
        // Its fans and slight creases are no harm.
        assert!(number(&flat["strain"]["twist_percent"]) < 0.05, "{flat}");
        assert!(number(&flat["strain"]["boundary_percent"]) < 1e-6, "{flat}");
        lengths.push(number(&flat["boundary_lengths"][0]));
        let dxf = service.get(&format!("{place}/result.dxf")).await;
        let dxf = String::from_utf8_lossy(&dxf.body).into_owned();
        assert!(dxf.contains("its thickness is allowed for"));
    }
    // The topside bulges outwards: what lies further out is longer, by half the
    // thickness times the bend.
    assert!(
        lengths[0] > lengths[1] && lengths[1] > lengths[2],
        "{lengths:?}"
    );
    assert!((lengths[0] + lengths[2] - 2.0 * lengths[1]).abs() < 1e-4);
}

#[tokio::test]
async fn units_scale_the_file_and_what_it_says_of_them() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let text = async |query: &str| {
        let answer = service.get(&format!("{place}/result.{query}")).await;
        assert_eq!(answer.status, StatusCode::OK, "{query}");
        String::from_utf8_lossy(&answer.body).into_owned()
    };
    // A vertex at (2, 0, 0.5) m.
    assert!(text("obj").await.contains("\nv 2 0 0.5\n"));
    let mm = text("obj?units=mm").await;
    assert!(mm.contains("# lengths in mm") && mm.contains("\nv 2000 0 500\n"));
    assert_eq!(text("obj?units=m").await, text("obj").await);
    assert!(text("stl?units=in").await.starts_with("lengths in in; "));
    assert!(
        text("ply?units=ft")
            .await
            .contains("comment lengths in ft; ")
    );
    assert!(text("glb?units=cm").await.contains("\"units\":\"cm\""));
    assert!(text("csv?units=mm").await.starts_with("plate,ruling"));
    assert!(text("csv?units=mm").await.contains("(mm)"));
    assert!(
        text("step?units=mm")
            .await
            .contains("SI_UNIT(.MILLI.,.METRE.)")
    );
    assert!(text("igs?units=in").await.contains("2HIN"));
    assert!(text("svg?units=ft").await.contains("ft"));
}

#[tokio::test]
async fn every_variant_has_its_own_tag_and_ranges() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let mut tags = std::collections::HashSet::new();
    for variant in ["obj", "obj?units=mm", "obj?units=ft", "stl", "stl?units=mm"] {
        let path = format!("{place}/result.{variant}");
        let whole = service.get(&path).await;
        let tag = whole.header("etag").to_owned();
        assert!(tags.insert(tag.clone()), "{variant}");
        let range = [("range", "bytes=5-8"), ("if-range", tag.as_str())];
        let part = service.get_with(&path, &range).await;
        assert_eq!(part.status, StatusCode::PARTIAL_CONTENT, "{variant}");
        assert_eq!(part.body, whole.body.slice(5..9));
        let same = service.get_with(&path, &[("if-none-match", &tag)]).await;
        assert_eq!(same.status, StatusCode::NOT_MODIFIED);
    }
}

#[tokio::test]
async fn strange_units_and_versions_are_named() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    for (query, pointer, code) in [
        ("result.obj?units=yd", "?units", "invalid-parameter"),
        ("result.obj?units=", "?units", "invalid-parameter"),
        ("result.obj?unit=mm", "?unit", "unknown-parameter"),
        ("result.step?version=r12", "?version", "unknown-parameter"),
        ("result.dxf?version=r13", "?version", "invalid-parameter"),
        ("result.json?units=mm", "?units", "unknown-parameter"),
        ("result.zip?units=mm", "?units", "unknown-parameter"),
        (
            "artifacts/result.json?units=mm",
            "?units",
            "unknown-parameter",
        ),
        (
            "artifacts/plate-1.glb?version=r12",
            "?version",
            "unknown-parameter",
        ),
        ("artifacts?units=mm", "?units", "unknown-parameter"),
    ] {
        let answer = service.get(&format!("{place}/{query}")).await;
        let problem = answer.problem(400, "invalid-query");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{query}");
        assert_eq!(problem["errors"][0]["code"], code, "{query}");
    }
}

#[tokio::test]
async fn artifacts_list_the_files_that_can_be_had() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let told = service.get(&place).await.json();
    let link = told["links"]["artifacts"].as_str().unwrap();
    assert_eq!(link, format!("{place}/artifacts"));
    let list = service.get(link).await.json();
    let items = list["items"].as_array().unwrap();
    let names: Vec<&str> = items.iter().map(|i| i["name"].as_str().unwrap()).collect();
    assert!(
        names.contains(&"result.glb") && names.contains(&"result.zip"),
        "{names:?}"
    );
    for item in items {
        let answer = service.get(item["href"].as_str().unwrap()).await;
        assert_eq!(answer.status, StatusCode::OK, "{item}");
        assert_eq!(answer.header("content-type"), item["media_type"]);
        let name = item["name"].as_str().unwrap();
        let same = service.get(&format!("{link}/{name}")).await;
        assert_eq!(same.body, answer.body, "{name}");
        let units = item["parameters"]
            .as_array()
            .unwrap()
            .contains(&json!("units"));
        let scaled = service.get(&format!("{link}/{name}?units=mm")).await;
        let expected = if units {
            StatusCode::OK
        } else {
            StatusCode::BAD_REQUEST
        };
        assert_eq!(scaled.status, expected, "{name}");
    }
    for name in ["plate-99.glb", "result.dwg", "..", "x", "plate-1.dwg"] {
        let answer = service.get(&format!("{link}/{name}")).await;
        answer.problem(404, "artifact-not-found");
    }
    let idle = idle_service().await;
    let posted = idle.post("/v1/jobs", job("deck").to_string()).await;
    let early = format!("{}/artifacts", posted.header("location"));
    idle.get(&early).await.problem(409, "result-not-ready");
    let early = format!("{early}/plate-1.glb");
    idle.get(&early).await.problem(409, "result-not-ready");
}

#[tokio::test]
async fn an_erased_job_s_files_are_gone_though_they_were_written() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let paths = ["result.glb", "artifacts/result.glb", "artifacts"];
    for path in paths {
        let answer = service.get(&format!("{place}/{path}")).await;
        assert_eq!(answer.status, StatusCode::OK, "{path}");
    }
    service.call(Method::DELETE, &place).await;
    for path in paths {
        let answer = service.get(&format!("{place}/{path}")).await;
        answer.problem(404, "job-not-found");
    }
}
