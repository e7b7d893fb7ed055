//! Sampled laws: when they are due, what they say, and when it acts.

use super::eye::{Eye, Shown};
use super::variation::{Held as HeldVariation, OfSamples, Sides};
use super::{ControlRun, Target, at};
use crate::control::{Aim, At, Control, Feedback, Sampling, Scratch, Sense};
use crate::equations::context::Held;
use crate::observe::Snapshot;
use crate::system::System;
use crate::system::error::RunError;
use crate::system::row_times::multiple;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Times that differ by less than this share of them are one.
const ONE_TIME: f64 = 1e-12;

/// Share of it by which a period may miss a whole number of steps.
const WHOLE: f64 = 1e-9;

/// The sampled laws of a run.
#[derive(Debug, Clone)]
pub(crate) struct Sampler {
    control: Arc<Control>,
    laws: Vec<Law>,
    /// The velocities that a controller drives.
    driven: Vec<usize>,
    state: SamplerState,
    /// What acts.
    acting: Arc<Held>,
    aim: Aim,
    /// Coordinates as the controller sees them (nq).
    measured: Vec<f64>,
    scratch: Scratch,
    /// Of every law, whether it is due, and what it says.
    due: Vec<bool>,
    said: Vec<Vec<f64>>,
    seen: Vec<f64>,
    /// On which sides of their limits the forces of the controller are (nv).
    limited: Vec<Sides>,
    /// What changes of what each law says; nothing where nothing is differentiated.
    changes: Vec<Vec<f64>>,
}

/// What changes of samples, in blocks of one number for each parameter.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Changes {
    waiting: Vec<VecDeque<Vec<f64>>>,
    acting: HeldVariation,
    /// Of what the controller said last before its limit.
    said: Vec<f64>,
}

/// A law that is sampled.
#[derive(Debug, Clone, Copy)]
struct Law {
    what: What,
    sampling: Sampling,
}

#[derive(Debug, Clone, Copy)]
enum What {
    /// Which of the torques by feedback.
    Torque(usize),
    /// Which of the inputs by feedback.
    Input(usize),
    Controller,
}

/// What outlasts a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct SamplerState {
    /// Of every law, how many samples were taken, and what does not act yet.
    counts: Vec<u64>,
    waiting: Vec<VecDeque<Vec<f64>>>,
    /// What acts; of a run under way it is with the sampler.
    acting: Held,
    /// What the controller said last before its limits (nv), whether it has, and on which side of its limit each force was.
    said: Vec<f64>,
    has_said: bool,
    sides: Vec<i8>,
    /// What parameters change of it, where any are asked for.
    changes: Option<Changes>,
}

impl Sampler {
    /// Of a system that has some; steps of one size take what is continuous at the start of each.
    ///
    /// # Errors
    /// [`RunError::SampleBetweenSteps`] where samples are due inside steps of one size.
    pub(crate) fn of(system: &System, fixed_step: Option<f64>) -> Result<Option<Box<Self>>, RunError> {
        let control = system.control.clone();
        let every = fixed_step.map(|period| Sampling { period, delay: 0 });
        let mut laws: Vec<Law> = Vec::new();
        let mut add = |what: What, sampling: Option<Sampling>| {
            laws.extend(sampling.or(every).map(|sampling| Law { what, sampling }));
        };
        control.torques.iter().enumerate().for_each(|(k, own)| add(What::Torque(k), own.sampling));
        control.inputs.iter().enumerate().for_each(|(k, own)| add(What::Input(k), own.sampling));
        if let Some(controlled) = &control.controller {
            add(What::Controller, controlled.sampling);
        }
        if laws.is_empty() {
            return Ok(None);
        }
        let period = |law: &Law| law.sampling.period;
        if let (Some(step), Some(law)) =
            (fixed_step, laws.iter().find(|law| fixed_step.is_some_and(|step| !is_multiple(period(law), step))))
        {
            let what = named(&control, law.what, system);
            return Err(RunError::SampleBetweenSteps { what, period: period(law), step });
        }
        let nv = system.model.nv();
        let mut held = Held::default();
        held.torques_mut(nv);
        for law in &laws {
            if let What::Input(k) = law.what {
                let own = &control.inputs[k];
                // What its place takes where 0 is none, as of a temperature.
                let before = system.elements[own.element].inputs[own.input].value(0.0);
                held.hold_input(system, own.element, own.input, Some(before)).expect("an input of the system");
            }
        }
        let state = SamplerState {
            counts: vec![0; laws.len()],
            waiting: vec![VecDeque::new(); laws.len()],
            acting: Held::default(),
            said: vec![0.0; nv],
            has_said: false,
            sides: vec![0; nv],
            changes: None,
        };
        let size = |law: &Law| if matches!(law.what, What::Controller) { nv } else { 1 };
        let driven = system.driven_velocities();
        Ok(Some(Box::new(Self {
            said: laws.iter().map(|law| vec![0.0; size(law)]).collect(),
            due: vec![false; laws.len()],
            driven: driven.into_iter().filter(|&k| system.model.coordinate_of(k).is_some()).collect(),
            control,
            laws,
            state,
            acting: Arc::new(held),
            aim: Aim::default(),
            measured: Vec::new(),
            scratch: Scratch::new(&system.model),
            seen: Vec::new(),
            limited: vec![Sides::default(); nv],
            changes: Vec::new(),
        })))
    }

    /// When the next sample is due, s.
    pub(crate) fn next(&self) -> f64 {
        let times = self.laws.iter().zip(&self.state.counts);
        times.map(|(law, count)| multiple(*count, law.sampling.period)).fold(f64::INFINITY, f64::min)
    }

    /// Whether a sample is due at t.
    pub(crate) fn is_due(&self, t: f64) -> bool {
        self.next() <= t * (1.0 + ONE_TIME)
    }

    /// What acts now.
    pub(crate) fn acting(&self) -> &Arc<Held> {
        &self.acting
    }

    /// On which side of its limit each force of a sampled controller is (nv).
    pub(crate) fn sides(&self) -> &[i8] {
        &self.state.sides
    }

    /// Takes all samples that are due at t, from what the robot shows just before.
    ///
    /// # Errors
    /// Where the reference cannot be followed, or a law says no number.
    ///
    /// What parameters change of that follows from `variation`, where the row was read.
    pub(crate) fn take(
        &mut self,
        eye: &Eye,
        shown: &dyn Shown,
        run: &ControlRun,
        mut variation: Option<&mut dyn OfSamples>,
    ) -> Result<(), RunError> {
        let t = eye.t;
        self.changes.clear();
        // All of one instant see what was before any of them acts.
        for k in 0..self.laws.len() {
            let at = multiple(self.state.counts[k], self.laws[k].sampling.period);
            let is_due = at <= t * (1.0 + ONE_TIME);
            self.due[k] = is_due;
            if !is_due {
                continue;
            }
            match self.laws[k].what {
                What::Torque(i) => {
                    self.said[k][0] = value(&self.control.torques[i].law, at, eye, shown, &mut self.seen)
                }
                What::Input(i) => self.said[k][0] = value(&self.control.inputs[i].law, at, eye, shown, &mut self.seen),
                What::Controller => self.ask(k, at, eye, shown, run)?,
            }
            if let Some(value) = self.said[k].iter().copied().find(|value| !value.is_finite()) {
                return Err(RunError::NotFinite { t, what: self.named(k, eye.system), value });
            }
        }
        if let Some(variation) = variation.as_deref_mut() {
            self.take_changes(variation, shown, run);
        }
        let mut changed = false;
        for k in (0..self.laws.len()).filter(|k| self.due[*k]) {
            self.state.counts[k] += 1;
            let waiting = &mut self.state.waiting[k];
            if self.laws[k].sampling.delay > 0 {
                // What waited longest makes room for what was said now.
                let full = waiting.len() >= self.laws[k].sampling.delay;
                let first = if full { waiting.pop_front() } else { None };
                let size = self.said[k].len();
                let now = std::mem::replace(&mut self.said[k], first.unwrap_or_else(|| vec![0.0; size]));
                waiting.push_back(now);
                if let (Some(own), Some(changes)) = (self.changes.get_mut(k), &mut self.state.changes) {
                    let waiting = &mut changes.waiting[k];
                    let first = if full { waiting.pop_front() } else { None };
                    let none = vec![0.0; own.len()];
                    waiting.push_back(std::mem::replace(own, first.unwrap_or(none)));
                }
                if !full {
                    continue;
                }
            }
            changed = true;
        }
        if !changed {
            return Ok(());
        }
        let acting = Arc::make_mut(&mut self.acting);
        let nv = eye.system.model.nv();
        for k in (0..self.laws.len()).filter(|k| self.due[*k]) {
            let delay = self.laws[k].sampling.delay as u64;
            if self.state.counts[k] <= delay {
                continue;
            }
            let said = &self.said[k];
            match self.laws[k].what {
                What::Torque(i) => acting.torques_mut(nv)[self.control.torques[i].velocity] = said[0],
                What::Input(i) => {
                    let own = &self.control.inputs[i];
                    let held = acting.hold_input(eye.system, own.element, own.input, Some(said[0]));
                    held.expect("an input of the system");
                }
                What::Controller => {
                    for &k in &self.driven {
                        acting.torques_mut(nv)[k] = said[k];
                    }
                }
            }
        }
        if let Some(variation) = variation {
            self.let_changes_act(nv);
            variation.hold(self.held_changes());
        }
        Ok(())
    }

    /// How many numbers its changes are at most.
    pub(crate) fn numbers(&self) -> usize {
        let nv = self.state.said.len();
        let sizes = self.laws.iter().zip(&self.said).map(|(law, said)| (law.sampling.delay + 1) * said.len());
        2 * nv + sizes.sum::<usize>()
    }

    /// Every block of its changes, of `count` numbers.
    pub(crate) fn each_block(&mut self, count: usize, take: &mut dyn FnMut(&mut [f64])) {
        let Some(Changes { waiting, acting, said }) = &mut self.state.changes else { return };
        let blocks = waiting.iter_mut().flatten().chain([said, &mut acting.torques]);
        let blocks = blocks.chain(acting.inputs.iter_mut().map(|(.., by)| by));
        blocks.for_each(|own| own.chunks_exact_mut(count).for_each(&mut *take));
    }

    /// What changes of what acts, where anything is differentiated.
    pub(crate) fn held_changes(&self) -> Option<&HeldVariation> {
        self.state.changes.as_ref().map(|changes| &changes.acting)
    }

    /// Works out what parameters change of the samples that are due.
    fn take_changes(&mut self, variation: &mut dyn OfSamples, shown: &dyn Shown, run: &ControlRun) {
        let (count, nv) = (variation.count(), self.state.said.len());
        let Self { laws, state, due, control, limited, .. } = self;
        let changes = state.changes.get_or_insert_with(|| Changes {
            waiting: vec![VecDeque::new(); laws.len()],
            acting: HeldVariation::default(),
            said: vec![0.0; nv * count],
        });
        self.changes = laws
            .iter()
            .zip(&*due)
            .map(|(law, due)| match law.what {
                _ if !due => Vec::new(),
                What::Torque(i) => variation.say(Target::Torque(control.torques[i].velocity), shown),
                What::Input(i) => {
                    let own = &control.inputs[i];
                    variation.say(Target::Input(own.element, own.input), shown)
                }
                What::Controller => {
                    let told = (&limited[..], &changes.said[..], law.sampling.period);
                    let [ahead, behind] = variation.say_of_controller(run, told, shown);
                    changes.said = ahead;
                    behind
                }
            })
            .collect();
    }

    /// Lets what changes of the samples act that do so now.
    fn let_changes_act(&mut self, nv: usize) {
        let Some(changes) = &mut self.state.changes else { return };
        for (k, own) in std::mem::take(&mut self.changes).into_iter().enumerate().filter(|(k, _)| self.due[*k]) {
            if self.state.counts[k] <= self.laws[k].sampling.delay as u64 {
                continue;
            }
            let acting = &mut changes.acting;
            let mut act = |velocity: usize, own: &[f64]| {
                let count = own.len();
                acting.torques.resize(nv * count, 0.0);
                acting.torques[velocity * count..][..count].copy_from_slice(own);
            };
            match self.laws[k].what {
                What::Torque(i) => act(self.control.torques[i].velocity, &own),
                What::Controller => {
                    let count = own.len() / nv;
                    self.driven.iter().for_each(|&k| act(k, &own[k * count..][..count]));
                }
                What::Input(i) => {
                    let law = &self.control.inputs[i];
                    let place = (law.element, law.input);
                    match acting.inputs.iter_mut().find(|(e, i, _)| (*e, *i) == place) {
                        Some((.., held)) => *held = own,
                        None => acting.inputs.push((law.element, law.input, own)),
                    }
                }
            }
        }
    }

    /// Works out what the controller says (nv), all limits included.
    fn ask(&mut self, law: usize, t: f64, eye: &Eye, shown: &dyn Shown, run: &ControlRun) -> Result<(), RunError> {
        let (system, period) = (eye.system, self.laws[law].sampling.period);
        let Self { control, aim, scratch, said, state, driven, limited, measured, .. } = self;
        let (tau, controlled) = (&mut said[law], control.controller.as_ref().expect("a controller that is sampled"));
        let site = system.gripper.as_ref();
        controlled.reference.at_into(&system.model, site, t, &mut scratch.kinematics, aim)?;
        let at = At { t, ..at(eye, aim, &controlled.shaping) };
        measured.clear();
        measured.extend_from_slice(eye.q);
        if let Some(measurement) = &controlled.measurement {
            for (k, place) in driven.iter().filter_map(|&k| Some((k, system.model.coordinate_of(k)?))) {
                measured[place] = measurement.of(eye.q[place], k, state.counts[law]);
            }
        }
        controlled.torque(&At { q: &*measured, ..at }, scratch, tau);
        if controlled.law.compensates_elements() {
            shown.add_pull(tau);
        }
        for &k in &*driven {
            let tau = &mut tau[k];
            *tau += run.terms_now(k, at.error(k), at.taken(k));
            let limit = controlled.limits.get(k).copied().unwrap_or_default();
            limited[k] = Sides::default();
            if state.has_said {
                let reach = limit.rate * period;
                limited[k].rate = i8::from(*tau > state.said[k] + reach) - i8::from(*tau < state.said[k] - reach);
                *tau = tau.clamp(state.said[k] - reach, state.said[k] + reach);
            }
            let is_above = *tau > limit.torque;
            state.sides[k] = if is_above { 1 } else { -i8::from(*tau < -limit.torque) };
            limited[k].force = state.sides[k];
            // Rates are those of the force before its limit, which acts last.
            state.said[k] = *tau;
            *tau = tau.clamp(-limit.torque, limit.torque);
        }
        state.has_said = true;
        Ok(())
    }

    fn named(&self, law: usize, system: &System) -> String {
        named(&self.control, self.laws[law].what, system)
    }

    /// What outlasts the steps.
    pub(crate) fn state(&self) -> SamplerState {
        SamplerState { acting: (*self.acting).clone(), ..self.state.clone() }
    }

    /// Goes on from a state of the same system; `false` where it is of another one.
    pub(crate) fn go_on(&mut self, state: SamplerState) -> bool {
        let fits = state.counts.len() == self.laws.len() && state.waiting.len() == self.laws.len();
        if fits {
            self.acting = state.acting.clone().into();
            self.state = state;
        }
        fits
    }
}

/// What a law says, as a column is called.
fn named(control: &Control, what: What, system: &System) -> String {
    match what {
        What::Torque(i) => Target::Torque(control.torques[i].velocity).column(system),
        What::Input(i) => {
            let own = &control.inputs[i];
            Target::Input(own.element, own.input).column(system)
        }
        What::Controller => "the force of the controller".to_owned(),
    }
}

/// Whether a period is a whole number of steps, but for rounding.
fn is_multiple(period: f64, step: f64) -> bool {
    let count = (period / step).round();
    count >= 1.0 && (period / step - count).abs() <= WHOLE * count
}

/// What an expression says of what is shown.
fn value(law: &Feedback, t: f64, eye: &Eye, shown: &dyn Shown, seen: &mut Vec<f64>) -> f64 {
    seen.clear();
    seen.extend(law.senses().iter().map(|sense| match *sense {
        Sense::Acceleration(k) => shown.acceleration(k),
        Sense::Force(e) => shown.force(e),
        Sense::Derivative(e) => shown.derivative(e),
        sense => eye.value(sense),
    }));
    law.value(t, seen)
}

impl Shown for Snapshot {
    fn force(&self, e: usize) -> f64 {
        Self::force(self, e)
    }

    fn derivative(&self, e: usize) -> f64 {
        self.elements[e].observation.derivative
    }

    fn acceleration(&self, k: usize) -> f64 {
        self.evaluation.a[k]
    }

    fn add_pull(&self, tau: &mut [f64]) {
        for (e, element) in self.evaluation.elements.iter().enumerate() {
            let force = Self::force(self, e);
            tau.iter_mut().zip(&element.gradient).for_each(|(tau, slope)| *tau += force * slope);
        }
    }
}
