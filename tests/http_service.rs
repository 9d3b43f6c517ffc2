//! Methods, examples, health, metrics and the documentation page.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::http::StatusCode;
use http_support::{idle_service, job, service};
use serde_json::{Value, json};

#[tokio::test]
async fn a_method_tells_options_with_default_unit_and_bounds() {
    let service = idle_service().await;
    let list = service.get("/v1/methods").await.json();
    assert_eq!(list["items"][0]["href"], "/v1/methods/hull_plates");
    let method = service.get("/v1/methods/hull_plates").await.json();
    let option = |name: &str| {
        let options = method["options"].as_array().unwrap();
        options
            .iter()
            .find(|o| o["name"] == name)
            .unwrap_or_else(|| panic!("{name}"))
            .clone()
    };
    let twist = option("max_twist_deg");
    assert_eq!(twist["default"], 6.0);
    assert_eq!(twist["unit"], "degrees");
    assert_eq!(twist["schema"]["maximum"], 45);
    assert_eq!(twist["schema"]["exclusiveMinimum"], 0);
    assert_eq!(option("thickness")["unit"], "length");
    assert_eq!(option("max_fan_percent")["default"], 20.0);
    assert_eq!(option("boundary")["default"], json!({"mode": "auto"}));
    assert_eq!(option("ends")["default"], "fan");
    for option in method["options"].as_array().unwrap() {
        assert!(
            !option["description"].as_str().unwrap().is_empty(),
            "{option}"
        );
    }
    assert_eq!(method["input"][0]["name"], "profiles");
    assert_eq!(method["input"][0]["required"], true);
    assert_eq!(
        method["formats"],
        json!([
            "json", "obj", "stl", "ply", "glb", "csv", "svg", "step", "igs", "dxf", "zip"
        ])
    );
}

#[tokio::test]
async fn examples_can_be_posted_as_they_are() {
    let service = idle_service().await;
    let list = service.get("/v1/examples").await.json();
    let items = list["items"].as_array().unwrap();
    assert!(items.len() >= 6);
    assert_eq!(items[0]["name"], "trawler");
    for item in items {
        let example = service.get(item["href"].as_str().unwrap()).await;
        assert_eq!(example.header("content-type"), "application/json");
        let posted = service.post("/v1/jobs", example.body).await;
        assert_eq!(posted.status, StatusCode::ACCEPTED, "{item}");
    }
}

#[tokio::test]
async fn the_trawler_is_the_published_one() {
    let service = idle_service().await;
    let trawler = service.get("/v1/examples/trawler").await.json();
    assert_eq!(trawler["units"], "ft");
    let profiles = trawler["input"]["profiles"].as_array().unwrap();
    let names: Vec<&Value> = profiles.iter().map(|p| &p["name"]).collect();
    assert_eq!(
        names,
        ["main_deck", "upper_chine", "lower_chine", "profile"]
    );
    assert!(
        profiles
            .iter()
            .all(|p| p["points"].as_array().unwrap().len() == 13)
    );
    assert_eq!(profiles[0]["points"][12], json!([70.0, 1.71, 14.19]));
    assert_eq!(profiles[3]["points"][11], json!([66.5, 0.0, 1.11]));
}

#[tokio::test]
async fn health_and_version() {
    let service = service().await;
    assert_eq!(service.get("/livez").await.json()["status"], "ok");
    let ready = service.get("/readyz").await;
    assert_eq!(ready.status, StatusCode::OK);
    assert_eq!(ready.json()["workers"], 1);
    assert_eq!(ready.header("cache-control"), "no-store");
    let version = service.get("/version").await.json();
    assert_eq!(version["name"], "mouldloft");
    assert_eq!(version["version"], env!("CARGO_PKG_VERSION"));
}

#[tokio::test]
async fn metrics_count_requests_by_route_and_jobs_by_end() {
    let service = service().await;
    service.done(&job("deck")).await;
    service.done(&job("invalid")).await;
    service
        .get("/v1/jobs/5b7c2f5e-9f0e-4f3a-8a57-3a1c1d2e4f60")
        .await;
    let answer = service.get("/metrics").await;
    assert!(answer.header("content-type").starts_with("text/plain"));
    let text = String::from_utf8(answer.body.to_vec()).unwrap();
    for line in [
        r#"mouldloft_http_requests_total{method="POST",route="/v1/jobs",status="200"} 2"#,
        r#"mouldloft_http_requests_total{method="GET",route="/v1/jobs/{id}",status="404"} 1"#,
        r#"mouldloft_jobs_accepted_total{method="hull_plates"} 2"#,
        r#"mouldloft_jobs_ended_total{method="hull_plates",status="successful",code=""} 1"#,
        "mouldloft_jobs_queued 0",
        "mouldloft_workers 1",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
}

#[tokio::test]
async fn two_services_do_not_mix_their_figures() {
    let (one, other) = (idle_service().await, idle_service().await);
    one.get("/livez").await;
    let text = |answer: http_support::Answer| String::from_utf8(answer.body.to_vec()).unwrap();
    assert!(text(one.get("/metrics").await).contains(r#"route="/livez""#));
    assert!(!text(other.get("/metrics").await).contains(r#"route="/livez""#));
}

#[tokio::test]
async fn the_page_needs_no_other_host() {
    let service = idle_service().await;
    let redirect = service.get("/docs").await;
    assert_eq!(redirect.status, StatusCode::SEE_OTHER);
    assert_eq!(redirect.header("location"), "/docs/");
    let page = service.get_raw("/docs/").await;
    assert_eq!(page.header("content-type"), "text/html");
    let text = String::from_utf8(page.body.to_vec()).unwrap();
    assert!(
        !text.contains("https://") && !text.contains("//cdn"),
        "{text}"
    );
    for part in [
        "swagger-ui.css",
        "swagger-ui-bundle.js",
        "swagger-initializer.js",
    ] {
        assert!(text.contains(part));
        let file = service.get_raw(&format!("/docs/{part}")).await;
        assert_eq!(file.status, StatusCode::OK, "{part}");
        assert!(!file.body.is_empty());
    }
    let start = service.get_raw("/docs/swagger-initializer.js").await;
    assert!(String::from_utf8_lossy(&start.body).contains("/openapi.json"));
}

#[tokio::test]
async fn both_notations_tell_the_same() {
    let service = idle_service().await;
    let json = service.get("/openapi.json").await.json();
    assert_eq!(json["openapi"], "3.1.0");
    let yaml = service.get("/openapi.yaml").await;
    assert_eq!(yaml.header("content-type"), "application/yaml");
    let text = String::from_utf8(yaml.body.to_vec()).unwrap();
    for path in json["paths"].as_object().unwrap().keys() {
        assert!(text.contains(&format!("\n  {path}:")), "{path}");
    }
}
