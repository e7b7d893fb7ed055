//! The rows of the input: which columns are wanted, and the text that is written again.

use super::Problem;
use crate::arguments::DerivativeOptions;
use springpot::fractional::{Definition, DerivativeError};
use springpot_run::table::quoted;
use springpot_scenario::csv::{CsvProblem, CsvRow, CsvRows, TIME};
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
    /// Columns and the cells that rows are taken with.
    taken: Vec<(usize, String)>,
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
        let taken = options.selection.iter().map(|wanted| {
            // Of paths and texts with `=` in them it is the first that splits.
            let (name, value) = wanted.split_once('=').ok_or_else(|| Problem::NoValue(wanted.clone()))?;
            Ok((rows.find(name.trim())?, value.trim().to_owned()))
        });
        let taken = taken.collect::<Result<Vec<_>, Problem>>()?;
        let mut written = vec![time];
        written.extend((0..names.len()).filter(|column| *column != time));
        let (orders, definition) = (options.orders.clone(), options.kind);
        let layout = Self { time, columns, orders, definition, written, names: names.to_vec(), taken };
        match layout.added(options.error).into_iter().find(|name| names.contains(name)) {
            Some(name) => Err(Problem::ColumnThere(name)),
            None => Ok(layout),
        }
    }

    /// Names of the derivatives, by column and order.
    pub(super) fn results(&self) -> Vec<String> {
        let of_column = |k: &usize| {
            let column = &self.names[*k];
            self.orders.iter().map(move |order| format!("D^{order} {column}"))
        };
        self.columns.iter().flat_map(of_column).collect()
    }

    /// Names of the columns that are added: behind every derivative its estimate, where there is one.
    fn added(&self, with_error: bool) -> Vec<String> {
        let with_own = |name: String| {
            let error = with_error.then(|| format!("error of {name}"));
            [Some(name), error].into_iter().flatten()
        };
        self.results().into_iter().flat_map(with_own).collect()
    }

    /// Whether a derivative may be this in a row: without bound at the start alone, where a jump from nothing counts.
    pub(super) fn may_be(&self, value: f64, is_first: bool) -> bool {
        value.is_finite() || (is_first && self.definition != Definition::Caputo)
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

    /// Whether the row is one of those asked for.
    pub(super) fn takes(&self, row: &CsvRow) -> bool {
        self.taken.iter().all(|(column, wanted)| {
            let number = |text: &str| text.parse::<f64>().ok();
            let is_equal = |cell: &str| cell == wanted || number(cell).is_some_and(|cell| number(wanted) == Some(cell));
            row.text(*column).is_ok_and(is_equal)
        })
    }

    /// The header line; `with_error` puts an estimate behind every derivative.
    pub(super) fn header(&self, with_error: bool) -> Vec<u8> {
        let mut cells: Vec<String> = self.written.iter().map(|column| self.names[*column].clone()).collect();
        cells.extend(self.added(with_error));
        let mut text = Vec::new();
        push_cells(&mut text, cells.iter().map(String::as_bytes));
        text.push(b'\n');
        text
    }

    /// The row's cells as they are written, time first.
    pub(super) fn text(&self, row: &CsvRow, text: &mut Vec<u8>) {
        push_cells(text, self.written.iter().map(|column| row.cell(*column)));
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
}

/// Appends cells, quoted where they must be.
fn push_cells<'a>(text: &mut Vec<u8>, cells: impl Iterator<Item = &'a [u8]>) {
    for (k, cell) in cells.enumerate() {
        if k > 0 {
            text.push(b',');
        }
        text.extend_from_slice(&quoted(cell));
    }
}
