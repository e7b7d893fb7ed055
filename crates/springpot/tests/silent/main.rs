//! What a run must not miss: switched signals, pulses, small motions; and what it says of itself where it did.

mod cases;
mod feedback;
mod narrow;
mod networks;
mod pulses;
mod random;
mod scales;
mod slider;
#[path = "../support/mod.rs"]
mod support;
mod switched;
mod verdicts;
