//! Statistics of columns, and metrics, over a swept parameter.

use super::source::{FreeSweeps, Source};
use crate::panels::{CasesOver, FigureColumn};
use crate::sweep::{CaseResult, FigureTotal, Total};
use springpot_report::Drawn;

pub(super) fn draw(source: &Source<'_>) -> Result<Drawn, String> {
    let data = source.drawn()?;
    let over = data.over.as_ref().ok_or("it has no abscissa")?;
    let sweeps = FreeSweeps::of(source, Some(over.axis));
    let mut cases = CasesOver::default();
    for &index in &data.cases {
        let x = over.values[source.cases.position(index)[over.axis]];
        let numbers: Vec<f64> = data.totals.iter().map(|total| number(source, index, total)).collect();
        cases.take(None, sweeps.values(source.cases, index), x, &numbers);
    }
    let y: Vec<FigureColumn> = data.totals.iter().map(|total| total.y.clone()).collect();
    let plot = cases.plot(source.figure.title.as_deref(), &over.column, &y, &data.look);
    plot.draw().map_err(|error| error.to_string())
}

/// A number of a case; NaN where it did not come to its end, or has none.
pub(super) fn number(source: &Source<'_>, index: usize, total: &FigureTotal) -> f64 {
    source.ended(index).and_then(|case| value(total.what, case)).unwrap_or(f64::NAN)
}

fn value(what: Total, case: &CaseResult) -> Option<f64> {
    let (index, statistic) = match what {
        Total::Metric(k) => return case.metrics.values.get(k).copied(),
        Total::Statistic { index, statistic } => (index, statistic),
    };
    let totals = case.curves.as_ref()?.totals.get(&index)?;
    Some(totals.value(statistic))
}
