//! Every way in which a job can end, and that the next one is fine.

use super::*;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_good_job_ends_well_on_both_stores() {
    let folder = tempfile::tempdir().unwrap();
    for data_dir in [None, Some(folder.path().to_owned())] {
        let stage = Stage::set(QueueConfig {
            data_dir,
            ..config()
        })
        .await;
        let job = stage.run("echo").await;
        assert_eq!(job.status, Status::Successful);
        assert_eq!((job.attempt, job.progress), (1, 100.0));
        assert_eq!(job, stage.get(job.id).await);
        let (queue, me) = (&stage.queue, &stage.me);
        assert_eq!(queue.result(me, job.id).await.unwrap(), "echo");
        assert_eq!(queue.input(me, job.id).await.unwrap(), "echo");
        let diagnostics = queue.diagnostics(me, job.id).await.unwrap();
        assert_eq!(diagnostics.unwrap(), "echo");
        let stats = queue.stats();
        assert_eq!((stats.accepted, stats.successful, stats.queued), (1, 1, 0));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_failure_of_the_engine_is_kept_with_its_diagnostics() {
    let stage = Stage::set(config()).await;
    let job = stage.run("no-pivot").await;
    let failure = job.failure.as_ref().unwrap();
    assert_eq!(
        (job.status, failure.code.as_str()),
        (Status::Failed, "no-pivot")
    );
    let diagnostics = stage.queue.diagnostics(&stage.me, job.id).await.unwrap();
    assert_eq!(diagnostics.unwrap(), "half");
    let result = stage.queue.result(&stage.me, job.id).await;
    assert_eq!(result, Err(QueueError::Failed(Box::new(job))));

    let job = stage.run("invalid").await;
    let failure = job.failure.unwrap();
    assert_eq!(failure.code, "invalid-input");
    assert_eq!(failure.errors_json.as_deref(), Some("[1]"));
    assert_eq!(job.attempt, 1, "never tried again");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_hundred_panics_harm_nobody() {
    let stage = Stage::set(config()).await;
    for _ in 0..100 {
        let job = stage.run("panic").await;
        let failure = job.failure.unwrap();
        assert_eq!(failure.code, "worker-panic");
        let reference = failure.reference.unwrap().to_string();
        assert!(failure.detail.contains(&reference));
        assert!(!failure.detail.contains("bytes"), "no inside shows");
    }
    assert_eq!(stage.run("echo").await.status, Status::Successful);
    assert_eq!(stage.queue.stats().panics, 100);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_cancelled_fit_frees_its_core() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("until-stopped").await;
    stage.strings.wait_begun();
    let waiting = stage.submit("echo").await;
    let cancelled = stage.queue.cancel(&stage.me, job.id).await.unwrap();
    assert!(cancelled.status == Status::Running && cancelled.cancel_requested);
    assert_eq!(stage.end_of(job.id).await.status, Status::Dismissed);
    assert_eq!(stage.end_of(waiting.id).await.status, Status::Successful);
    let again = stage.queue.cancel(&stage.me, job.id).await.unwrap();
    assert_eq!(again.status, Status::Dismissed);
    let result = stage.queue.result(&stage.me, job.id).await;
    assert!(matches!(result, Err(QueueError::Dismissed(_))));
    assert_eq!(stage.queue.stats().dismissed, 1);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_cancelled_waiting_job_never_begins() {
    let stage = Stage::set(config()).await;
    let first = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let second = stage.submit("echo").await;
    let cancelled = stage.queue.cancel(&stage.me, second.id).await.unwrap();
    assert_eq!(cancelled.status, Status::Dismissed);
    stage.strings.go_on();
    stage.end_of(first.id).await;
    assert_eq!(stage.run("echo").await.status, Status::Successful);
    assert_eq!(stage.get(second.id).await.attempt, 0);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn deleting_a_running_job_frees_its_core() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("until-stopped").await;
    stage.strings.wait_begun();
    let (queue, me) = (stage.queue.clone(), stage.me.clone());
    let waiter = tokio::spawn(async move { queue.wait_ended(&me, job.id, LONG).await });
    stage.queue.delete(&stage.me, job.id).await.unwrap();
    assert_eq!(waiter.await.unwrap(), Err(QueueError::NotFound));
    assert_eq!(stage.run("echo").await.status, Status::Successful);
    let again = stage.queue.delete(&stage.me, job.id).await;
    assert_eq!(again, Err(QueueError::NotFound));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_used_up_budget_fails_the_job() {
    let clock = Arc::new(ManualClock::at(Timestamp::from_millis(0)));
    let stage = Stage::set_with(config(), clock.clone()).await;
    let job = stage.submit("until-stopped").await;
    stage.strings.wait_begun();
    clock.advance(Duration::from_secs(59));
    assert_eq!(stage.get(job.id).await.status, Status::Running);
    clock.advance(Duration::from_secs(1));
    let ended = stage.end_of(job.id).await;
    assert_eq!(ended.status, Status::Failed);
    assert_eq!(ended.failure.unwrap().code, "budget-exceeded");
    assert_eq!(ended.solve_ms, Some(60_000.0));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_job_ends_in_time_though_its_fit_is_deaf() {
    let stage = Stage::set(QueueConfig {
        stop_grace: Duration::from_millis(20),
        ..config()
    })
    .await;
    let cancelled = stage.submit("deaf").await;
    stage.strings.wait_begun();
    stage.queue.cancel(&stage.me, cancelled.id).await.unwrap();
    let ended = stage.end_of(cancelled.id).await;
    assert_eq!(ended.status, Status::Dismissed);
    assert_eq!(stage.queue.health().await.stuck, 1);

    let next = stage.submit("echo").await;
    stage.strings.go_on();
    assert_eq!(stage.end_of(next.id).await.status, Status::Successful);

    let mut short = new_job("deaf", "short");
    short.budget = Duration::from_millis(1);
    let short = stage.submit_with(short).await;
    let ended = stage.end_of(short.id).await;
    assert_eq!(ended.failure.unwrap().code, "budget-exceeded");
    stage.strings.go_on();
    assert_eq!(stage.run("echo").await.status, Status::Successful);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_fit_whose_lease_is_lost_is_stopped_and_tried_again() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("until-stopped").await;
    stage.strings.wait_begun();
    // What another process does when this one was asleep.
    let core = &stage.queue.core;
    core.store.void_leases(3).await.unwrap();
    keeper::beat_once(core).await.unwrap();
    stage.strings.wait_begun();
    let again = stage.get(job.id).await;
    assert_eq!((again.status, again.attempt), (Status::Running, 2));
    stage.queue.cancel(&stage.me, job.id).await.unwrap();
    assert_eq!(stage.end_of(job.id).await.status, Status::Dismissed);
}
