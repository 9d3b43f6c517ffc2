//! The jobs and keys of the model, by the sentences of the trait.

use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

use super::entry::Entry;
use crate::jobs::model::{
    IdempotencyKey, Job, JobId, ListQuery, NewJob, Page, Status, Tenant, Timestamp,
};
use crate::jobs::store::cursor::Cursor;
use crate::jobs::store::shared::{revision, words};
use crate::jobs::store::{
    Admission, Backlog, Beat, BlobKind, Claim, Fence, Limits, Owner, Pulse, Retention, StoreError,
    Swept,
};

/// Everything, by order of acceptance.
#[derive(Default)]
pub(super) struct Rows {
    jobs: BTreeMap<u64, Entry>,
    keys: HashMap<(Tenant, String), Key>,
    last_seq: u64,
}

/// A known idempotency key.
struct Key {
    body_sha256: String,
    seq: u64,
    created: Timestamp,
}

impl Rows {
    pub fn seq_of(&self, tenant: &Tenant, id: JobId) -> Option<u64> {
        self.jobs
            .iter()
            .find(|(_, e)| e.job.id == id && e.job.tenant == *tenant)
            .map(|(seq, _)| *seq)
    }

    pub fn entry(&mut self, tenant: &Tenant, id: JobId) -> Option<(u64, &mut Entry)> {
        let seq = self.seq_of(tenant, id)?;
        self.jobs.get_mut(&seq).map(|entry| (seq, entry))
    }

    pub fn held(&mut self, fence: &Fence) -> Option<(u64, &mut Entry)> {
        self.jobs
            .iter_mut()
            .find(|(_, entry)| entry.holds(fence))
            .map(|(seq, entry)| (*seq, entry))
    }

    pub fn seen(&self, seq: u64) -> Option<Job> {
        let entry = self.jobs.get(&seq)?;
        let mut job = entry.job.clone();
        job.queue_position = (job.status == Status::Accepted).then(|| {
            let ahead = self.jobs.range(..=seq);
            ahead
                .filter(|(_, e)| e.job.status == Status::Accepted)
                .count() as u64
        });
        job.revision = revision(entry.transitions, entry.ticks, job.queue_position);
        Some(job)
    }

    pub fn all_seen(&self, seqs: impl IntoIterator<Item = u64>) -> Vec<Job> {
        seqs.into_iter().filter_map(|seq| self.seen(seq)).collect()
    }

    pub fn backlog(&self) -> Backlog {
        let mut backlog = Backlog::default();
        for entry in self.jobs.values() {
            match entry.job.status {
                Status::Accepted => {
                    backlog.queued += 1;
                    backlog.queued_bytes += entry.job.input_bytes;
                }
                Status::Running => backlog.running += 1,
                _ => {}
            }
        }
        backlog
    }

    pub fn replay(
        &self,
        tenant: &Tenant,
        key: &IdempotencyKey,
        oldest: Timestamp,
    ) -> Option<Admission> {
        let known = self.keys.get(&(tenant.clone(), key.key.clone()))?;
        if known.created < oldest {
            return None;
        }
        if known.body_sha256 != key.body_sha256 {
            return Some(Admission::KeyConflict);
        }
        self.seen(known.seq).map(Admission::Replayed)
    }

    pub fn accept(
        &mut self,
        tenant: &Tenant,
        mut new: NewJob,
        limits: Limits,
        now: Timestamp,
    ) -> Admission {
        let key = new.idempotency.take();
        if let Some(key) = &key {
            let oldest = now.minus(limits.idempotency_age);
            if let Some(known) = self.replay(tenant, key, oldest) {
                return known;
            }
        }
        let (backlog, more) = (self.backlog(), new.input.len() as u64);
        if backlog.queued >= limits.jobs || backlog.queued_bytes.saturating_add(more) > limits.bytes
        {
            return Admission::QueueFull;
        }
        self.last_seq += 1;
        let seq = self.last_seq;
        let entry = Entry::new(tenant, new, now);
        if let Some(key) = key {
            let known = Key {
                body_sha256: key.body_sha256,
                seq,
                created: now,
            };
            self.keys.insert((tenant.clone(), key.key), known);
        }
        let mut job = entry.job.clone();
        self.jobs.insert(seq, entry);
        job.queue_position = Some(backlog.queued + 1);
        job.revision = revision(1, 0, job.queue_position);
        Admission::New(job)
    }

    pub fn claim(&mut self, owner: &Owner, lease: Duration, now: Timestamp) -> Option<Claim> {
        let (seq, entry) = self
            .jobs
            .iter_mut()
            .find(|(_, e)| e.job.status == Status::Accepted)?;
        let seq = *seq;
        entry.enter(Status::Running, words::FITTING, now);
        words::STARTING.clone_into(&mut entry.job.phase);
        entry.job.attempt += 1;
        entry.job.started = Some(now);
        entry.lease = Some((owner.clone(), now.plus(lease)));
        let missing = || StoreError::Corrupt("the input is missing".to_owned());
        let input = entry.blobs.get(&BlobKind::Input).cloned();
        let budget = entry.budget;
        Some(Claim {
            job: self.seen(seq)?,
            input: input.ok_or_else(missing),
            budget,
        })
    }

    pub fn beat(&mut self, beat: &Beat, until: Timestamp, now: Timestamp) -> Pulse {
        let Some((_, entry)) = self.held(&beat.fence) else {
            return Pulse::Lost;
        };
        if let Some((_, lease)) = &mut entry.lease {
            *lease = until;
        }
        entry.job.phase.clone_from(&beat.phase);
        entry.job.progress = entry.job.progress.max(beat.progress);
        if beat.ticks > entry.ticks {
            entry.ticks = beat.ticks;
            entry.job.updated = now;
        }
        if entry.job.cancel_requested {
            Pulse::CancelRequested
        } else {
            Pulse::Held
        }
    }

    pub fn take_away(&mut self, by: Option<Timestamp>, max_lost: u32, now: Timestamp) -> Vec<Job> {
        let mut changed = Vec::new();
        for (seq, entry) in &mut self.jobs {
            let Some((_, until)) = &entry.lease else {
                continue;
            };
            if by.is_none_or(|by| *until <= by) {
                entry.put_back(entry.lost + 1, max_lost, now);
                changed.push(*seq);
            }
        }
        self.all_seen(changed)
    }

    pub fn list(&self, tenant: &Tenant, query: &ListQuery) -> Option<Page> {
        let place = |job: &Job| Cursor {
            created: job.created,
            id: job.id,
        };
        let after = match &query.cursor {
            Some(word) => Some(Cursor::parse(word)?),
            None => None,
        };
        let limit = query.limit.clamp(1, ListQuery::MAX_LIMIT);
        let mut found: Vec<(Cursor, u64)> = self
            .jobs
            .iter()
            .map(|(seq, entry)| (seq, &entry.job))
            .filter(|(_, job)| job.tenant == *tenant)
            .filter(|(_, job)| after.is_none_or(|after| place(job) < after))
            .filter(|(_, job)| query.status.is_none_or(|s| s == job.status))
            .filter(|(_, job)| query.method.as_ref().is_none_or(|m| *m == job.method))
            .filter(|(_, job)| query.label.is_none() || query.label == job.label)
            .map(|(seq, job)| (place(job), *seq))
            .collect();
        found.sort_unstable_by(|a, b| b.cmp(a));
        let next = (found.len() > limit).then(|| found[limit - 1].0.to_word());
        found.truncate(limit);
        Some(Page {
            items: self.all_seen(found.into_iter().map(|(_, seq)| seq)),
            next_cursor: next,
        })
    }

    pub fn sweep(&mut self, keep: Retention, now: Timestamp) -> Swept {
        let ended_before = |entry: &Entry, age| {
            let finished = entry.job.finished;
            finished.is_some_and(|finished| finished < now.minus(age))
        };
        let at_most = usize::try_from(Swept::AT_MOST).unwrap_or(usize::MAX);
        let mut swept = Swept::default();
        let old = |e: &&mut Entry| ended_before(e, keep.blobs) && !e.erased;
        for entry in self.jobs.values_mut().filter(old).take(at_most) {
            entry.blobs.clear();
            entry.erased = true;
            swept.blobs += 1;
        }
        let gone: Vec<u64> = self
            .jobs
            .iter()
            .filter(|(_, entry)| ended_before(entry, keep.records))
            .map(|(seq, _)| *seq)
            .take(at_most)
            .collect();
        for seq in &gone {
            self.remove(*seq);
        }
        swept.records = gone.len() as u64;
        let forgotten: Vec<(Tenant, String)> = self
            .keys
            .iter()
            .filter(|(_, key)| key.created < now.minus(keep.keys))
            .map(|(name, _)| name.clone())
            .take(at_most)
            .collect();
        for name in &forgotten {
            self.keys.remove(name);
        }
        swept.keys = forgotten.len() as u64;
        swept
    }

    pub fn remove(&mut self, seq: u64) {
        self.jobs.remove(&seq);
        self.keys.retain(|_, key| key.seq != seq);
    }
}
