//! What figures are drawn from.

use super::panels::{Curves, FigureColumn};
use crate::labels;
use crate::sweep::{FigureCurve, FigureData, KeptCurve, Outcome};
use springpot::integrate::System;
use springpot_report::Plot;
use springpot_scenario::{Cases, FigurePlan, Plan};

/// A figure and what there is to draw it from.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) figure: &'a FigurePlan,
    pub(super) cases: &'a Cases,
    /// Of the first case.
    pub(super) system: &'a System,
    pub(super) plan: &'a Plan,
    pub(super) data: &'a FigureData,
    pub(super) outcome: &'a Outcome,
}

impl Source<'_> {
    /// One curve per swept value and column; a second sweep makes one panel per value.
    pub(super) fn plot(&self) -> Result<Plot, String> {
        let Self { figure, cases, data, outcome, .. } = *self;
        if let Some(why) = &data.left_out {
            return Err(why.to_string());
        }
        let x = &data.curves.first().ok_or("it has no curves")?.x;
        // Sweeps that the figure does not fix: the first makes the curves, the others the panels.
        let free: Vec<usize> =
            (0..cases.axis_count()).filter(|axis| figure.selection.iter().all(|s| s.axis != *axis)).collect();
        let drawn = data.cases.iter().filter_map(|&index| {
            let found = outcome.cases.binary_search_by_key(&index, |case| case.index).ok()?;
            let kept = outcome.cases[found].curves.as_ref();
            let points = |curve: &FigureCurve| {
                kept.and_then(|curves| curves.get(&curve.index)).map_or(&[][..], KeptCurve::points)
            };
            Some((cases.position(index), data.curves.iter().map(points).collect()))
        });
        let y: Vec<FigureColumn> = data.curves.iter().map(|curve| curve.y.clone()).collect();
        let what = Curves {
            title: figure.title.as_deref(),
            x,
            y: &y,
            free: &free,
            sweep: &|axis| cases.axis_parameters(axis).map(labels::parameter).collect::<Vec<_>>().join(", "),
            value: &|axis, k| cases.axis_label(axis, k),
        };
        Ok(what.plot(drawn))
    }
}
