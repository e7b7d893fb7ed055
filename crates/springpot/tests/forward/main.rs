//! Robots that move by themselves: references, limits, orders, energies, drives, failures.

#![cfg(feature = "scenario")]

mod drives;
mod failures;
mod floating;
mod limits;
mod random;
mod references;
mod rows;
mod shipped;
mod stick;
#[path = "../support/mod.rs"]
mod support;
