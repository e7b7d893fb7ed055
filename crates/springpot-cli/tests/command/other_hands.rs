//! What comes from other hands: results of other versions, records that say too little, parts named twice, names of any length, small stacks.

use crate::support::{ARM, Ended, Place};
use std::fs;

const SWEEP: &str = "[[sweep]]\nparameter = \"element.damper.mu\"\nvalues = [1, 2, 4]\n";

/// Changes run.json of the results in results/arm.
fn edit(place: &Place, change: impl FnOnce(&mut serde_json::Value)) {
    let mut record = place.record("results/arm");
    change(&mut record);
    place.write("results/arm/run.json", record.to_string());
}

#[test]
fn results_of_another_version_are_read_with_a_word() {
    let place = Place::new();
    place.done(&["run", "arm.toml"]);
    assert_eq!(place.done(&["plot", "results/arm", "damper.force"]).stderr, "");
    edit(&place, |record| record["versions"]["springpot"] = "9.9.9\u{1b}[31m".into());
    for arguments in [
        &["plot", "results/arm", "damper.force"][..],
        &["view", "results/arm"],
        &["report", "results/arm"],
        &["export", "results/arm", "arm.glb"],
        &["metrics", "results/arm", "--metric", "rms(damper.force)"],
    ] {
        let said = place.done(arguments).stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        let word = format!("results/arm/run.json is of Springpot 9.9.9[31m, and this is {}", env!("CARGO_PKG_VERSION"));
        assert!(said.contains(&word), "{arguments:?}: {said}");
    }
}

#[test]
fn values_without_labels_are_called_as_the_rows_call_them() {
    let place = Place::with(&format!("{ARM}{SWEEP}"));
    place.done(&["run", "arm.toml"]);
    for labels in [serde_json::json!([]), serde_json::json!(["1"]), serde_json::json!(["1", "2", "4", "8"])] {
        edit(&place, |record| record["sweeps"][0]["labels"] = labels);
        place.done(&["plot", "results/arm", "damper.force", "--out", "curves.svg"]);
        let statistic = ["plot", "results/arm", "max(damper.force)", "--x", "element.damper.mu", "--out", "max.svg"];
        place.done(&statistic);
        let svg = place.read("curves.svg");
        assert!([">1<", ">2<", ">4<"].iter().all(|label| svg.contains(label)), "{svg}");
    }
}

#[test]
fn a_part_that_is_named_twice_is_refused() {
    let place = Place::with(&format!("{ARM}{SWEEP}"));
    for part in ["1/2", "2/2"] {
        let out = format!("p{}", &part[..1]);
        place.done(&["run", "arm.toml", "--shard", part, "--out", &out]);
    }
    for second in ["p1", "./p1", "p2/../p1"] {
        let refused = place.springpot(&["merge", "p1", "p2", second, "--out", "whole"]);
        assert_eq!(refused.code, Some(2), "{}", refused.stderr);
        let said = refused.said();
        assert!(said.contains(&format!("{second} is named twice")) && said.contains("name every part once"), "{said}");
    }
    place.done(&["merge", "p2", "p1", "--out", "whole"]);
    assert_eq!(place.table("whole/results.csv").rows.len(), 15);
}

#[test]
fn long_names_are_cut_where_they_are_described() {
    let name = "j".repeat(50_000);
    let place = Place::with(&ARM.replace("q1", &name));
    let said = place.done(&["check", "arm.toml"]).stdout;
    assert!(said.contains("jjjj…jjjj") && said.len() < 5_000, "{} bytes", said.len());
}

#[cfg(unix)]
#[test]
fn a_small_stack_is_enough() {
    let place = Place::new();
    for arguments in [&["run", "arm.toml"][..], &["check", "arm.toml"], &["--help"], &["run", "--resume", "nothing"]] {
        let mut shell = std::process::Command::new("sh");
        shell.current_dir(place.path("")).args(["-c", "ulimit -s 64; exec \"$0\" \"$@\""]);
        let ended = Ended::from(shell.arg(env!("CARGO_BIN_EXE_springpot")).args(arguments).output().unwrap());
        let right = if arguments.contains(&"nothing") { 2 } else { 0 };
        assert_eq!(ended.code, Some(right), "{arguments:?}: {}", ended.stderr);
    }
}

/// A network with escapes and signs of several bytes where it is wrong.
#[test]
fn what_is_wrong_behind_escapes_is_shown() {
    let element = "[[element]]\nname = \"net\"\njoint = \"x\"\nnetwork = \"NETWORK\"\n";
    for network in ["€€\\\"\\\"\\\"\\\"", "spring(€\\u00e9)", "parallel(spring(1), ö\\\"\\\"\\\"\\\")", "\\\"\\\"ä"]
    {
        let at = ARM.find("[motion]").unwrap();
        let place = Place::with(&format!("{}{}{}", &ARM[..at], element.replace("NETWORK", network), &ARM[at..]));
        let refused = place.springpot(&["check", "arm.toml"]);
        assert_eq!(refused.code, Some(2), "{network}: {}", refused.stderr);
        assert!(refused.stderr.contains("network = "), "{network}: {}", refused.stderr);
    }
}

/// A lock that nobody holds keeps nobody out, whatever a loss of power, or somebody else, left in it.
#[test]
fn a_lock_that_nobody_holds_is_free() {
    let place = Place::new();
    place.done(&["run", "arm.toml"]);
    for (left, stays) in [(&[0u8; 80][..], false), (b"locked by", false), (b"", false), (b"mine", true)] {
        fs::write(place.path("results/arm/.lock"), left).unwrap();
        place.done(&["run", "arm.toml"]);
        assert_eq!(place.path("results/arm/.lock").exists(), stays, "{left:?}");
    }
    assert_eq!(place.read("results/arm/.lock"), "mine");
}
