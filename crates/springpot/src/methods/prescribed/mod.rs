//! Kinematics given in advance: every step is evaluated where the motion is.
//!
//! Inner steps are chosen for the memories and for the energy ledger, whose works are quadratures over two steps where nothing jumps between them. Steps end on break points and kinks of the signals, where joints
//! turn round against friction that sticks, and where forces of elements have kinks.

mod reversal;
mod works;

use self::works::{Before, Quadrature};
use crate::account::ledger::NodePower;
use crate::account::recorder::balance::Allowed;
use crate::account::recorder::{Recorder, StepPowers};
use crate::collocation::{Nodes, RADAU_NODES, RADAU_WEIGHTS, STAGES};
use crate::elements::NoDirection;
use crate::equations::Node;
use crate::equations::context::Context;
use crate::equations::evaluate::Evaluation;
use crate::equations::kinks::Seen;
use crate::equations::{Change, Equations, Look, Scale, on_grid};
use crate::equations::{TANGENTS, Variation};
use crate::fractional::{Form, RatePolynomial};
use crate::methods::stepper::{Behind, Stepper, Target, Trial};
use crate::motion::Trajectory;
use crate::signal::Agenda;
use crate::system::error::RunError;
use crate::system::jump::refuse_jumps;
use crate::system::settings::Settings;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The longest inner step is this share of the motion, so that nothing in it is stepped over.
const LONGEST_STEP: f64 = 1.0 / 500.0;

/// The first inner step is this share of the longest.
const FIRST_STEP: f64 = 1.0 / 64.0;

/// Where rows come before its end, it is this share of the time of the first of them: energies within a first step are told by powers that rise there
/// like no polynomial.
const BEFORE_ROWS: f64 = 1.0 / 16.0;

/// And so much shorter where memories in series begin with a jump: what is inside bends there alike on every scale of time, and estimates of the
/// first step miss what it errs by.
const BEHIND_JUMP: f64 = 1e-5;

/// Shortest step as a share of the motion.
const SHORTEST_STEP: f64 = 1e-13;

/// Steps that shrink to nothing this near the end of what the gripper can reach shrink because of it; share of the motion.
const NEAR: f64 = 1e-3;

/// A step that is shorter by 0.7 leaves less than this share where the motion is smooth.
const SHRINKS: f64 = 0.5;

/// Rounding of a stroke, in units of its largest value: signals that begin at nothing are differences of what is that large.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// How the estimate of the energies falls with the step: that of the third difference, and that of the sixth.
const THIRD: f64 = 4.0;
const SIXTH: f64 = 7.0;

/// Steps along a trajectory.
#[derive(Debug)]
pub(crate) struct Prescribed {
    trajectory: Arc<Trajectory>,
    /// A lower bound of the energy turned over, estimated beforehand.
    energy_floor: f64,
    /// The largest stroke of each element, m, seen beforehand.
    largest: Vec<f64>,
    /// When a signal had its last kink, s.
    since: f64,
    /// Velocities at which friction sticks: their power has a kink where they turn round.
    rubbing: Vec<usize>,
    /// Error of the step that was evaluated last.
    error: StepError,
    /// The first evaluation behind the step that was worked out.
    behind: Option<Evaluation>,
    /// Powers of the step that was worked out, and of the one before it, where nothing jumps between them.
    flows: Vec<NodePower>,
    before: Option<Before>,
    /// Whether no element has variables of its own inside, which are known to the order of a step's nodes alone.
    is_plain: bool,
    /// As last used.
    quadrature: Option<Quadrature>,
    /// Where the last step that was refused starts, and how far each stroke was then from the integral of its rates, m.
    refused: Option<(f64, Vec<f64>)>,
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct StepperState {
    energy_floor: f64,
    largest: Vec<f64>,
    since: f64,
    before: Option<Before>,
}

/// Error of a step in units of its tolerance, by what it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
struct StepError {
    /// The worst memory: its error, which falls like this power of the step.
    memory: f64,
    falls: f64,
    /// Index of the worst element.
    element: Option<usize>,
    /// The energy ledger: its error, which falls like this power of the step.
    energy: f64,
    energy_falls: f64,
}

impl StepError {
    const NONE: Self = Self { memory: 0.0, falls: 4.0, element: None, energy: 0.0, energy_falls: THIRD };

    fn accepted(&self) -> bool {
        self.memory <= 1.0 && self.energy <= 1.0
    }

    /// By how much the next step may be longer; below 1 after a rejection.
    fn factor(&self) -> f64 {
        let memory = 0.85 * self.memory.powf(-1.0 / self.falls);
        let energy = 0.85 * self.energy.powf(-1.0 / self.energy_falls);
        let factor = memory.min(energy).clamp(0.1, 6.0);
        // A step that changes little keeps its size, and with it the tables of the exponentials.
        if (1.0..1.25).contains(&factor) { 1.0 } else { factor }
    }
}

impl Prescribed {
    pub(crate) fn new(cx: Context, trajectory: &Arc<Trajectory>) -> Self {
        let rubbing = reversal::rubbing(&cx.system.model);
        let (trajectory, largest) = (trajectory.clone(), vec![0.0; cx.system.elements.len()]);
        let mut laws = cx.system.elements.iter().map(|element| &element.law);
        let is_plain = laws.all(|law| law.hidden_errors() != usize::MAX && !law.is_thermal());
        Self {
            trajectory,
            energy_floor: 0.0,
            largest,
            since: 0.0,
            rubbing,
            error: StepError::NONE,
            behind: None,
            flows: Vec::new(),
            before: None,
            is_plain,
            quadrature: None,
            refused: None,
        }
    }

    /// What the next step takes over from those before.
    pub(crate) fn save(&self) -> StepperState {
        let Self { energy_floor, largest, since, before, .. } = self;
        StepperState { energy_floor: *energy_floor, largest: largest.clone(), since: *since, before: before.clone() }
    }

    /// Goes on from what was saved.
    ///
    /// # Errors
    /// What a named scheme refuses.
    pub(crate) fn load(&mut self, cx: Context, recorder: &mut Recorder, state: StepperState) -> Result<(), RunError> {
        (self.energy_floor, self.largest, self.since) = (state.energy_floor, state.largest, state.since);
        self.before = state.before;
        // What it tried on from there before is none of that state.
        (self.behind, self.refused) = (None, None);
        let rows = recorder.settings.rows.clone();
        recorder.grid = on_grid::derivatives(cx, &self.trajectory, &rows, &mut recorder.scratch)?;
        Ok(())
    }

    /// The first inner step where nobody gives one, s.
    fn first_step(&self, cx: Context, recorder: &Recorder) -> f64 {
        let (settings, [at, ..]) = (&recorder.settings, &recorder.evaluations);
        let mut first = self.longest_step(cx, settings) * FIRST_STEP;
        let begins_bent = cx.system.elements.iter().zip(&at.elements).any(|(element, at)| {
            element.law.has_memories_in_series() && element.start(at.reading.coordinate, &at.inputs).jump != 0.0
        });
        if begins_bent {
            first *= BEHIND_JUMP;
        }
        let mut rows = (0..settings.rows.count().min(2)).map(|row| settings.rows.at(row));
        match rows.find(|t| *t > 0.0) {
            Some(row) if row < first => (BEFORE_ROWS * row).max(SHORTEST_STEP * settings.end),
            _ => first,
        }
    }

    /// Evaluates the step without keeping it; an element that turns over on the way is asked for a shorter one.
    fn evaluate(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<StepError, RunError> {
        let (t, h) = (step.from, step.size);
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let at = if c == 1.0 { step.to } else { t + c * h };
            let inputs_at = if c == 1.0 { step.end_inputs() } else { at };
            cx.evaluate(&self.trajectory, at, inputs_at, &mut recorder.scratch, &mut recorder.evaluations[k + 1])?;
        }
        recorder.is_whole[1] = true;
        if let Some(element) = turned_over(cx, recorder, t, h)? {
            return Ok(StepError { memory: 1e3, element: Some(element), ..StepError::NONE });
        }
        recorder.works = None;
        recorder.powers = StepPowers::default();
        for (k, evaluation) in recorder.evaluations.iter().enumerate() {
            recorder.powers.actuators[k] = evaluation.rigid_power();
            recorder.powers.joints[k] = evaluation.joint_loss;
        }
        let mut error = StepError::NONE;
        recorder.equations.bank.start(t, h);
        for e in 0..cx.system.elements.len() {
            recorder.tell(cx, e);
            let noise = self.noise(recorder, e, t) + self.rounding(recorder, e);
            recorder.equations.bank.set_resolution(e, recorder.equations.bank.resolution(e) + noise);
            // By a clock of its own the rates are others.
            let has_clock = cx.system.elements[e].law.as_heated().is_some();
            let form = if has_clock || asks_for_strokes(recorder, e) { Form::Hermite } else { Form::Rates };
            recorder.equations.bank.set_form(e, form);
            if !recorder.equations.bank.account(e) {
                continue;
            }
            recorder.add_actuator_power(e);
            if !recorder.equations.bank.response(e).force.iter().all(|force| force.is_finite()) {
                // A law that finds no force asks for a shorter step.
                return Ok(StepError { memory: 1e3, element: Some(e), ..StepError::NONE });
            }
            let (share, falls) = recorder.memory_error(e, usize::MAX, 0.0, self.since);
            if share > error.memory {
                error = StepError { memory: share, falls, element: Some(e), ..error };
            }
        }
        (error.energy, error.energy_falls) = self.take_works(recorder, h);
        Ok(error)
    }

    /// Takes works over two steps where their estimate is the smaller one: the error of the energies, and how it falls.
    fn take_works(&mut self, recorder: &mut Recorder, h: f64) -> (f64, f64) {
        let alone = recorder.energy_error(h, self.energy_floor);
        self.flows = recorder.flows();
        // What begins without bound is known by a quadrature of its own.
        let is_plain = self.is_plain && !recorder.equations.bank.has_singular();
        let Some(before) = self.before.as_ref().filter(|_| is_plain) else { return (alone, THIRD) };
        let (works, errors) = before.works(h, &self.flows, &mut self.quadrature);
        let allowed = Allowed::by_differences(recorder.settings.rtol);
        let together = recorder.share_of_ledger(h, self.energy_floor, &errors, allowed);
        if together > alone {
            return (alone, THIRD);
        }
        recorder.works = Some(works);
        (together, SIXTH)
    }

    /// Noise of stroke `e`, m: what does not shrink with the step, within what the path is solved to. Near singular configurations its
    /// solutions lose many digits.
    fn noise(&self, recorder: &Recorder, e: usize, t: f64) -> f64 {
        let Some((_, before)) = self.refused.as_ref().filter(|(from, _)| *from == t) else { return 0.0 };
        let left = gap(recorder, e);
        let gradient = recorder.evaluations[0].elements[e].gradient.iter();
        let solved: f64 = gradient.map(|g| g.abs() * self.trajectory.solved_to()).sum();
        if left > SHRINKS * before[e] { (2.0 * left).min(solved) } else { 0.0 }
    }

    /// What rounding of the signals, and of the time that they are told, does to stroke `e`, m.
    fn rounding(&self, recorder: &Recorder, e: usize) -> f64 {
        let [_, rates] = recorder.equations.bank.told(e);
        let fastest = rates.iter().fold(0.0f64, |fastest, rate| fastest.max(rate.abs()));
        ROUNDING * (self.largest[e] + recorder.equations.bank.from() * fastest)
    }

    /// The error of what parameters change of inner variables over the step, where that shares in the choice of steps.
    fn variation_error(&self, recorder: &mut Recorder, step: &Target) -> f64 {
        let Recorder { evaluations, equations, variation, settings, .. } = recorder;
        let Some(variation) = variation.as_deref_mut().filter(|variation| variation.shares_in_steps()) else {
            return 0.0;
        };
        see(variation, evaluations, equations, step);
        variation.hidden_error(equations, (TANGENTS * settings.rtol, settings.end))
    }

    /// The step is tried again at this size, or somewhat below its own.
    fn rejected(&self, cx: Context, recorder: &Recorder, step: &Target, size: f64) -> Result<Trial, RunError> {
        let size = size.min(0.7 * step.size);
        self.gives_up(cx, recorder, step, size).map_or(Ok(Trial::Rejected { size }), Err)
    }

    /// The first evaluation behind a kink, to which coordinates must not jump from that at index `from` of the recorder.
    fn look_across(
        &self,
        cx: Context,
        recorder: &mut Recorder,
        from: usize,
        after: f64,
    ) -> Result<Evaluation, RunError> {
        let mut right = recorder.evaluations[from].clone();
        cx.evaluate(&self.trajectory, after, after, &mut recorder.scratch, &mut right)?;
        let (left, model) = (&recorder.evaluations[from], &cx.system.model);
        if left.t == after {
            return Ok(right);
        }
        let (mut v, mut a) = (vec![0.0; model.nv()], vec![0.0; model.nv()]);
        let speed = |k: usize| left.v[k].abs() + right.v[k].abs();
        refuse_jumps(model, (left.t, &left.q), (after, &right.q), speed, self.trajectory.solved_to(), |t, q| {
            self.trajectory.at(model, t, q, &mut v, &mut a)?;
            Ok(())
        })?;
        Ok(right)
    }

    fn step_too_small(&self, cx: Context, step: &Target, error: &StepError, end: f64) -> RunError {
        // At the limit of its reach the robot's rates are infinite, so that the steps shrink before the path ends.
        let near_the_end = self.trajectory.failure().filter(|failure| failure.t() - step.from < NEAR * end);
        if let Some(failure) = near_the_end {
            return failure.into();
        }
        let subject = match error.element {
            Some(e) if error.memory >= error.energy => format!("element \"{}\"", cx.system.elements[e].name),
            _ => "the energy ledger".into(),
        };
        RunError::StepTooSmall { t: step.from, h: step.size, error: error.memory.max(error.energy), subject }
    }
}

/// Whether stroke `e` tells more than its rates do, whose rounding counts less: with h^{1−alpha}, not with h^−alpha.
fn asks_for_strokes(recorder: &Recorder, e: usize) -> bool {
    let bank = &recorder.equations.bank;
    let [strokes, rates] = bank.told(e);
    let gaps = RatePolynomial::through_rates(bank.size(), Nodes::Radau, rates).gaps(None, strokes);
    gaps.iter().any(|gap| gap.abs() > bank.resolution(e))
}

/// How far stroke `e` at the end of the step is from the integral of its rates, m: of order h⁶ where the motion is smooth.
fn gap(recorder: &Recorder, e: usize) -> f64 {
    let [strokes, rates] = recorder.equations.bank.told(e);
    let travel: f64 = rates[1..].iter().zip(RADAU_WEIGHTS).map(|(rate, weight)| rate * weight).sum();
    (strokes[STAGES] - strokes[0] - recorder.equations.bank.size() * travel).abs()
}

/// An element whose points passed each other between two nodes, or that passed half a turn.
fn turned_over(cx: Context, recorder: &Recorder, t: f64, h: f64) -> Result<Option<usize>, RunError> {
    for pair in recorder.evaluations.windows(2) {
        for (e, (a, b)) in pair[0].elements.iter().zip(&pair[1].elements).enumerate() {
            let Some(why) = a.reading.lost_until(&b.reading) else { continue };
            let element = &cx.system.elements[e];
            let length = a.reading.coordinate.min(b.reading.coordinate);
            let met = !matches!(why, NoDirection::HalfTurn { .. }) && length < 1e-9 * element.rest;
            if h < 1e-9 * recorder.settings.end || met {
                return Err(element.without_direction(t + 0.5 * h, why));
            }
            return Ok(Some(e));
        }
    }
    Ok(None)
}

/// Sees what parameters change of the elements along the step.
fn see(variation: &mut Variation, evaluations: &[Evaluation], equations: &Equations, step: &Target) {
    for (i, at) in evaluations.iter().enumerate().skip(1) {
        let t = if i == STAGES { step.end_inputs() } else { at.t };
        variation.look(i, Node { t, q: &at.q, v: &at.v, a: &at.a });
        variation.take_start(i);
        (0..equations.bank.len()).for_each(|e| variation.measure(e, i));
    }
}

impl Stepper for Prescribed {
    fn longest_step(&self, _: Context, settings: &Settings) -> f64 {
        settings.max_step.unwrap_or(settings.end * LONGEST_STEP).min(settings.end)
    }

    fn start(&mut self, cx: Context, recorder: &mut Recorder, agenda: &Agenda) -> Result<f64, RunError> {
        let settings = recorder.settings.clone();
        cx.evaluate(&self.trajectory, 0.0, 0.0, &mut recorder.scratch, &mut recorder.evaluations[0])?;
        recorder.grid = on_grid::derivatives(cx, &self.trajectory, &settings.rows, &mut recorder.scratch)?;
        let Scale { energy, strokes } = cx.scale_of(&self.trajectory, settings.end, &mut recorder.scratch);
        (self.energy_floor, self.largest) = (energy, strokes);
        recorder.begin(cx)?;
        let first = settings.first_step.unwrap_or_else(|| self.first_step(cx, recorder));
        Ok(agenda.reach(0.0, first.min(settings.end)))
    }

    fn reach(&self, t: f64, h: f64) -> f64 {
        self.trajectory.reach(t, h)
    }

    fn solve(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<Result<f64, f64>, RunError> {
        self.error = self.evaluate(cx, recorder, target)?;
        Ok(Ok(target.size))
    }

    fn look(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<Look, RunError> {
        if let Some(theta) = self.first_reversal(cx, recorder, step)? {
            return Ok(Look::Within(theta, Change::Reversal));
        }
        Ok(match recorder.equations.look_for_kinks(step.size, &[]) {
            Seen::Nothing => Look::Nothing,
            Seen::Within(theta, kink) => Look::Within(theta, Change::Kink(kink)),
            Seen::AtEnd => Look::AtEnd,
        })
    }

    fn value(&mut self, _: Context, recorder: &mut Recorder, _: &Target, change: Change, theta: f64) -> f64 {
        let Change::Kink(kink) = change else { return 0.0 };
        recorder.equations.value_of_kink(kink, theta)
    }

    fn judge(&mut self, cx: Context, recorder: &mut Recorder, step: Target, _: f64) -> Result<Trial, RunError> {
        let next = step.size * self.error.factor();
        if !self.error.accepted() {
            self.refused = Some((step.from, (0..cx.system.elements.len()).map(|e| gap(recorder, e)).collect()));
            return self.rejected(cx, recorder, &step, next);
        }
        let changes = StepError { memory: self.variation_error(recorder, &step), ..StepError::NONE };
        let by_changes = step.size * changes.factor();
        if !changes.accepted() {
            return self.rejected(cx, recorder, &step, by_changes);
        }
        let next = next.min(by_changes);
        // Before any row is written, since a jump must leave none behind.
        self.behind = match step.behind {
            Behind::Kink(after) => Some(self.look_across(cx, recorder, STAGES, after)?),
            _ => None,
        };
        Ok(Trial::Accepted { step, next })
    }

    fn vary(&mut self, _: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError> {
        let Recorder { evaluations, equations, variation, .. } = recorder;
        let Some(variation) = variation else { return Ok(()) };
        if !variation.shares_in_steps() {
            see(variation, evaluations, equations, step);
        }
        variation.ask(equations);
        Ok(())
    }

    fn gives_up(&self, cx: Context, recorder: &Recorder, step: &Target, size: f64) -> Option<RunError> {
        let end = recorder.settings.end;
        (size < SHORTEST_STEP * end).then(|| self.step_too_small(cx, step, &self.error, end))
    }

    fn place(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        self.interpolate(cx, recorder, at, theta, evaluation)
    }

    fn interpolate(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        _: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        cx.evaluate(&self.trajectory, at, at, &mut recorder.scratch, evaluation)
    }

    fn accept(&mut self, _: Context, _: &mut Recorder, step: &Target) -> Result<(), RunError> {
        let flows = std::mem::take(&mut self.flows);
        self.before = (self.is_plain && step.behind == Behind::Step).then(|| Before::new(step.size, flows));
        Ok(())
    }

    fn cross(&mut self, cx: Context, recorder: &mut Recorder, after: f64) -> Result<(), RunError> {
        let right = match self.behind.take() {
            Some(right) if right.t == after => right,
            _ => self.look_across(cx, recorder, 0, after)?,
        };
        recorder.jump(cx, right)?;
        self.since = after;
        Ok(())
    }
}
