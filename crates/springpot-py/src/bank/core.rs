//! The engine's bank with what it was last told.

use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::{Form, KernelError};
use springpot::law::{Course, Derivative, Entry, InputValue, Network, Start};
use std::sync::Arc;

/// Steps begin where the last one ended, to this share of their size and of the time.
const SAME_TIME: f64 = 1e-9;

/// Shorter steps, s, have lags that are no numbers.
const SHORTEST: f64 = 1e-200;

/// How all steps are taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    pub(super) nodes: Nodes,
    pub(super) form: Form,
    pub(super) course: Course,
    pub(super) memory: MemoryRange,
}

/// Why a call was refused.
#[derive(Debug)]
pub(super) enum BankError {
    NotBegun,
    NotEvaluated,
    OtherBank,
    Step(f64, f64),
    /// A step from here, where the last one ended there.
    Elsewhere(f64, f64),
    /// What, of which element, and the value.
    NotFinite(&'static str, usize, f64),
    /// The element whose rule an input breaks, and why.
    Broken(usize, String),
    Kernel(KernelError),
}

/// Strokes and rates (n), inputs (all of them) at one time.
#[derive(Debug, Clone, Default, PartialEq)]
struct Place {
    strokes: Vec<f64>,
    rates: Vec<f64>,
    inputs: Vec<f64>,
}

#[derive(Debug)]
pub(super) struct Core {
    bank: ElementBank,
    /// For the rules of their inputs.
    laws: Vec<Network>,
    entries: Vec<Arc<Entry>>,
    derivatives: Vec<Derivative>,
    /// Where the inputs of each element begin.
    firsts: Vec<usize>,
    settings: Settings,
    /// Where it began; `None` before.
    begun: Option<Place>,
    /// Where the next step starts, and when.
    start: Place,
    t: f64,
    /// Where the step that was evaluated ends.
    evaluated: Option<(f64, Place)>,
    /// Room for the inputs of an element.
    values: Vec<InputValue>,
}

impl Core {
    pub(super) fn new(laws: Vec<(Network, Arc<Entry>, Derivative)>, settings: Settings) -> Self {
        let derivatives = laws.iter().map(|(.., derivative)| *derivative).collect();
        let (laws, entries): (Vec<Network>, Vec<_>) = laws.into_iter().map(|(law, entry, _)| (law, entry)).unzip();
        let mut bank = ElementBank::new(laws.clone(), settings.nodes, settings.form);
        bank.set_course(settings.course);
        let mut firsts = vec![0];
        for entry in &entries {
            firsts.push(firsts[firsts.len() - 1] + entry.inputs.len());
        }
        let (begun, start, evaluated, values) = (None, Place::default(), None, Vec::new());
        Self { bank, laws, entries, derivatives, firsts, settings, begun, start, t: 0.0, evaluated, values }
    }

    pub(super) fn t(&self) -> f64 {
        self.t
    }

    pub(super) fn modes(&self) -> usize {
        self.bank.modes()
    }

    /// Inputs as they were last; `None` before the start.
    pub(super) fn inputs(&self) -> Option<&[f64]> {
        self.begun.as_ref().map(|_| &self.start.inputs[..])
    }

    pub(super) fn begin(&mut self, strokes: Vec<f64>, rates: Vec<f64>, inputs: Vec<f64>) -> Result<(), BankError> {
        finite("stroke", &strokes, 1)?;
        finite("rate", &rates, 1)?;
        self.check_inputs(&inputs, 1)?;
        let values: Vec<InputValue> = inputs.iter().map(|value| InputValue { value: *value, rate: 0.0 }).collect();
        let starts: Vec<Start> = strokes
            .iter()
            .enumerate()
            .map(|(e, stroke)| {
                let inputs = &values[self.firsts[e]..self.firsts[e + 1]];
                // What was held since ever was not stretched at t = 0.
                let jump = if self.derivatives[e] == Derivative::RiemannLiouville { *stroke } else { 0.0 };
                Start { stroke: *stroke, jump, inputs }
            })
            .collect();
        self.bank.begin(&starts, self.settings.memory).map_err(BankError::Kernel)?;
        self.start = Place { strokes, rates, inputs };
        self.begun = Some(self.start.clone());
        (self.t, self.evaluated) = (0.0, None);
        Ok(())
    }

    pub(super) fn restart(&mut self, rates: Option<Vec<f64>>, inputs: Option<Vec<f64>>) -> Result<(), BankError> {
        self.begun.as_ref().ok_or(BankError::NotBegun)?;
        if let Some(rates) = rates {
            finite("rate", &rates, 1)?;
            self.start.rates = rates;
        }
        if let Some(inputs) = inputs {
            self.check_inputs(&inputs, 1)?;
            self.start.inputs = inputs;
        }
        self.evaluated = None;
        Ok(())
    }

    /// `strokes` and `rates` are n × nodes, `inputs` nodes × all of them.
    pub(super) fn evaluate(
        &mut self,
        t: f64,
        h: f64,
        strokes: &[f64],
        rates: Option<&[f64]>,
        inputs: Vec<f64>,
    ) -> Result<(), BankError> {
        self.begun.as_ref().ok_or(BankError::NotBegun)?;
        if !(t.is_finite() && h.is_finite() && h >= SHORTEST) {
            return Err(BankError::Step(t, h));
        }
        if (t - self.t).abs() > SAME_TIME * (h + self.t) {
            return Err(BankError::Elsewhere(t, self.t));
        }
        let s = self.settings.nodes.count();
        finite("stroke", strokes, s)?;
        if let Some(rates) = rates {
            finite("rate", rates, s)?;
        }
        self.check_inputs(&inputs, s)?;
        self.bank.start(t, h);
        let (n, all) = (self.entries.len(), self.firsts[self.entries.len()]);
        let mut end = Place { strokes: vec![0.0; n], rates: vec![0.0; n], inputs: vec![0.0; all] };
        for e in 0..n {
            let (from, own) = (self.start.strokes[e], &strokes[e * s..(e + 1) * s]);
            self.tell(e, 0, from, self.start.rates[e], None);
            for k in 0..s {
                let rate = rates.map_or_else(|| self.slope(k, from, own) / h, |rates| rates[e * s + k]);
                self.tell(e, k + 1, own[k], rate, Some(&inputs[k * all..(k + 1) * all]));
                (end.strokes[e], end.rates[e]) = (own[k], rate);
            }
            // The middle stands for the mean: x' is constant over the step.
            if self.settings.nodes == Nodes::Midpoint {
                end.strokes[e] = 2.0 * own[0] - from;
            }
        }
        if s > 0 {
            end.inputs.copy_from_slice(&inputs[(s - 1) * all..]);
        }
        self.bank.evaluate();
        self.evaluated = Some((t + h, end));
        Ok(())
    }

    /// h x' at node `k` of the polynomial through the strokes.
    fn slope(&self, k: usize, from: f64, strokes: &[f64]) -> f64 {
        let row = &self.settings.nodes.inverse()[k];
        strokes.iter().zip(row).map(|(stroke, factor)| factor * (stroke - from)).sum()
    }

    fn tell(&mut self, e: usize, point: usize, stroke: f64, rate: f64, inputs: Option<&[f64]>) {
        let inputs = inputs.unwrap_or(&self.start.inputs);
        let own = &inputs[self.firsts[e]..self.firsts[e + 1]];
        self.values.clear();
        self.values.extend(own.iter().map(|value| InputValue { value: *value, rate: 0.0 }));
        self.bank.set(e, point, stroke, rate, &self.values);
    }

    /// Forces at the nodes, n × nodes.
    pub(super) fn forces(&self) -> Vec<f64> {
        let s = self.settings.nodes.count();
        (0..self.bank.len()).flat_map(|e| self.bank.response(e).force[..s].to_vec()).collect()
    }

    /// ∂F_i/∂x_j and ∂F_i/∂x'_j, n × nodes × nodes; where rates `follow` from strokes, all of it is in the first.
    pub(super) fn slopes(&self, follow: bool) -> [Vec<f64>; 2] {
        let (s, n, h) = (self.settings.nodes.count(), self.bank.len(), self.bank.size());
        let inverse = self.settings.nodes.inverse();
        let mut slopes = [Vec::with_capacity(n * s * s), Vec::with_capacity(n * s * s)];
        for e in 0..n {
            let response = self.bank.response(e);
            for i in 0..s {
                for j in 0..s {
                    let through: f64 = (0..s).map(|k| response.d_rate[i][k] * inverse[k][j] / h).sum();
                    slopes[0].push(response.d_stroke[i][j] + if follow { through } else { 0.0 });
                    slopes[1].push(if follow { 0.0 } else { response.d_rate[i][j] });
                }
            }
        }
        slopes
    }

    pub(super) fn commit(&mut self) -> Result<(), BankError> {
        let (t, end) = self.evaluated.take().ok_or(BankError::NotEvaluated)?;
        (0..self.bank.len()).for_each(|e| _ = self.bank.account(e));
        self.bank.commit_account();
        (self.t, self.start) = (t, end);
        Ok(())
    }

    /// J; NaN where unknown.
    pub(super) fn stored(&self) -> Vec<f64> {
        let has_begun = self.begun.is_some();
        (0..self.bank.len()).map(|e| self.bank.stored(e).filter(|_| has_begun).unwrap_or(f64::NAN)).collect()
    }

    /// Dissipated, and supplied by inputs, J; NaN before the start.
    pub(super) fn energies(&self) -> (Vec<f64>, Vec<f64>) {
        (0..self.bank.len()).map(|e| self.bank.energies(e)).unzip()
    }

    /// Time, where it began, where it is, energies, and what the laws keep.
    pub(super) fn state(&self) -> Result<Vec<f64>, BankError> {
        let begun = self.begun.as_ref().ok_or(BankError::NotBegun)?;
        let mut numbers = vec![self.t];
        for place in [begun, &self.start] {
            [&place.strokes, &place.rates, &place.inputs].into_iter().for_each(|part| numbers.extend(part));
        }
        let (dissipated, supplied) = self.energies();
        numbers.extend(dissipated.iter().chain(&supplied));
        self.bank.save(&mut numbers);
        Ok(numbers)
    }

    pub(super) fn set_state(&mut self, numbers: &[f64]) -> Result<(), BankError> {
        let (n, all) = (self.entries.len(), self.firsts[self.entries.len()]);
        let mut rest = numbers;
        let mut take = |count: usize| {
            let (first, others) = rest.split_at_checked(count)?;
            rest = others;
            Some(first.to_vec())
        };
        let mut read = || {
            let t = take(1)?[0];
            let mut place = || Some(Place { strokes: take(n)?, rates: take(n)?, inputs: take(all)? });
            let (begun, start) = (place()?, place()?);
            Some((t, begun, start, take(n)?, take(n)?))
        };
        let (t, begun, start, dissipated, supplied) = read().ok_or(BankError::OtherBank)?;
        if self.begun.as_ref() != Some(&begun) {
            self.begin(begun.strokes, begun.rates, begun.inputs)?;
        }
        if !self.bank.load(rest) {
            return Err(BankError::OtherBank);
        }
        for (e, energies) in dissipated.into_iter().zip(supplied).enumerate() {
            self.bank.set_energies(e, energies);
        }
        self.bank.start(t, 0.0);
        (self.t, self.start, self.evaluated) = (t, start, None);
        for e in 0..n {
            let (stroke, rate) = (self.start.strokes[e], self.start.rates[e]);
            (0..=self.settings.nodes.count()).for_each(|point| self.tell(e, point, stroke, rate, None));
        }
        Ok(())
    }

    /// Inputs at `count` times within their ranges.
    fn check_inputs(&self, inputs: &[f64], count: usize) -> Result<(), BankError> {
        let all = self.firsts[self.entries.len()];
        for at in 0..count {
            for (e, entry) in self.entries.iter().enumerate() {
                for (i, input) in entry.inputs.iter().enumerate() {
                    let value = inputs[at * all + self.firsts[e] + i];
                    if !value.is_finite() {
                        return Err(BankError::NotFinite("an input", e, value));
                    }
                    if !input.range.contains(value) {
                        let (low, high) = (input.range.low, input.range.high);
                        let why = format!("input {} = {value} lies outside {low} … {high}", input.name);
                        return Err(BankError::Broken(e, why));
                    }
                }
                let own = &inputs[at * all + self.firsts[e]..at * all + self.firsts[e + 1]];
                let own: Vec<InputValue> = own.iter().map(|value| InputValue { value: *value, rate: 0.0 }).collect();
                let kept = self.laws[e].check_inputs(&own);
                kept.map_err(|broken| BankError::Broken(e, format!("its law demands {}", broken.rule)))?;
            }
        }
        Ok(())
    }
}

fn finite(what: &'static str, values: &[f64], width: usize) -> Result<(), BankError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(k) => Err(BankError::NotFinite(what, k / width, values[k])),
    }
}
