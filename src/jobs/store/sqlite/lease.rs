//! A worker's side: taking up, beating, ending, giving back, losing.
//!
//! Every statement here that follows a claim carries the whole fence (`id`,
//! `attempt`, `owner`, `status = 'running'`), so a worker that lost its lease
//! changes no row whatever it does.

use rusqlite::{Connection, params};

use super::accept::{json, put_blob};
use super::rows::{self, COLUMNS, Record};
use crate::jobs::model::{Failure, Job, Status, Timestamp, Verdict};
use crate::jobs::store::pack::Packed;
use crate::jobs::store::shared::{crashed, words};
use crate::jobs::store::{Beat, BlobKind, End, Fence, Outcome, Owner, Pulse, StoreError};

/// The fence of a holding, for `?1`, `?2`, `?3` = id, attempt, owner.
const FENCED: &str = "id = ?1 AND attempt = ?2 AND owner = ?3 AND status = 'running'";

/// Takes up the longest waiting job, if there is one.
///
/// # Errors
/// SQLite's.
pub(super) fn claim(
    conn: &Connection,
    owner: &Owner,
    now: Timestamp,
    until: Timestamp,
) -> Result<Option<Record>, StoreError> {
    let sql = format!(
        "UPDATE jobs SET status = 'running', attempt = attempt + 1, owner = ?1,
           lease_until = ?2, started = ?3, updated = ?3, phase = ?4, message = ?5,
           transitions = transitions + 1, ticks = 0
         WHERE seq = (SELECT seq FROM jobs WHERE status = 'accepted' ORDER BY seq LIMIT 1)
         RETURNING {COLUMNS}"
    );
    rows::one(
        conn,
        &sql,
        params![
            owner.0,
            until.as_millis(),
            now.as_millis(),
            words::STARTING,
            words::FITTING
        ],
    )
}

/// Prolongs one lease and writes its progress.
///
/// # Errors
/// SQLite's.
pub(super) fn beat(
    conn: &Connection,
    beat: &Beat,
    now: Timestamp,
    until: Timestamp,
) -> Result<Pulse, StoreError> {
    let sql = format!(
        "UPDATE jobs SET lease_until = ?4, phase = ?5, progress = max(progress, ?6),
           updated = iif(ticks < ?7, ?8, updated), ticks = max(ticks, ?7)
         WHERE {FENCED} RETURNING {COLUMNS}"
    );
    let fence = &beat.fence;
    let held = rows::one(
        conn,
        &sql,
        params![
            fence.id.to_string(),
            fence.attempt,
            fence.owner.0,
            until.as_millis(),
            beat.phase,
            beat.progress,
            beat.ticks.cast_signed(),
            now.as_millis(),
        ],
    )?;
    Ok(match held {
        None => Pulse::Lost,
        Some(record) if record.job.cancel_requested => Pulse::CancelRequested,
        Some(_) => Pulse::Held,
    })
}

/// The end of a job made ready outside the writer: columns and blobs.
pub(super) struct Closing {
    /// Who ends it.
    pub fence: Fence,
    /// What goes into the columns; its blobs are empty here.
    pub end: End,
    /// The result, compressed.
    pub result: Option<Packed>,
    /// The diagnostics, compressed.
    pub diagnostics: Option<Packed>,
}

/// Ends a job; none if the fence does not hold.
///
/// # Errors
/// SQLite's.
pub(super) fn complete(
    conn: &Connection,
    closing: &Closing,
    now: Timestamp,
) -> Result<Option<Job>, StoreError> {
    let fence = &closing.fence;
    let held = rows::one(
        conn,
        &format!("SELECT {COLUMNS} FROM jobs WHERE {FENCED}"),
        (fence.id.to_string(), fence.attempt, &fence.owner.0),
    )?;
    let Some(held) = held else { return Ok(None) };
    let ended = Ended::of(&closing.end, &held);
    let record = write_end(conn, closing, &ended, now)?;
    for (kind, blob) in [
        (BlobKind::Result, &closing.result),
        (BlobKind::Diagnostics, &closing.diagnostics),
    ] {
        if let Some(blob) = blob {
            put_blob(conn, held.seq, kind, blob)?;
        }
    }
    record.map(|r| rows::seen(conn, r)).transpose()
}

/// The columns of an end.
struct Ended {
    status: Status,
    phase: String,
    progress: f64,
    message: String,
    verdict: Option<Verdict>,
    warnings: Vec<String>,
    failure: Option<Failure>,
}

impl Ended {
    fn of(end: &End, held: &Record) -> Ended {
        let mut ended = Ended {
            status: Status::Dismissed,
            phase: end.phase.clone(),
            progress: end.progress,
            message: words::CANCELLED.to_owned(),
            verdict: None,
            warnings: held.job.warnings.clone(),
            failure: None,
        };
        match &end.outcome {
            Outcome::Successful {
                verdict,
                warnings,
                message,
                ..
            } => {
                ended.status = Status::Successful;
                words::DONE.clone_into(&mut ended.phase);
                ended.progress = 100.0;
                ended.message.clone_from(message);
                ended.verdict = Some(*verdict);
                ended.warnings.extend(warnings.iter().cloned());
            }
            Outcome::Failed { failure, .. } => {
                ended.status = Status::Failed;
                ended.message.clone_from(&failure.detail);
                ended.failure = Some(failure.clone());
            }
            Outcome::Dismissed => {}
        }
        ended
    }
}

fn write_end(
    conn: &Connection,
    closing: &Closing,
    ended: &Ended,
    now: Timestamp,
) -> Result<Option<Record>, StoreError> {
    let sql = format!(
        "UPDATE jobs SET status = ?4, phase = ?5, progress = max(progress, ?6), message = ?7,
           verdict = ?8, warnings = ?9, failure_code = ?10, failure_detail = ?11,
           failure_reference = ?12, failure_errors = ?13, solve_ms = ?14, finished = ?15,
           updated = ?15, result_bytes = ?16, owner = NULL, lease_until = NULL,
           cancel_requested = 0, transitions = transitions + 1, ticks = 0
         WHERE {FENCED} RETURNING {COLUMNS}"
    );
    let (fence, failure) = (&closing.fence, ended.failure.as_ref());
    rows::one(
        conn,
        &sql,
        params![
            fence.id.to_string(),
            fence.attempt,
            fence.owner.0,
            ended.status.as_str(),
            ended.phase,
            ended.progress,
            ended.message,
            ended.verdict.map(Verdict::as_str),
            json(&ended.warnings),
            failure.map(|f| &f.code),
            failure.map(|f| &f.detail),
            failure.and_then(|f| f.reference).map(|r| r.to_string()),
            failure.and_then(|f| f.errors_json.as_ref()),
            closing.end.solve_ms,
            now.as_millis(),
            closing.result.as_ref().map(|r| r.raw_len.cast_signed()),
        ],
    )
}

/// Gives one job back unharmed; none if the fence does not hold.
///
/// # Errors
/// SQLite's.
pub(super) fn release(
    conn: &Connection,
    fence: &Fence,
    now: Timestamp,
) -> Result<Option<Job>, StoreError> {
    let held = rows::one(
        conn,
        &format!("SELECT {COLUMNS} FROM jobs WHERE {FENCED}"),
        (fence.id.to_string(), fence.attempt, &fence.owner.0),
    )?;
    held.map(|record| put_back(conn, &record, record.lost, u32::MAX, now))
        .transpose()
}

/// Takes away the leases that ran out by `now`, or all of them.
///
/// # Errors
/// SQLite's.
pub(super) fn take_away(
    conn: &Connection,
    all: bool,
    max_lost: u32,
    now: Timestamp,
) -> Result<Vec<Job>, StoreError> {
    let by = if all { i64::MAX } else { now.as_millis() };
    let sql = format!(
        "SELECT {COLUMNS} FROM jobs WHERE status = 'running' AND lease_until <= ?1 ORDER BY seq"
    );
    rows::many(conn, &sql, [by])?
        .iter()
        .map(|record| put_back(conn, record, record.lost + 1, max_lost, now))
        .collect()
}

/// A running job waits again; or is dismissed, if somebody wants that; or has
/// failed, if `lost` is as many leases as it may lose.
fn put_back(
    conn: &Connection,
    record: &Record,
    lost: u32,
    max_lost: u32,
    now: Timestamp,
) -> Result<Job, StoreError> {
    let (status, failure) = if record.job.cancel_requested {
        (Status::Dismissed, None)
    } else if lost >= max_lost {
        (Status::Failed, Some(crashed(lost)))
    } else {
        (Status::Accepted, None)
    };
    let message = match &failure {
        Some(failure) => failure.detail.as_str(),
        None if status == Status::Dismissed => words::CANCELLED,
        None if lost > record.lost => words::AGAIN,
        None => words::WAITING,
    };
    let back = Back {
        status,
        message,
        lost,
        failure: failure.as_ref(),
    };
    let changed = write_back(conn, record.seq, &back, now)?;
    let changed =
        changed.ok_or_else(|| StoreError::Defect("a running row went away".to_owned()))?;
    rows::seen(conn, changed)
}

/// The columns of a job put back.
struct Back<'a> {
    status: Status,
    message: &'a str,
    lost: u32,
    failure: Option<&'a Failure>,
}

/// A job that ended keeps the phase in which it did.
fn write_back(
    conn: &Connection,
    seq: i64,
    back: &Back<'_>,
    now: Timestamp,
) -> Result<Option<Record>, StoreError> {
    let sql = format!(
        "UPDATE jobs SET status = ?2, phase = iif(?2 = 'accepted', ?3, phase), message = ?4,
           lost = ?5, updated = ?6, finished = ?7, failure_code = ?8, failure_detail = ?9,
           failure_reference = ?10, owner = NULL, lease_until = NULL, cancel_requested = 0,
           transitions = transitions + 1, ticks = 0
         WHERE seq = ?1 RETURNING {COLUMNS}"
    );
    let failure = back.failure;
    rows::one(
        conn,
        &sql,
        params![
            seq,
            back.status.as_str(),
            words::QUEUED,
            back.message,
            back.lost,
            now.as_millis(),
            back.status.is_ended().then_some(now.as_millis()),
            failure.map(|f| &f.code),
            failure.map(|f| &f.detail),
            failure.and_then(|f| f.reference).map(|r| r.to_string()),
        ],
    )
}
