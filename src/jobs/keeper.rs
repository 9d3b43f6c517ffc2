//! The beat: renews leases, carries progress out and cancels in, takes lost
//! leases away, tries whether the store can be written, and sweeps.
//!
//! Leases are renewed before lost ones are taken away, and only if that
//! worked: a process that slept through its own leases does not rob itself.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use tokio::time::MissedTickBehavior;
use tracing::{debug, info, warn};

use super::control::{FitControl, Why};
use super::core::{Core, Stage};
use super::store::{Pulse, Retention, StoreError};

/// Beats until the queue is closed.
pub(super) async fn keep(core: Arc<Core>) {
    let mut beat = tokio::time::interval(core.config.beat);
    beat.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut sweep = tokio::time::interval(core.config.sweep);
    sweep.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        let done = tokio::select! {
            () = core.reached(Stage::Closed) => return,
            _ = beat.tick() => beat_once(&core).await,
            _ = sweep.tick() => sweep_all(&core).await,
        };
        if let Err(error) = done {
            core.note(&error);
            warn!(%error, "the beat cannot be written just now");
        }
    }
}

/// One beat.
///
/// # Errors
/// The store's; the next beat tries again.
pub(super) async fn beat_once(core: &Core) -> Result<(), StoreError> {
    renew(core).await?;
    for job in core.store.reap(core.config.max_lost_leases).await? {
        info!(job = %job.id, status = job.status.as_str(), "a lease was lost");
        core.announce(&job);
        core.wake.notify_one();
    }
    core.store.probe().await?;
    let stuck = core.counters.stuck.load(Ordering::Relaxed);
    if stuck < core.config.workers as u64 {
        core.note_beat();
    }
    Ok(())
}

async fn renew(core: &Core) -> Result<(), StoreError> {
    let fits = core.live.all();
    if fits.is_empty() {
        return Ok(());
    }
    let beats = fits.iter().map(|fit| fit.beat()).collect();
    let pulses = core.store.beat(beats, core.config.lease).await?;
    for (fit, pulse) in fits.iter().zip(pulses) {
        heed(fit, pulse);
    }
    Ok(())
}

fn heed(fit: &Arc<FitControl>, pulse: Pulse) {
    match pulse {
        Pulse::Held => {}
        Pulse::CancelRequested => fit.stop(Why::Cancelled),
        Pulse::Lost => fit.stop(Why::LeaseLost),
    }
}

async fn sweep_all(core: &Core) -> Result<(), StoreError> {
    let keep = Retention {
        blobs: core.config.result_age,
        records: core.config.record_age,
        keys: core.config.idempotency_age,
    };
    loop {
        let swept = core.store.sweep(keep).await?;
        debug!(?swept, "swept");
        if !swept.is_cut_short() || core.stage() > Stage::Open {
            return Ok(());
        }
    }
}
