//! What parameters change of inertias and of the field of gravity, seeds of all of them side by side.

use crate::sensitivity::{Seed, Sensitivity};
use crate::spatial::Inertia;

/// What parameters change of inertias and gravity: parameter, joint or velocity of the extended robot, by how much.
#[derive(Debug, Default)]
pub(super) struct Inertias {
    pub(super) links: Vec<(usize, usize, Inertia)>,
    pub(super) rotors: Vec<(usize, usize, f64)>,
    pub(super) fields: Vec<(usize, [f64; 3])>,
}

impl Inertias {
    pub(super) fn of(by: &Sensitivity) -> Self {
        let mut own = Self::default();
        for (p, parameter) in by.parameters.iter().enumerate() {
            for seed in &parameter.seeds {
                match seed {
                    Seed::Inertia(change) => {
                        let links = (0..change.joint_count()).map(|j| (p, j, *change.link_inertia(j)));
                        own.links.extend(links.filter(|(_, _, inertia)| *inertia != Inertia::ZERO));
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
}
