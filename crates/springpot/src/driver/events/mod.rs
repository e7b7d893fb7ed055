//! Where the events of forward runs happen: steps end where they act, rows are told where they are.

mod nodes;
mod passage;
mod sides;
mod times;
mod watch;

pub(super) use watch::{Next, Watch, WatchState};
