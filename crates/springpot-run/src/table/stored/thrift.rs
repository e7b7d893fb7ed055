//! Thrift's compact protocol, as much of it as the metadata of Parquet files needs.

use super::damaged;
use std::collections::BTreeMap;
use std::io;

/// Deepest nesting that is read.
const MAX_DEPTH: usize = 16;

/// A value.
#[derive(Debug)]
pub(super) enum Value {
    Integer(i64),
    Bytes(Vec<u8>),
    List(Vec<Value>),
    Struct(Fields),
}

/// The fields of a struct, by number.
#[derive(Debug, Default)]
pub(super) struct Fields(BTreeMap<i64, Value>);

impl Fields {
    pub(super) fn integer(&self, number: i64) -> io::Result<i64> {
        match self.0.get(&number) {
            Some(Value::Integer(value)) => Ok(*value),
            _ => Err(damaged()),
        }
    }

    /// A number of bytes, rows or the like.
    pub(super) fn count(&self, number: i64) -> io::Result<usize> {
        usize::try_from(self.integer(number)?).map_err(|_| damaged())
    }

    pub(super) fn text(&self, number: i64) -> io::Result<String> {
        match self.0.get(&number) {
            Some(Value::Bytes(bytes)) => String::from_utf8(bytes.clone()).map_err(|_| damaged()),
            _ => Err(damaged()),
        }
    }

    pub(super) fn fields(&self, number: i64) -> io::Result<&Self> {
        match self.0.get(&number) {
            Some(Value::Struct(fields)) => Ok(fields),
            _ => Err(damaged()),
        }
    }

    /// The structs of a list.
    pub(super) fn list(&self, number: i64) -> io::Result<Vec<&Self>> {
        let Some(Value::List(items)) = self.0.get(&number) else { return Err(damaged()) };
        let fields = items.iter().map(|item| match item {
            Value::Struct(fields) => Ok(fields),
            _ => Err(damaged()),
        });
        fields.collect()
    }
}

/// Reads the struct at the beginning of `bytes`, which stand behind it then.
pub(super) fn read(bytes: &mut &[u8]) -> io::Result<Fields> {
    fields(bytes, 0)
}

fn fields(bytes: &mut &[u8], depth: usize) -> io::Result<Fields> {
    if depth > MAX_DEPTH {
        return Err(damaged());
    }
    let (mut fields, mut number) = (Fields::default(), 0);
    loop {
        let head = byte(bytes)?;
        if head == 0 {
            return Ok(fields);
        }
        number = match head >> 4 {
            0 => signed(bytes)?,
            more => number + i64::from(more),
        };
        // A flag has its value in its head.
        let value = match head & 0xf {
            1 => Value::Integer(1),
            2 => Value::Integer(0),
            kind => value(bytes, kind, depth)?,
        };
        fields.0.insert(number, value);
    }
}

fn value(bytes: &mut &[u8], kind: u8, depth: usize) -> io::Result<Value> {
    Ok(match kind {
        3 => Value::Integer(i64::from(byte(bytes)?)),
        4..=6 => Value::Integer(signed(bytes)?),
        8 => {
            let length = usize::try_from(varint(bytes)?).map_err(|_| damaged())?;
            Value::Bytes(taken(bytes, length)?.to_vec())
        }
        9 => {
            let head = byte(bytes)?;
            let length = match head >> 4 {
                15 => varint(bytes)?,
                length => u64::from(length),
            };
            // Every item takes a byte at least.
            if length > bytes.len() as u64 {
                return Err(damaged());
            }
            let items = (0..length).map(|_| value(bytes, head & 0xf, depth + 1));
            Value::List(items.collect::<io::Result<_>>()?)
        }
        12 => Value::Struct(fields(bytes, depth + 1)?),
        _ => return Err(damaged()),
    })
}

pub(super) fn byte(bytes: &mut &[u8]) -> io::Result<u8> {
    Ok(taken(bytes, 1)?[0])
}

/// So many bytes, which are taken off.
pub(super) fn taken<'b>(bytes: &mut &'b [u8], length: usize) -> io::Result<&'b [u8]> {
    let (taken, rest) = bytes.split_at_checked(length).ok_or_else(damaged)?;
    *bytes = rest;
    Ok(taken)
}

pub(super) fn varint(bytes: &mut &[u8]) -> io::Result<u64> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let byte = byte(bytes)?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(value);
        }
    }
    Err(damaged())
}

/// Signed numbers go 0, −1, 1, −2, ….
fn signed(bytes: &mut &[u8]) -> io::Result<i64> {
    let folded = varint(bytes)?;
    Ok((folded >> 1) as i64 ^ -((folded & 1) as i64))
}
