//! What can be observed of a system: one enum of quantities, from which columns, rows, limits and labels derive.
//!
//! A [`Quantity`] is one number of a row. It has a name (`strut.Q.q2`), a unit, a symbol and a meaning, and [`Observables`] lists those of a
//! system in the order of its rows. A [`Table`] keeps the rows of a run in memory, its columns by name or by quantity.

mod element;
pub(crate) mod evaluation;
mod observables;
mod quantity;
mod snapshot;
mod subscript;
pub mod symbol;
mod table;
mod units;

pub use element::{ElementQuantity, LeafQuantity};
pub use observables::Observables;
pub(crate) use quantity::Needs;
pub use quantity::{Axis, EnergyQuantity, Quantity};
pub use snapshot::Snapshot;
pub use table::Table;
