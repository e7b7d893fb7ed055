//! All that parameters change and that outlasts a step, block by block.

use crate::equations::variation::Variation;
use crate::fractional::MemoryTangent;
use crate::system::sensitivity::Lost;

impl Variation {
    /// Every block, in an order of its own; of memories what they keep beside their modes.
    ///
    /// Not among them are what no step changes (numbers of laws, geometry, energies at t = 0), and what follows from the others ([`Self::stand_again`]).
    pub(super) fn each_block(&mut self, take: &mut dyn FnMut(&mut [f64])) {
        let count = self.count();
        let Self { nodes: [start, ..], own_v, elements, saltation, singular, works, control, .. } = self;
        for blocks in [&mut start.q, &mut start.v, &mut start.a] {
            own_v.iter().for_each(|k| take(&mut blocks[k * count..(k + 1) * count]));
        }
        for element in elements.iter_mut() {
            element.law.variables_mut().chunks_exact_mut(count).for_each(&mut *take);
            for memory in element.law.memories_mut() {
                memory.kept_mut().into_iter().for_each(&mut *take);
            }
        }
        singular.each_block(count, take);
        saltation.each_block(take);
        works.each_block(take);
        if let Some(control) = control {
            control.each_block(take);
        }
    }

    /// Its memories, those of the elements first.
    pub(super) fn memories_mut(&mut self) -> impl Iterator<Item = &mut MemoryTangent> {
        let Self { elements, control, .. } = self;
        let of_control = control.iter_mut().flat_map(|control| control.memories_mut());
        elements.iter_mut().flat_map(|element| element.law.memories_mut()).chain(of_control)
    }

    /// What ended, column by column, and is whole again then.
    pub(super) fn take_lost(&mut self) -> Vec<Lost> {
        self.saltation.lost.iter_mut().filter_map(Option::take).collect()
    }

    /// Works out what follows from the blocks where the step starts, which are others.
    pub(super) fn stand_again(&mut self, equations: &crate::equations::Equations) {
        self.memories_mut().for_each(MemoryTangent::take_origin);
        if let Some(control) = &mut self.control {
            control.stand_again();
        }
        self.look_at_inputs(0, self.nodes[0].t);
        (0..self.elements.len()).for_each(|e| self.measure(e, 0));
        self.feed_back(0);
        if self.singular.is_there && self.one_size.is_none() {
            self.share_forces(equations);
        }
    }
}
