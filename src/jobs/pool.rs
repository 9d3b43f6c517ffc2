//! The threads that fit: one rayon pool at low priority, so that answering
//! stays quick, with panics logged where they happen.
//!
//! Limits: priority is lowered on Linux alone, where it belongs to a thread;
//! elsewhere it belongs to the process and is left as it is. rayon may run a
//! second fit on a thread whose first one waits for its parallel parts; the
//! first is then late by the second. No core idles by that, and the job of a
//! fit that is told to stop ends in time whatever its thread does.

use std::backtrace::Backtrace;
use std::cell::Cell;
use std::panic;
use std::sync::Once;

use rayon::{ThreadPool, ThreadPoolBuilder};
use tracing::error;

use super::error::OpenError;

/// How nice the threads are, from 0 to 19: at 10 a thread that answers gets
/// about nine tenths of a core that it shares with one that fits.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

thread_local! {
    static FITS: Cell<bool> = const { Cell::new(false) };
}

/// The pool.
///
/// # Errors
/// `Workers` if the system gives no threads.
pub(super) fn build(threads: usize) -> Result<ThreadPool, OpenError> {
    log_panics_of_fits();
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|n| format!("mouldloft-fit-{n}"))
        .start_handler(|_| {
            FITS.set(true);
            lower_priority();
        })
        // Fits catch their panics themselves; without this, one anywhere else
        // on these threads would end the process.
        .panic_handler(|_| error!("a panic outside a fit on a thread of the pool"))
        .build()
        .map_err(|e| OpenError::Workers(e.to_string()))
}

#[cfg(target_os = "linux")]
fn lower_priority() {
    let thread = rustix::thread::gettid();
    if let Err(e) = rustix::process::setpriority_process(Some(thread), NICENESS) {
        tracing::warn!(error = %e, "a fitting thread keeps its priority");
    }
}

#[cfg(not(target_os = "linux"))]
fn lower_priority() {}

/// Sends panics of the pool's threads, with their backtrace, to the log and
/// nowhere else; those of other threads go where they went before.
fn log_panics_of_fits() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if FITS.get() {
                let backtrace = Backtrace::force_capture();
                error!(panic = %info, %backtrace, "panic on a fitting thread");
            } else {
                before(info);
            }
        }));
    });
}
