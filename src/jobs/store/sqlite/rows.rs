//! Rows to jobs, and the few numbers that are computed on the way.

use std::collections::HashMap;

use rusqlite::types::Type;
use rusqlite::{Connection, OptionalExtension, Params, Row};
use uuid::Uuid;

use crate::jobs::model::{Failure, Job, JobId, Status, Tenant, Timestamp, Verdict};
use crate::jobs::store::StoreError;
use crate::jobs::store::shared::revision;

/// What [`Record::read`] expects, in this order.
pub(super) const COLUMNS: &str = "seq, id, tenant, method, label, status, phase, progress, \
     message, created, started, finished, updated, attempt, engine_version, input_sha256, \
     verdict, warnings, failure_code, failure_detail, failure_reference, failure_errors, \
     solve_ms, cancel_requested, input_bytes, result_bytes, transitions, ticks, erased, \
     budget_ms, lost";

/// A row of the table `jobs`.
#[derive(Debug, Clone)]
pub(super) struct Record {
    /// Order of acceptance; stays inside.
    pub seq: i64,
    /// The job, without its place in the queue.
    pub job: Job,
    /// Changes of state so far.
    transitions: u64,
    /// Its blobs are erased.
    pub erased: bool,
    /// Time for the engine, in ms.
    pub budget_ms: u64,
    /// Leases lost so far.
    pub lost: u32,
}

impl Record {
    /// Reads a row of [`COLUMNS`].
    ///
    /// # Errors
    /// A column is not what it should be.
    pub fn read(row: &Row<'_>) -> rusqlite::Result<Record> {
        let transitions = count(row, "transitions")?;
        let job = Job {
            id: parsed(row, "id", |t| t.parse().ok())?,
            tenant: Tenant::new(row.get::<_, String>("tenant")?),
            method: row.get("method")?,
            label: row.get("label")?,
            status: parsed(row, "status", Status::parse)?,
            phase: row.get("phase")?,
            progress: row.get("progress")?,
            message: row.get("message")?,
            created: Timestamp::from_millis(row.get("created")?),
            started: moment(row, "started")?,
            finished: moment(row, "finished")?,
            updated: Timestamp::from_millis(row.get("updated")?),
            attempt: row.get("attempt")?,
            queue_position: None,
            eta_s: None,
            engine_version: row.get("engine_version")?,
            input_sha256: row.get("input_sha256")?,
            verdict: optional(row, "verdict", Verdict::parse)?,
            warnings: parsed(row, "warnings", |t| serde_json::from_str(t).ok())?,
            failure: failure(row)?,
            solve_ms: row.get("solve_ms")?,
            revision: revision(transitions, count(row, "ticks")?, None),
            cancel_requested: row.get("cancel_requested")?,
            input_bytes: count(row, "input_bytes")?,
            result_bytes: row
                .get::<_, Option<i64>>("result_bytes")?
                .map(i64::cast_unsigned),
        };
        Ok(Record {
            seq: row.get("seq")?,
            job,
            transitions,
            erased: row.get("erased")?,
            budget_ms: count(row, "budget_ms")?,
            lost: row.get("lost")?,
        })
    }

    /// The job with its place in the queue, 1 being next.
    fn placed(mut self, position: Option<u64>) -> Job {
        if let Some(position) = position {
            self.job.revision = revision(self.transitions, 0, Some(position));
            self.job.queue_position = Some(position);
        }
        self.job
    }
}

/// The first row of a query whose columns are [`COLUMNS`].
///
/// # Errors
/// SQLite's, and `Corrupt`.
pub(super) fn one(
    conn: &Connection,
    sql: &str,
    params: impl Params,
) -> Result<Option<Record>, StoreError> {
    let found = conn
        .prepare_cached(sql)?
        .query_row(params, Record::read)
        .optional()?;
    Ok(found)
}

/// All rows of a query whose columns are [`COLUMNS`].
///
/// # Errors
/// SQLite's, and `Corrupt`.
pub(super) fn many(
    conn: &Connection,
    sql: &str,
    params: impl Params,
) -> Result<Vec<Record>, StoreError> {
    let mut statement = conn.prepare_cached(sql)?;
    let rows = statement.query_map(params, Record::read)?;
    Ok(rows.collect::<rusqlite::Result<_>>()?)
}

/// A job with its blobs' keys: by tenant and id.
///
/// # Errors
/// SQLite's, and `Corrupt`.
pub(super) fn find(
    conn: &Connection,
    tenant: &Tenant,
    id: JobId,
) -> Result<Option<Record>, StoreError> {
    let sql = format!("SELECT {COLUMNS} FROM jobs WHERE id = ?1 AND tenant = ?2");
    one(conn, &sql, (id.to_string(), tenant.as_str()))
}

/// One record as its owner may see it.
///
/// # Errors
/// SQLite's.
pub(super) fn seen(conn: &Connection, record: Record) -> Result<Job, StoreError> {
    let mut jobs = all_seen(conn, vec![record])?;
    jobs.pop()
        .ok_or_else(|| StoreError::Defect("one record gave no job".to_owned()))
}

/// Records as their owner may see them, in the same order. The places of the
/// waiting ones cost one walk along the queue, however many they are.
///
/// # Errors
/// SQLite's.
pub(super) fn all_seen(conn: &Connection, records: Vec<Record>) -> Result<Vec<Job>, StoreError> {
    let mut waiting: Vec<i64> = records
        .iter()
        .filter(|r| r.job.status == Status::Accepted)
        .map(|r| r.seq)
        .collect();
    waiting.sort_unstable();
    let mut places = HashMap::with_capacity(waiting.len());
    let (mut before, mut place) = (0, 0_u64);
    for seq in waiting {
        let between: i64 = conn
            .prepare_cached(
                "SELECT count(*) FROM jobs WHERE status = 'accepted' AND seq > ?1 AND seq <= ?2",
            )?
            .query_row((before, seq), |row| row.get(0))?;
        place += between.cast_unsigned();
        before = seq;
        places.insert(seq, place);
    }
    Ok(records
        .into_iter()
        .map(|record| {
            let place = places.get(&record.seq).copied();
            record.placed(place)
        })
        .collect())
}

/// A count that SQLite keeps as a signed number.
///
/// # Errors
/// It is no number, or negative.
pub(super) fn count(row: &Row<'_>, column: &str) -> rusqlite::Result<u64> {
    let value: i64 = row.get(column)?;
    u64::try_from(value).map_err(|e| unreadable(format!("{column}: {e}")))
}

fn moment(row: &Row<'_>, column: &str) -> rusqlite::Result<Option<Timestamp>> {
    Ok(row
        .get::<_, Option<i64>>(column)?
        .map(Timestamp::from_millis))
}

fn failure(row: &Row<'_>) -> rusqlite::Result<Option<Failure>> {
    let Some(code) = row.get("failure_code")? else {
        return Ok(None);
    };
    Ok(Some(Failure {
        code,
        detail: row
            .get::<_, Option<String>>("failure_detail")?
            .unwrap_or_default(),
        reference: optional(row, "failure_reference", |t| Uuid::try_parse(t).ok())?,
        errors_json: row.get("failure_errors")?,
    }))
}

fn parsed<T>(
    row: &Row<'_>,
    column: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> rusqlite::Result<T> {
    let text: String = row.get(column)?;
    parse(&text).ok_or_else(|| unreadable(format!("{column} is {text:?}")))
}

fn optional<T>(
    row: &Row<'_>,
    column: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> rusqlite::Result<Option<T>> {
    match row.get::<_, Option<String>>(column)? {
        None => Ok(None),
        Some(_) => parsed(row, column, parse).map(Some),
    }
}

fn unreadable(why: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> rusqlite::Error {
    rusqlite::Error::FromSqlConversionFailure(0, Type::Text, why.into())
}
