//! Prony series: the bound, the number of branches, passivity, exports, refusals.

mod bounds;
mod exports;
mod refusals;
