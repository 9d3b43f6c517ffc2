//! An owner's side: cancelling, deleting, listing, reading; and the sweep.

use rusqlite::{Connection, OptionalExtension, params};

use super::rows::{self, COLUMNS};
use crate::jobs::model::{Job, JobId, ListQuery, Page, Status, Tenant, Timestamp};
use crate::jobs::store::cursor::Cursor;
use crate::jobs::store::pack::Packed;
use crate::jobs::store::shared::words;
use crate::jobs::store::{BlobKind, Cancelled, Retention, StoreError, Swept};

/// Pages that one sweep gives back to the file system: 2 MB at the usual page
/// size, a few milliseconds of writing.
const VACUUM_PAGES: u32 = 500;

/// Dismisses, marks or leaves a job.
///
/// # Errors
/// SQLite's.
pub(super) fn cancel(
    conn: &Connection,
    tenant: &Tenant,
    id: JobId,
    now: Timestamp,
) -> Result<Option<Cancelled>, StoreError> {
    let Some(record) = rows::find(conn, tenant, id)? else {
        return Ok(None);
    };
    let set = match record.job.status {
        Status::Accepted => "status = 'dismissed', finished = ?2, message = ?3",
        Status::Running if !record.job.cancel_requested => "cancel_requested = 1, message = ?3",
        _ => {
            let job = rows::seen(conn, record)?;
            return Ok(Some(Cancelled {
                job,
                changed: false,
            }));
        }
    };
    let message = if record.job.status == Status::Accepted {
        words::CANCELLED
    } else {
        words::CANCELLING
    };
    let sql = format!(
        "UPDATE jobs SET {set}, updated = ?2, transitions = transitions + 1
         WHERE seq = ?1 RETURNING {COLUMNS}"
    );
    let changed = rows::one(conn, &sql, (record.seq, now.as_millis(), message))?;
    let Some(record) = changed else {
        return Ok(None);
    };
    let job = rows::seen(conn, record)?;
    Ok(Some(Cancelled { job, changed: true }))
}

/// Erases a job; its blobs and key go with it.
///
/// # Errors
/// SQLite's.
pub(super) fn delete(conn: &Connection, tenant: &Tenant, id: JobId) -> Result<bool, StoreError> {
    let gone = conn
        .prepare_cached("DELETE FROM jobs WHERE id = ?1 AND tenant = ?2")?
        .execute((id.to_string(), tenant.as_str()))?;
    Ok(gone > 0)
}

/// A page of jobs; none if the cursor is not ours.
///
/// # Errors
/// SQLite's.
pub(super) fn list(
    conn: &Connection,
    tenant: &Tenant,
    query: &ListQuery,
) -> Result<Option<Page>, StoreError> {
    let after = match query.cursor.as_deref().map(Cursor::parse) {
        None => None,
        Some(Some(cursor)) => Some(cursor),
        Some(None) => return Ok(None),
    };
    let limit = query.limit.clamp(1, ListQuery::MAX_LIMIT);
    let sql = format!(
        "SELECT {COLUMNS} FROM jobs WHERE tenant = ?1
           AND (created, id) < (?2, ?3)
           AND (?4 IS NULL OR status = ?4)
           AND (?5 IS NULL OR method = ?5)
           AND (?6 IS NULL OR label = ?6)
         ORDER BY created DESC, id DESC LIMIT ?7"
    );
    let mut records = rows::many(
        conn,
        &sql,
        params![
            tenant.as_str(),
            after.map_or(i64::MAX, |c| c.created.as_millis()),
            after.map_or_else(String::new, |c| c.id.to_string()),
            query.status.map(Status::as_str),
            query.method,
            query.label,
            i64::try_from(limit + 1).unwrap_or(i64::MAX),
        ],
    )?;
    let more = records.len() > limit;
    records.truncate(limit);
    let items = rows::all_seen(conn, records)?;
    let next_cursor = items.last().filter(|_| more).map(|job| {
        Cursor {
            created: job.created,
            id: job.id,
        }
        .to_word()
    });
    Ok(Some(Page { items, next_cursor }))
}

/// A job with one of its blobs, still compressed.
pub(super) struct Found {
    /// The job.
    pub job: Job,
    /// The blob.
    pub blob: Option<Packed>,
    /// Its blobs are erased.
    pub erased: bool,
}

/// A job with one of its blobs.
///
/// # Errors
/// SQLite's.
pub(super) fn blob(
    conn: &Connection,
    tenant: &Tenant,
    id: JobId,
    kind: BlobKind,
) -> Result<Option<Found>, StoreError> {
    let Some(record) = rows::find(conn, tenant, id)? else {
        return Ok(None);
    };
    let blob = read_blob(conn, record.seq, kind)?;
    let erased = record.erased;
    let job = rows::seen(conn, record)?;
    Ok(Some(Found { job, blob, erased }))
}

/// A blob by its job's number.
///
/// # Errors
/// SQLite's.
pub(super) fn read_blob(
    conn: &Connection,
    seq: i64,
    kind: BlobKind,
) -> Result<Option<Packed>, StoreError> {
    let found = conn
        .prepare_cached("SELECT raw_len, data FROM blobs WHERE seq = ?1 AND kind = ?2")?
        .query_row((seq, kind.as_str()), |row| {
            Ok(Packed {
                raw_len: rows::count(row, "raw_len")?,
                data: row.get("data")?,
            })
        })
        .optional()?;
    Ok(found)
}

/// Erases some of what is past its time.
///
/// # Errors
/// SQLite's.
pub(super) fn sweep(
    conn: &Connection,
    keep: Retention,
    now: Timestamp,
) -> Result<Swept, StoreError> {
    let at_most = Swept::AT_MOST.cast_signed();
    let blobs = now.minus(keep.blobs).as_millis();
    conn.prepare_cached(
        "DELETE FROM blobs WHERE seq IN (SELECT seq FROM jobs
           WHERE finished < ?1 AND erased = 0 ORDER BY finished LIMIT ?2)",
    )?
    .execute((blobs, at_most))?;
    let erased = conn
        .prepare_cached(
            "UPDATE jobs SET erased = 1 WHERE seq IN (SELECT seq FROM jobs
               WHERE finished < ?1 AND erased = 0 ORDER BY finished LIMIT ?2)",
        )?
        .execute((blobs, at_most))?;
    let records = conn
        .prepare_cached(
            "DELETE FROM jobs WHERE seq IN
               (SELECT seq FROM jobs WHERE finished < ?1 ORDER BY finished LIMIT ?2)",
        )?
        .execute((now.minus(keep.records).as_millis(), at_most))?;
    let keys = conn
        .prepare_cached(
            "DELETE FROM keys WHERE (tenant, key) IN
               (SELECT tenant, key FROM keys WHERE created < ?1 ORDER BY created LIMIT ?2)",
        )?
        .execute((now.minus(keep.keys).as_millis(), at_most))?;
    if erased + records > 0 {
        conn.execute_batch(&format!("PRAGMA incremental_vacuum({VACUUM_PAGES})"))?;
    }
    Ok(Swept {
        blobs: erased as u64,
        records: records as u64,
        keys: keys as u64,
    })
}
