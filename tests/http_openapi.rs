//! The OpenAPI document: the committed file is current, every route is in it
//! and answers, and real answers keep to its schemas.
//! `MOULDLOFT_UPDATE=1 cargo test --test http_openapi` writes the file anew.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::body::Body;
use axum::http::Method;
use http_support::{Answer, Service, idle_service, job, service};
use mouldloft::http::examples::EXAMPLES;
use mouldloft::http::problem::{Code, Success};
use mouldloft::http::{Document, document};
use serde_json::{Value, json};
use std::collections::BTreeSet;

const COMMITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.yaml");

#[test]
fn the_committed_document_is_current() {
    let current = Document::write(&document()).unwrap().yaml;
    if std::env::var_os("MOULDLOFT_UPDATE").is_some() {
        std::fs::write(COMMITTED, &current).unwrap();
    }
    let committed = std::fs::read(COMMITTED).unwrap_or_default();
    assert!(
        committed == current,
        "openapi.yaml is not current: run `MOULDLOFT_UPDATE=1 cargo test --test http_openapi`"
    );
}

fn published() -> Value {
    serde_json::from_slice(&Document::write(&document()).unwrap().json).unwrap()
}

/// All (path, method, operation) of the document.
fn operations(document: &Value) -> Vec<(String, Method, Value)> {
    let mut all = Vec::new();
    for (path, item) in document["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap() {
            let method = method.to_uppercase().parse().unwrap();
            all.push((path.clone(), method, operation.clone()));
        }
    }
    all
}

#[test]
fn operations_are_told_apart_and_described() {
    let document = published();
    let mut ids = BTreeSet::new();
    for (path, method, operation) in operations(&document) {
        let id = operation["operationId"]
            .as_str()
            .unwrap_or_default()
            .to_owned();
        assert!(
            ids.insert(id.clone()) && !id.is_empty(),
            "{method} {path}: {id}"
        );
        for field in ["summary", "tags"] {
            assert!(
                !operation[field].is_null(),
                "{method} {path} has no {field}"
            );
        }
        for parameter in operation["parameters"].as_array().into_iter().flatten() {
            assert!(
                parameter["description"].is_string(),
                "{method} {path} {parameter}"
            );
        }
    }
}

/// Every `$ref` leads somewhere.
#[test]
fn no_reference_dangles() {
    fn walk(value: &Value, document: &Value) {
        if let Some(target) = value["$ref"].as_str() {
            let pointer = target.strip_prefix('#').unwrap();
            assert!(document.pointer(pointer).is_some(), "{target}");
        }
        match value {
            Value::Array(items) => items.iter().for_each(|v| walk(v, document)),
            Value::Object(fields) => fields.values().for_each(|v| walk(v, document)),
            _ => {}
        }
    }
    let document = published();
    walk(&document, &document);
}

#[tokio::test]
async fn every_documented_operation_is_routed() {
    let service = idle_service().await;
    for (path, method, _) in operations(&published()) {
        let path = path
            .replace("{id}", "5b7c2f5e-9f0e-4f3a-8a57-3a1c1d2e4f60")
            .replace("{name}", "nothing")
            .replace("/docs/{file}", "/docs/swagger-ui.css")
            .replace("/page/{part}", "/page/style.css");
        let answer = service.call(method.clone(), &path).await;
        // A page that tells of no such job is an answer of its route.
        let is_problem = answer.header("content-type") == "application/problem+json";
        let told = is_problem && !answer.body.is_empty();
        let code = told.then(|| answer.json()["code"].clone());
        let routed = !matches!(answer.status.as_u16(), 405)
            && code.as_ref().is_none_or(|code| code != "not-found");
        assert!(routed, "{method} {path}: {} {code:?}", answer.status);
    }
}

/// A path with all its methods tried gives those in the document, no others:
/// a route that is registered past the document would show here.
#[tokio::test]
async fn no_documented_path_answers_undocumented_methods() {
    let service = idle_service().await;
    let document = published();
    for (path, item) in document["paths"].as_object().unwrap() {
        let concrete = path
            .replace("{id}", "x")
            .replace("{name}", "x")
            .replace("{file}", "x");
        let answer = service.call(Method::TRACE, &concrete).await;
        answer.problem(405, "method-not-allowed");
        let allowed: BTreeSet<String> = answer
            .header("allow")
            .split(',')
            .map(|m| m.trim().to_lowercase())
            .collect();
        let mut documented: BTreeSet<String> = item.as_object().unwrap().keys().cloned().collect();
        if documented.contains("get") {
            // HEAD goes with GET everywhere (RFC 9110); it is documented for files.
            documented.insert("head".into());
        }
        assert_eq!(allowed, documented, "{path}");
    }
}

/// The source registers routes only through the macro that documents them.
#[test]
fn no_route_is_registered_past_the_document() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/http");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let shipped = text.split("#[cfg(test)]").next().unwrap();
            for bypass in [".route(", ".nest(", ".route_service(", ".nest_service("] {
                assert!(
                    !shipped.contains(bypass),
                    "{} uses {bypass}",
                    path.display()
                );
            }
        }
    }
}

/// The schema of an answer, with the document's components at hand.
fn schema(document: &Value, method: &str, path: &str, answer: &Answer) -> Value {
    let status = answer.status.as_u16().to_string();
    let mut response = &document["paths"][path][method]["responses"][&status];
    assert!(
        !response.is_null(),
        "{method} {path}: {status} is not documented"
    );
    if let Some(target) = response["$ref"].as_str() {
        response = document.pointer(target.strip_prefix('#').unwrap()).unwrap();
    }
    let kind = answer.header("content-type").split(';').next().unwrap();
    let content = &response["content"][kind]["schema"];
    assert!(
        !content.is_null(),
        "{method} {path} {status}: {kind} is not documented"
    );
    json!({"allOf": [content], "components": document["components"]})
}

#[track_caller]
fn check(document: &Value, method: &str, path: &str, answer: &Answer) {
    let schema = schema(document, method, path, answer);
    let validator = jsonschema::draft202012::options().build(&schema).unwrap();
    let value = answer.json();
    let errors: Vec<String> = validator
        .iter_errors(&value)
        .map(|e| format!("{}: {e}", e.instance_path()))
        .collect();
    assert!(
        errors.is_empty(),
        "{method} {path} {}: {errors:#?}",
        answer.status
    );
}

#[tokio::test]
async fn answers_keep_to_their_schemas() {
    let document = published();
    let service = service().await;
    for path in [
        "/livez",
        "/readyz",
        "/version",
        "/v1/methods",
        "/v1/examples",
        "/openapi.json",
    ] {
        check(&document, "get", path, &service.get(path).await);
    }
    let method = service.get("/v1/methods/hull_plates").await;
    check(&document, "get", "/v1/methods/{name}", &method);
    let missing = service.get("/v1/methods/x").await;
    check(&document, "get", "/v1/methods/{name}", &missing);
    jobs_keep_to_their_schemas(&document, &service).await;
    measurements_keep_to_their_schemas(&document, &service).await;
    results_keep_to_their_schemas(&document, &service).await;
}

async fn measurements_keep_to_their_schemas(document: &Value, service: &Service) {
    let surface = |corner: Value| {
        json!({
            "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
            "control_points": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], corner]],
        })
    };
    let bodies = [
        json!({"units": "m", "surfaces": [surface(json!([1, 1, 0.1]))],
               "target": [{"name": "deck", "points": [[0, 0, 0]]}]}),
        // Neither area nor size.
        json!({"units": "m", "surfaces": [{
            "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
            "control_points": [[[1, 1, 1], [1, 1, 1]], [[1, 1, 1], [1, 1, 1]]],
        }]}),
        json!({"units": "m", "surfaces": [surface(json!([1, 1, null]))]}),
        json!({"units": "m", "surfaces": []}),
    ];
    for body in bodies {
        let answer = service.post("/v1/verify", body.to_string()).await;
        check(document, "post", "/v1/verify", &answer);
    }
    check(
        document,
        "post",
        "/v1/verify",
        &service.post("/v1/verify", "{").await,
    );
}

async fn jobs_keep_to_their_schemas(document: &Value, service: &Service) {
    for query in ["", "?wait=20", "?validate_only=true"] {
        let posted = service
            .post(&format!("/v1/jobs{query}"), job("deck").to_string())
            .await;
        check(document, "post", "/v1/jobs", &posted);
    }
    for bad in ["{", "{}", r#"{"method":"fairing"}"#] {
        check(
            document,
            "post",
            "/v1/jobs",
            &service.post("/v1/jobs", bad).await,
        );
    }
    let untyped = service.post_with("/v1/jobs", &[], "{}").await;
    check(document, "post", "/v1/jobs", &untyped);
    for path in ["/v1/jobs", "/v1/jobs?limit=1", "/v1/jobs?limit=x"] {
        check(document, "get", "/v1/jobs", &service.get(path).await);
    }
    let slow = service.post("/v1/jobs", job("slow").to_string()).await;
    let slow = slow.header("location").to_owned();
    check(document, "get", "/v1/jobs/{id}", &service.get(&slow).await);
    let early = service.get(&format!("{slow}/result")).await;
    check(document, "get", "/v1/jobs/{id}/result", &early);
    let cancel = service.post(&format!("{slow}/cancel"), Body::empty()).await;
    check(document, "post", "/v1/jobs/{id}/cancel", &cancel);
}

async fn results_keep_to_their_schemas(document: &Value, service: &Service) {
    for first in ["deck", "invalid", "panic", "numerical"] {
        let place = service.done(&job(first)).await;
        check(document, "get", "/v1/jobs/{id}", &service.get(&place).await);
        let end = if first == "deck" {
            vec!["result", "result.json", "input", "artifacts"]
        } else {
            vec![]
        };
        for part in end.into_iter().chain(["diagnostics"]) {
            // The input comes back as posted, without a newline of its own.
            let answer = service.get_raw(&format!("{place}/{part}")).await;
            check(document, "get", &format!("/v1/jobs/{{id}}/{part}"), &answer);
        }
    }
}

#[test]
fn examples_keep_to_the_schema_of_a_job() {
    let document = published();
    let body = &document["paths"]["/v1/jobs"]["post"]["requestBody"]["content"]["application/json"];
    let schema = json!({"allOf": [body["schema"]], "components": document["components"]});
    let validator = jsonschema::draft202012::options().build(&schema).unwrap();
    for example in EXAMPLES {
        let value: Value = serde_json::from_str(example.body).unwrap();
        assert!(validator.is_valid(&value), "{}", example.name);
    }
    assert!(!validator.is_valid(&json!({"method": "hull_plates"})));
    assert!(body["examples"]["trawler"]["value"]["input"].is_object());
}

/// The schema alone decides alike in our checker and in the reference one.
#[tokio::test]
async fn our_checker_agrees_with_the_reference() {
    let document = published();
    let body = &document["paths"]["/v1/jobs"]["post"]["requestBody"]["content"]["application/json"];
    let schema = json!({"allOf": [body["schema"]], "components": document["components"]});
    let validator = jsonschema::draft202012::options().build(&schema).unwrap();
    let service = idle_service().await;
    let edits: Vec<(&str, Value)> = vec![
        ("/label", json!(null)),
        ("/label", json!(7)),
        ("/units", json!("yd")),
        ("/options", json!({})),
        ("/options", json!(null)),
        ("/options", json!({"max_twist_deg": 45})),
        ("/options", json!({"max_twist_deg": 45.1})),
        ("/options", json!({"max_twist_deg": 0})),
        ("/options", json!({"thickness": null})),
        ("/options", json!({"thickness": -1})),
        ("/options", json!({"ends": "fan", "solver": "paper"})),
        ("/options", json!({"ends": "both"})),
        ("/options", json!({"boundary": {"mode": "auto", "x": 1}})),
        ("/options", json!({"boundary": {}})),
        (
            "/options",
            json!({"pinned_rulings": [{"plate": 0, "from": [0, 0, 0], "to": [0, 1, 0]}]}),
        ),
        (
            "/options",
            json!({"pinned_rulings": [{"plate": 0.5, "from": [0, 0, 0], "to": [0, 1, 0]}]}),
        ),
        ("/budget", json!({"time_s": 3601})),
        ("/budget", json!({})),
        ("/input", json!({"profiles": [{"name": "a"}]})),
        ("/input/profiles/0/name", json!("")),
        ("/input/profiles/0/points/0", json!([0, 0, 0, 0])),
        ("/input/profiles/0/points/0", json!([0, 0, 1e10])),
        ("/extra", json!(1)),
    ];
    for (pointer, value) in edits {
        let mut job = job("deck");
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = job.pointer_mut(parent).unwrap();
        match parent {
            Value::Array(items) => items[key.parse::<usize>().unwrap()] = value.clone(),
            other => other[key] = value.clone(),
        }
        let answer = service
            .post("/v1/jobs?validate_only=true", job.to_string())
            .await;
        assert_eq!(
            answer.status.as_u16() == 200,
            validator.is_valid(&job),
            "{pointer} = {value}: {}",
            answer.json()
        );
    }
}

/// Every status a problem or a success can have is documented somewhere.
#[test]
fn every_status_is_documented() {
    let document = published();
    let mut documented = BTreeSet::new();
    for (_, _, operation) in operations(&document) {
        documented.extend(operation["responses"].as_object().unwrap().keys().cloned());
    }
    for code in Code::ALL.iter().filter(|c| **c != Code::MethodNotAllowed) {
        assert!(
            documented.contains(&code.status().as_u16().to_string()),
            "{code:?}"
        );
    }
    for success in [
        Success::Here,
        Success::Accepted,
        Success::Erased,
        Success::Part,
        Success::Unchanged,
    ] {
        assert!(
            documented.contains(&success.status().as_u16().to_string()),
            "{success:?}"
        );
    }
}
