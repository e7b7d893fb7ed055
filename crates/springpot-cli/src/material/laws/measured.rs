//! A law from a measurement: storage and loss over frequency.

use super::columns::{self, Table};
use super::sample::Sample;
use super::{Refused, figure, page};
use crate::arguments::LawsOptions;
use crate::{Ending, terminal};
use serde_json::{Map, Value, json};
use springpot::law::datasheet::{FitError, Measured, Model, can_fit, fit, fit_network};
use springpot::law::{Catalog, Entry};
use springpot_run::numbers::{count, rough, short};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// The law, its parameters, an element, and how well it meets the rows; its figure is written.
pub(super) fn text(
    catalog: &Catalog,
    file: &Path,
    law: Option<&Entry>,
    sample: Sample,
    options: &LawsOptions,
) -> Result<(String, Option<Ending>), Refused> {
    let drawing = drawing(file, options)?;
    let table = columns::read(file, &sample)?;
    let law = match law {
        Some(law) => law,
        None => Model::FractionalKelvinVoigt.law(catalog).ok_or_else(|| {
            let help = format!("choose one of {}", super::determined(catalog));
            Refused::new("no law of the catalog is k·x + c·D^alpha x", help)
        })?,
    };
    if law.has_lists() {
        let message = format!("the law {:?} is not fitted from data yet: how many terms it has is not known", law.name);
        let help = "fit fractional-zener or fractional-maxwell; `springpot prony` then turns its springpot into springs and dampers";
        return Err(Refused::new(message, help.to_owned()));
    }
    let found = Found::of(law, &table.rows).map_err(|error| refused(&error, catalog, file, &table))?;
    match figure::write(&drawing, law, &*found.stiffness, &table.rows) {
        Ending::Done => {}
        ending => return Ok((String::new(), Some(ending))),
    }
    let told =
        if options.json { json(law, &found, &table, &drawing) } else { page(law, &found, &table, file, &drawing) };
    Ok((told, None))
}

/// A law fitted to rows, whatever its form.
pub(crate) struct Found {
    /// Values and spreads, in the order of the law's parameters.
    pub(crate) values: Vec<f64>,
    pub(crate) spreads: Vec<Option<f64>>,
    pub(crate) rms: f64,
    pub(crate) largest: f64,
    farthest: usize,
    pub(crate) stiffness: Box<figure::Stiffness<'static>>,
}

impl Found {
    pub(crate) fn of(law: &Entry, rows: &[Measured]) -> Result<Self, FitError> {
        if Model::of(law).is_none() && can_fit(law) {
            let found = fit_network(law, rows)?;
            let (values, spreads) = (found.values.clone(), found.spreads.clone());
            let (rms, largest, farthest) = (found.rms, found.largest, found.farthest);
            let stiffness = Box::new(move |omega| found.complex_stiffness(omega));
            return Ok(Self { values, spreads, rms, largest, farthest, stiffness });
        }
        let found = fit(law, rows)?;
        let each = || law.params.iter().map(|param| &*param.name);
        Ok(Self {
            values: each().map(|name| found.law.parameter(name).unwrap_or(f64::NAN)).collect(),
            spreads: each().map(|name| found.spread(name)).collect(),
            rms: found.rms,
            largest: found.largest,
            farthest: found.farthest,
            stiffness: Box::new(move |omega| found.law.complex_stiffness(omega)),
        })
    }
}

/// Where the figure goes: into the current folder, unless the options say where.
fn drawing(file: &Path, options: &LawsOptions) -> Result<PathBuf, Refused> {
    let Some(out) = &options.out else {
        let stem = file.file_stem().map_or_else(|| "laws".into(), |stem| stem.to_string_lossy());
        return Ok(PathBuf::from(format!("{stem}-fit.svg")));
    };
    let known = out.extension().is_some_and(|ending| ["svg", "png"].iter().any(|one| ending.eq_ignore_ascii_case(one)));
    match known {
        true => Ok(out.clone()),
        false => Err(Refused::new(
            format!("--out {} is neither .svg nor .png", out.display()),
            "write a name that ends in .svg or .png".to_owned(),
        )),
    }
}

/// Why the rows of a master curve determine no law.
pub(crate) fn refused_by(error: &FitError, catalog: &Catalog, file: &Path) -> Refused {
    refused(error, catalog, file, &Table { rows: Vec::new(), lines: Vec::new(), columns: Default::default() })
}

/// The message with its line, and what would be right.
fn refused(error: &FitError, catalog: &Catalog, file: &Path, table: &Table) -> Refused {
    let line = |row: usize| table.lines.get(row).copied();
    let last = table.lines.last().copied();
    let (line, help) = match error {
        FitError::OtherLaw { .. } => {
            let known = catalog.entries().iter().filter(|law| Model::of(law).is_some() || can_fit(law));
            let names = known.map(|law| &*law.name).collect::<Vec<_>>().join(", ");
            return Refused::new(error.to_string(), format!("choose one of {names}"));
        }
        FitError::NotPositive { row, .. } => (line(*row), "correct the row or leave it out".to_owned()),
        FitError::TooFew { needed, .. } => (last, format!("measure at {needed} frequencies or more")),
        FitError::SameFrequency { needed: 3, .. } => {
            (last, "measure at more frequencies, or name a law of two parameters, such as springpot".to_owned())
        }
        FitError::SameFrequency { .. } => (last, "measure at more frequencies".to_owned()),
        FitError::Undetermined { .. } => {
            (last, "look at units and columns, or name a law of fewer parameters".to_owned())
        }
    };
    Refused::new(columns::place(file, line, &error.to_string()), help)
}

fn page(law: &Entry, found: &Found, table: &Table, file: &Path, drawing: &Path) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let named = law.params.iter().zip(&found.values);
    let params: Vec<_> = named.map(|(param, value)| (&*param.name, &*param.unit, *value)).collect();
    let mut text = format!("{}   {}\n\n", law.name, law.equation);
    for ((name, unit, value), spread) in params.iter().zip(&found.spreads) {
        let spread = match *spread {
            Some(spread) => format!("± {} {unit}", rough(spread)),
            None => format!("{unit}, an end of its range"),
        };
        text.push_str(format!("  {name:<5} = {} {}", short(*value), spread.trim()).trim_end());
        text.push('\n');
    }
    let hertz = table.rows.iter().map(|row| row.omega / TAU);
    let [least, most] = [hertz.clone().fold(f64::INFINITY, f64::min), hertz.fold(0.0, f64::max)].map(short);
    text.push('\n');
    let rows = count(table.rows.len(), "row", "rows");
    let read = format!("{} of {}, {rows}, {least} Hz to {most} Hz", table.columns.join(", "), file.display());
    text.push_str(&terminal::hanging("  from       ", &read, width));
    let worst = format!(
        "{} % rms, {} % at most (line {}), relative to |K|",
        rough(100.0 * found.rms),
        rough(100.0 * found.largest),
        table.lines[found.farthest]
    );
    text.push_str(&terminal::hanging("  deviation  ", &worst, width));
    text.push_str(&terminal::hanging(
        "  ±          ",
        "one standard deviation, from the deviations of the rows",
        width,
    ));
    text.push_str(&terminal::hanging("  figure     ", &drawing.display().to_string(), width));
    text.push('\n');
    text.push_str(&page::found(&law.name, &params));
    text
}

fn json(law: &Entry, found: &Found, table: &Table, drawing: &Path) -> String {
    let each = |of: &dyn Fn(usize) -> Option<f64>| -> Map<String, Value> {
        law.params.iter().enumerate().map(|(k, param)| (param.name.to_string(), of(k).into())).collect()
    };
    let value = json!({
        "law": law.name,
        "parameters": each(&|k| Some(found.values[k])),
        "spread": each(&|k| found.spreads[k]),
        "rows": table.rows.len(),
        "columns": table.columns,
        "rms": found.rms,
        "deviation": found.largest,
        "line": table.lines[found.farthest],
        "figure": drawing.display().to_string(),
    });
    format!("{value:#}\n")
}
