//! What parameters change over explicit steps.

use super::{BENDING, SPRING_DAMPER, chain, floating};
use crate::support::{Run, relative_difference, run_system};
use springpot::Simulation;
use springpot::system::{Adaptive, RowTimes, Settings, System};

const OF_CHAIN: [&str; 4] = ["element.far.k", "element.near.c", "robot.body.b1.mass", "motion.start.v.q0"];
const OF_TOP: [&str; 4] = ["element.far.k", "robot.body.top.mass", "motion.start.v.base.wx", "robot.body.arm.com.0"];

/// With `[sensitivity]` by these numbers, whose tangents share in the choice of steps or not.
fn asked(text: &str, by: &[&str], control: bool) -> System {
    let table = format!("{text}[sensitivity]\nby = {by:?}\ncontrol = {control}\n");
    super::system(&table, 1.0)
}

/// Rows at times of which many lie within one step.
fn run(system: &System, adaptive: Adaptive, rtol: f64) -> Run {
    let settings = Settings { rtol, adaptive, ..Settings::new(1.0, RowTimes::Step { step: 0.011, end: 1.0 }) };
    let run = run_system(system, &settings);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

fn bits(row: &[f64]) -> Vec<u64> {
    row.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn without_control_every_other_column_is_that_of_the_plain_run() {
    for (text, by) in [(chain(4, [SPRING_DAMPER, BENDING]), OF_CHAIN), (floating(), OF_TOP)] {
        let plain = super::system(&text, 1.0);
        let varied = asked(&text, &by, false);
        for adaptive in [Adaptive::Explicit, Adaptive::Either] {
            let [plain, varied] = [&plain, &varied].map(|system| run(system, adaptive, 1e-7));
            assert!(varied.report.explicit_steps.is_some_and(|steps| steps > 0), "{:?}", varied.report);
            assert_eq!(plain.rows.len(), varied.rows.len());
            for (own, other) in plain.rows.iter().zip(&varied.rows) {
                assert!(other.len() > own.len());
                assert_eq!(bits(own), bits(&other[..own.len()]));
            }
        }
    }
}

/// The derivatives of both methods are those of one motion.
#[test]
fn tangents_are_as_good_as_the_motion() {
    for (text, by) in [(chain(4, [SPRING_DAMPER; 2]), OF_CHAIN), (floating(), OF_TOP)] {
        let truth = run(&asked(&text, &by, true), Adaptive::Radau, 1e-12);
        for (rtol, control) in [(1e-6, false), (1e-8, false), (1e-10, false), (1e-6, true), (1e-9, true)] {
            let found = run(&asked(&text, &by, control), Adaptive::Explicit, rtol);
            assert_eq!(found.report.explicit_steps, Some(found.report.steps));
            let worst = |is_of: &dyn Fn(&str) -> bool| {
                let names = truth.names.iter().filter(|name| name.starts_with("d(") && is_of(name));
                let apart = |name: &String| relative_difference(&truth.column(name), &found.column(name));
                names
                    .map(|name| (apart(name), name.clone()))
                    .fold((0.0, String::new()), |worst, own| if own.0 > worst.0 { own } else { worst })
            };
            let [of_motion, of_rates] =
                [worst(&|name| !name.starts_with("d(a.")), worst(&|name| name.starts_with("d(a."))];
            println!("{rtol:e} {control}: {of_motion:?} {of_rates:?}, {} steps", found.report.steps);
            // What does not share in the choice of steps is as good as these happen to be for it.
            let known = if control { 1.0 } else { 100.0 } * rtol;
            assert!(of_motion.0 < known, "{rtol:e} {control}: {of_motion:?}");
            assert!(of_rates.0 < 5.0 * known, "{rtol:e} {control}: {of_rates:?}");
        }
    }
}

/// Through steps of both methods, and from every state of the run.
#[test]
fn derivatives_go_on_to_the_bit() {
    let text = chain(3, [SPRING_DAMPER; 2])
        + "torque = { q0 = \"-0.1*v.q0 - 1e5*(tanh(20*(t - 0.4)) - tanh(20*(t - 0.6)))*v.q0\" }\n";
    let system = asked(&text, &OF_CHAIN, false);
    let settings = Settings { rtol: 1e-6, ..Settings::new(1.0, RowTimes::Times([1.0].into())) };
    let begin = || Simulation::new(system.clone(), settings.clone()).unwrap();
    let (mut whole, mut used, mut states) = (begin(), begin(), Vec::new());
    let all = |simulation: &mut Simulation| {
        let [q, v] = simulation.tangents().unwrap();
        bits(&[q, v].concat())
    };
    while whole.step().unwrap() {
        let changes = all(&mut whole);
        states.push((whole.state().unwrap(), changes));
    }
    let report = whole.report();
    assert!(report.method_switches.unwrap() >= 2 && report.explicit_steps.unwrap() > 10, "{report:?}");
    for (k, (state, _)) in states.iter().enumerate().step_by(3) {
        used.set_state(state).unwrap();
        for (_, expected) in &states[k + 1..(k + 3).min(states.len())] {
            assert!(used.step().unwrap());
            assert!(all(&mut used) == *expected, "from step {k}");
        }
    }
}
