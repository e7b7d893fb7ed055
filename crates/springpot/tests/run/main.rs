//! Memories, laws and whole runs: accuracy against quadrature, orders of convergence, energy, kinks, gripper paths.

mod accuracy;
mod accuracy_laws;
mod checkpoint;
mod energy;
mod equation;
mod floating;
mod gripper;
mod gripper_bounds;
mod gripper_singular;
mod kinks;
mod law;
mod memory;
mod observables;
mod rubbing;
mod slider;
mod slider_drift;
mod slider_energy;
mod slider_kinks;
mod steps;
#[path = "../support/mod.rs"]
mod support;
mod urdf;
