//! One pair of axes with its ticks, grid and curves.

use super::data::{Range, Runs};
use super::decimate::decimate;
use super::ticks::Ticks;
use crate::draw::{Align, Color, Font, INK, Point, Scene, Stroke, Text};

/// Size of tick labels, pixels.
pub(super) const TICK_SIZE: f64 = 11.5;
/// Length of a tick.
pub(super) const TICK: f64 = 4.0;
/// Blank between a tick and its label.
pub(super) const PAD: f64 = 4.0;
/// Height of a row of tick labels with its blanks.
pub(super) const TICK_ROW: f64 = TICK + PAD + 11.0;
const GRID: Color = Color(0xe4, 0xe4, 0xe4);
const ZERO: Color = Color(0xb4, 0xb4, 0xb4);
const NO_DATA: Color = Color(0x80, 0x80, 0x80);
/// Narrowest column for thinning long curves, pixels.
const COLUMN: f64 = 0.4;

/// The data area of a panel in pixels.
#[derive(Clone, Copy)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Everything a panel shows, with the ranges and ticks settled.
pub(super) struct Axes<'a> {
    pub(super) x: Range,
    pub(super) y: Range,
    pub(super) x_ticks: &'a Ticks,
    pub(super) y_ticks: &'a Ticks,
    pub(super) x_labels: bool,
    pub(super) y_labels: bool,
    pub(super) curves: Vec<(&'a Runs, Stroke)>,
    /// Points one curve may have in the file.
    pub(super) points: usize,
}

/// The finest ticks whose labels, beside one another, do not touch on `width` pixels.
pub(super) fn x_ticks(font: &Font, (lo, hi): Range, width: f64) -> Ticks {
    let fits = |ticks: &Ticks| {
        let at = |value: f64| (value - lo) / (hi - lo) * width;
        let half = |label: &str| 0.5 * font.width(label, TICK_SIZE);
        let pairs = ticks.values.windows(2).zip(ticks.labels.windows(2));
        pairs.into_iter().all(|(v, l)| at(v[1]) - at(v[0]) >= half(&l[0]) + half(&l[1]) + TICK_SIZE)
    };
    let most = ((width / 36.0) as usize).clamp(3, 9);
    let choices = (3..=most).rev().map(|most| Ticks::new(lo, hi, most));
    choices.into_iter().find(fits).unwrap_or_else(|| Ticks::new(lo, hi, 2))
}

/// Ticks for an axis of `height` pixels.
pub(super) fn y_ticks((lo, hi): Range, height: f64) -> Ticks {
    Ticks::new(lo, hi, ((height / 30.0) as usize).clamp(4, 8))
}

/// Width of the tick labels of a y axis.
pub(super) fn label_width(font: &Font, ticks: &Ticks) -> f64 {
    ticks.labels.iter().map(|label| font.width(label, TICK_SIZE)).fold(0.0, f64::max)
}

impl Axes<'_> {
    pub(super) fn draw(&self, scene: &mut Scene, area: Area) {
        let Area { left, top, width, height } = area;
        let (right, bottom) = (left + width, top + height);
        let px = |x: f64| left + (x - self.x.0) / (self.x.1 - self.x.0) * width;
        let py = |y: f64| bottom - (y - self.y.0) / (self.y.1 - self.y.0) * height;

        let mut grid: Vec<Vec<Point>> =
            self.x_ticks.values.iter().map(|x| vec![[px(*x), top], [px(*x), bottom]]).collect();
        grid.extend(self.y_ticks.values.iter().map(|y| vec![[left, py(*y)], [right, py(*y)]]));
        scene.lines(grid, Stroke::new(GRID, 0.8).butt());
        if self.y.0 < 0.0 && self.y.1 > 0.0 && !self.y_ticks.values.is_empty() {
            scene.line(&[[left, py(0.0)], [right, py(0.0)]], Stroke::new(ZERO, 1.0).butt());
        }

        let column = COLUMN.max(4.0 * width / self.points as f64);
        for (runs, stroke) in &self.curves {
            let pixels = runs.iter().map(|run| run.iter().map(|[x, y]| [px(*x), py(*y)]).collect::<Vec<_>>());
            let (dots, lines): (Vec<_>, Vec<_>) = pixels.partition(|run| run.len() == 1);
            let lines = decimate(&lines, column, self.points.max(8));
            if !lines.is_empty() {
                scene.lines(lines, *stroke);
            }
            for run in dots.iter().take(self.points) {
                scene.dot(run[0], 1.3 * stroke.width, stroke.color);
            }
        }
        if self.curves.iter().all(|(runs, _)| runs.is_empty()) {
            let middle = [0.5 * (left + right), 0.5 * (top + bottom) + Font::middle(13.0)];
            scene.text(Text::new("no data", middle, 13.0, Align::Middle).color(NO_DATA));
        }

        let mut lines: Vec<Vec<Point>> = vec![vec![[left, top], [left, bottom], [right, bottom]]];
        lines.extend(self.x_ticks.values.iter().map(|x| vec![[px(*x), bottom], [px(*x), bottom + TICK]]));
        lines.extend(self.y_ticks.values.iter().map(|y| vec![[left - TICK, py(*y)], [left, py(*y)]]));
        scene.lines(lines, Stroke::new(INK, 1.0).butt());

        if self.x_labels {
            for (x, label) in self.x_ticks.values.iter().zip(&self.x_ticks.labels) {
                let at = [px(*x), bottom + TICK_ROW - 1.0];
                scene.text(Text::new(label, at, TICK_SIZE, Align::Middle));
            }
        }
        if self.y_labels {
            for (y, label) in self.y_ticks.values.iter().zip(&self.y_ticks.labels) {
                let at = [left - TICK - PAD, py(*y) + Font::middle(TICK_SIZE)];
                scene.text(Text::new(label, at, TICK_SIZE, Align::End));
            }
        }
        if let Some(factor) = self.y_ticks.factor.as_ref().filter(|_| self.y_labels) {
            scene.text(Text::new(factor, [left, top - 6.0], TICK_SIZE, Align::Start));
        }
        if let Some(factor) = self.x_ticks.factor.as_ref().filter(|_| self.x_labels) {
            scene.text(Text::new(factor, [right, bottom + TICK_ROW + 14.0], TICK_SIZE, Align::End));
        }
    }
}
