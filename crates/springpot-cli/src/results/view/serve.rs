//! `springpot view --serve`: the page from a server on this machine, with the rows of a run under way as they come (server-sent events).

use super::http::{self, Bad, Delivery, Request};
use super::of_results;
use crate::arguments::ViewOptions;
use crate::{Ending, diagnostic, signals, terminal};
use serde_json::{Value, json};
use springpot_report::page::ViewCase;
use springpot_run::table::disk::Disk;
use springpot_run::{NewRows, News, Underway};
use std::io::{self, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Where the rows are asked for.
const EVENTS: &str = "/events";
/// Connections at a time that are answered.
const MOST: usize = 32;
/// More than these are not even told that there are too many.
const MOST_HEARD: usize = 2 * MOST;
/// Between two looks at the rows.
const PAUSE: Duration = Duration::from_millis(100);
/// A line that says nothing is sent after so long, to see whether somebody listens.
const QUIET: Duration = Duration::from_secs(5);

/// What is served.
#[derive(Debug)]
struct Server {
    options: ViewOptions,
    disk: Disk,
    open: AtomicUsize,
}

pub(super) fn serve(options: &ViewOptions, disk: &Disk) -> Ending {
    // What cannot be shown is said now.
    if Underway::open(disk, &options.results).is_some() {
        if !options.cases.is_empty() {
            let help = "leave --case out: the page shows the first 12 as they begin".to_owned();
            diagnostic::error_with_help("cases cannot be chosen while a run is under way", help);
            return Ending::Refused;
        }
    } else if let Err(ending) = of_results(&options.results, &options.cases, disk) {
        return ending;
    }
    let port = options.port.unwrap_or(0);
    let bound =
        TcpListener::bind((Ipv4Addr::LOCALHOST, port)).and_then(|listener| Ok((listener.local_addr()?, listener)));
    let (address, listener) = match bound {
        Ok(bound) => bound,
        Err(error) => {
            let help = "leave --port out, and a free one is taken".to_owned();
            diagnostic::error_with_help(format!("port {port} of this machine cannot be listened on: {error}"), help);
            return Ending::Failed;
        }
    };
    signals::before_the_end(|| ());
    terminal::print(&format!("http://{address}/\n"));
    terminal::print_error("Ctrl-C ends it\n");
    let server = Arc::new(Server { options: options.clone(), disk: disk.clone(), open: AtomicUsize::new(0) });
    for stream in listener.incoming() {
        let Ok(mut stream) = stream else {
            // Too many files are open, or the like.
            thread::sleep(PAUSE);
            continue;
        };
        let place = Place::of(&server);
        let open = server.open.load(Ordering::Relaxed);
        if open > MOST_HEARD {
            continue;
        }
        // A browser that goes away is no error, and neither is one that no thread can be had for.
        let _ = thread::Builder::new().spawn(move || {
            let _ = place.server.answer(&mut stream, open > MOST);
            http::close(&mut stream);
        });
    }
    Ending::Failed
}

/// One of the connections, until it is dropped.
struct Place {
    server: Arc<Server>,
}

impl Place {
    fn of(server: &Arc<Server>) -> Self {
        server.open.fetch_add(1, Ordering::Relaxed);
        Self { server: server.clone() }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.server.open.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Server {
    fn answer(&self, stream: &mut TcpStream, is_one_too_many: bool) -> io::Result<()> {
        let asked = http::request(stream)?;
        let text = |status: &'static str, body: &[u8], wants_body| {
            http::answer(&mut Delivery::of_page(stream), status, "text/plain", body, wants_body)
        };
        let Request { path, wants_body, last_event } = match asked {
            _ if is_one_too_many => return text("503 Service Unavailable", b"too many at a time", true),
            Ok(request) => request,
            Err(Bad(status)) => return text(status, status.as_bytes(), true),
        };
        let html = |page: &str| {
            http::answer(&mut Delivery::of_page(stream), "200 OK", "text/html", page.as_bytes(), wants_body)
        };
        let results: &Path = &self.options.results;
        let underway = Underway::open(&self.disk, results);
        match (path.as_str(), underway) {
            ("/", Some(run)) => html(&run.view(EVENTS).html()),
            ("/", None) => match of_results(results, &self.options.cases, &self.disk) {
                Ok(view) => html(&view.html()),
                // Why, stands on the terminal.
                Err(_) => text("404 Not Found", b"no results", wants_body),
            },
            (EVENTS, Some(run)) if wants_body => {
                // Of another run, nothing was sent.
                let of_run = |id: &str| id.strip_prefix(run.id())?.strip_prefix('@')?.parse().ok();
                let sent = last_event.and_then(|id| of_run(&id)).unwrap_or(0);
                events(stream, &run, sent)
            }
            // It has ended in between.
            (EVENTS, None) if wants_body => {
                let status =
                    of_results(results, &[], &self.disk).map_or_else(|_| "interrupted".to_owned(), |view| view.status);
                let mut delivery = Delivery::of_message(stream);
                http::begin_events(&mut delivery)?;
                http::event(&mut delivery, &json!({ "status": status }).to_string(), None)
            }
            _ => text("404 Not Found", b"404 Not Found", wants_body),
        }
    }
}

/// Sends rows as they come, until the run or the connection ends.
fn events(stream: &TcpStream, run: &Underway, sent: u64) -> io::Result<()> {
    let message = || Delivery::of_message(stream);
    http::begin_events(&mut message())?;
    let mut tail = run.tail(sent)?;
    let mut spoken = Instant::now();
    loop {
        let Some(news) = tail.news()? else {
            if spoken.elapsed() > QUIET {
                message().write_all(b":\n\n")?;
                spoken = Instant::now();
            }
            thread::sleep(PAUSE);
            continue;
        };
        if !news.is_empty() {
            spoken = Instant::now();
        }
        for one in news {
            match one {
                News::Case(case) => {
                    let ViewCase { index, name, parameters, scene, .. } = *case;
                    let case = json!({ "index": index, "name": name, "parameters": parameters, "scene": scene });
                    http::event(&mut message(), &json!({ "cases": [case] }).to_string(), None)?;
                }
                News::Rows(NewRows { case, rows, position }) => {
                    let rows: Vec<Value> = rows.iter().map(|row| row.iter().copied().map(number).collect()).collect();
                    http::event(
                        &mut message(),
                        &json!({ "case": case, "rows": rows }).to_string(),
                        Some(&format!("{}@{position}", run.id())),
                    )?;
                }
                News::Ended(status) => {
                    return http::event(&mut message(), &json!({ "status": status }).to_string(), None);
                }
            }
        }
    }
}

/// An empty field is null.
fn number(value: f64) -> Value {
    serde_json::Number::from_f64(value).map_or(Value::Null, Value::Number)
}
