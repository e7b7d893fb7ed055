//! The rows of a run's CSV file, gone through.

use super::disk::Disk;
use csv::ByteRecord;
use springpot::table::Column;
use std::io::{self, BufReader};
use std::path::Path;

/// Bytes of the file that are read at a time.
const CHUNK: usize = 1 << 18;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Numbers, or nothing.
    Number,
    /// Texts; the longest has so many characters.
    Text(usize),
}

/// The rows of a CSV file that a run wrote.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    disk: &'a Disk,
    file: &'a Path,
    pub(super) columns: &'a [Column],
    pub(super) kinds: Vec<Kind>,
    pub(super) count: u64,
}

impl<'a> Rows<'a> {
    /// Looks at every row once; the first `swept` columns may hold texts.
    pub(super) fn survey(disk: &'a Disk, file: &'a Path, columns: &'a [Column], swept: usize) -> io::Result<Self> {
        let mut rows = Self { disk, file, columns, kinds: vec![Kind::Number; columns.len()], count: 0 };
        let mut longest = vec![0; swept];
        let mut is_text = vec![false; swept];
        let mut count = 0;
        rows.visit(&mut |record| {
            for (k, field) in record.iter().take(swept).enumerate() {
                let text = std::str::from_utf8(field).map_err(|_| damaged())?;
                longest[k] = longest[k].max(text.chars().count());
                is_text[k] |= number(field).is_err();
            }
            count += 1;
            Ok(())
        })?;
        for (k, longest) in longest.into_iter().enumerate().filter(|(k, _)| is_text[*k]) {
            rows.kinds[k] = Kind::Text(longest);
        }
        rows.count = count;
        Ok(rows)
    }

    /// Calls `visit` with every row.
    pub(super) fn visit(&self, visit: &mut dyn FnMut(&ByteRecord) -> io::Result<()>) -> io::Result<()> {
        let file = BufReader::with_capacity(CHUNK, self.disk.open(self.file)?);
        let mut reader = csv::Reader::from_reader(file);
        if reader.byte_headers().map_err(io::Error::from)?.len() != self.columns.len() {
            return Err(damaged());
        }
        let mut record = ByteRecord::new();
        while reader.read_byte_record(&mut record).map_err(io::Error::from)? {
            visit(&record)?;
        }
        Ok(())
    }
}

/// The number in a field; `None` where it is empty.
pub(super) fn number(field: &[u8]) -> io::Result<Option<f64>> {
    if field.is_empty() {
        return Ok(None);
    }
    let read = std::str::from_utf8(field).ok().and_then(|text| text.parse::<f64>().ok());
    read.filter(|number| number.is_finite()).map(Some).ok_or_else(damaged)
}

fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the rows are not those of a run")
}
