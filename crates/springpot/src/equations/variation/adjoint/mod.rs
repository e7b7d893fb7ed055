//! Back through a run: gradients of numbers that are sums of its rows, by any number of parameters at once.
//!
//! What parameters change goes from step to step by linear maps. All that outlasts a step is cut off behind it: in place of what each parameter has
//! changed so far stand columns of ones, one for each number of the state that changes at all, and the next step is differentiated by these as by
//! parameters, by the very operations that go forward ([`super::Variation`]). What they make of the ones is the step's map. Of memories, columns stand
//! for what their past tells ([`crate::fractional::PortColumns`]), however many modes they have. The maps are kept while the run goes on
//! ([`Recording`]), and gone through in the other order, transposed ([`Backwards`]): one pass for each number, however many parameters there are.
//!
//! Steps of plain laws and of motions that follow from forces have no need of columns: these keep their equations instead ([`SolvedStep`]).

mod alone;
mod back;
mod blocks;
mod endings;
mod record;
mod room;
mod step;
mod tape;
mod through;
mod weighing;

pub(super) use alone::{Alone, lines};
pub(crate) use back::Backwards;
pub(crate) use endings::Endings;
pub(crate) use record::Recording;
pub(super) use room::keeps_works;
pub(crate) use step::{Narrow, SolvedStep};
pub(crate) use tape::{Entries, Starts};
