//! The page: where panels, labels, titles and legend stand.

use super::axes::{self, Area, Axes, PAD, TICK, TICK_ROW};
use super::data::{self, Range, Ranges, Runs};
use super::legend::Legend;
use super::ticks::Ticks;
use super::{Panel, Plot, style};
use crate::draw::{Align, Font, Scene, Stroke, Text, wrap};
use std::collections::HashMap;

const TITLE_SIZE: f64 = 15.0;
const TITLE_LINE: f64 = 20.0;
const LABEL_SIZE: f64 = 13.0;
const LABEL_LINE: f64 = 17.0;
const PANEL_TITLE_SIZE: f64 = 12.5;
const PANEL_TITLE_LINE: f64 = 17.0;
/// Row above a panel for the power of ten of its y axis.
const FACTOR_ROW: f64 = 17.0;
/// Blank around the figure.
const BORDER: f64 = 12.0;
/// Blank between panels and legend.
const LEGEND_GAP: f64 = 20.0;
/// Blank between columns and between rows of panels.
const COLUMN_GAP: f64 = 24.0;
const ROW_GAP: f64 = 14.0;
/// Points of all curves together: half a megabyte of SVG.
const MOST_POINTS: usize = 30_000;

/// Columns of the grid and the data area's size, by the number of panels.
fn grid(panels: usize) -> (usize, f64, f64) {
    match panels {
        0 | 1 => (1, 440.0, 290.0),
        2 => (2, 290.0, 220.0),
        3 => (3, 240.0, 190.0),
        4 => (2, 290.0, 200.0),
        5..=9 => (3, 230.0, 165.0),
        _ => (4, 190.0, 140.0),
    }
}

/// A figure's parts with their sizes settled.
struct Layout<'a> {
    plot: &'a Plot,
    panels: &'a [Panel],
    /// Panel titles in lines; empty where there is none.
    titles: Vec<Vec<String>>,
    runs: Vec<Vec<Runs>>,
    ranges: Ranges,
    x_ticks: Ticks,
    y_ticks: Vec<Ticks>,
    x_label: Vec<String>,
    y_label: Vec<String>,
    columns: usize,
    width: f64,
    height: f64,
}

/// A row of panels.
struct Row {
    /// Upper edge of the data areas.
    top: f64,
    /// Lower edge of the panel titles.
    title_bottom: f64,
}

/// Lays the figure out and draws it.
pub(super) fn scene(plot: &Plot, font: &Font) -> Scene {
    let empty = [Panel::default()];
    let panels: &[Panel] = if plot.panels.is_empty() { &empty } else { &plot.panels };
    Layout::new(plot, panels, font).draw(font)
}

impl<'a> Layout<'a> {
    fn new(plot: &'a Plot, panels: &'a [Panel], font: &Font) -> Self {
        let runs: Vec<Vec<Runs>> = panels.iter().map(|p| p.curves.iter().map(data::runs).collect()).collect();
        let ranges = Ranges::new(&runs);
        let (columns, width, height) = grid(panels.len());
        let y_ticks = |range: &Option<Range>| range.map_or_else(Ticks::none, |range| axes::y_ticks(range, height));
        let title = |panel: &Panel| panel.title.as_ref().map(|t| wrap(font, t, PANEL_TITLE_SIZE, width, 2));
        Self {
            plot,
            panels,
            titles: panels.iter().map(|panel| title(panel).unwrap_or_default()).collect(),
            x_ticks: if ranges.y.iter().any(Option::is_some) {
                axes::x_ticks(font, ranges.x, width)
            } else {
                Ticks::none()
            },
            y_ticks: ranges.y.iter().map(y_ticks).collect(),
            x_label: wrap(font, &plot.x_label, LABEL_SIZE, width, 3),
            y_label: wrap(font, &plot.y_label, LABEL_SIZE, height, 3),
            runs,
            ranges,
            columns,
            width,
            height,
        }
    }

    /// Nothing stands below the panel.
    fn has_x_labels(&self, panel: usize) -> bool {
        panel + self.columns >= self.panels.len()
    }

    /// The panel is the first of its row or has a range of its own.
    fn has_y_labels(&self, panel: usize) -> bool {
        panel.is_multiple_of(self.columns) || !self.ranges.shared_y
    }

    /// Where x labels start, below the data area; one row further down where the power of ten needs the place.
    fn x_label_top(&self, font: &Font) -> f64 {
        let label = self.x_label.iter().map(|line| font.width(line, LABEL_SIZE)).fold(0.0, f64::max);
        let factor = self.x_ticks.factor.as_ref().map_or(0.0, |factor| font.width(factor, axes::TICK_SIZE) + 12.0);
        TICK_ROW + if factor > 0.0 && 0.5 * label + factor > 0.5 * self.width { 20.0 } else { 5.0 }
    }

    /// Left edges of the columns' data areas.
    fn lefts(&self, font: &Font) -> Vec<f64> {
        let mut x = BORDER + self.y_label.len() as f64 * LABEL_LINE + 4.0;
        let mut lefts = Vec::new();
        for column in 0..self.columns {
            let labelled = (column..self.panels.len()).step_by(self.columns).filter(|p| self.has_y_labels(*p));
            let wide = labelled.map(|p| axes::label_width(font, &self.y_ticks[p])).fold(0.0, f64::max);
            x += TICK + if wide > 0.0 { PAD + wide } else { 0.0 };
            lefts.push(x);
            x += self.width + COLUMN_GAP;
        }
        lefts
    }

    /// The rows of panels below `top`, and the lower edge of the last.
    fn rows(&self, font: &Font, top: f64) -> (Vec<Row>, f64) {
        let mut y = top;
        let mut rows = Vec::new();
        for start in (0..self.panels.len()).step_by(self.columns) {
            let members = || start..(start + self.columns).min(self.panels.len());
            let titles = members().map(|p| self.titles[p].len()).max().unwrap_or(0);
            let factored = members().any(|p| self.has_y_labels(p) && self.y_ticks[p].factor.is_some());
            y += if titles > 0 { titles as f64 * PANEL_TITLE_LINE + 4.0 } else { 0.0 };
            let title_bottom = y - 4.0;
            y += if factored { FACTOR_ROW } else { 0.0 };
            rows.push(Row { top: y, title_bottom });
            let labels = self.x_label_top(font) + self.x_label.len() as f64 * LABEL_LINE;
            y += self.height + ROW_GAP + if members().any(|p| self.has_x_labels(p)) { labels } else { TICK };
        }
        (rows, y - ROW_GAP)
    }

    fn draw(&self, font: &Font) -> Scene {
        let lefts = self.lefts(font);
        let right = lefts[self.columns - 1] + self.width;
        let title = self.plot.title.as_deref().unwrap_or_default();
        let title_lines = wrap(font, title, TITLE_SIZE, right - BORDER, 3);
        let title_height = if title.is_empty() { 0.0 } else { title_lines.len() as f64 * TITLE_LINE + 8.0 };
        let (rows, bottom) = self.rows(font, BORDER + title_height);

        let mut scene = Scene { title: title.to_owned(), ..Scene::default() };
        for (row, line) in title_lines.iter().enumerate() {
            let at = [0.5 * (lefts[0] + right), BORDER + row as f64 * TITLE_LINE + TITLE_SIZE];
            scene.text(Text::new(line, at, TITLE_SIZE, Align::Middle));
        }

        let labels = data::labels(self.plot);
        let styles: HashMap<&str, Stroke> = labels.iter().map(String::as_str).zip(style::strokes(&labels)).collect();
        let curves: usize = self.runs.iter().map(Vec::len).sum();
        for (i, panel) in self.panels.iter().enumerate() {
            let row = &rows[i / self.columns];
            let area = Area { left: lefts[i % self.columns], top: row.top, width: self.width, height: self.height };
            let strokes = panel.curves.iter().filter_map(|curve| styles.get(curve.label.as_str()).copied());
            let axes = Axes {
                x: self.ranges.x,
                y: self.ranges.y[i].unwrap_or((0.0, 1.0)),
                x_ticks: &self.x_ticks,
                y_ticks: &self.y_ticks[i],
                x_labels: self.has_x_labels(i),
                y_labels: self.has_y_labels(i),
                curves: self.runs[i].iter().zip(strokes).collect(),
                points: MOST_POINTS / curves.max(1),
            };
            axes.draw(&mut scene, area);
            self.label(&mut scene, font, i, area, row);
        }

        let entries: Vec<(&str, Stroke)> =
            labels.iter().filter(|l| !l.is_empty()).map(|l| (l.as_str(), styles[l.as_str()])).collect();
        let top = rows[0].top;
        let panels_bottom = rows[rows.len() - 1].top + self.height;
        (scene.width, scene.height) = (right + BORDER + 8.0, bottom + BORDER);
        let legend = Legend::new(font, self.plot.legend_title.as_deref(), &entries, panels_bottom - top);
        if let Some(legend) = legend {
            legend.draw(&mut scene, [right + LEGEND_GAP, top]);
            scene.width = right + LEGEND_GAP + legend.width + BORDER;
            scene.height = scene.height.max(top + legend.height + BORDER);
        }
        scene
    }

    /// Title and axis labels of one panel.
    fn label(&self, scene: &mut Scene, font: &Font, panel: usize, area: Area, row: &Row) {
        let middle = area.left + 0.5 * area.width;
        for (above, line) in self.titles[panel].iter().rev().enumerate() {
            let at = [middle, row.title_bottom - 4.0 - above as f64 * PANEL_TITLE_LINE];
            scene.text(Text::new(line, at, PANEL_TITLE_SIZE, Align::Middle));
        }
        if self.has_x_labels(panel) {
            let top = area.top + area.height + self.x_label_top(font);
            for (below, line) in self.x_label.iter().enumerate() {
                let at = [middle, top + below as f64 * LABEL_LINE + LABEL_SIZE];
                scene.text(Text::new(line, at, LABEL_SIZE, Align::Middle));
            }
        }
        if panel.is_multiple_of(self.columns) {
            for (aside, line) in self.y_label.iter().enumerate() {
                let at = [BORDER + aside as f64 * LABEL_LINE + LABEL_SIZE - 1.0, area.top + 0.5 * area.height];
                scene.text(Text::new(line, at, LABEL_SIZE, Align::Middle).upwards());
            }
        }
    }
}
