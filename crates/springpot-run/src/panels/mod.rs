//! Curves of several cases as panels of one figure: what figures, pages of results and reports draw curves with.

mod column;
mod curves;
mod look;
mod over;

pub(crate) use column::FigureColumn;
pub(crate) use curves::{Curves, DrawnCase, MeasuredPoints};
pub(crate) use look::{DrawnLook, Misfit, millimetres};
pub(crate) use over::{CasesOver, swept_numbers};
