//! How many decays each memory takes, so that every channel is as exact as is asked for.

use super::LinearModel;
use super::power::{Power, Powers};
use super::realise::{Realised, realise};
use crate::linear::assembly::{Assembly, Parts, Row};
use crate::linear::linearisation::Linearisation;
use crate::linear::response::{Excitation, NoResponse};
use crate::observe::{ElementQuantity, Quantity};
use num_complex::Complex64;

/// Places in a decade that are looked at.
const PLACES: f64 = 50.0;
/// Beside a resonance, in units of its half width.
const BESIDE: [f64; 7] = [0.0, 0.3, 0.7, 1.0, 2.0, 4.0, 8.0];
/// Next to the terms that it is the sum of, an answer is rounding.
const ROUNDING: f64 = 1e-12;
/// What is aimed at, in units of the tolerance; and by how much less where a finer look finds more.
const AIM: f64 = 0.98;
const LESS: f64 = 0.8;
const ATTEMPTS: usize = 8;
/// Tolerances that can be asked for.
const TOLERANCES: [f64; 2] = [1e-11, 0.5];

/// What a linear model shall be.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelOrder<'a> {
    /// Its inputs.
    pub inputs: &'a [Excitation],
    /// Its outputs.
    pub outputs: &'a [Quantity],
    /// Angular frequencies between which it is to be exact, rad/s.
    pub band: [f64; 2],
    /// Relative deviation that every channel may have at every frequency of the band.
    pub tolerance: f64,
}

/// Why there is no linear model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LineariseError {
    /// Forces move no joint.
    #[error("no joint is free to move: all are prescribed or locked")]
    NoFree,
    /// The band or the tolerance is no such thing.
    #[error("{0}")]
    Order(&'static str),
    /// An output is not linear in what moves.
    #[error(transparent)]
    Output(#[from] NoResponse),
    /// An output answers to how fast an input changes.
    #[error("output {output} answers to how fast input {input} changes, which no x' = A x + B u, y = C x + D u does")]
    NotProper {
        /// Which output.
        output: usize,
        /// Which input.
        input: usize,
    },
    /// The equations are singular.
    #[error("the equations of small motions do not determine all strokes inside the laws")]
    Singular,
    /// The tolerance is out of reach.
    #[error("a relative deviation of {reached:.1e} is reached, not {tolerance:.1e}")]
    OutOfReach {
        /// What was asked for.
        tolerance: f64,
        /// What was reached.
        reached: f64,
    },
}

/// x' = A x + B u, y = C x + D u of small motions, with s^alpha of every springpot as d0 + d1 s + Σ w_i s/(s + p_i), w_i, p_i > 0, of as few
/// decays as keep every channel within the tolerance of its exact frequency response over the band.
///
/// A network of springs and dashpots stands for each springpot, so that a passive robot stays passive and has its poles in the left half plane.
/// Springpots of one order under proportional strokes share their decays. Where an input would meet d1 directly, d1 = 0.
///
/// # Errors
/// [`LineariseError`].
pub fn linearise(linear: &Linearisation, order: &ModelOrder) -> Result<LinearModel, LineariseError> {
    let ModelOrder { inputs, outputs, band, tolerance } = order;
    if linear.free.is_empty() {
        return Err(LineariseError::NoFree);
    }
    if !(band[0] > 0.0 && band[0] < band[1] && band[1].is_finite()) {
        return Err(LineariseError::Order("a band goes from a frequency above 0 to a higher one"));
    }
    if !(TOLERANCES[0]..=TOLERANCES[1]).contains(tolerance) {
        return Err(LineariseError::Order("a tolerance is from 1e-11 to 0.5"));
    }
    let is_inside = |quantity: &Quantity| {
        matches!(quantity, Quantity::Element(_, ElementQuantity::Leaf(..) | ElementQuantity::Derivative))
    };
    let parts = if outputs.iter().any(is_inside) { Parts::All } else { Parts::Reduced };
    let assembly = Assembly::new(linear, inputs, parts, None);
    let rows: Vec<Row> = outputs.iter().map(|quantity| assembly.observe(*quantity)).collect::<Result<_, _>>()?;
    let rates = resonances(linear);
    // As if all sums began with a decay each: what matters is which derivatives are met.
    let is_proper = {
        let mut table = Tables::new(&assembly, *band, false);
        let first: Vec<Power> = table.powers(&vec![1; assembly.springpots.len()]).ok_or(LineariseError::Singular)?;
        let realised = realise(&assembly, &rows, &first).ok_or(LineariseError::Singular)?;
        improper(&realised, *band).is_some()
    };
    let mut search = Search {
        tables: Tables::new(&assembly, *band, is_proper),
        channels: Channels::new(&assembly, &rows, *band, &rates),
        assembly: &assembly,
        rows: &rows,
    };
    let fine = Channels::new(&assembly, &rows, [band[0], band[1]], &rates).finer(&assembly, &rows);
    let mut aim = AIM * tolerance;
    let mut reached = f64::INFINITY;
    for _ in 0..ATTEMPTS {
        let (counts, error) = search.run(aim);
        let Some(powers) = counts.and_then(|counts| search.tables.powers(&counts)) else {
            reached = reached.min(error);
            break;
        };
        let realised = realise(&assembly, &rows, &powers).ok_or(LineariseError::Singular)?;
        if let Some([output, input]) = improper(&realised, *band) {
            return Err(LineariseError::NotProper { output, input });
        }
        let [d, ..] = realised.d;
        let mut model = LinearModel {
            a: realised.a,
            b: realised.b,
            c: realised.c,
            d,
            states: realised.states,
            error: search.error(&powers).max(fine.error(&assembly, &rows, &powers)),
        };
        model.error = model.error.max(search.channels.error_of(&model)).max(fine.error_of(&model));
        reached = reached.min(model.error);
        if model.error <= *tolerance {
            return Ok(model);
        }
        aim *= LESS;
    }
    Err(LineariseError::OutOfReach { tolerance: *tolerance, reached })
}

/// Where and how sharply the robot answers most: imaginary parts of the eigenvalues, rad/s, and −Re s/|s|.
fn resonances(linear: &Linearisation) -> Vec<[f64; 2]> {
    let modes = linear.modes().map(|modes| modes.modes).unwrap_or_default();
    let vibrating = modes.into_iter().filter(|mode| mode.eigenvalue.im > 0.0);
    vibrating.map(|mode| [mode.eigenvalue.im, mode.damping_ratio().abs().clamp(1e-9, 0.3)]).collect()
}

/// An output and an input of which derivatives are left.
fn improper(realised: &Realised, band: [f64; 2]) -> Option<[usize; 2]> {
    let [_, rest @ ..] = &realised.d;
    for (order, d) in (1..).zip(rest) {
        for (o, row) in d.iter().enumerate() {
            for (i, entry) in row.iter().enumerate() {
                let own = entry.abs() * band[1].powi(order);
                let direct = realised.d[0][o][i].abs();
                let through: f64 = realised.c[o].iter().zip(&realised.b).map(|(c, b)| (c * b[i]).abs()).sum();
                if own > 1e-9 * (direct + through / band[1]) && own > 0.0 {
                    return Some([o, i]);
                }
            }
        }
    }
    None
}

/// Approximations of every order.
struct Tables {
    /// Of each springpot its table.
    of: Vec<usize>,
    tables: Vec<Powers>,
}

impl Tables {
    fn new(assembly: &Assembly, band: [f64; 2], is_proper: bool) -> Self {
        let mut orders: Vec<f64> = Vec::new();
        let mut place = |order: f64| {
            orders.iter().position(|own| *own == order).unwrap_or_else(|| {
                orders.push(order);
                orders.len() - 1
            })
        };
        let of = assembly.springpots.iter().map(|springpot| place(springpot.order)).collect();
        let tables = orders.into_iter().map(|order| Powers::new(order, band, is_proper)).collect();
        Self { of, tables }
    }

    fn powers(&mut self, counts: &[usize]) -> Option<Vec<Power>> {
        let Self { of, tables } = self;
        of.iter().zip(counts).map(|(&table, &count)| tables[table].get(count).cloned()).collect()
    }

    /// The fewest decays of each springpot whose own error is up to `error`.
    fn fewest(&mut self, error: f64) -> Option<Vec<usize>> {
        let Self { of, tables } = self;
        of.iter().map(|&table| tables[table].fewest(error)).collect()
    }
}

impl Tables {
    /// The counts of the smallest errors that were found.
    fn best(&mut self) -> Vec<usize> {
        self.of.iter().map(|&table| self.tables[table].best()).collect()
    }
}

/// Exact answers of all channels over a band.
struct Channels {
    omegas: Vec<f64>,
    /// By frequency, input and output: the answer, and the size of its terms.
    exact: Vec<Vec<Vec<(Complex64, f64)>>>,
}

impl Channels {
    fn new(assembly: &Assembly, rows: &[Row], band: [f64; 2], rates: &[[f64; 2]]) -> Self {
        let decades = (band[1] / band[0]).log10();
        let count = (decades * PLACES).ceil().max(20.0) as usize;
        let mut omegas: Vec<f64> =
            (0..=count).map(|k| band[0] * (band[1] / band[0]).powf(k as f64 / count as f64)).collect();
        for [rate, ratio] in rates {
            for beside in BESIDE {
                omegas.extend([1.0, -1.0].map(|side| rate * (1.0 + side * beside * ratio)));
            }
        }
        omegas.retain(|omega| (band[0]..=band[1]).contains(omega));
        omegas.sort_by(f64::total_cmp);
        omegas.dedup();
        let mut own = Self { exact: omegas.iter().map(|omega| exact(assembly, rows, *omega)).collect(), omegas };
        own.refine(assembly, rows);
        own
    }

    /// Looks closer where an answer has a minimum: there its relative error is largest.
    fn refine(&mut self, assembly: &Assembly, rows: &[Row]) {
        let mut more = Vec::new();
        for (i, o) in channels(assembly, rows) {
            let size = |k: usize| self.exact[k][i][o].0.norm();
            for k in 1..self.omegas.len().saturating_sub(1) {
                if size(k) < size(k - 1) && size(k) < size(k + 1) {
                    let (mut low, mut high) = (self.omegas[k - 1], self.omegas[k + 1]);
                    let ratio = 0.5 * (5f64.sqrt() - 1.0);
                    for _ in 0..25 {
                        let [left, right] = [high - ratio * (high - low), low + ratio * (high - low)];
                        let [a, b] = [left, right].map(|omega| exact(assembly, rows, omega)[i][o].0.norm());
                        if a < b { high = right } else { low = left }
                    }
                    more.push(0.5 * (low + high));
                }
            }
        }
        for omega in more {
            let place = self.omegas.partition_point(|own| *own < omega);
            self.omegas.insert(place, omega);
            self.exact.insert(place, exact(assembly, rows, omega));
        }
    }

    /// The same between its places.
    fn finer(&self, assembly: &Assembly, rows: &[Row]) -> Self {
        let between =
            self.omegas.windows(2).flat_map(|pair| [0.31, 0.69].map(|share| pair[0] + share * (pair[1] - pair[0])));
        let omegas: Vec<f64> = between.collect();
        Self { exact: omegas.iter().map(|omega| exact(assembly, rows, *omega)).collect(), omegas }
    }

    /// The largest relative deviation with `powers` in place of the springpots.
    fn error(&self, assembly: &Assembly, rows: &[Row], powers: &[Power]) -> f64 {
        let each = self.omegas.iter().zip(&self.exact).map(|(omega, exact)| {
            let s = Complex64::new(0.0, *omega);
            let rational: Vec<Complex64> = powers.iter().map(|power| power.at(s)).collect();
            deviation(&answers(assembly, rows, s, &rational), exact)
        });
        each.fold(0.0, f64::max)
    }

    /// The same of a model, at as many places as a second or so has room for.
    fn error_of(&self, model: &LinearModel) -> f64 {
        let n = model.a.len() as f64;
        let stride = ((n.powi(3) * self.omegas.len() as f64 / 3e7).ceil() as usize).max(1);
        let each = self.omegas.iter().zip(&self.exact).step_by(stride).map(|(omega, exact)| {
            let answers = model.frequency_response(*omega);
            let off = |i: usize, o: usize| off(answers[o][i], exact[i][o]);
            let all = (0..exact.len()).flat_map(|i| (0..answers.len()).map(move |o| (i, o)));
            all.map(|(i, o)| off(i, o)).fold(0.0, f64::max)
        });
        each.fold(0.0, f64::max)
    }
}

fn channels(assembly: &Assembly, rows: &[Row]) -> Vec<(usize, usize)> {
    (0..assembly.excitations.len()).flat_map(|i| (0..rows.len()).map(move |o| (i, o))).collect()
}

/// The answers by input and output with the size of their terms.
fn answers(assembly: &Assembly, rows: &[Row], s: Complex64, powers: &[Complex64]) -> Vec<Vec<(Complex64, f64)>> {
    let lines: Vec<Vec<Complex64>> = rows.iter().map(|row| row.at(s, &assembly.springpots, powers)).collect();
    let one = |line: &Vec<Complex64>, columns: &[Complex64]| {
        let terms = || line.iter().zip(columns).map(|(row, column)| row * column);
        (terms().sum::<Complex64>(), terms().map(|term| term.norm()).sum())
    };
    let solved = assembly.solve(s, powers);
    solved.iter().map(|columns| lines.iter().map(|line| one(line, columns)).collect()).collect()
}

fn exact(assembly: &Assembly, rows: &[Row], omega: f64) -> Vec<Vec<(Complex64, f64)>> {
    let s = Complex64::new(0.0, omega);
    answers(assembly, rows, s, &assembly.powers(s))
}

fn deviation(answers: &[Vec<(Complex64, f64)>], exact: &[Vec<(Complex64, f64)>]) -> f64 {
    let pairs = answers.iter().flatten().zip(exact.iter().flatten());
    pairs.map(|(own, exact)| off(own.0, *exact)).fold(0.0, f64::max)
}

/// The relative deviation of one answer; what is rounding has none.
fn off(own: Complex64, (exact, size): (Complex64, f64)) -> f64 {
    let off = (own - exact).norm();
    if exact.norm() <= ROUNDING * size && off <= 10.0 * ROUNDING * size { 0.0 } else { off / exact.norm() }
}

/// How many decays it takes.
struct Search<'a> {
    tables: Tables,
    channels: Channels,
    assembly: &'a Assembly<'a>,
    rows: &'a [Row],
}

impl Search<'_> {
    fn error(&self, powers: &[Power]) -> f64 {
        self.channels.error(self.assembly, self.rows, powers)
    }

    fn error_with(&mut self, counts: &[usize]) -> f64 {
        match self.tables.powers(counts) {
            Some(powers) => self.error(&powers),
            None => f64::INFINITY,
        }
    }

    /// The counts with which the error is up to `aim`, none of which can be less; else how small the error became.
    fn run(&mut self, aim: f64) -> (Option<Vec<usize>>, f64) {
        // One error for all springpots first.
        let (mut own, mut reached) = (2.0 * aim, f64::INFINITY);
        let mut counts = loop {
            let Some(counts) = self.tables.fewest(own) else {
                let best = self.tables.best();
                return (None, reached.min(self.error_with(&best)));
            };
            let error = self.error_with(&counts);
            reached = reached.min(error);
            if error <= aim {
                break counts;
            }
            if own < 1e-5 * aim {
                return (None, reached);
            }
            own *= 0.6;
        };
        loop {
            let mut gained = false;
            let mut places: Vec<usize> = (0..counts.len()).filter(|&k| counts[k] > 0).collect();
            places.sort_by_key(|&k| std::cmp::Reverse(counts[k]));
            for k in places {
                counts[k] -= 1;
                if self.error_with(&counts) <= aim {
                    gained = true;
                } else {
                    counts[k] += 1;
                }
            }
            if !gained {
                return (Some(counts), reached);
            }
        }
    }
}
