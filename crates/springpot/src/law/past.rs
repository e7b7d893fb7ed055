//! What happened to a law before t = 0.

use super::network::Network;
use super::state::State;
use super::step::{Course, Point, Start, Step};
use crate::collocation::Nodes;
use crate::fractional::{Form, KernelError};
use num_complex::Complex64;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Shortest lag of the memories of a stretch, in units of its age: what is faster counts as settled to the rate, which may jump at t = 0.
const SHORTEST: f64 = 1e-13;

/// Shortest and longest lags of the memories of a periodic stroke, in units of its period.
const PERIODIC: [f64; 2] = [1e-7, 10.0];

/// The stretch before t = 0 of which fast modes are made, in units of the period.
const LAST: f64 = 1e-4;

/// First step of a relaxation and growth of the steps, in units of the time since the stretch.
const FIRST: f64 = 1e-12;
const GROWTH: f64 = 0.02;

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

    /// The same with other harmonics: the stroke of a part.
    pub(super) fn with(&self, spectrum: Vec<Complex64>) -> Self {
        Self { spectrum: spectrum.into(), ..*self }
    }

    /// The same in reduced time ([`Past::reduced`]).
    pub(super) fn reduced(&self, factor: f64, longer: f64) -> Self {
        let mut spectrum = self.spectrum.to_vec();
        spectrum.iter_mut().take(1).for_each(|mean| *mean += longer);
        Self { period: self.period / factor, spectrum: spectrum.into() }
    }

    /// The stroke at time t.
    pub fn stroke(&self, t: f64) -> f64 {
        self.mean() + self.sum(|s| Complex64::cis(s.im * t))
    }

    /// The period, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Coefficients of e^{2πint/P}, n = 0, 1, …, each with its 2πin/P.
    pub(super) fn harmonics(&self) -> impl Iterator<Item = (Complex64, Complex64)> + '_ {
        let omega = TAU / self.period;
        self.spectrum.iter().enumerate().map(move |(n, x)| (Complex64::new(0.0, n as f64 * omega), *x))
    }

    /// Σ f(2πin/P) X_n over the harmonics above the mean, as a real number.
    pub(super) fn sum(&self, factor: impl Fn(Complex64) -> Complex64) -> f64 {
        2.0 * self.harmonics().skip(1).map(|(s, x)| factor(s) * x).sum::<Complex64>().re
    }

    /// The mean.
    pub(super) fn mean(&self) -> f64 {
        self.spectrum[0].re
    }

    /// The stretch before t = 0 of which fast modes are made, s.
    pub(super) fn last(&self) -> f64 {
        LAST * self.period
    }
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
    /// For a periodic stroke of a law that is not linear.
    pub fn state(&self, law: &Network, start: &Start, tolerance: f64, horizon: f64) -> Result<State, KernelError> {
        match self {
            Self::OfDerivative => law.begin(start),
            _ if let Network::Heated(heated) = law => heated.recalled(self, start, tolerance, horizon),
            Self::Held(age) => {
                let mut state = law.begin(&Start { jump: start.stroke, ..*start })?;
                state.open(tolerance, SHORTEST * age, age + horizon)?;
                if law.has_inner_variables() && start.stroke != 0.0 {
                    relax(law, start, *age, &mut state);
                }
                state.memories_mut().iter_mut().for_each(|memory| memory.age(*age));
                Ok(state)
            }
            Self::Periodic(past) => {
                assert!(law.is_linear(), "a periodic past of a law that is not linear");
                let mut state = law.begin(&Start { jump: 0.0, ..*start })?;
                let [shortest, longest] = PERIODIC.map(|share| share * past.period);
                state.open(tolerance, shortest, longest + horizon)?;
                let at = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: start.inputs };
                law.recall(past, &at, &mut state);
                Ok(state)
            }
        }
    }
}

/// Takes a law that was just stretched through the time until t = 0.
fn relax(law: &Network, start: &Start, age: f64, state: &mut State) {
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
        law.prepare(&step, state);
        law.commit(&step, state);
        t = if t + h < age { t + h } else { age };
    }
}
