//! Broken files: never a panic, and what is read is built or refused.

use crate::robots::folder;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use springpot::model::description::{DescriptionOptions, DescriptionProblem, RobotDescription};

const ROBOTS: [&str; 4] = ["double_pendulum", "ur5", "panda", "simple_humanoid"];

/// What takes the place of numbers and names.
const VALUES: [&str; 18] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "",
    "0",
    "-1",
    "1e400",
    "x",
    "base_link",
    "floating",
    "0 0 0",
    "0.5",
    "-0.5",
    "1 2 3",
    "1e-12 0 1",
];

/// What is written between other texts.
const PIECES: [&str; 16] = [
    "<",
    ">",
    "/>",
    "\"",
    "&",
    "&#0;",
    "\0",
    "<!--",
    "]]>",
    "<?",
    "<link name=\"a\"/>",
    "<robot>",
    "</link>",
    "<mimic joint=\"panda_joint1\"/>",
    "<xacro:a/>",
    "é",
];

/// One change of the text; places are counted from its start and wrap around.
#[derive(Debug, Clone)]
enum Edit {
    Flip(usize, u8),
    Delete(usize, usize),
    Repeat(usize, usize),
    Insert(usize, usize),
    SwapLines(usize, usize),
    DropLine(usize),
    RepeatLine(usize),
    Value(usize, usize),
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let any = || any::<usize>();
    let one = prop_oneof![
        1 => (any(), 0..8u8).prop_map(|(at, bit)| Edit::Flip(at, bit)),
        1 => (any(), 1..40usize).prop_map(|(at, count)| Edit::Delete(at, count)),
        1 => (any(), 1..200usize).prop_map(|(at, count)| Edit::Repeat(at, count)),
        1 => (any(), any()).prop_map(|(at, piece)| Edit::Insert(at, piece)),
        2 => (any(), any()).prop_map(|(a, b)| Edit::SwapLines(a, b)),
        3 => any().prop_map(Edit::DropLine),
        1 => any().prop_map(Edit::RepeatLine),
        12 => (any(), any()).prop_map(|(at, value)| Edit::Value(at, value)),
    ];
    prop::collection::vec(one, 1..3)
}

fn apply(text: &mut Vec<u8>, edit: &Edit) {
    if text.is_empty() {
        return;
    }
    let length = text.len();
    let line_of = |text: &[u8], k: usize| -> std::ops::Range<usize> {
        let starts: Vec<usize> = std::iter::once(0)
            .chain(text.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(k, _)| k + 1))
            .collect();
        let k = k % starts.len();
        starts[k]..starts.get(k + 1).copied().unwrap_or(text.len())
    };
    match *edit {
        Edit::Flip(at, bit) => text[at % length] ^= 1 << bit,
        Edit::Delete(at, count) => drop(text.drain(at % length..(at % length + count).min(length))),
        Edit::Repeat(at, count) => {
            let piece = text[at % length..(at % length + count).min(length)].to_vec();
            text.splice(at % length..at % length, piece);
        }
        Edit::Insert(at, piece) => drop(text.splice(at % length..at % length, PIECES[piece % PIECES.len()].bytes())),
        Edit::SwapLines(a, b) => {
            let (a, b) = (line_of(text, a), line_of(text, b));
            let (first, second) = if a.start <= b.start { (a, b) } else { (b, a) };
            if first.end <= second.start {
                let (one, other) = (text[first.clone()].to_vec(), text[second.clone()].to_vec());
                text.splice(second, one);
                text.splice(first, other);
            }
        }
        Edit::DropLine(line) => drop(text.drain(line_of(text, line))),
        Edit::RepeatLine(line) => {
            let line = line_of(text, line);
            let copy = text[line.clone()].to_vec();
            text.splice(line.start..line.start, copy);
        }
        Edit::Value(at, value) => {
            // The text between the quotes of some attribute.
            let quotes: Vec<usize> = text.iter().enumerate().filter(|(_, b)| **b == b'"').map(|(k, _)| k).collect();
            if quotes.len() > 1 {
                let pair = at % (quotes.len() / 2) * 2;
                text.splice(quotes[pair] + 1..quotes[pair + 1], VALUES[value % VALUES.len()].bytes());
            }
        }
    }
}

/// Reads a text and builds what it describes; returns whether it was read and whether it was built.
fn read_and_build(text: &str, options: &DescriptionOptions) -> Result<(bool, bool), TestCaseError> {
    let lines = text.bytes().filter(|byte| *byte == b'\n').count() + 1;
    let urdf = match RobotDescription::parse(text, None, options) {
        Err(error) => {
            prop_assert!(error.line().is_none_or(|line| (1..=lines).contains(&line)), "{error}");
            prop_assert!(!error.to_string().contains('\n') && error.to_string().len() < 2_000, "{error}");
            return Ok((false, false));
        }
        Ok(urdf) => urdf,
    };
    for warning in &urdf.warnings {
        prop_assert!(
            !warning.places.is_empty() && warning.places.iter().all(|place| (1..=lines).contains(&place.line))
        );
        prop_assert!(warning.to_string().len() < 10_000, "{warning}");
    }
    prop_assert_eq!(urdf.lines.len(), urdf.bodies.len());
    match urdf.model([0.0, 0.0, -9.81]) {
        Ok(model) => {
            let numbers = (0..model.joint_count()).map(|joint| model.subtree_mass(joint));
            prop_assert!(numbers.into_iter().all(|mass| mass.is_finite() && mass >= 0.0));
            Ok((true, true))
        }
        Err(error) => {
            let is_typed =
                matches!(*error.problem, DescriptionProblem::Model { .. } | DescriptionProblem::NothingMoves { .. });
            prop_assert!(is_typed, "{error}");
            Ok((true, false))
        }
    }
}

fn fuzz(cases: u32, seed: u8) {
    let texts = ROBOTS.map(|name| std::fs::read(folder().join(format!("{name}.urdf"))).unwrap());
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]));
    let count = std::cell::Cell::new([0; 3]);
    let strategy = (0..ROBOTS.len(), edits(), any::<[bool; 2]>(), any::<bool>());
    let result = runner.run(&strategy, |(robot, edits, [floating_base, accept_inertia], ignore_mimic)| {
        let mut bytes = texts[robot].clone();
        edits.iter().for_each(|edit| apply(&mut bytes, edit));
        let options =
            DescriptionOptions { floating_base, ignore_mimic, accept_inertia, ..DescriptionOptions::default() };
        let (read, built) = read_and_build(&String::from_utf8_lossy(&bytes), &options)?;
        let [all, reads, builds] = count.get();
        count.set([all + 1, reads + u32::from(read), builds + u32::from(built)]);
        Ok(())
    });
    result.unwrap();
    let [all, read, built] = count.get();
    println!("{all} texts, {read} read, {built} built");
    // Both ways are taken often, or the test looks at one alone.
    assert!(all == cases && read > cases / 10 && read < cases * 9 / 10 && built > cases / 20 && built < read);
}

#[test]
fn broken_robots_are_refused_or_built() {
    fuzz(1_500, 7);
}

#[test]
#[ignore = "long"]
fn many_broken_robots_are_refused_or_built() {
    fuzz(200_000, 11);
}
