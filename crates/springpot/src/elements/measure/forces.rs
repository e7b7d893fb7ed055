//! The forces of all elements in one state, as the rigid-body algorithms take them.

use super::{Bushing, Cable, Measure};
use crate::dynamics::{
    Kinematics, PairForce, RneaDerivatives, Workspace, aba_into, add_force, add_stiffness, rnea, rnea_at_into,
    rnea_derivatives_into,
};
use crate::model::Model;

/// The force of an element, and how it answers to its coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pull {
    /// F, N or N·m.
    pub(crate) force: f64,
    /// ∂F/∂y, 0 where the tangent is taken elsewhere.
    pub(crate) d_coordinate: f64,
    /// ∂F/∂y', likewise.
    pub(crate) d_rate: f64,
}

/// A force on a joint's coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointForce {
    pub(super) velocity: usize,
    /// ∂y/∂q.
    pub(super) slope: f64,
    pub(super) pull: Pull,
}

/// The forces of all elements in one state: along lines as pairs, all others as what they add to τ.
#[derive(Debug, Clone, Default)]
pub(crate) struct Forces {
    values: Vec<f64>,
    pub(super) pairs: Vec<PairForce>,
    pub(super) joints: Vec<JointForce>,
    pub(super) cables: Vec<(Cable, Pull)>,
    pub(super) bushings: Vec<(Bushing, Pull)>,
}

impl Pull {
    /// A force without a tangent.
    #[inline]
    pub(crate) const fn constant(force: f64) -> Self {
        Self { force, d_coordinate: 0.0, d_rate: 0.0 }
    }

    /// F, ∂F/∂y, ∂F/∂y'.
    #[inline]
    fn tangent(self) -> [f64; 3] {
        [self.force, self.d_coordinate, self.d_rate]
    }
}

impl Forces {
    /// Room for the forces along all `measures`, so that no push allocates.
    pub(crate) fn with_room_for<'m>(measures: impl Iterator<Item = &'m Measure>) -> Self {
        let mut forces = Self::default();
        measures.for_each(|measure| forces.push(measure, Pull::constant(0.0)));
        forces.clear();
        forces
    }

    pub(crate) fn clear(&mut self) {
        self.values.clear();
        self.pairs.clear();
        self.joints.clear();
        self.cables.clear();
        self.bushings.clear();
    }

    /// Adds the force of the next element.
    #[inline]
    pub(crate) fn push(&mut self, measure: &Measure, pull: Pull) {
        self.values.push(pull.force);
        measure.push(pull, self);
    }

    /// F of every element, in order.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// τ = RNEA(q, v, a) − ΣQ with Q_b = −F ∂y/∂q_b, of kinematics with velocities.
    #[inline]
    pub(crate) fn inverse_dynamics_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        (q, a): (&[f64], &[f64]),
        workspace: &mut Workspace,
        tau: &mut [f64],
    ) {
        rnea_at_into(model, kinematics, q, a, &self.pairs, workspace, tau);
        self.add_to(model, kinematics, tau);
    }

    /// [`Self::inverse_dynamics_into`], allocating.
    pub(crate) fn inverse_dynamics(&self, model: &Model, [q, v, a]: [&[f64]; 3]) -> Vec<f64> {
        let mut tau = rnea(model, q, v, a, &self.pairs);
        self.add_to(model, &Kinematics::at_position(model, q), &mut tau);
        tau
    }

    /// The accelerations under τ and these forces, of kinematics with velocities; `tau` is scratch behind it.
    #[inline]
    pub(crate) fn forward_dynamics_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        tau: &mut [f64],
        workspace: &mut Workspace,
        a: &mut [f64],
    ) {
        if !(self.joints.is_empty() && self.cables.is_empty() && self.bushings.is_empty()) {
            tau.iter_mut().for_each(|tau| *tau = -*tau);
            self.add_to(model, kinematics, tau);
            tau.iter_mut().for_each(|tau| *tau = -*tau);
        }
        aba_into(model, kinematics, tau, &self.pairs, workspace, a);
    }

    /// ∂τ/∂q, ∂τ/∂v and ∂τ/∂a of [`Self::inverse_dynamics_into`]: of the elements ∂y (∂F/∂y ∂yᵀ + ∂F/∂y' ∂y'ᵀ) + F ∂²y.
    #[inline]
    pub(crate) fn inverse_dynamics_derivatives_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        a: &[f64],
        workspace: &mut Workspace,
        slopes: &mut RneaDerivatives,
    ) {
        rnea_derivatives_into(model, kinematics, a, &self.pairs, workspace, slopes);
        for &JointForce { velocity, slope, pull: Pull { d_coordinate, d_rate, .. } } in &self.joints {
            let at = velocity * (model.nv() + 1);
            slopes.d_q[at] += slope * slope * d_coordinate;
            slopes.d_v[at] += slope * slope * d_rate;
        }
        let RneaDerivatives { d_q, d_v, .. } = slopes;
        for (cable, pull) in &self.cables {
            add_stiffness(model, kinematics, &cable.coordinate(), pull.tangent(), workspace, [d_q, d_v]);
        }
        for (bushing, pull) in &self.bushings {
            add_stiffness(model, kinematics, bushing.coordinate(), pull.tangent(), workspace, [d_q, d_v]);
        }
    }

    /// Adds F ∂y/∂q_b of the forces that are no pairs.
    #[inline]
    fn add_to(&self, model: &Model, kinematics: &Kinematics, tau: &mut [f64]) {
        for JointForce { velocity, slope, pull } in &self.joints {
            tau[*velocity] += pull.force * slope;
        }
        for (cable, pull) in &self.cables {
            add_force(model, kinematics, &cable.coordinate(), pull.force, tau);
        }
        for (bushing, pull) in &self.bushings {
            add_force(model, kinematics, bushing.coordinate(), pull.force, tau);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Component, Line, Measure, Reading};
    use super::*;
    use crate::model::{Anchor, BodySpec, JointKind, JointSpec, ModelBuilder, Parent};
    use crate::spatial::Rotation;

    const STIFFNESS: f64 = 30.0;
    const DAMPING: f64 = 4.0;

    /// A floating body with two joints on it.
    fn model() -> Model {
        let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
        let joints = [
            JointSpec { kind: JointKind::Floating, ..JointSpec::revolute("base", [0.0; 3], [0.0; 3]) },
            JointSpec::revolute("turn", [0.2, 1.0, -0.3], [0.4, 0.1, 0.0]),
            JointSpec::prismatic("slide", [1.0, 0.5, 0.2], [0.2, 0.0, 0.3]),
        ];
        for (k, joint) in joints.into_iter().enumerate() {
            let parent = if k == 0 { Parent::World } else { Parent::Body(k - 1) };
            let inertia = [[0.3, 0.01, 0.0], [0.01, 0.2, 0.02], [0.0, 0.02, 0.25]];
            let body = BodySpec { name: format!("b{k}"), parent, joint, mass: 2.0, com: [0.2, -0.05, 0.1], inertia };
            builder.push(body).unwrap();
        }
        builder.finish().unwrap()
    }

    fn measures(model: &Model) -> Vec<Measure> {
        let anchors = [
            (Parent::World, [0.5, -0.4, 0.3]),
            (Parent::Body(0), [0.1, 0.2, -0.3]),
            (Parent::Body(2), [0.3, 0.1, 0.2]),
            (Parent::World, [-0.6, 0.9, 1.0]),
        ]
        .map(|(body, point)| Anchor { body, point });
        let sites = anchors.map(|anchor| model.resolve(&anchor).unwrap());
        let [from, .., to] =
            [0, 1, 2].map(|k| model.resolve_frame(&anchors[k], &Rotation::from_rpy([0.3, -0.2, 0.4])).unwrap());
        let components = Component::ALL.map(|component| Bushing::new(model, from, to, component).into());
        let line = Line { from: sites[0], to: sites[2] };
        [Cable::new(sites.to_vec()).unwrap().into(), line.into()].into_iter().chain(components).collect()
    }

    /// The tangents of F = k y + c y' along each measure are those of τ.
    #[test]
    fn tangents_are_those_of_the_forces() {
        let model = model();
        let n = model.nv();
        let mut q = vec![0.1, -0.2, 0.3, 0.2, -0.1, 0.3, 0.9, 0.4, -0.1];
        model.normalise(&mut q);
        let v = [0.4, -0.3, 0.2, 0.5, -0.6, 0.3, -1.1, 0.7];
        let a = [0.2, 0.1, -0.4, 0.6, 0.3, -0.2, 0.5, -0.9];
        for measure in measures(&model) {
            let pull = |q: &[f64], v: &[f64]| {
                let (Reading { coordinate, rate, .. }, _) =
                    measure.read(&model, &Kinematics::at_velocity(&model, q, v));
                let force = STIFFNESS * coordinate + DAMPING * rate;
                Pull { force, d_coordinate: STIFFNESS, d_rate: DAMPING }
            };
            let forces = |q: &[f64], v: &[f64]| {
                let mut forces = Forces::default();
                forces.push(&measure, pull(q, v));
                forces
            };
            let tau = |q: &[f64], v: &[f64]| forces(q, v).inverse_dynamics(&model, [q, v, &a]);
            let mut slopes = RneaDerivatives::new(&model);
            let kinematics = Kinematics::at_velocity(&model, &q, &v);
            let mut workspace = Workspace::new(&model);
            forces(&q, &v).inverse_dynamics_derivatives_into(&model, &kinematics, &a, &mut workspace, &mut slopes);
            let central = |at: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
                let h = 1e-3;
                let [pp, p, m, mm] = [2.0 * h, h, -h, -2.0 * h].map(at);
                (0..n).map(|b| (8.0 * (p[b] - m[b]) - (pp[b] - mm[b])) / (12.0 * h)).collect()
            };
            for c in 0..n {
                let along = |h: f64| {
                    let mut step = vec![0.0; n];
                    step[c] = h;
                    step
                };
                let by_q = central(&|h| tau(&model.integrate(&q, &along(h)), &v));
                let by_v = central(&|h| tau(&q, &v.iter().zip(along(h)).map(|(v, h)| v + h).collect::<Vec<_>>()));
                for b in 0..n {
                    let own = [slopes.d_q[b * n + c], slopes.d_v[b * n + c]];
                    for (own, other) in own.into_iter().zip([by_q[b], by_v[b]]) {
                        assert!((own - other).abs() < 1e-7, "{measure:?} ({b}, {c}): {own} {other}");
                    }
                }
            }
        }
    }
}
