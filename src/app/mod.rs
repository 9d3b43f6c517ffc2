//! The only place that knows every layer: it wires queue, engine and router
//! into a service, puts the service behind a socket, and takes it down again.

mod server;
mod signals;

pub use server::FrontLimits;
pub use signals::Signals;

use crate::http::{self, Api, Metrics};
use crate::jobs::{Meter, OpenError, Queue, QueueConfig};
use crate::settings::{FrontSettings, ServeSettings, StoreSettings, days};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use thiserror::Error;
use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

/// Why the service does not run, or ran no further; each a sentence for the
/// terminal.
#[derive(Debug, Error)]
pub enum AppError {
    /// Others could reach the service and nothing would keep them out.
    #[error(
        "{0} can be reached from other machines, and there are no API keys yet: listen on \
         127.0.0.1, or say --allow-unauthenticated if something else keeps strangers out"
    )]
    Exposed(SocketAddr),
    /// The port is taken, or not ours to take.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// Where.
        address: SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
    /// The queue cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A fault of this crate: its own contract cannot be written down.
    #[error("the OpenAPI document cannot be written: {0}")]
    Document(String),
    /// No handler for signals could be set.
    #[error("signals cannot be handled: {0}")]
    Signals(std::io::Error),
    /// The store broke while running.
    #[error("the job store broke, a restart recovers what was accepted: {0}")]
    StoreBroken(String),
    /// A second signal came before running fits had ended.
    #[error("stopped at once by a second {0}; unfinished jobs will be fitted after a restart")]
    Hurried(&'static str),
}

/// What the queue needs to know of the settings.
pub fn queue_config(store: &StoreSettings) -> QueueConfig {
    let default = QueueConfig::default();
    QueueConfig {
        data_dir: (!store.ephemeral).then(|| store.data.clone()),
        workers: store.workers.unwrap_or(default.workers),
        max_queued: store.max_queued,
        max_queued_bytes: store.max_queued_bytes(),
        min_free_bytes: store.min_free_bytes(),
        result_age: days(store.keep_results_days),
        record_age: days(store.keep_records_days),
        ..default
    }
}

/// Opens the queue with the engine of this crate; its workers start.
///
/// # Errors
/// As [`Queue::open`].
pub async fn open_queue(store: &StoreSettings, meter: Arc<dyn Meter>) -> Result<Queue, OpenError> {
    Queue::open(queue_config(store), Arc::new(http::Engine), meter).await
}

/// A service behind its socket.
pub struct Service {
    address: SocketAddr,
    queue: Queue,
    stop: CancellationToken,
    server: JoinHandle<()>,
}

impl Service {
    /// Listens, opens the queue and serves.
    ///
    /// # Errors
    /// [`AppError::Exposed`], [`AppError::Listen`], [`AppError::Open`].
    pub async fn start(settings: &ServeSettings) -> Result<Service, AppError> {
        let front = &settings.front;
        // The port first: a service that cannot listen must not touch jobs.
        let listener = listen(front).await?;
        let metrics = Metrics::new();
        let queue = open_queue(&settings.store, Arc::clone(&metrics) as Arc<dyn Meter>).await?;
        Service::over(queue, metrics, listener, limits(front))
    }

    /// Serves a queue that is open already.
    ///
    /// # Errors
    /// [`AppError::Document`]; [`AppError::Listen`] if the socket has no address.
    pub fn over(
        queue: Queue,
        metrics: Arc<Metrics>,
        listener: TcpListener,
        limits: FrontLimits,
    ) -> Result<Service, AppError> {
        let nowhere = SocketAddr::from(([0, 0, 0, 0], 0));
        let address = listener.local_addr().map_err(|source| AppError::Listen {
            address: nowhere,
            source,
        })?;
        let api = Api::new(queue.clone(), metrics).map_err(AppError::Document)?;
        let stop = CancellationToken::new();
        let server = server::run(listener, http::router(api), limits, stop.clone());
        let server = tokio::spawn(server);
        tracing::info!(%address, "the loft is open");
        Ok(Service {
            address,
            queue,
            stop,
            server,
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves until a signal comes, then goes down within `grace` and a few
    /// seconds for the last answers.
    ///
    /// # Errors
    /// [`AppError::StoreBroken`]; [`AppError::Hurried`] by a second signal.
    pub async fn until_signal(
        self,
        signals: &mut Signals,
        grace: Duration,
    ) -> Result<(), AppError> {
        tokio::select! {
            signal = signals.next() => tracing::info!(signal, "going down"),
            reason = self.queue.broken() => return Err(AppError::StoreBroken(reason)),
        }
        tokio::select! {
            () = self.shut_down(grace) => Ok(()),
            signal = signals.next() => Err(AppError::Hurried(signal)),
        }
    }

    /// Accepts nothing more, lets running fits end within `grace`, sends the
    /// last answers and closes the store. Status calls are answered until the
    /// fits have ended.
    pub async fn shut_down(self, grace: Duration) {
        self.queue.drain(grace).await;
        self.stop.cancel();
        if let Err(error) = self.server.await {
            tracing::error!(%error, "the server broke down");
        }
        tracing::info!("the loft is closed");
    }
}

/// Takes the port, unless that would let strangers in.
async fn listen(front: &FrontSettings) -> Result<TcpListener, AppError> {
    let address = front.listen;
    if !address.ip().is_loopback() && !front.allow_unauthenticated {
        return Err(AppError::Exposed(address));
    }
    TcpListener::bind(address)
        .await
        .map_err(|source| AppError::Listen { address, source })
}

fn limits(front: &FrontSettings) -> FrontLimits {
    FrontLimits {
        connections: front.max_connections,
        header_timeout: Duration::from_secs(front.header_timeout_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn strangers_are_not_let_in_by_accident() {
        let mut settings = ServeSettings {
            store: StoreSettings::ephemeral(),
            front: FrontSettings::loopback(),
        };
        settings.front.listen = SocketAddr::from(([0, 0, 0, 0], 0));
        let refused = Service::start(&settings).await.err();
        assert!(matches!(refused, Some(AppError::Exposed(_))), "{refused:?}");
    }
}
