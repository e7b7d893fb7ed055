//! Which systems explicit steps are for.

use super::{Motion, System};
use crate::elements::Element;
use crate::model::FrictionLaw;

/// Why explicit steps are not for a system.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// The force of an element hangs on what was: a springpot, a part in series, a state of its own, a temperature.
    #[error("the force of element \"{element}\" hangs on the past, which the explicit method does not keep")]
    Keeps {
        /// The element.
        element: String,
    },
    /// Friction that sticks.
    #[error("friction sticks in joint \"{joint}\", where motion is not smooth")]
    Sticks {
        /// The joint.
        joint: String,
    },
    /// A controller remembers its errors.
    #[error("the controller remembers its errors, which the explicit method does not")]
    Remembers,
    /// Nothing is moved by forces.
    #[error("no joint is moved by forces")]
    Led,
}

impl System {
    /// Whether [`Adaptive::Explicit`](super::Adaptive::Explicit) is for it.
    ///
    /// # Errors
    /// [`Unfit`].
    pub fn fits_explicit(&self) -> Result<(), Unfit> {
        let keeping = |element: &&Element| element.scheme.is_some() || !element.law.keeps_nothing();
        if let Some(element) = self.elements.iter().find(keeping) {
            return Err(Unfit::Keeps { element: element.name.clone() });
        }
        let model = &self.model;
        let sticks = |j: &usize| model.friction()[*j] > 0.0 && model.friction_laws()[*j] == FrictionLaw::Sticking;
        if let Some(j) = (0..model.joint_count()).find(sticks) {
            return Err(Unfit::Sticks { joint: model.v_labels()[model.v_range(j).start].name.clone() });
        }
        if self.control.controller.as_ref().is_some_and(|controlled| !controlled.error_terms().is_empty()) {
            return Err(Unfit::Remembers);
        }
        match &self.motion {
            Motion::Forward(forward) if forward.free_velocities(&self.model).is_empty() => Err(Unfit::Led),
            _ => Ok(()),
        }
    }
}
