//! NumPy's zipped arrays: a zip archive, not compressed, of one `COLUMN.npy` for each column.
//!
//! Formats: numpy.lib.format, version 1.0, of the NumPy manual; APPNOTE.TXT 6.3.10 of PKWARE, sections 4.3 and 4.5.3
//! (zip64).

use super::rows::{Kind, Rows, number};
use std::io::{self, Seek, SeekFrom, Write};

/// Bytes that are gathered before they are written to the arrays.
const GATHERED: usize = 1 << 23;
/// Version of zip64.
const VERSION: u16 = 45;
/// The name is UTF-8.
const FLAGS: u16 = 1 << 11;
/// 1980-01-01, the first day that the format knows: the same rows make the same file.
const DATE: u16 = 0x21;
/// Stands where a number is in the zip64 part.
const ELSEWHERE: u32 = u32::MAX;

/// One array under way.
struct Array {
    name: Vec<u8>,
    /// Where its entry begins in the file.
    at: u64,
    /// Where its next value goes.
    next: u64,
    /// Bytes of the entry: the array's own head and its values.
    size: u64,
    sum: crc32fast::Hasher,
    gathered: Vec<u8>,
    kind: Kind,
}

/// Writes the rows; an empty field is NaN, or an empty text.
pub(super) fn write<W: Write + Seek>(rows: &Rows<'_>, out: &mut W) -> io::Result<()> {
    let mut arrays = Vec::with_capacity(rows.columns.len());
    let mut at = 0;
    for (column, &kind) in rows.columns.iter().zip(&rows.kinds) {
        let array = Array::begin(&format!("{}.npy", column.name), kind, rows.count, at, out)?;
        at = array.at + array.head_of_entry() + array.size;
        arrays.push(array);
    }
    let most = GATHERED / arrays.len().max(1);
    rows.visit(&mut |record| {
        for (array, field) in arrays.iter_mut().zip(record) {
            array.take(field)?;
            if array.gathered.len() >= most {
                array.write(out)?;
            }
        }
        Ok(())
    })?;
    for array in &mut arrays {
        array.write(out)?;
        array.write_sum(out)?;
    }
    out.seek(SeekFrom::Start(at))?;
    finish(&arrays, at, out)
}

/// Whole arrays of one archive.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Whole {
    /// Numbers in rows, and how many rows and columns they are.
    Matrix(Vec<f64>, [usize; 2]),
    /// Numbers.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

/// Writes whole arrays by their names.
///
/// # Errors
/// The file's.
pub(crate) fn write_whole<W: Write + Seek>(arrays: &[(&str, Whole)], out: &mut W) -> io::Result<()> {
    let (mut written, mut at) = (Vec::with_capacity(arrays.len()), 0);
    for (name, whole) in arrays {
        let (kind, shape, fields) = match whole {
            Whole::Matrix(values, [rows, columns]) => (Kind::Number, format!("{rows}, {columns}"), numbers(values)),
            Whole::Numbers(values) => (Kind::Number, format!("{},", values.len()), numbers(values)),
            Whole::Texts(texts) => {
                let longest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0);
                (
                    Kind::Text(longest),
                    format!("{},", texts.len()),
                    texts.iter().map(|text| text.clone().into_bytes()).collect(),
                )
            }
        };
        let (descr, width) = match kind {
            Kind::Number => ("<f8".to_owned(), 8),
            Kind::Text(longest) => (format!("<U{}", longest.max(1)), 4 * longest.max(1) as u64),
        };
        let head = head_of_array(&descr, &shape);
        let mut array = Array::begin_as(&format!("{name}.npy"), kind, head, fields.len() as u64 * width, at, out)?;
        fields.iter().try_for_each(|field: &Vec<u8>| array.take(field))?;
        array.write(out)?;
        array.write_sum(out)?;
        at = array.at + array.head_of_entry() + array.size;
        written.push(array);
    }
    out.seek(SeekFrom::Start(at))?;
    finish(&written, at, out)
}

fn numbers(values: &[f64]) -> Vec<Vec<u8>> {
    values.iter().map(|value| value.to_string().into_bytes()).collect()
}

impl Array {
    /// Writes the heads of the entry and of the array; the sum of the bytes follows in the end.
    fn begin<W: Write + Seek>(name: &str, kind: Kind, rows: u64, at: u64, out: &mut W) -> io::Result<Self> {
        let (descr, width) = match kind {
            Kind::Number => ("<f8".to_owned(), 8),
            Kind::Text(longest) => (format!("<U{}", longest.max(1)), 4 * longest.max(1) as u64),
        };
        Self::begin_as(name, kind, head_of_array(&descr, &format!("{rows},")), rows * width, at, out)
    }

    /// The same with the array's own head and the bytes of its values.
    fn begin_as<W: Write + Seek>(
        name: &str,
        kind: Kind,
        head: Vec<u8>,
        bytes: u64,
        at: u64,
        out: &mut W,
    ) -> io::Result<Self> {
        let size = head.len() as u64 + bytes;
        let name = name.as_bytes().to_vec();
        let mut array = Self { name, at, next: at, size, sum: crc32fast::Hasher::new(), gathered: Vec::new(), kind };
        out.seek(SeekFrom::Start(at))?;
        let mut entry = Vec::new();
        entry.extend(0x0403_4b50_u32.to_le_bytes());
        array.push_common(&mut entry, 0);
        entry.extend(20_u16.to_le_bytes());
        entry.extend(&array.name);
        entry.extend(1_u16.to_le_bytes());
        entry.extend(16_u16.to_le_bytes());
        entry.extend(size.to_le_bytes());
        entry.extend(size.to_le_bytes());
        debug_assert_eq!(entry.len() as u64, array.head_of_entry());
        out.write_all(&entry)?;
        array.next += array.head_of_entry();
        array.gathered = head;
        Ok(array)
    }

    /// Bytes before the array in its entry.
    fn head_of_entry(&self) -> u64 {
        30 + self.name.len() as u64 + 20
    }

    /// What the heads of an entry in both places say: versions, time, sum, sizes, and the length of the name.
    fn push_common(&self, bytes: &mut Vec<u8>, sum: u32) {
        for short in [VERSION, FLAGS, 0, 0, DATE] {
            bytes.extend(short.to_le_bytes());
        }
        for long in [sum, ELSEWHERE, ELSEWHERE] {
            bytes.extend(long.to_le_bytes());
        }
        bytes.extend((self.name.len() as u16).to_le_bytes());
    }

    fn take(&mut self, field: &[u8]) -> io::Result<()> {
        match self.kind {
            Kind::Number => self.gathered.extend(number(field)?.unwrap_or(f64::NAN).to_le_bytes()),
            Kind::Text(longest) => {
                let text = String::from_utf8_lossy(field);
                let filled = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest.max(1));
                filled.for_each(|unit| self.gathered.extend(unit.to_le_bytes()));
            }
        }
        Ok(())
    }

    /// Writes what was gathered where it belongs.
    fn write<W: Write + Seek>(&mut self, out: &mut W) -> io::Result<()> {
        out.seek(SeekFrom::Start(self.next))?;
        out.write_all(&self.gathered)?;
        self.sum.update(&self.gathered);
        self.next += self.gathered.len() as u64;
        self.gathered.clear();
        Ok(())
    }

    fn write_sum<W: Write + Seek>(&self, out: &mut W) -> io::Result<()> {
        out.seek(SeekFrom::Start(self.at + 14))?;
        out.write_all(&self.sum.clone().finalize().to_le_bytes())
    }
}

/// The head of an array of a shape as Python writes it, padded so that the values begin at a multiple of 64 bytes.
fn head_of_array(descr: &str, shape: &str) -> Vec<u8> {
    const LEAD: usize = 10;
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}");
    let length = (LEAD + text.len() + 1).next_multiple_of(64) - LEAD;
    text.extend(std::iter::repeat_n(' ', length - 1 - text.len()));
    text.push('\n');
    let mut head = b"\x93NUMPY\x01\x00".to_vec();
    head.extend((length as u16).to_le_bytes());
    head.extend(text.as_bytes());
    head
}

/// Writes the directory, which begins at byte `at`.
fn finish<W: Write>(arrays: &[Array], at: u64, out: &mut W) -> io::Result<()> {
    let mut directory = Vec::new();
    for array in arrays {
        directory.extend(0x0201_4b50_u32.to_le_bytes());
        directory.extend(VERSION.to_le_bytes());
        array.push_common(&mut directory, array.sum.clone().finalize());
        // The zip64 part, no comment, first disk, no attributes.
        for short in [28_u16, 0, 0, 0] {
            directory.extend(short.to_le_bytes());
        }
        directory.extend(0_u32.to_le_bytes());
        directory.extend(ELSEWHERE.to_le_bytes());
        directory.extend(&array.name);
        directory.extend(1_u16.to_le_bytes());
        directory.extend(24_u16.to_le_bytes());
        for long in [array.size, array.size, array.at] {
            directory.extend(long.to_le_bytes());
        }
    }
    let (count, length) = (arrays.len() as u64, directory.len() as u64);
    // End of the directory in zip64, where that is, and the old end, which says that it is there.
    directory.extend(0x0606_4b50_u32.to_le_bytes());
    directory.extend(44_u64.to_le_bytes());
    directory.extend(VERSION.to_le_bytes());
    directory.extend(VERSION.to_le_bytes());
    directory.extend([0; 8]);
    for long in [count, count, length, at] {
        directory.extend(long.to_le_bytes());
    }
    directory.extend(0x0706_4b50_u32.to_le_bytes());
    directory.extend(0_u32.to_le_bytes());
    directory.extend((at + length).to_le_bytes());
    directory.extend(1_u32.to_le_bytes());
    directory.extend(0x0605_4b50_u32.to_le_bytes());
    directory.extend([0, 0, 0, 0]);
    directory.extend([0xff; 12]);
    directory.extend([0, 0]);
    out.write_all(&directory)
}
