//! Starting the queue and going down.

use std::sync::Arc;
use std::time::Duration;

use tokio_util::task::TaskTracker;
use tracing::{info, warn};

use super::clock::Clock;
use super::config::QueueConfig;
use super::control::Why;
use super::core::{Core, Parts, Stage};
use super::engine::Engine;
use super::error::OpenError;
use super::meter::Meter;
use super::store::Store;
use super::store::memory::MemoryStore;
use super::store::sqlite::SqliteStore;
use super::{keeper, pool, worker};

/// The tasks of an open queue. Dropping it stops them.
pub(super) struct Running {
    /// The dispatcher.
    dispatcher: TaskTracker,
    /// The keeper.
    keeper: TaskTracker,
    /// One task a fit.
    fits: TaskTracker,
    core: Arc<Core>,
}

/// Opens the store, recovers, and starts the tasks.
///
/// # Errors
/// See [`OpenError`].
pub(super) async fn start(
    config: QueueConfig,
    engine: Arc<dyn Engine>,
    meter: Arc<dyn Meter>,
    clock: Arc<dyn Clock>,
) -> Result<(Arc<Core>, Running), OpenError> {
    let store = open_store(&config, &clock).await?;
    let recovered = store.void_leases(config.max_lost_leases).await;
    let recovered = recovered.map_err(|e| OpenError::Store(e.to_string()))?;
    if !recovered.is_empty() {
        info!(
            jobs = recovered.len(),
            "jobs of a previous process recovered"
        );
    }
    let core = Arc::new(Core::new(Parts {
        config,
        store,
        engine,
        meter,
        clock,
    }));
    let running = Running {
        dispatcher: TaskTracker::new(),
        keeper: TaskTracker::new(),
        fits: TaskTracker::new(),
        core: Arc::clone(&core),
    };
    if core.config.workers > 0 {
        let pool = Arc::new(pool::build(core.config.workers)?);
        let dispatch = worker::dispatch(Arc::clone(&core), pool, running.fits.clone());
        running.dispatcher.spawn(dispatch);
    }
    running.keeper.spawn(keeper::keep(Arc::clone(&core)));
    Ok((core, running))
}

async fn open_store(
    config: &QueueConfig,
    clock: &Arc<dyn Clock>,
) -> Result<Arc<dyn Store>, OpenError> {
    let clock = Arc::clone(clock);
    let Some(folder) = config.data_dir.clone() else {
        return Ok(Arc::new(MemoryStore::new(clock)));
    };
    let opened = tokio::task::spawn_blocking(move || SqliteStore::open(&folder, clock)).await;
    let store = opened.map_err(|e| OpenError::Store(e.to_string()))??;
    Ok(Arc::new(store))
}

impl Running {
    /// See [`super::Queue::drain`].
    pub async fn drain(&self, core: &Core, grace: Duration) {
        core.stage.send_if_modified(|stage| {
            let open = *stage == Stage::Open;
            if open {
                *stage = Stage::Draining;
            }
            open
        });
        // A claim in hand ends first: what it brought is given back.
        self.dispatcher.close();
        self.dispatcher.wait().await;
        self.fits.close();
        if tokio::time::timeout(grace, self.fits.wait()).await.is_err() {
            self.stop_fits(core).await;
        }
        core.stage.send_replace(Stage::Closed);
        self.keeper.close();
        self.keeper.wait().await;
    }

    /// Stops what did not end by itself, and gives back what does not stop.
    async fn stop_fits(&self, core: &Core) {
        for fit in core.live.all() {
            fit.stop(Why::GivenBack);
        }
        let stopped = tokio::time::timeout(core.config.stop_grace, self.fits.wait());
        if stopped.await.is_ok() {
            return;
        }
        let fences = core.live.all().iter().map(|f| f.fence().clone()).collect();
        match core.store.release(fences).await {
            Ok(changed) => changed.iter().for_each(|job| core.announce(job)),
            Err(error) => warn!(%error, "jobs were not given back; the next start recovers them"),
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.core.stage.send_replace(Stage::Closed);
        for fit in self.core.live.all() {
            fit.stop(Why::GivenBack);
        }
    }
}
