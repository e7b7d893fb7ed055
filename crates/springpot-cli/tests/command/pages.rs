//! Pages of results: `springpot view`, `springpot report`, and the server that shows a run under way.

use crate::support::{ARM, Place, length, signal, wait_for};
use serde_json::Value;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Duration;

const SWEPT: &str = "[[sweep]]\nparameter = \"element.damper.u\"\nvalues = [\"1 V\", \"4 V\"]\n";
const FIGURES: &str =
    "[[figure]]\nname = \"force\"\ntitle = \"Force of the damper\"\nx = \"t\"\ny = \"damper.force\"\n";
/// What must stay text.
const BAD: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)> \\\"'`&";

fn swept() -> Place {
    let place = Place::with(&format!("{ARM}{SWEPT}{FIGURES}"));
    place.done(&["run", "arm.toml", "--out", "o"]);
    place
}

/// The data of a page that shows motion.
fn data(html: &str) -> Value {
    let (_, rest) = html.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn view_writes_one_page_with_what_is_asked_for() {
    let place = swept();
    let ended = place.done(&["view", "o"]);
    assert_eq!(ended.stdout.trim_end(), "o/view.html");
    let html = place.read("o/view.html");
    assert!(!html.contains("src=\"http") && !html.contains("href=\"http"));
    let whole = data(&html);
    assert_eq!(whole["title"], "Damped arm");
    assert_eq!((whole["name"].as_str(), whole["status"].as_str()), (Some("o"), Some("done")));
    let names: Vec<&str> =
        whole["cases"].as_array().unwrap().iter().map(|case| case["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 2);
    assert!(names[0].starts_with("u = "), "{names:?}");
    assert_eq!(whole["elements"][0]["name"], "damper");
    place.done(&["view", "o", "--case", "1", "--out", "one.html"]);
    let one = data(&place.read("one.html"));
    assert_eq!(one["cases"].as_array().unwrap().len(), 1);
    assert_eq!(one["cases"][0]["index"], 1);
    // `run --view` writes the same page.
    let ended = place.done(&["run", "arm.toml", "--out", "p", "--view"]);
    assert!(ended.stdout.contains("view     p/view.html"), "{}", ended.stdout);
    assert_eq!(data(&place.read("p/view.html"))["cases"], whole["cases"]);
}

#[test]
fn rows_in_any_format_make_the_same_page() {
    let place = swept();
    place.done(&["view", "o"]);
    let of_csv = data(&place.read("o/view.html"))["cases"].clone();
    for format in ["parquet", "npz"] {
        place.done(&["run", "arm.toml", "--out", format, "--format", format]);
        place.done(&["view", format]);
        assert_eq!(data(&place.read(format!("{format}/view.html")))["cases"], of_csv, "{format}");
        place.done(&["report", format]);
    }
}

#[test]
fn a_report_says_all_of_a_run() {
    let place = swept();
    let ended = place.done(&["report", "o"]);
    assert_eq!(ended.stdout.trim_end(), "o/report.html");
    let html = place.read("o/report.html");
    let wanted = [
        "<title>Damped arm</title>",
        "2 of 2 done",
        "Force of the damper",
        "figures&#x2f;force.svg",
        "<math",
        "damper: force over stroke",
        "Bodies",
        "springpot run arm.toml",
        "root mean square",
    ];
    for text in wanted {
        assert!(html.contains(text), "{text}");
    }
    assert!(!html.contains("<script") && !html.contains("http:&#x2f;&#x2f;") && !html.contains("src=\"http"));
    // The scenario is there as it was written.
    assert!(html.contains("[[sweep]]\nparameter = &quot;element.damper.u&quot;"));
    // The figure is the file that the run drew.
    let svg = fs::read(place.path("o/figures/force.svg")).unwrap();
    assert!(html.contains(&base64(&svg)));
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let of = |chunk: &[u8]| {
        let number = chunk.iter().fold(0_u32, |sum, byte| sum << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        let digit =
            |k: usize| if k <= chunk.len() { DIGITS[(number >> (18 - 6 * k) & 63) as usize] as char } else { '=' };
        (0..4).map(digit).collect::<String>()
    };
    bytes.chunks(3).map(of).collect()
}

#[test]
fn what_was_asked_stands_in_the_record_and_the_report() {
    let place = swept();
    let sweep = "element.damper.alpha=0.3,0.5";
    place.done(&["run", "arm.toml", "--out", "o", "--set", "time.end=0.2 s", "--sweep", sweep]);
    let record = place.record("o");
    assert_eq!(record["scenario"]["set"][0], "time.end=0.2 s");
    assert_eq!(record["scenario"]["sweep"][0], sweep);
    assert_eq!(record["scenario"]["text"].as_str(), Some(place.read("arm.toml").as_str()));
    place.done(&["report", "o"]);
    let html = place.read("o/report.html");
    assert!(html.contains("--set &#x27;time.end=0.2 s&#x27; --sweep element.damper.alpha=0.3,0.5"), "{html}");
}

#[test]
fn two_results_are_compared() {
    let place = swept();
    place.done(&["run", "arm.toml", "--out", "p", "--set", "element.damper.alpha=0.3"]);
    let ended = place.done(&["report", "o", "p"]);
    assert_eq!(ended.stdout.trim_end(), "o/comparison.html");
    let html = place.read("o/comparison.html");
    for text in ["o and p", "elements.damper.parameters.alpha", "largest difference", "damper: force over time"] {
        assert!(html.contains(text), "{text}");
    }
    place.done(&["report", "o", "o", "--out", "same.html"]);
    let same = place.read("same.html");
    assert!(same.contains("both were run from the same values"));
    assert!(!place.files(".").contains(&"o/report.html".to_owned()));
}

#[test]
fn pages_of_an_earlier_run_go_with_its_results() {
    let place = swept();
    place.done(&["view", "o"]);
    place.done(&["report", "o"]);
    place.write("o/notes.html", "mine");
    place.done(&["run", "arm.toml", "--out", "o", "-q"]);
    let files = place.files("o");
    assert!(!files.iter().any(|file| file == "view.html" || file == "report.html"), "{files:?}");
    assert!(files.iter().any(|file| file == "notes.html"));
    // A page of that name that is none of ours stays.
    place.write("o/view.html", "mine");
    place.done(&["run", "arm.toml", "--out", "o", "-q"]);
    assert_eq!(place.read("o/view.html"), "mine");
}

#[test]
fn hostile_names_stay_text() {
    let long = "x".repeat(100_000);
    let figure = format!("[[figure]]\nname = \"f\"\ntitle = \"{BAD}\"\nx = \"t\"\ny = \"damper.force\"\n");
    let place = Place::with(&format!("{}{figure}", ARM.replacen("Damped arm", &format!("{BAD} {long}"), 1)));
    place.done(&["run", "arm.toml", "--out", "o"]);
    for (command, page) in [("view", "o/view.html"), ("report", "o/report.html")] {
        place.done(&[command, "o"]);
        let html = place.read(page);
        assert!(!html.contains("<script>alert") && !html.contains("<img src=x"), "{page}");
        assert!(html.contains("alert(1)") && html.contains(&long), "{page}");
    }
    assert!(data(&place.read("o/view.html"))["title"].as_str().unwrap().starts_with(&BAD.replace("\\\"", "\"")));
}

#[test]
fn what_is_no_result_is_refused() {
    let place = swept();
    place.write("file", "");
    fs::create_dir(place.path("empty")).unwrap();
    fs::create_dir(place.path("old")).unwrap();
    let mut record = place.record("o");
    record.as_object_mut().unwrap().remove("scenes");
    place.write("old/run.json", record.to_string());
    place.write("broken.json", "{");
    let refused = |arguments: &[&str], message: &str| {
        let ended = place.springpot(arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(message), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains("help: "), "{arguments:?}: {}", ended.stderr);
    };
    for command in ["view", "report"] {
        refused(&[command, "nowhere"], "nowhere: there is no such folder");
        refused(&[command, "empty"], "empty has no run.json");
        refused(&[command, "file"], "file has no run.json");
        refused(&[command, "old"], "an earlier version wrote it");
    }
    refused(&["report", "o", "nowhere"], "nowhere: there is no such folder");
    refused(&["view", "o", "--case", "2"], "case 2 has no row");
    refused(&["view", "o", "--serve", "--case", "2"], "case 2 has no row");
    refused(&["view", "nowhere", "--serve"], "there is no such folder");
    let ended = place.springpot(&["view", "o", "--out", "nowhere/page.html"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    fs::remove_file(place.path("o/results.csv")).unwrap();
    refused(&["view", "o"], "results.csv");
}

#[test]
fn rows_belong_to_the_case_of_their_values() {
    let place = swept();
    let rows = place.read("o/results.csv");
    let lines: Vec<&str> = rows.lines().collect();
    let without_first: Vec<&str> = lines.iter().copied().filter(|line| !line.starts_with("1,")).collect();
    assert!(without_first.len() < lines.len());
    // Rows that run.json tells of are not there.
    for (cut, message) in [
        (without_first.join("\n"), "0 rows of case 0"),
        (lines[..lines.len() - 1].join("\n"), "of case 1, where run.json tells of"),
        (lines[0].to_owned(), "0 rows of case 0"),
    ] {
        place.write("o/results.csv", format!("{cut}\n"));
        for command in ["view", "report"] {
            let ended = place.springpot(&[command, "o"]);
            assert_eq!(ended.code, Some(2), "{command}");
            assert!(ended.stderr.contains(message), "{}", ended.stderr);
        }
    }
}

#[test]
fn cases_whose_scene_is_not_recorded_say_so() {
    let sweep = "robot.body.arm.joint.origin.2=0.1:1.4:14";
    let place = Place::with(ARM);
    place.done(&["run", "arm.toml", "--out", "o", "--sweep", sweep]);
    place.done(&["view", "o", "--case", "11,13"]);
    let notes = data(&place.read("o/view.html"))["notes"].to_string();
    assert!(
        notes.contains("case 13 is drawn with the robot and the elements of case 0") && !notes.contains("case 11"),
        "{notes}"
    );
    let ended = place.done(&["export", "o", "arm.glb", "--case", "13"]);
    assert!(ended.stderr.contains("case 13 is drawn"), "{}", ended.stderr);
    // What is swept moves nothing: all cases have one scene.
    place.done(&["run", "arm.toml", "--out", "p", "--sweep", "element.damper.alpha=0.1:0.9:14"]);
    place.done(&["view", "p", "--case", "13"]);
    assert!(!data(&place.read("p/view.html"))["notes"].to_string().contains("drawn with"));
}

#[test]
fn only_metrics_of_the_same_thing_are_compared() {
    let metric = |of: &str| format!("[[metric]]\nname = \"peak\"\nof = \"{of}\"\nkind = \"max\"\n");
    let place = Place::with(&format!("{ARM}{}", metric("damper.force")));
    place.write("other.toml", format!("{ARM}{}", metric("v.q1")));
    place.done(&["run", "arm.toml", "--out", "a", "--sweep", "element.damper.alpha=0.2,0.5"]);
    place.done(&[
        "run",
        "arm.toml",
        "--out",
        "b",
        "--sweep",
        "element.damper.alpha=0.2,0.5",
        "--set",
        "element.damper.u=4 V",
    ]);
    place.done(&["run", "arm.toml", "--out", "c", "--sweep", "element.damper.E_c=0.2,0.5"]);
    place.done(&["run", "other.toml", "--out", "d", "--sweep", "element.damper.alpha=0.2,0.5"]);
    let has_metrics = |other: &str| {
        place.done(&["report", "a", other, "--out", "c.html"]);
        place.read("c.html").contains(">Metrics</h2>")
    };
    assert!(has_metrics("b") && !has_metrics("c") && !has_metrics("d"));
}

/// A server of a page, ended with the test.
struct Server {
    child: Child,
    address: String,
}

impl Server {
    fn of(place: &Place, results: &str) -> Self {
        let mut command = place.command(&["view", results, "--serve"]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").unwrap().trim_end_matches('/').to_owned();
        Self { child, address }
    }

    fn ask(&self, request: &str) -> TcpStream {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(900))).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        stream
    }

    fn get(&self, path: &str) -> String {
        let mut answer = String::new();
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.address))
            .read_to_string(&mut answer)
            .unwrap();
        answer
    }

    /// The messages of the events from a place on, and the last place that they name.
    fn events(&self, from: &str) -> (Vec<Value>, String) {
        let request = format!("GET /events HTTP/1.1\r\nHost: {}\r\nLast-Event-ID: {from}\r\n\r\n", self.address);
        let (mut messages, mut id) = (Vec::new(), String::new());
        for line in BufReader::new(self.ask(&request)).lines() {
            let line = line.unwrap();
            if let Some(at) = line.strip_prefix("id: ") {
                id = at.to_owned();
            }
            if let Some(data) = line.strip_prefix("data: ") {
                messages.push(serde_json::from_str(data).unwrap());
            }
        }
        (messages, id)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_server_shows_a_run_while_it_is_under_way() {
    let longer = ARM.replace("end = 0.35", "end = 10").replace("\"100 ms\"", "\"5 ms\"");
    assert_ne!(longer, ARM);
    let place = Place::with(&format!("{longer}[solver]\nmax_step = \"0.05 ms\"\n{SWEPT}"));
    let mut run = place.command(&["run", "arm.toml", "--out", "o", "--jobs", "1", "-q"]).spawn().unwrap();
    wait_for("rows", || length(place.path("o/results.csv.part")) >= 4_000);
    // It waits until the page is asked for, however long that takes.
    signal(&run, "-STOP");
    let server = Server::of(&place, "o");
    let page = server.get("/");
    let told = data(&page);
    assert_eq!((&told["status"], &told["follow"]), (&"running".into(), &"/events".into()));
    signal(&run, "-CONT");
    let (messages, id) = server.events("");
    assert!(run.wait().unwrap().success());
    // Every row of every case, as the file has them.
    let names: Vec<&str> =
        told["columns"].as_array().unwrap().iter().map(|column| column["name"].as_str().unwrap()).collect();
    let table = place.table("o/results.csv");
    let force = names.iter().position(|name| *name == "damper.force").unwrap();
    let rows: Vec<f64> = messages
        .iter()
        .filter_map(|message| message["rows"].as_array())
        .flatten()
        .map(|row| row[force].as_f64().unwrap())
        .collect();
    assert_eq!(rows, table.numbers("damper.force"));
    let cases: Vec<&Value> = messages.iter().filter(|message| message["cases"].is_array()).collect();
    assert_eq!(cases.len(), 1);
    assert_eq!(cases[0]["cases"][0]["index"], 1);
    assert_eq!(messages.last().unwrap()["status"], "done");
    let whole = fs::metadata(place.path("o/results.csv")).unwrap().len();
    assert_eq!(id.rsplit('@').next(), Some(&*whole.to_string()));
    // The same server shows what has ended.
    let ended = data(&server.get("/"));
    assert_eq!((&ended["status"], &ended["follow"]), (&"done".into(), &Value::Null));
    assert_eq!(server.events("").0, [serde_json::json!({ "status": "done" })]);
    assert!(server.get("/../etc/passwd").starts_with("HTTP/1.1 404 "));
    let mut answer = String::new();
    server.ask("GET / HTTP/1.1\r\nHost: example.org\r\n\r\n").read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 403 "), "{answer}");
}

#[test]
fn a_server_survives_its_clients_and_bad_results() {
    let place = swept();
    let server = Server::of(&place, "o");
    let answer = |request: &str| {
        let mut answer = String::new();
        server.ask(request).read_to_string(&mut answer).unwrap();
        answer
    };
    let host = &server.address;
    let page = server.get("/");
    assert!(
        page.contains("\r\nX-Frame-Options: DENY\r\n") && page.contains("frame-ancestors 'none'"),
        "{}",
        &page[..400]
    );
    for (headers, status) in [
        (format!("Host: {host}\r\nHost: {host}\r\n"), "400"),
        (format!("Host: {host}\r\nSec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\n"), "403"),
        (format!("Host: {host}\r\nSec-Fetch-Dest: iframe\r\n"), "403"),
        (format!("Host: {host}\r\nX: {}\r\n", "a".repeat(100_000)), "431"),
    ] {
        let answer = answer(&format!("GET / HTTP/1.1\r\n{headers}\r\n"));
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{headers:.80}: {answer}");
    }
    // More than are answered at a time are told so, after their request was heard.
    let waiting: Vec<TcpStream> = (0..32).map(|_| server.ask("GET / HTTP/1.1\r\nX: ")).collect();
    let told = std::iter::repeat_with(|| {
        answer(&format!("GET / HTTP/1.1\r\nHost: {host}\r\nX: {}\r\n\r\n", "a".repeat(9000)))
    });
    let told: Vec<String> = told.take(3).collect();
    assert!(told.iter().all(|answer| answer.starts_with("HTTP/1.1 503 ")), "{:.80}", told[0]);
    drop(waiting);
    // What is no file is not waited for.
    fs::remove_file(place.path("o/results.csv")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(place.path("o/results.csv")).status().unwrap().success());
    wait_for("404", || server.get("/").starts_with("HTTP/1.1 404 "));
    assert!(place.springpot(&["view", "o"]).stderr.contains("it is no ordinary file"));
}

#[test]
fn a_server_ends_as_one_that_was_interrupted() {
    let place = swept();
    for signal in ["-TERM", "-INT"] {
        let mut server = Server::of(&place, "o");
        let id = server.child.id().to_string();
        assert!(std::process::Command::new("kill").args([signal, &id]).status().unwrap().success());
        assert_eq!(server.child.wait().unwrap().code(), Some(130), "{signal}");
    }
}
