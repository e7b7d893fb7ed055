//! What parameters change of the elements of a bank.

use super::{Banked, ElementBank, Kept, StepShape, Told};
use crate::collocation::Nodes;
use crate::law::variation::{
    LawVariation, ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError,
};
use crate::law::{Point, Response, State, Step, When};

/// How far towards the node before it the last node leans, as a share: more than a step may end behind a kink.
const LEANS: f64 = 2e-7;

/// The last node of a step as an element was told it, and what it answered.
#[derive(Debug)]
pub(crate) struct LastNode {
    stroke: f64,
    rate: f64,
    response: Box<Response>,
}

impl ElementBank {
    /// Tells element `e` that the last node of the step is a little nearer to the one before, and asks it anew.
    pub(crate) fn lean(&mut self, e: usize) -> LastNode {
        let (last, element) = (self.step.nodes.count(), &mut self.elements[e]);
        let Told { stroke, rate, .. } = &mut element.told;
        let kept = LastNode { stroke: stroke[last], rate: rate[last], response: Box::new(element.response) };
        for told in [stroke, rate] {
            told[last] += LEANS * (told[last - 1] - told[last]);
        }
        self.evaluate_element(e);
        kept
    }

    /// Tells element `e` the last node as it was.
    pub(crate) fn stand(&mut self, e: usize, LastNode { stroke, rate, response }: LastNode) {
        let (last, element) = (self.step.nodes.count(), &mut self.elements[e]);
        (element.told.stroke[last], element.told.rate[last], element.response) = (stroke, rate, *response);
    }

    /// The state of the law of element `e`; none where it takes no part.
    pub(crate) fn law_state(&self, e: usize) -> Option<&State> {
        self.elements[e].kept.as_ref().map(|kept| &kept.state)
    }

    /// What changes of the forces of element `e` at the nodes where strokes and rates there stay ([`crate::law::Leaf::vary`]).
    pub(crate) fn vary(&self, e: usize, by: &StepVariation, own: &LawVariation, forces: &mut [f64]) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.vary(&told.step(self.step), state, by, own, forces);
        }
    }

    /// What it answers to the step, with the tangents that derivatives take where those of the step are others ([`crate::law::Network`]).
    pub(crate) fn exact_response(&self, e: usize) -> Option<Response> {
        let Banked { law, kept, told, .. } = &self.elements[e];
        let Kept { state, .. } = kept.as_ref()?;
        law.evaluate_exactly(&told.step(self.step), state)
    }

    /// Adds what changes of the energy flows of element `e` at the start and at the nodes of the step; nothing of a law whose energies are unknown.
    pub(crate) fn vary_powers(&self, e: usize, by: &StepVariation, own: &LawVariation, sum: &mut PowersVariation) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept.as_ref().filter(|kept| kept.state.is_accounted()) {
            law.vary_powers(&told.step(self.step), state, by, own, sum);
        }
    }

    /// Adds what changes of the energy flows of element `e`, whose law keeps nothing, at one time, where it is told `at`: of what is dissipated, and of
    /// what inputs supply.
    pub(crate) fn vary_powers_at(
        &self,
        e: usize,
        at: &Point,
        by: &PointVariation,
        own: &LawVariation,
        sums: [&mut [f64]; 2],
    ) {
        let Banked { law, kept: Some(Kept { state, .. }), told, .. } = &self.elements[e] else { return };
        let (count, twice) = (own.count, [0, 1]);
        let (stroke, rate, inputs) = (twice.map(|_| at.stroke), twice.map(|_| at.rate), at.inputs.repeat(2));
        let step = told.step(StepShape { nodes: Nodes::One, ..self.step });
        let step = Step { stroke: &stroke, rate: &rate, inputs: &inputs, ..step };
        let [stroke, rate] = [by.stroke, by.rate].map(|block| block.repeat(2));
        let inputs = by.inputs.map(|blocks| blocks.repeat(2));
        let inputs = inputs.each_ref().map(Vec::as_slice);
        let told = StepVariation { count, stroke: &stroke, rate: &rate, inputs, passed: None };
        let mut flows = [(); 2].map(|()| vec![0.0; 2 * count]);
        let [dissipation, input] = &mut flows;
        law.vary_powers(&step, state, &told, own, &mut PowersVariation { dissipation, input });
        for (sum, flows) in sums.into_iter().zip(&flows) {
            sum.iter_mut().zip(&flows[count..]).for_each(|(sum, flow)| *sum += flow);
        }
    }

    /// Hands over how well the step knows what changes of the inner variables of element `e`, each with its number.
    pub(crate) fn vary_errors(&self, e: usize, by: &StepVariation, own: &LawVariation, take: TakeError) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.vary_errors(&told.step(self.step), state, by, own, take);
        }
    }

    /// Takes what changes of the step into what changes of the state of element `e`; to be called before [`ElementBank::commit`].
    pub(crate) fn commit_variation(&self, e: usize, by: &StepVariation, own: &mut LawVariation) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.commit_variation(&told.step(self.step), state, by, own);
        }
    }

    /// What changes of the singular forces of element `e` at the nodes ([`crate::law::Leaf::vary_singular`]).
    pub(crate) fn vary_singular(&self, e: usize, by: &StepVariation, own: &LawVariation, forces: &mut [f64]) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.vary_singular(&told.step(self.step), state, by, own, forces);
        }
    }

    /// Adds what changes of the singular forces of element `e` at the time of `at`, and of their integrals since `from`.
    pub(crate) fn vary_singularity(
        &self,
        e: usize,
        at: (f64, &Point),
        by: &PointVariation,
        own: &LawVariation,
        sums: [&mut [f64]; 3],
    ) {
        let Banked { law, kept, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.vary_singularity(at, state, by, own, sums);
        }
    }

    /// Adds what changes of element `e` at t_n + θh of the step, where it is told `at`.
    pub(crate) fn vary_at(
        &self,
        e: usize,
        (theta, at): (f64, &Point),
        by: &PointVariation,
        own: &LawVariation,
        sum: &mut ObservationVariation,
    ) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.vary_at((When::Within(&told.step(self.step), theta), at), state, by, own, sum);
        }
    }

    /// Adds what changes of element `e` between two steps, where it is told `at`; of a row, which is at t = 0 in the state there.
    pub(crate) fn vary_now(
        &self,
        e: usize,
        (at, is_row): (&Point, bool),
        by: &PointVariation,
        own: &LawVariation,
        sum: &mut ObservationVariation,
    ) {
        let Banked { law, kept, .. } = &self.elements[e];
        let Some(Kept { state, .. }) = kept else { return };
        let (state, own) = if is_row { (state.seen_at(at.t), own.seen_at(at.t)) } else { (state, own) };
        law.vary_at((When::Between, at), state, by, own, sum);
    }
}
