//! Intervals hold what they promise.

use crate::support::{Curve, Noise};
use springpot::identification::{
    Bootstrap, Fit, Parameter, Settings, fit, percentiles, profile, replicate, student_quantile,
};
use std::sync::atomic::AtomicBool;

const TRUTH: [f64; 3] = [400.0, 900.0, 0.35];

/// ln |k + c ω^alpha| over two decades with 2 % of noise: positive, one of them an order.
fn stiffening(seed: u64) -> Curve {
    let model = |x: f64, p: &[f64], by: &mut [f64]| {
        let power = x.powf(p[2]);
        let value = p[0] + p[1] * power;
        by.copy_from_slice(&[1.0 / value, power / value, p[1] * power * x.ln() / value]);
        value.ln()
    };
    let mut noise = Noise(1000 + seed);
    let points = (0..40).map(|k| 10.0_f64.powf(-1.0 + 0.05 * f64::from(k)));
    let points = points.map(|x| [x, model(x, &TRUTH, &mut [0.0; 3]) + 0.02 * noise.normal()]).collect();
    let positive = |name, start| Parameter::new(name, start, [0.0, f64::INFINITY]);
    Curve::new(
        vec![positive("k", 500.0), positive("c", 500.0), Parameter::new("alpha", 0.5, [0.0, 1.0])],
        points,
        model,
    )
}

fn fitted(curve: &Curve) -> Fit {
    fit(curve, &Settings { starts: 3, ..Settings::default() }, &AtomicBool::new(false)).unwrap()
}

#[test]
fn intervals_of_95_per_cent_hold_the_truth_in_95() {
    let (mut wald, mut profiles, mut agree) = (0, 0, 0);
    for seed in 0..300 {
        let curve = stiffening(seed);
        let found = fitted(&curve);
        let own = found.wald(&curve.parameters[2], 2, 0.95);
        let [low, high] = own;
        wald += usize::from(low <= TRUTH[2] && TRUTH[2] <= high);
        if seed % 3 == 0 {
            let [low, high] = profile(&curve, &found, 2, 0.95, &AtomicBool::new(false)).unwrap();
            profiles += usize::from(low <= TRUTH[2] && TRUTH[2] <= high);
            agree += usize::from((low - own[0]).abs() < 0.3 * found.sd(2) && (high - own[1]).abs() < 0.3 * found.sd(2));
        }
    }
    assert!((276..=291).contains(&wald), "{wald}");
    assert!((90..=99).contains(&profiles), "{profiles}");
    assert!(agree > 50, "{agree}");
}

#[test]
fn a_profile_ends_where_the_cost_has_risen_by_t_squared_variances() {
    let curve = stiffening(5);
    let found = fitted(&curve);
    let t = student_quantile(0.975, found.freedom());
    for j in 0..3 {
        for end in profile(&curve, &found, j, 0.95, &AtomicBool::new(false)).unwrap() {
            let mut held = stiffening(5);
            held.parameters.iter_mut().zip(&found.values).for_each(|(p, value)| p.start = vec![*value]);
            let narrow = end * 1e-9;
            held.parameters[j] = Parameter { bounds: [end - narrow, end + narrow], ..Parameter::free("held", end) };
            let rise = fitted(&held).cost - found.cost;
            assert!((rise / (t * t * found.cost / found.freedom()) - 1.0).abs() < 1e-4, "{j} {end}: {rise}");
        }
    }
}

#[test]
fn replicates_are_their_own_whatever_the_thread() {
    let curve = stiffening(8);
    let found = fitted(&curve);
    let bootstrap = Bootstrap { seed: 3, block: 1 };
    let one = |k: usize| replicate(&curve, &found, bootstrap, k, &AtomicBool::new(false)).unwrap();
    let alone: Vec<Vec<f64>> = (0..200).map(one).collect();
    let apart: Vec<Vec<f64>> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..4)
            .map(|w| scope.spawn(move || (0..50).map(|k| (k * 4 + w, one(k * 4 + w))).collect::<Vec<_>>()))
            .collect();
        let mut all: Vec<_> = workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect();
        all.sort_by_key(|(k, _)| *k);
        all.into_iter().map(|(_, values)| values).collect()
    });
    assert_eq!(alone, apart);
    let mean = alone.iter().map(|values| values[2]).sum::<f64>() / 200.0;
    let sd = (alone.iter().map(|values| (values[2] - mean).powi(2)).sum::<f64>() / 199.0).sqrt();
    assert!((sd / found.sd(2) - 1.0).abs() < 0.25, "{sd} {}", found.sd(2));
    let [low, high] = percentiles(alone.iter().map(|values| values[2]).collect(), 0.95);
    let wald = found.wald(&curve.parameters[2], 2, 0.95);
    assert!((low - wald[0]).abs() < sd && (high - wald[1]).abs() < sd, "{low} {high} {wald:?}");
}

#[test]
fn correlated_residuals_widen() {
    let mut curve = stiffening(2);
    let before = fitted(&curve);
    assert_eq!(before.widening, 1.0);
    curve.points.iter_mut().for_each(|[x, y]| *y += 0.1 * (3.0 * x.ln()).sin());
    let after = fitted(&curve);
    let rho = after.lag1[0];
    assert!(rho > 0.6 && (after.widening - ((1.0 + rho) / (1.0 - rho)).sqrt()).abs() < 1e-12, "{rho}");
    // Known standard deviations are not estimated: the spread is that of the noise alone.
    let mut known = stiffening(2);
    (known.sd, known.series[0].has_sd) = (0.02, true);
    let found = fitted(&known);
    assert!((found.cost / found.freedom() - 1.0).abs() < 0.7);
    assert!((found.sd(2) / (before.sd(2) / (found.cost / found.freedom()).sqrt()) - 1.0).abs() < 1e-6);
}
