//! The answer of a column to sines of a torque, an input or a prescribed joint.

use super::asked::Asked;
use super::{Problem, Stopped, Told};
use crate::arguments::ModesOptions;
use crate::grid::{Grid, Set};
use crate::{frequency, terminal};
use serde_json::Value;
use springpot::actuation::Drive;
use springpot::linear::{Excitation, NoResponse};
use springpot::observe::Quantity;
use springpot::system::Motion;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_run::numbers::four;
use springpot_scenario::suggest;
use std::f64::consts::TAU;

/// The answer at one frequency.
struct Row {
    hertz: f64,
    re: f64,
    im: f64,
    /// Continuous over the rows, deg.
    phase: f64,
}

impl Row {
    fn gain(&self) -> f64 {
        self.re.hypot(self.im)
    }
}

/// Something with a name and a unit.
struct Named<T> {
    name: String,
    unit: String,
    what: T,
}

pub(super) fn told(asked: &Asked, options: &ModesOptions, input: &str, column: &str) -> Result<Told, Stopped> {
    let input = find_input(asked, input)?;
    let column = find_column(asked, column)?;
    let band = frequency::band(&options.from, &options.to, options.points)?;
    let rows = rows(asked, &input, &column, &band)?;
    let unit = match (&*column.unit, &*input.unit) {
        (column, "") => column.to_owned(),
        ("", input) => format!("1/({input})"),
        (column, input) => format!("{column} per {input}"),
    };
    Ok(Told {
        page: page(asked, &input.name, &column.name, &unit, &rows),
        csv: csv(&unit, &rows),
        json: json(asked, &input.name, &column.name, &unit, &rows),
        plot: plot(&input.name, &column.name, &unit, &rows),
    })
}

/// All that can be moved by a sine.
fn inputs(asked: &Asked) -> Vec<Named<Excitation>> {
    let (system, free) = (&asked.system, &asked.linear.free);
    let model = &system.model;
    let mut all = Vec::new();
    let labels = model.v_labels();
    for &k in free {
        let unit = labels[k].dimension.units().force.to_owned();
        all.push(Named { name: format!("tau.{}", labels[k].name), unit, what: Excitation::Torque(k) });
    }
    if let Motion::Forward(forward) = &system.motion {
        for (j, drive) in model.own_joints().zip(&forward.drives) {
            let rates = model.v_range(j);
            if matches!(drive, Drive::Prescribed(_)) && rates.len() == 1 {
                let label = &labels[rates.start];
                let unit = label.dimension.units().coordinate.to_owned();
                let what = Excitation::Motion(rates.start);
                all.push(Named { name: format!("q.{}", label.name), unit, what });
            }
        }
    }
    for (e, element) in system.elements.iter().enumerate() {
        for (i, input) in element.entry.inputs.iter().enumerate() {
            let name = format!("{}.{}", element.name, input.name);
            all.push(Named { name, unit: input.unit.to_string(), what: Excitation::Input(e, i) });
        }
    }
    all
}

fn find_input(asked: &Asked, name: &str) -> Result<Named<Excitation>, Problem> {
    let mut all = inputs(asked);
    match all.iter().position(|input| input.name == name) {
        Some(k) => Ok(all.swap_remove(k)),
        None => {
            let help = suggest(name, all.iter().map(|input| &*input.name));
            let joints = asked.system.model.joint_names();
            let message = match name.strip_prefix("q.").or_else(|| name.strip_prefix("tau.")) {
                Some(joint) if joints.iter().any(|other| other == joint) && name.starts_with("q.") => {
                    format!("--frequency-response {name}: no signal of `prescribed` moves this joint")
                }
                Some(joint) if joints.iter().any(|other| other == joint) => {
                    format!("--frequency-response {name}: forces do not move this joint")
                }
                _ => format!("--frequency-response {name}: there is no such input"),
            };
            Err((message, help))
        }
    }
}

fn find_column(asked: &Asked, name: &str) -> Result<Named<Quantity>, Problem> {
    let observables = asked.system.observables().with_leaves();
    let columns = observables.columns();
    let answers = |quantity: Quantity| {
        let first = Excitation::Torque(usize::MAX);
        asked.linear.frequency_response(first, quantity, 1.0)
    };
    let Some(k) = columns.iter().position(|column| column.name == name) else {
        let known =
            observables.quantities().into_iter().zip(&columns).filter(|(quantity, _)| answers(*quantity).is_ok());
        let help = suggest(name, known.map(|(_, column)| &*column.name));
        return Err((format!("--frequency-response: there is no column {name:?}"), help));
    };
    let quantity = observables.quantities()[k];
    match answers(quantity) {
        Ok(_) => Ok(Named { name: name.to_owned(), unit: columns[k].unit.clone(), what: quantity }),
        Err(why @ (NoResponse::Energy | NoResponse::Told | NoResponse::NotLinear | NoResponse::None)) => {
            let help = "take a coordinate, a velocity, a torque, something of an element or the gripper".to_owned();
            Err((format!("--frequency-response {name}: {why}"), help))
        }
    }
}

fn rows(asked: &Asked, input: &Named<Excitation>, column: &Named<Quantity>, band: &[f64]) -> Result<Vec<Row>, Problem> {
    let mut rows: Vec<Row> = Vec::with_capacity(band.len());
    for &hertz in band {
        let answer = asked.linear.frequency_response(input.what, column.what, TAU * hertz);
        let answer = answer.map_err(|why| (format!("{}: {why}", column.name), "take another column".to_owned()))?;
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

fn csv(unit: &str, rows: &[Row]) -> String {
    let mut text = format!("frequency [Hz],gain [{unit}],phase [deg],real [{unit}],imaginary [{unit}]\n");
    for row in rows {
        text.push_str(&format!("{},{},{},{},{}\n", row.hertz, row.gain(), row.phase, row.re, row.im));
    }
    text
}

fn json(asked: &Asked, input: &str, column: &str, unit: &str, rows: &[Row]) -> Value {
    let all = |of: fn(&Row) -> f64| -> Value { rows.iter().map(of).collect::<Vec<_>>().into() };
    let mut value = asked.json();
    value["input"] = input.into();
    value["column"] = column.into();
    value["unit"] = unit.into();
    value["frequency"] = all(|row| row.hertz);
    value["gain"] = all(Row::gain);
    value["phase"] = all(|row| row.phase);
    value["real"] = all(|row| row.re);
    value["imaginary"] = all(|row| row.im);
    value
}

/// Gain and phase over the frequency.
fn plot(input: &str, column: &str, unit: &str, rows: &[Row]) -> Plot {
    let curve = |of: &dyn Fn(&Row) -> f64| Curve {
        x: rows.iter().map(|row| row.hertz).collect(),
        y: rows.iter().map(of).collect(),
        ..Curve::default()
    };
    let unit = unit.replace('*', "·");
    let panel = |label: String, scale: Scale, of: &dyn Fn(&Row) -> f64| Panel {
        y: Some(Axis { label, scale, ..Axis::default() }),
        curves: vec![curve(of)],
        ..Panel::default()
    };
    Plot {
        title: Some(format!("{column} under sines of {input}")),
        x: Axis { label: "frequency, Hz".to_owned(), scale: Scale::Log, ..Axis::default() },
        columns: Some(1),
        panels: vec![
            panel(format!("gain, {unit}"), Scale::Log, &Row::gain),
            panel("phase, deg".to_owned(), Scale::Linear, &|row| row.phase),
        ],
        ..Plot::default()
    }
}
