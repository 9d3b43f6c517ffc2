//! How the queue is, and whether that is good enough to be sent work.

use std::time::Duration;

/// How the queue is.
#[derive(Debug, Clone, PartialEq)]
pub struct Health {
    /// A write went through just now.
    pub store_writable: bool,
    /// Free space where the data are, in bytes; none if unknown or in memory.
    pub disk_free_bytes: Option<u64>,
    /// Too little free space to accept jobs.
    pub disk_nearly_full: bool,
    /// Time since a worker last showed life; none without workers.
    pub last_worker_beat_age: Option<Duration>,
    /// Going down: nothing is accepted or begun.
    pub draining: bool,
    /// Jobs that wait.
    pub accepted: u64,
    /// Jobs that run.
    pub running: u64,
    /// Fits of this process that were told to stop and have not.
    pub stuck: u64,
    /// Threads for fits in this process.
    pub workers: usize,
    /// The version of the SQLite library; none for the store in memory.
    pub sqlite_version: Option<String>,
}

impl Health {
    /// Longer than this without a worker's beat and the service is not ready.
    pub const MAX_BEAT_AGE: Duration = Duration::from_secs(15);

    /// Why the service is not ready, in sentences; empty if it is.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        let mut reasons = Vec::new();
        if !self.store_writable {
            reasons.push("the job store cannot be written".to_owned());
        }
        if self.disk_nearly_full {
            let free = self.disk_free_bytes.unwrap_or(0) / 1_000_000;
            reasons.push(format!("the disk is nearly full: {free} MB free"));
        }
        if let Some(age) = self.last_worker_beat_age
            && age > Health::MAX_BEAT_AGE
        {
            reasons.push(format!("no worker beat for {} s", age.as_secs()));
        }
        if self.draining {
            reasons.push("the service is going down".to_owned());
        }
        reasons
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn well() -> Health {
        Health {
            store_writable: true,
            disk_free_bytes: Some(5_000_000_000),
            disk_nearly_full: false,
            last_worker_beat_age: Some(Health::MAX_BEAT_AGE),
            draining: false,
            accepted: 3,
            running: 1,
            stuck: 0,
            workers: 1,
            sqlite_version: None,
        }
    }

    #[test]
    fn a_healthy_queue_has_no_reasons() {
        assert_eq!(well().reasons(), Vec::<String>::new());
    }

    #[test]
    fn every_trouble_is_a_reason_of_its_own() {
        let ill = Health {
            store_writable: false,
            disk_free_bytes: Some(42_000_000),
            disk_nearly_full: true,
            last_worker_beat_age: Some(Duration::from_secs(16)),
            draining: true,
            ..well()
        };
        let reasons = ill.reasons();
        assert_eq!(reasons.len(), 4);
        assert!(reasons[1].contains("42 MB") && reasons[2].contains("16 s"));
    }
}
