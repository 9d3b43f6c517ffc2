//! The commands as a shell sees them: exit codes, what goes to which stream,
//! which files appear.

use std::path::Path;
use std::process::{Command, Output};

fn mouldloft(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mouldloft"))
        .current_dir(folder)
        .args(args)
        .output()
        .expect("the programme runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

const PLANE: &str = r#"{"method":"hull_plates","units":"m","input":{"profiles":[
    {"name":"a","points":[[0,0,0],[1,0,0],[2,0,0],[3,0,0]]},
    {"name":"b","points":[[0,1,0],[1,1,0],[2,1,0],[3,1,0]]}]}}"#;

#[test]
fn a_job_is_fitted_without_a_server() {
    let folder = folder();
    std::fs::write(folder.path().join("job.json"), PLANE).expect("writable");
    let done = mouldloft(
        folder.path(),
        &["fit", "job.json", "--out", "out", "--format", "svg,obj"],
    );
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    for name in ["result.json", "result.svg", "result.obj"] {
        assert!(folder.path().join("out").join(name).is_file(), "no {name}");
        assert!(text(&done.stdout).contains(name));
    }
    assert!(
        !folder.path().join("out/result.csv").exists(),
        "nobody asked for it"
    );
}

#[test]
fn an_invalid_job_is_refused_with_its_place() {
    let folder = folder();
    let job = PLANE.replace("[3,0,0]", "[3,0,\"x\"]");
    std::fs::write(folder.path().join("job.json"), job).expect("writable");
    let refused = mouldloft(folder.path(), &["fit", "job.json"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("/input/profiles/0/points/3/2"),
        "{}",
        text(&refused.stderr)
    );
    assert!(refused.stdout.is_empty());
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("readable").count(),
        1,
        "no files"
    );
}

#[test]
fn a_missing_job_is_trouble() {
    let folder = folder();
    let missing = mouldloft(folder.path(), &["fit", "nowhere.json"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(text(&missing.stderr).contains("nowhere.json cannot be read"));
}

#[test]
fn the_demonstration_ends_by_itself_and_leaves_its_files() {
    let folder = folder();
    let shown = mouldloft(folder.path(), &["demo"]);
    assert_eq!(shown.status.code(), Some(0), "{}", text(&shown.stderr));
    let told = text(&shown.stdout);
    assert!(told.starts_with("listening on http://127.0.0.1:"), "{told}");
    assert!(
        told.contains("max twist") && told.contains("curl"),
        "{told}"
    );
    for format in ["json", "svg", "obj", "csv", "step", "igs"] {
        let path = folder
            .path()
            .join("demo-out")
            .join(format!("trawler.{format}"));
        assert!(
            path.metadata().is_ok_and(|m| m.len() > 1_000),
            "no {}",
            path.display()
        );
    }
}

#[test]
fn the_doctor_finds_a_good_store_good_and_a_bad_one_bad() {
    let folder = folder();
    let good = mouldloft(folder.path(), &["doctor", "--data", "data"]);
    assert_eq!(good.status.code(), Some(0), "{}", text(&good.stdout));
    assert!(text(&good.stdout).contains("small cone"));
    std::fs::write(folder.path().join("file"), "").expect("writable");
    let bad = mouldloft(folder.path(), &["doctor", "--data", "file/data"]);
    assert_eq!(bad.status.code(), Some(1));
    assert!(text(&bad.stdout).contains("BAD"), "{}", text(&bad.stdout));
}

#[test]
fn strangers_stay_out_unless_let_in() {
    let folder = folder();
    let refused = mouldloft(
        folder.path(),
        &["serve", "--listen", "0.0.0.0:0", "--ephemeral"],
    );
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("--allow-unauthenticated"));
}

#[test]
fn a_service_that_is_not_there_is_not_healthy() {
    let folder = folder();
    // Port 1 is reserved and never listened on.
    let sick = mouldloft(folder.path(), &["health", "--listen", "127.0.0.1:1"]);
    assert_eq!(sick.status.code(), Some(1));
}
