//! Torques and inputs held from outside act as signals with the same values.

use crate::support::forward::{every, falling};
use crate::support::robots::{ARM, magnetorheological, prescribed, thermoviscoelastic};
use crate::support::{cases, run, run_system};
use springpot::Simulation;
use springpot::methods::fixed::Method;
use springpot::system::{FixedStep, Settings};

/// The rows of a text, and a simulation of another one.
fn beside(truth: &str, text: &str) -> (crate::support::Run, Simulation) {
    let plan = cases(text).plan(0).unwrap();
    (run(truth), Simulation::new(plan.system(), plan.settings.clone()).unwrap())
}

const STEPS: [(f64, f64); 4] = [(0.0, 3.0), (0.1, -2.0), (0.25, 0.0), (0.3, 5.0)];

/// A staircase with the values of [`STEPS`] as an expression.
fn staircase(of: impl Fn(f64) -> f64) -> String {
    let [(_, first), rest @ ..] = STEPS;
    let jumps = rest.iter().scan(first, |before, (t, value)| {
        let height = of(*value) - of(std::mem::replace(before, *value));
        Some(format!("+({height:?})*0.5*(1+sign(t-{t:?}))"))
    });
    format!("{:?}{}", of(first), jumps.collect::<String>())
}

#[test]
fn held_torques_act_as_signals() {
    let time = every(0.4, 0.01, 1e-9);
    let truth = falling(0.3, 25.0, "caputo", &format!("torque = {{ q2 = \"{}\" }}", staircase(|x| x))) + &time;
    let (run, mut simulation) = beside(&truth, &(falling(0.3, 25.0, "caputo", "") + &time));
    for (k, t) in run.t().into_iter().enumerate() {
        simulation.step_to(t).unwrap();
        let now = simulation.snapshot().unwrap();
        for (j, name) in ["q.q1", "q.q2", "q.q3"].into_iter().enumerate() {
            let miss = (now.q()[j] - run.column(name)[k]).abs();
            assert!(miss < 2e-9, "{name} at {t}: {miss:e}");
        }
        if let Some((_, torque)) = STEPS.into_iter().find(|(at, _)| *at == t) {
            simulation.set_torque(1, torque).unwrap();
            let tau = simulation.snapshot().unwrap().value(springpot::observe::Quantity::Torque(1));
            assert_eq!(tau, torque);
        }
    }
    let residual = simulation
        .snapshot()
        .unwrap()
        .value(springpot::observe::Quantity::Energy(springpot::observe::EnergyQuantity::Residual));
    assert!(residual.abs() < 1e-7, "{residual:e}");
}

#[test]
fn held_inputs_act_as_signals_and_go_back_to_theirs() {
    use springpot::observe::{EnergyQuantity, Quantity};
    let kelvin = |x: f64| 300.0 + 10.0 * x;
    let time = every(0.4, 0.01, 1e-9);
    let swing = prescribed("0.1*sin(8*t)", "0.1*t") + &time;
    let arm = |inputs: &str, rest: &str| {
        let strut = thermoviscoelastic(0.5, 25.0, "caputo").replace("\"25 degC\"", inputs);
        format!("{ARM}{strut}{rest}")
    };
    let signal = format!("{{ expression = \"{}\", unit = \"K\" }}", staircase(kelvin));
    let free = format!("\n[motion]\nkind = \"forward\"\n{time}");
    for (rest, allowed) in [(swing, 1e-10), (free, 1e-8)] {
        let (run, mut simulation) = beside(&arm(&signal, &rest), &arm("\"25 degC\"", &rest));
        let force = run.column("strut.force");
        let largest = force.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        for (k, t) in run.t().into_iter().enumerate() {
            simulation.step_to(t).unwrap();
            if let Some((_, level)) = STEPS.into_iter().find(|(at, _)| *at == t) {
                simulation.set_input(0, 0, Some(kelvin(level))).unwrap();
                continue;
            }
            let miss = (simulation.snapshot().unwrap().force(0) - force[k]).abs();
            assert!(miss < allowed * largest, "{t}: {miss:e} of {largest:e}");
        }
        // Jumps of an input supply energy: the balance knows them.
        let residual = simulation.snapshot().unwrap().value(Quantity::Energy(EnergyQuantity::Residual));
        assert!(residual.abs() < 1e-6, "{residual:e}");
        simulation.set_input(0, 0, None).unwrap();
        let now = simulation.snapshot().unwrap();
        let held = now.force(0);
        simulation.set_input(0, 0, Some(kelvin(5.0))).unwrap();
        let warm = simulation.snapshot().unwrap().force(0);
        // F = … − a_kv E_kv (T − T_ref), T_ref = 25 °C.
        assert!((held - warm - 0.0007 * 20.0 * (kelvin(5.0) - 298.15)).abs() < 1e-9, "{held} {warm}");
    }
}

/// A loop of one millisecond in steps of one size: the same as the run whose torque is the staircase.
#[test]
fn a_controllers_loop_in_steps_of_one_size() {
    let time = every(0.4, 0.1, 1e-9);
    let truth = falling(0.3, 25.0, "caputo", &format!("torque = {{ q2 = \"{}\" }}", staircase(|x| x))) + &time;
    for method in [Method::BackwardEuler, Method::Midpoint] {
        let settings = |text: &str| {
            let plan = cases(text).plan(0).unwrap();
            let fixed_step = Some(FixedStep { method, step: 1e-3 });
            (plan.system(), Settings { fixed_step, ..plan.settings.clone() })
        };
        let (system, given) = settings(&truth);
        let run = run_system(&system, &given);
        let (free, given) = settings(&(falling(0.3, 25.0, "caputo", "") + &time));
        let mut simulation = Simulation::new(free, given).unwrap();
        for tick in 0..400 {
            let t = f64::from(tick) / 1000.0;
            if let Some((_, torque)) = STEPS.into_iter().find(|(at, _)| *at == t) {
                simulation.set_torque(1, torque).unwrap();
            }
            simulation.step_to(f64::from(tick + 1) / 1000.0).unwrap();
        }
        assert_eq!(simulation.report().steps, 400);
        let last = run.rows.len() - 1;
        let miss = (simulation.q()[1] - run.column("q.q2")[last]).abs();
        // Backward Euler meets the signal at the end of the step before it jumps.
        let allowed = if method == Method::BackwardEuler { 2e-3 } else { 1e-12 };
        assert!(miss < allowed, "{method:?}: {miss:e}");
    }
}

/// A jump of a held input supplies what it changes the stored energy by: the balance of steps of one size knows it too.
#[test]
fn held_inputs_supply_energy_in_steps_of_one_size() {
    use springpot::observe::{ElementQuantity, EnergyQuantity, Quantity};
    let strut = magnetorheological(0.5, "caputo");
    let text = format!("{ARM}{strut}\n[motion]\nkind = \"forward\"\n{}", every(0.3, 0.1, 1e-9));
    let plan = cases(&text).plan(0).unwrap();
    let residual_after = |volts: &[f64], look: bool| {
        let fixed_step = Some(FixedStep { method: Method::Midpoint, step: 1e-3 });
        let settings = Settings { fixed_step, ..plan.settings.clone() };
        let mut simulation = Simulation::new(plan.system(), settings).unwrap();
        for (k, volt) in volts.iter().enumerate() {
            simulation.step_to(0.1 * (k + 1) as f64).unwrap();
            simulation.set_input(0, 0, Some(*volt)).unwrap();
            if look {
                simulation.interpolate(simulation.t()).unwrap();
            }
        }
        simulation.step_to(0.3).unwrap();
        let last = simulation.snapshot().unwrap();
        let supplied = last.value(Quantity::Element(0, ElementQuantity::Input));
        (last.value(Quantity::Energy(EnergyQuantity::Residual)), supplied)
    };
    let ((own, _), (switched, supplied)) = (residual_after(&[], false), residual_after(&[8.0, 3.0], false));
    println!("{own:e} {switched:e} {supplied}");
    assert!((switched - own).abs() < 0.01 * supplied.abs(), "{switched:e} {own:e} {supplied}");
    assert_eq!(residual_after(&[8.0, 3.0], true), (switched, supplied));
}
