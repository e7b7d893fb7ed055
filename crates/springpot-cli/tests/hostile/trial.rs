//! One test in a process of its own: every input is noted before it is tried, so that the one that ends it is known.

use springpot::law::Catalog;
use springpot_run::table::disk::Disk;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Duration;

/// Processor time that an answer may take, s.
const LONGEST: f64 = 5.0;

/// Where the input is noted that is tried.
static NOTE: Mutex<Option<PathBuf>> = Mutex::new(None);
static TRIED: AtomicU64 = AtomicU64::new(0);

/// Ends the process; what is tried is noted already.
pub(crate) fn end(why: &str) -> ! {
    // No formatting: memory may be what is short.
    let _ = fs::write("/dev/stderr", why);
    std::process::abort()
}

/// A folder in which inputs are tried.
pub(crate) struct Trial {
    folder: tempfile::TempDir,
    catalog: Catalog,
}

impl Trial {
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path(name), text).unwrap();
    }

    /// Runs a command as it would from a shell; the number that it ends with.
    pub(crate) fn springpot(&self, arguments: &[&str]) -> u8 {
        let words = ["springpot"].iter().chain(arguments).map(OsString::from);
        let code = springpot_cli::main_on(&self.catalog, &Disk::default(), words);
        let codes = [0u8, 1, 2];
        codes.into_iter().find(|known| ExitCode::from(*known) == code).unwrap_or_else(|| panic!("ended with {code:?}"))
    }

    /// Tries an input, which is what `note` says.
    pub(crate) fn one<T>(&self, note: &str, work: impl FnOnce() -> T) -> T {
        fs::write(NOTE.lock().unwrap().as_ref().unwrap(), note).unwrap();
        TRIED.fetch_add(1, Relaxed);
        work()
    }
}

/// Runs `test` in a process of its own, in which this is the only one; `name` is that of the test.
pub(crate) fn alone(name: &str, test: impl FnOnce(&Trial)) {
    const CHILD: &str = "SPRINGPOT_TEST_HOSTILE";
    if let Some(note) = std::env::var_os(CHILD) {
        *NOTE.lock().unwrap() = Some(note.into());
        std::thread::spawn(watch);
        return test(&Trial { folder: tempfile::tempdir().unwrap(), catalog: Catalog::standard() });
    }
    let folder = tempfile::tempdir().unwrap();
    let note = folder.path().join("note");
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args([name, "--exact", "--include-ignored", "--nocapture"]).env(CHILD, &note);
    let output = command.output().unwrap();
    let [said, complained] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    println!("{}", said.lines().filter(|line| line.starts_with("tried ")).collect::<Vec<_>>().join("\n"));
    let last = complained.find("panicked").map_or_else(|| tail(&complained), |at| complained[at..].to_owned());
    assert!(output.status.success(), "{:?} {last}\n{}", output.status, read(&note));
    assert!(said.contains("test result: ok. 1 passed"), "{}", tail(&said));
}

fn tail(text: &str) -> String {
    text.lines().rev().take(5).collect::<Vec<_>>().join("\n")
}

fn read(note: &Path) -> String {
    fs::read_to_string(note).unwrap_or_default()
}

/// Ends the process where one input takes too much work.
fn watch() {
    let (mut tried, mut since) = (0, 0.0);
    loop {
        std::thread::sleep(Duration::from_millis(100));
        let (now, worked) = (TRIED.load(Relaxed), worked());
        if now != tried {
            (tried, since) = (now, worked);
        } else if worked - since > LONGEST {
            end("more than five seconds of work");
        }
    }
}

/// Processor time of this process, s; 0 where the system does not list it.
fn worked() -> f64 {
    let listed = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = listed.rsplit_once(')').map_or("", |(_, rest)| rest).split_whitespace().skip(11).take(2);
    fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() / 100.0
}
