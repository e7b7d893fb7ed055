//! Many states side by side: what one state gives, at every level that the processor has.

use crate::support::robots::{ROBOTS, load, numbers};
use crate::support::{build, case, close, config, largest, plain_case};
use proptest::prelude::*;
use springpot::dynamics::batch::{self, BatchError, BatchWorkspace};
use springpot::dynamics::{
    BODY_NUMBERS, Kinematics, aba, aba_derivatives, centroidal_matrix, centroidal_matrix_rate, christoffel, com,
    com_jacobian, coriolis, crba, frame_jacobian, frame_jacobian_rate, gravity, joint_torque_regressor, kinetic_energy,
    mass_derivative, mass_inverse, nonlinear_effects, pair, potential_energy, rnea, rnea_derivatives,
    rnea_second_derivatives,
};
use springpot::model::{Anchor, BodySpec, Frame, JointSpec, Model, Parent, Site};
use springpot::spatial::{SimdError, SimdLevel};
use std::process::Command;

/// A few units of the last place; where M⁻¹ has a part in it, of as many digits as its condition leaves.
const FEW_ULPS: f64 = 200.0 * f64::EPSILON;

fn levels() -> impl Iterator<Item = SimdLevel> {
    SimdLevel::ALL.into_iter().filter(|level| level.available().is_ok())
}

/// States in rows, and what is asked of them.
struct States<'a> {
    model: &'a Model,
    rows: usize,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    frame: Frame,
    ends: [Site; 2],
}

/// A result: its name, its numbers row by row, whether M⁻¹ has a part in it.
type Found = (&'static str, Vec<f64>, bool);

impl<'a> States<'a> {
    /// `rows` states about one.
    fn about(model: &'a Model, rows: usize, q: &[f64], v: &[f64], a: &[f64]) -> Self {
        let n = model.nv();
        let turned = |row: usize, k: usize| (1.0 + row as f64 * 1.3 + k as f64 * 0.7).sin();
        let moved = |values: &[f64], row: usize| -> Vec<f64> {
            values.iter().enumerate().map(|(k, x)| x + turned(row, k)).collect()
        };
        let step = |row: usize| -> Vec<f64> { (0..n).map(|k| turned(row, k + 3)).collect() };
        let all_q = (0..rows).flat_map(|row| model.integrate(q, &step(row))).collect();
        let [all_v, all_a] = [v, a].map(|values| (0..rows).flat_map(|row| moved(values, row)).collect());
        let last = Parent::Body(model.body_names().len() - 1);
        let site = |body, point| model.resolve(&Anchor { body, point }).unwrap();
        let ends = [site(Parent::World, [2.0, -3.0, 4.0]), site(last, [0.1, 0.3, -0.2])];
        Self { model, rows, q: all_q, v: all_v, a: all_a, frame: model.frame(last).unwrap(), ends }
    }

    fn batches(&self, level: SimdLevel) -> Vec<Found> {
        let Self { model, rows, q, v, a, frame, ends } = self;
        let mut w = BatchWorkspace::at(model, level).unwrap();
        assert_eq!(w.level(), level);
        let (m, w, n) = (*model, &mut w, model.nv());
        let room = |width: usize| vec![0.0; rows * width];
        let mut all = Vec::new();
        let mut keep = |name, numbers, is_inverse| all.push((name, numbers, is_inverse));
        let mut one = |name, width: usize, is_inverse, work: &mut dyn FnMut(&mut BatchWorkspace, &mut [f64])| {
            let mut out = room(width);
            work(w, &mut out);
            keep(name, out, is_inverse);
        };
        one("rnea", n, false, &mut |w, out| batch::rnea_into(m, w, q, v, a, out).unwrap());
        one("nonlinear effects", n, false, &mut |w, out| batch::nonlinear_effects_into(m, w, q, v, out).unwrap());
        one("aba", n, true, &mut |w, out| batch::aba_into(m, w, q, v, a, out).unwrap());
        one("crba", n * n, false, &mut |w, out| batch::crba_into(m, w, q, out).unwrap());
        one("mass inverse", n * n, true, &mut |w, out| batch::mass_inverse_into(m, w, q, out).unwrap());
        one("coriolis", n * n, false, &mut |w, out| batch::coriolis_into(m, w, q, v, out).unwrap());
        one("gravity", n, false, &mut |w, out| batch::gravity_into(m, w, q, out).unwrap());
        one("com", 3, false, &mut |w, out| batch::com_into(m, w, q, out).unwrap());
        one("com jacobian", 3 * n, false, &mut |w, out| batch::com_jacobian_into(m, w, q, out).unwrap());
        one("kinetic energy", 1, false, &mut |w, out| batch::kinetic_energy_into(m, w, q, v, out).unwrap());
        one("potential energy", 1, false, &mut |w, out| batch::potential_energy_into(m, w, q, out).unwrap());
        one("frame jacobian", 6 * n, false, &mut |w, out| batch::frame_jacobian_into(m, w, frame, q, out).unwrap());
        one("frame jacobian rate", 6 * n, false, &mut |w, out| {
            batch::frame_jacobian_rate_into(m, w, frame, q, v, out).unwrap();
        });
        one("centroidal matrix", 6 * n, false, &mut |w, out| batch::centroidal_matrix_into(m, w, q, out).unwrap());
        one("centroidal matrix rate", 6 * n, false, &mut |w, out| {
            batch::centroidal_matrix_rate_into(m, w, q, v, out).unwrap();
        });
        one("regressor", n * BODY_NUMBERS * m.body_names().len(), false, &mut |w, out| {
            batch::joint_torque_regressor_into(m, w, q, v, a, out).unwrap();
        });
        one("mass derivative", n * n * n, false, &mut |w, out| batch::mass_derivative_into(m, w, q, out).unwrap());
        let mut cubes: [Vec<f64>; 4] = std::array::from_fn(|_| room(n * n * n));
        batch::rnea_second_derivatives_into(m, w, [q, v, a], cubes.each_mut().map(|cube| &mut cube[..])).unwrap();
        let names = ["rnea by q, q", "rnea by v, q", "rnea by v, v", "rnea by a, q"];
        all.extend(names.into_iter().zip(cubes).map(|(name, cube)| (name, cube, false)));
        let (mut first, mut second, mut third) = (room(n * n), room(n * n), room(n));
        batch::rnea_derivatives_into(m, w, q, v, a, &mut first, &mut second).unwrap();
        all.extend([("rnea by q", first.clone(), false), ("rnea by v", second.clone(), false)]);
        batch::aba_derivatives_into(m, w, q, v, a, &mut first, &mut second).unwrap();
        all.extend([("aba by q", first, true), ("aba by v", second, true)]);
        let (mut first, mut second) = (room(9), room(3));
        batch::frame_placement_into(m, w, frame, q, &mut first, &mut second).unwrap();
        all.extend([("rotation", first, false), ("position", second, false)]);
        let (mut first, mut second) = (room(1), room(1));
        batch::pair_into(m, w, [&ends[0], &ends[1]], q, v, [&mut first, &mut second, &mut third]).unwrap();
        all.extend([("length", first, false), ("rate", second, false), ("gradient", third, false)]);
        if m.is_one_degree() {
            let mut gamma = room(n * n * n);
            batch::christoffel_into(m, w, q, &mut gamma).unwrap();
            all.push(("christoffel", gamma, false));
        }
        all
    }

    /// The same, one state after the other; and the condition of each mass matrix, roughly, with its largest entry inverted.
    fn one_by_one(&self) -> (Vec<Found>, Vec<[f64; 2]>) {
        let Self { model, frame, ends, .. } = self;
        let (m, n) = (*model, model.nv());
        let (mut all, mut conditions) = (Vec::<Found>::new(), Vec::new());
        for row in 0..self.rows {
            let q = &self.q[row * m.nq()..][..m.nq()];
            let [v, a] = [&self.v, &self.a].map(|values| &values[row * n..][..n]);
            let k = Kinematics::at_velocity(m, q, v);
            let inverse = mass_inverse(m, &k);
            let mass = crba(m, &k);
            conditions.push([n as f64 * largest(&mass) * largest(&inverse), largest(&inverse)]);
            let (by_rnea, by_aba) = (rnea_derivatives(m, q, v, a, &[]), aba_derivatives(m, q, v, a, &[]));
            let by_two = rnea_second_derivatives(m, q, v, a);
            let placement = k.frame(frame);
            let (distance, gradient) = pair(m, &k, &ends[0], &ends[1]);
            let mut found: Vec<Found> = vec![
                ("rnea", rnea(m, q, v, a, &[]), false),
                ("nonlinear effects", nonlinear_effects(m, q, v, &[]), false),
                ("aba", aba(m, q, v, a, &[]), true),
                ("crba", mass, false),
                ("mass inverse", inverse, true),
                ("coriolis", coriolis(m, &k), false),
                ("gravity", gravity(m, &k), false),
                ("com", com(m, &k).0.to_vec(), false),
                ("com jacobian", com_jacobian(m, &k), false),
                ("kinetic energy", vec![kinetic_energy(m, &k)], false),
                ("potential energy", vec![potential_energy(m, &k)], false),
                ("frame jacobian", frame_jacobian(m, &k, frame), false),
                ("frame jacobian rate", frame_jacobian_rate(m, &k, frame), false),
                ("centroidal matrix", centroidal_matrix(m, &k), false),
                ("centroidal matrix rate", centroidal_matrix_rate(m, &k), false),
                ("regressor", joint_torque_regressor(m, &k, a), false),
                ("mass derivative", mass_derivative(m, &k), false),
                ("rnea by q, q", by_two.d_q_q, false),
                ("rnea by v, q", by_two.d_v_q, false),
                ("rnea by v, v", by_two.d_v_v, false),
                ("rnea by a, q", by_two.d_a_q, false),
                ("rnea by q", by_rnea.d_q, false),
                ("rnea by v", by_rnea.d_v, false),
                ("aba by q", by_aba.d_q, true),
                ("aba by v", by_aba.d_v, true),
                ("rotation", placement.rotation.0.as_flattened().to_vec(), false),
                ("position", placement.translation.0.to_vec(), false),
                ("length", vec![distance.length], false),
                ("rate", vec![distance.rate], false),
                ("gradient", gradient, false),
            ];
            if m.is_one_degree() {
                found.push(("christoffel", christoffel(m, &k), false));
            }
            if all.is_empty() {
                all = found;
            } else {
                all.iter_mut().zip(found).for_each(|(all, found)| all.1.extend(found.1));
            }
        }
        (all, conditions)
    }

    fn compare(&self) {
        let (expected, conditions) = self.one_by_one();
        for level in levels() {
            let found = self.batches(level);
            assert_eq!(found.len(), expected.len());
            for ((name, found, _), (same, expected, is_inverse)) in found.iter().zip(&expected) {
                let what = format!("{name}, {level}");
                assert_eq!((name, found.len()), (same, expected.len()));
                if level == SimdLevel::Baseline {
                    assert_eq!(found, expected, "{what}");
                }
                let width = (found.len() / self.rows).max(1);
                for (row, (found, expected)) in found.chunks(width).zip(expected.chunks(width)).enumerate() {
                    // What cancels in a row is as large as what the algorithm adds up: forces of the whole robot.
                    let [condition, inverse] = conditions[row];
                    let (loss, forces) = if *is_inverse { (condition, 100.0 * inverse) } else { (1.0, 100.0) };
                    let scale = largest(expected).max(forces);
                    close(&format!("{what}, row {row}"), found, expected, FEW_ULPS * loss, scale);
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..config(0x5eed_1a4e) })]

    #[test]
    fn lanes_are_single_states_for_all_kinds_of_joints(case in case()) {
        let model = case.model();
        States::about(&model, 11, &case.q, &case.v, &case.a).compare();
    }

    #[test]
    fn lanes_are_single_states_with_christoffel_symbols(case in plain_case()) {
        let model = case.model();
        States::about(&model, 5, &case.q, &case.v, &case.a).compare();
    }
}

/// Reference values of eight robots, all states of a file in one batch.
#[test]
fn lanes_are_the_reference_values() {
    let mut compared = 0;
    for (name, _) in ROBOTS {
        let robot = load(name);
        let (model, n) = (&robot.model, robot.model.nv());
        let all = |key: &str| -> Vec<f64> { robot.states.iter().flat_map(|state| numbers(&state[key])).collect() };
        let [q, v, a, tau] = ["q", "qd", "qdd", "tau"].map(all);
        for level in levels() {
            let mut w = BatchWorkspace::at(model, level).unwrap();
            let rows = robot.states.len();
            let mut check = |key: &str, found: &[f64], tolerance: f64| {
                let width = found.len() / rows;
                for (row, (found, expected)) in found.chunks(width).zip(all(key).chunks(width)).enumerate() {
                    close(&format!("{name} {key} {level} {row}"), found, expected, tolerance, largest(expected));
                    compared += expected.len();
                }
            };
            let (mut vector, mut square, mut other) =
                (vec![0.0; rows * n], vec![0.0; rows * n * n], vec![0.0; rows * n * n]);
            batch::crba_into(model, &mut w, &q, &mut square).unwrap();
            check("M", &square, 1e-12);
            batch::coriolis_into(model, &mut w, &q, &v, &mut square).unwrap();
            check("C_matrix", &square, 1e-12);
            batch::gravity_into(model, &mut w, &q, &mut vector).unwrap();
            check("g", &vector, 1e-12);
            batch::nonlinear_effects_into(model, &mut w, &q, &v, &mut vector).unwrap();
            check("nle", &vector, 1e-12);
            batch::rnea_into(model, &mut w, &q, &v, &a, &mut vector).unwrap();
            check("rnea", &vector, 1e-12);
            batch::aba_into(model, &mut w, &q, &v, &tau, &mut vector).unwrap();
            check("aba", &vector, 1e-12);
            batch::mass_inverse_into(model, &mut w, &q, &mut square).unwrap();
            check("daba_dtau", &square, 1e-12);
            batch::rnea_derivatives_into(model, &mut w, &q, &v, &a, &mut square, &mut other).unwrap();
            check("drnea_dq", &square, 1e-10);
            check("drnea_dqd", &other, 1e-10);
            batch::aba_derivatives_into(model, &mut w, &q, &v, &tau, &mut square, &mut other).unwrap();
            check("daba_dq", &square, 1e-10);
            check("daba_dqd", &other, 1e-10);
        }
    }
    assert_eq!(compared, levels().count() * 67_500);
}

/// A branched robot of 14 velocities, on a floating base.
fn walker() -> Model {
    let mut bodies = vec![JointSpec::floating("base", [0.0; 3])];
    for k in 0..8 {
        bodies.push(JointSpec::revolute(format!("q{k}"), [0.3, 1.0, 0.1 * k as f64], [0.1, 0.2, -0.3]));
    }
    let inertia = [[0.2, 0.01, 0.0], [0.01, 0.3, 0.02], [0.0, 0.02, 0.25]];
    let bodies: Vec<BodySpec> = bodies
        .into_iter()
        .enumerate()
        .map(|(k, joint)| BodySpec {
            name: format!("b{k}"),
            parent: match k {
                0 => Parent::World,
                5 => Parent::Body(0),
                _ => Parent::Body(k - 1),
            },
            joint,
            mass: 1.0 + 0.1 * k as f64,
            com: [0.1, -0.1, 0.05],
            inertia,
        })
        .collect();
    build(&bodies)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn a_row_is_the_same_wherever_it_stands() {
    let model = walker();
    let n = model.nv();
    let states = States::about(&model, 21, &model.neutral(), &vec![0.0; n], &vec![0.0; n]);
    for level in levels() {
        let mut w = BatchWorkspace::at(&model, level).unwrap();
        let mut together = vec![0.0; 21 * n];
        batch::aba_into(&model, &mut w, &states.q, &states.v, &states.a, &mut together).unwrap();
        for (from, to) in [(0, 1), (3, 21), (7, 9), (20, 21)] {
            let [v, a] = [&states.v, &states.a].map(|values| &values[from * n..to * n]);
            let mut some = vec![0.0; (to - from) * n];
            batch::aba_into(&model, &mut w, &states.q[from * model.nq()..to * model.nq()], v, a, &mut some).unwrap();
            assert_eq!(bits(&some), bits(&together[from * n..to * n]), "{level}, {from} to {to}");
        }
    }
}

#[test]
fn what_is_no_number_stays_in_its_row_and_is_told() {
    let model = walker();
    let (n, rows) = (model.nv(), 13);
    let states = States::about(&model, rows, &model.neutral(), &vec![0.0; n], &vec![0.0; n]);
    for level in levels() {
        let mut w = BatchWorkspace::at(&model, level).unwrap();
        let mut healthy = vec![0.0; rows * n * n];
        batch::mass_inverse_into(&model, &mut w, &states.q, &mut healthy).unwrap();
        for bad in [f64::NAN, f64::INFINITY] {
            for row in [0, 5, 12] {
                let mut q = states.q.clone();
                q[row * model.nq()..][3..7].fill(bad);
                let mut found = vec![0.0; rows * n * n];
                let error = batch::mass_inverse_into(&model, &mut w, &q, &mut found).unwrap_err();
                assert!(matches!(error, BatchError::NotFinite { row: told, .. } if told == row), "{level}: {error}");
                assert!(error.to_string().starts_with(&format!("row {row}: the result holds ")), "{error}");
                for other in (0..rows).filter(|other| *other != row) {
                    let own = other * n * n..(other + 1) * n * n;
                    assert_eq!(bits(&found[own.clone()]), bits(&healthy[own]), "{level}, row {other}");
                }
            }
        }
        // Angles beyond the reach of the fast sine.
        let mut q = states.q.clone();
        q[4 * model.nq() + 9] = 1e9;
        let mut moved = vec![0.0; rows * n * n];
        batch::mass_inverse_into(&model, &mut w, &q, &mut moved).unwrap();
        q[4 * model.nq() + 9] = 1e9_f64.sin().atan2(1e9_f64.cos());
        let mut same = vec![0.0; rows * n * n];
        batch::mass_inverse_into(&model, &mut w, &q, &mut same).unwrap();
        close("a large angle", &moved, &same, 1e-11, largest(&same));
    }
}

#[test]
fn rows_that_do_not_fit_are_refused_before_anything_is_written() {
    let model = walker();
    let (n, nq) = (model.nv(), model.nq());
    let mut w = BatchWorkspace::new(&model).unwrap();
    let (q, v) = (model.neutral().repeat(2), vec![0.0; 2 * n]);
    let mut tau = vec![7.0; 2 * n];
    let refused = [
        (
            batch::rnea_into(&model, &mut w, &q[1..], &v, &v, &mut tau),
            "q holds 29 numbers, which are no whole rows of 15",
        ),
        (
            batch::rnea_into(&model, &mut w, &q, &v[..n], &v, &mut tau),
            "v holds 1 rows of 14, and q holds 2; they must hold as many",
        ),
        (
            batch::rnea_into(&model, &mut w, &q, &v, &v[3..], &mut tau),
            "a holds 25 numbers, which are no whole rows of 14",
        ),
        (
            batch::rnea_into(&model, &mut w, &q, &v, &v, &mut tau[..n]),
            "tau holds 1 rows of 14, and q holds 2; they must hold as many",
        ),
        (
            batch::rnea_into(&model, &mut w, &[], &v, &v, &mut tau),
            "v holds 2 rows of 14, and q holds 0; they must hold as many",
        ),
    ];
    assert_eq!(nq, 15);
    for (found, expected) in refused {
        assert_eq!(found.unwrap_err().to_string(), expected);
    }
    assert!(tau.iter().all(|x| *x == 7.0));
    // No rows are no mistake.
    batch::rnea_into(&model, &mut w, &[], &[], &[], &mut []).unwrap();
    batch::kinetic_energy_into(&model, &mut w, &[], &[], &mut []).unwrap();
    // Nor is a robot without joints.
    let still = build(&[BodySpec {
        name: "plate".into(),
        parent: Parent::World,
        joint: JointSpec::fixed("j", [0.0; 3]),
        mass: 1.0,
        com: [0.0; 3],
        inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    }]);
    let mut energy = [1.0; 3];
    let mut w = BatchWorkspace::new(&still).unwrap();
    batch::kinetic_energy_into(&still, &mut w, &[], &[], &mut energy).unwrap();
    assert_eq!(energy, [0.0; 3]);
    batch::rnea_into(&still, &mut w, &[], &[], &[], &mut []).unwrap();
    for level in SimdLevel::ALL.into_iter().filter(|level| *level > SimdLevel::best()) {
        let error = BatchWorkspace::at(&model, level).unwrap_err();
        assert!(matches!(error, SimdError::Missing { wanted, .. } if wanted == level), "{error}");
    }
}

/// A call of a vector instruction is a hundred times the instruction: it means that something was not inlined behind a door.
#[test]
fn no_vector_instruction_is_called() {
    let own = std::env::current_exe().unwrap();
    let Ok(listed) = Command::new("nm").arg(&own).output() else {
        eprintln!("skipped: there is no nm to list symbols with");
        return;
    };
    let symbols = String::from_utf8_lossy(&listed.stdout).into_owned();
    if !listed.status.success() || !symbols.contains("springpot") {
        eprintln!("skipped: nm lists no symbols of this program");
        return;
    }
    let called: Vec<&str> = symbols
        .lines()
        .filter(|line| line.contains("core_arch") && (line.contains("_mm512_") || line.contains("_mm256_")))
        .filter(|line| line.contains("_pd"))
        .collect();
    assert!(called.is_empty(), "compiled as functions:\n{}", called.join("\n"));
}
