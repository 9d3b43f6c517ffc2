//! The built programme as a child process, for the tests that stop it.

use reqwest::blocking::{Client, Response};
use serde_json::Value;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Longer than anything here takes on a slow machine; only a hang reaches it.
pub const PATIENCE: Duration = Duration::from_secs(120);
/// Pause between two looks at the other process.
const LOOK_AGAIN: Duration = Duration::from_millis(10);

/// A running service; killed when dropped.
pub struct Service {
    child: Child,
    url: String,
    client: Client,
}

impl Service {
    /// Starts it on a data folder and waits for its one line.
    pub fn start(data: &Path) -> Service {
        let mut child = Command::new(env!("CARGO_BIN_EXE_mouldloft"))
            .args([
                "serve",
                "--listen",
                "127.0.0.1:0",
                "--workers",
                "1",
                "--log",
                "warn",
                "--data",
            ])
            .arg(data)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the programme starts");
        let stdout = child.stdout.take().expect("a pipe");
        let mut line = String::new();
        BufReader::new(stdout).read_line(&mut line).expect("a line");
        let url = line
            .trim()
            .strip_prefix("listening on ")
            .expect("the promised line")
            .to_owned();
        let client = Client::builder()
            .timeout(PATIENCE)
            .build()
            .expect("a client");
        Service { child, url, client }
    }

    pub fn get(&self, path: &str) -> reqwest::Result<Response> {
        self.client.get(format!("{}{path}", self.url)).send()
    }

    pub fn job(&self, id: &str) -> Value {
        self.get(&format!("/v1/jobs/{id}"))
            .and_then(Response::json)
            .expect("a job")
    }

    /// Posts a job under an idempotency key and returns the answer.
    pub fn post(&self, body: &str, key: &str) -> reqwest::Result<Response> {
        let request = self.client.post(format!("{}/v1/jobs", self.url));
        let request = request
            .header("Content-Type", "application/json")
            .header("Idempotency-Key", key);
        request.body(body.to_owned()).send()
    }

    /// Posts a job that must be taken and returns its id.
    pub fn submit(&self, body: &str, key: &str) -> String {
        let answer = self.post(body, key).expect("an answer");
        let status = answer.status().as_u16();
        let job: Value = answer.json().expect("JSON");
        assert!(matches!(status, 200 | 202), "{status}: {job}");
        job["id"].as_str().expect("an id").to_owned()
    }

    /// kill -9: no chance to tidy up.
    pub fn kill(&mut self) {
        self.child.kill().expect("killed");
        self.child.wait().expect("gone");
    }

    /// A polite signal by name, through the shell's own command.
    pub fn signal(&self, name: &str) {
        let status = Command::new("kill")
            .arg(format!("-{name}"))
            .arg(self.child.id().to_string())
            .status();
        assert!(status.expect("a kill command").success());
    }

    /// The exit status, once it has ended by itself.
    pub fn ended(&mut self) -> ExitStatus {
        until("the programme ends", || {
            self.child.try_wait().expect("a child")
        })
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Looks at the other process until there is something to see.
pub fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(seen) = look() {
            return seen;
        }
        assert!(Instant::now() < deadline, "waited in vain until {what}");
        std::thread::sleep(LOOK_AGAIN);
    }
}

/// Whether a job has reached one of its ends.
pub fn has_ended(job: &Value) -> bool {
    matches!(
        job["status"].as_str(),
        Some("successful" | "failed" | "dismissed")
    )
}
