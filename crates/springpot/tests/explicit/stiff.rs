//! What is stiff, or becomes so on the way.

use super::{SPRING_DAMPER, apart, chain, run, system};
use crate::support::run_system;
use springpot::Simulation;
use springpot::system::{Adaptive, RowTimes, RunError, Settings, System, Unfit};

/// Damping of the first joint that grows a million times about t = 1 s and goes back about t = 2 s.
fn turning_stiff() -> String {
    chain(3, [SPRING_DAMPER; 2]) + "torque = { q0 = \"-0.1*v.q0 - 1e5*(tanh(20*(t - 1)) - tanh(20*(t - 2)))*v.q0\" }\n"
}

#[test]
fn what_turns_stiff_goes_on_with_the_other_method_and_back() {
    let system = system(&turning_stiff(), 4.0);
    let times = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0];
    let truth = run(&system, 4.0, &times, Adaptive::Radau, 1e-11);
    for rtol in [1e-6, 1e-8] {
        let run = run(&system, 4.0, &times, Adaptive::Either, rtol);
        let (error, report) = (apart(&truth, &run), run.report);
        println!("{rtol:e}: {error:.1e}, {report:?}");
        assert!(error < 30.0 * rtol && run.residual() < 10.0 * rtol, "{rtol:e}: {error:e} {:e}", run.residual());
        let explicit = report.explicit_steps.unwrap();
        assert!(report.method_switches.unwrap() >= 2 && explicit > 50 && explicit < report.steps, "{report:?}");
    }
}

/// Steps to the end, and goes on from every state on the way: gives the simulation at its end.
fn goes_on_from_every_state(system: &System, settings: &Settings) -> Simulation {
    let begin = || Simulation::new(system.clone(), settings.clone()).unwrap();
    let bits =
        |of: &Simulation| (of.t().to_bits(), of.q().iter().chain(of.v()).map(|x| x.to_bits()).collect::<Vec<_>>());
    let (mut whole, mut used, mut states, mut ends) = (begin(), begin(), Vec::new(), Vec::new());
    while whole.step().unwrap() {
        states.push(whole.state().unwrap());
        ends.push(bits(&whole));
    }
    for (k, state) in states.iter().enumerate() {
        used.set_state(state).unwrap();
        for expected in &ends[k + 1..(k + 4).min(ends.len())] {
            assert!(used.step().unwrap());
            assert!(bits(&used) == *expected, "from step {k}");
        }
    }
    whole
}

#[test]
fn goes_on_to_the_bit_across_changes_of_method() {
    let system = system(&turning_stiff(), 4.0);
    let settings =
        Settings { adaptive: Adaptive::Either, rtol: 1e-6, ..Settings::new(4.0, RowTimes::Times([4.0].into())) };
    let whole = goes_on_from_every_state(&system, &settings);
    assert!(whole.report().method_switches.unwrap() >= 2);
}

#[test]
fn long_chains_take_over_to_the_bit_what_rounding_does() {
    let system = system(&chain(18, [SPRING_DAMPER; 2]), 0.05);
    for adaptive in [Adaptive::Explicit, Adaptive::Radau] {
        let settings = Settings { adaptive, rtol: 1e-9, ..Settings::new(0.05, RowTimes::Times([0.05].into())) };
        let steps = goes_on_from_every_state(&system, &settings).report().steps;
        assert!(steps > 20, "{steps}");
    }
}

/// Two metres of links, all alike, that hang from the world: the shorter they are, the faster they answer.
fn rope(links: usize) -> String {
    let count = links as f64;
    let (length, middle, mass, damping) = (2.0 / count, 1.0 / count, 4.0 / count, 0.2 / count);
    let turning = mass * length * length / 12.0;
    let mut text = String::from("[robot]\n");
    for k in 0..links {
        let from = if k == 0 { 0.0 } else { length };
        text += &format!(
            "[[robot.body]]\nname = \"b{k}\"\njoint = {{ name = \"q{k}\", kind = \"revolute\", axis = [0, 1, 0], \
             origin = [{from}, 0, 0], damping = {damping} }}\nmass = {mass}\ncom = [{middle}, 0, 0]\n\
             inertia = {{ xx = {turning}, yy = {turning}, zz = {turning} }}\n"
        );
    }
    text + &format!("[motion]\nkind = \"forward\"\nstart = {{ q = {{ q0 = 0.3, q{} = 0.5 }} }}\n", links / 2)
}

#[test]
fn long_chains_are_left_to_implicit_steps() {
    let system = system(&rope(100), 0.1);
    let steps = |adaptive| run(&system, 0.1, &[0.1], adaptive, 1e-6).report;
    let (radau, own) = (steps(Adaptive::Radau), steps(Adaptive::Either));
    assert!(own.steps < 2 * radau.steps && own.method_switches == Some(1), "{radau:?} {own:?}");
}

#[test]
fn what_it_is_not_for_is_refused() {
    let explicit = Settings { adaptive: Adaptive::Explicit, ..Settings::new(1.0, RowTimes::Times([1.0].into())) };
    let refused = |text: &str| match run_system(&system(text, 1.0), &explicit).error {
        Some(RunError::NotExplicit(why)) => why,
        other => panic!("{other:?}"),
    };
    let past = chain(2, ["law = \"springpot\"\nparameters = { c = 3, alpha = 0.4 }", SPRING_DAMPER]);
    assert_eq!(refused(&past), Unfit::Keeps { element: "far".into() });
    let series = chain(2, [SPRING_DAMPER, "law = \"maxwell\"\nparameters = { k = 3, c = 4 }"]);
    assert_eq!(refused(&series), Unfit::Keeps { element: "near".into() });
    let sticks = chain(2, [SPRING_DAMPER; 2])
        .replace("name = \"q1\",", "name = \"q1\", friction = { force = 0.4, stick = true },");
    assert_eq!(refused(&sticks), Unfit::Sticks { joint: "q1".into() });
    let remembers = chain(2, [SPRING_DAMPER; 2])
        + "controller = { kind = \"pid\", kp = 3, ki = 4, kd = 1, reference = { kind = \"joints\", q0 = \"0.3\", q1 = \"0\" } }\n";
    assert_eq!(refused(&remembers), Unfit::Remembers);
    assert_eq!(refused(&(chain(2, [SPRING_DAMPER; 2]) + "locked = [\"q0\", \"q1\"]\n")), Unfit::Led);
}

#[test]
fn what_is_too_stiff_says_so_where_nothing_else_may_be_taken() {
    let settings =
        Settings { adaptive: Adaptive::Explicit, rtol: 1e-6, ..Settings::new(4.0, RowTimes::Times([4.0].into())) };
    let run = run_system(&system(&turning_stiff(), 4.0), &settings);
    match run.error {
        Some(RunError::TooStiff { t, h }) => assert!((0.8..1.2).contains(&t) && h < 1e-3, "{t} {h}"),
        other => panic!("{other:?}"),
    }
}
