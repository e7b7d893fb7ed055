//! How many columns it takes to stand for all that parameters change.

use crate::elements::Element;
use crate::equations::assembly::Equations;
use crate::fractional::PortColumns;
use crate::law::{Derivative, Network};
use crate::model::FrictionLaw;
use crate::observe::{ElementQuantity, Quantity};
use crate::system::sensitivity::{Parameter, Seed, Sensitivity};
use crate::system::{Action, Motion, System};
use std::sync::Arc;

/// How many lags a step asks a memory for, and a row beside them: of one alone, and inside a series.
const ALONE: usize = 5;
const IN_SERIES: usize = 12;

/// How many sums over modes the energies of a step ask for, at its start and its nodes, and a row beside them; those of a step of one size, told of three
/// nodes behind it and accelerated at both ends; and the mean that such a step asks for alone.
const OF_ENERGIES: usize = 12;
const IN_SERIES_OF_ENERGIES: usize = 20;
const OF_ONE_SIZE: usize = 32;
const OF_MEAN: usize = 1;

/// Columns: of parameters first, then of ones for numbers of the state, then of what memories are told.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) parameters: usize,
    pub(super) units: usize,
    pub(super) ports: Vec<PortColumns>,
    pub(super) all: usize,
}

impl Columns {
    /// Of a run of which rows of these `quantities` are kept and whose samples keep so many numbers.
    pub(super) fn of(
        system: &System,
        by: &Sensitivity,
        quantities: &[Quantity],
        equations: &Equations,
        (samples, has_fixed_steps): (usize, bool),
    ) -> Self {
        let [of_control, terms] = equations.control.as_ref().map_or([0; 2], |run| run.kept());
        let works = keeps_works(quantities);
        let mut units = of_control + samples + pending(system, by);
        units += if works { 2 * system.elements.len() + 1 } else { 0 };
        let is_singular = |element: &Element| element.derivative == Derivative::RiemannLiouville;
        if equations.bank.has_singular() || system.elements.iter().any(is_singular) {
            units += system.elements.len();
        }
        if let Motion::Forward(_) = system.motion {
            units += 3 * system.model.nv();
        }
        let mut rooms = Vec::new();
        for (e, element) in system.elements.iter().enumerate() {
            let size = equations.bank.law_state(e).map(|state| state.size()).unwrap_or_default();
            units += size.variables + 3 * size.memories;
            let in_series = element.law.has_memories_in_series();
            let lags = if in_series { IN_SERIES } else { ALONE };
            let stored = quantities.contains(&Quantity::Element(e, ElementQuantity::Stored));
            let sums = match (works || stored || warms(&element.law), has_fixed_steps) {
                (true, false) => {
                    if in_series {
                        IN_SERIES_OF_ENERGIES
                    } else {
                        OF_ENERGIES
                    }
                }
                (true, true) => OF_ONE_SIZE,
                (false, true) => OF_MEAN,
                (false, false) => 0,
            };
            rooms.extend(std::iter::repeat_n([lags, sums], size.memories));
        }
        rooms.extend(std::iter::repeat_n([ALONE, 0], terms));
        let parameters = by.parameters.len();
        let mut next = parameters + units;
        let mut take = |room: usize| {
            next += room;
            [next - room, room]
        };
        let ports = rooms.into_iter().map(|[lags, sums]| PortColumns { lags: take(lags), sums: take(sums) }).collect();
        Self { parameters, units, ports, all: next }
    }

    /// The parameters with others beside them that move nothing.
    pub(super) fn sensitivity(&self, by: &Sensitivity) -> Arc<Sensitivity> {
        let one = || Parameter { name: String::new(), value: 0.0, typical: 1.0, seeds: Vec::new() };
        let mut ones = Sensitivity { control: false, ..by.clone() };
        ones.parameters.resize_with(self.all, one);
        Arc::new(ones)
    }
}

/// Whether rows ask for works.
pub(in crate::equations::variation) fn keeps_works(quantities: &[Quantity]) -> bool {
    quantities.iter().any(Quantity::is_work)
}

/// Whether its losses warm it.
fn warms(law: &Network) -> bool {
    law.as_heated().is_some_and(|heated| heated.heat().thermal.is_some())
}

/// Numbers of what events set, and of the times of changes that parameters move.
fn pending(system: &System, by: &Sensitivity) -> usize {
    let sets = system.events.iter().map(|event| match &event.action {
        Action::Set(settings) => settings.len(),
        _ => 0,
    });
    let sets = sets.sum::<usize>();
    let switches = |seed: &Seed| matches!(seed, Seed::Switch { .. });
    let changes = sets > 0
        || !system.control.is_empty()
        || system.model.friction_laws().contains(&FrictionLaw::Sticking)
        || system.elements.iter().any(|element| element.law.jumps())
        || by.parameters.iter().any(|parameter| parameter.seeds.iter().any(switches));
    // How much later the next one comes, and the last one came, to the motion and to works.
    if changes { 3 + sets } else { 0 }
}
