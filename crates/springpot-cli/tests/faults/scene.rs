//! A run to be disturbed: its scenario, what was there before, and what it is to leave.

use crate::door::Door;
use serde_json::Value;
use springpot::law::Catalog;
use springpot_run::table::disk::Disk;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// A pendulum on a thermoviscoelastic strut.
const PENDULUM: &str = r#"
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
law = "springpot"
parameters = { c = "50 N*s^alpha/m", alpha = 0.5 }
[time]
end = 0.1
output_step = "5 ms"
[solver]
rtol = 1e-5
"#;

const FORWARD: &str = "[motion]\nkind = \"forward\"\n";
const PRESCRIBED: &str = "[motion]\nkind = \"prescribed\"\njoints = { q1 = \"0.3*sin(9*t)\" }\n";
const SWEEP: &str = "[[sweep]]\nparameter = \"element.strut.alpha\"\nvalues = [0.2, 0.5, 0.8]\n";
/// One that another run may draw by another name.
const FIGURE: &str = "[[figure]]\nname = \"loop\"\ny = \"strut.force\"\n";

/// Files by their names in a folder.
pub(crate) type Files = BTreeMap<String, Vec<u8>>;

/// A run, what is in its folder before, and what is in it after an undisturbed run.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    folder: tempfile::TempDir,
    arguments: Vec<String>,
    pub(crate) earlier: Files,
    pub(crate) whole: Files,
    pub(crate) checkpoints: bool,
}

/// One exit code, and what is in the folder then.
pub(crate) struct Left {
    pub(crate) code: ExitCode,
    pub(crate) files: Files,
}

impl Scene {
    fn new(name: &'static str, text: &str, arguments: &[&str], has_earlier: bool) -> Self {
        // Where there is a file system in memory, it is quicker.
        let memory = tempfile::tempdir_in("/dev/shm");
        let folder = memory.or_else(|_| tempfile::tempdir()).unwrap();
        fs::write(folder.path().join("arm.toml"), format!("{PENDULUM}{text}")).unwrap();
        // One that drew another figure.
        let other = text.replace("\"loop\"", "\"other\"");
        fs::write(folder.path().join("other.toml"), format!("{PENDULUM}{other}")).unwrap();
        let arguments: Vec<String> = arguments.iter().map(|argument| (*argument).to_owned()).collect();
        let checkpoints = arguments.iter().any(|argument| argument == "--checkpoint-every");
        let mut scene = Self { name, folder, arguments, earlier: Files::new(), whole: Files::new(), checkpoints };
        if has_earlier {
            let other = ["--set", "element.strut.c=70", "--set", "time.end=0.05"];
            assert_eq!(scene.springpot(&Door::open().disk(), "other.toml", &other), ExitCode::SUCCESS);
            scene.earlier = scene.files();
            scene.fill(&Files::new());
        }
        let whole = scene.run(&Door::open());
        assert_eq!(whole.code, ExitCode::SUCCESS);
        scene.whole = whole.files;
        scene
    }

    /// Those of every day.
    pub(crate) fn few() -> Vec<Self> {
        vec![
            Self::new("single", PRESCRIBED, &["--no-figures"], true),
            Self::new(
                "sweep",
                &format!("{FORWARD}{SWEEP}"),
                &["--checkpoint-every", "0.04", "--format", "parquet", "--no-figures"],
                true,
            ),
        ]
    }

    pub(crate) fn all() -> Vec<Self> {
        let (forward, swept) = (format!("{FORWARD}{FIGURE}"), format!("{FORWARD}{FIGURE}{SWEEP}"));
        let figure = format!("{PRESCRIBED}{FIGURE}");
        let every = ["--checkpoint-every", "0.04"];
        let and = |more: &[&'static str]| [&every[..], more].concat();
        let mut scenes = Self::few();
        scenes.extend([
            Self::new("fresh", PRESCRIBED, &["--no-figures"], false),
            Self::new("figures", &figure, &[], true),
            Self::new("npz", &figure, &["--format", "npz"], true),
            Self::new("forward", &forward, &every, true),
            Self::new("fresh forward", &forward, &every, false),
            Self::new("sweep with figures", &swept, &every, true),
            Self::new("sweep on two cores", &swept, &and(&["--no-figures", "--jobs", "2"]), true),
        ]);
        scenes
    }

    pub(crate) fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    fn springpot(&self, disk: &Disk, file: &str, more: &[&str]) -> ExitCode {
        let (file, out) = (self.folder.path().join(file), self.out());
        let mut arguments: Vec<OsString> = vec!["springpot".into(), "run".into(), file.into()];
        arguments.extend(["--quiet".into(), "--out".into(), out.into()]);
        if !self.arguments.iter().any(|argument| argument == "--jobs") {
            arguments.extend(["--jobs".into(), "1".into()]);
        }
        arguments.extend(self.arguments.iter().map(OsString::from).chain(more.iter().map(OsString::from)));
        springpot_cli::main_on(&Catalog::standard(), disk, arguments)
    }

    /// Runs in the folder as it is.
    pub(crate) fn run(&self, door: &Arc<Door>) -> Left {
        let code = self.springpot(&door.disk(), "arm.toml", &[]);
        Left { code, files: self.files() }
    }

    /// Goes on in the folder as it is.
    pub(crate) fn resume(&self, door: &Arc<Door>) -> Left {
        let words: [OsString; 4] = ["springpot".into(), "run".into(), "--resume".into(), self.out().into()];
        let more = ["--quiet", "--jobs", "1"].map(OsString::from);
        let code = springpot_cli::main_on(&Catalog::standard(), &door.disk(), words.into_iter().chain(more));
        Left { code, files: self.files() }
    }

    /// Leaves these files alone in the folder.
    pub(crate) fn fill(&self, files: &Files) {
        let out = self.out();
        let _ = fs::remove_dir_all(&out);
        fs::create_dir_all(&out).unwrap();
        for (name, bytes) in files {
            let path = out.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
    }

    pub(crate) fn files(&self) -> Files {
        let mut files = Files::new();
        below(&self.out(), "", &mut files);
        files
    }

    /// Runs to the end as if nothing had happened.
    pub(crate) fn runs_again(&self, what: &str) {
        let again = self.run(&Door::open());
        assert_eq!(again.code, ExitCode::SUCCESS, "{what}: the next run");
        self.is_whole(&again.files, &format!("{what}, next run"));
    }

    /// Asserts that there are the files of an undisturbed run and no others.
    pub(crate) fn is_whole(&self, files: &Files, what: &str) {
        if let Some(difference) = difference(files, &self.whole) {
            panic!("{} {what}: {difference}", self.name);
        }
    }

    /// Asserts that the results are the earlier ones, as they were.
    pub(crate) fn is_earlier(&self, files: &Files, what: &str) {
        if let Some(difference) = difference(&results(files), &self.earlier) {
            panic!("{} {what}: {difference}", self.name);
        }
    }

    /// Whether the results are those of an undisturbed run.
    pub(crate) fn has_whole(&self, files: &Files) -> bool {
        difference(&results(files), &self.whole).is_none()
    }
}

/// What a run puts in place.
fn results(files: &Files) -> Files {
    let is_result = |name: &str| !name.starts_with('.') && !name.starts_with("checkpoint/") && !name.ends_with(".part");
    files.iter().filter(|(name, _)| is_result(name)).map(|(name, bytes)| (name.clone(), bytes.clone())).collect()
}

/// In what files differ but for wall times and the file of a lock.
pub(crate) fn difference(left: &Files, right: &Files) -> Option<String> {
    let names = |files: &Files| files.keys().filter(|name| *name != ".lock").cloned().collect::<Vec<_>>();
    if names(left) != names(right) {
        return Some(format!("{:?} in place of {:?}", names(left), names(right)));
    }
    let differ = |name: &&String| timeless(name, &left[*name]) != timeless(name, &right[*name]);
    names(right).iter().find(differ).map(|name| format!("{name} differs"))
}

fn timeless(name: &str, bytes: &[u8]) -> Vec<u8> {
    let record = (name == "run.json").then(|| serde_json::from_slice::<Value>(bytes).ok()).flatten();
    let Some(mut record) = record else { return bytes.to_vec() };
    record["wall_time"].take();
    for case in record["cases"].as_array_mut().into_iter().flatten() {
        case["wall_time"].take();
    }
    record.to_string().into_bytes()
}

fn below(folder: &Path, lead: &str, files: &mut Files) {
    for entry in fs::read_dir(folder).into_iter().flatten().map(Result::unwrap) {
        let name = format!("{lead}{}", entry.file_name().to_str().unwrap());
        match entry.file_type().unwrap().is_dir() {
            true => below(&entry.path(), &format!("{name}/"), files),
            false => drop(files.insert(name, fs::read(entry.path()).unwrap())),
        }
    }
}

/// Numbers that look random and are always the same.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    /// Less than `count`.
    pub(crate) fn roll(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % count.max(1)
    }
}
