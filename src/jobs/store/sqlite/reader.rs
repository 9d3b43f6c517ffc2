//! A few connections that only read, used on the blocking threads. In WAL mode
//! they see the last commit and wait for no writer.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use rusqlite::Connection;
use tokio::sync::Semaphore;

use super::open;
use crate::jobs::error::OpenError;
use crate::jobs::store::StoreError;

/// How many reads at once: a read is microseconds of CPU, so more than a few
/// would only wait for each other's cores.
const CONNECTIONS: usize = 4;

/// The pool.
pub(super) struct Readers {
    idle: Arc<Mutex<Vec<Connection>>>,
    free: Arc<Semaphore>,
}

impl Readers {
    /// Opens the connections.
    ///
    /// # Errors
    /// `Store`.
    pub fn open(file: &Path) -> Result<Self, OpenError> {
        let idle = (0..CONNECTIONS)
            .map(|_| open::reader(file))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Readers {
            free: Arc::new(Semaphore::new(idle.len())),
            idle: Arc::new(Mutex::new(idle)),
        })
    }

    /// Does `work` in one read transaction on a blocking thread.
    ///
    /// # Errors
    /// The work's own error, or `Busy`.
    pub async fn read<F, T>(&self, work: F) -> Result<T, StoreError>
    where
        F: FnOnce(&Connection) -> Result<T, StoreError> + Send + 'static,
        T: Send + 'static,
    {
        let gone = |what: &str| StoreError::Busy(format!("readers: {what}"));
        let permit = Arc::clone(&self.free).acquire_owned().await;
        let permit = permit.map_err(|_| gone("closed"))?;
        let idle = Arc::clone(&self.idle);
        let reading = tokio::task::spawn_blocking(move || {
            let lent = Lent::take(&idle)?;
            let answer = lent.read(work);
            drop(lent);
            drop(permit);
            Some(answer)
        });
        match reading.await {
            Ok(Some(answer)) => answer,
            Ok(None) => Err(gone("no connection is idle")),
            Err(e) => Err(gone(&e.to_string())),
        }
    }
}

/// A connection on loan; dropping it gives it back, after a panic too.
struct Lent<'a> {
    conn: Option<Connection>,
    idle: &'a Mutex<Vec<Connection>>,
}

impl<'a> Lent<'a> {
    fn take(idle: &'a Mutex<Vec<Connection>>) -> Option<Self> {
        let conn = idle.lock().unwrap_or_else(PoisonError::into_inner).pop()?;
        Some(Lent {
            conn: Some(conn),
            idle,
        })
    }

    /// One transaction, so that two statements see the same commit.
    fn read<T>(
        &self,
        work: impl FnOnce(&Connection) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let conn = self
            .conn
            .as_ref()
            .ok_or_else(|| StoreError::Busy("connection taken".to_owned()))?;
        let tx = conn.unchecked_transaction()?;
        let answer = work(&tx)?;
        tx.commit()?;
        Ok(answer)
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        if let Some(conn) = self.conn.take() {
            let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
            idle.push(conn);
        }
    }
}
