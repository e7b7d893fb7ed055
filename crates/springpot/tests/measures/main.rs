//! Measures: their derivatives, the forces along them, and what they refuse.

mod derivatives;
mod forces;
#[path = "../rigid/support/mod.rs"]
mod random;
mod refusals;
mod shapes;
mod sliders;
#[path = "../support/mod.rs"]
mod support;
mod systems;
mod units;
