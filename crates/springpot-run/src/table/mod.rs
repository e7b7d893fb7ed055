//! Results as files: numbers as text, statistics, rows in case order, the folder that holds them.

pub mod disk;
pub mod folder;
mod format;
pub(crate) mod npz;
pub mod number;
pub mod ordered;
mod parquet;
mod rows;
pub(crate) mod sealed;
pub mod statistics;
pub(crate) mod stored;
pub mod text;

pub use format::Format;
pub use number::{push_fields, push_number};
pub use springpot_scenario::matches;
pub use statistics::{Statistics, Totals};
pub use text::{CUT, cut, cut_field, push_text, quoted};
