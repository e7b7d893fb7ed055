//! What happened to a law before t = 0.

mod variation;

pub(crate) use variation::{Begun, PastVariation};
pub(super) use variation::{ByHeat, RecalledVariation, recall as recall_variation};
pub(crate) use variation::{jolted, settled};

use super::network::Network;
use super::state::State;
use super::step::{Course, InputValue, Point, Start, Step};
use crate::collocation::Nodes;
use crate::fractional::{Form, KernelError};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Shortest lag of the memories of a stretch, in units of its age: what is faster counts as settled to the rate, which may jump at t = 0.
const SHORTEST: f64 = 1e-13;

/// Shortest and longest lags of the memories of a stroke that is recalled, in units of its period or age.
const LAGS: [f64; 2] = [1e-7, 10.0];

/// The stretch before t = 0 of which fast modes are made, in the same units.
const LAST: f64 = 1e-4;

/// First step of a relaxation and growth of the steps, in units of the time since the stretch.
const FIRST: f64 = 1e-12;
const GROWTH: f64 = 0.02;

/// The age at which a jump at t = 0 is recalled, in units of the horizon: strokes in series have begun to share it by then.
const SOON: f64 = 1e-10;

/// Ages, in units of the first, and weights of the stretches that are one at t = 0 but for the third order of that.
const TOGETHER: [[f64; 2]; 3] = [[1.0, 3.0], [2.0, -3.0], [3.0, 1.0]];

/// Harmonics below this share of the largest turn no stroke round; looks at a period of the highest, and halvings that find a turn.
const UNHEARD: f64 = 1e-13;
const LOOKS: usize = 16;
const HALVINGS: usize = 50;

/// Nodes on a contour: 0.6 digits each.
const CONTOUR: usize = 24;

/// What happened before t = 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Past {
    /// As the derivative of the law says: held at x(0) since ever (Caputo), or unloaded, x = 0, and stretched to x(0) at t = 0
    /// (Riemann–Liouville).
    #[default]
    OfDerivative,
    /// Stretched at once from 0 to x(0) so long before t = 0, s, and held there.
    Held(f64),
    /// The same periodic stroke since ever.
    Periodic(Periodic),
}

/// A periodic stroke.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    period: f64,
    /// Coefficients of e^{2πint/P}, n = 0, 1, …
    spectrum: Arc<[Complex64]>,
}

impl Periodic {
    /// From strokes at equal distances over one period, s, from t = 0 on, the end left out.
    ///
    /// Gives as well the largest harmonic, and the largest of their upper quarter: where that is not small, there are too few strokes or the
    /// stroke has a kink.
    ///
    /// # Panics
    /// Where there are no strokes.
    pub fn new(period: f64, strokes: &[f64]) -> (Self, [f64; 2]) {
        let count = strokes.len();
        let plan = RealFftPlanner::<f64>::new().plan_fft_forward(count);
        let (mut values, mut spectrum) = (strokes.to_vec(), plan.make_output_vec());
        plan.process(&mut values, &mut spectrum).expect("buffers that the plan made");
        spectrum.iter_mut().for_each(|harmonic| *harmonic /= count as f64);
        let size = |harmonics: &[Complex64]| harmonics.iter().map(|harmonic| harmonic.norm()).fold(0.0, f64::max);
        let sizes = [1, spectrum.len() - spectrum.len() / 4].map(|from| size(spectrum.get(from..).unwrap_or_default()));
        (Self { period, spectrum: spectrum.into() }, sizes)
    }

    /// The same in reduced time ([`Past::reduced`]).
    pub(super) fn reduced(&self, factor: f64, longer: f64) -> Self {
        let mut spectrum = self.spectrum.to_vec();
        spectrum.iter_mut().take(1).for_each(|mean| *mean += longer);
        Self { period: self.period / factor, spectrum: spectrum.into() }
    }

    /// The stroke at time t.
    pub fn stroke(&self, t: f64) -> f64 {
        self.recalled().stroke(t)
    }

    /// The period, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    fn recalled(&self) -> Recalled {
        let line = |(n, x): (usize, &Complex64)| [Complex64::new(0.0, n as f64 * TAU / self.period), *x];
        let exponentials = self.spectrum.iter().enumerate().skip(1).map(line).collect();
        Recalled { mean: self.spectrum[0].re, exponentials, last: LAST * self.period }
    }
}

/// A stroke before t = 0 as x = mean + 2 Re Σ X e^{st}, which holds at t ≤ 0 near 0.
#[derive(Debug, Clone)]
pub(super) struct Recalled {
    mean: f64,
    /// s and X.
    exponentials: Vec<[Complex64; 2]>,
    /// The stretch before t = 0 of which fast modes are made, s.
    last: f64,
}

impl Recalled {
    /// Stretches from 0 at once, each with its age, s, and by how much: inverse Laplace transforms along a contour around the negative real
    /// axis, where all that laws relax by has its poles and cuts.
    fn stretches(stretches: impl Iterator<Item = [f64; 2]>) -> Self {
        let (mut exponentials, mut youngest) = (Vec::new(), f64::INFINITY);
        for [age, stroke] in stretches {
            youngest = age.min(youngest);
            exponentials.extend(contour().map(|[z, weight]| {
                let s = z / age;
                [s, weight / (s * age) * stroke]
            }));
        }
        Self { mean: 0.0, exponentials, last: LAST * youngest }
    }

    /// The same with other amplitudes: the stroke of a part.
    pub(super) fn with(&self, mean: f64, exponentials: Vec<[Complex64; 2]>) -> Self {
        Self { mean, exponentials, ..*self }
    }

    /// The same in reduced time ([`Past::reduced`]).
    pub(super) fn reduced(&self, factor: f64, longer: f64) -> Self {
        let exponentials = self.exponentials.iter().map(|[s, x]| [s * factor, *x]).collect();
        Self { mean: self.mean + longer, exponentials, last: self.last / factor }
    }

    /// Each s with its X.
    pub(super) fn exponentials(&self) -> &[[Complex64; 2]] {
        &self.exponentials
    }

    /// 2 Re Σ f(s) X: what a linear map that turns e^{st} into f(s) makes of the stroke, but for its mean.
    pub(super) fn sum(&self, factor: impl Fn(Complex64) -> Complex64) -> f64 {
        2.0 * self.exponentials.iter().map(|[s, x]| factor(*s) * x).sum::<Complex64>().re
    }

    /// The stroke at time t.
    pub(super) fn stroke(&self, t: f64) -> f64 {
        self.mean + self.sum(|s| (s * t).exp())
    }

    /// Where one that is periodic was when it turned round in the last period, in order, and at last where it is at t = 0.
    pub(super) fn turns(&self) -> Vec<f64> {
        self.times_of_turns().into_iter().map(|t| self.stroke(t)).collect()
    }

    /// When it turned, and 0.
    fn times_of_turns(&self) -> Vec<f64> {
        let period = self.last / LAST;
        let largest = self.exponentials.iter().fold(0.0f64, |largest, [_, x]| largest.max(x.norm()));
        let heard = self.exponentials.iter().filter(|[_, x]| x.norm() > UNHEARD * largest);
        let highest = heard.fold(0.0f64, |highest, [s, _]| highest.max(s.im)) * period / TAU;
        let count = LOOKS * highest.ceil().max(1.0) as usize;
        let rate = |t: f64| self.sum(|s| s * (s * t).exp());
        let time = |k: usize| period * (k as f64 / count as f64 - 1.0);
        let mut turns = Vec::new();
        let mut before = rate(time(0));
        for k in 1..=count {
            let here = rate(time(k));
            if (before > 0.0) != (here > 0.0) {
                let (mut low, mut high) = (time(k - 1), time(k));
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if (rate(middle) > 0.0) == (before > 0.0) { low = middle } else { high = middle }
                }
                turns.push(high);
            }
            before = here;
        }
        turns.push(0.0);
        turns
    }

    /// The mean.
    pub(super) fn mean(&self) -> f64 {
        self.mean
    }

    /// The stretch before t = 0 of which fast modes are made, s.
    pub(super) fn last(&self) -> f64 {
        self.last
    }
}

/// The upper half of Talbot's contour as Weideman shaped it: z and the weight, so that f(t) = 2 Re Σ weight/t·F(z/t).
fn contour() -> impl Iterator<Item = [Complex64; 2]> {
    let n = CONTOUR as f64;
    (0..CONTOUR / 2).map(move |k| {
        let theta = (2 * k + 1) as f64 * PI / n;
        let (sine, cosine) = (0.6407 * theta).sin_cos();
        let z = n * Complex64::new(0.5017 * theta * cosine / sine - 0.6122, 0.2645 * theta);
        let slope = Complex64::new(0.5017 * cosine / sine - 0.5017 * 0.6407 * theta / (sine * sine), 0.2645);
        [z, z.exp() * slope / Complex64::I]
    })
}

impl Past {
    /// Whether the state at t = 0 is that of [`Network::begin`].
    pub fn is_of_derivative(&self) -> bool {
        *self == Self::OfDerivative
    }

    /// The same in reduced time, at times longer by a_T = `factor`, of a law whose strokes are longer by `longer`.
    pub(super) fn reduced(&self, factor: f64, longer: f64) -> Self {
        match self {
            Self::OfDerivative => Self::OfDerivative,
            Self::Held(age) => Self::Held(age / factor),
            Self::Periodic(past) => Self::Periodic(past.reduced(factor, longer)),
        }
    }

    /// The state of a law at t = 0, where its stroke is that of `start`. Kernels, but of [`Past::OfDerivative`], are made with this relative
    /// error, for lags up to `horizon`, s, after t = 0, of a law that temperature shifts in its own time ([`crate::law::Heat`]).
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be.
    ///
    /// # Panics
    /// For a periodic stroke of a law that does not recall it ([`Network::recalls`]).
    pub fn state(&self, law: &Network, start: &Start, tolerance: f64, horizon: f64) -> Result<State, KernelError> {
        match self {
            Self::OfDerivative => law.begin(start),
            _ if let Network::Heated(heated) = law => heated.recalled(start, |law, start, factor, longer| {
                self.reduced(factor, longer).state(law, start, tolerance, horizon)
            }),
            Self::Held(age) if law.has_inner_variables() && shares_by_modulus(law, start.inputs) => {
                stretched(law, start, std::iter::once([*age, 1.0]), tolerance, horizon)
            }
            Self::Held(age) => {
                let mut state = law.begin(&Start { jump: start.stroke, ..*start })?;
                state.open(tolerance, SHORTEST * age, age + horizon)?;
                if law.has_inner_variables() && (start.stroke != 0.0 || !is_dead(law, start.inputs)) {
                    relax(law, start, *age, &mut state);
                }
                state.memories_mut().iter_mut().for_each(|memory| memory.age(*age));
                Ok(state)
            }
            Self::Periodic(past) => {
                assert!(law.recalls(), "a periodic past of a law that does not recall it");
                recalled(law, start, &past.recalled(), past.period, [tolerance, horizon])
            }
        }
    }
}

/// The state behind a jump at t = 0, whose own state is `state`, of a law with memories in series: right from a little later on, as if the
/// stroke had been there somewhat before.
///
/// In series of orders that are near each other the parts share the jump like t^(β−α), settled on no scale of time that steps resolve.
///
/// # Errors
/// [`KernelError`] where a memory cannot be.
pub(crate) fn settle(
    law: &Network,
    start: &Start,
    state: State,
    tolerance: f64,
    horizon: f64,
) -> Result<State, KernelError> {
    let ages = |factor: f64| TOGETHER.into_iter().map(move |[age, share]| [age * SOON * horizon / factor, share]);
    let whole = |law: &Network, start: &Start, factor: f64| stretched(law, start, ages(factor), tolerance, horizon);
    let heated = law.as_heated();
    let inputs = heated.map_or_else(|| start.inputs.to_vec(), |heated| heated.inputs_of_law(start.inputs));
    let inner = heated.map_or(law, |heated| heated.law());
    if start.jump == 0.0 || !inner.has_memories_in_series() || !shares_by_modulus(inner, &inputs) {
        return Ok(state);
    }
    let later = match heated {
        Some(heated) => heated.recalled(start, |law, start, factor, _| whole(law, start, factor))?,
        None => whole(law, start, 1.0)?,
    };
    Ok(later.behind(state))
}

/// The state soon after a jump at t = 0 as [`settle`] has it, and how much more impulse than by that the force has until then, N·s: what a motion
/// that follows from forces must be given at once. Nothing where the force is finite from the first, or the law not linear.
///
/// With ages a_i, weights w_i and K the modulus it is x(0) Σ w_i L⁻¹[K/s²](a_i), less the impulse at t = 0 itself of what is like a dashpot there.
///
/// # Errors
/// [`KernelError`] where a memory cannot be.
pub(crate) fn jolt(
    law: &Network,
    start: &Start,
    tolerance: f64,
    horizon: f64,
) -> Result<Option<(State, f64)>, KernelError> {
    let at = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: start.inputs };
    if start.jump == 0.0 || !law.jolts(&at) || !shares_by_modulus(law, start.inputs) {
        return Ok(None);
    }
    let ages = TOGETHER.map(|[age, share]| [age * SOON * horizon, share]);
    let state = stretched(law, start, ages.into_iter(), tolerance, horizon)?;
    let impulse = |[age, share]: [f64; 2]| {
        let terms = contour().map(|[z, weight]| {
            let s = z / age;
            law.modulus(&at, s) / (s * s) * weight / age
        });
        share * 2.0 * terms.sum::<Complex64>().re
    };
    let owed = ages.into_iter().map(impulse).sum::<f64>() - law.dashed(&at);
    Ok(Some((state, start.jump * owed)))
}

/// Whether strokes inside follow from moduli alone: those of a linear law that gives no force where nothing was ever stretched.
fn shares_by_modulus(law: &Network, inputs: &[InputValue]) -> bool {
    law.is_linear() && is_dead(law, inputs)
}

/// Whether no part of a law gives a force where nothing was ever stretched.
fn is_dead(law: &Network, inputs: &[InputValue]) -> bool {
    let origin = Start { stroke: 0.0, jump: 0.0, inputs };
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs };
    law.begin(&origin).is_ok_and(|state| {
        // Held since ever parts in series have come to rest under no force, at strokes of their own.
        let mut leaves = Vec::new();
        law.leaves_now(&at, &state, &mut leaves);
        law.now(&at, &state).force() == 0.0 && leaves.iter().all(|leaf| leaf.stroke == 0.0)
    })
}

/// The state after stretches of x(0) from 0, each with its age, s, and its share.
fn stretched(
    law: &Network,
    start: &Start,
    stretches: impl Iterator<Item = [f64; 2]>,
    tolerance: f64,
    horizon: f64,
) -> Result<State, KernelError> {
    let past = Recalled::stretches(stretches.map(|[age, share]| [age, share * start.stroke]));
    recalled(law, start, &past, past.last / LAST, [tolerance, horizon])
}

/// The state after such a stroke, which changes over times like `scale`, s.
fn recalled(
    law: &Network,
    start: &Start,
    past: &Recalled,
    scale: f64,
    [tolerance, horizon]: [f64; 2],
) -> Result<State, KernelError> {
    let mut state = law.begin(&Start { jump: 0.0, ..*start })?;
    let [shortest, longest] = LAGS.map(|share| share * scale);
    state.open(tolerance, shortest, longest + horizon)?;
    let at = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: start.inputs };
    law.recall(past, &at, &mut state);
    Ok(state)
}

/// Takes a law that was just stretched through the time until t = 0.
fn relax(law: &Network, start: &Start, age: f64, state: &mut State) {
    each_of_relaxation(start, age, &mut |step| {
        law.prepare(step, state);
        law.commit(step, state);
    });
}

/// The steps of that.
fn each_of_relaxation(start: &Start, age: f64, take: &mut dyn FnMut(&Step)) {
    let nodes = Nodes::Radau;
    let strokes = vec![start.stroke; nodes.count() + 1];
    let (rates, inputs) = (vec![0.0; strokes.len()], start.inputs.repeat(strokes.len()));
    let mut t = 0.0;
    while t < age {
        let h = (GROWTH * t).max(FIRST * age).min(age - t);
        let step = Step {
            t,
            h,
            nodes,
            places: None,
            form: Form::Strokes,
            stroke: &strokes,
            rate: &rates,
            inputs: &inputs,
            resolution: 4.0 * f64::EPSILON * start.stroke.abs(),
            course: Course::Sought,
        };
        take(&step);
        t = if t + h < age { t + h } else { age };
    }
}
