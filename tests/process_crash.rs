//! The programme is killed, stopped and started again: what was accepted is
//! fitted, once, and nothing is lost.

mod process;

use process::{Service, has_ended, until};
use serde_json::Value;

/// The real hull; a fit takes long enough to be caught in the act.
fn trawler(service: &Service) -> String {
    let example = service.get("/v1/examples/trawler").expect("an answer");
    example.text().expect("a body")
}

fn submit(service: &Service, body: &str, count: usize) -> Vec<String> {
    (0..count)
        .map(|i| service.submit(body, &format!("crash-{i}")))
        .collect()
}

/// Waits until a worker has one of the jobs and the rest wait.
fn until_running(service: &Service, ids: &[String]) {
    until("a fit runs", || {
        ids.iter()
            .any(|id| service.job(id)["status"] == "running")
            .then_some(())
    });
}

fn until_all_ended(service: &Service, ids: &[String]) -> Vec<Value> {
    let ended = |id: &String| until("a job ends", || Some(service.job(id)).filter(has_ended));
    ids.iter().map(ended).collect()
}

fn result(service: &Service, id: &str) -> String {
    let answer = service
        .get(&format!("/v1/jobs/{id}/result"))
        .expect("an answer");
    assert_eq!(answer.status().as_u16(), 200);
    answer.text().expect("a body")
}

#[test]
fn every_accepted_job_ends_once_though_the_programme_is_killed() {
    const JOBS: usize = 8;
    const KILLS: usize = 2;
    let data = tempfile::tempdir().expect("a folder");
    let mut service = Service::start(data.path());
    let body = trawler(&service);
    let ids = submit(&service, &body, JOBS);
    for _ in 0..KILLS {
        until_running(&service, &ids);
        service.kill();
        service = Service::start(data.path());
    }

    let jobs = until_all_ended(&service, &ids);
    for job in &jobs {
        assert_eq!(job["status"], "successful", "{job}");
        let attempts = job["attempt"].as_u64().expect("a number");
        assert!((1..=1 + KILLS as u64).contains(&attempts), "{job}");
    }
    let interrupted = jobs
        .iter()
        .filter(|j| j["attempt"].as_u64() > Some(1))
        .count();
    assert!(interrupted > 0, "no fit was caught in the act");

    let first = result(&service, &ids[0]);
    assert!(
        ids.iter().all(|id| result(&service, id) == first),
        "one job, several results"
    );
    assert_eq!(
        submit(&service, &body, JOBS),
        ids,
        "a client's retry doubles nothing"
    );
    let listed: Value = service
        .get("/v1/jobs?limit=200")
        .and_then(|a| a.json())
        .expect("a list");
    assert_eq!(
        listed["items"].as_array().map(Vec::len),
        Some(JOBS),
        "nothing lost, nothing doubled"
    );
}

#[cfg(unix)]
#[test]
fn a_polite_stop_lets_the_running_fit_end() {
    const JOBS: usize = 6;
    let data = tempfile::tempdir().expect("a folder");
    let mut service = Service::start(data.path());
    let body = trawler(&service);
    let ids = submit(&service, &body, JOBS);
    until_running(&service, &ids);
    service.signal("TERM");
    assert_eq!(service.ended().code(), Some(0));

    let service = Service::start(data.path());
    for job in until_all_ended(&service, &ids) {
        assert_eq!(job["status"], "successful", "{job}");
        assert_eq!(job["attempt"], 1, "a polite stop wastes no attempt: {job}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_an_idle_service_in_order() {
    let data = tempfile::tempdir().expect("a folder");
    let mut service = Service::start(data.path());
    assert_eq!(
        service.get("/readyz").expect("an answer").status().as_u16(),
        200
    );
    service.signal("INT");
    assert_eq!(service.ended().code(), Some(0));
}
