//! OBJ: corners by number, polygons of them, and colours from a file beside.

use super::sink::{Rgb, Sink};
use super::{Unread, floats};
use std::collections::HashMap;

/// Most files of materials that are looked into.
const MOST_LIBRARIES: usize = 16;

/// `library`: the colours of a file of materials by their names.
pub(super) fn read(
    bytes: &[u8],
    library: &dyn Fn(&str) -> HashMap<String, Rgb>,
    sink: &mut Sink,
) -> Result<(), Unread> {
    // Names may be written in whatever way.
    let text = String::from_utf8_lossy(bytes);
    let (mut points, mut colors, mut libraries) = (Vec::<[f32; 3]>::new(), HashMap::new(), 0);
    let mut color: Option<Rgb> = None;
    for (line, written) in text.lines().enumerate() {
        let refused = |why| Unread::Line(line + 1, why);
        let written = written.trim();
        let (word, rest) = written.split_once(char::is_whitespace).unwrap_or((written, ""));
        match word {
            "v" => {
                let numbers: Vec<f32> = floats(rest).take(3).collect::<Result<_, _>>()?;
                points.push(numbers.try_into().map_err(|_| refused("a corner has three numbers"))?);
            }
            "f" => {
                let mut corners = rest.split_ascii_whitespace().map(|corner| {
                    place(corner, points.len())
                        .and_then(|place| points.get(place))
                        .ok_or_else(|| refused("a face names a corner that is not there"))
                });
                let (Some(first), Some(second)) = (corners.next(), corners.next()) else {
                    return Err(refused("a face has three corners"));
                };
                let (first, mut before) = (*first?, *second?);
                for corner in corners {
                    let corner = *corner?;
                    sink.triangle(color, [first, before, corner])?;
                    before = corner;
                }
            }
            "usemtl" => color = colors.get(rest.trim()).copied(),
            "mtllib" if libraries < MOST_LIBRARIES => {
                libraries += 1;
                colors.extend(library(rest.trim()));
            }
            _ => {}
        }
    }
    Ok(())
}

/// The place of a corner, `7`, `7/1/2` or, from the last one back, `-1`.
fn place(corner: &str, count: usize) -> Option<usize> {
    let number: i64 = corner.split('/').next()?.parse().ok()?;
    let place = if number < 0 { (count as i64).checked_add(number)? } else { number - 1 };
    usize::try_from(place).ok()
}
