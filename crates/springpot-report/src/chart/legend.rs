//! The legend, beside the panels or below them.

use super::axes::DOT;
use crate::draw::{Align, Font, INK, Point, Scene, Stroke, Text, wrap, wrap_to_end};
use std::collections::HashSet;

/// Size of the legend's text, pixels.
const SIZE: f64 = 12.0;
const LINE: f64 = 15.0;
/// Free height between two entries, and after a title.
const GAP: f64 = 4.0;
const TITLE_GAP: f64 = 6.0;
/// Free height between two groups, and free width between two columns.
const GROUP_GAP: f64 = 8.0;
const COLUMN_GAP: f64 = 14.0;
/// Length of the sample of each curve, and the blank after it.
const SAMPLE: f64 = 28.0;
const BLANK: f64 = 8.0;
/// Widest label; longer ones are wrapped.
const WIDEST: f64 = 210.0;
const MOST_ENTRIES: usize = 96;
/// Lines of a label; of one that else looks like another, up to the latter.
const LINES: usize = 2;
const MOST_LINES: usize = 8;

/// Entries that belong together.
pub(super) struct Group<'a> {
    pub(super) title: Option<&'a str>,
    pub(super) entries: Vec<(&'a str, Stroke)>,
    /// Their samples are points.
    pub(super) are_points: bool,
}

/// A legend that knows its size.
pub(super) struct Legend {
    items: Vec<Item>,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Some lines of text with the sample of a curve before them, or without.
struct Item {
    at: Point,
    stroke: Option<Stroke>,
    is_point: bool,
    lines: Vec<String>,
    indent: f64,
}

impl Legend {
    /// Groups below one another, their entries in columns where one is higher than `height`. `None` when there is nothing to say.
    pub(super) fn beside(font: &Font, groups: &[Group<'_>], height: f64) -> Option<Self> {
        let count: usize = groups.iter().map(|group| group.entries.len()).sum();
        let mut legend = Self::empty();
        for group in groups.iter().filter(|group| !group.entries.is_empty()) {
            let budget = height * group.entries.len() as f64 / count as f64;
            let title = group.title.map(|title| wrap(font, title, SIZE, WIDEST, 2)).unwrap_or_default();
            let top = legend.below_last() + legend.title(font, title);
            let (mut x, mut y, mut column) = (0.0, top, 0.0f64);
            for (stroke, lines) in entries(font, group, SAMPLE + BLANK + WIDEST) {
                let (tall, wide) = (entry_height(&lines), entry_width(font, &lines));
                if y > top && y + tall > top + budget.max(tall) {
                    (x, y, column) = (x + column + COLUMN_GAP, top, 0.0);
                }
                legend.put([x, y], (stroke, group.are_points), lines, wide, tall);
                (y, column) = (y + tall, column.max(wide));
            }
        }
        legend.finish()
    }

    /// Groups below one another, their entries in rows no wider than `width`.
    pub(super) fn below(font: &Font, groups: &[Group<'_>], width: f64) -> Option<Self> {
        let mut legend = Self::empty();
        for group in groups.iter().filter(|group| !group.entries.is_empty()) {
            let title = group.title.unwrap_or_default();
            let title_width = font.width(title, SIZE);
            let fitting = |left: f64| {
                let entries = entries(font, group, width - left);
                let widest = entries.iter().map(|(_, lines)| entry_width(font, lines)).fold(0.0, f64::max);
                let columns = ((width - left + COLUMN_GAP) / (widest + COLUMN_GAP)) as usize;
                // Rows are as even as their number allows.
                let rows = entries.len().div_ceil(columns.clamp(1, entries.len()));
                (entries.len().div_ceil(rows), rows, widest, entries)
            };
            // Above the entries, a title takes a row of its own.
            let beside = title_width + COLUMN_GAP;
            let is_short = title_width < 0.25 * width && fitting(beside).1 <= fitting(0.0).1 + 1;
            let lines = if title.is_empty() { Vec::new() } else { wrap(font, title, SIZE, width, 2) };
            let mut y = legend.below_last();
            let left = if is_short && !lines.is_empty() { beside } else { 0.0 };
            if left > 0.0 {
                legend.put_text([0.0, y], lines, title_width);
            } else {
                y += legend.title(font, lines);
            }
            let (columns, _, widest, entries) = fitting(left);
            for row in entries.chunks(columns) {
                let tall = row.iter().map(|(_, lines)| entry_height(lines)).fold(0.0, f64::max);
                for (column, (stroke, lines)) in row.iter().enumerate() {
                    let at = [left + column as f64 * (widest + COLUMN_GAP), y];
                    legend.put(at, (*stroke, group.are_points), lines.clone(), entry_width(font, lines), tall);
                }
                y += tall;
            }
        }
        legend.finish()
    }

    fn empty() -> Self {
        Self { items: Vec::new(), width: 0.0, height: 0.0 }
    }

    fn finish(self) -> Option<Self> {
        (!self.items.is_empty()).then_some(self)
    }

    /// Where the next group starts.
    fn below_last(&self) -> f64 {
        if self.items.is_empty() { 0.0 } else { self.height + GROUP_GAP }
    }

    /// Puts a title where the next group starts; returns its height.
    fn title(&mut self, font: &Font, lines: Vec<String>) -> f64 {
        if lines.is_empty() {
            return 0.0;
        }
        let (wide, tall) = (widest(font, &lines), lines.len() as f64 * LINE);
        let top = self.below_last();
        self.put_text([0.0, top], lines, wide);
        tall + TITLE_GAP
    }

    fn put_text(&mut self, at: Point, lines: Vec<String>, wide: f64) {
        let tall = lines.len() as f64 * LINE;
        self.items.push(Item { at, stroke: None, is_point: false, lines, indent: 0.0 });
        (self.width, self.height) = (self.width.max(at[0] + wide), self.height.max(at[1] + tall));
    }

    fn put(&mut self, at: Point, (stroke, is_point): (Option<Stroke>, bool), lines: Vec<String>, wide: f64, tall: f64) {
        self.items.push(Item { at, stroke, is_point, lines, indent: SAMPLE + BLANK });
        (self.width, self.height) = (self.width.max(at[0] + wide), self.height.max(at[1] + tall));
    }

    /// Draws the legend with its upper left corner at `at`.
    pub(super) fn draw(&self, scene: &mut Scene, at: Point) {
        for item in &self.items {
            let [left, top] = [at[0] + item.at[0], at[1] + item.at[1]];
            if let Some(stroke) = item.stroke {
                let y = top + 0.5 * LINE;
                if item.is_point {
                    scene.dot([left + 0.5 * SAMPLE, y], DOT * stroke.width, stroke.color);
                } else {
                    let wider = Stroke { width: stroke.width + 0.4, ..stroke.butt() };
                    scene.line(&[[left, y], [left + SAMPLE, y]], wider);
                }
            }
            for (row, line) in item.lines.iter().enumerate() {
                let at = [left + item.indent, top + (row as f64 + 0.5) * LINE + Font::middle(SIZE)];
                scene.text(Text::new(line, at, SIZE, Align::Start).color(INK));
            }
        }
    }
}

/// The entries of a group, each in lines; of too many the first.
fn entries(font: &Font, group: &Group<'_>, widest: f64) -> Vec<(Option<Stroke>, Vec<String>)> {
    let width = (widest - SAMPLE - BLANK).clamp(40.0, WIDEST);
    let labels: Vec<&str> = group.entries.iter().take(MOST_ENTRIES).map(|(label, _)| *label).collect();
    let strokes = group.entries.iter().map(|(_, stroke)| Some(*stroke));
    let shown = strokes.zip(labels_in_lines(font, &labels, width));
    let more = group.entries.len().checked_sub(MOST_ENTRIES + 1).map(|more| format!("… and {} more", more + 1));
    shown.chain(more.map(|more| (None, vec![more]))).collect()
}

/// Labels in lines no wider than `width`: long ones are cut at their ends, but where different ones would look alike then, before their ends, and
/// where they still do, in more lines.
fn labels_in_lines(font: &Font, labels: &[&str], width: f64) -> Vec<Vec<String>> {
    let wrapped = |most: usize, wrap: fn(&Font, &str, f64, f64, usize) -> Vec<String>| -> Vec<Vec<String>> {
        labels.iter().map(|label| wrap(font, label, SIZE, width, most)).collect()
    };
    let different = labels.iter().collect::<HashSet<_>>().len();
    let are_told_apart = |lines: &Vec<Vec<String>>| lines.iter().collect::<HashSet<_>>().len() == different;
    let first = wrapped(LINES, wrap);
    if are_told_apart(&first) {
        return first;
    }
    let mut others = (LINES..=MOST_LINES).map(|most| wrapped(most, wrap_to_end));
    others.find(are_told_apart).unwrap_or(first)
}

fn entry_height(lines: &[String]) -> f64 {
    lines.len() as f64 * LINE + GAP
}

fn entry_width(font: &Font, lines: &[String]) -> f64 {
    SAMPLE + BLANK + widest(font, lines)
}

fn widest(font: &Font, lines: &[String]) -> f64 {
    lines.iter().map(|line| font.width(line, SIZE)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_labels_that_differ_look_different() {
        let font = Font::load().unwrap();
        let long = "a_very_long_name_of_an_element_between_the_upper_arm_and_the_forearm_of_the_robot_on_the";
        let (left, right) = (format!("{long}_left"), format!("{long}_right"));
        let within = [format!("{long}_1_{long}_{long}"), format!("{long}_2_{long}_{long}")];
        for labels in [[&left, &right], [&within[0], &within[1]]] {
            let lines = labels_in_lines(&font, &labels.map(String::as_str), WIDEST);
            assert!(lines[0] != lines[1], "{lines:?}");
            assert!(lines.iter().flatten().all(|line| font.width(line, SIZE) <= WIDEST), "{lines:?}");
        }
        // One alone, and the same twice, are cut at their ends.
        let lines = labels_in_lines(&font, &[&left, &left, "short"], WIDEST);
        assert!(lines[0].len() == LINES && lines[0][1].ends_with('…') && lines[1] == lines[0] && lines[2] == ["short"]);
    }
}
