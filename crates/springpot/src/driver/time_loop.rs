//! The one loop: which step is tried next, what becomes of it, and what is crossed between two of them.

use super::driver_state::{DriverState, fingerprint};
use super::report::Report;
use super::roots::try_step;
use crate::account::recorder::Recorder;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::dynamics::Kinematics;
use crate::elements::MemoryRange;
use crate::equations::context::{Context, Held};
use crate::equations::control::{Eye, OfSamples, Sampler};
use crate::equations::{Equations, Node, Recording, Variation, VariationState};
use crate::fractional::Kind as Derivative;
use crate::methods::solver::Solver;
use crate::methods::stepper::{Behind, Target, Trial};
use crate::observe::{Needs, Snapshot};
use crate::signal::watched::FINEST;
use crate::signal::{self, Agenda};
use crate::system::definite::Definite;
use crate::system::error::RunError;
use crate::system::row_times::RowTimes;
use crate::system::sensitivity::{Sensitivity, SensitivityError};
use crate::system::settings::{Settings, Stop};
use crate::system::{Motion, System};
use std::sync::{Arc, OnceLock};

/// Steps above this many last bits of the end are whole multiples of such a bit.
const COARSE: f64 = (1u64 << 20) as f64;

/// Times that differ by less than this share of them are one.
const TICK: f64 = 1e-12;

/// A first step that is shorter than planned by this share has the memories built anew.
const MUCH_SHORTER: f64 = 0.1;

/// A sample and a kink of a signal that differ by less than this share of their time are crossed together.
const ONE_STOP: f64 = 1e-12;

/// Where the next row and the last one are: steps may end on rows that are far apart.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowsAhead {
    pub(super) next: f64,
    pub(super) last: f64,
}

/// Where a driver was before it took a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    h: f64,
    tick: usize,
    steps: u64,
}

/// A run between two steps, or with one that was worked out and is not yet taken into the past, so that it can be looked into.
#[derive(Debug)]
pub(super) struct Driver {
    pub(super) solver: Solver,
    pub(super) recorder: Recorder,
    /// What looks at the mass matrix of robots where it may be indefinite.
    definite: Option<Definite>,
    /// Laws that are sampled, where there are some.
    pub(super) sampler: Option<Box<Sampler>>,
    /// What the signals do.
    agenda: Arc<Agenda>,
    longest_step: f64,
    /// Where the last step taken into the past ended.
    t: f64,
    /// Size of the next step.
    h: f64,
    /// The shortest step that the memories are built for.
    planned: f64,
    step: Option<Target>,
    /// The far side of what is to be crossed before the next step.
    crossing: Option<f64>,
    /// Whether that is a change of the robot's own.
    is_own: bool,
    /// Number of the end of the next step, where they have one size.
    tick: usize,
    steps: u64,
    rejected_steps: u64,
    /// What tells system and settings from others, once it was asked for.
    fingerprint: OnceLock<u64>,
}

impl Driver {
    /// At t = 0.
    ///
    /// # Errors
    /// What keeps a run from starting; [`RunError::Interrupted`].
    pub(super) fn new(
        cx: Context,
        settings: &Settings,
        stop: &Stop,
        looked_ahead: impl FnOnce(&Self),
    ) -> Result<Self, RunError> {
        Self::begun(cx, settings, stop, looked_ahead, true)
    }

    /// As [`Self::new`] of one that takes no step: memories have no kernels.
    pub(super) fn at_start(
        cx: Context,
        settings: &Settings,
        stop: &Stop,
        looked_ahead: impl FnOnce(&Self),
    ) -> Result<Self, RunError> {
        Self::begun(cx, settings, stop, looked_ahead, false)
    }

    /// `opens`: whether it goes on from there.
    fn begun(
        cx: Context,
        settings: &Settings,
        stop: &Stop,
        looked_ahead: impl FnOnce(&Self),
        opens: bool,
    ) -> Result<Self, RunError> {
        let mut driver = Self::unstarted(cx, settings, stop)?;
        looked_ahead(&driver);
        driver.start(cx, opens)?;
        if driver.sampler.is_some() {
            // What the first samples say follows from the start without them, and acts at the start.
            driver.sample(cx, 0.0)?;
            let Self { sampler, agenda, .. } = driver;
            driver = Self::with(cx, settings, sampler, agenda)?;
            driver.start(cx, opens)?;
        }
        Ok(driver)
    }

    fn start(&mut self, cx: Context, opens: bool) -> Result<(), RunError> {
        let acting = self.acting();
        let cx = Context { sampled: &acting, ..cx };
        self.recorder.equations.begin_control(cx.system, self.recorder.settings.end)?;
        if let Some(sampler) = &self.sampler {
            self.recorder.equations.take_sides(sampler);
        }
        let first = self.solver.stepper_mut().start(cx, &mut self.recorder, &self.agenda)?;
        cx.system.check_definite(&self.recorder.evaluations[0].q)?;
        if !opens {
            return self.recorder.open_account(cx);
        }
        self.recorder.open(cx, first)?;
        self.begin_variation(cx)?;
        let Recorder { equations, variation, settings, .. } = &self.recorder;
        let sharing = variation.as_ref().filter(|variation| variation.shares_in_steps());
        let longest = sharing.map(|variation| variation.longest_first(equations, settings.rtol));
        let first = longest.filter(|_| settings.first_step.is_none()).map_or(first, |longest| first.min(longest));
        self.h = self.aligned(first);
        self.planned = self.h;
        Ok(())
    }

    /// What parameters change at t = 0, where any are asked for.
    fn begin_variation(&mut self, cx: Context) -> Result<(), RunError> {
        let Self { sampler, recorder, .. } = self;
        let Recorder { evaluations: [at, ..], equations, variation, recording, settings, takes_elements_work, .. } =
            recorder;
        let Some(by) = &cx.system.sensitivity else { return Ok(()) };
        if by.adjoint.is_some() {
            refuse_to_go_back(cx.system, equations)?;
        }
        let has_fixed_steps = self.solver.stepper().fixed_step().is_some();
        let (recorded, by) = recording_of(cx, by, equations, (sampler.as_deref(), has_fixed_steps));
        let mut begun = Variation::new(cx.system, &by, equations, has_fixed_steps)?;
        begun.hold(sampler.as_ref().and_then(|sampler| sampler.held_changes()));
        let [v, a] = self.solver.stepper().starts_with().unwrap_or([&at.v, &at.a]);
        let range = MemoryRange { tolerance: settings.memory_rtol, shortest: 0.0, horizon: settings.end };
        let start = [Node { t: at.t, q: &at.q, v: &at.v, a: &at.a }, Node { t: at.t, q: &at.q, v, a }];
        begun.begin(cx.system, equations, start, (range, *takes_elements_work))?;
        if let Some(mut recorded) = recorded {
            // Where the memories are built anew.
            if let (Some(earlier), Some(variation)) = (recording.take(), variation.as_deref_mut()) {
                recorded.take_start(*earlier, variation);
            }
            recorded.attach(&mut begun);
            *recording = Some(Box::new(recorded));
        }
        *variation = Some(Box::new(begun));
        Ok(())
    }

    /// Goes on with what parameters changed, where any are asked for.
    fn load_variation(&mut self, cx: Context, state: Option<VariationState>) -> Result<(), RunError> {
        let Self { sampler, recorder, .. } = self;
        let Recorder { evaluations: [at, ..], equations, variation, recording, .. } = recorder;
        let Some(by) = &cx.system.sensitivity else { return Ok(()) };
        let has_fixed_steps = self.solver.stepper().fixed_step().is_some();
        let (recorded, by) = recording_of(cx, by, equations, (sampler.as_deref(), has_fixed_steps));
        let mut loaded = Variation::new(cx.system, &by, equations, has_fixed_steps)?;
        loaded.hold(sampler.as_ref().and_then(|sampler| sampler.held_changes()));
        let [v, a] = self.solver.stepper().starts_with().unwrap_or([&at.v, &at.a]);
        let start = Node { t: at.t, q: &at.q, v, a };
        if !state.is_some_and(|state| loaded.load(state, equations, start)) {
            return Err(RunError::OtherRun);
        }
        (*variation, *recording) = (Some(Box::new(loaded)), recorded.map(Box::new));
        Ok(())
    }

    /// What sampled laws said last.
    fn acting(&self) -> Arc<Held> {
        self.sampler.as_ref().map_or_else(Arc::default, |sampler| sampler.acting().clone())
    }

    /// Takes the samples that are due at t, from what is known at the present time, which is just before.
    fn sample(&mut self, cx: Context, t: f64) -> Result<(), RunError> {
        let mut shown = Snapshot::new(cx.system);
        self.read(cx, self.t, 0, &mut shown)?;
        self.vary(None, &shown, false);
        let Snapshot { evaluation, .. } = &shown;
        let kinematics = Kinematics::at_velocity(&cx.system.model, &evaluation.q, &evaluation.v);
        let read = |e: usize| [evaluation.elements[e].reading.coordinate, evaluation.elements[e].reading.rate];
        let (system, q, v) = (cx.system, &evaluation.q[..], &evaluation.v[..]);
        let eye = Eye { system, t, q, v, kinematics: &kinematics, element: &read };
        let sampler = self.sampler.as_mut();
        let Recorder { equations, variation, .. } = &mut self.recorder;
        sampler.map_or(Ok(()), |sampler| equations.sample(sampler, &eye, &shown, variation.as_deref_mut()))
    }

    /// Where a run of the same system was.
    ///
    /// # Errors
    /// [`RunError::OtherRun`] where the state is none of this system and settings; [`RunError::Interrupted`].
    pub(super) fn resume(
        cx: Context,
        settings: &Settings,
        state: DriverState,
        stop: &Stop,
        looked_ahead: impl FnOnce(&Self),
    ) -> Result<Self, RunError> {
        let mut driver = Self::unstarted(cx, settings, stop)?;
        looked_ahead(&driver);
        driver.recorder.equations.begin_control(cx.system, settings.end)?;
        driver.go_on(cx, state)?;
        Ok(driver)
    }

    fn unstarted(cx: Context, settings: &Settings, stop: &Stop) -> Result<Self, RunError> {
        settings.check()?;
        let solver = Solver::new(cx, settings)?;
        let longest_step = solver.stepper().longest_step(cx, settings);
        let agenda = match solver.stepper().fixed_step() {
            None => {
                cx.system.look_for_jumps_of_references(settings, stop)?;
                cx.system.agenda(settings, longest_step, stop)?
            }
            Some(_) => {
                // What such steps pass over without a trace.
                cx.system.look_for_jumps(settings, stop)?;
                Arc::default()
            }
        };
        let sampler = Sampler::of(cx.system, solver.stepper().fixed_step())?;
        Self::with(cx, settings, sampler, agenda)
    }

    fn with(
        cx: Context,
        settings: &Settings,
        sampler: Option<Box<Sampler>>,
        agenda: Arc<Agenda>,
    ) -> Result<Self, RunError> {
        let solver = Solver::new(cx, settings)?;
        let longest_step = solver.stepper().longest_step(cx, settings);
        let mut recorder = Recorder::new(cx, settings);
        solver.stepper().set_up(&mut recorder);
        Ok(Self {
            solver,
            recorder,
            definite: Definite::of(&cx.system.model),
            sampler,
            agenda,
            longest_step,
            t: 0.0,
            h: 0.0,
            planned: 0.0,
            step: None,
            crossing: None,
            is_own: false,
            tick: 1,
            steps: 0,
            rejected_steps: 0,
            fingerprint: OnceLock::new(),
        })
    }

    /// How often the signals switch.
    pub(super) fn switches(&self) -> Option<u64> {
        self.solver.stepper().fixed_step().is_none().then(|| self.agenda.switches())
    }

    /// Whether all steps have one size, whose error they show, whatever it is.
    pub(super) fn has_fixed_steps(&self) -> bool {
        self.solver.stepper().fixed_step().is_some()
    }

    /// Steps worked out so far.
    pub(super) fn steps(&self) -> u64 {
        self.steps
    }

    /// Time up to which everything is known, s.
    pub(super) fn reached(&self) -> f64 {
        self.step.map_or(self.t, |step| step.to)
    }

    /// Whether the end is reached.
    pub(super) fn has_ended(&self) -> bool {
        self.reached() >= self.recorder.settings.end
    }

    /// Where the last step taken into the past ended, s.
    pub(super) fn t(&self) -> f64 {
        self.t
    }

    /// Where it is, to be asked before a step that may be taken back.
    pub(super) fn mark(&self) -> Mark {
        Mark { h: self.h, tick: self.tick, steps: self.steps }
    }

    /// Forgets the step at hand, before which it was at `mark`.
    pub(super) fn take_back(&mut self, mark: Mark) {
        if self.step.take().is_some() {
            self.rejected_steps += 1;
        }
        Mark { h: self.h, tick: self.tick, steps: self.steps } = mark;
    }

    /// The step that can be looked into.
    pub(super) fn step_at_hand(&self) -> Option<Target> {
        self.step
    }

    /// Takes the step at hand into the past, or crosses what is behind it: `true` where something was crossed, whose rows are to be written before
    /// it is asked again. After `false` the next step can be tried.
    ///
    /// # Errors
    /// What must not jump.
    pub(super) fn settle(&mut self, cx: Context) -> Result<bool, RunError> {
        self.close(cx)?;
        let sampled = Some(self.t).filter(|t| self.has_fixed_steps() && self.samples_at(*t));
        let Some(after) = self.crossing.take().or(sampled).or_else(|| self.kink_at_hand(cx)) else {
            return self.settle_still().map(|()| false);
        };
        if self.samples_at(after) {
            self.sample(cx, after)?;
        }
        let acting = self.acting();
        let cx = Context { sampled: &acting, ..cx };
        let varies = self.recorder.variation.is_some();
        if varies {
            self.vary_switches(cx, [self.t, after]);
        }
        let [at, ..] = &self.recorder.evaluations;
        let before = if varies { [at.v.clone(), at.a.clone()] } else { Default::default() };
        self.solver.stepper_mut().cross(cx, &mut self.recorder, after)?;
        let is_own = std::mem::take(&mut self.is_own);
        self.settle_variation(before.each_ref().map(|own| &own[..]), is_own)?;
        self.t = after;
        // A little further, since a sign is 0 while it turns.
        let past = if self.has_fixed_steps() { after } else { cx.system.past_turns(after) };
        self.crossing = (past != after).then_some(past);
        Ok(true)
    }

    /// Whether a sample is due at t.
    fn samples_at(&self, t: f64) -> bool {
        self.sampler.as_ref().is_some_and(|sampler| sampler.is_due(t))
    }

    /// Whether a row at t can be read now: what is sampled at the end of a step of one size acts there already.
    pub(super) fn shows(&self, t: f64) -> bool {
        let reached = self.reached();
        let is_end = || t >= reached * (1.0 - TICK) && self.step.is_some();
        t <= reached && !(self.has_fixed_steps() && is_end() && self.samples_at(reached))
    }

    /// Whether something is to be crossed at the present time before anything else, as after [`Self::disturb`].
    pub(super) fn is_disturbed(&self) -> bool {
        self.step.is_none() && self.crossing.is_some()
    }

    /// Takes the step at hand into the past; what is behind it is not yet crossed.
    ///
    /// # Errors
    /// Where nothing can follow.
    pub(super) fn close(&mut self, cx: Context) -> Result<(), RunError> {
        let Some(step) = self.step.take() else { return Ok(()) };
        let acting = self.acting();
        let cx = Context { sampled: &acting, ..cx };
        let Recorder { evaluations: [start, ..], equations, variation, .. } = &mut self.recorder;
        if let Some(variation) = variation
            && equations.has_jumped_at_end()
        {
            variation.arrive(&start.a);
        }
        self.recorder.commit(cx)?;
        self.is_own = step.behind == Behind::Change;
        self.vary_changes(step.size);
        self.recorder.check_warmth(cx, step.to)?;
        self.t = step.to;
        self.crossing = step.crossing();
        self.solver.stepper_mut().accept(cx, &mut self.recorder, &step)
    }

    /// The far side of a kink at the present time.
    fn kink_at_hand(&self, cx: Context) -> Option<f64> {
        if self.solver.stepper().fixed_step().is_some() || self.has_ended() {
            return None;
        }
        if self.t == 0.0 && cx.system.turns_at(0.0) {
            return Some(f64::EPSILON * f64::EPSILON * self.recorder.settings.end);
        }
        let stop = self.agenda.next_stop(self.t).filter(|stop| stop.before <= self.t);
        stop.and_then(|stop| stop.after)
    }

    /// What follows starts anew: something that is held from outside is about to change.
    ///
    /// # Errors
    /// Where nothing can follow.
    pub(super) fn disturb(&mut self, cx: Context) -> Result<(), RunError> {
        self.close(cx)?;
        self.crossing = self.crossing.or(Some(self.t));
        Ok(())
    }

    /// Works out the next step, which ends at `until` at the latest; everything before it is settled. `pauses` is asked before every try.
    ///
    /// # Errors
    /// Where no step leads on, or no more are allowed; [`RunError::Interrupted`].
    pub(super) fn advance(
        &mut self,
        cx: Context,
        until: f64,
        rows: Option<RowsAhead>,
        pauses: &mut dyn FnMut() -> bool,
    ) -> Result<(), RunError> {
        let limit = self.recorder.settings.step_limit(self.agenda.switches());
        let acting = self.acting();
        let cx = Context { sampled: &acting, ..cx };
        loop {
            if self.steps >= limit {
                return Err(RunError::TooManySteps { t: self.t, limit: self.steps });
            }
            if pauses() {
                return Err(RunError::Interrupted { t: self.t });
            }
            let target = self.target(until, rows);
            self.begin_recording();
            match try_step(self.solver.stepper_mut(), cx, &mut self.recorder, target)? {
                Trial::Accepted { step, next } => {
                    self.check_definite(cx, &step)?;
                    self.steps += 1;
                    self.solver.stepper_mut().vary(cx, &mut self.recorder, &step)?;
                    if let Some(size) = self.solver.stepper().fixed_step() {
                        self.tick += usize::from(step.to >= self.tick_time(size) * (1.0 - TICK));
                    }
                    // A step cut short by a stop says nothing against the size chosen before.
                    let before = if step.size < self.h { self.h } else { 0.0 };
                    self.h = self.aligned(next.max(before).min(self.longest_step));
                    self.step = Some(step);
                    return Ok(());
                }
                Trial::Rejected { size } => {
                    self.rejected_steps += 1;
                    self.h = self.aligned(size);
                    if self.t == 0.0 && size < MUCH_SHORTER * self.planned && self.recorder.has_inner_strokes() {
                        // Strokes inside a series may change faster than the memories are built for, whose energies take that for still.
                        self.recorder.begin(cx)?;
                        self.recorder.open(cx, size)?;
                        self.begin_variation(cx)?;
                        self.planned = size;
                    }
                }
                Trial::Changes => {
                    self.is_own = true;
                    self.vary_changes(0.0);
                    self.crossing = Some(self.t);
                    return Ok(());
                }
            }
        }
    }

    /// Refuses to go on where the mass matrix is not positive definite on the way through a step whose motion follows from forces.
    fn check_definite(&mut self, cx: Context, step: &Target) -> Result<(), RunError> {
        let (Some(definite), Motion::Forward(_)) = (&mut self.definite, &cx.system.motion) else { return Ok(()) };
        // Steps of one size are known at their ends alone.
        let is_fixed = self.solver.stepper().fixed_step().is_some();
        let mut before = (step.from, 0);
        for node in if is_fixed { STAGES } else { 1 }..=STAGES {
            let to = if node == STAGES { step.to } else { step.from + RADAU_NODES[node - 1] * step.size };
            let q = [before.1, node].map(|node| self.recorder.evaluations[node].q.as_slice());
            definite.check_way(&cx.system.model, [before.0, to], q)?;
            before = (to, node);
        }
        Ok(())
    }

    /// A size that times can be added to without rounding, so that steps of one size are so to the bit and share their tables of lags.
    fn aligned(&self, h: f64) -> f64 {
        let bit = f64::EPSILON * self.recorder.settings.end.log2().ceil().exp2();
        if h > COARSE * bit { (h / bit).floor() * bit } else { h }
    }

    /// The step that is tried next.
    fn target(&self, until: f64, rows: Option<RowsAhead>) -> Target {
        let (t, end) = (self.t, self.recorder.settings.end.min(until));
        if let Some(step) = self.solver.stepper().fixed_step() {
            let tick = self.tick_time(step);
            // What differs by rounding alone is the end that was asked for.
            let to = if end <= tick * (1.0 + TICK) { end } else { tick };
            // To the bit where it can be, so that the tables of the exponentials are made once.
            let size = if (to - t - step).abs() <= 1e-9 * step { step } else { to - t };
            return Target { from: t, to, size, behind: Behind::Step };
        }
        let stop = self.next_stop(t);
        let stop_at = stop.map_or(end, |stop| stop.before.min(end));
        let reach = self.solver.stepper().reach(t, self.agenda.reach(t, self.h));
        let reach = self.recorder.equations.reach(t, reach);
        let sparse = rows.filter(|rows| {
            self.solver.stepper().ends_on_sparse_rows() && rows.next > t && rows.next - rows.last >= reach
        });
        let to = end_of(t, reach, sparse.map_or(stop_at, |rows| rows.next.min(stop_at)));
        let size = to - t;
        let behind = match stop.filter(|stop| stop.before == to) {
            None => Behind::Step,
            Some(signal::Stop { after: None, .. }) => Behind::Break,
            Some(signal::Stop { after: Some(after), .. }) => Behind::Kink(after),
        };
        Target { from: t, to, size, behind }
    }

    /// Where a step from t must end: on what the signals do, and just before samples.
    fn next_stop(&self, t: f64) -> Option<signal::Stop> {
        let stop = self.agenda.next_stop(t);
        let due = self.sampler.as_ref().map_or(f64::INFINITY, |sampler| sampler.next());
        if due > self.recorder.settings.end {
            return stop;
        }
        let near = ONE_STOP * due;
        let sample = signal::Stop { before: due.next_down(), after: Some(due) };
        match stop {
            Some(stop) if stop.before < due - near => Some(stop),
            Some(stop) if stop.before <= due + near => Some(signal::Stop {
                before: stop.before.min(sample.before),
                after: Some(stop.after.unwrap_or(stop.before).max(due)),
            }),
            _ => Some(sample),
        }
    }

    /// Where the present step of one size ends, if nothing ends it earlier.
    fn tick_time(&self, step: f64) -> f64 {
        let ends = RowTimes::Step { step, end: self.recorder.settings.end };
        ends.at(self.tick.min(ends.count() - 1))
    }

    /// Fills a snapshot at a time of the step at hand, or at the present time; `row` is that of named schemes. Gives θ inside the step.
    ///
    /// # Errors
    /// What a row there may show.
    pub(super) fn read(
        &mut self,
        cx: Context,
        at: f64,
        row: usize,
        snapshot: &mut Snapshot,
    ) -> Result<Option<f64>, RunError> {
        let acting = self.acting();
        let cx = Context { sampled: &acting, ..cx };
        // Where the step at hand starts nothing of it is in the past.
        let Some(Target { from, to, behind, .. }) = self.step.filter(|step| at > step.from) else {
            self.solver.stepper_mut().complete(cx, &mut self.recorder, 0)?;
            snapshot.evaluation.clone_from(&self.recorder.evaluations[0]);
            self.recorder.read(cx, None, row, snapshot)?;
            return Ok(None);
        };
        let theta = if at == to { 1.0 } else { (at - from) / (to - from) };
        if at == to && behind != Behind::Break {
            self.solver.stepper_mut().complete(cx, &mut self.recorder, 1)?;
            snapshot.evaluation.clone_from(&self.recorder.evaluations[STAGES]);
        } else {
            self.solver.stepper_mut().interpolate(cx, &mut self.recorder, at, theta, &mut snapshot.evaluation)?;
        }
        self.recorder.read(cx, Some(theta), row, snapshot)?;
        Ok(Some(theta))
    }

    /// As [`Self::read`], with the derivatives that rows tell.
    ///
    /// # Errors
    /// As there.
    pub(super) fn show(
        &mut self,
        cx: Context,
        at: f64,
        row: usize,
        snapshot: &mut Snapshot,
    ) -> Result<Option<f64>, RunError> {
        let theta = self.read(cx, at, row, snapshot)?;
        let Some(by) = &cx.system.sensitivity else { return Ok(theta) };
        let mut derivatives = std::mem::take(&mut snapshot.derivatives);
        derivatives.clear();
        let is_of_motion = by.columns.iter().all(|column| Variation::is_of_motion(&cx.system.model, column.of));
        let variation = if by.columns.is_empty() { None } else { self.vary(theta, snapshot, is_of_motion) };
        // All parameters of a column stand together.
        for columns in by.columns.chunk_by(|one, next| one.of == next.of) {
            let values = variation.and_then(|variation| variation.values(columns[0].of, snapshot));
            // Empty where the column is.
            let values = values.filter(|_| !snapshot.value(columns[0].of).is_nan());
            let finite = |value: f64| if value.is_finite() { value } else { f64::NAN };
            let value = |by: usize| values.as_ref().map_or(f64::NAN, |values| finite(values[by]));
            derivatives.extend(columns.iter().map(|column| value(column.by)));
        }
        snapshot.derivatives = derivatives;
        Ok(theta)
    }

    /// What parameters change at the row that was read into `snapshot` last, at θ of the step at hand or between two; of the motion alone where
    /// nothing else is asked for.
    pub(super) fn vary(&mut self, theta: Option<f64>, snapshot: &Snapshot, is_of_motion: bool) -> Option<&Variation> {
        let Self { solver, recorder, step, .. } = self;
        recorder.variation.as_ref()?;
        let within = theta.zip(*step).map(|(theta, step)| (theta, step.size));
        solver.stepper_mut().vary_within(recorder, within, snapshot);
        let Recorder { equations, variation, .. } = recorder;
        let variation = variation.as_deref_mut()?;
        if !is_of_motion {
            variation.read(equations, theta, snapshot);
        }
        Some(variation)
    }

    /// How stiff element `e` is over a step, N/m or N·m/rad; 0 where it takes no steps.
    pub(super) fn stiffness(&self, cx: Context, e: usize) -> f64 {
        let bank = &self.recorder.equations.bank;
        let stiffness = cx.system.elements[e].law.stiffness(&bank.point(e, 0), bank.size().recip());
        if stiffness.is_finite() { stiffness } else { 0.0 }
    }

    /// As [`Self::read`], for what `needs` say alone.
    ///
    /// # Errors
    /// As there.
    pub(super) fn glance(
        &mut self,
        cx: Context,
        at: f64,
        needs: Needs,
        snapshot: &mut Snapshot,
    ) -> Result<(), RunError> {
        if needs >= Needs::Forces {
            return self.read(cx, at, 0, snapshot).map(|_| ());
        }
        let (recorder, evaluation) = (&mut self.recorder, &mut snapshot.evaluation);
        match self.step {
            Some(Target { from, to, behind, .. }) if at > from && (at < to || behind == Behind::Break) => {
                let theta = if at == to { 1.0 } else { (at - from) / (to - from) };
                self.solver.stepper_mut().place(cx, recorder, at, theta, evaluation)?;
            }
            step => {
                let node = step.filter(|step| at > step.from).map_or(0, |_| STAGES);
                evaluation.q.copy_from_slice(&recorder.evaluations[node].q);
                evaluation.v.copy_from_slice(&recorder.evaluations[node].v);
            }
        }
        cx.fill_readings((at, needs), None, &mut recorder.scratch, evaluation)
    }

    /// As [`Self::glance`], at the start (0) or at a node of the step at hand; gives θ.
    ///
    /// # Errors
    /// As there.
    pub(super) fn glance_at_node(
        &mut self,
        cx: Context,
        node: usize,
        needs: Needs,
        snapshot: &mut Snapshot,
    ) -> Result<f64, RunError> {
        let Target { from, to, .. } = self.step.expect("a step at hand");
        let theta = if node == 0 { 0.0 } else { RADAU_NODES[node - 1] };
        let at = if node == STAGES { to } else { from + theta * (to - from) };
        match self.solver.stepper().kinematics(&self.recorder.equations, node) {
            Some(kinematics) => {
                let (known, evaluation) = (&self.recorder.evaluations[node], &mut snapshot.evaluation);
                evaluation.q.copy_from_slice(&known.q);
                evaluation.v.copy_from_slice(&known.v);
                cx.fill_readings((at, needs), Some(kinematics), &mut self.recorder.scratch, evaluation)?;
            }
            None => self.glance(cx, at, needs, snapshot)?,
        }
        Ok(theta)
    }

    /// What tells system and settings from others.
    fn fingerprint(&self, cx: Context) -> u64 {
        *self.fingerprint.get_or_init(|| fingerprint(cx.system, &self.recorder.settings))
    }

    /// What it takes to go on; everything is settled.
    pub(super) fn state(&self, cx: Context) -> DriverState {
        DriverState {
            system: self.fingerprint(cx),
            recorder: self.recorder.state(),
            variation: self.recorder.variation.as_ref().map(|variation| variation.save()),
            sampler: self.sampler.as_ref().map(|sampler| sampler.state()),
            solver: self.solver.save(),
            t: self.t,
            h: self.h,
            crossing: self.crossing,
            is_own: self.is_own,
            tick: self.tick,
            steps: self.steps,
            rejected_steps: self.rejected_steps,
        }
    }

    /// Goes on from a state of the same system and settings.
    ///
    /// # Errors
    /// [`RunError::OtherRun`], and the driver as it was.
    pub(super) fn go_on(&mut self, cx: Context, state: DriverState) -> Result<(), RunError> {
        let DriverState {
            system,
            recorder,
            variation,
            sampler,
            solver,
            t,
            h,
            crossing,
            is_own,
            tick,
            steps,
            rejected_steps,
        } = state;
        if system != self.fingerprint(cx) || !self.solver.fits(&solver) || !self.recorder.go_on(recorder) {
            return Err(RunError::OtherRun);
        }
        let samples = match (&mut self.sampler, sampler) {
            (None, None) => true,
            (Some(own), Some(state)) => own.go_on(state),
            _ => false,
        };
        if !samples {
            return Err(RunError::OtherRun);
        }
        let acting = self.acting();
        let cx = Context { sampled: &acting, ..cx };
        self.solver.load(cx, &mut self.recorder, solver)?;
        (self.t, self.h, self.step, self.crossing, self.is_own) = (t, h, None, crossing, is_own);
        self.planned = h;
        (self.tick, self.steps, self.rejected_steps) = (tick, steps, rejected_steps);
        self.load_variation(cx, variation)
    }

    /// What the run did, but for its rows.
    pub(super) fn report(&self) -> Report {
        let explicit = self.solver.stepper().explicit();
        Report {
            steps: self.steps,
            rejected_steps: self.rejected_steps,
            newton_iterations: self.solver.stepper().newton_iterations(),
            explicit_steps: explicit.map(|effort| effort.steps),
            evaluations: explicit.map(|effort| effort.evaluations),
            method_switches: explicit.map(|effort| effort.switches),
            modes: self.recorder.equations.bank.modes(),
            switches: self.switches(),
            resolution: self.switches().map(|_| FINEST * self.recorder.settings.end),
            ..Report::default()
        }
    }
}

/// By what a run is differentiated: with columns of its own where it is recorded, to go back through it.
fn recording_of(
    cx: Context,
    by: &Arc<Sensitivity>,
    equations: &Equations,
    (sampler, has_fixed_steps): (Option<&Sampler>, bool),
) -> (Option<Recording>, Arc<Sensitivity>) {
    let Some(quantities) = &by.adjoint else { return (None, by.clone()) };
    let samples = sampler.map_or(0, Sampler::numbers);
    let (recording, by) = Recording::of(cx.system, by, quantities, equations, (samples, has_fixed_steps));
    (Some(recording), by)
}

/// Refuses to go back to starts whose changes are in memories already: of pasts, and of what jumps at t = 0 before springpots in series.
///
/// # Errors
/// [`SensitivityError::Backwards`].
fn refuse_to_go_back(system: &System, equations: &Equations) -> Result<(), RunError> {
    for (e, element) in system.elements.iter().enumerate() {
        let Some(state) = equations.bank.law_state(e) else { continue };
        let keeps = element.law.has_inner_variables() || !state.memories().is_empty();
        let is_past = keeps && !element.past.is_of_derivative();
        let jumps = element.derivative == Derivative::RiemannLiouville && element.law.has_memories_in_series();
        if is_past || jumps {
            let what = match is_past {
                true => format!("the past of \"{}\"", element.name),
                false => format!("springpots in series that jump at t = 0, of \"{}\"", element.name),
            };
            return Err(SensitivityError::Backwards { what }.into());
        }
    }
    Ok(())
}

/// The end of a step of size h from t that must not pass `stop`; the last two steps before it share what is left.
fn end_of(t: f64, h: f64, stop: f64) -> f64 {
    let left = stop - t;
    if h >= left * (1.0 - 1e-9) {
        stop
    } else if h > 0.5 * left {
        t + 0.5 * left
    } else {
        t + h
    }
}
