//! What every part of a run is told.

use crate::law::InputValue;
use crate::signal::Signal;
use crate::system::System;
use serde::{Deserialize, Serialize};

/// A system, and what is held from outside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) system: &'a System,
    pub(crate) held: &'a Held,
    /// What sampled laws said last, for which the same goes; what is held in `held` comes before it.
    pub(crate) sampled: &'a Held,
}

/// Torques and inputs that somebody outside or an event holds; the default holds nothing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Held {
    /// Added to the actuator forces, nv values or none.
    torques: Vec<f64>,
    /// In place of the signal, for each velocity, or none.
    forces: Vec<Option<f64>>,
    /// In place of the signal, for each input of each element, or none.
    inputs: Vec<Vec<Option<f64>>>,
}

impl Held {
    /// Nothing is held.
    pub(crate) const NONE: &'static Self = &Self { torques: Vec::new(), forces: Vec::new(), inputs: Vec::new() };

    /// The torques on the velocities of a system, to be set.
    pub(crate) fn torques_mut(&mut self, nv: usize) -> &mut [f64] {
        self.torques.resize(nv, 0.0);
        &mut self.torques
    }

    /// Holds the actuator force on velocity `k` of `nv`, N·m or N.
    pub(crate) fn hold_force(&mut self, nv: usize, k: usize, value: f64) {
        self.forces.resize(nv, None);
        self.forces[k] = Some(value);
    }

    /// Holds input `i` of element `e` of a system, or gives it back to its signal; `None` where there is no such input.
    pub(crate) fn hold_input(&mut self, system: &System, e: usize, i: usize, value: Option<f64>) -> Option<()> {
        if self.inputs.is_empty() {
            self.inputs = system.elements.iter().map(|element| vec![None; element.inputs.len()]).collect();
        }
        *self.inputs.get_mut(e)?.get_mut(i)? = value;
        Some(())
    }
}

impl Context<'_> {
    /// Values and rates of the inputs of element `e` at t.
    pub(crate) fn inputs_at(&self, e: usize, t: f64, values: &mut [InputValue]) {
        self.system.elements[e].inputs_at(t, values);
        for held in [self.sampled, self.held] {
            let Some(held) = held.inputs.get(e) else { continue };
            for (value, held) in values.iter_mut().zip(held) {
                if let Some(held) = *held {
                    *value = InputValue { value: held, rate: 0.0 };
                }
            }
        }
    }

    /// Whether input `i` of element `e` is held, whatever else says what it is.
    pub(crate) fn holds_input(&self, e: usize, i: usize) -> bool {
        self.held.inputs.get(e).is_some_and(|held| held[i].is_some())
    }

    /// Whether the actuator force on velocity `k` is held, whatever else says what it is.
    pub(crate) fn holds_force(&self, k: usize) -> bool {
        self.held.forces.get(k).is_some_and(Option::is_some)
    }

    /// The actuator force on velocity `k` at t, N·m or N, where `signal` says what it is unless one is held.
    pub(crate) fn force(&self, k: usize, signal: &Signal, t: f64) -> f64 {
        let held = self.held.forces.get(k).copied().flatten();
        let sampled = self.sampled.torques.get(k).copied().unwrap_or(0.0);
        held.unwrap_or_else(|| signal.at(t).value + sampled) + self.torque(k)
    }

    /// What is added to the actuator force on velocity `k`, N·m or N.
    pub(crate) fn torque(&self, k: usize) -> f64 {
        self.held.torques.get(k).copied().unwrap_or(0.0)
    }
}

impl System {
    /// It alone.
    pub(crate) fn context(&self) -> Context<'_> {
        Context { system: self, held: Held::NONE, sampled: Held::NONE }
    }
}
