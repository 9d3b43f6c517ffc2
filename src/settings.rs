//! Everything that can be set, as flags and `MOULDLOFT_*` variables: flags win
//! over the environment, the environment over the defaults shown by `--help`.
//!
//! Only the programme's own part (`main`, `app`, `cli`) reads this; every
//! layer below is handed what it needs.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::PathBuf;
use std::time::Duration;
use tracing_subscriber::filter::Targets;

const MEGABYTE: u64 = 1_000_000;

/// The command line.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "mouldloft",
    version,
    about = "The mould loft as a service: developable hull plates between profile curves",
    flatten_help = true,
    subcommand_required = true,
    arg_required_else_help = true
)]
pub struct Settings {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How to log.
    #[command(flatten)]
    pub log: LogSettings,
}

/// What the programme can do.
#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// Run the service: API and workers in one process.
    Serve(ServeSettings),
    /// Fit one job without a server and write its files.
    Fit(FitSettings),
    /// Start a service, post a trawler to it, show and save what comes back.
    Demo(DemoSettings),
    /// Check the store, the disk and a worker; say what is wrong.
    Doctor(StoreSettings),
    /// Ask a running service whether it is ready; 0 when it is.
    Health(HealthSettings),
}

/// How to log; to standard error, always.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Logging")]
pub struct LogSettings {
    /// What to log: a level (`error`, `warn`, `info`, `debug`, `trace`) or
    /// `target=level` pairs; without it `info` for `serve`, `warn` otherwise.
    #[arg(long, env = "MOULDLOFT_LOG", value_name = "LEVEL", global = true)]
    pub log: Option<Targets>,
    /// One line of text or one JSON object an event.
    #[arg(
        long,
        env = "MOULDLOFT_LOG_FORMAT",
        default_value = "text",
        global = true
    )]
    pub log_format: LogFormat,
}

/// The shape of log lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// For people.
    Text,
    /// For machines.
    Json,
}

/// Where jobs are kept and who fits them.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Store and workers")]
pub struct StoreSettings {
    /// The folder of the job store; made if it is not there.
    #[arg(
        long,
        env = "MOULDLOFT_DATA",
        value_name = "FOLDER",
        default_value = "./mouldloft-data"
    )]
    pub data: PathBuf,
    /// Keep nothing: jobs and results end with the process.
    #[arg(long, env = "MOULDLOFT_EPHEMERAL")]
    pub ephemeral: bool,
    /// Threads for fits; 0 accepts and answers but fits nothing. Without it all
    /// cores but one.
    #[arg(long, env = "MOULDLOFT_WORKERS", value_name = "N")]
    pub workers: Option<usize>,
    /// Turn jobs away when this many wait.
    #[arg(
        long,
        env = "MOULDLOFT_MAX_QUEUED",
        value_name = "JOBS",
        default_value_t = 10_000
    )]
    pub max_queued: u64,
    /// Turn jobs away when this much input waits, in MB.
    #[arg(
        long,
        env = "MOULDLOFT_MAX_QUEUED_MB",
        value_name = "MB",
        default_value_t = 2_000
    )]
    pub max_queued_mb: u64,
    /// Accept nothing when the disk has less free space, in MB.
    #[arg(
        long,
        env = "MOULDLOFT_MIN_FREE_MB",
        value_name = "MB",
        default_value_t = 100
    )]
    pub min_free_mb: u64,
    /// Keep inputs and results this long after a job's end, in days.
    #[arg(
        long,
        env = "MOULDLOFT_KEEP_RESULTS_DAYS",
        value_name = "DAYS",
        default_value_t = 30
    )]
    pub keep_results_days: u32,
    /// Keep the records of jobs this long after their end, in days.
    #[arg(
        long,
        env = "MOULDLOFT_KEEP_RECORDS_DAYS",
        value_name = "DAYS",
        default_value_t = 90
    )]
    pub keep_records_days: u32,
}

impl StoreSettings {
    /// A store that keeps nothing, everything else by default.
    pub fn ephemeral() -> StoreSettings {
        StoreSettings {
            data: PathBuf::new(),
            ephemeral: true,
            workers: None,
            max_queued: 10_000,
            max_queued_mb: 2_000,
            min_free_mb: 100,
            keep_results_days: 30,
            keep_records_days: 90,
        }
    }

    /// Most input that may wait, bytes.
    pub fn max_queued_bytes(&self) -> u64 {
        self.max_queued_mb.saturating_mul(MEGABYTE)
    }

    /// Least free space to accept jobs, bytes.
    pub fn min_free_bytes(&self) -> u64 {
        self.min_free_mb.saturating_mul(MEGABYTE)
    }
}

/// A whole number of days.
pub fn days(count: u32) -> Duration {
    Duration::from_secs(u64::from(count) * 24 * 3600)
}

/// The service.
#[derive(Debug, Clone, Args)]
pub struct ServeSettings {
    /// Where jobs are kept and who fits them.
    #[command(flatten)]
    pub store: StoreSettings,
    /// Where to listen and how much to take.
    #[command(flatten)]
    pub front: FrontSettings,
}

/// Where the service listens and how much it takes at once.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Front door")]
pub struct FrontSettings {
    /// Address and port; port 0 takes a free one.
    #[arg(
        long,
        env = "MOULDLOFT_LISTEN",
        value_name = "ADDR:PORT",
        default_value = "127.0.0.1:8080",
        value_parser = listen_address
    )]
    pub listen: SocketAddr,
    /// Listen on an address that other machines reach, though there are no API
    /// keys yet: everyone who gets there may submit, read and erase jobs.
    #[arg(long, env = "MOULDLOFT_ALLOW_UNAUTHENTICATED")]
    pub allow_unauthenticated: bool,
    /// Open connections; more wait until one closes.
    #[arg(
        long,
        env = "MOULDLOFT_MAX_CONNECTIONS",
        value_name = "N",
        default_value_t = 1_024
    )]
    pub max_connections: usize,
    /// A request's head must arrive within this many seconds.
    #[arg(
        long,
        env = "MOULDLOFT_HEADER_TIMEOUT_S",
        value_name = "S",
        default_value_t = 10
    )]
    pub header_timeout_s: u64,
    /// Going down, running fits get this many seconds to end.
    #[arg(
        long,
        env = "MOULDLOFT_DRAIN_S",
        value_name = "S",
        default_value_t = 25
    )]
    pub drain_s: u64,
}

impl FrontSettings {
    /// A free port of this machine alone, everything else by default.
    pub fn loopback() -> FrontSettings {
        FrontSettings {
            listen: SocketAddr::from(([127, 0, 0, 1], 0)),
            allow_unauthenticated: false,
            max_connections: 1_024,
            header_timeout_s: 10,
            drain_s: 25,
        }
    }
}

/// Reads `127.0.0.1:8080`, `[::1]:8080` or `localhost:8080`.
fn listen_address(text: &str) -> Result<SocketAddr, String> {
    let mut found = text
        .to_socket_addrs()
        .map_err(|e| format!("{e}; expected ADDR:PORT"))?;
    found
        .next()
        .ok_or_else(|| "the name has no address".to_owned())
}

/// One job without a server.
#[derive(Debug, Clone, Args)]
pub struct FitSettings {
    /// The job, as it would be posted to `/v1/jobs`; `-` reads standard input.
    #[arg(value_name = "JOB.json")]
    pub job: PathBuf,
    /// The folder for `result.json` and the files; made if it is not there.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub out: PathBuf,
    /// Files to write beside `result.json`.
    #[arg(
        long,
        value_name = "FORMATS",
        value_delimiter = ',',
        default_value = "obj,csv,svg"
    )]
    pub format: Vec<FileFormat>,
    /// Threads for the fit; without it all cores.
    #[arg(long, env = "MOULDLOFT_WORKERS", value_name = "N")]
    pub workers: Option<usize>,
}

/// A file that a result can be written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FileFormat {
    /// Triangles, watertight along shared borders.
    Obj,
    /// Triangles alone.
    Stl,
    /// Triangles with colours and values.
    Ply,
    /// A scene with named parts, colours, values and lines.
    Glb,
    /// The table of rulings.
    Csv,
    /// The lines plan.
    Svg,
    /// Surfaces and curves for CAD.
    Step,
    /// Surfaces and curves for older CAD.
    Igs,
    /// Flat patterns for the cutting table.
    Dxf,
}

/// Which service to ask.
#[derive(Debug, Clone, Args)]
pub struct HealthSettings {
    /// Where the service listens.
    #[arg(
        long,
        env = "MOULDLOFT_LISTEN",
        value_name = "ADDR:PORT",
        default_value = "127.0.0.1:8080",
        value_parser = listen_address
    )]
    pub listen: SocketAddr,
}

/// The demonstration.
#[derive(Debug, Clone, Args)]
pub struct DemoSettings {
    /// Leave the service up until it is interrupted.
    #[arg(long)]
    pub keep: bool,
    /// The folder for the files; made if it is not there.
    #[arg(long, value_name = "FOLDER", default_value = "./demo-out")]
    pub out: PathBuf,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(args: &[&str]) -> Result<Settings, clap::Error> {
        Settings::try_parse_from([&["mouldloft"], args].concat())
    }

    #[test]
    fn the_command_line_is_sound() {
        Settings::command().debug_assert();
    }

    #[test]
    fn every_variable_is_listed_by_help() {
        let help = Settings::command().render_long_help().to_string();
        let commands = Settings::command();
        let all = commands
            .get_subcommands()
            .flat_map(clap::Command::get_arguments);
        for argument in all.filter_map(clap::Arg::get_env) {
            let name = argument.to_string_lossy();
            assert!(
                name.starts_with("MOULDLOFT_") && help.contains(&*name),
                "{name} is not listed"
            );
        }
    }

    #[test]
    fn defaults_in_code_are_those_of_the_flags() {
        let Ok(Command::Serve(serve)) = parse(&["serve", "--ephemeral"]).map(|s| s.command) else {
            panic!("serve was not understood");
        };
        let mut store = StoreSettings::ephemeral();
        store.data = serve.store.data.clone();
        assert_eq!(format!("{:?}", serve.store), format!("{store:?}"));
        let mut front = FrontSettings::loopback();
        front.listen = serve.front.listen;
        assert_eq!(format!("{:?}", serve.front), format!("{front:?}"));
    }

    #[test]
    fn names_and_free_ports_are_addresses() {
        assert!(listen_address("localhost:0").is_ok_and(|a| a.ip().is_loopback()));
        assert!(listen_address("8080").is_err());
    }

    #[test]
    fn formats_are_a_list() {
        let Ok(Command::Fit(fit)) =
            parse(&["fit", "a.json", "--format", "svg,obj"]).map(|s| s.command)
        else {
            panic!("fit was not understood");
        };
        assert_eq!(fit.format, [FileFormat::Svg, FileFormat::Obj]);
        assert!(parse(&["fit", "a.json", "--format", "dwg"]).is_err());
    }
}
