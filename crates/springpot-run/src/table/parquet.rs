//! Apache Parquet, as much of it as a table of numbers needs: optional columns, plain values, no compression.
//!
//! Format: Apache Parquet 2.10, `parquet.thrift`, with data pages of version 1; the metadata in Thrift's compact
//! protocol. Units and meanings of the columns stand under the key `springpot.columns` of the file's metadata, as in
//! run.json.

use super::rows::{Kind, Rows, number};
use std::io::{self, Write};

const MAGIC: &[u8; 4] = b"PAR1";
/// Values that are gathered before they are written as one group of rows.
const GATHERED: usize = 1 << 20;
/// Fewest and most rows of a group.
const ROWS: (usize, usize) = (1_000, 1_000_000);

const DOUBLE: i64 = 5;
const BYTE_ARRAY: i64 = 6;
const PLAIN: i64 = 0;
const RLE: i64 = 3;

/// Writes the rows; an empty field is null.
pub(super) fn write<W: Write>(rows: &Rows<'_>, out: &mut W) -> io::Result<()> {
    let mut file = Counted { out, written: 0 };
    file.write(MAGIC)?;
    let most = (GATHERED / rows.columns.len().max(1)).clamp(ROWS.0, ROWS.1);
    let mut chunks: Vec<Chunk> = rows.kinds.iter().map(|kind| Chunk { kind: *kind, ..Chunk::default() }).collect();
    let mut groups = Vec::new();
    let mut gathered = 0;
    rows.visit(&mut |record| {
        for (chunk, field) in chunks.iter_mut().zip(record) {
            chunk.take(field)?;
        }
        gathered += 1;
        if gathered == most {
            groups.push(Group::write(rows, &mut chunks, gathered, &mut file)?);
            gathered = 0;
        }
        Ok(())
    })?;
    if gathered > 0 {
        groups.push(Group::write(rows, &mut chunks, gathered, &mut file)?);
    }
    let footer = footer(rows, &groups);
    file.write(&footer)?;
    file.write(&(footer.len() as u32).to_le_bytes())?;
    file.write(MAGIC)
}

struct Counted<'a, W> {
    out: &'a mut W,
    written: u64,
}

impl<W: Write> Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.written += bytes.len() as u64;
        Ok(())
    }
}

/// The values of one column in a group of rows.
struct Chunk {
    kind: Kind,
    values: Vec<u8>,
    /// Runs of rows that have a value, or none.
    runs: Vec<(bool, u64)>,
}

impl Default for Chunk {
    fn default() -> Self {
        Self { kind: Kind::Number, values: Vec::new(), runs: Vec::new() }
    }
}

impl Chunk {
    fn take(&mut self, field: &[u8]) -> io::Result<()> {
        let has_value = !field.is_empty();
        match self.kind {
            Kind::Number => self.values.extend(number(field)?.into_iter().flat_map(f64::to_le_bytes)),
            Kind::Text(_) if has_value => {
                self.values.extend((field.len() as u32).to_le_bytes());
                self.values.extend(field);
            }
            Kind::Text(_) => {}
        }
        match self.runs.last_mut() {
            Some((had_value, length)) if *had_value == has_value => *length += 1,
            _ => self.runs.push((has_value, 1)),
        }
        Ok(())
    }

    /// The page: its head, which rows have values, and the values; empties the chunk.
    fn page(&mut self, rows: usize) -> Vec<u8> {
        let mut levels = Vec::new();
        for (has_value, length) in self.runs.drain(..) {
            push_varint(&mut levels, length << 1);
            levels.push(u8::from(has_value));
        }
        let size = (4 + levels.len() + self.values.len()) as i64;
        let mut head = Struct::new();
        head.integer(1, 0);
        head.integer(2, size);
        head.integer(3, size);
        head.structure(5, {
            let mut data = Struct::new();
            data.integer(1, rows as i64);
            data.integer(2, PLAIN);
            data.integer(3, RLE);
            data.integer(4, RLE);
            data
        });
        let mut page = head.finish();
        page.extend((levels.len() as u32).to_le_bytes());
        page.append(&mut levels);
        page.append(&mut self.values);
        page
    }
}

/// A group of rows that was written.
struct Group {
    /// Where the page of every column begins, and how long it is.
    pages: Vec<(u64, u64)>,
    rows: usize,
}

impl Group {
    fn write<W: Write>(
        rows: &Rows<'_>,
        chunks: &mut [Chunk],
        count: usize,
        file: &mut Counted<'_, W>,
    ) -> io::Result<Self> {
        let mut pages = Vec::with_capacity(rows.columns.len());
        for chunk in chunks {
            let page = chunk.page(count);
            pages.push((file.written, page.len() as u64));
            file.write(&page)?;
        }
        Ok(Self { pages, rows: count })
    }

    fn metadata(&self, rows: &Rows<'_>) -> Struct {
        let columns = rows.columns.iter().zip(&rows.kinds).zip(&self.pages).map(|((column, kind), &(at, size))| {
            let mut data = Struct::new();
            data.integer(1, physical(*kind));
            data.integers(2, &[PLAIN, RLE]);
            data.texts(3, &[&column.name]);
            data.integer(4, 0);
            data.long(5, self.rows as i64);
            data.long(6, size as i64);
            data.long(7, size as i64);
            data.long(9, at as i64);
            let mut chunk = Struct::new();
            chunk.long(2, at as i64);
            chunk.structure(3, data);
            chunk
        });
        let mut group = Struct::new();
        group.structures(1, columns.collect());
        group.long(2, self.pages.iter().map(|(_, size)| *size as i64).sum());
        group.long(3, self.rows as i64);
        group
    }
}

fn physical(kind: Kind) -> i64 {
    if kind == Kind::Number { DOUBLE } else { BYTE_ARRAY }
}

fn footer(rows: &Rows<'_>, groups: &[Group]) -> Vec<u8> {
    let mut root = Struct::new();
    root.text(4, "schema");
    root.integer(5, rows.columns.len() as i64);
    let mut schema = vec![root];
    schema.extend(rows.columns.iter().zip(&rows.kinds).map(|(column, kind)| {
        let mut element = Struct::new();
        element.integer(1, physical(*kind));
        element.integer(3, 1);
        element.text(4, &column.name);
        if *kind != Kind::Number {
            element.integer(6, 0);
        }
        element
    }));
    let mut columns = Struct::new();
    columns.text(1, "springpot.columns");
    columns.text(2, &serde_json::to_string(rows.columns).unwrap_or_default());
    let mut footer = Struct::new();
    footer.integer(1, 1);
    footer.structures(2, schema);
    footer.long(3, rows.count as i64);
    footer.structures(4, groups.iter().map(|group| group.metadata(rows)).collect());
    footer.structures(5, vec![columns]);
    footer.text(6, concat!("springpot version ", env!("CARGO_PKG_VERSION")));
    footer.finish()
}

/// A struct of Thrift's compact protocol; fields are added in the order of their numbers.
struct Struct {
    bytes: Vec<u8>,
    last: u8,
}

impl Struct {
    const I32: u8 = 5;
    const I64: u8 = 6;
    const BINARY: u8 = 8;
    const LIST: u8 = 9;
    const STRUCT: u8 = 12;

    fn new() -> Self {
        Self { bytes: Vec::new(), last: 0 }
    }

    fn finish(mut self) -> Vec<u8> {
        self.bytes.push(0);
        self.bytes
    }

    /// Every field here is less than 16 after the one before.
    fn field(&mut self, number: u8, kind: u8) {
        self.bytes.push((number - self.last) << 4 | kind);
        self.last = number;
    }

    fn integer(&mut self, number: u8, value: i64) {
        self.field(number, Self::I32);
        push_zigzag(&mut self.bytes, value);
    }

    fn long(&mut self, number: u8, value: i64) {
        self.field(number, Self::I64);
        push_zigzag(&mut self.bytes, value);
    }

    fn text(&mut self, number: u8, text: &str) {
        self.field(number, Self::BINARY);
        push_text(&mut self.bytes, text);
    }

    fn structure(&mut self, number: u8, value: Struct) {
        self.field(number, Self::STRUCT);
        self.bytes.extend(value.finish());
    }

    fn list(&mut self, number: u8, kind: u8, length: usize) {
        self.field(number, Self::LIST);
        if length < 15 {
            self.bytes.push((length as u8) << 4 | kind);
        } else {
            self.bytes.push(0xf0 | kind);
            push_varint(&mut self.bytes, length as u64);
        }
    }

    fn integers(&mut self, number: u8, values: &[i64]) {
        self.list(number, Self::I32, values.len());
        values.iter().for_each(|value| push_zigzag(&mut self.bytes, *value));
    }

    fn texts(&mut self, number: u8, values: &[&str]) {
        self.list(number, Self::BINARY, values.len());
        values.iter().for_each(|text| push_text(&mut self.bytes, text));
    }

    fn structures(&mut self, number: u8, values: Vec<Struct>) {
        self.list(number, Self::STRUCT, values.len());
        values.into_iter().for_each(|value| self.bytes.extend(value.finish()));
    }
}

fn push_text(bytes: &mut Vec<u8>, text: &str) {
    push_varint(bytes, text.len() as u64);
    bytes.extend(text.as_bytes());
}

fn push_zigzag(bytes: &mut Vec<u8>, value: i64) {
    push_varint(bytes, (value << 1 ^ value >> 63) as u64);
}

/// Seven bits a byte, the lowest first.
fn push_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}
