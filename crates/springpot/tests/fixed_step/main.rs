//! Fixed-step methods: orders, stability, conserved quantities, allocation, rows and ledger, bad input.

mod allocations;
mod conserved;
mod joints;
mod loops;
mod memory;
mod orders;
mod refusals;
mod rubbing;
mod runs;
mod stability;
mod states;
#[path = "../support/mod.rs"]
mod support;
