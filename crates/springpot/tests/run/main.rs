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
mod memory_support;
mod rubbing;
mod run_support;
mod slider_drift;
mod slider_energy;
mod slider_kinks;
mod slider_support;
mod urdf;
