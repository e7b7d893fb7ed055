//! Where a recording begins, and what cannot be gone back through.

use super::tape::{Begin, Entries, Layout, Sparse};
use super::{Recording, Tape};
use crate::equations::assembly::Equations;
use crate::equations::node::Node;
use crate::equations::variation::{ROW, Variation};
use crate::law::variation::probe::LawProbe;
use crate::law::{Derivative, Network};
use crate::observe::{ElementQuantity, EnergyQuantity, Quantity};
use crate::sensitivity::{Parameter, Seed, Sensitivity, SensitivityError, has_derivative};
use crate::system::{Action, Motion, System};
use std::sync::Arc;

fn refuse<T>(what: impl Into<String>) -> Result<T, SensitivityError> {
    Err(SensitivityError::Backwards { what: what.into() })
}

impl Recording {
    /// Of a run whose elements have begun and whose robot is at `start`, of which rows of these `quantities` are to be known.
    ///
    /// # Errors
    /// What has no derivative, or none that one can go back through.
    pub(crate) fn begin(
        system: &System,
        by: &Arc<Sensitivity>,
        quantities: &[Quantity],
        equations: &Equations,
        start: Node,
    ) -> Result<Self, SensitivityError> {
        check(system, by, equations)?;
        let variation = Variation::new(system, by, equations, false)?;
        let (count, nv) = (variation.count(), variation.nv());
        let extended = variation.system.clone();
        quantities.iter().try_for_each(|of| check_quantity(*of, &extended))?;
        let mut ones = Sensitivity::clone(by);
        let others = 3 * (nv + extended.elements.len());
        let one = || Parameter { name: String::new(), value: 0.0, typical: 1.0, seeds: Vec::new() };
        ones.parameters.extend(std::iter::repeat_with(one).take(others));
        let rows = Variation::new(system, &Arc::new(ones), equations, false)?;
        let mut own = Self {
            variation,
            rows,
            laws: Vec::new(),
            quantities: quantities.to_vec(),
            step: None,
            tape: Tape {
                count,
                nv,
                quantities: quantities.len(),
                begin: Begin::default(),
                layouts: Vec::new(),
                entries: Entries::default(),
                rests: Vec::new(),
                starts: Vec::new(),
            },
        };
        own.tell_rows();
        own.take_seeds(by);
        own.begin_laws(by, equations, start.t)?;
        own.see_start(equations, start)?;
        own.tape.begin.gradients = own.variation.nodes[0].gradients.clone();
        Ok(own)
    }

    /// Takes over what was kept of the same start: rows of t = 0 are told already.
    pub(crate) fn take_start(&mut self, earlier: Self) {
        let own = std::mem::replace(&mut self.tape.entries, earlier.tape.entries);
        own.into_all().for_each(|entry| self.tape.entries.push(entry));
    }

    /// Ones stand for what rows are told.
    fn tell_rows(&mut self) {
        let (count, parameters, nv) = (self.rows.count(), self.tape.count, self.tape.nv);
        let row = &mut self.rows.nodes[ROW];
        for (place, blocks) in [&mut row.q, &mut row.v, &mut row.a].into_iter().enumerate() {
            (0..nv).for_each(|k| blocks[k * count + parameters + place * nv + k] = 1.0);
        }
        for (e, element) in self.rows.elements.iter_mut().enumerate() {
            let first = parameters + 3 * (nv + e);
            element.row.iter_mut().enumerate().for_each(|(k, block)| block[first + k] = 1.0);
        }
    }

    /// What parameters change for good, and at the start.
    fn take_seeds(&mut self, by: &Sensitivity) {
        let Self { variation, tape, .. } = self;
        for (p, seed) in
            by.parameters.iter().enumerate().flat_map(|(p, own)| own.seeds.iter().map(move |seed| (p, seed)))
        {
            match seed {
                Seed::Position { velocity, by } => tape.starts.push((variation.own_v[*velocity], p, [*by, 0.0])),
                Seed::Velocity { velocity, by } => tape.starts.push((variation.own_v[*velocity], p, [0.0, *by])),
                Seed::Place { velocity, by } => tape.starts.push((*velocity, p, [*by, 0.0])),
                _ => {}
            }
        }
        for (e, element) in variation.elements.iter().enumerate() {
            let moved = element.rest.iter().enumerate().filter(|(_, by)| **by != 0.0);
            tape.rests.extend(moved.map(|(p, by)| (e, p, *by)));
        }
    }

    fn begin_laws(&mut self, by: &Sensitivity, equations: &Equations, t: f64) -> Result<(), SensitivityError> {
        let system = self.variation.system.clone();
        for (e, element) in system.elements.iter().enumerate() {
            let Some(state) = equations.bank.law_state(e) else {
                return refuse(format!("\"{}\", which has a named scheme", element.name));
            };
            let law = |p: usize| -> Option<Network> {
                by.parameters[p].seeds.iter().find_map(|seed| match seed {
                    Seed::Law { element, law } if *element == e => Some(law.clone()),
                    _ => None,
                })
            };
            let is_input = |seed: &Seed| matches!(seed, Seed::Input { element, .. } if *element == e);
            let moves_input = |p: usize| by.parameters[p].seeds.iter().any(is_input);
            let own: Vec<usize> = (0..self.tape.count).filter(|&p| law(p).is_some() || moves_input(p)).collect();
            if own.iter().any(|&p| moves_clock(&element.law, law(p).as_ref(), moves_input(p))) {
                return refuse(format!("the clock of \"{}\", which temperature moves,", element.name));
            }
            let moves_inputs = own.iter().any(|&p| moves_input(p)).then_some(element.inputs.len());
            let mut probe = LawProbe::new(&element.law, own.clone(), moves_inputs, state);
            tell_inputs(&mut probe, by, (e, 0), t);
            let at = equations.bank.point(e, 0);
            let laws = own.iter().map(|&p| law(p));
            let [origins, variables] = probe.begin(&element.law, laws, &at, state).map_err(|leaf| {
                SensitivityError::Unknown { what: format!("{leaf} in the law of \"{}\"", element.name) }
            })?;
            let mut kept = Sparse::default();
            let rows = origins.chunks_exact(probe.columns()).chain(variables.chunks_exact(probe.columns()));
            rows.enumerate().for_each(|(row, values)| kept.push_row(row, values));
            self.tape.begin.kept.push(kept);
            self.tape.layouts.push(Layout {
                columns: probe.columns(),
                ports: probe.ports.clone(),
                variables: (0..probe.variables()).map(|k| probe.variable(k)).collect(),
                parameters: own.iter().enumerate().map(|(place, p)| (probe.parameter(place), *p)).collect(),
            });
            self.laws.push(probe);
        }
        Ok(())
    }
}

/// Whether a parameter moves the clock of a law: by the numbers of its heat, or by its inputs.
fn moves_clock(law: &Network, by: Option<&Network>, moves_inputs: bool) -> bool {
    let Some(heated) = law.as_heated().filter(|heated| heated.heat().shift.is_some()) else { return false };
    let of_heat = heated.heat().numbers().len();
    let moves = |own: &Network| own.numbers().iter().take(of_heat).any(|number| number.slope != 0.0);
    moves_inputs || by.is_some_and(moves)
}

/// Tells what parameters change of the inputs of element `e` at a point, at `t`.
pub(super) fn tell_inputs(probe: &mut LawProbe, by: &Sensitivity, (e, point): (usize, usize), t: f64) {
    if !probe.moves_inputs() {
        return;
    }
    probe.still_inputs(point);
    for (place, p) in probe.parameters.clone().into_iter().enumerate() {
        for seed in &by.parameters[p].seeds {
            let Seed::Input { element, input, by } = seed else { continue };
            if *element == e {
                let change = by.at(t);
                let [value, rate] = probe.input_mut(point, *input, place);
                (*value, *rate) = (*value + change.value, *rate + change.first);
            }
        }
    }
}

/// What cannot be gone back through.
fn check(system: &System, by: &Sensitivity, equations: &Equations) -> Result<(), SensitivityError> {
    if matches!(system.motion, Motion::Given(_)) {
        return refuse("a given motion");
    }
    if !system.model.is_one_degree() {
        return refuse("joints with quaternions");
    }
    if equations.control.is_some() || !system.control.is_empty() {
        return refuse("forces and inputs that follow from the state");
    }
    if equations.rubs() {
        return refuse("friction that sticks");
    }
    if let Some(event) = system.events.iter().find(|event| matches!(event.action, Action::Set(_))) {
        return refuse(format!("event \"{}\", which sets something", event.name));
    }
    for element in &system.elements {
        let of = |what: &str| refuse(format!("{what} \"{}\"", element.name));
        let law = &element.law;
        let keeps = law.has_inner_variables() || law.has_memories();
        if law.is_thermal() {
            return of("the warming of");
        }
        if law.jumps() {
            return of("the jumps of the force of");
        }
        if keeps && !element.past.is_of_derivative() {
            return of("the past of");
        }
        if law.has_memories() && element.derivative == Derivative::RiemannLiouville {
            return of("the Riemann-Liouville start of");
        }
    }
    for parameter in &by.parameters {
        let known = |seed: &Seed| {
            matches!(
                seed,
                Seed::Position { .. }
                    | Seed::Velocity { .. }
                    | Seed::Law { .. }
                    | Seed::Rest { .. }
                    | Seed::Input { .. }
                    | Seed::Drive { .. }
                    | Seed::When { .. }
                    | Seed::WhenOfTime { .. }
                    | Seed::Damping { .. }
                    | Seed::Friction { .. }
                    | Seed::Inertia(_)
                    | Seed::Gravity(_)
                    | Seed::Place { .. }
            )
        };
        if !parameter.seeds.iter().all(known) {
            return refuse(format!("what \"{}\" moves: a time at which something switches", parameter.name));
        }
    }
    Ok(())
}

/// Rows of which something is not known.
fn check_quantity(of: Quantity, system: &System) -> Result<(), SensitivityError> {
    match of {
        Quantity::Element(e, ElementQuantity::Stored) if system.elements[e].law.has_memories() => {
            refuse(format!("the stored energy of \"{}\"", system.elements[e].name))
        }
        Quantity::Element(e, ElementQuantity::Dissipated | ElementQuantity::Input | ElementQuantity::Told(_)) => {
            refuse(format!("works, and what laws tell of themselves, of \"{}\"", system.elements[e].name))
        }
        Quantity::Energy(EnergyQuantity::Actuators | EnergyQuantity::Joints) => refuse("works"),
        Quantity::GripperError => refuse("how far the gripper is off"),
        of if has_derivative(of) => Ok(()),
        _ => refuse("a column that has no derivative"),
    }
}
