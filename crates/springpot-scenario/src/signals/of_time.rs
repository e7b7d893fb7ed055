//! Signals of a scenario: numbers, quantities, expressions, columns of CSV files.

use crate::csv::{CsvProblem, Dialect};
use crate::keys::SIGNAL;
use crate::reader::files::CsvSamples;
use crate::reader::{Field, Read, Refused, Table};
use crate::signals::plan::SignalPlan;
use crate::text::document::{Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::{RefusalKind, Remark};
use crate::units::{self, Unit};
use springpot::law::Range;
use springpot::signal::{Expression, Signal};

/// Times at which a signal is looked at before the run, besides 0 and the end.
const PROBES: usize = 31;
const NO_EXPONENTS: &dyn Fn(&str) -> Option<f64> = &|_| None;

/// What a signal's place asks of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted<'u> {
    /// Unit of its values.
    pub(crate) unit: &'u str,
    /// Admissible values, SI.
    pub(crate) range: Range,
    /// Whether samples are joined by a twice differentiable spline (motions) or by straight lines (inputs).
    pub(crate) smooth: bool,
    /// Duration of the run, s, where it is known.
    pub(crate) end: Option<f64>,
}

/// Reads the signal in `field`.
pub(crate) fn read(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let plan = match &field.node.value {
        Value::Number { .. } => constant(field, wanted)?,
        Value::Text(text) if text.trim().parse::<f64>().is_ok() || reads_as_quantity(text) => constant(field, wanted)?,
        Value::Text(text) => SignalPlan {
            signal: Signal::expression(expression(field, text)?),
            constant: None,
            written: text.clone(),
            place: field.node.place.clone(),
            feedback: None,
        },
        Value::Table(_) => table(field, wanted)?,
        _ => return Err(field.wrong_type("a number, a quantity, an expression of t or a table")),
    };
    probe(field, wanted, &plan)?;
    Ok(plan)
}

/// Whether a text is a number with something behind it that could be a unit; a condition, `0 if t < 1 else 20`, is none.
fn reads_as_quantity(text: &str) -> bool {
    let is_condition = |unit: &str| unit.contains(['<', '>', '?']) || unit.starts_with("if ") || unit.contains(" if ");
    units::split_quantity(text).is_some_and(|(_, unit)| !is_condition(unit))
}

fn constant(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let value = field.number(wanted.unit)?;
    Ok(SignalPlan {
        signal: Signal::constant(value),
        constant: Some(value),
        written: field.node.label(),
        place: field.node.place.clone(),
        feedback: None,
    })
}

fn expression(field: &Field<'_>, text: &str) -> Read<Expression> {
    Expression::parse_with(text, &field.ctx.constants()).map_err(|error| {
        let place = field.node.place_in_text(error.span());
        field.ctx.refuse(
            place
                .refuse(RefusalKind::BadQuantity, format!("{field}: {error}"))
                .help("write a number, a quantity such as \"25 degC\", or an expression of t such as \"0.1*sin(8*t)\""),
        )
    })
}

fn table(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let table = field.table(&SIGNAL)?;
    if let Some(field) = table.get("sample") {
        let message = "belongs to feedback: torques and inputs that follow from the state";
        return Err(field.refuse(RefusalKind::UnknownKey, message, None));
    }
    let signal = match (table.get("expression"), table.get("csv")) {
        (Some(text), None) => {
            let of_csv = ["column", "time", "time_unit", "separator", "outside"];
            if let Some(field) = of_csv.into_iter().find_map(|key| table.get(key)) {
                return Err(field.refuse(RefusalKind::UnknownKey, "belongs to `csv`, not to `expression`", None));
            }
            Signal::expression(expression(&text, text.text()?)?)
        }
        (None, Some(csv)) => {
            let samples = csv_table(&table, &csv, wanted.end)?;
            let column = table.require_with("column", "column = \"NAME\": the column of the CSV file")?;
            samples_signal(&column, &samples, column.text()?, wanted.smooth)?
        }
        (Some(_), Some(csv)) => {
            return Err(csv.refuse(RefusalKind::Rule, "stands beside `expression`: a signal is one of them", None));
        }
        (None, None) => {
            let right = "{ expression = \"…\", unit = \"…\" } or { csv = \"FILE\", column = \"…\", unit = \"…\" }";
            return Err(table.missing("expression", right));
        }
    };
    let signal = match table.get("unit") {
        Some(unit) => in_unit(&unit, signal, wanted.unit)?,
        None => signal,
    };
    let written = field.node.place.text().to_owned();
    Ok(SignalPlan { signal, constant: None, written, place: field.node.place.clone(), feedback: None })
}

/// The signal converted from the unit in `field` to SI.
pub(crate) fn in_unit(field: &Field<'_>, signal: Signal, expected: &str) -> Read<Signal> {
    let text = field.text()?;
    let unit = Unit::parse(text, NO_EXPONENTS).map_err(|error| {
        let place = field.node.place_in_text(error.span());
        let refusal = place.refuse(RefusalKind::BadQuantity, format!("{field}: {error}"));
        field.ctx.refuse(refusal.help(unit_name_help(expected)))
    })?;
    let fits =
        Unit::parse(expected, NO_EXPONENTS).is_ok_and(|expected| unit.dimension().agrees_with(&expected.dimension()));
    if !fits {
        let message = format!("is {:?}, which has another dimension than {}", shorten(text), named(expected));
        return Err(field.refuse(RefusalKind::BadQuantity, message, Some(unit_name_help(expected))));
    }
    Ok(Signal::scaled(signal, unit.scale(), unit.shift()))
}

fn named(unit: &str) -> &str {
    if unit.is_empty() { "a pure number" } else { unit }
}

fn unit_name_help(unit: &str) -> String {
    format!("write a unit of the dimension of {}", named(unit))
}

/// More than so many times the run are covered by no file whose times are in the unit that is said.
const FAR_LONGER: f64 = 50.0;

/// Reads the CSV file that `field` names, in the dialect that `table` says, and checks that it covers the run.
pub(crate) fn csv_table(table: &Table<'_>, field: &Field<'_>, end: Option<f64>) -> Read<CsvSamples> {
    let name = field.text()?;
    let path = field.ctx.folder.join(name);
    let time = table.get("time").map_or(Ok(crate::csv::TIME), |field| field.text())?;
    let separator = table.word("separator", "separator")?.chars().next().unwrap_or(',');
    let held = table.word("outside", "rule")? == "hold";
    let time_scale = match table.get("time_unit") {
        None => 1.0,
        Some(field) => time_scale(&field)?,
    };
    let dialect = Dialect { time: time.to_owned(), time_scale, separator };
    let read = field.ctx.tables.table(&path, &dialect).map_err(|error| {
        let help = match &error.problem {
            CsvProblem::OtherSeparator { separator, .. } => format!("write separator = {separator:?}"),
            CsvProblem::MissingColumn { suggestion: Some(column), name, .. } if name == time => {
                format!("write time = {column:?}")
            }
            problem => how_to_mend(problem, time),
        };
        field.refuse(RefusalKind::File, format!("cannot be read: {error}"), Some(help))
    })?;
    let (Some(&first), Some(&last)) = (read.time().first(), read.time().last()) else {
        return Err(field.refuse(RefusalKind::Missing, format!("has no rows: {:?}", shorten(name)), None));
    };
    let samples = CsvSamples { table: read, dialect, held };
    match end {
        Some(end) if !held && (first > 0.0 || last < end) => {
            let message = format!("covers t from {first} s to {last} s, but the run needs 0 s to {end} s");
            let help = "end the run earlier, bring samples for the whole of it, or write outside = \"hold\"; time_unit says the unit of its times";
            Err(field.refuse(RefusalKind::OutOfRange, message, Some(help.to_owned())))
        }
        Some(end) => {
            if last > FAR_LONGER * end {
                let message = format!("{name:?} covers {last} s, and the run ends at {end} s");
                let advice = "if its times are in milliseconds, write time_unit = \"ms\"";
                field.ctx.warn(Remark::at(&field.node.place, message).help(advice));
            }
            Ok(samples)
        }
        None => Ok(samples),
    }
}

/// What to do about a CSV file that cannot be read.
fn how_to_mend(problem: &CsvProblem, time: &str) -> String {
    match problem {
        CsvProblem::TimeNotIncreasing { line, .. } => format!(
            "sort the rows by {time} and leave out times that come twice (look at line {line}); if {time} is not the time, write time = \"NAME\""
        ),
        CsvProblem::NoHeader { .. } => format!("write the names of the columns above the numbers, such as {time},q1"),
        CsvProblem::Ragged { .. } => "give every row as many cells as the header has".to_owned(),
        CsvProblem::NotANumber { .. } | CsvProblem::NoNumber { .. } | CsvProblem::NotFinite { .. } => {
            "write a number there, with a decimal point; where decimals have commas, columns are separated by ;".to_owned()
        }
        _ => "write the path of a CSV file, relative to the scenario, with a column t in seconds, or say time and time_unit"
            .to_owned(),
    }
}

/// Seconds in the unit that `field` names.
fn time_scale(field: &Field<'_>) -> Read<f64> {
    let text = field.text()?;
    let fits = |unit: &Unit| Unit::parse("s", NO_EXPONENTS).is_ok_and(|second| unit.dimension() == second.dimension());
    match Unit::parse(text, NO_EXPONENTS) {
        Ok(unit) if fits(&unit) => Ok(unit.scale()),
        _ => {
            let message = format!("is {:?}, which is no unit of time", shorten(text));
            Err(field.refuse(RefusalKind::BadQuantity, message, Some("write s, ms, min or h".to_owned())))
        }
    }
}

/// The signal in the column `name`; refusals point at `field`.
pub(crate) fn samples_signal(field: &Field<'_>, samples: &CsvSamples, name: &str, smooth: bool) -> Read<Signal> {
    let columns = samples.table.headers().iter().map(String::as_str);
    if !columns.clone().any(|column| column == name) {
        let message = format!("is {:?}, but the CSV file has no such column", shorten(name));
        return Err(field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, columns))));
    }
    let signal = field.ctx.tables.signal(samples, name, smooth).map_err(|error| {
        let help = format!("column {:?} needs a finite number in every row", shorten(name));
        field.refuse(RefusalKind::File, format!("cannot be used: {error}"), Some(help))
    })?;
    Ok(if samples.held { signal.held() } else { signal })
}

/// Refuses a signal that leaves its range or is not finite at a time that is looked at.
fn probe(field: &Field<'_>, wanted: Wanted<'_>, plan: &SignalPlan) -> Read<()> {
    let range = wanted.range;
    if let Some(value) = plan.constant {
        return if range.contains(value) { Ok(()) } else { Err(outside(field, wanted, value, None)) };
    }
    let end = wanted.end.unwrap_or(1.0);
    for k in 0..=PROBES + 1 {
        let t = end * k as f64 / (PROBES + 1) as f64;
        let jet = plan.signal.at(t);
        let finite = jet.value.is_finite() && (!wanted.smooth || jet.first.is_finite() && jet.second.is_finite());
        if !finite {
            let what = if jet.value.is_finite() { "has a rate that is not finite" } else { "is not finite" };
            let message = format!("{what} at t = {t} s: {}", shorten(&plan.written));
            let help = "write a signal that is finite from t = 0 to the end".to_owned();
            return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
        }
        if !range.contains(jet.value) {
            return Err(outside(field, wanted, jet.value, Some(t)));
        }
    }
    Ok(())
}

fn outside(field: &Field<'_>, wanted: Wanted<'_>, value: f64, t: Option<f64>) -> Refused {
    let when = t.map(|t| format!(" at t = {t} s")).unwrap_or_default();
    let message = format!("is {value} {}{when}, {}", wanted.unit, how_outside(wanted.range));
    let right = match (&field.node.value, celsius(field.node, wanted.unit, wanted.range, value)) {
        (_, None) => keep_within(wanted),
        // What begins as a temperature is one.
        (_, Some(_)) if t.is_some_and(|t| t > 0.0) => keep_within(wanted),
        (Value::Text(text), Some(_)) if t.is_some() => {
            format!("{value} K? write {{ expression = {text:?}, unit = \"degC\" }}")
        }
        (_, Some(_)) if t.is_some() => format!("{value} K? write unit = \"degC\""),
        (_, Some(right)) => right,
    };
    field.refuse(RefusalKind::OutOfRange, message.replace("  ", " "), Some(right))
}

/// What its author may have meant by a temperature without a unit that is far too cold: degrees Celsius.
pub(crate) fn celsius(node: &Node, unit: &str, range: Range, value: f64) -> Option<String> {
    let has_unit = node.text().and_then(units::split_quantity).is_some_and(|(_, unit)| !unit.is_empty())
        || node.get("unit").is_some_and(|node| node.text() == Some("K"));
    (unit == "K" && !has_unit && range.low > 0.0 && range.contains(value + 273.15))
        .then(|| format!("{value} K? write \"{value} degC\""))
}

/// Where the values of a signal have to stay.
fn keep_within(Wanted { unit, range, .. }: Wanted<'_>) -> String {
    let where_to = match (range.low > f64::MIN, range.high < f64::MAX) {
        (true, true) => format!("between {} and {}", range.low, range.high),
        (true, false) if range.low != f64::MIN_POSITIVE => format!("at {} or above", range.low),
        (false, true) => format!("at {} or below", range.high),
        _ => interval(range),
    };
    format!("keep it {where_to} {unit}").trim_end().to_owned()
}

/// An interval in words.
pub(crate) fn interval(range: Range) -> String {
    match (range.low > f64::MIN, range.high < f64::MAX) {
        (true, true) => format!("{} … {}", range.low, range.high),
        (true, false) if range.low == f64::MIN_POSITIVE => "above 0".to_owned(),
        (true, false) => format!("{} and above", range.low),
        (false, true) => format!("{} and below", range.high),
        (false, false) => "the finite numbers".to_owned(),
    }
}

/// Says that a value is not in `range`.
pub(crate) fn how_outside(range: Range) -> String {
    match (range.low > f64::MIN, range.high < f64::MAX) {
        (true, false) if range.low == f64::MIN_POSITIVE => "not above 0".to_owned(),
        (true, false) => format!("less than {}", range.low),
        (false, true) => format!("more than {}", range.high),
        _ => format!("outside {}", interval(range)),
    }
}
