//! Scenario files: plans, sweeps, refusals, limits, broken texts.

mod fuzz;
mod limits;
mod plan;
mod refusals;
mod support;
mod sweeps;
