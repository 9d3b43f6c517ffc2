//! What the stores have in common: revisions, and the words they write.

use crate::jobs::model::Failure;

/// Bits of a revision that count progress within one state; the bits above
/// count changes of state. 2²⁰ steps are more than any fit shows (it shows one
/// a percent and one a phase), 2⁴³ changes more than any job sees.
const REVISION_TICK_BITS: u32 = 20;

/// The revision of a job: changes of state first, then what moves within one:
/// steps of progress while it runs, places gained while it waits (`position`
/// falls, so its complement rises).
pub(crate) fn revision(transitions: u64, ticks: u64, position: Option<u64>) -> u64 {
    let top = (1 << REVISION_TICK_BITS) - 1;
    let low = match position {
        Some(position) => top - position.min(top),
        None => ticks.min(top),
    };
    (transitions << REVISION_TICK_BITS) | low
}

/// The revision of a running job whose progress is known better than the row
/// that `revision` was read from.
pub(crate) fn with_ticks(row_revision: u64, ticks: u64) -> u64 {
    revision(row_revision >> REVISION_TICK_BITS, ticks, None)
}

/// Words that the stores write into jobs, the same in each.
pub(crate) mod words {
    /// Phase of a waiting job.
    pub const QUEUED: &str = "queued";
    /// Phase of a job just taken up.
    pub const STARTING: &str = "starting";
    /// Phase of a successful job.
    pub const DONE: &str = "done";
    /// Message of a waiting job.
    pub const WAITING: &str = "waiting for a worker";
    /// Message of a running job.
    pub const FITTING: &str = "a worker has it";
    /// Message of a running job that somebody wants cancelled.
    pub const CANCELLING: &str = "being cancelled";
    /// Message of a dismissed job.
    pub const CANCELLED: &str = "cancelled";
    /// Message of a job whose worker was lost.
    pub const AGAIN: &str = "its worker was lost; waiting for another";
    /// Failure code of a job that lost too many workers.
    pub const CRASHED: &str = "worker-crashed";
}

/// The failure of a job that lost `lost` workers.
pub(crate) fn crashed(lost: u32) -> Failure {
    Failure {
        code: words::CRASHED.to_owned(),
        detail: format!("the worker that ran this job was lost {lost} times"),
        reference: Some(uuid::Uuid::new_v4()),
        errors_json: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revision_rises_by_state_by_step_and_by_place() {
        let rising = [
            revision(1, 0, Some(u64::MAX)),
            revision(1, 0, Some(7)),
            revision(1, 0, Some(1)),
            revision(2, 0, None),
            with_ticks(revision(2, 0, None), 1),
            revision(2, 2, None),
            revision(2, u64::MAX, None),
            revision(3, 0, None),
        ];
        assert!(rising.is_sorted_by(|a, b| a < b), "{rising:?}");
    }
}
