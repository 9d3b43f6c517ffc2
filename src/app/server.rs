//! The listening socket: connections in, requests to the router, and an
//! orderly end.
//!
//! hyper is driven by hand because `axum::serve` bounds neither the time a
//! client may take over its request head nor the number of connections.

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::sync::CancellationToken;

/// Pause after a failed accept: it fails when the process is out of file
/// descriptors, and trying again at once would only burn the core.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);
/// Answers under way when the service goes down get this long to be sent.
const GOODBYE: Duration = Duration::from_secs(3);

/// What one service takes at once.
#[derive(Debug, Clone, Copy)]
pub struct FrontLimits {
    /// Open connections; more wait in the system's backlog.
    pub connections: usize,
    /// A request's head must arrive within this time.
    pub header_timeout: Duration,
}

/// Serves until `stop`, then lets answers under way end, at most [`GOODBYE`].
pub async fn run(
    listener: TcpListener,
    router: Router,
    limits: FrontLimits,
    stop: CancellationToken,
) {
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new())
        .header_read_timeout(limits.header_timeout);
    let slots = Arc::new(Semaphore::new(limits.connections));
    let open = GracefulShutdown::new();
    loop {
        let next = tokio::select! {
            () = stop.cancelled() => break,
            next = next_connection(&listener, &slots) => next,
        };
        let Some((stream, slot)) = next else { continue };
        let service = TowerToHyperService::new(router.clone());
        let connection = open.watch(http.serve_connection(TokioIo::new(stream), service));
        tokio::spawn(async move {
            // A client that hangs up or times out is its own affair.
            if let Err(error) = connection.await {
                tracing::debug!(%error, "connection ended early");
            }
            drop(slot);
        });
    }
    drop(listener);
    if tokio::time::timeout(GOODBYE, open.shutdown())
        .await
        .is_err()
    {
        tracing::warn!("some answers were cut off at the end");
    }
}

/// The next connection, once there is a slot for it; `None` when it failed.
async fn next_connection(
    listener: &TcpListener,
    slots: &Arc<Semaphore>,
) -> Option<(TcpStream, OwnedSemaphorePermit)> {
    // The semaphore is never closed.
    let slot = Arc::clone(slots).acquire_owned().await.ok()?;
    match listener.accept().await {
        Ok((stream, _)) => {
            // Small answers must not wait for more (Nagle); if it cannot be
            // set they only come later.
            let _ = stream.set_nodelay(true);
            Some((stream, slot))
        }
        Err(error) => {
            tracing::warn!(%error, "a connection could not be accepted");
            tokio::time::sleep(ACCEPT_PAUSE).await;
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::routing::get;
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};

    const LIMITS: FrontLimits = FrontLimits {
        connections: 2,
        header_timeout: Duration::from_millis(200),
    };

    async fn start(
        router: Router,
    ) -> (
        std::net::SocketAddr,
        CancellationToken,
        tokio::task::JoinHandle<()>,
    ) {
        let listener = TcpListener::bind(("127.0.0.1", 0))
            .await
            .expect("a free port");
        let address = listener.local_addr().expect("an address");
        let stop = CancellationToken::new();
        let task = tokio::spawn(run(listener, router, LIMITS, stop.clone()));
        (address, stop, task)
    }

    async fn read_all(mut stream: TcpStream) -> String {
        let mut text = String::new();
        stream.read_to_string(&mut text).await.expect("readable");
        text
    }

    #[tokio::test]
    async fn a_slow_head_is_cut_off() {
        let (address, stop, task) = start(Router::new()).await;
        let mut stream = TcpStream::connect(address).await.expect("connected");
        stream
            .write_all(b"GET / HTTP/1.1\r\nHost:")
            .await
            .expect("writable");
        // Ends only because the server closes: no clock of our own.
        let answer = read_all(stream).await;
        assert!(
            answer.is_empty() || answer.starts_with("HTTP/1.1 408"),
            "{answer}"
        );
        stop.cancel();
        task.await.expect("the server ends");
    }

    #[tokio::test]
    async fn an_answer_under_way_is_finished() {
        let (entered, mut seen) = tokio::sync::mpsc::channel::<()>(1);
        let gate = Arc::new(tokio::sync::Notify::new());
        let wait = Arc::clone(&gate);
        let handler = move || async move {
            let _ = entered.send(()).await;
            wait.notified().await;
            "done"
        };
        let (address, stop, task) = start(Router::new().route("/", get(handler))).await;
        let mut stream = TcpStream::connect(address).await.expect("connected");
        stream
            .write_all(b"GET / HTTP/1.1\r\nHost: a\r\n\r\n")
            .await
            .expect("writable");
        seen.recv().await.expect("the handler runs");
        stop.cancel();
        gate.notify_one();
        assert!(read_all(stream).await.ends_with("done"));
        task.await.expect("the server ends");
        assert!(
            TcpStream::connect(address).await.is_err(),
            "nobody listens any more"
        );
    }

    #[tokio::test]
    async fn more_connections_than_slots_wait_their_turn() {
        let (address, stop, task) =
            start(Router::new().route("/", get(|| async { "hello" }))).await;
        let mut clients = Vec::new();
        for _ in 0..6 {
            clients.push(tokio::spawn(async move {
                let mut stream = TcpStream::connect(address).await.expect("connected");
                let request = b"GET / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n";
                stream.write_all(request).await.expect("writable");
                read_all(stream).await
            }));
        }
        for client in clients {
            assert!(client.await.expect("a client").ends_with("hello"));
        }
        stop.cancel();
        task.await.expect("the server ends");
    }
}
