//! `[constants]`: numbers by name, and scalars that are expressions of them.

use crate::keys::SCALAR;
use crate::reader::{Context, Field, Read, Table, all};
use crate::text::document::{Node, Value, shorten};
use crate::text::names::list;
use crate::text::refusal::RefusalKind;
use crate::units::{self, Exponents, Unit, UnitError};
use springpot::signal::Expression;
use springpot::signal::expression::is_name;

/// Most constants.
const MAX_CONSTANTS: usize = 1_000;
const RIGHT: &str = "a number, a quantity such as \"2 Hz\" or { expression = \"…\", unit = \"…\" } of constants above";

/// A constant's name and its value, SI.
pub(crate) type Constant = (String, f64);

/// Reads `[constants]` into the context, in the order of the text.
pub(crate) fn read(root: &Table<'_>) -> Read<()> {
    let Some(field) = root.get("constants") else { return Ok(()) };
    let Some(entries) = field.node.entries() else { return Err(field.wrong_type("a table of numbers by name")) };
    if entries.len() > MAX_CONSTANTS {
        let message = format!("holds {} numbers; at most {MAX_CONSTANTS} are taken", entries.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    let table = Table::of_any(field.ctx, field.node, "[constants]")?;
    let read = table.fields().map(|constant| {
        check_name(&constant)?;
        let read = value(&constant);
        // What is refused is known all the same, so that nothing else is refused for want of it.
        let (value, unit) = read.clone().unwrap_or((1.0, String::new()));
        constant.ctx.note_swept(constant.node, value, &unit);
        constant.ctx.know(constant.key, value);
        read.map(|_| ())
    });
    all(read.collect::<Vec<_>>()).map(|_| ())
}

fn check_name(field: &Field<'_>) -> Read<()> {
    let name = field.key;
    let mut characters = name.chars();
    let is_right = characters.next().is_some_and(|c| c.is_alphabetic() || c == '_')
        && characters.all(|c| c.is_alphanumeric() || c == '_');
    let (message, help) = if !is_right {
        let help = "write a letter or _, and then letters, digits and _: expressions take it so";
        (format!("`{}` is no name of a constant", shorten(name)), help)
    } else if is_name(name) {
        (format!("`{name}` cannot be a constant: every expression knows it"), "choose another name")
    } else {
        return Ok(());
    };
    Err(field.ctx.refuse(field.node.place.refuse(RefusalKind::BadName, message).help(help)))
}

/// A number in any unit, SI, and its SI unit.
fn value(field: &Field<'_>) -> Read<(f64, String)> {
    let none = |_: &str| None;
    let value = match &field.node.value {
        Value::Number { value, .. } => *value,
        Value::Text(text) => {
            let unit = units::split_quantity(text).map_or("", |(_, unit)| unit);
            units::parse_quantity(text, unit, &none).map_err(|error| misread(field, &error))?
        }
        Value::Table(_) => expression(field, None, &none)?,
        _ => return Err(field.wrong_type(RIGHT)),
    };
    if value.is_finite() {
        return Ok((value, unit_of(field.node)));
    }
    let message = format!("is {}, not a finite number", field.node.label());
    Err(field.refuse(RefusalKind::OutOfRange, message, Some(format!("write {RIGHT}"))))
}

/// The SI unit of a number, whatever unit it is written in; empty where it is none, or no number.
pub(crate) fn unit_of(node: &Node) -> String {
    let unit = match &node.value {
        Value::Text(text) => units::si_unit(text).ok(),
        Value::Table(_) => {
            let unit = node.get("unit").and_then(|unit| Unit::parse(unit.text()?, &|_| None).ok());
            unit.map(|unit| unit.si_name())
        }
        _ => None,
    };
    unit.unwrap_or_default()
}

fn misread(field: &Field<'_>, error: &UnitError) -> crate::reader::Refused {
    let place = field.node.place_in_text(error.span());
    let refusal = place.refuse(RefusalKind::BadQuantity, format!("{field}: {error}"));
    field.ctx.refuse(refusal.help(format!("write {RIGHT}")))
}

/// Whether a value is an expression of constants where a scalar is wanted.
pub(crate) fn is_expression(node: &Node) -> bool {
    node.get("expression").is_some()
}

/// `{ expression = "3/f", unit = "s" }`: a number of constants alone, SI; `expected` is the unit of its place, with the `exponents` that it
/// may name.
pub(crate) fn expression(field: &Field<'_>, expected: Option<&str>, exponents: Exponents<'_>) -> Read<f64> {
    let (value, unit_field) = written_expression(field)?;
    let Some(unit_field) = unit_field else { return Ok(value) };
    let unit_text = unit_field.text()?;
    let unit = Unit::parse(unit_text, exponents).map_err(|error| misread(&unit_field, &error))?;
    if let Some(expected) = expected {
        let fits =
            Unit::parse(expected, exponents).is_ok_and(|wanted| wanted.dimension().agrees_with(&unit.dimension()));
        if !fits {
            let message = format!("is {:?}, which has another dimension than {}", shorten(unit_text), named(expected));
            let help = format!("write a unit of the dimension of {}", named(expected));
            return Err(unit_field.refuse(RefusalKind::BadQuantity, message, Some(help)));
        }
    }
    Ok(unit.to_si(value))
}

/// The number of such an expression in its own unit, and that unit.
pub(crate) fn written_expression<'a>(field: &Field<'a>) -> Read<(f64, Option<Field<'a>>)> {
    let table = field.table(&SCALAR)?;
    let written = table.require("expression")?;
    let text = written.text()?;
    let known = field.ctx.constants();
    let parsed = Expression::parse_with(text, &known).map_err(|error| {
        let place = written.node.place_in_text(error.span());
        let refusal = place.refuse(RefusalKind::BadQuantity, format!("{written}: {error}"));
        field.ctx.refuse(refusal.help(of_constants(field.ctx)))
    })?;
    let Some(value) = parsed.is_constant() else {
        let message = "names t, and a number does not vary with time";
        return Err(written.refuse(RefusalKind::Rule, message, Some(of_constants(field.ctx))));
    };
    if !value.is_finite() {
        let message = format!("is {value}, not a finite number");
        return Err(written.refuse(RefusalKind::OutOfRange, message, Some(of_constants(field.ctx))));
    }
    Ok((value, table.get("unit")))
}

fn named(unit: &str) -> &str {
    if unit.is_empty() { "a pure number" } else { unit }
}

/// What such an expression may name.
fn of_constants(ctx: &Context<'_>) -> String {
    let known = ctx.constants();
    match known.is_empty() {
        true => "it is made of numbers, functions and constants; [constants] f = \"2 Hz\" makes one".to_owned(),
        false => format!(
            "it is made of numbers, functions and the constants {}",
            list(known.iter().map(|(name, _)| name.as_str()))
        ),
    }
}
