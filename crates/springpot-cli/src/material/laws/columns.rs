//! Frequency, storage and loss from a CSV file.

use super::sample::{ANGLES, Sample, is_angle, tangent};
use super::{Refused, names};
use crate::{diagnostic, frequency, mistakes};
use springpot::law::datasheet::{Measured, Quantity};
use springpot_run::numbers::short;
use springpot_scenario::csv::{CsvProblem, CsvRow, CsvRows, MAX_ROWS};
use springpot_scenario::list;
use springpot_scenario::units::Unit;
use std::fs::File;
use std::path::Path;

/// A measurement as its file has it.
pub(super) struct Table {
    pub(super) rows: Vec<Measured>,
    /// The line of each row, from 1.
    pub(super) lines: Vec<u64>,
    /// The names of the columns that were read.
    pub(super) columns: [String; 3],
}

/// A column and how its numbers become SI.
pub(super) struct Column {
    pub(super) index: usize,
    header: String,
    unit: Unit,
    factor: f64,
    /// It is the tangent of the phase, as a number or as the angle.
    pub(super) phase: Option<Phase>,
    /// It is |K| beside a phase, of which storage is a part.
    pub(super) is_magnitude: bool,
    /// It is a modulus.
    pub(super) is_modulus: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    Tangent,
    Angle,
}

/// What a column of a name can be.
enum Role {
    Frequency,
    Of(Quantity, bool),
}

/// A table that cannot be read, and what would be right.
pub(super) fn broken(file: &Path, problem: &CsvProblem) -> Refused {
    let help = match problem {
        CsvProblem::NoHeader { .. } => Some(NAMES.to_owned()),
        _ => None,
    };
    at(file, problem.line(), problem.to_string(), help)
}

/// Opens a table, with `;` between its columns where it has these.
pub(super) fn open(file: &Path) -> Result<CsvRows<File>, Refused> {
    if let Some((message, help)) = mistakes::table_is_scenario(file) {
        return Err(Refused::new(message, help));
    }
    let opened = || File::open(file).map_err(|source| broken(file, &CsvProblem::Unreadable { source }));
    match CsvRows::new(opened()?) {
        // Where commas are decimal points.
        Err(CsvProblem::OtherSeparator { separator, .. }) => CsvRows::separated(opened()?, separator),
        cells => cells,
    }
    .map_err(|problem| broken(file, &problem))
}

/// Reads the file, in SI.
pub(super) fn read(file: &Path, sample: &Sample) -> Result<Table, Refused> {
    let broken = |problem: &CsvProblem| broken(file, problem);
    let mut cells = open(file)?;
    let header_line = cells.header_line();
    let [omega, storage, loss] = columns(cells.headers(), sample)
        .map_err(|refused| Refused { message: place(file, Some(header_line), &refused.message), ..refused })?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    let warmth = cells.headers().iter().position(|header| names::is_temperature(without_unit(header)));
    let mut temperatures: Vec<(f64, u64)> = Vec::new();
    while let Some(row) = cells.next_row().map_err(|problem| broken(&problem))? {
        if rows.len() as u64 >= MAX_ROWS {
            return Err(broken(&CsvProblem::TooLarge { limit: MAX_ROWS, what: "rows" }));
        }
        let read =
            |column: &Column| number(&row, column).map_err(|(message, help)| at(file, Some(row.line()), message, help));
        let frequency = read(&omega)?;
        let [real, imaginary] = parts([&storage, &loss], [read(&storage)?, read(&loss)?]);
        if let Some(warmth) = warmth {
            let number = row.number(warmth).map_err(|problem| broken(&problem))?;
            if temperatures.iter().all(|(known, _)| (known - number).abs() > SAME_TEMPERATURE) {
                temperatures.push((number, row.line()));
            }
        }
        rows.push(Measured { omega: frequency, storage: real, loss: imaginary });
        lines.push(row.line());
    }
    if let [first, second, ..] = temperatures[..] {
        let told: Vec<String> = temperatures.iter().map(|(number, _)| short(*number)).collect();
        let header = warmth.map_or("", |k| cells.headers()[k].as_str());
        let message = format!(
            "the rows were measured at several temperatures, {header:?}: {}",
            list(told.iter().map(String::as_str))
        );
        let help = format!(
            "a law is fitted at one temperature: leave the rows of one in the file (those of {} begin on line {}, of {} on line {}); `shift` of an \
             element then takes the law to other temperatures",
            told[0], first.1, told[1], second.1
        );
        return Err(at(file, Some(second.1), message, help));
    }
    if rows.is_empty() {
        lines.push(cells.line());
    }
    Ok(Table { rows, lines, columns: [omega, storage, loss].map(|column| column.header) })
}

/// Storage and loss of what stands in their columns: both, storage or the magnitude, and the tangent of the phase.
pub(super) fn parts([storage, loss]: [&Column; 2], [first, second]: [f64; 2]) -> [f64; 2] {
    let real = if storage.is_magnitude { first / second.hypot(1.0) } else { first };
    [real, if loss.phase.is_some() { real * second } else { second }]
}

/// Temperatures that differ by less are one, K.
const SAME_TEMPERATURE: f64 = 2.0;

/// The name before a unit in brackets.
pub(super) fn without_unit(header: &str) -> &str {
    header.split(['[', '(', ',']).next().unwrap_or(header).trim()
}

/// `FILE:LINE: message`.
pub(super) fn place(file: &Path, line: Option<u64>, message: &str) -> String {
    let line = line.map_or_else(String::new, |line| format!(":{line}"));
    format!("{}{line}: {message}", file.display())
}

pub(super) fn at(file: &Path, line: Option<u64>, message: impl AsRef<str>, help: impl Into<Option<String>>) -> Refused {
    Refused::new(place(file, line, message.as_ref()), help)
}

/// A cell in SI; what is wrong with it, and what would be right.
pub(super) fn number(row: &CsvRow, column: &Column) -> Result<f64, (String, Option<String>)> {
    let written = row.number(column.index).map_err(|problem| (problem.to_string(), None))?;
    let value = column.unit.to_si(written) * column.factor;
    let value = match column.phase {
        Some(Phase::Angle) => tangent(value).ok_or_else(|| {
            (format!("{} is {written}, which is no loss angle", column.header), Some(ANGLES.to_owned()))
        })?,
        _ => value,
    };
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err((
            format!("{} is {written}, but must be positive and finite", column.header),
            Some("correct the row or leave it out".to_owned()),
        )),
    }
}

/// How columns are named.
const NAMES: &str = "the columns are frequency, storage, and loss or tan_delta, with units behind the names where they are not Hz and N/m: \
                     frequency [rad/s], E' [MPa]";

/// The columns of frequency, storage and loss.
pub(super) fn columns(headers: &[String], sample: &Sample) -> Result<[Column; 3], Refused> {
    let known: Vec<(usize, Role, &str)> = headers
        .iter()
        .enumerate()
        .filter_map(|(index, header)| role(header).map(|(role, unit)| (index, role, unit)))
        .collect();
    let find = |wanted: &dyn Fn(&Role) -> bool| {
        let mut found = known.iter().filter(|(_, role, _)| wanted(role));
        match (found.next(), found.next()) {
            (Some(one), Some(other)) => Err(Refused::new(
                format!("columns {:?} and {:?} are the same quantity", headers[one.0], headers[other.0]),
                "rename the one that is not meant".to_owned(),
            )),
            (one, _) => Ok(one.map(|(index, role, unit)| (*index, role, *unit))),
        }
    };
    let missing = |what: &str| {
        let listed = headers.iter().take(20).cloned().collect::<Vec<_>>().join(", ");
        Refused::new(format!("no column is {what}; the columns are {listed}"), NAMES.to_owned())
    };
    let of = |quantity: Quantity| find(&move |role| matches!(role, Role::Of(found, _) if *found == quantity));
    let omega = find(&|role| matches!(role, Role::Frequency))?.ok_or_else(|| missing("the frequency"))?;
    let (storage, loss) = match (of(Quantity::Storage)?, of(Quantity::Loss)?, of(Quantity::LossFactor)?) {
        (Some(storage), Some(loss), _) | (Some(storage), None, Some(loss)) => (storage, loss),
        (Some(_), None, None) => return Err(missing("loss or tan_delta")),
        (None, _, phase) => match (of(Quantity::Stiffness)?, phase) {
            (Some(magnitude), Some(phase)) => (magnitude, phase),
            _ => return Err(missing("the storage")),
        },
    };
    let read = |(index, role, unit): (usize, &Role, &str)| column(index, &headers[index], role, unit, sample);
    let columns = [read(omega)?, read(storage)?, read(loss)?];
    match sample.is_given() && !columns.iter().any(|column| column.is_modulus) {
        true => Err(Refused::new(super::NO_MODULUS, super::MODULI.to_owned())),
        false => Ok(columns),
    }
}

/// What a column is, and its unit: `storage`, `E' [MPa]`, `frequency (rad/s)`.
fn role(header: &str) -> Option<(Role, &str)> {
    let of = |name: &str| match names::quantity(name) {
        _ if names::is_frequency(name) => Some(Role::Frequency),
        found => names::column(name).or(found).map(|(quantity, is_modulus)| Role::Of(quantity, is_modulus)),
    };
    let split = |open: char, close: char| header.trim().strip_suffix(close)?.rsplit_once(open);
    let (name, unit) = match of(header) {
        Some(role) => return Some((role, "")),
        None => split('[', ']').or_else(|| split('(', ')'))?,
    };
    of(name).map(|role| (role, unit.trim()))
}

fn column(index: usize, header: &str, role: &Role, unit: &str, sample: &Sample) -> Result<Column, Refused> {
    let parsed = |unit: &str| {
        Unit::parse(unit, &|_| None).map_err(|error| Refused::new(format!("column {header:?}: {error}"), None))
    };
    let no = |help: &str| {
        Refused::new(format!("column {header:?}: the unit {unit} does not fit"), format!("write {help} there"))
    };
    let column = |unit: Unit, factor: f64| Column {
        index,
        header: header.to_owned(),
        unit,
        factor,
        phase: None,
        is_magnitude: matches!(role, Role::Of(Quantity::Stiffness, _)),
        is_modulus: false,
    };
    let fits = |own: &Unit, wanted: &str| parsed(wanted).map(|wanted| wanted.dimension() == own.dimension());
    match role {
        Role::Frequency => {
            let unit = if unit.is_empty() && names::is_angular(header) { "rad/s" } else { unit };
            let own = parsed(if unit.is_empty() { "Hz" } else { unit })?;
            if !fits(&own, "Hz")? {
                return Err(no("Hz or rad/s"));
            }
            let factor = frequency::radians(unit).map_err(|error| {
                Refused::new(format!("column {header:?}: {error}"), "write Hz or rad/s there".to_owned())
            })?;
            Ok(column(own, factor))
        }
        Role::Of(Quantity::LossFactor, _) => {
            let own = parsed(unit)?;
            if !fits(&own, "")? {
                return Err(no("deg, rad or nothing"));
            }
            let phase = Some(if is_angle(unit) { Phase::Angle } else { Phase::Tangent });
            Ok(Column { phase, ..column(own, 1.0) })
        }
        Role::Of(_, is_modulus) => {
            if *is_modulus && unit.is_empty() {
                let help = format!("a modulus has a unit: name the column {header} [MPa]");
                diagnostic::warning(format!("column {header:?} has no unit and is read in N/m"), Some(help));
            }
            let own = parsed(if unit.is_empty() { "N/m" } else { unit })?;
            if fits(&own, "N/m")? {
                return Ok(column(own, 1.0));
            }
            if !fits(&own, "Pa")? {
                return Err(no("Pa or N/m"));
            }
            let factor = sample.stiffness_of_one().ok_or_else(|| {
                let message =
                    format!("column {header:?} is a modulus: the stiffness E·A/L takes area and length of the sample");
                Refused::new(message, "give them: --area '4 cm^2' --length '10 mm'".to_owned())
            })?;
            Ok(Column { is_modulus: true, ..column(own, factor) })
        }
    }
}
