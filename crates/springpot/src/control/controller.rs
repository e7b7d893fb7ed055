//! What a law of control answers.

use super::shaping::Shaping;
use super::variation::ControllerVariation;
use crate::dynamics::{Kinematics, RneaDerivatives, Workspace};
use crate::model::{Model, Site};
use std::fmt;

/// A law of control: actuator forces from the state and from what it aims at.
///
/// It is asked at one time and keeps nothing: what hangs on the past of an error is one of its [`ErrorTerm`]s, which whoever takes the steps keeps for
/// it. It may be asked any number of times. Its forces act on the velocities that forces drive; elsewhere what it says counts for nothing.
///
/// ```
/// use springpot::control::{At, Controller, Scratch};
///
/// /// τ = −k·v: a brake on every joint.
/// #[derive(Debug)]
/// struct Brake(f64);
///
/// impl Controller for Brake {
///     fn torque(&self, at: &At, _: &mut Scratch, tau: &mut [f64]) {
///         tau.iter_mut().zip(at.v).for_each(|(tau, v)| *tau = -self.0 * v);
///     }
/// }
/// ```
pub trait Controller: fmt::Debug + Send + Sync {
    /// τ (nv) without its error terms, N·m or N; all entries are written.
    fn torque(&self, at: &At, scratch: &mut Scratch, tau: &mut [f64]);

    /// ∂τ/∂q and ∂τ/∂v, nv × nv, row-major, which are 0 at first. What is left out costs iterations, no accuracy.
    fn slopes(&self, _at: &At, _scratch: &mut Scratch, _slopes: &mut TorqueSlopes) {}

    /// The terms of its forces that hang on the past of an error.
    fn error_terms(&self) -> Vec<ErrorTerm> {
        Vec::new()
    }

    /// The terms kd·ė of its forces as such of order 1, which stand in [`Self::error_terms`] where their derivatives go through a filter
    /// ([`super::Shaping`]); its forces are without them then ([`At::derived`]).
    fn rate_terms(&self) -> Vec<ErrorTerm> {
        Vec::new()
    }

    /// Whether the generalized forces of the elements are taken off its forces.
    fn compensates_elements(&self) -> bool {
        false
    }

    /// Whether it follows accelerations of its reference, which may not jump then.
    fn follows_accelerations(&self) -> bool {
        false
    }

    /// What it says where its run is differentiated; `None`: nothing is known of that, and such a run is refused.
    fn variation(&self) -> Option<&dyn ControllerVariation> {
        None
    }
}

/// A term gain·D^order e of the force on one velocity, e the error of its coordinate, terminal 0 (Caputo).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorTerm {
    /// The velocity, of a joint of one degree.
    pub velocity: usize,
    /// −1 ≤ order < 0: an integral; 0 < order < 1, and 1 through a filter: a derivative.
    pub order: f64,
    /// Its factor, N·m/(rad·s^−order) or N/(m·s^−order).
    pub gain: f64,
}

/// What a controller aims at, at one time.
#[derive(Debug, Clone, Default)]
pub struct Aim {
    /// q_d (nq), v_d, a_d (nv).
    pub q: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Where the gripper should be and how fast, m and m/s.
    pub gripper: [[f64; 3]; 2],
}

/// The robot at the time at which a controller is asked.
#[derive(Debug, Clone, Copy)]
pub struct At<'a> {
    /// The robot.
    pub model: &'a Model,
    /// Its gripper.
    pub gripper: Option<&'a Site>,
    /// Time, s.
    pub t: f64,
    /// Coordinates (nq).
    pub q: &'a [f64],
    /// Velocities (nv).
    pub v: &'a [f64],
    /// Positions and velocities of the links there.
    pub kinematics: &'a Kinematics,
    /// The aim.
    pub aim: &'a Aim,
    /// How the parts of the law see its error.
    pub shaping: &'a Shaping,
}

/// ∂τ/∂q and ∂τ/∂v, nv × nv, row-major: row b belongs to τ_b.
#[derive(Debug, Clone, Default)]
pub struct TorqueSlopes {
    /// ∂τ/∂q.
    pub d_q: Vec<f64>,
    /// ∂τ/∂v.
    pub d_v: Vec<f64>,
}

/// Room for what controllers work out, so that none of them allocates.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// Room for the algorithms of `dynamics`.
    pub workspace: Workspace,
    /// Other kinematics than those at hand.
    pub kinematics: Kinematics,
    /// Derivatives of inverse dynamics.
    pub derivatives: RneaDerivatives,
    /// nv numbers.
    pub row: Vec<f64>,
    /// 3·nv numbers, twice.
    pub jacobians: [Vec<f64>; 2],
}

impl Scratch {
    /// Room for a robot.
    pub fn new(model: &Model) -> Self {
        let columns = || vec![0.0; 3 * model.nv()];
        Self {
            workspace: Workspace::new(model),
            kinematics: Kinematics::new(model),
            derivatives: RneaDerivatives::new(model),
            row: vec![0.0; model.nv()],
            jacobians: [columns(), columns()],
        }
    }
}

impl At<'_> {
    /// Error of the coordinate that velocity `k` of a joint of one degree moves, and its rate; zeros for other joints.
    pub fn error(&self, k: usize) -> [f64; 2] {
        self.aim.error(self.model, k, self.q, self.v)
    }

    /// What the proportional part takes: b·q_d − q.
    pub fn weighted(&self, k: usize) -> f64 {
        let weight = self.shaping.weight(k);
        self.model.coordinate_of(k).map_or(0.0, |place| weight * self.aim.q[place] - self.q[place])
    }

    /// The rate that the derivative part takes: q̇_d − q̇, or −q̇; 0 where it goes through a filter.
    pub fn derived(&self, k: usize) -> f64 {
        if self.shaping.filter.is_some() { 0.0 } else { self.taken(k)[1] }
    }

    /// What derivatives of velocity `k` take, and its rate: the error, or −q.
    pub(crate) fn taken(&self, k: usize) -> [f64; 2] {
        self.shaping.taken(self.aim, self.model, k, [self.q, self.v])
    }
}

impl Aim {
    /// Error of the coordinate that velocity `k` of a joint of one degree moves, and its rate; zeros for other joints.
    pub(crate) fn error(&self, model: &Model, k: usize, q: &[f64], v: &[f64]) -> [f64; 2] {
        model.coordinate_of(k).map_or([0.0; 2], |place| [self.q[place] - q[place], self.v[k] - v[k]])
    }
}
