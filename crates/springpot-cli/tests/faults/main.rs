//! What disks, kills and losses of power do to results: nothing is lost, nothing is mixed, and what is said to be done is whole.
//!
//! A few hundred faults are tried by default. `cargo test --release -p springpot-cli --test faults -- --ignored --nocapture` tries all of them.

mod calls;
mod damage;
mod door;
mod power;
mod scene;

use std::path::Path;
use std::process::Command;

/// Runs a test in a process of its own, whose messages about faults nobody wants to read.
fn quietly(name: &str, test: impl FnOnce()) {
    const CHILD: &str = "SPRINGPOT_TEST_FAULTS";
    if std::env::var_os(CHILD).is_some() {
        return test();
    }
    let mut command = Command::new(std::env::current_exe().unwrap());
    let output = command.args([name, "--exact", "--include-ignored", "--nocapture"]).env(CHILD, "1").output().unwrap();
    let [said, complained] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    println!("{}", said.lines().filter(|line| line.contains(": ")).collect::<Vec<_>>().join("\n"));
    let panic = complained.find("panicked").map_or("", |at| &complained[at..]);
    assert!(output.status.success(), "{said}\n{panic}");
}

/// A call past the door would be one that no fault meets.
#[test]
fn all_calls_go_through_the_door() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../springpot-run/src");
    let mut folders = vec![sources];
    let mut looked_at = 0;
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            // Meshes look at the robot's file, and figures at anybody's tables: no run writes these.
            if ["table/disk.rs", "meshes.rs", "later/table.rs", "tests.rs"].iter().any(|own| path.ends_with(own)) {
                continue;
            }
            looked_at += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            for line in code.lines().filter(|line| !line.contains("/proc/sys/kernel/hostname")) {
                let passes = ["fs::", "File::open", "File::create", "File::options", ".exists()", ".metadata()"];
                assert!(!passes.iter().any(|call| line.contains(call)), "{}: {line}", path.display());
            }
        }
    }
    assert!(looked_at > 15);
}
