//! Rows of the Parquet files that runs write: optional columns, plain values, one page for each column of a group, no compression.

use super::thrift::{self, Fields, taken, varint};
use super::{Take, Values, Wanted, damaged};
use crate::table::disk::{Disk, DiskFile};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

const MAGIC: &[u8; 4] = b"PAR1";
const DOUBLE: i64 = 5;
const BYTE_ARRAY: i64 = 6;

/// A file and what its end says.
pub(super) struct Table {
    file: DiskFile,
    length: u64,
    footer: Fields,
    names: Vec<String>,
}

impl Table {
    pub(super) fn open(disk: &Disk, path: &Path) -> io::Result<Self> {
        let mut file = disk.open(path)?;
        let length = file.seek(SeekFrom::End(0))?;
        if length < 12 {
            return Err(damaged());
        }
        let end = stretch(&mut file, length, length - 8, 8)?;
        let (size, magic) = end.split_at(4);
        let size = u64::from(u32::from_le_bytes([size[0], size[1], size[2], size[3]]));
        if magic != MAGIC || size > length - 12 {
            return Err(damaged());
        }
        let bytes = stretch(&mut file, length, length - 8 - size, size)?;
        let footer = thrift::read(&mut &*bytes)?;
        if !footer.text(6)?.starts_with("springpot ") {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "no run wrote this file"));
        }
        // The first is the root of the others.
        let names = footer.list(2)?.into_iter().skip(1).map(|element| element.text(4));
        let names = names.collect::<io::Result<_>>()?;
        Ok(Self { file, length, footer, names })
    }

    pub(super) fn names(self) -> Vec<String> {
        self.names
    }

    pub(super) fn visit(mut self, wanted: Wanted<'_>, take: Take<'_>) -> io::Result<()> {
        for group in self.footer.list(4)? {
            let (chunks, rows) = (group.list(1)?, group.count(3)?);
            let read = wanted.indices().map(|at| {
                let data = chunks.get(at).ok_or_else(damaged)?.fields(3)?;
                let (from, size) = (data.count(9)? as u64, data.count(7)? as u64);
                let page = stretch(&mut self.file, self.length, from, size)?;
                values(&page, data.integer(1)?, rows)
            });
            let columns = read.collect::<io::Result<Vec<_>>>()?;
            wanted.hand_over(&columns, rows, take)?;
        }
        Ok(())
    }
}

/// Bytes of a file of this length.
fn stretch(file: &mut DiskFile, length: u64, from: u64, size: u64) -> io::Result<Vec<u8>> {
    if from.checked_add(size).is_none_or(|end| end > length) {
        return Err(damaged());
    }
    file.seek(SeekFrom::Start(from))?;
    let mut bytes = vec![0; size as usize];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// The values of a page.
fn values(page: &[u8], physical: i64, rows: usize) -> io::Result<Values> {
    let mut rest = page;
    let head = thrift::read(&mut rest)?;
    if head.fields(5)?.count(1)? != rows {
        return Err(damaged());
    }
    let levels = u32_of(&mut rest)?;
    let mut levels = taken(&mut rest, levels)?;
    let mut numbers = Vec::new();
    let mut texts = Vec::new();
    let mut done = 0;
    // Runs of rows that have a value, or none.
    while done < rows {
        let run = varint(&mut levels)?;
        let count = usize::try_from(run >> 1).map_err(|_| damaged())?;
        let has_value = thrift::byte(&mut levels)?;
        if run & 1 == 1 || count == 0 || count > rows - done || has_value > 1 {
            return Err(damaged());
        }
        done += count;
        match (physical, has_value) {
            (DOUBLE, 0) => numbers.resize(numbers.len() + count, f64::NAN),
            (DOUBLE, _) => {
                let size = count.checked_mul(8).ok_or_else(damaged)?;
                let bytes = taken(&mut rest, size)?.as_chunks::<8>().0;
                numbers.extend(bytes.iter().map(|bytes| f64::from_le_bytes(*bytes)));
            }
            (BYTE_ARRAY, 0) => texts.resize(texts.len() + count, String::new()),
            (BYTE_ARRAY, _) => {
                for _ in 0..count {
                    let length = u32_of(&mut rest)?;
                    texts.push(String::from_utf8_lossy(taken(&mut rest, length)?).into_owned());
                }
            }
            _ => return Err(damaged()),
        }
    }
    Ok(if physical == DOUBLE { Values::Numbers(numbers) } else { Values::Texts(texts) })
}

fn u32_of(bytes: &mut &[u8]) -> io::Result<usize> {
    let bytes = taken(bytes, 4)?;
    Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize)
}
