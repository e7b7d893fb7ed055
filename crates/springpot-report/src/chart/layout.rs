//! The page: where panels, labels, titles and legend stand. Its parts: `size` (what follows from how large the panels are), `page` (drawing).

mod page;
mod size;

use super::data::{self, Range, Reach, Runs};
use super::legend::{Group, Legend};
use super::ticks::Ticks;
use super::{Axis, Panel, Plot, style};
use crate::draw::{Font, Scene, Stroke, wrap_evenly};
use crate::{PIXELS_PER_MM, ReportError, WIDTH};

pub(super) const TITLE_SIZE: f64 = 15.0;
pub(super) const TITLE_LINE: f64 = 20.0;
pub(super) const LABEL_SIZE: f64 = 13.0;
pub(super) const LABEL_LINE: f64 = 17.0;
const PANEL_TITLE_SIZE: f64 = 12.5;
const PANEL_TITLE_LINE: f64 = 17.0;
/// Blank around the figure.
pub(super) const BORDER: f64 = 10.0;
/// Blank between panels and legend, and below the panels.
const LEGEND_GAP: f64 = 18.0;
const LEGEND_ROW: f64 = 10.0;
/// Blank between columns of panels.
const COLUMN_GAP: f64 = 20.0;
/// The legend stands beside the panels where it takes no more of the page, and leaves the panels no less than this.
const LEGEND_SHARE: f64 = 0.27;
const WIDE: f64 = 140.0;
/// Narrower pages than this, mm, have smaller letters, of no less than this part of the size.
const FULL_SIZE: f64 = 110.0;
const SMALLEST: f64 = 0.8;
/// The highest data area of a page without a height.
pub(super) const HIGHEST: f64 = 290.0;

/// Columns of the grid of so many panels.
fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2 | 4 => 2,
        3 | 5..=9 => 3,
        _ => 4,
    }
}

/// A page as it is laid out, pixels: so many times as large as the paper.
pub(super) struct Page {
    pub(super) width: f64,
    pub(super) height: Option<f64>,
    shrunk: f64,
}

impl Page {
    /// Of a size in mm.
    pub(super) fn new(size: Option<[f64; 2]>) -> Self {
        let width = size.map_or(WIDTH, |[width, _]| width);
        let shrunk = 1.0 / (width / FULL_SIZE).clamp(SMALLEST, 1.0);
        let height = size.map(|[_, height]| height * PIXELS_PER_MM * shrunk);
        Self { width: width * PIXELS_PER_MM * shrunk, height, shrunk }
    }

    /// Width of the paper, where it is another one.
    pub(super) fn paper_width(&self) -> Option<f64> {
        (self.shrunk > 1.0).then_some(self.width / self.shrunk)
    }
}

/// A figure's parts.
struct Layout<'a> {
    plot: &'a Plot,
    font: &'a Font,
    panels: &'a [Panel],
    /// The different y axes, and that of each panel.
    axes: Vec<&'a Axis>,
    group: Vec<usize>,
    runs: Vec<Vec<Runs>>,
    columns: usize,
    /// Of the page as laid out, which is `shrunk` times as large as the paper.
    page_width: f64,
    page_height: Option<f64>,
    shrunk: f64,
    title: Vec<String>,
    legend: Option<(Legend, Place)>,
    /// What the curves need.
    needed: Ranges,
    /// By axis: whether the panels of a group have one range.
    shared: Vec<bool>,
}

/// Where the legend stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Beside,
    Below,
}

#[derive(Clone)]
struct Ranges {
    x: Range,
    y: Vec<Option<Range>>,
    right: Option<Range>,
}

/// What follows from the size of the panels.
struct Settled {
    width: f64,
    height: f64,
    ranges: Ranges,
    x_ticks: Ticks,
    y_ticks: Vec<Ticks>,
    right_ticks: Option<Ticks>,
    /// Panel titles, the label of x, those of y by panel, that of the right axis, in lines.
    titles: Vec<Vec<String>>,
    x_label: Vec<String>,
    y_labels: Vec<Vec<String>>,
    right_label: Vec<String>,
    lefts: Vec<f64>,
    /// Right edge of all that belongs to the panels.
    right: f64,
}

/// A row of panels.
struct Row {
    /// Upper edge of the data areas.
    top: f64,
    /// Lower edge of the panel titles.
    title_bottom: f64,
}

/// Lays the figure out and draws it.
pub(super) fn scene(plot: &Plot, font: &Font) -> Result<Scene, ReportError> {
    let empty = [Panel::default()];
    let panels: &[Panel] = if plot.panels.is_empty() { &empty } else { &plot.panels };
    let labels = data::names(plot, false, |curve| &curve.label);
    let kinds = data::names(plot, false, |curve| &curve.kind);
    let points = data::names(plot, true, |curve| &curve.label);
    let strokes = style::strokes(&labels, kinds.len());
    let mut layout = Layout::new(plot, panels, font);
    let groups = legend_groups(plot, &labels, (&kinds, &points), &strokes);
    layout.place_legend(&groups);
    let settled = layout.settle()?;
    let look = |curve: &super::Curve| {
        if curve.is_points {
            return style::points(points.iter().position(|label| *label == curve.label).unwrap_or(0));
        }
        let label = labels.iter().position(|label| *label == curve.label).unwrap_or(0);
        let kind = kinds.iter().position(|kind| *kind == curve.kind).unwrap_or(0);
        strokes[label][kind]
    };
    let mut scene = layout.draw(&settled, &look);
    scene.remarks = data::not_positive(plot);
    Ok(scene)
}

/// Labels in their colours, then kinds in their dashes, then points.
fn legend_groups<'a>(
    plot: &'a Plot,
    labels: &[&'a str],
    (kinds, points): (&[&'a str], &[&'a str]),
    strokes: &[Vec<Stroke>],
) -> Vec<Group<'a>> {
    if plot.hides_legend {
        return Vec::new();
    }
    let named = |names: &[&'a str], stroke: &dyn Fn(usize) -> Stroke| -> Vec<(&'a str, Stroke)> {
        names.iter().enumerate().filter(|(_, name)| !name.is_empty()).map(|(k, name)| (*name, stroke(k))).collect()
    };
    let group = |entries| Group { title: None, entries, are_points: false };
    let values = Group { title: plot.legend_title.as_deref(), ..group(named(labels, &|k| strokes[k][0])) };
    let kinds = group(if kinds.len() > 1 { named(kinds, &style::dash) } else { Vec::new() });
    vec![values, kinds, Group { are_points: true, ..group(named(points, &style::points)) }]
}

impl<'a> Layout<'a> {
    fn new(plot: &'a Plot, panels: &'a [Panel], font: &'a Font) -> Self {
        let mut axes: Vec<&Axis> = Vec::new();
        let mut group = Vec::new();
        for panel in panels {
            let axis = panel.y.as_ref().unwrap_or(&plot.y);
            group.push(axes.iter().position(|known| *known == axis).unwrap_or_else(|| {
                axes.push(axis);
                axes.len() - 1
            }));
        }
        let right_axis = plot.right.as_ref();
        let scales =
            |is_right: bool, group: usize| [plot.x.scale, right_axis.filter(|_| is_right).unwrap_or(axes[group]).scale];
        let runs: Vec<Vec<Runs>> = panels
            .iter()
            .zip(&group)
            .map(|(panel, group)| panel.curves.iter().map(|c| data::runs(c, scales(c.is_right, *group))).collect())
            .collect();
        let has_marks = panels.iter().flat_map(|panel| &panel.curves).any(|curve| curve.is_marked || curve.is_points);
        let x = data::x_range(runs.iter().flatten(), &plot.x, has_marks);
        let reaches = |is_right: bool, group: &[usize]| -> Vec<Reach<'_>> {
            let of = panels.iter().zip(&runs).zip(group);
            let reach = of.map(|((panel, runs), group)| {
                let own =
                    panel.curves.iter().zip(runs).filter(|(c, _)| (c.is_right && right_axis.is_some()) == is_right);
                Reach { runs: own.map(|(_, runs)| runs).collect(), group: *group }
            });
            reach.collect()
        };
        let (y, shared) = data::y_ranges(&reaches(false, &group), &axes, x);
        let right = right_axis.and_then(|axis| {
            let whole = reaches(true, &vec![0; panels.len()]).into_iter().flat_map(|reach| reach.runs).collect();
            data::y_ranges(&[Reach { runs: whole, group: 0 }], &[axis], x).0.pop().flatten()
        });
        let columns = plot.columns.unwrap_or(columns(panels.len())).clamp(1, panels.len());
        let Page { width: page_width, height: page_height, shrunk } = Page::new(plot.size);
        let title = plot.title.as_deref().filter(|title| !title.is_empty());
        Self {
            plot,
            font,
            panels,
            axes,
            group,
            needed: Ranges { x, y, right },
            shared,
            runs,
            columns,
            page_width,
            page_height,
            shrunk,
            title: title
                .map(|title| wrap_evenly(font, title, TITLE_SIZE, page_width - 2.0 * BORDER, 3))
                .unwrap_or_default(),
            legend: None,
        }
    }

    fn place_legend(&mut self, groups: &[Group<'_>]) {
        let height = self.page_height.map_or(HIGHEST, |height| height - self.title_height() - 60.0);
        let most = LEGEND_SHARE * self.page_width;
        let rows = self.panels.len().div_ceil(self.columns);
        let beside = Legend::beside(self.font, groups, height * if rows > 1 { 1.5 } else { 1.0 });
        self.legend = match beside {
            None => None,
            Some(legend) => {
                let left = self.page_width - legend.width - LEGEND_GAP - 60.0;
                let each = left / self.columns as f64 - if self.columns > 1 { COLUMN_GAP } else { 0.0 };
                let fits_height = self.page_height.is_none_or(|height| legend.height <= height - 2.0 * BORDER);
                if legend.width <= most && each >= WIDE && fits_height {
                    Some((legend, Place::Beside))
                } else {
                    let below = Legend::below(self.font, groups, self.page_width - 2.0 * BORDER);
                    below.map(|legend| (legend, Place::Below))
                }
            }
        };
    }
}
