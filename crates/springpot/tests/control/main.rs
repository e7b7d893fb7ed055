//! Control: expressions of the state, controllers, their limits, samples and delays, against other programs and closed forms.

mod arm;
mod closed;
mod feedback;
mod going_on;
mod kinks_of_time;
mod order;
mod readings;
mod shaping;
#[path = "../support/mod.rs"]
mod support;
mod variation;
