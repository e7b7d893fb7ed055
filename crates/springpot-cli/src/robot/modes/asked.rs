//! The scenario at the configuration that the options ask for.

use super::Stopped;
use crate::arguments::ModesOptions;
use crate::diagnostic;
use serde_json::Value;
use springpot::law::Catalog;
use springpot::linear::Equilibrium;
use springpot::system::Motion;
use springpot_run::linear::{self, About, Where};
use springpot_run::numbers::{rough, short};
use springpot_scenario::{Cases, Plan};
use std::path::Path;

/// A system and its small motions about a configuration.
pub(crate) struct Asked {
    pub(crate) title: Option<String>,
    pub(crate) about: About,
}

impl Asked {
    /// The cases of the scenario: those of sweeps on the command line, else of its own.
    pub(crate) fn cases(
        (file, overrides, sweeps): (&Path, &[String], &[String]),
        catalog: &Catalog,
    ) -> Result<Cases, Stopped> {
        let read = || {
            let mut scenario = diagnostic::scenario(file, overrides)?;
            sweeps.iter().try_for_each(|assignment| scenario.sweep(assignment))?;
            scenario.cases(catalog)
        };
        read().map_err(Stopped::told)
    }

    pub(super) fn read(options: &ModesOptions, catalog: &Catalog) -> Result<Self, Stopped> {
        let cases = Self::cases((&options.file, &options.overrides, &[]), catalog)?;
        let asked = Self::of_case(&cases, 0, options)?;
        diagnostic::robot_warnings(&cases);
        asked.warn();
        Ok(asked)
    }

    /// Case `k`, about what the options say.
    pub(super) fn of_case(cases: &Cases, k: usize, options: &ModesOptions) -> Result<Self, Stopped> {
        Self::about(&cases.plan(k).map_err(Stopped::told)?, options.about.place())
    }

    /// The small motions of one case.
    pub(crate) fn about(plan: &Plan, place: Where) -> Result<Self, Stopped> {
        let about = linear::about(plan, place)?;
        Ok(Self { title: plan.title.clone(), about })
    }

    /// Says what the numbers are not about.
    pub(crate) fn warn(&self) {
        if self.about.equilibrium.is_none()
            && let Some((joint, torque, unit)) = self.about.linear.largest_left_over()
        {
            let message =
                format!("the robot does not stay where it is: {} {unit} are missing on {joint}", short(torque));
            diagnostic::warning(message, Some("--equilibrium goes to where it rests".to_owned()));
        }
        let message = "what follows from the state, by feedback or a controller, is left out";
        match self.about.sampled() {
            [false, _] => {}
            [true, true] => diagnostic::warning(format!("{message}: these are the modes of the robot alone"), None),
            [true, false] => diagnostic::warning(format!("{message} where it is sampled"), None),
        }
        for joint in &self.about.linear.sticking {
            let message = format!("the friction of {joint} sticks, which is not linear: it is left out");
            diagnostic::warning(message, Some("friction_speed makes it smooth; locked holds the joint".to_owned()));
        }
    }

    /// Where it is, in one line: `about the equilibrium, found in 7 steps`.
    pub(super) fn place(&self) -> String {
        let held = matches!(self.about.system.motion, Motion::Given(_));
        match &self.about.equilibrium {
            Some(Equilibrium { steps, residual, .. }) => {
                let from =
                    if self.about.t == 0.0 { "the start".to_owned() } else { format!("t = {} s", short(self.about.t)) };
                format!("the equilibrium, {steps} steps from {from}, to {} of the forces", rough(*residual))
            }
            None if held => format!("t = {} s at rest, held by constant actuator forces", short(self.about.t)),
            None if self.about.t == 0.0 => "the start, at rest".to_owned(),
            None => format!("t = {} s, at rest", short(self.about.t)),
        }
    }

    /// Names, values and units of the coordinates.
    pub(super) fn coordinates(&self) -> Vec<(String, f64, &'static str)> {
        let labels = self.about.system.model.q_labels();
        let named = labels.into_iter().zip(&self.about.linear.q);
        named.map(|(label, q)| (label.name, *q, label.dimension.units().coordinate)).collect()
    }

    /// What all files of data say first.
    pub(super) fn json(&self) -> Value {
        linear::about_json(&self.about)
    }
}
