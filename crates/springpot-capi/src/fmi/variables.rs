//! The variables of an FMU: what they are called, and what they stand for.

use serde::{Deserialize, Serialize};
use springpot::Simulation;
use springpot::observe::{ElementQuantity, EnergyQuantity, Quantity};
use springpot::system::{Motion, System};
use springpot_scenario::{Plan, ShapePlan, toml_key};

/// One variable, a real number. Its value reference is its place in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// SI unit in the grammar of scenarios; empty for a pure number.
    pub unit: String,
    /// What it is, in a few words.
    pub meaning: String,
    /// What it stands for.
    pub role: Role,
}

/// What a variable stands for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Role {
    /// t.
    Time,
    /// A force that is added to that of an actuator.
    Torque {
        /// Which number of v it drives.
        velocity: usize,
    },
    /// An input of an element.
    Input {
        /// Which element.
        element: usize,
        /// Which of its inputs.
        input: usize,
        /// Where it stands in the scenario.
        path: String,
        /// What the scenario says at t = 0.
        start: f64,
    },
    /// A number of the scenario.
    Parameter {
        /// Where it stands.
        path: String,
        /// What it is.
        start: f64,
    },
    /// A column of the rows.
    Output {
        /// Its name.
        column: String,
        /// Which of [`Variable`]s it follows from at once: inputs alone, by value reference.
        inputs: Vec<u32>,
    },
}

impl Variable {
    /// Whether it is an input.
    pub fn is_input(&self) -> bool {
        matches!(self.role, Role::Torque { .. } | Role::Input { .. })
    }

    /// Where it stands in the scenario, and what it is there, where it can be set before the start.
    pub fn place(&self) -> Option<(&str, f64)> {
        match &self.role {
            Role::Input { path, start, .. } | Role::Parameter { path, start } => Some((path, *start)),
            _ => None,
        }
    }

    /// Its value before anything is set; `None` of outputs.
    pub fn start(&self) -> Option<f64> {
        match &self.role {
            Role::Time | Role::Torque { .. } => Some(0.0),
            Role::Input { start, .. } | Role::Parameter { start, .. } => Some(*start),
            Role::Output { .. } => None,
        }
    }
}

/// A variable that stands for a number of the scenario, if it can be set.
pub(super) struct Candidate {
    pub(super) variable: Variable,
    pub(super) read: Reading,
}

/// Reads the number from a plan.
type Reading = Box<dyn Fn(&Plan) -> Option<f64>>;

/// Time and inputs; the elements' inputs have their values at t = 0 for starts.
pub(super) fn inputs(plan: &Plan, simulation: &mut Simulation) -> Vec<Variable> {
    let mut variables =
        vec![Variable { name: "time".to_owned(), unit: "s".to_owned(), meaning: "time".to_owned(), role: Role::Time }];
    let observables = simulation.system().observables();
    for velocity in 0..simulation.system().model.nv() {
        // Nothing is added, where something could be.
        if simulation.set_torque(velocity, 0.0).is_err() {
            continue;
        }
        let column = observables.column(Quantity::Torque(velocity));
        let meaning = format!("added to the {}", column.meaning);
        variables.push(Variable { name: column.name, unit: column.unit, meaning, role: Role::Torque { velocity } });
    }
    for (e, planned) in plan.elements.iter().enumerate() {
        for (i, signal) in planned.inputs.iter().enumerate() {
            let column = observables.column(Quantity::Element(e, ElementQuantity::InputValue(i)));
            let path = format!("{}.{}", path_of(plan, e), toml_key(&planned.element.entry.inputs[i].name));
            let start = signal.signal.at(0.0).value;
            let role = Role::Input { element: e, input: i, path, start };
            variables.push(Variable { name: column.name, unit: column.unit, meaning: column.meaning, role });
        }
    }
    variables
}

/// Numbers that may be set before the start: parameters of laws, where a forward motion starts, the tolerance.
pub(super) fn candidates(plan: &Plan, system: &System) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    let mut push = |path: String, unit: &str, meaning: String, start: f64, read: Reading| {
        let role = Role::Parameter { path: path.clone(), start };
        let variable = Variable { name: path, unit: unit.to_owned(), meaning, role };
        candidates.push(Candidate { variable, read });
    };
    for (e, planned) in plan.elements.iter().enumerate() {
        let entry = &planned.element.entry;
        for (k, (param, value)) in entry.params.iter().zip(&planned.parameters).enumerate() {
            let path = format!("{}.{}", path_of(plan, e), toml_key(&param.name));
            let meaning = format!("{} of {}", param.meaning, planned.element.name);
            let read = move |plan: &Plan| plan.elements.get(e)?.parameters.get(k).copied();
            push(path, &param.unit, meaning, *value, Box::new(read));
        }
    }
    if let Motion::Forward(forward) = &system.motion {
        let labels = [("q", "coordinate", plan.model.q_labels()), ("v", "velocity", plan.model.v_labels())];
        for (symbol, words, labels) in labels {
            let values = if symbol == "q" { &forward.q } else { &forward.v };
            for (k, label) in labels.iter().enumerate() {
                let units = label.dimension.units();
                let unit = if symbol == "q" { units.coordinate } else { units.velocity };
                let path = format!("motion.start.{symbol}.{}", toml_key(&label.name));
                let read = move |plan: &Plan| match plan.system_at_start().motion {
                    Motion::Forward(forward) if symbol == "q" => forward.q.get(k).copied(),
                    Motion::Forward(forward) => forward.v.get(k).copied(),
                    Motion::Given(_) => None,
                };
                push(path, unit, format!("{words} of {} at the start", label.name), values[k], Box::new(read));
            }
        }
    }
    if plan.settings.fixed_step.is_none() {
        let meaning = "relative tolerance of the run".to_owned();
        push("solver.rtol".to_owned(), "", meaning, plan.settings.rtol, Box::new(|plan| Some(plan.settings.rtol)));
    }
    candidates
}

/// Every column that no input stands for. One that an added force changes has another name than that.
pub(super) fn outputs(system: &System, inputs: &[Variable]) -> Vec<Variable> {
    let observables = system.observables();
    let is_given = matches!(system.motion, Motion::Given(_));
    let quantities = observables.quantities().into_iter();
    let told = quantities
        .filter(|quantity| !matches!(quantity, Quantity::Time | Quantity::Element(_, ElementQuantity::InputValue(_))));
    let output = |quantity: Quantity| {
        let column = observables.column(quantity);
        let is_taken = inputs.iter().any(|input| input.name == column.name);
        let name = if is_taken { format!("{}.total", column.name) } else { column.name.clone() };
        let meaning = column.meaning;
        let known = inputs.iter().enumerate().filter(|(_, input)| acts(&input.role, quantity, is_given));
        let inputs = known.map(|(k, _)| k as u32).collect();
        Variable { name, unit: column.unit, meaning, role: Role::Output { column: column.name, inputs } }
    };
    told.map(output).collect()
}

/// Whether an input changes a quantity at once, and not by way of the motion.
fn acts(role: &Role, quantity: Quantity, is_given: bool) -> bool {
    match (role, quantity) {
        (Role::Torque { .. }, Quantity::Acceleration(_)) => true,
        (Role::Torque { velocity }, Quantity::Torque(k)) => *velocity == k,
        (Role::Input { .. }, Quantity::Acceleration(_)) => !is_given,
        (Role::Input { .. }, Quantity::Torque(_) | Quantity::Energy(EnergyQuantity::Residual)) => true,
        (Role::Input { element, .. }, Quantity::Element(e, of)) => {
            use ElementQuantity::{Length, Rate, Stroke};
            *element == e && !matches!(of, Length | Stroke | Rate)
        }
        _ => false,
    }
}

/// Where element `e` stands in the scenario.
fn path_of(plan: &Plan, e: usize) -> String {
    let planned = &plan.elements[e];
    let name = &planned.element.name;
    match (&planned.shape, name.rsplit_once('.')) {
        (ShapePlan::Bushing { .. }, Some((bushing, component))) => {
            format!("element.{}.{}", toml_key(bushing), toml_key(component))
        }
        _ => format!("element.{}", toml_key(name)),
    }
}
