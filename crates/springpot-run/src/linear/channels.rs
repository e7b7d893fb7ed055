//! Inputs and outputs of small motions by name.

use super::about::About;
use springpot::linear::{Excitation, NoResponse};
use springpot::observe::Quantity;
use springpot_scenario::suggest;

/// Something with a name and a unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named<T> {
    /// `tau.q1`, `q.q1`, `strut.U`, `reference.q1`, or a column.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// What it is.
    pub what: T,
}

/// All that can be moved by a sine.
pub fn inputs(about: &About) -> Vec<Named<Excitation>> {
    let (system, labels) = (&about.system, about.system.model.v_labels());
    let named = |what: Excitation| {
        let units = |k: usize| labels[k].dimension.units();
        let (name, unit) = match what {
            Excitation::Torque(k) => (format!("tau.{}", labels[k].name), units(k).force.to_owned()),
            Excitation::Motion(k) => (format!("q.{}", labels[k].name), units(k).coordinate.to_owned()),
            Excitation::Reference(k) => (format!("reference.{}", labels[k].name), units(k).coordinate.to_owned()),
            Excitation::Input(e, i) => {
                let (element, input) = (&system.elements[e], &system.elements[e].entry.inputs[i]);
                (format!("{}.{}", element.name, input.name), input.unit.to_string())
            }
        };
        Named { name, unit, what }
    };
    about.linear.excitations().into_iter().map(named).collect()
}

/// The input of this name, which `option` speaks of; what is wrong, and what would be right.
///
/// # Errors
/// Where there is none.
pub fn input(about: &About, option: &str, name: &str) -> Result<Named<Excitation>, (String, String)> {
    let mut all = inputs(about);
    if let Some(k) = all.iter().position(|input| input.name == name) {
        return Ok(all.swap_remove(k));
    }
    let help = suggest(name, all.iter().map(|input| &*input.name));
    let joints = about.system.model.joint_names();
    let of = |lead: &str| name.strip_prefix(lead).is_some_and(|joint| joints.iter().any(|other| other == joint));
    let message = if of("q.") {
        format!("{option} {name}: no signal of `prescribed` moves this joint")
    } else if of("tau.") {
        format!("{option} {name}: forces do not move this joint")
    } else if of("reference.") {
        format!(
            "{option} {name}: no `joints` reference of a controller that acts at every time says where this joint goes"
        )
    } else {
        format!("{option} {name}: there is no such input")
    };
    Err((message, help))
}

/// The column of this name that is linear in small motions, which `option` speaks of; what is wrong, and what would be right.
///
/// # Errors
/// Where there is none.
pub fn column(about: &About, option: &str, name: &str) -> Result<Named<Quantity>, (String, String)> {
    let observables = about.system.observables().with_leaves();
    let columns = observables.columns();
    let answers = |quantity: Quantity| about.linear.is_linear(quantity);
    let Some(k) = columns.iter().position(|column| column.name == name) else {
        let known =
            observables.quantities().into_iter().zip(&columns).filter(|(quantity, _)| answers(*quantity).is_ok());
        let help = suggest(name, known.map(|(_, column)| &*column.name));
        return Err((format!("{option}: there is no column {name:?}"), help));
    };
    let quantity = observables.quantities()[k];
    match answers(quantity) {
        Ok(()) => Ok(Named { name: name.to_owned(), unit: columns[k].unit.clone(), what: quantity }),
        Err(why @ (NoResponse::Energy | NoResponse::Told | NoResponse::NotLinear | NoResponse::None)) => {
            let help = "take a coordinate, a velocity, a torque, something of an element or the gripper".to_owned();
            Err((format!("{option} {name}: {why}"), help))
        }
    }
}
