//! What only SQLite can do wrong: grouping, reopening, crashes, locks, a full
//! disk, a broken one. The contract of every store is in
//! `tests/store_contract.rs`.

use std::fs;
use std::sync::mpsc;

use super::*;
use crate::jobs::clock::SystemClock;
use crate::jobs::model::Status;
use crate::jobs::store::shared::words;

const LEASE: Duration = Duration::from_secs(30);
const ROOMY: Limits = Limits {
    jobs: 1000,
    bytes: 1_000_000_000,
    idempotency_age: LEASE,
};

fn open(folder: &Path) -> SqliteStore {
    SqliteStore::open(folder, Arc::new(SystemClock::new())).unwrap()
}

fn new_job(input: impl Into<Bytes>) -> NewJob {
    NewJob {
        method: "hull_plates".to_owned(),
        label: None,
        input: input.into(),
        input_sha256: String::new(),
        budget: LEASE,
        idempotency: None,
        engine_version: "0.1.0".to_owned(),
        warnings: Vec::new(),
    }
}

async fn accept(store: &SqliteStore, input: impl Into<Bytes>) -> Result<Job, StoreError> {
    let admission = store
        .accept(&Tenant::local(), new_job(input), ROOMY)
        .await?;
    match admission {
        Admission::New(job) => Ok(job),
        other => panic!("{other:?}"),
    }
}

/// Holds the writer up until the returned end is dropped.
fn hold(store: &SqliteStore) -> (mpsc::Sender<()>, impl Future<Output = ()> + '_) {
    let (release, held) = mpsc::channel::<()>();
    let held = store.writer.call(move |_| {
        let _ = held.recv();
        Ok(())
    });
    (release, async move { held.await.unwrap() })
}

#[tokio::test]
async fn calls_that_come_together_share_a_commit() {
    let folder = tempfile::tempdir().unwrap();
    let store = Arc::new(open(folder.path()));
    let (release, held) = hold(&store);
    // The first poll sends the call; the writer takes it up and is held.
    let mut held = Box::pin(held);
    tokio::select! { biased; () = &mut held => panic!("not held"), () = std::future::ready(()) => {} }
    while store.writer.taken() == 0 {
        tokio::task::yield_now().await;
    }
    let before = store.writer.commits();
    let mut calls: Vec<_> = (0..100)
        .map(|n| {
            Box::pin(store.writer.call(move |conn| {
                conn.execute("UPDATE backlog SET probes = ?1", [n])?;
                Ok(n)
            }))
        })
        .collect();
    for call in &mut calls {
        tokio::select! { biased; _ = call => panic!("not held"), () = std::future::ready(()) => {} }
    }
    drop(release);
    held.await;
    for (n, call) in calls.into_iter().enumerate() {
        assert_eq!(call.await.unwrap(), n as i64);
    }
    // The held one, then 64, then the rest.
    assert_eq!(store.writer.commits() - before, 3);
}

#[tokio::test]
async fn a_refused_call_leaves_its_neighbours_alone() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let (good, bad) = tokio::join!(
        accept(&store, "good"),
        store.writer.call(|conn| {
            conn.execute("DELETE FROM jobs", [])?;
            conn.execute("UPDATE backlog SET running = -1", [])?;
            Ok(())
        })
    );
    assert!(matches!(bad, Err(StoreError::Defect(_))), "{bad:?}");
    let id = good.unwrap().id;
    assert!(store.get(&Tenant::local(), id).await.unwrap().is_some());
    accept(&store, "next").await.unwrap();
}

#[tokio::test]
async fn jobs_outlive_the_process() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let job = accept(&store, "{}").await.unwrap();
    drop(store);
    let store = open(folder.path());
    let found = store.get(&Tenant::local(), job.id).await.unwrap();
    assert_eq!(found, Some(job));
    assert_eq!(store.state().backlog.queued, 1);
}

#[tokio::test]
async fn what_a_call_returned_is_in_the_files() {
    let (folder, copy) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let store = open(folder.path());
    let job = accept(&store, "{}").await.unwrap();
    store.claim(&Owner("a".into()), 1, LEASE).await.unwrap();
    // What a crash leaves: the files as they are, nothing closed.
    for file in fs::read_dir(folder.path()).unwrap() {
        let file = file.unwrap();
        if !file.file_name().to_string_lossy().ends_with("-shm") {
            fs::copy(file.path(), copy.path().join(file.file_name())).unwrap();
        }
    }
    let after = open(copy.path());
    let recovered = after.void_leases(3).await.unwrap();
    assert_eq!(recovered.len(), 1);
    assert_eq!(recovered[0].id, job.id);
    assert_eq!(recovered[0].status, Status::Accepted);
    assert_eq!(recovered[0].message, words::AGAIN);
}

#[tokio::test]
async fn somebody_elses_lock_is_told_and_passes() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let job = accept(&store, "{}").await.unwrap();
    let other = rusqlite::Connection::open(store.folder.file()).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    let refused = accept(&store, "{}").await;
    assert!(matches!(refused, Err(StoreError::Busy(_))), "{refused:?}");
    assert!(!store.state().writable);
    let read = store.get(&Tenant::local(), job.id).await.unwrap();
    assert_eq!(read, Some(job));
    other.execute_batch("ROLLBACK").unwrap();
    accept(&store, "{}").await.unwrap();
    assert!(store.state().writable);
}

#[tokio::test]
async fn a_full_disk_is_told_and_passes() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let job = accept(&store, "{}").await.unwrap();
    let limit_pages = |pages: i64| {
        store.writer.call(move |conn| {
            conn.query_row(&format!("PRAGMA max_page_count = {pages}"), [], |_| Ok(()))?;
            Ok(())
        })
    };
    limit_pages(1).await.unwrap();
    // No pattern that zstd could use.
    let mut state = 1_u64;
    let noise: Vec<u8> = std::iter::repeat_with(|| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 56) as u8
    })
    .take(1_000_000)
    .collect();
    let refused = accept(&store, noise.clone()).await;
    assert_eq!(refused, Err(StoreError::Full));
    let read = store.get(&Tenant::local(), job.id).await.unwrap();
    assert_eq!(read, Some(job));
    limit_pages(1_000_000).await.unwrap();
    accept(&store, noise).await.unwrap();
    assert_eq!(store.state().backlog.queued, 2);
}

#[tokio::test]
async fn a_broken_disk_ends_all_writing() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let job = accept(&store, "{}").await.unwrap();
    let broke = || Err::<(), _>(StoreError::Broken("fsync: input/output error".into()));
    assert!(store.writer.call(move |_| broke()).await.is_err());
    let refused = accept(&store, "{}").await;
    assert!(matches!(refused, Err(StoreError::Broken(_))), "{refused:?}");
    assert!(!store.state().writable);
    assert!(store.get(&Tenant::local(), job.id).await.unwrap().is_some());
}

#[tokio::test]
async fn every_commit_reaches_the_disk() {
    let folder = tempfile::tempdir().unwrap();
    let store = open(folder.path());
    let settings = store.writer.call(|conn| {
        let of = |name: &str| -> Result<i64, StoreError> {
            Ok(conn.query_row(&format!("PRAGMA {name}"), [], |row| row.get(0))?)
        };
        Ok((of("synchronous")?, of("foreign_keys")?, of("auto_vacuum")?))
    });
    const FULL: i64 = 2;
    const INCREMENTAL: i64 = 2;
    assert_eq!(settings.await.unwrap(), (FULL, 1, INCREMENTAL));
}
