//! As much of HTTP/1.1 as a browser on the same machine asks for (RFC 9112): one request a connection.

use std::io::{self, Read as _, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// Bytes of a request that are read.
const LONGEST: usize = 16 << 10;
/// A browser that has not asked by then is left.
const PATIENCE: Duration = Duration::from_secs(10);
/// One that has not taken a page by then is left too.
const DELIVERY: Duration = Duration::from_secs(60);
/// What is still coming is read for so long, so that an answer is not lost with it.
const FAREWELL: Duration = Duration::from_secs(1);

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

/// Reads a request, all of it before one deadline; the outer error is the connection's.
pub(super) fn request(stream: &mut TcpStream) -> io::Result<Result<Request, Bad>> {
    request_until(stream, Instant::now() + PATIENCE)
}

fn request_until(stream: &mut TcpStream, until: Instant) -> io::Result<Result<Request, Bad>> {
    let (mut bytes, mut piece) = (Vec::new(), [0; 4096]);
    loop {
        let Some(left) = left(until) else { return Ok(Err(Bad("408 Request Timeout"))) };
        stream.set_read_timeout(Some(left))?;
        let count = match stream.read(&mut piece) {
            Ok(0) => return Ok(Err(Bad("400 Bad Request"))),
            Ok(count) => count,
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => continue,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        // The end may have begun in the piece before.
        let from = bytes.len().saturating_sub(3);
        bytes.extend_from_slice(&piece[..count]);
        if let Some(end) = end_of_head(&bytes, from) {
            let text = String::from_utf8_lossy(&bytes[..end]);
            return Ok(read(&text.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>()));
        }
        if bytes.len() > LONGEST {
            return Ok(Err(Bad("431 Request Header Fields Too Large")));
        }
    }
}

/// Where the empty line is that ends the head of a request.
fn end_of_head(bytes: &[u8], from: usize) -> Option<usize> {
    (from..bytes.len()).find(|&at| bytes[at..].starts_with(b"\n\r\n") || bytes[at..].starts_with(b"\n\n"))
}

fn left(until: Instant) -> Option<Duration> {
    until.checked_duration_since(Instant::now()).filter(|left| !left.is_zero())
}

/// Ends a connection once the other side has heard the answer: what it still sends is read, for a moment.
pub(super) fn close(stream: &mut TcpStream) {
    let (until, mut piece) = (Instant::now() + FAREWELL, [0; 4096]);
    if stream.shutdown(Shutdown::Write).is_err() {
        return;
    }
    while let Some(left) = left(until) {
        let _ = stream.set_read_timeout(Some(left));
        if !stream.read(&mut piece).is_ok_and(|count| count > 0) {
            break;
        }
    }
}

/// A connection that takes what is written before one deadline.
#[derive(Debug)]
pub(super) struct Delivery<'a> {
    stream: &'a TcpStream,
    until: Instant,
}

impl<'a> Delivery<'a> {
    /// Of a whole answer.
    pub(super) fn of_page(stream: &'a TcpStream) -> Self {
        Self { stream, until: Instant::now() + DELIVERY }
    }

    /// Of one of many messages.
    pub(super) fn of_message(stream: &'a TcpStream) -> Self {
        Self { stream, until: Instant::now() + PATIENCE }
    }
}

impl Write for Delivery<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let left = left(self.until).ok_or(io::ErrorKind::TimedOut)?;
        self.stream.set_write_timeout(Some(left))?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

fn read(lines: &[String]) -> Result<Request, Bad> {
    let mut words = lines.first().map_or("", String::as_str).split(' ');
    let (method, target, version) = (words.next(), words.next(), words.next());
    let headers = |name: &str| {
        let values = lines.iter().skip(1).filter_map(|line| line.split_once(':'));
        values.filter(|(own, _)| own.eq_ignore_ascii_case(name)).map(|(_, value)| value.trim()).collect::<Vec<_>>()
    };
    let header = |name: &str| headers(name).first().map(|value| (*value).to_owned());
    let wants_body = match (method, version) {
        (Some("GET"), Some(version)) if version.starts_with("HTTP/1.") => true,
        (Some("HEAD"), Some(version)) if version.starts_with("HTTP/1.") => false,
        (Some(_), Some(version)) if version.starts_with("HTTP/") => return Err(Bad("405 Method Not Allowed")),
        _ => return Err(Bad("400 Bad Request")),
    };
    // Of two, a browser and its server may each take another.
    let [host] = headers("Host")[..] else {
        return Err(if headers("Host").is_empty() { Bad("403 Forbidden") } else { Bad("400 Bad Request") });
    };
    // A page from elsewhere whose name was made to lead here is not answered.
    if !is_here(host) {
        return Err(Bad("403 Forbidden"));
    }
    // Nor does a page from elsewhere make this machine work, or show what is here in a frame: the address is typed, or comes from this machine.
    let is = |name: &str, values: &[&str]| header(name).is_some_and(|value| values.contains(&value.as_str()));
    let is_foreign = is("Sec-Fetch-Site", &["cross-site"])
        || (is("Sec-Fetch-Site", &["same-site"]) && !is("Sec-Fetch-Mode", &["navigate"]))
        || header("Origin").is_some_and(|origin| !origin.split_once("://").is_some_and(|(_, host)| is_here(host)));
    if is_foreign || is("Sec-Fetch-Dest", &["iframe", "frame", "embed", "object", "fencedframe"]) {
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

const COMMON: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
     X-Frame-Options: DENY\r\nContent-Security-Policy: frame-ancestors 'none'\r\nCross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n";

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
    fn one_byte_after_another_has_one_deadline() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let mut client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (mut server, _) = listener.accept().unwrap();
        let talker = std::thread::spawn(move || {
            client.write_all(b"GET / HTTP/1.1\r\nX: ").unwrap();
            // Until the other side hangs up; never a line.
            while client.write_all(b"a").is_ok() {
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        let until = Instant::now() + Duration::from_millis(300);
        assert_eq!(request_until(&mut server, until).unwrap(), Err(Bad("408 Request Timeout")));
        drop(server);
        talker.join().unwrap();
    }

    #[test]
    fn a_request_in_pieces_is_read_whole() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        for pieces in
            [&["GET /a HTTP/1.1\r\nHost: localhost\r\n\r", "\n"][..], &["GET /a HTTP/1.1\nHost: localhost\n\n"]]
        {
            let mut client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
            let (mut server, _) = listener.accept().unwrap();
            for piece in pieces {
                client.write_all(piece.as_bytes()).unwrap();
                client.flush().unwrap();
            }
            assert_eq!(request(&mut server).unwrap().unwrap().path, "/a");
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
        let with = |headers: &[&str]| of(&[&["GET / HTTP/1.1", "Host: localhost"][..], headers].concat());
        for foreign in [
            &["Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: no-cors"][..],
            &["Sec-Fetch-Site: cross-site", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: document"],
            &["Sec-Fetch-Site: same-site", "Sec-Fetch-Mode: cors"],
            &["Sec-Fetch-Site: same-origin", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: iframe"],
            &["Origin: http://example.org"],
            &["Origin: null"],
        ] {
            assert_eq!(with(foreign), Err(Bad("403 Forbidden")), "{foreign:?}");
        }
        for own in [
            &["Sec-Fetch-Site: none", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: document"][..],
            &["Sec-Fetch-Site: same-origin", "Sec-Fetch-Mode: cors", "Origin: http://127.0.0.1:80"],
            &["Sec-Fetch-Site: same-site", "Sec-Fetch-Mode: navigate", "Sec-Fetch-Dest: document"],
            &[],
        ] {
            assert!(with(own).is_ok(), "{own:?}");
        }
        assert_eq!(with(&["hOST: localhost"]), Err(Bad("400 Bad Request")));
    }
}
