//! What outlasts a step of what parameters change.

use super::energies::WorksDone;
use super::saltation::Saltation;
use super::singular::SingularState;
use super::sizes::SizesSoFar;
use super::{NodeVariation, Variation};
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
        let control = self.control.as_ref().map(|control| control.save());
        VariationState {
            motion: [q.clone(), v.clone(), a.clone()],
            sizes: self.sizes.so_far.clone(),
            singular: self.singular.save(self.count()),
            laws,
            control,
            saltation: self.saltation.clone(),
            works: self.works.save(),
            accelerated: self.one_size.as_ref().is_some_and(|one_size| one_size.accelerated[0]),
        }
    }

    /// Goes on from what was saved where the run is at `start`; `false` where that is of another one.
    pub(crate) fn load(&mut self, state: VariationState, equations: &Equations, start: Node) -> bool {
        let VariationState { motion: [q, v, a], sizes, singular, laws, control, saltation, works, accelerated } = state;
        let (blocks, count) = (self.nodes[0].q.len(), self.count());
        if !self.singular.load(singular, count)
            || laws.len() != self.elements.len()
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
        if let Some(one_size) = &mut self.one_size {
            one_size.accelerated = [accelerated, false];
        }
        true
    }
}
