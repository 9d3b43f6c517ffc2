//! Takes waiting jobs up as threads become free, and sees each to its end.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use rayon::ThreadPool;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};
use tokio_util::task::TaskTracker;
use tracing::{debug, info, warn};

use super::control::{FitControl, Why};
use super::core::{Core, Stage, bump};
use super::fit;
use super::model::Job;
use super::store::{Claim, End, Fence, StoreError};

/// How often to look for work unasked: jobs of other processes that share the
/// store, and a claim that failed. Within one process submitting wakes us.
const LOOK: Duration = Duration::from_secs(1);

/// First and longest pause between tries to write an end.
const RETRY: std::ops::RangeInclusive<Duration> =
    Duration::from_millis(50)..=Duration::from_secs(1);

/// Takes jobs up until the queue drains. Fits and their ends are tasks of
/// `fits`.
pub(super) async fn dispatch(core: Arc<Core>, pool: Arc<ThreadPool>, fits: TaskTracker) {
    let free = Arc::new(Semaphore::new(core.config.workers));
    loop {
        let begun = tokio::select! {
            biased;
            () = core.reached(Stage::Draining) => return,
            permit = Arc::clone(&free).acquire_owned() => {
                // The semaphore is never closed.
                let Ok(permit) = permit else { return };
                take_up(&core, &pool, &fits, Free { first: permit, more: &free }).await
            }
        };
        if begun == 0 {
            tokio::select! {
                () = core.wake.notified() => {}
                () = tokio::time::sleep(LOOK) => {}
                () = core.reached(Stage::Draining) => return,
            }
        }
    }
}

/// Free threads: one at least.
struct Free<'a> {
    first: OwnedSemaphorePermit,
    more: &'a Arc<Semaphore>,
}

impl Free<'_> {
    fn all(self) -> Vec<OwnedSemaphorePermit> {
        let mut all = vec![self.first];
        while let Ok(permit) = Arc::clone(self.more).try_acquire_owned() {
            all.push(permit);
        }
        all
    }
}

/// Claims a job for every free thread and begins them; how many there were.
async fn take_up(
    core: &Arc<Core>,
    pool: &Arc<ThreadPool>,
    fits: &TaskTracker,
    free: Free<'_>,
) -> usize {
    let permits = free.all();
    let claimed = core
        .store
        .claim(&core.owner, permits.len(), core.config.lease)
        .await;
    let claims = match claimed {
        Ok(claims) => claims,
        Err(error) => {
            core.note(&error);
            warn!(%error, "no job can be taken up just now");
            return 0;
        }
    };
    let begun = claims.len();
    for (claim, permit) in claims.into_iter().zip(permits) {
        begin(core, pool, fits, (claim, permit));
    }
    begun
}

/// Puts one fit on the pool and a task beside it that sees it to its end.
fn begin(
    core: &Arc<Core>,
    pool: &Arc<ThreadPool>,
    fits: &TaskTracker,
    (claim, permit): (Claim, OwnedSemaphorePermit),
) {
    let control = Arc::new(control_of(core, &claim));
    core.live.insert(&control);
    core.hub.changed(claim.job.id);
    if core.stage() > Stage::Open {
        // Claimed while the queue began to drain: not worth beginning.
        control.stop(Why::GivenBack);
    }
    let (tell, told) = oneshot::channel();
    let seen = Fit {
        core: Arc::clone(core),
        control: Arc::clone(&control),
        begun: core.clock.monotonic(),
        budget: claim.budget,
    };
    fits.spawn(seen.see_to_its_end(told));
    let core = Arc::clone(core);
    let Claim { job, input, .. } = claim;
    pool.spawn(move || {
        let end = fit::run(&core, &job, &input, &control);
        drop(permit);
        // The task waits for this as long as the runtime lives.
        let _ = tell.send(end);
    });
}

fn control_of(core: &Arc<Core>, claim: &Claim) -> FitControl {
    let fence = Fence {
        id: claim.job.id,
        attempt: claim.job.attempt,
        owner: core.owner.clone(),
    };
    let (watched, id) = (Arc::downgrade(core), claim.job.id);
    let on_step = Box::new(move || {
        if let Some(core) = watched.upgrade() {
            core.hub.changed(id);
        }
    });
    FitControl::new(
        &claim.job,
        fence,
        claim.budget,
        Arc::clone(&core.clock),
        on_step,
    )
}

/// A running fit as its task sees it.
struct Fit {
    core: Arc<Core>,
    control: Arc<FitControl>,
    begun: Duration,
    budget: Duration,
}

impl Fit {
    /// Waits for the fit and writes its end; ends the job without it if it
    /// does not stop when told.
    async fn see_to_its_end(self, mut told: oneshot::Receiver<Option<End>>) {
        let end = tokio::select! {
            biased;
            end = &mut told => end.ok().flatten(),
            () = self.grace_over() => return self.without_it(told).await,
        };
        match end {
            Some(end) => self.write(end).await,
            None => self.give_back().await,
        }
        self.core.live.remove(&self.control);
    }

    /// The fit was stopped for our sake: its job goes to somebody else. Nothing
    /// happens if it is somebody else's already.
    async fn give_back(&self) {
        let fence = self.control.fence().clone();
        match self.core.store.release(vec![fence]).await {
            Ok(changed) => changed.iter().for_each(|job| self.core.announce(job)),
            Err(error) => warn!(%error, "a job was not given back; its lease will run out"),
        }
    }

    /// Ends when the fit was told to stop, or should have noticed by itself
    /// that its time is over, and the grace for obeying is over as well.
    async fn grace_over(&self) {
        tokio::select! {
            () = self.control.told_to_stop() => {}
            () = tokio::time::sleep(self.budget) => {}
        }
        tokio::time::sleep(self.core.config.stop_grace).await;
    }

    async fn without_it(self, told: oneshot::Receiver<Option<End>>) {
        let id = self.control.fence().id;
        warn!(job = %id, "a fit does not stop; its job ends without it");
        let stuck = &self.core.counters.stuck;
        stuck.fetch_add(1, Ordering::Relaxed);
        match fit::overdue(&self.control, self.solve_ms()) {
            Some(end) => self.write(end).await,
            None => self.give_back().await,
        }
        // Should it ever ask: nobody wants it any more.
        self.control.stop(Why::LeaseLost);
        self.core.live.remove(&self.control);
        // An error means that the pool is gone, and the fit with it.
        let _ = told.await;
        stuck.fetch_sub(1, Ordering::Relaxed);
        info!(job = %id, "the fit that did not stop has ended");
    }

    fn solve_ms(&self) -> f64 {
        (self.core.clock.monotonic() - self.begun).as_secs_f64() * 1000.0
    }

    /// Writes the end, however long that takes: a result is hours of somebody's
    /// patience, and a full disk or a lock passes.
    async fn write(&self, end: End) {
        let mut end = end;
        let mut pause = *RETRY.start();
        let mut refused = false;
        loop {
            let fence = self.control.fence().clone();
            match self.core.store.complete(fence, end.clone()).await {
                Ok(job) => return self.written(job.as_ref()),
                Err(StoreError::Full | StoreError::Busy(_)) if !self.is_closed() => {
                    warn!(job = %self.control.fence().id, "an end cannot be written yet");
                    tokio::time::sleep(pause).await;
                    pause = (pause * 2).min(*RETRY.end());
                }
                Err(reason @ (StoreError::Corrupt(_) | StoreError::Defect(_))) if !refused => {
                    refused = true;
                    end = fit::not_kept(&self.control, end.solve_ms, &reason);
                }
                Err(reason) => {
                    self.core.note(&reason);
                    warn!(job = %self.control.fence().id, %reason, "an end was not written");
                    return;
                }
            }
        }
    }

    fn is_closed(&self) -> bool {
        self.core.stage() == Stage::Closed
    }

    fn written(&self, job: Option<&Job>) {
        let fence = self.control.fence();
        match job {
            Some(job) => {
                debug!(job = %job.id, status = job.status.as_str(), "ended");
                self.core.announce(job);
            }
            None => {
                bump(&self.core.counters.stale);
                warn!(job = %fence.id, attempt = fence.attempt,
                    "a result was dropped: the job is no longer this attempt's");
            }
        }
    }
}
