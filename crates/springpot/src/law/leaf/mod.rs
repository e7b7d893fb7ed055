//! The leaves of every law: what gives a force by itself.

pub(super) mod bouc_wen;
mod contract;
mod dashpot;
mod elastic;
mod end_stop;
mod friction;
pub(super) mod hysteresis;
mod kind;
mod lagged;
mod polynomial;
mod preload;
mod source;
mod spencer;
mod spring;
mod springpot;
mod stop;
mod table;
mod viscous;

pub use bouc_wen::BoucWen;
pub use contract::Leaf;
pub use dashpot::Dashpot;
pub use elastic::Elastic;
pub use end_stop::EndStop;
pub use friction::Friction;
pub use hysteresis::Hysteresis;
pub use kind::{LeafBuild, LeafKind};
pub(super) use lagged::Lagged;
pub use polynomial::Polynomial;
pub use preload::Preload;
pub use source::Source;
pub use spencer::Spencer;
pub use spring::Spring;
pub use springpot::{Coefficient, Springpot};
pub use stop::Stop;
pub use table::{Table, TableError};
pub use viscous::Viscous;
