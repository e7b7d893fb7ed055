//! Where in a scenario the cause of a failed run stands, and what can be done.

use crate::elements::plan::ElementPlan;
use crate::plan::Plan;
use crate::plan::events::EventPlan;
use crate::signals::plan::SignalPlan;
use crate::text::refusal::Place;
use springpot::law::{InputValue, heat};
use springpot::system::{Action, RunError, Setting};

/// What an error calls the force of a controller.
const CONTROLLER: &str = "the force of the controller";

/// Where the cause of a failed run stands, and what can be done, as far as it is known.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cure {
    /// Where it stands.
    pub place: Option<Place>,
    /// What can be done, where the error does not say it.
    pub help: Option<String>,
}

impl Plan {
    /// What an error of a run of this plan is about.
    pub fn cure(&self, error: &RunError) -> Cure {
        let element = |name: &str| self.elements.iter().find(|plan| plan.element.name == name);
        let place_of = |plan: Option<&ElementPlan>| plan.map(|plan| plan.place.clone());
        let ends_of = |plan: Option<&ElementPlan>| plan.map(|plan| plan.ends.first().unwrap_or(&plan.place).clone());
        let (place, help) = match error {
            RunError::Rule { t, element: name, .. } if let Some(place) = self.breaking_event(name, *t) => {
                (Some(place), Some("set a value under which the law's rule holds".to_owned()))
            }
            RunError::Rule { element: name, .. } => {
                let plan = element(name);
                let input = plan.and_then(|plan| plan.inputs.first()).map(|input| input.place.clone());
                let law =
                    plan.map_or_else(String::new, |plan| format!(" (`springpot laws {}`)", plan.element.entry.name));
                let help =
                    format!("change the input or the parameters, so that the law's rule{law} holds at every time");
                (input.or_else(|| place_of(plan)), Some(help))
            }
            RunError::Heat { element: name, .. } => {
                let plan = element(name);
                let input = plan.and_then(|plan| plan.input(heat::INPUT)).map(|input| input.place.clone());
                (input.or_else(|| place_of(plan)), None)
            }
            RunError::NotFinite { what, .. } => match self.said(what) {
                Some((place, true)) => {
                    let help = "keep it finite wherever the motion comes: guard what divides, as in 1/max(x, 1e-6), and roots, as in sqrt(max(x, 0))";
                    (Some(place), Some(help.to_owned()))
                }
                Some((place, false)) => (Some(place), None),
                None => (None, None),
            },
            RunError::TooBusy { what, .. } => {
                let help = "look at its frequency (rad/s in an expression of t): is it what was meant?";
                (self.busy(what), Some(help.to_owned()))
            }
            RunError::TooShortSteps { .. } => {
                let asked = self.settings.max_step.map(|_| "raise solver.max_step, or solver.max_steps");
                (None, Some(asked.unwrap_or("raise solver.max_steps").to_owned()))
            }
            RunError::ControlChatter { signal, .. } => match signal {
                Some(signal) => (self.said(signal).map(|(place, _)| place), None),
                None => (self.motion.place_of_controller().cloned(), None),
            },
            RunError::ForceChatter { element: name, .. } => (place_of(element(name)), None),
            RunError::InputRange { element: name, input, low, high, .. } => {
                let plan = element(name);
                let input = plan.and_then(|plan| plan.input(input)).map(|input| input.place.clone());
                (input.or_else(|| place_of(plan)), Some(format!("keep it between {low} and {high}")))
            }
            RunError::ZeroLength { element: name, .. } => {
                let help = "a force along a line needs a length: move `from` or `to`, or the motion, so that the points stay apart";
                (ends_of(element(name)), Some(help.to_owned()))
            }
            RunError::SegmentLength { element: name, .. } => {
                let help = "the tension needs a direction: move the points of `via`, or the motion, so that neighbours stay apart";
                (ends_of(element(name)), Some(help.to_owned()))
            }
            RunError::HalfTurn { element: name, .. } => {
                let help = "rx, ry and rz are for turns below pi: turn the frames by `rpy` so that they face one another, or put the element on a \
                            joint, where turns are counted";
                (ends_of(element(name)), Some(help.to_owned()))
            }
            RunError::Kernel { element: name, .. } => (place_of(element(name)), None),
            RunError::Jump { joint, .. } => {
                let help = "velocities may jump, coordinates may not: ramp it, as in 0.1*min(max((t - 1)/0.01, 0), 1)";
                (Some(self.motion.place_of(joint).clone()), Some(help.to_owned()))
            }
            RunError::ReferenceJump { what, .. } => (Some(self.motion.place_of_reference(what).clone()), None),
            RunError::Path(_) => {
                let help = self
                    .motion
                    .has_orientation()
                    .then_some("without `rpy` the orientation is free, and more can be reached");
                (Some(self.motion.place_of_path().clone()), help.map(str::to_owned))
            }
            _ => (None, None),
        };
        Cure { place, help }
    }

    /// The event whose `set` breaks a rule of an element that its own inputs keep.
    fn breaking_event(&self, name: &str, t: f64) -> Option<Place> {
        let at = self.elements.iter().position(|plan| plan.element.name == name)?;
        let plan = &self.elements[at];
        let input = |value| InputValue { value, rate: 0.0 };
        let own: Vec<InputValue> = plan.inputs.iter().map(|plan| input(plan.signal.value(t))).collect();
        let breaks = |inputs: &[InputValue]| plan.element.law.check_inputs(inputs).is_err();
        let sets = |event: &EventPlan| {
            let mut inputs = own.clone();
            let Action::Set(settings) = &event.event.action else { return false };
            for setting in settings {
                if let Setting::Input { element, input: place, value } = *setting
                    && element == at
                {
                    inputs[place] = input(value);
                }
            }
            breaks(&inputs)
        };
        let event = self.events.iter().find(|event| sets(event)).filter(|_| !breaks(&own))?;
        Some(event.place.clone())
    }

    /// Where a signal stands that is named by what it drives.
    fn busy(&self, what: &str) -> Option<Place> {
        let names = |name: &str| what.contains(&format!("\"{name}\""));
        if let Some(element) = self.elements.iter().find(|plan| names(&plan.element.name)) {
            let input =
                element.element.entry.inputs.iter().find(|row| what.starts_with(&format!("input {} ", row.name)));
            return Some(
                input.and_then(|row| element.input(&row.name)).map_or(&element.place, |input| &input.place).clone(),
            );
        }
        let joint = self.own_joint_names().find(|joint| names(joint))?;
        let own = self.motion.own_place_of(joint).or_else(|| self.motion.place_of_force(joint));
        own.cloned()
    }

    /// Where what a column tells is said, and whether by an expression of the state.
    fn said(&self, column: &str) -> Option<(Place, bool)> {
        if column == CONTROLLER {
            return Some((self.motion.place_of_controller()?.clone(), false));
        }
        let (symbol, label) = column.split_once('.')?;
        let is_of =
            |name: &&str| label.strip_prefix(*name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        let joint = || self.own_joint_names().filter(is_of).max_by_key(|name| name.len());
        match symbol {
            "tau" => {
                let velocity = self.model.v_labels().iter().position(|own| own.name == label);
                let is_feedback = self.motion.feedback().iter().any(|(k, _)| Some(*k) == velocity);
                Some((self.motion.place_of_force(joint()?)?.clone(), is_feedback))
            }
            "q" | "v" | "a" => Some((self.motion.own_place_of(joint()?)?.clone(), false)),
            _ => self.elements.iter().find_map(|plan| {
                let input = column.strip_prefix(&plan.element.name)?.strip_prefix('.')?;
                let signal = plan.input(input)?;
                Some((signal.place.clone(), signal.feedback.is_some()))
            }),
        }
    }
}

impl ElementPlan {
    /// The input of that name.
    fn input(&self, name: &str) -> Option<&SignalPlan> {
        self.inputs.get(self.element.entry.inputs.iter().position(|row| row.name == name)?)
    }
}
