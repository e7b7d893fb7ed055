//! Control of a robot in a loop: sampled, at the start of its steps.

use super::real_time::MemorySettings;
use super::step::OneStage;
use crate::elements::ElementBank;
use crate::equations::context::Held;
use crate::equations::control::{ControlRun, ControlState, Eye, Sampler, SamplerState, Shown};
use crate::law::{Observation, Point};
use crate::system::System;
use crate::system::error::RunError;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What controls a robot in a loop.
#[derive(Debug, Clone)]
pub(super) struct LoopControl {
    sampler: Box<Sampler>,
    run: Box<ControlRun>,
}

/// What of it outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct LoopControlState {
    sampler: SamplerState,
    run: ControlState,
}

/// A robot in a loop between two steps.
struct Between<'a> {
    system: &'a System,
    stage: &'a OneStage,
    /// None before the laws begin.
    bank: Option<&'a ElementBank>,
}

impl LoopControl {
    /// Of a system that is controlled, at the start.
    pub(super) fn of(
        system: &System,
        step: f64,
        stage: &OneStage,
        memory: MemorySettings,
    ) -> Result<Option<Self>, RunError> {
        let (Some(sampler), Some(mut run)) = (Sampler::of(system, Some(step))?, ControlRun::of(system, true)) else {
            return Ok(None);
        };
        run.begin(system, &stage.origin.q, &stage.origin.v, memory.horizon)?;
        run.open(memory.tolerance, step, memory.horizon)?;
        Ok(Some(Self { sampler, run }))
    }

    /// What the first samples say before the laws begin, which start from it.
    pub(super) fn first(&mut self, system: &System, stage: &OneStage) -> Result<Arc<Held>, RunError> {
        let mut sampler = self.sampler.clone();
        let shown = Between { system, stage, bank: None };
        shown.look(|eye| sampler.take(eye, &shown, &self.run, None))?;
        Ok(sampler.acting().clone())
    }

    /// Takes the samples that are due.
    pub(super) fn take(&mut self, system: &System, stage: &OneStage, bank: &ElementBank) -> Result<(), RunError> {
        if !self.sampler.is_due(stage.origin.t) {
            return Ok(());
        }
        let shown = Between { system, stage, bank: Some(bank) };
        shown.look(|eye| self.sampler.take(eye, &shown, &self.run, None))?;
        self.run.set_sides(self.sampler.sides());
        Ok(())
    }

    /// What acts.
    pub(super) fn acting(&self) -> &Held {
        self.sampler.acting()
    }

    /// What outlasts a step.
    pub(super) fn state(&self) -> LoopControlState {
        LoopControlState { sampler: self.sampler.state(), run: self.run.state() }
    }

    /// Goes on from a state of the same system; `false` where it is of another one.
    pub(super) fn go_on(&mut self, LoopControlState { sampler, run }: LoopControlState) -> bool {
        self.sampler.go_on(sampler) && self.run.go_on(run)
    }

    /// Takes the step that was just worked out into the past.
    pub(super) fn commit(&mut self, system: &System, stage: &OneStage) -> Result<(), RunError> {
        let ends = [&stage.origin, &stage.end].map(|end| (end.t, &end.q[..], &end.v[..]));
        self.run.take_ends(system, ends)?;
        self.run.commit();
        Ok(())
    }
}

impl Between<'_> {
    fn look(&self, take: impl FnOnce(&Eye) -> Result<(), RunError>) -> Result<(), RunError> {
        let read = |e: usize| self.stage.equations.read(e);
        let origin = &self.stage.origin;
        let (q, v, kinematics) = (&origin.q[..], &origin.v[..], &origin.kinematics);
        take(&Eye { system: self.system, t: origin.t, q, v, kinematics, element: &read })
    }
}

impl Shown for Between<'_> {
    fn force(&self, e: usize) -> f64 {
        self.observed(e, |observation| observation.finite_force())
    }

    fn derivative(&self, e: usize) -> f64 {
        self.observed(e, |observation| observation.derivative)
    }

    fn acceleration(&self, k: usize) -> f64 {
        self.stage.a[k]
    }

    fn add_pull(&self, tau: &mut [f64]) {
        for e in 0..self.system.elements.len() {
            let (force, gradient) = (self.force(e), self.stage.equations.gradient(e));
            tau.iter_mut().zip(gradient).for_each(|(tau, slope)| *tau += force * slope);
        }
    }
}

impl Between<'_> {
    fn observed(&self, e: usize, of: impl FnOnce(&Observation) -> f64) -> f64 {
        let Some(bank) = self.bank else { return 0.0 };
        let [coordinate, rate] = self.stage.equations.read(e);
        let stroke = self.system.elements[e].stroke(coordinate);
        let point = Point { t: self.stage.origin.t, stroke, rate, inputs: bank.point(e, 1).inputs };
        bank.now(e, &point).as_ref().map_or(0.0, of)
    }
}
