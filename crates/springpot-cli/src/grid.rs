//! Tables of text: columns that line up, names cut where the terminal is too narrow.

use crate::plain;
use springpot_run::table::CUT;
use std::cmp::Reverse;
use std::collections::HashSet;

/// Blanks between columns.
const GAP: usize = 2;
/// No column is cut below this.
const NARROWEST: usize = 8;
/// Most names among which the best place for the cut is looked for.
const MOST_COMPARED: usize = 500;

/// A table; its columns are as wide as their widest text.
#[derive(Debug)]
pub(crate) struct Grid {
    columns: Vec<Column>,
    rows: Vec<Vec<String>>,
}

/// How a column is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Set {
    /// Flush left.
    Text,
    /// Flush left; the first to be cut.
    Name,
    /// Decimal points under one another.
    Number,
}

#[derive(Debug)]
struct Column {
    title: String,
    set: Set,
}

impl Grid {
    /// A table without rows; columns without a title have none in the head.
    pub(crate) fn new<T: Into<String>>(columns: impl IntoIterator<Item = (T, Set)>) -> Self {
        let columns = columns.into_iter().map(|(title, set)| Column { title: title.into(), set }).collect();
        Self { columns, rows: Vec::new() }
    }

    /// Adds a row; every field is shown on one line.
    pub(crate) fn row(&mut self, fields: Vec<String>) {
        debug_assert_eq!(fields.len(), self.columns.len());
        self.rows.push(fields.iter().map(|field| plain::line(field)).collect());
    }

    /// Takes out the columns in which every row is empty.
    pub(crate) fn without_empty_columns(mut self) -> Self {
        let kept: Vec<bool> = (0..self.columns.len()).map(|c| self.rows.iter().any(|row| !row[c].is_empty())).collect();
        let mut keep = kept.iter();
        self.columns.retain(|_| *keep.next().unwrap_or(&true));
        for row in &mut self.rows {
            let mut keep = kept.iter();
            row.retain(|_| *keep.next().unwrap_or(&true));
        }
        self
    }

    /// The lines, none longer than `width` as far as names can be cut for it.
    pub(crate) fn text(&self, width: Option<usize>) -> String {
        let rows = self.with_points_aligned();
        let widest = |c: usize| rows.iter().map(|row| width_of(&row[c])).max().unwrap_or(0);
        let with_title = |(c, column): (usize, &Column)| width_of(&column.title).max(widest(c));
        let mut widths: Vec<usize> = self.columns.iter().enumerate().map(with_title).collect();
        if let Some(width) = width {
            self.narrow(&mut widths, width);
        }
        let heads: Vec<usize> = (0..self.columns.len()).map(|c| self.best_head(c, widths[c])).collect();
        let titles: Vec<String> = self.columns.iter().map(|column| column.title.clone()).collect();
        let head = titles.iter().any(|title| !title.is_empty()).then_some(&titles);
        let mut text = String::new();
        for row in head.into_iter().chain(&rows) {
            let mut line = String::new();
            for (c, (field, column)) in row.iter().zip(&self.columns).enumerate() {
                let width = widths[c];
                let field = cut(field, width, heads[c]);
                let blanks = " ".repeat(width - width_of(&field));
                match column.set {
                    Set::Number => line.push_str(&format!("{blanks}{field}")),
                    Set::Text | Set::Name => line.push_str(&format!("{field}{blanks}")),
                }
                line.push_str(&" ".repeat(GAP));
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }

    /// The rows, numbers filled up with blanks behind the point.
    fn with_points_aligned(&self) -> Vec<Vec<String>> {
        let mut rows = self.rows.clone();
        for c in (0..self.columns.len()).filter(|&c| self.columns[c].set == Set::Number) {
            let most = self.rows.iter().map(|row| behind_the_point(&row[c])).max().unwrap_or(0);
            for row in rows.iter_mut().filter(|row| !row[c].is_empty()) {
                let blanks = most - behind_the_point(&row[c]);
                row[c].extend(std::iter::repeat_n(' ', blanks));
            }
        }
        rows
    }

    /// How much of the names in a column is best kept before the cut: as few as possible should look alike.
    fn best_head(&self, c: usize, width: usize) -> usize {
        let long: Vec<&String> = self.rows.iter().map(|row| &row[c]).filter(|field| width_of(field) > width).collect();
        let middle = width.saturating_sub(1).div_ceil(2);
        if long.len() < 2 || long.len() > MOST_COMPARED {
            return middle;
        }
        let different = |head: &usize| {
            let texts: HashSet<String> = long.iter().map(|field| cut(field, width, *head)).collect();
            texts.len()
        };
        // Of equally good ones the one nearest to the middle.
        let heads = (0..width).map(|head| (different(&head), Reverse(head.abs_diff(middle)), head));
        heads.max().map_or(middle, |(_, _, head)| head)
    }

    /// Takes from the widest of the names until the line fits.
    fn narrow(&self, widths: &mut [usize], width: usize) {
        let total = |widths: &[usize]| widths.iter().sum::<usize>() + GAP * widths.len().saturating_sub(1);
        while total(widths) > width {
            let names = (0..widths.len()).filter(|&c| self.columns[c].set == Set::Name && widths[c] > NARROWEST);
            let Some(widest) = names.max_by_key(|&c| widths[c]) else { return };
            widths[widest] -= 1;
        }
    }
}

/// Columns from the decimal point on.
fn behind_the_point(number: &str) -> usize {
    number.find(['.', 'e']).map_or(0, |at| width_of(&number[at..]))
}

/// Columns that a text takes: marks above a letter take none.
pub(crate) fn width_of(text: &str) -> usize {
    text.chars().filter(|c| !('\u{300}'..='\u{36f}').contains(c)).count()
}

/// A text of which `head` characters are kept before what is left out, where it is too long.
fn cut(text: &str, width: usize, head: usize) -> String {
    if width_of(text) <= width {
        return text.to_owned();
    }
    let characters: Vec<char> = text.chars().collect();
    let kept = width.saturating_sub(1);
    let head = head.min(kept);
    let ends = characters[..head].iter().chain([&CUT]).chain(&characters[characters.len() - (kept - head)..]);
    ends.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        let mut grid = Grid::new([("name", Set::Name), ("kind", Set::Text), ("", Set::Text), ("x", Set::Number)]);
        grid.row(["left_shoulder_pitch_joint", "revolute", "", "1.5"].map(String::from).to_vec());
        grid.row(["q\u{308}", "prismatic", "", "-10"].map(String::from).to_vec());
        grid
    }

    #[test]
    fn columns_line_up() {
        let expected = "\
name                       kind           x
left_shoulder_pitch_joint  revolute     1.5
q\u{308}                          prismatic  -10
";
        assert_eq!(grid().without_empty_columns().text(None), expected);
        assert_eq!(grid().without_empty_columns().text(Some(43)), expected);
    }

    #[test]
    fn names_are_cut_to_fit() {
        let expected = "\
name         kind           x
left_…joint  revolute     1.5
q\u{308}            prismatic  -10
";
        assert_eq!(grid().without_empty_columns().text(Some(29)), expected);
        assert_eq!(cut("abcdef", 5, 2), "ab…ef");
        assert_eq!(cut("abcdef", 6, 2), "abcdef");
        // What is no name stays whole, whatever the width.
        assert!(grid().text(Some(5)).contains("prismatic"));
    }

    #[test]
    fn cut_names_stay_different() {
        let mut grid = Grid::new([("", Set::Name)]);
        for name in ["r_gripper_l_finger_joint", "r_gripper_r_finger_joint", "r_gripper_l_finger_tip_joint"] {
            grid.row(vec![name.to_owned()]);
        }
        let text = grid.text(Some(20));
        let lines: HashSet<&str> = text.lines().collect();
        assert!(lines.len() == 3 && lines.iter().all(|line| width_of(line) == 20), "{text}");
    }

    #[test]
    fn names_are_one_line() {
        let mut grid = Grid::new([("", Set::Name)]);
        grid.row(vec!["a\nb\u{1b}[31m".to_owned()]);
        assert_eq!(grid.text(None), "a␊b␛[31m\n");
    }
}
