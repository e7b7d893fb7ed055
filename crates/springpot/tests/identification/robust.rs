//! Outliers.

use crate::support::{Curve, Noise};
use springpot::identification::{Loss, Parameter, Settings, Status, fit};
use std::sync::atomic::AtomicBool;

/// 2 + 3x with noise of 0.1, every seventh row 5 too high.
fn spoiled(loss: Loss, seed: u64) -> Curve {
    let mut noise = Noise(seed);
    let points = (0..70)
        .map(|k| (k, 0.05 * f64::from(k)))
        .map(|(k, x)| [x, 2.0 + 3.0 * x + 0.1 * noise.normal() + if k % 7 == 3 { 5.0 } else { 0.0 }]);
    let mut curve =
        Curve::new(vec![Parameter::free("a", 0.0), Parameter::free("b", 0.0)], points.collect(), |x, p, by| {
            by.copy_from_slice(&[1.0, x]);
            p[0] + p[1] * x
        });
    curve.series[0].loss = loss;
    curve
}

#[test]
fn a_seventh_of_the_rows_is_wrong() {
    let (mut covered, mut plain) = (0, 0);
    for seed in 0..100 {
        let stop = AtomicBool::new(false);
        let settings = Settings { starts: 1, ..Settings::default() };
        let robust = spoiled(Loss::Huber(1.345), seed);
        let found = fit(&robust, &settings, &stop).unwrap();
        assert_eq!(found.status, Status::Converged);
        let [low, high] = found.wald(&robust.parameters[1], 1, 0.95);
        covered += usize::from(low < 3.0 && 3.0 < high);
        assert!((found.values[1] - 3.0).abs() < 0.1 && found.sd(1) < 0.05, "{:?} ± {}", found.values, found.sd(1));
        plain +=
            usize::from((fit(&spoiled(Loss::Squares, seed), &settings, &stop).unwrap().values[0] - 2.0).abs() > 0.5);
    }
    assert!((88..=100).contains(&covered), "{covered}");
    assert!(plain > 90, "{plain}");
}
