//! A small HTTP/1.1 client for the demonstration: one request a connection,
//! over plain TCP to this machine. It knows content lengths and chunks, no
//! redirects, no compression, no TLS.

use serde_json::Value;
use std::net::SocketAddr;
use std::time::Duration;
use thiserror::Error;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;

/// An answer takes at most this long: the longest wait the service grants
/// (55 s) and some.
const PATIENCE: Duration = Duration::from_secs(70);
/// An answer is at most this long, bytes.
const LONGEST_ANSWER: u64 = 256 * 1024 * 1024;

/// Why there is no answer.
#[derive(Debug, Error)]
pub enum ClientError {
    /// The connection failed.
    #[error("no connection to {address}: {source}")]
    Connection {
        /// Whom we called.
        address: SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
    /// Nothing came in time.
    #[error("{request} was not answered within {} s", PATIENCE.as_secs())]
    Slow {
        /// What we asked.
        request: String,
    },
    /// What came is not HTTP.
    #[error("the answer to {request} is not HTTP: {what}")]
    Garbled {
        /// What we asked.
        request: String,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The service refused.
    #[error("{request} was refused with status {status}: {detail}")]
    Refused {
        /// What we asked.
        request: String,
        /// The status code.
        status: u16,
        /// The problem's detail, or the body.
        detail: String,
    },
}

/// An answer of the service.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Status code.
    pub status: u16,
    /// The body, chunks put together.
    pub body: Vec<u8>,
}

/// Calls one service.
#[derive(Debug, Clone, Copy)]
pub struct Client {
    address: SocketAddr,
}

impl Client {
    /// A client of the service at `address`.
    pub fn new(address: SocketAddr) -> Client {
        Client { address }
    }

    /// The body at a path.
    ///
    /// # Errors
    /// See [`ClientError`]; any status but success is refused.
    pub async fn get(&self, path: &str) -> Result<Vec<u8>, ClientError> {
        self.call("GET", path, None).await
    }

    /// The body at a path, as JSON.
    ///
    /// # Errors
    /// As [`Client::get`], and when the body is not JSON.
    pub async fn get_json(&self, path: &str) -> Result<Value, ClientError> {
        json(&format!("GET {path}"), &self.get(path).await?)
    }

    /// Posts JSON and reads JSON.
    ///
    /// # Errors
    /// As [`Client::get_json`].
    pub async fn post_json(&self, path: &str, body: &[u8]) -> Result<Value, ClientError> {
        json(
            &format!("POST {path}"),
            &self.call("POST", path, Some(body)).await?,
        )
    }

    async fn call(
        &self,
        method: &str,
        path: &str,
        body: Option<&[u8]>,
    ) -> Result<Vec<u8>, ClientError> {
        let request = format!("{method} {path}");
        let answer = tokio::time::timeout(PATIENCE, self.exchange(&request, body)).await;
        let bytes = answer.map_err(|_| ClientError::Slow {
            request: request.clone(),
        })?;
        let bytes = bytes.map_err(|source| ClientError::Connection {
            address: self.address,
            source,
        })?;
        let parsed = parse(&bytes);
        let answer = parsed.map_err(|what| ClientError::Garbled {
            request: request.clone(),
            what,
        })?;
        if (200..300).contains(&answer.status) {
            return Ok(answer.body);
        }
        Err(ClientError::Refused {
            request,
            status: answer.status,
            detail: detail(&answer.body),
        })
    }

    async fn exchange(&self, request: &str, body: Option<&[u8]>) -> std::io::Result<Vec<u8>> {
        let mut stream = TcpStream::connect(self.address).await?;
        let mut head = format!(
            "{request} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n",
            self.address
        );
        if let Some(body) = body {
            head += &format!(
                "Content-Type: application/json\r\nContent-Length: {}\r\n",
                body.len()
            );
        }
        head += "\r\n";
        stream.write_all(head.as_bytes()).await?;
        stream.write_all(body.unwrap_or_default()).await?;
        let mut bytes = Vec::new();
        stream.take(LONGEST_ANSWER).read_to_end(&mut bytes).await?;
        Ok(bytes)
    }
}

fn json(request: &str, body: &[u8]) -> Result<Value, ClientError> {
    let garbled = |_| ClientError::Garbled {
        request: request.to_owned(),
        what: "the body is not JSON",
    };
    serde_json::from_slice(body).map_err(garbled)
}

/// What a problem document says, or the whole body.
fn detail(body: &[u8]) -> String {
    let problem: Option<Value> = serde_json::from_slice(body).ok();
    let told = problem
        .as_ref()
        .and_then(|p| p["detail"].as_str())
        .map(str::to_owned);
    told.unwrap_or_else(|| String::from_utf8_lossy(body).into_owned())
}

/// Takes a whole answer apart.
fn parse(bytes: &[u8]) -> Result<Answer, &'static str> {
    let end = bytes
        .windows(4)
        .position(|w| w == b"\r\n\r\n")
        .ok_or("it ends before its body")?;
    let head = std::str::from_utf8(&bytes[..end]).map_err(|_| "its head is not text")?;
    let mut lines = head.split("\r\n");
    let status = lines
        .next()
        .and_then(|l| l.split(' ').nth(1))
        .and_then(|s| s.parse().ok());
    let status = status.ok_or("it has no status")?;
    let mut headers = lines
        .filter_map(|l| l.split_once(':'))
        .map(|(n, v)| (n.to_ascii_lowercase(), v.trim()));
    let chunked = headers
        .clone()
        .any(|(n, v)| n == "transfer-encoding" && v == "chunked");
    let length = headers
        .find(|(n, _)| n == "content-length")
        .and_then(|(_, v)| v.parse().ok());
    let rest = &bytes[end + 4..];
    let body = match (chunked, length) {
        (true, _) => unchunk(rest)?,
        (false, Some(length)) => rest.get(..length).ok_or("its body is cut off")?.to_vec(),
        (false, None) => rest.to_vec(),
    };
    Ok(Answer { status, body })
}

/// Puts the chunks of a body together (RFC 9112 §7.1).
fn unchunk(mut rest: &[u8]) -> Result<Vec<u8>, &'static str> {
    let mut body = Vec::new();
    loop {
        let line = rest
            .windows(2)
            .position(|w| w == b"\r\n")
            .ok_or("a chunk has no size")?;
        let size = std::str::from_utf8(&rest[..line])
            .ok()
            .and_then(|s| s.split(';').next());
        let size = size.and_then(|s| usize::from_str_radix(s.trim(), 16).ok());
        let size = size.ok_or("a chunk has no size")?;
        if size == 0 {
            return Ok(body);
        }
        let start = line + 2;
        let end = start.checked_add(size).ok_or("a chunk is too long")?;
        body.extend_from_slice(rest.get(start..end).ok_or("a chunk is cut off")?);
        rest = rest.get(end + 2..).ok_or("a chunk is cut off")?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_chunks_are_understood() {
        let plain = parse(b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nabc");
        assert_eq!(
            plain,
            Ok(Answer {
                status: 200,
                body: b"abc".to_vec()
            })
        );
        let chunks = b"HTTP/1.1 404 Not\r\nTransfer-Encoding: chunked\r\n\r\n2\r\nab\r\n1;x=y\r\nc\r\n0\r\n\r\n";
        assert_eq!(
            parse(chunks),
            Ok(Answer {
                status: 404,
                body: b"abc".to_vec()
            })
        );
    }

    #[test]
    fn cut_off_answers_are_noticed() {
        assert!(parse(b"HTTP/1.1 200 OK\r\n").is_err());
        assert!(parse(b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\nabc").is_err());
        assert!(parse(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nff\r\nab").is_err());
        assert!(parse(b"garbage\r\n\r\n").is_err());
    }

    #[test]
    fn a_problem_s_detail_is_told() {
        assert_eq!(
            detail(br#"{"detail":"two profiles are needed"}"#),
            "two profiles are needed"
        );
        assert_eq!(detail(b"plain"), "plain");
    }
}
