//! `mouldloft demo`: the whole loft in one go. A real service on a free port of
//! this machine, the trawler posted to it over HTTP, the answer shown and
//! saved, and the same story as `curl` lines.

use super::client::{Client, ClientError};
use super::{Exit, figures, files, out};
use crate::app::{AppError, Service, Signals};
use crate::settings::{DemoSettings, FrontSettings, ServeSettings, StoreSettings};
use serde_json::Value;
use std::net::SocketAddr;
use std::time::Duration;
use thiserror::Error;

/// The example that is posted.
const EXAMPLE: &str = "/v1/examples/trawler";
/// What is fetched of the result.
const FORMATS: [&str; 7] = ["json", "svg", "obj", "csv", "dxf", "step", "igs"];
/// Asks for a job's end are repeated this often; each waits up to 55 s.
const MOST_WAITS: usize = 6;
/// At the end nothing is running that deserves more patience.
const GRACE: Duration = Duration::from_secs(5);

/// Why the demonstration broke off.
#[derive(Debug, Error)]
enum DemoError {
    #[error(transparent)]
    App(#[from] AppError),
    #[error(transparent)]
    Client(#[from] ClientError),
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("the job ended as {status}: {why}")]
    NotSuccessful { status: String, why: String },
}

/// Shows everything, then ends or stays up.
pub async fn run(settings: &DemoSettings) -> Exit {
    match show(settings).await {
        Ok(()) => Exit::Done,
        Err(error) => {
            out::complain(&error.to_string());
            match error {
                DemoError::NotSuccessful { .. } => Exit::FitFailed,
                _ => Exit::Trouble,
            }
        }
    }
}

async fn show(settings: &DemoSettings) -> Result<(), DemoError> {
    let mut signals = Signals::listen().map_err(AppError::Signals)?;
    let mut serve = ServeSettings {
        store: StoreSettings::ephemeral(),
        front: FrontSettings::loopback(),
    };
    // One job at a time: it may have every core.
    serve.store.workers = std::thread::available_parallelism().ok().map(Into::into);
    let service = Service::start(&serve).await?;
    let address = service.address();
    out::line(&format!("listening on http://{address}"));
    let told = tell(address, settings).await;
    if settings.keep && told.is_ok() {
        out::line("\nThe service stays up; Ctrl-C ends it.");
        service.until_signal(&mut signals, GRACE).await?;
    } else {
        service.shut_down(GRACE).await;
    }
    told
}

/// Posts, waits, shows, saves.
async fn tell(address: SocketAddr, settings: &DemoSettings) -> Result<(), DemoError> {
    let client = Client::new(address);
    let job = client.get(EXAMPLE).await?;
    let accepted = client.post_json("/v1/jobs", &job).await?;
    let id = accepted["id"].as_str().unwrap_or_default().to_owned();
    out::line(&format!("posted {EXAMPLE} as job {id}"));
    let ended = wait(&client, &id).await?;
    let result = client.get_json(&format!("/v1/jobs/{id}/result")).await?;
    out::line(&format!(
        "fitted in {} ms\n",
        ended["solve_ms"].as_f64().unwrap_or(f64::NAN).round()
    ));
    for sentence in result["summary"].as_array().into_iter().flatten() {
        out::line(sentence.as_str().unwrap_or_default());
    }
    out::line(&format!("\n{}", figures::table(&result)));
    for format in FORMATS {
        let bytes = client
            .get(&format!("/v1/jobs/{id}/result.{format}"))
            .await?;
        let path = files::write(&settings.out, &format!("trawler.{format}"), &bytes)?;
        out::line(&format!("saved {}", path.display()));
    }
    out::line(&curl_lines(address));
    if settings.keep {
        out::line(&format!("In a browser: http://{address}/jobs/{id}/view"));
    }
    Ok(())
}

/// The job once it has ended well.
async fn wait(client: &Client, id: &str) -> Result<Value, DemoError> {
    let mut job = Value::Null;
    for _ in 0..MOST_WAITS {
        job = client.get_json(&format!("/v1/jobs/{id}?wait=55")).await?;
        match job["status"].as_str() {
            Some("accepted" | "running") => continue,
            Some("successful") => return Ok(job),
            _ => break,
        }
    }
    let text = |value: &Value| value.as_str().unwrap_or("unknown").to_owned();
    Err(DemoError::NotSuccessful {
        status: text(&job["status"]),
        why: text(&job["error"]["detail"]),
    })
}

/// The same by hand, against a service that stays up.
fn curl_lines(address: SocketAddr) -> String {
    let base = format!("http://{address}");
    format!(
        "\nThe same by hand (while a service is up: `mouldloft demo --keep` or `mouldloft serve`):\n\
         \n  curl -s {base}{EXAMPLE} -o job.json\
         \n  curl -s '{base}/v1/jobs?wait=55' -H 'Content-Type: application/json' --data-binary @job.json\
         \n  curl -s {base}/v1/jobs/ID/result.svg -o trawler.svg    # also .dxf .obj .csv .json\
         \n\nReference: {base}/docs"
    )
}
