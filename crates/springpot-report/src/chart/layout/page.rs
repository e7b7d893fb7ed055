//! The page drawn.

use super::{
    BORDER, LABEL_LINE, LABEL_SIZE, LEGEND_GAP, LEGEND_ROW, Layout, PANEL_TITLE_LINE, PANEL_TITLE_SIZE, Place, Row,
    Settled, TITLE_LINE, TITLE_SIZE,
};
use crate::chart::axes::{self, Axes, Line, PAD, Ruler, TICK};
use crate::chart::clip::Area;
use crate::chart::data::Range;
use crate::chart::{Curve, Scale, decimate};
use crate::draw::{Align, Scene, Stroke, Text};

/// Points of all curves together: some megabytes of SVG at most.
const MOST_POINTS: usize = 100_000;

impl Layout<'_> {
    pub(super) fn draw(&self, settled: &Settled, look: &dyn Fn(&Curve) -> Stroke) -> Scene {
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
        scene.paper_width = (self.shrunk > 1.0).then_some(self.page_width / self.shrunk);
        scene
    }

    fn axes_of<'s>(&'s self, settled: &'s Settled, panel: usize, look: &dyn Fn(&Curve) -> Stroke) -> Axes<'s> {
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
                    is_points: curve.is_points,
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
