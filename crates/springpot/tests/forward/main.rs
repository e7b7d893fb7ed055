//! Robots that move by themselves: references, limits, orders, energies, drives, failures.

mod chains;
mod drives;
mod failures;
mod floating;
mod joints;
mod limits;
mod random;
mod references;
mod shipped;
mod stick;
#[path = "../support/mod.rs"]
mod support;
