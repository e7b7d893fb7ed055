//! What one case keeps for figures.

use super::Layout;
use super::curve::KeptCurve;
use super::wanted::Window;
use crate::table::Totals;
use std::collections::BTreeMap;

/// What figures draw of a case.
#[derive(Debug, Default)]
pub struct CaseCurves {
    /// Curves, by their index in [`super::FigureCurve`].
    pub curves: BTreeMap<usize, KeptCurve>,
    /// Statistics, by their index in [`super::FigureTotal`].
    pub totals: BTreeMap<usize, Totals>,
}

/// The curves and statistics of a case that figures draw.
#[derive(Debug)]
pub(super) struct Kept<'a> {
    /// Indices in a row of the columns that they need.
    columns: &'a [usize],
    /// By index, each with the places of its x and y in `columns`.
    curves: BTreeMap<usize, ([usize; 2], Option<Window>, KeptCurve)>,
    /// By index, each with the place of its column.
    totals: BTreeMap<usize, (usize, Option<Window>, Totals)>,
    /// The values of the row at hand.
    values: Vec<f64>,
}

impl<'a> Kept<'a> {
    /// Of case `index`; `None` where no figure draws it.
    pub(super) fn of(layout: &'a Layout, index: usize) -> Option<Self> {
        let columns = layout.kept(index)?;
        let most = layout.most_points();
        let curves =
            layout.drawn(index).map(|(curve, wanted)| (curve, (wanted.places, wanted.window, KeptCurve::new(most))));
        let totals =
            layout.summed(index).map(|(total, wanted)| (total, (wanted.place, wanted.window, Totals::default())));
        Some(Self {
            columns,
            curves: curves.collect(),
            totals: totals.collect(),
            values: Vec::with_capacity(columns.len()),
        })
    }

    /// Takes a row; returns its values for figures.
    pub(super) fn row(&mut self, row: &[f64]) -> &[f64] {
        self.values.clear();
        self.values.extend(self.columns.iter().map(|&k| row[k]));
        self.add();
        &self.values
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
    }

    /// Values of one row.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// What it has kept.
    pub(super) fn into_curves(self) -> CaseCurves {
        let curves = self.curves.into_iter().map(|(index, (.., curve))| (index, curve)).collect();
        CaseCurves { curves, totals: self.totals.into_iter().map(|(index, (.., totals))| (index, totals)).collect() }
    }
}
