//! Material laws: stroke history (and inputs) → force. A law knows no bodies and chooses no step.
//!
//! A law is data: a [`Network`] of leaves in parallel and in series, linear or not, with or without inner variables. A step of
//! size h has nodes 0 < c_1 < … < c_s ≤ 1; [`Network::evaluate`] answers with the forces at the nodes and their tangents and may be
//! asked any number of times; [`Network::commit`] is the only mutation, on accepted steps. The [`State`] is a plain serialisable value
//! outside the law.
//!
//! Signs: stroke x = l − l0, force F > 0 in tension. Power: F·x' = d(stored)/dt + dissipation − input.
//!
//! A law with a name is an [`Entry`] of the [`Catalog`]: name, equation, parameters, inputs and how it builds its network; whoever must
//! know all laws reads the catalog. A force of a new kind is a [`Leaf`].
//!
//! ```
//! use springpot::law::{Catalog, Derivative, Point, Start};
//!
//! let catalog = Catalog::standard();
//! let entry = catalog.get("fractional-kelvin-voigt").expect("a law that comes with Springpot");
//! assert_eq!(entry.equation, "F = k·x + c·D^alpha x");
//! let law = entry.build(&[100.0, 50.0, 0.5], Derivative::Caputo)?;
//! let state = law.begin(&Start { stroke: 0.02, jump: 0.02, inputs: &[] })?;
//! let at = Point { t: 0.0, stroke: 0.02, rate: 0.1, inputs: &[] };
//! assert_eq!(law.now(&at, &state).force(), 100.0 * 0.02); // D^½ x = 0 at the start
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod catalog;
pub mod datasheet;
pub mod heat;
pub mod leaf;
pub mod master;
pub mod network;
pub mod past;
pub mod state;
pub mod step;
pub mod tangent;
pub mod variation;

mod damper;
mod filled_rubber;
mod harmonic;
mod kelvin_voigt;
mod magnetorheological;
mod named;
mod piezo;
mod piezo_stack;
mod prandtl_ishlinskii;
mod rule;
mod standard;
mod thermoviscoelastic;
mod told;
mod transient;
mod written;

pub use crate::fractional::Kind as Derivative;
pub use catalog::{Build, Built, Catalog, Entry, Input, Param, Range};
pub use heat::{Expansion, Heat, Shift, Thermal};
pub use leaf::{Elastic, Guard, Holds, Leaf, LeafBuild, LeafKind, Table, TableError, When};
pub use network::{Heated, LeafPart, Network, Series, Warmth};
pub use past::{Past, Periodic};
pub use prandtl_ishlinskii::{PrandtlIshlinskii, Stop};
pub use rule::RuleError;
pub use state::{State, StateMut, StateRef, StateSize};
pub use step::{
    Course, InputValue, LeafState, LocalError, Observation, Point, Power, Powers, Response, Start, Step, Term,
};
pub use tangent::{AtRest, Tangent};
pub use told::Told;
pub use written::{NetworkText, NetworkTextError};
