//! Pulses and trains of pulses, smooth and compact, in motions, torques and voltages.

use crate::random::{Random, slider};
use crate::switched::agrees_with_tiny_steps;

/// A pulse of height 1 about `t = at`, or a train of them each `period`, `width` wide.
fn pulse(random: &mut Random, at: f64, width: f64, period: f64) -> String {
    let half = 0.5 * width;
    // sin²(π(t − at)/period) ≈ (π(t − at)/period)² near each pulse.
    let sharp = (period / (std::f64::consts::PI * half)).powi(2);
    match (random.unit() * 5.0) as u32 {
        0 => format!("exp(-((t-{at})/{half})^2)"),
        1 => format!("max(0, 1-((t-{at})/{half})^2)^3"),
        2 => format!("1/(1+((t-{at})/{half})^2)"),
        3 => format!("exp(-{sharp}*sin(pi*(t-{at})/{period})^2)"),
        _ => format!("max(0, 1-{sharp}*sin(pi*(t-{at})/{period})^2)^3"),
    }
}

fn case(random: &mut Random) {
    let (width, end) = (random.log(1e-3, 1.0), 60.0);
    // Short runs for narrow pulses, whose tiny steps are many.
    let end = f64::min(end, width * random.within(700.0, 1500.0));
    let (at, period) = (random.within(0.05, 0.95) * end, end / random.within(3.0, 12.0));
    let pulse = pulse(random, at, width, period);
    let ground = *random.of(&["", "+0.05*sin(t)", "+0.02*sin(7*t)"]);
    let alpha = random.within(0.1, 0.9);
    let springpot = format!("law = \"springpot\"\nparameters = {{ c = 1, alpha = {alpha} }}");
    let kelvin_voigt = format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 30, c = 3, alpha = {alpha} }}");
    let (law, motion, columns): (String, String, &[&str]) = match (random.unit() * 3.0) as u32 {
        0 => (
            springpot,
            format!("kind = \"prescribed\"\njoints = {{ q = \"1+0.1*{pulse}{ground}\" }}"),
            &["e.derivative", "e.dissipated"],
        ),
        1 => (
            kelvin_voigt,
            format!(
                "kind = \"forward\"\nstart = {{ q = {{ q = 1 }} }}\ntorque = {{ q = \"{}*{pulse}{ground}\" }}",
                1.0 / width
            ),
            &["e.stroke", "v.q", "e.dissipated"],
        ),
        _ => (
            format!(
                "law = \"magnetorheological\"\nparameters = {{ E_c = 30, mu_0 = 2, mu = 20, alpha = {alpha} }}\ninputs = {{ u = \"{pulse}\" }}"
            ),
            "kind = \"forward\"\nstart = { q = { q = 1.1 } }".to_owned(),
            &["e.stroke", "v.q"],
        ),
    };
    agrees_with_tiny_steps(&slider(&law, &motion, end, 40), width / 50.0, columns);
}

/// Each stream of random numbers is a share, for as many threads.
const SEEDS: [u64; 4] = [0x2545_F491_4F6C_DD1D, 0x9FB2_1C65_1E98_DF25, 0xC2B2_AE3D_27D4_EB4F, 0x1656_67B1_9E37_79F9];

fn share(seed: u64, count: usize) {
    let mut random = Random(seed);
    (0..count).for_each(|_| case(&mut random));
}

#[test]
fn pulses_first_share() {
    share(SEEDS[0], 20);
}

#[test]
fn pulses_second_share() {
    share(SEEDS[1], 20);
}

#[test]
fn pulses_third_share() {
    share(SEEDS[2], 20);
}

#[test]
fn pulses_fourth_share() {
    share(SEEDS[3], 20);
}

#[test]
#[ignore = "a minute"]
fn two_hundred_pulses() {
    SEEDS.iter().for_each(|&seed| share(seed, 50));
}
