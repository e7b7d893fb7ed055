//! The shipped scenarios that move by themselves, and runs so long that nothing may add up.

use crate::support::forward::{every, falling, largest, slider, state};
use crate::support::{cases, run_case, scenarios, shipped};
use springpot::system::Motion;
use std::time::Instant;

#[test]
fn the_balance_of_every_shipped_scenario_closes_to_its_tolerance() {
    let mut compared = 0;
    for entry in std::fs::read_dir(scenarios()).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if !name.ends_with(".toml") {
            continue;
        }
        let cases = shipped(&name, &[]);
        let plan = cases.plan(0).unwrap();
        if !matches!(plan.system().motion, Motion::Forward(_)) {
            continue;
        }
        let mut worst = 0.0f64;
        for index in 0..cases.len() {
            let run = run_case(&cases, index);
            assert!(run.error.is_none(), "{name}: {:?}", run.error);
            worst = worst.max(run.residual() / plan.settings.rtol);
            compared += 1;
        }
        println!("{name}: {worst:.2} rtol of the energy turned over");
        assert!(worst <= 10.0, "{name}: {worst}");
    }
    assert!(compared >= 13, "{compared} cases");
}

#[test]
fn the_mass_stays_on_its_exact_solution() {
    let run = run_case(&shipped("one_mass_exact.toml", &[]), 0);
    let error = largest(run.column("gauge.stroke"));
    println!("{error:.1e} m");
    assert!(error < 1e-9 && largest(run.column("q.mass")) > 0.1, "{error:e}");
    assert!(largest(run.column("gauge.force")) < 1e-20);
}

#[test]
#[ignore = "compares wall times: for a quiet machine"]
fn an_hour_costs_the_same_from_minute_to_minute() {
    // Stirred slowly for an hour: steps and time of each tenth.
    let text = falling(0.5, 25.0, "caputo", "torque = { q2 = \"3*sin(0.05*t)\", q1 = \"0.2*sin(0.7*t)\" }")
        + &every(3600.0, 360.0, 1e-7);
    let cases = cases(&text);
    let (system, settings) = (cases.plan(0).unwrap().system(), cases.plan(0).unwrap().settings);
    let begun = Instant::now();
    let mut marks = Vec::new();
    let mut keep = |row: &[f64]| -> std::io::Result<()> {
        assert!(row.iter().all(|x| x.is_finite()));
        marks.push(begun.elapsed().as_secs_f64());
        Ok(())
    };
    let stop = springpot::system::Stop::new(false);
    let (report, outcome) = springpot::driver::run(&system, &settings, &mut keep, &stop);
    outcome.unwrap();
    let tenths: Vec<f64> = marks.windows(2).map(|pair| pair[1] - pair[0]).collect();
    println!("{report:?}\nseconds of each tenth: {tenths:.2?}");
    // The first tenth holds the fall.
    let (early, late) = (tenths[1] + tenths[2], tenths[8] + tenths[9]);
    assert!(late < 1.5 * early, "{tenths:?}");
    assert!(report.modes < 80, "{report:?}");
    assert!(report.energy_residual.unwrap() < 1e-5 * report.energy_turned_over.unwrap(), "{report:?}");
}

#[test]
#[ignore = "a minute"]
fn ten_million_steps_keep_the_memory_as_it_is() {
    let law = "law = \"springpot\"\nparameters = { c = 30, alpha = 0.5 }";
    let stir = state("0", "0") + "\ntorque = { q = \"19.62 + 5*sin(3*t)\" }";
    let text = slider("2", -9.81, law, &stir) + &every(1e5, 1e4, 1e-4) + "max_step = 0.0099\nmax_steps = 20000000\n";
    let run = run_case(&cases(&text), 0);
    println!("{:?}", run.report);
    assert!(run.error.is_none() && run.report.steps >= 10_000_000);
    assert!(run.report.modes < 60 && largest(run.column("q.q")) < 10.0);
}
