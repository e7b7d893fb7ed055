//! The springpot: a fractional derivative of the stroke.

use super::contract::{Holds, Leaf, When};
use super::kind::{LeafBuild, LeafKind};
use crate::collocation::MAX_NODES;
use crate::collocation::Nodes;
use crate::dual::{Dual, Real};
use crate::fractional::Kind as Derivative;
use crate::fractional::{
    EnergyTangent, Form, KernelError, Memory, MemoryTangent, RatePolynomial, Singular, StepStart, TangentEnd,
    TangentPoint, TangentSeeds, TangentStep,
};
use crate::law::catalog::{Param, Range, alpha};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::Course;
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use crate::law::variation::{
    ObservationVariation, PointVariation, PowersVariation, StepVariation, VariationMut, VariationRef, add,
};
use std::borrow::Cow;
use std::sync::Arc;

/// A coefficient that may follow an input: constant + slope·input.
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficient {
    /// Value where the input is 0.
    pub constant: Dual,
    /// Change per unit of the input.
    pub slope: Dual,
    /// Which input; `None`: constant.
    pub input: Option<usize>,
    /// The rule that keeps it from turning negative, as the message says it.
    pub rule: Cow<'static, str>,
    /// The parameter to change where the rule is broken.
    pub parameter: Cow<'static, str>,
}

/// F = c·D^alpha x, c outside the derivative also when it varies.
///
/// At alpha = 0 a spring (on x, or on x − x(0) for Caputo), at alpha = 1 a dashpot. Stores c·ψ, dissipates c·P with ψ and P of
/// [`crate::fractional::Energy`]; a varying c exchanges ∫ c'ψ dt with its input.
#[derive(Debug, Clone, PartialEq)]
pub struct Springpot {
    /// Coefficient c ≥ 0, N·s^alpha/m.
    pub coefficient: Coefficient,
    /// Order, 0 ≤ alpha ≤ 1.
    pub alpha: Dual,
    /// Which derivative.
    pub derivative: Derivative,
}

impl Coefficient {
    /// A coefficient that never changes.
    pub fn constant(value: impl Into<Dual>) -> Self {
        Self {
            constant: value.into(),
            slope: Dual::default(),
            input: None,
            rule: "c ≥ 0".into(),
            parameter: "c".into(),
        }
    }

    /// constant + slope·input of the input counted from 0, never below 0.
    pub(in crate::law) fn following([constant, slope]: [Dual; 2], rule: &'static str, parameter: &'static str) -> Self {
        Self { constant, slope, input: Some(0), rule: rule.into(), parameter: parameter.into() }
    }

    /// Whether it is 0 whatever the inputs.
    pub(super) fn is_none(&self) -> bool {
        self.constant.value == 0.0 && (self.slope.value == 0.0 || self.input.is_none())
    }

    /// Whether it is 0 or more under the inputs; `what` is what messages call it.
    ///
    /// # Errors
    /// [`RuleError`] with its rule and its parameter.
    pub(super) fn check(&self, inputs: &[InputValue], what: &str) -> Result<(), RuleError> {
        let c = self.at(inputs).value;
        if c >= 0.0 {
            return Ok(());
        }
        let rule = format!("{} is broken: {what} is {c}", self.rule);
        Err(RuleError { rule, parameter: self.parameter.clone() })
    }

    /// Value and rate under the inputs.
    pub fn at<T: Real>(&self, inputs: &[InputValue<T>]) -> InputValue<T> {
        let [constant, slope] = [self.constant, self.slope].map(T::of);
        match self.input {
            None => InputValue { value: constant, rate: 0.0.into() },
            Some(i) => InputValue { value: constant + slope * inputs[i].value, rate: slope * inputs[i].rate },
        }
    }

    /// Its numbers.
    pub(super) fn numbers(&mut self) -> [&mut Dual; 2] {
        [&mut self.constant, &mut self.slope]
    }
}

impl Springpot {
    /// F from the regular D^alpha x.
    fn observation(&self, memory: &Memory, at: &Point, derivative: f64, energy: impl FnOnce() -> f64) -> Observation {
        let c = self.coefficient.at(at.inputs).value;
        if !memory.is_singular() {
            let stored = memory.is_accounted().then(|| c * energy());
            return Observation { derivative, regular: c * derivative, singular: 0.0, stored };
        }
        let singular = if at.t == 0.0 { f64::NAN } else { memory.singular_part(at.t) };
        Observation { derivative: derivative + singular, regular: c * derivative, singular: c * singular, stored: None }
    }
}

/// Blocks of c's numbers: constant, slope, alpha.
const ALPHA: usize = 2;

impl Coefficient {
    /// Adds factor·δc, where the input of `inputs` that it follows changes by `input`.
    fn add_change(
        &self,
        inputs: &[InputValue],
        input: Option<&[f64]>,
        own: &VariationRef,
        factor: f64,
        sum: &mut [f64],
    ) {
        add(sum, factor, own.number(0));
        let Some(followed) = self.input else { return };
        add(sum, factor * inputs[followed].value, own.number(1));
        input.into_iter().for_each(|input| add(sum, factor * self.slope.value, input));
    }

    /// The same of the rate of c, where that of the input changes by `rate`.
    fn add_rate_change(
        &self,
        inputs: &[InputValue],
        rate: Option<&[f64]>,
        own: &VariationRef,
        factor: f64,
        sum: &mut [f64],
    ) {
        let Some(followed) = self.input else { return };
        add(sum, factor * inputs[followed].rate, own.number(1));
        rate.into_iter().for_each(|rate| add(sum, factor * self.slope.value, rate));
    }
}

impl Springpot {
    fn tangent_step<'a>(step: &Step<'a>) -> TangentStep<'a> {
        let Step { nodes, places, form, .. } = *step;
        TangentStep { start: step.start(), nodes, places, form, polynomial: step.polynomial() }
    }

    /// What changes of strokes and rates at the times of the points, where the clock moves the points and `told` says what changes of those at them.
    fn at_times(step: &TangentStep, told: &StepVariation) -> [Vec<f64>; 2] {
        let (mut stroke, mut rate) = (told.stroke.to_vec(), told.rate.to_vec());
        let (passed, count) = (told.passed.unwrap_or_default(), told.count);
        let positions = step.places.map_or(step.nodes.positions(), |places| places.positions());
        for ((passed, theta), k) in passed.chunks_exact(count).zip(positions).zip(1..) {
            add(&mut stroke[k * count..(k + 1) * count], -step.polynomial.rate(*theta), passed);
            add(&mut rate[k * count..(k + 1) * count], -step.polynomial.bend(*theta), passed);
        }
        [stroke, rate]
    }

    /// Adds to the blocks of D^alpha x at the nodes what moves of them with the clock, where strokes and rates at them stay.
    fn add_moved(memory: &Memory, step: &Step, passed: &[f64], count: usize, derivatives: &mut [f64]) {
        let (start, polynomial) = (step.start(), step.polynomial());
        let affine = memory.respond_at(&start, step.nodes, step.places, step.form);
        for (i, derivatives) in derivatives.chunks_exact_mut(count).enumerate() {
            let own = &passed[i * count..(i + 1) * count];
            if own.iter().any(|passed| *passed != 0.0) {
                // Of a singular start, whose share follows from the time since then, nothing is known.
                let theta = step.positions()[i];
                let slope = || match step.nodes {
                    // The mean over the step, h long: d(∫D/h)/dh = (D(h) − ∫D/h)/h.
                    Nodes::Midpoint => {
                        let mean = affine.history[i] + affine.stroke[i][i] * (step.stroke[1] - step.stroke[0]);
                        (memory.regular_derivative(&polynomial, 1.0, 0.0, 0.0) - mean) / (theta * step.h)
                    }
                    _ => memory.slopes(&polynomial, theta).derivative,
                };
                add(derivatives, if memory.is_singular() { f64::NAN } else { slope() }, own);
            }
            for (j, passed) in passed.chunks_exact(count).enumerate() {
                let at = step.positions()[j];
                let along = affine.stroke[i][j] * polynomial.rate(at) + affine.rate[i][j] * polynomial.bend(at);
                add(derivatives, -along, passed);
            }
        }
    }

    /// D^alpha x at the nodes of a step, the share of a singular start as the course takes it.
    fn derivatives(memory: &Memory, step: &Step) -> [f64; MAX_NODES] {
        let (start, mut derivatives) = (step.start(), [0.0; MAX_NODES]);
        let affine = memory.respond_at(&start, step.nodes, step.places, step.form);
        for (i, derivative) in derivatives.iter_mut().enumerate().take(step.nodes.count()) {
            let own = |j: usize| {
                affine.stroke[i][j] * (step.stroke[j + 1] - step.stroke[0]) + affine.rate[i][j] * step.rate[j + 1]
            };
            *derivative = affine.history[i] + (0..step.nodes.count()).map(own).sum::<f64>();
        }
        if memory.is_singular() && step.course != Course::Given {
            let moments = memory.singular_moments(&start, step.nodes, step.places);
            for (i, derivative) in derivatives.iter_mut().enumerate().take(step.nodes.count()) {
                let value = memory.singular_part(step.t + step.positions()[i] * step.h);
                *derivative = *derivative - value + moments[i];
            }
        }
        derivatives
    }
}

impl Leaf for Springpot {
    fn name(&self) -> &'static str {
        "springpot"
    }

    fn size(&self) -> StateSize {
        StateSize { memories: 1, variables: 0 }
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        state.push_memory(Memory::closed(self.alpha.value, self.derivative, start.stroke, start.jump)?);
        Ok(())
    }

    fn prepare(&self, step: &Step, state: StateMut) {
        state.memories[0].prepare_at(&step.start(), step.nodes, step.places, step.form);
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let memory = &state.memories[0];
        let start = step.start();
        let affine = memory.respond_at(&start, step.nodes, step.places, step.form);
        let moments = match step.course {
            Course::Sought if memory.is_singular() => memory.singular_moments(&start, step.nodes, step.places),
            _ => [0.0; MAX_NODES],
        };
        let count = step.nodes.count();
        for i in 0..count {
            let c = self.coefficient.at(step.point(i + 1).inputs).value;
            let mut derivative = affine.history[i];
            if memory.is_singular() {
                let value = memory.singular_part(step.t + step.positions()[i] * step.h);
                let share = if step.course == Course::Sought { moments[i] } else { value };
                derivative += share - value;
                response.singular[i] += c * share;
            }
            for j in 0..count {
                derivative += affine.stroke[i][j] * (step.stroke[j + 1] - step.stroke[0]);
                derivative += affine.rate[i][j] * step.rate[j + 1];
                response.d_stroke[i][j] += c * affine.stroke[i][j];
                response.d_rate[i][j] += c * affine.rate[i][j];
            }
            response.force[i] += c * derivative;
        }
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if self.coefficient.input != Some(input) || self.coefficient.slope.value == 0.0 {
            return;
        }
        let affine = state.memories[0].respond_at(&step.start(), step.nodes, step.places, step.form);
        let count = step.nodes.count();
        for i in 0..count {
            let own = |j: usize| {
                affine.stroke[i][j] * (step.stroke[j + 1] - step.stroke[0]) + affine.rate[i][j] * step.rate[j + 1]
            };
            let derivative = affine.history[i] + (0..count).map(own).sum::<f64>();
            slopes[i][i] += self.coefficient.slope.value * derivative;
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        let polynomial = step.polynomial();
        let memory = &mut state.memories[0];
        match step.form {
            Form::Rates => {
                let end = step.stroke[step.nodes.count()];
                memory.commit_rates(&polynomial, step.places, end, step.resolution);
            }
            Form::Strokes | Form::Hermite => memory.commit_at(&polynomial, step.places),
        }
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let memory = &state.memories[0];
        let (last, polynomial) = (step.nodes.count(), step.polynomial());
        let [stroke, rate] = [step.stroke, step.rate].map(|values| [values[0], values[last]]);
        let is_along = step.nodes == Nodes::Radau && step.course == Course::Given && step.form != Form::Strokes;
        let (error, falls) = if is_along {
            let (form, known) = ((step.form, step.places), [step.stroke, step.rate]);
            let error = memory.defect_along(&polynomial, form, known, step.resolution);
            (error, if step.form == Form::Hermite { 7.0 } else { 5.0 })
        } else {
            (memory.defect(&polynomial, stroke, rate, step.resolution), 4.0)
        };
        errors.push(LocalError {
            error,
            value: memory.regular_derivative(&polynomial, 1.0, stroke[1], rate[1]),
            order: self.alpha.value,
            falls: falls - self.alpha.value,
            sharpness: if self.alpha.value == 1.0 { 0.0 } else { 1.0 },
        });
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let memory = &state.memories[0];
        let polynomial = step.polynomial();
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let at = step.point(k);
            let c = self.coefficient.at(at.inputs);
            if memory.is_singular() {
                // The stored energy is infinite, and what a varying coefficient makes of it is unknown.
                power.input += if c.rate == 0.0 { 0.0 } else { f64::NAN };
                continue;
            }
            let theta = if k == 0 { 0.0 } else { step.positions()[k - 1] };
            let energy = memory.energy(&polynomial, theta, at.stroke, at.rate);
            power.dissipation += c.value * energy.dissipation;
            power.input += c.rate * energy.stored;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let memory = &state.memories[0];
        let polynomial = step.polynomial();
        let derivative = if step.form == Form::Rates && step.nodes == Nodes::Radau && theta < 1.0 {
            match step.places {
                None => memory.derivative_between(&polynomial, theta, at.stroke, at.rate),
                Some(places) => {
                    let nodes = places.node_polynomial();
                    memory.derivative_between_at(&polynomial, &nodes, theta, at.stroke, at.rate)
                }
            }
        } else {
            memory.regular_derivative(&polynomial, theta, at.stroke, at.rate)
        };
        let at = Point { t: step.t + theta * step.h, ..*at };
        self.observation(memory, &at, derivative, || memory.energy(&polynomial, theta, at.stroke, at.rate).stored)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        let memory = &state.memories[0];
        self.observation(memory, at, memory.now(at.stroke, at.rate), || memory.stored(at.stroke, at.rate))
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        [self.coefficient.constant, self.coefficient.slope, self.alpha].into_iter().for_each(take);
        true
    }

    fn begin_memories(
        &self,
        state: StateRef,
        own: VariationRef,
        memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        let none = vec![0.0; own.count];
        let seeds = TangentSeeds { alpha: own.number(ALPHA), origin: &none, jump: &none };
        memories.push(MemoryTangent::new(&state.memories[0], &seeds)?);
        Ok(())
    }

    fn begin_variation(&self, _: &Point, state: StateRef, told: &PointVariation, own: VariationMut) {
        own.memories[0].begin(&state.memories[0], told.stroke);
    }

    fn vary(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        let (memory, tangent) = (&state.memories[0], &own.memories[0]);
        let at_start = TangentPoint {
            stroke: step.stroke[0],
            rate: step.rate[0],
            delta_stroke: told.stroke_at(0),
            delta_rate: told.rate_at(0),
        };
        let mut derivatives = vec![0.0; forces.len()];
        let singular = if step.course == Course::Sought { Singular::Moments } else { Singular::Values };
        tangent.explicit(memory, &Self::tangent_step(step), singular, &at_start, &mut derivatives);
        if let Some(passed) = told.passed.filter(|_| memory.is_fractional()) {
            Self::add_moved(memory, step, passed, own.count, &mut derivatives);
        }
        let values = Self::derivatives(memory, step);
        for (i, forces) in forces.chunks_exact_mut(own.count).enumerate() {
            let inputs = step.point(i + 1).inputs;
            add(forces, self.coefficient.at(inputs).value, &derivatives[i * own.count..(i + 1) * own.count]);
            let followed = self.coefficient.input.and_then(|input| told.input_at(i + 1, input, inputs.len()));
            self.coefficient.add_change(inputs, followed.map(|[value, _]| value), &own, values[i], forces);
        }
    }

    fn commit_variation(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationMut) {
        let tangent_step = Self::tangent_step(step);
        let (count, memory) = (own.count, &state.memories[0]);
        let mut changes = vec![0.0; tangent_step.coefficients() * count];
        let moved = told.passed.filter(|_| memory.is_fractional());
        let at_times = moved.map(|_| Self::at_times(&tangent_step, told));
        let [stroke, rate] =
            at_times.as_ref().map_or([told.stroke, told.rate], |own| own.each_ref().map(Vec::as_slice));
        tangent_step.delta_polynomial(stroke, rate, &mut changes);
        let last = step.nodes.count();
        let delta_stroke = &stroke[last * count..(last + 1) * count];
        let end = TangentEnd { stroke: step.stroke[last], delta_stroke, resolution: step.resolution };
        let end = (step.form == Form::Rates).then_some(&end);
        own.memories[0].commit(memory, &tangent_step, &changes, end);
        if let Some(passed) = moved {
            let mut after = [memory.clone()];
            self.commit(step, StateMut { memories: &mut after, variables: &mut [], ready: &mut [] });
            let of_end = &passed[(last - 1) * count..last * count];
            own.memories[0].move_end([memory, &after[0]], &tangent_step, end, of_end);
        }
    }

    fn vary_powers(
        &self,
        step: &Step,
        state: StateRef,
        told: &StepVariation,
        own: VariationRef,
        sum: &mut PowersVariation,
    ) {
        let (memory, tangent, count) = (&state.memories[0], &own.memories[0], own.count);
        if memory.is_singular() {
            // As of the energies themselves.
            return;
        }
        let tangent_step = Self::tangent_step(step);
        let mut changes = vec![0.0; tangent_step.coefficients() * count];
        let (mut stored, mut dissipation) = (vec![0.0; count], vec![0.0; count]);
        let moved = told.passed.filter(|_| memory.is_fractional());
        let at_times = moved.map(|_| Self::at_times(&tangent_step, told));
        let [strokes, rates] =
            at_times.as_ref().map_or([told.stroke, told.rate], |own| own.each_ref().map(Vec::as_slice));
        tangent_step.delta_polynomial(strokes, rates, &mut changes);
        for k in 0..=step.nodes.count() {
            let (at, theta) = (step.point(k), if k == 0 { 0.0 } else { step.positions()[k - 1] });
            let [delta_stroke, delta_rate] = [strokes, rates].map(|blocks| &blocks[k * count..(k + 1) * count]);
            let point = TangentPoint { stroke: at.stroke, rate: at.rate, delta_stroke, delta_rate };
            let mut change = EnergyTangent { stored: &mut stored, dissipation: &mut dissipation };
            tangent.energy(memory, &tangent_step, theta, &point, &changes, &mut change);
            if let Some(passed) = moved.filter(|_| k > 0) {
                let (slopes, passed) =
                    (memory.slopes(&tangent_step.polynomial, theta), &passed[(k - 1) * count..k * count]);
                add(&mut stored, slopes.stored, passed);
                add(&mut dissipation, slopes.dissipation, passed);
            }
            let (c, energy) =
                (self.coefficient.at(at.inputs), memory.energy(&tangent_step.polynomial, theta, at.stroke, at.rate));
            let followed = self.coefficient.input.and_then(|input| told.input_at(k, input, at.inputs.len()));
            let block = k * count..(k + 1) * count;
            add(&mut sum.dissipation[block.clone()], c.value, &dissipation);
            let by_value = followed.map(|[value, _]| value);
            let to = &mut sum.dissipation[block.clone()];
            self.coefficient.add_change(at.inputs, by_value, &own, energy.dissipation, to);
            add(&mut sum.input[block.clone()], c.rate, &stored);
            let rate = followed.map(|[_, rate]| rate);
            self.coefficient.add_rate_change(at.inputs, rate, &own, energy.stored, &mut sum.input[block]);
        }
    }

    fn vary_at(
        &self,
        when: When,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let (memory, tangent, count) = (&state.memories[0], &own.memories[0], own.count);
        let (mut changes, mut derivatives) = (Vec::new(), vec![0.0; count]);
        let mut kinematics = [told.stroke.to_vec(), told.rate.to_vec()];
        let mut moved = None;
        if let (When::Within(step, theta), Some(passed)) = (when, told.passed.filter(|_| memory.is_fractional())) {
            let polynomial = step.polynomial();
            add(&mut kinematics[0], -polynomial.rate(theta), passed);
            add(&mut kinematics[1], -polynomial.bend(theta), passed);
            moved = Some((memory.slopes(&polynomial, theta), passed));
        }
        let [delta_stroke, delta_rate] = kinematics.each_ref().map(Vec::as_slice);
        let point = TangentPoint { stroke: at.stroke, rate: at.rate, delta_stroke, delta_rate };
        let (tangent_step, theta, derivative, energy) = match (when, told.step) {
            (When::Within(step, theta), Some(around)) => {
                let tangent_step = Self::tangent_step(step);
                changes.resize(tangent_step.coefficients() * count, 0.0);
                match around.passed.filter(|_| memory.is_fractional()) {
                    Some(_) => {
                        let [stroke, rate] = Self::at_times(&tangent_step, &around);
                        tangent_step.delta_polynomial(&stroke, &rate, &mut changes);
                    }
                    None => tangent_step.delta_polynomial(around.stroke, around.rate, &mut changes),
                }
                tangent.at(memory, &tangent_step, theta, &point, &changes, &mut derivatives);
                if let Some((slopes, passed)) = moved {
                    add(&mut derivatives, slopes.derivative, passed);
                }
                let seen = self.at(step, theta, at, state);
                let energy = memory.energy(&tangent_step.polynomial, theta, at.stroke, at.rate).stored;
                let singular = if memory.is_singular() { memory.singular_part(at.t) } else { 0.0 };
                (tangent_step, theta, seen.derivative - singular, energy)
            }
            _ => {
                tangent.now(memory, told.stroke, told.rate, &mut derivatives);
                let start = StepStart { t: at.t, h: 0.0, stroke: at.stroke, rate: at.rate };
                let polynomial = RatePolynomial::NONE;
                let still = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
                (still, 0.0, memory.now(at.stroke, at.rate), memory.stored(at.stroke, at.rate))
            }
        };
        let c = self.coefficient.at(at.inputs).value;
        let followed = self.coefficient.input.and_then(|input| told.input(input, count)).map(|[value, _]| value);
        add(sum.force, c, &derivatives);
        add(sum.derivative, 1.0, &derivatives);
        tangent.singular_part(memory, at.t, sum.derivative);
        self.coefficient.add_change(at.inputs, followed, &own, derivative, sum.force);
        let (mut stored, mut dissipation) = (vec![0.0; count], vec![0.0; count]);
        let mut change = EnergyTangent { stored: &mut stored, dissipation: &mut dissipation };
        tangent.energy(memory, &tangent_step, theta, &point, &changes, &mut change);
        if let Some((slopes, passed)) = moved {
            add(&mut stored, slopes.stored, passed);
        }
        add(sum.stored, c, &stored);
        self.coefficient.add_change(at.inputs, followed, &own, energy, sum.stored);
    }

    fn vary_singular(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        let (memory, tangent) = (&state.memories[0], &own.memories[0]);
        if !memory.is_singular() && !tangent.has_jumps() {
            return;
        }
        let mut moved = vec![0.0; forces.len()];
        tangent.singular_moments(memory, &Self::tangent_step(step), &mut moved);
        let moments = memory.singular_moments(&step.start(), step.nodes, step.places);
        for (i, (forces, moved)) in forces.chunks_exact_mut(own.count).zip(moved.chunks_exact(own.count)).enumerate() {
            let inputs = step.point(i + 1).inputs;
            add(forces, self.coefficient.at(inputs).value, moved);
            let followed = self.coefficient.input.and_then(|input| told.input_at(i + 1, input, inputs.len()));
            self.coefficient.add_change(inputs, followed.map(|[value, _]| value), &own, moments[i], forces);
        }
    }

    fn vary_singularity(
        &self,
        from: f64,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sums: [&mut [f64]; 3],
    ) {
        let (memory, tangent, count) = (&state.memories[0], &own.memories[0], own.count);
        if !memory.is_singular() && !tangent.has_jumps() {
            return;
        }
        let mut moved = [(); 3].map(|()| vec![0.0; count]);
        let [value, once, twice] = &mut moved;
        tangent.singular_motion(memory, [from, at.t], [value, once, twice]);
        let c = self.coefficient.at(at.inputs).value;
        let followed = self.coefficient.input.and_then(|input| told.input(input, count)).map(|[value, _]| value);
        let shares = memory.singular_motion(from, at.t);
        for ((sum, moved), share) in sums.into_iter().zip(&moved).zip(shares) {
            add(sum, c, moved);
            self.coefficient.add_change(at.inputs, followed, &own, share, sum);
        }
    }

    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.coefficient.at(at.inputs).value, order: self.alpha.value }
    }

    fn linearised_slope(&self, at: &Point<Dual>) -> Option<Term> {
        let coefficient = self.coefficient.at(at.inputs).value.slope;
        Some(Term { coefficient, order: self.alpha.slope })
    }

    fn at_rest(&self, at: &Point, held: f64) -> AtRest {
        let term = self.linearised(at);
        let Term { coefficient, order } = term;
        let tangent = Tangent::Leaf(term, None);
        if order > 0.0 {
            return AtRest { force: 0.0, stiffness: None, tangent };
        }
        let held = if self.derivative == Derivative::Caputo { held } else { 0.0 };
        AtRest { force: coefficient * (at.stroke - held), stiffness: Some(coefficient), tangent }
    }

    fn holds(&self) -> Holds {
        let Coefficient { constant, slope, .. } = self.coefficient;
        if constant.value == 0.0 && slope.value == 0.0 { Holds::Never } else { Holds::Always }
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn singular(&self, inputs: &[InputValue], state: StateRef) -> Option<Term> {
        let memory = &state.memories[0];
        let coefficient = || self.coefficient.at(inputs).value * memory.singular_part(1.0);
        memory.is_singular().then(|| Term { coefficient: coefficient(), order: self.alpha.value })
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.coefficient.check(inputs, "the coefficient of D^alpha x")
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "springpot",
        equation: "F = c·D^alpha x",
        params: vec![
            Param::new("c", "N*s^alpha/m", "coefficient of the fractional derivative", Range::NOT_NEGATIVE),
            alpha(),
        ],
        build: LeafBuild::Values(|values, derivative| {
            let coefficient = Coefficient::constant(values[0]);
            Ok(Arc::new(Springpot { coefficient, alpha: values[1], derivative }))
        }),
    }
}
