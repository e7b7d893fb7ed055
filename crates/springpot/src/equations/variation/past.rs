//! What parameters change of what happened before t = 0, and of what that does at t = 0 at once.

use super::{ROW, Variation};
use crate::equations::assembly::Equations;
use crate::equations::node::Node;
use crate::equations::pose::State;
use crate::law::past::PastVariation;
use crate::law::{Past, Periodic};
use crate::system::System;
use crate::system::sensitivity::{Seed, SensitivityError};

impl Variation {
    /// What changes of the past of element `e`; of a steady one along the motion of `run`.
    pub(super) fn past_variation(&mut self, run: &System, e: usize) -> Result<PastVariation, SensitivityError> {
        let count = self.count();
        let mut changes = PastVariation { age: vec![0.0; count], strokes: vec![None; count] };
        match &run.elements[e].past {
            Past::OfDerivative => {}
            Past::Held(age) => {
                changes.age = self.of_seeds(|seed| match seed {
                    Seed::Age { element, by } if *element == e => by / age,
                    _ => 0.0,
                });
            }
            Past::Periodic(past) => {
                let (samples, period) = (past.count(), past.period());
                let mut strokes = vec![Vec::with_capacity(samples); count];
                for k in 0..samples {
                    let t = period * k as f64 / samples as f64;
                    let unknown = |_| SensitivityError::Unknown { what: format!("the motion at t = {t} s") };
                    let State { q, v, a } = run.state(t).map_err(unknown)?;
                    self.look(ROW, Node { t, q: &q, v: &v, a: &a });
                    self.take_start(ROW);
                    self.measure(e, ROW);
                    let own = &self.elements[e].stroke[ROW * count..(ROW + 1) * count];
                    strokes.iter_mut().zip(own).for_each(|(strokes, own)| strokes.push(*own));
                }
                changes.strokes = strokes.iter().map(|own| Some(Periodic::new(period, own).0)).collect();
            }
        }
        Ok(changes)
    }

    /// Pushes what changes of the free velocities as the impulses of elements at t = 0 do, of each that has one ([`Equations::kick`]):
    /// M δΔv = −(δM Δv + Σ δg J + g δJ).
    pub(super) fn kick(
        &mut self,
        equations: &Equations,
        jolts: &[Option<(f64, Vec<f64>)>],
        [before, start]: [Node; 2],
    ) {
        if jolts.iter().all(Option::is_none) {
            return;
        }
        let (count, n, free) = (self.count(), self.nv(), self.of_run(equations.free()));
        let mut moved = vec![0.0; n];
        for (k, (after, before)) in self.own_v.iter().zip(start.v.iter().zip(before.v)) {
            moved[*k] = after - before;
        }
        let mut owed = self.change_of_mass(&moved);
        let [node, ..] = &self.nodes;
        for (e, (impulse, changes)) in jolts.iter().enumerate().filter_map(|(e, jolt)| Some((e, jolt.as_ref()?))) {
            for (k, owed) in owed.chunks_exact_mut(count.max(1)).enumerate() {
                let pull = node.gradients[e][0][k];
                owed.iter_mut().zip(changes).for_each(|(owed, change)| *owed += pull * change);
                for (c, places) in node.q.chunks_exact(count.max(1)).enumerate() {
                    let bend = impulse * node.hessians[e][k * n + c];
                    owed.iter_mut().zip(places).for_each(|(owed, place)| *owed += bend * place);
                }
            }
        }
        let mut pushed = vec![0.0; n * count];
        let regular = {
            let Self { nodes: [node, ..], room, .. } = self;
            !free.is_empty() && room.solve.factor_part(&node.slopes.d_a, n, &free)
        };
        if regular {
            self.solve_free(&free, &owed, &mut pushed);
        }
        let [node, ..] = &mut self.nodes;
        self.before_kick = Some(node.v.clone());
        node.v.iter_mut().zip(&pushed).for_each(|(v, pushed)| *v += pushed);
        self.see_start(equations, start);
    }
}
