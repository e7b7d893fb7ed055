//! Ends of joints as stops: elements on their coordinates that rows do not tell by themselves.

use super::System;
use crate::elements::{Element, Joint};
use crate::law::leaf::EndStop;
use crate::law::{Derivative, Entry, Network, RuleError};
use std::sync::Arc;

impl System {
    /// With stops of this stiffness (> 0) and damping (≥ 0), SI of each joint, where joints have smallest and largest coordinates: beyond them by e the
    /// force −stiffness·e − damping·v, which never pulls back. Of joints that follow others the coordinates are their own.
    ///
    /// The stops are elements that rows do not tell. What they store and dissipate is told with what joints lose.
    ///
    /// # Errors
    /// [`RuleError`] where one of the two is out of its range, or the ends of a joint are in the wrong order.
    pub fn with_end_stops(mut self, stiffness: f64, damping: f64) -> Result<Self, RuleError> {
        let model = Arc::clone(&self.model);
        for joint in 0..model.joint_count() {
            let (lower, upper) = (model.limits(joint).lower, model.limits(joint).upper);
            let Ok(measure) = Joint::new(&model, joint) else { continue };
            if lower == f64::NEG_INFINITY && upper == f64::INFINITY {
                continue;
            }
            let stop = EndStop::new(stiffness, damping, lower, upper)?;
            let entry = Entry {
                name: "end-stop".into(),
                equation: "F = k·e + d·v beyond an end by e, never pulling".into(),
                params: Vec::new(),
                inputs: Vec::new(),
                source: "".into(),
                build: Arc::new(move |_, _| Ok(Network::leaf(stop))),
            };
            let name = name_of(&model.joint_names()[joint]);
            let stop = Element::new(name, measure, 0.0, &Arc::new(entry), &[], Derivative::Caputo)?;
            self.elements.push(Element { shown: false, ..stop });
        }
        Ok(self)
    }

    /// The element that is the stop of a joint, where there is one.
    pub fn end_stop(&self, joint: &str) -> Option<usize> {
        let name = name_of(joint);
        self.elements.iter().position(|element| !element.shown && *element.name == *name)
    }
}

fn name_of(joint: &str) -> String {
    format!("ends of {joint}")
}
