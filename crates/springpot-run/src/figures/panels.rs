//! Curves of several cases as panels of one figure.

use crate::labels;
use springpot::table::Column;
use springpot_report::{Curve, Panel, Plot};
use springpot_scenario::units::Unit;

/// A column of a figure.
#[derive(Debug, Clone)]
pub struct FigureColumn {
    /// The column.
    pub column: Column,
    /// The unit it is drawn in and how SI values become numbers of it; `None`: SI.
    pub unit: Option<(String, Unit)>,
}

impl FigureColumn {
    /// What stands at its axis: its quantity and its unit.
    pub fn axis(&self) -> String {
        labels::axis(&self.column, self.unit.as_ref().map(|(text, _)| text.as_str()))
    }

    /// An SI value in the unit that it is drawn in.
    pub fn number(&self, value: f64) -> f64 {
        self.unit.as_ref().map_or(value, |(_, unit)| unit.from_si(value))
    }

    fn unit_name(&self) -> &str {
        self.unit.as_ref().map_or(&self.column.unit, |(text, _)| text)
    }
}

/// What a figure of curves shows, apart from their points.
#[derive(Clone, Copy)]
pub struct Curves<'a> {
    /// Title.
    pub title: Option<&'a str>,
    /// The abscissa.
    pub x: &'a FigureColumn,
    /// The ordinates.
    pub y: &'a [FigureColumn],
    /// Sweeps that the figure does not fix: values of the first make curves, those of the others panels.
    pub free: &'a [usize],
    /// What a sweep is called.
    pub sweep: &'a dyn Fn(usize) -> String,
    /// Value `k` of a sweep as written: its sweep, then `k`.
    pub value: &'a dyn Fn(usize, usize) -> String,
}

impl Curves<'_> {
    /// The figure of `cases`: which value each sweep has there, and for each ordinate the points [x, y] of its curve, SI.
    pub fn plot<'p>(&self, cases: impl IntoIterator<Item = (Vec<usize>, Vec<&'p [[f64; 2]]>)>) -> Plot {
        let Self { x, y, free, .. } = *self;
        let several = y.len() > 1;
        let alike = common_unit(y).is_some();
        let mut panels: Vec<(Vec<usize>, Panel)> = Vec::new();
        for (position, curves) in cases {
            let key: Vec<usize> = free.iter().skip(1).map(|axis| position[*axis]).collect();
            let at = panels.iter().position(|(other, _)| *other == key).unwrap_or_else(|| {
                let named: Vec<String> =
                    free.iter().skip(1).map(|axis| self.swept(*axis, position[*axis], true)).collect();
                let title = (!named.is_empty()).then(|| named.join(", "));
                panels.push((key, Panel { title, ..Panel::default() }));
                panels.len() - 1
            });
            // Beside a column's name the value alone would not say what it is of.
            let swept = free.first().map(|axis| self.swept(*axis, position[*axis], several));
            for (column, points) in y.iter().zip(curves) {
                let own = several.then(|| if alike { labels::quantity(&column.column.name) } else { column.axis() });
                let label = own.into_iter().chain(swept.clone()).collect::<Vec<_>>().join(", ");
                let (x, y) = points.iter().map(|[at, value]| (x.number(*at), column.number(*value))).unzip();
                panels[at].1.curves.push(Curve { label, x, y, ..Curve::default() });
            }
        }
        let mut panels: Vec<Panel> = panels.into_iter().map(|(_, panel)| panel).collect();
        if let [only] = &mut panels[..]
            && let [curve] = &mut only.curves[..]
        {
            // The ordinate's label says all about a single curve.
            curve.label.clear();
        }
        // One label for all ordinates: the column's own, or the unit that several have in common.
        let y_label = match y {
            [only] => only.axis(),
            several => common_unit(several).map_or(String::new(), labels::written_unit),
        };
        let legend_title = free.first().filter(|_| y.len() == 1).map(|axis| (self.sweep)(*axis));
        let (x, y) = (x.axis().into(), y_label.into());
        Plot { title: self.title.map(str::to_owned), x, y, legend_title, panels, ..Plot::default() }
    }

    /// The swept value as written; with the name of what is swept where nothing else says it.
    fn swept(&self, axis: usize, k: usize, named: bool) -> String {
        let value = labels::written_unit(&(self.value)(axis, k));
        if named { format!("{} = {value}", (self.sweep)(axis)) } else { value }
    }
}

/// The unit that all columns are drawn in; `None` where they differ.
fn common_unit(columns: &[FigureColumn]) -> Option<&str> {
    let first = columns.first()?.unit_name();
    columns.iter().all(|column| column.unit_name() == first).then_some(first)
}
