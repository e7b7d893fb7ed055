//! A material: measure + law + inputs. The only place where bodies and laws meet.

use super::bank::MemoryRange;
use super::measure::Measure;
use crate::fractional::KernelError;
use crate::fractional::scheme::Scheme;
use crate::law::past::{self, Begun, PastVariation};
use crate::law::variation::LawVariation;
use crate::law::{Derivative, Entry, InputValue, Network, Past, Point, RuleError, Start, State};
use crate::signal::Signal;
use std::sync::Arc;

/// How many times an input T is looked at for how hot it gets.
const LOOKS: usize = 512;

/// Relative error of kernels where nobody says one.
const KERNEL: f64 = 1e-12;

/// A massless one-dimensional material: a measure y of the configuration and a law.
///
/// Stroke x = y − y0, force F; its generalized forces are Q_b = −F·∂y/∂q_b. Between two points
/// ([`Line`](super::Line)) y is the length l, and F > 0 is tension: it pulls the points together. Laws are written for
/// translation: on a rotation N reads N·m and m reads rad.
#[derive(Debug, Clone)]
pub struct Element {
    /// Name.
    pub name: String,
    /// What it sees of the configuration.
    pub measure: Measure,
    /// y0, at which the stroke is 0, m or rad: the rest length of a line.
    pub rest: f64,
    /// The law.
    pub law: Network,
    /// Its entry of the catalog, which copies of the element share.
    pub entry: Arc<Entry>,
    /// Signals of its inputs, in the order of the entry, SI.
    pub inputs: Vec<Signal>,
    /// Which fractional derivative the law takes.
    pub derivative: Derivative,
    /// What happened before t = 0.
    pub past: Past,
    /// A named offline scheme in place of the exact memory.
    pub scheme: Option<Scheme>,
    /// Whether rows tell it by itself; what end stops store and lose is told with what joints lose.
    pub shown: bool,
}

impl Element {
    /// An element with the law of an `entry` under these parameters (SI, in its order), with its exact memory and without inputs.
    ///
    /// # Errors
    /// [`RuleError`] where the law does not take the parameters.
    pub fn new(
        name: impl Into<String>,
        measure: impl Into<Measure>,
        rest: f64,
        entry: &Arc<Entry>,
        parameters: &[f64],
        derivative: Derivative,
    ) -> Result<Self, RuleError> {
        Ok(Self {
            name: name.into(),
            measure: measure.into(),
            rest,
            law: entry.build(parameters, derivative)?,
            entry: Arc::clone(entry),
            inputs: Vec::new(),
            derivative,
            past: Past::OfDerivative,
            scheme: None,
            shown: true,
        })
    }

    /// With another past. One that was held has the Riemann–Liouville derivative, a periodic one Caputo's.
    ///
    /// # Errors
    /// [`RuleError`] where the law does not take a periodic stroke: it is not linear but for jenkins elements side by side, or an input changes what is in a series.
    pub fn with_past(self, past: Past) -> Result<Self, RuleError> {
        if let Past::Periodic(_) = past {
            let refuse = |rule: &str| Err(RuleError { rule: rule.to_owned(), parameter: "past".into() });
            if !self.law.recalls() {
                return refuse("to be linear, or jenkins elements beside what is, where its past is steady");
            }
            // A temperature from outside was always that at t = 0.
            let (law, inputs) =
                self.law.as_heated().map_or((&self.law, self.entry.inputs.len()), |h| (h.law(), h.inputs()));
            if law.has_inner_variables() && inputs > 0 {
                return refuse("to have no inputs where its past is steady and parts stand in series");
            }
        }
        Ok(Self { past, ..self })
    }

    /// Values and rates of the inputs at t.
    pub fn inputs_at(&self, t: f64, values: &mut [InputValue]) {
        for (value, signal) in values.iter_mut().zip(&self.inputs) {
            let jet = signal.at(t);
            *value = InputValue { value: jet.value, rate: jet.first };
        }
    }

    /// What the law starts from at t = 0 at this coordinate y and under these inputs.
    pub fn start<'i>(&self, coordinate: f64, inputs: &'i [InputValue]) -> Start<'i> {
        // What was held since ever was not stretched at t = 0.
        let jump = if self.derivative == Derivative::RiemannLiouville { self.jump(coordinate) } else { 0.0 };
        Start { stroke: self.stroke(coordinate), jump, inputs }
    }

    /// The law's state at t = 0 at this coordinate y and under these inputs, its memories without kernels
    /// ([`Network::begin`]).
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be.
    pub fn begin(&self, coordinate: f64, inputs: &[InputValue]) -> Result<State, KernelError> {
        self.begin_within(coordinate, inputs, KERNEL, 0.0)
    }

    /// As [`Self::begin`]; the kernels of another past than that of the derivative have this relative error, for lags up to `horizon`, s.
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub fn begin_within(
        &self,
        coordinate: f64,
        inputs: &[InputValue],
        tolerance: f64,
        horizon: f64,
    ) -> Result<State, KernelError> {
        // Other pasts alone ask for the longest lag here.
        let horizon = match self.past.is_of_derivative() {
            true => horizon,
            false => self.memory_range(MemoryRange { tolerance, shortest: 0.0, horizon }, inputs).horizon,
        };
        self.past.state(&self.law, &self.start(coordinate, inputs), tolerance, horizon)
    }

    /// The state that a run begins with where at t = 0 that of the law is `state`: behind a jump that parts in series share ([`past::settle`]).
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub(crate) fn settled(&self, start: &Start, state: State, range: MemoryRange) -> Result<State, KernelError> {
        let MemoryRange { tolerance, horizon, .. } = self.memory_range(range, start.inputs);
        past::settle(&self.law, start, state, tolerance, horizon)
    }

    /// What parameters change of the state `state` that a run begins with ([`Self::begin_within`], or [`Self::settled`] where `settles`), of the law as
    /// it is `of`; `by` is what changes of its past.
    ///
    /// # Errors
    /// What no derivative is known of.
    pub(crate) fn variation(
        &self,
        of: Begun,
        by: &PastVariation,
        state: &State,
        range: MemoryRange,
        settles: bool,
    ) -> Result<LawVariation, String> {
        let MemoryRange { tolerance, horizon, .. } = self.memory_range(range, of.start.inputs);
        let is_of_derivative = self.past.is_of_derivative();
        let settled = match settles && is_of_derivative && self.derivative == Derivative::RiemannLiouville {
            true => past::settled(of, state, horizon)?,
            false => None,
        };
        match settled {
            Some(settled) => {
                let start = self.past.variation(of, by, state.seen_at(0.0), [tolerance, horizon]);
                // What has no derivative at t = 0 itself is infinite there.
                let start = start.unwrap_or_else(|_| settled.clone().lost());
                Ok(settled.behind(start))
            }
            None => self.past.variation(of, by, state, [tolerance, horizon]),
        }
    }

    /// What parameters change of the impulse of [`Self::jolt`]; nothing where there is none, be x(0) what it may.
    pub(crate) fn jolt_variation(&self, of: Begun, horizon: f64) -> Option<(f64, Vec<f64>)> {
        let jumps = self.past.is_of_derivative() && self.derivative == Derivative::RiemannLiouville;
        past::jolted(of, horizon).filter(|_| jumps)
    }

    /// Whether it is known what parameters change of its leaves: not by another clock, behind a jump at t = 0, nor where parts in series are not linear or
    /// share what they begin with by coefficients of one order.
    pub(crate) fn tells_changes_of_leaves(&self) -> bool {
        let inputs = vec![InputValue::default(); self.entry.inputs.len()];
        let (at, mut orders) = (Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs }, Vec::new());
        self.law.for_each_springpot(&at, &mut |term| orders.push(term.order));
        orders.sort_by(f64::total_cmp);
        let jumps = self.past.is_of_derivative() && self.derivative == Derivative::RiemannLiouville;
        let is_shared = !self.law.is_linear() || orders.windows(2).any(|pair| pair[0] == pair[1]);
        self.law.as_heated().is_none() && !(jumps && self.law.has_memories()) && !(self.law.has_series() && is_shared)
    }

    /// What a jump at t = 0 does that [`Self::settled`] does not tell ([`past::jolt`]).
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub(crate) fn jolt(
        &self,
        start: &Start,
        tolerance: f64,
        horizon: f64,
    ) -> Result<Option<(State, f64)>, KernelError> {
        past::jolt(&self.law, start, tolerance, horizon)
    }

    /// The range of its memories in their own time, under the inputs at t = 0 and what its signals say of the rest of the run.
    pub fn memory_range(&self, range: MemoryRange, inputs: &[InputValue]) -> MemoryRange {
        let Some(heated) = self.law.as_heated() else { return range };
        let signal = heated.input().and_then(|input| self.inputs.get(input));
        let at = |signal: &Signal, k: usize| signal.at(range.horizon * k as f64 / LOOKS as f64).value;
        let hottest = signal.map(|signal| (0..=LOOKS).map(|k| at(signal, k)).fold(f64::NEG_INFINITY, f64::max));
        range.reduced(&self.law, inputs, hottest)
    }

    /// x = y − y0, m or rad.
    #[inline]
    pub fn stroke(&self, coordinate: f64) -> f64 {
        coordinate - self.rest
    }

    /// x(0) as a Riemann–Liouville start counts it: 0 where it is no more than the rounding of the coordinates, or has another past.
    pub fn jump(&self, coordinate: f64) -> f64 {
        let stroke = self.stroke(coordinate);
        if !self.past.is_of_derivative() || stroke.abs() <= self.resolution(coordinate) { 0.0 } else { stroke }
    }

    /// Rounding of a stroke, m or rad.
    pub fn resolution(&self, coordinate: f64) -> f64 {
        8.0 * f64::EPSILON * coordinate.abs().max(self.rest.abs()).max(self.measure.offset())
    }
}
