//! The one thread that writes, with group commit.
//!
//! Work is a closure over the connection. Whatever is waiting when the writer
//! is free becomes one transaction (each closure in a savepoint of its own, so
//! that one's failure leaves the others), is committed with one fsync, and
//! only then is everybody answered. A lone call waits for nobody; while calls
//! come together, the writer lingers a moment for those still on their way.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rusqlite::Connection;
use tokio::sync::oneshot;
use tracing::{error, warn};

use super::rows::count;
use crate::jobs::error::OpenError;
use crate::jobs::store::{Backlog, StoreError, StoreState};

/// Most closures in one commit: beyond it the gain per fsync is small and the
/// first would wait for the last.
const GROUP: usize = 64;

/// How long the writer lingers for one more while calls come together.
const LINGER_STEP: Duration = Duration::from_micros(500);

/// It lingers at most this often for one commit, 2 ms in all: shorter than an
/// fsync on most disks, so it costs less than it saves.
const LINGER_STEPS: usize = 4;

/// Work that waits for its transaction.
trait Work: Send {
    /// Does it, keeping the answer back. `Err` takes its savepoint back.
    fn run(&mut self, conn: &Connection) -> Result<(), StoreError>;
    /// Gives the answer out, or the reason why the commit did not happen.
    fn answer(self: Box<Self>, committed: Result<(), StoreError>);
}

struct Call<F, T> {
    work: Option<F>,
    done: Option<Result<T, StoreError>>,
    reply: oneshot::Sender<Result<T, StoreError>>,
}

impl<F, T> Work for Call<F, T>
where
    F: FnOnce(&Connection) -> Result<T, StoreError> + Send,
    T: Send,
{
    fn run(&mut self, conn: &Connection) -> Result<(), StoreError> {
        let Some(work) = self.work.take() else {
            return Ok(());
        };
        let done = work(conn);
        let outcome = done.as_ref().map(|_| ()).map_err(Clone::clone);
        self.done = Some(done);
        outcome
    }

    fn answer(self: Box<Self>, committed: Result<(), StoreError>) {
        let answer = match (self.done, committed) {
            (Some(Err(own)), _) => Err(own),
            (_, Err(common)) => Err(common),
            (Some(Ok(value)), Ok(())) => Ok(value),
            (None, Ok(())) => Err(stopped()),
        };
        // Nobody may be waiting any more: a client that hung up.
        let _ = self.reply.send(answer);
    }
}

fn stopped() -> StoreError {
    StoreError::Broken("the writer has stopped".to_owned())
}

/// The writer's side that callers hold. Dropping it ends the thread after the
/// work in hand and closes the connection.
pub(super) struct Writer {
    calls: Option<Sender<Box<dyn Work>>>,
    thread: Option<JoinHandle<()>>,
    shared: Arc<Shared>,
}

/// What the writer tells without being asked.
struct Shared {
    state: Mutex<StoreState>,
    commits: AtomicU64,
    /// Calls taken up, for tests of grouping.
    taken: AtomicU64,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, StoreState> {
        // Plain numbers; no panic can leave them half written.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Writer {
    /// Starts the thread.
    ///
    /// # Errors
    /// `Store` if the backlog cannot be read or the thread not be started.
    pub fn start(conn: Connection) -> Result<Self, OpenError> {
        let backlog = read_backlog(&conn).map_err(|e| OpenError::Store(e.to_string()))?;
        let shared = Arc::new(Shared {
            state: Mutex::new(StoreState {
                backlog,
                writable: true,
            }),
            commits: AtomicU64::new(0),
            taken: AtomicU64::new(0),
        });
        let (calls, inbox) = channel();
        let told = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("mouldloft-store".to_owned())
            .spawn(move || Loop::new(conn, told).run(&inbox))
            .map_err(|e| OpenError::Store(format!("the writer cannot be started: {e}")))?;
        Ok(Writer {
            calls: Some(calls),
            thread: Some(thread),
            shared,
        })
    }

    /// Does `work` in a transaction and returns its answer once that is on
    /// disk. Its effects are taken back if it returns `Err`.
    ///
    /// # Errors
    /// The work's own error, or the commit's.
    pub async fn call<F, T>(&self, work: F) -> Result<T, StoreError>
    where
        F: FnOnce(&Connection) -> Result<T, StoreError> + Send + 'static,
        T: Send + 'static,
    {
        let (reply, answer) = oneshot::channel();
        let call = Box::new(Call {
            work: Some(work),
            done: None,
            reply,
        });
        let calls = self.calls.as_ref().ok_or_else(stopped)?;
        calls.send(call).map_err(|_| stopped())?;
        answer.await.map_err(|_| stopped())?
    }

    /// What is known without asking the disk.
    pub fn state(&self) -> StoreState {
        self.shared.state().clone()
    }

    /// Commits so far, for tests of grouping.
    #[cfg(test)]
    pub fn commits(&self) -> u64 {
        self.shared.commits.load(Ordering::Relaxed)
    }

    /// Calls taken up so far, for tests of grouping.
    #[cfg(test)]
    pub fn taken(&self) -> u64 {
        self.shared.taken.load(Ordering::Relaxed)
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.calls = None;
        if let Some(thread) = self.thread.take() {
            // It only ends by itself; a panic there was logged by the hook.
            let _ = thread.join();
        }
    }
}

/// The thread's own state.
struct Loop {
    conn: Connection,
    shared: Arc<Shared>,
    broken: Option<StoreError>,
}

impl Loop {
    fn new(conn: Connection, shared: Arc<Shared>) -> Self {
        Loop {
            conn,
            shared,
            broken: None,
        }
    }

    fn run(mut self, inbox: &Receiver<Box<dyn Work>>) {
        let mut together = false;
        while let Ok(first) = inbox.recv() {
            let mut group = gather(first, inbox, together);
            together = group.len() > 1;
            self.shared
                .taken
                .fetch_add(group.len() as u64, Ordering::Relaxed);
            let committed = self.commit(&mut group);
            for work in group {
                work.answer(committed.clone());
            }
        }
    }

    /// One transaction over the group; on an error nothing of it happened.
    fn commit(&mut self, group: &mut [Box<dyn Work>]) -> Result<(), StoreError> {
        if let Some(broken) = &self.broken {
            return Err(broken.clone());
        }
        let committed = self.transact(group);
        if let Err(reason) = &committed {
            self.take_back(reason);
        }
        self.tell(&committed);
        committed
    }

    fn transact(&self, group: &mut [Box<dyn Work>]) -> Result<(), StoreError> {
        self.conn.execute_batch("BEGIN IMMEDIATE")?;
        for work in group {
            self.conn.execute_batch("SAVEPOINT one")?;
            if let Err(reason) = work.run(&self.conn) {
                if self.conn.is_autocommit() {
                    // SQLite took the whole transaction back by itself.
                    return Err(reason);
                }
                self.conn.execute_batch("ROLLBACK TO one")?;
                if matches!(reason, StoreError::Full | StoreError::Broken(_)) {
                    return Err(reason);
                }
            }
            self.conn.execute_batch("RELEASE one")?;
        }
        self.conn.execute_batch("COMMIT")?;
        Ok(())
    }

    fn take_back(&mut self, reason: &StoreError) {
        if !self.conn.is_autocommit()
            && let Err(e) = self.conn.execute_batch("ROLLBACK")
        {
            self.broken = Some(StoreError::Broken(format!("rollback: {e}")));
        }
        match reason {
            StoreError::Broken(_) => {
                error!(%reason, "the job store broke: no more writes");
                self.broken = Some(reason.clone());
            }
            _ => warn!(%reason, "a commit did not happen"),
        }
    }

    fn tell(&self, committed: &Result<(), StoreError>) {
        let backlog = committed.is_ok().then(|| read_backlog(&self.conn));
        let mut state = self.shared.state();
        state.writable = committed.is_ok();
        if let Some(Ok(backlog)) = backlog {
            state.backlog = backlog;
        }
        self.shared.commits.fetch_add(1, Ordering::Relaxed);
    }
}

/// What waits already, and, while calls come `together`, what comes soon.
fn gather(
    first: Box<dyn Work>,
    inbox: &Receiver<Box<dyn Work>>,
    together: bool,
) -> Vec<Box<dyn Work>> {
    let mut group = vec![first];
    let mut lingers = if together { LINGER_STEPS } else { 0 };
    while group.len() < GROUP {
        if let Ok(work) = inbox.try_recv() {
            group.push(work);
        } else if lingers > 0
            && let Ok(work) = inbox.recv_timeout(LINGER_STEP)
        {
            lingers -= 1;
            group.push(work);
        } else {
            break;
        }
    }
    group
}

fn read_backlog(conn: &Connection) -> rusqlite::Result<Backlog> {
    conn.prepare_cached("SELECT queued, queued_bytes, running FROM backlog")?
        .query_row([], |row| {
            Ok(Backlog {
                queued: count(row, "queued")?,
                queued_bytes: count(row, "queued_bytes")?,
                running: count(row, "running")?,
            })
        })
}
