//! As much of HTTP/1.1 as a browser on the same machine asks for (RFC 9112): one request a connection.

use std::io::{self, BufRead as _, BufReader, Read as _, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Bytes of a request that are read.
const LONGEST: u64 = 16 << 10;
/// A browser that says nothing for so long is left.
const PATIENCE: Duration = Duration::from_secs(10);

/// What is asked for.
#[derive(Debug, PartialEq)]
pub(super) struct Request {
    pub(super) path: String,
    /// Whether the answer's body is wanted.
    pub(super) wants_body: bool,
    /// The event that was heard last.
    pub(super) last_event: Option<String>,
}

/// What is wrong with a request: the status that it is answered with.
#[derive(Debug, PartialEq)]
pub(super) struct Bad(pub(super) &'static str);

/// Reads a request; the outer error is the connection's.
pub(super) fn request(stream: &TcpStream) -> io::Result<Result<Request, Bad>> {
    stream.set_write_timeout(Some(PATIENCE))?;
    let (mut lines, begun) = (Vec::new(), Instant::now());
    let mut reader = BufReader::new(stream.take(LONGEST));
    loop {
        // One that sends a byte now and then is left too.
        let left = PATIENCE.checked_sub(begun.elapsed()).filter(|left| !left.is_zero());
        let Some(left) = left else { return Ok(Err(Bad("408 Request Timeout"))) };
        stream.set_read_timeout(Some(left))?;
        let mut line = Vec::new();
        if reader.read_until(b'\n', &mut line)? == 0 {
            return Ok(Err(Bad("400 Bad Request")));
        }
        let line = String::from_utf8_lossy(&line).trim_end().to_owned();
        if line.is_empty() {
            return Ok(read(&lines));
        }
        lines.push(line);
    }
}

fn read(lines: &[String]) -> Result<Request, Bad> {
    let mut words = lines.first().map_or("", String::as_str).split(' ');
    let (method, target, version) = (words.next(), words.next(), words.next());
    let header = |name: &str| {
        lines.iter().skip(1).find_map(|line| {
            let (own, value) = line.split_once(':')?;
            own.eq_ignore_ascii_case(name).then(|| value.trim().to_owned())
        })
    };
    let wants_body = match (method, version) {
        (Some("GET"), Some(version)) if version.starts_with("HTTP/1.") => true,
        (Some("HEAD"), Some(version)) if version.starts_with("HTTP/1.") => false,
        (Some(_), Some(version)) if version.starts_with("HTTP/") => return Err(Bad("405 Method Not Allowed")),
        _ => return Err(Bad("400 Bad Request")),
    };
    // A page from elsewhere whose name was made to lead here is not answered.
    if !header("Host").is_some_and(|host| is_here(&host)) {
        return Err(Bad("403 Forbidden"));
    }
    // Nor does a page from elsewhere make this machine work; whoever follows a link does.
    if header("Sec-Fetch-Site").is_some_and(|site| site == "cross-site")
        && header("Sec-Fetch-Mode").is_none_or(|mode| mode != "navigate")
    {
        return Err(Bad("403 Forbidden"));
    }
    let path = target.unwrap_or("/").split(['?', '#']).next().unwrap_or("/").to_owned();
    Ok(Request { path, wants_body, last_event: header("Last-Event-ID") })
}

/// Whether a host is this machine, by any port.
fn is_here(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    ["127.0.0.1", "localhost", "[::1]"].contains(&name.to_ascii_lowercase().as_str())
}

/// Answers with a whole body.
pub(super) fn answer(
    stream: &mut impl Write,
    status: &str,
    media: &str,
    body: &[u8],
    wants_body: bool,
) -> io::Result<()> {
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {media}; charset=utf-8\r\nContent-Length: {length}\r\n{COMMON}\r\n"
    )?;
    if wants_body {
        stream.write_all(body)?;
    }
    stream.flush()
}

/// Begins an answer of events that come one by one.
pub(super) fn begin_events(stream: &mut impl Write) -> io::Result<()> {
    write!(stream, "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\n{COMMON}\r\nretry: 1000\n\n")?;
    stream.flush()
}

/// Writes an event whose data is one line; `id` is what a browser says when it comes again.
pub(super) fn event(stream: &mut impl Write, data: &str, id: Option<&str>) -> io::Result<()> {
    if let Some(id) = id {
        writeln!(stream, "id: {id}")?;
    }
    write!(stream, "data: {data}\n\n")?;
    stream.flush()
}

const COMMON: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nConnection: close\r\n";

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lines: &[&str]) -> Result<Request, Bad> {
        read(&lines.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn requests() {
        let request = of(&["GET /events?x=1 HTTP/1.1", "host: localhost:8080", "Last-Event-ID: 12"]).unwrap();
        assert_eq!(request, Request { path: "/events".into(), wants_body: true, last_event: Some("12".into()) });
        assert!(!of(&["HEAD / HTTP/1.0", "Host: 127.0.0.1"]).unwrap().wants_body);
        assert_eq!(of(&["POST / HTTP/1.1", "Host: localhost"]), Err(Bad("405 Method Not Allowed")));
        for lines in [&["GET /"][..], &[], &["GET", "Host: localhost"], &["\u{0}\u{1} a b"]] {
            assert_eq!(of(lines), Err(Bad("400 Bad Request")), "{lines:?}");
        }
    }

    #[test]
    fn only_this_machine_is_answered() {
        for host in ["localhost", "LocalHost:1", "127.0.0.1:65535", "[::1]:80", "[::1]"] {
            assert!(is_here(host), "{host}");
        }
        for host in ["", "example.org", "localhost.example.org", "127.0.0.1.example.org:80", "localhost:x", "0.0.0.0"] {
            assert!(!is_here(host), "{host}");
        }
        assert_eq!(of(&["GET / HTTP/1.1", "Host: example.org"]), Err(Bad("403 Forbidden")));
        assert_eq!(of(&["GET / HTTP/1.1"]), Err(Bad("403 Forbidden")));
        let from = |mode: &str| {
            of(&["GET / HTTP/1.1", "Host: localhost", "Sec-Fetch-Site: cross-site", &format!("Sec-Fetch-Mode: {mode}")])
        };
        assert_eq!(from("no-cors"), Err(Bad("403 Forbidden")));
        assert!(from("navigate").is_ok());
    }
}
