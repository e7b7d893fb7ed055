//! The page: where panels, labels, titles and legend stand.

use super::axes::{self, Area, Axes, Line, PAD, Ruler, TICK, TICK_ROW};
use super::data::{self, Range, Reach, Runs};
use super::legend::{Group, Legend};
use super::ticks::Ticks;
use super::{Axis, Panel, Plot, Scale, decimate, style};
use crate::draw::{Align, Font, Scene, Stroke, Text, wrap};
use crate::{PIXELS_PER_MM, ReportError, WIDTH};

const TITLE_SIZE: f64 = 15.0;
const TITLE_LINE: f64 = 20.0;
const LABEL_SIZE: f64 = 13.0;
const LABEL_LINE: f64 = 17.0;
const PANEL_TITLE_SIZE: f64 = 12.5;
const PANEL_TITLE_LINE: f64 = 17.0;
/// Row above a panel for the power of ten of its y axis.
const FACTOR_ROW: f64 = 17.0;
/// Blank around the figure.
const BORDER: f64 = 10.0;
/// Blank between panels and legend, and below the panels.
const LEGEND_GAP: f64 = 18.0;
const LEGEND_ROW: f64 = 10.0;
/// Blank between columns and between rows of panels.
const COLUMN_GAP: f64 = 20.0;
const ROW_GAP: f64 = 14.0;
/// The legend stands beside the panels where it takes no more of the page, and leaves the panels no less than this.
const LEGEND_SHARE: f64 = 0.27;
const WIDE: f64 = 140.0;
/// The smallest data area, and the highest of a page without a height.
const LEAST: [f64; 2] = [50.0, 36.0];
const HIGHEST: f64 = 290.0;
/// Points of all curves together: some megabytes of SVG at most.
const MOST_POINTS: usize = 100_000;
/// Sizes, ticks and labels follow from one another; so often they are found anew.
const ROUNDS: usize = 4;

/// Columns of the grid of so many panels.
fn columns(panels: usize) -> usize {
    match panels {
        0 | 1 => 1,
        2 | 4 => 2,
        3 | 5..=9 => 3,
        _ => 4,
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
    page_width: f64,
    page_height: Option<f64>,
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
    let labels = data::names(plot, |curve| &curve.label);
    let kinds = data::names(plot, |curve| &curve.kind);
    let strokes = style::strokes(&labels, kinds.len());
    let mut layout = Layout::new(plot, panels, font);
    let groups = legend_groups(plot, &labels, &kinds, &strokes);
    layout.place_legend(&groups);
    let settled = layout.settle()?;
    let look = |curve: &super::Curve| {
        let label = labels.iter().position(|label| *label == curve.label).unwrap_or(0);
        let kind = kinds.iter().position(|kind| *kind == curve.kind).unwrap_or(0);
        strokes[label][kind]
    };
    Ok(layout.draw(&settled, &look))
}

/// Labels in their colours, then kinds in their dashes.
fn legend_groups<'a>(plot: &'a Plot, labels: &[&'a str], kinds: &[&'a str], strokes: &[Vec<Stroke>]) -> Vec<Group<'a>> {
    if plot.hides_legend {
        return Vec::new();
    }
    let named = |names: &[&'a str], stroke: &dyn Fn(usize) -> Stroke| -> Vec<(&'a str, Stroke)> {
        names.iter().enumerate().filter(|(_, name)| !name.is_empty()).map(|(k, name)| (*name, stroke(k))).collect()
    };
    let values = Group { title: plot.legend_title.as_deref(), entries: named(labels, &|k| strokes[k][0]) };
    let kinds = Group { title: None, entries: if kinds.len() > 1 { named(kinds, &style::dash) } else { Vec::new() } };
    vec![values, kinds]
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
        let x = data::x_range(runs.iter().flatten(), &plot.x);
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
        let [page_width, page_height] =
            plot.size.map_or([Some(WIDTH), None], |size| size.map(Some)).map(|side| side.map(|mm| mm * PIXELS_PER_MM));
        let page_width = page_width.unwrap_or(WIDTH * PIXELS_PER_MM);
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
            title: title.map(|title| wrap(font, title, TITLE_SIZE, page_width - 2.0 * BORDER, 3)).unwrap_or_default(),
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

    fn title_height(&self) -> f64 {
        if self.title.is_empty() { 0.0 } else { self.title.len() as f64 * TITLE_LINE + 6.0 }
    }

    /// What the legend takes in width and in height.
    fn legend_takes(&self) -> [f64; 2] {
        match &self.legend {
            Some((legend, Place::Beside)) => [LEGEND_GAP + legend.width, 0.0],
            Some((legend, Place::Below)) => [0.0, LEGEND_ROW + legend.height],
            None => [0.0, 0.0],
        }
    }

    /// Finds sizes and all that follows from them.
    fn settle(&self) -> Result<Settled, ReportError> {
        let [legend_width, legend_height] = self.legend_takes();
        let mut size = [300.0, 200.0];
        let mut settled = self.settled(size);
        for _ in 0..ROUNDS {
            // What is no data area stays as it is while these grow.
            let beside = settled.right - self.columns as f64 * settled.width;
            let width = (self.page_width - BORDER - 8.0 - legend_width - beside) / self.columns as f64;
            let (rows, bottom) = self.rows(&settled, 0.0);
            let above = bottom - rows.len() as f64 * settled.height;
            let height = match self.page_height {
                Some(page) => {
                    let free = page - 2.0 * BORDER - self.title_height() - legend_height - above;
                    free / rows.len() as f64
                }
                None => self.natural_height(width, rows.len()),
            };
            if width < LEAST[0] || height < LEAST[1] {
                let page = [self.page_width, self.page_height.unwrap_or(0.0)].map(|side| side / PIXELS_PER_MM);
                return Err(ReportError::TooSmall { width: page[0], height: page[1] });
            }
            size = [width, height];
            settled = self.settled(size);
        }
        Ok(settled)
    }

    /// Height of a data area of this width on a page without a height.
    fn natural_height(&self, width: f64, rows: usize) -> f64 {
        if self.plot.is_equal {
            let x = self.needed.x.hi - self.needed.x.lo;
            let y = self.needed.y.iter().flatten().map(|range| range.hi - range.lo).fold(0.0, f64::max);
            return (width * y / x).clamp(0.3 * width, 1.2 * width);
        }
        let share = match (self.columns, rows) {
            (1, 1) => 0.66,
            (1, _) => 0.42,
            _ => 0.76,
        };
        (share * width).clamp(LEAST[1] + 30.0, HIGHEST)
    }

    fn settled(&self, [width, height]: [f64; 2]) -> Settled {
        let font = self.font;
        let (ranges, [width, height]) = self.equal([width, height]);
        let y_ticks = |range: &Option<Range>| range.map_or_else(Ticks::none, |range| axes::y_ticks(range, height));
        let title = |panel: &Panel| panel.title.as_ref().map(|t| wrap(font, t, PANEL_TITLE_SIZE, width, 2));
        let label = |axis: &Axis, room: f64| {
            if axis.label.is_empty() { Vec::new() } else { wrap(font, &axis.label, LABEL_SIZE, room, 3) }
        };
        let has_data = ranges.y.iter().any(Option::is_some) || ranges.right.is_some();
        let mut settled = Settled {
            x_ticks: if has_data { axes::x_ticks(font, ranges.x, width) } else { Ticks::none() },
            y_ticks: ranges.y.iter().map(y_ticks).collect(),
            right_ticks: self.plot.right.as_ref().map(|_| y_ticks(&ranges.right)),
            titles: self.panels.iter().map(|panel| title(panel).unwrap_or_default()).collect(),
            x_label: label(&self.plot.x, width + if self.columns == 1 { 40.0 } else { 0.0 }),
            y_labels: self.group.iter().map(|group| label(self.axes[*group], height)).collect(),
            right_label: self.plot.right.as_ref().map(|axis| label(axis, height)).unwrap_or_default(),
            lefts: Vec::new(),
            right: 0.0,
            ranges,
            width,
            height,
        };
        (settled.lefts, settled.right) = self.lefts(&settled);
        settled
    }

    /// The ranges on data areas of this size, and the part of these that is used.
    fn equal(&self, [width, height]: [f64; 2]) -> (Ranges, [f64; 2]) {
        let mut ranges = self.needed.clone();
        let tallest = ranges.y.iter().flatten().map(|range| range.hi - range.lo).fold(0.0, f64::max);
        if !self.plot.is_equal || tallest == 0.0 {
            return (ranges, [width, height]);
        }
        let per_pixel = [(ranges.x.hi - ranges.x.lo) / width, tallest / height];
        let scale = per_pixel[0].max(per_pixel[1]);
        let mut size = [width, height];
        if self.plot.x.range.is_some() {
            size[0] *= per_pixel[0] / scale;
        } else {
            ranges.x = ranges.x.stretched(scale / per_pixel[0]);
        }
        if self.axes.iter().any(|axis| axis.range.is_some()) {
            size[1] *= per_pixel[1] / scale;
        } else {
            for range in ranges.y.iter_mut().flatten() {
                *range = range.stretched(scale * height / (range.hi - range.lo));
            }
        }
        (ranges, size)
    }

    /// Nothing stands below the panel.
    fn has_x_labels(&self, panel: usize) -> bool {
        panel + self.columns >= self.panels.len()
    }

    /// The panel is the first of its row, or another one than the panel before it.
    fn has_y_labels(&self, panel: usize) -> bool {
        panel.is_multiple_of(self.columns)
            || self.group[panel] != self.group[panel - 1]
            || !self.shared[self.group[panel]]
    }

    /// The panel is the last of its row.
    fn has_right_labels(&self, panel: usize) -> bool {
        self.plot.right.is_some() && ((panel + 1).is_multiple_of(self.columns) || panel + 1 == self.panels.len())
    }

    /// Where x labels start, below the data area; one row further down where the power of ten needs the place.
    fn x_label_top(&self, settled: &Settled) -> f64 {
        let width = |text: &str, size: f64| self.font.width(text, size);
        let label = settled.x_label.iter().map(|line| width(line, LABEL_SIZE)).fold(0.0, f64::max);
        let factor = settled.x_ticks.factor.as_ref().map_or(0.0, |factor| width(factor, axes::TICK_SIZE) + 12.0);
        TICK_ROW + if factor > 0.0 && 0.5 * label + factor > 0.5 * settled.width { 20.0 } else { 5.0 }
    }

    /// Left edges of the columns' data areas, and the right edge of what belongs to the panels.
    fn lefts(&self, settled: &Settled) -> (Vec<f64>, f64) {
        let label_lines = settled.y_labels.iter().map(Vec::len).max().unwrap_or(0);
        let mut x = BORDER + label_lines as f64 * LABEL_LINE + if label_lines > 0 { 4.0 } else { 0.0 };
        let mut lefts = Vec::new();
        for column in 0..self.columns {
            let labelled = (column..self.panels.len()).step_by(self.columns).filter(|p| self.has_y_labels(*p));
            let wide = labelled.map(|p| axes::label_width(self.font, &settled.y_ticks[p])).fold(0.0, f64::max);
            x += TICK + if wide > 0.0 { PAD + wide } else { 0.0 };
            lefts.push(x);
            x += settled.width + COLUMN_GAP;
        }
        let ticks = settled.right_ticks.as_ref().map_or(0.0, |ticks| {
            TICK + PAD + axes::label_width(self.font, ticks) + 6.0 + settled.right_label.len() as f64 * LABEL_LINE
        });
        (lefts, x - COLUMN_GAP + ticks)
    }

    /// The rows of panels below `top`, and the lower edge of the last.
    fn rows(&self, settled: &Settled, top: f64) -> (Vec<Row>, f64) {
        let mut y = top;
        let mut rows = Vec::new();
        let right_factor = settled.right_ticks.as_ref().is_some_and(|ticks| ticks.factor.is_some());
        for start in (0..self.panels.len()).step_by(self.columns) {
            let members = || start..(start + self.columns).min(self.panels.len());
            let titles = members().map(|p| settled.titles[p].len()).max().unwrap_or(0);
            let factored = members().any(|p| self.has_y_labels(p) && settled.y_ticks[p].factor.is_some());
            y += if titles > 0 { titles as f64 * PANEL_TITLE_LINE + 4.0 } else { 0.0 };
            let title_bottom = y - 4.0;
            y += if factored || right_factor { FACTOR_ROW } else { 0.0 };
            rows.push(Row { top: y, title_bottom });
            let labels = self.x_label_top(settled) + settled.x_label.len() as f64 * LABEL_LINE;
            y += settled.height + ROW_GAP + if members().any(|p| self.has_x_labels(p)) { labels } else { TICK };
        }
        (rows, y - ROW_GAP)
    }

    fn draw(&self, settled: &Settled, look: &dyn Fn(&super::Curve) -> Stroke) -> Scene {
        let (rows, bottom) = self.rows(settled, BORDER + self.title_height());
        let title = self.plot.title.clone().unwrap_or_default();
        let mut scene = Scene { title, width: self.page_width, ..Scene::default() };
        for (row, line) in self.title.iter().enumerate() {
            let at = [0.5 * self.page_width, BORDER + row as f64 * TITLE_LINE + TITLE_SIZE - 2.0];
            scene.text(Text::new(line, at, TITLE_SIZE, Align::Middle));
        }

        let area = |panel: usize| Area {
            left: settled.lefts[panel % self.columns],
            top: rows[panel / self.columns].top,
            width: settled.width,
            height: settled.height,
        };
        let axes: Vec<Axes<'_>> = (0..self.panels.len()).map(|panel| self.axes_of(settled, panel, look)).collect();
        let mut curves: Vec<_> = axes.iter().enumerate().map(|(panel, axes)| axes.pixels(area(panel))).collect();
        let counts: Vec<usize> = curves.iter().flatten().map(axes::Drawn::count).collect();
        let most = decimate::share(&counts, MOST_POINTS);
        curves.iter_mut().flatten().for_each(|curve| curve.limit(most));
        for (panel, (axes, curves)) in axes.iter().zip(curves).enumerate() {
            axes.draw(&mut scene, area(panel), curves);
            self.label(&mut scene, settled, panel, area(panel), &rows[panel / self.columns]);
        }

        let mut height = bottom + BORDER;
        match &self.legend {
            Some((legend, Place::Beside)) => {
                let top = rows[0].top;
                legend.draw(&mut scene, [settled.right + LEGEND_GAP, top]);
                height = height.max(top + legend.height + BORDER);
            }
            Some((legend, Place::Below)) => {
                let top = bottom + LEGEND_ROW;
                legend.draw(&mut scene, [(0.5 * (self.page_width - legend.width)).max(BORDER), top]);
                height = top + legend.height + BORDER;
            }
            None => {}
        }
        scene.height = self.page_height.unwrap_or(height);
        scene
    }

    fn axes_of<'s>(&'s self, settled: &'s Settled, panel: usize, look: &dyn Fn(&super::Curve) -> Stroke) -> Axes<'s> {
        let nothing = Range { lo: 0.0, hi: 1.0, scale: Scale::Linear };
        let has_right = self.plot.right.is_some();
        let ranges = &settled.ranges;
        let curves = self.panels[panel].curves.iter().zip(&self.runs[panel]);
        Axes {
            x: Ruler { range: ranges.x, ticks: &settled.x_ticks, has_labels: self.has_x_labels(panel) },
            y: Ruler {
                range: ranges.y[panel].unwrap_or(nothing),
                ticks: &settled.y_ticks[panel],
                has_labels: self.has_y_labels(panel),
            },
            right: settled.right_ticks.as_ref().map(|ticks| Ruler {
                range: ranges.right.unwrap_or(nothing),
                ticks,
                has_labels: self.has_right_labels(panel),
            }),
            curves: curves
                .map(|(curve, runs)| Line {
                    runs,
                    stroke: look(curve),
                    is_right: has_right && curve.is_right,
                    is_marked: curve.is_marked,
                })
                .collect(),
            clips: [&self.plot.x, self.axes[self.group[panel]]]
                .into_iter()
                .chain(&self.plot.right)
                .any(|axis| axis.range.is_some()),
        }
    }

    /// Title and axis labels of one panel.
    fn label(&self, scene: &mut Scene, settled: &Settled, panel: usize, area: Area, row: &Row) {
        let middle = area.left + 0.5 * area.width;
        let upright = area.top + 0.5 * area.height;
        for (above, line) in settled.titles[panel].iter().rev().enumerate() {
            let at = [middle, row.title_bottom - 4.0 - above as f64 * PANEL_TITLE_LINE];
            scene.text(Text::new(line, at, PANEL_TITLE_SIZE, Align::Middle));
        }
        if self.has_x_labels(panel) {
            let top = area.top + area.height + self.x_label_top(settled);
            for (below, line) in settled.x_label.iter().enumerate() {
                let at = [middle, top + below as f64 * LABEL_LINE + LABEL_SIZE];
                scene.text(Text::new(line, at, LABEL_SIZE, Align::Middle));
            }
        }
        if panel.is_multiple_of(self.columns) {
            let label = &settled.y_labels[panel];
            // The last line stands beside the numbers.
            let start = settled.lefts[0] - self.number_room(settled) - label.len() as f64 * LABEL_LINE - 4.0;
            for (aside, line) in label.iter().enumerate() {
                let at = [start + aside as f64 * LABEL_LINE + LABEL_SIZE - 1.0, upright];
                scene.text(Text::new(line, at, LABEL_SIZE, Align::Middle).upwards());
            }
        }
        if self.has_right_labels(panel) {
            let last = settled.right_label.len().saturating_sub(1);
            for (aside, line) in settled.right_label.iter().enumerate() {
                let at = [settled.right - 3.0 - (last - aside) as f64 * LABEL_LINE, upright];
                scene.text(Text::new(line, at, LABEL_SIZE, Align::Middle).upwards());
            }
        }
    }

    /// Room of the numbers at the leftmost axes.
    fn number_room(&self, settled: &Settled) -> f64 {
        let first = (0..self.panels.len()).step_by(self.columns);
        let wide = first.map(|p| axes::label_width(self.font, &settled.y_ticks[p])).fold(0.0, f64::max);
        TICK + if wide > 0.0 { PAD + wide } else { 0.0 }
    }
}
