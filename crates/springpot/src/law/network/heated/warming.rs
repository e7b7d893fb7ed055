//! The temperature of a step: told, or found together with the losses.

use super::{Heated, Own, Values};
use crate::collocation::{MAX_NODES, Nodes};
use crate::law::heat::Thermal;
use crate::law::state::StateRef;
use crate::law::step::{InputValue, Step};

/// Iterations for the temperatures at the nodes.
const MOST_ITERATIONS: usize = 40;

/// Change of the temperatures, in units of them, at which they end.
const ENOUGH: f64 = 1e-13;

/// Temperatures beyond which a search for them has gone astray, K.
const ASTRAY: [f64; 2] = [1.0, 1e4];

/// T and T' at the start and at the nodes of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Temperatures {
    pub(super) temperature: Values,
    pub(super) warming: Values,
}

impl Temperatures {
    pub(super) fn at(&self, k: usize) -> InputValue {
        InputValue { value: self.temperature[k], rate: self.warming[k] }
    }

    /// What flows to the surroundings, W.
    pub(super) fn flows(&self, thermal: &Thermal) -> Values {
        self.temperature.map(|temperature| thermal.conductance * (temperature - thermal.ambient))
    }
}

impl Heated {
    /// The temperatures of the step as they are told; of a state as if it stayed where it is.
    pub(super) fn told(&self, step: &Step, own: &Own) -> Option<Temperatures> {
        let mut course = Temperatures { temperature: [own.temperature; 5], warming: [own.warming; 5] };
        if self.heat.thermal.is_none() {
            for k in 0..=step.nodes.count() {
                let seen = self.seen(step.point(k).inputs);
                (course.temperature[k], course.warming[k]) = (seen.value, seen.rate);
            }
        }
        course.temperature.iter().take(step.nodes.count() + 1).all(|t| t.is_finite()).then_some(course)
    }

    /// The temperatures of the step, whose law has this share of the state: T_i = T_0 + h Σ_j A_ij T'_j by iteration for the losses, which hardly follow the
    /// temperature within a step, while the flow to the surroundings is solved with it.
    pub(super) fn course(&self, step: &Step, own: &Own, state: StateRef) -> Option<Temperatures> {
        let mut course = self.told(step, own)?;
        let Some(thermal) = &self.heat.thermal else { return Some(course) };
        let (count, matrix) = (step.nodes.count(), step.matrix());
        let (share, start) = (step.h / thermal.capacity, own.temperature);
        let inverse = implicit(&matrix, share * thermal.conductance, count);
        for _ in 0..MOST_ITERATIONS {
            let inside = self.inside(step, own, &course);
            let powers = self.powers_of(step, &inside, &mut state.clone());
            let lost = |k: usize| powers[k].dissipation - thermal.conductance * (start - thermal.ambient);
            // As differences to the temperature at the start, of which no digits are lost.
            let driven: [f64; MAX_NODES] = std::array::from_fn(|i| {
                if i < count { share * (0..count).map(|j| matrix[i][j] * lost(j + 1)).sum::<f64>() } else { 0.0 }
            });
            let (mut change, mut next) = (0.0f64, course);
            for i in 0..count {
                next.temperature[i + 1] = start + (0..count).map(|j| inverse[i][j] * driven[j]).sum::<f64>();
            }
            for k in 0..=count {
                let flow = thermal.conductance * (next.temperature[k] - thermal.ambient);
                next.warming[k] = (powers[k].dissipation - flow) / thermal.capacity;
                let moved = next.temperature[k] - course.temperature[k];
                let turned = step.h * (next.warming[k] - course.warming[k]);
                // Not `max`, which would pass over what is no number.
                for moved in [moved.abs(), if self.heat.expansion.is_some() { turned.abs() } else { 0.0 }] {
                    change = if moved > change || moved.is_nan() { moved } else { change };
                }
            }
            course = next;
            if change.is_nan() || !course.temperature[..=count].iter().all(|t| (ASTRAY[0]..ASTRAY[1]).contains(t)) {
                return None;
            }
            if change <= ENOUGH * start {
                return Some(course);
            }
        }
        None
    }

    /// T, the heat lost and T' at the end of a step.
    pub(super) fn end(&self, thermal: &Thermal, step: &Step, own: &Own, course: &Temperatures) -> [f64; 3] {
        let (count, matrix, flows) = (step.nodes.count(), step.matrix(), course.flows(thermal));
        // The middle of a step stands for the whole of it.
        let weights = match step.nodes {
            Nodes::Midpoint => [1.0, 0.0, 0.0, 0.0],
            _ => matrix[count - 1],
        };
        let over = |values: &Values| step.h * (0..count).map(|j| weights[j] * values[j + 1]).sum::<f64>();
        [own.temperature + over(&course.warming), own.lost + over(&flows), course.warming[count]]
    }
}

/// (I + `factor` A)⁻¹ over the leading `count` rows.
pub(super) fn implicit(
    matrix: &[[f64; MAX_NODES]; MAX_NODES],
    factor: f64,
    count: usize,
) -> [[f64; MAX_NODES]; MAX_NODES] {
    let mut system = [[0.0; 2 * MAX_NODES]; MAX_NODES];
    for i in 0..count {
        (0..count).for_each(|j| system[i][j] = factor * matrix[i][j]);
        system[i][i] += 1.0;
        system[i][MAX_NODES + i] = 1.0;
    }
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| system[a][k].abs().total_cmp(&system[b][k].abs())).unwrap_or(k);
        system.swap(k, pivot);
        let scale = system[k][k].recip();
        system[k].iter_mut().for_each(|entry| *entry *= scale);
        let row = system[k];
        for (i, other) in system.iter_mut().enumerate().take(count) {
            let factor = if i == k { 0.0 } else { other[k] };
            other.iter_mut().zip(row).for_each(|(entry, pivot)| *entry -= factor * pivot);
        }
    }
    system.map(|row| std::array::from_fn(|j| row[MAX_NODES + j]))
}
