//! Expressions of time: `0.1*sin(8*t)`.
//!
//! | | |
//! |---|---|
//! | operators, weakest first | `+ −`, `* /` (also `·`), sign, `^` (from the right: `2^3^2` is 2^9; `-2^2` is −4) |
//! | names | `t`, `pi`, `e` |
//! | functions | sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs sign step; atan2(y, x); min and max of two or more |
//!
//! `log` is the natural logarithm, `step(x)` is 0 for x < 0 and 1 for x ≥ 0, `sign(0)` is 0, 0^0 is 1. Numbers may have an
//! exponent (`1e-3`). A product is always written out.

mod bound;
mod branch;
mod error;
mod formula;
mod look;
mod of_columns;
mod of_stroke;
mod parse;
mod program;
mod slope;
mod terms;
mod within;

pub(crate) use bound::BoundExpression;
pub use branch::Branch;
pub use error::ExpressionError;
pub use formula::Expression;
pub use of_columns::ColumnExpression;
pub use of_stroke::StrokeExpression;
pub use parse::{is_of_module, number_length};
pub use program::{MAX_DEPTH, MAX_KINKS, MAX_LENGTH, is_name};
pub use slope::{MovedJump, Slope, SlopeError};
