//! `springpot modulus`: an element under a steady sine of its stroke, over the frequency and the amplitude.

use crate::arguments::ModulusOptions;
use crate::grid::{Grid, Set};
use crate::{Ending, diagnostic, drawing, frequency, output, printed, terminal};
use serde_json::json;
use springpot::law::Catalog;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_run::modulus::{Modulus, USUAL_AMPLITUDE, moduli, units};
use springpot_run::numbers::{four, short};
use springpot_scenario::units::parse_quantity;
use springpot_scenario::{ElementPlan, ShapePlan, suggest};
use std::f64::consts::TAU;
use std::path::Path;

/// No mount is pressed so far, m.
const HUGE: f64 = 1.0;

/// What is wrong, and what would be right.
type Problem = (String, String);

/// What is asked for.
struct Asked {
    band: Vec<f64>,
    /// m, or rad.
    amplitudes: Vec<f64>,
    /// The same as they are written.
    written: Vec<String>,
    /// Whether rows say their amplitude: where it matters, or there are several.
    is_over_amplitude: bool,
}

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
    let asked = match asked(options, element) {
        Ok(asked) => asked,
        Err((message, help)) => {
            diagnostic::error_with_help(message, help);
            return Ending::Refused;
        }
    };
    for amplitude in &asked.amplitudes {
        warn_of_amplitude(element, *amplitude);
    }
    match moduli(element, &asked.band, &asked.amplitudes) {
        Ok(rows) => tell(options, element, &rows, &asked),
        Err((message, help)) => {
            diagnostic::error_with_help(message, help);
            Ending::Failed
        }
    }
}

fn asked(options: &ModulusOptions, element: &ElementPlan) -> Result<Asked, Problem> {
    let one = |text: &str| frequency::angular(text).ok().filter(|omega| *omega > 0.0);
    let band = match (one(&options.from), one(&options.to)) {
        (Some(from), Some(to)) if from == to => vec![from / TAU],
        _ => frequency::band(&options.from, &options.to, options.points)?,
    };
    let is_linear = element.element.law.is_linear();
    let (unit, examples) = match element.element.measure.is_rotation() {
        true => ("rad", ["1 deg", "0.1 deg,1 deg,5 deg"]),
        false => ("m", ["1 mm", "0.1 mm,1 mm,5 mm"]),
    };
    let Some(text) = &options.amplitude else {
        if !is_linear {
            let name = &element.element.name;
            let message = format!("the law of element {name:?} is not linear: its modulus depends on the amplitude");
            return Err((message, format!("write --amplitude '{}', or several: '{}'", examples[0], examples[1])));
        }
        return Ok(Asked { band, amplitudes: vec![USUAL_AMPLITUDE], written: Vec::new(), is_over_amplitude: false });
    };
    let read = |part: &str| {
        let amplitude = parse_quantity(part, unit, &|_| None).ok().filter(|value| *value > 0.0 && value.is_finite());
        let help = || format!("write '{}', or several: '{}'", examples[0], examples[1]);
        amplitude.ok_or_else(|| (format!("--amplitude {}: not a stroke above 0", part.trim()), help()))
    };
    let amplitudes = text.split(',').map(read).collect::<Result<Vec<_>, _>>()?;
    let is_over_amplitude = !is_linear || amplitudes.len() > 1;
    let written = text.split(',').map(|part| part.trim().to_owned()).collect();
    Ok(Asked { band, amplitudes, written, is_over_amplitude })
}

/// Warns of strokes beyond the element's own length, and of more than a turn.
fn warn_of_amplitude(element: &ElementPlan, amplitude: f64) {
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
    let unit = stroke_unit(element);
    diagnostic::warning(
        format!("--amplitude {} {unit} of element {:?}: {why}", short(amplitude), element.element.name),
        Some(help),
    );
}

/// Prints the rows, or writes them as the ending of the file says.
fn tell(options: &ModulusOptions, element: &ElementPlan, rows: &[Modulus], asked: &Asked) -> Ending {
    let Some(out) = &options.out else {
        let text = match options.json {
            true => format!("{:#}\n", json(element, rows, asked)),
            false => table(element, rows, asked),
        };
        return printed(terminal::try_print(&text));
    };
    match &*drawing::ending(out) {
        "csv" => write(out, &csv(element, rows, asked)),
        "json" => write(out, &format!("{:#}\n", json(element, rows, asked))),
        ending if drawing::ENDINGS.contains(&ending) => drawing::write(out, &plot(element, rows, asked)),
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

/// The unit of K*.
fn unit(element: &ElementPlan) -> &'static str {
    units(element)[1]
}

/// The unit of its stroke.
fn stroke_unit(element: &ElementPlan) -> &'static str {
    units(element)[0]
}

fn table(element: &ElementPlan, rows: &[Modulus], asked: &Asked) -> String {
    let (stroke, unit, is_over) = (stroke_unit(element), unit(element), asked.is_over_amplitude);
    let head = [
        ("f, Hz".to_owned(), Set::Number),
        (format!("X, {stroke}"), Set::Number),
        (format!("K', {unit}"), Set::Number),
        (format!("K'', {unit}"), Set::Number),
        ("tan delta".to_owned(), Set::Number),
        ("loss a cycle, J".to_owned(), Set::Number),
    ];
    let shown = |k: &usize| is_over || *k != 1;
    let mut grid = Grid::new(head.into_iter().enumerate().filter(|(k, _)| shown(k)).map(|(_, column)| column));
    let mut left_out = String::new();
    for rows in rows.chunks(asked.band.len()) {
        let (printed, of_band) = frequency::printed(rows.len());
        for Modulus { hertz, amplitude, storage, loss, cycle } in printed.map(|k| rows[k]) {
            let values = [hertz, amplitude, storage, loss, loss / storage, cycle].map(four);
            grid.row(values.into_iter().enumerate().filter(|(k, _)| shown(k)).map(|(_, value)| value).collect());
        }
        left_out = of_band;
    }
    let name = &element.element.name;
    let mut text = match is_over {
        false => format!(
            "element {name} under x = {} {stroke} sin(2 pi f t), steady: K* = K' + i K''\n\n",
            short(asked.amplitudes[0])
        ),
        true => format!("element {name} under x = X sin(2 pi f t), first harmonic: K* = K' + i K''\n\n"),
    };
    text.push_str(&grid.text(terminal::stdout_width()));
    text.push_str(&left_out);
    text
}

fn csv(element: &ElementPlan, rows: &[Modulus], asked: &Asked) -> String {
    let (unit, is_over) = (unit(element), asked.is_over_amplitude);
    let of_amplitude = if is_over { format!("amplitude [{}],", stroke_unit(element)) } else { String::new() };
    let mut text = format!("frequency [Hz],{of_amplitude}storage [{unit}],loss [{unit}],tan_delta,cycle [J]\n");
    for Modulus { hertz, amplitude, storage, loss, cycle } in rows {
        let of_amplitude = if is_over { format!("{amplitude},") } else { String::new() };
        text.push_str(&format!("{hertz},{of_amplitude}{storage},{loss},{},{cycle}\n", loss / storage));
    }
    text
}

fn json(element: &ElementPlan, rows: &[Modulus], asked: &Asked) -> serde_json::Value {
    let column = |of: fn(&Modulus) -> f64| rows.iter().map(of).collect::<Vec<_>>();
    let amplitude = match asked.is_over_amplitude {
        true => json!(column(|row| row.amplitude)),
        false => json!(asked.amplitudes[0]),
    };
    json!({
        "element": element.element.name, "unit": unit(element), "amplitude": amplitude,
        "frequency": column(|row| row.hertz), "storage": column(|row| row.storage), "loss": column(|row| row.loss),
        "tan_delta": column(|row| row.loss / row.storage), "cycle": column(|row| row.cycle),
    })
}

/// Storage and loss over the frequency, a curve of each amplitude; over the amplitude where there is one frequency.
fn plot(element: &ElementPlan, rows: &[Modulus], asked: &Asked) -> Plot {
    let axis = |label: String| Axis { label, scale: Scale::Log, ..Axis::default() };
    let is_of_frequency = asked.band.len() > 1 || asked.amplitudes.len() == 1;
    let of_x: fn(&Modulus) -> f64 = if is_of_frequency { |row| row.hertz } else { |row| row.amplitude };
    let curve = |rows: &[Modulus], label: String, of: fn(&Modulus) -> f64| Curve {
        label,
        is_marked: !is_of_frequency || rows.len() == 1,
        x: rows.iter().map(of_x).collect(),
        y: rows.iter().map(of).collect(),
        ..Curve::default()
    };
    let [storage, loss]: [fn(&Modulus) -> f64; 2] = [|row| row.storage, |row| row.loss];
    let (name, unit, stroke) = (&element.element.name, unit(element).replace('*', "·"), stroke_unit(element));
    let x = match is_of_frequency {
        true => axis("frequency, Hz".to_owned()),
        false => axis(format!("amplitude, {stroke}")),
    };
    let at_one = match (is_of_frequency, asked.amplitudes.as_slice()) {
        (false, _) => format!(" at {} Hz", short(asked.band[0])),
        (true, [amplitude]) if asked.is_over_amplitude => format!(" at {} {stroke}", short(*amplitude)),
        (true, _) => String::new(),
    };
    let title = Some(format!("Storage and loss of {name}{at_one}"));
    let has_many = is_of_frequency && asked.amplitudes.len() > 1;
    if !has_many {
        let curves = vec![curve(rows, "storage K′".into(), storage), curve(rows, "loss K″".into(), loss)];
        let y = axis(format!("dynamic stiffness, {unit}"));
        return Plot { title, x, y, panels: vec![Panel { curves, ..Panel::default() }], ..Plot::default() };
    }
    let panel = |label: &str, of: fn(&Modulus) -> f64| {
        let of_one = |(rows, written): (&[Modulus], &String)| curve(rows, written.clone(), of);
        let curves = rows.chunks(asked.band.len()).zip(&asked.written).map(of_one).collect();
        Panel { y: Some(axis(format!("{label}, {unit}"))), curves, ..Panel::default() }
    };
    let panels = vec![panel("storage K′", storage), panel("loss K″", loss)];
    Plot { title, x, legend_title: Some("amplitude".to_owned()), columns: Some(1), panels, ..Plot::default() }
}
