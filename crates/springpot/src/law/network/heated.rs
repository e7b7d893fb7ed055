//! A law under heat: asked by the clock of the wall, its own law answers in reduced time.
//!
//! Over a step the temperature is known at the start and at the nodes, as an input or as a state that is found together with the losses
//! ([`warming`]). From there ξ at the nodes follows ([`clock`]), and the law is asked a step of the size Δξ with nodes where these ξ lie, under
//! x_m = x − coefficient·(T − T_ref) and dx_m/dξ = a_T x_m'. Of its answer ∂F/∂x' is a_T ∂F/∂(dx/dξ) and P is P_ξ/a_T. How F follows T, and T
//! the stroke, is no part of the tangents: in a step T moves little.

mod answers;
mod clock;
mod unshifted;
mod vary;
mod warming;

use super::part::{Part, Seen};
use super::{LeafPart, Network, Series};
use crate::collocation::{MAX_NODES, Nodes, lagrange_row};
use crate::fractional::KernelError;
use crate::law::heat::Heat;
use crate::law::leaf;
use crate::law::state::{State, StateRef};
use crate::law::step::{InputValue, Point, Powers, Response, Start, Step};
use clock::Clock;
use std::sync::Arc;
use unshifted::Unshifted;
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
    /// What a parameter changes of the numbers of the heat, where it was built of such.
    moved: Heat,
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
        Self { heat, moved: heat.still(), law, inputs, takes, tells_factor }
    }

    /// The same, whose numbers a parameter moves by those of `moved`.
    pub(super) fn moving(self, moved: Heat) -> Self {
        Self { moved, ..self }
    }

    /// Whether derivatives of it are known where parameters move its clock.
    ///
    /// # Errors
    /// What there are none of.
    pub(in crate::law) fn by_a_clock_that_moves(&self, state: &State) -> Result<(), String> {
        let mut unknown = state.is_singular().then(|| "a singular start by a clock that a parameter moves".to_owned());
        self.law.ask().for_each_leaf(&mut |part| {
            if part.size().variables > 0 && part.slips().is_none() {
                unknown = Some(format!("{} by a clock that a parameter moves", part.name()));
            }
        });
        unknown.map_or(Ok(()), Err)
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
            _ if start.jump == 0.0 && self.law.ask().size().memories == 0 => 0.0,
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

    /// Forces and tangents of the law as it is asked by its own clock.
    fn respond(
        &self,
        step: &Step,
        state: &mut StateRef,
        response: &mut Response,
        evaluate: impl FnOnce(&Network, &Step, &mut StateRef, &mut Response),
    ) {
        let Some((_, _, inside)) = self.look(step, state) else {
            self.law.ask().pass(state);
            response.force = [f64::NAN; MAX_NODES];
            return;
        };
        let mut own = Response::default();
        evaluate(&self.law, &inside.step(step), state, &mut own);
        for i in 0..step.nodes.count() {
            response.force[i] += own.force[i];
            response.singular[i] += own.singular[i];
            for j in 0..step.nodes.count() {
                response.d_stroke[i][j] += own.d_stroke[i][j];
                response.d_rate[i][j] += inside.clock.factor[j + 1] * own.d_rate[i][j];
            }
        }
    }

    /// How many of the local errors, the first of them, are those of the clock and of the temperature.
    fn own_errors(&self) -> usize {
        usize::from(self.heat.shift.is_some()) + usize::from(self.heat.thermal.is_some())
    }

    /// Powers by the clock of the wall; leaves the state behind the law's share.
    fn powers_of(&self, step: &Step, inside: &Inside, state: &mut StateRef) -> Powers {
        let mut powers = Powers::default();
        self.law.ask().powers(&inside.step(step), state, &mut powers);
        for (power, factor) in powers.iter_mut().zip(inside.clock.factor).take(step.nodes.count() + 1) {
            power.dissipation /= factor;
            power.input /= factor;
        }
        powers
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
fn by_the_wall(leaf: Seen, factor: f64) -> Seen {
    Seen { factor, ..leaf }
}

/// The law in which leaves that do not shift are told a_T as the input `factor`, and whether there are any.
fn unshifted(law: Network, factor: usize) -> (Network, bool) {
    let all = |parts: Vec<Network>| {
        let parts: Vec<(Network, bool)> = parts.into_iter().map(|part| unshifted(part, factor)).collect();
        let any = parts.iter().any(|(_, any)| *any);
        (parts.into_iter().map(|(part, _)| part).collect(), any)
    };
    match law {
        Network::Leaf(part) if part.leaf.clock() == leaf::Clock::Wall => {
            let name = part.name.clone();
            (Network::Leaf(LeafPart { name, leaf: Arc::new(Unshifted { leaf: part, factor }) }), true)
        }
        Network::Parallel(parts) => {
            let (parts, any) = all(parts);
            (Network::Parallel(parts), any)
        }
        Network::Series(series) => {
            let (parts, any) = all(series.into_parts());
            (Network::Series(Series::new(parts)), any)
        }
        other => (other, false),
    }
}
