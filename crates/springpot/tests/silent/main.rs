//! What a run must not miss: switched signals, pulses, small motions; and what it says of itself where it did.

mod cases;
mod narrow;
mod pulses;
mod random;
mod scales;
#[allow(dead_code, unused_imports, reason = "a share of it")]
#[path = "../forward/support.rs"]
mod support;
mod switched;
mod verdicts;
