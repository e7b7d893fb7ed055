//! What the driver asks of a method that takes steps.

use crate::account::recorder::Recorder;
use crate::dynamics::Kinematics;
use crate::equations::ROW;
use crate::equations::context::Context;
use crate::equations::evaluate::Evaluation;
use crate::equations::{Change, Equations, Look};
use crate::observe::Snapshot;
use crate::signal::Agenda;
use crate::system::error::RunError;
use crate::system::settings::Settings;

/// A step to be tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Target {
    /// Where it starts and ends, s.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Its size, s.
    pub(crate) size: f64,
    /// What is behind its end.
    pub(crate) behind: Behind,
}

/// What follows at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Behind {
    /// The next step.
    Step,
    /// The next step, beyond a break point of the signals: only their left side belongs to the step.
    Break,
    /// A kink or jump, whose first time on the far side this is.
    Kink(f64),
    /// A change of the robot's own: what follows starts anew.
    Change,
}

impl Target {
    /// The time of the inputs at its end.
    pub(super) fn end_inputs(&self) -> f64 {
        if self.behind == Behind::Break { self.to.next_down() } else { self.to }
    }

    /// Where the next step starts, if not at its end as if nothing were.
    pub(crate) fn crossing(&self) -> Option<f64> {
        match self.behind {
            Behind::Step => None,
            Behind::Break | Behind::Change => Some(self.to),
            Behind::Kink(after) => Some(after),
        }
    }
}

/// What became of a step that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Trial {
    /// It meets the tolerance, perhaps as a shorter one; `next` is the size that the one after it may have.
    Accepted { step: Target, next: f64 },
    /// It does not: this size may.
    Rejected { size: f64 },
    /// Something changes at its very start, which is to be crossed first.
    Changes,
}

/// What explicit steps took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExplicitEffort {
    pub(crate) steps: u64,
    /// Solves for accelerations.
    pub(crate) evaluations: u64,
    /// How often another method took over.
    pub(crate) switches: u64,
}

/// A method that takes steps. It fills the evaluations of the recorder and tells the bank.
pub(crate) trait Stepper: std::fmt::Debug + Send + Sync {
    /// The longest step, s.
    fn longest_step(&self, cx: Context, settings: &Settings) -> f64;

    /// Makes the recorder of a new run fit for it.
    fn set_up(&self, _recorder: &mut Recorder) {}

    /// The size of steps that are all of one size, s; none of those that are chosen and end on what the signals do.
    fn fixed_step(&self) -> Option<f64> {
        None
    }

    /// Whether steps end on rows that are farther apart than steps are long.
    fn ends_on_sparse_rows(&self) -> bool {
        false
    }

    /// Goes to t = 0: the first evaluation is there and its elements have begun; gives the size of the first step.
    ///
    /// # Errors
    /// What keeps a run from starting.
    fn start(&mut self, cx: Context, recorder: &mut Recorder, agenda: &Agenda) -> Result<f64, RunError>;

    /// How long a step from t may be, at most `h`, beyond what the signals ask for.
    fn reach(&self, _t: f64, h: f64) -> f64 {
        h
    }

    /// Solves a step without taking it into the past: gives the size that the next one may have, or one to try instead.
    ///
    /// # Errors
    /// Where no step leads on.
    fn solve(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<Result<f64, f64>, RunError>;

    /// The first change in the step that was solved last.
    ///
    /// # Errors
    /// What a row inside the step may show.
    fn look(&mut self, _: Context, _: &mut Recorder, _: &Target) -> Result<Look, RunError> {
        Ok(Look::Nothing)
    }

    /// How far a change is away at θ of the step that was solved last; negative behind it.
    fn value(&mut self, _: Context, _: &mut Recorder, _: &Target, _: Change, _theta: f64) -> f64 {
        0.0
    }

    /// What becomes of a step that was solved and in which nothing changes before its end; `next` is the size that the one after it may have.
    ///
    /// # Errors
    /// Where no step leads on, or what is behind the end must not jump.
    fn judge(&mut self, _: Context, _: &mut Recorder, step: Target, next: f64) -> Result<Trial, RunError> {
        Ok(Trial::Accepted { step, next })
    }

    /// Why a step of size `size` is not tried in place of one in which no first change was found, where there is no point in it.
    fn gives_up(&self, _: Context, _: &Recorder, _: &Target, _size: f64) -> Option<RunError> {
        None
    }

    /// Works out what parameters change over the step at hand.
    ///
    /// # Errors
    /// Where nothing changes in one way.
    fn vary(&mut self, _: Context, _: &mut Recorder, _: &Target) -> Result<(), RunError> {
        Ok(())
    }

    /// Works out what parameters change of the motion at θ of the step at hand, whose size is given too, or between two, as a row is asked for that is as
    /// `shown`: into node [`ROW`].
    fn vary_within(&mut self, recorder: &mut Recorder, _within: Option<(f64, f64)>, _shown: &Snapshot) {
        recorder.variation.iter_mut().for_each(|variation| variation.take_start(ROW));
    }

    /// The velocities and accelerations that the next step starts with, where those of rows are others: behind an impulse at t = 0, and without the
    /// share of what is infinite there.
    fn starts_with(&self) -> Option<[&[f64]; 2]> {
        None
    }

    /// Takes over what changes where the step starts.
    ///
    /// # Errors
    /// Where changes follow one another without end.
    fn change_at_start(&mut self, _: Context, _: &mut Recorder) -> Result<(), RunError> {
        Ok(())
    }

    /// Makes sure that the evaluation at the start (0) or at the end (1) of the step has all that a row asks for.
    ///
    /// # Errors
    /// What a row there may show.
    fn complete(&mut self, cx: Context, recorder: &mut Recorder, end: usize) -> Result<(), RunError> {
        recorder.complete(cx, end)
    }

    /// Fills q and v of an evaluation at t, θ inside the step that was worked out, 0 < θ ≤ 1.
    ///
    /// # Errors
    /// Where the motion cannot be followed.
    fn place(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError>;

    /// Positions and velocities of the links at the start (0) or at a node of the step that was worked out, where the method knows them.
    fn kinematics<'s>(&'s self, _: &'s Equations, _node: usize) -> Option<&'s Kinematics> {
        None
    }

    /// Fills an evaluation at t, θ inside the step that was worked out, 0 < θ ≤ 1.
    ///
    /// # Errors
    /// What a row there may show.
    fn interpolate(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError>;

    /// Goes on to the end of the step that was worked out and that the recorder has taken.
    ///
    /// # Errors
    /// Where nothing can follow.
    fn accept(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError>;

    /// Goes from the present time to `after`, the far side of what jumps between them or there.
    ///
    /// # Errors
    /// What must not jump.
    fn cross(&mut self, cx: Context, recorder: &mut Recorder, after: f64) -> Result<(), RunError>;

    /// Whether a step is the cubic through its nodes.
    fn is_cubic(&self) -> bool {
        true
    }

    /// What explicit steps took so far, of methods that take some.
    fn explicit(&self) -> Option<ExplicitEffort> {
        None
    }

    /// Newton iterations so far, of methods that take some.
    fn newton_iterations(&self) -> Option<u64> {
        None
    }
}
