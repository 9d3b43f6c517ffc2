//! Submitting, refusing, waiting and watching.

use super::*;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn progress_shows_at_once_and_never_falls() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("steps").await;
    let (queue, me) = (&stage.queue, &stage.me);
    let mut seen = Vec::new();
    let mut last = job;
    while !last.status.is_ended() {
        let known = last.revision;
        let next = queue.wait_change(me, last.id, known, LONG).await.unwrap();
        assert!(next.revision > known, "{known} to {next:?}");
        assert!(next.progress >= last.progress && next.updated >= last.updated);
        // The engine waits after each call: once for a step that shows, and
        // once more for the one that is no number and shows nothing.
        let step = (next.phase.clone(), next.progress);
        if step.1 > 0.0 && next.status == Status::Running {
            stage.strings.go_on();
            if step == ("two".to_owned(), 10.0) {
                stage.strings.go_on();
            }
        }
        seen.push(step);
        last = next;
    }
    for step in [("one", 10.0), ("two", 10.0), ("two", 50.0), ("done", 100.0)] {
        let step = (step.0.to_owned(), step.1);
        assert!(seen.contains(&step), "{step:?} in {seen:?}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn waiting_ends_with_its_time() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let short = Duration::from_millis(5);
    let still = stage.queue.wait_ended(&stage.me, job.id, short).await;
    assert_eq!(still.unwrap().status, Status::Running);
    let revision = stage.get(job.id).await.revision;
    let same = stage.queue.wait_change(&stage.me, job.id, revision, short);
    assert_eq!(same.await.unwrap().revision, revision);
    let not_ready = stage.queue.result(&stage.me, job.id).await;
    assert!(matches!(not_ready, Err(QueueError::NotReady(_))));
    stage.strings.go_on();
    let ended = stage.end_of(job.id).await;
    let at_once = stage
        .queue
        .wait_change(&stage.me, job.id, ended.revision, LONG);
    assert_eq!(at_once.await.unwrap(), ended);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_crowd_is_woken_by_one_end() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let waiting: Vec<_> = (0..300)
        .map(|_| {
            let (queue, me) = (stage.queue.clone(), stage.me.clone());
            tokio::spawn(async move { queue.wait_ended(&me, job.id, LONG).await })
        })
        .collect();
    stage.strings.go_on();
    for waiter in waiting {
        assert_eq!(waiter.await.unwrap().unwrap().status, Status::Successful);
    }
    assert_eq!(stage.queue.core.hub.watched(), 0, "nothing is left behind");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nobody_hears_of_the_jobs_of_others() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let other = Tenant::new("other");
    let (queue, id) = (&stage.queue, job.id);
    let missing = Err(QueueError::NotFound);
    assert_eq!(queue.get(&other, id).await, missing);
    assert_eq!(queue.wait_ended(&other, id, LONG).await, missing);
    assert_eq!(queue.cancel(&other, id).await, missing);
    assert_eq!(queue.delete(&other, id).await, Err(QueueError::NotFound));
    assert_eq!(queue.input(&other, id).await, Err(QueueError::NotFound));
    assert_eq!(stage.get(id).await.status, Status::Running);
    stage.strings.go_on();
    assert_eq!(stage.end_of(id).await.status, Status::Successful);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_full_queue_refuses_but_replays() {
    let stage = Stage::set(QueueConfig {
        max_queued: 1,
        ..config()
    })
    .await;
    let running = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let waiting = stage.submit_with(keyed("echo", "k")).await;
    let refused = stage.queue.submit(&stage.me, keyed("echo", "l")).await;
    let Err(QueueError::QueueFull { retry_after }) = refused else {
        panic!("{refused:?}");
    };
    assert!(retry_after >= Duration::from_secs(1));
    let known = stage.queue.submit(&stage.me, keyed("echo", "k")).await;
    assert_eq!(known, Ok(Accepted::Replayed(stage.get(waiting.id).await)));
    let mut other_body = keyed("echo", "k");
    other_body.idempotency.as_mut().unwrap().body_sha256 = "other".to_owned();
    let conflict = stage.queue.submit(&stage.me, other_body).await;
    assert_eq!(conflict, Err(QueueError::IdempotencyConflict));
    stage.strings.go_on();
    stage.end_of(running.id).await;
    stage.end_of(waiting.id).await;
    assert_eq!(stage.run("echo").await.status, Status::Successful);
    let stats = stage.queue.stats();
    assert_eq!((stats.rejected, stats.replayed), (1, 1));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_nearly_full_disk_refuses() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::set(QueueConfig {
        data_dir: Some(folder.path().to_owned()),
        min_free_bytes: u64::MAX,
        ..config()
    })
    .await;
    let refused = stage.queue.submit(&stage.me, new_job("echo", "")).await;
    if cfg!(unix) {
        assert!(matches!(refused, Err(QueueError::StorageFull { .. })));
        let health = stage.queue.health().await;
        assert!(health.disk_nearly_full && health.reasons().len() == 1);
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn without_workers_jobs_wait() {
    let stage = Stage::set(QueueConfig {
        workers: 0,
        ..config()
    })
    .await;
    let (first, second) = (stage.submit("echo").await, stage.submit("echo").await);
    assert_eq!(second.queue_position, Some(2));
    let short = Duration::from_millis(5);
    let still = stage.queue.wait_ended(&stage.me, first.id, short).await;
    assert_eq!(still.unwrap().status, Status::Accepted);
    let health = stage.queue.health().await;
    assert_eq!(health.reasons(), Vec::<String>::new());
    assert_eq!((health.accepted, health.last_worker_beat_age), (2, None));
    let page = stage
        .queue
        .list(&stage.me, ListQuery::default())
        .await
        .unwrap();
    assert_eq!((page.items.len(), page.next_cursor.is_some()), (1, true));
    let bad = ListQuery {
        cursor: Some("?".to_owned()),
        ..ListQuery::default()
    };
    let refused = stage.queue.list(&stage.me, bad).await;
    assert_eq!(refused, Err(QueueError::InvalidCursor));
}
