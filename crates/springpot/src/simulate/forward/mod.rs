//! A robot that moves by itself: the equations of motion with the memories inside.

mod start;
mod stepper;
mod tableau;

use crate::fractional::step::RADAU_NODES;
use crate::law::{Start, State};
use crate::motion::Motion;
use crate::simulate::{RunError, Settings, System};
use stepper::{Outcome, Stepper, Tolerance};

#[doc(hidden)]
pub fn prototype(
    system: &System,
    settings: &Settings,
    times: &[f64],
) -> Result<(Vec<(Vec<f64>, Vec<f64>)>, [u64; 3]), RunError> {
    let Motion::Forward(forward) = &system.motion else { panic!("forward") };
    let rtol = settings.rtol;
    let mapped = MAP * rtol.powf(2.0 / 3.0);
    let tolerance = Tolerance { rtol: mapped, atol: settings.atol.unwrap_or(rtol) * mapped / rtol };
    let (origin, elements) = start::origin(system, forward)?;
    let mut h = start::first_step(system, &origin, &elements, tolerance, settings.end);
    let mut laws: Vec<State> = Vec::new();
    for (element, start) in system.elements.iter().zip(&elements) {
        let begin = Start {
            stroke: start.stroke,
            jump: start.jump,
            tolerance: settings.memory_rtol,
            delta: RADAU_NODES[0] * h,
            horizon: settings.end,
        };
        laws.push(
            element.law.begin(&begin).map_err(|source| RunError::Kernel { element: element.name.clone(), source })?,
        );
    }
    let mut stepper = Stepper::new(system, forward, tolerance, rtol);
    stepper.origin = origin;
    let mut counts = [0u64; 3];
    let mut out = Vec::new();
    let (mut h_old, mut e_old) = (0.0, 0.0);
    for &target in times {
        while stepper.origin.t < target {
            let t = stepper.origin.t;
            let left = target - t;
            let size = if h >= left * (1.0 - 1e-9) {
                left
            } else if h > 0.5 * left {
                0.5 * left
            } else {
                h
            };
            match stepper.attempt(size, t + size, &laws)? {
                Outcome::Diverged { iterations } => {
                    counts[1] += 1;
                    counts[2] += u64::from(iterations);
                    h = 0.5 * size;
                    assert!(h > 1e-14, "diverged at {t}");
                }
                Outcome::Done { error, iterations, .. } => {
                    counts[2] += u64::from(iterations);
                    let safety = 0.9 * 15.0 / (14.0 + f64::from(iterations));
                    let p = 0.25;
                    if error > 1.0 {
                        counts[1] += 1;
                        h = size * (safety * error.powf(-p)).max(0.1);
                        assert!(h > 1e-14, "small at {t}");
                        continue;
                    }
                    for (e, element) in system.elements.iter().enumerate() {
                        element.law.commit(&stepper.elements[e].law_step(t, size), &mut laws[e]);
                    }
                    stepper.accept(size);
                    counts[0] += 1;
                    if size == left {
                        stepper.origin.t = target;
                    }
                    let error = error.max(1e-10);
                    let mut factor = safety * error.powf(-p);
                    if h_old > 0.0 {
                        factor =
                            factor.min(safety * (size / h_old) * (f64::max(e_old, 1e-2) / (error * error)).powf(p));
                    }
                    (h_old, e_old) = (size, error);
                    h = (size * factor.clamp(0.2, 8.0)).max(if size < h { h } else { 0.0 });
                }
            }
        }
        out.push((stepper.origin.q.clone(), stepper.origin.v.clone()));
    }
    Ok((out, counts))
}

/// Share of the tolerance that the estimate may reach: the estimate is of order 3, the method of order 5.
const MAP: f64 = 0.03;
