//! `mouldloft fit`: one job without a server, refused and fitted by the same
//! code that serves.

use super::{Exit, figures, files, out, progress::Watch};
use crate::app::Signals;
use crate::http::dto::result::Sentences;
use crate::http::engine::Engine;
use crate::http::intake;
use crate::http::methods::{self, Format};
use crate::http::problem::{ApiError, FieldError};
use crate::jobs::clock::SystemClock;
use crate::jobs::{Engine as _, EngineError, Product};
use crate::methods::Stop;
use crate::settings::{FileFormat, FitSettings};
use std::sync::Arc;

/// Fits and writes.
pub async fn run(settings: &FitSettings) -> Exit {
    let job = match files::read(&settings.job) {
        Ok(job) => job,
        Err(error) => return trouble(&error.to_string()),
    };
    let read = match intake::read_job(&job) {
        Ok(read) => read,
        Err(error) => return refuse(&error),
    };
    let time = read.header().budget.time();
    let watch = Arc::new(Watch::new(SystemClock::new(), time));
    let outcome = fit(job, read.method(), settings.workers, Arc::clone(&watch)).await;
    watch.clear();
    match outcome {
        Ok(product) => deliver(&product, settings),
        Err(Trouble::Engine(error)) => fail(error),
        Err(Trouble::Around(why)) => trouble(&why),
    }
}

/// Why there is no product.
enum Trouble {
    /// The engine says so.
    Engine(EngineError),
    /// It did not come to the engine, or not back from it.
    Around(String),
}

/// Runs the engine on threads of its own; Ctrl-C asks it to stop.
async fn fit(
    job: Vec<u8>,
    method: &'static str,
    workers: Option<usize>,
    watch: Arc<Watch<SystemClock>>,
) -> Result<Product, Trouble> {
    let around = |why: &dyn std::fmt::Display| Trouble::Around(why.to_string());
    let threads = workers.unwrap_or(0); // rayon reads 0 as all cores
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| around(&e))?;
    let mut signals = Signals::listen().map_err(|e| around(&e))?;
    let control = Arc::clone(&watch);
    let mut running =
        tokio::task::spawn_blocking(move || pool.install(|| Engine.run(method, &job, &*control)));
    let ended = tokio::select! {
        ended = &mut running => ended,
        _ = signals.next() => {
            watch.cancel();
            running.await
        }
    };
    ended.map_err(|e| around(&e))?.map_err(Trouble::Engine)
}

/// Writes the files and prints what they say.
fn deliver(product: &Product, settings: &FitSettings) -> Exit {
    let document: Sentences = match serde_json::from_slice(&product.result) {
        Ok(document) => document,
        Err(error) => return trouble(&format!("the result cannot be read back: {error}")),
    };
    let Some(method) = methods::named(&document.method) else {
        return trouble(&format!("no method {} wrote this result", document.method));
    };
    let mut written = vec![files::write(&settings.out, "result.json", &product.result)];
    let formats = settings.format.iter().map(|f| format_of(*f));
    for format in formats.filter(|f| method.formats().contains(f)) {
        let name = format!("result.{}", format.extension());
        match method.write(format.into(), &product.result) {
            Ok(bytes) => written.push(files::write(&settings.out, &name, &bytes)),
            Err(error) => out::complain(&format!("{name}: {}", error.detail)),
        }
    }
    for sentence in document.warnings.iter().chain(&document.summary) {
        out::line(sentence);
    }
    if document.method == "hull_plates" {
        let value = serde_json::from_slice(&product.result).unwrap_or_default();
        out::line(&figures::table(&value));
    }
    for path in written {
        match path {
            Ok(path) => out::line(&path.display().to_string()),
            Err(error) => return trouble(&error.to_string()),
        }
    }
    Exit::Done
}

fn format_of(format: FileFormat) -> Format {
    match format {
        FileFormat::Obj => Format::Obj,
        FileFormat::Stl => Format::Stl,
        FileFormat::Ply => Format::Ply,
        FileFormat::Glb => Format::Glb,
        FileFormat::Csv => Format::Csv,
        FileFormat::Svg => Format::Svg,
        FileFormat::Step => Format::Step,
        FileFormat::Igs => Format::Igs,
        FileFormat::Dxf => Format::Dxf,
    }
}

fn trouble(why: &str) -> Exit {
    out::complain(why);
    Exit::Trouble
}

/// Prints a refusal with every place that is wrong.
fn refuse(error: &ApiError) -> Exit {
    out::complain(&format!("The job is not valid: {}", error.detail));
    for fault in &error.errors {
        complain_about(fault);
    }
    Exit::InvalidJob
}

fn complain_about(fault: &FieldError) {
    let place = if fault.pointer.is_empty() {
        "the job"
    } else {
        &fault.pointer
    };
    let hint = fault
        .hint
        .as_ref()
        .map_or(String::new(), |h| format!(" ({h})"));
    out::complain(&format!("  {place}: {}{hint}", fault.message));
}

fn fail(error: EngineError) -> Exit {
    match error {
        EngineError::Invalid {
            detail,
            errors_json,
        } => {
            out::complain(&format!("The job is not valid: {detail}"));
            let faults: Vec<FieldError> = serde_json::from_str(&errors_json).unwrap_or_default();
            faults.iter().for_each(complain_about);
            Exit::InvalidJob
        }
        EngineError::Stopped(Stop::Cancelled) => {
            out::complain("The fit was cancelled.");
            Exit::FitFailed
        }
        EngineError::Stopped(Stop::OutOfTime) => {
            out::complain("The fit used up its budget; raise budget.time_s in the job.");
            Exit::FitFailed
        }
        EngineError::Failed { code, detail, .. } => {
            out::complain(&format!("The fit failed ({code}): {detail}"));
            Exit::FitFailed
        }
    }
}
