//! Tables that are broken from page to page and are no wider than one.

use super::text;

/// Width of a page's text, of a character in small print and between two columns, mm.
const PAGE: f64 = 170.0;
const CHARACTER: f64 = 1.55;
const BETWEEN: f64 = 4.3;

/// The head of a column.
#[derive(Debug, Clone)]
pub struct Column {
    /// What stands there.
    pub title: Cell,
    /// Whether it holds numbers, which stand at its right.
    pub is_number: bool,
}

/// LaTeX that fits into a table, and about how many characters wide it is.
#[derive(Debug, Clone)]
pub struct Cell {
    latex: String,
    width: usize,
}

impl Cell {
    /// Text, none of it a command.
    pub fn text(plain: &str) -> Self {
        Self { latex: text(plain), width: plain.chars().count() }
    }

    /// LaTeX of what is so wide as this text.
    pub fn latex(latex: String, plain: &str) -> Self {
        Self { latex, width: plain.chars().count() }
    }
}

/// A table in small print under this caption, of text; without a head where no column has a title, and nothing where there are no columns.
pub fn table(caption: &str, columns: &[Column], rows: &[Vec<Cell>]) -> String {
    if columns.is_empty() {
        return String::new();
    }
    let widths: Vec<f64> = (columns.iter().enumerate())
        .map(|(k, column)| {
            let cells = rows.iter().filter_map(|row| row.get(k)).chain([&column.title]);
            CHARACTER * cells.map(|cell| cell.width).max().unwrap_or(0) as f64
        })
        .collect();
    let room = PAGE - BETWEEN * columns.len() as f64;
    let most = widest(&widths, room);
    let kind = |(column, width): (&Column, &f64)| match (*width > most, column.is_number) {
        (true, _) => format!(">{{\\raggedright\\arraybackslash}}p{{{most:.1}mm}}"),
        (false, true) => "r".to_owned(),
        (false, false) => "l".to_owned(),
    };
    let kinds: Vec<String> = columns.iter().zip(&widths).map(kind).collect();
    let line = |cells: &mut dyn Iterator<Item = &Cell>| {
        let cells: Vec<&str> = cells.map(|cell| &*cell.latex).collect();
        // What begins with a bracket or a star is not taken for an option of the line before it.
        format!("{{}}{} \\\\\n", cells.join(" & "))
    };
    let mut out = String::new();
    if !caption.is_empty() {
        out.push_str(&format!("\\textbf{{{}}}\\nopagebreak\n\n", text(caption)));
    }
    out.push_str(&format!("{{\\footnotesize\n\\begin{{longtable}}{{@{{}}{}@{{}}}}\n\\hline\n", kinds.concat()));
    if columns.iter().any(|column| column.title.width > 0) {
        out.push_str(&line(&mut columns.iter().map(|column| &column.title)));
        out.push_str("\\hline\n");
    }
    out.push_str("\\endhead\n\\hline\n\\endfoot\n");
    for row in rows {
        out.push_str(&line(&mut row.iter()));
    }
    out.push_str("\\end{longtable}}\n\n");
    out
}

/// The width that the widest columns are cut to, so that all of them have room.
fn widest(widths: &[f64], room: f64) -> f64 {
    let mut sorted = widths.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut left = room;
    for (k, width) in sorted.iter().enumerate() {
        let share = left / (sorted.len() - k) as f64;
        if *width > share {
            return share;
        }
        left -= width;
    }
    f64::INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_columns_share_what_the_others_leave() {
        assert_eq!(widest(&[10.0, 20.0], 40.0), f64::INFINITY);
        assert_eq!(widest(&[10.0, 100.0, 70.0], 90.0), 40.0);
        let column = |title: &str, is_number| Column { title: Cell::text(title), is_number };
        let columns = [column("meaning", false), column("value", true)];
        let rows = [vec![Cell::text(&"word ".repeat(60)), Cell::text("1 & 2")]];
        let table = table("100 %", &columns, &rows);
        assert!(table.contains("p{153.") && table.contains("1 \\& 2 \\\\") && table.contains("100 \\%"), "{table}");
    }
}
