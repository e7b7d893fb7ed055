//! The legend, to the right of the panels.

use crate::draw::{Align, Font, INK, Point, Scene, Stroke, Text, wrap};

/// Size of the legend's text, pixels.
const SIZE: f64 = 12.0;
const LINE: f64 = 15.0;
/// Free height between two entries.
const GAP: f64 = 4.0;
/// Length of the sample of each curve, and the blank after it.
const SAMPLE: f64 = 26.0;
const BLANK: f64 = 8.0;
/// Widest label; longer ones are wrapped.
const WIDEST: f64 = 210.0;
const MOST_ENTRIES: usize = 96;

/// A legend that knows its size.
pub(super) struct Legend {
    title: Vec<String>,
    columns: Vec<Column>,
    pub(super) width: f64,
    pub(super) height: f64,
}

struct Column {
    entries: Vec<(Option<Stroke>, Vec<String>)>,
    width: f64,
}

impl Legend {
    /// Lays out entries in columns no higher than `height`, where one column does not hold them. `None` when there is nothing to say.
    pub(super) fn new(font: &Font, title: Option<&str>, entries: &[(&str, Stroke)], height: f64) -> Option<Self> {
        if entries.is_empty() {
            return None;
        }
        let lines = |text: &str| wrap(font, text, SIZE, WIDEST, 2);
        let mut shown: Vec<_> =
            entries.iter().take(MOST_ENTRIES).map(|(label, stroke)| (Some(*stroke), lines(label))).collect();
        if entries.len() > MOST_ENTRIES {
            shown.push((None, vec![format!("… and {} more", entries.len() - MOST_ENTRIES)]));
        }
        let title = title.map(lines).unwrap_or_default();
        let title_height = Self::title_height(&title);
        let mut columns: Vec<Column> = Vec::new();
        let (mut used, mut tallest) = (f64::INFINITY, 0.0f64);
        for entry in shown {
            let tall = entry_height(&entry.1);
            if used + tall > height - title_height {
                columns.push(Column { entries: Vec::new(), width: 0.0 });
                used = 0.0;
            }
            used += tall;
            tallest = tallest.max(used);
            let wide = SAMPLE + BLANK + widest(font, &entry.1);
            if let Some(column) = columns.last_mut() {
                column.width = column.width.max(wide);
                column.entries.push(entry);
            }
        }
        let gaps = 14.0 * columns.len().saturating_sub(1) as f64;
        let width = columns.iter().map(|c| c.width).sum::<f64>() + gaps;
        Some(Self { width: width.max(widest(font, &title)), height: title_height + tallest, title, columns })
    }

    fn title_height(title: &[String]) -> f64 {
        if title.is_empty() { 0.0 } else { title.len() as f64 * LINE + GAP + 2.0 }
    }

    /// Draws the legend with its upper left corner at `at`.
    pub(super) fn draw(&self, scene: &mut Scene, at: Point) {
        let middle = |row: usize| (row as f64 + 0.5) * LINE + Font::middle(SIZE);
        for (row, line) in self.title.iter().enumerate() {
            scene.text(Text::new(line, [at[0], at[1] + middle(row)], SIZE, Align::Start));
        }
        let mut left = at[0];
        for column in &self.columns {
            let mut top = at[1] + Self::title_height(&self.title);
            for (stroke, lines) in &column.entries {
                if let Some(stroke) = stroke {
                    let y = top + 0.5 * LINE;
                    scene.line(&[[left, y], [left + SAMPLE, y]], Stroke { width: stroke.width + 0.4, ..stroke.butt() });
                }
                for (row, line) in lines.iter().enumerate() {
                    let at = [left + SAMPLE + BLANK, top + middle(row)];
                    scene.text(Text::new(line, at, SIZE, Align::Start).color(INK));
                }
                top += entry_height(lines);
            }
            left += column.width + 14.0;
        }
    }
}

fn entry_height(lines: &[String]) -> f64 {
    lines.len() as f64 * LINE + GAP
}

fn widest(font: &Font, lines: &[String]) -> f64 {
    lines.iter().map(|line| font.width(line, SIZE)).fold(0.0, f64::max)
}
