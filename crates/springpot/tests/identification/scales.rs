//! Parameters twenty decades apart, and what rows do not tell apart.

use crate::support::{Curve, Noise};
use springpot::identification::{Parameter, Settings, Status, fit};
use std::sync::atomic::AtomicBool;

/// y = a·1e-10·e^{−x} + 1e10·b·e^{−3x} with a of 1e10 and b of 1e-10.
fn decades(parameters: Vec<Parameter>) -> Curve {
    let mut noise = Noise(4);
    let points = (0..60)
        .map(|k| 0.05 * f64::from(k))
        .map(|x| [x, 2.0 * (-x).exp() + 5.0 * (-3.0 * x).exp() + 0.01 * noise.normal()])
        .collect();
    Curve::new(parameters, points, |x, p, by| {
        by.copy_from_slice(&[1e-10 * (-x).exp(), 1e10 * (-3.0 * x).exp()]);
        p[0] * by[0] + p[1] * by[1]
    })
}

#[test]
fn twenty_decades() {
    let log = |start| Parameter::new("p", start, [0.0, f64::INFINITY]);
    let linear = |start: f64| Parameter { typical: start, ..Parameter::free("p", start) };
    let problems = [decades(vec![log(1e9), log(1e-8)]), decades(vec![linear(1e9), linear(1e-8)])];
    let found = problems
        .map(|problem| fit(&problem, &Settings { starts: 1, ..Settings::default() }, &AtomicBool::new(false)).unwrap());
    for fit in &found {
        assert_eq!((fit.status, fit.undetermined.len()), (Status::Converged, 0));
        for (j, exact) in [2e10, 5e-10].into_iter().enumerate() {
            assert!((fit.values[j] - exact).abs() < 4.0 * fit.sd(j) && fit.sd(j) < 0.02 * exact, "{:?}", fit.values);
            assert!((fit.values[j] / found[0].values[j] - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn only_the_sum_is_determined() {
    let mut noise = Noise(9);
    let points: Vec<[f64; 2]> =
        (0..50).map(|k| 0.1 * f64::from(k)).map(|x| [x, 50.0 + 7.0 * x + 0.5 * noise.normal()]).collect();
    let positive = |name: &str, start| Parameter::new(name, start, [0.0, f64::INFINITY]);
    let curve =
        Curve::new(vec![positive("E_c", 10.0), positive("k", 1.0), positive("E_kv", 20.0)], points, |x, p, by| {
            by.copy_from_slice(&[1.0, x, 1.0]);
            p[0] + p[1] * x + p[2]
        });
    let found = fit(&curve, &Settings::default(), &AtomicBool::new(false)).unwrap();
    let names = |j: usize| curve.parameters[j].name.clone();
    let [open] = &found.undetermined[..] else { panic!("{:?}", found.undetermined) };
    let determined = open.determined.unwrap();
    assert_eq!(determined.sum.map(|(j, _)| j), [0, 2]);
    assert!(
        (determined.sum[1].1 - 1.0).abs() < 1e-6 && (determined.value - 50.0).abs() < 4.0 * determined.sd,
        "{determined:?}"
    );
    assert!((determined.sd / 0.14 - 1.0).abs() < 0.3, "{determined:?}");
    let text = open.text(names);
    assert!(text.starts_with("only E_c + E_kv = ") && text.ends_with(" is determined"), "{text}");
    // Neither is put to 0, nor said to be known; what is not involved is.
    assert_eq!((found.at_bound[0], found.at_bound[2]), (None, None));
    assert!(
        [0, 2].iter().all(|j| found.sd(*j) >= 1e3) && found.sd(1) < 0.1,
        "{:?}",
        [found.sd(0), found.sd(1), found.sd(2)]
    );
    // A parameter that no residual depends on keeps its start.
    let points = curve.points.clone();
    let blind = Curve::new(vec![positive("a", 3.0), positive("b", 4.0)], points, |x, p, by| {
        by.copy_from_slice(&[x, 0.0]);
        p[0] * x
    });
    let found = fit(&blind, &Settings { starts: 1, ..Settings::default() }, &AtomicBool::new(false)).unwrap();
    assert_eq!((&found.unseen[..], found.values[1], found.parameters), (&[1][..], 4.0, 1));
}
