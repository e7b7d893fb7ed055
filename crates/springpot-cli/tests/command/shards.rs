//! A run in parts, as on several machines, and the parts put together.

use crate::support::Place;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Seven cases with figures of all kinds, a metric and an event; the last one fails on the way.
const GRID: &str = r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "mass"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 2
[[element]]
name = "pad"
joint = "x"
law = "magnetorheological"
parameters = { E_c = 100, mu_0 = 4, mu = 2, alpha = 0.6 }
inputs = { u = "1" }
[motion]
kind = "forward"
torque = { x = "5*sin(3*t)" }
[time]
end = 1
output_step = 0.01
[solver]
rtol = 1e-7
[[event]]
name = "turn"
when = "v.x"
[[metric]]
name = "peak"
of = "q.x"
kind = "max"
[[sweep]]
parameter = "element.pad.u"
values = [0, 1, 2, "1+t", "abs(t-0.5)", 3, "1-4*t"]
[[figure]]
name = "force"
y = ["pad.force"]
[[figure]]
name = "loop"
x = "pad.stroke"
y = ["pad.force"]
window = [0.3, 1]
"#;

/// Every file in a folder but its checkpoint and its record.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for inside in [folder.to_owned(), folder.join("figures")] {
        for entry in fs::read_dir(&inside).into_iter().flatten().map(Result::unwrap) {
            let name = entry.file_name().into_string().unwrap();
            if entry.file_type().unwrap().is_file() && name != "run.json" {
                found.insert(name, fs::read(entry.path()).unwrap());
            }
        }
    }
    found
}

/// run.json without what the clock says.
fn record(folder: &Path) -> Value {
    fn still(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.remove("wall_time");
                map.values_mut().for_each(still);
            }
            Value::Array(items) => items.iter_mut().for_each(still),
            _ => {}
        }
    }
    let mut value = serde_json::from_slice(&fs::read(folder.join("run.json")).unwrap()).unwrap();
    still(&mut value);
    value
}

#[test]
fn parts_put_together_are_the_whole_run() {
    let place = Place::with(GRID);
    for format in ["csv", "parquet"] {
        let whole = place.springpot(&["run", "arm.toml", "--format", format, "--out", "whole", "-q"]);
        assert_eq!(whole.code, Some(1), "{whole:?}");
        // More parts than cases: the last one is empty.
        let mut merge = vec!["merge".to_owned(), "--out".to_owned(), "merged".to_owned(), "-q".to_owned()];
        for k in (1..=8).rev() {
            let (shard, out) = (format!("{k}/8"), format!("part-{k}"));
            let part =
                place.springpot(&["run", "arm.toml", "--format", format, "--shard", &shard, "--out", &out, "-q"]);
            assert_eq!(part.code, Some(i32::from(k == 7)), "{part:?}");
            assert!(!place.path(&out).join("figures").exists());
            merge.push(out);
        }
        let merge: Vec<&str> = merge.iter().map(String::as_str).collect();
        let merged = place.springpot(&merge);
        assert_eq!(merged.code, Some(1), "{merged:?}");
        let (whole, merged) = (place.path("whole"), place.path("merged"));
        let expected = files(&whole);
        assert!(expected.len() == 8 && expected.contains_key("loop.png"), "{:?}", expected.keys());
        assert!(files(&merged) == expected);
        assert_eq!(record(&merged), record(&whole));
        let part = record(&place.path("part-3"));
        assert_eq!(part["shard"], serde_json::json!({ "number": 3, "count": 8, "cases": [2, 3] }));
        assert_eq!((&part["cases_total"], &part["cases_done"]), (&7.into(), &1.into()));
    }
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let place = Place::with(GRID);
    let run = |arguments: &[&str]| place.springpot(&[&["run", "arm.toml", "-q"], arguments].concat());
    let said = |arguments: &[&str]| {
        let output = place.springpot(arguments);
        assert_eq!(output.code, Some(2), "{output:?}");
        output.stderr
    };
    run(&["--shard", "1/2", "--out", "a"]);
    run(&["--shard", "2/2", "--out", "other", "--set", "time.end=0.5"]);
    run(&["--out", "plain"]);
    assert!(said(&["merge", "a"]).contains("3 of 7 cases are in none of these folders, the first of them case 4"));
    assert!(said(&["merge", "a", "other"]).contains("a and other hold parts of different runs: what was set"));
    assert!(said(&["merge", "a", "plain"]).contains("plain holds no part of a run"));
    assert!(said(&["merge", "nowhere"]).contains("nowhere holds no part of a run"));
    // One job: rows are nowhere but in their file.
    run(&["--shard", "2/2", "--out", "b", "--jobs", "1"]);
    let before = files(&place.path("a"));
    assert!(said(&["merge", "a", "b", "--out", "a"]).contains("cannot go into a, which holds a part of it"));
    assert!(files(&place.path("a")) == before);
    for shard in ["0/2", "3/2", "1", "x/2", "-1/2"] {
        let output = place.springpot(&["run", "arm.toml", "--shard", shard]);
        assert_eq!(output.code, Some(2), "{output:?}");
        assert!(output.stderr.contains("--shard"), "{output:?}");
    }
    // One byte of the rows.
    let rows = place.path("b/results.csv");
    let mut bytes = fs::read(&rows).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] = if bytes[middle] == b'1' { b'2' } else { b'1' };
    fs::write(&rows, bytes).unwrap();
    let said = said(&["merge", "a", "b", "--out", "c"]);
    assert!(said.contains("do not belong") || said.contains("are in none of these folders"), "{said}");
    assert!(!place.path("c/results.csv").exists());
}

/// A part whose only case fails before its first row is a part all the same.
#[test]
fn a_case_without_a_row_is_merged_too() {
    let place = Place::with(&GRID.replace("\"1-4*t\"]", "\"-3\"]"));
    assert_eq!(place.springpot(&["run", "arm.toml", "--out", "whole", "-q"]).code, Some(1));
    for (shard, out, code) in [("1/7", "part-1", 0), ("7/7", "part-7", 1)] {
        let part = place.springpot(&["run", "arm.toml", "--shard", shard, "--out", out, "-q"]);
        assert_eq!(part.code, Some(code), "{part:?}");
    }
    let mut merge =
        vec!["merge".to_owned(), "--out".to_owned(), "merged".to_owned(), "part-1".to_owned(), "part-7".to_owned()];
    for k in 2..=6 {
        let out = format!("part-{k}");
        place.done(&["run", "arm.toml", "--shard", &format!("{k}/7"), "--out", &out, "-q"]);
        merge.push(out);
    }
    let merged = place.springpot(&merge.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(merged.code, Some(1), "{merged:?}");
    let (whole, merged) = (place.path("whole"), place.path("merged"));
    assert_eq!(files(&merged), files(&whole));
    assert_eq!(record(&merged), record(&whole));
    assert_eq!(record(&whole)["cases"][6]["rows"], 0);
}
