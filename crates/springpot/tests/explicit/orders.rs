//! Orders in steps of one size: of the ends, of rows between them, of the balance.

use super::{BENDING, SPRING_DAMPER, apart, chain, floating, system};
use crate::support::{Run, run_system};
use springpot::system::{Adaptive, RowTimes, Settings, System};

const END: f64 = 1.0;

/// Steps of one size, whatever they err.
fn steps(system: &System, count: u32, times: &[f64]) -> Run {
    let h = Some(END / f64::from(count));
    let settings = Settings {
        rtol: 1e4,
        first_step: h,
        max_step: h,
        adaptive: Adaptive::Explicit,
        ..Settings::new(END, RowTimes::Times(times.into()))
    };
    let run = run_system(system, &settings);
    assert!(run.error.is_none(), "{:?}", run.error);
    let taken = (run.report.steps, run.report.rejected_steps);
    // Steps that are shorter than rows are apart end on these.
    let is_finer = count >= 200 && taken.0 >= u64::from(count);
    assert!((is_finer || taken.0 == u64::from(count)) && taken.1 == 0, "{taken:?} of {count}");
    run
}

fn order(errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).log2()
}

fn systems() -> [(&'static str, System, u32); 4] {
    let driven = chain(2, [SPRING_DAMPER; 2])
        + "torque = { q1 = \"3*sin(5*t)\" }\nprescribed = { q0 = \"0.7 + 0.3*sin(4*t)\" }\n";
    [
        ("double pendulum", system(&chain(2, [SPRING_DAMPER; 2]), END), 16),
        ("chain", system(&chain(5, [SPRING_DAMPER, BENDING]), END), 32),
        ("floating", system(&floating(), END), 16),
        ("led", system(&driven.replace("start = { q = { q0 = 0.7 }, v = { q0 = -0.4 } }", ""), END), 16),
    ]
}

#[test]
fn ends_rows_and_balance() {
    let between: Vec<f64> = (1..200).map(|k| END * f64::from(k) / 200.0 + 1e-3).collect();
    for (name, system, count) in systems() {
        // As exact as double precision: implicit steps agree (`agree.rs`), but not to so many digits.
        let truth = |times: &[f64]| steps(&system, 8 * count, times);
        let (end, rows) = (truth(&[END]), truth(&between));
        let tries = [count, 2 * count];
        let errors = tries.map(|count| apart(&end, &steps(&system, count, &[END])));
        let within = tries.map(|count| steps(&system, count, &between));
        let of_rows = within.each_ref().map(|run| apart(&rows, run));
        let balance = within.each_ref().map(|run| run.residual());
        let orders = [errors, of_rows, balance].map(order);
        println!("{name}: ends {errors:?}, rows {of_rows:?}, balance {balance:?}: {orders:.2?}");
        let [end, row, balance] = orders;
        assert!(end > 7.7 && row > 6.7 && balance > 6.7, "{name}: {orders:?}");
    }
}
