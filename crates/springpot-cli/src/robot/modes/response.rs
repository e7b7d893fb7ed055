//! The answer of a column to sines of a torque, an input or a prescribed joint.

use super::asked::Asked;
use super::{Problem, Stopped, Told};
use crate::arguments::ModesOptions;
use crate::grid::{Grid, Set};
use crate::{frequency, terminal};
use num_complex::Complex64;
use serde_json::Value;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_run::linear;
use springpot_run::numbers::four;
use std::f64::consts::TAU;

/// The answer at one frequency.
pub(super) struct Row {
    pub(super) hertz: f64,
    re: f64,
    im: f64,
    /// Continuous over the rows, deg.
    pub(super) phase: f64,
}

impl Row {
    fn gain(&self) -> f64 {
        self.re.hypot(self.im)
    }
}

pub(super) fn told(asked: &Asked, options: &ModesOptions, input: &str, column: &str) -> Result<Told, Stopped> {
    let input = linear::input(&asked.about, "--frequency-response", input)?;
    let column = linear::column(&asked.about, "--frequency-response", column)?;
    let band = frequency::band(&options.from, &options.to, options.points)?;
    let rows = rows(&band, |omega| {
        let answer = asked.about.linear.frequency_response(input.what, column.what, omega);
        answer.map_err(|why| (format!("{}: {why}", column.name), "take another column".to_owned()))
    })?;
    let unit = match (&*column.unit, &*input.unit) {
        (column, "") => column.to_owned(),
        ("", input) => format!("1/({input})"),
        (column, input) => format!("{column} per {input}"),
    };
    Ok(Told {
        page: page(asked, &input.name, &column.name, &unit, &rows),
        csv: csv(&unit, &rows),
        json: json(asked, &input.name, &column.name, &unit, &rows),
        plot: bode(format!("{} under sines of {}", column.name, input.name), &unit, &rows, options.decibel),
        beside: None,
    })
}

/// The answers over a band, Hz.
pub(super) fn rows(band: &[f64], answer: impl Fn(f64) -> Result<Complex64, Problem>) -> Result<Vec<Row>, Problem> {
    let mut rows: Vec<Row> = Vec::with_capacity(band.len());
    for &hertz in band {
        let answer = answer(TAU * hertz)?;
        let own = answer.arg().to_degrees();
        let phase = rows.last().map_or(own, |before| own + 360.0 * ((before.phase - own) / 360.0).round());
        rows.push(Row { hertz, re: answer.re, im: answer.im, phase });
    }
    Ok(rows)
}

fn page(asked: &Asked, input: &str, column: &str, unit: &str, rows: &[Row]) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let mut grid = Grid::new([
        ("f, Hz".to_owned(), Set::Number),
        (format!("gain, {unit}"), Set::Number),
        ("phase, deg".to_owned(), Set::Number),
    ]);
    let (printed, left_out) = frequency::printed(rows.len());
    for k in printed {
        let row = &rows[k];
        grid.row([row.hertz, row.gain(), row.phase].map(four).to_vec());
    }
    let what = format!("{column} under a sine of {input}, small and steady, about {}", asked.place());
    let mut text = terminal::hanging("", &what, width);
    text.push('\n');
    text.push_str(&grid.text(terminal::stdout_width()));
    text.push_str(&left_out);
    text
}

pub(super) fn csv(unit: &str, rows: &[Row]) -> String {
    let mut text = format!("frequency [Hz],gain [{unit}],phase [deg],real [{unit}],imaginary [{unit}]\n");
    for row in rows {
        text.push_str(&format!("{},{},{},{},{}\n", row.hertz, row.gain(), row.phase, row.re, row.im));
    }
    text
}

fn json(asked: &Asked, input: &str, column: &str, unit: &str, rows: &[Row]) -> Value {
    let mut value = asked.json();
    value["input"] = input.into();
    value["column"] = column.into();
    value["unit"] = unit.into();
    add_arrays(&mut value, rows);
    value
}

/// The answers as arrays.
pub(super) fn add_arrays(value: &mut Value, rows: &[Row]) {
    let all = |of: fn(&Row) -> f64| -> Value { rows.iter().map(of).collect::<Vec<_>>().into() };
    value["frequency"] = all(|row| row.hertz);
    value["gain"] = all(Row::gain);
    value["phase"] = all(|row| row.phase);
    value["real"] = all(|row| row.re);
    value["imaginary"] = all(|row| row.im);
}

/// Gain and phase over the frequency, the gain in dB where that is asked for.
pub(super) fn bode(title: String, unit: &str, rows: &[Row], decibel: bool) -> Plot {
    let curve = |of: &dyn Fn(&Row) -> f64| Curve {
        x: rows.iter().map(|row| row.hertz).collect(),
        y: rows.iter().map(of).collect(),
        ..Curve::default()
    };
    let unit = unit.replace('*', "·");
    let level = |row: &Row| 20.0 * row.gain().log10();
    let panel = |label: String, scale: Scale, of: &dyn Fn(&Row) -> f64| Panel {
        y: Some(Axis { label, scale, ..Axis::default() }),
        curves: vec![curve(of)],
        ..Panel::default()
    };
    Plot {
        title: Some(title),
        x: Axis { label: "frequency, Hz".to_owned(), scale: Scale::Log, ..Axis::default() },
        columns: Some(1),
        panels: vec![
            match (decibel, &*unit) {
                (true, "1") => panel("gain, dB".to_owned(), Scale::Linear, &level),
                (true, unit) => panel(format!("gain, dB of {unit}"), Scale::Linear, &level),
                (false, "1") => panel("gain".to_owned(), Scale::Log, &Row::gain),
                (false, unit) => panel(format!("gain, {unit}"), Scale::Log, &Row::gain),
            },
            panel("phase, deg".to_owned(), Scale::Linear, &|row| row.phase),
        ],
        ..Plot::default()
    }
}
