//! The method of a run: which one its motion and settings ask for, and what of it must outlast a step.

use super::explicit::{self, Explicit};
use super::fixed::{self, Fixed};
use super::prescribed::{self, Prescribed};
use super::radau::{self, Radau};
use super::stepper::Stepper;
use crate::account::recorder::Recorder;
use crate::equations::context::Context;
use crate::equations::is_smooth;
use crate::system::error::RunError;
use crate::system::settings::Settings;
use crate::system::{Adaptive, Motion, System};
use serde::{Deserialize, Serialize};

/// One of the methods.
#[derive(Debug)]
pub(crate) enum Solver {
    Prescribed(Box<Prescribed>),
    Radau(Box<Radau>),
    Explicit(Box<Explicit>),
    Fixed(Box<Fixed>),
}

/// What a method takes over from the steps before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum SolverState {
    Prescribed(prescribed::StepperState),
    Radau(Box<radau::StepperState>),
    Explicit(Box<explicit::StepperState>),
    Fixed(Box<fixed::StepperState>),
}

impl System {
    /// Refuses elements whose forces are only known of a complete motion.
    ///
    /// # Errors
    /// [`RunError::NoStepping`].
    pub(crate) fn refuse_schemes(&self) -> Result<(), RunError> {
        match self.elements.iter().find(|element| element.scheme.is_some()) {
            Some(element) => Err(RunError::NoStepping { element: element.name.clone() }),
            None => Ok(()),
        }
    }
}

impl Solver {
    /// The method that a system's motion and the settings ask for.
    ///
    /// # Errors
    /// What keeps a run from starting.
    pub(crate) fn new(cx: Context, settings: &Settings) -> Result<Self, RunError> {
        if let Motion::Forward(_) = cx.system.motion {
            cx.system.refuse_schemes()?;
        }
        Ok(match (&cx.system.motion, settings.fixed_step) {
            (Motion::Given(trajectory), _) => Self::Prescribed(Box::new(Prescribed::new(cx, trajectory))),
            (Motion::Forward(forward), None) if takes_explicit(cx.system, settings)? => {
                Self::Explicit(Box::new(Explicit::new(cx, forward, settings)))
            }
            (Motion::Forward(forward), None) => Self::Radau(Box::new(Radau::new(cx, forward, settings))),
            (Motion::Forward(forward), Some(by)) => Self::Fixed(Box::new(Fixed::new(cx, forward, by)?)),
        })
    }

    pub(crate) fn stepper(&self) -> &dyn Stepper {
        match self {
            Self::Prescribed(stepper) => &**stepper,
            Self::Radau(stepper) => &**stepper,
            Self::Explicit(stepper) => &**stepper,
            Self::Fixed(stepper) => &**stepper,
        }
    }

    pub(crate) fn stepper_mut(&mut self) -> &mut dyn Stepper {
        match self {
            Self::Prescribed(stepper) => &mut **stepper,
            Self::Radau(stepper) => &mut **stepper,
            Self::Explicit(stepper) => &mut **stepper,
            Self::Fixed(stepper) => &mut **stepper,
        }
    }

    /// What the next step takes over from those before.
    pub(crate) fn save(&self) -> SolverState {
        match self {
            Self::Prescribed(stepper) => SolverState::Prescribed(stepper.save()),
            Self::Radau(stepper) => SolverState::Radau(Box::new(stepper.save())),
            Self::Explicit(stepper) => SolverState::Explicit(Box::new(stepper.save())),
            Self::Fixed(stepper) => SolverState::Fixed(Box::new(stepper.save())),
        }
    }

    /// Whether that is a state of this method.
    pub(crate) fn fits(&self, state: &SolverState) -> bool {
        matches!(
            (self, state),
            (Self::Prescribed(_), SolverState::Prescribed(_))
                | (Self::Radau(_), SolverState::Radau(_))
                | (Self::Explicit(_), SolverState::Explicit(_))
                | (Self::Fixed(_), SolverState::Fixed(_))
        )
    }

    /// Goes on from what was saved of this method, the recorder from what belongs to it.
    ///
    /// # Errors
    /// What keeps a run from going on; [`RunError::OtherRun`] where it is of another method.
    pub(crate) fn load(&mut self, cx: Context, recorder: &mut Recorder, state: SolverState) -> Result<(), RunError> {
        match (self, state) {
            (Self::Prescribed(stepper), SolverState::Prescribed(state)) => stepper.load(cx, recorder, state),
            (Self::Radau(stepper), SolverState::Radau(state)) => {
                stepper.load(*state);
                Ok(())
            }
            (Self::Explicit(stepper), SolverState::Explicit(state)) => {
                stepper.load(*state);
                Ok(())
            }
            (Self::Fixed(stepper), SolverState::Fixed(state)) => {
                stepper.load(cx, *state);
                Ok(())
            }
            _ => Err(RunError::OtherRun),
        }
    }
}

/// Whether steps are explicit as long as nothing is stiff. A run that is gone back through need not take those of the plain run where derivatives may
/// share in their choice, and goes back through implicit ones by their own equations; what a controller leads is damped, and its reference keeps steps
/// short, so that fewer evaluations in each are worth more than fewer steps.
///
/// # Errors
/// [`RunError::NotExplicit`].
fn takes_explicit(system: &System, settings: &Settings) -> Result<bool, RunError> {
    match settings.adaptive {
        Adaptive::Radau => Ok(false),
        Adaptive::Either => {
            let goes_back = system.sensitivity.as_ref().is_some_and(|by| by.adjoint.is_some() && by.control);
            let is_led = system.control.controller.is_some();
            Ok(!goes_back && !is_led && system.fits_explicit().is_ok() && is_smooth(system))
        }
        Adaptive::Explicit => Ok(system.fits_explicit().map(|()| true)?),
    }
}
