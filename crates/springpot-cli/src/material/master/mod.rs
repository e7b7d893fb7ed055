//! `springpot master`: records at several temperatures become one master curve.

mod figure;
mod told;

use crate::arguments::MasterOptions;
use crate::material::laws::{Found, Refused, Warm, read_warm, refused_by};
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot::law::datasheet::Measured;
use springpot::law::heat::TEMPERATURE;
use springpot::law::master::{Master, MasterError, master as shifted};
use springpot::law::{Catalog, Entry};
use springpot_run::numbers::count;
use springpot_scenario::suggest;
use springpot_scenario::units::parse_quantity;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What was found, and of what.
struct Told<'a> {
    options: &'a MasterOptions,
    table: &'a Warm,
    found: &'a Master,
    law: Option<(&'a Entry, Found)>,
    /// A/L of the part that the law is for, m.
    sample: f64,
    folder: &'a Path,
}

pub(crate) fn master(options: &MasterOptions, catalog: &Catalog) -> Ending {
    match made(options, catalog) {
        Ok(ending) => ending,
        Err(refused) => {
            refused.show("");
            Ending::Refused
        }
    }
}

fn made(options: &MasterOptions, catalog: &Catalog) -> Result<Ending, Refused> {
    let reference = reference(&options.reference)?;
    let law = options.law.as_deref().map(|name| law(name, catalog)).transpose()?;
    let table = read_warm(&options.file)?;
    if table.skipped > 0 {
        let rows = count(table.skipped, "row", "rows");
        diagnostic::warning(format!("{}: {rows} with empty cells left out", options.file.display()), None);
    }
    let sample = sample(options, &table)?;
    let found = match shifted(&table.rows, reference, options.vertical) {
        Ok(found) => found,
        Err(error) => return failed(&error, &options.file, &table),
    };
    let law = match law {
        Some(law) => {
            let rows: Vec<Measured> = found
                .rows
                .iter()
                .map(|row| Measured {
                    omega: TAU * row.frequency,
                    storage: sample * row.storage,
                    loss: sample * row.loss,
                })
                .collect();
            let fitted = Found::of(law, &rows).map_err(|error| refused_by(&error, catalog, &options.file))?;
            Some((&**law, fitted))
        }
        None => None,
    };
    let folder = options.out.clone().unwrap_or_else(|| default_folder(&options.file));
    Ok(written(&Told { options, table: &table, found: &found, law, sample, folder: &folder }))
}

/// T_ref, K.
fn reference(text: &str) -> Result<f64, Refused> {
    let right = "write '20 degC' or 293.15";
    let value = parse_quantity(text, "K", &|_| None)
        .map_err(|error| Refused::new(format!("--reference {text}: {error}"), right.to_owned()))?;
    match TEMPERATURE.contains(value) {
        true => Ok(value),
        false => Err(Refused::new(
            format!("--reference {text}: {value} K is not between 150 K and 1500 K"),
            right.to_owned(),
        )),
    }
}

fn law<'a>(name: &str, catalog: &'a Catalog) -> Result<&'a Arc<Entry>, Refused> {
    let law = catalog.get(name).ok_or_else(|| {
        let help = suggest(name, catalog.entries().iter().map(|law| &*law.name));
        Refused::new(format!("there is no law {name:?}"), help)
    })?;
    match law.has_lists() {
        true => Err(Refused::new(
            format!("the law {name:?} is not fitted from data: how many terms it has is not known"),
            "fit fractional-zener; `springpot prony` then turns its springpot into springs and dampers".to_owned(),
        )),
        false => Ok(law),
    }
}

/// A/L of the part, m; 1 where moduli stay what they are.
fn sample(options: &MasterOptions, table: &Warm) -> Result<f64, Refused> {
    let size = |name: &str, text: &Option<String>, unit: &str| match text {
        None => Ok(None),
        Some(text) => match parse_quantity(text, unit, &|_| None) {
            Ok(value) if value > 0.0 && value.is_finite() => Ok(Some(value)),
            Ok(_) => Err(Refused::new(format!("--{name} {text}: not a positive number"), None)),
            Err(error) => Err(Refused::new(format!("--{name} {text}: {error}"), None)),
        },
    };
    match (size("area", &options.area, "m^2")?, size("length", &options.length, "m")?) {
        (None, None) => Ok(1.0),
        _ if !table.is_modulus => Err(Refused::new("area and length have no use: nothing is in Pa", None)),
        (Some(area), Some(length)) => Ok(area / length),
        _ => Err(Refused::new("a part has an area and a length: give both", None)),
    }
}

/// The message with its line, and what would be right; curves that have nothing in common are no mistake of the table.
fn failed(error: &MasterError, file: &Path, table: &Warm) -> Result<Ending, Refused> {
    let message = format!("{}: {error}", file.display());
    let help = match error {
        MasterError::Number { row, what, .. } => {
            let line = table.lines.get(*row).map_or_else(String::new, |line| format!(":{line}"));
            let help = match *what {
                "T" => "a bare T is in K: name the column T [degC]",
                _ => "correct the row or leave it out",
            };
            return Err(Refused::new(format!("{}{line}: {error}", file.display()), help.to_owned()));
        }
        MasterError::NoOverlap { .. } | MasterError::Flat { .. } => {
            let help = "measure at temperatures between them, or over more frequencies; or leave one of them out";
            diagnostic::error_with_help(message, help.to_owned());
            return Ok(Ending::Failed);
        }
        MasterError::NoRows => None,
        MasterError::OneTemperature(_) => Some("`springpot laws --from` fits a law at one temperature"),
        MasterError::TooFewRows { .. } => Some("leave these rows out, or measure there at more frequencies"),
        MasterError::Reference { .. } => Some("take one of the temperatures that were measured, or one between"),
    };
    Err(Refused::new(message, help.map(str::to_owned)))
}

fn default_folder(file: &Path) -> PathBuf {
    let stem = file.file_stem().map_or_else(|| "master".into(), |stem| stem.to_os_string());
    Path::new("results").join(stem)
}

/// Writes the files, then prints.
fn written(told: &Told<'_>) -> Ending {
    if let Err(error) = std::fs::create_dir_all(told.folder) {
        return output::written(told.folder, Err(error));
    }
    for (name, text) in [("shifts.csv", told.shifts()), ("master.csv", told.curve()), ("master.json", told.json())] {
        let file = told.folder.join(name);
        match output::written(&file, output::write(&file, text.as_bytes())) {
            Ending::Done => {}
            ending => return ending,
        }
    }
    for ending in figure::written(told) {
        match ending {
            Ending::Done => {}
            ending => return ending,
        }
    }
    printed(terminal::try_print(&if told.options.json { told.json() } else { told.page() }))
}
