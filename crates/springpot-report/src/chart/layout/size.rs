//! How large the panels are, and all that follows from it.

use super::{
    BORDER, COLUMN_GAP, HIGHEST, LABEL_LINE, LABEL_SIZE, LEGEND_GAP, LEGEND_ROW, Layout, PANEL_TITLE_LINE,
    PANEL_TITLE_SIZE, Place, Ranges, Row, Settled, TITLE_LINE,
};
use crate::chart::axes::{self, PAD, TICK, TICK_ROW};
use crate::chart::data::Range;
use crate::chart::ticks::Ticks;
use crate::chart::{Axis, Panel};
use crate::draw::{wrap, wrap_evenly};
use crate::{PIXELS_PER_MM, ReportError};

/// So far, both ends together, labels may reach beyond the data area, px: pages have no more room there.
const OVERHANG: f64 = 16.0;
/// Row above a panel for the power of ten of its y axis.
const FACTOR_ROW: f64 = 17.0;
const ROW_GAP: f64 = 14.0;
/// The smallest data area.
const LEAST: [f64; 2] = [50.0, 36.0];
/// Sizes, ticks and labels follow from one another; so often they are found anew.
const ROUNDS: usize = 4;

impl Layout<'_> {
    pub(super) fn title_height(&self) -> f64 {
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
    pub(super) fn settle(&self) -> Result<Settled, ReportError> {
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
                let page = [self.page_width, self.page_height.unwrap_or(0.0)];
                let page = page.map(|side| side / (PIXELS_PER_MM * self.shrunk));
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
            return (width * y / x).clamp(0.3 * width, 0.9 * width);
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
            // A long word may reach somewhat beyond the data area, where it is not split.
            let words = axis.label.split(' ').map(|word| font.width(word, LABEL_SIZE));
            let room = words.fold(room, f64::max).min(room + OVERHANG);
            if axis.label.is_empty() { Vec::new() } else { wrap_evenly(font, &axis.label, LABEL_SIZE, room, 3) }
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
    pub(super) fn has_x_labels(&self, panel: usize) -> bool {
        panel + self.columns >= self.panels.len()
    }

    /// The panel is the first of its row, or another one than the panel before it.
    pub(super) fn has_y_labels(&self, panel: usize) -> bool {
        panel.is_multiple_of(self.columns)
            || self.group[panel] != self.group[panel - 1]
            || !self.shared[self.group[panel]]
    }

    /// The panel is the last of its row.
    pub(super) fn has_right_labels(&self, panel: usize) -> bool {
        self.plot.right.is_some() && ((panel + 1).is_multiple_of(self.columns) || panel + 1 == self.panels.len())
    }

    /// Where x labels start, below the data area; one row further down where the power of ten needs the place.
    pub(super) fn x_label_top(&self, settled: &Settled) -> f64 {
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
    pub(super) fn rows(&self, settled: &Settled, top: f64) -> (Vec<Row>, f64) {
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
}
