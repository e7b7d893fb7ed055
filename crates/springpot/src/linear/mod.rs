//! Small motions about rest: natural frequencies, damping, and how columns answer to sines.
//!
//! At a configuration q at rest, M(q) s² δq + D s δq + K δq + Σ_e \[K_e*(s) g_e g_eᵀ + F_e ∂²y_e\] δq = δτ under e^{st}, with the modulus K_e*(s) of
//! each law about the stroke that it has there ([`crate::law::Tangent`]), g = ∂y/∂q and the force F_e that remains after endless rest. K is
//! gravity's, D that of damping and friction of joints. Of s^alpha the principal branch is meant, |arg s| < π.
//!
//! ```
//! use springpot::elements::{Element, Joint};
//! use springpot::actuation::{Drive, Forward};
//! use springpot::system::System;
//! use springpot::law::{Catalog, Derivative};
//! use springpot::model::{BodySpec, JointSpec, ModelBuilder, Parent};
//! use springpot::signal::Signal;
//!
//! // 2 kg on a slider, held by a springpot beside a spring: 2 s² + 3 s^½ + 50 = 0.
//! let mut builder = ModelBuilder::new([0.0; 3]);
//! builder.push(BodySpec {
//!     name: "mass".into(),
//!     parent: Parent::World,
//!     joint: JointSpec::prismatic("x", [1.0, 0.0, 0.0], [0.0; 3]),
//!     mass: 2.0,
//!     com: [0.0; 3],
//!     inertia: [[0.0; 3]; 3],
//! })?;
//! let model = builder.finish()?;
//! let laws = Catalog::standard();
//! let law = laws.get("fractional-kelvin-voigt").expect("a law that comes with Springpot");
//! let pad = Element::new("pad", Joint::new(&model, 0)?, 0.0, law, &[50.0, 3.0, 0.5], Derivative::Caputo)?;
//! let free = Forward { q: vec![0.0], v: vec![0.0], drives: vec![Drive::Force(vec![Signal::constant(0.0)])] };
//! let system = System::new(model, vec![pad], free);
//! let modes = system.linearised(&[0.0], 0.0)?.modes()?;
//! let mode = &modes.modes[0];
//! let s = mode.eigenvalue;
//! assert!((2.0 * s * s + 3.0 * s.sqrt() + 50.0).norm() < 1e-12 * 50.0);
//! assert!(mode.damping_ratio() > 0.0 && modes.is_complete());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod candidates;
mod control;
mod count;
mod equilibrium;
mod error;
mod linearisation;
mod margins;
mod model;
mod modes;
mod pencil;
mod refine;
mod response;
mod statics;

pub use control::{LinearAim, LinearControl, LinearInput};
pub use equilibrium::Equilibrium;
pub use error::LinearError;
pub use linearisation::{LinearElement, Linearisation};
pub use margins::{LoopGain, Margins};
pub use model::{LinearModel, LineariseError, ModelOrder, State, StateKind, StateOwner, linearise};
pub use modes::{Mode, Modes, ModesError};
pub use response::{Excitation, NoResponse};
