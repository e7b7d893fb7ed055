//! Frequency, storage, loss and temperature from a CSV file.

use super::columns::{self, Column, at, broken, number, parts, without_unit};
use super::sample::Sample;
use super::{Refused, names};
use springpot::law::master::Row;
use springpot_scenario::csv::{CsvProblem, CsvRow, MAX_ROWS};
use springpot_scenario::units::Unit;
use std::f64::consts::TAU;
use std::path::Path;

/// A measurement at several temperatures.
pub(crate) struct Warm {
    /// In Hz, Pa or N/m, K.
    pub(crate) rows: Vec<Row>,
    /// The line of each row, from 1.
    pub(crate) lines: Vec<u64>,
    /// Rows with an empty cell.
    pub(crate) skipped: usize,
    /// Whether storage and loss are moduli, Pa.
    pub(crate) is_modulus: bool,
}

/// The columns of a table.
struct Columns {
    omega: Column,
    storage: Column,
    loss: Column,
    temperature: usize,
    unit: Unit,
}

/// Reads the file. A second row of units, as some programs write it, is read as those of the columns.
pub(crate) fn read(file: &Path) -> Result<Warm, Refused> {
    let mut cells = columns::open(file)?;
    let mut headers = cells.headers().to_vec();
    let header_line = cells.header_line();
    let mut warm = Warm { rows: Vec::new(), lines: Vec::new(), skipped: 0, is_modulus: false };
    let mut found: Option<Columns> = None;
    while let Some(row) = cells.next_row().map_err(|problem| broken(file, &problem))? {
        if warm.rows.len() as u64 >= MAX_ROWS {
            return Err(broken(file, &CsvProblem::TooLarge { limit: MAX_ROWS, what: "rows" }));
        }
        if found.is_none() {
            let units = units(&row, headers.len());
            if let Some(units) = &units {
                headers = headers.iter().zip(units).map(|(name, unit)| named(name, unit)).collect();
            }
            let columns = Columns::of(&headers).map_err(|refused| Refused {
                message: columns::place(file, Some(header_line), &refused.message),
                ..refused
            })?;
            warm.is_modulus = columns.storage.is_modulus;
            found = Some(columns);
            if units.is_some() {
                continue;
            }
        }
        let Some(columns) = &found else { continue };
        if columns.is_missing(&row) {
            warm.skipped += 1;
            continue;
        }
        let read =
            |column: &Column| number(&row, column).map_err(|(message, help)| at(file, Some(row.line()), message, help));
        let omega = read(&columns.omega)?;
        let [storage, loss] = parts([&columns.storage, &columns.loss], [read(&columns.storage)?, read(&columns.loss)?]);
        let written = row.number(columns.temperature).map_err(|problem| broken(file, &problem))?;
        warm.rows.push(Row { frequency: omega / TAU, storage, loss, temperature: columns.unit.to_si(written) });
        warm.lines.push(row.line());
    }
    if found.is_none() {
        Columns::of(&headers)?;
    }
    Ok(warm)
}

impl Columns {
    fn of(headers: &[String]) -> Result<Self, Refused> {
        let [omega, storage, loss] = columns::columns(headers, &Sample::IMPLIED)?;
        if loss.phase.is_none() && storage.is_modulus != loss.is_modulus {
            let message = "storage and loss are not of one kind: one is in Pa, the other in N/m";
            return Err(Refused::new(message, "give both units, such as E' [MPa], E'' [MPa]".to_owned()));
        }
        let is_warmth =
            |header: &&String| matches!(without_unit(header), "T") || names::is_temperature(without_unit(header));
        let mut warmths = headers.iter().enumerate().filter(|(_, header)| is_warmth(header));
        let (temperature, header) = match (warmths.next(), warmths.next()) {
            (Some(one), None) => one,
            (Some((_, one)), Some((_, other))) => {
                let message = format!("columns {one:?} and {other:?} are the same quantity");
                return Err(Refused::new(message, "rename the one that is not meant".to_owned()));
            }
            _ => {
                let message = format!("no column is the temperature; the columns are {}", headers.join(", "));
                return Err(Refused::new(message, "name it T [degC], or T where it is in K".to_owned()));
            }
        };
        let written = header[without_unit(header).len()..].trim_matches([' ', '[', ']', '(', ')', ',']);
        let meant = match written {
            "" => "K",
            "C" | "°C" | "ºC" | "℃" | "Celsius" | "celsius" => "degC",
            "F" | "°F" => "degF",
            other => other,
        };
        let wrong = || {
            let message = format!("column {header:?}: {written:?} is no unit of a temperature");
            Refused::new(message, "write K, degC or degF there".to_owned())
        };
        let unit = Unit::parse(meant, &|_| None).map_err(|_| wrong())?;
        let kelvin = Unit::parse("K", &|_| None).map_err(|_| wrong())?;
        if unit.dimension() != kelvin.dimension() {
            return Err(wrong());
        }
        Ok(Self { omega, storage, loss, temperature, unit })
    }

    /// Whether a cell is empty, or says so.
    fn is_missing(&self, row: &CsvRow<'_>) -> bool {
        let used = [self.omega.index, self.storage.index, self.loss.index, self.temperature];
        used.into_iter().any(|index| row.text(index).is_ok_and(|text| is_nothing(text.trim())))
    }
}

fn is_nothing(text: &str) -> bool {
    text.is_empty() || ["nan", "na", "n/a", "null", "-", "--"].iter().any(|word| text.eq_ignore_ascii_case(word))
}

/// The cells of a row that holds no number and some text: units.
fn units(row: &CsvRow<'_>, count: usize) -> Option<Vec<String>> {
    let texts: Vec<String> = (0..count).map(|index| row.text(index).unwrap_or("").trim().to_owned()).collect();
    let is_number = |text: &String| row.cells().count() == 0 || text.replace(',', ".").parse::<f64>().is_ok();
    let is_any = texts.iter().any(|text| !is_nothing(text));
    (is_any && !texts.iter().any(is_number)).then_some(texts)
}

/// A column with the unit that stands below its name.
fn named(name: &str, unit: &str) -> String {
    if is_nothing(unit) || name.contains(['[', '(']) { name.to_owned() } else { format!("{name} [{unit}]") }
}
