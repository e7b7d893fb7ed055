//! What parameters change of what happened before t = 0.

use super::{
    Past, Periodic, Recalled, SHORTEST, SOON, TOGETHER, contour, each_of_relaxation, is_dead, shares_by_modulus,
};
use crate::collocation::Nodes;
use crate::fractional::{KernelError, Memory, MemoryTangent, RatePolynomial, RecalledTangent};
use crate::law::network::Network;
use crate::law::state::State;
use crate::law::step::{Point, Start};
use crate::law::variation::{LawVariation, PointVariation, StepVariation};
use num_complex::Complex64;

/// What parameters change of a past, a number for each.
#[derive(Debug, Clone)]
pub(crate) struct PastVariation {
    /// Of ln of the time since a stretch.
    pub(crate) age: Vec<f64>,
    /// Of the periodic stroke; nothing where it stays.
    pub(crate) strokes: Vec<Option<Periodic>>,
}

/// What parameters change of a stroke made of exponentials.
#[derive(Debug, Clone)]
pub(in crate::law) struct RecalledVariation {
    /// Of the mean.
    pub(in crate::law) mean: Vec<f64>,
    /// Of each s and of its X, parameter by parameter.
    pub(in crate::law) exponentials: Vec<Vec<[Complex64; 2]>>,
}

/// Kernels of memories that are made with a past: their relative error, and the longest lag after t = 0, s.
pub(in crate::law) type Kernels = [f64; 2];

/// A law at t = 0: how each parameter has it, where it starts, and what changes of that.
#[derive(Clone, Copy)]
pub(crate) struct Begun<'a> {
    pub(crate) law: &'a Network,
    /// Built of numbers that change with each parameter, where it has any.
    pub(crate) by: &'a [Option<Network>],
    pub(crate) start: Start<'a>,
    pub(crate) told: PointVariation<'a>,
}

impl Begun<'_> {
    pub(in crate::law) fn at(&self) -> Point<'_> {
        Point { t: 0.0, stroke: self.start.stroke, rate: 0.0, inputs: self.start.inputs }
    }

    pub(in crate::law) fn count(&self) -> usize {
        self.by.len()
    }

    /// The law as each parameter has it; as it is where it stays.
    fn each(&self) -> Vec<&Network> {
        self.by.iter().map(|law| law.as_ref().unwrap_or(self.law)).collect()
    }

    fn begin(&self, state: &State) -> Result<LawVariation, String> {
        LawVariation::begin(self.law, self.by, &self.at(), &self.told, state)
    }
}

impl RecalledVariation {
    /// Of stretches from 0 at once ([`Recalled::stretches`]) whose strokes change by `stroke`, a block, times their share, and ln of their ages by
    /// `older`, each s then by −s.
    fn of_stretches(stretches: impl Iterator<Item = [f64; 2]>, stroke: &[f64], older: &[f64]) -> Self {
        let mut exponentials = Vec::new();
        for [age, share] in stretches {
            for [z, weight] in contour() {
                let (s, x) = (z / age, weight / z * share);
                exponentials.push(stroke.iter().zip(older).map(|(stroke, older)| [-s * older, x * stroke]).collect());
            }
        }
        Self { mean: vec![0.0; stroke.len()], exponentials }
    }

    /// Adds 2 Re Σ (f δX + f' δs X), where `factor` says f and f' at s.
    pub(in crate::law) fn add(&self, of: &Recalled, factor: impl Fn(Complex64) -> [Complex64; 2], sum: &mut [f64]) {
        for ([s, x], changes) in of.exponentials().iter().zip(&self.exponentials) {
            let [value, slope] = factor(*s);
            for (sum, [by_s, by_x]) in sum.iter_mut().zip(changes) {
                *sum += 2.0 * (value * by_x + slope * by_s * x).re;
            }
        }
    }

    /// What changes of the stroke at time t, a block.
    pub(in crate::law) fn stroke(&self, of: &Recalled, t: f64) -> Vec<f64> {
        let mut sum = self.mean.clone();
        self.add(of, |s| [(s * t).exp(), t * (s * t).exp()], &mut sum);
        sum
    }

    /// What changes of the stroke where it turned round, a block for each turn ([`Recalled::turns`]): its rate is 0 there.
    pub(in crate::law) fn turns(&self, of: &Recalled) -> Vec<f64> {
        of.times_of_turns().into_iter().flat_map(|t| self.stroke(of, t)).collect()
    }
}

impl Periodic {
    /// How many strokes it was made of.
    pub(crate) fn count(&self) -> usize {
        2 * (self.spectrum.len() - 1).max(1)
    }

    /// What changes of it as it is recalled, where ln of its rates changes by `faster`, and its strokes by `longer` as well.
    fn variation(&self, strokes: &[Option<Self>], faster: &[f64], longer: &[f64]) -> RecalledVariation {
        let of = |p: usize, n: usize| {
            strokes[p].as_ref().and_then(|own| own.spectrum.get(n)).copied().unwrap_or(Complex64::ZERO)
        };
        let count = strokes.len();
        let line = |[s, _]: &[Complex64; 2], n: usize| (0..count).map(|p| [s * faster[p], of(p, n)]).collect();
        let recalled = self.recalled();
        RecalledVariation {
            mean: (0..count).map(|p| of(p, 0).re + longer[p]).collect(),
            exponentials: recalled.exponentials().iter().zip(1..).map(|(own, n)| line(own, n)).collect(),
        }
    }
}

/// Puts what changes of a stroke before t = 0 into what changes of a memory that recalled it.
pub(in crate::law) fn recall(
    memory: &Memory,
    tangent: &mut MemoryTangent,
    stroke: &Recalled,
    changes: &RecalledVariation,
) {
    let (alpha, width, count) = (memory.alpha(), stroke.last(), changes.mean.len());
    let nodes = Nodes::Radau;
    let mut rates = Vec::new();
    for theta in [0.0].iter().chain(nodes.positions()) {
        let t = (theta - 1.0) * width;
        let mut own = vec![0.0; count];
        changes.add(stroke, |s| [s * (s * t).exp(), (1.0 + s * t) * (s * t).exp()], &mut own);
        rates.push(own);
    }
    let mut last = vec![0.0; 4 * count];
    for p in 0..count {
        let own: Vec<f64> = rates.iter().map(|rates| rates[p]).collect();
        let polynomial = RatePolynomial::through_rates(width, nodes, &own);
        polynomial.coefficients().iter().enumerate().for_each(|(k, u)| last[k * count + p] = *u);
    }
    let mut derivative = vec![0.0; count];
    let power = |s: Complex64| match alpha {
        0.0 => [Complex64::ONE, Complex64::ZERO],
        alpha => [s.powf(alpha), alpha * s.powf(alpha - 1.0)],
    };
    changes.add(stroke, power, &mut derivative);
    let by_order = if alpha == 0.0 { 0.0 } else { stroke.sum(|s| s.powf(alpha) * s.ln()) };
    derivative.iter_mut().zip(tangent.of_order()).for_each(|(own, order)| *own += by_order * order);
    let delta_mode = |lambda: f64, row: &mut [f64]| {
        row.fill(0.0);
        changes.add(stroke, |s| [s / (lambda + s), lambda / ((lambda + s) * (lambda + s))], row);
    };
    tangent.begin(memory, &changes.stroke(stroke, 0.0));
    tangent.recall(
        memory,
        &RecalledTangent {
            mode: &|lambda| stroke.sum(|s| s / (lambda + s)),
            delta_mode: &delta_mode,
            delta_last: &last,
            delta_derivative: &derivative,
            delta_mean: &changes.mean,
        },
    );
}

/// Of heat: what changes of ln a_T and of what it adds to strokes, a number for each parameter.
pub(in crate::law) struct ByHeat {
    pub(in crate::law) ln_factor: Vec<f64>,
    pub(in crate::law) longer: Vec<f64>,
}

impl ByHeat {
    fn none(count: usize) -> Self {
        Self { ln_factor: vec![0.0; count], longer: vec![0.0; count] }
    }
}

impl Past {
    /// What changes of `state`, which is that of [`Past::state`] with these kernels; `by` is what changes of the past itself.
    ///
    /// # Errors
    /// What no derivative is known of.
    pub(crate) fn variation(
        &self,
        of: Begun,
        by: &PastVariation,
        state: &State,
        kernels: Kernels,
    ) -> Result<LawVariation, String> {
        match of.law.as_heated() {
            None => self.variation_under(of, by, &ByHeat::none(of.count()), state, kernels),
            Some(heated) => heated.variation_of_past(of, state, |inner, state, factor, longer, heat| {
                self.reduced(factor, longer).variation_under(inner, by, heat, state, kernels)
            }),
        }
    }

    /// The same of a law without heat, in the time of `heat`.
    fn variation_under(
        &self,
        of: Begun,
        by: &PastVariation,
        heat: &ByHeat,
        state: &State,
        kernels: Kernels,
    ) -> Result<LawVariation, String> {
        match self {
            Self::OfDerivative => of.begin(state),
            Self::Held(age) => {
                // The age in the time of the law is that of the wall over a_T.
                let older: Vec<f64> = by.age.iter().zip(&heat.ln_factor).map(|(by, ln)| by - ln).collect();
                if of.law.has_inner_variables() && shares_by_modulus(of.law, of.start.inputs) {
                    return behind_stretches(of, &[[*age, 1.0]], &older, state);
                }
                held(of, *age, &older, kernels)
            }
            Self::Periodic(past) => {
                let changes = past.variation(&by.strokes, &heat.ln_factor, &heat.longer);
                behind(of, (&past.recalled(), &changes), state)
            }
        }
    }
}

/// Behind a stretch so long ago, s, whose ln changes by `older`.
fn held(of: Begun, age: f64, older: &[f64], [tolerance, horizon]: Kernels) -> Result<LawVariation, String> {
    let (law, start) = (of.law, &of.start);
    let kernel = |error: KernelError| error.to_string();
    let mut state = law.begin(&Start { jump: start.stroke, ..*start }).map_err(kernel)?;
    state.open(tolerance, SHORTEST * age, age + horizon).map_err(kernel)?;
    let mut own = of.begin(&state)?;
    if law.has_inner_variables() && (start.stroke != 0.0 || !is_dead(law, start.inputs)) {
        if older.iter().any(|older| *older != 0.0) {
            return Err("how long a law was held that is not linear".to_owned());
        }
        let points = Nodes::Radau.count() + 1;
        let [stroke, rate] = [of.told.stroke.repeat(points), vec![0.0; points * of.count()]];
        let [values, rates] = of.told.inputs.map(|blocks| blocks.repeat(points));
        let (count, inputs) = (of.count(), [&values[..], &rates[..]]);
        let told = StepVariation { count, stroke: &stroke, rate: &rate, inputs, passed: None };
        each_of_relaxation(start, age, &mut |step| {
            law.prepare(step, &mut state);
            law.commit_variation(step, &state, &told, &mut own);
            law.commit(step, &mut state);
        });
    }
    let of_age: Vec<f64> = older.iter().map(|older| older * age).collect();
    for (memory, tangent) in state.memories_mut().iter_mut().zip(own.memories_mut()) {
        tangent.age(memory, age, &of_age);
        memory.age(age);
    }
    Ok(own)
}

/// What changes of `state` behind a jump at t = 0 ([`super::settle`]); nothing where parts in series do not share it so.
///
/// # Errors
/// What no derivative is known of.
pub(crate) fn settled(of: Begun, state: &State, horizon: f64) -> Result<Option<LawVariation>, String> {
    let heated = of.law.as_heated();
    let inputs = heated.map_or_else(|| of.start.inputs.to_vec(), |heated| heated.inputs_of_law(of.start.inputs));
    let inner = heated.map_or(of.law, |heated| heated.law());
    let jumps = of.start.jump != 0.0 || of.told.stroke.iter().any(|change| *change != 0.0);
    if !jumps || !inner.has_memories_in_series() || !shares_by_modulus(inner, &inputs) {
        return Ok(None);
    }
    let whole = |of: Begun, state: &State, factor: f64, heat: &ByHeat| {
        let stretches = TOGETHER.map(|[age, share]| [age * SOON * horizon / factor, share]);
        let older: Vec<f64> = heat.ln_factor.iter().map(|ln| -ln).collect();
        behind_stretches(of, &stretches, &older, state)
    };
    match heated {
        Some(heated) => {
            heated.variation_of_past(of, state, |inner, state, factor, _, heat| whole(inner, state, factor, heat))
        }
        None => whole(of, state, 1.0, &ByHeat::none(of.count())),
    }
    .map(Some)
}

/// The impulse that a jump at t = 0 gives at once ([`super::jolt`]), N·s, and what changes of it by each parameter; nothing where it gives none.
pub(crate) fn jolted(of: Begun, horizon: f64) -> Option<(f64, Vec<f64>)> {
    let at = of.at();
    if !of.law.jolts(&at) || !shares_by_modulus(of.law, of.start.inputs) {
        return None;
    }
    let count = of.count();
    let (mut impulse, mut changes) = (0.0, Vec::with_capacity(count));
    for (p, law) in of.each().into_iter().enumerate() {
        let inputs = of.told.inputs_of(&at, p, count);
        let moving = at.with_inputs(&inputs);
        let mut owed = [0.0; 2];
        for [age, share] in TOGETHER.map(|[age, share]| [age * SOON * horizon, share]) {
            for [z, weight] in contour() {
                let s = z / age;
                let both = law.modulus_by(&moving, [s, Complex64::ZERO])?;
                let own = both.map(|own| 2.0 * share * (own / (s * s) * weight / age).re);
                owed.iter_mut().zip(own).for_each(|(owed, own)| *owed += own);
            }
        }
        let [value, slope] = owed;
        let [dashed, by_dashed] = law.dashed_by(&moving)?;
        impulse = of.start.jump * (value - dashed);
        changes.push(of.told.stroke[p] * (value - dashed) + of.start.jump * (slope - by_dashed));
    }
    Some((impulse, changes))
}

/// Behind stretches of x(0) from 0, each with its age, s, and its share; ln of the ages changes by `older`.
fn behind_stretches(of: Begun, stretches: &[[f64; 2]], older: &[f64], state: &State) -> Result<LawVariation, String> {
    let shares = || stretches.iter().copied();
    let past = Recalled::stretches(shares().map(|[age, share]| [age, share * of.start.stroke]));
    let changes = RecalledVariation::of_stretches(shares(), of.told.stroke, older);
    behind(of, (&past, &changes), state)
}

/// Behind a stroke that was recalled.
fn behind(of: Begun, stroke: (&Recalled, &RecalledVariation), state: &State) -> Result<LawVariation, String> {
    let mut own = of.begin(state)?;
    of.law.recall_variation(stroke, (&of.at(), &of.told), &of.each(), state, &mut own)?;
    Ok(own)
}
