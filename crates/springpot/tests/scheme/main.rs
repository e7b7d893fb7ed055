//! Named offline schemes: orders, exactness, refusals.

mod exactness;
mod expansion;
mod orders;
mod refusals;
mod support;
