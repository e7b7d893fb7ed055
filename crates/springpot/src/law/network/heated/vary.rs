//! What parameters change of a law under a temperature that is told: the clock and the expansion stay, and what its own law is told changes.
//!
//! Where a parameter moves the temperature itself nothing is known, and derivatives by it are NaN.

use super::{Heated, Inside};
use crate::law::leaf::When;
use crate::law::network::part::Part;
use crate::law::network::vary::Vary;
use crate::law::state::StateRef;
use crate::law::step::{Point, Response, Step};
use crate::law::variation::{
    ObservationVariation, PointVariation, PowersVariation, StepVariation, VariationMut, VariationRef, add,
};

/// What changes of rates and inputs at some times, as the law itself is told them.
struct Told {
    rate: Vec<f64>,
    inputs: [Vec<f64>; 2],
    /// The parameters that move the temperature.
    unknown: Vec<usize>,
}

impl Told {
    fn step<'a>(&'a self, told: &StepVariation<'a>) -> StepVariation<'a> {
        StepVariation { rate: &self.rate, inputs: self.inputs.each_ref().map(Vec::as_slice), ..*told }
    }

    fn point<'a>(&'a self, told: &PointVariation<'a>) -> PointVariation<'a> {
        PointVariation { rate: &self.rate, inputs: self.inputs.each_ref().map(Vec::as_slice), step: None, ..*told }
    }

    /// Puts NaN where nothing is known.
    fn mark(&self, blocks: &mut [f64], count: usize) {
        for block in blocks.chunks_exact_mut(count) {
            self.unknown.iter().for_each(|&p| block[p] = f64::NAN);
        }
    }
}

impl Heated {
    /// `factors` are a_T at the times of the blocks, `outer` the number of inputs from outside.
    fn told_inside(
        &self,
        rate: &[f64],
        [values, rates]: [&[f64]; 2],
        (factors, outer, count): (&[f64], usize, usize),
    ) -> Told {
        let by_clock = |blocks: &[f64], each: usize| -> Vec<f64> {
            let of = |(block, factor): (&[f64], &f64)| block.iter().map(|x| factor * x).collect::<Vec<_>>();
            blocks.chunks_exact(each).zip(factors).flat_map(of).collect()
        };
        let mut told = Told { rate: by_clock(rate, count), inputs: [Vec::new(), Vec::new()], unknown: Vec::new() };
        if values.is_empty() {
            return told;
        }
        let own = self.inputs + usize::from(self.tells_factor);
        for (into, from) in told.inputs.iter_mut().zip([values.to_vec(), by_clock(rates, outer * count)]) {
            for point in from.chunks_exact(outer * count) {
                // a_T, the last of them, is that of the temperature.
                into.extend_from_slice(&point[..self.inputs * count]);
                into.resize(into.len() + (own - self.inputs) * count, 0.0);
            }
        }
        let moves = |p: usize| {
            let of = |input: usize| {
                let blocks = values.chunks_exact(count).zip(rates.chunks_exact(count)).skip(input).step_by(outer);
                blocks.into_iter().any(|(value, rate)| value[p] != 0.0 || rate[p] != 0.0)
            };
            self.input().filter(|_| self.heat.shift.is_some() || self.heat.expansion.is_some()).is_some_and(of)
        };
        told.unknown = (0..count).filter(|p| moves(*p)).collect();
        told
    }

    fn told_step(&self, step: &Step, inside: &Inside, told: &StepVariation) -> Told {
        let factors = &inside.clock.factor[..=step.nodes.count()];
        self.told_inside(told.rate, told.inputs, (factors, step.inputs_at(0).len(), told.count))
    }
}

impl Vary for Heated {
    /// None is known of a temperature that follows from the losses.
    fn without_derivatives(&self) -> Option<String> {
        match self.heat.thermal {
            Some(_) => Some("a temperature that follows from losses".to_owned()),
            None if self.size().memories > 0 => Some("a springpot under heat".to_owned()),
            None => self.law.without_derivatives(),
        }
    }

    fn begin_variation(&self, at: &Point, state: &mut StateRef, told: &PointVariation, own: &mut VariationMut) {
        let kept = self.own(state.take(self.own_size()).variables, at.t);
        own.take(0, self.own_size());
        let place = self.place(at, kept.xi, self.temperature(&kept, at.inputs));
        let inside = self.told_inside(told.rate, told.inputs, (&[place.factor], at.inputs.len(), own.count));
        self.law.ask().begin_variation(&place.point(), state, &inside.point(told), own);
    }

    /// Of what a temperature moves nothing is told.
    fn rates(&self, _: &Point, _: &mut StateRef, _: &mut Vec<f64>) -> bool {
        false
    }

    fn vary(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        own.take(0, self.own_size());
        let Some((_, _, inside)) = self.look(step, state) else {
            forces.fill(f64::NAN);
            return self.law.ask().pass(state);
        };
        let changes = self.told_step(step, &inside, told);
        self.law.ask().vary(&inside.step(step), state, &changes.step(told), own, forces);
        changes.mark(forces, told.count);
    }

    fn commit_variation(&self, step: &Step, state: &mut StateRef, told: &StepVariation, own: &mut VariationMut) {
        own.take(0, self.own_size());
        let Some((_, _, inside)) = self.look(step, state) else {
            own.variables.fill(f64::NAN);
            return self.law.ask().pass(state);
        };
        let changes = self.told_step(step, &inside, told);
        self.law.ask().commit_variation(&inside.step(step), state, &changes.step(told), &mut own.reborrow());
        changes.mark(own.variables, told.count);
    }

    fn vary_powers(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        sum: &mut PowersVariation,
    ) {
        own.take(0, self.own_size());
        let kept = self.own(state.variables, step.t);
        let Some((_, course, inside)) = self.look(step, state) else {
            [&mut *sum.dissipation, &mut *sum.input].into_iter().for_each(|sum| sum.fill(f64::NAN));
            return self.law.ask().pass(state);
        };
        let (count, nodes, behind, own_behind) = (told.count, step.nodes.count(), *state, *own);
        let changes = self.told_step(step, &inside, told);
        let (inner, of_step) = (inside.step(step), changes.step(told));
        let mut flows = [(); 2].map(|()| vec![0.0; (nodes + 1) * count]);
        let [dissipation, input] = &mut flows;
        self.law.ask().vary_powers(&inner, state, &of_step, own, &mut PowersVariation { dissipation, input });
        for (sum, flows) in [&mut *sum.dissipation, &mut *sum.input].into_iter().zip(&flows) {
            for (k, (sum, flow)) in sum.chunks_exact_mut(count).zip(flows.chunks_exact(count)).enumerate() {
                add(sum, inside.clock.factor[k].recip(), flow);
            }
        }
        if self.heat.expansion.is_some() {
            // What the heat does to the stroke is supplied by it: F·coefficient·T'.
            let mut response = Response::default();
            self.law.ask().evaluate(&inner, &mut behind.clone(), &mut response);
            let mut forces = vec![0.0; (nodes + 1) * count];
            let (start, rest) = forces.split_at_mut(count);
            let of_inputs = told.inputs.map(|blocks| blocks.get(..step.inputs_at(0).len() * count).unwrap_or_default());
            let of_start =
                PointVariation { stroke: told.stroke_at(0), rate: told.rate_at(0), inputs: of_inputs, step: None };
            let at = step.point(0);
            let place = self.place(&at, kept.xi, self.temperature(&kept, at.inputs));
            let of_place = self.told_inside(of_start.rate, of_start.inputs, (&[place.factor], at.inputs.len(), count));
            let mut spare = vec![0.0; count];
            let mut at_start = ObservationVariation { force: start, stored: &mut spare };
            let when = (When::Between, &place.point());
            let told_at_start = of_place.point(&of_start);
            self.law.ask().vary_at(when, &mut behind.clone(), &told_at_start, &mut own_behind.clone(), &mut at_start);
            self.law.ask().vary(&inner, &mut behind.clone(), &of_step, &mut own_behind.clone(), rest);
            for (i, forces) in rest.chunks_exact_mut(count).enumerate() {
                for j in 0..nodes {
                    add(forces, response.d_stroke[i][j], of_step.stroke_at(j + 1));
                    add(forces, response.d_rate[i][j], of_step.rate_at(j + 1));
                }
            }
            let by_temperature = self.heat.stroke_by_temperature();
            for (k, (sum, force)) in sum.input.chunks_exact_mut(count).zip(forces.chunks_exact(count)).enumerate() {
                add(sum, by_temperature * course.warming[k], force);
            }
        }
        changes.mark(sum.dissipation, count);
        changes.mark(sum.input, count);
    }

    fn vary_at(
        &self,
        (when, at): (When, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sum: &mut ObservationVariation,
    ) {
        own.take(0, self.own_size());
        let count = own.count;
        let (When::Within(step, theta), Some(around)) = (when, &told.step) else {
            let kept = self.own(state.take(self.own_size()).variables, at.t);
            let place = self.place(at, kept.xi, self.temperature(&kept, at.inputs));
            let inside = self.told_inside(told.rate, told.inputs, (&[place.factor], at.inputs.len(), count));
            self.law.ask().vary_at((When::Between, &place.point()), state, &inside.point(told), own, sum);
            inside.mark(sum.force, count);
            return inside.mark(sum.stored, count);
        };
        let Some((kept, _, inside)) = self.look(step, state) else {
            sum.force.fill(f64::NAN);
            return self.law.ask().pass(state);
        };
        let share = inside.clock.share(theta);
        let place = self.place(at, kept.xi + share * inside.clock.h, self.seen(at.inputs));
        let (of_step, of_point) = (
            self.told_step(step, &inside, around),
            self.told_inside(told.rate, told.inputs, (&[place.factor], at.inputs.len(), count)),
        );
        let told = PointVariation { step: Some(of_step.step(around)), ..of_point.point(told) };
        let inner = inside.step(step);
        self.law.ask().vary_at((When::Within(&inner, share), &place.point()), state, &told, own, sum);
        of_point.mark(sum.force, count);
        of_point.mark(sum.stored, count);
    }
}
