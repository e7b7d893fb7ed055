//! What every leaf answers.

use super::columns::ByColumns;
use super::jenkins::Jenkins;
use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::fractional::{KernelError, MemoryTangent};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use crate::law::told::Told;
use crate::law::variation::{
    ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError, VariationMut, VariationRef,
};
use num_complex::Complex64;

/// A function whose zeros are kinks of a force, at the start and at the nodes of a step.
pub type Guard = [f64; MAX_NODES + 1];

/// Whether a part of a network carries force: what stands behind it in a series is free where it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holds {
    /// It never gives any.
    Never,
    /// There are strokes at which it yields to every force.
    AtTimes,
    /// The same of a spring that is free at some strokes ([`Leaf::free`]) or of friction, which slides: in a series what is slack is theirs.
    LetsGo,
    /// Wherever it is.
    Always,
}

/// Which time a leaf is asked about.
#[derive(Debug, Clone, Copy)]
pub enum When<'a> {
    /// t_n + theta·h of a step, 0 < theta ≤ 1.
    Within(&'a Step<'a>, f64),
    /// Between two steps.
    Between,
}

/// Whose clock a leaf goes by, where temperature shifts the law that it is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// That of the material, which temperature shifts, as springpots and dashpots do; also of what follows no rate.
    Material,
    /// That of the wall: it follows its rate, and no temperature shifts it.
    Wall,
    /// Its own: something in it goes on by itself with time, such as the driver of a coil. No temperature shifts a law with that.
    Own,
}

/// A spring that is free at some strokes: F = k·(x − upper) above `upper`, k·(x − lower) below `lower`, 0 between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Free {
    /// Stiffness k > 0, N/m.
    pub stiffness: f64,
    /// Where it is free, m: from `lower` to `upper` > `lower`; an end that is infinite is none.
    pub lower: f64,
    /// See `lower`.
    pub upper: f64,
}

/// Friction that turns over about a rate: F = f·tanh(x'/v0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slide {
    /// f > 0, N.
    pub force: f64,
    /// v0 > 0, m/s.
    pub rate: f64,
}

/// A part of a law that gives a force by itself: linear or not, with or without memories and inner variables.
///
/// It is asked at the nodes of a step and nowhere else. Asking is pure and may be done any number of times; [`Leaf::commit`] is the only
/// change of its state, on accepted steps. What a leaf keeps is a share of the law's [`State`] whose size it declares: inner
/// variables (a slip, a temperature) are collocated by the leaf at the same nodes ([`crate::collocation::Nodes::inverse`]) and eliminated there,
/// so that to the outside it is a map from strokes and rates to forces. What is provided is that of a leaf that keeps nothing.
pub trait Leaf: Send + Sync + std::fmt::Debug {
    /// What it is called, with a number behind it, where nobody names it.
    fn name(&self) -> &'static str {
        "leaf"
    }

    /// What it keeps between steps.
    fn size(&self) -> StateSize {
        StateSize::default()
    }

    /// Appends its memories and inner variables as they are at t = 0, as many as [`Leaf::size`] says.
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be.
    fn begin(&self, _start: &Start, _state: &mut State) -> Result<(), KernelError> {
        Ok(())
    }

    /// Makes ready what does not change while a step is worked out; no answer changes.
    fn prepare(&self, _step: &Step, _state: StateMut) {}

    /// Adds its forces at the nodes and their tangents.
    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response);

    /// Adds ∂F_i/∂u_j for input `input`, u_j its value at node j: what a method asks for whose inputs follow from the state. A leaf that no input
    /// moves adds nothing.
    fn by_input(&self, _step: &Step, _state: StateRef, _input: usize, _slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {}

    /// Takes an accepted step into the state. With [`crate::collocation::Nodes::Midpoint`] what is known at the node is that of the middle of the
    /// step: an inner variable ends as far beyond it as it began before it.
    fn commit(&self, _step: &Step, _state: StateMut) {}

    /// Whether its state is known after a stroke that was periodic since ever: memories alone do that, inner variables by [`Leaf::recall`].
    fn recalls(&self) -> bool {
        self.is_linear()
    }

    /// Gives its inner variables what a stroke leaves that was periodic since ever: `turns` is where it turned round in the last period, in order, and at last
    /// x(0).
    fn recall(&self, _turns: &[f64], _variables: &mut [f64]) {}

    /// Puts what changes of its inner variables behind such a stroke, where the turns are these and change by these blocks.
    fn recall_variation(&self, turns: [&[f64]; 2], own: VariationMut) {
        if let Some(columns) = self.by_columns() {
            columns.recall(turns, own);
        }
    }

    /// Appends how well the step knows each of its memories and inner variables.
    fn local_errors(&self, _step: &Step, _state: StateRef, _errors: &mut Vec<LocalError>) {}

    /// Adds its energy flows at the start and at the nodes; zeros after a singular start.
    fn powers(&self, _step: &Step, _state: StateRef, _powers: &mut Powers) {}

    /// The leaf at t_n + theta·h, 0 < theta ≤ 1, where its exact kinematics are those of `at`.
    fn at(&self, _step: &Step, _theta: f64, at: &Point, state: StateRef) -> Observation {
        self.now(at, state)
    }

    /// The leaf between two steps, under the kinematics and inputs of `at`, which may have jumped since the last one.
    fn now(&self, at: &Point, state: StateRef) -> Observation;

    /// What it tells of itself beside stroke, force and energies, in the order of the columns.
    fn tells(&self) -> &'static [Told] {
        &[]
    }

    /// Hands over the values of [`Leaf::tells`], in that order.
    fn tell(&self, _when: When, _at: &Point, _state: StateRef, _take: &mut dyn FnMut(f64)) {}

    /// What it is like under small and fast strokes about `at`.
    fn linearised(&self, at: &Point) -> Term;

    /// What the parameter that its numbers and the inputs carry changes of coefficient and order of [`Leaf::linearised`]; `None` where that is not known.
    fn linearised_slope(&self, _at: &Point<Dual>) -> Option<Term> {
        let mut moves = false;
        let known = self.numbers(&mut |number| moves |= number.slope != 0.0);
        (known && !moves).then_some(Term { coefficient: 0.0, order: 0.0 })
    }

    /// K* = K' + iK'', N/m, of the first harmonic of its force under a sine of its stroke about that of `at` since ever, of this `amplitude`, m, at the rate
    /// `omega`, rad/s, where there is a formula. What is linear needs none, and what keeps nothing is integrated.
    fn harmonic(&self, _at: &Point, _amplitude: f64, _omega: f64) -> Option<Complex64> {
        None
    }

    /// The leaf at rest since ever at the stroke of `at`; `held` is x(0), from which Caputo's derivative counts.
    ///
    /// What is provided is that of a leaf that flows: no force remains, and small motions meet [`Leaf::linearised`].
    fn at_rest(&self, at: &Point, _held: f64) -> AtRest {
        let term = self.linearised(&Point { rate: 0.0, ..*at });
        AtRest { force: 0.0, stiffness: None, tangent: Tangent::Leaf(term, None) }
    }

    /// Whether it gives a force that grows with its stroke, or the rate of it, wherever it is: what may stand in a series by itself.
    fn holds(&self) -> Holds {
        let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
        if self.is_linear() && self.linearised(&at).coefficient == 0.0 { Holds::Never } else { Holds::Always }
    }

    /// The strokes at which it carries nothing, of a spring that has such: what lets it stand in a series ([`Holds::LetsGo`]), which gives it
    /// all that is slack.
    fn free(&self) -> Option<Free> {
        None
    }

    /// How it slides under the inputs, of friction: the other leaf that may stand in a series though it lets go.
    fn slides(&self, _inputs: &[InputValue]) -> Option<Slide> {
        None
    }

    /// Itself where it is a spring that slips, which is one with the springs behind it in a series, and takes what the others leave while it slips.
    fn slips(&self) -> Option<Jenkins> {
        None
    }

    /// Hands over functions whose zeros are kinks of its force, such as how far a stop is away, always as many in one order: steps
    /// end on them.
    fn guards(&self, _at: &Point, _take: &mut dyn FnMut(f64)) {}

    /// Whether its force may jump where one of its guards is zero: what follows then starts anew.
    fn jumps(&self) -> bool {
        false
    }

    /// Hands over functions of the stroke that pass zero where its force jumps, with what changes of them as the stroke and its own numbers do.
    fn jumps_at(&self, _stroke: Dual, _take: &mut dyn FnMut(Dual)) {}

    /// [`Leaf::guards`] at the start and at the nodes of a step: of a leaf whose kinks depend on its inner variables what they are there.
    fn guards_in(&self, step: &Step, _state: StateRef, guards: &mut Vec<Guard>) {
        let first = guards.len();
        self.guards(&step.point(0), &mut |value| guards.push([value; MAX_NODES + 1]));
        for k in 1..=step.nodes.count() {
            let mut own = guards[first..].iter_mut();
            self.guards(&step.point(k), &mut |value| own.next().into_iter().for_each(|guard| guard[k] = value));
        }
    }

    /// Whose clock it goes by.
    fn clock(&self) -> Clock {
        Clock::Material
    }

    /// F is an affine function of strokes and rates of a step.
    fn is_linear(&self) -> bool {
        false
    }

    /// s and order of the share s·t^−order of a singular start in F; `None` without one.
    fn singular(&self, _inputs: &[InputValue], _state: StateRef) -> Option<Term> {
        None
    }

    /// Itself, where its formulas are asked for derivatives ([`super::Columns`]): the questions about derivatives are answered by that.
    fn by_columns(&self) -> Option<&dyn ByColumns> {
        None
    }

    /// Hands over the numbers of its parameters, which carry derivatives where its law was built of such; false of a leaf of which no derivative
    /// is known: a law with it is refused where one is asked for.
    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        self.by_columns().map(|own| own.numbers(take)).is_some()
    }

    /// Appends how fast its inner variables change, where it is asked at one time: an input that jumps lets them turn there. `false`: that is not told.
    fn rates(&self, _at: &Point, _state: StateRef, _rates: &mut Vec<f64>) -> bool {
        self.size().variables == 0
    }

    /// Puts what changes of its state at t = 0, by its own numbers and by what is `told` of `at`; also again, where that was not all of it.
    fn begin_variation(&self, at: &Point, _state: StateRef, told: &PointVariation, own: VariationMut) {
        if let Some(columns) = self.by_columns() {
            columns.begin(at, told, own);
        }
    }

    /// Appends what changes of its memories where x(0) stays; [`Leaf::begin_variation`] tells what changes of that.
    ///
    /// # Errors
    /// [`KernelError`] where there is no derivative by its order.
    fn begin_memories(
        &self,
        _: StateRef,
        _own: VariationRef,
        _memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        Ok(())
    }

    /// Adds to `forces`, blocks of derivatives node by node, what changes of its forces where strokes and rates at the nodes stay: by its own
    /// numbers, by the start of the step, by what it keeps, and by its inputs. What the strokes and rates of `told` at the nodes change is
    /// [`Response::d_stroke`] and [`Response::d_rate`].
    fn vary(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        self.by_columns().into_iter().for_each(|columns| columns.vary(step, state, told, own, forces));
    }

    /// Takes what changes of an accepted step, which is not in the state yet, into what changes of the state.
    fn commit_variation(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationMut) {
        if let Some(columns) = self.by_columns() {
            columns.commit(step, state, told, own);
        }
    }

    /// Hands over how well the step knows what changes of its inner variables, in their order; nothing of those that follow exactly.
    fn vary_errors(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, take: TakeError) {
        self.by_columns().into_iter().for_each(|columns| columns.errors(step, state, told, own, take));
    }

    /// Adds what changes of its energy flows at the start and at the nodes ([`Leaf::powers`]), where strokes and rates change as told.
    fn vary_powers(
        &self,
        step: &Step,
        state: StateRef,
        told: &StepVariation,
        own: VariationRef,
        sum: &mut PowersVariation,
    ) {
        self.by_columns().into_iter().for_each(|columns| columns.powers(step, state, told, own, sum));
    }

    /// Adds what changes of it at one time ([`Leaf::at`], [`Leaf::now`]).
    fn vary_at(
        &self,
        when: When,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        self.by_columns().into_iter().for_each(|columns| columns.at(when, at, state, told, own, sum));
    }

    /// Adds what changes of [`Response::singular`] at the nodes of a step.
    fn vary_singular(&self, _: &Step, _: StateRef, _: &StepVariation, _: VariationRef, _forces: &mut [f64]) {}

    /// Adds what changes of the share of singular starts in F at the time of `at`, of its integral since `from`, and of the integral of that; the
    /// inputs count as those of `at`.
    fn vary_singularity(
        &self,
        _from: f64,
        _at: &Point,
        _: StateRef,
        _: &PointVariation,
        _: VariationRef,
        _sums: [&mut [f64]; 3],
    ) {
    }

    /// Rules over the inputs, to hold at every time.
    ///
    /// # Errors
    /// [`RuleError`] names the broken rule.
    fn check_inputs(&self, _inputs: &[InputValue]) -> Result<(), RuleError> {
        Ok(())
    }
}
