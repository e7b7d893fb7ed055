//! Which systems the explicit method is for.

use crate::equations::resistance::holding_forces;
use crate::system::{Motion, System};

/// Why the explicit method is not for a system.
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
    /// Derivatives are asked for.
    #[error("derivatives by parameters go with \"radau\"")]
    Differentiated,
}

impl System {
    /// Whether [`Adaptive::Explicit`](crate::system::Adaptive::Explicit) is for it.
    ///
    /// # Errors
    /// [`Unfit`].
    pub fn fits_explicit(&self) -> Result<(), Unfit> {
        let keeping = |element: &&crate::elements::Element| element.scheme.is_some() || !element.law.keeps_nothing();
        if let Some(element) = self.elements.iter().find(keeping) {
            return Err(Unfit::Keeps { element: element.name.clone() });
        }
        if let Some(k) = holding_forces(&self.model).iter().position(|force| *force > 0.0) {
            return Err(Unfit::Sticks { joint: self.model.v_labels()[k].name.clone() });
        }
        if self.control.controller.as_ref().is_some_and(|controlled| !controlled.law.error_terms().is_empty()) {
            return Err(Unfit::Remembers);
        }
        match &self.motion {
            Motion::Forward(forward) if forward.free_velocities(&self.model).is_empty() => Err(Unfit::Led),
            _ if self.sensitivity.is_some() => Err(Unfit::Differentiated),
            _ => Ok(()),
        }
    }
}
