//! Reads the look of a figure.

use super::super::columns::ColumnGlob;
use super::{FIGURE_SIDES, FigureFormat, FigureLabel, Look, OPTIONS, RangeEnd, Said, Takes};
use crate::reader::constants;
use crate::reader::{Field, Read, Table, all};
use crate::text::document::Value;
use crate::text::refusal::RefusalKind;

/// Reads it; `end` is that of the run, s, where all cases have one.
pub(in crate::figures) fn read(table: &Table<'_>, is_robot: bool, end: Option<f64>) -> Read<Look> {
    let mut look = Look { formats: FigureFormat::DEFAULT.to_vec(), ..Look::default() };
    let asked = OPTIONS.iter().filter_map(|option| Some((option, table.get(option.name())?)));
    all(asked.map(|(option, field)| {
        match option.takes {
            Takes::Range(at) => *at(&mut look) = Some(range(&field)?),
            Takes::Flag { of, word, at } => *at(&mut look) = field.word(of)? == word,
            Takes::Text(at) => *at(&mut look) = Some(field.text()?.to_owned()),
            Takes::TextOrFalse { text, hides } => {
                let written = text_or_false(&field)?;
                *hides(&mut look) = written.is_none();
                *text(&mut look) = written;
            }
            Takes::Size(at) => *at(&mut look) = Some(size(&field)?),
            Takes::Times(at) => *at(&mut look) = Some(window(&field, end)?),
            Takes::Direction(at) => *at(&mut look) = Some(view(&field)?),
            Takes::Labels => (look.labels, look.hides_names) = (labels(&field, is_robot)?, is_robot),
            Takes::Formats => look.formats = formats(&field)?,
        }
        let what = match option.takes {
            Takes::Flag { word, .. } => format!("{} = {word:?}:", option.name()),
            _ => field.to_string(),
        };
        look.said.push(Said { option: option.name(), what, place: Some(field.node.place.clone()) });
        Ok(())
    }))?;
    if let Some(place) = look.said("aspect").and_then(|said| said.place.as_ref())
        && (look.x.is_log || look.y.is_log)
    {
        let refusal = place.refuse(RefusalKind::Rule, "aspect = \"equal\" has no meaning on a logarithmic scale");
        return Err(table.ctx.refuse(refusal.help("leave `aspect` out, or the scale")));
    }
    Ok(look)
}

/// The two items of an array.
fn pair<'a>(field: &Field<'a>, right: &str, help: &str) -> Read<[Field<'a>; 2]> {
    let items = field.items(right)?;
    <[Field<'a>; 2]>::try_from(items).map_err(|items| {
        let message = format!("has {} entries, but must be {right}", items.len());
        field.refuse(RefusalKind::WrongType, message, Some(format!("write {help}")))
    })
}

fn range(field: &Field<'_>) -> Read<[RangeEnd; 2]> {
    let [from, to] = pair(field, "an array of two numbers or quantities", "[from, to]")?;
    let ends = [range_end(&from), range_end(&to)];
    let [from, to] = ends;
    Ok([from?, to?])
}

fn range_end(field: &Field<'_>) -> Read<RangeEnd> {
    let misread = |text: &str, why| {
        let help = "write a number in the unit that is drawn, or a quantity such as \"5 N\"".to_owned();
        field.refuse(RefusalKind::BadQuantity, format!("holds {text:?}: {why}"), Some(help))
    };
    match &field.node.value {
        Value::Text(text) => RangeEnd::parse(text).map_err(|why| misread(text, why)),
        Value::Table(_) if constants::is_expression(field.node) => {
            let (number, unit) = constants::written_expression(field)?;
            let Some(unit) = unit else { return Ok(RangeEnd { number, unit: None }) };
            let text = format!("{number:?} {}", unit.text()?);
            RangeEnd::parse(&text).map_err(|why| misread(&text, why))
        }
        _ => field.number("").map(|number| RangeEnd { number, unit: None }),
    }
}

fn size(field: &Field<'_>) -> Read<[f64; 2]> {
    let help = "size = [\"90 mm\", \"60 mm\"]";
    let [width, height] = pair(field, "an array of two lengths, [width, height]", help)?;
    let sides = [width.number("m"), height.number("m")];
    let sides = [sides[0]?, sides[1]?];
    if let Some(side) = sides.into_iter().find(|side| !(FIGURE_SIDES[0]..=FIGURE_SIDES[1]).contains(side)) {
        let message = format!("holds {}, which is no side of a figure", millimetres(side));
        let help = format!(
            "write lengths from {} to {}, as in {help}",
            millimetres(FIGURE_SIDES[0]),
            millimetres(FIGURE_SIDES[1])
        );
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
    }
    Ok(sides)
}

fn millimetres(side: f64) -> String {
    format!("{} mm", (1e9 * side).round() * 1e-6)
}

fn labels(field: &Field<'_>, is_robot: bool) -> Read<Vec<FigureLabel>> {
    if is_robot {
        return match field.node.value {
            Value::Boolean(false) => Ok(Vec::new()),
            _ => Err(field.wrong_type("false, where kind = \"robot\"")),
        };
    }
    let Some(entries) = field.node.entries() else { return Err(field.wrong_type("a table of texts by column")) };
    all(entries.iter().map(|entry| {
        let column = ColumnGlob { text: entry.key.clone(), place: entry.key_place.clone() };
        let text =
            Field { node: &entry.node, key: &entry.key, row: None, owner: field.to_string().into(), ..field.clone() };
        Ok(FigureLabel { column, text: text.text()?.to_owned() })
    }))
}

/// A text; nothing where there is none.
fn text_or_false(field: &Field<'_>) -> Read<Option<String>> {
    match &field.node.value {
        Value::Text(text) => Ok(Some(text.clone())),
        Value::Boolean(false) => Ok(None),
        _ => Err(field.wrong_type("a text or false")),
    }
}

fn window(field: &Field<'_>, end: Option<f64>) -> Read<[f64; 2]> {
    let [from, to] = pair(field, "an array of two times, [from, to]", "window = [\"1 s\", \"2 s\"]")?;
    let times = [from.number("s"), to.number("s")];
    let [from, to] = [times[0]?, times[1]?];
    if from >= to {
        let message = format!("runs from {from} s to {to} s, which is no stretch of time");
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some("write the earlier time first".to_owned())));
    }
    if to < 0.0 || end.is_some_and(|end| from > end) {
        let end = end.map_or_else(|| "its end".to_owned(), |end| format!("{end} s"));
        let message = format!("runs from {from} s to {to} s, where there is no row");
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some(format!("the run goes from 0 to {end}"))));
    }
    Ok([from, to])
}

fn formats(field: &Field<'_>) -> Read<Vec<FigureFormat>> {
    let items = field.items("an array of formats, of \"svg\", \"png\" and \"pdf\"")?;
    if items.is_empty() {
        return Err(field.refuse(
            RefusalKind::Missing,
            "is empty",
            Some("write formats = [\"svg\", \"pdf\"]".to_owned()),
        ));
    }
    let mut formats = all(items.iter().map(|item| {
        let word = item.word("format of figures")?;
        Ok(FigureFormat::ALL.into_iter().find(|format| format.name() == word).unwrap_or(FigureFormat::Svg))
    }))?;
    formats.sort_by_key(|format| *format as usize);
    formats.dedup();
    Ok(formats)
}

fn view(field: &Field<'_>) -> Read<[f64; 2]> {
    let help = "view = [azimuth, elevation], as in view = [30, 20]";
    let [azimuth, elevation] = pair(field, "an array of two angles in degrees", help)?;
    let angles = [degrees(&azimuth), degrees(&elevation)];
    let [azimuth, elevation] = [angles[0]?, angles[1]?];
    if azimuth.abs() > 360.0 || elevation.abs() > 90.0 {
        let message = format!("is [{azimuth}, {elevation}], which is no direction");
        let help = "write an azimuth from -360 to 360 and an elevation from -90 to 90, in degrees".to_owned();
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
    }
    Ok([azimuth, elevation])
}

/// A number of degrees, or an angle with its unit.
fn degrees(field: &Field<'_>) -> Read<f64> {
    match field.node.value {
        Value::Text(_) => field.number("rad").map(f64::to_degrees),
        _ => field.number(""),
    }
}
