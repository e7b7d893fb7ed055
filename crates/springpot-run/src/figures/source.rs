//! What figures are drawn from.

use crate::labels;
use crate::panels::{Curves, DrawnCase, FigureColumn};
use crate::sweep::{CaseResult, FigureCurve, FigureData, KeptCurve, Outcome};
use springpot::system::System;
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

impl<'a> Source<'a> {
    /// One curve per swept value and column; a second sweep makes one panel per value.
    pub(super) fn plot(&self) -> Result<Plot, String> {
        let Self { figure, data, .. } = *self;
        let x = &self.drawn()?.curves.first().ok_or("it has no curves")?.x;
        let sweeps = FreeSweeps::of(self, None);
        let drawn = data.cases.iter().filter_map(|&index| {
            let kept = self.case(index)?.curves.as_ref();
            let points = |curve: &FigureCurve| {
                kept.and_then(|kept| kept.curves.get(&curve.index)).map_or(&[][..], KeptCurve::points)
            };
            let values = sweeps.values(self.cases, index);
            Some(DrawnCase { source: None, values, points: data.curves.iter().map(points).collect() })
        });
        let y: Vec<FigureColumn> = data.curves.iter().map(|curve| curve.y.clone()).collect();
        let title = figure.title.as_deref();
        Ok(Curves { title, x, y: &y, look: &data.look, is_marked: false, measured: &data.measured }.plot(drawn))
    }

    /// What it draws, or why it is left out.
    pub(super) fn drawn(&self) -> Result<&'a FigureData, String> {
        self.data.left_out.as_ref().map_or(Ok(self.data), |why| Err(why.to_string()))
    }

    /// A case that was begun.
    pub(super) fn case(&self, index: usize) -> Option<&'a CaseResult> {
        let cases = &self.outcome.cases;
        cases.binary_search_by_key(&index, |case| case.index).ok().map(|found| &cases[found])
    }

    /// A case that came to its end.
    pub(super) fn ended(&self, index: usize) -> Option<&'a CaseResult> {
        self.case(index).filter(|case| case.error.is_none())
    }
}

/// Sweeps that a figure does not fix, with names and values as legends show them.
pub(super) struct FreeSweeps(Vec<(usize, String, Vec<String>)>);

impl FreeSweeps {
    /// Those of a figure, but for `other`.
    pub(super) fn of(source: &Source<'_>, other: Option<usize>) -> Self {
        let Source { figure, cases, .. } = source;
        let is_free = |axis: &usize| Some(*axis) != other && figure.selection.iter().all(|s| s.axis != *axis);
        let sweep = |axis: usize| {
            let written: Vec<String> = (0..cases.axis_len(axis)).map(|k| cases.axis_label(axis, k)).collect();
            let (name, values) = labels::sweep(cases.axis_parameters(axis), &written, cases.axis_names(axis).is_some());
            (axis, name, values)
        };
        Self((0..cases.axis_count()).filter(is_free).map(sweep).collect())
    }

    /// Names and values of a case.
    pub(super) fn values(&self, cases: &Cases, index: usize) -> Vec<(String, String)> {
        let position = cases.position(index);
        self.0.iter().map(|(axis, name, values)| (name.clone(), values[position[*axis]].clone())).collect()
    }
}
