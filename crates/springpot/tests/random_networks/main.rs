//! Random networks along random motions after random pasts, against inverse Laplace transforms and, where they are not linear, against roots of
//! monotone functions and dense steps: every run is right to 1e-6 of its largest force, or it says that it failed.
//!
//! `cargo nextest run -p springpot --test random_networks --run-ignored all` runs 500 of them.

mod dense;
mod driven;
mod laplace;
mod make;

use make::{Motion, Past, Random, Tree};

/// What a run may be off, in units of its largest force, and what the references may be.
const RIGHT: f64 = 1e-6;
const KNOWN: f64 = 1e-8;

/// Times of the rows, in units of the end.
const TIMES: [f64; 8] = [0.001, 0.01, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];

/// How far a run is off; `None` where it says that it failed.
fn departure(tree: &Tree, motion: &Motion, past: Past, times: &[f64], right: &[f64]) -> Option<f64> {
    let forces = driven::forces(tree, motion, past, times).ok()?;
    let largest = right.iter().fold(0.0f64, |largest, force| largest.max(force.abs()));
    let off = |(is, right): (&f64, &f64)| if is.is_nan() { f64::INFINITY } else { (is - right).abs() };
    Some(forces.iter().zip(right).map(off).fold(0.0, f64::max) / largest)
}

/// How many of these networks say that they failed; none may be wrong.
fn failures(seeds: std::ops::Range<u64>, one: impl Fn(u64) -> Option<f64>) -> usize {
    let wrong = |seed: &u64| {
        let off = one(*seed);
        assert!(off.is_none_or(|off| off < RIGHT), "network {seed} is off by {off:?}");
        off.is_none()
    };
    seeds.filter(wrong).count()
}

/// Linear, from x(0) = 0, held since ever, unloaded, held for a while, steady in turn.
fn linear(seed: u64) -> Option<f64> {
    let mut random = Random::new(seed);
    let depth = random.below(5);
    let tree = make::linear(&mut random, depth);
    let end = [1.0, 0.1, 10.0][random.below(3)];
    let start = if seed.is_multiple_of(5) { 0.0 } else { random.within(0.05, 0.5) };
    let past = Past::random(&mut random, (seed % 5).saturating_sub(1), end);
    let motion = driven::steady(past, Motion::random(&mut random, start, end));
    let times = TIMES.map(|t| t * end);
    let (right, apart) = laplace::forces(&tree, &motion, past, &times);
    assert!(apart < KNOWN, "network {seed}: two contours differ by {apart:e}");
    departure(&tree, &motion, past, &times, &right)
}

/// Elastic and not linear; every other one in series with another that has a dashpot beside it.
fn nonlinear(seed: u64) -> Option<f64> {
    let mut random = Random::new(seed);
    let depth = 1 + random.below(3);
    // Dense steps ask for the force of every part ten thousand times.
    let deepest = if seed.is_multiple_of(2) { depth } else { depth.min(2) };
    let [front, back] = [deepest, 1].map(|depth| make::elastic(&mut random, depth));
    let viscosity = random.within(0.1, 10.0);
    let motion = Motion::random(&mut random, 0.0, 1.0);
    if seed.is_multiple_of(2) {
        let right = TIMES.map(|t| dense::elastic(&front, motion.stroke(t)));
        return departure(&front, &motion, Past::Since, &TIMES, &right);
    }
    let right = dense::damped(&front, &back, viscosity, &motion, &TIMES, 400);
    let tree = Tree::Series(vec![front, Tree::Parallel(vec![back, Tree::Dashpot(viscosity)])]);
    departure(&tree, &motion, Past::Since, &TIMES, &right)
}

#[test]
fn linear_networks_are_right() {
    assert_eq!(failures(0..40, linear), 0);
}

#[test]
fn nonlinear_networks_are_right() {
    assert_eq!(failures(0..20, nonlinear), 0);
}

#[test]
#[ignore = "400 networks"]
fn many_linear_networks_are_right() {
    assert_eq!(failures(40..400, linear), 0);
}

#[test]
#[ignore = "100 networks"]
fn many_nonlinear_networks_are_right() {
    assert_eq!(failures(20..100, nonlinear), 0);
}
