//! Where a viewer is.

use std::io::{self, Read as _, Write as _};
use std::net::{IpAddr, TcpStream, ToSocketAddrs as _};
use std::time::Duration;

use rerun::external::re_uri::{ProxyUri, RedapUri, Scheme};

use crate::recording::error::RecordError;

/// The viewer at `address`: `HOST:PORT`, or a URL as viewers show it.
pub(super) fn parse(address: &str) -> Result<ProxyUri, RecordError> {
    let url = if address.contains("://") {
        address.to_owned()
    } else {
        format!("rerun+http://{address}/proxy")
    };
    match url.parse() {
        Ok(RedapUri::Proxy(uri)) => Ok(uri),
        Ok(_) | Err(_) => Err(RecordError::Address { address: address.to_owned() }),
    }
}

/// Tries whether anything listens there, and speaks HTTP/2 as viewers do.
pub(super) fn reach(uri: &ProxyUri, patience: Duration) -> io::Result<()> {
    let place = format!("{}:{}", uri.origin.host, uri.origin.port);
    let mut result = Err(io::ErrorKind::AddrNotAvailable.into());
    for address in place.to_socket_addrs()? {
        result = TcpStream::connect_timeout(&address, patience);
        if result.is_ok() {
            break;
        }
    }
    match uri.origin.scheme {
        Scheme::RerunHttp => greet(&mut result?, patience),
        // The greeting would have to be encrypted.
        Scheme::RerunHttps => result.map(drop),
    }
}

/// Exchanges the first frames of HTTP/2 (RFC 9113, section 3.4): the server's is its settings.
fn greet(stream: &mut TcpStream, patience: Duration) -> io::Result<()> {
    const PREFACE: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
    const EMPTY_SETTINGS: [u8; 9] = [0, 0, 0, SETTINGS, 0, 0, 0, 0, 0];
    /// The type of a frame of settings, and where in a frame the type is.
    const SETTINGS: u8 = 4;
    const TYPE: usize = 3;
    stream.set_read_timeout(Some(patience))?;
    stream.write_all(PREFACE)?;
    stream.write_all(&EMPTY_SETTINGS)?;
    let mut header = [0; 9];
    let answered = stream.read_exact(&mut header).is_ok();
    if answered && header[TYPE] == SETTINGS {
        return Ok(());
    }
    Err(io::Error::other("the program that listens there is not a viewer"))
}

/// An address as it is written before a port.
pub(super) fn host(ip: IpAddr) -> String {
    match ip {
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_host_with_a_port_or_a_url() {
        for address in ["127.0.0.1:9876", "rerun+http://127.0.0.1:9876/proxy"] {
            assert_eq!(parse(address).unwrap().to_string(), "rerun+http://127.0.0.1:9876/proxy");
        }
        assert_eq!(parse("lab-pc:9000").unwrap().origin.port, 9000);
        for wrong in ["", "ftp://lab-pc", "rerun+http://", "a b:1"] {
            assert!(matches!(parse(wrong), Err(RecordError::Address { .. })), "{wrong}");
        }
    }
}
