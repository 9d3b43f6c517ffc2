//! The fits of this process, by job: what `get` shows at once, what the beat
//! writes, whom a cancel reaches.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::control::{FitControl, Why};
use super::model::{Job, JobId, Status};

/// The table.
#[derive(Default)]
pub(super) struct Live {
    fits: Mutex<HashMap<JobId, Arc<FitControl>>>,
}

impl Live {
    /// A fit begins.
    pub fn insert(&self, control: &Arc<FitControl>) {
        self.lock().insert(control.fence().id, Arc::clone(control));
    }

    /// A fit is over; a later attempt of the same job stays.
    pub fn remove(&self, control: &Arc<FitControl>) {
        let mut fits = self.lock();
        let id = control.fence().id;
        if fits.get(&id).is_some_and(|held| Arc::ptr_eq(held, control)) {
            fits.remove(&id);
        }
    }

    /// Tells a fit to stop, if it is one of ours.
    pub fn stop(&self, id: JobId, why: Why) {
        if let Some(control) = self.lock().get(&id) {
            control.stop(why);
        }
    }

    /// Every fit.
    pub fn all(&self) -> Vec<Arc<FitControl>> {
        self.lock().values().cloned().collect()
    }

    /// Shows the latest progress in a job read from the store.
    pub fn overlay(&self, job: &mut Job) {
        if job.status == Status::Running
            && let Some(control) = self.lock().get(&job.id)
        {
            control.overlay(job);
        }
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<JobId, Arc<FitControl>>> {
        // Inserting and removing leave the map whole even if a thread dies.
        self.fits.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
