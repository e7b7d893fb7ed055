//! The eigenvalues as a page, rows, data and a figure.

use super::asked::Asked;
use super::{Stopped, Told};
use crate::grid::{Grid, Set};
use crate::{diagnostic, plain, terminal};
use springpot::linear::{Mode, Modes, ModesError};
use springpot_report::{Curve, Panel, Plot};
use springpot_run::linear::modes_json;
use springpot_run::numbers::{brief, count, short};

/// Coordinates that are printed in a line; --json has all of them.
const MOST_COORDINATES: usize = 12;
/// A part of an eigenvalue that is smaller than this share of it is rounding, and is shown as 0.
const ROUNDING: f64 = 1e-13;

pub(super) fn told(asked: &Asked) -> Result<Told, Stopped> {
    let modes = asked.about.linear.modes().map_err(|error| Stopped::Refused(problem(error)))?;
    warn_of_missing(&modes, "");
    let names = asked.about.linear.velocity_names();
    Ok(Told {
        page: page(asked, &modes, &names),
        csv: HEADER.to_owned() + &rows(&modes, &names).collect::<String>(),
        json: modes_json(&asked.about, &modes),
        plot: plot(asked, &modes),
        beside: None,
    })
}

/// Says where one may be missing, of the case of this name.
pub(super) fn warn_of_missing(modes: &Modes, case: &str) {
    if !modes.is_complete() {
        let counted = modes.counted.map_or_else(|| "cannot be counted".to_owned(), |counted| format!("are {counted}"));
        let lead = if case.is_empty() { String::new() } else { format!("{case}: ") };
        let message = format!(
            "{lead}the eigenvalues {counted} by the principle of the argument, but {} are found: one may be missing",
            modes.found
        );
        diagnostic::warning(message, None);
    }
}

pub(super) fn problem(error: ModesError) -> (String, String) {
    (error.to_string(), help(error).to_owned())
}

fn help(error: ModesError) -> &'static str {
    match error {
        ModesError::NoFree => "free a joint: leave it out of `prescribed` and `locked` of [motion]",
        ModesError::NotFinite => "look at masses, inertias and parameters",
        ModesError::NotFound => "look at parameters of very different sizes",
    }
}

fn page(asked: &Asked, modes: &Modes, names: &[String]) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let mut text = String::new();
    let mut line = |lead: &str, words: &str| text.push_str(&terminal::hanging(&format!("{lead:<8}"), words, width));
    if let Some(title) = &asked.title {
        line("title", &plain::title(title));
    }
    line("about", &asked.place());
    let coordinates = asked.coordinates();
    let shown = coordinates.iter().take(MOST_COORDINATES);
    let mut places: Vec<String> = shown
        .map(|(name, q, unit)| {
            let unit = if *unit == "1" { "" } else { unit };
            let space = if unit.is_empty() { "" } else { terminal::NO_BREAK };
            let [nb, q] = [terminal::NO_BREAK, &short(*q)];
            format!("{}{nb}={nb}{q}{space}{unit}", plain::line(name))
        })
        .collect();
    if coordinates.len() > MOST_COORDINATES {
        places.push("…".to_owned());
    }
    line("q", &places.join(", "));
    text.push('\n');
    let titles = ["f, Hz", "damped, Hz", "ratio", "tau, s", "eigenvalue, 1/s"].map(|title| (title, Set::Number));
    let mut grid = Grid::new([("mode", Set::Number)].into_iter().chain(titles).chain([("moves", Set::Name)]));
    for (k, mode) in (1..).zip(&modes.modes) {
        let ratio = mode.damping_ratio();
        let ratio = if ratio.abs() < ROUNDING { 0.0 } else { ratio };
        let tau = if ratio == 0.0 { "-".to_owned() } else { brief(mode.time_constant()) };
        let numbers = [brief(mode.frequency()), brief(mode.damped_frequency()), brief(ratio), tau, eigenvalue(mode)];
        let row = [format!("{k}")].into_iter().chain(numbers).chain([names[mode.largest].clone()]);
        grid.row(row.collect());
    }
    text.push_str(&grid.text(terminal::stdout_columns()));
    let remarks = remarks(modes);
    if !remarks.is_empty() {
        text.push('\n');
    }
    remarks.iter().for_each(|remark| text.push_str(&terminal::hanging("", remark, width)));
    text
}

/// `-0.3 ± 6.2i`
pub(super) fn eigenvalue(mode: &Mode) -> String {
    let s = mode.eigenvalue;
    let part = |x: f64| brief(if x.abs() < ROUNDING * s.norm() { 0.0 } else { x });
    if s.im == 0.0 { part(s.re) } else { format!("{} ± {}i", part(s.re), part(s.im)) }
}

fn remarks(modes: &Modes) -> Vec<String> {
    let mut remarks = Vec::new();
    for (k, mode) in (1..).zip(&modes.modes).filter(|(_, mode)| mode.is_unstable()) {
        remarks.push(format!(
            "mode {k} is unstable: it grows to e times itself in {} s",
            brief(mode.eigenvalue.re.recip())
        ));
    }
    if modes.modes.is_empty() && modes.free_motions == 0 {
        remarks.push("no eigenvalues: nothing vibrates or decays as an exponential".to_owned());
    }
    if modes.free_motions > 0 {
        let motions = count(modes.free_motions, "motion", "motions");
        remarks.push(format!("{motions} that no stiffness holds: eigenvalue 0"));
    }
    if modes.is_fractional {
        let all = if modes.is_complete() { ", all that there are by the principle of the argument" } else { "" };
        remarks.push(format!(
            "{} on the principal sheet, |arg s| < pi{all}; beside them what springpots remember decays like a power of t",
            count(modes.found, "eigenvalue", "eigenvalues")
        ));
    }
    remarks
}

/// The columns of CSV files.
pub(super) const HEADER: &str =
    "re [1/s],im [1/s],frequency [Hz],damped_frequency [Hz],damping_ratio,time_constant [s],moves\n";

/// Rows of CSV files.
pub(super) fn rows(modes: &Modes, names: &[String]) -> impl Iterator<Item = String> {
    modes.modes.iter().map(|mode| {
        let s = mode.eigenvalue;
        let (f, damped, ratio) = (mode.frequency(), mode.damped_frequency(), mode.damping_ratio());
        let tau = if s.re == 0.0 { String::new() } else { format!("{}", mode.time_constant()) };
        format!("{},{},{f},{damped},{ratio},{tau},{}\n", s.re, s.im, quoted(&names[mode.largest]))
    })
}

/// A cell of a CSV file.
pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// The eigenvalues as marks.
pub(super) fn marks(modes: &Modes) -> Curve {
    let both = modes.modes.iter().map(|mode| mode.eigenvalue).flat_map(|s| [s, s.conj()]);
    let (x, y): (Vec<f64>, Vec<f64>) = both.map(|s| (s.re, s.im)).unzip();
    // One run for each mark, so that no line joins them.
    let gaps = |values: Vec<f64>| values.into_iter().flat_map(|value| [value, f64::NAN]).collect();
    Curve { x: gaps(x), y: gaps(y), is_marked: true, ..Curve::default() }
}

/// The eigenvalues in the plane.
fn plot(asked: &Asked, modes: &Modes) -> Plot {
    Plot {
        title: asked.place().split(',').next().map(|place| format!("Eigenvalues about {place}")),
        x: "real part, 1/s".into(),
        y: "imaginary part, 1/s".into(),
        panels: vec![Panel { curves: vec![marks(modes)], ..Panel::default() }],
        ..Plot::default()
    }
}
