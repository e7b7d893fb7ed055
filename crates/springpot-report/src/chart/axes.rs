//! One pair of axes with its ticks, grid and curves.

use super::Scale;
use super::clip::{Area, clip};
use super::data::{Range, Runs};
use super::decimate::{self, decimate};
use super::ticks::Ticks;
use crate::draw::{Align, Color, Font, INK, Point, Scene, Stroke, Text};

/// Size of tick labels, pixels.
pub(super) const TICK_SIZE: f64 = 11.5;
/// Length of a tick, and of one without a label.
pub(super) const TICK: f64 = 4.0;
const MINOR_TICK: f64 = 2.0;
/// Blank between a tick and its label.
pub(super) const PAD: f64 = 4.0;
/// Height of a row of tick labels with its blanks.
pub(super) const TICK_ROW: f64 = TICK + PAD + 11.0;
const GRID: Color = Color(0xe4, 0xe4, 0xe4);
const ZERO: Color = Color(0xb4, 0xb4, 0xb4);
const NO_DATA: Color = Color(0x80, 0x80, 0x80);
/// Points that are drawn as dots, of one curve.
const MOST_DOTS: usize = 2_000;

/// Radius of a dot, widths of its stroke.
pub(super) const DOT: f64 = 1.5;

/// One axis with its ticks.
#[derive(Clone, Copy)]
pub(super) struct Ruler<'a> {
    pub(super) range: Range,
    pub(super) ticks: &'a Ticks,
    /// Whether numbers stand at it.
    pub(super) has_labels: bool,
}

/// A curve and the axis that its ordinates belong to.
pub(super) struct Line<'a> {
    pub(super) runs: &'a Runs,
    pub(super) stroke: Stroke,
    pub(super) is_right: bool,
    pub(super) is_marked: bool,
    pub(super) is_points: bool,
}

/// Everything a panel shows, with the ranges and ticks settled.
pub(super) struct Axes<'a> {
    pub(super) x: Ruler<'a>,
    pub(super) y: Ruler<'a>,
    pub(super) right: Option<Ruler<'a>>,
    pub(super) curves: Vec<Line<'a>>,
    /// Curves may leave the panel.
    pub(super) clips: bool,
}

/// A curve in pixels.
pub(super) struct Drawn {
    lines: Vec<Vec<Point>>,
    dots: Vec<Point>,
    stroke: Stroke,
}

impl Drawn {
    /// Points of its lines after thinning.
    pub(super) fn count(&self) -> usize {
        decimate::count(&self.lines)
    }

    /// Thins it until it has no more points than `most`.
    pub(super) fn limit(&mut self, most: usize) {
        if self.count() > most {
            self.lines = decimate(&self.lines, most.max(8));
        }
    }
}

/// The finest ticks whose labels, beside one another, do not touch on `width` pixels.
pub(super) fn x_ticks(font: &Font, range: Range, width: f64) -> Ticks {
    let fits = |ticks: &Ticks| {
        let half = |label: &str| 0.5 * font.width(label, TICK_SIZE);
        let pairs = ticks.values.windows(2).zip(ticks.labels.windows(2));
        pairs
            .into_iter()
            .all(|(v, l)| width * (range.share(v[1]) - range.share(v[0])) >= half(&l[0]) + half(&l[1]) + TICK_SIZE)
    };
    let most = ((width / 36.0) as usize).clamp(5, 9);
    let choices = (3..=most).rev().map(|most| ticks(range, most));
    choices.into_iter().find(fits).unwrap_or_else(|| ticks(range, 2))
}

/// Ticks for an axis of `height` pixels.
pub(super) fn y_ticks(range: Range, height: f64) -> Ticks {
    ticks(range, ((height / 30.0) as usize).clamp(5, 8))
}

fn ticks(range: Range, most: usize) -> Ticks {
    match range.scale {
        Scale::Linear => Ticks::new(range.lo, range.hi, most),
        Scale::Log => Ticks::logarithmic(range.lo, range.hi, most),
    }
}

/// Width of the tick labels of a y axis.
pub(super) fn label_width(font: &Font, ticks: &Ticks) -> f64 {
    ticks.labels.iter().map(|label| font.width(label, TICK_SIZE)).fold(0.0, f64::max)
}

impl Axes<'_> {
    /// The curves in pixels, thinned.
    pub(super) fn pixels(&self, area: Area) -> Vec<Drawn> {
        let curve = |line: &Line<'_>| {
            let y = if line.is_right { self.right.unwrap_or(self.y) } else { self.y }.range;
            let at = |[x, y_value]: &[f64; 2]| {
                let (along, up) = (self.x.range.share(*x), y.share(*y_value));
                [area.left + along * area.width, area.top + area.height - up * area.height]
            };
            let pixels = line.runs.iter().map(|run| run.iter().map(at).collect::<Vec<_>>());
            let (dots, mut lines): (Vec<_>, Vec<_>) = pixels.partition(|run| run.len() == 1);
            let mut dots: Vec<Point> = dots.into_iter().flatten().collect();
            if line.is_marked || line.is_points {
                dots.extend(lines.iter().flatten());
            }
            if line.is_points {
                lines.clear();
            }
            if self.clips {
                lines = lines.iter().flat_map(|run| clip(run, area)).collect();
                dots.retain(|[x, y]| {
                    (area.left..=area.left + area.width).contains(x) && (area.top..=area.top + area.height).contains(y)
                });
            }
            dots.truncate(MOST_DOTS);
            Drawn { lines: decimate(&lines, usize::MAX), dots, stroke: line.stroke }
        };
        self.curves.iter().map(curve).collect()
    }

    pub(super) fn draw(&self, scene: &mut Scene, area: Area, curves: Vec<Drawn>) {
        let Area { left, top, width, height } = area;
        let (right, bottom) = (left + width, top + height);
        let px = |x: f64| left + self.x.range.share(x) * width;
        let py = |y: f64| bottom - self.y.range.share(y) * height;
        let (x_ticks, y_ticks) = (self.x.ticks, self.y.ticks);

        let mut grid: Vec<Vec<Point>> = x_ticks.values.iter().map(|x| vec![[px(*x), top], [px(*x), bottom]]).collect();
        grid.extend(y_ticks.values.iter().map(|y| vec![[left, py(*y)], [right, py(*y)]]));
        scene.lines(grid, Stroke::new(GRID, 0.8).butt());
        let has_zero = self.y.range.scale == Scale::Linear && self.y.range.lo < 0.0 && self.y.range.hi > 0.0;
        if has_zero && !y_ticks.values.is_empty() {
            scene.line(&[[left, py(0.0)], [right, py(0.0)]], Stroke::new(ZERO, 1.0).butt());
        }

        for Drawn { lines, dots, stroke } in curves {
            if !lines.is_empty() {
                scene.lines(lines, stroke);
            }
            for dot in dots {
                scene.dot(dot, DOT * stroke.width, stroke.color);
            }
        }
        if self.curves.iter().all(|line| line.runs.is_empty()) {
            let middle = [0.5 * (left + right), 0.5 * (top + bottom) + Font::middle(13.0)];
            scene.text(Text::new("no data", middle, 13.0, Align::Middle).color(NO_DATA));
        }

        let mut lines: Vec<Vec<Point>> = vec![vec![[left, top], [left, bottom], [right, bottom]]];
        let below = |x: f64, long: f64| vec![[px(x), bottom], [px(x), bottom + long]];
        let beside = |y: f64, long: f64| vec![[left - long, py(y)], [left, py(y)]];
        lines.extend(x_ticks.values.iter().map(|x| below(*x, TICK)));
        lines.extend(x_ticks.minor.iter().map(|x| below(*x, MINOR_TICK)));
        lines.extend(y_ticks.values.iter().map(|y| beside(*y, TICK)));
        lines.extend(y_ticks.minor.iter().map(|y| beside(*y, MINOR_TICK)));
        scene.lines(lines, Stroke::new(INK, 1.0).butt());

        if self.x.has_labels {
            for (x, label) in x_ticks.values.iter().zip(&x_ticks.labels) {
                let at = [px(*x), bottom + TICK_ROW - 1.0];
                scene.text(Text::new(label, at, TICK_SIZE, Align::Middle));
            }
        }
        if self.y.has_labels {
            for (y, label) in y_ticks.values.iter().zip(&y_ticks.labels) {
                let at = [left - TICK - PAD, py(*y) + Font::middle(TICK_SIZE)];
                scene.text(Text::new(label, at, TICK_SIZE, Align::End));
            }
        }
        if let Some(factor) = y_ticks.factor.as_ref().filter(|_| self.y.has_labels) {
            scene.text(Text::new(factor, [left, top - 6.0], TICK_SIZE, Align::Start));
        }
        if let Some(factor) = x_ticks.factor.as_ref().filter(|_| self.x.has_labels) {
            scene.text(Text::new(factor, [right, bottom + TICK_ROW + 14.0], TICK_SIZE, Align::End));
        }
        if let Some(ruler) = &self.right {
            ruler.draw_right(scene, area);
        }
    }
}

impl Ruler<'_> {
    /// Draws it along the right edge of a panel.
    fn draw_right(&self, scene: &mut Scene, Area { left, top, width, height }: Area) {
        let (right, bottom) = (left + width, top + height);
        let py = |y: f64| bottom - self.range.share(y) * height;
        let mut lines: Vec<Vec<Point>> = vec![vec![[right, top], [right, bottom]]];
        let tick = |y: f64, long: f64| vec![[right, py(y)], [right + long, py(y)]];
        lines.extend(self.ticks.values.iter().map(|y| tick(*y, TICK)));
        lines.extend(self.ticks.minor.iter().map(|y| tick(*y, MINOR_TICK)));
        scene.lines(lines, Stroke::new(INK, 1.0).butt());
        if !self.has_labels {
            return;
        }
        for (y, label) in self.ticks.values.iter().zip(&self.ticks.labels) {
            let at = [right + TICK + PAD, py(*y) + Font::middle(TICK_SIZE)];
            scene.text(Text::new(label, at, TICK_SIZE, Align::Start));
        }
        if let Some(factor) = &self.ticks.factor {
            scene.text(Text::new(factor, [right, top - 6.0], TICK_SIZE, Align::End));
        }
    }
}
