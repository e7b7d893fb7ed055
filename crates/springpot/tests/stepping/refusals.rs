//! What cannot be: an error, no panic, and the simulation as it was.

use super::{bits, start, systems};
use crate::support::forward::{every, falling};
use crate::support::robots::{ARM, prescribed, springpot};
use crate::support::{cases, system};
use springpot::Simulation;
use springpot::driver::run;
use springpot::methods::fixed::Method;
use springpot::system::{FixedStep, RunError, Settings, Stop};

#[test]
fn states_of_other_systems_and_settings_are_refused() {
    let all = systems();
    let mut simulations: Vec<Simulation> = all.iter().map(|(_, system, settings)| start(system, settings)).collect();
    let mut states = Vec::new();
    for simulation in &mut simulations {
        simulation.step_to(0.05).unwrap();
        states.push(simulation.state().unwrap());
    }
    // One number of one law, or one setting, makes another system of it.
    let (_, system, settings) = &all[2];
    let mut stiffer = system.clone();
    stiffer.elements[0].rest += 1e-9;
    let finer = Settings { rtol: 0.5 * settings.rtol, ..settings.clone() };
    for (system, settings) in [(&stiffer, settings), (system, &finer)] {
        let error = start(system, settings).set_state(&states[2]).unwrap_err();
        assert!(matches!(error, RunError::OtherRun), "{error}");
    }
    for (i, simulation) in simulations.iter_mut().enumerate() {
        let before = bits(&all[i].1, &simulation.snapshot().unwrap());
        for (k, state) in states.iter().enumerate().filter(|(k, _)| *k != i) {
            let error = simulation.set_state(state).unwrap_err();
            assert!(matches!(error, RunError::OtherRun), "{} {}: {error}", all[i].0, all[k].0);
        }
        assert_eq!(bits(&all[i].1, &simulation.snapshot().unwrap()), before, "{}", all[i].0);
        simulation.step_to(0.1).unwrap();
    }
}

#[test]
fn settings_and_times_without_steps_are_refused() {
    let (_, system, settings) = systems().swap_remove(2);
    let fixed = |step: f64| Some(FixedStep { method: Method::Midpoint, step });
    for (wrong, key) in [
        (Settings { fixed_step: fixed(0.0), ..settings.clone() }, "solver.step"),
        (Settings { fixed_step: fixed(f64::NAN), ..settings.clone() }, "solver.step"),
        (Settings { first_step: Some(0.0), ..settings.clone() }, "solver.first_step"),
        (Settings { max_step: Some(-1.0), ..settings.clone() }, "solver.max_step"),
        (Settings { end: 0.0, ..settings.clone() }, "time.end"),
        (Settings { rtol: f64::INFINITY, ..settings.clone() }, "solver.rtol"),
        (Settings { atol: Some(-1.0), ..settings.clone() }, "solver.atol"),
    ] {
        let error = Simulation::new(system.clone(), wrong).unwrap_err();
        assert!(error.to_string().starts_with(key), "{error}");
    }
    let mut simulation = start(&system, &settings);
    simulation.step_to(0.1).unwrap();
    let before = bits(&system, &simulation.snapshot().unwrap());
    for t in [0.05, settings.end.next_up(), f64::NAN, f64::INFINITY] {
        let error = simulation.step_to(t).unwrap_err();
        assert!(matches!(error, RunError::Outside { .. }), "{error}");
    }
    let beyond = simulation.interpolate(0.11).unwrap_err().to_string();
    assert!(beyond.starts_with("t = 0.11 s lies outside") && beyond.ends_with("… 0.1 s"), "{beyond}");
    assert_eq!(bits(&system, &simulation.snapshot().unwrap()), before);
}

#[test]
fn what_nobody_can_hold_is_refused() {
    let time = every(0.4, 0.1, 1e-9);
    let locked = system(&(falling(0.3, 25.0, "caputo", "locked = [\"q3\"]") + &time));
    let (_, _, settings) = systems().swap_remove(2);
    let mut simulation = start(&locked, &settings);
    for velocity in [2, 3, usize::MAX] {
        assert!(matches!(simulation.set_torque(velocity, 1.0), Err(RunError::NotDriven { .. })), "{velocity}");
    }
    let error = simulation.set_torque(1, f64::NAN).unwrap_err().to_string();
    assert_eq!(error, "t = 0 s: tau.q2 is NaN, not a finite number");
    for (element, input) in [(1, 0), (0, 1), (usize::MAX, 0)] {
        let error = simulation.set_input(element, input, Some(300.0)).unwrap_err();
        assert_eq!(error.to_string(), format!("element {element} has no input {input}"));
    }
    let error = simulation.set_input(0, 0, Some(-1.0)).unwrap_err().to_string();
    assert!(error.starts_with("t = 0 s: element \"strut\": input T = -1 lies outside 150 … 1500"), "{error}");
    let error = simulation.set_input(0, 0, Some(f64::INFINITY)).unwrap_err().to_string();
    assert_eq!(error, "t = 0 s: strut.T is inf, not a finite number");
    simulation.step_to(0.1).unwrap();

    let given = format!("{ARM}{}{}{time}", springpot(0.5, "caputo"), prescribed("t", "0"));
    let plan = cases(&given).plan(0).unwrap();
    let mut simulation = start(&plan.system(), &plan.settings);
    assert!(matches!(simulation.set_torque(0, 1.0), Err(RunError::NotDriven { velocity: 0 })));
    assert!(matches!(simulation.set_input(0, 0, None), Err(RunError::NoInput { element: 0, input: 0 })));
}

#[test]
fn named_schemes_cannot_be_stepped() {
    let swing = prescribed("t", "0");
    let law = springpot(0.5, "caputo").replace("derivative =", "scheme = \"l1\"\nderivative =");
    let plan = cases(&format!("{ARM}{law}{swing}{}", every(0.4, 0.01, 1e-9))).plan(0).unwrap();
    let error = Simulation::new(plan.system(), plan.settings.clone()).unwrap_err().to_string();
    assert!(error.starts_with("element \"strut\" has a named scheme"), "{error}");
    // A run of forward dynamics knows no complete motion either; the reader of scenarios refuses it before.
    let (_, mut falling, settings) = systems().swap_remove(2);
    falling.elements[0].scheme = plan.system().elements[0].scheme;
    let (_, outcome) = run(&falling, &settings, &mut falling.table(), &Stop::new(false));
    assert!(matches!(outcome, Err(RunError::NoStepping { .. })), "{outcome:?}");
}
