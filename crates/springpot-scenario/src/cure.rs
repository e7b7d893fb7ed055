//! Where in a scenario the cause of a failed run stands, and what can be done.

use super::plan::{ElementPlan, Plan};
use super::refusal::Place;
use springpot::integrate::RunError;

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
        let (place, help) = match error {
            RunError::Rule { element: name, .. } => {
                let plan = element(name);
                let input = plan.and_then(|plan| plan.inputs.first()).map(|input| input.place.clone());
                let law =
                    plan.map_or_else(String::new, |plan| format!(" (`springpot laws {}`)", plan.element.entry.name));
                let help =
                    format!("change the input or the parameters, so that the law's rule{law} holds at every time");
                (input.or_else(|| place_of(plan)), Some(help))
            }
            RunError::InputRange { element: name, input, low, high, .. } => {
                let plan = element(name);
                let at = plan.and_then(|plan| plan.element.entry.inputs.iter().position(|row| row.name == *input));
                let input = plan.zip(at).and_then(|(plan, at)| plan.inputs.get(at)).map(|input| input.place.clone());
                (input.or_else(|| place_of(plan)), Some(format!("keep it between {low} and {high}")))
            }
            RunError::ZeroLength { element: name, .. } => {
                let help = "a force along a line needs a length: move `from` or `to`, or the motion, so that the points stay apart";
                (place_of(element(name)), Some(help.to_owned()))
            }
            RunError::SegmentLength { element: name, .. } => {
                let help = "the tension needs a direction: move the points of `via`, or the motion, so that neighbours stay apart";
                (place_of(element(name)), Some(help.to_owned()))
            }
            RunError::HalfTurn { element: name, .. } => {
                let help = "rx, ry and rz are for turns below pi: turn the frames by `rpy` so that they face one another, or put the element on a \
                            joint, where turns are counted";
                (place_of(element(name)), Some(help.to_owned()))
            }
            RunError::Kernel { element: name, .. } => (place_of(element(name)), None),
            RunError::Jump { joint, .. } => {
                let help = "velocities may jump, coordinates may not: ramp it, as in 0.1*min(max((t - 1)/0.01, 0), 1)";
                (Some(self.motion.place_of(joint).clone()), Some(help.to_owned()))
            }
            RunError::ReferenceJump { .. } => (Some(self.motion.place_of("").clone()), None),
            RunError::Path(_) => {
                let help = self
                    .motion
                    .has_orientation()
                    .then_some("without `rpy` the orientation is free, and more can be reached");
                (Some(self.motion.place_of("").clone()), help.map(str::to_owned))
            }
            _ => (None, None),
        };
        Cure { place, help }
    }
}
