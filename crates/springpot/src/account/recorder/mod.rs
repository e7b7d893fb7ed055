//! What a run keeps of its steps: the kinematics of the step under way, its elements, and the energy accounts.
//!
//! A stepper fills the evaluations of a step (its start and its nodes) and tells the bank its strokes; the driver takes what was worked out into
//! the past.

pub(crate) mod balance;
mod check;

use crate::account::ledger::{NodePower, Turnover};
use crate::account::works::Works;
use crate::collocation::STAGES;
use crate::elements::{Element, MemoryRange};
use crate::equations::Variation;
use crate::equations::context::Context;
use crate::equations::evaluate::{ElementEvaluation, Evaluation, Scratch};
use crate::equations::on_grid::{GridDerivatives, on_grid_observation};
use crate::equations::{Equations, EquationsState, Recording};
use crate::law::heat::TEMPERATURE;
use crate::law::{Observation, Point, State};
use crate::observe::evaluation::ElementRow;
use crate::observe::{ElementQuantity, Quantity, Snapshot};
use crate::system::error::RunError;
use crate::system::settings::Settings;
use serde::{Deserialize, Serialize};

/// What a temperature, or what is stored, may move across a kink, in units of it: one bit of time further it is another one.
const SAME: f64 = 1e-9;

/// Powers of the step that belong to no element.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct StepPowers {
    pub(crate) actuators: NodePower,
    pub(crate) joints: NodePower,
}

/// What a run keeps of its steps.
#[derive(Debug)]
pub(crate) struct Recorder {
    pub(crate) settings: Settings,
    pub(crate) scratch: Scratch,
    /// At the start of the step and at its nodes.
    pub(crate) evaluations: [Evaluation; STAGES + 1],
    /// Whether those at the start and at the end have all that a row asks for.
    pub(crate) is_whole: [bool; 2],
    pub(crate) equations: Equations,
    pub(crate) powers: StepPowers,
    /// Works of the step, where its method integrates them itself.
    pub(crate) works: Option<Works>,
    /// What parameters change, where any are asked for.
    pub(crate) variation: Option<Box<Variation>>,
    /// What is kept to go back through the run, where that is asked for.
    pub(crate) recording: Option<Box<Recording>>,
    /// Whether actuators move the elements, as along kinematics given in advance.
    pub(crate) takes_elements_work: bool,
    /// Whether the force of each element is without bound behind a jump at t = 0, and its impulse is given at once.
    pub(crate) jolts: Vec<bool>,
    /// Of elements with named schemes.
    pub(crate) grid: GridDerivatives,
    /// Elements that warm themselves.
    thermal: Vec<usize>,
    ledger: Ledger,
}

/// The energies since t = 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Ledger {
    actuators: f64,
    joints: f64,
    potential_origin: f64,
    /// What stretching all elements that expand by a kelvin stores: of energies far below that rounding leaves nothing.
    stretching: f64,
    /// Balance at t = 0.
    origin: f64,
    turnover: Turnover,
}

/// What of a recorder must outlast a step. Whatever else it holds follows from the system and its settings, or is filled anew by every
/// step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct RecorderState {
    equations: EquationsState,
    /// Where the next step starts.
    pub(crate) evaluation: Evaluation,
    is_whole: bool,
    ledger: Ledger,
}

impl Recorder {
    pub(crate) fn new(cx: Context, settings: &Settings) -> Self {
        let evaluation = Evaluation::new(cx.system);
        Self {
            settings: settings.clone(),
            scratch: Scratch::new(&cx.system.model),
            evaluations: std::array::from_fn(|_| evaluation.clone()),
            is_whole: [true; 2],
            equations: Equations::new(cx.system, settings.fixed_step.is_some()),
            powers: StepPowers::default(),
            works: None,
            variation: None,
            recording: None,
            takes_elements_work: true,
            jolts: vec![false; cx.system.elements.len()],
            grid: vec![None; cx.system.elements.len()],
            thermal: (0..cx.system.elements.len()).filter(|&e| cx.system.elements[e].law.is_thermal()).collect(),
            ledger: Ledger::default(),
        }
    }

    /// Gives the first evaluation the inputs that follow from the state.
    pub(crate) fn take_inputs_at_start(&mut self, cx: Context) {
        let [evaluation, ..] = &mut self.evaluations;
        let elements = evaluation.elements.iter_mut().enumerate();
        elements.for_each(|(e, element)| self.equations.inputs_at_start(cx, e, &mut element.inputs));
    }

    /// Goes onto the branches of control behind the changes that were seen at the start of a step.
    ///
    /// # Errors
    /// [`RunError::ControlChatter`].
    pub(crate) fn change_branches(&mut self, cx: Context) -> Result<(), RunError> {
        if let Some(variation) = &mut self.variation {
            variation.foresee(0, &self.equations);
        }
        self.equations.change_branches(cx, false, self.settings.end)
    }

    /// Whether an element has strokes, or other variables, of its own inside.
    pub(crate) fn has_inner_strokes(&self) -> bool {
        (0..self.equations.bank.len()).any(|e| self.equations.bank.hidden_errors(e) == usize::MAX)
    }

    /// [`Self::begin`]s where the motion follows from forces: gives what jumps at t = 0 do at once, of each element ([`crate::law::past::jolt`]).
    ///
    /// # Errors
    /// Where a memory cannot be.
    pub(crate) fn begin_with_jolts(&mut self, cx: Context) -> Result<Vec<Option<(State, f64)>>, RunError> {
        let elements = cx.system.elements.iter().zip(&self.evaluations[0].elements);
        let jolts = elements.map(|(element, at)| {
            let start = element.start(at.reading.coordinate, &at.inputs);
            let jolt = element.jolt(&start, self.settings.memory_rtol, self.settings.end);
            jolt.map_err(RunError::of_kernel(&element.name))
        });
        let jolts = jolts.collect::<Result<Vec<_>, _>>()?;
        self.jolts = jolts.iter().map(Option::is_some).collect();
        self.begin(cx)?;
        Ok(jolts)
    }

    /// Begins the laws at the first evaluation, `evaluations[0]`, their memories without kernels.
    pub(crate) fn begin(&mut self, cx: Context) -> Result<(), RunError> {
        for (e, element) in cx.system.elements.iter().enumerate().filter(|(e, _)| self.grid[*e].is_none()) {
            let at = &self.evaluations[0].elements[e];
            let Settings { memory_rtol: tolerance, end: horizon, .. } = self.settings;
            let begun = element.begin_within(at.reading.coordinate, &at.inputs, tolerance, horizon);
            let mut state = begun.map_err(RunError::of_kernel(&element.name))?;
            element.check_start(&state)?;
            let start = element.start(at.reading.coordinate, &at.inputs);
            // Where the motion is sought, what the force does until then counts too, unless that is given to it at once.
            if self.takes_elements_work || self.jolts[e] {
                let range = MemoryRange { tolerance, shortest: 0.0, horizon };
                state = element.settled(&start, state, range).map_err(RunError::of_kernel(&element.name))?;
            }
            self.equations.bank.begin_from(e, &start, state);
        }
        self.equations.take_starts();
        Ok(())
    }

    /// Opens memories and accounts of what has begun; `first` is the size of the first step.
    pub(crate) fn open(&mut self, cx: Context, first: f64) -> Result<(), RunError> {
        let Settings { memory_rtol: tolerance, end: horizon, .. } = self.settings;
        for (e, element) in cx.system.elements.iter().enumerate() {
            let range = MemoryRange { tolerance, shortest: first, horizon };
            let range = element.memory_range(range, &self.evaluations[0].elements[e].inputs);
            let opened = self.equations.bank.open_element(e, range);
            opened.map_err(RunError::of_kernel(&element.name))?;
        }
        self.equations.open_control(tolerance, first, horizon)?;
        self.open_account(cx)
    }

    /// Opens the accounts alone.
    pub(crate) fn open_account(&mut self, cx: Context) -> Result<(), RunError> {
        let horizon = self.settings.end;
        let at_start = cx.system.elements.iter().zip(&self.evaluations[0].elements);
        let stretching = |(element, at): (&Element, &ElementEvaluation)| {
            element.law.as_heated().map_or(0.0, |heated| heated.stretching(&at.point(0.0), 1.0 / horizon))
        };
        self.ledger.stretching = at_start.map(stretching).sum();
        self.ledger.potential_origin = self.evaluations[0].potential;
        let mut start = Snapshot::new(cx.system);
        start.evaluation.clone_from(&self.evaluations[0]);
        self.read(cx, None, 0, &mut start)?;
        let balance = self.balance(&start, 0.0, 0.0);
        self.ledger.origin = balance.total();
        // Taken here and at the ends of steps, never from rows: they must not change the steps.
        self.ledger.turnover.take(&balance);
        Ok(())
    }

    /// Tells the bank element `e` of the step, as the evaluations have it.
    pub(crate) fn tell(&mut self, cx: Context, e: usize) {
        for (k, evaluation) in self.evaluations.iter().enumerate() {
            let at = &evaluation.elements[e];
            self.equations.bank.set(e, k, at.stroke, at.reading.rate, &at.inputs);
        }
        let start = self.evaluations[0].elements[e].reading.coordinate;
        self.equations.bank.set_resolution(e, cx.system.elements[e].resolution(start));
    }

    /// Makes sure that the evaluation at the start (0) or at the end (1) has all that a row asks for.
    pub(crate) fn complete(&mut self, cx: Context, end: usize) -> Result<(), RunError> {
        if !self.is_whole[end] {
            let evaluation = &mut self.evaluations[end * STAGES];
            cx.fill(evaluation.t, evaluation.t, None, &mut self.scratch, evaluation)?;
            self.is_whole[end] = true;
        }
        Ok(())
    }

    /// Takes the step that was worked out into the past.
    ///
    /// # Errors
    /// [`RunError::ControlChatter`]; where the reference of a controller cannot be followed.
    pub(crate) fn commit(&mut self, cx: Context) -> Result<(), RunError> {
        let ends = [0, STAGES].map(|k| &self.evaluations[k]).map(|end| (end.t, &end.q[..], &end.v[..]));
        self.equations.take_ends(cx, ends)?;
        let leaning = self.equations.lean_again();
        match (&mut self.variation, &mut self.recording) {
            (Some(variation), Some(recording)) if variation.is_unsolved() => {
                recording.take_step(variation, &self.equations);
            }
            (variation, recording) => {
                variation.iter_mut().for_each(|variation| variation.commit(&self.equations));
                recording.iter_mut().for_each(|recording| recording.note(true));
            }
        }
        self.equations.stand(leaning);
        let (actuators, joints) = self.work_until(1.0);
        let end = &self.evaluations[STAGES];
        let (mut stored, mut dissipated, mut supplied) = (0.0, 0.0, 0.0);
        for e in 0..self.equations.bank.len() {
            let until = self.energies_until(e, 1.0);
            // Of an element that takes no part all three are unknown.
            stored += self.equations.bank.end(e).stored.unwrap_or(f64::NAN);
            (dissipated, supplied) = (dissipated + until.0, supplied + until.1);
        }
        let balance = self.balance_of(end, [stored, dissipated, supplied], actuators, joints);
        let known = self.works.is_some();
        let until: Vec<_> =
            (0..self.equations.bank.len()).filter(|_| known).map(|e| self.energies_until(e, 1.0)).collect();
        self.equations.commit(cx, self.settings.end)?;
        until.into_iter().enumerate().for_each(|(e, until)| self.equations.bank.set_energies(e, until));
        self.ledger.turnover.take(&balance);
        self.ledger.actuators += actuators;
        self.ledger.joints += joints;
        self.evaluations.swap(0, STAGES);
        self.is_whole.swap(0, 1);
        Ok(())
    }

    /// # Errors
    /// [`RunError::RunAway`] where an element is too hot after the last step.
    pub(crate) fn check_warmth(&self, cx: Context, t: f64) -> Result<(), RunError> {
        for &e in &self.thermal {
            let temperature = self.equations.bank.warmth(e, None).map_or(0.0, |warmth| warmth.temperature);
            let highest = TEMPERATURE.high;
            if temperature > highest {
                let element = cx.system.elements[e].name.clone();
                return Err(RunError::RunAway { t, element, temperature, highest });
            }
        }
        Ok(())
    }

    /// Goes on from the far side of a kink, `right`, and records what jumps there.
    ///
    /// # Errors
    /// [`RunError::Heat`] where a temperature jumps that stretches an element.
    pub(crate) fn jump(&mut self, cx: Context, right: Evaluation) -> Result<(), RunError> {
        for (e, element) in
            cx.system.elements.iter().enumerate().filter(|(_, element)| element.law.stretched_by().is_some())
        {
            let [before, after] =
                [&self.evaluations[0], &right].map(|of| element.law.temperature(&of.elements[e].inputs));
            if (after - before).abs() > SAME * before {
                return Err(RunError::heat_jump(right.t, &element.name, before, after));
            }
        }
        let left = std::mem::replace(&mut self.evaluations[0], right);
        let right = &self.evaluations[0];
        self.is_whole[0] = true;
        // An impulse of the actuators makes the velocities jump; a jump of an input changes what its element stores.
        self.ledger.actuators += right.kinetic - left.kinetic;
        for e in 0..self.equations.bank.len() {
            let was = left.elements[e].point(left.t);
            let is = Point { inputs: &right.elements[e].inputs, ..was };
            let stored = |at: &Point| self.equations.bank.now(e, at).and_then(|observation| observation.stored);
            if let Some((was, is)) = stored(&was).zip(stored(&is)) {
                self.equations.bank.add_supplied(e, is - was);
                if let Some(variation) = self.variation.as_mut().filter(|_| (is - was).abs() > SAME * was) {
                    variation.lose_supplied(e);
                }
            }
        }
        Ok(())
    }

    /// Fills the elements and the balance of a snapshot whose evaluation is there: at θ of the step that was accounted, or between two steps
    /// (`None`), at the first evaluation. `row` is that of named schemes.
    ///
    /// # Errors
    /// What a row there may show.
    pub(crate) fn read(
        &mut self,
        cx: Context,
        theta: Option<f64>,
        row: usize,
        snapshot: &mut Snapshot,
    ) -> Result<(), RunError> {
        self.equations.complete(cx, theta, &mut snapshot.evaluation)?;
        let Snapshot { evaluation, elements, .. } = snapshot;
        elements.clear();
        for e in 0..self.equations.bank.len() {
            let point = evaluation.elements[e].point(evaluation.t);
            let (observation, (dissipated, input)) = match theta {
                Some(theta) => (self.equations.bank.at(e, theta, &point), self.energies_until(e, theta)),
                None => (self.equations.bank.now(e, &point), self.equations.bank.energies(e)),
            };
            let observation = match observation {
                Some(observation) => observation,
                None => self.on_grid(cx, e, &point, row)?,
            };
            let mut leaves = Vec::new();
            if cx.system.needs_leaves() {
                self.equations.bank.leaves(e, theta, &point, &mut leaves);
            }
            let mut told = Vec::new();
            self.equations.bank.tell(e, theta, &point, &mut told);
            elements.push(ElementRow { observation, told, leaves, dissipated, input });
        }
        let (actuators, joints) = theta.map_or((0.0, 0.0), |theta| self.work_until(theta));
        let balance = self.balance(snapshot, actuators, joints);
        snapshot.actuators = balance.actuators;
        let hidden = snapshot.elements.iter().zip(&cx.system.elements).filter(|(_, element)| !element.shown);
        let stops = hidden.map(|(row, _)| row.observation.stored.unwrap_or(f64::NAN) + row.dissipated).sum::<f64>();
        snapshot.joints = self.ledger.joints + joints + stops;
        snapshot.residual = balance.total() - self.ledger.origin;
        Ok(())
    }

    /// An element with a named scheme.
    fn on_grid(&self, cx: Context, e: usize, point: &Point, row: usize) -> Result<Observation, RunError> {
        on_grid_observation(&cx.system.elements[e], point, self.grid[e].as_deref().unwrap_or_default(), row)
    }

    /// Whether all energies are known.
    pub(crate) fn knows_energies(&self) -> bool {
        (0..self.equations.bank.len()).all(|e| self.equations.bank.takes_part(e) && self.equations.bank.is_accounted(e))
    }

    /// Whether a row at time t may leave this quantity empty: whatever follows from an infinite force, or from a named scheme, at t = 0, and
    /// energies of which no account is kept.
    pub(crate) fn may_be_unknown(&self, t: f64, quantity: &Quantity) -> bool {
        let is_unknown_at_start =
            |e: usize| !self.equations.bank.takes_part(e) || self.equations.bank.begins_singular(e);
        match quantity {
            Quantity::GripperError | Quantity::Derivative(_) => true,
            Quantity::Energy(_)
            | Quantity::Element(_, ElementQuantity::Stored | ElementQuantity::Dissipated | ElementQuantity::Input)
                if !self.knows_energies() =>
            {
                true
            }
            _ => t == 0.0 && (0..self.equations.bank.len()).any(is_unknown_at_start),
        }
    }

    /// What outlasts the steps.
    pub(crate) fn state(&self) -> RecorderState {
        let (equations, evaluation) = (self.equations.save(), self.evaluations[0].clone());
        RecorderState { equations, evaluation, is_whole: self.is_whole[0], ledger: self.ledger }
    }

    /// Goes on from a state of the same system; `false`, and nothing changed, where it is of another one.
    pub(crate) fn go_on(&mut self, state: RecorderState) -> bool {
        let RecorderState { equations, evaluation, is_whole, ledger } = state;
        if !evaluation.has_shape_of(&self.evaluations[0]) || !self.equations.load(equations) {
            return false;
        }
        self.evaluations[0] = evaluation;
        self.is_whole[0] = is_whole;
        self.ledger = ledger;
        true
    }
}
