//! Logging: events go to standard error, so that standard output stays for
//! what a programme reads (`listening on …`, tables, file names).

use crate::settings::{LogFormat, LogSettings};
use std::io::IsTerminal as _;
use tracing::Level;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Starts logging, at `default` unless the settings say otherwise. A second
/// call changes nothing.
pub fn start(settings: &LogSettings, default: Level) {
    let filter = settings.log.clone().unwrap_or_else(|| ours(default));
    let lines = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let layer = match settings.log_format {
        LogFormat::Text => lines.with_ansi(std::io::stderr().is_terminal()).boxed(),
        LogFormat::Json => lines.json().boxed(),
    };
    // It fails only where a subscriber is there already, as in a test.
    let _ = tracing_subscriber::registry()
        .with(layer.with_filter(filter))
        .try_init();
}

/// This crate at `level`; of the libraries beneath warnings alone.
fn ours(level: Level) -> Targets {
    Targets::new()
        .with_default(level.min(Level::WARN))
        .with_target("mouldloft", level)
}
