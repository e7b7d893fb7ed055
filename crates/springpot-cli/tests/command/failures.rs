//! Runs that fail, and input that is refused: exit codes, messages, and what is left behind.

use crate::support::{ARM, Csv, Ended, Place};
use std::process::Stdio;

/// A file with one edit, which must hit exactly once.
fn edited(from: &str, to: &str) -> String {
    assert_eq!(ARM.matches(from).count(), 1, "{from:?}");
    ARM.replace(from, to)
}

#[test]
fn a_failing_case_does_not_stop_the_others() {
    // Below -2.5 the coefficient mu_0 + u·mu is negative; the second case gets there on the way, the third never starts.
    let sweep = "[[sweep]]\nparameter = \"element.damper.u\"\nvalues = [\"1 V\", \"1 - 20*t\", \"-3 V\", \"2 V\"]\n";
    let place = Place::with(&format!("{ARM}{sweep}"));
    for jobs in ["1", "3"] {
        let ended = place.springpot(&["run", "arm.toml", "--jobs", jobs]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        let errors: Vec<&str> = ended.stderr.lines().collect();
        assert!(
            errors[0].starts_with("error: arm.toml:38:18: element.damper.u = 1 - 20*t and 1 other case: t = 0.17")
                && errors[0].contains("mu_0 + u·mu"),
            "{errors:?}"
        );
        let help = errors[errors.len() - 2];
        assert!(help.starts_with("  help: change the input or the parameters"), "{errors:?}");
        assert_eq!(
            errors[errors.len() - 1..],
            ["failed: 2 of 4 cases done, 2 failed, the earliest before the first row; all rows are complete"]
        );
        assert!(ended.stdout.contains("\n4 cases, 12 rows, "), "{}", ended.stdout);

        let results = place.table("results/arm/results.csv");
        let of = |u: &str| results.texts("element.damper.u").iter().filter(|text| **text == u).count();
        assert_eq!((of("1"), of("1 - 20*t"), of("-3"), of("2")), (5, 2, 0, 5));
        let record = place.record("results/arm");
        assert_eq!((&record["status"], record["t_reached"].is_null()), (&"failed".into(), true));
        assert_eq!((&record["cases_done"], &record["cases_failed"]), (&2.into(), &2.into()));
        let statuses: Vec<&str> =
            record["cases"].as_array().unwrap().iter().map(|c| c["status"].as_str().unwrap()).collect();
        assert_eq!(statuses, ["done", "failed", "failed", "done"]);
        let second = &record["cases"][1];
        assert_eq!(second["t_reached"], 0.1);
        assert!(second["error"].as_str().unwrap().contains("t = 0.17"), "{second}");
    }
}

#[test]
fn a_single_run_that_fails_keeps_its_rows() {
    // The two points meet at t = 0.25 s.
    let text = ARM
        .replace("point = [-0.4, 0.3, 0]", "point = [-0.4, 0, 0]")
        .replace("point = [0, 0.3, 0]", "point = [0, 0, 0.5]")
        .replace("x = \"0.05 - 0.05*cos(6*t)\"", "x = \"0.25 - t\"");
    let place = Place::with(&text);
    let ended = place.springpot(&["run", "arm.toml"]);
    assert_eq!(ended.code, Some(1));
    let lines: Vec<&str> = ended.stderr.lines().collect();
    let (warning, how_far) = (lines[0], lines[lines.len() - 1]);
    let (error, help) = (lines[2], lines[lines.len() - 2]);
    // Where its points stand.
    assert!(lines.iter().any(|line| line.contains("22 │ from = {")), "{}", ended.stderr);
    assert!(warning.starts_with("warning: element \"damper\" starts with a stroke of -0.25 m"), "{warning}");
    assert!(help.starts_with("  help: a force along a line needs a length"), "{help}");
    assert!(
        error.starts_with("error: arm.toml:22:8: t = 0.2") && error.contains("element \"damper\" has no direction"),
        "{error}"
    );
    assert_eq!(how_far, "failed after the row at t = 0.2 s of 0.35 s; all rows are complete");
    assert_eq!(place.table("results/arm/results.csv").numbers("t"), [0.0, 0.1, 0.2]);
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
    let record = place.record("results/arm");
    assert_eq!((&record["status"], &record["t_reached"]), (&"failed".into(), &0.2.into()));
}

/// The arm with its gripper on a path that it cannot follow to the end.
fn unreachable() -> String {
    let at = ARM.find("[motion]").unwrap();
    let path = "[motion]\nkind = \"gripper-path\"\nx = \"0.4 + 2*t\"\ny = \"step(t - 0.25)*(t - 0.25)\"\nz = 0.5\nguess = { x = 0.1 }\n";
    format!("{}{path}\n[time]\nend = 1\noutput_step = 0.1\n", &ARM[..at])
}

#[test]
fn a_path_out_of_reach_is_named_with_time_and_distance() {
    let place = Place::with(&unreachable());
    let ended = place.springpot(&["run", "arm.toml"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains(": the gripper cannot reach its path at t = 0.25"), "{}", ended.stderr);
    assert!(
        ended.stderr.contains(" m away; bring the path nearer")
            && ended.stderr.contains("after the row at t = 0.2 s of 1 s"),
        "{}",
        ended.stderr
    );
    assert_eq!(place.table("results/arm/results.csv").numbers("t"), [0.0, 0.1, 0.2]);
    let check = place.springpot(&["check", "arm.toml"]);
    assert_eq!(check.code, Some(1));
    assert!(check.stderr.contains(": the gripper cannot reach its path at t = 0.25"), "{}", check.stderr);
}

#[test]
fn a_controllers_path_out_of_reach_is_found_by_check() {
    let text = unreachable();
    let at = text.find("kind = \"gripper-path\"").unwrap();
    let end = text.find("\n[time]").unwrap();
    let keys = text[at..end].trim_end().replace(['\n', '\r'], ", ");
    let forward = format!(
        "{}kind = \"forward\"\nstart = {{ q = {{ x = 0.1 }} }}\n[motion.controller]\nkind = \"pd-gravity\"\nkp = 100\nreference = {{ {keys} }}\n{}",
        &text[..at],
        &text[end..]
    );
    let place = Place::with(&forward);
    let line = forward.lines().position(|line| line.starts_with("reference")).unwrap() + 1;
    for command in ["check", "run"] {
        let ended = place.springpot(&[command, "arm.toml"]);
        let said = &ended.stderr;
        assert_eq!(ended.code, Some(1), "{said}");
        assert!(said.contains(": the gripper cannot reach its path at t = 0.25"), "{said}");
        assert!(said.contains(&format!("arm.toml:{line}:13")), "{said}");
    }
}

/// The arm falls, so that torques and inputs may follow from its state.
fn falling() -> String {
    let [motion, time] = ["[motion]", "[time]"].map(|head| ARM.find(head).unwrap());
    let forward = "[motion]\nkind = \"forward\"\nstart = { q = { x = 0.1 } }\n";
    format!("{}{forward}{}", &ARM[..motion], &ARM[time..])
}

#[test]
fn what_stops_a_run_names_its_place() {
    let place = Place::with(&falling());
    let input = "element.damper.u={ expression = \"1/(q.x - 0.1)\", sample = \"10 ms\" }";
    let guard = "keep it finite wherever the motion comes: guard what divides";
    for (set, words, help) in [
        (&["element.damper.u=1/(q.x - 0.1)"][..], "t = 0 s: damper.u is ", guard),
        (&[input], "t = 0 s: damper.u is ", guard),
        (&["motion.torque.x=exp(1000*(1 + q.x))"], "t = 0 s: tau.x is inf", guard),
        (&["element.damper.u=1/(q.x - 0.1)", "solver.method=midpoint", "solver.step=1 ms"], "damper.u is ", guard),
        (
            &["motion.torque.q1=-30*sign(v.q1)", "robot.gravity=[0, 0, 0]"],
            "the expression \"-30*sign(v.q1)\" of tau.q1 switches again and again",
            "error: --set:1:18: ",
        ),
        (
            &[
                "motion.controller={ kind = \"pd-gravity\", kp = 1e300, reference = { kind = \"move\", to = { x = 0.2 }, duration = 1 } }",
            ],
            "error: t = 1.",
            "no step meets the tolerance",
        ),
        (
            &[
                "motion.controller={ kind = \"computed-torque\", kp = 1, reference = { kind = \"move\", to = { x = 0.2 }, duration = 1e-30 } }",
            ],
            "times too much in joint",
            "a duration or a capacity that is too small",
        ),
        (
            &[
                "element.damper.expansion={ coefficient = 1e-3, T_ref = 300 }",
                "element.damper.T=300 + 10*step(t - 0.1)",
            ],
            "it expands by a temperature that does not jump",
            "error: --set:1:18: ",
        ),
    ] {
        let sets = set.iter().flat_map(|set| ["--set", set]);
        let arguments: Vec<&str> = ["run", "arm.toml", "--quiet"].into_iter().chain(sets).collect();
        let ended = place.springpot(&arguments);
        let said = ended.said();
        assert!(ended.code != Some(0) && said.contains(words) && said.contains(help), "{set:?}: {said}");
        assert!(!said.contains("stick = true") && !said.contains("0.00000000"), "{set:?}: {said}");
        if help == guard {
            assert!(
                said.contains("help: keep it")
                    && (said.contains("error: --set:1:18: ") || said.contains("error: --set:1:17: ")),
                "{said}"
            );
        }
    }
}

#[test]
fn a_path_that_is_lost_at_once_keeps_its_start() {
    let place = Place::with(&unreachable().replace("\"step(t - 0.25)*(t - 0.25)\"", "\"1e9*t\""));
    for command in ["run", "check"] {
        let ended = place.springpot(&[command, "arm.toml"]);
        assert_eq!(ended.code, Some(1));
        assert!(ended.stderr.contains(": the gripper cannot reach its path at t = "), "{}", ended.stderr);
    }
    assert_eq!(place.table("results/arm/results.csv").numbers("t"), [0.0]);
    // Lengths beyond all numbers lead nowhere, and not for ever.
    let ended = place.springpot(&["check", "arm.toml", "--set", "robot.body.arm.joint.origin=[0, 1.7e308, 0]"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
}

/// One of each class of refusals: edit, place, and words of the message.
#[test]
fn refusals_name_file_line_and_column_and_mark_the_place() {
    let cases: &[(&str, &str, &str, &str)] = &[
        ("rest_length = ", "rest_lenght = ", "24:1", "unknown key `rest_lenght`"),
        ("law = \"magnetorheological\"", "law = \"magnetorheologic\"", "25:7", "did you mean `magnetorheological`?"),
        ("to = { body = \"slide\"", "to = { body = \"sled\"", "23:15", "did you mean `slide`?"),
        ("joints = { q1", "joints = { q7 = 0, q1", "31:12", "unknown key `q7`"),
        ("inputs = { u =", "inputs = { w = 1, u =", "27:12", "unknown key `w`"),
        ("20*t)\" }", "20*t) + sine(t)\" }", "27:37", "unknown name `sine`; did you mean `sin`?"),
        ("mass = 2\n", "mass = \"2 m\"\n", "10:11", "`mass` of body \"arm\": `m` does not fit: this place takes `kg`"),
        ("mass = 2\n", "mass = true\n", "10:8", "not the boolean true"),
        (
            "joints = { q1 = \"0.3*sin(4*t)\", x = \"0.05 - 0.05*cos(6*t)\" }",
            "joints = {}",
            "31:10",
            "leaves out the joints q1, x",
        ),
        ("alpha = 0.5", "alpha = 1.5", "26:59", "is 1.5, outside 0 … 1"),
        ("axis = [0, 1, 0]", "axis = [0, 0, 0]", "9:50", "has no direction"),
        ("end = 0.35", "end = 0", "34:7", "must be positive"),
        ("output_step = \"100 ms\"", "output_step = -1", "35:15", "must be positive"),
        ("com = [0.2, 0, 0]", "com = [nan, 0, 0]", "11:8", "is nan, not a finite number"),
        ("com = [0.2, 0, 0]", "com = [inf, 0, 0]", "11:8", "is inf, not a finite number"),
        ("mass = 2\n", "mass = -2\n", "10:8", "mass of body \"arm\" is -2; it must be 0 or more"),
        ("name = \"damper\"", "name = \"energy\"", "21:8", "which the columns of the results use"),
        ("end = 0.35", "end = = 0.35", "34:7", "not TOML"),
        ("output_step = \"100 ms\"", "output_step = 1e-12", "35:15", "at most 20000000"),
        ("kind = \"prescribed\"", "kind = \"forward\"", "31:1", "unknown key `joints` in [motion]"),
    ];
    for (from, to, position, words) in cases {
        let place = Place::with(&edited(from, to));
        for command in ["run", "check"] {
            let Ended { code, stdout, stderr, .. } = place.springpot(&[command, "arm.toml"]);
            assert_eq!((code, stdout.as_str()), (Some(2), ""), "{to}: {stderr}");
            assert!(stderr.contains(&format!("error: arm.toml:{position}: ")), "{to}: {stderr}");
            assert!(stderr.contains(words), "{to}: {stderr}");
            // The offending line stands under its number, and the mark under the line.
            let (line, _) = position.split_once(':').unwrap();
            let shown = stderr.lines().position(|shown| shown.trim_start().starts_with(&format!("{line} │"))).unwrap();
            assert!(stderr.lines().nth(shown + 1).unwrap().contains(['┬', '─', '▲']), "{to}: {stderr}");
        }
        assert!(!place.path("results").exists(), "{to}: nothing may be written");
    }
}

#[test]
fn overrides_are_refused_where_they_stand() {
    let place = Place::new();
    for (set, words) in [
        ("element.damper.alfa=0.5", "--set:1:1: path \"element.damper.alfa\": `element.damper` has no `alfa`\n"),
        ("element.damper.alfa=0.5", "did you mean `alpha`?"),
        ("element.dumper.alpha=0.5", "did you mean `damper`?"),
        ("element.damper.alpha=2", "--set:1:22: `alpha` of `parameters` of element \"damper\""),
        ("element.damper.alpha", "has no `=`"),
        ("element.damper.alpha=", "needs the parameters alpha"),
        ("=3", "has no path"),
        ("time.end=1 m", "--set:1:12: "),
        ("motion.joints.q1=log(0.1 - t)", "is not finite at t = 0.1"),
    ] {
        let ended = place.springpot(&["run", "arm.toml", "--set", set]);
        assert_eq!(ended.code, Some(2), "{set}");
        assert!(ended.stderr.contains(words), "{set}: {}", ended.stderr);
    }
}

#[test]
fn files_that_are_none_are_refused() {
    let place = Place::new();
    place.write("empty.toml", "");
    place.write("binary.toml", (0..4000u32).map(|k| (k * k % 251) as u8).collect::<Vec<_>>());
    place.write("latin.toml", b"title = \"Gr\xf6\xdfe\"\n");
    place.write("large.toml", vec![b' '; (4 << 20) + 1]);
    std::fs::create_dir(place.path("folder.toml")).unwrap();
    for (file, words) in [
        ("none.toml", "error: none.toml: cannot be opened: "),
        ("folder.toml", "error: folder.toml: cannot be "),
        ("empty.toml", "error: empty.toml:1:1: the scenario has no `robot`"),
        ("binary.toml", "error: binary.toml:1:"),
        ("latin.toml", "error: latin.toml:1:12: not UTF-8"),
        ("large.toml", "error: large.toml: larger than 4 MiB"),
    ] {
        for command in ["run", "check"] {
            let ended = place.springpot(&[command, file]);
            assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{file}: {}", ended.stderr);
            assert!(ended.stderr.contains(words), "{file}: {}", ended.stderr);
            assert!(ended.stderr.len() < 4_000, "{file}: {} bytes of complaint", ended.stderr.len());
            assert!(
                ended.stderr.chars().all(|c| c == '\n' || c == '\t' || !c.is_control()),
                "{file}: {:?}",
                ended.stderr
            );
        }
    }
    assert!(!place.path("results").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_said() {
    let place = Place::new();
    place.write("file", "in the way");
    for out in ["file", "file/below"] {
        let ended = place.springpot(&["run", "arm.toml", "--out", out]);
        assert_eq!(ended.code, Some(1), "{out}");
        assert!(
            ended.stderr.starts_with("error: the results cannot be written to ") && ended.stderr.contains(out),
            "{}",
            ended.stderr
        );
    }
    assert_eq!(place.read("file"), "in the way");
}

#[test]
fn files_of_others_are_refused_and_stay() {
    let figure = "[[figure]]\nname = \"motion\"\ny = \"damper.force\"\n";
    for name in [
        "results.csv",
        "results.parquet",
        "results.npz",
        "results.csv.part",
        "summary.csv",
        "run.json",
        "figures/motion.svg",
        "checkpoint/run",
        "checkpoint/case-7",
    ] {
        let place = Place::with(&format!("{ARM}{figure}"));
        std::fs::create_dir_all(place.path("out").join(name).parent().unwrap()).unwrap();
        place.write(&format!("out/{name}"), "mine");
        let ended = place.springpot(&["run", "arm.toml", "--out", "out", "--checkpoint-every", "1"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{name}: {}", ended.stderr);
        let named = format!("error: out/{}", if name.starts_with("checkpoint") { "checkpoint" } else { name });
        assert!(ended.stderr.starts_with(&named) && ended.stderr.contains("--out"), "{name}: {}", ended.stderr);
        assert_eq!(place.files("out"), [name]);
        assert_eq!(place.read(format!("out/{name}")), "mine");
    }
    // Others' files of other names are in nobody's way.
    let place = Place::with(&format!("{ARM}{figure}"));
    place.write("notes.txt", "mine");
    std::fs::create_dir_all(place.path("checkpoint")).unwrap();
    place.write("checkpoint/case-7", "mine");
    place.done(&["run", "arm.toml", "--out", "."]);
    assert_eq!((place.read("notes.txt"), place.read("checkpoint/case-7")), ("mine".into(), "mine".into()));
}

#[test]
fn what_a_scenario_reads_is_not_replaced() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--out", "out", "--set", "time.output_step=0.01"]);
    let rows = place.read("out/results.csv");
    let signal = "inputs = { u = { csv = \"out/results.csv\", column = \"damper.u\" } }";
    place.write("again.toml", edited("inputs = { u = \"1 + 0.5*sin(20*t)\" }", signal));
    let ended = place.springpot(&["run", "again.toml", "--out", "out"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("the scenario reads out/results.csv, which its results would replace"),
        "{}",
        ended.stderr
    );
    assert_eq!(place.read("out/results.csv"), rows);
    place.done(&["run", "again.toml", "--out", "elsewhere"]);
}

#[test]
fn a_failure_before_the_first_row_leaves_the_last_results() {
    let place = Place::new();
    let files = |place: &Place| {
        place.files("results/arm").into_iter().map(|name| place.read(format!("results/arm/{name}"))).collect::<Vec<_>>()
    };
    let fails = ["run", "arm.toml", "--set", "element.damper.u=-3 V", "--checkpoint-every", "0.1"];
    let ended = place.springpot(&fails);
    assert_eq!((ended.code, place.path("results").exists()), (Some(2), false), "{}", ended.stderr);
    assert!(ended.stderr.contains("nothing was run, and earlier results are as they were"), "{}", ended.stderr);
    place.done(&["run", "arm.toml"]);
    let before = files(&place);
    let ended = place.springpot(&fails);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert_eq!(files(&place), before);
    // A refusal, too.
    assert_eq!(place.springpot(&["run", "arm.toml", "--set", "time.end=-1"]).code, Some(2));
    assert_eq!(files(&place), before);
}

#[test]
fn a_closed_pipe_is_no_error() {
    let place = Place::new();
    for arguments in [&["run", "arm.toml"][..], &["check", "arm.toml"], &["--help"], &["run", "--help"], &["--version"]]
    {
        let mut child = place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // Nobody reads: every write finds the pipe closed.
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), stderr.as_ref()), (Some(0), ""), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn full_terminals_are_no_panic() {
    let place = Place::new();
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    for (file, code) in [("arm.toml", 0), ("none.toml", 2)] {
        let status = place.command(&["run", file]).stdout(full()).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(code));
    }
}

#[test]
fn more_jobs_than_make_sense_are_not_started() {
    let place = Place::new();
    let ended = place.done(&["run", "arm.toml", "--jobs", "65535"]);
    assert!(ended.stderr.starts_with("warning: --jobs 65535: no more than "), "{}", ended.stderr);
    assert_eq!(place.done(&["run", "arm.toml", "--jobs", "64"]).stderr, "");
}

#[test]
fn absurd_counts_are_refused_at_once() {
    let sweep = |count: &str| {
        format!("{ARM}[[sweep]]\nparameter = \"element.damper.mu\"\nvalues = {{ from = 1, to = 2, count = {count} }}\n")
    };
    let twice = format!(
        "{}[[sweep]]\nparameter = \"element.damper.mu_0\"\nvalues = {{ from = 1, to = 2, count = 100000 }}\n",
        sweep("100000")
    );
    let cases = [
        (sweep("1000000000"), "is 1000000000, outside 2 … 10000000"),
        (sweep("9223372036854775807"), "outside 2 … 10000000"),
        (twice, "a grid of 10000000000 cases; at most 10000000 are run"),
        (edited("\"100 ms\"", "1e-12"), "makes 350000000000 rows; at most 20000000 are written"),
        (edited("\"100 ms\"", "1e-300"), "rows; at most 20000000 are written"),
        (edited("end = 0.35", "end = 1e300"), "rows; at most 20000000 are written"),
    ];
    for (text, words) in cases {
        let place = Place::with(&text);
        for command in ["run", "check"] {
            let ended = Ended::from(with_little_memory(&place, command).output().unwrap());
            assert_eq!(ended.code, Some(2), "{words}: {}", ended.stderr);
            assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
        }
    }
}

/// The program with 400 MB of address space, most of which are the stacks of its threads, and five seconds of work.
#[cfg(unix)]
fn with_little_memory(place: &Place, command: &str) -> std::process::Command {
    let mut shell = std::process::Command::new("sh");
    shell.current_dir(place.path("")).args(["-c", "ulimit -v 400000 2>/dev/null; ulimit -t 5; exec \"$0\" \"$@\""]);
    shell.args([env!("CARGO_BIN_EXE_springpot"), command, "arm.toml"]);
    shell
}

#[cfg(not(unix))]
fn with_little_memory(place: &Place, command: &str) -> std::process::Command {
    place.command(&[command, "arm.toml"])
}

/// A file system that takes no more: rows that stand there stay, whole ones alone, and so does an earlier result. SIGXFSZ would end the
/// process without a word.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_complete_rows() {
    let sweep = "[[sweep]]\nparameter = \"element.damper.mu\"\nvalues = { from = 1, to = 2, count = 60 }\n";
    let place = Place::new();
    place.done(&["run", "arm.toml"]);
    let before = ["results.csv", "summary.csv", "run.json"].map(|name| place.read(format!("results/arm/{name}")));
    place.write("arm.toml", format!("{ARM}{sweep}"));
    let mut shell = std::process::Command::new("sh");
    shell.current_dir(place.path("")).args(["-c", "ulimit -f 64; exec \"$0\" \"$@\""]).args([
        env!("CARGO_BIN_EXE_springpot"),
        "run",
        "arm.toml",
        "--jobs",
        "4",
        "--set",
        "time.output_step=0.01",
    ]);
    let ended = Ended::from(shell.output().unwrap());
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(
        ended.stderr.starts_with("error: the results cannot be written to ") && ended.stderr.contains("os error"),
        "{}",
        ended.stderr
    );
    assert!(ended.stderr.contains("results.csv.part holds its rows so far; earlier results are as they were"));
    assert!(Csv::new(&place.read("results/arm/results.csv.part")).rows.len() > 20);
    let after = ["results.csv", "summary.csv", "run.json"].map(|name| place.read(format!("results/arm/{name}")));
    assert_eq!(after, before);
    // A run with room replaces what the failed one left.
    place.write("arm.toml", ARM);
    place.done(&["run", "arm.toml"]);
    assert_eq!(place.files("results/arm"), ["results.csv", "run.json", "summary.csv"]);
}
