//! The configuration that small motions are about.

use springpot::control::Control;
use springpot::driver::EquationError;
use springpot::linear::{Equilibrium, LinearError, Linearisation};
use springpot::system::{Motion, System};
use springpot_scenario::Plan;
use springpot_scenario::units::parse_quantity;
use std::sync::Arc;

/// Which configuration is meant, and what counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Where<'a> {
    /// The time, as it is written; `None`: the start.
    pub at: Option<&'a str>,
    /// Whether it goes to the equilibrium from there.
    pub equilibrium: bool,
    /// Whether feedback and controllers are left out.
    pub open: bool,
}

/// A system and its small motions about a configuration.
#[derive(Debug, Clone)]
pub struct About {
    /// The system; without control where that is left out.
    pub system: System,
    /// Its small motions.
    pub linear: Linearisation,
    /// The time, s.
    pub t: f64,
    /// How the equilibrium was found.
    pub equilibrium: Option<Equilibrium>,
}

/// Why there is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stopped {
    /// What was asked for does not fit: what is wrong, and what would be right.
    Refused(String, String),
    /// The motion does not come as far.
    Failed(String),
}

/// The small motions of a case.
///
/// # Errors
/// [`Stopped`].
pub fn about(plan: &Plan, place: Where) -> Result<About, Stopped> {
    let t = place.at.map_or(Ok(0.0), time)?;
    let mut system = plan.system();
    let start = configuration(&system, plan, place, t)?;
    if place.open {
        system.control = Arc::new(Control::default());
    }
    let refuse = |error: LinearError| Stopped::Refused(error.to_string(), help(&error).to_owned());
    let equilibrium = place.equilibrium.then(|| system.equilibrium(&start, t)).transpose().map_err(refuse)?;
    let q = equilibrium.as_ref().map_or(&start, |found| &found.q);
    let linear = system.linearised(q, t).map_err(refuse)?;
    Ok(About { system, linear, t, equilibrium })
}

impl About {
    /// Whether something that follows from the state is sampled, which is no part of the small motions; and whether all of it is.
    pub fn sampled(&self) -> [bool; 2] {
        let control = &self.system.control;
        let torques = control.torques.iter().map(|own| own.sampling);
        let inputs = control.inputs.iter().map(|own| own.sampling);
        let controller = control.controller.iter().map(|own| own.sampling);
        let all: Vec<bool> = torques.chain(inputs).chain(controller).map(|sampling| sampling.is_some()).collect();
        [all.contains(&true), !all.contains(&false)]
    }
}

/// The configuration at `t`: of forward dynamics behind t = 0 that of a run until then.
fn configuration(system: &System, plan: &Plan, place: Where, t: f64) -> Result<Vec<f64>, Stopped> {
    let at = place.at.unwrap_or("0");
    if !(0.0..=plan.settings.end).contains(&t) {
        let outside = EquationError::Outside { t, end: plan.settings.end };
        return Err(Stopped::Refused(format!("--at {at}: {outside}"), in_the_motion()));
    }
    let failed = |error: &dyn std::fmt::Display| Stopped::Failed(error.to_string());
    if t > 0.0 && matches!(system.motion, Motion::Forward(_)) {
        return system.equation(&plan.settings, t).map(|equation| equation.state.q).map_err(|error| failed(&error));
    }
    system.state(t).map(|state| state.q).map_err(|error| failed(&error))
}

fn in_the_motion() -> String {
    "write a time such as 0.5 or \"500 ms\" within the motion".to_owned()
}

fn time(text: &str) -> Result<f64, Stopped> {
    match parse_quantity(text, "s", &|_| None) {
        Ok(time) if time.is_finite() => Ok(time),
        Ok(_) => Err(Stopped::Refused(format!("--at {text}: not a finite number"), in_the_motion())),
        Err(error) => Err(Stopped::Refused(format!("--at {text}: {error}"), in_the_motion())),
    }
}

fn help(error: &LinearError) -> &'static str {
    match error {
        LinearError::NothingHolds { .. } => {
            "give it a spring, the torque that it takes, or a place among the `locked` of [motion]; springpots and dashpots \
             hold nothing for ever"
        }
        LinearError::Given => {
            "leave --equilibrium out, and the actuators hold the configuration; or let forces move it: kind = \"forward\""
        }
        LinearError::NoDirection { .. } => "look at --at and at the start of the motion",
        LinearError::Value { .. } => "look at the signal at that time",
        LinearError::NoRest { .. } => "look at preloads and free play of its parts",
    }
}
