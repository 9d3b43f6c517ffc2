//! The tables, and how a file of an earlier format becomes one of this.
//!
//! The format number is SQLite's `user_version`; migration `n` makes format
//! `n + 1` out of `n`. A migration that is out is never changed.

use rusqlite::Connection;

use crate::jobs::error::OpenError;

/// Format 1. `seq` is the order of acceptance, never handed out. Triggers keep
/// `backlog` true in the same transaction, so that a limit costs one row to
/// check however long the queue is. `transitions` and `ticks` make the
/// revision. Blobs have a table of their own so that reading a job reads none.
const FORMAT_1: &str = "
CREATE TABLE jobs (
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  tenant TEXT NOT NULL,
  method TEXT NOT NULL,
  label TEXT,
  status TEXT NOT NULL
    CHECK (status IN ('accepted','running','successful','failed','dismissed')),
  phase TEXT NOT NULL,
  progress REAL NOT NULL,
  message TEXT NOT NULL,
  created INTEGER NOT NULL,
  started INTEGER,
  finished INTEGER,
  updated INTEGER NOT NULL,
  attempt INTEGER NOT NULL DEFAULT 0,
  lost INTEGER NOT NULL DEFAULT 0,
  owner TEXT,
  lease_until INTEGER,
  cancel_requested INTEGER NOT NULL DEFAULT 0,
  budget_ms INTEGER NOT NULL,
  engine_version TEXT NOT NULL,
  input_sha256 TEXT NOT NULL,
  input_bytes INTEGER NOT NULL,
  result_bytes INTEGER,
  verdict TEXT,
  warnings TEXT NOT NULL,
  failure_code TEXT,
  failure_detail TEXT,
  failure_reference TEXT,
  failure_errors TEXT,
  solve_ms REAL,
  transitions INTEGER NOT NULL DEFAULT 1,
  ticks INTEGER NOT NULL DEFAULT 0,
  erased INTEGER NOT NULL DEFAULT 0,
  CHECK ((status = 'running') = (owner IS NOT NULL)),
  CHECK ((finished IS NOT NULL) = (status IN ('successful','failed','dismissed')))
);
CREATE INDEX jobs_waiting ON jobs (seq) WHERE status = 'accepted';
CREATE INDEX jobs_leased ON jobs (lease_until) WHERE status = 'running';
CREATE INDEX jobs_newest ON jobs (tenant, created DESC, id DESC);
CREATE INDEX jobs_kept ON jobs (finished) WHERE finished IS NOT NULL AND erased = 0;
CREATE INDEX jobs_ended ON jobs (finished) WHERE finished IS NOT NULL;

CREATE TABLE blobs (
  seq INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
  kind TEXT NOT NULL,
  raw_len INTEGER NOT NULL,
  data BLOB NOT NULL,
  PRIMARY KEY (seq, kind)
);

CREATE TABLE keys (
  tenant TEXT NOT NULL,
  key TEXT NOT NULL,
  body_sha256 TEXT NOT NULL,
  seq INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
  created INTEGER NOT NULL,
  PRIMARY KEY (tenant, key)
) WITHOUT ROWID;
CREATE INDEX keys_oldest ON keys (created);
CREATE INDEX keys_job ON keys (seq);

CREATE TABLE backlog (
  one INTEGER PRIMARY KEY CHECK (one = 1),
  queued INTEGER NOT NULL CHECK (queued >= 0),
  queued_bytes INTEGER NOT NULL CHECK (queued_bytes >= 0),
  running INTEGER NOT NULL CHECK (running >= 0),
  probes INTEGER NOT NULL DEFAULT 0
);
INSERT INTO backlog (one, queued, queued_bytes, running) VALUES (1, 0, 0, 0);

CREATE TRIGGER backlog_in AFTER INSERT ON jobs BEGIN
  UPDATE backlog SET
    queued = queued + (NEW.status = 'accepted'),
    queued_bytes = queued_bytes + (NEW.status = 'accepted') * NEW.input_bytes,
    running = running + (NEW.status = 'running');
END;
CREATE TRIGGER backlog_move AFTER UPDATE OF status ON jobs
WHEN OLD.status <> NEW.status BEGIN
  UPDATE backlog SET
    queued = queued + (NEW.status = 'accepted') - (OLD.status = 'accepted'),
    queued_bytes = queued_bytes
      + ((NEW.status = 'accepted') - (OLD.status = 'accepted')) * NEW.input_bytes,
    running = running + (NEW.status = 'running') - (OLD.status = 'running');
END;
CREATE TRIGGER backlog_out AFTER DELETE ON jobs BEGIN
  UPDATE backlog SET
    queued = queued - (OLD.status = 'accepted'),
    queued_bytes = queued_bytes - (OLD.status = 'accepted') * OLD.input_bytes,
    running = running - (OLD.status = 'running');
END;
";

/// In order; the format after all of them is their number.
const MIGRATIONS: [&str; 1] = [FORMAT_1];

/// Brings the file to the present format, each step in one transaction.
///
/// # Errors
/// `TooNew` for a file of a later release, `Store` if SQLite refuses.
pub(super) fn migrate(conn: &mut Connection) -> Result<(), OpenError> {
    let refused = |e: rusqlite::Error| OpenError::Store(e.to_string());
    let known = MIGRATIONS.len();
    let found: i64 = conn
        .query_row("PRAGMA user_version", [], |row| row.get(0))
        .map_err(refused)?;
    let done = usize::try_from(found)
        .ok()
        .filter(|&n| n <= known)
        .ok_or(OpenError::TooNew {
            found,
            known: i64::try_from(known).unwrap_or(i64::MAX),
        })?;
    for (n, sql) in MIGRATIONS.iter().enumerate().skip(done) {
        let tx = conn.transaction().map_err(refused)?;
        tx.execute_batch(sql).map_err(refused)?;
        tx.execute_batch(&format!("PRAGMA user_version = {}", n + 1))
            .map_err(refused)?;
        tx.commit().map_err(refused)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn migrating_twice_changes_nothing() {
        let mut conn = Connection::open_in_memory().unwrap();
        migrate(&mut conn).unwrap();
        migrate(&mut conn).unwrap();
        let version: i64 = conn
            .query_row("PRAGMA user_version", [], |row| row.get(0))
            .unwrap();
        assert_eq!(version, 1);
    }

    #[test]
    fn a_later_format_is_refused() {
        let mut conn = Connection::open_in_memory().unwrap();
        conn.execute_batch("PRAGMA user_version = 99").unwrap();
        let refusal = migrate(&mut conn).unwrap_err();
        assert!(matches!(
            refusal,
            OpenError::TooNew {
                found: 99,
                known: 1
            }
        ));
    }
}
