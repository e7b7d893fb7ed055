//! Rigid-body algorithms on robots of the size of an arm, an arm with a gripper and a humanoid on the ground and on a floating base, one state at a time.

use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use serde_json::Value;
use springpot::dynamics::{
    AbaDerivatives, Kinematics, PairForce, RneaDerivatives, Workspace, aba_derivatives_into, aba_into,
    christoffel_into, coriolis_into, crba_into, frame_jacobian_at_into, frame_jacobian_into, mass_inverse_into,
    pair_into, rnea_derivatives_into, rnea_into,
};
use springpot::model::{Anchor, BodySpec, JointKind, JointSpec, Model, ModelBuilder, Parent};

/// States that are cycled, so that no branch or value can be learned by heart.
const STATES: usize = 64;

/// A robot of `testdata/multibody`, without the turns between its joints: they cost the same whatever they are.
fn robot(name: &str) -> Model {
    let path = format!("{}/../../testdata/multibody/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("the file is there")).expect("JSON");
    let vector = |value: &Value| [0, 1, 2].map(|k| value[k].as_f64().expect("a number"));
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    for (k, joint) in file["model"]["joints"].as_array().expect("joints").iter().enumerate() {
        let (kind, axis) = match joint["type"].as_str() {
            Some("R") => (JointKind::Revolute, vector(&joint["axis"])),
            Some("P") => (JointKind::Prismatic, vector(&joint["axis"])),
            _ => (JointKind::Floating, [0.0, 0.0, 1.0]),
        };
        let plain = JointSpec::revolute(format!("q{k}"), axis, vector(&joint["placement_p"]));
        let spec = BodySpec {
            name: format!("link{k}"),
            parent: joint["parent"].as_u64().map_or(Parent::World, |p| Parent::Body(p as usize)),
            joint: JointSpec { kind, rpy: [0.1, 0.2, 0.3], ..plain },
            mass: joint["mass"].as_f64().expect("a number"),
            com: vector(&joint["com"]),
            inertia: [0, 1, 2].map(|r| vector(&joint["inertia_com"][r])),
        };
        builder.push(spec).expect("the robot is physical");
    }
    builder.finish().expect("the robot is physical")
}

fn states(n: usize, seed: f64) -> Vec<Vec<f64>> {
    (0..STATES).map(|s| (0..n).map(|j| 3.0 * (seed + 1.7 * s as f64 + 0.9 * j as f64).sin()).collect()).collect()
}

/// One row: `work` gets a new state in every call.
fn row(group: &mut BenchmarkGroup<'_, criterion::measurement::WallTime>, name: &str, mut work: impl FnMut(usize)) {
    let mut k = 0;
    group.bench_function(name, |bench| {
        bench.iter(|| {
            k = (k + 1) % STATES;
            work(black_box(k));
        });
    });
}

fn rigid(criterion: &mut Criterion) {
    for name in ["ur5", "panda", "simple_humanoid", "simple_humanoid_ff"] {
        let model = robot(name);
        let n = model.nv();
        let (q, v, a) = (states(model.nq(), 0.1), states(n, 0.5), states(n, 0.8));
        let (mut kinematics, mut workspace) = (Kinematics::new(&model), Workspace::new(&model));
        let (mut vector, mut mass, mut inverse) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * n]);
        let (mut inverse_slopes, mut forward_slopes) = (RneaDerivatives::new(&model), AbaDerivatives::new(&model));
        let site = |body, point| model.resolve(&Anchor { body, point }).expect("the body exists");
        let last = Parent::Body(model.body_names().len() - 1);
        let (from, to) = (site(Parent::Body(0), [0.14, -0.1, 0.08]), site(last, [0.0, 0.1, 0.1]));
        let tip = model.frame(last).expect("the body exists");
        let pairs = [PairForce { from, to, force: 10.0, d_length: 100.0, d_rate: 5.0 }];

        let mut group = criterion.benchmark_group(name);
        row(&mut group, "positions", |s| kinematics.update_position(&model, &q[s]));
        row(&mut group, "velocities", |s| kinematics.update_velocity(&model, &q[s], &v[s]));
        row(&mut group, "rnea", |s| rnea_into(&model, &q[s], &v[s], &a[s], &[], &mut workspace, &mut vector));
        row(&mut group, "rnea, one pair", |s| {
            rnea_into(&model, &q[s], &v[s], &a[s], &pairs, &mut workspace, &mut vector);
        });
        row(&mut group, "crba", |s| {
            kinematics.update_position(&model, &q[s]);
            crba_into(&model, &kinematics, &mut workspace, &mut mass);
        });
        row(&mut group, "aba", |s| {
            kinematics.update_velocity(&model, &q[s], &v[s]);
            aba_into(&model, &kinematics, &a[s], &[], &mut workspace, &mut vector);
        });
        row(&mut group, "mass inverse", |s| {
            kinematics.update_position(&model, &q[s]);
            mass_inverse_into(&model, &kinematics, &mut workspace, &mut mass, &mut inverse);
        });
        let mut jacobian = vec![0.0; 6 * n];
        row(&mut group, "frame jacobian", |s| {
            kinematics.update_position(&model, &q[s]);
            frame_jacobian_into(&model, &kinematics, &tip, &mut jacobian);
        });
        row(&mut group, "frame jacobian alone", |s| {
            frame_jacobian_at_into(&model, &q[s], &tip, &mut workspace, &mut jacobian);
        });
        row(&mut group, "coriolis", |s| {
            kinematics.update_velocity(&model, &q[s], &v[s]);
            coriolis_into(&model, &kinematics, &mut workspace, &mut mass);
        });
        for (name, pairs) in [("rnea derivatives", &pairs[..0]), ("rnea derivatives, one pair", &pairs[..])] {
            row(&mut group, name, |s| {
                kinematics.update_velocity(&model, &q[s], &v[s]);
                rnea_derivatives_into(&model, &kinematics, &a[s], pairs, &mut workspace, &mut inverse_slopes);
            });
        }
        row(&mut group, "aba derivatives", |s| {
            kinematics.update_velocity(&model, &q[s], &v[s]);
            aba_derivatives_into(&model, &kinematics, &a[s], &[], &mut workspace, &mut forward_slopes);
        });
        row(&mut group, "pair", |s| {
            kinematics.update_velocity(&model, &q[s], &v[s]);
            pair_into(&model, &kinematics, &from, &to, &mut vector);
        });
        if n <= 9 {
            let mut gamma = vec![0.0; n * n * n];
            row(&mut group, "christoffel", |s| {
                kinematics.update_position(&model, &q[s]);
                christoffel_into(&model, &kinematics, &mut workspace, &mut gamma);
            });
        }
        group.finish();
    }
}

criterion_group! { name = benches; config = Criterion::default().without_plots(); targets = rigid }
criterion_main!(benches);
