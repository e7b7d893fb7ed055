//! STL: triangles alone, as bytes or as text.

use super::sink::Sink;
use super::{Unread, floats};

/// Bytes before the triangles of the binary form: words, and how many there are.
const HEAD: usize = 84;
/// Bytes of a triangle: a normal, three corners, and two more.
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8], sink: &mut Sink) -> Result<(), Unread> {
    let count = bytes.get(HEAD - 4..HEAD).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let needed = count.map(|count| HEAD as u64 + TRIANGLE as u64 * u64::from(count));
    let has_all = needed.is_some_and(|needed| needed <= bytes.len() as u64);
    let is_exact = needed == Some(bytes.len() as u64);
    // Binary files may begin with the word of texts.
    if is_exact || (has_all && !bytes.starts_with(b"solid")) {
        return binary(&bytes[HEAD..], count.unwrap_or(0) as usize, sink);
    }
    if !bytes.trim_ascii_start().starts_with(b"solid") {
        return Err(Unread::Broken("it ends before the number of triangles that it tells"));
    }
    text(std::str::from_utf8(bytes).map_err(|_| Unread::NotText)?, sink)
}

fn binary(bytes: &[u8], count: usize, sink: &mut Sink) -> Result<(), Unread> {
    for triangle in bytes.chunks_exact(TRIANGLE).take(count) {
        let number = |k: usize| f32::from_le_bytes([triangle[k], triangle[k + 1], triangle[k + 2], triangle[k + 3]]);
        sink.triangle(None, [12, 24, 36].map(|at| [number(at), number(at + 4), number(at + 8)]))?;
    }
    Ok(())
}

fn text(text: &str, sink: &mut Sink) -> Result<(), Unread> {
    let mut corners: Vec<[f32; 3]> = Vec::with_capacity(3);
    for (line, written) in text.lines().enumerate() {
        let refused = |why| Unread::Line(line + 1, why);
        let written = written.trim_start();
        let (word, rest) = written.split_once(char::is_whitespace).unwrap_or((written.trim_end(), ""));
        match word.to_ascii_lowercase().as_str() {
            "facet" => corners.clear(),
            "vertex" => {
                if corners.len() == 3 {
                    return Err(refused("a facet has more than three corners"));
                }
                let numbers: Vec<f32> = floats(rest).take(3).collect::<Result<_, _>>()?;
                corners.push(numbers.try_into().map_err(|_| refused("a corner has three numbers"))?);
            }
            "endfacet" => {
                let whole = corners[..].try_into().map_err(|_| refused("a facet has three corners"))?;
                sink.triangle(None, whole)?;
            }
            _ => {}
        }
    }
    Ok(())
}
