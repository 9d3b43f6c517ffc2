//! `mouldloft health`: asks a running service on this machine whether it is
//! ready, for container health checks where there is no `curl`.

use super::client::Client;
use super::{Exit, out};
use crate::settings::HealthSettings;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

/// 0 when the service is ready; else says why not.
pub async fn run(settings: &HealthSettings) -> Exit {
    match Client::new(reachable(settings.listen)).get("/readyz").await {
        Ok(_) => Exit::Done,
        Err(error) => {
            out::complain(&error.to_string());
            Exit::Trouble
        }
    }
}

/// Where to call a service that listens there: "all addresses" is none to call.
fn reachable(mut listen: SocketAddr) -> SocketAddr {
    match listen.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => listen.set_ip(Ipv4Addr::LOCALHOST.into()),
        IpAddr::V6(ip) if ip.is_unspecified() => listen.set_ip(Ipv6Addr::LOCALHOST.into()),
        _ => {}
    }
    listen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_addresses_are_called_at_home() {
        let at = |text: &str| reachable(text.parse().unwrap()).to_string();
        assert_eq!(at("0.0.0.0:80"), "127.0.0.1:80");
        assert_eq!(at("[::]:80"), "[::1]:80");
        assert_eq!(at("10.0.0.7:80"), "10.0.0.7:80");
    }
}
