//! Scenario files: plans, sweeps, refusals, limits, broken texts.

mod control;
mod friction;
mod fuzz;
mod heat;
mod joints;
mod kinds;
mod limits;
mod plan;
mod refusals;
mod support;
mod sweeps;
mod urdf;
