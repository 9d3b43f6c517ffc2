//! Wakes those who wait for a job: one channel a watched job, made by the
//! first who watches and dropped with the last. A thousand waiting calls cost
//! a thousand wake-ups and no reading of the store until something happens.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use super::model::{Job, JobId};

/// What a watcher hears.
#[derive(Debug, Clone, Default)]
pub(super) enum News {
    /// Nothing yet, or something changed: look.
    #[default]
    Look,
    /// It ended like this.
    Ended(Arc<Job>),
    /// It was deleted.
    Deleted,
}

struct Channel {
    news: watch::Sender<News>,
    watches: usize,
}

type Channels = Arc<Mutex<HashMap<JobId, Channel>>>;

/// The channels.
#[derive(Default)]
pub(super) struct Hub {
    channels: Channels,
}

/// A watch on one job.
pub(super) struct Watch {
    id: JobId,
    news: watch::Receiver<News>,
    channels: Channels,
}

impl Hub {
    /// Watches a job from now on. Watch first and read then: nothing is missed.
    pub fn watch(&self, id: JobId) -> Watch {
        let mut channels = lock(&self.channels);
        let channel = channels.entry(id).or_insert_with(|| Channel {
            news: watch::channel(News::Look).0,
            watches: 0,
        });
        channel.watches += 1;
        Watch {
            id,
            news: channel.news.subscribe(),
            channels: Arc::clone(&self.channels),
        }
    }

    /// Something about the job changed.
    pub fn changed(&self, id: JobId) {
        self.tell(id, News::Look);
    }

    /// The job ended.
    pub fn ended(&self, job: &Job) {
        self.tell(job.id, News::Ended(Arc::new(job.clone())));
    }

    /// The job was deleted.
    pub fn deleted(&self, id: JobId) {
        self.tell(id, News::Deleted);
    }

    fn tell(&self, id: JobId, news: News) {
        if let Some(channel) = lock(&self.channels).get(&id) {
            channel.news.send_modify(|last| {
                // A late step of progress must not hide the end.
                if matches!(last, News::Look) || matches!(news, News::Deleted) {
                    *last = news;
                }
            });
        }
    }

    /// How many watches there are.
    #[cfg(test)]
    pub fn watches(&self) -> usize {
        lock(&self.channels).values().map(|c| c.watches).sum()
    }

    /// How many jobs are watched.
    #[cfg(test)]
    pub fn watched(&self) -> usize {
        lock(&self.channels).len()
    }
}

impl Watch {
    /// Waits for news since the last call.
    pub async fn news(&mut self) -> News {
        // The sender lives in the map as long as this watch does.
        if self.news.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
        self.news.borrow_and_update().clone()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let mut channels = lock(&self.channels);
        if let Some(channel) = channels.get_mut(&self.id) {
            channel.watches -= 1;
            if channel.watches == 0 {
                channels.remove(&self.id);
            }
        }
    }
}

fn lock(channels: &Channels) -> MutexGuard<'_, HashMap<JobId, Channel>> {
    // Inserting and removing leave the map whole even if a thread dies.
    channels.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_watch_hears_and_leaves_nothing_behind() {
        let hub = Hub::default();
        let id = JobId::random();
        let (mut one, two) = (hub.watch(id), hub.watch(id));
        hub.deleted(id);
        hub.changed(id);
        assert!(matches!(one.news().await, News::Deleted));
        drop(one);
        assert_eq!(hub.watched(), 1);
        drop(two);
        assert_eq!(hub.watched(), 0);
    }
}
