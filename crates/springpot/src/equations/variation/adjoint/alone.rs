//! The robot of a run over steps that are gone back through by their own equations: as it is, whatever parameters change of it. What they change of
//! places, inertias and gravity is weighed on the way back ([`super::weighing`]).

use super::step::POINTS;
use crate::collocation::STAGES;
use crate::dynamics::{Abreast, Sought, Workspace};
use crate::elements::Measure;
use crate::equations::node::Node;
use crate::equations::variation::NodeVariation;
use crate::equations::variation::seen::see_all;
use crate::system::{Motion, System};

/// The robot at the start and at the stages of a step, side by side.
#[derive(Debug)]
pub(in crate::equations::variation) struct Alone {
    system: System,
    own: Vec<usize>,
    abreast: Abreast,
    workspace: Workspace,
    pub(super) nodes: [NodeVariation; POINTS],
    /// Forces of the elements at the start and at the stages, node by node.
    pub(super) force: Vec<f64>,
    /// The node where the next step starts, where that was not seen by what parameters change; it is the first one as long as a step is at hand.
    pub(super) ahead: Option<usize>,
}

/// The two points of every measure that has no more, and which it is.
pub(in crate::equations::variation) fn lines(system: &System) -> Vec<(usize, [crate::model::Site; 2])> {
    let measures = system.elements.iter().map(|element| &element.measure).enumerate();
    let lines = measures.filter_map(|(e, measure)| match measure {
        Measure::Line(line) => Some((e, [line.from, line.to])),
        _ => None,
    });
    lines.collect()
}

impl Alone {
    pub(in crate::equations::variation) fn of(system: &System) -> Self {
        let (system, model) = (system.clone(), &system.model);
        let start = match &system.motion {
            Motion::Forward(forward) => forward.q.clone(),
            Motion::Given(_) => model.neutral(),
        };
        let sought = Sought { moves: vec![true; model.nv()], lines: lines(&system), ..Sought::default() };
        Self {
            own: (0..model.nv()).collect(),
            abreast: Abreast::new(model, sought),
            workspace: Workspace::new(model),
            nodes: std::array::from_fn(|_| NodeVariation::new(&system, &start, (0, 0))),
            force: vec![0.0; POINTS * system.elements.len()],
            ahead: None,
            system,
        }
    }

    /// Looks at a step that starts where the last one ended and has its stages there, where element e pulls with `force(e, stage)`.
    pub(super) fn see(&mut self, at: [Node; POINTS], pull: impl Fn(usize, usize) -> f64) {
        let Self { system, own, abreast, workspace, nodes, force, ahead, .. } = self;
        let elements = system.elements.len();
        force.copy_within(STAGES * elements.., 0);
        for (place, force) in force[elements..].iter_mut().enumerate() {
            *force = pull(place % elements, place / elements);
        }
        *ahead = ahead.map(|_| 0);
        for (node, at) in nodes.iter_mut().zip(at) {
            node.t = at.t;
            for (to, from) in [(&mut node.q_now, at.q), (&mut node.v_now, at.v), (&mut node.a_now, at.a)] {
                to.copy_from_slice(from);
            }
        }
        see_all(abreast, &system.model, nodes);
        let sought = &abreast.sought;
        if sought.lines.len() < system.elements.len() {
            let is_other = |e: usize| sought.lines.iter().all(|(line, _)| *line != e);
            nodes.iter_mut().for_each(|node| node.measure_all((system, own), &sought.moves, workspace, is_other));
        }
        for (i, node) in nodes.iter_mut().enumerate().skip(1) {
            node.pull_and_resist((system, own), &force[i * elements..(i + 1) * elements]);
        }
    }
}
