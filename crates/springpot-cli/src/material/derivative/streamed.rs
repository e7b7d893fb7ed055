//! Derivatives of rows as they come.

use super::sheet::{Layout, Sheet};
use super::{FEWEST, Problem};
use springpot::fractional::{DerivativeError, Stream};
use springpot_run::table::push_fields;
use springpot_scenario::csv::CsvRows;
use std::collections::VecDeque;
use std::io::{Read, Write};

/// Goes on from the rows that are `held`, and then as they are read.
pub(super) fn differentiate(
    layout: &Layout,
    held: Sheet,
    rows: &mut CsvRows<impl Read>,
    output: &mut dyn Write,
) -> Result<(), Problem> {
    let mut writer = Writer::new(layout, output)?;
    for row in 0..held.times.len() {
        let values = held.values.iter().map(|column| column[row]);
        let pushed = writer.push(held.times[row], values, held.row_text(row).to_vec());
        pushed.map_err(|problem| at_line(held.line(row), problem))?;
    }
    drop(held);
    while let Some(row) = rows.next_row()? {
        if !layout.takes(&row) {
            continue;
        }
        let time = layout.time(&row, writer.last)?;
        let values = layout.values(&row).collect::<Result<Vec<_>, _>>()?;
        let mut text = Vec::new();
        layout.text(&row, &mut text);
        let line = row.line();
        writer.push(time, values.into_iter(), text).map_err(|problem| at_line(line, problem))?;
    }
    writer.finish(rows.line())
}

/// What a stream refuses, with the line of the row that it takes.
fn at_line(line: u64, problem: Problem) -> Problem {
    match problem {
        Problem::Derivative(problem) => Problem::Row { line, problem },
        other => other,
    }
}

/// Rows wait here until their derivatives are known.
struct Writer<'a> {
    output: &'a mut dyn Write,
    /// Until the first row is known: a mistake before leaves no output.
    header: Option<Vec<u8>>,
    /// One for each column and order.
    streams: Vec<Stream>,
    orders: usize,
    /// Values that are known, in the order of the streams; all streams are as far.
    known: Vec<Vec<f64>>,
    waiting: VecDeque<Vec<u8>>,
    first: f64,
    last: Option<f64>,
    taken: usize,
}

impl<'a> Writer<'a> {
    fn new(layout: &Layout, output: &'a mut dyn Write) -> Result<Self, Problem> {
        let orders = layout.orders.iter().cycle().take(layout.orders.len() * layout.count());
        let streams = orders.map(|order| Stream::new(*order, layout.definition));
        let streams: Vec<Stream> = streams.collect::<Result<_, _>>()?;
        let known = vec![Vec::new(); streams.len()];
        Ok(Self {
            output,
            header: Some(layout.header(false)),
            streams,
            orders: layout.orders.len(),
            known,
            waiting: VecDeque::new(),
            first: 0.0,
            last: None,
            taken: 0,
        })
    }

    fn push(&mut self, time: f64, values: impl Iterator<Item = f64>, text: Vec<u8>) -> Result<(), Problem> {
        if self.last.is_none() {
            self.first = time;
        }
        self.last = Some(time);
        self.taken += 1;
        self.waiting.push_back(text);
        let streams = self.streams.chunks_mut(self.orders).zip(self.known.chunks_mut(self.orders));
        for (value, (streams, known)) in values.zip(streams) {
            for (stream, known) in streams.iter_mut().zip(known) {
                known.clear();
                known.extend(stream.push(time - self.first, value)?.iter().map(|row| row.value));
            }
        }
        self.write()
    }

    fn finish(mut self, line: u64) -> Result<(), Problem> {
        if self.taken < FEWEST {
            return Err(Problem::TooFewRows { line, given: self.taken });
        }
        let rests = std::mem::take(&mut self.streams).into_iter().map(Stream::finish);
        let rests = rests.collect::<Result<Vec<_>, DerivativeError>>()?;
        self.known = rests.iter().map(|rows| rows.iter().map(|row| row.value).collect()).collect();
        self.write()
    }

    /// Writes the rows whose derivatives are known.
    fn write(&mut self) -> Result<(), Problem> {
        let mut cells = String::new();
        for row in 0..self.known[0].len() {
            if let Some(header) = self.header.take() {
                self.output.write_all(&header)?;
            }
            let text = self.waiting.pop_front().expect("a row for every value");
            cells.clear();
            push_fields(&mut cells, self.known.iter().map(|values| values[row]));
            cells.push('\n');
            self.output.write_all(&text)?;
            self.output.write_all(cells.as_bytes())?;
        }
        Ok(())
    }
}
