//! From one start to a minimum.

use super::quadratic::{Row, solve};
use super::{Slope, Value};

/// How a minimum is looked for.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Values that are asked for at most.
    pub most: usize,
}

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// At a minimum that the constraints admit.
    Converged,
    /// Where no step leads further down although one should: at a kink, or where the numbers are too rough.
    Stalled,
    /// After as many values as were allowed.
    Spent,
    /// Where the constraints are broken and cannot be mended nearby.
    Infeasible,
    /// Nothing could be worked out where it started.
    Failed,
}

/// What was found.
#[derive(Debug, Clone)]
pub struct Descent {
    /// How it ended.
    pub status: Status,
    /// The best point.
    pub x: Vec<f64>,
    /// There; `None` where nothing could be worked out at the start.
    pub value: Option<Value>,
    /// Multipliers of the constraints.
    pub multipliers: Vec<f64>,
}

/// Broken by less than this a constraint holds.
const HOLDS: f64 = 1e-7;

/// The first step goes no further, and no step further than the whole range.
const FIRST_REACH: f64 = 0.2;

/// Shares of a step that are tried one after another at most.
const MOST_TRIES: usize = 8;

/// The merit is to fall below the largest of so many points (L. Grippo, F. Lampariello, S. Lucidi, SIAM J. Numer. Anal. 23 (1986) 707–716).
const REMEMBERED: usize = 5;

/// Curvature of the unknown that stands for the largest of several.
const OF_LARGEST: f64 = 0.1;

/// Goes down from `start`, whose variables are between 0 and 1, until a step at a point is `small`; `at` gives values, `None` where there are none.
pub fn descend(
    start: &[f64],
    settings: &Settings,
    at: &mut dyn FnMut(&[f64]) -> Option<Value>,
    small: &dyn Fn(&[f64], &[f64]) -> bool,
) -> Descent {
    let n = start.len();
    let mut asked = 0;
    let mut ask = |x: &[f64], asked: &mut usize| {
        *asked += 1;
        at(x).filter(Value::is_finite)
    };
    let mut x = start.to_vec();
    let Some(mut value) = ask(&x, &mut asked) else {
        return Descent { status: Status::Failed, x, value: None, multipliers: Vec::new() };
    };
    let count = value.constraints.len();
    let (mut curvature, mut is_new) = (Curvature::unit(n, steepness(&value)), true);
    let (mut reach, mut price) = (FIRST_REACH, steepness(&value).max(1e-12));
    let mut multipliers = vec![0.0; count];
    let mut passed: Vec<[f64; 2]> = Vec::new();
    loop {
        let Some(step) = step(&x, &value, &curvature, (reach, price)) else {
            return Descent { status: Status::Stalled, x, value: Some(value), multipliers };
        };
        let of_constraints = &step.multipliers[value.of.len()..];
        multipliers.copy_from_slice(of_constraints);
        let largest = of_constraints.iter().copied().fold(0.0, f64::max);
        // The price is above every multiplier, so that it pays to keep the constraints.
        if largest >= 0.9 * price && price < 1e8 * steepness(&value).max(1e-12) {
            price *= 4.0;
            continue;
        }
        if small(&x, &step.d) {
            let status = if value.broken() <= HOLDS { Status::Converged } else { Status::Infeasible };
            return Descent { status, x, value: Some(value), multipliers };
        }
        let broken = |value: &Value| value.constraints.iter().map(|one| one.value.max(0.0)).sum::<f64>();
        let merit = |value: &Value| value.largest() + price * broken(value);
        if passed.len() == REMEMBERED {
            passed.remove(0);
        }
        passed.push([value.largest(), broken(&value)]);
        // Along a bent constraint the merit may rise for a while.
        let here = passed.iter().map(|[largest, broken]| largest + price * broken).fold(f64::NEG_INFINITY, f64::max);
        let expected = step.expected;
        let mut share = 1.0;
        let mut found = None;
        for _ in 0..MOST_TRIES {
            if asked >= settings.most {
                return Descent { status: Status::Spent, x, value: Some(value), multipliers };
            }
            let next: Vec<f64> = x.iter().zip(&step.d).map(|(x, d)| (x + share * d).clamp(0.0, 1.0)).collect();
            let trial = ask(&next, &mut asked);
            let there = trial.as_ref().map_or(f64::INFINITY, merit);
            if there <= here - 1e-4 * share * expected + 1e-13 * here.abs() {
                found = trial.map(|trial| (next, trial));
                break;
            }
            // A constraint that bends away is met by a second step from there.
            let bent = trial.filter(|trial| share == 1.0 && broken(trial) > broken(&value).max(HOLDS));
            if let Some(bent) = bent
                && let Some(again) = self::step(&x, &value.bent(&bent, &step.d), &curvature, (reach, price))
                && asked < settings.most
            {
                let next: Vec<f64> = x.iter().zip(&again.d).map(|(x, d)| (x + d).clamp(0.0, 1.0)).collect();
                let trial = ask(&next, &mut asked);
                if trial.as_ref().map_or(f64::INFINITY, merit) <= here - 1e-4 * expected {
                    found = trial.map(|trial| (next, trial));
                    break;
                }
            }
            // Where the parabola through both values and the slope is least.
            let lower = 0.5 * share * share * expected / (there - here + share * expected);
            share = if there.is_finite() { lower.clamp(0.1 * share, 0.5 * share) } else { 0.3 * share };
            let shorter: Vec<f64> = step.d.iter().map(|d| share * d).collect();
            if small(&x, &shorter) {
                break;
            }
        }
        let Some((next, trial)) = found else {
            if is_new {
                let status = if value.broken() <= HOLDS { Status::Stalled } else { Status::Infeasible };
                return Descent { status, x, value: Some(value), multipliers };
            }
            (curvature, is_new) = (Curvature::unit(n, steepness(&value)), true);
            passed.clear();
            reach = (0.5 * reach).max(1e-3);
            continue;
        };
        let moved: Vec<f64> = next.iter().zip(&x).map(|(next, x)| next - x).collect();
        let gradient = |value: &Value| lagrangian(value, &step.multipliers, n);
        let turned: Vec<f64> = gradient(&trial).iter().zip(gradient(&value)).map(|(new, old)| new - old).collect();
        curvature.learn(&moved, &turned, is_new);
        is_new = false;
        let length = moved.iter().fold(0.0f64, |length, d| length.max(d.abs()));
        reach = match share {
            1.0 if length > 0.9 * reach => (2.0 * reach).min(1.0),
            1.0 => reach,
            _ => (2.0 * length).clamp(1e-6, reach),
        };
        (x, value) = (next, trial);
    }
}

impl Value {
    /// The same with constraints that are what they were found to be behind a step `d`.
    fn bent(&self, there: &Self, d: &[f64]) -> Self {
        let along = |gradient: &[f64]| gradient.iter().zip(d).map(|(g, d)| g * d).sum::<f64>();
        let constraints = self
            .constraints
            .iter()
            .zip(&there.constraints)
            .map(|(here, there)| Slope { value: there.value - along(&here.gradient), gradient: here.gradient.clone() });
        Self { of: self.of.clone(), constraints: constraints.collect() }
    }
}

/// The steepest of all slopes.
fn steepness(value: &Value) -> f64 {
    value.of.iter().flat_map(|one| &one.gradient).fold(0.0, |steepest: f64, slope| steepest.max(slope.abs()))
}

/// A step.
struct Step {
    d: Vec<f64>,
    /// Of what is to be small, then of the constraints.
    multipliers: Vec<f64>,
    /// By how much the merit falls, to first order, less half of what curvature takes back.
    expected: f64,
}

/// The solution of the quadratic problem within `reach`.
fn step(x: &[f64], value: &Value, curvature: &Curvature, (reach, price): (f64, f64)) -> Option<Step> {
    let (n, several) = (x.len(), value.of.len() > 1);
    let size = n + usize::from(several);
    let mut b = vec![0.0; size * size];
    for i in 0..n {
        b[i * size..i * size + n].copy_from_slice(&curvature.b[i * n..(i + 1) * n]);
    }
    let mut g = vec![0.0; size];
    let mut rows = Vec::new();
    let largest = value.largest();
    if several {
        b[size * size - 1] = OF_LARGEST;
        g[n] = 1.0;
        for one in &value.of {
            let mut of = one.gradient.clone();
            of.push(-1.0);
            rows.push(Row { of, limit: largest - one.value, price: f64::INFINITY });
        }
    } else {
        g[..n].copy_from_slice(&value.of[0].gradient);
    }
    let padded = |gradient: &[f64]| {
        let mut of = gradient.to_vec();
        of.resize(size, 0.0);
        of
    };
    rows.extend(value.constraints.iter().map(|one| Row { of: padded(&one.gradient), limit: -one.value, price }));
    for (k, x) in x.iter().enumerate() {
        for (sign, room) in [(1.0, 1.0 - x), (-1.0, *x)] {
            let mut of = vec![0.0; size];
            of[k] = sign;
            rows.push(Row { of, limit: room.clamp(0.0, reach), price: f64::INFINITY });
        }
    }
    let (d, all) = solve(&b, &g, &rows)?;
    let d = d[..n].iter().zip(x).map(|(d, x)| d.clamp(-x, 1.0 - x)).collect::<Vec<_>>();
    let own = if several { all[..value.of.len()].to_vec() } else { vec![1.0] };
    let from = if several { value.of.len() } else { 0 };
    let multipliers = own.into_iter().chain(all[from..from + value.constraints.len()].iter().copied()).collect();
    let along = |one: &Slope| one.value + one.gradient.iter().zip(&d).map(|(g, d)| g * d).sum::<f64>();
    let next = value.of.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let mended: f64 = value.constraints.iter().map(|one| one.value.max(0.0) - along(one).max(0.0)).sum();
    let bent: f64 = (0..n).map(|i| d[i] * (0..n).map(|j| curvature.b[i * n + j] * d[j]).sum::<f64>()).sum();
    let expected = (largest - next + price * mended - 0.5 * bent).max(0.5 * bent);
    Some(Step { d, multipliers, expected })
}

/// The gradient of what is to be small and of the constraints, each times its multiplier.
fn lagrangian(value: &Value, multipliers: &[f64], n: usize) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    for (one, multiplier) in value.of.iter().chain(&value.constraints).zip(multipliers) {
        sum.iter_mut().zip(&one.gradient).for_each(|(sum, slope)| *sum += multiplier * slope);
    }
    sum
}

/// What is known of the curvature of the Lagrangian, n × n.
struct Curvature {
    b: Vec<f64>,
    n: usize,
}

impl Curvature {
    /// As steep everywhere.
    fn unit(n: usize, steepness: f64) -> Self {
        let own = if steepness > 0.0 { steepness } else { 1.0 };
        Self { b: (0..n * n).map(|k| if k % (n + 1) == 0 { own } else { 0.0 }).collect(), n }
    }

    /// Takes in that the gradient turned by `y` along `s`; the first time its size is taken for all directions.
    fn learn(&mut self, s: &[f64], y: &[f64], is_first: bool) {
        let (n, dot) = (self.n, |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() });
        let (length, along) = (dot(s, s), dot(s, y));
        if length == 0.0 {
            return;
        }
        if is_first && along > 0.0 {
            *self = Self::unit(n, dot(y, y) / along);
        }
        let bent: Vec<f64> = (0..n).map(|i| dot(&self.b[i * n..(i + 1) * n], s)).collect();
        let whole = dot(s, &bent);
        // Where the curvature is hardly positive, a part of what was known stays.
        let part = if along >= 0.2 * whole { 1.0 } else { 0.8 * whole / (whole - along) };
        let y: Vec<f64> = y.iter().zip(&bent).map(|(y, bent)| part * y + (1.0 - part) * bent).collect();
        let along = dot(s, &y);
        for i in 0..n {
            for j in 0..n {
                self.b[i * n + j] += y[i] * y[j] / along - bent[i] * bent[j] / whole;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimisation::hypercube;

    fn slope(value: f64, gradient: &[f64]) -> Slope {
        Slope { value, gradient: gradient.to_vec() }
    }

    fn found(n: usize, at: &dyn Fn(&[f64]) -> Value, most: usize) -> Vec<(Descent, usize)> {
        let settings = Settings { most };
        let small = |_: &[f64], d: &[f64]| d.iter().all(|d| d.abs() < 1e-7);
        hypercube(n, 5, 1)
            .iter()
            .map(|start| {
                let mut asked = 0;
                let mut counted = |x: &[f64]| {
                    asked += 1;
                    Some(at(x))
                };
                let found = descend(start, &settings, &mut counted, &small);
                (found, asked)
            })
            .collect()
    }

    #[test]
    fn a_bent_valley_leads_to_its_minimum() {
        // Rosenbrock's valley on [-2, 2]².
        let at = |x: &[f64]| {
            let (u, v) = (4.0 * x[0] - 2.0, 4.0 * x[1] - 2.0);
            let (f, rest) = (100.0 * (v - u * u).powi(2) + (1.0 - u).powi(2), v - u * u);
            let g = [4.0 * (-400.0 * u * rest - 2.0 * (1.0 - u)), 4.0 * 200.0 * rest];
            Value { of: vec![slope(f, &g)], constraints: Vec::new() }
        };
        for (found, asked) in found(2, &at, 200) {
            assert_eq!(found.status, Status::Converged);
            assert!(found.x.iter().all(|x| (x - 0.75).abs() < 1e-5), "{:?}", found.x);
            println!("{asked} values");
            assert!(asked < 80, "{asked}");
        }
    }

    #[test]
    fn constraints_and_bounds_hold_with_their_multipliers() {
        // min (u − 2)² + (v − 1)² where u + v ≤ 1, on [0, 1]²: at (1, 0), the limit and both bounds; and where u² + v² ≤ 1 at 2/√5, 1/√5.
        let line = |x: &[f64]| Value {
            of: vec![slope((x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2), &[2.0 * (x[0] - 2.0), 2.0 * (x[1] - 1.0)])],
            constraints: vec![slope(x[0] + x[1] - 1.0, &[1.0, 1.0])],
        };
        let round = |x: &[f64]| Value {
            constraints: vec![slope(x[0] * x[0] + x[1] * x[1] - 1.0, &[2.0 * x[0], 2.0 * x[1]])],
            ..line(x)
        };
        for (found, asked) in found(2, &line, 40) {
            assert_eq!(found.status, Status::Converged);
            assert!((found.x[0] - 1.0).abs() < 1e-6 && found.x[1].abs() < 1e-6, "{:?} after {asked}", found.x);
        }
        for (found, asked) in found(2, &round, 40) {
            assert_eq!(found.status, Status::Converged);
            let (u, v) = (2.0 / 5f64.sqrt(), 1.0 / 5f64.sqrt());
            assert!((found.x[0] - u).abs() < 1e-6 && (found.x[1] - v).abs() < 1e-6, "{:?} after {asked}", found.x);
            assert!((found.multipliers[0] - (5f64.sqrt() - 1.0)).abs() < 1e-4, "{:?}", found.multipliers);
        }
    }

    #[test]
    fn the_largest_of_several_is_smallest_where_they_meet() {
        // max(x², (x − 1)² + y): at x = ½, y = 0.
        let at = |x: &[f64]| Value {
            of: vec![
                slope(x[0] * x[0], &[2.0 * x[0], 0.0]),
                slope((x[0] - 1.0).powi(2) + x[1], &[2.0 * (x[0] - 1.0), 1.0]),
            ],
            constraints: Vec::new(),
        };
        for (found, asked) in found(2, &at, 40) {
            assert_eq!(found.status, Status::Converged);
            assert!((found.x[0] - 0.5).abs() < 1e-6 && found.x[1].abs() < 1e-6, "{:?} after {asked}", found.x);
        }
    }

    #[test]
    fn what_cannot_hold_and_what_cannot_be_worked_out_is_said() {
        let broken = |x: &[f64]| Value {
            of: vec![slope(x[0], &[1.0])],
            constraints: vec![slope(x[0] - 0.2, &[1.0]), slope(0.4 - x[0], &[-1.0])],
        };
        for (found, _) in found(1, &broken, 40) {
            assert_eq!(found.status, Status::Infeasible, "{found:?}");
        }
        let small = |_: &[f64], d: &[f64]| d.iter().all(|d| d.abs() < 1e-7);
        let failed = descend(&[0.5], &Settings { most: 40 }, &mut |_| None, &small);
        assert!(failed.status == Status::Failed && failed.value.is_none());
        // Half of the range has no values: the minimum lies at its edge, and steps into it count as infinite.
        let mut half = |x: &[f64]| {
            (x[0] < 0.7).then(|| Value {
                of: vec![slope((x[0] - 0.6).powi(2), &[2.0 * (x[0] - 0.6)])],
                constraints: Vec::new(),
            })
        };
        let found = descend(&[0.1], &Settings { most: 40 }, &mut half, &small);
        assert!(found.status == Status::Converged && (found.x[0] - 0.6).abs() < 1e-6, "{found:?}");
    }
}
