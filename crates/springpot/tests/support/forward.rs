//! Robots that move by themselves, as scenario texts.

use super::robots::{ARM, thermoviscoelastic};

/// Largest magnitude; infinite where one is NaN.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m: f64, x| if x.is_nan() { f64::INFINITY } else { m.max(x.abs()) })
}

/// Largest difference of two columns.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).map(|(a, b)| a - b))
}

/// A slider on the vertical axis with the element `e` to the world: its stroke is q. `law` is the rest of the element's table.
pub(crate) fn slider(mass: &str, gravity: f64, law: &str, start: &str) -> String {
    format!(
        r#"
[robot]
gravity = [0, 0, {gravity}]
[[robot.body]]
name = "slider"
joint = {{ name = "q", kind = "prismatic", axis = [0, 0, 1], origin = [0, 0, 8] }}
mass = {mass}
[[element]]
name = "e"
from = {{ body = "world", point = [0, 0, 0] }}
to = {{ body = "slider", point = [0, 0, 0] }}
rest_length = 8
{law}
[motion]
kind = "forward"
start = {start}
"#
    )
}

/// q(0) and v(0) of the slider.
pub(crate) fn state(x: &str, v: &str) -> String {
    format!("{{ q = {{ q = {x} }}, v = {{ q = {v} }} }}")
}

/// The arm falling with the thermoviscoelastic strut of the first paper; `motion` is the rest of its motion.
pub(crate) fn falling(alpha: f64, celsius: f64, derivative: &str, motion: &str) -> String {
    let strut = thermoviscoelastic(alpha, celsius, derivative);
    format!("{ARM}{strut}\n[motion]\nkind = \"forward\"\n{motion}\n")
}

/// Rows every `step` seconds.
pub(crate) fn every(end: f64, step: f64, rtol: f64) -> String {
    format!("\n[time]\nend = {end}\noutput_step = {step}\n[solver]\nrtol = {rtol:e}\n")
}

/// Rows at the given times, written as TOML.
pub(crate) fn at(end: &str, times: &str, rtol: f64) -> String {
    format!("\n[time]\nend = {end}\noutput_times = [{times}]\n[solver]\nrtol = {rtol:e}\n")
}
