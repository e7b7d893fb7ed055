//! A law from a measurement: storage and loss over frequency.

use super::columns::{self, Table};
use super::sample::Sample;
use super::{Refused, figure, page};
use crate::arguments::LawsOptions;
use crate::numbers::{count, rough, short};
use crate::{Ending, terminal};
use serde_json::{Map, Value, json};
use springpot::law::datasheet::{FitError, Fitted, Model, fit};
use springpot::law::{Catalog, Entry};
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
    let found = fit(law, &table.rows).map_err(|error| refused(&error, catalog, file, &table))?;
    match figure::write(&drawing, law, &found, &table.rows) {
        Ending::Done => {}
        ending => return Ok((String::new(), Some(ending))),
    }
    let told =
        if options.json { json(law, &found, &table, &drawing) } else { page(law, &found, &table, file, &drawing) };
    Ok((told, None))
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

/// The message with its line, and what would be right.
fn refused(error: &FitError, catalog: &Catalog, file: &Path, table: &Table) -> Refused {
    let line = |row: usize| table.lines.get(row).copied();
    let last = table.lines.last().copied();
    let (line, help) = match error {
        FitError::OtherLaw { .. } => {
            return Refused::new(error.to_string(), format!("choose one of {}", super::determined(catalog)));
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

fn page(law: &Entry, found: &Fitted, table: &Table, file: &Path, drawing: &Path) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let value = |name: &str| found.law.parameter(name).unwrap_or(f64::NAN);
    let params: Vec<_> = law.params.iter().map(|param| (&*param.name, &*param.unit, value(&param.name))).collect();
    let mut text = format!("{}   {}\n\n", law.name, law.equation);
    for (name, unit, value) in &params {
        let spread = match found.spread(name) {
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

fn json(law: &Entry, found: &Fitted, table: &Table, drawing: &Path) -> String {
    let each = |of: &dyn Fn(&str) -> Option<f64>| -> Map<String, Value> {
        law.params.iter().map(|param| (param.name.to_string(), of(&param.name).into())).collect()
    };
    let value = json!({
        "law": law.name,
        "parameters": each(&|name| found.law.parameter(name)),
        "spread": each(&|name| found.spread(name)),
        "rows": table.rows.len(),
        "columns": table.columns,
        "rms": found.rms,
        "deviation": found.largest,
        "line": table.lines[found.farthest],
        "figure": drawing.display().to_string(),
    });
    format!("{value:#}\n")
}
