//! What every store promises, run on SQLite and on the model in memory.
//!
//! Each contract is a function of a rig; the macro at the end runs it on each
//! store. Time is a clock that stands until a test moves it.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

mod accepting;
mod leasing;
mod owning;
mod rig;

macro_rules! contracts {
    ($($group:ident: $($name:ident),* $(,)?;)*) => {
        mod memory {
            $($(#[tokio::test] async fn $name() {
                crate::$group::$name(crate::rig::Rig::memory()).await
            })*)*
        }
        mod sqlite {
            $($(#[tokio::test] async fn $name() {
                crate::$group::$name(crate::rig::Rig::sqlite()).await
            })*)*
        }
    };
}

contracts! {
    accepting: an_accepted_job_is_there_with_all_it_was_given, the_same_key_and_body_give_the_same_job, a_key_is_forgotten_in_time_and_with_its_job, limits_turn_away_by_count_and_by_bytes, a_large_input_and_result_come_back_whole;
    owning: nobody_sees_the_jobs_of_others, cancelling_a_waiting_job_dismisses_it, cancelling_a_running_job_is_heard_with_the_beat, a_cancelled_job_whose_worker_is_lost_is_dismissed, deleting_erases_whatever_the_state, a_list_is_newest_first_and_complete, a_list_keeps_to_its_filters, what_is_past_its_time_is_erased, a_sweep_does_a_bounded_amount;
    leasing: claims_go_by_the_order_of_acceptance, a_success_keeps_everything, a_failure_keeps_its_reason_and_diagnostics, an_end_is_final, a_stale_worker_changes_nothing, a_beat_keeps_the_lease_and_carries_progress, a_lost_lease_is_another_attempt_and_the_third_fails, voiding_takes_every_lease, giving_back_costs_no_attempt, a_revision_rises_with_every_visible_change;
}
