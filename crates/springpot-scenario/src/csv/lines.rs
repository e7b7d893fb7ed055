//! The lines of a CSV file, split into cells where they stand.

use super::MAX_LINE;
use super::rows::trimmed;
use std::io::{self, Read};
use std::ops::Range;

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 16;

/// The mark that some programs put before UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A line is longer than [`MAX_LINE`].
#[derive(Debug, thiserror::Error)]
#[error("line {line} is too long")]
pub(super) struct LongLine {
    pub(super) line: u64,
}

/// A file and the part of it that is held, which begins anywhere before the next line.
pub(super) struct Lines<R> {
    reader: R,
    buffer: Vec<u8>,
    /// The part of the buffer that holds what comes next.
    held: Range<usize>,
    /// Lines before it.
    before: u64,
    ended: bool,
}

/// What the next line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Split {
    /// Cells, on this line.
    Row(u64),
    /// One with quotes, which is not taken.
    Quotes,
    /// None.
    End,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, buffer: vec![0; CHUNK], held: 0..0, before: 0, ended: false }
    }

    /// What the cells of [`Self::split`] stand in.
    pub(super) fn text(&self) -> &[u8] {
        &self.buffer
    }

    /// Splits the next line that is no comment; `cells` are without the blanks around them, and stand until the next call.
    ///
    /// # Errors
    /// The reader's; [`LongLine`].
    pub(super) fn split(&mut self, separator: u8, cells: &mut Vec<Range<usize>>) -> io::Result<Split> {
        loop {
            while self.held.is_empty() {
                if !self.fill()? {
                    return Ok(Split::End);
                }
            }
            let (start, is_comment) = (self.held.start, self.buffer[self.held.start] == b'#');
            let (mut from, mut end) = (start, None);
            cells.clear();
            for (k, &byte) in self.buffer[self.held.clone()].iter().enumerate() {
                if byte == separator {
                    cells.push(from..start + k);
                    from = start + k + 1;
                } else if byte == b'\n' {
                    end = Some(start + k);
                    break;
                } else if byte == b'"' && !is_comment {
                    return Ok(Split::Quotes);
                }
            }
            let end = match end {
                Some(end) => end,
                // What is held moves.
                None if !self.ended => {
                    self.fill()?;
                    continue;
                }
                None => self.held.end,
            };
            if (end - start) as u64 >= MAX_LINE {
                return Err(self.long_line());
            }
            cells.push(from..end);
            self.held.start = self.held.end.min(end + 1);
            self.before += 1;
            if !is_comment {
                for cell in cells {
                    *cell = trimmed(&self.buffer, cell.clone());
                }
                return Ok(Split::Row(self.before));
            }
        }
    }

    /// Reads more behind what is held; `false` at the end of the file.
    fn fill(&mut self) -> io::Result<bool> {
        if self.held.len() as u64 > MAX_LINE {
            return Err(self.long_line());
        }
        if self.ended {
            return Ok(false);
        }
        self.buffer.copy_within(self.held.clone(), 0);
        self.held = 0..self.held.len();
        if self.held.end == self.buffer.len() {
            self.buffer.resize(2 * self.buffer.len(), 0);
        }
        let is_first = self.before == 0 && self.held.is_empty();
        loop {
            match self.reader.read(&mut self.buffer[self.held.end..]) {
                Ok(count) => {
                    self.held.end += count;
                    self.ended = count == 0;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            }
            // The mark comes whole, or is none.
            let mark = &BYTE_ORDER_MARK[..BYTE_ORDER_MARK.len().min(self.held.len())];
            if !is_first || self.ended || mark.len() == BYTE_ORDER_MARK.len() || !self.buffer.starts_with(mark) {
                break;
            }
        }
        if is_first && self.buffer[self.held.clone()].starts_with(BYTE_ORDER_MARK) {
            self.held.start = BYTE_ORDER_MARK.len();
        }
        Ok(!self.ended)
    }

    fn long_line(&self) -> io::Error {
        io::Error::other(LongLine { line: self.before + 1 })
    }

    /// What is held, what follows it, and the number of lines before it.
    pub(super) fn into_rest(mut self) -> (Vec<u8>, R, u64) {
        self.buffer.truncate(self.held.end);
        self.buffer.drain(..self.held.start);
        (self.buffer, self.reader, self.before)
    }
}
