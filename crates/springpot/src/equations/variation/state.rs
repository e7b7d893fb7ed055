//! What outlasts a step of what parameters change.

use super::energies::WorksDone;
use super::saltation::Saltation;
use super::singular::SingularState;
use super::sizes::SizesSoFar;
use super::{NodeVariation, ROW, Variation};
use crate::equations::assembly::Equations;
use crate::equations::control::ControlVariationState;
use crate::equations::node::Node;
use crate::law::variation::LawVariation;
use serde::{Deserialize, Serialize};

/// What of it outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct VariationState {
    /// Blocks of q, v and a where the next step starts.
    motion: [Vec<f64>; 3],
    sizes: SizesSoFar,
    singular: SingularState,
    laws: Vec<LawVariation>,
    /// Blocks of inputs there, as the last step left them: on the side of a kink that it was on.
    inputs: Vec<[Vec<f64>; 2]>,
    saltation: Saltation,
    works: WorksDone,
    control: Option<ControlVariationState>,
    /// Whether the accelerations there are known, of steps of one size.
    accelerated: bool,
}

impl Variation {
    /// What outlasts the steps.
    pub(crate) fn save(&self) -> VariationState {
        let [NodeVariation { q, v, a, .. }, ..] = &self.nodes;
        let laws = self.elements.iter().map(|element| element.law.clone()).collect();
        let at_start = |blocks: &Vec<f64>| blocks[..blocks.len() / (ROW + 1)].to_vec();
        let inputs = self.elements.iter().map(|element| element.inputs.each_ref().map(at_start)).collect();
        let control = self.control.as_ref().map(|control| control.save());
        VariationState {
            motion: [q.clone(), v.clone(), a.clone()],
            sizes: self.sizes.so_far.clone(),
            singular: self.singular.save(self.count()),
            laws,
            inputs,
            control,
            saltation: self.saltation.clone(),
            works: self.works.save(),
            accelerated: self.one_size.as_ref().is_some_and(|one_size| one_size.accelerated[0]),
        }
    }

    /// Goes on from what was saved where the run is at `start`; `false` where that is of another one.
    pub(crate) fn load(&mut self, state: VariationState, equations: &Equations, start: Node) -> bool {
        let VariationState { motion, sizes, singular, laws, inputs, control, saltation, works, accelerated } = state;
        let [q, v, a] = motion;
        let (blocks, count) = (self.nodes[0].q.len(), self.count());
        if !self.singular.load(singular, count)
            || [laws.len(), inputs.len()] != [self.elements.len(); 2]
            || !sizes.fits(&self.sizes.so_far)
            || !saltation.fits(self.count())
            || !self.works.load(works)
            || [&q, &v, &a].into_iter().any(|own| own.len() != blocks)
        {
            return false;
        }
        let controls = match (&mut self.control, control, &equations.control) {
            (Some(own), Some(state), Some(run)) => own.load(run, state),
            (own, state, _) => own.is_none() && state.is_none(),
        };
        if !controls {
            return false;
        }
        let [node, ..] = &mut self.nodes;
        (node.q, node.v, node.a, self.sizes.so_far) = (q, v, a, sizes);
        self.place_nodes();
        self.saltation = saltation;
        self.elements.iter_mut().zip(laws).for_each(|(element, law)| element.law = law);
        self.see_start(equations, start);
        for (own, known) in self.elements.iter_mut().zip(inputs) {
            for (own, known) in own.inputs.iter_mut().zip(known) {
                let at_start = own.len() / (ROW + 1);
                if known.len() != at_start {
                    return false;
                }
                own[..at_start].copy_from_slice(&known);
            }
        }
        if let Some(one_size) = &mut self.one_size {
            one_size.accelerated = [accelerated, false];
        }
        true
    }
}
