//! One step of the fixed-step methods: the falling three-body arm and a Panda arm, each with a strut; and whole runs beside a bare loop.

use criterion::{Criterion, criterion_group, criterion_main};
use springpot::Simulation;
use springpot::driver::run;
use springpot::law::Catalog;
use springpot::methods::fixed::{Loop, MemorySettings, Method};
use springpot::system::{FixedStep, RowTimes, Settings, Stop, System};
use springpot_scenario::Scenario;
use std::hint::black_box;

/// A shipped scenario whose robot moves by itself from its position at `start`.
fn system(name: &str, start: &str) -> System {
    let folder = format!("{}/../../scenarios", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(format!("{folder}/{name}.toml")).expect("a shipped scenario");
    // Everything up to the motion: the robot and its elements.
    let robot = text.split("[motion]").next().expect("a first part");
    let text = format!("{robot}\n[motion]\nkind = \"forward\"\nstart = {start}\n[time]\nend = 1\noutput_step = 0.1\n");
    let cases = Scenario::parse(&text, name, folder).unwrap_or_else(|refusals| panic!("{refusals}"));
    let cases = cases.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"));
    cases.plan(0).expect("a valid case").system()
}

fn advance(criterion: &mut Criterion) {
    let robots = [
        ("arm, thermoviscoelastic strut", system("thermoviscoelastic_temperature", "{}")),
        (
            "panda, strut and strap",
            system("panda_strut_and_strap", "{ q = { panda_joint2 = -0.6, panda_joint4 = -2.1, panda_joint6 = 1.5 } }"),
        ),
    ];
    let memory = MemorySettings { tolerance: 1e-8, horizon: 3600.0 };
    for (name, system) in &robots {
        let mut group = criterion.benchmark_group(*name);
        for method in [Method::BackwardEuler, Method::Midpoint] {
            let mut robot = Loop::new(system, method, 1e-4, memory).expect("a loop");
            let mut torque = vec![0.0; system.model.nv()];
            println!("{} exponentials in {} elements", robot.modes(), system.elements.len());
            group.bench_function(method.name(), |bench| {
                bench.iter(|| {
                    // A little damping keeps it in one region however long the measurement takes.
                    torque.iter_mut().zip(robot.v()).for_each(|(torque, v)| *torque = -0.5 * v);
                    robot.advance(black_box(&torque)).expect("a step");
                });
            });
        }
        group.finish();
    }
}

/// 10⁴ steps of the arm: a bare loop, a simulation with its energy ledger, and a run that writes two rows.
fn whole(criterion: &mut Criterion) {
    let system = system("thermoviscoelastic_temperature", "{}");
    let settings = |method| Settings {
        rtol: 1e-6,
        memory_rtol: 1e-8,
        fixed_step: Some(FixedStep { method, step: 1e-4 }),
        ..Settings::new(1.0, RowTimes::Times([0.0, 1.0].into()))
    };
    let mut group = criterion.benchmark_group("ten thousand steps of the arm");
    group.sample_size(20);
    for method in [Method::BackwardEuler, Method::Midpoint] {
        let settings = settings(method);
        let torque = vec![0.0; system.model.nv()];
        group.bench_function(format!("{}, loop", method.name()), |bench| {
            bench.iter(|| {
                let memory = MemorySettings { tolerance: 1e-8, horizon: 1.0 };
                let mut robot = Loop::new(&system, method, 1e-4, memory).expect("a loop");
                (0..10_000).for_each(|_| robot.advance(&torque).expect("a step"));
                robot.t()
            });
        });
        group.bench_function(format!("{}, simulation", method.name()), |bench| {
            bench.iter(|| {
                let mut robot = Simulation::new(system.clone(), settings.clone()).expect("a simulation");
                while robot.step().expect("a step") {}
                robot.t()
            });
        });
        group.bench_function(format!("{}, run", method.name()), |bench| {
            bench.iter(|| {
                let mut table = system.table();
                run(&system, &settings, &mut table, &Stop::new(false)).1.expect("a run");
                table
            });
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = Criterion::default().without_plots(); targets = advance, whole }
criterion_main!(benches);
