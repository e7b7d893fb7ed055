//! The complex stiffness of an element under a steady sine of its stroke.

use crate::numbers::short;
use springpot::law::{InputValue, Point};
use springpot_scenario::ElementPlan;
use std::f64::consts::{PI, TAU};
use std::num::NonZero;

/// The amplitude where none is asked for and none matters, m or rad.
pub const USUAL_AMPLITUDE: f64 = 1e-3;

/// K* at one frequency and amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modulus {
    /// Hz.
    pub hertz: f64,
    /// m, or rad.
    pub amplitude: f64,
    /// K′, N/m or N·m/rad.
    pub storage: f64,
    /// K″, as `storage`.
    pub loss: f64,
    /// Energy lost in a cycle of the amplitude, J.
    pub cycle: f64,
}

/// The first harmonic of the steady force to x = A sin ωt, over that of the stroke, with the inputs that the element has at t = 0: of a linear law its
/// complex modulus, whatever A is. Amplitudes are outermost; all cores work.
///
/// # Errors
/// What is wrong, and what would be right: the law comes to no steady turn.
pub fn moduli(element: &ElementPlan, hertz: &[f64], amplitudes: &[f64]) -> Result<Vec<Modulus>, (String, String)> {
    let element = &element.element;
    let mut inputs = vec![InputValue::default(); element.inputs.len()];
    element.inputs_at(0.0, &mut inputs);
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
    let one = |(amplitude, hertz): (f64, f64)| -> Result<Modulus, (String, String)> {
        let modulus = match element.law.is_linear() {
            true => Some(element.law.complex_modulus(&at, TAU * hertz)),
            false => element.law.first_harmonic(&at, amplitude, TAU * hertz),
        };
        let [storage, loss] = modulus.ok_or_else(|| {
            let [hertz, amplitude] = [hertz, amplitude].map(short);
            let message = format!("element {:?} comes to no steady turn at {hertz} Hz and {amplitude}", element.name);
            (message, "run it under the sine that is meant, and look at the loop".to_owned())
        })?;
        Ok(Modulus { hertz, amplitude, storage, loss, cycle: PI * loss * amplitude * amplitude })
    };
    let wanted: Vec<(f64, f64)> =
        amplitudes.iter().flat_map(|amplitude| hertz.iter().map(|hertz| (*amplitude, *hertz))).collect();
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    let share = wanted.len().div_ceil(cores).max(1);
    let work = |wanted: &[(f64, f64)]| wanted.iter().map(|wanted| one(*wanted)).collect::<Result<Vec<_>, _>>();
    let work = &work;
    std::thread::scope(|scope| {
        let started: Vec<_> = wanted.chunks(share).map(|wanted| scope.spawn(move || work(wanted))).collect();
        let joined = started.into_iter().map(|share| share.join().unwrap_or_else(|why| std::panic::resume_unwind(why)));
        Ok(joined.collect::<Result<Vec<_>, _>>()?.concat())
    })
}

/// The units of the element's stroke, and of K*: N/m, or N·m/rad where it acts on an angle.
pub fn units(element: &ElementPlan) -> [&'static str; 2] {
    if element.element.measure.is_rotation() { ["rad", "N*m/rad"] } else { ["m", "N/m"] }
}
