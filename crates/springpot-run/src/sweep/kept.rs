//! What one case keeps for figures.

use super::Layout;
use super::curve::KeptCurve;
use std::collections::BTreeMap;

/// The curves of a case that figures draw.
#[derive(Debug)]
pub(super) struct Kept<'a> {
    /// Indices in a row of the columns that curves need.
    columns: &'a [usize],
    /// By index, each with the places of its x and y in `columns`.
    curves: BTreeMap<usize, ([usize; 2], KeptCurve)>,
    /// The values of the row at hand.
    values: Vec<f64>,
}

impl<'a> Kept<'a> {
    /// Of case `index`; `None` where no figure draws it.
    pub(super) fn of(layout: &'a Layout, index: usize) -> Option<Self> {
        let columns = layout.kept(index)?;
        let most = layout.most_points();
        let curves = layout.drawn(index).map(|(curve, places)| (curve, (places, KeptCurve::new(most)))).collect();
        Some(Self { columns, curves, values: Vec::with_capacity(columns.len()) })
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
        for ([x, y], curve) in self.curves.values_mut() {
            curve.push(self.values[*x], self.values[*y]);
        }
    }

    /// Values of one row.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// The curves, by their index in [`super::FigureCurve`].
    pub(super) fn into_curves(self) -> BTreeMap<usize, KeptCurve> {
        self.curves.into_iter().map(|(index, (_, curve))| (index, curve)).collect()
    }
}
