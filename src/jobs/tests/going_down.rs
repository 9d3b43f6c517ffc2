//! Draining, crashing and coming back.

use std::fs;
use std::path::Path;

use super::*;

fn on_disk(folder: &Path) -> QueueConfig {
    QueueConfig {
        data_dir: Some(folder.to_owned()),
        ..config()
    }
}

/// What a crash leaves: the files as they are, nothing closed.
fn crash(from: &Path, to: &Path) {
    for file in fs::read_dir(from).unwrap() {
        let file = file.unwrap();
        if !file.file_name().to_string_lossy().ends_with("-shm") {
            fs::copy(file.path(), to.join(file.file_name())).unwrap();
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn after_a_crash_every_job_ends_once() {
    let (folder, left) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let before = Stage::set(on_disk(folder.path())).await;
    let ended = before.run("echo").await;
    let running = before.submit("when-told").await;
    before.strings.wait_begun();
    before.strings.wait_begun();
    let waiting = before.submit_with(keyed("echo", "k")).await;
    crash(folder.path(), left.path());

    let after = Stage::set(on_disk(left.path())).await;
    assert_eq!(after.strings.wait_begun(), "when-told");
    after.strings.go_on();
    let again = after.end_of(running.id).await;
    assert_eq!((again.status, again.attempt), (Status::Successful, 2));
    let waited = after.end_of(waiting.id).await;
    assert_eq!((waited.status, waited.attempt), (Status::Successful, 1));
    assert_eq!(after.get(ended.id).await, ended);
    let replayed = after.queue.submit(&after.me, keyed("echo", "k")).await;
    assert_eq!(replayed, Ok(Accepted::Replayed(waited)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_job_that_crashes_its_worker_three_times_has_failed() {
    let mut folder = tempfile::tempdir().unwrap();
    let mut stage = Stage::set(on_disk(folder.path())).await;
    let job = stage.submit("when-told").await;
    for attempt in 1..=3 {
        stage.strings.wait_begun();
        assert_eq!(stage.get(job.id).await.attempt, attempt);
        let left = tempfile::tempdir().unwrap();
        crash(folder.path(), left.path());
        stage.strings.go_on();
        stage = Stage::set(on_disk(left.path())).await;
        folder = left;
    }
    let failed = stage.get(job.id).await;
    assert_eq!(failed.status, Status::Failed);
    assert_eq!(failed.failure.unwrap().code, "worker-crashed");
    assert_eq!(stage.run("echo").await.status, Status::Successful);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn draining_lets_fits_end_and_begins_none() {
    let stage = Stage::set(config()).await;
    let running = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let waiting = stage.submit("echo").await;
    let wait = |id| {
        let (queue, me) = (stage.queue.clone(), stage.me.clone());
        tokio::spawn(async move { queue.wait_ended(&me, id, LONG).await.unwrap() })
    };
    let (of_running, of_waiting) = (wait(running.id), wait(waiting.id));
    let queue = stage.queue.clone();
    let drain = tokio::spawn(async move { queue.drain(LONG).await });
    stage.queue.draining().await;
    // Who waits for what will not begin is let go at once.
    assert_eq!(of_waiting.await.unwrap().status, Status::Accepted);
    let refused = stage.queue.submit(&stage.me, new_job("echo", "")).await;
    assert!(matches!(refused, Err(QueueError::Draining { .. })));
    assert!(stage.queue.health().await.draining);
    stage.strings.go_on();
    assert_eq!(of_running.await.unwrap().status, Status::Successful);
    drain.await.unwrap();
    assert_eq!(stage.get(waiting.id).await.status, Status::Accepted);
    stage.queue.drain(LONG).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_does_not_end_in_the_grace_is_given_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut id = None;
    // More often than a job may lose its lease: giving back is no loss.
    for attempt in 1..=5 {
        let stage = Stage::set(on_disk(folder.path())).await;
        let id = *id.get_or_insert(match attempt {
            1 => stage.submit("until-stopped").await.id,
            _ => JobId::random(),
        });
        stage.strings.wait_begun();
        assert_eq!(stage.get(id).await.attempt, attempt);
        stage.queue.drain(Duration::from_millis(1)).await;
        let back = stage.get(id).await;
        assert_eq!((back.status, back.failure), (Status::Accepted, None));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_deaf_fit_is_given_back_as_well() {
    let stage = Stage::set(QueueConfig {
        stop_grace: Duration::from_millis(20),
        ..config()
    })
    .await;
    let job = stage.submit("deaf").await;
    stage.strings.wait_begun();
    stage.queue.drain(Duration::from_millis(1)).await;
    assert_eq!(stage.get(job.id).await.status, Status::Accepted);
    stage.strings.go_on();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_folder_has_one_queue() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::set(on_disk(folder.path())).await;
    let (engine, _strings) = puppet();
    let second = Queue::open(on_disk(folder.path()), engine, Arc::new(Unmetered)).await;
    assert!(matches!(second, Err(OpenError::InUse(_))));
    assert_eq!(stage.run("echo").await.status, Status::Successful);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_broken_store_is_told() {
    let stage = Stage::set(config()).await;
    let broken = store::StoreError::Broken("fsync failed".to_owned());
    stage.queue.core.explain(&broken);
    assert_eq!(stage.queue.broken().await, "fsync failed");
    assert!(!stage.queue.health().await.store_writable);
    let refused = stage.queue.submit(&stage.me, new_job("echo", "")).await;
    assert!(matches!(refused, Err(QueueError::Unavailable { .. })));
}
