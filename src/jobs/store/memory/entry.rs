//! One job of the model, and what can become of it.

use std::collections::HashMap;
use std::time::Duration;

use bytes::Bytes;

use crate::jobs::model::{Job, JobId, NewJob, Status, Tenant, Timestamp};
use crate::jobs::store::shared::{crashed, words};
use crate::jobs::store::{BlobKind, End, Fence, Outcome, Owner};

/// A job with all that belongs to it.
pub(super) struct Entry {
    pub job: Job,
    pub lease: Option<(Owner, Timestamp)>,
    pub lost: u32,
    pub budget: Duration,
    pub transitions: u64,
    pub ticks: u64,
    pub blobs: HashMap<BlobKind, Bytes>,
    pub erased: bool,
}

impl Entry {
    pub fn new(tenant: &Tenant, new: NewJob, now: Timestamp) -> Self {
        let job = Job {
            id: JobId::random(),
            tenant: tenant.clone(),
            method: new.method,
            label: new.label,
            status: Status::Accepted,
            phase: words::QUEUED.to_owned(),
            progress: 0.0,
            message: words::WAITING.to_owned(),
            created: now,
            started: None,
            finished: None,
            updated: now,
            attempt: 0,
            queue_position: None,
            eta_s: None,
            engine_version: new.engine_version,
            input_sha256: new.input_sha256,
            verdict: None,
            warnings: new.warnings,
            failure: None,
            solve_ms: None,
            revision: 0,
            cancel_requested: false,
            input_bytes: new.input.len() as u64,
            result_bytes: None,
        };
        Entry {
            job,
            lease: None,
            lost: 0,
            budget: new.budget,
            transitions: 1,
            ticks: 0,
            blobs: HashMap::from([(BlobKind::Input, new.input)]),
            erased: false,
        }
    }

    pub fn holds(&self, fence: &Fence) -> bool {
        self.job.id == fence.id
            && self.job.status == Status::Running
            && self.job.attempt == fence.attempt
            && self.lease.as_ref().is_some_and(|(o, _)| *o == fence.owner)
    }

    /// A new state: what every change of state has in common.
    pub fn enter(&mut self, status: Status, message: impl Into<String>, now: Timestamp) {
        self.job.status = status;
        self.job.message = message.into();
        self.job.updated = now;
        self.transitions += 1;
        self.ticks = 0;
        if status != Status::Running {
            self.lease = None;
            self.job.cancel_requested = false;
        }
        if status.is_ended() {
            self.job.finished = Some(now);
        }
    }

    pub fn put_back(&mut self, lost: u32, max_lost: u32, now: Timestamp) {
        let again = lost > self.lost;
        self.lost = lost;
        if self.job.cancel_requested {
            self.enter(Status::Dismissed, words::CANCELLED, now);
        } else if lost >= max_lost {
            let failure = crashed(lost);
            self.enter(Status::Failed, failure.detail.clone(), now);
            self.job.failure = Some(failure);
        } else {
            words::QUEUED.clone_into(&mut self.job.phase);
            let message = if again { words::AGAIN } else { words::WAITING };
            self.enter(Status::Accepted, message, now);
        }
    }

    pub fn close(&mut self, end: End, now: Timestamp) {
        self.job.phase = end.phase;
        self.job.progress = self.job.progress.max(end.progress);
        self.job.solve_ms = Some(end.solve_ms);
        match end.outcome {
            Outcome::Successful {
                result,
                diagnostics,
                verdict,
                warnings,
                message,
            } => {
                self.enter(Status::Successful, message, now);
                words::DONE.clone_into(&mut self.job.phase);
                self.job.progress = 100.0;
                self.job.verdict = Some(verdict);
                self.job.warnings.extend(warnings);
                self.job.result_bytes = Some(result.len() as u64);
                self.blobs.insert(BlobKind::Result, result);
                self.blobs.insert(BlobKind::Diagnostics, diagnostics);
            }
            Outcome::Failed {
                failure,
                diagnostics,
            } => {
                self.enter(Status::Failed, failure.detail.clone(), now);
                self.job.failure = Some(failure);
                if let Some(diagnostics) = diagnostics {
                    self.blobs.insert(BlobKind::Diagnostics, diagnostics);
                }
            }
            Outcome::Dismissed => self.enter(Status::Dismissed, words::CANCELLED, now),
        }
    }
}
