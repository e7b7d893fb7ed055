//! The rows of a CSV file as they are read.

use super::{CsvProblem, MAX_LINE};
use std::io::{self, Read};

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
    reader: ::csv::Reader<io::Chain<Lines<R>, &'static [u8]>>,
    headers: Vec<String>,
    header_line: u64,
    /// Of the row that was read last.
    line: u64,
    separator: char,
    record: ::csv::ByteRecord,
}

/// One row of a CSV file.
#[derive(Debug, Clone, Copy)]
pub struct CsvRow<'a> {
    line: u64,
    headers: &'a [String],
    record: &'a ::csv::ByteRecord,
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
        // Lines end with a line feed only (a carriage return before it is trimmed), the last one too: so the line that a record
        // ends on is known, which the crate's own record position does not tell behind blank lines and CRLF.
        let reader = ::csv::ReaderBuilder::new()
            .has_headers(false)
            .delimiter(u8::try_from(separator).unwrap_or(b','))
            .comment(Some(b'#'))
            .flexible(true)
            .trim(::csv::Trim::All)
            .terminator(::csv::Terminator::Any(b'\n'))
            .from_reader(Lines { reader, line: 1, length: 0 }.chain(&b"\n"[..]));
        let record = ::csv::ByteRecord::new();
        let mut rows = Self { reader, headers: Vec::new(), header_line: 1, line: 1, separator, record };
        rows.header_line = rows.advance()?.ok_or(CsvProblem::Empty)?;
        rows.headers = read_headers(&rows.record, rows.header_line, separator)?;
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
        let Self { headers, record, separator, .. } = self;
        if record.len() != headers.len() {
            return Err(CsvProblem::Ragged { line, given: record.len(), wanted: headers.len() });
        }
        Ok(Some(CsvRow { line, headers, record, decimal_comma: *separator == ';' }))
    }

    /// Reads the next record that is not blank; the line it ends on.
    fn advance(&mut self) -> Result<Option<u64>, CsvProblem> {
        while self.reader.read_byte_record(&mut self.record).map_err(unreadable)? {
            if !(self.record.len() == 1 && self.record[0].is_empty()) {
                self.line = self.reader.position().line() - 1;
                return Ok(Some(self.line));
            }
        }
        Ok(None)
    }
}

impl CsvRow<'_> {
    /// Its line in the file, from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    /// Its cells, without blanks around them and without quotes.
    pub fn cells(&self) -> impl Iterator<Item = &[u8]> {
        self.record.iter()
    }

    /// A cell as text.
    ///
    /// # Errors
    /// `NotUtf8`.
    pub fn text(&self, index: usize) -> Result<&str, CsvProblem> {
        let text = std::str::from_utf8(&self.record[index]);
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

fn read_headers(record: &::csv::ByteRecord, line: u64, own: char) -> Result<Vec<String>, CsvProblem> {
    let mut names: Vec<String> = Vec::with_capacity(record.len());
    for (index, cell) in record.iter().enumerate() {
        let column = index + 1;
        let name = std::str::from_utf8(cell).map_err(|_| CsvProblem::NotUtf8 { line, column })?;
        if name.is_empty() && record.len() > 1 {
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
struct Lines<R> {
    reader: R,
    /// From 1.
    line: u64,
    length: u64,
}

#[derive(Debug, thiserror::Error)]
#[error("line {line} is too long")]
struct TooLong {
    line: u64,
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        for part in buffer[..count].split_inclusive(|byte| *byte == b'\n') {
            self.length += part.len() as u64;
            if self.length > MAX_LINE {
                return Err(io::Error::other(TooLong { line: self.line }));
            }
            if part.ends_with(b"\n") {
                self.line += 1;
                self.length = 0;
            }
        }
        Ok(count)
    }
}

fn unreadable(error: ::csv::Error) -> CsvProblem {
    let source = match error.into_kind() {
        ::csv::ErrorKind::Io(source) => source,
        other => io::Error::other(format!("{other:?}")),
    };
    match source.get_ref().and_then(|inner| inner.downcast_ref::<TooLong>()) {
        Some(&TooLong { line }) => CsvProblem::LongLine { line, limit: MAX_LINE },
        None => CsvProblem::Unreadable { source },
    }
}
