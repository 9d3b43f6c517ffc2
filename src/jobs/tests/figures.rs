//! Figures of the queue itself, printed. Run by hand on a quiet machine:
//! `cargo test --release --lib jobs::tests::figures -- --ignored --nocapture`.

use super::*;

/// Measures by the queue's own clock, as nothing else here reads one.
#[derive(Clone, Copy)]
struct Stopwatch(SystemClock);

impl Stopwatch {
    fn start() -> Self {
        Stopwatch(SystemClock::new())
    }

    fn seconds(&self) -> f64 {
        self.0.monotonic().as_secs_f64()
    }

    fn ms(&self) -> f64 {
        self.seconds() * 1000.0
    }
}

/// The value below which a share of the sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len() - 1;
    sorted[(share * last as f64).round() as usize]
}

fn print(what: &str, mut ms: Vec<f64>) -> f64 {
    ms.sort_unstable_by(f64::total_cmp);
    let of = |share| quantile(&ms, share);
    println!("{what}: p50 {:.1} ms, p99 {:.1} ms", of(0.5), of(0.99));
    of(0.99)
}

fn fsyncs_a_second(folder: &std::path::Path) -> f64 {
    use std::io::Write;
    let mut file = std::fs::File::create(folder.join("fsync")).unwrap();
    let begun = Stopwatch::start();
    const TIMES: u32 = 200;
    for _ in 0..TIMES {
        file.write_all(&[7; 4096]).unwrap();
        file.sync_data().unwrap();
    }
    f64::from(TIMES) / begun.seconds()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn small_jobs_end_to_end() {
    let folder = tempfile::tempdir().unwrap();
    println!("{:.0} fsync/s", fsyncs_a_second(folder.path()));
    let stage = Stage::set(QueueConfig {
        data_dir: Some(folder.path().to_owned()),
        ..config()
    })
    .await;
    let mut overhead = Vec::new();
    for _ in 0..300 {
        let job = stage.run("echo").await;
        let held = job.finished.unwrap().millis_since(job.created) as f64;
        overhead.push(held - job.solve_ms.unwrap());
    }
    assert!(print("one at a time, accept to end less solve", overhead) <= 50.0);

    let begun = Stopwatch::start();
    let mut ids = Vec::new();
    for _ in 0..300 {
        ids.push(stage.submit("echo").await.id);
    }
    for id in ids {
        stage.end_of(id).await;
    }
    println!("{:.0} jobs/s", 300.0 / begun.seconds());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn accepting_from_64_callers() {
    let folder = tempfile::tempdir().unwrap();
    println!("{:.0} fsync/s", fsyncs_a_second(folder.path()));
    let stage = Stage::set(QueueConfig {
        data_dir: Some(folder.path().to_owned()),
        workers: 0,
        max_queued: 100_000,
        ..config()
    })
    .await;
    let body: String = (0..5_000).map(|n| format!("{n},")).collect();
    let begun = Stopwatch::start();
    let callers: Vec<_> = (0..64)
        .map(|_| {
            let (queue, me) = (stage.queue.clone(), stage.me.clone());
            let new = new_job("echo", &body);
            tokio::spawn(async move {
                let mut ms = Vec::new();
                for _ in 0..40 {
                    let begun = Stopwatch::start();
                    queue.submit(&me, new.clone()).await.unwrap();
                    ms.push(begun.ms());
                }
                ms
            })
        })
        .collect();
    let mut ms = Vec::new();
    for caller in callers {
        ms.extend(caller.await.unwrap());
    }
    let rate = ms.len() as f64 / begun.seconds();
    println!("{rate:.0} jobs/s of {} bytes", body.len());
    print("accept", ms);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn a_thousand_waiters_wake() {
    let stage = Stage::set(config()).await;
    let job = stage.submit("when-told").await;
    stage.strings.wait_begun();
    let watch = Stopwatch::start();
    let waiting: Vec<_> = (0..1000)
        .map(|_| {
            let (queue, me) = (stage.queue.clone(), stage.me.clone());
            tokio::spawn(async move {
                queue.wait_ended(&me, job.id, LONG).await.unwrap();
                watch.ms()
            })
        })
        .collect();
    while stage.queue.core.hub.watches() < 1000 {
        tokio::task::yield_now().await;
    }
    let ended = watch.ms();
    stage.strings.go_on();
    let mut ms = Vec::new();
    for waiter in waiting {
        ms.push(waiter.await.unwrap() - ended);
    }
    print("woken", ms);
}
