//! What outlasts a step: it begins with the run, is committed with each step, saved and loaded.

use super::assembly::Equations;
use super::context::Context;
use super::control::{ControlState, End, Eye, OfSamples, Sampler, Shown};
use super::friction::Sliding;
use super::rounding::Shares;
use super::variation::Variation;
use crate::elements::Kept;
use crate::system::System;
use crate::system::error::RunError;
use serde::{Deserialize, Serialize};

/// What outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct EquationsState {
    elements: Vec<Option<Kept>>,
    control: Option<ControlState>,
    sliding: Sliding,
    /// Of every element, the force at the start of the next step without the share of a singular start, and that share, N or N·m.
    forces: Vec<[f64; 2]>,
    is_singular: bool,
    rounding: Shares,
}

impl Equations {
    /// Begins what is kept of the errors of a controller, where the motion starts; `end` is that of the run, s.
    ///
    /// # Errors
    /// Where the reference cannot be followed, or a memory cannot be.
    pub(crate) fn begin_control(&mut self, system: &System, end: f64) -> Result<(), RunError> {
        let Some(control) = &mut self.control else { return Ok(()) };
        let start = system.state(0.0)?;
        control.begin(system, &start.q, &start.v, end)
    }

    /// Builds the memories of a controller; `first` is the size of the first step.
    ///
    /// # Errors
    /// Where one cannot be built.
    pub(crate) fn open_control(&mut self, tolerance: f64, first: f64, horizon: f64) -> Result<(), RunError> {
        self.control.as_mut().map_or(Ok(()), |control| control.open(tolerance, first, horizon))
    }

    /// The laws have begun.
    pub(crate) fn take_starts(&mut self) {
        self.is_singular = self.bank.has_singular();
        // They were told no rates.
        (self.tangent.is_known, self.tangent.is_seen) = (false, false);
    }

    /// Takes the samples that are due, from what is `shown` just before.
    ///
    /// # Errors
    /// Where a reference cannot be followed.
    pub(crate) fn sample(
        &mut self,
        sampler: &mut Sampler,
        eye: &Eye,
        shown: &dyn Shown,
        variation: Option<&mut Variation>,
    ) -> Result<(), RunError> {
        if let Some(control) = &mut self.control {
            sampler.take(eye, shown, control, variation.map(|variation| variation as &mut dyn OfSamples))?;
            control.set_sides(sampler.sides());
        }
        Ok(())
    }

    /// Takes over on which side of its limit each force of a sampled controller is.
    pub(crate) fn take_sides(&mut self, sampler: &Sampler) {
        if let Some(control) = &mut self.control {
            control.set_sides(sampler.sides());
        }
    }

    /// How long a step from t may be, at most h, so that its nodes see what a reference does.
    pub(crate) fn reach(&self, t: f64, h: f64) -> f64 {
        self.control.as_ref().map_or(h, |control| control.reach(t, h))
    }

    /// Goes onto the branches of control behind the changes that were seen, at the end of the step or at its start; `end` is that of the run.
    ///
    /// # Errors
    /// [`RunError::ControlChatter`].
    pub(crate) fn change_branches(&mut self, cx: Context, is_end: bool, end: f64) -> Result<(), RunError> {
        self.control.as_mut().map_or(Ok(()), |control| control.change(cx.system, is_end, end))
    }

    /// Tells control the `ends` of the step that was worked out.
    ///
    /// # Errors
    /// Where the reference of a controller cannot be followed.
    pub(crate) fn take_ends(&mut self, cx: Context, ends: [End; 2]) -> Result<(), RunError> {
        self.control.as_mut().map_or(Ok(()), |control| control.take_ends(cx.system, ends))
    }

    /// Takes the step that was worked out into the past.
    ///
    /// # Errors
    /// [`RunError::ControlChatter`].
    pub(crate) fn commit(&mut self, cx: Context, end: f64) -> Result<(), RunError> {
        self.change_branches(cx, true, end)?;
        if let Some(control) = &mut self.control {
            control.commit();
        }
        self.bank.commit_account();
        self.rounding.shares.commit();
        Ok(())
    }

    /// What outlasts the steps.
    pub(crate) fn save(&self) -> EquationsState {
        EquationsState {
            elements: self.bank.kept(),
            control: self.control.as_ref().map(|control| control.state()),
            sliding: self.friction.sliding.clone(),
            forces: self.elements.iter().map(|nodes| [nodes.force, nodes.singular]).collect(),
            is_singular: self.is_singular,
            rounding: self.rounding.shares.clone(),
        }
    }

    /// Goes on from a state of the same system; `false`, and nothing changed, where it is of another one.
    pub(crate) fn load(&mut self, state: EquationsState) -> bool {
        let EquationsState { elements, control, sliding, forces, is_singular, rounding } = state;
        let fits = forces.len() == self.elements.len() && self.friction.fits(&sliding);
        let controls = match (&mut self.control, control) {
            (None, None) => true,
            (Some(own), Some(state)) if fits => own.go_on(state),
            _ => false,
        };
        if !fits || !controls || !self.bank.go_on(elements) {
            return false;
        }
        self.friction.sliding = sliding;
        self.take_free();
        for (nodes, [force, singular]) in self.elements.iter_mut().zip(forces) {
            (nodes.force, nodes.singular) = (force, singular);
        }
        self.is_singular = is_singular;
        self.rounding.shares = rounding;
        self.tangent.forget();
        true
    }
}
