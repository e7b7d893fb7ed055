//! Robots that move by themselves: references, limits, orders, energies, drives, failures.

#![cfg(feature = "scenario")]

mod failures;
mod limits;
mod references;
mod support;
