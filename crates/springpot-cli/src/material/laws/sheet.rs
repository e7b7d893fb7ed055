//! A law from the values of a data sheet.

use super::names::{self, SUGGESTED};
use super::sample::{ANGLES, Missized, Sample, is_angle, tangent};
use super::{Refused, page};
use crate::{diagnostic, frequency};
use serde_json::{Map, Value, json};
use springpot::law::datasheet::{DatasheetError, Datum, Identified, Model, Quantity, identify};
use springpot::law::{Catalog, Entry};
use springpot_run::numbers::{rough, short};
use springpot_scenario::suggest;
use springpot_scenario::units::{UnitError, parse_quantity, split_quantity};
use std::ops::Range;

/// A deviation below this is that of the digits shown.
const SHOWN: f64 = 1e-5;

/// A deviation above this is worth a warning.
const FAR_OFF: f64 = 0.5;

/// One value and how it was written.
struct Item {
    datum: Datum,
    /// `stiffness at 10 Hz`.
    written: String,
    value: String,
    reading: Reading,
    /// Where the value stands.
    at: Range<usize>,
}

/// How a value is read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reading {
    AsWritten,
    /// The angle δ for tan δ.
    Angle,
    /// In Pa, of the sample.
    Modulus,
    /// The number of a modulus without unit, in N/m.
    Bare,
}

/// The law, its parameters, an element, and how well it meets the data.
pub(super) fn text(
    catalog: &Catalog,
    data: &str,
    law: Option<&Entry>,
    sample: Sample,
    as_json: bool,
) -> Result<String, Refused> {
    let items = items(data, sample)?;
    let values: Vec<Datum> = items.iter().map(|item| item.datum).collect();
    let names = || super::determined(catalog);
    let law = match law {
        Some(law) => law,
        None => Model::for_data(&values).law(catalog).ok_or_else(|| {
            let message = "no law of the catalog is of the form that such data determine";
            Refused::new(message, format!("choose one of {}", names()))
        })?,
    };
    let found = identify(law, &values).map_err(|error| refused(&error, law, &values, &names))?;
    let deviation = found.deviation(&values);
    if deviation > FAR_OFF {
        let message = format!(
            "{} misses the data by {} %: no values of its parameters meet them",
            law.name,
            rough(100.0 * deviation)
        );
        diagnostic::warning(message, Some("name another law, or none: the data then say which".to_owned()));
    }
    Ok(if as_json { json(law, &found, &items) } else { page(law, &found, &items) })
}

/// The message, and what would be right for this law, or which others data determine.
fn refused(error: &DatasheetError, law: &Entry, data: &[Datum], names: &dyn Fn() -> String) -> Refused {
    let is_whole = Model::of(law) == Some(Model::FractionalKelvinVoigt);
    let help = match error {
        DatasheetError::OtherLaw { .. } => Some(format!("choose one of {}", names())),
        DatasheetError::TooFew { .. } => Some(missing(is_whole, data)),
        DatasheetError::NoStiffness => Some("add stiffness, storage, loss or damping".to_owned()),
        DatasheetError::NeedsFrequency { quantity } => Some(format!("write {quantity} = … at 10 Hz")),
        DatasheetError::NoStaticStiffness { .. } => {
            Some("a static stiffness makes it kelvin-voigt or fractional-kelvin-voigt".to_owned())
        }
        DatasheetError::Undetermined { .. } => {
            Some("add tan_delta, loss or damping, or values at another frequency".to_owned())
        }
        DatasheetError::Unreachable { .. } if is_whole => Some(
            "its dynamic stiffness rises with the frequency, from k at rest; look at units and frequencies".to_owned(),
        ),
        DatasheetError::Unreachable { .. } => Some("look at units and frequencies, or name another law".to_owned()),
        DatasheetError::NotPositive { .. } | DatasheetError::Twice { .. } => None,
    };
    Refused::new(error.to_string(), help)
}

/// What would be enough for a law, of three parameters or of fewer.
fn missing(is_whole: bool, data: &[Datum]) -> String {
    let has_losses = data.iter().any(|datum| datum.quantity.is_of_losses());
    match (is_whole, has_losses) {
        (true, _) => "it needs three values, such as a static stiffness, and stiffness and tan_delta at one \
                                              frequency"
            .to_owned(),
        (false, true) => "add a stiffness: stiffness = 5 kN/m".to_owned(),
        (false, false) => "add the losses: tan_delta = 0.3 at 10 Hz".to_owned(),
    }
}

/// Reads `NAME = VALUE [at FREQUENCY], …`.
fn items(data: &str, mut sample: Sample) -> Result<Vec<Item>, Refused> {
    let mut read = Vec::new();
    let mut start = 0;
    for part in data.split([',', ';']) {
        let at = start + (part.len() - part.trim_start().len());
        start += part.len() + 1;
        let part = part.trim();
        if !(part.is_empty() || size(data, part, &mut sample)?) {
            read.push(item(data, at, part)?);
        }
    }
    if read.is_empty() {
        let help = "write --from 'tan_delta = 0.3 at 10 Hz, stiffness = 5 kN/m'".to_owned();
        return Err(Refused::new("--from holds no data", help));
    }
    of_sample(&mut read, &sample)?;
    // What has no frequency of its own has the only one there is.
    let mut told: Vec<(f64, String)> = read.iter().filter_map(|(_, frequency)| frequency.clone()).collect();
    told.sort_by(|a, b| a.0.total_cmp(&b.0));
    told.dedup_by(|a, b| a.0 == b.0);
    let moving: Vec<&(f64, String)> = told.iter().filter(|(omega, _)| *omega > 0.0).collect();
    let only = match moving[..] {
        [] => (0.0, "0".to_owned()),
        [only] => only.clone(),
        _ => {
            let Some((item, _)) = read.iter().find(|(_, frequency)| frequency.is_none()) else {
                return Ok(read
                    .into_iter()
                    .map(|(item, frequency)| item.with(frequency.unwrap_or_default()))
                    .collect());
            };
            let message = format!("{} has no frequency, and the data have several", item.written);
            return Err(Refused::new(message, format!("write {} = … at 10 Hz", item.written)));
        }
    };
    Ok(read.into_iter().map(|(item, frequency)| item.with(frequency.unwrap_or_else(|| only.clone()))).collect())
}

/// Takes `area = 4 cm^2` or `length = 10 mm` for the sample; whether `part` is one of them.
fn size(data: &str, part: &str, sample: &mut Sample) -> Result<bool, Refused> {
    let Some((name, value)) = part.split_once(['=', ':']) else { return Ok(false) };
    let (name, value) = (name.trim(), value.trim());
    let Some((_, unit, example)) = Sample::SIZES.into_iter().find(|size| size.0 == name) else { return Ok(false) };
    let right = format!("write a positive number in {unit}, or with a unit: {name} = {example}");
    match sample.set(name, value) {
        Ok(()) => Ok(true),
        Err(Missized::Twice) => Err(Refused::at(place(data, name), format!("{name} is given twice"), None)),
        Err(Missized::NotPositive) => {
            Err(Refused::at(place(data, value), format!("{name} is {value}, but must be positive"), right))
        }
        Err(Missized::Unit(error)) => Err(misread(place(data, value), &error, right)),
    }
}

/// Makes stiffnesses of moduli.
fn of_sample(read: &mut [(Item, Frequency)], sample: &Sample) -> Result<(), Refused> {
    let mut moduli = 0;
    for (item, _) in read {
        if item.reading == Reading::Bare {
            let help = format!("a modulus has a unit: {} = {} MPa", item.written, item.value);
            diagnostic::warning(
                format!("{} = {} has no unit and is read in N/m", item.written, item.value),
                Some(help),
            );
        }
        if item.reading == Reading::Modulus {
            let Some(factor) = sample.stiffness_of_one() else {
                let message =
                    format!("{} is a modulus: the stiffness E·A/L takes area and length of the sample", item.written);
                return Err(Refused::at(item.at.clone(), message, Sample::CURE.to_owned()));
            };
            item.datum.value *= factor;
            moduli += 1;
        }
    }
    match sample.is_given() && moduli == 0 {
        true => Err(Refused::new(super::NO_MODULUS, super::MODULI.to_owned())),
        false => Ok(()),
    }
}

/// Where a part of `data` stands in it.
fn place(data: &str, text: &str) -> Range<usize> {
    let at = text.as_ptr() as usize - data.as_ptr() as usize;
    at..at + text.len()
}

impl Item {
    fn with(mut self, (omega, written): (f64, String)) -> Self {
        self.datum.omega = omega;
        self.written.push_str(&if omega == 0.0 { " at rest".to_owned() } else { format!(" at {written}") });
        self
    }
}

type Frequency = Option<(f64, String)>;

/// `stiffness = 5 kN/m at 10 Hz`, which stands at byte `start` of `data`.
fn item(data: &str, start: usize, part: &str) -> Result<(Item, Frequency), Refused> {
    let place = |text: &str| place(data, text);
    debug_assert_eq!(place(part).start, start);
    let Some((name, rest)) = part.split_once(['=', ':']) else {
        let help = "write NAME = VALUE, as in tan_delta = 0.3".to_owned();
        return Err(Refused::at(place(part), format!("{part:?} has no `=`"), help));
    };
    let (name, rest) = (name.trim(), rest.trim());
    let Some((quantity, is_modulus)) = names::quantity(name) else {
        return Err(Refused::at(place(name), format!("there is no quantity {name:?}"), suggest(name, SUGGESTED)));
    };
    let (value, frequency) = match rest.rsplit_once(" at ") {
        Some((value, frequency)) => (value.trim(), Some(frequency.trim())),
        None => (rest, None),
    };
    let unit = split_quantity(value).map_or("", |(_, unit)| unit);
    let in_pascal = || parse_quantity(value, "Pa", &|_| None);
    let (read, reading) = match parse_quantity(value, quantity.unit(), &|_| None) {
        Ok(delta) if quantity == Quantity::LossFactor && is_angle(unit) => match tangent(delta) {
            Some(tangent) => (tangent, Reading::Angle),
            None => return Err(Refused::at(place(value), format!("{value} is no loss angle"), ANGLES.to_owned())),
        },
        Ok(read) => (read, if is_modulus && unit.is_empty() { Reading::Bare } else { Reading::AsWritten }),
        Err(_) if quantity.unit() == "N/m" && in_pascal().is_ok() => {
            (in_pascal().unwrap_or(f64::NAN), Reading::Modulus)
        }
        Err(error) => {
            let right = match quantity.unit() {
                "" => "write a number".to_owned(),
                unit => format!("write a number in {unit}, or with a unit: 5 k{unit}"),
            };
            return Err(misread(place(value), &error, right));
        }
    };
    if read <= 0.0 {
        return Err(Refused::at(place(value), format!("{name} is {value}, but must be positive"), None));
    }
    let frequency = frequency.map(|text| omega(text, place(text)).map(|omega| (omega, text.to_owned()))).transpose()?;
    let datum = Datum { quantity, value: read, omega: 0.0 };
    Ok((Item { datum, written: name.to_owned(), value: value.to_owned(), reading, at: place(value) }, frequency))
}

fn misread(at: Range<usize>, error: &UnitError, help: String) -> Refused {
    let span = error.span().map_or(at.clone(), |span| at.start + span.start..at.start + span.end);
    Refused::at(span, error.to_string(), help)
}

/// An angular frequency, rad/s.
fn omega(text: &str, at: Range<usize>) -> Result<f64, Refused> {
    let help = || "write a frequency such as 10 Hz or 63 rad/s, or 0 for a static value".to_owned();
    if text == "rest" {
        return Ok(0.0);
    }
    match frequency::angular(text) {
        Ok(value) if value >= 0.0 => Ok(value),
        Ok(_) => Err(Refused::at(at, format!("{text:?} is no frequency"), help())),
        Err(frequency::Misread::Unit(error)) => Err(misread(at, &error, help())),
        Err(error) => Err(Refused::at(at, error.to_string(), help())),
    }
}

/// The parameters as they are shown, and the law that has them.
fn rounded<'a>(row: &'a Entry, found: &Identified) -> (Vec<(&'a str, &'a str, f64)>, Identified) {
    let round = |value: f64| short(value).parse().unwrap_or(value);
    let shown = Identified {
        stiffness: round(found.stiffness),
        coefficient: round(found.coefficient),
        order: round(found.order),
        ..*found
    };
    let value = |name: &str| shown.parameter(name).unwrap_or(f64::NAN);
    (row.params.iter().map(|param| (&*param.name, &*param.unit, value(&param.name))).collect(), shown)
}

fn page(row: &Entry, found: &Identified, items: &[Item]) -> String {
    let (params, shown) = rounded(row, found);
    let mut text = format!("{}   {}\n\n", row.name, row.equation);
    for (name, unit, value) in &params {
        text.push_str(format!("  {name:<5} = {} {unit}", short(*value)).trim_end());
        text.push('\n');
    }
    text.push('\n');
    let widest = items.iter().map(|item| item.written.chars().count()).max().unwrap_or(0);
    for Item { datum, written, value, reading, .. } in items {
        let value = match reading {
            Reading::AsWritten | Reading::Bare => value.clone(),
            Reading::Angle => format!("{value} (angle: tan δ = {})", short(datum.value)),
            Reading::Modulus => format!("{value} ({} N/m)", short(datum.value)),
        };
        let reached = format!("{} {}", short(shown.predict(datum)), datum.quantity.unit());
        text.push_str(&format!("  {written:<widest$}  {value} wanted, {} reached\n", reached.trim_end()));
    }
    let data: Vec<Datum> = items.iter().map(|item| item.datum).collect();
    let deviation = shown.deviation(&data);
    if deviation > SHOWN {
        text.push_str(&format!("  largest deviation {} %\n", rough(100.0 * deviation)));
    }
    text.push('\n');
    text.push_str(&page::found(&row.name, &params));
    text
}

fn json(row: &Entry, found: &Identified, items: &[Item]) -> String {
    let params: Map<String, Value> =
        row.params.iter().map(|param| (param.name.to_string(), found.parameter(&param.name).into())).collect();
    let check: Vec<Value> = items
        .iter()
        .map(|Item { datum, .. }| {
            json!({
                "quantity": datum.quantity.name(), "unit": datum.quantity.unit(), "omega": datum.omega,
                "wanted": datum.value, "reached": found.predict(datum),
            })
        })
        .collect();
    let data: Vec<Datum> = items.iter().map(|item| item.datum).collect();
    let value = json!({ "law": row.name, "parameters": params, "deviation": found.deviation(&data), "check": check });
    format!("{value:#}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words of the grammar and what may be written in their place.
    const WORDS: [&str; 24] = [
        "tan_delta = 0.3",
        "stiffness = 3 kN/m",
        "storage=",
        "loss: 2",
        "damping = 4 N*s/m",
        " at 3 Hz",
        " at 50 rad/s",
        " at ",
        ",",
        ", ",
        "; ",
        "=",
        "0",
        "-1",
        "1e400",
        "kN/m",
        "rest",
        "µ",
        "\u{0}",
        "(",
        "tan_delta = 30 deg",
        "E″ = 2 MPa",
        "area = 4 cm^2",
        "length: 10 mm",
    ];

    #[test]
    fn no_text_breaks_the_reader() {
        let catalog = Catalog::standard();
        let (mut state, mut read) = (1_u64, 0);
        for _ in 0..30_000 {
            let mut data = String::new();
            for _ in 0..state >> 33 & 15 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                data.push_str(WORDS[(state >> 33) as usize % WORDS.len()]);
            }
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            match text(&catalog, &data, None, Sample::default(), false) {
                Ok(page) => {
                    read += 1;
                    assert!(page.contains("[[element]]") && !page.contains("NaN"), "{data}: {page}");
                }
                Err(Refused { at: Some(at), .. }) => assert!(data.get(at.clone()).is_some(), "{data:?} {at:?}"),
                Err(Refused { message, .. }) => assert!(!message.is_empty()),
            }
        }
        assert!(read > 200, "{read}");
    }
}
