//! Waiting for a job of the [`Queue`]: one channel a job, whoever waits, and no
//! reading of the store until something happens.

use std::time::Duration;

use super::core::Stage;
use super::error::QueueError;
use super::hub::News;
use super::model::{Job, JobId, Status, Tenant};
use super::queue::Queue;

impl Queue {
    /// The job once it has ended, or as it stands when `timeout` is over or
    /// the service goes down: look at its status.
    ///
    /// # Errors
    /// As [`Queue::get`].
    pub async fn wait_ended(
        &self,
        tenant: &Tenant,
        id: JobId,
        timeout: Duration,
    ) -> Result<Job, QueueError> {
        self.wait(tenant, id, timeout, None).await
    }

    /// The job once its revision is not `known_revision`, or as it stands when
    /// `timeout` is over or the service goes down. An ended job is returned at
    /// once. Moving up in the queue changes the revision but wakes nobody.
    ///
    /// # Errors
    /// As [`Queue::get`].
    pub async fn wait_change(
        &self,
        tenant: &Tenant,
        id: JobId,
        known_revision: u64,
        timeout: Duration,
    ) -> Result<Job, QueueError> {
        self.wait(tenant, id, timeout, Some(known_revision)).await
    }

    /// Waits for an end, or for another revision than the known one. Watches
    /// first and reads then, so nothing is missed in between.
    async fn wait(
        &self,
        tenant: &Tenant,
        id: JobId,
        timeout: Duration,
        known_revision: Option<u64>,
    ) -> Result<Job, QueueError> {
        let mut watch = self.core.hub.watch(id);
        let mut stage = self.core.stage.subscribe();
        let over = tokio::time::sleep(timeout);
        tokio::pin!(over);
        let mut job = self.get(tenant, id).await?;
        loop {
            let changed = known_revision.is_some_and(|known| known != job.revision);
            if changed || job.status.is_ended() || self.is_given_up(&job) {
                return Ok(job);
            }
            tokio::select! {
                news = watch.news() => match news {
                    News::Ended(ended) if ended.tenant == *tenant => return Ok((*ended).clone()),
                    News::Deleted => return Err(QueueError::NotFound),
                    // Steps of progress are nothing to who waits for the end.
                    News::Look if known_revision.is_none() => continue,
                    _ => {}
                },
                // An error means that the queue is gone, which it is not.
                _ = stage.changed() => {}
                () = &mut over => return self.get(tenant, id).await,
            }
            job = self.get(tenant, id).await?;
        }
    }

    /// Nothing more will happen to the job in this process.
    fn is_given_up(&self, job: &Job) -> bool {
        match self.core.stage() {
            Stage::Open => false,
            Stage::Draining => job.status == Status::Accepted,
            Stage::Closed => true,
        }
    }
}
