//! Laws and networks that once gave wrong forces, or stopped, without a reason.

use crate::cases::{holds, silent};

#[test]
fn a_series_inside_a_series_may_be_at_rest() {
    // The root of one scalar equation.
    let right =
        [(0.1, 0.110_636_66), (0.3, 0.230_191_15), (0.5, 0.138_108_96), (0.9, -0.284_865_34), (1.0, -0.277_204_11)];
    holds(&silent("nested_series_nonlinear", &[]), "mount.force", &right, 3e-8);
}

#[test]
fn a_force_may_switch_on_at_a_series_at_rest() {
    // DOP853, 1e-11.
    let right = [(1.1, 0.014_916_85), (1.5, 0.316_332_51), (2.0, 0.417_519_38), (3.0, 0.200_875_02)];
    holds(&silent("rest_nonlinear_series", &[]), "q.x", &right, 3e-8);
}

#[test]
fn dashpots_in_series_know_of_a_jump() {
    // 0.5 (k_e + Σ k_i e^(−t/τ_i)).
    let force = |age: f64| move |t: f64| (t, 0.5 + f64::exp(-2.0 * (t + age)) + 1.5 * f64::exp(-0.5 * (t + age)));
    for (past, age) in [("\"unloaded\"", 0.0), ("{ held = 0.1 }", 0.1)] {
        let run = silent("past_prony_unloaded", &[&format!("element.mount.past={past}")]);
        holds(&run, "mount.force", &[0.05, 0.3, 1.0].map(force(age)), 1e-9);
    }
}

#[test]
fn high_orders_in_series_share_a_jump() {
    // Inverse Laplace transforms, 40 digits.
    let held =
        [(0.0001, 0.268_306_35), (0.01, 0.244_142_05), (0.05, 0.178_966_20), (0.3, 0.066_914_03), (1.0, 0.024_195_90)];
    holds(&silent("past_series_high_orders", &[]), "e.force", &held, 3e-8);
    let unloaded = [(0.01, 2.668_82), (0.05, 0.537_006), (0.3, 0.089_319_5), (1.0, 0.026_632_4)];
    let run = silent("past_series_high_orders", &["element.e.past=\"unloaded\""]);
    holds(&run, "e.force", &[(0.0001, 250.563)], 3e-6);
    holds(&run, "e.force", &unloaded, 3e-6);
}

#[test]
fn a_stroke_may_begin_smoothly() {
    // The inverse Laplace transform of K(s) X(s).
    let right = [(0.1, 0.289_600_900_366), (1.0, -0.567_419_874_756)];
    holds(&silent("series_smooth_start", &[]), "e.force", &right, 1e-8);
}
