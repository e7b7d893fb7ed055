//! What a law under heat answers.

use super::{Heated, SHARPNESS, by_the_wall};
use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::fractional::KernelError;
use crate::law::harmonic::Sine;
use crate::law::leaf::Guard;
use crate::law::network::Network;
use crate::law::network::part::{Onset, Part, Reported, Seen, Take};
use crate::law::past::Recalled;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::AtRest;
use num_complex::Complex64;

/// Its own law is asked in reduced time.
impl Part for Heated {
    fn parts(&self) -> &[Network] {
        std::slice::from_ref(&self.law)
    }

    fn own_size(&self) -> StateSize {
        let (clock, thermal) = (self.heat.shift.is_some(), self.heat.thermal.is_some());
        StateSize { memories: 0, variables: usize::from(clock) + if thermal { 3 } else { 0 } }
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        self.begin_own(state);
        let mut inputs = Vec::new();
        self.law.ask().begin(&self.start(start, &mut inputs), state)
    }

    fn prepare(&self, step: &Step, state: &mut StateMut) {
        let own = self.own(state.take(self.own_size()).variables, step.t);
        // A state is another one whenever it is asked for: what it shifts, or stretches, has nothing to make ready.
        let is_settled = self.heat.thermal.is_none() || (self.heat.shift.is_none() && self.heat.expansion.is_none());
        match self.told(step, &own).filter(|_| is_settled) {
            Some(course) => self.law.ask().prepare(&self.inside(step, &own, &course).step(step), state),
            None => self.law.ask().pass_mut(state),
        }
    }

    fn evaluate(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        self.respond(step, state, response, |law, step, state, own| law.ask().evaluate(step, state, own));
    }

    /// Of the temperature what sources and the expansion make of it; what it does to the clock is left out.
    fn by_input(&self, step: &Step, state: &mut StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        let Some((_, _, inside)) = self.look(step, state) else { return self.law.ask().pass(state) };
        let inner = match (self.input() == Some(input), self.takes) {
            (true, takes) => takes,
            (false, Some(own)) if self.heat.thermal.is_some() && input >= own => Some(input + 1),
            (false, _) => Some(input),
        };
        let mut behind = *state;
        match inner {
            Some(inner) => self.law.ask().by_input(&inside.step(step), state, inner, slopes),
            None => self.law.ask().pass(state),
        }
        if self.input() == Some(input) && self.heat.expansion.is_some() {
            let (mut own, stretch) = (Response::default(), self.heat.stroke_by_temperature());
            self.law.ask().evaluate(&inside.step(step), &mut behind, &mut own);
            for (row, own) in slopes.iter_mut().zip(own.d_stroke) {
                row.iter_mut().zip(own).for_each(|(slope, by_stroke)| *slope += stretch * by_stroke);
            }
        }
    }

    fn commit(&self, step: &Step, state: &mut StateMut) {
        let size = self.own_size();
        let looked = self.look(step, &mut state.view());
        let variables = state.take(size).variables;
        let Some((own, course, inside)) = looked else {
            variables.fill(f64::NAN);
            return self.law.ask().pass_mut(state);
        };
        self.law.ask().commit(&inside.step(step), state);
        let (first, rest) = variables.split_at_mut(usize::from(self.heat.shift.is_some()));
        first.fill(own.xi + inside.clock.h);
        if let Some(thermal) = &self.heat.thermal {
            let end = self.end(thermal, step, &own, &course);
            rest.copy_from_slice(&end);
        }
    }

    fn local_errors(&self, step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
        let order = |error, value| LocalError { sharpness: SHARPNESS, ..LocalError::collocated(error, value) };
        let Some((own, course, inside)) = self.look(step, state) else {
            errors.extend([order(f64::NAN, 1.0); 2].into_iter().take(self.own_errors()));
            return self.law.ask().pass(state);
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
        self.law.ask().local_errors(&inside.step(step), state, errors);
    }

    /// How many of the local errors, the first of them, no motion shows.
    fn hidden_errors(&self) -> usize {
        if self.law.has_inner_variables() { usize::MAX } else { self.own_errors() }
    }

    fn powers(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        let share = *state;
        let Some((_, course, inside)) = self.look(step, state) else {
            powers.fill(Power { dissipation: f64::NAN, input: f64::NAN });
            return self.law.ask().pass(state);
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
        self.law.ask().evaluate(&inside.step(step), &mut behind, &mut response);
        let start = self.now(&step.point(0), &mut share.clone(), &mut |_| ()).observation.regular;
        let by_temperature = self.heat.stroke_by_temperature();
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            // Of a singular start the energies are not known; its share of the force would only make steps short.
            let force = if k == 0 { start } else { response.force[k - 1] - response.singular[k - 1] };
            power.input += force * by_temperature * course.warming[k];
        }
    }

    fn guards(&self, step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
        match self.look(step, state) {
            Some((_, _, inside)) => self.law.ask().guards(&inside.step(step), state, guards),
            None => self.law.ask().pass(state),
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        let Some((own, course, inside)) = self.look(step, state) else {
            self.law.ask().pass(state);
            return Reported::unknown();
        };
        let temperature = match self.heat.thermal {
            None => self.seen(at.inputs),
            Some(_) => self.within(step, theta, &own, &course),
        };
        let share = inside.clock.share(theta);
        let place = self.place(at, own.xi + share * inside.clock.h, temperature);
        let factor = place.factor;
        let mut tell = |leaf: Seen| take(by_the_wall(leaf, factor));
        self.law.ask().at(&inside.step(step), share, &place.point(), state, &mut tell)
    }

    fn now(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        let own = self.own(state.take(self.own_size()).variables, at.t);
        let place = self.place(at, own.xi, self.temperature(&own, at.inputs));
        let factor = place.factor;
        self.law.ask().now(&place.point(), state, &mut |leaf: Seen| take(by_the_wall(leaf, factor)))
    }

    fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        let place = self.still(at);
        self.law.stiffness(&place.point(), omega * place.factor)
    }

    fn estimate(&self, at: &Point, state: &mut StateRef, omega: f64) -> f64 {
        let own = self.own(state.take(self.own_size()).variables, at.t);
        let place = self.place(at, own.xi, self.temperature(&own, at.inputs));
        self.law.ask().estimate(&place.point(), state, omega * place.factor)
    }

    fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        let place = self.still(at);
        self.law.for_each_springpot(&place.point(), &mut |term| take(term.shifted(place.factor)));
    }

    fn singularities(&self, inputs: &[InputValue], state: &mut StateRef, take: &mut dyn FnMut(Term)) {
        let own = self.own(state.take(self.own_size()).variables, 0.0);
        let at = Point { t: own.xi, stroke: 0.0, rate: 0.0, inputs };
        let place = self.place(&at, own.xi, self.temperature(&own, inputs));
        self.law.ask().singularities(&place.inputs, state, &mut |term| take(term.shifted(place.factor)));
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        let temperature = self.seen(inputs);
        if let Some(shift) = self.heat.shift.filter(|_| self.heat.thermal.is_none()) {
            let needs = |broken: RuleError| RuleError { rule: format!("its shift needs {}", broken.rule), ..broken };
            shift.check(temperature.value).map_err(needs)?;
        }
        let mut own = Vec::new();
        self.hand_on(inputs, temperature, 1.0, &mut own);
        self.law.check_inputs(&own)
    }

    fn report(&self, at: &Point) -> (u8, f64) {
        self.law.ask().report(&self.still(at).point())
    }

    fn has_guards(&self, at: &Point) -> bool {
        self.law.has_guards(&self.still(at).point())
    }

    fn modulus_slope(&self, at: &Point<Dual>, s: [Complex64; 2]) -> Option<[Complex64; 2]> {
        let inputs = at.values_of_inputs();
        let place = self.still(&at.without_derivatives(&inputs));
        self.law.modulus_slope(&place.point(), s.map(|s| s * place.factor))
    }

    /// At the temperature of the inputs, or of the start.
    fn harmonic(&self, sine: &Sine) -> Option<Complex64> {
        let place = self.still(&sine.at);
        self.law.ask().harmonic(&Sine { at: place.point(), omega: sine.omega * place.factor, ..*sine })
    }

    fn asymptote(&self, at: &Point, onset: Onset) -> Term {
        let place = self.still(at);
        self.law.ask().asymptote(&place.point(), onset).shifted(place.factor)
    }

    fn recall(&self, stroke: &Recalled, at: &Point, state: &mut StateMut) {
        state.take(self.own_size());
        let place = self.still(at);
        let temperature = self.seen(at.inputs).value;
        let stroke = stroke.reduced(place.factor, self.heat.stroke(temperature));
        self.law.ask().recall(&stroke, &place.point(), state);
    }

    /// At rest at the temperature of the inputs, or of the start.
    fn at_rest(&self, at: &Point, held: f64) -> Option<AtRest> {
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

    fn jolts(&self, _: &Point) -> bool {
        false
    }
}
