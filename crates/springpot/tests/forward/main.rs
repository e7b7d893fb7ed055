//! Robots that move by themselves: references, limits, orders, energies, drives, failures.

#![cfg(feature = "scenario")]

mod references;
mod support;
