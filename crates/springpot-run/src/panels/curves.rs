//! Curves of several cases as panels of one figure.

use super::column::{FigureColumn, groups, with_unit};
use super::look::DrawnLook;
use crate::labels;
use springpot::table::Column;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};

/// What a figure of curves shows, apart from their points.
#[derive(Clone, Copy)]
pub(crate) struct Curves<'a> {
    /// Title.
    pub title: Option<&'a str>,
    /// The abscissa.
    pub x: &'a FigureColumn,
    /// The ordinates.
    pub y: &'a [FigureColumn],
    /// Ranges, scales, size, words.
    pub look: &'a DrawnLook,
    /// Points of curves are marked.
    pub is_marked: bool,
    /// Measured points, which every panel shows.
    pub measured: &'a [MeasuredPoints],
}

/// Points that no case has, in the units that are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPoints {
    /// What they are called.
    pub label: String,
    /// Index of the ordinate whose axis is theirs.
    pub of: usize,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
}

/// A case of a figure of curves.
pub(crate) struct DrawnCase<'p> {
    /// Whose it is, where the figure holds several results.
    pub source: Option<String>,
    /// Sweeps that the figure does not fix, and their values: the first tells curves apart, the others make panels.
    pub values: Vec<(String, String)>,
    /// For each ordinate the points [x, y] of its curve, SI.
    pub points: Vec<&'p [[f64; 2]]>,
}

/// A swept value with what is swept, where that is told.
fn said(name: &str, value: &str) -> String {
    if name.is_empty() { value.to_owned() } else { format!("{name} = {value}") }
}

/// The panels of one combination of values: their title, and the curves of each unit.
struct Cell {
    key: Vec<String>,
    title: Option<String>,
    curves: Vec<Vec<Curve>>,
}

impl Curves<'_> {
    /// The figure of these cases. Ordinates of two units have two axes, those of more units panels below one another.
    pub(crate) fn plot<'p>(&self, cases: impl IntoIterator<Item = DrawnCase<'p>>) -> Plot {
        let groups = groups(self.y);
        let mut sweeps: Vec<String> = Vec::new();
        let mut cells: Vec<Cell> = Vec::new();
        for case in cases {
            let key: Vec<String> = case.values.iter().skip(1).map(|(name, value)| said(name, value)).collect();
            let at = cells.iter().position(|cell| cell.key == key).unwrap_or_else(|| {
                let title = (!key.is_empty()).then(|| key.join(", "));
                cells.push(Cell { key, title, curves: vec![Vec::new(); groups.len()] });
                cells.len() - 1
            });
            if let Some((sweep, _)) = case.values.first()
                && !sweep.is_empty()
                && !sweeps.contains(sweep)
            {
                sweeps.push(sweep.clone());
            }
            for (group, members) in groups.iter().enumerate() {
                let drawn = members.iter().filter(|k| !is_blank(case.points[**k]));
                cells[at].curves[group].extend(drawn.map(|&k| self.curve(&case, k, groups.len(), group)));
            }
        }
        for points in self.measured {
            let group = groups.iter().position(|members| members.contains(&points.of)).unwrap_or(0);
            for cell in &mut cells {
                cell.curves[group].push(points.curve(groups.len() == 2 && group == 1));
            }
        }
        let is_stacked = groups.len() > 2;
        let axes: Vec<Axis> = groups.iter().enumerate().map(|(at, members)| self.y_axis(at, members)).collect();
        let mut panels: Vec<Panel> = Vec::new();
        let columns = is_stacked.then_some(cells.len());
        if is_stacked {
            for (group, axis) in axes.iter().enumerate() {
                panels.extend(cells.iter_mut().map(|cell| Panel {
                    title: cell.title.clone().filter(|_| group == 0),
                    y: Some(axis.clone()),
                    curves: std::mem::take(&mut cell.curves[group]),
                }));
            }
        } else {
            let panel = |cell: Cell| Panel { title: cell.title, curves: cell.curves.concat(), ..Panel::default() };
            panels.extend(cells.into_iter().map(panel));
        }
        if let [only] = &mut panels[..]
            && let [curve] = &mut only.curves[..]
        {
            // The ordinate's label says all about a single curve.
            (curve.label, curve.kind) = (String::new(), String::new());
        }
        let asked = &self.look.asked;
        let label = asked.x.label.clone().unwrap_or_else(|| self.x.axis());
        let mut axes = axes.into_iter();
        Plot {
            title: self.title.map(str::to_owned),
            x: Axis { label, range: self.look.x_range, scale: scale(asked.x.is_log) },
            y: axes.next().unwrap_or_default(),
            right: axes.next().filter(|_| groups.len() == 2),
            is_equal: asked.is_equal,
            size: self.look.size(),
            legend_title: asked.legend.clone().or_else(|| (!sweeps.is_empty()).then(|| sweeps.join(", "))),
            hides_legend: asked.hides_legend,
            columns,
            panels,
        }
    }

    /// The curve of ordinate `k` of a case. Swept values are labels, which have colours; what else tells curves apart are kinds, which
    /// have dashes.
    fn curve(&self, case: &DrawnCase<'_>, k: usize, groups: usize, group: usize) -> Curve {
        let column = &self.y[k];
        // Where units differ, the name alone would not say which axis is meant; alone in its panel, a column has the axis.
        let is_alone = groups > 2 && self.y.iter().filter(|other| other.unit_name() == column.unit_name()).count() == 1;
        let is_told = self.y.len() > 1 && !is_alone || !self.measured.is_empty() && case.values.is_empty();
        let own = is_told.then(|| if groups > 1 { column.axis() } else { column.name() });
        let mut names =
            case.values.first().map(|(_, value)| value.clone()).into_iter().chain(case.source.clone()).chain(own);
        let label = names.next().unwrap_or_default();
        let kind = names.collect::<Vec<_>>().join(": ");
        let (x, y) = case.points[k].iter().map(|[at, value]| (self.x.number(*at), column.number(*value))).unzip();
        Curve { label, kind, is_right: groups == 2 && group == 1, is_marked: self.is_marked, is_points: false, x, y }
    }

    /// The axis of the ordinates of one unit.
    fn y_axis(&self, group: usize, members: &[usize]) -> Axis {
        let columns: Vec<&FigureColumn> = members.iter().map(|&k| &self.y[k]).collect();
        let label = match (&columns[..], &self.look.asked.y.label) {
            (_, Some(label)) if group == 0 => label.clone(),
            ([only], _) => only.axis(),
            (several, _) => {
                let own: Vec<&Column> = several.iter().map(|column| &column.column).collect();
                let names = || {
                    let mut names: Vec<String> = several.iter().map(|column| column.name()).collect();
                    names.dedup();
                    names.join("; ")
                };
                with_unit(&labels::common(&own).unwrap_or_else(names), several[0].unit_name())
            }
        };
        let range = self.look.y_range.filter(|(at, _)| *at == group).map(|(_, range)| range);
        Axis { label, range, scale: scale(self.look.asked.y.is_log) }
    }
}

impl MeasuredPoints {
    fn curve(&self, is_right: bool) -> Curve {
        let Self { label, x, y, .. } = self.clone();
        Curve { label, is_right, is_points: true, x, y, ..Curve::default() }
    }
}

/// Whether there are rows and all their cells are empty, as of an element that is not enabled.
fn is_blank(points: &[[f64; 2]]) -> bool {
    !points.is_empty() && points.iter().all(|[_, y]| y.is_nan())
}

fn scale(is_log: bool) -> Scale {
    if is_log { Scale::Log } else { Scale::Linear }
}
