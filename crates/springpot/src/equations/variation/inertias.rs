//! What parameters change of inertias and of the field of gravity, seeds of all of them side by side.

use crate::spatial::Inertia;
use crate::system::sensitivity::{Seed, Sensitivity};

/// What parameters change of inertias and gravity: parameter, velocity of the extended robot, by how much.
#[derive(Debug, Default)]
pub(super) struct Inertias {
    /// By joint of the extended robot, with parameter and change.
    links: Vec<(usize, Vec<(usize, Inertia)>)>,
    pub(super) rotors: Vec<(usize, usize, f64)>,
    fields: Vec<(usize, [f64; 3])>,
}

impl Inertias {
    pub(super) fn of(by: &Sensitivity) -> Self {
        let mut own = Self::default();
        for (p, parameter) in by.parameters.iter().enumerate() {
            for seed in &parameter.seeds {
                match seed {
                    Seed::Inertia(change) => {
                        let links = (0..change.joint_count()).map(|j| (j, *change.link_inertia(j)));
                        for (joint, inertia) in links.filter(|(_, inertia)| *inertia != Inertia::ZERO) {
                            match own.links.iter_mut().find(|(other, _)| *other == joint) {
                                Some((_, changes)) => changes.push((p, inertia)),
                                None => own.links.push((joint, vec![(p, inertia)])),
                            }
                        }
                        let rotors = change.felt_rotors().iter().enumerate().map(|(k, rotor)| (p, k, *rotor));
                        own.rotors.extend(rotors.filter(|(_, _, rotor)| *rotor != 0.0));
                    }
                    Seed::Gravity(change) => own.fields.push((p, change.gravity())),
                    _ => {}
                }
            }
        }
        own
    }

    /// Changes of links, joint by joint.
    pub(super) fn links(&self) -> Vec<(usize, Vec<Inertia>)> {
        let own = |changes: &[(usize, Inertia)]| changes.iter().map(|(_, change)| *change).collect();
        self.links.iter().map(|(joint, changes)| (*joint, own(changes))).collect()
    }

    /// Changes of gravity.
    pub(super) fn fields(&self) -> Vec<[f64; 3]> {
        self.fields.iter().map(|(_, change)| *change).collect()
    }

    /// Which parameter each of these is of, one after the other, those of links first.
    pub(super) fn parameters(&self) -> impl Iterator<Item = usize> + '_ {
        let links = self.links.iter().flat_map(|(_, changes)| changes.iter().map(|(p, _)| *p));
        links.chain(self.fields.iter().map(|(p, _)| *p))
    }
}
