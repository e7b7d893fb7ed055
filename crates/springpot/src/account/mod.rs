//! What a run keeps book of: evaluations of its nodes, energies, and whether they balance.

pub(crate) mod ledger;
pub(crate) mod recorder;
pub(crate) mod works;
