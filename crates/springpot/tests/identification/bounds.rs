//! Bounds that act, and the test at those that a logarithm never reaches.

use crate::support::{Curve, Noise};
use springpot::identification::{
    Failed, Parameter, Prior, Problem, Rows, Scale, Series, Settings, Side, Status, at_start, fit, profile,
};
use std::sync::atomic::AtomicBool;

/// Rosenbrock's valley, r = (10(y − x²), 1 − x), with rows of 0 behind so that there are enough.
struct Valley(Vec<Parameter>, [Series; 1]);

impl Valley {
    fn new(parameters: Vec<Parameter>) -> Self {
        Self(parameters, [Series::new("r")])
    }
}

impl Problem for Valley {
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn series(&self) -> &[Series] {
        &self.1
    }
    fn rows(&self, p: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let [x, y] = [p[0], p[1]];
        let jacobian = [-20.0 * x, 10.0, -1.0, 0.0];
        take(Rows { series: 0, residuals: &[10.0 * (y - x * x), 1.0 - x], jacobian: &jacobian });
        Ok(())
    }
}

fn one(settings: Settings, problem: &dyn Problem) -> springpot::identification::Fit {
    fit(problem, &settings, &AtomicBool::new(false)).unwrap()
}

const ONCE: Settings = Settings { starts: 1, seed: 1, steps: 500 };

#[test]
fn the_valley_and_a_bound_in_it() {
    let free = Valley::new(vec![Parameter::free("x", -1.2), Parameter::free("y", 1.0)]);
    let found = one(ONCE, &free);
    assert_eq!(found.status, Status::Converged);
    assert!((found.values[0] - 1.0).abs() < 1e-12 && (found.values[1] - 1.0).abs() < 1e-12, "{:?}", found.values);
    let within = |bounds, scale, start| Parameter { bounds, scale, ..Parameter::free("x", start) };
    for (scale, low) in [(Scale::Linear, -1.0), (Scale::Log, 0.1)] {
        let bound = Valley::new(vec![within([low, 0.3], scale, 0.2), Parameter::free("y", 1.0)]);
        let found = one(ONCE, &bound);
        assert_eq!((found.values[0], found.at_bound[0], found.parameters), (0.3, Some(Side::Upper), 1), "{scale:?}");
        assert!((found.values[1] - 0.09).abs() < 1e-12 && found.sd(0) == 0.0, "{:?}", found.values);
    }
    // 1e-9 off the range the same minimum is no bound.
    let wide = Valley::new(vec![within([-1.0, 1.0 + 1e-9], Scale::Linear, 0.2), Parameter::free("y", 1.0)]);
    let found = one(ONCE, &wide);
    assert!(found.at_bound[0].is_none() && (found.values[0] - 1.0).abs() < 1e-12, "{:?}", found.values);
}

/// y = a + b·e^{−x} with noise.
fn line(a: f64, seed: u64) -> Curve {
    let mut noise = Noise(seed);
    let points =
        (0..40).map(|k| 0.1 * f64::from(k)).map(|x| [x, a + 3.0 * (-x).exp() + 0.05 * noise.normal()]).collect();
    let positive = |name| Parameter::new(name, 1.0, [0.0, f64::INFINITY]);
    Curve::new(vec![positive("a"), positive("b")], points, |x, p, by| {
        by.copy_from_slice(&[1.0, (-x).exp()]);
        p[0] + p[1] * by[1]
    })
}

#[test]
fn what_belongs_at_zero_is_zero_to_the_bit() {
    let (mut at_zero, mut inside) = (0, 0);
    for seed in 0..40 {
        let curve = line(0.0, seed);
        let found = one(ONCE, &curve);
        // The unbounded minimum of a linear problem says where it belongs.
        let mut free = line(0.0, seed);
        free.parameters = vec![Parameter::free("a", 1.0), Parameter::free("b", 1.0)];
        let exact = one(ONCE, &free);
        if exact.values[0] > 0.0 {
            assert!(found.at_bound[0].is_none(), "{seed}: {:?} {:?}", exact.values, found.values);
            assert!(
                (found.values[0] / exact.values[0] - 1.0).abs() < 1e-5,
                "{seed}: {:?} {:?}",
                exact.values,
                found.values
            );
            inside += 1;
            continue;
        }
        assert_eq!((found.values[0], found.at_bound[0], found.parameters), (0.0, Some(Side::Lower), 1), "{seed}");
        let [low, limit] = profile(&curve, &found, 0, 0.95, &AtomicBool::new(false)).unwrap();
        assert!(low == 0.0 && limit > 0.0 && limit < 0.06, "{limit}");
        let back = one(
            ONCE,
            &Curve {
                parameters: vec![Parameter::new("a", 0.0, [0.0, f64::INFINITY]), curve.parameters[1].clone()],
                ..line(0.0, seed)
            },
        );
        assert_eq!(back.values[0], 0.0);
        at_zero += 1;
    }
    assert!(at_zero > 10 && inside > 10, "{at_zero} {inside}");
    let found = one(ONCE, &line(0.5, 3));
    assert!(found.at_bound[0].is_none() && (found.values[0] - 0.5).abs() < 4.0 * found.sd(0));
}

#[test]
fn an_order_belongs_at_one() {
    // y = x^n with n at most 1, of points that rise faster.
    let points = (1..20).map(f64::from).map(|x| [x, x.powf(1.02)]).collect();
    let curve = Curve::new(
        vec![Parameter::new("c", 2.0, [0.0, f64::INFINITY]), Parameter::new("n", 0.4, [0.0, 1.0])],
        points,
        |x, p, by| {
            let power = x.powf(p[1]);
            by.copy_from_slice(&[power, p[0] * power * x.ln()]);
            p[0] * power
        },
    );
    let found = one(ONCE, &curve);
    assert_eq!((found.values[1], found.at_bound[1]), (1.0, Some(Side::Upper)));
    let [limit, high] = profile(&curve, &found, 1, 0.95, &AtomicBool::new(false)).unwrap();
    assert!(high == 1.0 && limit < 1.0 && limit > 0.97, "{limit}");
}

#[test]
fn priors_faults_and_failures() {
    let mut curve = line(0.5, 3);
    let free = one(ONCE, &curve);
    curve.parameters[0].prior = Some(Prior { mean: 0.7, sd: 1e-6 });
    let held = one(ONCE, &curve);
    assert!((held.values[0] - 0.7).abs() < 1e-6 && (free.values[0] - 0.7).abs() > 0.1 && held.rows == 40);
    let stop = AtomicBool::new(false);
    let told = |parameters| {
        let curve = Curve { parameters, ..line(0.5, 3) };
        fit(&curve, &ONCE, &stop).unwrap_err().to_string()
    };
    assert_eq!(told(Vec::new()), "there is no parameter");
    assert!(told(vec![Parameter::new("a", 2.0, [0.0, 1.0])]).contains("start is not within"));
    assert!(told(vec![Parameter::new("a", 2.0, [3.0, 1.0])]).contains("lower bound"));
    assert!(told(vec![Parameter { scale: Scale::Log, ..Parameter::free("a", 1.0) }]).contains("may be negative"));
    assert!(told(vec![Parameter { scale: Scale::Logit, ..Parameter::free("a", 1.0) }]).contains("has not both"));
    let few = Curve { points: vec![[0.0, 1.0]], ..line(0.5, 3) };
    assert_eq!(fit(&few, &ONCE, &stop).unwrap_err().to_string(), "1 rows for 2 parameters");
    // An interrupt before anything is done leaves the start.
    let stopped = fit(&line(0.5, 3), &Settings::default(), &AtomicBool::new(true)).unwrap();
    assert_eq!((stopped.status, stopped.starts, &stopped.values[..]), (Status::Interrupted, [1, 1], &[1.0, 1.0][..]));
}

/// √p, with no residuals below 1.
struct Root([Parameter; 1], [Series; 1]);

impl Problem for Root {
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn series(&self) -> &[Series] {
        &self.1
    }
    fn rows(&self, p: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        if p[0] < 1.0 {
            return Err(Failed(format!("p = {}", p[0])));
        }
        let slope = 0.5 / p[0].sqrt();
        take(Rows { series: 0, residuals: &[p[0].sqrt() - 1.1, p[0].sqrt() - 1.2], jacobian: &[slope, slope] });
        Ok(())
    }
}

#[test]
fn a_trial_that_fails_is_a_longer_cost() {
    let root = |start| Root([Parameter::free("p", start)], [Series::new("r")]);
    let found = one(ONCE, &root(400.0));
    assert!((found.values[0] - 1.15 * 1.15).abs() < 1e-10, "{:?}", found.values);
    let error = fit(&root(0.5), &ONCE, &AtomicBool::new(false)).unwrap_err();
    assert_eq!(error.to_string(), "no start can be evaluated: p = 0.5");
}

/// Nothing is known of what `b` changes.
struct Blind([Parameter; 2], [Series; 1]);

impl Problem for Blind {
    fn parameters(&self) -> &[Parameter] {
        &self.0
    }
    fn series(&self) -> &[Series] {
        &self.1
    }
    fn rows(&self, p: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        take(Rows { series: 0, residuals: &[p[0], p[1], 1.0], jacobian: &[1.0, 0.0, 0.0, f64::NAN, 0.0, 0.0] });
        Ok(())
    }
}

#[test]
fn what_has_no_derivative_is_named() {
    let blind = Blind([Parameter::free("a", 1.0), Parameter::free("b", 2.0)], [Series::new("r")]);
    let stop = AtomicBool::new(false);
    for error in [fit(&blind, &ONCE, &stop).unwrap_err(), at_start(&blind, &ONCE, &stop).unwrap_err()] {
        assert!(error.to_string().ends_with(" has no derivative by b = 2"), "{error}");
    }
}
