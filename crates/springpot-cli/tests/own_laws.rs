//! A program whose laws come from a text that it reads: the whole command knows them as it knows those of Springpot.
//!
//! Started by `cargo test` it is the test, which starts it again, with [`LAWS`] in the environment, as that program.

use serde_json::Value;
use springpot::law::{Catalog, Entry, Network, Param, Range};
use std::path::Path;
use std::process::{Command, ExitCode};
use std::sync::Arc;

/// Names the file of laws.
const LAWS: &str = "SPRINGPOT_TEST_LAWS";

/// A name, and the dashpots that are side by side in it.
const FILE: &str = "twin-dashpot c_left c_right\n";

const SCENARIO: &str = r#"
robot.body = [{ name = "slide", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }]
motion = { kind = "prescribed", joints = { x = "0.1*t" } }
time = { end = 1, output_step = 0.5 }

[[element]]
name = "e"
from = { body = "world", point = [-1, 0, 0] }
to = { body = "slide", point = [0, 0, 0] }
rest_length = 1
law = "twin-dashpot"
parameters = { c_left = "3 N*s/m", c_right = 4 }
"#;

fn main() -> ExitCode {
    match std::env::var_os(LAWS) {
        Some(file) => springpot_cli::main_from(&catalog(file.as_ref()), std::env::args_os()),
        // As test harnesses answer who asks for the list of tests.
        None if std::env::args().any(|argument| argument == "--list") => {
            if !std::env::args().any(|argument| argument == "--ignored") {
                println!("the_command_takes_laws_that_a_program_hands_in: test");
            }
            ExitCode::SUCCESS
        }
        None => {
            the_command_takes_laws_that_a_program_hands_in();
            println!("the_command_takes_laws_that_a_program_hands_in ... ok");
            ExitCode::SUCCESS
        }
    }
}

/// The standard laws, and those of the file.
fn catalog(file: &Path) -> Catalog {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines().fold(Catalog::standard(), |catalog, line| {
        let (name, params) = line.split_once(' ').unwrap();
        let params: Vec<String> = params.split(' ').map(str::to_owned).collect();
        catalog.with(Entry {
            name: name.to_owned().into(),
            equation: format!("F = ({})·x'", params.join(" + ")).into(),
            params: params.into_iter().map(|c| Param::new(c, "N*s/m", "viscosity", Range::NOT_NEGATIVE)).collect(),
            inputs: Vec::new(),
            source: "a file".into(),
            build: Arc::new(|values, _| Ok(Network::parallel(values.iter().map(|c| Network::dashpot(*c))))),
        })
    })
}

fn the_command_takes_laws_that_a_program_hands_in() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    file("slide.toml", SCENARIO);
    let (with, without) = (file("laws", FILE), file("none", ""));
    let ended = |laws: &Path, words: &[&str]| {
        let program = std::env::current_exe().unwrap();
        let output = Command::new(program).current_dir(folder.path()).env(LAWS, laws).args(words).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (output.status.code(), text(output.stdout), text(output.stderr))
    };
    let done = |words: &[&str]| {
        let (code, out, complaints) = ended(&with, words);
        assert_eq!(code, Some(0), "{words:?}: {complaints}");
        out
    };

    let laws: Value = serde_json::from_str(&done(&["laws", "--json"])).unwrap();
    let last = laws.as_array().unwrap().last().unwrap();
    assert_eq!(laws.as_array().unwrap().len(), Catalog::standard().entries().len() + 1);
    assert!(last["name"] == "twin-dashpot" && last["parameters"][1]["name"] == "c_right", "{last}");
    assert!(done(&["laws", "twin-dashpot"]).contains("F = (c_left + c_right)·x'"));
    assert!(done(&["check", "--schema"]).contains("Parameters of twin-dashpot"));

    let plan = done(&["check", "slide.toml"]);
    assert!(plan.contains("e: twin-dashpot") && plan.contains("c_left = 3 N*s/m"), "{plan}");
    assert!(done(&["info", "slide.toml"]).contains("slide"));
    done(&["dynamics", "slide.toml", "--at", "0.5"]);

    done(&["run", "slide.toml", "--out", "out", "--quiet"]);
    let results = std::fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    let mut rows = results.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let force = rows.next().unwrap().iter().position(|name| *name == "e.force").unwrap();
    let forces: Vec<f64> = rows.map(|row| row[force].parse().unwrap()).collect();
    assert!(forces.len() == 3 && forces.iter().all(|force| (force - 0.7).abs() < 1e-12), "{forces:?}");
    let record = std::fs::read_to_string(folder.path().join("out/run.json")).unwrap();
    assert!(record.contains("twin-dashpot") && record.contains("c_right"), "{record}");

    // An FMU takes a library that was handed the law.
    let ended_fmu = |more: &[&str]| ended(&with, &[&["fmu", "slide.toml"], more].concat());
    let (code, _, complaints) = ended_fmu(&[]);
    assert!(code == Some(2) && complaints.contains("\"twin-dashpot\" does not come with Springpot"), "{complaints}");
    assert!(complaints.contains("--library FILE") && !folder.path().join("slide.fmu").exists(), "{complaints}");
    let library = |name: &str, more: &str| {
        let mark = concat!("springpot-capi for FMUs, version ", env!("CARGO_PKG_VERSION"), ";");
        std::fs::write(folder.path().join(name), format!("\x7fELF{mark}fmi2DoStep{more}")).unwrap();
    };
    library("other.so", "");
    let (code, _, complaints) = ended_fmu(&["--library", "other.so"]);
    assert!(code == Some(0) && complaints.contains("\"twin-dashpot\" is not in other.so"), "{complaints}");
    library("own.so", "twin-dashpot");
    let (code, out, complaints) = ended_fmu(&["--library", "own.so"]);
    assert!(code == Some(0) && out.starts_with("wrote slide.fmu") && complaints.is_empty(), "{complaints}");

    // Refusals know it as well: by its parameters, by names that are near, and by what it is not without the file.
    let wrong = |words: &[&str], said: &str| {
        let (code, _, complaints) = ended(&with, words);
        assert!(code == Some(2) && complaints.contains(said), "{words:?}: {complaints}");
    };
    wrong(&["check", "slide.toml", "--set", "element.e.c_left=-1"], "c_left");
    wrong(&["check", "slide.toml", "--set", "element.e.law=twin-dashpots"], "twin-dashpot");
    wrong(&["laws", "twin-dashpod"], "twin-dashpot");
    assert_eq!(ended(&without, &["check", "slide.toml"]).0, Some(2));
    assert_eq!(ended(&without, &["laws", "twin-dashpot"]).0, Some(2));
}
