//! What the tests of the command share: a folder to work in, the built program, its files.

#![allow(dead_code, reason = "each test uses its share")]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::time::{Duration, Instant};

/// Longest wait for what must happen: on any machine, whatever else it does, only what hangs takes so long.
const PATIENCE: Duration = Duration::from_secs(900);

/// A robot of a turning and a sliding joint with one damper whose voltage varies; x(0) = 0.
pub(crate) const ARM: &str = r#"title = "Damped arm"

[robot.gripper]
body = "slide"
point = [0.1, 0, 0]

[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.5] }
mass = 2
com = [0.2, 0, 0]
inertia = { xx = 0.01, yy = 0.05, zz = 0.05 }

[[robot.body]]
name = "slide"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0], origin = [0.4, 0, 0] }
mass = "500 g"
com = [0.05, 0, 0]

[[element]]
name = "damper"
from = { body = "world", point = [0, 0.3, 0] }
to = { body = "slide", point = [-0.4, 0.3, 0] }
rest_length = "50 cm"
law = "magnetorheological"
parameters = { E_c = "20 N/m", mu_0 = 10, mu = 4, alpha = 0.5 }
inputs = { u = "1 + 0.5*sin(20*t)" }

[motion]
kind = "prescribed"
joints = { q1 = "0.3*sin(4*t)", x = "0.05 - 0.05*cos(6*t)" }

[time]
end = 0.35
output_step = "100 ms"
"#;

/// A motion of which no computer sees the end, with rows every now and then.
pub(crate) const ENDLESS: [&str; 8] = [
    "--set",
    "motion.joints.q1=0.1*sin(300000*t)",
    "--set",
    "time.end=1000",
    "--set",
    "time.output_step=0.0005",
    "--set",
    "solver.max_steps=1000000000000",
];

/// A folder that is taken away in the end, with `arm.toml` in it.
pub(crate) struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    pub(crate) fn new() -> Self {
        Self::with(ARM)
    }

    pub(crate) fn with(text: &str) -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.write("arm.toml", text);
        place
    }

    pub(crate) fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: impl AsRef<Path>) -> String {
        let path = self.path(name);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// Names of the files in a folder and below, sorted.
    pub(crate) fn files(&self, folder: impl AsRef<Path>) -> Vec<String> {
        fn below(folder: &Path, lead: &str, names: &mut Vec<String>) {
            for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
                let name = format!("{lead}{}", entry.file_name().to_str().unwrap());
                match entry.file_type().unwrap().is_dir() {
                    true => below(&entry.path(), &format!("{name}/"), names),
                    false => names.push(name),
                }
            }
        }
        let mut names = Vec::new();
        below(&self.path(folder), "", &mut names);
        names.sort();
        names
    }

    /// The program, to be started in this folder.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_springpot"));
        command.current_dir(self.folder.path()).args(arguments).env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
        command
    }

    pub(crate) fn springpot(&self, arguments: &[&str]) -> Ended {
        Ended::from(self.command(arguments).output().unwrap())
    }

    /// Runs, and asserts that all went well.
    pub(crate) fn done(&self, arguments: &[&str]) -> Ended {
        let ended = self.springpot(arguments);
        assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
        ended
    }

    pub(crate) fn table(&self, name: impl AsRef<Path>) -> Csv {
        Csv::new(&self.read(name))
    }

    pub(crate) fn record(&self, folder: &str) -> Value {
        serde_json::from_str(&self.read(Path::new(folder).join("run.json"))).unwrap()
    }
}

/// Waits until something has happened.
pub(crate) fn wait_for(what: &str, mut has_happened: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !has_happened() {
        assert!(begun.elapsed() < PATIENCE, "waited {PATIENCE:?} for {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Bytes of a file; 0 where it is not there yet.
pub(crate) fn length(file: impl AsRef<Path>) -> u64 {
    fs::metadata(file).map_or(0, |file| file.len())
}

/// Sends a signal to a program.
pub(crate) fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// Waits for the end of a program.
pub(crate) fn ended(mut child: Child) -> Ended {
    wait_for("the end of the program", || child.try_wait().unwrap().is_some());
    Ended::from(child.wait_with_output().unwrap())
}

/// Processor time of a program that runs, s; wall time where the system does not list it.
pub(crate) fn worked(child: &Child, begun: Instant) -> f64 {
    let listed = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap_or_default();
    // Behind the name in parentheses: user and system time are the 12th and 13th, in hundredths of a second.
    let ticks = listed.rsplit_once(')').map(|(_, rest)| {
        let fields = rest.split_whitespace().skip(11).take(2);
        fields.map(|field| field.parse::<f64>().unwrap()).sum::<f64>()
    });
    ticks.map_or_else(|| begun.elapsed().as_secs_f64(), |ticks| ticks / 100.0)
}

/// A file of testdata/.
pub(crate) fn testdata(file: &str) -> String {
    format!("{}/../../testdata/{file}", env!("CARGO_MANIFEST_DIR"))
}

/// All numbers of nested arrays, in their order; decimal texts count as numbers.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        Value::String(text) => vec![text.parse().unwrap()],
        value => vec![value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))],
    }
}

/// How the program ended and what it said.
#[derive(Debug)]
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    /// What killed it.
    pub(crate) signal: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        #[cfg(unix)]
        let signal = std::os::unix::process::ExitStatusExt::signal(&output.status);
        #[cfg(not(unix))]
        let signal = None;
        let ended = Self {
            code: output.status.code(),
            signal,
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        };
        assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
        assert!(!ended.stdout.contains('\u{1b}') && !ended.stderr.contains('\u{1b}'), "colours in a pipe: {ended:?}");
        ended
    }
}

impl Ended {
    /// What it said on stderr, without the ends and the bars of the terminal's lines.
    pub(crate) fn said(&self) -> String {
        self.stderr.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    }

    #[track_caller]
    pub(crate) fn says(&self, words: &[&str]) {
        let said = self.said();
        words.iter().for_each(|words| assert!(said.contains(words), "{words:?} is not in {}", self.stderr));
    }

    #[track_caller]
    pub(crate) fn ends(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{}{}", self.stdout, self.stderr);
        self.says(words);
    }
}

/// The arm with words in the place of others, which it has once.
#[track_caller]
pub(crate) fn edited(edits: &[(&str, &str)]) -> String {
    edits.iter().fold(ARM.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    })
}

/// A CSV file without quotes.
#[derive(Debug)]
pub(crate) struct Csv {
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Csv {
    pub(crate) fn new(text: &str) -> Self {
        assert!(text.ends_with('\n') && !text.contains('"') && !text.contains('\r'), "{text:?}");
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let rows: Vec<_> = lines.collect();
        assert!(rows.iter().all(|row| row.len() == header.len()), "rows of other lengths than the header");
        Self { header, rows }
    }

    pub(crate) fn at(&self, column: &str) -> usize {
        let found = self.header.iter().position(|name| name == column);
        found.unwrap_or_else(|| panic!("no column {column} in {:?}", self.header))
    }

    /// Texts of a column.
    pub(crate) fn texts(&self, column: &str) -> Vec<&str> {
        let at = self.at(column);
        self.rows.iter().map(|row| row[at].as_str()).collect()
    }

    /// Numbers of a column; NaN for an empty cell.
    pub(crate) fn numbers(&self, column: &str) -> Vec<f64> {
        self.texts(column).iter().map(|text| if text.is_empty() { f64::NAN } else { text.parse().unwrap() }).collect()
    }
}
