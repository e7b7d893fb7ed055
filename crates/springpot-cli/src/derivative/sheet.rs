//! The rows of the input: which columns are wanted, and the text that is written again.

use super::Problem;
use crate::arguments::DerivativeOptions;
use springpot::fractional::{Definition, DerivativeError};
use springpot::signal::csv::{CsvProblem, CsvRow, CsvRows, TIME};
use std::io::Read;

/// Which columns are read and in which order they are written.
#[derive(Debug)]
pub(super) struct Layout {
    /// Column of the times.
    time: usize,
    /// Columns to differentiate.
    columns: Vec<usize>,
    pub(super) orders: Vec<f64>,
    pub(super) definition: Definition,
    /// The input's columns as they are written: time first.
    written: Vec<usize>,
    names: Vec<String>,
}

impl Layout {
    pub(super) fn new(options: &DerivativeOptions, rows: &CsvRows<impl Read>) -> Result<Self, Problem> {
        let names = rows.headers();
        let time = match &options.time {
            Some(name) => rows.find(name)?,
            None => names.iter().position(|name| name == TIME).unwrap_or(0),
        };
        let columns = options.columns.iter().map(|name| rows.find(name)).collect::<Result<Vec<_>, _>>()?;
        for (k, column) in columns.iter().enumerate() {
            let name = &names[*column];
            if *column == time {
                return Err(Problem::TimeItself(name.clone()));
            }
            if columns[..k].contains(column) {
                return Err(Problem::ColumnTwice(name.clone()));
            }
        }
        let mut written = vec![time];
        written.extend((0..names.len()).filter(|column| *column != time));
        let (orders, definition) = (options.orders.clone(), options.kind);
        Ok(Self { time, columns, orders, definition, written, names: names.to_vec() })
    }

    /// Refuses an order before a row is read.
    pub(super) fn check_orders(&self) -> Result<(), Problem> {
        for (k, order) in self.orders.iter().enumerate() {
            if !(-2.0..=2.0).contains(order) {
                return Err(DerivativeError::Order(*order).into());
            }
            if self.orders[..k].contains(order) {
                return Err(Problem::OrderTwice(*order));
            }
        }
        Ok(())
    }

    /// Number of columns to differentiate.
    pub(super) fn count(&self) -> usize {
        self.columns.len()
    }

    /// The header line; `with_error` puts an estimate behind every derivative.
    pub(super) fn header(&self, with_error: bool) -> Vec<u8> {
        let mut cells: Vec<String> = self.written.iter().map(|column| self.names[*column].clone()).collect();
        for column in &self.columns {
            for order in &self.orders {
                let name = format!("D^{order} {}", self.names[*column]);
                cells.push(name.clone());
                if with_error {
                    cells.push(format!("error of {name}"));
                }
            }
        }
        let mut text = Vec::new();
        push_cells(&mut text, cells.iter().map(String::as_bytes));
        text.push(b'\n');
        text
    }

    /// The row's cells as they are written, time first.
    pub(super) fn text(&self, row: &CsvRow, text: &mut Vec<u8>) {
        let cells: Vec<&[u8]> = row.cells().collect();
        push_cells(text, self.written.iter().map(|column| cells[*column]));
    }

    /// The time, which must follow `before`.
    pub(super) fn time(&self, row: &CsvRow, before: Option<f64>) -> Result<f64, CsvProblem> {
        let time = row.number(self.time)?;
        match before {
            Some(before) if time <= before => Err(CsvProblem::TimeNotIncreasing { line: row.line(), time, before }),
            _ => Ok(time),
        }
    }

    /// The numbers to differentiate.
    pub(super) fn values(&self, row: &CsvRow) -> impl Iterator<Item = Result<f64, CsvProblem>> {
        self.columns.iter().map(|column| row.number(*column))
    }

    /// A unit of the last digit that the row's time is written with: what two rounded times may differ by from their step.
    fn last_digit(&self, row: &CsvRow) -> f64 {
        let Ok(text) = row.text(self.time) else { return 0.0 };
        let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len()) as i32;
        10f64.powi(exponent.parse::<i32>().unwrap_or(0).saturating_sub(decimals))
    }
}

/// Rows that are held.
#[derive(Debug, Default)]
pub(super) struct Sheet {
    pub(super) times: Vec<f64>,
    /// The numbers to differentiate, column by column.
    pub(super) values: Vec<Vec<f64>>,
    /// Line of every row.
    lines: Vec<u64>,
    text: Vec<u8>,
    ends: Vec<usize>,
    /// The largest unit of a last digit of the times.
    rounding: f64,
}

impl Sheet {
    pub(super) fn push(&mut self, layout: &Layout, row: &CsvRow) -> Result<(), Problem> {
        self.times.push(layout.time(row, self.times.last().copied())?);
        self.values.resize_with(layout.count(), Vec::new);
        for (column, value) in self.values.iter_mut().zip(layout.values(row)) {
            column.push(value?);
        }
        layout.text(row, &mut self.text);
        self.ends.push(self.text.len());
        self.lines.push(row.line());
        self.rounding = self.rounding.max(layout.last_digit(row));
        Ok(())
    }

    /// Bytes held, about.
    pub(super) fn size(&self) -> usize {
        self.text.len() + self.times.len() * 8 * (self.values.len() + 3)
    }

    pub(super) fn line(&self, row: usize) -> u64 {
        self.lines[row.min(self.lines.len() - 1)]
    }

    /// The text of a row, without its end.
    pub(super) fn row_text(&self, row: usize) -> &[u8] {
        let start = if row == 0 { 0 } else { self.ends[row - 1] };
        &self.text[start..self.ends[row]]
    }

    /// Times from the first on; those that are equal steps to the rounding they are written with are equal steps.
    pub(super) fn times_from_start(&self) -> Vec<f64> {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let step = (last - first) / (self.times.len() - 1).max(1) as f64;
        let allowed = (self.rounding + 4.0 * f64::EPSILON * first.abs().max(last.abs())).min(1e-2 * step);
        let equal = |k: usize, t: f64| (t - first - k as f64 * step).abs() <= allowed;
        let is_equal = self.times.iter().enumerate().all(|(k, t)| equal(k, *t));
        let times = self.times.iter().enumerate();
        times.map(|(k, t)| if is_equal { k as f64 * step } else { t - first }).collect()
    }
}

/// Appends cells, quoted where they must be.
fn push_cells<'a>(text: &mut Vec<u8>, cells: impl Iterator<Item = &'a [u8]>) {
    for (k, cell) in cells.enumerate() {
        if k > 0 {
            text.push(b',');
        }
        if cell.iter().any(|byte| matches!(byte, b',' | b'"' | b'\n' | b'\r')) {
            text.push(b'"');
            for byte in cell {
                text.extend_from_slice(if *byte == b'"' { b"\"\"" } else { std::slice::from_ref(byte) });
            }
            text.push(b'"');
        } else {
            text.extend_from_slice(cell);
        }
    }
}
