//! How large the terms of gravity are that joints feel, as they are before they cancel: of a slider that lies across the weight that it carries, none.

use crate::dynamics::Kinematics;
use crate::model::{JointMotion, Model};
use crate::spatial::Rotation;

/// Along the axes of each link, m/s² and N: sums of magnitudes, never more than what is added up.
#[derive(Debug, Default)]
pub(super) struct Weights {
    gravity: Vec<[f64; 3]>,
    carried: Vec<[f64; 3]>,
    /// |g|.
    whole: f64,
}

/// Σ_k |R_ki| x_k, the terms of x in the axes of a link whose frame is `link`, seen from one whose frame is `from`; or the other way.
fn turned(from: &Rotation, link: &Rotation, x: [f64; 3], outwards: bool, most: f64) -> [f64; 3] {
    std::array::from_fn(|i| {
        let term = |k: usize| {
            let (one, other) =
                if outwards { (from.column(k), link.column(i)) } else { (from.column(i), link.column(k)) };
            one.dot(other).abs() * x[k]
        };
        (term(0) + term(1) + term(2)).min(most)
    })
}

/// Whether a joint may feel less than all of them: what follows a joint counts with it, wherever it is.
fn are_told(model: &Model) -> bool {
    model.is_free_of_followers() && (0..model.joint_count()).any(|j| model.motion(j) == JointMotion::Prismatic)
}

impl Weights {
    /// Takes them where the links are: outwards gravity, as it is turned from link to link, and inwards the weights that add up.
    pub(super) fn take(&mut self, model: &Model, kinematics: &Kinematics) {
        let Self { gravity, carried, whole } = self;
        *whole = model.gravity().iter().map(|g| g * g).sum::<f64>().sqrt();
        carried.clear();
        if !are_told(model) {
            return;
        }
        let (n, g) = (model.joint_count(), model.gravity().map(f64::abs));
        let rotation = |link: usize| &kinematics.link(link).rotation;
        gravity.clear();
        for j in 0..n {
            let parent = model.parent_link(j);
            let above = parent.checked_sub(1).map_or(g, |parent| gravity[parent]);
            gravity.push(turned(rotation(parent), rotation(j + 1), above, true, *whole));
        }
        carried.extend(gravity.iter().enumerate().map(|(j, g)| g.map(|g| model.link_inertia(j).mass * g)));
        for j in (0..n).rev() {
            let Some(parent) = model.parent_link(j).checked_sub(1) else { continue };
            let most = model.subtree_mass(j) * *whole;
            let moved = turned(rotation(parent + 1), rotation(j + 1), carried[j], false, most);
            carried[parent].iter_mut().zip(moved).for_each(|(sum, own)| *sum += own);
        }
    }

    /// What joint `j` feels of them for each kilogram that it carries, m/s²: all of it, unless it slides.
    pub(super) fn felt(&self, model: &Model, j: usize) -> f64 {
        let (Some([_, _, along]), mass) = (self.carried.get(j), model.subtree_mass(j)) else { return self.whole };
        let is_told = model.motion(j) == JointMotion::Prismatic && mass > 0.0;
        if is_told { (along / mass).min(self.whole) } else { self.whole }
    }
}
