//! Small motions of a scenario: where they are about, and what their inputs and outputs are called.

mod about;
mod channels;
mod json;
mod model;

pub use about::{About, Stopped, Where, about};
pub use channels::{Named, column, input, inputs};
pub use json::{about_json, modes_json, response_json};
pub use model::{Modelled, linearise};
