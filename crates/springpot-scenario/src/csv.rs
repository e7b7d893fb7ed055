//! Columns of numbers from CSV files: a header row, a time column that increases, UTF-8.

mod error;
mod lines;
mod rows;

pub use error::{CsvError, CsvProblem};
pub use rows::{CsvRow, CsvRows};

use crate::units::Unit;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Most data rows of a file.
pub const MAX_ROWS: u64 = 20_000_000;
/// Most numbers (rows × columns) of a file.
pub const MAX_NUMBERS: u64 = 100_000_000;
/// Longest line of a file, in bytes.
pub const MAX_LINE: u64 = 1 << 20;
/// Name of the time column where none is given.
pub const TIME: &str = "t";

/// How a file writes its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// Name of the time column.
    pub time: String,
    /// What its times are multiplied with, s.
    pub time_scale: f64,
    /// What stands between cells; where it is `;` a comma is the decimal point.
    pub separator: char,
}

impl Default for Dialect {
    /// `t` in seconds, separated by commas.
    fn default() -> Self {
        Self { time: TIME.to_owned(), time_scale: 1.0, separator: ',' }
    }
}

/// A table read from a CSV file.
///
/// The first row names the columns; the time column, `t` wherever it stands, has finite and increasing numbers. Other
/// columns are judged when they are asked for, so text in a column that nobody uses does no harm. A byte order mark, CRLF,
/// blank lines, blanks around numbers and quoted cells are fine.
#[derive(Debug, Clone)]
pub struct CsvTable {
    file: std::path::PathBuf,
    headers: Vec<String>,
    header_line: u64,
    time: usize,
    columns: Vec<Column>,
}

#[derive(Debug, Clone, Default)]
struct Column {
    numbers: Vec<f64>,
    /// First cell that is not a finite number: its line and text.
    flaw: Option<(u64, String)>,
}

impl CsvTable {
    /// Reads a file whose time column is `t`.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, CsvError> {
        Self::read_with_time(path, TIME)
    }

    /// Reads a file whose time column has another name.
    ///
    /// The file's lines are counted first: one that is too large is refused before memory is taken for it.
    pub fn read_with_time(path: impl AsRef<Path>, time: &str) -> Result<Self, CsvError> {
        Self::read_as(path, &Dialect { time: time.to_owned(), ..Dialect::default() })
    }

    /// Reads a file that is written in a dialect of its own.
    pub fn read_as(path: impl AsRef<Path>, dialect: &Dialect) -> Result<Self, CsvError> {
        let path = path.as_ref();
        let with_file = |problem: CsvProblem| CsvError { file: path.to_owned(), problem };
        let unreadable = |source| with_file(CsvProblem::Unreadable { source });
        let open = || File::open(path).map_err(unreadable);
        // Looked at before it is opened: opening a pipe would wait for its other end.
        if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
            return Err(with_file(CsvProblem::NotAFile));
        }
        let lines = count_lines(BufReader::with_capacity(1 << 16, open()?)).map_err(with_file)?;
        parse(path, BufReader::with_capacity(1 << 16, open()?), dialect, lines).map_err(with_file)
    }

    /// Reads a table from memory; `file` is the name that errors give it.
    pub fn from_bytes(file: impl AsRef<Path>, bytes: &[u8], time: &str) -> Result<Self, CsvError> {
        let file = file.as_ref();
        let dialect = Dialect { time: time.to_owned(), ..Dialect::default() };
        let table = count_lines(bytes).and_then(|lines| parse(file, bytes, &dialect, lines));
        table.map_err(|problem| CsvError { file: file.to_owned(), problem })
    }

    /// The file it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Names of the columns, in the file's order.
    pub fn headers(&self) -> &[String] {
        &self.headers
    }

    /// Times, s, increasing; at least two.
    pub fn time(&self) -> &[f64] {
        &self.columns[self.time].numbers
    }

    /// The numbers of a column, as many as there are times; an error if one of them is none or is not finite.
    pub fn column(&self, name: &str) -> Result<&[f64], CsvError> {
        let with_file = |problem| CsvError { file: self.file.clone(), problem };
        let Some(index) = self.headers.iter().position(|header| header == name) else {
            return Err(with_file(missing(name, &self.headers, self.header_line)));
        };
        let column = &self.columns[index];
        match &column.flaw {
            None => Ok(&column.numbers),
            Some((line, text)) => Err(with_file(not_a_number(text, *line, index, name))),
        }
    }
}

/// Name and unit of a column of measured numbers, where its heading tells one: `Force [kN]`.
pub fn heading(written: &str) -> Option<(&str, Unit)> {
    let (name, unit) = bracket(written)?;
    Some((name, Unit::parse(unit, &|_| None).ok()?))
}

/// What stands before brackets at the end of a heading, and in them.
pub(crate) fn bracket(written: &str) -> Option<(&str, &str)> {
    let (name, rest) = written.trim().split_once('[')?;
    Some((name.trim(), rest.strip_suffix(']')?.trim()))
}

/// The numbers of the columns of these names of a file with `most` rows at most, whatever else is in it.
///
/// # Errors
/// What is wrong with the file, its header or one of those columns.
pub fn columns(path: &Path, names: &[&str], most: usize) -> Result<Vec<Vec<f64>>, CsvError> {
    separated_columns(path, names, (most, ','))
}

/// As [`columns`], of a file whose cells are separated by another character; where that is `;` a comma is the decimal point.
///
/// # Errors
/// As [`columns`].
pub fn separated_columns(
    path: &Path,
    names: &[&str],
    (most, separator): (usize, char),
) -> Result<Vec<Vec<f64>>, CsvError> {
    let unreadable = |source| CsvProblem::Unreadable { source };
    let read = || -> Result<_, CsvProblem> {
        // Looked at before it is opened: opening a pipe would wait for its other end.
        if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
            return Err(CsvProblem::NotAFile);
        }
        let file = File::open(path).map_err(unreadable)?;
        let mut rows = CsvRows::separated(BufReader::new(file), separator)?;
        let at = names.iter().map(|name| rows.find(name)).collect::<Result<Vec<_>, _>>()?;
        let mut columns = vec![Vec::new(); names.len()];
        while let Some(row) = rows.next_row()? {
            if columns.first().is_some_and(|column| column.len() == most) {
                return Err(CsvProblem::TooLarge { limit: most as u64, what: "rows" });
            }
            for (column, &at) in columns.iter_mut().zip(&at) {
                column.push(row.number(at)?);
            }
        }
        Ok(columns)
    };
    read().map_err(|problem| CsvError { file: path.to_owned(), problem })
}

/// Lines that are not empty; refuses what no table may have.
fn count_lines(mut reader: impl BufRead) -> Result<u64, CsvProblem> {
    let (mut lines, mut length, mut line) = (0_u64, 0_u64, 1_u64);
    loop {
        let chunk = reader.fill_buf().map_err(|source| CsvProblem::Unreadable { source })?;
        if chunk.is_empty() {
            return Ok(lines + u64::from(length > 0));
        }
        for &byte in chunk {
            if byte == b'\n' || byte == b'\r' {
                lines += u64::from(length > 0);
                length = 0;
                line += u64::from(byte == b'\n');
            } else {
                length += 1;
            }
            if length > MAX_LINE {
                return Err(CsvProblem::LongLine { line, limit: MAX_LINE });
            }
        }
        if lines > MAX_ROWS + 1 {
            return Err(CsvProblem::TooLarge { limit: MAX_ROWS, what: "rows" });
        }
        let used = chunk.len();
        reader.consume(used);
    }
}

fn parse(file: &Path, reader: impl Read, dialect: &Dialect, lines: u64) -> Result<CsvTable, CsvProblem> {
    let mut rows = CsvRows::separated(reader, dialect.separator)?;
    let time = rows.find(&dialect.time)?;
    let headers = rows.headers().to_vec();
    if lines.saturating_mul(headers.len() as u64) > MAX_NUMBERS {
        return Err(CsvProblem::TooLarge { limit: MAX_NUMBERS, what: "numbers" });
    }
    let capacity = lines.saturating_sub(1) as usize;
    let mut columns: Vec<Column> =
        headers.iter().map(|_| Column { numbers: Vec::with_capacity(capacity), flaw: None }).collect();
    while let Some(row) = rows.next_row()? {
        read_row(&row, time, &mut columns)?;
    }
    let given = columns[time].numbers.len();
    if given < 2 {
        return Err(CsvProblem::TooFewRows { line: rows.line(), given });
    }
    columns[time].numbers.iter_mut().for_each(|time| *time *= dialect.time_scale);
    Ok(CsvTable { file: file.to_owned(), headers, header_line: rows.header_line(), time, columns })
}

fn read_row(row: &CsvRow, time: usize, columns: &mut [Column]) -> Result<(), CsvProblem> {
    for (index, column) in columns.iter_mut().enumerate() {
        let text = row.text(index)?;
        let number = row.parse(text).unwrap_or(f64::NAN);
        if !number.is_finite() && index == time {
            row.number(index)?;
        }
        if !number.is_finite() && column.flaw.is_none() {
            column.flaw = Some((row.line(), shorten(text)));
        }
        column.numbers.push(number);
    }
    match columns[time].numbers[..] {
        [.., before, now] if now <= before => {
            Err(CsvProblem::TimeNotIncreasing { line: row.line(), time: now, before })
        }
        _ => Ok(()),
    }
}

fn not_a_number(text: &str, line: u64, index: usize, name: &str) -> CsvProblem {
    let (text, name, column) = (shorten(text), shorten(name), index + 1);
    if text.is_empty() {
        return CsvProblem::NoNumber { line, column, name };
    }
    // "nan" and "inf" parse, and so does 1e999.
    if text.parse::<f64>().is_ok() {
        CsvProblem::NotFinite { text, line, column, name }
    } else {
        CsvProblem::NotANumber { text, line, column, name }
    }
}

fn missing(name: &str, headers: &[String], line: u64) -> CsvProblem {
    let lower = name.to_lowercase();
    let short = headers.iter().take(1000).filter(|header| header.len() <= 64);
    let distance = |header: &str| strsim::damerau_levenshtein(&lower, &header.to_lowercase());
    let close = short.map(|header| (distance(header), header)).min_by_key(|(distance, _)| *distance);
    // One letter of two, a third of many may be wrong.
    let near = close.filter(|(distance, header)| {
        let length = header.len().min(name.len());
        *distance == 0 || (length > 1 && *distance <= (length / 3).max(1))
    });
    let time = headers.iter().find(|header| name == TIME && header.to_lowercase().starts_with("time"));
    let suggestion = time.or(near.map(|(_, header)| header)).map(|header| shorten(header));
    let listed = headers.iter().take(20).map(|header| shorten(header)).collect();
    CsvProblem::MissingColumn { line, name: shorten(name), suggestion, headers: listed }
}

/// At most 40 characters, for messages.
fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
