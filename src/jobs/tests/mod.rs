//! The queue as a whole, with engines that do as a test says.
//!
//! No test sleeps to let something happen: engines tell through channels that
//! they have begun and wait to be told to go on, and the queue's own waiting
//! calls tell the rest.

mod ends;
mod figures;
mod going_down;
mod watching;

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::Bytes;

use super::clock::{Clock, ManualClock, SystemClock};
use super::*;
use crate::methods::Control;

/// Far longer than anything here takes: a test that reaches it has failed.
const LONG: Duration = Duration::from_secs(30);

/// An engine whose method names say what it does.
struct Puppet {
    begun: Mutex<Sender<String>>,
    go_on: Mutex<Receiver<()>>,
}

/// The test's ends of a [`Puppet`]'s channels.
struct Strings {
    begun: Receiver<String>,
    go_on: Sender<()>,
}

impl Strings {
    /// Waits until an engine has begun; its input.
    fn wait_begun(&self) -> String {
        self.begun.recv_timeout(LONG).unwrap()
    }

    /// Lets an engine that waits go on.
    fn go_on(&self) {
        self.go_on.send(()).unwrap();
    }
}

fn puppet() -> (Arc<Puppet>, Strings) {
    let ((begin, begun), (go, go_on)) = (channel(), channel());
    let puppet = Puppet {
        begun: Mutex::new(begin),
        go_on: Mutex::new(go_on),
    };
    let strings = Strings { begun, go_on: go };
    (Arc::new(puppet), strings)
}

impl Puppet {
    fn tell(&self, input: &[u8]) {
        let text = String::from_utf8_lossy(input).into_owned();
        // Tests that do not care have dropped their end.
        let _ = self.begun.lock().unwrap().send(text);
    }

    fn wait(&self) {
        let _ = self.go_on.lock().unwrap().recv_timeout(LONG);
    }
}

impl Engine for Puppet {
    fn run(
        &self,
        method: &str,
        input: &[u8],
        control: &dyn Control,
    ) -> Result<Product, EngineError> {
        self.tell(input);
        match method {
            "echo" => {}
            "when-told" => self.wait(),
            "deaf" => {
                self.wait();
                control.check().map_err(EngineError::Stopped)?;
            }
            "until-stopped" => loop {
                control.check().map_err(EngineError::Stopped)?;
                std::thread::yield_now();
            },
            "steps" => {
                for (phase, percent) in [
                    ("one", 10.0),
                    ("two", 5.0),
                    ("two", f64::NAN),
                    ("two", 50.0),
                ] {
                    control.progress(phase, percent);
                    self.wait();
                }
            }
            "panic" => panic!("a plate of {} bytes", input.len()),
            "invalid" => {
                return Err(EngineError::Invalid {
                    detail: "profiles cross".to_owned(),
                    errors_json: "[1]".to_owned(),
                });
            }
            other => {
                return Err(EngineError::Failed {
                    code: other.to_owned(),
                    detail: "broke down".to_owned(),
                    diagnostics: Some(b"half".to_vec()),
                });
            }
        }
        Ok(Product {
            result: input.to_vec(),
            diagnostics: method.as_bytes().to_vec(),
            verdict: Verdict::WithinLimits,
            warnings: Vec::new(),
            message: "fits".to_owned(),
        })
    }
}

fn config() -> QueueConfig {
    QueueConfig {
        data_dir: None,
        workers: 1,
        min_free_bytes: 0,
        ..QueueConfig::default()
    }
}

fn new_job(method: &str, input: &str) -> NewJob {
    NewJob {
        method: method.to_owned(),
        label: None,
        input: Bytes::copy_from_slice(input.as_bytes()),
        input_sha256: String::new(),
        budget: Duration::from_secs(60),
        idempotency: None,
        engine_version: "0.1.0".to_owned(),
        warnings: Vec::new(),
    }
}

fn keyed(method: &str, key: &str) -> NewJob {
    NewJob {
        idempotency: Some(IdempotencyKey {
            key: key.to_owned(),
            body_sha256: method.to_owned(),
        }),
        ..new_job(method, key)
    }
}

/// A queue, a puppet behind it, and whose jobs they are.
struct Stage {
    queue: Queue,
    strings: Strings,
    me: Tenant,
}

impl Stage {
    async fn set(config: QueueConfig) -> Stage {
        Stage::set_with(config, Arc::new(SystemClock::new())).await
    }

    async fn set_with(config: QueueConfig, clock: Arc<dyn Clock>) -> Stage {
        let (engine, strings) = puppet();
        let queue = Queue::open_with_clock(config, engine, Arc::new(Unmetered), clock);
        Stage {
            queue: queue.await.unwrap(),
            strings,
            me: Tenant::local(),
        }
    }

    async fn submit(&self, method: &str) -> Job {
        self.submit_with(new_job(method, method)).await
    }

    async fn submit_with(&self, new: NewJob) -> Job {
        match self.queue.submit(&self.me, new).await.unwrap() {
            Accepted::New(job) => job,
            Accepted::Replayed(job) => panic!("replayed {job:?}"),
        }
    }

    async fn get(&self, id: JobId) -> Job {
        self.queue.get(&self.me, id).await.unwrap()
    }

    /// The job, which has to end.
    async fn end_of(&self, id: JobId) -> Job {
        let job = self.queue.wait_ended(&self.me, id, LONG).await.unwrap();
        assert!(job.status.is_ended(), "{job:?}");
        job
    }

    async fn run(&self, method: &str) -> Job {
        let job = self.submit(method).await;
        self.end_of(job.id).await
    }
}
