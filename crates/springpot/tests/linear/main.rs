//! Small motions about rest: eigenvalues, equilibria, frequency responses.

mod classical;
mod closed;
mod equilibria;
mod fractional;
mod margins;
mod models;
mod responses;
mod runs;
#[path = "../support/mod.rs"]
mod support;

use springpot::linear::{Linearisation, Modes};
use springpot::system::System;
use support::robots::ARM;

/// The arm under forces: `elements` are tables, `motion` what follows the kind.
pub(crate) fn arm(elements: &str, motion: &str) -> String {
    format!("{ARM}\n{elements}\n[motion]\nkind = \"forward\"\n{motion}\n[time]\nend = 1\noutput_step = 0.5\n")
}

/// An element on each joint of the arm, the rest of whose tables these are.
pub(crate) fn on_joints(laws: [&str; 3]) -> String {
    let table = |(k, law): (usize, &str)| {
        format!("[[element]]\nname = \"e{k}\"\njoint = \"q{}\"\nrest = \"0.{k}\"\n{law}\n", k + 1)
    };
    laws.into_iter().enumerate().map(table).collect()
}

/// A slider of this mass with a law along it, no gravity.
pub(crate) fn slider(mass: f64, law: &str, torque: &str, time: &str) -> String {
    format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = {mass}\n\
         joint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0], origin = [0, 0, 0] }}\n\
         [[element]]\nname = \"e\"\njoint = \"x\"\n{law}\n[motion]\nkind = \"forward\"\n{torque}\n{time}\n"
    )
}

/// About the start.
pub(crate) fn linear(system: &System) -> Linearisation {
    let start = system.state(0.0).unwrap();
    system.linearised(&start.q, 0.0).unwrap()
}

pub(crate) fn modes(system: &System) -> Modes {
    let modes = linear(system).modes().unwrap();
    assert!(modes.is_complete(), "{modes:?}");
    modes
}
