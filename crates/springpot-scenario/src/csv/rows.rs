//! The rows of a CSV file as they are read.

use super::lines::{Lines, LongLine, Split};
use super::{CsvProblem, MAX_LINE};
use std::io::{self, Cursor, Read};
use std::ops::Range;

/// The header and then the rows of a CSV file, one at a time: nothing but the row at hand is kept.
///
/// The first row names the columns, and every other has as many cells. A byte order mark, CRLF, blank lines, comments (`#`), blanks around
/// cells and quoted cells are fine.
///
/// ```
/// use springpot_scenario::csv::CsvRows;
///
/// let mut rows = CsvRows::new("t,x\n0,1\n\n0.5,2\n".as_bytes())?;
/// let x = rows.find("x")?;
/// let mut lines = Vec::new();
/// while let Some(row) = rows.next_row()? {
///     lines.push((row.line(), row.number(x)?));
/// }
/// assert_eq!(lines, [(2, 1.0), (4, 2.0)]);
/// # Ok::<(), springpot_scenario::csv::CsvProblem>(())
/// ```
pub struct CsvRows<R> {
    source: Source<R>,
    /// Where the cells of the row that was read last stand in its text, without blanks around them.
    cells: Vec<Range<usize>>,
    headers: Vec<String>,
    header_line: u64,
    /// Of the row that was read last.
    line: u64,
    separator: char,
}

/// Lines are split where they stand; from the first one with quotes on, rows may be more than lines.
enum Source<R> {
    Lines(Lines<R>),
    Quoted(Box<Quoted<R>>),
    Ended,
}

/// What is held of a file, what follows it, and the end of its last line.
type Rest<R> = io::Chain<Checked<io::Chain<Cursor<Vec<u8>>, R>>, &'static [u8]>;

/// The rest of a file with its quotes.
struct Quoted<R> {
    reader: ::csv::Reader<Rest<R>>,
    record: ::csv::ByteRecord,
    /// Lines before it.
    before: u64,
}

/// One row of a CSV file.
#[derive(Debug, Clone, Copy)]
pub struct CsvRow<'a> {
    line: u64,
    headers: &'a [String],
    text: &'a [u8],
    cells: &'a [Range<usize>],
    decimal_comma: bool,
}

impl<R: Read> CsvRows<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// `Unreadable`, `Empty`, `LongLine`, and what can be wrong with a header: `NotUtf8`, `NoName`, `DuplicateName`, `NoHeader`,
    /// `OtherSeparator`.
    pub fn new(reader: R) -> Result<Self, CsvProblem> {
        Self::separated(reader, ',')
    }

    /// Reads the header of a file whose cells are separated by another character of one byte. Where that is `;` a comma is the decimal point.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn separated(reader: R, separator: char) -> Result<Self, CsvProblem> {
        let source = Source::Lines(Lines::new(reader));
        let mut rows = Self { source, cells: Vec::new(), headers: Vec::new(), header_line: 1, line: 1, separator };
        rows.header_line = rows.advance()?.ok_or(CsvProblem::Empty)?;
        rows.headers = read_headers(&rows.row(rows.header_line), separator)?;
        Ok(rows)
    }

    /// Names of the columns, in the file's order.
    pub fn headers(&self) -> &[String] {
        &self.headers
    }

    /// Line of the row that was read last, from 1; at first that of the header.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Line of the header, from 1.
    pub fn header_line(&self) -> u64 {
        self.header_line
    }

    /// Where the column called `name` stands, from 0.
    ///
    /// # Errors
    /// `MissingColumn`, with the name that was probably meant.
    pub fn find(&self, name: &str) -> Result<usize, CsvProblem> {
        let found = self.headers.iter().position(|header| header == name);
        found.ok_or_else(|| super::missing(name, &self.headers, self.header_line))
    }

    /// The next row that is not blank; `None` at the end.
    ///
    /// # Errors
    /// `Unreadable`, `LongLine`, `Ragged`.
    pub fn next_row(&mut self) -> Result<Option<CsvRow<'_>>, CsvProblem> {
        let Some(line) = self.advance()? else { return Ok(None) };
        if self.cells.len() != self.headers.len() {
            return Err(CsvProblem::Ragged { line, given: self.cells.len(), wanted: self.headers.len() });
        }
        Ok(Some(self.row(line)))
    }

    /// The row that was read last, which ends on `line`.
    fn row(&self, line: u64) -> CsvRow<'_> {
        let text = match &self.source {
            Source::Lines(lines) => lines.text(),
            Source::Quoted(quoted) => quoted.record.as_slice(),
            Source::Ended => &[],
        };
        let decimal_comma = self.separator == ';';
        CsvRow { line, headers: &self.headers, text, cells: &self.cells, decimal_comma }
    }

    /// Reads the next row that is not blank; the line it ends on.
    fn advance(&mut self) -> Result<Option<u64>, CsvProblem> {
        let separator = u8::try_from(self.separator).unwrap_or(b',');
        loop {
            let line = match &mut self.source {
                Source::Lines(lines) => match lines.split(separator, &mut self.cells).map_err(unreadable)? {
                    Split::Row(line) => line,
                    Split::Quotes => {
                        self.source = match std::mem::replace(&mut self.source, Source::Ended) {
                            Source::Lines(lines) => Source::Quoted(Quoted::from(lines, separator).into()),
                            source => source,
                        };
                        continue;
                    }
                    Split::End => return Ok(None),
                },
                Source::Quoted(quoted) => {
                    match quoted.split(&mut self.cells).map_err(|error| unreadable(io_error(error)))? {
                        Some(line) => line,
                        None => return Ok(None),
                    }
                }
                Source::Ended => return Ok(None),
            };
            if !(self.cells.len() == 1 && self.cells[0].is_empty()) {
                self.line = line;
                return Ok(Some(line));
            }
        }
    }
}

impl<R: Read> Quoted<R> {
    /// Goes on where `lines` found the first quote of the file, from the beginning of that line.
    fn from(lines: Lines<R>, separator: u8) -> Self {
        let (mut held, reader, before) = lines.into_rest();
        // Behind a blank line no byte order mark is taken away.
        held.insert(0, b'\n');
        let reader = Checked { reader: Cursor::new(held).chain(reader), line: before, length: 0 };
        // Lines end with a line feed only (a carriage return before it is trimmed), the last one too: so the line that a record
        // ends on is known, which the crate's own record position does not tell behind blank lines and CRLF.
        let reader = ::csv::ReaderBuilder::new()
            .has_headers(false)
            .delimiter(separator)
            .comment(Some(b'#'))
            .flexible(true)
            .terminator(::csv::Terminator::Any(b'\n'))
            .from_reader(reader.chain(&b"\n"[..]));
        Self { reader, record: ::csv::ByteRecord::new(), before }
    }

    /// Reads the next record; the line it ends on.
    fn split(&mut self, cells: &mut Vec<Range<usize>>) -> Result<Option<u64>, ::csv::Error> {
        if !self.reader.read_byte_record(&mut self.record)? {
            return Ok(None);
        }
        let text = self.record.as_slice();
        cells.clear();
        cells.extend((0..self.record.len()).filter_map(|k| Some(trimmed(text, self.record.range(k)?))));
        Ok(Some(self.before + self.reader.position().line() - 2))
    }
}

/// A cell without the blanks around it.
pub(super) fn trimmed(text: &[u8], Range { mut start, mut end }: Range<usize>) -> Range<usize> {
    while start < end && text[start].is_ascii_whitespace() {
        start += 1;
    }
    while start < end && text[end - 1].is_ascii_whitespace() {
        end -= 1;
    }
    start..end
}

impl CsvRow<'_> {
    /// Its line in the file, from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Its cells, without blanks around them and without quotes.
    pub fn cells(&self) -> impl Iterator<Item = &[u8]> {
        self.cells.iter().map(|cell| &self.text[cell.clone()])
    }

    /// One of them. Panics beyond the last one.
    pub fn cell(&self, index: usize) -> &[u8] {
        &self.text[self.cells[index].clone()]
    }

    /// A cell as text.
    ///
    /// # Errors
    /// `NotUtf8`.
    pub fn text(&self, index: usize) -> Result<&str, CsvProblem> {
        let text = std::str::from_utf8(self.cell(index));
        text.map_err(|_| CsvProblem::NotUtf8 { line: self.line, column: index + 1 })
    }

    /// The number that a cell's text is.
    pub(super) fn parse(&self, text: &str) -> Option<f64> {
        match self.decimal_comma && text.contains(',') {
            true => text.replacen(',', ".", 1).parse().ok(),
            false => text.parse().ok(),
        }
    }

    /// A cell as a finite number.
    ///
    /// # Errors
    /// `NotUtf8`, `NotANumber`, `NotFinite`.
    pub fn number(&self, index: usize) -> Result<f64, CsvProblem> {
        let text = self.text(index)?;
        match self.parse(text) {
            Some(number) if f64::is_finite(number) => Ok(number),
            _ => Err(super::not_a_number(text, self.line, index, &self.headers[index])),
        }
    }
}

fn read_headers(row: &CsvRow<'_>, own: char) -> Result<Vec<String>, CsvProblem> {
    let (line, count) = (row.line(), row.cells().count());
    let mut names: Vec<String> = Vec::with_capacity(count);
    for (index, cell) in row.cells().enumerate() {
        let column = index + 1;
        let name = std::str::from_utf8(cell).map_err(|_| CsvProblem::NotUtf8 { line, column })?;
        if name.is_empty() && count > 1 {
            return Err(CsvProblem::NoName { line, column });
        }
        if let Some(first) = names.iter().position(|other| other == name) {
            let name = super::shorten(name);
            return Err(CsvProblem::DuplicateName { line, name, first: first + 1, second: column });
        }
        names.push(name.to_owned());
    }
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(CsvProblem::NoHeader { line, first: super::shorten(&names[0]) });
    }
    if let [only] = &names[..]
        && let Some((before, separator)) =
            only.chars().enumerate().find(|(_, c)| *c != own && matches!(c, ',' | ';' | '\t' | '|'))
    {
        return Err(CsvProblem::OtherSeparator { line, separator, own, at: before + 1 });
    }
    Ok(names)
}

/// A file none of whose lines is longer than [`MAX_LINE`].
struct Checked<R> {
    reader: R,
    /// From 1.
    line: u64,
    length: u64,
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        for part in buffer[..count].split_inclusive(|byte| *byte == b'\n') {
            self.length += part.len() as u64;
            if self.length > MAX_LINE {
                return Err(io::Error::other(LongLine { line: self.line }));
            }
            if part.ends_with(b"\n") {
                self.line += 1;
                self.length = 0;
            }
        }
        Ok(count)
    }
}

fn io_error(error: ::csv::Error) -> io::Error {
    match error.into_kind() {
        ::csv::ErrorKind::Io(source) => source,
        other => io::Error::other(format!("{other:?}")),
    }
}

fn unreadable(source: io::Error) -> CsvProblem {
    match source.get_ref().and_then(|inner| inner.downcast_ref::<LongLine>()) {
        Some(&LongLine { line }) => CsvProblem::LongLine { line, limit: MAX_LINE },
        None => CsvProblem::Unreadable { source },
    }
}
