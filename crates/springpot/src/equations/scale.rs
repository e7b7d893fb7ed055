//! How large a motion is that is given in advance.

use super::context::Context;
use super::evaluate::{Evaluation, Scratch};
use crate::motion::Trajectory;

/// Samples of a motion.
const SAMPLES: u32 = 64;

/// What a motion comes to.
#[derive(Debug)]
pub(crate) struct Scale {
    /// A lower bound of the energy that it turns over, J.
    pub(crate) energy: f64,
    /// The largest stroke of each element, m or rad.
    pub(crate) strokes: Vec<f64>,
}

impl Context<'_> {
    /// What a motion comes to until `end`, s, as 65 samples of it tell.
    pub(crate) fn scale_of(&self, trajectory: &Trajectory, end: f64, scratch: &mut Scratch) -> Scale {
        let elements = &self.system.elements;
        let mut evaluation = Evaluation::new(self.system);
        let (mut potential, mut kinetic) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0f64);
        let mut strokes = vec![[f64::INFINITY, f64::NEG_INFINITY]; elements.len()];
        let mut forces = vec![0.0f64; elements.len()];
        for k in 0..=SAMPLES {
            let t = end * f64::from(k) / f64::from(SAMPLES);
            if self.evaluate(trajectory, t, t, scratch, &mut evaluation).is_err() {
                break;
            }
            let widen = |range: &mut [f64; 2], x: f64| *range = [range[0].min(x), range[1].max(x)];
            kinetic = kinetic.max(evaluation.kinetic);
            widen(&mut potential, evaluation.potential);
            for (e, state) in evaluation.elements.iter().enumerate() {
                widen(&mut strokes[e], state.stroke);
                let element = &elements[e];
                if let Ok(law) = element.law.begin(&element.start(element.rest, &state.inputs)) {
                    forces[e] = forces[e].max(element.law.estimate(&state.point(t), &law, 1.0 / end).abs());
                }
            }
        }
        let work: f64 = strokes.iter().zip(forces).map(|(range, force)| (range[1] - range[0]) * force).sum();
        Scale {
            energy: kinetic + (potential[1] - potential[0]).max(0.0) + work.max(0.0),
            strokes: strokes.iter().map(|[low, high]| low.abs().max(high.abs())).collect(),
        }
    }
}
