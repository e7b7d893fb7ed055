//! Derivatives of rows as they come.

use super::sheet::{Layout, Sheet};
use super::{FEWEST, Problem};
use springpot::fractional::{DerivativeError, Stream};
use springpot_run::table::push_fields;
use springpot_scenario::csv::CsvRows;
use std::collections::VecDeque;
use std::io::{Read, Write};

/// Bytes of rows that are written before their room is used again.
const WAITING: usize = 1 << 16;

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
        let at = (held.line(row), held.times[row]);
        let pushed = writer.push(at, values, |text| text.extend_from_slice(held.row_text(row)));
        pushed.map_err(|problem| at_line(held.line(row), problem))?;
    }
    drop(held);
    let mut values = Vec::with_capacity(layout.count());
    while let Some(row) = rows.next_row()? {
        if !layout.takes(&row) {
            continue;
        }
        let time = layout.time(&row, writer.last)?;
        values.clear();
        for value in layout.values(&row) {
            values.push(value?);
        }
        let pushed = writer.push((row.line(), time), values.iter().copied(), |text| layout.text(&row, text));
        pushed.map_err(|problem| at_line(row.line(), problem))?;
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
    layout: &'a Layout,
    output: &'a mut dyn Write,
    /// Until the first row is known: a mistake before leaves no output.
    header: Option<Vec<u8>>,
    /// One for each column and order.
    streams: Vec<Stream>,
    orders: usize,
    /// Values that are known, in the order of the streams; all streams are as far.
    known: Vec<Vec<f64>>,
    waiting: Waiting,
    /// The derivatives of a row as they are written.
    cells: String,
    first: f64,
    last: Option<f64>,
    taken: usize,
}

impl<'a> Writer<'a> {
    fn new(layout: &'a Layout, output: &'a mut dyn Write) -> Result<Self, Problem> {
        let orders = layout.orders.iter().cycle().take(layout.orders.len() * layout.count());
        let streams = orders.map(|order| Stream::new(*order, layout.definition));
        let streams: Vec<Stream> = streams.collect::<Result<_, _>>()?;
        let known = vec![Vec::new(); streams.len()];
        Ok(Self {
            layout,
            output,
            header: Some(layout.header(false)),
            streams,
            orders: layout.orders.len(),
            known,
            waiting: Waiting::default(),
            cells: String::new(),
            first: 0.0,
            last: None,
            taken: 0,
        })
    }

    /// Takes a row on a line, whose own cells are put by `text`.
    fn push(
        &mut self,
        (line, time): (u64, f64),
        values: impl Iterator<Item = f64>,
        text: impl FnOnce(&mut Vec<u8>),
    ) -> Result<(), Problem> {
        if self.last.is_none() {
            self.first = time;
        }
        self.last = Some(time);
        self.taken += 1;
        self.waiting.push(line, text);
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
        for row in 0..self.known[0].len() {
            let (text, line) = self.waiting.pop();
            let (layout, is_first) = (self.layout, self.header.is_some());
            if let Some(k) = self.known.iter().position(|values| !layout.may_be(values[row], is_first)) {
                return Err(Problem::NotFinite { line, name: layout.results().swap_remove(k) });
            }
            if let Some(header) = self.header.take() {
                self.output.write_all(&header)?;
            }
            self.cells.clear();
            push_fields(&mut self.cells, self.known.iter().map(|values| values[row]));
            self.cells.push('\n');
            self.output.write_all(text)?;
            self.output.write_all(self.cells.as_bytes())?;
        }
        Ok(())
    }
}

/// The texts of rows that wait, first come first gone, in one buffer.
#[derive(Default)]
struct Waiting {
    text: Vec<u8>,
    /// Where they end, and on which lines they stand.
    ends: VecDeque<(usize, u64)>,
    /// Where the first of them begins.
    start: usize,
}

impl Waiting {
    fn push(&mut self, line: u64, put: impl FnOnce(&mut Vec<u8>)) {
        if self.start > WAITING {
            self.text.drain(..self.start);
            self.ends.iter_mut().for_each(|(end, _)| *end -= self.start);
            self.start = 0;
        }
        put(&mut self.text);
        self.ends.push_back((self.text.len(), line));
    }

    /// Panics where none waits.
    fn pop(&mut self) -> (&[u8], u64) {
        let (start, (end, line)) = (self.start, self.ends.pop_front().expect("a row for every value"));
        self.start = end;
        (&self.text[start..end], line)
    }
}
