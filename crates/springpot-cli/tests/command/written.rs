//! Files that commands write: whole or not there, through links, and into what is no file.

use crate::support::{Ended, Place, ended, signal, wait_for};
use std::fs;
use std::io::Write as _;
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Child, Command, Stdio};

const PRONY: [&str; 11] =
    ["prony", "--order", "0.5", "--coefficient", "50", "--from", "1e-3", "--to", "10", "--format", "csv"];
const DERIVATIVE: [&str; 6] = ["derivative", "x.csv", "--column", "x", "--order", "0.5"];

/// A folder with samples in x.csv.
fn with_samples() -> Place {
    let place = Place::new();
    let rows = (0..400).map(|k| f64::from(k) * 0.01).map(|t| format!("{t},{}\n", (3.0 * t).sin()));
    place.write("x.csv", format!("t,x\n{}", rows.collect::<String>()));
    place
}

/// What the command prints without `--out`.
fn printed(place: &Place, arguments: &[&str]) -> String {
    place.done(arguments).stdout
}

fn in_time(place: &Place, arguments: &[&str]) -> Ended {
    let mut command = place.command(arguments);
    ended(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
}

fn pipe(place: &Place, name: &str) {
    assert!(Command::new("mkfifo").arg(place.path(name)).status().unwrap().success());
}

fn is_pipe(path: &Path) -> bool {
    path.symlink_metadata().unwrap().file_type().is_fifo()
}

#[test]
fn devices_and_pipes_are_written_to() {
    let place = with_samples();
    pipe(&place, "pipe");
    symlink("/dev/null", place.path("null")).unwrap();
    for command in [&DERIVATIVE[..], &PRONY] {
        let text = printed(&place, command);
        let to = |out| [command, &["--out", out]].concat();
        assert_eq!(in_time(&place, &to("null")).code, Some(0));
        assert_eq!(fs::read_link(place.path("null")).unwrap(), Path::new("/dev/null"));

        let reader = Command::new("cat").arg(place.path("pipe")).stdout(Stdio::piped()).spawn().unwrap();
        assert_eq!(in_time(&place, &to("pipe")).code, Some(0));
        assert_eq!(String::from_utf8(reader.wait_with_output().unwrap().stdout).unwrap(), text);
        assert!(is_pipe(&place.path("pipe")));
        // A reader that has seen enough is no error.
        let reader = Command::new("head").arg("-c1").arg(place.path("pipe")).stdout(Stdio::piped()).spawn().unwrap();
        assert_eq!(in_time(&place, &to("pipe")).code, Some(0));
        assert_eq!(reader.wait_with_output().unwrap().stdout.len(), 1);
    }
    // A folder is neither.
    let refused = place.springpot(&[&PRONY[..], &["--out", "."]].concat());
    assert!(refused.code == Some(1) && refused.stderr.contains(". cannot be written: is a directory"), "{refused:?}");
    assert_eq!(place.files("."), ["arm.toml", "null", "pipe", "x.csv"]);
}

#[cfg(target_os = "linux")]
#[test]
fn open_descriptors_are_written_to() {
    let place = with_samples();
    // Through a link of the test's own: whatever replaces it does no harm.
    symlink("/dev/stdout", place.path("stdout")).unwrap();
    for command in [&DERIVATIVE[..], &PRONY] {
        let text = printed(&place, command);
        let arguments = [command, &["--out", "stdout"]].concat();
        assert_eq!(printed(&place, &arguments), text);
        // A file that stdout appends to keeps what it has.
        place.write("log", "before\n");
        let log = fs::File::options().append(true).open(place.path("log")).unwrap();
        assert!(place.command(&arguments).stdout(log).status().unwrap().success());
        assert_eq!(place.read("log"), format!("before\n{text}"));
    }
    let starter = printed(&place, &["init", "--out", "stdout"]);
    place.done(&["init", "--out", "s.toml"]);
    assert_eq!(starter, place.read("s.toml"));
}

#[test]
fn links_are_followed_and_rights_are_kept() {
    let place = with_samples();
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    place.done(&["man", "--out", "man"]);
    fs::create_dir(place.path("far")).unwrap();
    for (name, arguments) in [
        ("d.csv", [&DERIVATIVE[..], &["--out", "d.csv"]].concat()),
        ("p.csv", [&PRONY[..], &["--out", "p.csv"]].concat()),
        ("f.svg", ["plot", "r", "damper.force", "--out", "f.svg"].to_vec()),
        ("man/springpot.1", ["man", "--out", "man"].to_vec()),
    ] {
        place.done(&arguments);
        let (text, file) = (place.read(name), place.path(name));
        // A new file has the rights that the umask leaves.
        let fresh = place.path("fresh");
        fs::write(&fresh, "").unwrap();
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&file), mode(&fresh), "{name}");

        fs::remove_file(&file).unwrap();
        let target = place.path("far/target");
        fs::write(&target, "old").unwrap();
        fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&target, &file).unwrap();
        place.done(&arguments);
        assert_eq!((mode(&target), place.files("far")), (0o640, vec!["target".to_owned()]), "{name}");
        assert_eq!(fs::read_to_string(&target).unwrap(), text, "{name}");
        // A link to what is not there yet is followed too.
        fs::remove_file(&target).unwrap();
        place.done(&arguments);
        assert_eq!(fs::read_to_string(&target).unwrap(), text, "{name}");
        assert!(file.symlink_metadata().unwrap().is_symlink(), "{name}");
        fs::remove_file(&file).unwrap();
    }
}

/// The program where no file may grow, as on a full disk.
fn without_room(place: &Place, arguments: &[&str]) -> Ended {
    let mut shell = Command::new("sh");
    shell.current_dir(place.path("")).args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\""]);
    Ended::from(shell.arg(env!("CARGO_BIN_EXE_springpot")).args(arguments).output().unwrap())
}

#[test]
fn a_full_disk_leaves_what_was_there() {
    let place = with_samples();
    place.done(&["run", "arm.toml", "--out", "r", "--quiet"]);
    fs::create_dir(place.path("man")).unwrap();
    let kept = ["d.csv", "p.csv", "f.svg", "f.png", "man/springpot-run.1"];
    kept.iter().for_each(|name| place.write(name, "earlier"));
    let before = place.files(".");
    for arguments in [
        [&DERIVATIVE[..], &["--out", "d.csv"]].concat(),
        [&DERIVATIVE[..], &["--scheme", "exponential", "--out", "d.csv"]].concat(),
        [&PRONY[..], &["--out", "p.csv"]].concat(),
        ["plot", "r", "damper.force", "--out", "f.svg"].to_vec(),
        ["plot", "r", "damper.force", "--out", "f.png"].to_vec(),
        ["man", "--out", "man"].to_vec(),
        ["init"].to_vec(),
    ] {
        let failed = without_room(&place, &arguments);
        assert_eq!((failed.code, failed.stdout.as_str()), (Some(1), ""), "{arguments:?}: {}", failed.stderr);
        assert!(failed.stderr.contains("cannot be written") && failed.stderr.contains("os error"), "{}", failed.stderr);
        assert!(!failed.stderr.contains(".part"), "{}", failed.stderr);
    }
    assert_eq!(place.files("."), before);
    kept.iter().for_each(|name| assert_eq!(place.read(name), "earlier", "{name}"));
    // What failed is no obstacle later.
    place.done(&["init"]);
    assert!(place.read("scenario.toml").contains("[[element]]"));
}

#[test]
fn files_of_others_stay() {
    let place = with_samples();
    place.write("d.csv.part", "mine");
    place.done(&[&DERIVATIVE[..], &["--out", "d.csv"]].concat());
    place.write("bad.csv", "t,x\n0,1\n1,2\n2,?\n");
    let refused = place.springpot(&["derivative", "bad.csv", "--column", "x", "--order", "1", "--out", "d.csv"]);
    assert_eq!(refused.code, Some(2));
    assert_eq!(place.read("d.csv.part"), "mine");
    assert_eq!(place.table("d.csv").rows.len(), 400);
    assert_eq!(place.files("."), ["arm.toml", "bad.csv", "d.csv", "d.csv.part", "x.csv"]);
    // A link that leads nowhere is somebody's too.
    symlink("nowhere.toml", place.path("scenario.toml")).unwrap();
    let refused = place.springpot(&["init"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("is there already"), "{}", refused.stderr);
}

/// A derivative of rows that do not end, under way to d.csv.
fn under_way(place: &Place) -> (Child, std::process::ChildStdin) {
    let arguments = ["derivative", "-", "--column", "x", "--order", "0.5", "--scheme", "exponential", "--out", "d.csv"];
    let mut command = place.command(&arguments);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    input.write_all(place.read("x.csv").as_bytes()).unwrap();
    wait_for("a file", || place.files(".").iter().any(|name| name.starts_with(".springpot-")));
    (child, input)
}

#[test]
fn an_end_on_the_way_leaves_what_was_there() {
    let place = with_samples();
    place.write("d.csv", "earlier");
    let before = place.files(".");
    let (child, input) = under_way(&place);
    signal(&child, "-INT");
    assert_eq!(ended(child).code, Some(130));
    drop(input);
    assert_eq!((place.files("."), place.read("d.csv")), (before.clone(), "earlier".to_owned()));

    // Nothing can be tidied up after a kill; what is left is in nobody's way.
    let (mut child, input) = under_way(&place);
    child.kill().unwrap();
    child.wait().unwrap();
    drop(input);
    assert_eq!(place.read("d.csv"), "earlier");
    assert_eq!(place.files(".").len(), before.len() + 1);
    place.done(&[&DERIVATIVE[..], &["--out", "d.csv"]].concat());
    assert_eq!(place.table("d.csv").rows.len(), 400);
}

#[test]
fn a_pipe_where_a_file_should_be_is_refused_at_once() {
    let place = with_samples();
    pipe(&place, "pipe");
    pipe(&place, "pipe.toml");
    place.write("urdf.toml", "[robot]\nurdf = \"pipe\"\n");
    let robot = crate::support::testdata("multibody/double_pendulum.urdf");
    let motion = "motion.joints.q1={csv=\"pipe\", column=\"x\"}";
    for arguments in [
        &["check", "arm.toml", "--set", motion][..],
        &["run", "arm.toml", "--set", motion],
        &["check", "pipe"],
        &["run", "pipe"],
        &["info", "urdf.toml"],
        &["info", "pipe"],
        &["init", "pipe"],
        &["dynamics", "pipe.toml", "--at", "0"],
        &["dynamics", &robot, "--states", "pipe"],
        &["dynamics", &robot, "--states", "/dev/zero"],
        &["plot", "pipe", "x"],
    ] {
        let refused = in_time(&place, arguments);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{arguments:?}: {}", refused.stderr);
        assert!(refused.stderr.contains("not a regular file"), "{arguments:?}: {}", refused.stderr);
    }
    // Results whose record is a pipe have none.
    fs::create_dir(place.path("r")).unwrap();
    place.write("r/results.csv", "t,x\n0,1\n1,2\n");
    pipe(&place, "r/run.json");
    let drawn = in_time(&place, &["plot", "r", "x"]);
    assert!(drawn.code == Some(0) && drawn.stderr.contains("no run.json"), "{}", drawn.stderr);
}

#[test]
fn states_without_end_are_refused() {
    let place = Place::new();
    let robot = crate::support::testdata("multibody/double_pendulum.urdf");
    let mut command = place.command(&["dynamics", &robot, "--states", "-"]);
    let zeros = fs::File::open("/dev/zero").unwrap();
    let refused = ended(command.stdin(zeros).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.starts_with("error: standard input: larger than 256 MiB"), "{}", refused.stderr);
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_printed_is_a_failure() {
    let place = with_samples();
    for arguments in [
        &["--help"][..],
        &["--version"],
        &["run", "--help"],
        &["help", "check"],
        &["check", "arm.toml"],
        &["check", "--schema"],
        &["info", "arm.toml"],
        &["dynamics", "arm.toml", "--at", "0.1"],
        &DERIVATIVE,
        &PRONY,
        &["laws"],
        &["init"],
        &["completions", "zsh"],
        &["man"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let failed = Ended::from(place.command(arguments).stdout(full).stderr(Stdio::piped()).output().unwrap());
        assert_eq!(failed.code, Some(1), "{arguments:?}: {}", failed.stderr);
        assert!(failed.stderr.contains("error: the results cannot be written: "), "{arguments:?}: {}", failed.stderr);
    }
}
