//! Rigid-body algorithms on a six-joint arm, one state at a time.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use springpot::dynamics::{Kinematics, PairForce, Workspace, christoffel_into, crba_into, pair_into, rnea_into};
use springpot::model::{Anchor, BodySpec, JointSpec, Model, ModelBuilder, Parent};

/// States that are cycled, so that no branch or value can be learned by heart.
const STATES: usize = 64;

/// A chain with the joint axes of a common industrial arm.
fn arm() -> Model {
    let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    for (k, axis) in axes.into_iter().enumerate() {
        let spec = BodySpec {
            name: format!("link{k}"),
            parent: k.checked_sub(1).map_or(Parent::World, Parent::Body),
            joint: JointSpec { rpy: [0.1, 0.2, 0.3], ..JointSpec::revolute(format!("q{k}"), axis, [0.1, 0.05, 0.3]) },
            mass: 5.0 - 0.7 * k as f64,
            com: [0.02, 0.1, 0.15],
            inertia: [[0.06, 0.001, 0.002], [0.001, 0.05, 0.003], [0.002, 0.003, 0.03]],
        };
        builder.push(spec).expect("the arm is physical");
    }
    builder.finish().expect("the arm is physical")
}

fn states(n: usize, seed: f64) -> Vec<Vec<f64>> {
    (0..STATES).map(|s| (0..n).map(|j| 3.0 * (seed + 1.7 * s as f64 + 0.9 * j as f64).sin()).collect()).collect()
}

fn rigid(criterion: &mut Criterion) {
    let model = arm();
    let n = model.nv();
    let (q, v, a) = (states(n, 0.1), states(n, 0.5), states(n, 0.8));
    let (mut kinematics, mut workspace) = (Kinematics::new(&model), Workspace::new(&model));
    let (mut tau, mut mass, mut gamma) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * n * n]);
    let site = |body, point| model.resolve(&Anchor { body, point }).expect("the body exists");
    let (from, to) = (site(Parent::Body(0), [0.14, -0.1, 0.08]), site(Parent::Body(5), [0.0, 0.1, 0.1]));
    let pairs = [PairForce { from, to, force: 10.0, d_length: 0.0, d_rate: 0.0 }];
    let mut k = 0;
    let mut next = || {
        k = (k + 1) % STATES;
        k
    };

    let mut group = criterion.benchmark_group("arm6");
    group.bench_function("positions", |bench| bench.iter(|| kinematics.update_position(&model, black_box(&q[next()]))));
    group.bench_function("velocities", |bench| {
        bench.iter(|| {
            let s = next();
            kinematics.update_velocity(&model, black_box(&q[s]), &v[s]);
        });
    });
    for (name, pairs) in [("rnea", &pairs[..0]), ("rnea with one pair", &pairs[..])] {
        group.bench_function(name, |bench| {
            bench.iter(|| {
                let s = next();
                rnea_into(&model, black_box(&q[s]), &v[s], &a[s], pairs, &mut workspace, black_box(&mut tau));
            });
        });
    }
    group.bench_function("crba", |bench| {
        bench.iter(|| {
            kinematics.update_position(&model, black_box(&q[next()]));
            crba_into(&model, &kinematics, &mut workspace, black_box(&mut mass));
        });
    });
    group.bench_function("christoffel", |bench| {
        bench.iter(|| {
            kinematics.update_position(&model, black_box(&q[next()]));
            christoffel_into(&model, &kinematics, &mut workspace, black_box(&mut gamma));
        });
    });
    group.bench_function("pair", |bench| {
        kinematics.update_velocity(&model, &q[0], &v[0]);
        bench.iter(|| pair_into(&model, black_box(&kinematics), &from, &to, black_box(&mut tau)));
    });
    group.finish();
}

criterion_group! { name = benches; config = Criterion::default().without_plots(); targets = rigid }
criterion_main!(benches);
