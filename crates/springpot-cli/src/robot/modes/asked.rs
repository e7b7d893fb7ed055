//! The scenario at the configuration that the options ask for.

use super::{Problem, Stopped};
use crate::arguments::ModesOptions;
use crate::{Ending, diagnostic};
use serde_json::{Value, json};
use springpot::driver::EquationError;
use springpot::law::Catalog;
use springpot::linear::{Equilibrium, LinearError, Linearisation};
use springpot::system::{Motion, System};
use springpot_run::numbers::{rough, short};
use springpot_scenario::Plan;
use springpot_scenario::units::parse_quantity;

/// A system and its small motions about a configuration.
pub(super) struct Asked {
    pub(super) title: Option<String>,
    pub(super) system: System,
    pub(super) linear: Linearisation,
    pub(super) t: f64,
    equilibrium: Option<Equilibrium>,
}

impl Asked {
    pub(super) fn read(options: &ModesOptions, catalog: &Catalog) -> Result<Self, Stopped> {
        let refused = |refusals| {
            diagnostic::refused(&refusals);
            Stopped::Ended(Ending::Refused)
        };
        let cases = diagnostic::open(&options.file, &options.overrides, catalog).map_err(refused)?;
        let plan = cases.plan(0).map_err(refused)?;
        let t = options.at.as_deref().map_or(Ok(0.0), time)?;
        let system = plan.system();
        diagnostic::robot_warnings(&cases);
        let start = configuration(&system, &plan, options, t)?;
        let refuse = |error: LinearError| Stopped::from((error.to_string(), help(&error).to_owned()));
        let equilibrium = options.equilibrium.then(|| system.equilibrium(&start, t)).transpose().map_err(refuse)?;
        let q = equilibrium.as_ref().map_or(&start, |found| &found.q);
        let linear = system.linearised(q, t).map_err(refuse)?;
        let asked = Self { title: plan.title, system, linear, t, equilibrium };
        asked.warn();
        Ok(asked)
    }

    fn warn(&self) {
        if self.equilibrium.is_none()
            && let Some((joint, torque, unit)) = self.linear.largest_left_over()
        {
            let message =
                format!("the robot does not stay where it is: {} {unit} are missing on {joint}", short(torque));
            diagnostic::warning(message, Some("--equilibrium goes to where it rests".to_owned()));
        }
        if !self.system.control.is_empty() {
            let message = "what follows from the state, by feedback or a controller, is left out: these are the modes of the robot alone";
            diagnostic::warning(message.to_owned(), None);
        }
        for joint in &self.linear.sticking {
            let message = format!("the friction of {joint} sticks, which is not linear: it is left out");
            diagnostic::warning(message, Some("friction_speed makes it smooth; locked holds the joint".to_owned()));
        }
    }

    /// Where it is, in one line: `about the equilibrium, found in 7 steps`.
    pub(super) fn place(&self) -> String {
        let held = matches!(self.system.motion, Motion::Given(_));
        match &self.equilibrium {
            Some(Equilibrium { steps, residual, .. }) => {
                let from = if self.t == 0.0 { "the start".to_owned() } else { format!("t = {} s", short(self.t)) };
                format!("the equilibrium, {steps} steps from {from}, to {} of the forces", rough(*residual))
            }
            None if held => format!("t = {} s at rest, held by constant actuator forces", short(self.t)),
            None if self.t == 0.0 => "the start, at rest".to_owned(),
            None => format!("t = {} s, at rest", short(self.t)),
        }
    }

    /// Names, values and units of the coordinates.
    pub(super) fn coordinates(&self) -> Vec<(String, f64, &'static str)> {
        let labels = self.system.model.q_labels();
        let named = labels.into_iter().zip(&self.linear.q);
        named.map(|(label, q)| (label.name, *q, label.dimension.units().coordinate)).collect()
    }

    /// What all files of data say first.
    pub(super) fn json(&self) -> Value {
        let coordinates = self.coordinates();
        json!({
            "t": self.t, "equilibrium": self.equilibrium.is_some(),
            "q_names": coordinates.iter().map(|(name, ..)| name).collect::<Vec<_>>(), "q": self.linear.q,
            "velocities": self.linear.velocity_names(), "left_over": self.linear.left_over,
        })
    }
}

/// The configuration at `t`: of forward dynamics behind t = 0 that of a run until then.
fn configuration(system: &System, plan: &Plan, options: &ModesOptions, t: f64) -> Result<Vec<f64>, Stopped> {
    let at = options.at.as_deref().unwrap_or("0");
    let outside = (format!("--at {at}: {}", EquationError::Outside { t, end: plan.settings.end }), in_the_motion());
    if !(0.0..=plan.settings.end).contains(&t) {
        return Err(outside.into());
    }
    let failed = |error: &dyn std::fmt::Display| {
        diagnostic::error(error.to_string());
        Stopped::Ended(Ending::Failed)
    };
    if t > 0.0 && matches!(system.motion, Motion::Forward(_)) {
        return system.equation(&plan.settings, t).map(|equation| equation.state.q).map_err(|error| failed(&error));
    }
    system.state(t).map(|state| state.q).map_err(|error| failed(&error))
}

fn in_the_motion() -> String {
    "write a time such as 0.5 or \"500 ms\" within the motion".to_owned()
}

fn time(text: &str) -> Result<f64, Problem> {
    match parse_quantity(text, "s", &|_| None) {
        Ok(time) if time.is_finite() => Ok(time),
        Ok(_) => Err((format!("--at {text}: not a finite number"), in_the_motion())),
        Err(error) => Err((format!("--at {text}: {error}"), in_the_motion())),
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
