//! The leaves of every law: what gives a force by itself.

pub(super) mod bouc_wen;
mod contract;
mod dashpot;
mod elastic;
mod end_stop;
mod friction;
mod kind;
mod polynomial;
mod preload;
mod source;
mod spring;
mod springpot;
mod stop;
mod table;
mod unshifted;

pub use bouc_wen::BoucWen;
pub use contract::Leaf;
pub use dashpot::Dashpot;
pub use elastic::Elastic;
pub use end_stop::EndStop;
pub use friction::Friction;
pub use kind::{LeafBuild, LeafKind};
pub use polynomial::Polynomial;
pub use preload::Preload;
pub use source::Source;
pub use spring::Spring;
pub use springpot::{Coefficient, Springpot};
pub use stop::Stop;
pub use table::{Table, TableError};
pub(super) use unshifted::Unshifted;
