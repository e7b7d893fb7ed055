//! What parameters change of a law under heat.
//!
//! They may move the temperature, and what it does: a_T, and with it the clock and its nodes; the stroke of heat. Its own law is told what changes
//! of strokes, rates and inputs at its nodes, and of the time that has passed until them. A temperature that is a state changes as its losses do:
//!
//! δT_i + (hG/C) Σ_j A_ij δT_j = δT_0 + h Σ_j A_ij [δP_j − δG (T_j − T_a) + G δT_a − δC T'_j]/C,
//!
//! found by the iteration of the run.

use super::warming::{Temperatures, implicit};
use super::{Heated, Inside, Own, Values};
use crate::collocation::{Nodes, RADAU_NODES, STAGES, lagrange_row};
use crate::dual::{Dual, Real};
use crate::law::heat::{GAS, Shift};
use crate::law::leaf::When;
use crate::law::network::Network;
use crate::law::network::part::Part;
use crate::law::network::vary::Vary;
use crate::law::past::{Begun, ByHeat};
use crate::law::state::{State, StateRef};
use crate::law::step::{InputValue, Point, Response, Step};
use crate::law::variation::{
    LawVariation, ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError, VariationMut,
    VariationRef, add,
};

/// Iterations for what changes of the temperatures, and the change of it at which they end.
const MOST_ITERATIONS: usize = 40;
const ENOUGH: f64 = 1e-13;

/// The numbers of the heat as one parameter has them.
#[derive(Debug, Clone, Copy)]
struct Numbers {
    shift: [Dual; 3],
    /// C, G, T_a and T(0).
    thermal: [Dual; 4],
    /// Coefficient and T_ref.
    expansion: [Dual; 2],
}

impl Numbers {
    /// ln a_T at a temperature, and its derivative by that.
    fn ln_factor(&self, shift: &Shift, temperature: Dual) -> [Dual; 2] {
        match (shift, self.shift) {
            (Shift::Wlf { .. }, [c1, c2, reference]) => {
                let (above, scale) = (temperature - reference, -(Dual::from(std::f64::consts::LN_10) * c1));
                let whole = c2 + above;
                [scale * above / whole, scale * c2 / (whole * whole)]
            }
            (Shift::Arrhenius { .. }, [energy, reference, _]) => {
                let (one, energy) = (Dual::from(1.0), energy / Dual::from(GAS));
                [energy * (one / temperature - one / reference), -(energy / (temperature * temperature))]
            }
        }
    }

    /// By how much a kelvin makes the stroke of the law longer.
    fn by_temperature(&self) -> Dual {
        -self.expansion[0]
    }

    /// By how much heat makes it longer.
    fn stroke(&self, temperature: Dual) -> Dual {
        self.by_temperature() * (temperature - self.expansion[1])
    }
}

/// T and T' at the start and at the nodes as one parameter has them.
#[derive(Debug, Clone, Copy)]
struct Warmed {
    temperature: [Dual; STAGES + 2],
    warming: [Dual; STAGES + 2],
}

/// What changes of what the law itself is told: blocks.
#[derive(Debug, Default)]
struct Told {
    stroke: Vec<f64>,
    rate: Vec<f64>,
    inputs: [Vec<f64>; 2],
    passed: Option<Vec<f64>>,
}

impl Told {
    fn step(&self, count: usize) -> StepVariation<'_> {
        let inputs = self.inputs.each_ref().map(Vec::as_slice);
        StepVariation { count, stroke: &self.stroke, rate: &self.rate, inputs, passed: self.passed.as_deref() }
    }

    fn point<'a>(&'a self, step: Option<StepVariation<'a>>) -> PointVariation<'a> {
        let inputs = self.inputs.each_ref().map(Vec::as_slice);
        PointVariation { stroke: &self.stroke, rate: &self.rate, inputs, step, passed: self.passed.as_deref() }
    }

    /// What is told of one point, whose kinematics and inputs are told from outside.
    fn push(&mut self, seen: Seen) {
        self.stroke.push(seen.stroke.slope);
        self.rate.push(seen.rate.slope);
    }
}

/// A point as one parameter has it: what the law itself sees of it.
struct Seen {
    stroke: Dual,
    rate: Dual,
    inputs: Vec<InputValue<Dual>>,
}

impl Heated {
    fn numbers_of(&self, own: &VariationRef, p: usize) -> Numbers {
        let mut left = self.heat.numbers().into_iter().enumerate();
        let mut next = |there: bool| match there {
            true => left.next().map_or(Dual::default(), |(k, value)| Dual { value, slope: own.number(k)[p] }),
            false => Dual::default(),
        };
        let (wlf, shift) = (matches!(self.heat.shift, Some(Shift::Wlf { .. })), self.heat.shift.is_some());
        let shift = [next(shift), next(shift), next(wlf)];
        let thermal = std::array::from_fn(|_| next(self.heat.thermal.is_some()));
        let expansion = std::array::from_fn(|_| next(self.heat.expansion.is_some()));
        Numbers { shift, thermal, expansion }
    }

    fn all_numbers(&self, own: &VariationRef) -> Vec<Numbers> {
        (0..own.count).map(|p| self.numbers_of(own, p)).collect()
    }

    /// What it keeps itself as parameter `p` has it: ξ, T, heat lost and T'.
    fn kept(&self, own: &Own, share: &VariationRef, p: usize) -> [Dual; 4] {
        let clock = usize::from(self.heat.shift.is_some());
        let of =
            |k: usize, there: bool, value: f64| Dual { value, slope: if there { share.variable(k)[p] } else { 0.0 } };
        let thermal = self.heat.thermal.is_some();
        [
            of(0, clock == 1, own.xi),
            of(clock, thermal, own.temperature),
            of(clock + 1, thermal, own.lost),
            of(clock + 2, thermal, own.warming),
        ]
    }

    /// 1/a_T of the one node of a step, which stands for the whole of it ([`super::clock::Clock`]); of steps of several nodes none.
    fn pace_of(&self, step: &Step, warmed: &Warmed, numbers: &Numbers) -> Option<Dual> {
        let shift = self.heat.shift.as_ref().filter(|_| step.nodes.count() == 1)?;
        let at = |k: usize| (-numbers.ln_factor(shift, warmed.temperature[k])[0]).exp();
        Some(if step.nodes == Nodes::One { Dual::from(0.5) * (at(0) + at(1)) } else { at(1) })
    }

    /// What changes of ln a_T at the start or at a node of the step.
    fn ln_factor_at(&self, step: &Step, k: usize, warmed: &Warmed, numbers: &Numbers) -> f64 {
        match (&self.heat.shift, self.pace_of(step, warmed, numbers).filter(|_| k > 0)) {
            (_, Some(pace)) => -pace.slope / pace.value,
            (Some(shift), None) => numbers.ln_factor(shift, warmed.temperature[k])[0].slope,
            (None, None) => 0.0,
        }
    }

    /// What the law itself sees of a point; 1/a_T is `pace` where that is told.
    fn see(
        &self,
        numbers: &Numbers,
        [stroke, rate, temperature, warming]: [Dual; 4],
        inputs: impl Iterator<Item = InputValue<Dual>>,
        pace: Option<Dual>,
    ) -> Seen {
        let (ln, slope) = match &self.heat.shift {
            Some(shift) => numbers.ln_factor(shift, temperature).into(),
            None => (Dual::default(), Dual::default()),
        };
        let factor = pace.map_or_else(|| ln.exp(), |pace| Dual::from(1.0) / pace);
        let (mut rest, mut inside) = (inputs, Vec::new());
        for i in 0..self.inputs {
            let told = match (self.takes == Some(i), self.heat.thermal) {
                (true, Some(_)) => InputValue { value: temperature, rate: warming },
                _ => rest.next().unwrap_or(InputValue { value: Dual::default(), rate: Dual::default() }),
            };
            inside.push(InputValue { rate: factor * told.rate, ..told });
        }
        if self.tells_factor {
            inside.push(InputValue { value: factor, rate: factor * factor * slope * warming });
        }
        let (longer, by_temperature) = match self.heat.expansion {
            Some(_) => (numbers.stroke(temperature), numbers.by_temperature()),
            None => (Dual::default(), Dual::default()),
        };
        Seen { stroke: stroke + longer, rate: factor * (rate + by_temperature * warming), inputs: inside }
    }

    /// What changes of the step as the law itself is told it; where `still` strokes and rates from outside stay at the nodes.
    fn told_inside(
        &self,
        step: &Step,
        warmed: &[Warmed],
        told: &StepVariation,
        numbers: &[Numbers],
        still: bool,
    ) -> Told {
        let (count, outer) = (told.count, step.inputs_at(0).len());
        let mut inside = Told::default();
        for k in 0..=step.nodes.count() {
            let mut each = Vec::with_capacity(count);
            for (p, (warmed, numbers)) in warmed.iter().zip(numbers).enumerate() {
                let moves = |block: &[f64]| if still && k > 0 { 0.0 } else { block[p] };
                let stroke = Dual { value: step.stroke[k], slope: moves(told.stroke_at(k)) };
                let slope = if told.rate.is_empty() { 0.0 } else { moves(told.rate_at(k)) };
                let rate = Dual { value: step.rate.get(k).copied().unwrap_or(0.0), slope };
                let of_input = |(i, input): (usize, &InputValue)| {
                    let [by_value, by_rate] =
                        told.input_at(k, i, outer).map_or([0.0; 2], |of| of.map(|block| block[p]));
                    let [value, rate] =
                        [(input.value, by_value), (input.rate, by_rate)].map(|(value, slope)| Dual { value, slope });
                    InputValue { value, rate }
                };
                let inputs = step.inputs_at(k).iter().enumerate().map(of_input);
                let at = [stroke, rate, warmed.temperature[k], warmed.warming[k]];
                each.push(self.see(numbers, at, inputs, self.pace_of(step, warmed, numbers).filter(|_| k > 0)));
            }
            push_inputs(&mut inside, &each);
            each.into_iter().for_each(|seen| inside.push(seen));
        }
        inside.passed = self.passed(step, warmed, numbers, None);
        inside
    }

    /// What changes of Δξ until the nodes, or until θ; `None` where nothing does.
    fn passed(&self, step: &Step, warmed: &[Warmed], numbers: &[Numbers], until: Option<f64>) -> Option<Vec<f64>> {
        let shift = self.heat.shift.as_ref()?;
        let moves = |(warmed, numbers): (&Warmed, &Numbers)| {
            warmed.temperature.iter().chain(&numbers.shift).any(|number| number.slope != 0.0)
        };
        if !warmed.iter().zip(numbers).any(moves) {
            return None;
        }
        let (count, nodes) = (warmed.len(), step.nodes.count());
        let mut passed = vec![0.0; count * if until.is_some() { 1 } else { nodes }];
        for (p, (warmed, numbers)) in warmed.iter().zip(numbers).enumerate().filter(|(_, both)| moves(*both)) {
            if let Some(pace) = self.pace_of(step, warmed, numbers) {
                passed[p] = until.unwrap_or(step.positions()[0]) * step.h * pace.slope;
                continue;
            }
            let pace = |theta: f64| {
                let at = |k: usize| Dual::from(lagrange_row(k).iter().rev().fold(0.0, |sum, c| sum * theta + c));
                let temperature = (0..=STAGES).map(|k| at(k) * warmed.temperature[k]).sum();
                let [ln, _] = numbers.ln_factor(shift, temperature);
                (-ln).exp()
            };
            let (mut from, mut sum) = (0.0, 0.0);
            for (j, end) in RADAU_NODES.into_iter().enumerate() {
                let to = until.map_or(end, |theta| theta.min(end));
                if to > from {
                    sum += super::clock::integral(from, to, |theta| pace(theta).slope);
                    from = to;
                }
                if until.is_none() {
                    passed[j * count + p] = step.h * sum;
                }
            }
            if until.is_some() {
                passed[p] = step.h * sum;
            }
        }
        Some(passed)
    }

    /// What changes of the temperatures; the state is at the law's share, `own` at the start of all.
    #[allow(clippy::too_many_arguments)]
    fn warmed(
        &self,
        step: &Step,
        kept: &Own,
        course: &Temperatures,
        inside: &Inside,
        state: StateRef,
        told: &StepVariation,
        (own, numbers): (&VariationRef, &[Numbers]),
    ) -> Vec<Warmed> {
        let (nodes, outer) = (step.nodes.count(), step.inputs_at(0).len());
        let still = |k: usize| [course.temperature[k].into(), course.warming[k].into()];
        let of_input = |p: usize| {
            let mut warmed = Warmed { temperature: [Dual::default(); 5], warming: [Dual::default(); 5] };
            for k in 0..=nodes {
                [warmed.temperature[k], warmed.warming[k]] = still(k);
                let moved = self.input().and_then(|input| told.input_at(k, input, outer));
                if let Some([value, rate]) = moved.filter(|_| self.heat.thermal.is_none()) {
                    (warmed.temperature[k].slope, warmed.warming[k].slope) = (value[p], rate[p]);
                }
            }
            warmed
        };
        let mut warmed: Vec<Warmed> = (0..told.count).map(of_input).collect();
        let Some(thermal) = &self.heat.thermal else { return warmed };
        let (count, matrix) = (told.count, step.matrix());
        let [capacity, conductance] = [thermal.capacity, thermal.conductance];
        let inverse = implicit(&matrix, step.h / capacity * conductance, nodes);
        let powers = self.powers_of(step, inside, &mut state.clone());
        for (p, warmed) in warmed.iter_mut().enumerate() {
            let [_, temperature, _, _] = self.kept(kept, own, p);
            warmed.temperature.iter_mut().take(nodes + 1).for_each(|own| own.slope = temperature.slope);
        }
        // A column ends by itself, so that it has the same bits whatever stands beside it.
        let mut is_found = vec![false; count];
        for _ in 0..MOST_ITERATIONS {
            let changes = self.told_inside(step, &warmed, told, numbers, false);
            let mut flows = [(); 2].map(|()| vec![0.0; (nodes + 1) * count]);
            let [dissipation, input] = &mut flows;
            let (mut behind, mut of_law) = (state, *own);
            of_law.take(self.heat.numbers().len(), self.own_size());
            let mut sum = PowersVariation { dissipation, input };
            self.law.ask().vary_powers(&inside.step(step), &mut behind, &changes.step(count), &mut of_law, &mut sum);
            for (p, ((warmed, numbers), is_found)) in warmed.iter_mut().zip(numbers).zip(&mut is_found).enumerate() {
                if *is_found {
                    continue;
                }
                let (mut change, mut size) = (0.0f64, f64::MIN_POSITIVE);
                let [by_capacity, by_conductance, by_ambient, _] = numbers.thermal.map(|number| number.slope);
                // Of the power by the clock of the wall.
                let power = |k: usize, warmed: &Warmed| {
                    let ln = self.ln_factor_at(step, k, warmed, numbers);
                    flows[0][k * count + p] / inside.clock.factor[k] - powers[k].dissipation * ln
                };
                let driven = |k: usize, warmed: &Warmed| {
                    let above = course.temperature[k] - thermal.ambient;
                    let flow = by_conductance * above - conductance * by_ambient;
                    (power(k, warmed) - flow - course.warming[k] * by_capacity) / capacity
                };
                let all: Values = std::array::from_fn(|k| if k <= nodes { driven(k, warmed) } else { 0.0 });
                let start = warmed.temperature[0].slope;
                let right: Values = std::array::from_fn(|i| match i < nodes {
                    true => start + step.h * (0..nodes).map(|j| matrix[i][j] * all[j + 1]).sum::<f64>(),
                    false => 0.0,
                });
                for i in 0..nodes {
                    let next: f64 = (0..nodes).map(|j| inverse[i][j] * right[j]).sum();
                    let moved = (next - warmed.temperature[i + 1].slope).abs();
                    change = if moved > change || moved.is_nan() { moved } else { change };
                    size = size.max(next.abs());
                    warmed.temperature[i + 1].slope = next;
                }
                for k in 0..=nodes {
                    let next = all[k] - conductance * warmed.temperature[k].slope / capacity;
                    let moved = step.h * (next - warmed.warming[k].slope).abs();
                    change = if moved > change || moved.is_nan() { moved } else { change };
                    warmed.warming[k].slope = next;
                }
                *is_found = change <= ENOUGH * size || change.is_nan();
            }
            if is_found.iter().all(|found| *found) {
                break;
            }
        }
        warmed
    }

    /// The temperature between two steps as parameter `p` has it, T and T'.
    fn temperature_now(
        &self,
        kept: &Own,
        at: &Point,
        told: &PointVariation,
        (own, p): (&VariationRef, usize),
    ) -> [Dual; 2] {
        if self.heat.thermal.is_some() {
            let [_, temperature, _, warming] = self.kept(kept, own, p);
            return [temperature, warming];
        }
        let seen = self.seen(at.inputs);
        let moved = self.input().and_then(|input| told.input(input, own.count));
        let [by_value, by_rate] = moved.map_or([0.0; 2], |of| of.map(|block| block[p]));
        [Dual { value: seen.value, slope: by_value }, Dual { value: seen.rate, slope: by_rate }]
    }

    /// What changes of a point as the law itself is told it, at these temperatures.
    fn told_point(
        &self,
        at: &Point,
        told: &PointVariation,
        numbers: &[Numbers],
        temperatures: impl Fn(usize) -> [Dual; 2],
    ) -> Told {
        let mut inside = Told::default();
        let count = numbers.len();
        let each: Vec<Seen> = (0..count)
            .map(|p| {
                let [temperature, warming] = temperatures(p);
                let stroke = Dual { value: at.stroke, slope: told.stroke[p] };
                let rate = Dual { value: at.rate, slope: told.rate[p] };
                let inputs = told.inputs_of(at, p, count).into_iter();
                self.see(&numbers[p], [stroke, rate, temperature, warming], inputs, None)
            })
            .collect();
        push_inputs(&mut inside, &each);
        each.into_iter().for_each(|seen| inside.push(seen));
        inside
    }

    /// What changes of `state` behind a past that was spent at the temperature of the start ([`Heated::recalled`]): `take` says it of the law
    /// itself, whose state, a_T, stroke of heat and changes of these it is told.
    ///
    /// # Errors
    /// Those of `take`, and of a clock that moves.
    pub(in crate::law) fn variation_of_past(
        &self,
        of: Begun,
        state: &State,
        take: impl FnOnce(Begun, &State, f64, f64, &ByHeat) -> Result<LawVariation, String>,
    ) -> Result<LawVariation, String> {
        let at = of.at();
        let mut whole = LawVariation::begin(of.law, of.by, &at, &of.told, state)?;
        let (size, view) = (self.own_size(), whole.view());
        let share = self.take_own(&mut { view });
        let (kept, numbers) = (self.own(&state.view().variables[..size.variables], 0.0), self.all_numbers(&share));
        let temperature = |p: usize| self.temperature_now(&kept, &at, &of.told, (&share, p));
        let of_each = |change: &dyn Fn(&Numbers, Dual) -> Dual| -> Vec<f64> {
            numbers.iter().enumerate().map(|(p, own)| change(own, temperature(p)[0]).slope).collect()
        };
        let ln_factor = of_each(&|own, temperature| {
            self.heat.shift.as_ref().map_or(Dual::default(), |shift| own.ln_factor(shift, temperature)[0])
        });
        let longer =
            of_each(&|own, temperature| self.heat.expansion.map_or(Dual::default(), |_| own.stroke(temperature)));
        let inside = self.told_point(&at, &of.told, &numbers, temperature);
        let by: Vec<Option<Network>> = of
            .by
            .iter()
            .map(|law| law.as_ref().and_then(Network::as_heated).map(|heated| heated.law().clone()))
            .collect();
        let (warm, mut inputs) = (self.seen(of.start.inputs).value, Vec::new());
        let start = self.start(&of.start, &mut inputs);
        let inner = Begun { law: &self.law, by: &by, start, told: inside.point(None) };
        let (factor, stroke) = (self.heat.factor(warm), self.heat.stroke(warm));
        let inner = take(inner, &state.without(size.variables), factor, stroke, &ByHeat { ln_factor, longer })?;
        whole.take_inner(inner, size.variables);
        Ok(whole)
    }

    /// Splits off the share of the heat.
    fn take_own<'a>(&self, own: &mut VariationRef<'a>) -> VariationRef<'a> {
        own.take(self.heat.numbers().len(), self.own_size())
    }
}

/// Blocks of the inputs of one point, input by input.
fn push_inputs(inside: &mut Told, each: &[Seen]) {
    let inputs = each.first().map_or(0, |seen| seen.inputs.len());
    let [values, rates] = &mut inside.inputs;
    for i in 0..inputs {
        values.extend(each.iter().map(|seen| seen.inputs[i].value.slope));
        rates.extend(each.iter().map(|seen| seen.inputs[i].rate.slope));
    }
}

impl Vary for Heated {
    fn numbers(&self, take: &mut dyn FnMut(Dual)) {
        let numbers = self.heat.numbers().into_iter().zip(self.moved.numbers());
        numbers.for_each(|(value, slope)| take(Dual { value, slope }));
        self.law.ask().numbers(take);
    }

    fn begin_memories(
        &self,
        state: &mut StateRef,
        own: &mut VariationRef,
        memories: &mut Vec<crate::fractional::MemoryTangent>,
    ) -> Result<(), crate::fractional::KernelError> {
        state.take(self.own_size());
        self.take_own(own);
        self.law.ask().begin_memories(state, own, memories)
    }

    fn begin_variation(&self, at: &Point, state: &mut StateRef, told: &PointVariation, own: &mut VariationMut) {
        let kept = self.own(state.take(self.own_size()).variables, at.t);
        let share = own.take(self.heat.numbers().len(), self.own_size());
        let numbers = self.all_numbers(&share.view());
        let clock = usize::from(self.heat.shift.is_some());
        if let Some(thermal) = &self.heat.thermal {
            for (p, Numbers { thermal: [capacity, conductance, ambient, start], .. }) in numbers.iter().enumerate() {
                let warming = -(*conductance * (*start - *ambient)) / *capacity;
                debug_assert!(start.value == thermal.start);
                share.variables[clock * share.count + p] = start.slope;
                share.variables[(clock + 2) * share.count + p] = warming.slope;
            }
        }
        let place = self.place(at, kept.xi, self.temperature(&kept, at.inputs));
        let view = share.view();
        let inside = self.told_point(at, told, &numbers, |p| self.temperature_now(&kept, at, told, (&view, p)));
        self.law.ask().begin_variation(&place.point(), state, &inside.point(None), own);
    }

    fn evaluate_exactly(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        self.respond(step, state, response, |law, step, state, own| law.ask().evaluate_exactly(step, state, own));
    }

    /// Of what a temperature moves nothing is told.
    fn rates(&self, _: &Point, _: &mut StateRef, _: &mut Vec<f64>) -> bool {
        false
    }

    /// The temperature changes with strokes and rates at the nodes too: a state of that is asked again once what changes of those is known.
    fn vary(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        let whole = *own;
        let numbers = self.all_numbers(&self.take_own(own));
        let Some((kept, course, inside)) = self.look(step, state) else {
            forces.fill(f64::NAN);
            return self.law.ask().pass(state);
        };
        let warmed = self.warmed(step, &kept, &course, &inside, *state, told, (&whole, &numbers));
        let (count, inner) = (told.count, inside.step(step));
        let changes = self.told_inside(step, &warmed, told, &numbers, true);
        if changes.stroke[count..].iter().chain(&changes.rate[count..]).any(|change| *change != 0.0) {
            let mut response = Response::default();
            self.law.ask().evaluate_exactly(&inner, &mut state.clone(), &mut response);
            for (i, forces) in forces.chunks_exact_mut(count).enumerate() {
                for j in 0..step.nodes.count() {
                    let block = (j + 1) * count..(j + 2) * count;
                    add(forces, response.d_stroke[i][j], &changes.stroke[block.clone()]);
                    add(forces, response.d_rate[i][j], &changes.rate[block]);
                }
            }
        }
        self.law.ask().vary(&inner, state, &changes.step(count), own, forces);
    }

    fn vary_singular(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        let whole = *own;
        let numbers = self.all_numbers(&self.take_own(own));
        let Some((kept, course, inside)) = self.look(step, state) else { return self.law.ask().pass(state) };
        let warmed = self.warmed(step, &kept, &course, &inside, *state, told, (&whole, &numbers));
        let changes = self.told_inside(step, &warmed, told, &numbers, false);
        self.law.ask().vary_singular(&inside.step(step), state, &changes.step(told.count), own, forces);
    }

    /// As of the run itself: by a clock that always ran as it does now.
    fn vary_singularity(
        &self,
        (from, at): (f64, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sums: [&mut [f64]; 3],
    ) {
        let kept = self.own(state.take(self.own_size()).variables, at.t);
        let share = self.take_own(own);
        let numbers = self.all_numbers(&share);
        let place = self.place(at, at.t, self.temperature(&kept, at.inputs));
        let inside = self.told_point(at, told, &numbers, |p| self.temperature_now(&kept, at, told, (&share, p)));
        let (factor, count) = (place.factor, share.count);
        let mut inner = [(); 3].map(|()| vec![0.0; count]);
        let [value, once, twice] = &mut inner;
        let point = Point { t: at.t / factor, ..place.point() };
        self.law.ask().vary_singularity((from / factor, &point), state, &inside.point(None), own, [value, once, twice]);
        for (order, (sum, inner)) in sums.into_iter().zip(&inner).enumerate() {
            add(sum, factor.powi(order as i32), inner);
        }
    }

    fn commit_variation(&self, step: &Step, state: &mut StateRef, told: &StepVariation, own: &mut VariationMut) {
        let (count, clock) = (own.count, usize::from(self.heat.shift.is_some()));
        let Some((kept, course, inside)) = self.look(step, state) else {
            own.variables.fill(f64::NAN);
            return self.law.ask().pass(state);
        };
        let (changes, warmed, numbers, starts) = {
            let mut view = own.view();
            let whole = view;
            let share = self.take_own(&mut view);
            let numbers = self.all_numbers(&share);
            let warmed = self.warmed(step, &kept, &course, &inside, *state, told, (&whole, &numbers));
            let starts: Vec<[Dual; 4]> = (0..count).map(|p| self.kept(&kept, &share, p)).collect();
            (self.told_inside(step, &warmed, told, &numbers, false), warmed, numbers, starts)
        };
        let share = own.take(self.heat.numbers().len(), self.own_size());
        let (nodes, matrix) = (step.nodes.count(), step.matrix());
        let weights = match step.nodes {
            Nodes::Midpoint => [1.0, 0.0, 0.0, 0.0],
            _ => matrix[nodes - 1],
        };
        for (p, [xi, temperature, lost, _]) in starts.into_iter().enumerate() {
            let mut put = |k: usize, value: f64| share.variables[k * count + p] = value;
            if clock == 1 {
                let passed = changes.passed.as_ref().map_or(0.0, |passed| passed[(nodes - 1) * count + p]);
                put(0, xi.slope + passed);
            }
            if self.heat.thermal.is_some() {
                let [_, conductance, ambient, _] = numbers[p].thermal;
                let over = |of: &dyn Fn(usize) -> f64| step.h * (0..nodes).map(|j| weights[j] * of(j + 1)).sum::<f64>();
                put(clock, temperature.slope + over(&|k| warmed[p].warming[k].slope));
                let flow = |k: usize| (conductance * (warmed[p].temperature[k] - ambient)).slope;
                put(clock + 1, lost.slope + over(&flow));
                put(clock + 2, warmed[p].warming[nodes].slope);
            }
        }
        self.law.ask().commit_variation(&inside.step(step), state, &changes.step(count), own);
    }

    /// By the clock of the law, whose steps are the same.
    fn vary_errors(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        take: TakeError,
    ) {
        let (whole, before) = (*own, *state);
        let share = self.take_own(own);
        let numbers = self.all_numbers(&share);
        let Some((kept, course, inside)) = self.look(step, state) else {
            (*state, *own) = (before, whole);
            return self.pass_by(state, own);
        };
        let warmed = self.warmed(step, &kept, &course, &inside, *state, told, (&whole, &numbers));
        let changes = self.told_inside(step, &warmed, told, &numbers, false);
        self.law.ask().vary_errors(&inside.step(step), state, &changes.step(told.count), own, take);
    }

    fn vary_powers(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        sum: &mut PowersVariation,
    ) {
        let (whole, before) = (*own, *state);
        let share = self.take_own(own);
        let numbers = self.all_numbers(&share);
        let Some((kept, course, inside)) = self.look(step, state) else {
            [&mut *sum.dissipation, &mut *sum.input].into_iter().for_each(|sum| sum.fill(f64::NAN));
            return self.law.ask().pass(state);
        };
        let warmed = self.warmed(step, &kept, &course, &inside, *state, told, (&whole, &numbers));
        let (count, nodes, behind, own_behind) = (told.count, step.nodes.count(), *state, *own);
        let changes = self.told_inside(step, &warmed, told, &numbers, false);
        let (inner, of_step) = (inside.step(step), changes.step(count));
        let mut powers = Default::default();
        self.law.ask().powers(&inner, &mut behind.clone(), &mut powers);
        let mut flows = [(); 2].map(|()| vec![0.0; (nodes + 1) * count]);
        let [dissipation, input] = &mut flows;
        self.law.ask().vary_powers(&inner, state, &of_step, own, &mut PowersVariation { dissipation, input });
        for k in 0..=nodes {
            let factor = inside.clock.factor[k];
            for p in 0..count {
                let ln = self.ln_factor_at(step, k, &warmed[p], &numbers[p]);
                let at = k * count + p;
                sum.dissipation[at] += (flows[0][at] - powers[k].dissipation * ln) / factor;
                sum.input[at] += (flows[1][at] - powers[k].input * ln) / factor;
            }
        }
        if self.heat.expansion.is_some() {
            // What the heat does to the stroke is supplied by it: F·coefficient·T'.
            let mut response = Response::default();
            self.law.ask().evaluate(&inner, &mut behind.clone(), &mut response);
            let mut forces = vec![0.0; (nodes + 1) * count];
            let (start, rest) = forces.split_at_mut(count);
            let at = step.point(0);
            let place = self.place(&at, kept.xi, self.temperature(&kept, at.inputs));
            let inputs = self.inputs + usize::from(self.tells_factor);
            let of_inputs = changes.inputs.each_ref().map(|blocks| blocks.get(..inputs * count).unwrap_or_default());
            let of_start = PointVariation {
                stroke: of_step.stroke_at(0),
                rate: of_step.rate_at(0),
                inputs: of_inputs,
                step: None,
                passed: None,
            };
            let mut spare = vec![0.0; count];
            let mut unused = vec![0.0; count];
            let told = &mut Vec::new();
            let mut at_start =
                ObservationVariation { force: start, stored: &mut spare, derivative: &mut unused, told, leaves: None };
            let when = (When::Between, &place.point());
            self.law.ask().vary_at(when, &mut behind.clone(), &of_start, &mut own_behind.clone(), &mut at_start);
            self.law.ask().vary(&inner, &mut behind.clone(), &of_step, &mut own_behind.clone(), rest);
            for (i, forces) in rest.chunks_exact_mut(count).enumerate() {
                for j in 0..nodes {
                    add(forces, response.d_stroke[i][j], of_step.stroke_at(j + 1));
                    add(forces, response.d_rate[i][j], of_step.rate_at(j + 1));
                }
            }
            let first = self.law.ask().now(&place.point(), &mut behind.clone(), &mut |_| ()).observation.regular;
            for k in 0..=nodes {
                let value = if k == 0 { first } else { response.force[k - 1] - response.singular[k - 1] };
                for p in 0..count {
                    let force = Dual { value, slope: forces[k * count + p] };
                    sum.input[k * count + p] += (force * numbers[p].by_temperature() * warmed[p].warming[k]).slope;
                }
            }
        }
        debug_assert!(before.variables.len() >= self.own_size().variables);
    }

    fn vary_at(
        &self,
        (when, at): (When, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let whole = *own;
        let share = self.take_own(own);
        let numbers = self.all_numbers(&share);
        let (When::Within(step, theta), Some(around)) = (when, &told.step) else {
            let kept = self.own(state.take(self.own_size()).variables, at.t);
            let place = self.place(at, kept.xi, self.temperature(&kept, at.inputs));
            let inside = self.told_point(at, told, &numbers, |p| self.temperature_now(&kept, at, told, (&share, p)));
            self.law.ask().vary_at((When::Between, &place.point()), state, &inside.point(None), own, sum);
            if self.heat.thermal.is_some() {
                let clock = usize::from(self.heat.shift.is_some());
                [clock, clock + 1].into_iter().for_each(|k| sum.told.extend(share.variable(k)));
            }
            return;
        };
        let Some((kept, course, inside)) = self.look(step, state) else {
            sum.force.fill(f64::NAN);
            sum.told.extend(vec![f64::NAN; 2 * share.count]);
            return self.law.ask().pass(state);
        };
        let warmed = self.warmed(step, &kept, &course, &inside, *state, around, (&whole, &numbers));
        let (fraction, temperature) = (
            inside.clock.share(theta),
            match self.heat.thermal {
                None => self.seen(at.inputs),
                Some(_) => self.within(step, theta, &kept, &course),
            },
        );
        let place = self.place(at, kept.xi + fraction * inside.clock.h, temperature);
        let of_step = self.told_inside(step, &warmed, around, &numbers, false);
        let quadrature = step.quadrature(theta);
        let temperature_at = |p: usize| {
            if self.heat.thermal.is_none() {
                return self.temperature_now(&kept, at, told, (&share, p));
            }
            let own = &warmed[p];
            let moved: f64 = quadrature.iter().zip(&own.warming).map(|(weight, rate)| weight * rate.slope).sum();
            let rate = match step.nodes {
                Nodes::Radau => {
                    let at = |k: usize| lagrange_row(k).iter().rev().fold(0.0, |sum, c| sum * theta + c);
                    own.warming.iter().enumerate().take(4).map(|(k, rate)| at(k) * rate.slope).sum()
                }
                _ => own.warming[step.nodes.count()].slope,
            };
            let [_, start, ..] = self.kept(&kept, &share, p);
            [
                Dual { value: temperature.value, slope: start.slope + step.h * moved },
                Dual { value: temperature.rate, slope: rate },
            ]
        };
        let temperatures: Vec<[Dual; 2]> = (0..share.count).map(temperature_at).collect();
        let mut of_point = self.told_point(at, told, &numbers, |p| temperatures[p]);
        of_point.passed = self.passed(step, &warmed, &numbers, Some(theta));
        let (inner, count) = (inside.step(step), share.count);
        let told = of_point.point(Some(of_step.step(count)));
        self.law.ask().vary_at((When::Within(&inner, fraction), &place.point()), state, &told, own, sum);
        if self.heat.thermal.is_some() {
            let lost = |(p, own): (usize, &Warmed)| {
                let [_, conductance, ambient, _] = numbers[p].thermal;
                let flow = |k: usize| (conductance * (own.temperature[k] - ambient)).slope;
                let flows = quadrature.iter().enumerate().map(|(k, weight)| weight * flow(k)).sum::<f64>();
                share.variable(usize::from(self.heat.shift.is_some()) + 1)[p] + step.h * flows
            };
            sum.told.extend(temperatures.iter().map(|[temperature, _]| temperature.slope));
            sum.told.extend(warmed.iter().enumerate().map(lost));
        }
    }
}
