//! Runs that are killed or interrupted, by all sorts of signals, and go on: the same bytes as without a break.

use crate::support::{ARM, Ended, Place, ended, length, signal, wait_for};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A pendulum on a thermoviscoelastic strut under a torque with kinks, and a figure and a metric of what results.csv does not hold.
const FALLING: &str = r#"
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.5] }
mass = 2
com = [0.2, 0, 0]
inertia = { xx = 0.01, yy = 0.05, zz = 0.05 }
[[element]]
name = "strut"
from = { body = "world", point = [0, 0.1, 0] }
to = { body = "arm", point = [0.3, 0, 0] }
rest_length = "55 cm"
law = "thermoviscoelastic"
parameters = { E_c = "30 N/m", E_kv = "20 N/m", E_d = "50 N*s^alpha/m", alpha = 0.5, a_kv = "0.0007 m/K" }
inputs = { T = "25 degC" }
[motion]
kind = "forward"
torque = { q1 = "2*sign(sin(3*t))" }
[time]
end = 20
output_step = "5 ms"
[solver]
rtol = 1e-7
[output]
columns = ["t", "q.*", "strut.stored", "energy.*"]
[[figure]]
y = "strut.force"
[[metric]]
name = "swing"
of = "strut.rate"
kind = "residual-vibration"
[[metric]]
name = "settle"
of = "q.q1"
kind = "settling-time"
window = ["1 s", "15 s"]
"#;

/// The same pendulum, with limits that it passes and something that nobody uses.
const LIMITED: &str = r#"<robot name="pendulum">
  <link name="base"><visual/></link>
  <link name="arm">
    <inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="q1" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-0.1" upper="0.3" velocity="0.5" effort="1.5"/>
    <safety_controller k_velocity="1"/>
  </joint>
</robot>
"#;

/// Numbers that look random and are always the same, in 0 … 1.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }
}

/// What is left to compare of a run's files: all bytes but those of wall times.
fn files(place: &Place, folder: &str) -> Vec<(String, Vec<u8>)> {
    let names = place.files(folder);
    let bytes = |name: &String| fs::read(place.path(folder).join(name)).unwrap();
    names
        .iter()
        .map(|name| (name.clone(), if name == "run.json" { timeless(place, folder) } else { bytes(name) }))
        .collect()
}

fn timeless(place: &Place, folder: &str) -> Vec<u8> {
    let mut record = place.record(folder);
    let wall = record["wall_time"].take();
    assert!(wall.as_f64().is_some_and(|wall| wall > 0.0));
    for case in record["cases"].as_array_mut().unwrap() {
        case["wall_time"].take();
    }
    record.to_string().into_bytes()
}

fn start(place: &Place, arguments: &[&str]) -> Child {
    place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until the program has ended, or sends it a signal after `life`; `None` where it was killed.
fn live(mut child: Child, life: Duration, signal: &str) -> Option<Ended> {
    let begun = Instant::now();
    while begun.elapsed() < life {
        if child.try_wait().unwrap().is_some() {
            return Some(Ended::from(child.wait_with_output().unwrap()));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).status();
    let ended = Ended::from(child.wait_with_output().unwrap());
    ended.code.is_some().then_some(ended)
}

fn head(place: &Place) -> PathBuf {
    place.path("out/checkpoint/run")
}

/// Runs to the end, then again with kills at all sorts of times, and compares all files; returns the number of kills.
fn killed_and_equal(place: &Place, arguments: &[&str], every: &str, dice: &mut Dice) -> u32 {
    let begun = Instant::now();
    let whole = place.done(&[&["run", "arm.toml", "--out", "whole"], arguments].concat());
    let mut length = begun.elapsed();
    let first = [&["run", "arm.toml", "--out", "out", "--checkpoint-every", every], arguments].concat();
    let jobs = arguments.iter().position(|argument| *argument == "--jobs").map_or(&[][..], |at| &arguments[at..at + 2]);
    let again = [&["run", "--resume", "out"], jobs].concat();
    let mut kills = 0;
    let last = loop {
        let arguments = if head(place).exists() { &again } else { &first };
        // Longer each time: on a busy machine the first lives may all end before another checkpoint.
        let life = (0.1 + 0.5 * dice.roll()) * 1.2_f64.powi(kills as i32);
        let signal = ["-KILL", "-TERM", "-KILL", "-INT", "-HUP"][kills as usize % 5];
        match live(start(place, arguments), length.mul_f64(life), signal) {
            // The machine was busier when the length was measured.
            Some(ended) if ended.code == Some(0) && kills == 0 && length > Duration::from_millis(10) => {
                fs::remove_dir_all(place.path("out")).unwrap();
                length /= 2;
            }
            Some(ended) if ended.code != Some(130) => break ended,
            _ => kills += 1,
        }
        assert!(kills < 50, "never done");
    };
    assert_eq!(last.code, Some(0), "{}", last.stderr);
    assert_eq!(files(place, "out"), files(place, "whole"));
    // What is said counts all rows and steps, too.
    let said = |ended: &Ended| ended.stdout.split(" in ").next().unwrap().to_owned();
    // A kill between the last file and the end leaves nothing to say.
    if !last.stderr.ends_with("nothing is left to do\n") {
        assert_eq!((said(&last), &last.stderr), (said(&whole), &whole.stderr));
    }
    println!("{kills} kills of a run of {length:?}");
    kills
}

#[test]
fn a_killed_robot_falls_on() {
    let place = Place::with(FALLING);
    let kills = killed_and_equal(&place, &[], "200 ms", &mut Dice(1));
    assert!(kills > 0);
}

#[test]
fn a_killed_sweep_goes_on() {
    let sweep = "[[sweep]]\nparameter = [\"element.strut.alpha\"]\nvalues = [0.2, 0.5, 0.8, 0.9]\n";
    let elements = &FALLING[FALLING.find("[[element]]").unwrap()..];
    let place = Place::with(&format!("robot.urdf = \"arm.urdf\"\n{elements}{sweep}"));
    place.write("arm.urdf", LIMITED);
    let kills = killed_and_equal(&place, &["--jobs", "2", "--set", "time.end=10"], "0.5", &mut Dice(2));
    assert!(kills > 0);
    let limits = place.record("out")["limits"].clone();
    assert!(limits.as_array().is_some_and(|limits| limits.len() > 1), "{limits}");

    // What the scenario names must not change either.
    killed(&place);
    place.write("arm.urdf", LIMITED.replace("mass value=\"2\"", "mass value=\"2.1\""));
    assert!(refused(&place).contains("a file that arm.toml names has changed since the run began"));
}

#[test]
fn a_killed_run_keeps_its_events() {
    let events = "[[event]]\nname = \"up\"\nwhen = \"v.q1\"\naction = { set = { \"strut.T\" = \"60 degC\", \"tau.q1\" = 1.5 } }\n\
                  [[event]]\nname = \"clock\"\nwhen = \"sin(2*t)\"\ndirection = \"rising\"\naction = { set = { \"strut.T\" = 293, \"tau.q1\" = -1 } }\n\
                  [[sweep]]\nparameter = [\"element.strut.alpha\"]\nvalues = [0.2, 0.5, 0.8]\n";
    let place = Place::with(&format!("{FALLING}{events}"));
    let kills = killed_and_equal(&place, &["--jobs", "2"], "0.5", &mut Dice(5));
    assert!(kills > 0);
    assert!(place.table("out/events.csv").rows.len() > 30);
}

#[test]
fn a_killed_run_keeps_its_derivatives() {
    let tables = "[[parameter]]\nname = \"order\"\npath = \"element.strut.alpha\"\n\
                  [sensitivity]\nby = [\"order\", \"element.strut.to.point.0\", \"motion.start.v.q1\"]\nof = [\"q.q1\", \"strut.stored\"]\n\
                  [[sweep]]\nparameter = \"element.strut.E_d\"\nvalues = [50, 60, 70]\n";
    let place = Place::with(&format!("{FALLING}{tables}"));
    let kills = killed_and_equal(&place, &["--jobs", "2", "--set", "time.end=10"], "0.5", &mut Dice(6));
    assert!(kills > 0);
    assert_eq!(place.table("out/gradient.csv").rows.len(), 3 * 2 * 3);
    assert_eq!(place.table("out/ranking.csv").rows.len(), 3 * 2 * 3);
}

#[test]
fn a_killed_prescribed_motion_goes_on() {
    let place = Place::with(ARM);
    let set = ["--set", "time.end=20", "--set", "time.output_step=0.01", "--no-figures"];
    let kills = killed_and_equal(&place, &set, "1 s", &mut Dice(3));
    assert!(kills > 0);
}

#[test]
fn a_killed_run_thins_its_curves_as_if_it_were_not() {
    let loops = "[[figure]]\nx = \"strut.stroke\"\ny = \"strut.force\"\n";
    let place = Place::with(&format!("{FALLING}{loops}"));
    // 100 001 rows, more than a curve keeps.
    let kills = killed_and_equal(&place, &["--set", "time.output_step=0.0002"], "1 s", &mut Dice(4));
    assert!(kills > 0);
}

/// A folder `out` with a killed run that has a checkpoint.
fn killed(place: &Place) {
    let endless = ["--set", "time.end=100000", "--set", "time.output_step=0.5"];
    let arguments = [&["run", "arm.toml", "--out", "out", "--checkpoint-every", "0.5"], &endless[..]].concat();
    let mut child = start(place, &arguments);
    wait_for("a checkpoint", || place.path("out/checkpoint/case-0").exists());
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Asserts that nothing is run and nothing changes; returns what is said.
fn refused(place: &Place) -> String {
    let before = all(place);
    let ended = place.springpot(&["run", "--resume", "out"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    assert!(all(place) == before, "{}", ended.stderr);
    ended.stderr
}

fn all(place: &Place) -> Vec<(String, Vec<u8>)> {
    // The lock of a killed run goes with the next one.
    let names = place.files("out").into_iter().filter(|name| name != ".lock");
    names.map(|name| (name.clone(), fs::read(place.path("out").join(name)).unwrap())).collect()
}

#[test]
fn what_cannot_go_on_is_refused() {
    let place = Place::new();
    place.done(&["run", "arm.toml", "--out", "out"]);
    assert!(refused(&place).contains("the run in out has come to its end: nothing is left to do"));
    fs::remove_dir_all(place.path("out")).unwrap();
    fs::create_dir(place.path("out")).unwrap();
    assert!(refused(&place).contains("out holds no checkpoint"));
    fs::remove_dir(place.path("out")).unwrap();
    assert!(place.springpot(&["run", "--resume", "out"]).stderr.contains("out holds no checkpoint"));

    killed(&place);
    place.write("arm.toml", ARM.replace("mass = 2\n", "mass = 3\n"));
    assert!(refused(&place).contains("arm.toml has changed since the run began"));
    place.write("arm.toml", "mass =");
    assert!(refused(&place).contains("arm.toml has changed since the run began"));
    place.write("arm.toml", ARM);

    let head = fs::read(head(&place)).unwrap();
    let line = head.iter().position(|byte| *byte == b'\n').unwrap();
    let other = [b"springpot 0.0.1 checkpoint 1", &head[line..]].concat();
    fs::write(self::head(&place), other).unwrap();
    assert!(refused(&place).contains("written by another version or build (springpot 0.0.1 checkpoint 1)"));
    fs::write(self::head(&place), &head).unwrap();

    let rows = place.read("out/results.csv.part");
    let flipped = rows.replacen("0.", "1.", 1);
    let zeroed = format!("{}{}", &rows[..rows.len() / 2], "\0".repeat(rows.len() - rows.len() / 2));
    let foreign = format!("{}\n{}", rows.lines().next().unwrap(), rows.lines().skip(2).collect::<Vec<_>>().join("\n"));
    let cut = [&rows[..rows.len() / 2], &rows[..10], "", &rows.replacen("q.q1", "q.q2", 1)];
    for bad in cut.into_iter().chain([&*flipped, &zeroed, &foreign]) {
        place.write("out/results.csv.part", bad);
        assert!(refused(&place).contains("the rows do not belong to the checkpoint"));
    }
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let place = Place::with(&format!("{ARM}[[sweep]]\nparameter = \"time.end\"\nvalues = [0.2, 100000, 100001]\n"));
    let mut child = start(&place, &["run", "arm.toml", "--out", "out", "--checkpoint-every", "0.5", "--jobs", "2"]);
    wait_for("a checkpoint", || place.path("out/checkpoint/case-1").exists());
    child.kill().unwrap();
    child.wait().unwrap();
    let mut dice = Dice(4);
    // A bad last record of the journal is no damage: a kill or a loss of power may leave it.
    for name in ["run", "case-1"] {
        let path = place.path("out/checkpoint").join(name);
        let good = fs::read(&path).unwrap();
        assert!(good.len() > 50, "{name}");
        for tried in 0..6 {
            let mut bad = good.clone();
            let at = (dice.roll() * good.len() as f64) as usize;
            match tried % 2 {
                0 => bad.truncate(at),
                _ => bad[at] ^= 1 << (8.0 * dice.roll()) as u32,
            }
            fs::write(&path, &bad).unwrap();
            let said = refused(&place);
            assert!(said.contains("damaged") || said.contains("another version"), "{name} at {at}: {said}");
        }
        fs::write(&path, &good).unwrap();
    }
}

#[test]
fn an_interrupted_run_says_how_to_go_on() {
    let sweep = "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.3, 0.5, 0.7]\n";
    let place = Place::with(&format!("{FALLING}{sweep}"));
    place.done(&["run", "arm.toml", "--out", "whole"]);
    // No checkpoint is due before the end; the interrupt leaves one.
    let interrupted = || {
        let _ = fs::remove_dir_all(place.path("out"));
        let child = start(&place, &["run", "arm.toml", "--out", "out", "--checkpoint-every", "1000", "--jobs", "2"]);
        wait_for("rows", || {
            length(place.path("out/results.csv.part")) >= 30_000 || place.path("out/results.csv").exists()
        });
        signal(&child, "-INT");
        ended(child)
    };
    // On a busy machine the signal may come after the end.
    let ended = std::iter::repeat_with(interrupted).find(|ended| ended.code != Some(0)).unwrap();
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    assert!(ended.stderr.ends_with("\nto go on: springpot run --resume out\n"), "{}", ended.stderr);
    assert_eq!(place.record("out")["status"], Value::from("interrupted"));
    assert!(place.path("out/results.csv").exists() && !place.path("out/results.csv.part").exists());
    assert_eq!(place.done(&["run", "--resume", "out", "--jobs", "1"]).stderr, "");
    assert_eq!(files(&place, "out"), files(&place, "whole"));
}

#[test]
fn checkpoints_leave_nothing_behind() {
    let place = Place::new();
    let ended = place.done(&["run", "arm.toml", "--out", "out", "--checkpoint-every", "10 ms"]);
    assert_eq!(ended.stderr, "");
    place.done(&["run", "arm.toml", "--out", "whole"]);
    assert_eq!(files(&place, "out"), files(&place, "whole"));
    // A run that begins anew forgets the checkpoint of the one before.
    killed(&place);
    place.done(&["run", "arm.toml", "--out", "out"]);
    assert_eq!(files(&place, "out"), files(&place, "whole"));
}

#[test]
fn a_run_goes_on_from_elsewhere_and_without_its_scenario() {
    let place = Place::new();
    killed(&place);
    // The end is too far away to wait for; the text that was kept leads there.
    fs::remove_file(place.path("arm.toml")).unwrap();
    fs::create_dir(place.path("elsewhere")).unwrap();
    let mut command = place.command(&["run", "--resume", "../out"]);
    let mut child = command.current_dir(place.path("elsewhere")).stderr(Stdio::piped()).spawn().unwrap();
    let rows = fs::metadata(place.path("out/results.csv.part")).unwrap().len();
    wait_for("rows", || {
        assert!(child.try_wait().unwrap().is_none());
        length(place.path("out/results.csv.part")) >= rows + 2_000
    });
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn mistyped_options_are_refused() {
    let place = Place::new();
    for (arguments, words) in [
        (&["run", "arm.toml", "--checkpoint-every", "0"][..], "--checkpoint-every 0: not a positive time"),
        (&["run", "arm.toml", "--checkpoint-every", "-1 s"], "--checkpoint-every -1 s: not a positive time"),
        (&["run", "arm.toml", "--checkpoint-every", "2 m"], "--checkpoint-every 2 m: "),
        (&["run", "arm.toml", "--checkpoint-every", "often"], "--checkpoint-every often: "),
        (&["run", "arm.toml", "--resume", "out"], "cannot be used with"),
        (&["run", "--resume", "out", "--set", "time.end=1"], "cannot be used with"),
        (&["run", "--resume", "out", "--out", "new"], "cannot be used with"),
    ] {
        let ended = place.springpot(arguments);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(ended.stderr.contains(words), "{arguments:?}: {}", ended.stderr);
    }
    assert!(!place.path("results").exists() && !place.path("out").exists());
}
