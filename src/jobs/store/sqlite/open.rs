//! Opening: the folder and its lock, the version of the library, the
//! connection's settings.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::{Connection, OpenFlags};

use super::schema::migrate;
use crate::jobs::error::OpenError;

/// Name of the database in the data folder.
const FILE: &str = "jobs.sqlite3";

/// Name of the file whose lock says that the folder is taken.
const LOCK: &str = "lock";

/// The oldest good SQLite: before 3.51.3 a race at the reset of the
/// write-ahead log can lose committed writes.
const OLDEST_GOOD: i32 = 3_051_003;

/// [`OLDEST_GOOD`] for people.
const OLDEST_GOOD_NAME: &str = "3.51.3";

/// How long the writer waits for somebody else's lock (a backup, a shell)
/// before the calls in hand are answered "try again": well below a client's
/// patience, well above a backup's step.
const WRITER_PATIENCE: Duration = Duration::from_secs(2);

/// The same for readers, who wait for nothing but a recovery of the log.
const READER_PATIENCE: Duration = Duration::from_secs(2);

/// Prepared statements kept by each connection; the store has about 40.
const STATEMENTS: usize = 64;

/// The open folder: where, and the lock that says it is ours.
#[derive(Debug)]
pub(super) struct Folder {
    /// The folder.
    pub path: PathBuf,
    /// Held as long as this lives.
    _lock: File,
}

impl Folder {
    /// Makes the folder if need be, and takes it.
    ///
    /// # Errors
    /// `InUse`, `Folder`.
    pub fn take(path: &Path) -> Result<Self, OpenError> {
        let failed = |source| OpenError::Folder {
            path: path.to_owned(),
            source,
        };
        fs::create_dir_all(path).map_err(failed)?;
        let lock = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(path.join(LOCK))
            .map_err(failed)?;
        match lock.try_lock() {
            Ok(()) => Ok(Folder {
                path: path.to_owned(),
                _lock: lock,
            }),
            Err(TryLockError::WouldBlock) => Err(OpenError::InUse(path.to_owned())),
            Err(TryLockError::Error(source)) => Err(failed(source)),
        }
    }

    /// The database file.
    pub fn file(&self) -> PathBuf {
        self.path.join(FILE)
    }
}

/// Refuses an SQLite that loses writes.
///
/// # Errors
/// `BadSqlite` if `number` (as of `sqlite3_libversion_number`) is too old.
pub(super) fn check_version(number: i32) -> Result<(), OpenError> {
    if number >= OLDEST_GOOD {
        return Ok(());
    }
    Err(OpenError::BadSqlite {
        found: format!(
            "{}.{}.{}",
            number / 1_000_000,
            number / 1000 % 1000,
            number % 1000
        ),
        needed: OLDEST_GOOD_NAME,
    })
}

/// The writer's connection, file made and migrated.
///
/// # Errors
/// `Store`, `TooNew`.
pub(super) fn writer(file: &Path) -> Result<Connection, OpenError> {
    let mut conn = Connection::open(file).map_err(refused)?;
    set_up_writer(&conn).map_err(refused)?;
    migrate(&mut conn)?;
    Ok(conn)
}

/// `auto_vacuum` only works before the first table; it lets the sweep give
/// space back. `secure_delete` makes erasing a hull erase it from the file.
fn set_up_writer(conn: &Connection) -> rusqlite::Result<()> {
    conn.busy_timeout(WRITER_PATIENCE)?;
    conn.set_prepared_statement_cache_capacity(STATEMENTS);
    conn.execute_batch(
        "PRAGMA auto_vacuum = INCREMENTAL;
         PRAGMA journal_mode = WAL;
         PRAGMA synchronous = FULL;
         PRAGMA foreign_keys = ON;
         PRAGMA secure_delete = FAST;
         PRAGMA journal_size_limit = 67108864;",
    )?;
    let mode: String = conn.query_row("PRAGMA journal_mode", [], |row| row.get(0))?;
    if mode.eq_ignore_ascii_case("wal") {
        Ok(())
    } else {
        // A file system without shared memory: a network share, most often.
        Err(rusqlite::Error::SqliteFailure(
            rusqlite::ffi::Error::new(rusqlite::ffi::SQLITE_CANTOPEN),
            Some(format!(
                "the write-ahead log cannot be used here (journal mode {mode}); use a local disk"
            )),
        ))
    }
}

/// A connection that only reads.
///
/// # Errors
/// `Store`.
pub(super) fn reader(file: &Path) -> Result<Connection, OpenError> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let conn = Connection::open_with_flags(file, flags).map_err(refused)?;
    conn.busy_timeout(READER_PATIENCE).map_err(refused)?;
    conn.set_prepared_statement_cache_capacity(STATEMENTS);
    conn.execute_batch("PRAGMA query_only = ON")
        .map_err(refused)?;
    Ok(conn)
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn refused(e: rusqlite::Error) -> OpenError {
    OpenError::Store(e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_sqlite_that_loses_writes_is_refused() {
        assert!(check_version(3_051_003).is_ok());
        assert!(check_version(3_054_001).is_ok());
        let refusal = check_version(3_051_002).unwrap_err().to_string();
        assert!(
            refusal.contains("3.51.2") && refusal.contains("3.51.3"),
            "{refusal}"
        );
    }

    #[test]
    fn the_library_linked_in_is_good() {
        check_version(rusqlite::version_number()).unwrap();
    }

    #[test]
    fn a_folder_has_one_owner() {
        let dir = tempfile::tempdir().unwrap();
        let first = Folder::take(dir.path()).unwrap();
        let second = Folder::take(dir.path()).unwrap_err();
        assert!(matches!(second, OpenError::InUse(_)));
        drop(first);
        Folder::take(dir.path()).unwrap();
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_told() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("plain");
        fs::write(&file, "").unwrap();
        let refusal = Folder::take(&file.join("below")).unwrap_err();
        assert!(matches!(refusal, OpenError::Folder { .. }));
    }
}
