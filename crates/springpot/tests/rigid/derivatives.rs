//! Derivatives of inverse and forward dynamics against central differences, on random trees with elements attached.

use crate::support::build;
use crate::support::{Case, case, close, config, difference, largest, one_degree_case, plain_difference};
use proptest::prelude::*;
use springpot::dynamics::{
    AbaDerivatives, Kinematics, PairForce, RneaDerivatives, Workspace, aba, aba_derivatives, aba_derivatives_into,
    coriolis, crba, mass_inverse, pair, rnea, rnea_at_into, rnea_derivatives, rnea_derivatives_into,
};
use springpot::model::{Anchor, BodySpec, JointSpec, Model, Parent, Site};

/// Distances below this make differences inaccurate.
const SHORTEST: f64 = 0.4;

/// A material without memory: F = 20 + 300 (l − 0.5) + 80 (l − 0.5)³ + (4 + 3 l) l' + l'³/5.
fn material(from: Site, to: Site, length: f64, rate: f64) -> PairForce {
    let x = length - 0.5;
    PairForce {
        from,
        to,
        force: 20.0 + 300.0 * x + 80.0 * x.powi(3) + (4.0 + 3.0 * length) * rate + 0.2 * rate.powi(3),
        d_length: 300.0 + 240.0 * x * x + 3.0 * rate,
        d_rate: 4.0 + 3.0 * length + 0.6 * rate * rate,
    }
}

struct Elements {
    ends: Vec<(Site, Site)>,
}

impl Elements {
    /// Between the anchors of the case and from the second one to the world.
    fn new(case: &Case, model: &Model, attached: bool) -> Self {
        let [from, to] = case.sites(model);
        let base = model.resolve(&Anchor { body: Parent::World, point: [2.0, -3.0, 4.0] }).unwrap();
        Self { ends: if attached { vec![(from, to), (to, base)] } else { Vec::new() } }
    }

    fn apart(&self, case: &Case, model: &Model) -> bool {
        let kinematics = Kinematics::at_position(model, &case.q);
        self.ends.iter().all(|(from, to)| (kinematics.position(to) - kinematics.position(from)).norm() > SHORTEST)
    }

    fn at(&self, model: &Model, q: &[f64], v: &[f64]) -> Vec<PairForce> {
        let kinematics = Kinematics::at_velocity(model, q, v);
        let force = |&(from, to): &(Site, Site)| {
            let here = pair(model, &kinematics, &from, &to).0;
            material(from, to, here.length, here.rate)
        };
        self.ends.iter().map(force).collect()
    }
}

/// Columns as a row-major square matrix.
fn square(n: usize, column: impl Fn(usize) -> Vec<f64>) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = (0..n).map(column).collect();
    (0..n * n).map(|k| columns[k % n][k / n]).collect()
}

/// Central differences along the tangent vectors of q.
fn by_q(model: &Model, q: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    square(model.nv(), |c| difference(model, q, c, &f))
}

/// Central differences along the entries of v.
fn by_v(v: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    square(v.len(), |c| plain_difference(v, c, &f))
}

proptest! {
    #![proptest_config(config(0x5eed_0004))]

    #[test]
    fn of_inverse_dynamics(case in case(), attached in any::<bool>()) {
        let model = case.model();
        let elements = Elements::new(&case, &model, attached);
        prop_assume!(elements.apart(&case, &model));
        let (q, v, a) = (&case.q[..], &case.v[..], &case.a[..]);
        let slopes = rnea_derivatives(&model, q, v, a, &elements.at(&model, q, v));
        let tau = |q: &[f64], v: &[f64]| rnea(&model, q, v, a, &elements.at(&model, q, v));
        let mut at_hand = vec![0.0; model.nv()];
        let (kinematics, workspace) = (Kinematics::at_velocity(&model, q, v), &mut Workspace::new(&model));
        rnea_at_into(&model, &kinematics, q, a, &elements.at(&model, q, v), workspace, &mut at_hand);
        close("tau by kinematics at hand", &at_hand, &tau(q, v), 1e-13, largest(&at_hand).max(1.0));
        let scale = largest(&tau(q, v)).max(largest(&slopes.d_q)).max(largest(&slopes.d_v)).max(1.0);
        close("dtau/dq", &slopes.d_q, &by_q(&model, q, |q| tau(q, v)), 1e-7, scale);
        close("dtau/dv", &slopes.d_v, &by_v(v, |v| tau(q, v)), 1e-9, scale);
        let mass = crba(&model, &Kinematics::at_position(&model, q));
        close("dtau/da", &slopes.d_a, &mass, 1e-12, largest(&mass));
    }

    #[test]
    fn of_forward_dynamics(case in case(), attached in any::<bool>()) {
        let model = case.model();
        let elements = Elements::new(&case, &model, attached);
        prop_assume!(elements.apart(&case, &model));
        let (q, v) = (&case.q[..], &case.v[..]);
        // Forces that give moderate accelerations: far from them, differences say little.
        let tau = &rnea(&model, q, v, &case.a, &elements.at(&model, q, v));
        let slopes = aba_derivatives(&model, q, v, tau, &elements.at(&model, q, v));
        let accelerations = |q: &[f64], v: &[f64]| aba(&model, q, v, tau, &elements.at(&model, q, v));
        let inverse = mass_inverse(&model, &Kinematics::at_position(&model, q));
        let scale = largest(&slopes.d_q).max(largest(&slopes.d_v)).max(largest(&inverse)).max(1.0);
        close("a", &slopes.a, &accelerations(q, v), 1e-14, largest(&slopes.a));
        close("da/dv", &slopes.d_v, &by_v(v, |v| accelerations(q, v)), 1e-8, scale);
        close("da/dtau", &slopes.d_tau, &inverse, 1e-11, largest(&inverse) * largest(&inverse).max(1.0));
        // M da/dq = −∂RNEA/∂q at that a, differenced on the side without the ill-conditioned M⁻¹.
        let held = &slopes.a;
        let forces = by_q(&model, q, |q| rnea(&model, q, v, held, &elements.at(&model, q, v)));
        let n = model.nv();
        let mass = crba(&model, &Kinematics::at_position(&model, q));
        let product: Vec<f64> =
            (0..n * n).map(|k| -(0..n).map(|i| mass[k / n * n + i] * slopes.d_q[i * n + k % n]).sum::<f64>()).collect();
        let scale = largest(&forces).max(largest(tau)).max(1.0).max(largest(&mass) * largest(&slopes.d_q) * 1e-5);
        close("M da/dq", &product, &forces, 1e-7, scale);
    }

    #[test]
    fn half_the_slope_over_velocities_is_the_coriolis_matrix(case in one_degree_case()) {
        let model = case.model();
        let kinematics = Kinematics::at_velocity(&model, &case.q, &case.v);
        let slopes = rnea_derivatives(&model, &case.q, &case.v, &case.a, &[]).d_v;
        let twice: Vec<f64> = coriolis(&model, &kinematics).iter().map(|c| 2.0 * c).collect();
        close("2 C", &slopes, &twice, 1e-13, largest(&twice).max(largest(&crba(&model, &kinematics))));
    }

    #[test]
    fn nothing_is_left_from_the_call_before(first in case(), force in -50.0..50.0) {
        let model = first.model();
        let [from, to] = first.sites(&model);
        let pairs = [PairForce { from, to, force, d_length: 100.0, d_rate: 10.0 }];
        prop_assume!(Elements::new(&first, &model, true).apart(&first, &model));
        let mut workspace = Workspace::new(&model);
        let (mut inverse, mut forward) = (RneaDerivatives::new(&model), AbaDerivatives::new(&model));
        let there = Kinematics::at_velocity(&model, &model.random(1), &first.a);
        let here = Kinematics::at_velocity(&model, &first.q, &first.v);
        for kinematics in [&there, &here] {
            rnea_derivatives_into(&model, kinematics, &first.a, &pairs, &mut workspace, &mut inverse);
            aba_derivatives_into(&model, kinematics, &first.a, &pairs, &mut workspace, &mut forward);
        }
        prop_assert_eq!(inverse, rnea_derivatives(&model, &first.q, &first.v, &first.a, &pairs));
        prop_assert_eq!(forward, aba_derivatives(&model, &first.q, &first.v, &first.a, &pairs));
    }
}

/// A mass on a slider held by one element: m a = τ − F, so that every derivative can be read off.
#[test]
fn a_slider_on_a_spring_and_a_dashpot() {
    let model = build(&[BodySpec {
        name: "slider".into(),
        parent: Parent::World,
        joint: JointSpec::prismatic("q1", [1.0, 0.0, 0.0], [0.0; 3]),
        mass: 2.0,
        com: [0.0; 3],
        inertia: [[0.0; 3]; 3],
    }]);
    let from = model.resolve(&Anchor { body: Parent::World, point: [0.0; 3] }).unwrap();
    let to = model.resolve(&Anchor { body: Parent::Body(0), point: [0.0; 3] }).unwrap();
    let pairs = [PairForce { from, to, force: 5.0, d_length: 30.0, d_rate: 4.0 }];
    let inverse = rnea_derivatives(&model, &[0.5], &[1.0], &[0.0], &pairs);
    assert_eq!((inverse.d_q[0], inverse.d_v[0], inverse.d_a[0]), (30.0, 4.0, 2.0));
    let forward = aba_derivatives(&model, &[0.5], &[1.0], &[7.0], &pairs);
    assert_eq!((forward.d_q[0], forward.d_v[0], forward.d_tau[0]), (-15.0, -2.0, 0.5));
}
