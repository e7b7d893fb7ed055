//! Switched torques, voltages and ledgers: what a run finds by itself against what tiny steps find.

use crate::random::{Random, slider};
use crate::support::forward::{distance, largest};
use crate::support::{Run, run};

/// A square wave between 0 and 1 of that rate, and its duty as a share.
fn wave(random: &mut Random, rate: f64, duty: f64) -> String {
    let phase = random.within(0.0, 6.0);
    // sin > level for that share of the time.
    let level = (std::f64::consts::PI * (0.5 - duty)).sin();
    match (random.unit() * 3.0) as u32 {
        0 => format!("step(sin(2*pi*{rate}*t+{phase})-({level}))"),
        1 => format!("(0.5+0.5*sign(cos(2*pi*{rate}*t+{phase})-({level})))"),
        _ => format!("max(0, sign(sin({phase}-2*pi*{rate}*t)-({level})))"),
    }
}

/// The columns of `text`'s run against those of the same with steps of at most `max_step`, relative to the largest value of each.
pub(crate) fn agrees_with_tiny_steps(text: &str, max_step: f64, columns: &[&str]) {
    let plain = run(text);
    let fine = run(&format!("{text}\n[solver]\nmax_step = {max_step:e}\nmax_steps = 100000000\n"));
    let compare = |column: &str, plain: &Run, fine: &Run| {
        let (a, b) = (plain.column(column), fine.column(column));
        let scale = largest(b.iter().copied());
        let error = distance(&a, &b);
        assert!(error <= 1e-6 * scale, "{column}: {:e} of {scale:e}\n{text}", error / scale);
    };
    columns.iter().for_each(|column| compare(column, &plain, &fine));
    assert!(plain.residual() < 1e-6, "{:e}\n{text}", plain.residual());
}

/// One of the random cases: a torque or a voltage in forward runs, or a voltage along a motion.
fn case(random: &mut Random) {
    let (rate, duty) = (random.log(40.0, 1000.0), random.within(0.01, 0.4));
    let shortest = duty / rate;
    let end = shortest * random.within(600.0, 1000.0);
    let alpha = random.within(0.05, 0.95);
    let wave = wave(random, rate, duty);
    let damper = |u: &str| {
        format!(
            "law = \"magnetorheological\"\nparameters = {{ E_c = 30, mu_0 = 2, mu = 20, alpha = {alpha} }}\ninputs = {{ u = \"{u}\" }}"
        )
    };
    let (law, motion, columns): (String, String, &[&str]) = match (random.unit() * 3.0) as u32 {
        0 => (
            format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 30, c = 3, alpha = {alpha} }}"),
            format!("kind = \"forward\"\nstart = {{ q = {{ q = 1 }} }}\ntorque = {{ q = \"5*{wave}\" }}"),
            &["e.stroke", "v.q", "e.stored"],
        ),
        1 => (
            damper(&wave),
            "kind = \"forward\"\nstart = { q = { q = 1.1 } }\ntorque = { q = \"sin(9*t)\" }".to_owned(),
            &["e.stroke", "v.q", "e.dissipated"],
        ),
        _ => (
            damper(&wave),
            format!("kind = \"prescribed\"\njoints = {{ q = \"1+0.1*sin({}*t)\" }}", random.log(0.3, 30.0)),
            &["e.derivative", "e.dissipated", "e.input"],
        ),
    };
    agrees_with_tiny_steps(&slider(&law, &motion, end, 12), shortest / 50.0, columns);
}

/// Each stream of random numbers is a share, for as many threads.
const SEEDS: [u64; 4] = [0x9E37_79B9_7F4A_7C15, 0xD1B5_4A32_D192_ED03, 0x8CB9_2BA7_2F3D_8DD7, 0xA076_1D64_78BD_642F];

fn share(seed: u64, count: usize) {
    let mut random = Random(seed);
    (0..count).for_each(|_| case(&mut random));
}

#[test]
fn switched_signals_first_share() {
    share(SEEDS[0], 20);
}

#[test]
fn switched_signals_second_share() {
    share(SEEDS[1], 20);
}

#[test]
fn switched_signals_third_share() {
    share(SEEDS[2], 20);
}

#[test]
fn switched_signals_fourth_share() {
    share(SEEDS[3], 20);
}

#[test]
#[ignore = "a minute"]
fn two_hundred_switched_signals() {
    SEEDS.iter().for_each(|&seed| share(seed, 50));
}
