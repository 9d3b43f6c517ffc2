//! The `mouldloft` programme: command line in, exit code out.

use clap::Parser as _;
use mouldloft::settings::{Command, Settings};
use mouldloft::{cli, telemetry};
use std::process::ExitCode;
use std::time::Duration;
use tracing::Level;

/// Many small allocations a request: a faster allocator is felt.
#[cfg(feature = "mimalloc")]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// How long threads may take to see that it is over; a fit that hangs must not
/// hold the process.
const LAST_WAIT: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let settings = Settings::parse();
    let level = match settings.command {
        Command::Serve(_) => Level::INFO,
        _ => Level::WARN,
    };
    telemetry::start(&settings.log, level);
    let runtime = match tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
    {
        Ok(runtime) => runtime,
        Err(error) => {
            tracing::error!(%error, "the runtime cannot be started");
            return ExitCode::FAILURE;
        }
    };
    let code = runtime.block_on(cli::run(settings.command));
    runtime.shutdown_timeout(LAST_WAIT);
    code
}
