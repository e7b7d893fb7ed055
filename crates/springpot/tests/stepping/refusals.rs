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

/// A system in which all that a simulation hangs on is named once.
const NAMED: &str = r#"
[robot]
gravity = [0, 0, -9.81]
[robot.gripper]
body = "forearm"
point = [0.4, 0, 0]
[[robot.body]]
name = "upper_arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.6], damping = 0.31, friction = 0.17 }
mass = 3.25
com = [0.25, 0.01, 0.02]
inertia = { xx = 0.011, yy = 0.071, zz = 0.072 }
[[robot.body]]
name = "forearm"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0.5, 0, 0] }
mass = 2
com = [0.18, 0, 0]
inertia = { xx = 0.006, yy = 0.03, zz = 0.03 }
[[element]]
name = "strut"
from = { body = "world", point = [0.14, -0.1, 0.08] }
to = { body = "forearm", point = [-0.06, 0.1, 0.33] }
rest_length = 0.71
network = "series(spring(k), springpot(c, alpha))"
parameters = { k = 1250, c = 55, alpha = 0.41 }
past = "held"
[[element]]
name = "damper"
joint = "q1"
law = "magnetorheological"
parameters = { E_c = 5, mu_0 = 3, mu = 1, alpha = 0.7 }
inputs = { u = "2.5*sin(3*t)" }
[[element]]
name = "mount"
joint = "q2"
rest = 0.125
law = "fractional-zener"
parameters = { k_e = 30, k_m = 200, c = 50, alpha = 0.5 }
thermal = { capacity = 0.75, conductance = 0.02, ambient = 295 }
shift = { kind = "wlf", C1 = 17.44, C2 = 51.6, T_ref = 290 }
[motion]
kind = "forward"
start = { q = { q1 = 0.45 }, v = { q2 = 0.55 } }
torque = { q1 = { expression = "7.5*q.q2", unit = "N*m", sample = 0.016 } }
[motion.controller]
kind = "fractional-pid"
kp = 5.5
ki = 1.5
kd = 0.65
lambda = 0.85
mu = 0.95
limits = { q2 = 9.5 }
reference = { kind = "joints", q1 = 0.35, q2 = "0.2*t" }
[[event]]
name = "low"
when = "q.q1 - 0.875"
action = { set = { "tau.q2" = 4.5 } }
[time]
end = 1.75
output_step = 0.375
[solver]
rtol = 1.5e-7
"#;

#[test]
fn whatever_matters_tells_one_system_from_another() {
    let of = |text: &str| {
        let plan = cases(text).plan(0).unwrap_or_else(|error| panic!("{error}\n{text}"));
        start(&plan.system(), &plan.settings)
    };
    let mut simulation = of(NAMED);
    simulation.step_to(0.02).unwrap();
    let state = simulation.state().unwrap();
    for (is, other) in [
        ("-9.81", "-9.82"),
        ("point = [0.4, 0, 0]", "point = [0.4, 0, 1e-9]"),
        ("origin = [0, 0, 0.6]", "origin = [0, 0, 0.7]"),
        ("axis = [0, 1, 0], origin = [0.5", "axis = [0, -1, 0], origin = [0.5"),
        ("damping = 0.31", "damping = 0.3"),
        ("friction = 0.17", "friction = { force = 0.17, stick = true }"),
        ("mass = 3.25", "mass = 3.5"),
        ("0.01, 0.02]", "0.01, 0.03]"),
        ("xx = 0.011", "xx = 0.012"),
        ("0.14, -0.1, 0.08", "0.14, -0.1, 0.09"),
        ("rest_length = 0.71", "rest_length = 0.72"),
        ("series(spring(k), springpot(c, alpha))", "parallel(spring(k), springpot(c, alpha))"),
        ("k = 1250", "k = 1251"),
        ("alpha = 0.41", "alpha = 0.42"),
        ("2.5*sin(3*t)", "2.5*sin(3.5*t)"),
        ("past = \"held\"", "past = { held = 0.25 }"),
        ("rest = 0.125", "rest = 0.25"),
        ("law = \"magnetorheological\"", "derivative = \"riemann-liouville\"\nlaw = \"magnetorheological\""),
        ("capacity = 0.75", "capacity = 0.5"),
        ("C1 = 17.44", "C1 = 17.5"),
        ("q1 = 0.45 }", "q1 = 0.25 }"),
        ("q2 = 0.55 }", "q2 = 0.25 }"),
        ("7.5*q.q2", "7.25*q.q2"),
        ("sample = 0.016", "sample = 0.008"),
        ("kp = 5.5", "kp = { q1 = 5.5, q2 = 5 }"),
        ("ki = 1.5", "ki = 1"),
        ("lambda = 0.85", "lambda = 0.75"),
        ("q2 = 9.5", "q2 = 9"),
        ("q1 = 0.35,", "q1 = 0.25,"),
        ("q.q1 - 0.875", "q.q1 - 0.75"),
        ("\"tau.q2\" = 4.5", "\"tau.q2\" = 4"),
        ("end = 1.75", "end = 1.5"),
        ("rtol = 1.5e-7", "rtol = 1e-7"),
        ("rtol = 1.5e-7", "rtol = 1.5e-7\natol = 1e-9"),
        ("rtol = 1.5e-7", "rtol = 1.5e-7\nmemory_rtol = 1e-10"),
        ("rtol = 1.5e-7", "rtol = 1.5e-7\nfirst_step = 1e-9"),
        ("rtol = 1.5e-7", "rtol = 1.5e-7\nmax_step = 0.125"),
        ("rtol = 1.5e-7", "method = \"midpoint\"\nstep = 0.001"),
    ] {
        let text = NAMED.replacen(is, other, 1);
        assert_ne!(text, NAMED, "{is}");
        let error = of(&text).set_state(&state).expect_err(other);
        assert!(matches!(error, RunError::OtherRun), "{is} {other}: {error}");
    }
    // When rows are written and how many steps are allowed makes no other motion.
    for (is, other) in
        [("output_step = 0.375", "output_step = 0.25"), ("rtol = 1.5e-7", "rtol = 1.5e-7\nmax_steps = 999")]
    {
        of(&NAMED.replacen(is, other, 1)).set_state(&state).expect(other);
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
