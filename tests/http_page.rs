//! The page for people: its parts, their headers, a job that does not exist.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use http_support::{Answer, idle_service, job};

const PARTS: [(&str, &str); 8] = [
    ("/", "text/html; charset=utf-8"),
    ("/page/style.css", "text/css; charset=utf-8"),
    ("/page/index.js", "text/javascript; charset=utf-8"),
    ("/page/view.js", "text/javascript; charset=utf-8"),
    ("/page/viewer.js", "text/javascript; charset=utf-8"),
    ("/page/model.js", "text/javascript; charset=utf-8"),
    ("/page/service.js", "text/javascript; charset=utf-8"),
    ("/page/icon.svg", "image/svg+xml"),
];

fn text(answer: &Answer) -> String {
    String::from_utf8(answer.body.to_vec()).unwrap()
}

/// Only the page's own files, and names that nobody fetches.
fn stays_at_home(answer: &Answer) {
    let policy = answer.header("content-security-policy");
    assert!(policy.contains("default-src 'self'"), "{policy}");
    assert!(!policy.contains("unsafe"), "{policy}");
    let text = text(answer).replace("http://www.w3.org/2000/svg", "");
    assert!(!text.contains("://"), "an address of elsewhere");
    for inline in ["style=\"", "onclick=\"", "<style", "<script>"] {
        assert!(!text.contains(inline), "{inline}");
    }
}

#[tokio::test]
async fn every_part_has_its_type_its_policy_and_a_tag() {
    let service = idle_service().await;
    for (path, kind) in PARTS {
        let answer = service.get(path).await;
        assert_eq!(answer.status, 200, "{path}");
        assert_eq!(answer.header("content-type"), kind, "{path}");
        stays_at_home(&answer);
        let etag = answer.header("etag").to_owned();
        let again = service.get_with(path, &[("if-none-match", &etag)]).await;
        assert_eq!(again.status, 304, "{path}");
    }
}

#[tokio::test]
async fn every_part_that_a_page_names_is_there() {
    let service = idle_service().await;
    for (path, _) in PARTS {
        let text = text(&service.get(path).await);
        for quoted in text.split('"').filter(|q| q.starts_with("/page/")) {
            assert_eq!(service.get(quoted).await.status, 200, "{path}: {quoted}");
        }
    }
    service.get("/page/none.js").await.problem(404, "not-found");
}

#[tokio::test]
async fn a_job_links_to_its_view() {
    let service = idle_service().await;
    let posted = service
        .post("/v1/jobs", job("keel").to_string())
        .await
        .json();
    let link = posted["links"]["view"].as_str().unwrap();
    assert_eq!(
        link,
        format!("/jobs/{}/view", posted["id"].as_str().unwrap())
    );
    let answer = service.get(link).await;
    assert_eq!(answer.status, 200);
    assert!(text(&answer).contains("/page/view.js"));
    stays_at_home(&answer);
}

#[tokio::test]
async fn a_job_that_is_not_there_is_told_in_html_with_the_way_back() {
    let service = idle_service().await;
    for id in ["00000000-0000-4000-8000-000000000000", "nonsense"] {
        let answer = service.get(&format!("/jobs/{id}/view")).await;
        assert_eq!(answer.status, 404, "{id}");
        assert_eq!(answer.header("content-type"), "text/html; charset=utf-8");
        assert!(text(&answer).contains("<a href=\"/\">Back to all jobs</a>"));
        stays_at_home(&answer);
    }
}
