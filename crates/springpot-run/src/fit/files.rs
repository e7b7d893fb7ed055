//! The files of a fit, and what it tells on a terminal.

use super::figures;
use super::outcome::{Outcome, Status};
use super::record::{json, name, side};
use crate::numbers::{count, rough, short};
use crate::table::disk::Disk;
use springpot::identification::Side;
use springpot_scenario::{DataKind, Scenario};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Writes fit.json, parameters.csv, correlation.csv, residuals.csv, fitted.toml with the files that it names, and the figures into a folder;
/// remarks on the figures are returned.
///
/// # Errors
/// Those of the disk.
pub fn save(outcome: &Outcome, folder: &Path) -> io::Result<Vec<String>> {
    let (disk, drawn) = (Disk::default(), folder.join("figures"));
    disk.create_folders(&drawn)?;
    let put = |file: &str, text: String| whole(&disk, &folder.join(file), text.as_bytes());
    put("fit.json", format!("{:#}\n", json(outcome)))?;
    put("parameters.csv", parameters(outcome))?;
    put("correlation.csv", correlation(outcome))?;
    put("residuals.csv", residuals(outcome))?;
    let text = outcome.fitting.fitted(&outcome.fit.values);
    // Its files go with it, so that it can be run where it stands.
    let base = outcome.fitting.scenario().folder();
    let text = match Scenario::parse(&text, "fitted.toml", base) {
        Ok(scenario) => {
            let portable = scenario.portable();
            for (name, file) in &portable.files {
                let target = folder.join(name);
                if let Some(above) = target.parent() {
                    disk.create_folders(above)?;
                }
                if target.canonicalize().ok().as_ref() != Some(file) {
                    whole(&disk, &target, &disk.read(file)?)?;
                }
            }
            portable.text
        }
        Err(_) => text,
    };
    put("fitted.toml", text)?;
    let mut remarks = Vec::new();
    for (file, plot) in figures::all(outcome) {
        match plot.render() {
            Ok(rendered) => {
                whole(&disk, &drawn.join(format!("{file}.svg")), rendered.svg.as_bytes())?;
                whole(&disk, &drawn.join(format!("{file}.png")), &rendered.png)?;
                remarks.extend(rendered.remarks.iter().map(|remark| format!("figures/{file}: {remark}")));
            }
            Err(error) => remarks.push(format!("figures/{file} is not drawn: {error}")),
        }
    }
    Ok(remarks)
}

/// A file that is there whole or as it was.
fn whole(disk: &Disk, file: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut beside = PathBuf::from(file);
    beside.as_mut_os_string().push(".part");
    disk.create(&beside)?.write_all(bytes)?;
    disk.rename(&beside, file)
}

/// A number as files have it; nothing where it is none.
fn cell(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

fn parameters(outcome: &Outcome) -> String {
    let fit = &outcome.fit;
    let mut text = "parameter,path,value,unit,sd,low,high,start,at_bound\n".to_owned();
    for (j, own) in outcome.fitting.plan().parameters.iter().enumerate() {
        let [low, high] = outcome.intervals[j];
        let numbers = [fit.sd(j), low, high, own.sought.start[0]].map(cell);
        let _ = writeln!(
            text,
            "{},{},{},{},{},{}",
            quoted(&own.sought.name),
            quoted(&own.paths.join(" ")),
            cell(fit.values[j]),
            quoted(&own.unit),
            numbers.join(","),
            side(fit.at_bound[j]).unwrap_or_default()
        );
    }
    text
}

fn correlation(outcome: &Outcome) -> String {
    let n = outcome.fit.values.len();
    let names: Vec<String> = (0..n).map(|j| quoted(name(outcome, j))).collect();
    let mut text = format!("parameter,{}\n", names.join(","));
    for (i, name) in names.iter().enumerate() {
        let line: Vec<String> =
            (0..n).map(|j| if i == j { "1.0".to_owned() } else { cell(outcome.fit.correlation(i, j)) }).collect();
        let _ = writeln!(text, "{name},{}", line.join(","));
    }
    text
}

fn residuals(outcome: &Outcome) -> String {
    let plan = outcome.fitting.plan();
    let is_dma = |kind: DataKind| matches!(kind, DataKind::Dma { .. });
    let (dma, other) =
        (plan.data.iter().any(|data| is_dma(data.kind)), plan.data.iter().any(|data| !is_dma(data.kind)));
    let places: Vec<&str> =
        [(other, "t"), (dma, "frequency")].into_iter().filter_map(|(has, name)| has.then_some(name)).collect();
    let mut text = format!("data,row,{},column,measured,model,residual\n", places.join(","));
    for (data, score) in plan.data.iter().zip(&outcome.records) {
        for (column, own) in data.columns.iter().zip(&score.columns) {
            for (k, row) in score.rows.iter().enumerate() {
                let at = if is_dma(data.kind) { data.at[*row] / TAU } else { data.at[*row] };
                let at = places
                    .iter()
                    .map(|place| if (*place == "frequency") == is_dma(data.kind) { cell(at) } else { String::new() });
                let at: Vec<String> = at.collect();
                let numbers = [own.measured[k], own.model[k], own.residuals[k]].map(cell).join(",");
                let _ = writeln!(
                    text,
                    "{},{},{},{},{numbers}",
                    quoted(&data.name),
                    row + 1,
                    at.join(","),
                    quoted(&column.name)
                );
            }
        }
    }
    text
}

/// The fit as a table, what is not determined in words, the laws where there were several, and how well records are met.
pub fn told(outcome: &Outcome) -> String {
    let (fit, plan) = (&outcome.fit, outcome.fitting.plan());
    let mut lines: Vec<[String; 4]> = Vec::new();
    for (j, own) in plan.parameters.iter().enumerate() {
        let [low, high] = outcome.intervals[j];
        let sd = match (fit.at_bound[j], fit.sd(j)) {
            (Some(_), _) => "at its bound".to_owned(),
            (None, sd) if sd.is_finite() && !fit.unseen.contains(&j) => format!("± {}", rough(sd)),
            (None, _) => "not determined".to_owned(),
        };
        let interval = match fit.at_bound[j] {
            Some(Side::Lower) => format!("< {}", short(high)),
            Some(Side::Upper) => format!("> {}", short(low)),
            None => format!("{} … {}", short(low), short(high)),
        };
        lines.push([own.sought.name.clone(), with_unit(fit.values[j], &own.unit), sd, interval]);
    }
    let confidence = format!("{} %", short(100.0 * plan.settings.confidence));
    lines.insert(0, ["parameter".into(), "value".into(), "sd".into(), confidence]);
    let mut text = table(&lines);
    for open in &fit.undetermined {
        let _ = writeln!(text, "\n{}", open.text(|j| name(outcome, j).to_owned()));
    }
    if !outcome.laws.is_empty() {
        text.push('\n');
        let mut lines = vec![["law", "cost", "parameters", "AICc", "BIC"].map(str::to_owned)];
        for (law, cost, p, [aicc, bic]) in &outcome.laws {
            let law = if outcome.chosen.as_ref() == Some(law) { format!("{law} (chosen)") } else { law.clone() };
            lines.push([law, short(*cost), p.to_string(), short(*aicc), short(*bic)]);
        }
        text.push_str(&table(&lines));
    }
    text.push('\n');
    let mut lines = vec![["data", "column", "rows", "rms", "R²"].map(str::to_owned)];
    for (data, score) in plan.data.iter().zip(&outcome.records) {
        for (column, own) in data.columns.iter().zip(&score.columns) {
            let used = if data.is_fitted { data.name.clone() } else { format!("{} (validation)", data.name) };
            lines.push([
                used,
                column.name.clone(),
                score.rows.len().to_string(),
                with_unit_of(rough(own.rms), &column.unit),
                if own.r2.is_finite() { format!("{:.4}", own.r2) } else { "–".to_owned() },
            ]);
        }
    }
    text.push_str(&table(&lines));
    let [tried, reached] = fit.starts;
    let how = match outcome.status {
        Status::Converged => format!("{reached} of {}", count(tried, "start", "starts")),
        Status::NotConverged => "not converged: the best so far".to_owned(),
        Status::Interrupted => "interrupted: the best so far".to_owned(),
    };
    let numbers = format!(
        "cost {}, {}, {}",
        short(fit.cost),
        count(fit.rows, "number", "numbers"),
        count(fit.parameters + fit.eliminated, "unknown", "unknowns")
    );
    let _ = writeln!(text, "\n{how}; {numbers}");
    text
}

fn with_unit(value: f64, unit: &str) -> String {
    with_unit_of(short(value), unit)
}

fn with_unit_of(value: String, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { value } else { format!("{value} {unit}") }
}

/// Lines whose cells stand below one another.
fn table<const N: usize>(lines: &[[String; N]]) -> String {
    let width = |k: usize| lines.iter().map(|line| line[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let cells =
            line.iter().zip(&widths).map(|(cell, width)| format!("{cell}{}", " ".repeat(width - cell.chars().count())));
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}
