//! Rows of the zipped arrays that runs write: entries that are not compressed, with zip64 sizes, one behind the other.

use super::{Take, Values, Wanted, damaged};
use crate::table::disk::{Disk, DiskFile};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

const ENTRY: u32 = 0x0403_4b50;
/// Rows that are read at a time.
const ROWS: u64 = 1 << 16;

/// A file and the arrays in it.
pub(super) struct Table {
    file: DiskFile,
    arrays: Vec<Array>,
    rows: u64,
}

#[derive(Debug, Clone)]
struct Array {
    name: String,
    /// Where its first value stands.
    from: u64,
    /// Characters of its texts; `None`: numbers.
    text: Option<u64>,
}

impl Table {
    pub(super) fn open(disk: &Disk, path: &Path) -> io::Result<Self> {
        let mut file = disk.open(path)?;
        let length = file.seek(SeekFrom::End(0))?;
        let (mut arrays, mut rows) = (Vec::new(), None);
        let mut at = 0;
        while let Some((array, count, end)) = entry(&mut file, at, length)? {
            if *rows.get_or_insert(count) != count {
                return Err(damaged());
            }
            arrays.push(array);
            at = end;
        }
        Ok(Self { file, arrays, rows: rows.ok_or_else(damaged)? })
    }

    pub(super) fn names(self) -> Vec<String> {
        self.arrays.into_iter().map(|array| array.name).collect()
    }

    pub(super) fn visit(mut self, wanted: Wanted<'_>, take: Take<'_>) -> io::Result<()> {
        let mut first = 0;
        while first < self.rows {
            let count = ROWS.min(self.rows - first);
            let read = wanted.indices().map(|at| {
                let array = self.arrays.get(at).ok_or_else(damaged)?.clone();
                array.values(&mut self.file, first, count)
            });
            let columns = read.collect::<io::Result<Vec<_>>>()?;
            wanted.hand_over(&columns, count as usize, take)?;
            first += count;
        }
        Ok(())
    }
}

/// The array whose entry begins at a byte, its number of values, and where the entry ends; `None` behind the last one.
fn entry(file: &mut DiskFile, at: u64, length: u64) -> io::Result<Option<(Array, u64, u64)>> {
    let head = bytes(file, at, 30)?;
    let short = |k: usize| u16::from_le_bytes([head[k], head[k + 1]]);
    if u32::from_le_bytes([head[0], head[1], head[2], head[3]]) != ENTRY {
        return Ok(None);
    }
    let (name_length, extra) = (u64::from(short(26)), u64::from(short(28)));
    // Stored as it is, with both sizes in the zip64 part.
    if short(8) != 0 || extra != 20 {
        return Err(damaged());
    }
    let name = String::from_utf8(bytes(file, at + 30, name_length)?).map_err(|_| damaged())?;
    let name = name.strip_suffix(".npy").ok_or_else(damaged)?.to_owned();
    let from = at + 30 + name_length + extra;
    let size = bytes(file, at + 30 + name_length + 4, 8)?;
    let size = u64::from_le_bytes(size.try_into().map_err(|_| damaged())?);
    let end = from.checked_add(size).filter(|end| *end <= length).ok_or_else(damaged)?;
    let start = bytes(file, from, 10)?;
    if &start[..8] != b"\x93NUMPY\x01\x00" {
        return Err(damaged());
    }
    let of_head = u64::from(u16::from_le_bytes([start[8], start[9]]));
    let words = String::from_utf8(bytes(file, from + 10, of_head)?).map_err(|_| damaged())?;
    let descr = words.split('\'').nth(3).unwrap_or_default();
    let (text, width) = match descr.strip_prefix("<U") {
        Some(digits) => {
            let longest = digits.parse::<u32>().map_err(|_| damaged())?;
            (Some(u64::from(longest)), 4 * u64::from(longest))
        }
        None if descr == "<f8" => (None, 8),
        None => return Err(damaged()),
    };
    let values = from + 10 + of_head;
    let size = end.checked_sub(values).filter(|size| width > 0 && size.is_multiple_of(width)).ok_or_else(damaged)?;
    Ok(Some((Array { name, from: values, text }, size / width, end)))
}

impl Array {
    /// Some of its values.
    fn values(&self, file: &mut DiskFile, first: u64, count: u64) -> io::Result<Values> {
        let width = self.text.map_or(8, |longest| 4 * longest);
        let bytes = bytes(file, self.from + first * width, count * width)?;
        Ok(match self.text {
            None => Values::Numbers(bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()),
            Some(_) => Values::Texts(bytes.chunks_exact(width as usize).map(text).collect()),
        })
    }
}

/// A text in units of four bytes, zeros behind it.
fn text(bytes: &[u8]) -> String {
    let units = bytes.as_chunks::<4>().0.iter().map(|unit| u32::from_le_bytes(*unit));
    units.take_while(|unit| *unit != 0).map(|unit| char::from_u32(unit).unwrap_or('\u{fffd}')).collect()
}

fn bytes(file: &mut DiskFile, from: u64, size: u64) -> io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(from))?;
    let mut bytes = Vec::new();
    // The length that a damaged file claims is not reserved.
    file.take(size).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == size { Ok(bytes) } else { Err(damaged()) }
}
