//! Runs that are interrupted or killed: what they leave behind, and what they say.

use crate::support::{ARM, Csv, ENDLESS, Ended, Place};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for rows, and for the end after a signal.
const PATIENCE: Duration = Duration::from_secs(30);

/// Starts an endless run and waits for its first rows on the disk.
fn started(place: &Place, arguments: &[&str]) -> Child {
    let arguments = [&["run", "arm.toml"], arguments, &ENDLESS].concat();
    let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    let part = place.path("results/arm/results.csv.part");
    while std::fs::metadata(&part).map_or(0, |file| file.len()) < 6_000 {
        assert!(begun.elapsed() < PATIENCE, "no rows after {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(10));
    }
    child
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

fn ended(mut child: Child) -> Ended {
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < PATIENCE, "still running {PATIENCE:?} after the signal");
        std::thread::sleep(Duration::from_millis(10));
    }
    Ended::from(child.wait_with_output().unwrap())
}

#[test]
fn an_interrupted_run_leaves_complete_rows_and_says_how_far_it_came() {
    let place = Place::new();
    let child = started(&place, &[]);
    signal(&child, "-INT");
    let ended = ended(child);
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);

    let times = place.table("results/arm/results.csv").numbers("t");
    assert!(times.len() > 5 && times.windows(2).all(|pair| pair[0] < pair[1]));
    let last = times[times.len() - 1];
    let record = place.record("results/arm");
    assert_eq!((&record["status"], &record["t_reached"]), (&"interrupted".into(), &last.into()));
    assert_eq!(
        (&record["cases"][0]["status"], &record["cases"][0]["rows"]),
        (&"interrupted".into(), &times.len().into())
    );
    assert_eq!(ended.stderr, format!("interrupted after the row at t = {last} s of 1000 s; all rows are complete\n"));
    assert!(ended.stdout.starts_with(&format!("{} rows, ", times.len())), "{}", ended.stdout);
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
    assert_eq!(place.table("results/arm/summary.csv").numbers("max")[0], last);
}

#[test]
fn an_interrupted_sweep_keeps_what_is_done() {
    // The first case is short; the second and third never end, the others never begin.
    let sweep = "[[sweep]]\nparameter = [\"time.end\", \"time.output_step\"]\nvalues = [0.001, 500, 600, 700, 800]\n";
    let place = Place::with(&format!("{}{sweep}", ARM.replace("\"0.3*sin(4*t)\"", "\"0.1*sin(300000*t)\"")));
    let step = place.read("arm.toml").replace("[\"time.end\", \"time.output_step\"]", "\"time.end\"");
    place.write("arm.toml", step.replace("output_step = \"100 ms\"", "output_step = 0.0005"));
    let arguments = ["run", "arm.toml", "--jobs", "2"];
    let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    while std::fs::metadata(place.path("results/arm/results.csv.part")).map_or(0, |file| file.len()) < 4_000 {
        assert!(begun.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(10));
    }
    signal(&child, "-INT");
    let ended = ended(child);
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    let said = "interrupted: 1 of 5 cases done, 2 stopped, the earliest after the row at t = ";
    assert!(
        ended.stderr.starts_with(said) && ended.stderr.ends_with(" s; all rows are complete\n"),
        "{}",
        ended.stderr
    );

    let results = place.table("results/arm/results.csv");
    let (ends, times) = (results.numbers("time.end"), results.numbers("t"));
    let of = |end: f64| ends.iter().zip(&times).filter(|(e, _)| **e == end).map(|(_, t)| *t).collect::<Vec<_>>();
    assert_eq!(of(0.001), [0.0, 0.0005, 0.001]);
    let (second, third) = (of(500.0), of(600.0));
    assert_eq!(3 + second.len() + third.len(), times.len());
    let record = place.record("results/arm");
    let statuses: Vec<_> = record["cases"].as_array().unwrap().iter().map(|case| case["status"].clone()).collect();
    assert_eq!(statuses, ["done", "interrupted", "interrupted"]);
    for (case, rows) in [(1, &second), (2, &third)] {
        assert_eq!(record["cases"][case]["t_reached"].as_f64(), rows.last().copied());
    }
    let earliest = second.last().unwrap().min(third.last().copied().unwrap_or(0.0)).min(0.001);
    assert_eq!((&record["status"], &record["t_reached"]), (&"interrupted".into(), &earliest.into()));
}

#[test]
fn a_killed_run_leaves_parts_and_the_next_one_replaces_them() {
    let place = Place::new();
    place.done(&["run", "arm.toml"]);
    let child = started(&place, &[]);
    signal(&child, "-KILL");
    assert_eq!(ended(child).code, None);
    assert_eq!(place.files("results/arm"), ["results.csv.part", "summary.csv.part"]);
    let text = place.read("results/arm/results.csv.part");
    let whole = &text[..text.rfind('\n').unwrap() + 1];
    assert!(Csv::new(whole).rows.len() > 5);

    place.done(&["run", "arm.toml"]);
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
    assert_eq!(place.table("results/arm/results.csv").rows.len(), 5);
}

#[test]
fn a_gripper_path_that_is_still_followed_hears_it() {
    // Many seconds of inverse kinematics before the first step.
    let at = ARM.find("[motion]").unwrap();
    let path = "[motion]\nkind = \"gripper-path\"\nx = \"0.4 + 0.1*sin(t)\"\ny = 0\nz = 0.5\nguess = { x = 0.1 }\n";
    let time = "[time]\nend = 45\noutput_step = 15\n[solver]\nmax_step = 1e-4\n";
    let place = Place::with(&format!("{}{path}{time}", &ARM[..at]));
    for (command, code) in [("run", Some(130)), ("check", None)] {
        let child =
            place.command(&[command, "arm.toml"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(500));
        let begun = Instant::now();
        signal(&child, "-INT");
        let ended = ended(child);
        assert!(begun.elapsed() < Duration::from_secs(5), "{command}: {:?}", begun.elapsed());
        assert_eq!(ended.code, code, "{command}: {}", ended.stderr);
        assert!(code.is_none() || ended.stderr.starts_with("interrupted before"), "{command}: {}", ended.stderr);
    }
}
