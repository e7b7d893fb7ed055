//! Every law between a mass and the world: steps, ramps, sines, pulses of force, from rest.

use crate::ran::{Tried, ran};
use springpot::law::Catalog;
use std::process::Command;

/// Forces of the amplitude F, by what they are called. What begins at t > 0 finds the mass at rest.
const FORCES: [(&str, &str); 7] = [
    ("step", "F*step(t - 1)"),
    ("step at once", "F"),
    ("ramp", "F*min(1, max(0, t - 1))"),
    ("sine", "F*sin(3*t)"),
    ("smooth start", "F*(1 - cos(3*t))"),
    ("smooth pulse", "F*sin(pi*max(0, min(1, 2*t - 2)))^2"),
    ("rectangular pulse", "F*(step(t - 1) - step(t - 1.2))"),
];

/// The element that `springpot laws NAME` shows, on a joint.
fn element(law: &str) -> String {
    let ended = Command::new(env!("CARGO_BIN_EXE_springpot")).args(["laws", law]).output().unwrap();
    let page = String::from_utf8(ended.stdout).unwrap();
    let (_, sample) =
        page.split_once("an element of this law in a scenario").unwrap_or_else(|| panic!("{law}: {page}"));
    let place = ["from = ", "to = ", "rest_length = "];
    let lines = sample.lines().filter(|line| !place.iter().any(|key| line.starts_with(key)));
    lines.collect::<Vec<_>>().join("\n").replace("[[element]]", "[[element]]\njoint = \"x\"")
}

/// A mass that swings in about a second, and a force that moves it some millimetres; a stack is stiff.
fn text(law: &str, element: &str, force: &str, end: f64) -> String {
    let (mass, newton) = if law.starts_with("piezo-stack") { (5e5, "100") } else { (10.0, "5") };
    let force = force.replace('F', newton);
    format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"mass\"\nmass = {mass}\n\
         joint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }}\n{element}\n\
         [motion]\nkind = \"forward\"\ntorque = {{ x = \"{force}\" }}\n[time]\nend = {end}\noutput_step = {}\n",
        end / 100.0
    )
}

fn all_laws(forces: &[&str], end: f64) {
    let mut tried = Tried::default();
    let catalog = Catalog::standard();
    for law in catalog.entries() {
        let element = element(&law.name);
        for (name, force) in FORCES.iter().filter(|(name, _)| forces.is_empty() || forces.contains(name)) {
            tried.one(&format!("{}, {name}", law.name), ran(&text(&law.name, &element, force, end)));
        }
    }
    tried.end(28 * if forces.is_empty() { FORCES.len() } else { forces.len() });
}

#[test]
fn every_law_takes_a_step_and_a_sine() {
    all_laws(&["step at once", "sine"], 10.0);
}

#[test]
fn every_law_is_moved_from_rest() {
    all_laws(&[], 10.0);
}

#[test]
#[ignore = "some minutes"]
fn every_law_is_moved_from_rest_for_a_thousand_seconds() {
    all_laws(&[], 1000.0);
}

/// What is pulled at rest by nothing stays there, in a handful of steps.
#[test]
fn every_law_rests() {
    let mut tried = Tried::default();
    for law in Catalog::standard().entries() {
        let text = text(&law.name, &element(&law.name), "0", 10.0);
        tried.one(&law.name, ran(&text));
    }
    tried.end(28);
}
