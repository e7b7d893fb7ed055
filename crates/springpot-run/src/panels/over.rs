//! Numbers of cases over a swept parameter.

use super::column::FigureColumn;
use super::curves::{Curves, DrawnCase};
use super::look::DrawnLook;
use crate::labels;
use springpot::table::Column;
use springpot_report::Plot;
use springpot_scenario::RangeEnd;
use springpot_scenario::units::Unit;

/// Values of a sweep, as they were written, as an abscissa: the column in the unit of the first, and SI numbers.
///
/// # Errors
/// What is wrong with them, and what would be right: texts, values in several units.
pub(crate) fn swept_numbers(
    path: &str,
    written: &[String],
) -> Result<(FigureColumn, Vec<f64>), (String, &'static str)> {
    let mut unit: Option<Option<(String, Unit)>> = None;
    let mut values = Vec::with_capacity(written.len());
    for written in written {
        let Ok(end) = RangeEnd::parse(written) else {
            let message = format!("a summary over {path} needs numbers, and {written} is none");
            return Err((message, "draw it over a parameter that is swept over numbers or quantities"));
        };
        let own = end.unit.as_ref().and_then(|text| Some((text.clone(), Unit::parse(text, &|_| None).ok()?)));
        let first = unit.get_or_insert_with(|| own.clone());
        let value = match (first, &own) {
            (None, None) => end.number,
            (Some((_, first)), Some((_, own))) if first.dimension() == own.dimension() => own.to_si(end.number),
            _ => {
                let message = format!("a summary over {path} needs values in one unit, and {written} has another");
                return Err((message, "write all values of the sweep with one unit, or all without"));
            }
        };
        values.push(value);
    }
    let unit = unit.flatten();
    let column = Column::new(path, unit.as_ref().map_or("", |(text, _)| text), "swept parameter");
    Ok((FigureColumn { column, unit, label: Some(labels::parameter(path)) }, values))
}

/// Numbers of cases over a swept parameter: those that differ in it alone make a curve of each number.
#[derive(Default)]
pub(crate) struct CasesOver(Vec<CaseGroup>);

/// Cases that differ in the abscissa alone: whose they are, values of the other sweeps, and of each number the points.
struct CaseGroup {
    source: Option<String>,
    values: Vec<(String, String)>,
    points: Vec<Vec<[f64; 2]>>,
}

impl CasesOver {
    /// Takes the numbers of a case.
    pub(crate) fn take(&mut self, source: Option<String>, values: Vec<(String, String)>, x: f64, numbers: &[f64]) {
        let known = self.0.iter().position(|other| other.source == source && other.values == values);
        let at = known.unwrap_or_else(|| {
            self.0.push(CaseGroup { source, values, points: vec![Vec::new(); numbers.len()] });
            self.0.len() - 1
        });
        self.0[at].points.iter_mut().zip(numbers).for_each(|(points, number)| points.push([x, *number]));
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The figure of them.
    pub(crate) fn plot(mut self, title: Option<&str>, x: &FigureColumn, y: &[FigureColumn], look: &DrawnLook) -> Plot {
        for points in self.0.iter_mut().flat_map(|group| &mut group.points) {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
        let drawn = self.0.iter().map(|CaseGroup { source, values, points }| DrawnCase {
            source: source.clone(),
            values: values.clone(),
            points: points.iter().map(Vec::as_slice).collect(),
        });
        Curves { title, x, y, look, is_marked: true, measured: &[] }.plot(drawn)
    }
}
