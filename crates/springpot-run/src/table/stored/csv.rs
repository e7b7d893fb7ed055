//! Rows of CSV files.

use super::{Take, Wanted, damaged};
use crate::table::disk::{Disk, DiskFile};
use crate::table::quoted;
use crate::table::rows::number;
use csv::{ByteRecord, Reader};
use std::io::{self, BufReader};
use std::path::Path;

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 18;

fn reader(disk: &Disk, file: &Path) -> io::Result<Reader<BufReader<DiskFile>>> {
    Ok(Reader::from_reader(BufReader::with_capacity(CHUNK, disk.open(file)?)))
}

pub(super) fn columns(disk: &Disk, file: &Path) -> io::Result<Vec<String>> {
    let mut reader = reader(disk, file)?;
    Ok(reader.headers().map_err(io::Error::from)?.iter().map(str::to_owned).collect())
}

pub(super) fn visit(disk: &Disk, file: &Path, wanted: Wanted<'_>, take: Take<'_>) -> io::Result<()> {
    let mut reader = reader(disk, file)?;
    let mut record = ByteRecord::new();
    let (mut lead, mut numbers) = (String::new(), Vec::with_capacity(wanted.numbers.len()));
    while reader.read_byte_record(&mut record).map_err(io::Error::from)? {
        lead.clear();
        for field in record.iter().take(wanted.lead) {
            lead.push_str(&String::from_utf8_lossy(&quoted(field)));
            lead.push(',');
        }
        numbers.clear();
        for &at in wanted.numbers {
            numbers.push(number(record.get(at).ok_or_else(damaged)?)?.unwrap_or(f64::NAN));
        }
        take(&lead, &numbers)?;
    }
    Ok(())
}
