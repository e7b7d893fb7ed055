//! A material between two points: anchors + law + inputs. The only place where bodies and laws meet.

use crate::fractional::KernelError;
use crate::fractional::scheme::Scheme;
use crate::law::{Derivative, Entry, InputValue, Network, Start, State};
use crate::model::Site;
use crate::signal::Signal;
use std::sync::Arc;

/// A massless one-dimensional material between point D_i (`from`) and point D_j (`to`).
///
/// Length l = |r_Dj − r_Di|, stroke x = l − l0, force F > 0 in tension; it pulls the two points together, so that its
/// generalized forces are Q_b = −F·∂l/∂q_b.
#[derive(Debug, Clone)]
pub struct Element {
    /// Name.
    pub name: String,
    /// D_i.
    pub from: Site,
    /// D_j.
    pub to: Site,
    /// l0, m.
    pub rest_length: f64,
    /// The law.
    pub law: Network,
    /// Its entry of the catalog, which copies of the element share.
    pub entry: Arc<Entry>,
    /// Signals of its inputs, in the order of the entry, SI.
    pub inputs: Vec<Signal>,
    /// Which fractional derivative the law takes.
    pub derivative: Derivative,
    /// A named offline scheme in place of the exact memory.
    pub scheme: Option<Scheme>,
}

impl Element {
    /// Values and rates of the inputs at t.
    pub fn inputs_at(&self, t: f64, values: &mut [InputValue]) {
        for (value, signal) in values.iter_mut().zip(&self.inputs) {
            let jet = signal.at(t);
            *value = InputValue { value: jet.value, rate: jet.first };
        }
    }

    /// The law's state at t = 0 at this length and under these inputs, its memories without kernels ([`Network::begin`]).
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be.
    pub fn begin(&self, length: f64, inputs: &[InputValue]) -> Result<State, KernelError> {
        self.law.begin(&Start { stroke: length - self.rest_length, jump: self.jump(length), inputs })
    }

    /// x(0) as a Riemann–Liouville start counts it: 0 where it is no more than the rounding of the lengths.
    pub fn jump(&self, length: f64) -> f64 {
        let stroke = length - self.rest_length;
        if stroke.abs() <= self.resolution(length) { 0.0 } else { stroke }
    }

    /// Rounding of a stroke, m.
    pub fn resolution(&self, length: f64) -> f64 {
        8.0 * f64::EPSILON * length.max(self.rest_length)
    }
}
