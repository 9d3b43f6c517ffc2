//! The commands of the programme. Each returns its exit code after it has said
//! in a sentence what went wrong.

mod client;
mod demo;
mod doctor;
mod figures;
mod files;
mod fit;
mod health;
mod out;
mod progress;

use crate::app::{AppError, Service, Signals};
use crate::settings::{Command, ServeSettings};
use std::process::ExitCode;
use std::time::Duration;

/// What the programme tells the shell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Exit {
    /// All is well.
    Done,
    /// Something around the fit is wrong: files, ports, the store.
    Trouble,
    /// The job is not valid.
    InvalidJob,
    /// The job is valid and could not be fitted.
    FitFailed,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(match exit {
            Exit::Done => 0,
            Exit::Trouble => 1,
            Exit::InvalidJob => 2,
            Exit::FitFailed => 3,
        })
    }
}

/// Runs a command to its end.
pub async fn run(command: Command) -> ExitCode {
    let exit = match command {
        Command::Serve(settings) => serve(&settings).await,
        Command::Fit(settings) => fit::run(&settings).await,
        Command::Demo(settings) => demo::run(&settings).await,
        Command::Doctor(settings) => doctor::run(&settings).await,
        Command::Health(settings) => health::run(&settings).await,
    };
    exit.into()
}

async fn serve(settings: &ServeSettings) -> Exit {
    match serve_until_signal(settings).await {
        Ok(()) => Exit::Done,
        Err(error) => {
            out::complain(&error.to_string());
            Exit::Trouble
        }
    }
}

async fn serve_until_signal(settings: &ServeSettings) -> Result<(), AppError> {
    // Before the line below promises a service that can be stopped in order.
    let mut signals = Signals::listen().map_err(AppError::Signals)?;
    let service = Service::start(settings).await?;
    out::line(&format!("listening on http://{}", service.address()));
    service
        .until_signal(&mut signals, Duration::from_secs(settings.front.drain_s))
        .await
}
