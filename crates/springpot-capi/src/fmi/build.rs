//! The simulation of an instance, and what its variables are in it.

use super::resources::Resources;
use super::variables::{Role, Variable};
use serde::{Deserialize, Serialize};
use springpot::Simulation;
use springpot::observe::{ElementQuantity, Quantity, Snapshot};
use std::collections::{BTreeMap, HashMap};

/// What a simulation is built with: numbers of the scenario by value reference, and its end, where that is not the scenario's, s.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Setup {
    pub(super) changes: BTreeMap<u32, f64>,
    pub(super) end: Option<f64>,
}

/// A simulation with what was read of it last.
#[derive(Debug)]
pub(super) struct Live {
    pub(super) simulation: Simulation,
    /// What it was built with.
    pub(super) setup: Setup,
    snapshot: Snapshot,
    /// Whether the snapshot is that of the present time.
    is_fresh: bool,
    /// By value reference: what is read of a snapshot.
    quantities: Vec<Option<Quantity>>,
}

impl Live {
    /// At t = 0.
    pub(super) fn new(resources: &Resources, setup: &Setup) -> Result<Self, String> {
        let variables = resources.variables();
        let place = |(reference, value): (&u32, &f64)| Some((variables.get(*reference as usize)?.place()?.0, *value));
        let changes: Vec<_> = setup.changes.iter().filter_map(place).collect();
        let plan = resources.plan(&changes, setup.end)?;
        let mut simulation = Simulation::new(plan.system(), plan.settings).map_err(|error| error.to_string())?;
        let quantities = quantities(variables, &simulation)?;
        let snapshot = simulation.snapshot().map_err(|error| error.to_string())?;
        Ok(Self { simulation, setup: setup.clone(), snapshot, is_fresh: true, quantities })
    }

    /// The value of an output or of an input of an element at the present time.
    pub(super) fn value(&mut self, reference: usize) -> Result<Option<f64>, String> {
        let Some(quantity) = self.quantities[reference] else { return Ok(None) };
        if !self.is_fresh {
            let t = self.simulation.t();
            self.simulation.interpolate_into(t, &mut self.snapshot).map_err(|error| error.to_string())?;
            self.is_fresh = true;
        }
        Ok(Some(self.snapshot.value(quantity)))
    }

    /// The simulation, to be changed.
    pub(super) fn changed(&mut self) -> &mut Simulation {
        self.is_fresh = false;
        &mut self.simulation
    }
}

/// What each variable is in a simulation.
fn quantities(variables: &[Variable], simulation: &Simulation) -> Result<Vec<Option<Quantity>>, String> {
    let observables = simulation.system().observables();
    let all = observables.quantities().into_iter();
    let by_name: HashMap<String, Quantity> =
        all.map(|quantity| (observables.named(quantity).to_string(), quantity)).collect();
    let one = |variable: &Variable| match &variable.role {
        Role::Output { column, .. } => match by_name.get(column) {
            Some(quantity) => Ok(Some(*quantity)),
            None => Err(format!("there is no column {column}: the FMU is of another version of the library")),
        },
        Role::Input { element, input, .. } => {
            Ok(Some(Quantity::Element(*element, ElementQuantity::InputValue(*input))))
        }
        Role::Time | Role::Torque { .. } | Role::Parameter { .. } => Ok(None),
    };
    variables.iter().map(one).collect()
}
