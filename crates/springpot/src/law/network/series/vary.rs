//! What parameters change of parts one behind the other.
//!
//! With δF_m = G_m δx_m + e_m of part m, e_m what changes of its force where its strokes at the nodes stay, Σ δx_m = δx gives
//! δF = (Σ C_m)⁻¹ (δx + Σ C_m e_m) and δx_m = C_m (δF − e_m), C_m = G_m⁻¹: the solve of the run about the strokes that it found, with a right side
//! for each parameter. Where a play is slack δF is 0 and the first of its parts takes what the others leave; of friction the rates are what
//! is looked for.

use super::asked::Asked;
use super::loose::Sought;
use super::solve::{Inner, Lines, Solved, invert, solve, times};
use super::{Matrix, Series, Settled, Values, is_near, vary_past, vary_start};
use crate::collocation::inner::TABLEAU_OF_FOUR;
use crate::collocation::{MAX_NODES, Nodes};
use crate::dual::Dual;
use crate::fractional::RatePolynomial;
use crate::law::leaf::When;
use crate::law::network::part::Part;
use crate::law::network::vary::Vary;
use crate::law::network::{MOST_IN_SERIES, Network};
use crate::law::past::{Recalled, RecalledVariation};
use crate::law::state::StateRef;
use crate::law::step::{Course, InputValue, Point, Power, Powers, Response, Step};
use crate::law::variation::{
    AtNodes, ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError, VariationMut,
    VariationRef, add,
};

/// What one parameter changes over a step: strokes and rates of the parts, and the force at the nodes of the parts.
#[derive(Debug, Clone, Default)]
struct Moved {
    inner: [Inner; MOST_IN_SERIES],
    force: [f64; MAX_NODES],
}

/// What all of them change, as the parts are told it.
struct Changes {
    moved: Vec<Moved>,
    nodes: usize,
    inputs: [Vec<f64>; 2],
    /// Of the time that has passed until the nodes.
    passed: Option<Vec<f64>>,
}

impl Changes {
    /// Blocks of stroke and rate of part `k` at the start and at the nodes.
    fn blocks(&self, k: usize) -> [Vec<f64>; 2] {
        let of = |values: fn(&Inner) -> &Values| {
            (0..=self.nodes).flat_map(|i| self.moved.iter().map(move |moved| values(&moved.inner[k])[i])).collect()
        };
        [of(|inner| &inner.stroke), of(|inner| &inner.rate)]
    }

    fn told<'a>(&'a self, [stroke, rate]: &'a [Vec<f64>; 2]) -> StepVariation<'a> {
        let inputs = self.inputs.each_ref().map(Vec::as_slice);
        StepVariation { count: self.moved.len(), stroke, rate, inputs, passed: self.passed.as_deref() }
    }
}

/// What the whole is asked about a step, and what comes of it.
struct Looked {
    asked: Asked,
    solved: Solved,
    changes: Changes,
    clock: Option<Clock>,
}

impl Looked {
    /// What changes of a quantity at the start and at the nodes of the parts, which is `values` there, at those of the whole, by parameter `p`.
    fn outer(&self, step: &Step, values: impl Fn() -> Values, changes: &Values, p: usize) -> Values {
        let mut outer = self.asked.outer(changes);
        if let Some(clock) = &self.clock {
            let count = clock.h.len();
            let [_, at_nodes @ ..] = values();
            for (i, theta) in step.positions().iter().enumerate() {
                outer[i + 1] += Asked::slope(&at_nodes, *theta) * clock.theta[i * count + p];
            }
        }
        outer
    }
}

/// What a clock that parameters move changes of a step: its nodes, as shares of it, and its size.
struct Clock {
    /// Of θ at the nodes, s blocks.
    theta: Vec<f64>,
    /// Of h, a block.
    h: Vec<f64>,
    /// Of θ at the place in it that is asked for, a block.
    here: Vec<f64>,
    /// x' over the step as the parts are told it.
    polynomial: RatePolynomial,
}

impl Clock {
    fn of(step: &Step, told: &StepVariation, asked: &Asked, until: Option<(f64, &PointVariation)>) -> Option<Self> {
        let (passed, count) = (told.passed?, told.count);
        let last = step.positions()[step.nodes.count() - 1];
        let h: Vec<f64> = passed[passed.len() - count..].iter().map(|own| own / last).collect();
        let moved = |own: f64, theta: f64, h: f64| (own - theta * h) / step.h;
        let of_node = |(own, theta): (&[f64], &f64)| -> Vec<f64> {
            own.iter().zip(&h).map(|(own, h)| moved(*own, *theta, *h)).collect()
        };
        let theta = passed.chunks_exact(count).zip(step.positions()).flat_map(of_node).collect();
        let here = until.map_or_else(Vec::new, |(theta, told)| {
            let own = told.passed.map_or_else(|| vec![0.0; count], <[f64]>::to_vec);
            own.iter().zip(&h).map(|(own, h)| moved(*own, theta, *h)).collect()
        });
        let polynomial = match (asked.is_of_strokes(), step.places) {
            (true, None) => RatePolynomial::through_strokes(step.h, step.nodes, step.stroke),
            (true, Some(places)) => RatePolynomial::through_strokes_at(step.h, places, step.stroke),
            (false, None) => RatePolynomial::through_rates(step.h, step.nodes, step.rate),
            (false, Some(places)) => RatePolynomial::through_rates_at(step.h, places, step.rate),
        };
        Some(Self { theta, h, here, polynomial })
    }

    /// Strokes, rates and inputs at the nodes as they change at these shares of the step, in units of its size; nothing of what is told of the nodes
    /// where these stay.
    fn at_shares(&self, step: &Step, told: &StepVariation, at_nodes: AtNodes) -> [Vec<f64>; 3] {
        let (count, inputs) = (told.count, step.inputs_at(0).len());
        let [mut stroke, mut rate, mut input] = [told.stroke.to_vec(), told.rate.to_vec(), told.inputs[0].to_vec()];
        if at_nodes == AtNodes::Still {
            stroke[count..].fill(0.0);
            rate[count..].fill(0.0);
        }
        for k in 0..=step.nodes.count() {
            let at = if k == 0 { 0.0 } else { step.positions()[k - 1] };
            for p in 0..count {
                let (theta, h) = (if k == 0 { 0.0 } else { self.theta[(k - 1) * count + p] }, self.h[p]);
                let block = k * count + p;
                stroke[block] -= step.h * self.polynomial.rate(at) * theta;
                let own = step.rate.get(k).copied().unwrap_or(0.0);
                rate[block] += own * h / step.h - step.h * self.polynomial.bend(at) * theta;
                for (i, value) in step.inputs_at(k).iter().enumerate() {
                    if let Some(input) = input.get_mut((k * inputs + i) * count + p) {
                        *input -= step.h * value.rate * theta;
                    }
                }
            }
        }
        [stroke, rate, input]
    }
}

/// Hands over the step whose strokes, rates and inputs are what parameter `p` changes of `step`: what is asked of a step is linear in them.
fn of_changes<R>(step: &Step, told: &StepVariation, p: usize, at_nodes: AtNodes, take: impl FnOnce(&Step) -> R) -> R {
    let column = told.column(step, p, at_nodes);
    let told = column.step(step);
    let [stroke, rate]: [Vec<f64>; 2] =
        [told.stroke, told.rate].map(|numbers| numbers.iter().map(|number| number.slope).collect());
    let inputs: Vec<InputValue> = told.inputs.iter().map(slopes).collect();
    take(&Step { stroke: &stroke, rate: &rate, inputs: &inputs, ..*step })
}

fn slopes(input: &InputValue<Dual>) -> InputValue {
    InputValue { value: input.value.slope, rate: input.rate.slope }
}

impl Series {
    /// What of the step, all of it or up to `until`, changes; leaves the state at the shares of the parts.
    fn look(
        &self,
        step: &Step,
        state: &mut StateRef,
        (told, at_nodes): (&StepVariation, AtNodes),
        until: Option<(f64, &Point, &PointVariation)>,
        own: VariationRef,
    ) -> Looked {
        let is_yielding = self.is_yielding(step);
        let ask = |step: &Step, until: Option<(f64, &Point)>| match until {
            Some((theta, at)) if theta < 1.0 => Asked::until(step, is_yielding, theta, at),
            _ => Asked::whole(step, is_yielding),
        };
        let ready = state.take_ready();
        let asked = ask(step, until.map(|(theta, at, _)| (theta, at)));
        let (strokes, _) = self.own(state);
        let solved = solve(self, &asked.step(step), strokes, ready, *state, Sought::Fit);
        let until_here = until.filter(|(theta, ..)| *theta < 1.0);
        let clock = Clock::of(step, told, &asked, until_here.map(|(theta, _, told)| (theta, told)));
        let at_shares = clock.as_ref().map(|clock| clock.at_shares(step, told, at_nodes));
        let (told, at_nodes) = match &at_shares {
            Some([stroke, rate, values]) => {
                (&StepVariation { stroke, rate, inputs: [values, told.inputs[1]], ..*told }, AtNodes::AsTold)
            }
            None => (told, at_nodes),
        };
        let column = |p: usize| {
            of_changes(step, told, p, at_nodes, |changes| {
                let inputs: Vec<InputValue> = until.map_or_else(Vec::new, |(_, at, told)| {
                    told.inputs_of(at, p, own.count).iter().map(slopes).collect()
                });
                let here = clock.as_ref().and_then(|clock| Some((clock, *clock.here.get(p)?)));
                let along = |theta: f64| here.map_or(0.0, |(clock, here)| step.h * clock.polynomial.rate(theta) * here);
                let at = until.map(|(theta, at, told)| {
                    let stroke = told.stroke[p] - along(theta);
                    (theta, Point { t: at.t, stroke, rate: told.rate[p], inputs: &inputs })
                });
                let mut asked = ask(changes, at.as_ref().map(|(theta, at)| (*theta, at)));
                if let Some((theta, ..)) = until_here {
                    // The places of the nodes move with the end.
                    for (stroke, c) in asked.stroke[1..].iter_mut().zip(asked.nodes.positions()) {
                        *stroke += c * along(theta * c);
                    }
                }
                let inputs = asked.step(changes).inputs.to_vec();
                (asked.stroke, inputs)
            })
        };
        let columns: Vec<(Values, Vec<InputValue>)> = (0..own.count).map(column).collect();
        let of_size = clock.as_ref().map(|clock| match until_here {
            Some((theta, ..)) => {
                clock.h.iter().zip(&clock.here).map(|(h, here)| theta * h + step.h * here).collect::<Vec<f64>>()
            }
            None => clock.h.clone(),
        });
        let changes = self.changes(&asked.step(step), &solved, &columns, of_size.as_deref(), *state, own);
        Looked { asked, solved, changes, clock }
    }

    /// What changes of the parts in a step as they are told it, where the stroke of the whole and the inputs change as the columns say.
    fn changes(
        &self,
        step: &Step,
        Solved { inner, force, tangent, .. }: &Solved,
        columns: &[(Values, Vec<InputValue>)],
        of_size: Option<&[f64]>,
        mut state: StateRef,
        mut own: VariationRef,
    ) -> Changes {
        let (count, nodes) = (own.count, step.nodes.count());
        let blocks = |of: fn(&InputValue) -> f64| -> Vec<f64> {
            let inputs = columns.first().map_or(0, |(_, inputs)| inputs.len());
            (0..inputs).flat_map(|i| columns.iter().map(move |(_, inputs)| of(&inputs[i]))).collect()
        };
        let inputs = [blocks(|input| input.value), blocks(|input| input.rate)];
        let mut lines = Lines::default();
        lines.look_exactly(self, inner, step, state);
        lines.turn(self, nodes);
        let passed: Option<Vec<f64>> = of_size.map(|of_size| {
            let of_node = |c: &f64| of_size.iter().map(|h| c * h).collect::<Vec<f64>>();
            step.nodes.positions().iter().flat_map(of_node).collect()
        });
        let starts = own.take(0, self.own_size());
        // What changes of each part where its strokes at the nodes stay, and the slopes of friction.
        let mut explicit: Vec<Vec<f64>> = Vec::with_capacity(self.parts.len());
        let slip = lines.slip(self, step, inner, state);
        let slipping = slip.map(|slip| slip.part);
        let mut steep = [0.0; MAX_NODES];
        let still = vec![0.0; (nodes + 1) * count];
        for (k, (part, inner)) in self.parts.iter().zip(inner).enumerate() {
            let (told, mut response) = (inner.step(step), Response::default());
            part.ask().evaluate(&told, &mut state.clone(), &mut response);
            let mut stroke = still.clone();
            stroke[..count].copy_from_slice(starts.variable(k));
            let changes = StepVariation {
                count,
                stroke: &stroke,
                rate: &still,
                inputs: inputs.each_ref().map(Vec::as_slice),
                passed: passed.as_deref(),
            };
            let mut forces = vec![0.0; nodes * count];
            part.ask().vary(&told, &mut state, &changes, &mut own, &mut forces);
            if self.slides(k) {
                (0..nodes).for_each(|i| steep[i] = response.d_rate[i][i]);
            } else {
                // Rates follow the stroke at the start.
                let mut by_start = Inner::default();
                by_start.stroke[0] = 1.0;
                by_start.take_rates(step.nodes, step.h);
                for (forces, by_rate) in forces.chunks_exact_mut(count).zip(response.d_rate) {
                    let follows: f64 = (0..nodes).map(|j| by_rate[j] * by_start.rate[j + 1]).sum();
                    add(forces, follows, starts.variable(k));
                    // And the size of the step.
                    let by_size: f64 = (0..nodes).map(|j| -by_rate[j] * inner.rate[j + 1] / step.h).sum();
                    of_size.into_iter().for_each(|of_size| add(forces, by_size, of_size));
                }
            }
            explicit.push(forces);
        }
        let carried: [bool; MAX_NODES] =
            std::array::from_fn(|i| i < nodes && (self.play().is_none() || force[i] != 0.0));
        let friction = (0..self.parts.len()).find(|&k| self.slides(k));
        let compliance = self.compliances(&lines, &carried, nodes);
        // What maps what is left for friction to its rates.
        let moved_by_rate = step.matrix().map(|row| row.map(|entry| step.h * entry));
        let slides = friction.map(|_| {
            let whole: Matrix = compliance.iter().fold(Matrix::default(), |sum, own| {
                std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + own[i][j]))
            });
            let mut system = Matrix::default();
            for i in 0..nodes {
                for j in 0..nodes {
                    system[i][j] = match carried[i] && carried[j] {
                        true => moved_by_rate[i][j] + whole[i][j] * steep[j],
                        false => f64::from(u8::from(i == j)),
                    };
                }
            }
            invert(&mut system, nodes, f64::MIN_POSITIVE);
            (whole, system)
        });
        let moved = |(p, (asked, _)): (usize, &(Values, Vec<InputValue>))| {
            let explicit_at = |k: usize| -> [f64; MAX_NODES] {
                std::array::from_fn(|i| if i < nodes { explicit[k][i * count + p] } else { 0.0 })
            };
            let mut moved = Moved::default();
            let mut left: [f64; MAX_NODES] = std::array::from_fn(|i| if i < nodes { asked[i + 1] } else { 0.0 });
            for k in (0..self.parts.len()).filter(|k| Some(*k) != friction && Some(*k) != slipping) {
                let longer = times(&compliance[k], &explicit_at(k));
                left.iter_mut().zip(longer).for_each(|(left, longer)| *left += longer);
            }
            let mut rates = [0.0; MAX_NODES];
            match (friction, &slides) {
                (Some(k), Some((whole, system))) => {
                    let own = explicit_at(k);
                    let held: [f64; MAX_NODES] = std::array::from_fn(|i| if carried[i] { own[i] } else { 0.0 });
                    let stretched = times(whole, &held);
                    let right: [f64; MAX_NODES] = std::array::from_fn(|i| match carried[i] {
                        true => left[i] - starts.variable(k)[p] - stretched[i],
                        false => 0.0,
                    });
                    rates = times(system, &right);
                    moved.force = std::array::from_fn(|i| steep[i] * rates[i] + held[i]);
                }
                // The tangent of what slips has no inverse.
                _ => match &slip {
                    Some(slip) => {
                        let (own, right) = (explicit_at(slip.part), times(&slip.stiffness, &left));
                        moved.force = times(&slip.system, &std::array::from_fn(|i| right[i] + own[i]));
                    }
                    None => moved.force = times(tangent, &left),
                },
            }
            (0..nodes).filter(|i| !carried[*i]).for_each(|i| moved.force[i] = 0.0);
            let first = self.play().map(super::Play::first);
            for k in 0..self.parts.len() {
                let own = explicit_at(k);
                let longer = times(&compliance[k], &std::array::from_fn(|i| moved.force[i] - own[i]));
                let slid = times(&moved_by_rate, &rates);
                let start = starts.variable(k)[p];
                moved.inner[k].stroke[0] = start;
                for i in 0..nodes {
                    moved.inner[k].stroke[i + 1] = if Some(k) == friction { start + slid[i] } else { longer[i] };
                }
            }
            if let Some(slip) = &slip {
                let taken = times(&slip.others, &moved.force);
                (0..nodes).for_each(|i| moved.inner[slip.part].stroke[i + 1] = left[i] - taken[i]);
            }
            // What is slack takes what the others leave.
            if let Some(first) = first {
                for i in (0..nodes).filter(|i| !carried[*i]) {
                    let others = (0..self.parts.len()).filter(|k| *k != first);
                    moved.inner[first].stroke[i + 1] =
                        asked[i + 1] - others.map(|k| moved.inner[k].stroke[i + 1]).sum::<f64>();
                }
            }
            for (moved, inner) in moved.inner.iter_mut().zip(inner).take(self.parts.len()) {
                moved.take_rates(step.nodes, step.h);
                let shorter = of_size.map_or(0.0, |of_size| of_size[p] / step.h);
                moved.rate.iter_mut().zip(inner.rate).for_each(|(moved, rate)| *moved -= shorter * rate);
            }
            if friction.is_some() && of_size.is_some_and(|of_size| of_size[p] != 0.0) {
                // How what slides goes on by another clock is not known.
                moved.force.fill(f64::NAN);
                moved.inner.iter_mut().for_each(|inner| inner.stroke.fill(f64::NAN));
            }
            if let Some(k) = friction {
                moved.inner[k].rate[1..=nodes].copy_from_slice(&rates[..nodes]);
            }
            moved
        };
        Changes { moved: columns.iter().enumerate().map(moved).collect(), nodes, inputs, passed }
    }

    /// C of each part; of a play where it carries, of friction none.
    fn compliances(&self, lines: &Lines, carried: &[bool; MAX_NODES], nodes: usize) -> Vec<Matrix> {
        let of = |k: usize| match self.play() {
            _ if self.slides(k) => Matrix::default(),
            Some(play) if play.has(k) => {
                let mut own = Matrix::default();
                (0..nodes).filter(|i| carried[*i]).for_each(|i| own[i][i] = play.stiffness_of(k).recip());
                own
            }
            _ => lines.compliance(k),
        };
        (0..self.parts.len()).map(of).collect()
    }

    /// What changes between two steps of the force, and of the rates of the parts; the state is at their shares.
    fn change_now(
        &self,
        at: &Point,
        strokes: &[f64],
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
    ) -> (Vec<f64>, Vec<[f64; MOST_IN_SERIES]>) {
        let Settled { rates, lines, follows, is_slack, .. } = self.settle(at, strokes, state);
        let (count, mut of_parts) = (own.count, own);
        let starts = of_parts.take(0, self.own_size());
        let [still, one] = [vec![0.0; count], vec![1.0; count]];
        let (mut explicit, mut slopes) = (vec![vec![0.0; count]; self.parts.len()], [0.0; MOST_IN_SERIES]);
        let mut behind = state;
        for (k, part) in self.parts.iter().enumerate() {
            let inside = Point { stroke: strokes[k], rate: rates[k], ..*at };
            let ask = |rate: &[f64], force: &mut Vec<f64>| {
                let (mut state, mut own) = (behind, of_parts);
                let (told, mut spare) =
                    (PointVariation { stroke: starts.variable(k), rate, step: None, ..*told }, vec![0.0; count]);
                let mut unused = vec![0.0; count];
                let told_there = &mut Vec::new();
                let mut sum = ObservationVariation {
                    force,
                    stored: &mut spare,
                    derivative: &mut unused,
                    told: told_there,
                    leaves: None,
                };
                part.ask().vary_at((When::Between, &inside), &mut state, &told, &mut own, &mut sum);
                (state, own)
            };
            let (next, own) = ask(&still, &mut explicit[k]);
            slopes[k] = lines[k][1];
            if slopes[k] != 0.0 && !part.is_linear() {
                let mut moving = vec![0.0; count];
                ask(&one, &mut moving);
                slopes[k] = moving[0] - explicit[k][0];
            }
            (behind, of_parts) = (next, own);
        }
        let yields = |k: &usize| slopes[*k] != 0.0;
        let compliance: f64 = (0..self.parts.len()).filter(yields).map(|k| slopes[k].recip()).sum();
        let column = |p: usize| {
            let force = match follows {
                Some(_) if is_slack => 0.0,
                Some(k) => explicit[k][p],
                None => {
                    let owed: f64 = (0..self.parts.len()).filter(yields).map(|k| explicit[k][p] / slopes[k]).sum();
                    (told.rate[p] + owed) / compliance
                }
            };
            let rate =
                |k: usize| if k < self.parts.len() && yields(&k) { (force - explicit[k][p]) / slopes[k] } else { 0.0 };
            (force, std::array::from_fn(rate))
        };
        (0..count).map(column).unzip()
    }

    /// As [`Part::vary_at`] between two steps, but of all but the force.
    fn rest_now(
        &self,
        at: &Point,
        strokes: &[f64],
        state: &mut StateRef,
        told: &PointVariation,
        own: VariationRef,
        (rates, sum): (&[[f64; MOST_IN_SERIES]], &mut ObservationVariation),
    ) {
        let settled = self.settle(at, strokes, *state);
        let (count, mut of_parts) = (own.count, own);
        let starts = of_parts.take(0, self.own_size());
        for (k, part) in self.parts.iter().enumerate() {
            let rate: Vec<f64> = rates.iter().map(|rates| rates[k]).collect();
            let told = PointVariation { stroke: starts.variable(k), rate: &rate, step: None, ..*told };
            let inside = Point { stroke: strokes[k], rate: settled.rates[k], ..*at };
            let mut spare = vec![0.0; count];
            let ObservationVariation { stored, derivative, told: tells, leaves, .. } = &mut *sum;
            let leaves = leaves.as_deref_mut();
            let mut sum = ObservationVariation { force: &mut spare, stored, derivative, told: tells, leaves };
            part.ask().vary_at((When::Between, &inside), state, &told, &mut of_parts, &mut sum);
        }
    }

    /// What changes of the force at θ where that is the polynomial through that at the start and at the nodes.
    fn change_between(
        &self,
        step: &Step,
        (theta, here): (f64, Option<&[f64]>),
        mut state: StateRef,
        told: &StepVariation,
        own: VariationRef,
    ) -> Vec<f64> {
        let before = state;
        let mut behind = state;
        behind.take_ready();
        let (strokes, _) = self.own(&mut behind);
        let (at, count) = (step.point(0), own.count);
        let of_start = PointVariation {
            stroke: told.stroke_at(0),
            rate: told.rate_at(0),
            inputs: told.inputs.map(|blocks| blocks.get(..at.inputs.len() * count).unwrap_or_default()),
            step: None,
            passed: None,
        };
        let (start, _) = self.change_now(&at, strokes, behind, &of_start, own);
        let looked = self.look(step, &mut state, (told, AtNodes::AsTold), None, own);
        let through = |start: f64, force: &[f64; MAX_NODES]| {
            let values = [start, force[0], force[1], force[2], force[3]];
            TABLEAU_OF_FOUR.values.map(|row| row.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>())
        };
        // How the force itself goes on there, where the clock moves the place.
        let along = here.filter(|_| looked.clock.is_some()).map_or(0.0, |_| {
            let first = self.now(&at, &mut before.clone(), &mut |_| ()).observation.regular;
            let [_, rows @ ..] = through(first, &looked.solved.force);
            rows.iter().enumerate().rev().fold(0.0, |sum, (p, row)| sum * theta + (p + 1) as f64 * row)
        });
        let at_theta = |(p, (start, Moved { force, .. })): (usize, (f64, &Moved))| {
            let value = through(start, force).iter().rev().fold(0.0, |sum, row| sum * theta + row);
            let moved =
                here.zip(looked.clock.as_ref()).map_or(0.0, |(here, clock)| (here[p] - theta * clock.h[p]) / step.h);
            value + along * moved
        };
        start.into_iter().zip(&looked.changes.moved).enumerate().map(at_theta).collect()
    }
}

impl Vary for Series {
    /// Of several that slide one alone can be looked for.
    fn without_derivatives(&self) -> Option<String> {
        if (0..self.parts.len()).filter(|k| self.slides(*k)).count() > 1 {
            return Some("friction in series with friction".to_owned());
        }
        if self.loose.is_some() && (0..self.parts.len()).any(|k| self.slips(k).is_some()) {
            return Some("a spring that slips in series with what lets go".to_owned());
        }
        self.parts.iter().find_map(|part| part.ask().without_derivatives())
    }

    fn begin_variation(&self, at: &Point, state: &mut StateRef, told: &PointVariation, own: &mut VariationMut) {
        vary_start::begin(self, at, state, told, own);
    }

    fn recall_variation(
        &self,
        stroke: (&Recalled, &RecalledVariation),
        at: (&Point, &PointVariation),
        laws: &[&Network],
        state: &mut StateRef,
        own: &mut VariationMut,
    ) -> Result<(), String> {
        vary_past::recall(self, stroke, at, laws, state, own)
    }

    /// Iterations take what slips for a soft spring.
    fn evaluate_exactly(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        let (asked, Solved { inner, force, mut tangent, .. }) = self.solved(step, state, Sought::Fit);
        if self.loose.is_none() && self.slips_inside() {
            let mut lines = Lines::default();
            let step = &asked.step(step);
            lines.look_exactly(self, &inner, step, *state);
            lines.turn(self, step.nodes.count());
            tangent = lines.slip(self, step, &inner, *state).map_or(lines.tangent(), |slip| slip.tangent);
        }
        self.parts.iter().for_each(|part| part.ask().pass(state));
        asked.respond(&force, &tangent, response);
    }

    fn slips_inside(&self) -> bool {
        (0..self.parts.len()).any(|k| self.slips(k).is_some())
            || self.parts.iter().any(|part| part.ask().slips_inside())
    }

    /// Of inner strokes nothing is told.
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
        let share = own.take(self.number_count(), self.size());
        let looked = self.look(step, state, (told, AtNodes::Still), None, share);
        self.parts.iter().for_each(|part| part.ask().pass(state));
        let at_nodes = |[a, b, c, d]: [f64; MAX_NODES]| [0.0, a, b, c, d];
        for (p, Moved { force, .. }) in looked.changes.moved.iter().enumerate() {
            let outer = looked.outer(step, || at_nodes(looked.solved.force), &at_nodes(*force), p);
            for (forces, outer) in forces.chunks_exact_mut(share.count).zip(&outer[1..]) {
                forces[p] += outer;
            }
        }
    }

    fn commit_variation(&self, step: &Step, state: &mut StateRef, told: &StepVariation, own: &mut VariationMut) {
        let mut share = own.take(self.number_count(), self.size());
        let count = share.count;
        let Looked { asked, solved, changes, .. } = self.look(step, state, (told, AtNodes::AsTold), None, share.view());
        let (step, strokes) = (asked.step(step), share.take(0, self.own_size()).variables);
        for (k, (part, inner)) in self.parts.iter().zip(&solved.inner).enumerate() {
            let blocks = changes.blocks(k);
            part.ask().commit_variation(&inner.step(&step), state, &changes.told(&blocks), &mut share);
            for (own, Moved { inner, .. }) in strokes[k * count..(k + 1) * count].iter_mut().zip(&changes.moved) {
                let values = &inner[k].stroke;
                *own = match step.nodes {
                    Nodes::Midpoint => 2.0 * values[1] - values[0],
                    nodes => values[nodes.count()],
                };
            }
        }
    }

    /// Strokes inside are known as their forces are: the steps of those suffice.
    fn vary_errors(&self, _: &Step, state: &mut StateRef, _: &StepVariation, own: &mut VariationRef, _: TakeError) {
        self.pass_by(state, own);
    }

    fn vary_powers(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        sum: &mut PowersVariation,
    ) {
        let mut share = own.take(self.number_count(), self.size());
        let count = share.count;
        let looked = self.look(step, state, (told, AtNodes::AsTold), None, share);
        let Looked { asked, solved, changes, clock } = &looked;
        share.take(0, self.own_size());
        let (outer_nodes, outer_step) = (step.nodes.count(), step);
        let (step, behind) = (asked.step(step), *state);
        let mut inside = [(); 2].map(|()| vec![0.0; (step.nodes.count() + 1) * count]);
        for (k, (part, inner)) in self.parts.iter().zip(&solved.inner).enumerate() {
            let (blocks, [dissipation, input]) = (changes.blocks(k), &mut inside);
            let mut sum = PowersVariation { dissipation, input };
            part.ask().vary_powers(&inner.step(&step), state, &changes.told(&blocks), &mut share, &mut sum);
        }
        let mut powers = Powers::default();
        if clock.is_some() {
            let mut behind = behind;
            for (part, inner) in self.parts.iter().zip(&solved.inner) {
                part.ask().powers(&inner.step(&step), &mut behind, &mut powers);
            }
        }
        let own: [fn(&Power) -> f64; 2] = [|power| power.dissipation, |power| power.input];
        for ((sum, inside), own) in [&mut *sum.dissipation, &mut *sum.input].into_iter().zip(&inside).zip(own) {
            for p in 0..count {
                let mut values = Values::default();
                values.iter_mut().zip(inside.iter().skip(p).step_by(count)).for_each(|(value, own)| *value = *own);
                let outer = looked.outer(outer_step, || powers.each_ref().map(own), &values, p);
                (0..=outer_nodes).for_each(|k| sum[k * count + p] += outer[k]);
            }
        }
    }

    /// What is singular inside is no share of the force of its own.
    fn vary_singular(&self, _: &Step, state: &mut StateRef, _: &StepVariation, own: &mut VariationRef, _: &mut [f64]) {
        self.pass(state);
        own.take(self.number_count(), self.size());
    }

    fn vary_singularity(
        &self,
        _: (f64, &Point),
        state: &mut StateRef,
        _: &PointVariation,
        own: &mut VariationRef,
        _: [&mut [f64]; 3],
    ) {
        self.pass(state);
        own.take(self.number_count(), self.size());
    }

    fn vary_at(
        &self,
        (when, at): (When, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let share = own.take(self.number_count(), self.size());
        let within = match (when, &told.step) {
            (When::Within(step, theta), Some(around)) => Some((step, theta, around)),
            _ => None,
        };
        let Some((step, theta, around)) = within.filter(|(step, theta, _)| !is_near(step, *theta)) else {
            let force = within
                .map(|(step, theta, around)| self.change_between(step, (theta, told.passed), *state, around, share));
            state.take_ready();
            let (strokes, _) = self.own(state);
            let (now, rates) = self.change_now(at, strokes, *state, told, share);
            add(sum.force, 1.0, force.as_ref().unwrap_or(&now));
            return self.rest_now(at, strokes, state, told, share, (&rates, sum));
        };
        let is_between = theta < 1.0 && step.nodes == Nodes::Radau && step.course == Course::Sought;
        let between = is_between.then(|| {
            let changes = self.change_between(step, (theta, told.passed), *state, around, share);
            (self.between(step, theta, *state), changes)
        });
        let Looked { asked, solved, changes, .. } =
            self.look(step, state, (around, AtNodes::AsTold), Some((theta, at, told)), share);
        let mut of_parts = share;
        of_parts.take(0, self.own_size());
        let (step, last) = (asked.step(step), asked.nodes.count());
        for (k, (part, inner)) in self.parts.iter().zip(&solved.inner).enumerate() {
            let blocks = changes.blocks(k);
            let end = last * share.count..;
            let inside = Point { stroke: inner.stroke[last], rate: inner.rate[last], ..*at };
            let of_part = PointVariation {
                stroke: &blocks[0][end.clone()],
                rate: &blocks[1][end],
                inputs: told.inputs,
                step: Some(changes.told(&blocks)),
                passed: changes.passed.as_ref().map(|passed| &passed[(last - 1) * share.count..]),
            };
            let mut spare = vec![0.0; share.count];
            let ObservationVariation { stored, derivative, told, leaves, .. } = &mut *sum;
            let leaves = leaves.as_deref_mut();
            let mut sum = ObservationVariation { force: &mut spare, stored, derivative, told, leaves };
            let when = (When::Within(&inner.step(&step), 1.0), &inside);
            part.ask().vary_at(when, state, &of_part, &mut of_parts, &mut sum);
        }
        let is_beyond = |known: f64| match (self.play(), solved.side) {
            (None, _) => false,
            (Some(_), side) => side == 0 || f64::from(side) * known < 0.0,
        };
        match between {
            Some((known, changes)) if !is_beyond(known) => add(sum.force, 1.0, &changes),
            _ => {
                let ends = changes.moved.iter().map(|moved| moved.force[last - 1]);
                sum.force.iter_mut().zip(ends).for_each(|(sum, end)| *sum += end);
            }
        }
    }
}
