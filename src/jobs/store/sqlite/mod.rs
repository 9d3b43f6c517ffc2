//! The embedded store: one SQLite file, one writer thread, a few readers.
//!
//! Write-ahead log with `synchronous = FULL`: what a call has returned is on
//! disk. The folder is locked, so one process has it; that makes the leases of
//! whoever had it before void. Everything heavy (compressing, copying blobs)
//! happens outside the writer.
//!
//! Limits: a blob is one row of at most SQLite's 1 GB; local disks only, as the
//! log needs shared memory.

mod accept;
mod fault;
mod lease;
mod open;
mod owner;
mod reader;
mod rows;
mod schema;
#[cfg(test)]
mod tests;
mod writer;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;

use self::accept::Draft;
use self::lease::Closing;
use self::open::Folder;
use self::reader::Readers;
use self::writer::Writer;
use super::pack::Packed;
use super::{
    Admission, Answer, Beat, BlobKind, Cancelled, Claim, End, Fence, Limits, Looked, Outcome,
    Owner, Pulse, Retention, Store, StoreError, StoreState, Swept,
};
use crate::jobs::clock::Clock;
use crate::jobs::error::OpenError;
use crate::jobs::model::{IdempotencyKey, Job, JobId, ListQuery, NewJob, Page, Tenant};

/// The store in one SQLite file.
pub struct SqliteStore {
    // Order of dropping: connections first, the folder's lock last.
    writer: Writer,
    readers: Readers,
    clock: Arc<dyn Clock>,
    folder: Folder,
}

impl SqliteStore {
    /// Opens the store in `folder`, making and migrating it if need be.
    ///
    /// # Errors
    /// See [`OpenError`].
    pub fn open(folder: &Path, clock: Arc<dyn Clock>) -> Result<Self, OpenError> {
        open::check_version(rusqlite::version_number())?;
        let folder = Folder::take(folder)?;
        let file = folder.file();
        let writer = Writer::start(open::writer(&file)?)?;
        let readers = Readers::open(&file)?;
        Ok(SqliteStore {
            writer,
            readers,
            clock,
            folder,
        })
    }
}

/// Heavy work, off the threads that answer.
async fn off<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, StoreError> + Send + 'static,
) -> Result<T, StoreError> {
    tokio::task::spawn_blocking(work)
        .await
        .map_err(|e| StoreError::Busy(format!("a blocking thread: {e}")))?
}

/// Compresses what an end carries.
fn close(fence: Fence, end: End) -> Result<Closing, StoreError> {
    let (result, diagnostics) = match &end.outcome {
        Outcome::Successful {
            result,
            diagnostics,
            ..
        } => (
            Some(Packed::pack(result)?),
            Some(Packed::pack(diagnostics)?),
        ),
        Outcome::Failed { diagnostics, .. } => {
            let packed = diagnostics.as_ref().map(|d| Packed::pack(d)).transpose()?;
            (None, packed)
        }
        Outcome::Dismissed => (None, None),
    };
    Ok(Closing {
        fence,
        end,
        result,
        diagnostics,
    })
}

impl Store for SqliteStore {
    fn accept<'a>(
        &'a self,
        tenant: &'a Tenant,
        new: NewJob,
        limits: Limits,
    ) -> Answer<'a, Admission> {
        Box::pin(async move {
            let tenant = tenant.clone();
            let draft = off(move || {
                Ok(Draft {
                    input: Packed::pack(&new.input)?,
                    tenant,
                    new,
                    limits,
                })
            })
            .await?;
            let clock = Arc::clone(&self.clock);
            self.writer
                .call(move |conn| accept::accept(conn, &draft, clock.now()))
                .await
        })
    }

    fn replay<'a>(
        &'a self,
        tenant: &'a Tenant,
        key: &'a IdempotencyKey,
        idempotency_age: Duration,
    ) -> Answer<'a, Option<Admission>> {
        let (tenant, key) = (tenant.clone(), key.clone());
        let oldest = self.clock.now().minus(idempotency_age);
        Box::pin(
            self.readers
                .read(move |conn| accept::replay(conn, &tenant, &key, oldest)),
        )
    }

    fn claim<'a>(
        &'a self,
        owner: &'a Owner,
        count: usize,
        lease: Duration,
    ) -> Answer<'a, Vec<Claim>> {
        let (owner, clock) = (owner.clone(), Arc::clone(&self.clock));
        let claims = self.writer.call(move |conn| {
            let now = clock.now();
            let mut claims = Vec::new();
            while claims.len() < count {
                let Some(record) = lease::claim(conn, &owner, now, now.plus(lease))? else {
                    break;
                };
                let input = owner::read_blob(conn, record.seq, BlobKind::Input)?;
                claims.push((record, input));
            }
            Ok(claims)
        });
        Box::pin(async move {
            let claims = claims.await?;
            if claims.is_empty() {
                return Ok(Vec::new());
            }
            off(move || Ok(claims.into_iter().map(unpack_claim).collect())).await
        })
    }

    fn beat(&self, beats: Vec<Beat>, lease: Duration) -> Answer<'_, Vec<Pulse>> {
        let clock = Arc::clone(&self.clock);
        Box::pin(self.writer.call(move |conn| {
            let now = clock.now();
            beats
                .iter()
                .map(|beat| lease::beat(conn, beat, now, now.plus(lease)))
                .collect()
        }))
    }

    fn complete(&self, fence: Fence, end: End) -> Answer<'_, Option<Job>> {
        Box::pin(async move {
            let closing = off(move || close(fence, end)).await?;
            let clock = Arc::clone(&self.clock);
            self.writer
                .call(move |conn| lease::complete(conn, &closing, clock.now()))
                .await
        })
    }

    fn release(&self, fences: Vec<Fence>) -> Answer<'_, Vec<Job>> {
        let clock = Arc::clone(&self.clock);
        Box::pin(self.writer.call(move |conn| {
            let now = clock.now();
            fences
                .iter()
                .filter_map(|fence| lease::release(conn, fence, now).transpose())
                .collect()
        }))
    }

    fn reap(&self, max_lost: u32) -> Answer<'_, Vec<Job>> {
        let clock = Arc::clone(&self.clock);
        Box::pin(
            self.writer
                .call(move |conn| lease::take_away(conn, false, max_lost, clock.now())),
        )
    }

    fn void_leases(&self, max_lost: u32) -> Answer<'_, Vec<Job>> {
        let clock = Arc::clone(&self.clock);
        Box::pin(
            self.writer
                .call(move |conn| lease::take_away(conn, true, max_lost, clock.now())),
        )
    }

    fn cancel<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, Option<Cancelled>> {
        let (tenant, clock) = (tenant.clone(), Arc::clone(&self.clock));
        Box::pin(
            self.writer
                .call(move |conn| owner::cancel(conn, &tenant, id, clock.now())),
        )
    }

    fn delete<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, bool> {
        let tenant = tenant.clone();
        Box::pin(
            self.writer
                .call(move |conn| owner::delete(conn, &tenant, id)),
        )
    }

    fn get<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, Option<Job>> {
        let tenant = tenant.clone();
        Box::pin(self.readers.read(move |conn| {
            rows::find(conn, &tenant, id)?
                .map(|record| rows::seen(conn, record))
                .transpose()
        }))
    }

    fn list<'a>(&'a self, tenant: &'a Tenant, query: ListQuery) -> Answer<'a, Option<Page>> {
        let tenant = tenant.clone();
        Box::pin(
            self.readers
                .read(move |conn| owner::list(conn, &tenant, &query)),
        )
    }

    fn blob<'a>(
        &'a self,
        tenant: &'a Tenant,
        id: JobId,
        kind: BlobKind,
    ) -> Answer<'a, Option<Looked>> {
        let tenant = tenant.clone();
        Box::pin(self.readers.read(move |conn| {
            let Some(found) = owner::blob(conn, &tenant, id, kind)? else {
                return Ok(None);
            };
            Ok(Some(Looked {
                job: found.job,
                blob: found.blob.map(|packed| packed.unpack()).transpose()?,
                erased: found.erased,
            }))
        }))
    }

    fn sweep(&self, retention: Retention) -> Answer<'_, Swept> {
        let clock = Arc::clone(&self.clock);
        Box::pin(
            self.writer
                .call(move |conn| owner::sweep(conn, retention, clock.now())),
        )
    }

    fn probe(&self) -> Answer<'_, ()> {
        Box::pin(self.writer.call(|conn| {
            conn.prepare_cached("UPDATE backlog SET probes = probes + 1")?
                .execute([])?;
            Ok(())
        }))
    }

    fn state(&self) -> StoreState {
        self.writer.state()
    }

    fn free_bytes(&self) -> Option<u64> {
        free_bytes(&self.folder.path)
    }

    fn sqlite_version(&self) -> Option<String> {
        Some(rusqlite::version().to_owned())
    }
}

/// Space that this process may still fill on the folder's disk.
#[cfg(unix)]
fn free_bytes(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(not(unix))]
fn free_bytes(_folder: &Path) -> Option<u64> {
    None
}

fn unpack_claim((record, input): (rows::Record, Option<Packed>)) -> Claim {
    let missing = || StoreError::Corrupt("the input is missing".to_owned());
    Claim {
        budget: Duration::from_millis(record.budget_ms),
        job: record.job,
        input: input
            .ok_or_else(missing)
            .and_then(|packed: Packed| -> Result<Bytes, StoreError> { packed.unpack() }),
    }
}
