//! What can stop a run.

use super::sensitivity::SensitivityError;
use crate::fractional::KernelError;
use crate::fractional::scheme::SchemeError;
use crate::motion::PathError;

/// Why a run stopped or a simulation refused; what happens on the way names the time.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The run cannot be differentiated.
    #[error(transparent)]
    Sensitivity(#[from] SensitivityError),
    /// The points that an element joins met, so that its direction is undefined.
    #[error("t = {} s: element \"{element}\" has no direction: its points met (length {length:.1e} m)", seconds(*.t))]
    ZeroLength {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// Length, m.
        length: f64,
    },
    /// The ends of a segment of a cable met, so that its direction is undefined.
    #[error(
        "t = {} s: element \"{element}\" has no direction: the points of segment {segment} of its cable met (length {length:.1e} m)",
        seconds(*.t)
    )]
    SegmentLength {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// The segment, from 1.
        segment: usize,
        /// Its length, m.
        length: f64,
    },
    /// The frames of a bushing came to half a turn, where their rotation vector jumps.
    #[error(
        "t = {} s: element \"{element}\" is turned by {angle:.4} rad: a bushing's rotation vector jumps at half a turn, pi",
        seconds(*.t)
    )]
    HalfTurn {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// Turn of its frames against each other, rad.
        angle: f64,
    },
    /// A signal gave NaN or infinity.
    #[error("t = {} s: {what} is {value}, not a finite number", seconds(*.t))]
    NotFinite {
        /// Time, s.
        t: f64,
        /// Which signal or result.
        what: String,
        /// Its value.
        value: f64,
    },
    /// An input broke a rule of its law.
    #[error("t = {} s: element \"{element}\": {rule}", seconds(*.t))]
    Rule {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// The rule.
        rule: String,
    },
    /// What temperature does to an element has no answer: a shift, an expansion, losses that warm it.
    #[error("t = {} s: element \"{element}\": {why}", seconds(*.t))]
    Heat {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// Why, and what would have one.
        why: String,
    },
    /// An input left the range of its law.
    #[error("t = {} s: element \"{element}\": input {input} = {value} lies outside {low} … {high}", seconds(*.t))]
    InputRange {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// Input.
        input: String,
        /// Its value, SI.
        value: f64,
        /// Smallest admissible value.
        low: f64,
        /// Largest admissible value.
        high: f64,
    },
    /// An element warmed itself beyond what materials are known at.
    #[error(
        "t = {} s: element \"{element}\" runs away: it has warmed itself to {temperature:.1} K, above {highest} K: it loses more than its \
         surroundings take",
        seconds(*.t)
    )]
    RunAway {
        /// Time, s.
        t: f64,
        /// Element.
        element: String,
        /// Its temperature, K.
        temperature: f64,
        /// The highest that is admissible, K.
        highest: f64,
    },
    /// A coordinate jumps.
    #[error("t = {} s: joint \"{joint}\" jumps by {jump:e}; a motion must be continuous", seconds(*.t))]
    Jump {
        /// Time, s.
        t: f64,
        /// Joint.
        joint: String,
        /// Height of the jump, rad or m.
        jump: f64,
    },
    /// No step is small enough.
    #[error(
        "t = {} s: no step meets the tolerance: {h:.1e} s still {} in {subject}; {}",
        seconds(*.t),
        errs(*.error),
        if *.error < FAR_OFF { "raise solver.rtol, or slow down what is that fast, such as a gain" } else { TOO_FAST }
    )]
    StepTooSmall {
        /// Time, s.
        t: f64,
        /// Step tried, s.
        h: f64,
        /// Error in units of the tolerance.
        error: f64,
        /// Worst element, or the energy.
        subject: String,
    },
    /// The step of a fixed-step method is too long.
    #[error(
        "t = {} s: a step of {} s is too long: no finite acceleration of {joint} solves it; take a shorter solver.step",
        seconds(*.t),
        seconds(*.h)
    )]
    FixedStep {
        /// Time, s.
        t: f64,
        /// Step size, s.
        h: f64,
        /// Joint.
        joint: String,
    },
    /// The equations of motion of a step have no solution that the iteration finds.
    #[error("t = {} s: the motion cannot go on: joint \"{joint}\" settles in no step down to {h:e} s", seconds(*.t))]
    NoConvergence {
        /// Time, s.
        t: f64,
        /// Step tried, s.
        h: f64,
        /// The joint that is farthest off.
        joint: String,
    },
    /// Joints stick and slide without getting on.
    #[error(
        "t = {} s: joint \"{joint}\" sticks and slides without getting on: {count} changes within {span:.1e} s; \
         give its friction a speed in place of stick = true",
        seconds(*.t)
    )]
    Chatter {
        /// Time, s.
        t: f64,
        /// The joint that changed last.
        joint: String,
        /// Changes between holding and sliding.
        count: u32,
        /// Within this time, s.
        span: f64,
    },
    /// Events set one another off without getting on.
    #[error(
        "t = {} s: event \"{event}\" acts again and again without getting on: {count} events act within {span:.1e} s; \
         leave a gap between what sets them off",
        seconds(*.t)
    )]
    EventChatter {
        /// Time, s.
        t: f64,
        /// The event that acted last.
        event: String,
        /// How many acted.
        count: u32,
        /// Within this time, s.
        span: f64,
    },
    /// The reference of a controller jumps.
    #[error(
        "t = {} s: the reference of {what} jumps by {jump:e}; computed torque and D^mu of an error would answer with an impulse: \
         write one that is continuous, such as a move",
        seconds(*.t)
    )]
    ReferenceJump {
        /// Time, s.
        t: f64,
        /// The joint, or the gripper's path.
        what: String,
        /// Height of the jump, rad or m.
        jump: f64,
    },
    /// A law is sampled between the steps of one size.
    #[error(
        "{what} is sampled every {period} s, which is no whole number of steps of {step} s: steps of one size know the state at their ends alone"
    )]
    SampleBetweenSteps {
        /// What is sampled.
        what: String,
        /// Time between two samples, s.
        period: f64,
        /// Size of the steps, s.
        step: f64,
    },
    /// Feedback goes to and fro between two branches without getting on.
    #[error(
        "t = {} s: {what} switches again and again without getting on: {count} times within {span:.1e} s; leave a gap between where it \
         switches on and off, write a smooth function such as tanh(s/s0) in place of sign(s), or sample it",
        seconds(*.t)
    )]
    ControlChatter {
        /// Time, s.
        t: f64,
        /// What switches.
        what: String,
        /// The column of what an expression says; none where it is the controller.
        signal: Option<String>,
        /// How many times.
        count: u32,
        /// Within this time, s.
        span: f64,
    },
    /// The force of an element jumps to and fro without getting on.
    #[error(
        "t = {} s: the force of element \"{element}\" jumps again and again without getting on: {count} times within {span:.1e} s; \
         write a force that is continuous, such as friction(f, v0) or tanh(v/v0) in place of sign(v), or jenkins(k, F_y), which sticks",
        seconds(*.t)
    )]
    ForceChatter {
        /// Time, s.
        t: f64,
        /// Whose.
        element: String,
        /// How many times.
        count: u32,
        /// Within this time, s.
        span: f64,
    },
    /// Which joints hold by friction and which slide has no answer.
    #[error(
        "t = {} s: no friction between -force and force of joint \"{joint}\" goes with the forces on it; \
         give its friction a speed in place of stick = true",
        seconds(*.t)
    )]
    NoHold {
        /// Time, s.
        t: f64,
        /// A joint that finds no friction.
        joint: String,
    },
    /// An accepted inertia is negative where the motion comes.
    #[error(
        "t = {} s: the mass matrix is not positive definite at joint \"{joint}\": what it moves has a negative inertia here, \
         which was accepted; correct the inertia of these bodies",
        seconds(*.t)
    )]
    IndefiniteMassMatrix {
        /// Time, s.
        t: f64,
        /// The joint.
        joint: String,
    },
    /// The explicit method was asked for, which is not for this system.
    #[error("solver.method = \"explicit\": {0}; leave it out, and the run chooses")]
    NotExplicit(#[from] super::explicit::Unfit),
    /// The explicit method was asked for, and stability keeps its steps short.
    #[error(
        "t = {} s: the motion is stiff: stability, not accuracy, keeps explicit steps at {h:.1e} s; leave out \
         solver.method = \"explicit\", and the run goes on with \"radau\" where it is",
        seconds(*.t)
    )]
    TooStiff {
        /// Time, s.
        t: f64,
        /// Size of the steps, s.
        h: f64,
    },
    /// More steps than allowed.
    #[error("t = {} s: {limit} steps are used up (solver.max_steps)", seconds(*.t))]
    TooManySteps {
        /// Time, s.
        t: f64,
        /// The limit.
        limit: u64,
    },
    /// The longest steps that the run may take are too many.
    #[error("steps are at most {} s long, so that the run takes {}, and {limit} are allowed", seconds(*longest), at_least(*.times))]
    TooShortSteps {
        /// The longest step, s.
        longest: f64,
        /// Steps that it takes at least.
        times: f64,
        /// The limit.
        limit: u64,
    },
    /// Signals change more often than the run may take steps.
    #[error(
        "{what} changes too often: it takes {}, and {limit} are allowed; raise solver.max_steps or shorten the run",
        at_least(*.times)
    )]
    TooBusy {
        /// Which signal, or all of them.
        what: String,
        /// Steps that it takes at least.
        times: f64,
        /// The limit.
        limit: u64,
    },
    /// A row contradicts the step that it lies in.
    #[error(
        "t = {} s: the steps missed what the motion does: at this row the rate of element \"{element}\" departs from its step by {departure:.1e} of its largest derivative; the rows are kept; give solver.max_step a time in which the motion changes little",
        seconds(*.t)
    )]
    Missed {
        /// Time of the first such row, s.
        t: f64,
        /// Element.
        element: String,
        /// Departure in units of the largest D^alpha x so far.
        departure: f64,
    },
    /// At a row an expression of the state is not what its step used.
    #[error(
        "t = {} s: the steps missed what the motion does: at this row the expression \"{expression}\" of {column} is {is:.6e}, and its step went with {used:.6e}; the rows are kept; give solver.max_step a time in which the motion changes little",
        seconds(*.t)
    )]
    MissedKink {
        /// Time of the first such row, s.
        t: f64,
        /// The expression.
        expression: String,
        /// The column of what it says.
        column: String,
        /// Its value there, SI.
        is: f64,
        /// What its step used, SI.
        used: f64,
    },
    /// The energies do not balance.
    #[error(
        "t = {} s: the energy balance is off by {residual:.1e} J of {turned_over:.1e} J turned over: the results are wrong or the motion is not what it seems; the rows are kept; try a smaller solver.max_step",
        seconds(*.t)
    )]
    Unbalanced {
        /// Time of the largest residual, s.
        t: f64,
        /// The residual, J.
        residual: f64,
        /// The energy turned over, J.
        turned_over: f64,
    },
    /// The memory of an element could not be built.
    #[error("t = 0 s: element \"{element}\": {source}")]
    Kernel {
        /// Element.
        element: String,
        /// Reason.
        source: KernelError,
    },
    /// A named offline scheme cannot run on this grid.
    #[error("element \"{element}\": {source}")]
    Scheme {
        /// Element.
        element: String,
        /// Reason.
        source: SchemeError,
    },
    /// Interrupted by the user.
    #[error("interrupted at t = {} s", seconds(*.t))]
    Interrupted {
        /// Time reached, s.
        t: f64,
    },
    /// A checkpoint or state was taken from another system.
    #[error("the checkpoint belongs to another run")]
    OtherRun,
    /// A setting with which no step can be taken.
    #[error("{what} must be positive and finite, not {value}")]
    Setting {
        /// Its key in a scenario.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A named scheme works on complete motions alone.
    #[error("element \"{element}\" has a named scheme, which works on motions given in advance and complete alone")]
    NoStepping {
        /// Element.
        element: String,
    },
    /// A time that cannot be gone to or looked at.
    #[error("t = {} s lies outside {from} … {to} s", seconds(*.t))]
    Outside {
        /// Time, s.
        t: f64,
        /// Earliest time, s.
        from: f64,
        /// Latest time, s.
        to: f64,
    },
    /// No force drives that velocity.
    #[error("no force drives velocity {velocity}: there is none, or its motion is given")]
    NotDriven {
        /// Index of the velocity.
        velocity: usize,
    },
    /// No such input.
    #[error("element {element} has no input {input}")]
    NoInput {
        /// Index of the element.
        element: usize,
        /// Index of the input.
        input: usize,
    },
    /// The motion cannot be followed.
    #[error("{0}")]
    Path(PathError),
    /// Rows could not be written.
    #[error("rows could not be written: {0}")]
    Output(#[from] std::io::Error),
}

/// An error in units of the tolerance that no tolerance is meant for, and what then helps.
const FAR_OFF: f64 = 1e3;
const TOO_FAST: &str = "something acts faster than any step: look for a duration or a capacity that is too small, or a gain that is too large; \
    where so small a motion does not matter, solver.atol says from which size on it does";

/// By how much a step errs.
fn errs(error: f64) -> String {
    match error {
        error if error < FAR_OFF => format!("errs {error:.1} times too much"),
        error if error.is_finite() => format!("errs {error:.0e} times too much"),
        _ => "has no finite error".to_owned(),
    }
}

/// A number of steps that may be beyond all counting.
fn at_least(steps: f64) -> String {
    if steps.is_finite() { format!("at least {steps:.1e} steps") } else { "more steps than can be counted".into() }
}

/// A time as messages say it: with an exponent where its zeros would be counted.
fn seconds(t: f64) -> String {
    if t == 0.0 || (1e-5..1e15).contains(&t.abs()) { format!("{t}") } else { format!("{t:e}") }
}

impl RunError {
    /// When it happened, s; `None` where no time is to blame.
    pub fn time(&self) -> Option<f64> {
        match self {
            Self::ZeroLength { t, .. }
            | Self::SegmentLength { t, .. }
            | Self::HalfTurn { t, .. }
            | Self::NotFinite { t, .. }
            | Self::Rule { t, .. }
            | Self::Heat { t, .. }
            | Self::InputRange { t, .. }
            | Self::RunAway { t, .. }
            | Self::Jump { t, .. }
            | Self::StepTooSmall { t, .. }
            | Self::FixedStep { t, .. }
            | Self::NoConvergence { t, .. }
            | Self::Chatter { t, .. }
            | Self::EventChatter { t, .. }
            | Self::ReferenceJump { t, .. }
            | Self::ControlChatter { t, .. }
            | Self::ForceChatter { t, .. }
            | Self::NoHold { t, .. }
            | Self::IndefiniteMassMatrix { t, .. }
            | Self::TooManySteps { t, .. }
            | Self::TooStiff { t, .. }
            | Self::Missed { t, .. }
            | Self::MissedKink { t, .. }
            | Self::Unbalanced { t, .. }
            | Self::Interrupted { t }
            | Self::Outside { t, .. } => Some(*t),
            Self::Kernel { .. } => Some(0.0),
            Self::Path(error) => Some(error.t()),
            Self::TooShortSteps { .. }
            | Self::TooBusy { .. }
            | Self::SampleBetweenSteps { .. }
            | Self::Scheme { .. }
            | Self::OtherRun
            | Self::Setting { .. }
            | Self::NoStepping { .. }
            | Self::NotExplicit(_)
            | Self::NotDriven { .. }
            | Self::NoInput { .. }
            | Self::Sensitivity(_)
            | Self::Output(_) => None,
        }
    }

    /// That of an element whose memory cannot be built.
    pub(crate) fn of_kernel(element: &str) -> impl Fn(KernelError) -> Self + '_ {
        move |source| Self::Kernel { element: element.to_owned(), source }
    }

    /// That of an element whose temperature, which stretches it, jumps.
    pub(crate) fn heat_jump(t: f64, element: &str, before: f64, after: f64) -> Self {
        let why =
            format!("it expands by a temperature that does not jump, here from {before} to {after} K: give it a ramp");
        Self::Heat { t, element: element.to_owned(), why }
    }
}

impl From<PathError> for RunError {
    fn from(error: PathError) -> Self {
        match error {
            PathError::Interrupted { t } => Self::Interrupted { t },
            error => Self::Path(error),
        }
    }
}
