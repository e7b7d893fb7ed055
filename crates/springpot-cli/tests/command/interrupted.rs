//! Runs that are interrupted or killed: what they leave behind, and what they say.

use crate::support::{ARM, Csv, ENDLESS, Place, ended, length, signal, wait_for, worked};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Starts an endless run and waits for its first rows on the disk.
fn started(place: &Place, arguments: &[&str]) -> Child {
    let arguments = [&["run", "arm.toml"], arguments, &ENDLESS].concat();
    let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let part = place.path("results/arm/results.csv.part");
    wait_for("rows", || length(&part) >= 6_000);
    child
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
    let arguments = ["run", "arm.toml", "--jobs", "2", "--set", "solver.max_steps=1000000000000"];
    let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("rows", || length(place.path("results/arm/results.csv.part")) >= 20_000);
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
    let before = ["results.csv", "run.json", "summary.csv"].map(|name| place.read(format!("results/arm/{name}")));
    let child = started(&place, &[]);
    signal(&child, "-KILL");
    assert_eq!(ended(child).code, None);
    // What was there before is there still.
    let after = ["results.csv", "run.json", "summary.csv"].map(|name| place.read(format!("results/arm/{name}")));
    assert_eq!(after, before);
    let text = place.read("results/arm/results.csv.part");
    let whole = &text[..text.rfind('\n').unwrap() + 1];
    assert!(Csv::new(whole).rows.len() > 5);

    place.done(&["run", "arm.toml"]);
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
    assert_eq!(place.table("results/arm/results.csv").rows.len(), 5);
}

#[test]
fn sigterm_and_sighup_end_a_run_as_tidily() {
    // Where these tests run under nohup themselves, what they start does not hear it.
    let names = if ignores_hangup() { &["-TERM"][..] } else { &["-TERM", "-HUP"] };
    for name in names {
        let place = Place::new();
        let child = started(&place, &[]);
        signal(&child, name);
        let ended = ended(child);
        assert_eq!(ended.code, Some(130), "{name}: {}", ended.stderr);
        assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
        assert_eq!(place.record("results/arm")["status"], "interrupted");
        assert!(place.table("results/arm/results.csv").rows.len() > 5);
    }
}

/// Whether this process ignores SIGHUP, the lowest bit of the signals that Linux lists.
fn ignores_hangup() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_under_nohup_outlives_its_terminal() {
    let place = Place::new();
    let mut shell = Command::new("sh");
    shell.current_dir(place.path("")).args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_springpot")]);
    let mut child = shell.args(["run", "arm.toml", "--quiet"]).args(ENDLESS).stderr(Stdio::piped()).spawn().unwrap();
    let part = place.path("results/arm/results.csv.part");
    let rows = || length(&part);
    let wait = |child: &mut Child, least: u64| {
        wait_for("rows", || {
            assert!(child.try_wait().unwrap().is_none());
            rows() >= least
        });
    };
    wait(&mut child, 3_000);
    signal(&child, "-HUP");
    wait(&mut child, rows() + 3_000);
    signal(&child, "-TERM");
    assert_eq!(ended(child).code, Some(130));
}

#[test]
fn a_second_run_into_a_folder_is_refused_and_the_first_is_named() {
    let place = Place::new();
    let first = started(&place, &["--set", "element.damper.mu=5"]);
    let process = format!("springpot run arm.toml, process {} on ", first.id());
    let rows = || place.read("results/arm/results.csv.part").len();
    for arguments in
        [&["run", "arm.toml"][..], &["run", "--resume", "results/arm"], &["run", "arm.toml", "--set", "time.end=1"]]
    {
        let before = rows();
        let second = place.springpot(arguments);
        assert_eq!((second.code, second.stdout.as_str()), (Some(1), ""), "{}", second.stderr);
        let said = second.said();
        assert!(said.starts_with("error: another run writes to results/arm: ") && said.contains(&process), "{said}");
        assert!(said.contains(", since 2") && said.contains("name another folder with --out"), "{said}");
        assert!(rows() >= before && place.path("results/arm/.lock").exists());
    }
    // A killed run locks nobody out.
    signal(&first, "-KILL");
    ended(first);
    assert!(place.path("results/arm/.lock").exists());
    place.done(&["run", "arm.toml"]);
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
}

/// Takes the results away, whatever is written into them meanwhile.
fn removed(place: &Place) {
    while let Err(error) = std::fs::remove_dir_all(place.path("results")) {
        assert_eq!(error.kind(), std::io::ErrorKind::DirectoryNotEmpty, "{error}");
    }
}

/// What was removed does not come back in part, and nothing is left that would refuse the next run.
#[test]
fn a_folder_that_is_removed_under_a_run_is_free_again() {
    for options in [&[][..], &["--checkpoint-every", "0.001"]] {
        let place = Place::with(&format!("{ARM}[[figure]]\ny = \"damper.force\"\n"));
        let child = started(&place, options);
        removed(&place);
        signal(&child, "-INT");
        let ended = ended(child);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(1), ""), "{}", ended.stderr);
        let said = ended.said();
        assert!(said.starts_with("error: results/arm was removed while the run wrote to it"), "{said}");
        assert!(said.ends_with("run it again, into a folder that stays"), "{said}");
        assert!(!place.path("results").exists());
    }
    // Another run may have made it anew.
    let place = Place::new();
    let child = started(&place, &[]);
    removed(&place);
    place.done(&["run", "arm.toml"]);
    let results = place.read("results/arm/results.csv");
    signal(&child, "-INT");
    assert_eq!(ended(child).code, Some(1));
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
    assert_eq!(place.read("results/arm/results.csv"), results);
}

/// Two at once, again and again: one of them runs, or both after each other, and rows and record are of one run.
#[test]
fn two_runs_at_once_never_mix() {
    let place = Place::new();
    let mut refused = 0;
    for turn in 0..12 {
        let set = |mu: &str| format!("element.damper.mu={mu}");
        let children = ["4", "8"].map(|mu| {
            let arguments = ["run", "arm.toml", "--quiet", "--set", &set(mu), "--set", "time.output_step=0.0005"];
            let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
            std::thread::sleep(Duration::from_millis(turn));
            child
        });
        let codes = children.map(|child| ended(child).code);
        assert!(codes.contains(&Some(0)) && codes.iter().all(|code| [Some(0), Some(1)].contains(code)), "{codes:?}");
        refused += codes.iter().filter(|code| **code == Some(1)).count();
        let plan = place.record("results/arm")["plan"].clone();
        let force = place.table("results/arm/results.csv").numbers("damper.force");
        let alone = if codes[1] == Some(0) && codes[0] != Some(0) {
            "8"
        } else if codes[0] == Some(0) && codes[1] != Some(0) {
            "4"
        } else {
            ""
        };
        for (value, out) in [("4", "four"), ("8", "eight")] {
            if turn == 0 {
                place.done(&[
                    "run",
                    "arm.toml",
                    "--quiet",
                    "--out",
                    out,
                    "--set",
                    &set(value),
                    "--set",
                    "time.output_step=0.0005",
                ]);
            }
            let same = place.table(format!("{out}/results.csv")).numbers("damper.force") == force;
            assert_eq!(same, place.record(out)["plan"] == plan, "{codes:?}");
            assert!(alone != value || same, "{codes:?}");
        }
    }
    println!("{refused} of 12 turns refused one");
}

#[cfg(unix)]
#[test]
fn a_gripper_path_that_is_still_followed_hears_it() {
    // A second of inverse kinematics for each of many cases: who does not hear it comes to its end minutes later.
    let at = ARM.find("[motion]").unwrap();
    let path = "[motion]\nkind = \"gripper-path\"\nx = \"0.4 + 0.1*sin(t)\"\ny = 0\nz = 0.5\nguess = { x = 0.1 }\n";
    let time = "[time]\nend = 45\noutput_step = 15\n[solver]\nmax_step = 1e-4\n";
    let sweep = "[[sweep]]\nparameter = \"motion.z\"\nvalues = { from = 0.5, to = 0.51, count = 200 }\n";
    let place = Place::with(&format!("{}{path}{time}{sweep}", &ARM[..at]));
    for (command, says) in [("run", "interrupted"), ("check", "interrupted\n")] {
        hears(&place, command, says);
    }
}

/// A command that works on `arm.toml` ends with 130 at SIGINT, and says so.
#[cfg(unix)]
fn hears(place: &Place, command: &str, says: &str) {
    let mut started = place.command(&[command, "arm.toml"]);
    let (mut child, begun) = (started.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap(), Instant::now());
    wait_for("work", || worked(&child, begun) >= 0.2 || child.try_wait().unwrap().is_some());
    signal(&child, "-INT");
    let ended = ended(child);
    assert_eq!((ended.code, ended.signal), (Some(130), None), "{command}: {}", ended.stderr);
    assert!(ended.stderr.starts_with(says), "{command}: {}", ended.stderr);
}

/// While signals are looked through, Ctrl-C is an interrupt, not a refusal.
#[cfg(unix)]
#[test]
fn signals_that_are_looked_through_hear_it() {
    // Nearly as many kinks as a run may have: minutes.
    let place = Place::with(&ARM.replace("x = \"0.05 - 0.05*cos(6*t)\"", "x = \"0.05*max(0.1, cos(29e6*t))\""));
    for (command, says) in [("run", "interrupted before anything was run"), ("check", "interrupted\n")] {
        hears(&place, command, says);
    }
}
