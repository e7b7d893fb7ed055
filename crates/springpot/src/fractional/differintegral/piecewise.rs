//! Functions of time as polynomials between joints, and D^a of them at any time.

use super::along::Start;
use super::along::march::{KERNEL_TOLERANCE, past_of};
use super::definition::Definition;
use super::error::{DerivativeError, FunctionError};
use super::first_slope::FirstSlope;
use super::hermite::{Form, Node};
use super::order::{Jump, Order};
use super::sampled::{Nodes, negligible_slope};
use crate::fractional::gamma::reciprocal_gamma;
use crate::fractional::kernel::Kernel;
use crate::fractional::scheme::{Samples, Scheme, SchemeError};

/// A function of time made of polynomials, from samples or from a closure.
///
/// It lives on [start, end], and start is the lower terminal of its derivatives. A kink or a jump is where one function
/// ends and the [next](Self::then) begins; there D^a is exact, and so it is for polynomials up to degree 5.
///
/// ```
/// use springpot::fractional::{Definition, Piecewise};
///
/// // x = |t − 1|: a kink at t = 1.
/// let x = Piecewise::spline(&[0.0, 1.0], &[1.0, 0.0])?.then(Piecewise::spline(&[1.0, 3.0], &[0.0, 2.0])?)?;
/// let d = x.derivative(0.5, Definition::Caputo)?;
/// // −D^½ t + 2 D^½ (t − 1)₊, D^½ t = 2√(t/π)
/// let exact = |t: f64| 2.0 / std::f64::consts::PI.sqrt() * (2.0 * (t - 1.0).max(0.0).sqrt() - t.sqrt());
/// for t in [0.2, 1.0, 1.001, 2.5] {
///     assert!((d.at(t).value - exact(t)).abs() < 1e-11);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Piecewise {
    pub(super) pieces: Vec<Piece>,
}

/// One polynomial x = Σ_p c_p θ^p, θ = (t − start)/width.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) start: f64,
    pub(super) width: f64,
    pub(super) x: Vec<f64>,
    /// By how much the polynomial may miss the function.
    pub(super) miss: f64,
    pub(super) joint: Joint,
}

/// How a piece follows the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Joint {
    /// x and x' are continuous.
    Smooth,
    /// x is continuous, and a jump of x' beyond what both pieces miss is a kink.
    Fitted,
    /// x and x' may jump.
    Broken,
}

/// A value and an estimate of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// D^a x.
    pub value: f64,
    /// Estimate of |error|: what the polynomials miss of the function and of x'(0), the kernel, rounding.
    pub error: f64,
}

impl Piecewise {
    /// The quintic Hermite spline through samples, as [`Method::Spline`](super::Method::Spline); `t` may start
    /// anywhere.
    ///
    /// # Errors
    /// `Samples`: fewer than two, unequal lengths, numbers that are not finite, times that do not increase.
    pub fn spline(t: &[f64], x: &[f64]) -> Result<Self, FunctionError> {
        let samples = Samples { t, x, rate: None };
        match samples.check(Scheme::L1, 0.5) {
            // Any start will do, but the times must still increase.
            Err(SchemeError::Start(_)) => {
                if let Some(row) = (1..t.len()).find(|&k| t[k] <= t[k - 1]) {
                    return Err(SchemeError::NotIncreasing { row, t: t[row], previous: t[row - 1] }.into());
                }
            }
            checked => checked?,
        }
        let form = Form::Quintic;
        let nodes = Nodes::of(&samples, form, None);
        let pieces = (1..t.len()).map(|row| {
            let [from, to]: [Node; 2] = [row - 1, row].map(|row| nodes.at(&samples, row));
            let x = form.between(&from, &to).to_vec();
            Piece { start: from.t, width: to.t - from.t, x, miss: 0.0, joint: Joint::Smooth }
        });
        Ok(Self { pieces: pieces.collect() })
    }

    /// This function up to its end, and `next` from there on; x and x' may jump.
    ///
    /// # Errors
    /// `Interval` where `next` does not start at this end.
    pub fn then(mut self, next: Self) -> Result<Self, FunctionError> {
        let (start, end) = (next.start(), self.end());
        if (start - end).abs() > 4.0 * f64::EPSILON * end.abs().max(start.abs()) {
            return Err(FunctionError::Interval { start: end, end: start });
        }
        let first = self.pieces.len();
        self.pieces.extend(next.pieces);
        self.pieces[first].joint = Joint::Broken;
        Ok(self)
    }

    /// Time of the first value, s: the lower terminal.
    pub fn start(&self) -> f64 {
        self.pieces[0].start
    }

    /// Time of the last value, s.
    pub fn end(&self) -> f64 {
        let last = &self.pieces[self.pieces.len() - 1];
        last.start + last.width
    }

    /// Number of polynomials.
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// x(t), from the left where it jumps; NaN outside.
    pub fn value(&self, t: f64) -> f64 {
        if !(self.start()..=self.end()).contains(&t) {
            return f64::NAN;
        }
        let piece = &self.pieces[index(&self.pieces, |piece| piece.start, t)];
        polynomial(&piece.x, (t - piece.start) / piece.width)
    }

    /// D^a x for −2 ≤ a ≤ 2, to be asked at any time.
    ///
    /// Costs O(N log T/h) operations and numbers once, with h the shortest piece.
    ///
    /// # Errors
    /// `Order` and `Kernel`.
    pub fn derivative(&self, order: f64, definition: Definition) -> Result<Differintegral, DerivativeError> {
        Differintegral::new(self, Order::new(order)?, definition)
    }
}

/// The piece that `t` lies in; the earlier one at a joint.
fn index<T>(pieces: &[T], start: impl Fn(&T) -> f64, t: f64) -> usize {
    pieces.partition_point(|piece| start(piece) < t).saturating_sub(1)
}

fn polynomial(coefficients: &[f64], theta: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * theta + c)
}

impl Piece {
    pub(super) fn is_chord(&self) -> bool {
        self.x.len() <= 2
    }

    pub(super) fn slope(&self, at_end: bool) -> f64 {
        let terms = self.x.iter().enumerate().skip(1).map(|(p, c)| p as f64 * c);
        (if at_end { terms.sum() } else { self.x.get(1).copied().unwrap_or(0.0) }) / self.width
    }

    /// By how much x⁽ᵐ⁾ may be missed, m = 0, 1, 2: Markov's bound for polynomials, of degree 2 beside a chord.
    fn missed(&self, m: i32) -> f64 {
        let n = (self.x.len() - 1).max(2) as f64;
        let per_width = 2.0 / self.width;
        match m {
            ..=0 => self.miss,
            1 => self.miss * n * n * per_width,
            _ => self.miss * n * n * (n * n - 1.0) / 3.0 * per_width * per_width,
        }
    }
}

/// D^a of a [`Piecewise`] function.
#[derive(Debug, Clone)]
pub struct Differintegral {
    order: Order,
    start: Start,
    jumps: Vec<Jump>,
    /// Factor of t^{1−a} in the error: what is not known of x'(0).
    doubt: f64,
    spans: Vec<Span>,
    factors: Vec<f64>,
    modes: Option<Modes>,
    origin: f64,
    end: f64,
}

/// y = x⁽ᵐ⁾ on one piece, times from the origin.
#[derive(Debug, Clone)]
struct Span {
    start: f64,
    width: f64,
    y: Vec<f64>,
    /// Bound of what y misses.
    missed: f64,
    /// The same as it is felt after the piece.
    missed_later: f64,
}

/// The lags of all modes at the start of every piece.
#[derive(Debug, Clone)]
struct Modes {
    lambda: Vec<f64>,
    weight: Vec<f64>,
    shortest: f64,
    /// Of y, and of the bound of what it misses.
    lags: Vec<[Vec<f64>; 2]>,
}

impl Differintegral {
    fn new(function: &Piecewise, order: Order, definition: Definition) -> Result<Self, DerivativeError> {
        let pieces = &function.pieces;
        let (origin, end) = (function.start(), function.end());
        let first = &pieces[0];
        let bend = 2.0 * first.x.get(2).copied().unwrap_or(0.0) / (first.width * first.width);
        let node = Node { t: 0.0, x: first.x[0], slope: first.slope(false), bend };
        let largest = first.x.iter().map(|c| c.abs()).fold(0.0, f64::max);
        let rounding = negligible_slope(&[0.0, first.width], &[largest]);
        let negligible = if first.is_chord() { rounding } else { first.missed(1).max(rounding) };
        let mut start = Start::new(&order, definition, &node, negligible);
        let mut jumps = Vec::new();
        let mut doubt = 0.0;
        if first.is_chord() {
            // A chord's slope is not that of x at 0, which the first row and Caputo's definition ask for.
            let domain = [function.start(), function.end() - function.start()];
            let slope = FirstSlope::of(|t| function.value(t), domain, [first.width, first.slope(false)]);
            let there = Node { slope: slope.value, ..node };
            start.value = Start::new(&order, definition, &there, negligible.max(slope.doubt)).value;
            if definition == Definition::Caputo && order.whole == 2 && order.is_singular() {
                jumps.extend(Jump::new(&order, 0.0, 0.0, node.slope - slope.value));
                doubt = slope.doubt * reciprocal_gamma(2.0 - order.order);
            }
        }
        for pair in pieces.windows(2) {
            let kink = pair[1].slope(false) - pair[0].slope(true);
            let (value, slope) = match pair[1].joint {
                Joint::Smooth => continue,
                // Chords stand for what polynomials cannot follow.
                Joint::Fitted
                    if !pair.iter().any(Piece::is_chord)
                        && kink.abs() <= 100.0 * (pair[0].missed(1) + pair[1].missed(1)) =>
                {
                    continue;
                }
                Joint::Fitted => (0.0, kink),
                Joint::Broken => (pair[1].x[0] - pair[0].x.iter().sum::<f64>(), kink),
            };
            jumps.extend(Jump::new(&order, pair[1].start - origin, value, slope));
        }

        let (mut running, mut missed) = ([0.0; 2], [0.0; 2]);
        let spans: Vec<Span> = pieces
            .iter()
            .map(|piece| {
                let mut y = Vec::new();
                order.lower(piece.width, &piece.x, &mut running, &mut y);
                // What is missed adds up in integrals.
                missed[0] += piece.width * piece.miss;
                missed[1] += piece.width * missed[0];
                let missed = match order.whole {
                    -1 => missed[0],
                    -2 => missed[1],
                    m => piece.missed(m),
                };
                // A chord has the increments of x, so that later on nothing is missed of its derivatives.
                let missed_later = if piece.is_chord() && order.whole > 0 { 0.0 } else { missed };
                // What the kernel misses is in proportion to y.
                let largest = [0.0, 0.25, 0.5, 0.75, 1.0].map(|theta| polynomial(&y, theta).abs());
                let missed_later = missed_later + KERNEL_TOLERANCE * largest.into_iter().fold(0.0, f64::max);
                Span { start: piece.start - origin, width: piece.width, y, missed, missed_later }
            })
            .collect();
        let most = spans.iter().map(|span| span.y.len()).max().unwrap_or(1);
        let modes = if order.is_integer() { None } else { Some(Modes::new(&order, &spans)?) };
        Ok(Self { order, start, jumps, doubt, spans, factors: order.factors(most), modes, origin, end })
    }

    /// D^a x at time t, from the left where it jumps.
    ///
    /// NaN outside the function's interval, and at its start where D^a x is infinite there. The error is a bound as far as
    /// the polynomials' own is known: for powers t^p, 0 ≤ p ≤ 3, none of 3000 random cases exceeds it. It is infinite for
    /// Caputo's definition above order 1 where x'(0) is, since there is no such derivative then.
    pub fn at(&self, t: f64) -> Estimate {
        if !(self.origin..=self.end).contains(&t) {
            return Estimate { value: f64::NAN, error: f64::NAN };
        }
        let t = t - self.origin;
        if t == 0.0 {
            let error = if self.start.value.is_nan() { f64::NAN } else { self.spans[0].missed };
            return Estimate { value: self.start.value, error };
        }
        let place = index(&self.spans, |span| span.start, t);
        let span = &self.spans[place];
        let tau = (t - span.start).min(span.width);
        let theta = tau / span.width;
        let share = self.start.share(t);
        let Some(modes) = &self.modes else {
            let value = polynomial(&span.y, theta) + share;
            return Estimate { value, error: span.missed + 4.0 * f64::EPSILON * (value.abs() + share.abs()) };
        };

        let mut sum = Sum::default();
        sum.add(share);
        for jump in self.jumps.iter().take_while(|jump| jump.t < t) {
            sum.add(jump.at(t));
        }
        self.piece(&mut sum, &span.y, span.width, theta, 1.0);
        let mut missed = span.missed * tau.powf(self.order.beta()) * self.factors[0];
        if tau < modes.shortest && place > 0 {
            // Too near to the piece before for the exponentials: its share is that of its polynomial up to here less
            // that of the same polynomial from its end on.
            let before = &self.spans[place - 1];
            let beyond = tau / before.width;
            self.piece(&mut sum, &before.y, before.width, 1.0 + beyond, 1.0);
            self.piece(&mut sum, &shifted(&before.y), before.width, beyond, -1.0);
            missed += before.missed_later * (before.width + tau).powf(self.order.beta()) * self.factors[0];
            missed += modes.history(place - 1, before.width + tau, &mut sum);
        } else {
            missed += modes.history(place, tau, &mut sum);
        }
        if self.doubt > 0.0 {
            missed += self.doubt * t.powf(1.0 - self.order.order);
        }
        Estimate { value: sum.value, error: missed + 4.0 * f64::EPSILON * sum.size }
    }

    /// Adds sign · width^beta Σ_p c_p p!/Γ(p+1+beta) θ^{p+beta}.
    fn piece(&self, sum: &mut Sum, y: &[f64], width: f64, theta: f64, sign: f64) {
        let mut power = sign * (theta * width).powf(self.order.beta());
        for (c, factor) in y.iter().zip(&self.factors) {
            sum.add(power * c * factor);
            power *= theta;
        }
    }
}

/// Terms with their size, by which rounding is measured.
#[derive(Debug, Default)]
struct Sum {
    value: f64,
    size: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        self.value += term;
        self.size += term.abs();
    }
}

impl Modes {
    fn new(order: &Order, spans: &[Span]) -> Result<Self, DerivativeError> {
        let shortest = spans.iter().map(|span| span.width).fold(f64::INFINITY, f64::min);
        let last = &spans[spans.len() - 1];
        let mut past = past_of(order, shortest, last.start + last.width, KERNEL_TOLERANCE)?;
        let mut missed = past.clone();
        let lags = spans
            .iter()
            .map(|span| {
                let lags = [past.modes().to_vec(), missed.modes().to_vec()];
                let slack = 1e-12 * span.width;
                past.advance(span.width, &span.y, slack);
                missed.advance(span.width, &[span.missed_later], slack);
                lags
            })
            .collect();
        let Kernel { lambda, weight, .. } = past.kernel().clone();
        Ok(Self { lambda, weight, shortest, lags })
    }

    /// Adds what lies before piece `place` at `lag` after its start, and returns what is missed of it.
    fn history(&self, place: usize, lag: f64, sum: &mut Sum) -> f64 {
        let [lags, missed] = &self.lags[place];
        let (mut past, mut bound) = (0.0, 0.0);
        for ((lambda, weight), (z, missed)) in self.lambda.iter().zip(&self.weight).zip(lags.iter().zip(missed)) {
            let factor = weight * (-lambda * lag).exp();
            past += factor * z;
            bound += factor * missed;
        }
        sum.add(past);
        bound
    }
}

/// Coefficients in powers of θ − 1.
fn shifted(y: &[f64]) -> Vec<f64> {
    let mut shifted = y.to_vec();
    for lowest in 0..y.len() {
        for p in (lowest..y.len() - 1).rev() {
            shifted[p] += shifted[p + 1];
        }
    }
    shifted
}
