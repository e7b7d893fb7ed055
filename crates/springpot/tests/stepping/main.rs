//! A simulation driven from outside: the run itself, step by step; states; what is held from outside; what is refused.

mod held;
mod refusals;
mod resume;
mod states;

#[path = "../support/mod.rs"]
mod support;

use springpot::Simulation;
use springpot::methods::fixed::Method;
use springpot::observe::Snapshot;
use springpot::system::{FixedStep, RunError, Settings, System};
use support::forward::{every, falling};
use support::robots::{ARM, PATH, magnetorheological, prescribed, springpot, strut, thermoviscoelastic};
use support::{cases, run_system};

/// Systems of every kind of motion with their settings: along signals, along a path, forward, forward from a singular start beside a locked and a
/// prescribed joint, with friction that sticks, and in steps of one size.
fn systems() -> Vec<(&'static str, System, Settings)> {
    let swing = prescribed("0.1*abs(sin(8*t))", "0.1*t");
    let time = every(0.6, 0.01, 1e-9);
    let torque = "torque = { q2 = \"3*sign(sin(11*t))\" }";
    let given = format!("{ARM}{}{swing}{time}", thermoviscoelastic(0.5, 25.0, "caputo"));
    let path = format!("{ARM}{}{PATH}{time}", magnetorheological(0.7, "caputo"));
    let forward = falling(0.3, 25.0, "caputo", torque) + &time;
    let singular =
        falling(0.5, 40.0, "riemann-liouville", "prescribed = { q1 = \"0.3*t^2\" }\nlocked = [\"q3\"]") + &time;
    let rough = ARM.replace("name = \"q3\",", "name = \"q3\", friction = { force = 0.4, stick = true },");
    let rough = format!("{rough}{}\n[motion]\nkind = \"forward\"\n{torque}\n{time}", springpot(0.5, "caputo"));
    let warm = strut(
        "law = \"fractional-zener\"\nparameters = { k_e = 30, k_m = 200, c = 50, alpha = 0.5 }\n\
         shift = { kind = \"wlf\", C1 = 17.44, C2 = 51.6, T_ref = 290 }\n\
         thermal = { capacity = 0.1, conductance = 0.02, ambient = 295 }",
    );
    let warm = format!("{ARM}{warm}\n[motion]\nkind = \"forward\"\n{torque}\n{time}");
    let mut systems = Vec::new();
    for (name, text) in [
        ("signals", given),
        ("path", path),
        ("forward", forward),
        ("singular", singular),
        ("rough", rough),
        ("warm", warm),
    ] {
        let plan = cases(&text).plan(0).expect("a valid plan");
        systems.push((name, plan.system(), plan.settings.clone()));
        if name == "forward" {
            for (name, method) in [("euler", Method::BackwardEuler), ("midpoint", Method::Midpoint)] {
                let fixed_step = Some(FixedStep { method, step: 1e-3 });
                systems.push((name, plan.system(), Settings { fixed_step, ..plan.settings.clone() }));
            }
        }
    }
    systems
}

/// All numbers of a snapshot, as bits.
fn bits(system: &System, snapshot: &Snapshot) -> Vec<u64> {
    system.observables().quantities().into_iter().map(|quantity| (snapshot.value(quantity) + 0.0).to_bits()).collect()
}

fn start(system: &System, settings: &Settings) -> Simulation {
    Simulation::new(system.clone(), settings.clone()).expect("a simulation")
}

#[test]
fn steps_taken_by_hand_are_those_of_the_run() {
    for (name, system, settings) in systems() {
        let run = run_system(&system, &settings);
        assert!(run.error.is_none(), "{name}: {:?}", run.error);
        // Forward runs that choose their steps end some on rows that are far apart.
        let same_steps = matches!(name, "signals" | "path" | "euler" | "midpoint");
        let mut simulation = start(&system, &settings);
        let mut snapshot = simulation.snapshot().unwrap();
        for (row, t) in run.rows.iter().zip(run.t()) {
            while simulation.t() < t {
                assert!(simulation.step().unwrap(), "{name}");
            }
            simulation.interpolate_into(t, &mut snapshot).unwrap();
            if same_steps {
                let expected: Vec<u64> = row.iter().map(|value| value.to_bits()).collect();
                assert_eq!(bits(&system, &snapshot), expected, "{name} at {t}");
            }
            for (q, expected) in snapshot.q().iter().zip(&row[1..]) {
                assert!((q - expected).abs() < 1e-8, "{name} at {t}: {q} {expected}");
            }
        }
        assert_eq!(simulation.t(), settings.end);
        let (q, v) = (snapshot.q(), snapshot.v());
        assert!(simulation.q() == q && simulation.v() == v, "{name}");
        let report = simulation.report();
        assert!(!same_steps || report.steps == run.report.steps, "{name}");
        assert!(!simulation.step().unwrap() && simulation.t() == settings.end, "{name}: the end is the end");
    }
}

#[test]
fn going_to_times_ends_steps_there() {
    for (name, system, settings) in systems() {
        let run = run_system(&system, &settings);
        let mut simulation = start(&system, &settings);
        let force = run.column("strut.force");
        let largest = force.iter().filter(|f| f.is_finite()).fold(0.0f64, |m, f| m.max(f.abs()));
        for (k, t) in run.t().into_iter().enumerate().step_by(7) {
            simulation.step_to(t).unwrap();
            assert_eq!(simulation.t(), t, "{name}");
            let now = simulation.snapshot().unwrap();
            let miss = (now.force(0) - force[k]).abs();
            let allowed = if settings.fixed_step.is_some() { 1e-12 } else { 1e-7 };
            assert!(miss <= allowed * largest || force[k].is_nan(), "{name} at {t}: {miss:e} of {largest:e}");
        }
    }
}

#[test]
fn the_start_of_a_step_is_the_end_of_the_one_before() {
    for (name, system, settings) in systems() {
        let mut simulation = start(&system, &settings);
        for _ in 0..5 {
            assert!(simulation.step().unwrap(), "{name}");
            let (t, before) = (simulation.t(), simulation.snapshot().unwrap());
            simulation.step().unwrap();
            let again = simulation.interpolate(t).unwrap();
            for quantity in system.observables().quantities() {
                let [a, b] = [&before, &again].map(|shown| shown.value(quantity));
                let near = (a - b).abs() <= 1e-7 * (a.abs() + b.abs() + 1e-3) || a.is_nan() || b.is_nan();
                assert!(near, "{name}: {quantity:?} at {t}: {a} and {b}");
            }
        }
    }
}

#[test]
fn pauses_between_tries_change_no_bit() {
    for (name, system, settings) in systems() {
        let (mut straight, mut paused) = (start(&system, &settings), start(&system, &settings));
        let (mut asked, mut left) = (0, 0);
        while straight.t() < 0.1 {
            let moved = straight.step_until(0.1).unwrap();
            loop {
                let before = paused.t();
                let stepped = paused.step_until_unless(0.1, &mut || {
                    asked += 1;
                    asked % 3 == 1
                });
                match stepped {
                    Ok(stepped) => break assert_eq!(stepped, moved, "{name}"),
                    // What changes at a time is crossed to its far side, a rounding on, before a step is tried.
                    Err(RunError::Interrupted { t }) => {
                        assert!(
                            t == paused.t() && t - before <= 4.0 * f64::EPSILON * before.max(1e-14),
                            "{name} at {t}"
                        );
                    }
                    Err(error) => panic!("{name}: {error}"),
                }
                left += 1;
            }
        }
        assert!(left > 3, "{name}: {left} pauses");
        let [one, other] =
            [&mut straight, &mut paused].map(|simulation| bits(&system, &simulation.snapshot().unwrap()));
        assert_eq!(one, other, "{name}");
        assert_eq!(straight.report().rejected_steps, paused.report().rejected_steps, "{name}");
    }
}

#[test]
fn samples_end_steps() {
    use springpot::system::RowTimes;
    for (name, system, settings) in systems() {
        let mut simulation = start(&system, &settings);
        let samples = RowTimes::Step { step: 0.013, end: settings.end };
        simulation.sample_at(Some(samples.clone()));
        let mut ends = vec![0.0];
        while simulation.step().unwrap() {
            ends.push(simulation.t());
        }
        for t in samples.all() {
            assert!(ends.contains(&t), "{name}: no step ends at {t}");
        }
    }
}

#[test]
fn a_simulation_can_be_sent_to_a_thread() {
    let (_, system, settings) = systems().swap_remove(2);
    let mut simulation = start(&system, &settings);
    simulation.step_to(0.1).unwrap();
    let far = std::thread::spawn(move || {
        simulation.step_to(0.2).unwrap();
        simulation
    });
    let mut far = far.join().unwrap();
    let mut near = start(&system, &settings);
    near.step_to(0.1).unwrap();
    near.step_to(0.2).unwrap();
    assert_eq!(bits(&system, &far.snapshot().unwrap()), bits(&system, &near.snapshot().unwrap()));
}
