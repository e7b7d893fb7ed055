//! Leaves whose formulas are asked for numbers, and for numbers with their derivatives.

use super::contract::{Leaf, When};
use super::hysteresis::Values;
use crate::dual::{Dual, Real};
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Power, Powers, Step};
use crate::law::variation::{
    AtNodes, ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError, VariationError,
    VariationMut, VariationRef,
};

/// A leaf whose formulas are written over [`Real`]: asked with numbers they give its forces, asked with [`Dual`]s what one parameter changes of
/// them. [`Leaf::by_columns`] tells of it.
///
/// What it finds by an iteration is found with numbers; what changes of that follows by one more step of Newton's method, whose matrix is known.
/// At a kink the derivative is that of the branch taken.
pub trait Columns: Leaf + Clone {
    /// A step worked out.
    type Solved<T: Real>;

    /// Hands over its numbers, always in the same order.
    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual));

    /// Hands over its inner variables at t = 0, as many as [`Leaf::size`] says.
    fn at_start<T: Real>(&self, _at: &Point<T>, _take: &mut dyn FnMut(T)) {}

    /// Hands over its inner variables behind a periodic stroke that turned round there ([`Leaf::recall`]).
    fn after_turns<T: Real>(&self, _turns: &[T], _take: &mut dyn FnMut(T)) {}

    /// Works out a step from the inner variables at its start.
    fn solved(&self, step: &Step, start: &[f64]) -> Self::Solved<f64>;

    /// The same with derivatives, `found` with numbers.
    fn follow(&self, step: &Step<Dual>, start: &[Dual], found: &Self::Solved<f64>) -> Self::Solved<Dual>;

    /// F at node `k`, from 1 on.
    fn force<T: Real>(&self, step: &Step<T>, solved: &Self::Solved<T>, k: usize) -> T;

    /// Energy flows at the start (0) or at node `k`.
    fn power<T: Real>(&self, step: &Step<T>, start: &[T], solved: &Self::Solved<T>, k: usize) -> Power<T>;

    /// Hands over its inner variables at the end of the step.
    fn at_end<T: Real>(&self, _step: &Step<T>, _start: &[T], _solved: &Self::Solved<T>, _take: &mut dyn FnMut(T)) {}

    /// Hands over its inner variables at the end of the step, and how fast they change at its start and at the nodes, where a formula says so.
    fn each_rate<T: Real>(
        &self,
        _step: &Step<T>,
        _start: &[T],
        _solved: &Self::Solved<T>,
        _take: &mut dyn FnMut(T, Values<T>),
    ) {
    }

    /// The leaf at t_n + theta·h.
    fn within<T: Real>(
        &self,
        _step: &Step<T>,
        _theta: f64,
        at: &Point<T>,
        start: &[T],
        _solved: &Self::Solved<T>,
    ) -> Observation<T> {
        self.between(at, start)
    }

    /// The leaf between two steps.
    fn between<T: Real>(&self, at: &Point<T>, variables: &[T]) -> Observation<T>;

    /// Hands over what it tells of itself ([`Leaf::tells`]): from the inner variables at the start of the step that `within` is in at θ, or between two.
    fn told<T: Real>(
        &self,
        _within: Option<(&Step<T>, f64, &Self::Solved<T>)>,
        _at: &Point<T>,
        _variables: &[T],
        _take: &mut dyn FnMut(T),
    ) {
    }
}

/// Adds what a leaf without inner variables dissipates at the start and at the nodes.
pub(super) fn add_dissipation<L: Columns<Solved<f64> = ()>>(leaf: &L, step: &Step, powers: &mut Powers) {
    for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
        power.dissipation += leaf.power(step, &[], &(), k).dissipation;
    }
}

/// What a leaf with [`Columns`] tells of its derivatives.
pub trait ByColumns {
    /// [`Leaf::numbers`].
    fn numbers(&self, take: &mut dyn FnMut(Dual));

    /// [`Leaf::begin_variation`].
    fn begin(&self, at: &Point, told: &PointVariation, own: VariationMut);

    /// [`Leaf::recall_variation`].
    fn recall(&self, turns: [&[f64]; 2], own: VariationMut);

    /// [`Leaf::vary`].
    fn vary(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]);

    /// [`Leaf::commit_variation`].
    fn commit(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationMut);

    /// [`Leaf::vary_powers`].
    fn powers(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, sum: &mut PowersVariation);

    /// [`Leaf::vary_errors`].
    fn errors(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, take: TakeError);

    /// [`Leaf::vary_at`].
    fn at(
        &self,
        when: When,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    );
}

impl<L: Columns> ByColumns for L {
    fn numbers(&self, take: &mut dyn FnMut(Dual)) {
        self.clone().each_number(&mut |number| take(*number));
    }

    fn begin(&self, at: &Point, told: &PointVariation, own: VariationMut) {
        for p in 0..own.count {
            let (leaf, _) = column(self, &own.view(), p);
            let inputs = told.inputs_of(at, p, own.count);
            let stroke = Dual { value: at.stroke, slope: told.stroke[p] };
            let mut variables = own.variables.iter_mut().skip(p).step_by(own.count);
            leaf.at_start(&Point { t: 0.0, stroke, rate: Dual::default(), inputs: &inputs }, &mut |variable: Dual| {
                variables.next().into_iter().for_each(|own| *own = variable.slope);
            });
        }
    }

    fn recall(&self, [turns, changes]: [&[f64]; 2], own: VariationMut) {
        for p in 0..own.count {
            let (leaf, _) = column(self, &own.view(), p);
            let of_turns = changes.iter().skip(p).step_by(own.count);
            let turns: Vec<Dual> = turns.iter().zip(of_turns).map(|(&value, &slope)| Dual { value, slope }).collect();
            let mut variables = own.variables.iter_mut().skip(p).step_by(own.count);
            leaf.after_turns(&turns, &mut |variable: Dual| {
                variables.next().into_iter().for_each(|own| *own = variable.slope);
            });
        }
    }

    fn vary(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        each(self, (step, AtNodes::Still, &|_| false), state, told, &own, &mut |p, leaf, step, _, solved| {
            for (i, forces) in forces.chunks_exact_mut(own.count).enumerate() {
                forces[p] += leaf.force(step, solved, i + 1).slope;
            }
        });
        lose(self, told, forces);
    }

    fn commit(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationMut) {
        let VariationMut { count, numbers, variables, .. } = own;
        let before = variables.to_vec();
        let own = VariationRef { count, numbers, memories: &[], variables: &before };
        variables.fill(0.0);
        each(self, (step, AtNodes::AsTold, &|_| false), state, told, &own, &mut |p, leaf, step, start, solved| {
            let mut variables = variables.iter_mut().skip(p).step_by(count);
            leaf.at_end(step, start, solved, &mut |variable: Dual| {
                variables.next().into_iter().for_each(|own| *own = variable.slope);
            });
        });
        lose(self, told, variables);
    }

    fn powers(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, sum: &mut PowersVariation) {
        each(self, (step, AtNodes::AsTold, &|_| false), state, told, &own, &mut |p, leaf, step, start, solved| {
            for k in 0..=step.nodes.count() {
                let power = leaf.power(step, start, solved, k);
                sum.dissipation[k * own.count + p] += power.dissipation.slope;
                sum.input[k * own.count + p] += power.input.slope;
            }
        });
        lose(self, told, sum.dissipation);
        lose(self, told, sum.input);
    }

    fn errors(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, take: TakeError) {
        each(self, (step, AtNodes::AsTold, &|_| false), state, told, &own, &mut |p, leaf, dual, start, solved| {
            let mut variable = 0..;
            leaf.each_rate(dual, start, solved, &mut |end: Dual, rates: Values<Dual>| {
                let changes = rates.map(|rate| rate.slope);
                let fastest = rates.iter().fold(0.0f64, |fastest, rate| fastest.max(rate.value.abs()));
                let error = VariationError {
                    parameter: p,
                    error: step.h * step.quadrature_defect(&changes),
                    change: end.slope.abs(),
                    coming: step.h * changes.iter().fold(0.0f64, |fastest, rate| fastest.max(rate.abs())),
                    size: end.value.abs() + step.h * fastest,
                };
                variable.next().into_iter().for_each(|k| take(k, error));
            });
        });
    }

    fn at(
        &self,
        when: When,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let first = sum.told.len();
        sum.told.resize(first + self.tells().len() * own.count, 0.0);
        let ObservationVariation { force, stored, told: tells, .. } = sum;
        let mut add = |p: usize, observation: Observation<Dual>| {
            force[p] += observation.regular.slope;
            stored[p] += observation.stored.map_or(f64::NAN, |stored| stored.slope);
        };
        let moving = |p: usize| {
            let stroke = Dual { value: at.stroke, slope: told.stroke[p] };
            (stroke, Dual { value: at.rate, slope: told.rate[p] }, told.inputs_of(at, p, own.count))
        };
        let moves_here = |p: usize| {
            let of_inputs = told.inputs.iter().flat_map(|blocks| blocks.iter().skip(p).step_by(own.count.max(1)));
            told.stroke[p] != 0.0 || told.rate[p] != 0.0 || of_inputs.into_iter().any(|change| *change != 0.0)
        };
        match (when, &told.step) {
            (When::Within(step, theta), Some(around)) => {
                each(
                    self,
                    (step, AtNodes::AsTold, &moves_here),
                    state,
                    around,
                    &own,
                    &mut |p, leaf, step, start, solved| {
                        let (stroke, rate, inputs) = moving(p);
                        let at = Point { t: at.t, stroke, rate, inputs: &inputs };
                        add(p, leaf.within(step, theta, &at, start, solved));
                        tell(&mut tells[first..], (p, own.count), |take| {
                            leaf.told(Some((step, theta, solved)), &at, start, take)
                        });
                    },
                );
            }
            _ => {
                for p in 0..own.count {
                    let (leaf, _) = column(self, &own, p);
                    let (stroke, rate, inputs) = moving(p);
                    let at = Point { t: at.t, stroke, rate, inputs: &inputs };
                    let variables = variables(state.variables, &own, p);
                    add(p, leaf.between(&at, &variables));
                    tell(&mut tells[first..], (p, own.count), |take| leaf.told(None, &at, &variables, take));
                }
            }
        }
    }
}

/// Puts what a leaf tells of itself into column `p` of blocks of `count`.
fn tell(blocks: &mut [f64], (p, count): (usize, usize), told: impl FnOnce(&mut dyn FnMut(Dual))) {
    let mut places = blocks.iter_mut().skip(p).step_by(count);
    told(&mut |value: Dual| places.next().into_iter().for_each(|own| *own = value.slope));
}

/// Of inner variables nothing is known where a parameter moves the clock.
fn lose(leaf: &dyn Leaf, told: &StepVariation, blocks: &mut [f64]) {
    // What slips follows from strokes alone.
    if leaf.size().variables > 0 && leaf.slips().is_none() {
        for p in told.moves_clock() {
            blocks.iter_mut().skip(p).step_by(told.count).for_each(|block| *block = f64::NAN);
        }
    }
}

/// Hands over every column in which something changes, in the step or beside it: its parameter, the leaf, the step, its inner variables at the start, and the step worked
/// out.
#[allow(clippy::type_complexity)]
fn each<L: Columns>(
    leaf: &L,
    (step, at_nodes, moves_beside): (&Step, AtNodes, &dyn Fn(usize) -> bool),
    state: StateRef,
    told: &StepVariation,
    own: &VariationRef,
    take: &mut dyn FnMut(usize, &L, &Step<Dual>, &[Dual], &L::Solved<Dual>),
) {
    let mut found = None;
    for p in 0..own.count {
        let (of_column, is_still) = column(leaf, own, p);
        let (told, start) = (told.column(step, p, at_nodes), variables(state.variables, own, p));
        if is_still && told.is_still() && !moves_beside(p) && start.iter().all(|variable| variable.slope == 0.0) {
            continue;
        }
        let found = found.get_or_insert_with(|| leaf.solved(step, state.variables));
        let step = told.step(step);
        take(p, &of_column, &step, &start, &of_column.follow(&step, &start, found));
    }
}

/// The leaf whose numbers change as parameter `p` has them; whether none does.
fn column<L: Columns>(leaf: &L, own: &VariationRef, p: usize) -> (L, bool) {
    let (mut leaf, mut is_still) = (leaf.clone(), true);
    let mut blocks = own.numbers.chunks_exact(own.count);
    leaf.each_number(&mut |number| {
        number.slope = blocks.next().map_or(0.0, |block| block[p]);
        is_still &= number.slope == 0.0;
    });
    (leaf, is_still)
}

/// Its inner variables as parameter `p` has them.
fn variables(values: &[f64], own: &VariationRef, p: usize) -> Vec<Dual> {
    let of = |(k, value): (usize, &f64)| Dual { value: *value, slope: own.variable(k)[p] };
    values.iter().enumerate().map(of).collect()
}
