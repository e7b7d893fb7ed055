//! What one case keeps for figures and metrics.

use super::layout::{KeptCurve, Layout, Window};
use super::metrics::{CaseMetrics, Watched};
use super::simulate::Back;
use crate::table::Totals;
use springpot::system::RunError;
use springpot_scenario::Plan;
use std::collections::BTreeMap;

/// What figures draw of a case.
#[derive(Debug, Default)]
pub struct CaseCurves {
    /// Curves, by their index in [`super::FigureCurve`].
    pub curves: BTreeMap<usize, KeptCurve>,
    /// Statistics, by their index in [`super::FigureTotal`].
    pub totals: BTreeMap<usize, Totals>,
}

/// The curves and statistics of a case that figures draw, and the columns that its metrics are taken from.
#[derive(Debug)]
pub(super) struct Kept<'a> {
    /// Indices in a row of the columns that they need.
    columns: &'a [usize],
    /// By index, each with the places of its x and y in `columns`.
    curves: BTreeMap<usize, ([usize; 2], Option<Window>, KeptCurve)>,
    /// By index, each with the place of its column.
    totals: BTreeMap<usize, (usize, Option<Window>, Totals)>,
    /// Where there are metrics.
    watched: Option<Watched>,
    /// Whether a figure draws it.
    is_drawn: bool,
    /// The values of the row at hand.
    values: Vec<f64>,
}

impl<'a> Kept<'a> {
    /// Of case `index`; `None` where no figure draws it and there are no metrics.
    pub(super) fn of(layout: &'a Layout, index: usize) -> Option<Self> {
        let columns = layout.kept(index)?;
        let most = layout.most_points();
        let curves = layout
            .drawn(index)
            .map(|(curve, wanted)| (curve, (wanted.places, wanted.window, KeptCurve::on_axes(most, wanted.is_log))));
        let totals =
            layout.summed(index).map(|(total, wanted)| (total, (wanted.place, wanted.window, Totals::default())));
        Some(Self {
            columns,
            curves: curves.collect(),
            totals: totals.collect(),
            watched: Watched::of(layout),
            is_drawn: layout.draws(index),
            values: Vec::with_capacity(columns.len()),
        })
    }

    /// Of a case that has ended and whose metrics are known: for figures alone.
    pub(super) fn without_metrics(mut self) -> Self {
        self.watched = None;
        self
    }

    /// Takes a row; returns its values that are kept.
    pub(super) fn row(&mut self, row: &[f64]) -> &[f64] {
        self.values.clear();
        self.values.extend(self.columns.iter().map(|&k| row[k]));
        self.add();
        &self.values
    }

    /// Takes the row of an event that ends the case, and the derivatives of its time.
    pub(super) fn ended(&mut self, row: &[f64], later: &[f64]) {
        self.values.clear();
        self.values.extend(self.columns.iter().map(|&k| row[k]));
        let values = &self.values;
        self.watched.iter_mut().for_each(|watched| watched.ended(values, later));
    }

    /// Takes the values of a row again.
    pub(super) fn again(&mut self, values: &[f64]) {
        self.values.clear();
        self.values.extend_from_slice(values);
        self.add();
    }

    fn add(&mut self) {
        let values = &self.values;
        let is_in = |window: &Option<Window>| window.is_none_or(|window| window.holds(values[window.t]));
        for ([x, y], window, curve) in self.curves.values_mut() {
            if is_in(window) {
                curve.push(values[*x], values[*y]);
            }
        }
        for (column, window, totals) in self.totals.values_mut() {
            if is_in(window) {
                totals.add(values[*column]);
            }
        }
        if let Some(watched) = &mut self.watched {
            watched.add(values);
        }
    }

    /// The metrics of the case whose swept values are `lead`.
    pub(super) fn metrics(
        &self,
        layout: &Layout,
        asked: (&Plan, Option<Back>),
        lead: &str,
    ) -> Result<CaseMetrics, RunError> {
        let metrics = self.watched.as_ref().map(|watched| watched.metrics(layout, asked, lead));
        metrics.unwrap_or_else(|| Ok(CaseMetrics::default()))
    }

    /// Values of one row.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// What it has kept for figures; `None` where none draws it.
    pub(super) fn into_curves(self) -> Option<CaseCurves> {
        if !self.is_drawn {
            return None;
        }
        let curves = self.curves.into_iter().map(|(index, (.., curve))| (index, curve)).collect();
        let totals = self.totals.into_iter().map(|(index, (.., totals))| (index, totals)).collect();
        Some(CaseCurves { curves, totals })
    }
}
