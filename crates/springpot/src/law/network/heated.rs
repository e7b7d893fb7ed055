//! A law under heat: asked by the clock of the wall, its own law answers in reduced time.
//!
//! Over a step the temperature is known at the start and at the nodes, as an input or as a state that is found together with the losses
//! ([`warming`]). From there ξ at the nodes follows ([`clock`]), and the law is asked a step of the size Δξ with nodes where these ξ lie, under
//! x_m = x − coefficient·(T − T_ref) and dx_m/dξ = a_T x_m'. Of its answer ∂F/∂x' is a_T ∂F/∂(dx/dξ) and P is P_ξ/a_T. How F follows T, and T
//! the stroke, is no part of the tangents: in a step T moves little.

mod clock;
mod warming;

use super::{Guard, LeafPart, Network, Onset, Reported, Take};
use crate::collocation::{MAX_NODES, Nodes, lagrange_row};
use crate::fractional::KernelError;
use crate::law::heat::Heat;
use crate::law::leaf::Unshifted;
use crate::law::past::Recalled;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use clock::Clock;
use std::sync::Arc;
use warming::Temperatures;

type Values = [f64; MAX_NODES + 1];

/// How much warmer than it was seen to be, or than where it starts, a temperature may get within the accuracy of the memories, K.
const WARMER: [f64; 2] = [25.0, 150.0];

/// Sharpness of the estimates, which are of the order 3, of the clock and of the temperature, which are of the order 5.
const SHARPNESS: f64 = 5.0 / 3.0;

/// A law and what temperature does to it ([`crate::law::Entry::with_heat`]).
#[derive(Debug, Clone)]
pub struct Heated {
    heat: Heat,
    law: Network,
    /// Number of inputs of the law.
    inputs: usize,
    /// Which of them is the temperature.
    takes: Option<usize>,
    /// Whether a_T is one more input of the law, for what does not shift.
    tells_factor: bool,
}

/// Temperature and heat of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Warmth {
    /// T, K.
    pub temperature: f64,
    /// Heat lost to the surroundings since t = 0, J.
    pub lost: f64,
}

/// What a heated law itself keeps.
#[derive(Debug, Clone, Copy)]
struct Own {
    /// ξ, s; t where nothing is shifted.
    xi: f64,
    temperature: f64,
    lost: f64,
    /// T', K/s.
    warming: f64,
}

/// A step as the law itself is asked it.
struct Inside {
    clock: Clock,
    t: f64,
    stroke: Values,
    rate: Values,
    inputs: Vec<InputValue>,
    resolution: f64,
}

impl Inside {
    fn step<'a>(&'a self, outer: &Step<'a>) -> Step<'a> {
        let count = outer.nodes.count() + 1;
        Step {
            t: self.t,
            h: self.clock.h,
            places: self.clock.places.as_ref(),
            stroke: &self.stroke[..count],
            rate: &self.rate[..count],
            inputs: &self.inputs,
            resolution: self.resolution,
            ..*outer
        }
    }
}

/// A point as the law itself sees it, with room for its inputs.
struct Place {
    t: f64,
    stroke: f64,
    rate: f64,
    factor: f64,
    inputs: Vec<InputValue>,
}

impl Place {
    fn point(&self) -> Point<'_> {
        Point { t: self.t, stroke: self.stroke, rate: self.rate, inputs: &self.inputs }
    }
}

impl Heated {
    /// `inputs` is the number of inputs of the law, `takes` which of them is the temperature.
    pub(super) fn new(law: Network, heat: Heat, inputs: usize, takes: Option<usize>) -> Self {
        let (law, tells_factor) = match heat.shift {
            Some(_) => unshifted(law, inputs),
            None => (law, false),
        };
        Self { heat, law, inputs, takes, tells_factor }
    }

    /// What temperature does to it.
    pub fn heat(&self) -> &Heat {
        &self.heat
    }

    /// The law itself, asked in reduced time.
    pub fn law(&self) -> &Network {
        &self.law
    }

    /// Inputs of the law itself, under those from outside and the temperature that they say, or that of the start.
    pub fn inputs_of_law(&self, inputs: &[InputValue]) -> Vec<InputValue> {
        let (temperature, mut own) = (self.seen(inputs), Vec::new());
        self.hand_on(inputs, temperature, self.heat.factor(temperature.value), &mut own);
        own
    }

    /// Number of inputs of the law itself.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Which input from outside is the temperature; `None` where it is a state.
    pub fn input(&self) -> Option<usize> {
        self.heat.thermal.is_none().then_some(self.takes.unwrap_or(self.inputs))
    }

    /// By how much ξ runs faster than t, at most, where the temperature was seen to reach `hottest`.
    pub(crate) fn fastest(&self, hottest: Option<f64>) -> f64 {
        let Some(shift) = self.heat.shift else { return 1.0 };
        let [of_input, of_state] = WARMER;
        let hottest = match self.heat.thermal {
            Some(thermal) => thermal.start.max(thermal.ambient) + of_state,
            None => hottest.unwrap_or(f64::NEG_INFINITY) + of_input,
        };
        let fastest = shift.factor(hottest).recip();
        if fastest.is_finite() { fastest.max(f64::MIN_POSITIVE) } else { 1.0 }
    }

    /// By how much ξ runs faster than t under these inputs, of a temperature that is a state where it starts.
    pub(crate) fn pace(&self, inputs: &[InputValue]) -> f64 {
        let pace = self.heat.factor(self.seen(inputs).value).recip();
        if pace.is_finite() && pace > 0.0 { pace } else { 1.0 }
    }

    /// The same at the end of a step.
    pub(crate) fn pace_at(&self, step: &Step, state: StateRef) -> f64 {
        if self.heat.thermal.is_none() {
            return self.pace(step.point(step.nodes.count()).inputs);
        }
        self.warmth(Some((step, 1.0)), state).map_or(1.0, |warmth| self.heat.factor(warmth.temperature).recip())
    }

    fn own_size(&self) -> StateSize {
        let (clock, thermal) = (self.heat.shift.is_some(), self.heat.thermal.is_some());
        StateSize { memories: 0, variables: usize::from(clock) + if thermal { 3 } else { 0 } }
    }

    pub(super) fn size(&self) -> StateSize {
        let (own, law) = (self.own_size(), self.law.size());
        StateSize { memories: law.memories, variables: own.variables + law.variables }
    }

    /// Splits off what it keeps itself; `t` stands for ξ where nothing is shifted.
    fn own(&self, variables: &[f64], t: f64) -> Own {
        let (xi, rest) = match (self.heat.shift, variables) {
            (Some(_), [xi, rest @ ..]) => (*xi, rest),
            _ => (t, variables),
        };
        let [temperature, lost, warming] = *rest.first_chunk().unwrap_or(&[f64::NAN, 0.0, 0.0]);
        Own { xi, temperature, lost, warming }
    }

    /// The temperature from outside; that at the start where it is a state.
    fn seen(&self, inputs: &[InputValue]) -> InputValue {
        match (self.heat.thermal, self.input()) {
            (Some(thermal), _) => InputValue { value: thermal.start, rate: 0.0 },
            (None, at) => at.and_then(|at| inputs.get(at)).copied().unwrap_or_default(),
        }
    }

    /// The temperature between two steps.
    fn temperature(&self, own: &Own, inputs: &[InputValue]) -> InputValue {
        match self.heat.thermal {
            Some(_) => InputValue { value: own.temperature, rate: own.warming },
            None => self.seen(inputs),
        }
    }

    /// Appends the inputs of the law, with their rates by ξ.
    fn hand_on(&self, outer: &[InputValue], temperature: InputValue, factor: f64, inputs: &mut Vec<InputValue>) {
        let mut rest = outer.iter();
        for i in 0..self.inputs {
            let told = match (self.takes == Some(i), self.heat.thermal) {
                (true, Some(_)) => temperature,
                _ => rest.next().copied().unwrap_or_default(),
            };
            inputs.push(InputValue { rate: factor * told.rate, ..told });
        }
        if self.tells_factor {
            let slope = self.heat.shift.map_or(0.0, |shift| shift.slope(temperature.value));
            inputs.push(InputValue { value: factor, rate: factor * factor * slope * temperature.rate });
        }
    }

    /// What the law sees of `at` at this temperature.
    fn place(&self, at: &Point, xi: f64, temperature: InputValue) -> Place {
        let (factor, mut inputs) = (self.heat.factor(temperature.value), Vec::new());
        self.hand_on(at.inputs, temperature, factor, &mut inputs);
        Place {
            t: xi,
            stroke: at.stroke + self.heat.stroke(temperature.value),
            rate: factor * (at.rate + self.heat.stroke_by_temperature() * temperature.rate),
            factor,
            inputs,
        }
    }

    /// What the law sees of `at` where nothing is known but the inputs.
    fn still(&self, at: &Point) -> Place {
        self.place(at, at.t, self.seen(at.inputs))
    }

    /// The step as the law itself is asked it under these temperatures.
    fn inside(&self, step: &Step, own: &Own, course: &Temperatures) -> Inside {
        let count = step.nodes.count() + 1;
        let clock = Clock::new(&self.heat, step, &course.temperature);
        let (mut stroke, mut rate, mut inputs) = (Values::default(), Values::default(), Vec::new());
        for k in 0..count {
            let temperature = course.at(k);
            stroke[k] = step.stroke[k] + self.heat.stroke(temperature.value);
            let told = step.rate.get(k).copied().unwrap_or(0.0);
            rate[k] = clock.factor[k] * (told + self.heat.stroke_by_temperature() * temperature.rate);
            self.hand_on(step.point(k).inputs, temperature, clock.factor[k], &mut inputs);
        }
        // Strokes are known no better than what heat adds to them.
        let stretch = self.heat.stroke_by_temperature().abs() * course.temperature[0];
        let resolution = step.resolution + 8.0 * f64::EPSILON * stretch;
        Inside { clock, t: own.xi, stroke, rate, inputs, resolution }
    }

    /// The temperatures of the step and the step under them; `None` where no temperature goes with the losses. Leaves the state at the law's share.
    fn look(&self, step: &Step, state: &mut StateRef) -> Option<(Own, Temperatures, Inside)> {
        let own = self.own(state.take(self.own_size()).variables, step.t);
        let course = self.course(step, &own, *state)?;
        let inside = self.inside(step, &own, &course);
        Some((own, course, inside))
    }

    pub(super) fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        self.begin_own(state);
        let mut inputs = Vec::new();
        self.law.begin_part(&self.start(start, &mut inputs), state)
    }

    fn begin_own(&self, state: &mut State) {
        if self.heat.shift.is_some() {
            state.push_variable(0.0);
        }
        if let Some(thermal) = self.heat.thermal {
            let cooling = thermal.conductance * (thermal.start - thermal.ambient);
            for value in [thermal.start, 0.0, -cooling / thermal.capacity] {
                state.push_variable(value);
            }
        }
    }

    /// A start as the law itself sees it.
    fn start<'i>(&self, start: &Start<'i>, inputs: &'i mut Vec<InputValue>) -> Start<'i> {
        let temperature = self.seen(start.inputs);
        self.hand_on(start.inputs, temperature, self.heat.factor(temperature.value), inputs);
        let longer = self.heat.stroke(temperature.value);
        let stroke = start.stroke + longer;
        let tiny = 8.0 * f64::EPSILON * (start.stroke.abs() + longer.abs());
        let jump = match longer {
            0.0 => start.jump,
            // Strokes alone do not tell whether it was held: memories do.
            _ if start.jump == 0.0 && self.law.size().memories == 0 => 0.0,
            _ if stroke.abs() <= tiny => 0.0,
            _ => stroke,
        };
        Start { stroke, jump, inputs }
    }

    /// The state at t = 0 after a past that was spent at the temperature of the start: `recall` is told the law, its start, a_T and by how
    /// much heat makes its strokes longer.
    pub(in crate::law) fn recalled(
        &self,
        start: &Start,
        recall: impl FnOnce(&Network, &Start, f64, f64) -> Result<State, KernelError>,
    ) -> Result<State, KernelError> {
        let mut state = State::default();
        self.begin_own(&mut state);
        let temperature = self.seen(start.inputs).value;
        let (mut inputs, factor) = (Vec::new(), self.heat.factor(temperature));
        let start = self.start(start, &mut inputs);
        state.append(recall(&self.law, &start, factor, self.heat.stroke(temperature))?);
        Ok(state)
    }

    pub(super) fn prepare(&self, step: &Step, state: &mut StateMut) {
        let own = self.own(state.take(self.own_size()).variables, step.t);
        // A state is another one whenever it is asked for: what it shifts, or stretches, has nothing to make ready.
        let is_settled = self.heat.thermal.is_none() || (self.heat.shift.is_none() && self.heat.expansion.is_none());
        match self.told(step, &own).filter(|_| is_settled) {
            Some(course) => self.law.prepare_part(&self.inside(step, &own, &course).step(step), state),
            None => state.skip(self.law.size(), self.law.series_count()),
        }
    }

    pub(super) fn evaluate(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        let Some((_, _, inside)) = self.look(step, state) else {
            self.law.pass(state);
            response.force = [f64::NAN; MAX_NODES];
            return;
        };
        let mut own = Response::default();
        self.law.evaluate_part(&inside.step(step), state, &mut own);
        for i in 0..step.nodes.count() {
            response.force[i] += own.force[i];
            response.singular[i] += own.singular[i];
            for j in 0..step.nodes.count() {
                response.d_stroke[i][j] += own.d_stroke[i][j];
                response.d_rate[i][j] += inside.clock.factor[j + 1] * own.d_rate[i][j];
            }
        }
    }

    /// Of the temperature what sources and the expansion make of it; what it does to the clock is left out.
    pub(super) fn by_input(
        &self,
        step: &Step,
        state: &mut StateRef,
        input: usize,
        slopes: &mut [[f64; MAX_NODES]; MAX_NODES],
    ) {
        let Some((_, _, inside)) = self.look(step, state) else { return self.law.pass(state) };
        let inner = match (self.input() == Some(input), self.takes) {
            (true, takes) => takes,
            (false, Some(own)) if self.heat.thermal.is_some() && input >= own => Some(input + 1),
            (false, _) => Some(input),
        };
        let mut behind = *state;
        match inner {
            Some(inner) => self.law.by_input_part(&inside.step(step), state, inner, slopes),
            None => self.law.pass(state),
        }
        if self.input() == Some(input) && self.heat.expansion.is_some() {
            let (mut own, stretch) = (Response::default(), self.heat.stroke_by_temperature());
            self.law.evaluate_part(&inside.step(step), &mut behind, &mut own);
            for (row, own) in slopes.iter_mut().zip(own.d_stroke) {
                row.iter_mut().zip(own).for_each(|(slope, by_stroke)| *slope += stretch * by_stroke);
            }
        }
    }

    pub(super) fn commit(&self, step: &Step, state: &mut StateMut) {
        let size = self.own_size();
        let looked = self.look(step, &mut state.view());
        let variables = state.take(size).variables;
        let Some((own, course, inside)) = looked else {
            variables.fill(f64::NAN);
            return state.skip(self.law.size(), self.law.series_count());
        };
        self.law.commit_part(&inside.step(step), state);
        let (first, rest) = variables.split_at_mut(usize::from(self.heat.shift.is_some()));
        first.fill(own.xi + inside.clock.h);
        if let Some(thermal) = &self.heat.thermal {
            let end = self.end(thermal, step, &own, &course);
            rest.copy_from_slice(&end);
        }
    }

    pub(super) fn local_errors(&self, step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
        let order = |error, value| LocalError { error, value, order: 0.0, sharpness: SHARPNESS };
        let Some((own, course, inside)) = self.look(step, state) else {
            errors.extend([order(f64::NAN, 1.0); 2].into_iter().take(self.own_errors()));
            return self.law.pass(state);
        };
        let known = ..=step.nodes.count();
        if self.heat.shift.is_some() {
            let (pace, mean) = (inside.clock.factor.map(f64::recip), inside.clock.h / step.h);
            errors.push(order(step.quadrature_defect(&pace[known]) / mean, 1.0));
        }
        if self.heat.thermal.is_some() {
            // The temperature counts by what it does to the clock.
            let scale = self.heat.shift.map_or(1.0, |shift| shift.slope(own.temperature).abs().max(1.0).recip());
            errors.push(order(step.h * step.quadrature_defect(&course.warming[known]), scale));
        }
        self.law.local_errors_part(&inside.step(step), state, errors);
    }

    /// How many of the local errors, the first of them, are those of the clock and of the temperature.
    fn own_errors(&self) -> usize {
        usize::from(self.heat.shift.is_some()) + usize::from(self.heat.thermal.is_some())
    }

    /// How many of the local errors, the first of them, no motion shows.
    pub(super) fn hidden_errors(&self) -> usize {
        if self.law.has_inner_variables() { usize::MAX } else { self.own_errors() }
    }

    pub(super) fn powers(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        let share = *state;
        let Some((_, course, inside)) = self.look(step, state) else {
            powers.fill(Power { dissipation: f64::NAN, input: f64::NAN });
            return self.law.pass(state);
        };
        let mut behind = *state;
        let own = self.powers_of(step, &inside, state);
        for (power, own) in powers.iter_mut().zip(own) {
            power.dissipation += own.dissipation;
            power.input += own.input;
        }
        if self.heat.expansion.is_none() {
            return;
        }
        // F·x' = F·x_m' + F·coefficient·T': what the heat does to the stroke is supplied by it.
        let mut response = Response::default();
        self.law.evaluate_part(&inside.step(step), &mut behind, &mut response);
        let start = self.now(&step.point(0), &mut share.clone(), &mut |_| ()).observation.regular;
        let by_temperature = self.heat.stroke_by_temperature();
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            // Of a singular start the energies are not known; its share of the force would only make steps short.
            let force = if k == 0 { start } else { response.force[k - 1] - response.singular[k - 1] };
            power.input += force * by_temperature * course.warming[k];
        }
    }

    /// Powers by the clock of the wall; leaves the state behind the law's share.
    fn powers_of(&self, step: &Step, inside: &Inside, state: &mut StateRef) -> Powers {
        let mut powers = Powers::default();
        self.law.powers_part(&inside.step(step), state, &mut powers);
        for (power, factor) in powers.iter_mut().zip(inside.clock.factor).take(step.nodes.count() + 1) {
            power.dissipation /= factor;
            power.input /= factor;
        }
        powers
    }

    pub(super) fn guards(&self, step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
        match self.look(step, state) {
            Some((_, _, inside)) => self.law.guards_part(&inside.step(step), state, guards),
            None => self.law.pass(state),
        }
    }

    pub(super) fn at(&self, step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        let Some((own, course, inside)) = self.look(step, state) else {
            self.law.pass(state);
            return Reported::unknown();
        };
        let temperature = match self.heat.thermal {
            None => self.seen(at.inputs),
            Some(_) => self.within(step, theta, &own, &course),
        };
        let share = inside.clock.share(theta);
        let place = self.place(at, own.xi + share * inside.clock.h, temperature);
        let factor = place.factor;
        let mut tell = |leaf| take(by_the_wall(leaf, factor));
        self.law.at_part(&inside.step(step), share, &place.point(), state, &mut tell)
    }

    pub(super) fn now(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        let own = self.own(state.take(self.own_size()).variables, at.t);
        let place = self.place(at, own.xi, self.temperature(&own, at.inputs));
        let factor = place.factor;
        self.law.now_part(&place.point(), state, &mut |leaf| take(by_the_wall(leaf, factor)))
    }

    /// Temperature and heat at θ of a step, or between two steps.
    pub(super) fn warmth(&self, within: Option<(&Step, f64)>, mut state: StateRef) -> Option<Warmth> {
        let thermal = self.heat.thermal.as_ref()?;
        let Some((step, theta)) = within else {
            let own = self.own(state.take(self.own_size()).variables, 0.0);
            return Some(Warmth { temperature: own.temperature, lost: own.lost });
        };
        let Some((own, course, _)) = self.look(step, &mut state) else {
            return Some(Warmth { temperature: f64::NAN, lost: f64::NAN });
        };
        let temperature = self.within(step, theta, &own, &course).value;
        let flows: f64 =
            step.quadrature(theta).iter().zip(course.flows(thermal)).map(|(weight, flow)| weight * flow).sum();
        Some(Warmth { temperature, lost: own.lost + step.h * flows })
    }

    /// The temperature, a state, at θ of a step.
    fn within(&self, step: &Step, theta: f64, own: &Own, course: &Temperatures) -> InputValue {
        let moved: f64 = step.quadrature(theta).iter().zip(course.warming).map(|(weight, rate)| weight * rate).sum();
        let value = own.temperature + step.h * moved;
        let rate = match step.nodes {
            Nodes::Radau => {
                let at = |k: usize| lagrange_row(k).iter().rev().fold(0.0, |sum, c| sum * theta + c);
                course.warming.iter().enumerate().take(4).map(|(k, rate)| at(k) * rate).sum()
            }
            _ => course.warming[step.nodes.count()],
        };
        InputValue { value, rate }
    }

    pub(super) fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        let place = self.still(at);
        self.law.stiffness(&place.point(), omega * place.factor)
    }

    pub(super) fn estimate(&self, at: &Point, state: &mut StateRef, omega: f64) -> f64 {
        let own = self.own(state.take(self.own_size()).variables, at.t);
        let place = self.place(at, own.xi, self.temperature(&own, at.inputs));
        self.law.estimate_part(&place.point(), state, omega * place.factor)
    }

    pub(super) fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        let place = self.still(at);
        self.law.for_each_springpot(&place.point(), &mut |term| take(term.shifted(place.factor)));
    }

    pub(super) fn singularities(&self, inputs: &[InputValue], state: &mut StateRef, take: &mut dyn FnMut(Term)) {
        let own = self.own(state.take(self.own_size()).variables, 0.0);
        let at = Point { t: own.xi, stroke: 0.0, rate: 0.0, inputs };
        let place = self.place(&at, own.xi, self.temperature(&own, inputs));
        self.law.singularities(&place.inputs, state, &mut |term| take(term.shifted(place.factor)));
    }

    pub(super) fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        let temperature = self.seen(inputs);
        if let Some(shift) = self.heat.shift.filter(|_| self.heat.thermal.is_none()) {
            let needs = |broken: RuleError| RuleError { rule: format!("its shift needs {}", broken.rule), ..broken };
            shift.check(temperature.value).map_err(needs)?;
        }
        let mut own = Vec::new();
        self.hand_on(inputs, temperature, 1.0, &mut own);
        self.law.check_inputs(&own)
    }

    pub(super) fn report(&self, at: &Point) -> (u8, f64) {
        self.law.report(&self.still(at).point())
    }

    pub(super) fn has_guards(&self, at: &Point) -> bool {
        self.law.has_guards(&self.still(at).point())
    }

    pub(super) fn modulus(&self, at: &Point, s: num_complex::Complex64) -> num_complex::Complex64 {
        let place = self.still(at);
        self.law.modulus(&place.point(), s * place.factor)
    }

    pub(super) fn asymptote(&self, at: &Point, onset: Onset) -> Term {
        let place = self.still(at);
        self.law.asymptote(&place.point(), onset).shifted(place.factor)
    }

    pub(super) fn recall(&self, stroke: &Recalled, at: &Point, state: &mut StateMut) {
        state.take(self.own_size());
        let place = self.still(at);
        let temperature = self.seen(at.inputs).value;
        let stroke = stroke.reduced(place.factor, self.heat.stroke(temperature));
        self.law.recall_part(&stroke, &place.point(), state);
    }

    /// At rest at the temperature of the inputs, or of the start.
    pub(in crate::law) fn at_rest(&self, at: &Point, held: f64) -> Option<AtRest> {
        let place = self.still(at);
        let rest = self.law.at_rest(&place.point(), held + (place.stroke - at.stroke))?;
        let outside = |input: usize| match (self.heat.thermal, self.takes) {
            _ if input >= self.inputs => None,
            (Some(_), Some(own)) if input == own => None,
            (Some(_), Some(own)) if input > own => Some(input - 1),
            _ => Some(input),
        };
        let tangent = rest.tangent.shifted(place.factor, &outside);
        Some(AtRest { tangent, ..rest })
    }

    /// What a stretch by a kelvin at the rate `omega`, rad/s, stores, J.
    pub(crate) fn stretching(&self, at: &Point, omega: f64) -> f64 {
        match self.heat.expansion {
            Some(_) => 0.5 * self.stiffness(at, omega) * self.heat.stroke_by_temperature().powi(2),
            None => 0.0,
        }
    }

    /// The input that stretches the law, and by how much per unit of it, m/K.
    pub(crate) fn stretch(&self) -> Option<(usize, f64)> {
        self.heat.expansion.and(self.input()).map(|input| (input, self.heat.stroke_by_temperature()))
    }
}

/// A leaf whose rate is told in reduced time.
fn by_the_wall(leaf: crate::law::step::LeafState, factor: f64) -> crate::law::step::LeafState {
    crate::law::step::LeafState { rate: leaf.rate / factor, ..leaf }
}

/// The law in which leaves that do not shift are told a_T as the input `factor`, and whether there are any.
fn unshifted(law: Network, factor: usize) -> (Network, bool) {
    let all = |parts: Vec<Network>| {
        let parts: Vec<(Network, bool)> = parts.into_iter().map(|part| unshifted(part, factor)).collect();
        let any = parts.iter().any(|(_, any)| *any);
        (parts.into_iter().map(|(part, _)| part).collect(), any)
    };
    match law {
        Network::Leaf(part) if part.leaf.keeps_the_wall_clock() => {
            let name = part.name.clone();
            (Network::Leaf(LeafPart { name, leaf: Arc::new(Unshifted { leaf: part, factor }) }), true)
        }
        Network::Parallel(parts) => {
            let (parts, any) = all(parts);
            (Network::Parallel(parts), any)
        }
        Network::Series(parts) => {
            let (parts, any) = all(parts);
            (Network::Series(parts), any)
        }
        other => (other, false),
    }
}

impl Term {
    /// c·D^order in ξ as it is in t, where times are longer by a_T = `factor`.
    fn shifted(self, factor: f64) -> Self {
        Self { coefficient: self.coefficient * factor.powf(self.order), ..self }
    }
}

impl Tangent {
    /// The same with times longer by a_T = `factor`, its inputs under the numbers that `outside` gives them.
    fn shifted(self, factor: f64, outside: &dyn Fn(usize) -> Option<usize>) -> Self {
        let all = |parts: Vec<Self>| parts.into_iter().map(|part| part.shifted(factor, outside)).collect();
        match self {
            Self::Leaf(term, input) => {
                let input = input.and_then(|(input, gain)| Some((outside(input)?, gain)));
                Self::Leaf(term.shifted(factor), input)
            }
            Self::Whole(tangent) => Self::Whole(Box::new(tangent.shifted(factor, outside))),
            Self::Parallel(parts) => Self::Parallel(all(parts)),
            Self::Series(parts) => Self::Series(all(parts)),
        }
    }
}
