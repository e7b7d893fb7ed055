//! `springpot dynamics SCENARIO --at TIME`: the equations of motion term by term.

use super::{latex, terms};
use crate::arguments::DynamicsOptions;
use crate::robot::{Refused, is_scenario, refuse_urdf_flags};
use crate::scenario::swept::in_case;
use crate::{Ending, diagnostic, plain, printed, terminal};
use serde::Serialize;
use serde_json::{Map, Value, json};
use springpot::driver::{Equation, EquationError};
use springpot::law::Catalog;
use springpot::system::System;
use springpot_scenario::units::parse_quantity;
use springpot_scenario::{Cases, Refusals, SweptValue};

pub(super) fn at(options: &DynamicsOptions, catalog: &Catalog, at: &str) -> Result<Ending, Refused> {
    let file = &options.robot.file;
    if !is_scenario(file) {
        let message = format!("--at wants a scenario (.toml), whose motion it follows; {} has none", file.display());
        diagnostic::error_with_help(
            message,
            "--states computes the dynamics of a URDF robot in given states".to_owned(),
        );
        return Err(Refused);
    }
    refuse_urdf_flags(&options.robot)?;
    let t = time(at)?;
    let refused = |refusals: Refusals| {
        diagnostic::refused(&refusals);
        Refused
    };
    let cases = diagnostic::open(file, &options.overrides, catalog).map_err(refused)?;
    let index = options.case.unwrap_or(0);
    if index >= cases.len() {
        let message = format!("--case {index}: the last case of {} is {}", file.display(), cases.len() - 1);
        diagnostic::error_with_help(message, "cases are counted from 0, as in run.json".to_owned());
        return Err(Refused);
    }
    let plan = cases.plan(index).map_err(refused)?;
    let system = plan.system();
    diagnostic::robot_warnings(&cases);
    match system.equation(&plan.settings, t) {
        Ok(equation) => {
            let (title, case) = (plan.title.as_deref(), cases.name(index));
            let text = match (options.json, options.latex) {
                (true, _) => json(&cases, index, &system, &equation),
                (_, true) => latex::latex(title, &case, &system, &equation),
                _ => terms::text(title, &case, &system, &equation),
            };
            Ok(printed(terminal::try_print(&text)))
        }
        Err(EquationError::Run(error)) => {
            diagnostic::error(in_case(&cases, index, &error.to_string()));
            Ok(Ending::Failed)
        }
        Err(error @ (EquationError::Outside { .. } | EquationError::NotARow { .. })) => {
            diagnostic::error(format!("--at {at}: {error}"));
            Err(Refused)
        }
    }
}

fn time(text: &str) -> Result<f64, Refused> {
    let refuse = |message: String| {
        diagnostic::error_with_help(message, "write a time such as 0.5 or \"500 ms\"".to_owned());
        Refused
    };
    match parse_quantity(text, "s", &|_| None) {
        Ok(time) if time.is_finite() => Ok(time),
        Ok(_) => Err(refuse(format!("--at {text}: not a finite number"))),
        Err(error) => Err(refuse(format!("--at {text}: {error}"))),
    }
}

/// Everything as data, SI; what is not known is null.
#[derive(Serialize)]
struct Record<'a> {
    t: f64,
    case: usize,
    parameters: Map<String, Value>,
    /// Names of the numbers of q, and of those of v and all terms.
    q_names: Vec<String>,
    joints: Vec<String>,
    q: &'a [f64],
    v: &'a [f64],
    a: &'a [f64],
    #[serde(rename = "M")]
    mass: Vec<&'a [f64]>,
    coriolis: Vec<&'a [f64]>,
    christoffel: Option<Vec<Vec<&'a [f64]>>>,
    elements: Vec<Value>,
    equation: Terms<'a>,
}

/// inertia + velocity − gravity − elements − joints − tau = residual.
#[derive(Serialize)]
struct Terms<'a> {
    inertia: &'a [f64],
    velocity: &'a [f64],
    gravity: &'a [f64],
    elements: Vec<f64>,
    joints: &'a [f64],
    tau: &'a [f64],
    residual: Vec<f64>,
}

fn json(cases: &Cases, index: usize, system: &System, equation: &Equation) -> String {
    let Equation { t, state, mass, christoffel, coriolis, inertia, velocity, gravity, joints, tau, .. } = equation;
    let n = state.v.len();
    let values = cases.values(index).into_iter().map(|value| match value {
        SweptValue::Number(number) => json!(number),
        SweptValue::Text(text) => json!(text),
    });
    let rows = |matrix| -> Vec<&[f64]> { <[f64]>::chunks(matrix, n).collect() };
    let element = |(term, element): (&springpot::driver::ElementTerm, &springpot::elements::Element)| {
        let inputs: Map<String, Value> = element
            .entry
            .inputs
            .iter()
            .zip(&term.inputs)
            .map(|(input, x)| (input.name.to_string(), json!(x)))
            .collect();
        json!({
            "name": term.name,
            "length": term.length,
            "stroke": term.stroke,
            "rate": term.rate,
            "derivative": term.derivative,
            "force": term.force,
            "Q": term.q_force,
            "inputs": inputs,
        })
    };
    let record = Record {
        t: *t,
        case: index,
        parameters: cases.parameters().iter().cloned().zip(values).collect(),
        q_names: system.model.q_labels().into_iter().map(|label| label.name).collect(),
        joints: system.model.v_labels().into_iter().map(|label| label.name).collect(),
        q: &state.q,
        v: &state.v,
        a: &state.a,
        mass: rows(mass),
        coriolis: rows(coriolis),
        christoffel: christoffel.as_ref().map(|gamma| gamma.chunks(n * n).map(rows).collect()),
        elements: equation.elements.iter().zip(&system.elements).map(element).collect(),
        equation: Terms {
            inertia,
            velocity,
            gravity,
            elements: equation.sum_of_elements(),
            joints,
            tau,
            residual: equation.residual(),
        },
    };
    let text = serde_json::to_string(&record).expect("names are text and numbers are numbers or null");
    format!("{}\n", plain::json(&text))
}
