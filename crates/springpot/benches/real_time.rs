//! Real time: a Panda arm with four elements under computed torque in steps of 1 ms, every step timed by itself.
//!
//! `cargo bench -p springpot --bench real_time [-- STEPS]`; 10⁶ steps where none are said. It prints the percentiles and a histogram.

use springpot::law::Catalog;
use springpot::methods::fixed::{Loop, MemorySettings, Method};
use springpot::system::System;
use springpot_scenario::Scenario;
use std::time::Instant;

const STEP: f64 = 1e-3;

/// Upper ends of the bins of the histogram, µs.
const BINS: [f64; 9] = [10.0, 12.0, 15.0, 20.0, 30.0, 60.0, 100.0, 1000.0, f64::INFINITY];

const TEXT: &str = r#"
[robot]
urdf = "robots/panda.urdf"
[[element]]
name = "strut"
from = { body = "panda_link2", point = [0.04, -0.14, 0] }
to = { body = "panda_link4", point = [-0.02, 0.18, 0] }
rest_length = "23 cm"
law = "fractional-kelvin-voigt"
parameters = { k = "4 N/cm", c = "300 N*s^alpha/m", alpha = 0.5 }
[[element]]
name = "strap"
from = { body = "panda_link0", point = [0.18, 0, 0.22] }
to = { body = "panda_link2", point = [0.08, -0.1, 0] }
rest_length = "26.3 cm"
law = "thermoviscoelastic"
parameters = { E_c = "300 N/m", E_kv = "500 N/m", E_d = "200 N*s^alpha/m", alpha = 0.35, a_kv = "0.3 mm/K", T_ref = "20 degC" }
inputs = { T = "30 degC" }
[[element]]
name = "damper"
from = { body = "panda_link4", point = [0.05, 0.1, 0] }
to = { body = "panda_link6", point = [0.05, 0, 0.1] }
rest_length = "start"
law = "magnetorheological"
parameters = { E_c = "200 N/m", mu_0 = "20 N*s^alpha/m", mu = "40 N*s^alpha/(m*V)", alpha = 0.7 }
inputs = { u = "1 V" }
[[element]]
name = "wrist"
joint = "panda_joint6"
rest = "1.5 rad"
law = "springpot"
parameters = { c = "2 N*m*s^alpha/rad", alpha = 0.4 }
[motion]
kind = "forward"
start = { q = { panda_joint2 = -0.6, panda_joint4 = -2.1, panda_joint6 = 1.5, panda_joint7 = 0.8 } }
locked = ["panda_finger_joint1"]
[motion.controller]
kind = "computed-torque"
kp = 100
kd = 20
compensate_elements = true
[motion.controller.reference]
kind = "joints"
panda_joint1 = "0.5*sin(0.5*pi*t)"
panda_joint2 = "-0.6 + 0.25*sin(pi*t)"
panda_joint3 = "0.1*sin(0.3*pi*t)"
panda_joint4 = "-2.1 + 0.3*sin(pi*t)"
panda_joint5 = "0.1*sin(pi*t)"
panda_joint6 = "1.5 + 0.1*sin(pi*t)"
panda_joint7 = "0.8"
[time]
end = "10 s"
output_step = "1 s"
"#;

fn system() -> System {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    let cases = Scenario::parse(TEXT, "bench", folder).and_then(|scenario| scenario.cases(&Catalog::standard()));
    let plan = cases.and_then(|cases| cases.plan(0)).unwrap_or_else(|refusals| panic!("{refusals}"));
    plan.system()
}

fn main() {
    let asked = std::env::args().skip(1).find_map(|argument| argument.parse().ok());
    // `cargo test --benches` asks for a look alone.
    let is_bench = std::env::args().any(|argument| argument == "--bench");
    let steps: usize = asked.unwrap_or(if is_bench { 1_000_000 } else { 1_000 });
    let system = system();
    let memory = MemorySettings { tolerance: 1e-6, horizon: steps as f64 * STEP };
    for method in [Method::BackwardEuler, Method::Midpoint] {
        let mut arm = Loop::new(&system, method, STEP, memory).unwrap_or_else(|error| panic!("{error}"));
        let torque = vec![0.0; system.model.nv()];
        let mut times = Vec::with_capacity(steps);
        for _ in 0..steps {
            let start = Instant::now();
            arm.advance(&torque).unwrap_or_else(|error| panic!("{error}"));
            times.push(start.elapsed().as_secs_f64() * 1e6);
        }
        let miss = (0.5 * (0.5 * std::f64::consts::PI * arm.t()).sin() - arm.q()[0]).abs();
        println!(
            "{method:?}: {steps} steps, {} exponentials, joint 1 misses its reference by {miss:.1e} rad",
            arm.modes()
        );
        print(&mut times);
    }
    alone(steps);
}

/// What the machine does to work that is the same every time: a sum of sines that takes some 14 µs.
fn alone(steps: usize) {
    let mut times = Vec::with_capacity(steps);
    for _ in 0..steps {
        let start = Instant::now();
        let sum: f64 = (0..1_000).map(|k| std::hint::black_box(1e-3 * f64::from(k)).sin()).sum();
        std::hint::black_box(sum);
        times.push(start.elapsed().as_secs_f64() * 1e6);
    }
    println!("the machine by itself: the same sum of sines every time");
    print(&mut times);
}

/// Percentiles and a histogram of times, µs.
fn print(times: &mut [f64]) {
    let steps = times.len();
    times.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| times[((steps - 1) as f64 * share) as usize];
    println!(
        "  median {:.1} µs, 99 % {:.1} µs, 99.9 % {:.1} µs, 99.99 % {:.1} µs, worst {:.0} µs",
        at(0.5),
        at(0.99),
        at(0.999),
        at(0.9999),
        at(1.0)
    );
    let mut from = 0;
    for upper in BINS {
        let to = times.partition_point(|time| *time <= upper);
        if to > from {
            let share = 100.0 * (to - from) as f64 / steps as f64;
            println!("  up to {upper:>4} µs: {:>8} steps, {share:.4} %", to - from);
        }
        from = to;
    }
}
