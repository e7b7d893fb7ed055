//! Named offline schemes: orders, exactness, refusals.

mod exactness;
mod expansion;
mod limits;
mod orders;
mod refusals;
mod support;
