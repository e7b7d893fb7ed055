//! `springpot prony`.

use crate::arguments::{BulkModulus, PronyFormat, PronyOptions};
use crate::grid::{Grid, Set};
use crate::robot::Refused;
use crate::{Ending, diagnostic, frequency, output, printed, terminal};
use springpot::fractional::mittag_leffler::Complex64;
use springpot::fractional::prony::{Bulk, PronyError, PronySeries, Relaxation, Slowest, Springpot, Term, Window};
use springpot::law::{Catalog, Derivative, Entry, Point, Tangent};
use springpot_run::numbers::{count, rough, short};
use springpot_scenario::suggest;
use springpot_scenario::units::parse_quantity;
use std::f64::consts::TAU;
use std::fmt::Display;

pub(crate) fn prony(options: &PronyOptions, catalog: &Catalog) -> Ending {
    match text(options, catalog) {
        Err(Refused) => Ending::Refused,
        Ok(text) => match &options.out {
            None => printed(terminal::try_print(&text)),
            Some(file) => output::written(file, output::write(file, text.as_bytes())),
        },
    }
}

fn text(options: &PronyOptions, catalog: &Catalog) -> Result<String, Refused> {
    let asked = Asked::read(options, catalog)?;
    let Asked { material, window, own_equilibrium, .. } = &asked;
    let for_elements = matches!(options.format, PronyFormat::Abaqus | PronyFormat::Ansys);
    let slowest = if for_elements && !own_equilibrium { Slowest::Stays } else { Slowest::Relaxes };
    let series = PronySeries::new(material, *window, options.rtol, slowest).map_err(|error| refuse(options, &error))?;
    check_finite(options, &series)?;
    let bulk = match options.bulk {
        BulkModulus::Elastic => Bulk::Elastic,
        BulkModulus::Relaxes => Bulk::Relaxes,
    };
    match options.format {
        PronyFormat::Table => Ok(table(options, &asked, &series)),
        PronyFormat::Csv => Ok(series.csv()),
        PronyFormat::Json => Ok(json(&series)),
        PronyFormat::Abaqus => series.abaqus(bulk).map_err(|error| refuse(options, &error)),
        PronyFormat::Ansys => series.ansys(bulk).map_err(|error| refuse(options, &error)),
    }
}

/// What relaxes.
enum Material {
    Springpot(Springpot),
    Law(Tangent),
}

impl Material {
    fn own(&self) -> &dyn Relaxation {
        match self {
            Self::Springpot(springpot) => springpot,
            Self::Law(tangent) => tangent,
        }
    }
}

impl Relaxation for Material {
    fn equilibrium(&self) -> f64 {
        self.own().equilibrium()
    }

    fn spectrum(&self, tau: f64) -> f64 {
        self.own().spectrum(tau)
    }

    fn relaxation(&self, t: f64) -> f64 {
        self.own().relaxation(t)
    }

    fn complex_modulus(&self, omega: f64) -> Complex64 {
        self.own().complex_modulus(omega)
    }
}

/// What the options say, in SI.
struct Asked {
    material: Material,
    window: Window,
    /// Unit of the moduli.
    unit: &'static str,
    own_equilibrium: bool,
}

impl Asked {
    fn read(options: &PronyOptions, catalog: &Catalog) -> Result<Self, Refused> {
        let (material, unit) = match &options.law {
            Some(name) => (Material::Law(law(name, &options.parameters, catalog)?), "N/m"),
            None => springpot(options)?,
        };
        let ends = [("--from", &options.from), ("--to", &options.to)];
        let [from, to] = match options.band {
            false => ends.map(|(name, text)| time(name, text)),
            true => ends.map(|(name, text)| angular(name, text)),
        };
        let (from, to) = (from?, to?);
        if from >= to {
            let help = "--from is the lower end of the window and --to the upper one";
            return refused(format!("--from {} is not below --to {}", options.from, options.to), help);
        }
        let window = if options.band { Window::Frequencies { from, to } } else { Window::Times { from, to } };
        Ok(Self { own_equilibrium: material.equilibrium() > 0.0, material, window, unit })
    }
}

/// The springpot, beside a spring, and the unit of its moduli.
fn springpot(options: &PronyOptions) -> Result<(Material, &'static str), Refused> {
    let order = options.order.unwrap_or(f64::NAN);
    if !(order > 0.0 && order < 1.0) {
        let help = "write an order above 0 and below 1; 0 is a spring and 1 a dashpot, which need no series";
        return refused(format!("--order {order}: out of range"), help);
    }
    let (coefficient, unit) = coefficient(options.coefficient.as_deref().unwrap_or_default(), order)?;
    let equilibrium = match &options.equilibrium {
        None => 0.0,
        Some(text) => modulus(text, unit)?,
    };
    let material = Springpot::new(coefficient, order, equilibrium).map_err(|error| refuse(options, &error))?;
    Ok((Material::Springpot(material), unit))
}

/// A law of the catalog that springpots alone let relax.
fn law(name: &str, given: &[String], catalog: &Catalog) -> Result<Tangent, Refused> {
    let Some(entry) = catalog.get(name) else {
        let help = suggest(name, catalog.entries().iter().map(|law| &*law.name));
        return refused(format!("--law {name}: there is no such law"), &help);
    };
    let values = parameters(entry, given)?;
    let built = entry.build(&values, Derivative::Caputo);
    let law = match built {
        Ok(law) if law.is_linear() && entry.inputs.is_empty() => law,
        Ok(_) => {
            let help = "take one without inputs whose parts are springs and springpots";
            return refused(format!("--law {name}: it is not linear, or has inputs"), help);
        }
        Err(broken) => {
            return refused(
                format!("--law {name} demands {}", broken.rule),
                "look at its parameters: springpot laws NAME",
            );
        }
    };
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
    match law.at_rest(&at, 0.0).map(|rest| rest.tangent.reduced()) {
        Some(tangent) if tangent.is_smooth() && tangent.spectrum(1.0) > 0.0 => Ok(tangent),
        _ => {
            let help = "a chain of springs and dashpots needs no series: the law `prony` takes it as it is";
            refused(format!("--law {name}: its parts are not springs and springpots alone"), help)
        }
    }
}

/// The values of a law's parameters, SI.
fn parameters(law: &Entry, given: &[String]) -> Result<Vec<f64>, Refused> {
    let help = "write --parameter NAME=VALUE, such as --parameter 'k=2 kN/m'";
    let mut pairs: Vec<(&str, &str)> = Vec::new();
    for text in given {
        let Some((name, value)) = text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) else {
            return refused(format!("--parameter {text}: no value"), help);
        };
        if !law.params.iter().any(|param| param.name == name && !param.is_list) {
            let help = suggest(name, law.params.iter().map(|param| &*param.name));
            return refused(format!("--parameter {name}: the law {} has no such parameter", law.name), &help);
        }
        pairs.push((name, value));
    }
    let written = |name: &str| pairs.iter().rev().find(|(own, _)| *own == name).map(|(_, value)| *value);
    // Units may have an order as an exponent.
    let order = |name: &str| written(name).and_then(|value| value.parse().ok());
    let value = |param: &springpot::law::Param| match written(&param.name) {
        None => param.default.map_or_else(|| refused(format!("--parameter {} is missing", param.name), help), Ok),
        Some(text) => match parse_quantity(text, &param.unit, &order) {
            Ok(value) if param.range.contains(value) => Ok(value),
            Ok(_) => refused(
                format!("--parameter {}={text}: out of range", param.name),
                "springpot laws NAME has the ranges",
            ),
            Err(error) => refused(format!("--parameter {}={text}: {error}", param.name), help),
        },
    };
    law.params.iter().map(value).collect()
}

/// The option that says what relaxes.
fn said(options: &PronyOptions) -> String {
    match (&options.law, &options.coefficient) {
        (Some(law), _) => format!("--law {law}"),
        (None, coefficient) => format!("--coefficient {}", coefficient.as_deref().unwrap_or_default()),
    }
}

/// c in SI and the unit of its moduli: a stiffness or a modulus of elasticity.
fn coefficient(text: &str, order: f64) -> Result<(f64, &'static str), Refused> {
    let alpha = |name: &str| (name == "alpha").then_some(order);
    let read = |unit: &str| parse_quantity(text, unit, &alpha);
    let help = "write a positive coefficient such as \"50 N*s^alpha/m\" or \"2 MPa*s^alpha\"";
    let (read, unit) = match read("N*s^alpha/m") {
        Err(error) => match read("Pa*s^alpha") {
            Ok(value) => (Ok(value), "Pa"),
            Err(_) => (Err(error), "N/m"),
        },
        stiffness => (stiffness, "N/m"),
    };
    positive("--coefficient", text, read, help).map(|value| (value, unit))
}

fn modulus(text: &str, unit: &str) -> Result<f64, Refused> {
    match parse_quantity(text, unit, &|_| None) {
        Ok(value) if value == 0.0 => Ok(value),
        read => {
            let help = format!(
                "write a modulus in {unit}, the unit of the coefficient without s^alpha, such as \"200 {unit}\""
            );
            positive("--equilibrium", text, read, &help)
        }
    }
}

fn time(name: &str, text: &str) -> Result<f64, Refused> {
    let read = parse_quantity(text, "s", &|_| None);
    positive(name, text, read, "write a time such as 0.5 or \"500 ms\"; with --band, a frequency")
}

/// The angular frequency, rad/s.
fn angular(name: &str, text: &str) -> Result<f64, Refused> {
    positive(name, text, frequency::angular(text), "write a frequency such as 10, \"0.5 kHz\" or \"3 rad/s\"")
}

fn positive(name: &str, text: &str, read: Result<f64, impl Display>, help: &str) -> Result<f64, Refused> {
    match read {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        Ok(_) => refused(format!("{name} {text}: not a positive number"), help),
        Err(error) => refused(format!("{name} {text}: {error}"), help),
    }
}

fn refused<T>(message: String, help: &str) -> Result<T, Refused> {
    diagnostic::error_with_help(message, help.to_owned());
    Err(Refused)
}

/// What numbers can hold.
const HOLD: &str = "64-bit numbers end at 1.8e308 and lose digits below 2.2e-308: take a coefficient nearer to 1, and times nearer to 1 s";

/// Says what the library refused.
fn refuse(options: &PronyOptions, error: &PronyError) -> Refused {
    if let PronyError::Spectrum { .. } = error {
        diagnostic::error_with_help(format!("{}: {error}", said(options)), HOLD.to_owned());
        return Refused;
    }
    let help = match error {
        PronyError::Tolerance(_) => format!("--rtol {}: write a number such as 1e-4", options.rtol),
        PronyError::Bound { .. } => "ask for a larger --rtol or a shorter window".to_owned(),
        PronyError::NoEquilibrium | PronyError::Digits(_) => {
            "name a shorter window, or take --format csv, whose moduli are not normalised".to_owned()
        }
        PronyError::Window { .. } => "name a shorter window with --from and --to".to_owned(),
        _ => "springpot prony --help tells the ranges".to_owned(),
    };
    diagnostic::error_with_help(error.to_string(), help);
    Refused
}

/// Refuses a series of which some number is beyond all numbers of 64 bits, or so small that it has lost digits.
fn check_finite(options: &PronyOptions, series: &PronySeries) -> Result<(), Refused> {
    let of_term = |(k, term): (usize, &Term)| {
        [("modulus", term.modulus), ("relaxation time", term.relaxation_time), ("viscosity", term.viscosity())]
            .map(|(what, value)| (format!("the {what} of branch {k}"), value))
    };
    let sum = ("the sum of all moduli".to_owned(), series.instantaneous());
    let all = (1..).zip(&series.terms).flat_map(of_term).chain([sum]);
    let Some((what, value)) = all.into_iter().find(|(_, value)| !value.is_normal()) else { return Ok(()) };
    let how = if value.is_finite() { "too small for" } else { "beyond all" };
    refused(format!("{}: {what} is {how} numbers of 64 bits", said(options)), HOLD)
}

fn json(series: &PronySeries) -> String {
    let mut text = serde_json::to_string_pretty(series).expect("a series is numbers and names");
    text.push('\n');
    text
}

fn table(options: &PronyOptions, asked: &Asked, series: &PronySeries) -> String {
    let unit = asked.unit;
    let beside = match &options.equilibrium {
        Some(equilibrium) if asked.own_equilibrium => format!(", beside a spring of {equilibrium}"),
        _ => String::new(),
    };
    let (what, window) = match series.window {
        Window::Times { from, to } => ("G(t)", format!("{} s to {} s", short(from), short(to))),
        Window::Frequencies { from, to } => ("G*", format!("{} Hz to {} Hz", short(from / TAU), short(to / TAU))),
    };
    let material = match (&options.law, &options.coefficient, options.order) {
        (None, Some(coefficient), Some(order)) => ("springpot", format!("{coefficient}, alpha = {order}{beside}")),
        (law, ..) => ("law", format!("{}, {}", law.as_deref().unwrap_or_default(), options.parameters.join(", "))),
    };
    let lines = [
        material,
        ("window", window),
        ("series", format!("{}, all moduli positive", count(series.terms.len(), "branch", "branches"))),
        ("error", format!("{} of {what}, verified; at most {:e} was asked for", rough(series.error), series.tolerance)),
        ("G(0)", format!("{} {unit}, all branches together", short(series.instantaneous()))),
        ("G_e", format!("{} {unit}, what stays", short(series.equilibrium))),
    ];
    let width = terminal::stdout_width();
    let mut text: String =
        lines.iter().map(|(lead, line)| terminal::hanging(&format!("{lead:<11}"), line, width)).collect();
    text.push('\n');
    let mut grid = Grid::new([
        ("k".to_owned(), Set::Number),
        (format!("g_k, {unit}"), Set::Number),
        ("tau_k, s".to_owned(), Set::Number),
        (format!("g_k tau_k, {}", if unit == "Pa" { "Pa*s" } else { "N*s/m" }), Set::Number),
    ]);
    for (k, term) in (1..).zip(&series.terms) {
        let numbers = [term.modulus, term.relaxation_time, term.viscosity()].map(short);
        grid.row([format!("{k}")].into_iter().chain(numbers).collect());
    }
    text.push_str(&grid.text(terminal::stdout_columns()));
    text
}
