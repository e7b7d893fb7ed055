//! What is kept of a step of Radau IIA so that one can go back through it.

use super::step::RadauStep;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::equations::{Equations, Recording};

impl RadauStep {
    /// Keeps what the step that was solved does, of size `h`, where signals at its end are those at `t_end`.
    pub(super) fn record(&self, equations: &Equations, recording: &mut Recording, h: f64, t_end: f64) {
        let elements = equations.bank.len();
        let mut force = vec![0.0; elements];
        for (i, stage) in self.stages.iter().enumerate() {
            force.iter_mut().enumerate().for_each(|(e, force)| *force = equations.bank.response(e).force[i]);
            let t = if i + 1 == STAGES { t_end } else { self.origin.t + RADAU_NODES[i] * h };
            recording.see(equations, i + 1, stage.node(t), &force);
        }
        let free = recording.variation.of_run(equations.free());
        let size = STAGES * free.len();
        let mut matrix = vec![0.0; size * size];
        self.fill_matrix(equations, &recording.variation, (&free, h), &mut matrix);
        for row in 0..size {
            for column in 0..row {
                matrix.swap(row * size + column, column * size + row);
            }
        }
        recording.keep_step(equations, (h, &free), matrix);
    }
}
