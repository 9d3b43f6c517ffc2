//! Accepting: the job, its key and its input in one transaction.

use rusqlite::{Connection, OptionalExtension};

use super::rows;
use crate::jobs::model::{IdempotencyKey, JobId, NewJob, Tenant, Timestamp, millis};
use crate::jobs::store::pack::Packed;
use crate::jobs::store::shared::words;
use crate::jobs::store::{Admission, BlobKind, Limits, StoreError};

/// A submission made ready outside the writer.
pub(super) struct Draft {
    /// Whose it will be.
    pub tenant: Tenant,
    /// What was submitted.
    pub new: NewJob,
    /// Its input, compressed.
    pub input: Packed,
    /// What limits it.
    pub limits: Limits,
}

/// Accepts, replays or turns away.
///
/// # Errors
/// SQLite's.
pub(super) fn accept(
    conn: &Connection,
    draft: &Draft,
    now: Timestamp,
) -> Result<Admission, StoreError> {
    if let Some(key) = &draft.new.idempotency {
        let oldest = now.minus(draft.limits.idempotency_age);
        forget(conn, &draft.tenant, key, oldest)?;
        if let Some(known) = replay(conn, &draft.tenant, key, oldest)? {
            return Ok(known);
        }
    }
    if is_full(conn, draft)? {
        return Ok(Admission::QueueFull);
    }
    let id = JobId::random();
    let seq = insert(conn, draft, id, now)?;
    put_blob(conn, seq, BlobKind::Input, &draft.input)?;
    if let Some(key) = &draft.new.idempotency {
        conn.prepare_cached(
            "INSERT INTO keys (tenant, key, body_sha256, seq, created) VALUES (?1, ?2, ?3, ?4, ?5)",
        )?
        .execute((
            draft.tenant.as_str(),
            &key.key,
            &key.body_sha256,
            seq,
            now.as_millis(),
        ))?;
    }
    let record = rows::find(conn, &draft.tenant, id)?
        .ok_or_else(|| StoreError::Defect("the accepted row is not there".to_owned()))?;
    Ok(Admission::New(rows::seen(conn, record)?))
}

/// What a key gives, if it was used at `oldest` or later.
///
/// # Errors
/// SQLite's.
pub(super) fn replay(
    conn: &Connection,
    tenant: &Tenant,
    key: &IdempotencyKey,
    oldest: Timestamp,
) -> Result<Option<Admission>, StoreError> {
    let known: Option<(String, String)> = conn
        .prepare_cached(
            "SELECT keys.body_sha256, jobs.id FROM keys JOIN jobs USING (seq)
             WHERE keys.tenant = ?1 AND key = ?2 AND keys.created >= ?3",
        )?
        .query_row((tenant.as_str(), &key.key, oldest.as_millis()), |row| {
            Ok((row.get(0)?, row.get(1)?))
        })
        .optional()?;
    let Some((body_sha256, id)) = known else {
        return Ok(None);
    };
    if body_sha256 != key.body_sha256 {
        return Ok(Some(Admission::KeyConflict));
    }
    let id = id
        .parse()
        .map_err(|e| StoreError::Corrupt(format!("id {id:?}: {e}")))?;
    match rows::find(conn, tenant, id)? {
        Some(record) => Ok(Some(Admission::Replayed(rows::seen(conn, record)?))),
        None => Ok(None),
    }
}

fn forget(
    conn: &Connection,
    tenant: &Tenant,
    key: &IdempotencyKey,
    oldest: Timestamp,
) -> Result<(), StoreError> {
    conn.prepare_cached("DELETE FROM keys WHERE tenant = ?1 AND key = ?2 AND created < ?3")?
        .execute((tenant.as_str(), &key.key, oldest.as_millis()))?;
    Ok(())
}

fn is_full(conn: &Connection, draft: &Draft) -> Result<bool, StoreError> {
    let (jobs, bytes) = conn
        .prepare_cached("SELECT queued, queued_bytes FROM backlog")?
        .query_row([], |row| {
            Ok((
                rows::count(row, "queued")?,
                rows::count(row, "queued_bytes")?,
            ))
        })?;
    Ok(jobs >= draft.limits.jobs || bytes.saturating_add(draft.input.raw_len) > draft.limits.bytes)
}

fn insert(conn: &Connection, draft: &Draft, id: JobId, now: Timestamp) -> Result<i64, StoreError> {
    let new = &draft.new;
    conn.prepare_cached(
        "INSERT INTO jobs (id, tenant, method, label, status, phase, progress, message, created,
           updated, budget_ms, engine_version, input_sha256, input_bytes, warnings)
         VALUES (?1, ?2, ?3, ?4, 'accepted', ?5, 0.0, ?6, ?7, ?7, ?8, ?9, ?10, ?11, ?12)",
    )?
    .execute(rusqlite::params![
        id.to_string(),
        draft.tenant.as_str(),
        new.method,
        new.label,
        words::QUEUED,
        words::WAITING,
        now.as_millis(),
        millis(new.budget),
        new.engine_version,
        new.input_sha256,
        draft.input.raw_len.cast_signed(),
        json(&new.warnings),
    ])?;
    Ok(conn.last_insert_rowid())
}

/// Warnings as the row keeps them.
pub(super) fn json(warnings: &[String]) -> String {
    serde_json::Value::from(warnings).to_string()
}

/// Puts a blob beside its job; one that is there is replaced.
///
/// # Errors
/// SQLite's.
pub(super) fn put_blob(
    conn: &Connection,
    seq: i64,
    kind: BlobKind,
    blob: &Packed,
) -> Result<(), StoreError> {
    conn.prepare_cached(
        "INSERT OR REPLACE INTO blobs (seq, kind, raw_len, data) VALUES (?1, ?2, ?3, ?4)",
    )?
    .execute((seq, kind.as_str(), blob.raw_len.cast_signed(), &blob.data))?;
    Ok(())
}
