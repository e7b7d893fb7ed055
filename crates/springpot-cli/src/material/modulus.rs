//! `springpot modulus`: an element under a steady sine of its stroke, over the frequency.

use crate::arguments::ModulusOptions;
use crate::grid::{Grid, Set};
use crate::{Ending, diagnostic, drawing, frequency, output, printed, terminal};
use serde_json::json;
use springpot::law::{Catalog, InputValue, Point};
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_run::numbers::{four, short};
use springpot_scenario::units::parse_quantity;
use springpot_scenario::{ElementPlan, ShapePlan, suggest};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// K*(ω) at one frequency.
struct Row {
    hertz: f64,
    storage: f64,
    loss: f64,
    /// Energy lost in a cycle of the amplitude, J.
    cycle: f64,
}

/// No mount is pressed so far, m.
const HUGE: f64 = 1.0;

/// What is wrong, and what would be right.
type Problem = (String, String);

pub(crate) fn modulus(options: &ModulusOptions, catalog: &Catalog) -> Ending {
    let scenario = diagnostic::scenario(&options.file, &options.overrides);
    let plan = scenario.and_then(|scenario| scenario.cases(catalog)).and_then(|cases| cases.plan(0));
    let plan = match plan {
        Ok(plan) => plan,
        Err(refused) => {
            diagnostic::refused(&refused);
            return Ending::Refused;
        }
    };
    if plan.absent.iter().any(|(_, absent)| absent.element.name == options.element) {
        let message = format!("element {:?} is not enabled, and has no modulus here", options.element);
        let help = format!("write enabled = true, or --set element.{}.enabled=true", options.element);
        diagnostic::error_with_help(message, help);
        return Ending::Refused;
    }
    let Some(element) = plan.elements.iter().find(|element| element.element.name == options.element) else {
        let names = plan.elements.iter().map(|element| &*element.element.name);
        let help = suggest(&options.element, names);
        diagnostic::error_with_help(format!("there is no element {:?}", options.element), help);
        return Ending::Refused;
    };
    match asked(options).and_then(|(band, amplitude)| Ok((rows(element, band, amplitude)?, amplitude))) {
        Ok((rows, amplitude)) => {
            warn_of_amplitude(element, amplitude, &options.amplitude);
            tell(options, element, &rows, amplitude)
        }
        Err((message, help)) => {
            diagnostic::error_with_help(message, help);
            Ending::Refused
        }
    }
}

/// The frequencies, Hz, and the amplitude of the stroke, m or rad.
fn asked(options: &ModulusOptions) -> Result<(Vec<f64>, f64), Problem> {
    let band = frequency::band(&options.from, &options.to, options.points)?;
    let text = &options.amplitude;
    let amplitude = ["m", "rad"].into_iter().find_map(|unit| parse_quantity(text, unit, &|_| None).ok());
    match amplitude.filter(|amplitude| *amplitude > 0.0 && amplitude.is_finite()) {
        Some(amplitude) => Ok((band, amplitude)),
        None => Err((format!("--amplitude {text}: not a stroke above 0"), "write '1 mm' or '1 deg'".to_owned())),
    }
}

/// Warns of strokes beyond the element's own length, and of more than a turn.
fn warn_of_amplitude(element: &ElementPlan, amplitude: f64, written: &str) {
    let length = element.element.rest.abs();
    let why = match (&element.shape, element.element.measure.is_rotation()) {
        (ShapePlan::Points(_), _) if length > 0.0 && amplitude >= length => {
            format!("its rest length is {} m: its ends would meet", short(length))
        }
        (_, true) if amplitude > TAU => format!("that is {} turns", short((amplitude / TAU * 10.0).round() / 10.0)),
        (_, false) if amplitude >= HUGE => format!("that is {} m", short(amplitude)),
        _ => return,
    };
    let help = "plain numbers are in m and rad: write '2 mm' or '2 deg'".to_owned();
    diagnostic::warning(format!("--amplitude {written} of element {:?}: {why}", element.element.name), Some(help));
}

fn rows(element: &ElementPlan, band: Vec<f64>, amplitude: f64) -> Result<Vec<Row>, Problem> {
    let element = &element.element;
    if !element.law.is_linear() {
        let message = format!("the law of element {:?} is not linear: its modulus depends on the stroke", element.name);
        return Err((message, "run it under the sine that is meant, and look at the loop".to_owned()));
    }
    let mut inputs = vec![InputValue::default(); element.inputs.len()];
    element.inputs_at(0.0, &mut inputs);
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
    let row = |hertz: f64| {
        let [storage, loss] = element.law.complex_modulus(&at, TAU * hertz);
        Row { hertz, storage, loss, cycle: PI * loss * amplitude * amplitude }
    };
    Ok(band.into_iter().map(row).collect())
}

/// Prints the rows, or writes them as the ending of the file says.
fn tell(options: &ModulusOptions, element: &ElementPlan, rows: &[Row], amplitude: f64) -> Ending {
    let Some(out) = &options.out else {
        let text = match options.json {
            true => format!("{:#}\n", json(element, rows, amplitude)),
            false => table(element, rows, amplitude),
        };
        return printed(terminal::try_print(&text));
    };
    match &*drawing::ending(out) {
        "csv" => write(out, &csv(element, rows)),
        "json" => write(out, &format!("{:#}\n", json(element, rows, amplitude))),
        ending if drawing::ENDINGS.contains(&ending) => drawing::write(out, &plot(element, rows)),
        _ => {
            let help = "write a name that ends in .csv, .json, .svg, .png or .pdf".to_owned();
            diagnostic::error_with_help(format!("--out {}: no kind of file", out.display()), help);
            Ending::Refused
        }
    }
}

fn write(out: &Path, text: &str) -> Ending {
    output::written(out, output::write(out, text.as_bytes()))
}

/// The unit of K*: N/m, or N·m/rad where the element acts on an angle.
fn unit(element: &ElementPlan) -> &'static str {
    if element.element.measure.is_rotation() { "N*m/rad" } else { "N/m" }
}

fn table(element: &ElementPlan, rows: &[Row], amplitude: f64) -> String {
    let stroke = if element.element.measure.is_rotation() { "rad" } else { "m" };
    let unit = unit(element);
    let mut grid = Grid::new([
        ("f, Hz".to_owned(), Set::Number),
        (format!("K', {unit}"), Set::Number),
        (format!("K'', {unit}"), Set::Number),
        ("tan delta".to_owned(), Set::Number),
        ("loss a cycle, J".to_owned(), Set::Number),
    ]);
    let (printed, left_out) = frequency::printed(rows.len());
    for k in printed {
        let Row { hertz, storage, loss, cycle } = &rows[k];
        grid.row([*hertz, *storage, *loss, loss / storage, *cycle].iter().map(|value| four(*value)).collect());
    }
    let mut text = format!(
        "element {} under x = {} {stroke} sin(2 pi f t), steady: K* = K' + i K''\n\n",
        element.element.name,
        short(amplitude)
    );
    text.push_str(&grid.text(terminal::stdout_width()));
    text.push_str(&left_out);
    text
}

fn csv(element: &ElementPlan, rows: &[Row]) -> String {
    let unit = unit(element);
    let mut text = format!("frequency [Hz],storage [{unit}],loss [{unit}],tan_delta,cycle [J]\n");
    for Row { hertz, storage, loss, cycle } in rows {
        text.push_str(&format!("{hertz},{storage},{loss},{},{cycle}\n", loss / storage));
    }
    text
}

fn json(element: &ElementPlan, rows: &[Row], amplitude: f64) -> serde_json::Value {
    let column = |of: fn(&Row) -> f64| rows.iter().map(of).collect::<Vec<_>>();
    json!({
        "element": element.element.name, "unit": unit(element), "amplitude": amplitude,
        "frequency": column(|row| row.hertz), "storage": column(|row| row.storage), "loss": column(|row| row.loss),
        "tan_delta": column(|row| row.loss / row.storage), "cycle": column(|row| row.cycle),
    })
}

/// Storage and loss over the frequency.
fn plot(element: &ElementPlan, rows: &[Row]) -> Plot {
    let curve = |label: &str, of: &dyn Fn(&Row) -> f64| Curve {
        label: label.to_owned(),
        x: rows.iter().map(|row| row.hertz).collect(),
        y: rows.iter().map(of).collect(),
        ..Curve::default()
    };
    let axis = |label: String| Axis { label, scale: Scale::Log, ..Axis::default() };
    Plot {
        title: Some(format!("Storage and loss of {}", element.element.name)),
        x: axis("frequency, Hz".to_owned()),
        y: axis(format!("dynamic stiffness, {}", unit(element).replace('*', "·"))),
        panels: vec![Panel {
            curves: vec![curve("storage K′", &|row| row.storage), curve("loss K″", &|row| row.loss)],
            ..Panel::default()
        }],
        ..Plot::default()
    }
}
