//! The command line's own reading and writing: the job in, the files out.

use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The path that stands for standard input.
const STANDARD_INPUT: &str = "-";

/// A file that cannot be read or written.
#[derive(Debug, Error)]
#[error("{} cannot be {what}: {source}", .path.display())]
pub struct FileError {
    /// Which.
    path: PathBuf,
    /// `read` or `written`.
    what: &'static str,
    /// What the system says.
    source: io::Error,
}

/// The whole file, or standard input for `-`.
///
/// # Errors
/// When it cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    let bytes = if path == Path::new(STANDARD_INPUT) {
        let mut bytes = Vec::new();
        io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    bytes.map_err(|source| FileError {
        path: path.to_owned(),
        what: "read",
        source,
    })
}

/// Writes a file into a folder, which is made if it is not there, and returns
/// its path. A reader sees the old file or the new one, never half of it.
///
/// # Errors
/// When it cannot be written.
pub fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, FileError> {
    let path = folder.join(name);
    let partial = folder.join(format!(".{name}.{}.partial", std::process::id()));
    let written = std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&partial, bytes))
        .and_then(|()| std::fs::rename(&partial, &path));
    match written {
        Ok(()) => Ok(path),
        Err(source) => Err(FileError {
            path,
            what: "written",
            source,
        }),
    }
}

/// How often a second a small append to a file in `folder` reaches the disk:
/// what bounds the rate at which jobs are accepted one by one. `now` is a
/// clock that never falls.
///
/// # Errors
/// When the file cannot be written.
pub fn syncs_per_second(
    folder: &Path,
    now: impl Fn() -> std::time::Duration,
) -> Result<f64, FileError> {
    /// Long enough to average, short enough to wait for.
    const PROBES: u32 = 50;
    /// About what a job's row takes.
    const BYTES: [u8; 4096] = [0; 4096];
    let path = folder.join(format!(".sync-probe.{}", std::process::id()));
    let probe = || -> io::Result<f64> {
        std::fs::create_dir_all(folder)?;
        let mut file = std::fs::File::create(&path)?;
        let start = now();
        for _ in 0..PROBES {
            file.write_all(&BYTES)?;
            file.sync_data()?;
        }
        let seconds = (now() - start).as_secs_f64();
        Ok(f64::from(PROBES) / seconds.max(f64::MIN_POSITIVE))
    };
    let rate = probe();
    // Whether or not it went well, nothing is left behind.
    let _ = std::fs::remove_file(&path);
    rate.map_err(|source| FileError {
        path,
        what: "written",
        source,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let below = folder.path().join("a/b");
        let path = write(&below, "x.json", b"{}").unwrap();
        assert_eq!(read(&path).unwrap(), b"{}");
        write(&below, "x.json", b"[]").unwrap();
        assert_eq!(read(&path).unwrap(), b"[]");
        assert_eq!(std::fs::read_dir(&below).unwrap().count(), 1);
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let error = read(Path::new("/nowhere/job.json")).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("/nowhere/job.json cannot be read")
        );
    }

    #[test]
    fn the_probe_counts_and_cleans_up() {
        let folder = tempfile::tempdir().unwrap();
        let calls = std::cell::Cell::new(0);
        let clock = || {
            calls.set(calls.get() + 1);
            std::time::Duration::from_secs(calls.get())
        };
        assert_eq!(syncs_per_second(folder.path(), clock).unwrap(), 50.0);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
