//! Linear models with names and units, and their files.

use super::about::{About, Stopped};
use super::channels::{Named, column, input};
use crate::table::npz::{Whole, write_whole};
use serde_json::{Map, Value, json};
use springpot::linear::{
    Excitation, LinearModel, LineariseError, ModelOrder, State, StateKind, StateOwner, linearise as linear_model,
};
use springpot::observe::Quantity;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::io::{self, Seek, Write};

/// A linear model whose inputs, outputs and states have names.
#[derive(Debug, Clone)]
pub struct Modelled {
    /// The matrices.
    pub model: LinearModel,
    /// Its inputs.
    pub inputs: Vec<Named<Excitation>>,
    /// Its outputs.
    pub outputs: Vec<Named<Quantity>>,
    /// Names and units of its states.
    pub states: Vec<[String; 2]>,
    /// Hz.
    pub band: [f64; 2],
    /// The time that it is about, s, and the coordinates there.
    pub about: (f64, Vec<f64>),
}

/// The linear model of a system between inputs and outputs that are told by name; `band` in Hz.
///
/// # Errors
/// [`Stopped`]: unknown names, a sampled controller, what no such model does, and a tolerance that is out of reach.
pub fn linearise(
    about: &About,
    [inputs, outputs]: [&[String]; 2],
    band: [f64; 2],
    tolerance: f64,
) -> Result<Modelled, Stopped> {
    let refuse = |(message, help): (String, String)| Stopped::Refused(message, help);
    if about.sampled()[0] {
        let message = "what follows from the state is sampled, which no linear model of continuous time is";
        let help = "leave `sample` out, or leave feedback and controllers out: --open";
        return Err(Stopped::Refused(message.to_owned(), help.to_owned()));
    }
    let inputs =
        inputs.iter().map(|name| input(about, "--input", name)).collect::<Result<Vec<_>, _>>().map_err(refuse)?;
    let outputs =
        outputs.iter().map(|name| column(about, "--output", name)).collect::<Result<Vec<_>, _>>().map_err(refuse)?;
    let order = ModelOrder {
        inputs: &inputs.iter().map(|input| input.what).collect::<Vec<_>>(),
        outputs: &outputs.iter().map(|output| output.what).collect::<Vec<_>>(),
        band: band.map(|hertz| TAU * hertz),
        tolerance,
    };
    let model = linear_model(&about.linear, &order).map_err(|error| {
        let message = match &error {
            LineariseError::NotProper { output, input } => format!(
                "{} answers to how fast {} changes, which no x' = A x + B u, y = C x + D u does",
                outputs[*output].name, inputs[*input].name
            ),
            error => error.to_string(),
        };
        match error {
            LineariseError::OutOfReach { .. } => Stopped::Failed(message),
            LineariseError::NoFree => {
                refuse((message, "free a joint: leave it out of `prescribed` and `locked`".to_owned()))
            }
            LineariseError::NotProper { .. } => {
                refuse((message, "take an output that lies behind it, such as a coordinate".to_owned()))
            }
            _ => refuse((message, "look at the band, the tolerance and parts in series".to_owned())),
        }
    })?;
    let states = state_names(about, &model.states);
    Ok(Modelled { model, inputs, outputs, states, band, about: (about.t, about.linear.q.clone()) })
}

/// `q.elbow`, `v.elbow`, `strut.inner1`, `strut.memory1`, `controller.elbow.integral1`, `controller.elbow.memory1`, and their units.
fn state_names(about: &About, states: &[State]) -> Vec<[String; 2]> {
    let labels = about.system.model.v_labels();
    let columns = about.system.observables().columns();
    let stroke_unit = |name: &str| {
        let stroke = columns.iter().find(|column| column.name == format!("{name}.stroke"));
        stroke.map_or_else(|| "m".to_owned(), |column| column.unit.clone())
    };
    let mut counted: HashMap<(StateKind, StateOwner), usize> = HashMap::new();
    let one = |state: &State| {
        let number = counted.entry((state.kind, state.owner())).or_default();
        *number += 1;
        let joint = |k: usize| labels[k].dimension.units().coordinate.to_owned();
        let (owner, unit) = match state.owner() {
            StateOwner::Velocity(k) => (labels[k].name.clone(), joint(k)),
            StateOwner::Controller(k) => (format!("controller.{}", labels[k].name), joint(k)),
            StateOwner::Filter(k) => {
                (format!("controller.{}", labels[k].name), labels[k].dimension.units().force.to_owned())
            }
            StateOwner::Element(e) => {
                let name = &about.system.elements[e].name;
                (name.clone(), stroke_unit(name))
            }
        };
        let is_controller = matches!(state.owner(), StateOwner::Controller(_));
        let (name, unit) = match state.kind {
            StateKind::Position => (format!("q.{owner}"), unit),
            StateKind::Velocity => (format!("v.{owner}"), format!("{unit}/s")),
            StateKind::Inner if is_controller => (format!("{owner}.integral{number}"), format!("{unit}*s")),
            StateKind::Inner if matches!(state.owner(), StateOwner::Filter(_)) => {
                (format!("{owner}.filter{number}"), unit)
            }
            StateKind::Inner => (format!("{owner}.inner{number}"), unit),
            StateKind::Memory => (format!("{owner}.memory{number}"), unit),
            StateKind::MemoryOfIntegral => (format!("{owner}.integral_memory{number}"), format!("{unit}*s")),
        };
        [name, unit]
    };
    states.iter().map(one).collect()
}

impl Modelled {
    /// Every name with its unit, in order.
    pub fn units(&self) -> Vec<[String; 2]> {
        let inputs = self.inputs.iter().map(|own| [own.name.clone(), own.unit.clone()]);
        let outputs = self.outputs.iter().map(|own| [own.name.clone(), own.unit.clone()]);
        let mut all: Vec<[String; 2]> = Vec::new();
        for own in inputs.chain(outputs).chain(self.states.iter().cloned()) {
            if all.iter().all(|[name, _]| *name != own[0]) {
                all.push(own);
            }
        }
        all
    }

    /// As data.
    pub fn json(&self) -> Value {
        let LinearModel { a, b, c, d, error, .. } = &self.model;
        let units: Map<String, Value> = self.units().into_iter().map(|[name, unit]| (name, unit.into())).collect();
        json!({
            "A": a, "B": b, "C": c, "D": d,
            "inputs": self.inputs.iter().map(|own| &own.name).collect::<Vec<_>>(),
            "outputs": self.outputs.iter().map(|own| &own.name).collect::<Vec<_>>(),
            "states": self.states.iter().map(|[name, _]| name).collect::<Vec<_>>(),
            "units": units, "band": self.band, "error": error,
            "about": { "t": self.about.0, "q": self.about.1 },
        })
    }

    /// As NumPy's zipped arrays: the keys of [`Self::json`], `units` along `unit_names`, and `about_t` and `about_q`.
    ///
    /// # Errors
    /// The file's.
    pub fn npz<W: Write + Seek>(&self, out: &mut W) -> io::Result<()> {
        let LinearModel { a, b, c, d, error, .. } = &self.model;
        let [n, inputs, outputs] = [a.len(), self.inputs.len(), self.outputs.len()];
        let matrix = |rows: &[Vec<f64>], shape: [usize; 2]| Whole::Matrix(rows.concat(), shape);
        let units = self.units();
        let names = |of: Vec<&String>| Whole::Texts(of.into_iter().cloned().collect());
        write_whole(
            &[
                ("A", matrix(a, [n, n])),
                ("B", matrix(b, [n, inputs])),
                ("C", matrix(c, [outputs, n])),
                ("D", matrix(d, [outputs, inputs])),
                ("inputs", names(self.inputs.iter().map(|own| &own.name).collect())),
                ("outputs", names(self.outputs.iter().map(|own| &own.name).collect())),
                ("states", names(self.states.iter().map(|[name, _]| name).collect())),
                ("unit_names", names(units.iter().map(|[name, _]| name).collect())),
                ("units", names(units.iter().map(|[_, unit]| unit).collect())),
                ("band", Whole::Numbers(self.band.to_vec())),
                ("error", Whole::Numbers(vec![*error])),
                ("about_t", Whole::Numbers(vec![self.about.0])),
                ("about_q", Whole::Numbers(self.about.1.clone())),
            ],
            out,
        )
    }
}
