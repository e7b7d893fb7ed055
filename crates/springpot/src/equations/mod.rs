//! The equations of motion: what is known at one time and at the nodes of a step, and the forces of all that acts.

mod accelerations;
mod ahead;
mod assembly;
pub(crate) mod context;
pub(crate) mod control;
pub(crate) mod coulomb;
pub(crate) mod drives;
pub(crate) mod evaluate;
mod friction;
mod guards;
pub(crate) mod kinks;
mod node;
pub(crate) mod on_grid;
mod one_node;
mod pose;
pub(crate) mod resistance;
mod rounding;
mod rows;
mod scale;
mod solve;
mod state;
mod steady;
mod tangent;
mod variation;
pub(crate) mod zero;

pub(crate) use accelerations::{AtOnce, ElementAtStart, OWN_POWERS, solve_mass};
pub(crate) use ahead::Outlook;
pub(crate) use assembly::Equations;
pub(crate) use guards::{Change, Look, Solved, Within, is_smooth};
pub(crate) use node::{Node, Origin};
pub(crate) use one_node::{OneNode, Place};
pub use pose::{ElementStart, Pose, State};
pub(crate) use scale::Scale;
pub(crate) use solve::Solve;
pub(crate) use state::EquationsState;
pub use steady::SteadyError;
pub(crate) use tangent::Coupling;
pub(crate) use variation::{
    Backwards, Endings, Entries, Found, NodeVariation, ROW, Recording, STAGE, Starts, StepErrors, TANGENTS, Told,
    Variation, VariationState,
};
