//! Loopback interface: 127.0.0.1 and, if the machine has it, `[::1]`, on one port and no other address.

use std::io::{self, ErrorKind};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};

/// Number of free ports to try; a port that is free in IPv4 may be in use in IPv6.
const FREE_PORTS_TRIED: usize = 16;

/// Sockets that a server listens on.
#[derive(Debug)]
pub(crate) struct Loopback {
    pub(crate) port: u16,
    pub(crate) sockets: Vec<TcpListener>,
}

impl Loopback {
    /// Binds `port`. A port in use in IPv6 alone counts as in use: a browser may try IPv6 first for `localhost`.
    pub(crate) fn on(port: u16) -> io::Result<Self> {
        let first = listen(Ipv4Addr::LOCALHOST.into(), port)?;
        let port = first.local_addr()?.port();
        let sockets = match listen(Ipv6Addr::LOCALHOST.into(), port) {
            Ok(second) => vec![first, second],
            Err(error) if error.kind() == ErrorKind::AddrInUse => return Err(error),
            // A machine without IPv6.
            Err(_) => vec![first],
        };
        Ok(Self { port, sockets })
    }

    /// Binds a free port.
    pub(crate) fn on_free_port() -> io::Result<Self> {
        let tried = (1..FREE_PORTS_TRIED).find_map(|_| Self::on(0).ok());
        tried.map_or_else(|| Self::on(0), Ok)
    }
}

fn listen(address: IpAddr, port: u16) -> io::Result<TcpListener> {
    TcpListener::bind(SocketAddr::new(address, port))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn has_ipv6() -> bool {
        listen(Ipv6Addr::LOCALHOST.into(), 0).is_ok()
    }

    #[test]
    fn both_families_share_one_port_where_there_are_both() {
        let loopback = Loopback::on_free_port().unwrap();
        let addresses: Vec<SocketAddr> = loopback
            .sockets
            .iter()
            .map(|socket| socket.local_addr().unwrap())
            .collect();
        let expected = 1 + usize::from(has_ipv6());
        assert_eq!(addresses.len(), expected, "{addresses:?}");
        for address in addresses {
            assert!(address.ip().is_loopback(), "{address}");
            assert_eq!(address.port(), loopback.port);
        }
    }

    #[test]
    fn a_port_that_is_taken_in_one_family_is_taken() {
        let families = [
            IpAddr::from(Ipv4Addr::LOCALHOST),
            Ipv6Addr::LOCALHOST.into(),
        ];
        let there = if has_ipv6() { 2 } else { 1 };
        for family in &families[..there] {
            let taken = listen(*family, 0).unwrap();
            let port = taken.local_addr().unwrap().port();
            let error = Loopback::on(port).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::AddrInUse, "{family}");
        }
    }
}
