//! The memory of one fractional derivative in a time loop: what is kept of the past, and how a step adds to it.
//!
//! Within the current step the kernel is exact (see [`super::step`]); only the past goes through the exponentials of
//! [`Kernel`](super::Kernel), one lag z_k = ∫₀ᵗ e^{−λ_k(t−s)} x'(s) ds for each. Asking is pure; [`Memory::commit`] is the only
//! mutation.
//!
//! A step from t_n to t_n + h has nodes c_1 … c_s. [`Memory::respond`] gives D^alpha x there as an affine map of what
//! the step does not know yet, D_i = Σ_j stroke_ij (x_j − x_0) + Σ_j rate_ij x'_j + history_i, so that an implicit
//! method solves for it at the cost of an ordinary dashpot; the number of modes does not appear in its unknowns. Along
//! a known motion the same map is evaluated:
//!
//! ```
//! use springpot::collocation::{Nodes, RADAU_NODES};
//! use springpot::fractional::{Form, Kind, Memory, RatePolynomial, StepStart};
//!
//! // D^½ of x = t², from its rates at the three Radau nodes of every step; the steps may have any size.
//! let mut memory = Memory::new(0.5, Kind::Caputo, 0.0, 0.0, 1e-11, 1e-3, 2.0)?;
//! let mut t = 0.0;
//! for h in [0.1, 0.3, 0.05, 0.55] {
//!     let start = StepStart { t, h, stroke: t * t, rate: 2.0 * t };
//!     let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| 2.0 * (t + c * h)).collect();
//!     let map = memory.respond(&start, Nodes::Radau, Form::Rates);
//!     let end: f64 = (0..3).map(|j| map.rate[2][j] * rates[j + 1]).sum::<f64>() + map.history[2];
//!     t += h;
//!     // D^½ t² = 8/(3√π) t^{3/2}
//!     assert!((end - 8.0 / (3.0 * std::f64::consts::PI.sqrt()) * t.powf(1.5)).abs() < 1e-9);
//!     memory.commit(&RatePolynomial::through_rates(h, Nodes::Radau, &rates));
//! }
//! # Ok::<(), springpot::fractional::KernelError>(())
//! ```
//!
//! There is no smallest step: where a lag shorter than the kernel's delta is asked for, faster modes are made for it
//! from the last committed step alone. That is exact, since they have forgotten everything before it (λ·h > 100).
//!
//! For samples, streams and functions that are known, [`derivative`](super::derivative), [`Stream`](super::Stream) and
//! [`Piecewise`](super::Piecewise) ask for less.

use super::gamma::reciprocal_gamma;
use super::history::{History, Squares};
use super::kernel::KernelError;
use super::kind::Kind;
use super::local::{Both, Local};
use super::shelf::Shelf;
use super::step::{Form, RatePolynomial, SEXTIC};
use crate::collocation::{MAX_NODES, NODE_POLYNOMIAL, Nodes, Places};
use serde::{Deserialize, Serialize};

/// What rounding of the strokes, each by as much, may add to the highest coefficient of a polynomial of strokes and rates, in units of the mean rate
/// that it makes of a step: the sum of the last row of the inverse of [`crate::collocation::Gaps`], the stroke at the start counted with each.
const NOISE_OF_BOTH: f64 = 2.0 * 12_600.0;

/// What it may add to D^alpha x at a node, in units of h^−alpha: at no order more than 4 times as much as each of two strokes.
const NOISE_AT_NODES: f64 = 8.0;

/// Square of what the polynomial with its zeros at the nodes of a step has next to them; between them it is 0.003 to 0.018.
pub(super) const NEXT_TO_NODE: f64 = 1e-6;

/// The start of a step as a memory sees it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StepStart {
    /// Time t_n, s.
    pub t: f64,
    /// Step size h, s.
    pub h: f64,
    /// x(t_n).
    pub stroke: f64,
    /// x'(t_n).
    pub rate: f64,
}

/// D^alpha x at the nodes of a step as an affine map of the step's own data:
/// D_i = Σ_j stroke_ij (x_j − x_0) + Σ_j rate_ij x'_j + history_i.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Affine {
    /// Factors of the strokes, s^−alpha.
    pub stroke: [[f64; MAX_NODES]; MAX_NODES],
    /// Factors of the rates, s^{1−alpha}.
    pub rate: [[f64; MAX_NODES]; MAX_NODES],
    /// All that is known at the start of the step.
    pub history: [f64; MAX_NODES],
}

/// Energy of a springpot of unit coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// ½(Σ w_k z_k² + d2·x'²), stored.
    pub stored: f64,
    /// Σ w_k λ_k z_k² + d1·x'² − 2·d2·x'·x'' + d3·x''², the rate of dissipation.
    pub dissipation: f64,
}

/// The memory of D^alpha x for 0 ≤ alpha ≤ 1 from t = 0.
///
/// The limits keep no past: alpha = 0 is x (Riemann–Liouville) or x − x(0) (Caputo); alpha = 1 is x' for both.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Memory {
    alpha: f64,
    kind: Kind,
    /// x(0).
    origin: f64,
    /// x(0) of a singular start, else 0.
    jump: f64,
    /// 1/Γ(1−alpha).
    singular_factor: f64,
    local: Local,
    /// ∫ of all rates committed: what the modes have seen of the stroke.
    travelled: f64,
    /// D^alpha x after the last committed step without the singular part; at the limits it follows from x and x'.
    now: f64,
    /// None at the limits, and before [`Self::open`].
    past: Option<History>,
    /// In the place of it.
    told: Option<f64>,
    /// Whether its energies are known.
    is_accounted: bool,
    #[serde(skip)]
    prepared: Option<Prepared>,
}

/// What [`Memory::respond`] says of one step.
#[derive(Debug, Clone, Copy)]
struct Prepared {
    start: StepStart,
    nodes: Nodes,
    places: Option<Places>,
    form: Form,
    affine: Affine,
}

/// What integrals of rates owe the strokes, m, and the rate at which a step pays, m/s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Debt {
    pub(super) owed: f64,
    pub(super) rate: f64,
}

impl Prepared {
    fn is_for(&self, start: &StepStart, nodes: Nodes, places: Option<&Places>, form: Form) -> bool {
        self.start == *start && self.nodes == nodes && self.form == form && self.places.as_ref() == places
    }
}

impl Memory {
    /// An empty memory at t = 0.
    ///
    /// `origin` is x(0), `jump` the same where a Riemann–Liouville start counts as singular and 0 elsewhere; `tolerance` bounds
    /// the relative error of the kernel between the lag `delta` (c_1 times the first step) and `horizon` (the end of the run).
    ///
    /// # Errors
    /// [`KernelError`] where no kernel can be built.
    pub fn new(
        alpha: f64,
        kind: Kind,
        origin: f64,
        jump: f64,
        tolerance: f64,
        delta: f64,
        horizon: f64,
    ) -> Result<Self, KernelError> {
        let mut memory = Self::closed(alpha, kind, origin, jump)?;
        memory.open(tolerance, delta, horizon)?;
        Ok(memory)
    }

    /// A memory at t = 0 that has no kernel yet: all that it knows is what holds there ([`Self::now`], [`Self::is_singular`]).
    ///
    /// # Errors
    /// [`KernelError::Order`] for an order outside [0, 1].
    pub fn closed(alpha: f64, kind: Kind, origin: f64, jump: f64) -> Result<Self, KernelError> {
        if !(0.0..=1.0).contains(&alpha) {
            return Err(KernelError::Order(alpha));
        }
        let singular = alpha > 0.0 && alpha < 1.0 && kind == Kind::RiemannLiouville;
        Ok(Self {
            alpha,
            kind,
            origin,
            jump: if singular { jump } else { 0.0 },
            singular_factor: reciprocal_gamma(1.0 - alpha),
            local: Local::from(alpha),
            travelled: 0.0,
            now: 0.0,
            told: None,
            is_accounted: !(singular && jump != 0.0),
            past: None,
            prepared: None,
        })
    }

    /// Builds the kernel where there is none, whose arguments are those of [`Self::new`].
    ///
    /// # Errors
    /// [`KernelError`] where no kernel can be built.
    pub fn open(&mut self, tolerance: f64, delta: f64, horizon: f64) -> Result<(), KernelError> {
        self.open_on(&Shelf::default(), tolerance, delta, horizon)
    }

    /// As [`Self::open`], on the shelf of other memories.
    pub(crate) fn open_on(
        &mut self,
        shelf: &Shelf,
        tolerance: f64,
        delta: f64,
        horizon: f64,
    ) -> Result<(), KernelError> {
        if self.is_fractional() && self.past.is_none() {
            self.past = Some(History::open(shelf, self.alpha, tolerance, delta.min(0.5 * horizon), horizon)?);
        }
        Ok(())
    }

    pub(crate) fn is_fractional(&self) -> bool {
        self.alpha > 0.0 && self.alpha < 1.0
    }

    /// Which derivative.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The order.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Number of exponentials.
    pub fn modes(&self) -> usize {
        self.past.as_ref().map_or(0, |past| past.kernel().modes())
    }

    /// Whether D^alpha x is infinite at t = 0+.
    pub fn is_singular(&self) -> bool {
        self.jump != 0.0
    }

    /// Whether its energies are known: not after a singular start, nor where a network begins as steeply ([`Self::lose_account`]).
    pub fn is_accounted(&self) -> bool {
        self.is_accounted
    }

    /// No step knows the energies of what begins like t^alpha.
    pub fn lose_account(&mut self) {
        self.is_accounted = false;
    }

    /// x(0) t^−alpha/Γ(1−alpha) of a singular start, else 0; infinite at t = 0.
    pub fn singular_part(&self, t: f64) -> f64 {
        if self.jump == 0.0 { 0.0 } else { self.jump * t.powf(-self.alpha) * self.singular_factor }
    }

    /// The singular part at the nodes of a step, such that h Σ_j A_ij σ_j is its exact integral up to every node:
    /// σ = x(0)/(h Γ(2−alpha)) A⁻¹ (t_j^{1−alpha} − t_n^{1−alpha}); with one node its mean over the step. Three nodes may be at `places`.
    ///
    /// Collocation that takes the point values instead loses its order at a singular start; far from the start both agree.
    pub fn singular_moments(&self, start: &StepStart, nodes: Nodes, places: Option<&Places>) -> [f64; MAX_NODES] {
        if self.jump == 0.0 {
            return [0.0; MAX_NODES];
        }
        let power = 1.0 - self.alpha;
        let impulse = |c: f64| {
            let lag = c * start.h;
            let grown = if start.t == 0.0 {
                lag.powf(power)
            } else {
                start.t.powf(power) * (power * (lag / start.t).ln_1p()).exp_m1()
            };
            self.jump * self.singular_factor / power * grown / start.h
        };
        collocated(impulse, nodes, places)
    }

    /// D^alpha x at the nodes of a step as an affine map of the step's strokes and rates.
    ///
    /// With [`Nodes::Midpoint`] it is the mean of D^alpha x over the step under a constant rate u:
    /// h^{1−alpha}/Γ(3−alpha)·u + Σ_k w_k z_k ψ_0(λ_k h), the singular part apart. Impulses are then those of a continuous stroke
    /// of straight pieces, whose errors do not add up: a force that errs by h^{2−alpha} in every step leaves the motion of order 2. The
    /// work h Σ F u is that of D^alpha x on this stroke, never negative in all, so that no step size makes energy.
    pub fn respond(&self, start: &StepStart, nodes: Nodes, form: Form) -> Affine {
        self.respond_at(start, nodes, None, form)
    }

    /// As [`Self::respond`], the nodes of a step with three being at `places`.
    pub fn respond_at(&self, start: &StepStart, nodes: Nodes, places: Option<&Places>, form: Form) -> Affine {
        match &self.prepared {
            Some(ready) if ready.is_for(start, nodes, places, form) => ready.affine,
            _ => match places {
                None => self.affine(start, nodes, form),
                Some(places) => self.affine_at(start, places, form),
            },
        }
    }

    /// [`Self::affine`] of three nodes at `places`.
    fn affine_at(&self, start: &StepStart, places: &Places, form: Form) -> Affine {
        let mut affine = Affine::default();
        let both = self.both(form, Some(places));
        for (i, &theta) in places.positions().iter().enumerate() {
            if self.alpha == 0.0 {
                affine.stroke[i][i] = 1.0;
                affine.history[i] = start.stroke - self.held();
                continue;
            }
            let strokes = || self.local.stroke_row_at(start.h, i, places);
            let Some(past) = &self.past else {
                match form {
                    Form::Rates | Form::Hermite => affine.rate[i][i] = 1.0,
                    Form::Strokes => affine.stroke[i] = strokes(),
                }
                continue;
            };
            affine.history[i] = past.at(theta * start.h) + self.singular_part(start.t + theta * start.h);
            match form {
                Form::Strokes => affine.stroke[i] = strokes(),
                Form::Rates => {
                    let row = self.local.rate_row_at(start.h, i, places);
                    affine.history[i] += row[0] * start.rate;
                    affine.rate[i].copy_from_slice(&row[1..]);
                }
                Form::Hermite => self.take_both(&both, start, i, &mut affine),
            }
        }
        affine
    }

    fn affine(&self, start: &StepStart, nodes: Nodes, form: Form) -> Affine {
        let mut affine = Affine::default();
        let both = self.both(form, None);
        for (i, &c) in nodes.positions().iter().enumerate() {
            if self.alpha == 0.0 {
                affine.stroke[i][i] = 1.0;
                affine.history[i] = start.stroke - self.held();
                continue;
            }
            let Some(past) = &self.past else {
                match form {
                    Form::Rates | Form::Hermite => affine.rate[i][i] = 1.0,
                    Form::Strokes => affine.stroke[i] = self.local.stroke_row(start.h, i, nodes),
                }
                continue;
            };
            let before = match nodes {
                Nodes::Midpoint => mean_history(past, start.h),
                Nodes::One | Nodes::Radau | Nodes::Inner => past.at(c * start.h),
            };
            affine.history[i] = before + self.singular_part(start.t + c * start.h);
            match form {
                Form::Strokes => affine.stroke[i] = self.local.stroke_row(start.h, i, nodes),
                Form::Rates => {
                    let row = self.local.rate_row(start.h, i, nodes);
                    affine.history[i] += row[0] * start.rate;
                    affine.rate[i].copy_from_slice(&row[1..]);
                }
                Form::Hermite => self.take_both(&both, start, i, &mut affine),
            }
        }
        affine
    }

    /// What a step has of both strokes and rates, where it asks for it.
    pub(super) fn both(&self, form: Form, places: Option<&Places>) -> Option<Both> {
        (form == Form::Hermite && self.is_fractional()).then(|| self.local.both(places))
    }

    fn take_both(&self, both: &Option<Both>, start: &StepStart, i: usize, affine: &mut Affine) {
        let Some(both) = both else { return };
        let (rates, strokes) = self.local.rows_of_both(both, start.h, i);
        affine.history[i] += rates[0] * start.rate;
        affine.rate[i].copy_from_slice(&rates[1..]);
        affine.stroke[i] = strokes;
    }

    /// Makes ready what a step will ask for, which then costs nothing however often it is asked; no answer changes.
    pub fn prepare(&mut self, start: &StepStart, nodes: Nodes, form: Form) {
        self.prepare_at(start, nodes, None, form);
    }

    /// As [`Self::prepare`], the nodes of a step with three being at `places`.
    pub fn prepare_at(&mut self, start: &StepStart, nodes: Nodes, places: Option<&Places>, form: Form) {
        if self.prepared.as_ref().is_some_and(|ready| ready.is_for(start, nodes, places, form)) {
            return;
        }
        let affine = match places {
            None => {
                self.prepare_lags(start.h, nodes, form.coefficients());
                self.affine(start, nodes, form)
            }
            // Such lags are those of no other step: tables of them would be filled for one use.
            Some(places) => self.affine_at(start, places, form),
        };
        self.prepared = Some(Prepared { start: *start, nodes, places: places.copied(), form, affine });
    }

    fn prepare_lags(&mut self, h: f64, nodes: Nodes, coefficients: usize) {
        let Some(past) = &mut self.past else { return };
        self.local.prepare(h);
        match nodes {
            Nodes::One | Nodes::Midpoint => {
                past.prepare(h, coefficients, 0.0);
            }
            Nodes::Radau | Nodes::Inner => {
                for c in nodes.positions() {
                    past.prepare(c * h, coefficients, 0.0);
                }
            }
        }
    }

    /// From now on [`Self::now`] is what was found by other means: by a named scheme.
    pub fn tell(&mut self, derivative: f64) {
        self.told = Some(derivative);
    }

    /// D^alpha x between two steps, where x and x' are `stroke` and `rate`, without the singular part: D^alpha x itself does not jump
    /// with x', but at alpha = 1.
    pub fn now(&self, stroke: f64, rate: f64) -> f64 {
        match (self.told, self.alpha) {
            (Some(told), _) => told,
            (None, 0.0) => stroke - self.held(),
            (None, 1.0) => rate,
            (None, _) => self.now,
        }
    }

    /// D^alpha x at t_n + θh, 0 < θ ≤ 1, from the step's polynomial and the exact x and x' there.
    pub fn derivative(&self, start: &StepStart, step: &RatePolynomial, theta: f64, stroke: f64, rate: f64) -> f64 {
        self.regular_derivative(step, theta, stroke, rate) + self.singular_part(start.t + theta * step.h)
    }

    /// As [`Self::derivative`] without the singular part.
    pub fn regular_derivative(&self, step: &RatePolynomial, theta: f64, stroke: f64, rate: f64) -> f64 {
        match &self.past {
            Some(past) => self.local.part(step, theta) + past.at(theta * step.h),
            None if self.alpha == 0.0 => stroke - self.held(),
            None => rate,
        }
    }

    /// As [`Self::regular_derivative`] for a step of rates at the Radau nodes, with the exact x' at θ as one point more: between the
    /// nodes this is as accurate as the end of the step.
    pub fn derivative_between(&self, step: &RatePolynomial, theta: f64, stroke: f64, rate: f64) -> f64 {
        self.derivative_between_at(step, &NODE_POLYNOMIAL, theta, stroke, rate)
    }

    /// As [`Self::derivative_between`]; `nodes` are the coefficients of the polynomial that vanishes at 0 and at the nodes.
    pub(crate) fn derivative_between_at(
        &self,
        step: &RatePolynomial,
        nodes: &[f64; 5],
        theta: f64,
        stroke: f64,
        rate: f64,
    ) -> f64 {
        let value = self.regular_derivative(step, theta, stroke, rate);
        let at = |coefficients: &[f64; 5]| coefficients.iter().rev().fold(0.0, |sum, c| sum * theta + c);
        let node_polynomial = at(nodes);
        if self.past.is_none() {
            return value;
        }
        // Next to a node the point says nothing that the cubic does not know, and what it errs would weigh too much.
        let miss = (rate - step.rate(theta)) * node_polynomial / (node_polynomial * node_polynomial + NEXT_TO_NODE);
        let moments: [f64; 5] = std::array::from_fn(|p| nodes[p] * self.local.factors[p]);
        value + miss * self.local.power(theta * step.h) * at(&moments)
    }

    /// |D^alpha x| at the end of the step by the step's polynomial less the same by the Hermite form of its ends: the embedded error.
    ///
    /// `resolution` is the rounding of the strokes; differences that it explains count as 0.
    pub fn defect(&self, step: &RatePolynomial, stroke: [f64; 2], rate: [f64; 2], resolution: f64) -> f64 {
        if self.past.is_none() {
            return 0.0;
        }
        let hermite = RatePolynomial::hermite(step.h, stroke, rate);
        let difference = (self.local.part(step, 1.0) - self.local.part(&hermite, 1.0)).abs();
        (difference - 6.0 * resolution * self.local.power(step.h) / step.h).max(0.0)
    }

    /// The same along a given motion, three nodes being at `places`: with [`Form::Hermite`] the most of what the stroke at the first node tells, of order
    /// 7 − alpha, with [`Form::Rates`] the most of what all of them tell at a node, of order 5 − alpha.
    pub(crate) fn defect_along(
        &self,
        step: &RatePolynomial,
        (form, places): (Form, Option<&Places>),
        known: [&[f64]; 2],
        resolution: f64,
    ) -> f64 {
        if self.past.is_none() {
            return 0.0;
        }
        if form == Form::Hermite {
            let noise = NOISE_OF_BOTH * resolution / step.h;
            return self.local.defect_of_both(step.h, places, (step.u[SEXTIC - 1].abs() - noise).max(0.0));
        }
        let both = RatePolynomial::through_strokes_and_rates(step.h, places, known);
        let positions = places.map_or(Nodes::Radau.positions(), |places| places.positions());
        let told = |theta: &f64| (self.local.part(&both, *theta) - self.local.part(step, *theta)).abs();
        let noise = NOISE_AT_NODES * resolution * self.local.power(step.h) / step.h;
        (positions.iter().map(told).fold(0.0, f64::max) - noise).max(0.0)
    }

    /// Energy of a unit springpot at t_n + θh; `rate` is x' there. The limits: ½(x − x(0))² or ½x² stored at alpha = 0,
    /// x'² dissipated at alpha = 1.
    pub fn energy(&self, step: &RatePolynomial, theta: f64, stroke: f64, rate: f64) -> Energy {
        let past = match &self.past {
            Some(past) => past,
            None if self.alpha == 0.0 => {
                return Energy { stored: 0.5 * (stroke - self.held()).powi(2), dissipation: 0.0 };
            }
            None => return Energy { stored: 0.0, dissipation: rate * rate },
        };
        // At t = 0 the fast lags have not settled yet: nothing is stored and nothing flows.
        if theta == 0.0 && past.is_empty() {
            return Energy::default();
        }
        // A step behind a kink is shorter than those before it: what its fast modes take in is not settled.
        let longer = if step.h > 0.0 { past.extended(Nodes::Radau.positions()[0] * step.h) } else { None };
        let past = longer.as_ref().unwrap_or(past);
        let mut power = 1.0;
        let scaled = step.u.map(|u| {
            let coefficient = power * u;
            power *= theta;
            coefficient
        });
        let Squares { weighted, with_rates } = past.squares(theta * step.h, &scaled);
        let [d1, d2, d3] = past.fast_tail();
        let bend = step.bend(theta);
        Energy {
            // What is stored at the start of a step is what was stored at the end of the one before.
            stored: match &longer {
                Some(_) if theta == 0.0 => self.stored(stroke, rate),
                _ => 0.5 * (weighted + d2 * rate * rate),
            },
            dissipation: with_rates + rate * (d1 * rate - 2.0 * d2 * bend) + d3 * bend * bend,
        }
    }

    /// Energy that a unit springpot stores after the last committed step; `stroke` and `rate` are x and x' there.
    pub fn stored(&self, stroke: f64, rate: f64) -> f64 {
        self.energy(&RatePolynomial::NONE, 0.0, stroke, rate).stored
    }

    /// Takes an accepted step into the past: z_k ← e^{−λ_k h} z_k + ∫ e^{−λ_k(h−s)} x'(s) ds, exact for the polynomial.
    pub fn commit(&mut self, step: &RatePolynomial) {
        self.take(step, step, None);
    }

    /// As [`Self::commit`] of a step with three nodes at `places`.
    pub fn commit_at(&mut self, step: &RatePolynomial, places: Option<&Places>) {
        self.take(step, step, places);
    }

    /// Takes `step` into the past, D^alpha x at its end being that of `as_found`.
    fn take(&mut self, step: &RatePolynomial, as_found: &RatePolynomial, places: Option<&Places>) {
        let shortest = self.shortest_lag(step.h, places);
        // Whoever does not prepare steps asks for the next one with the same lags.
        if self.prepared.take().is_none() && places.is_none() {
            self.prepare_lags(step.h, Nodes::Radau, step.coefficients().len());
        }
        let local = self.local.part(as_found, 1.0);
        let Some(past) = &mut self.past else { return };
        self.travelled += step.travel();
        past.extend(shortest);
        self.now = local + past.advance(step.h, step.coefficients(), 0.0);
        past.drop_surplus(shortest);
    }

    /// As [`Self::commit`] for a step of rates that ends at `stroke`, which is known to `resolution`, above 0; three nodes may be at `places`.
    ///
    /// Integrals of rates drift from the strokes, in a step by less than any tolerance; over 10⁵ steps the slowest modes, which
    /// are D^alpha x at small alpha, would be off by 10⁻⁷. What is owed is paid back as a rate, the faster the more it is.
    pub fn commit_rates(&mut self, step: &RatePolynomial, places: Option<&Places>, stroke: f64, resolution: f64) {
        if self.past.is_none() {
            return;
        }
        let mut paid = *step;
        if let Some(Debt { rate, .. }) = self.debt(step, stroke, resolution) {
            paid.u[0] += rate;
        }
        self.take(&paid, step, places);
    }

    /// The debt behind a step that ends at `stroke`, where it is more than `resolution`.
    pub(super) fn debt(&self, step: &RatePolynomial, stroke: f64, resolution: f64) -> Option<Debt> {
        let past = self.past.as_ref()?;
        let owed = (stroke - self.origin) - (self.travelled + step.travel());
        if owed.abs() <= resolution || owed.is_nan() {
            return None;
        }
        let largest = step.rate(0.0).abs().max(step.rate(1.0).abs());
        // Of a debt that may be rounding, no more than the kernel errs: a short step would make much of it.
        let bearable = 10.0 * past.kernel().tolerance * (owed.abs() / resolution) * largest;
        Some(Debt { owed, rate: (owed.abs() / step.h).min(bearable).copysign(owed) })
    }

    /// The shortest lag that steps like the one to be committed ask for.
    pub(super) fn shortest_lag(&self, h: f64, places: Option<&Places>) -> f64 {
        let first = match (&self.prepared, places) {
            (_, Some(places)) => places.positions()[0],
            (Some(prepared), None) => prepared.nodes.positions()[0],
            (None, None) => Nodes::Radau.positions()[0],
        };
        Nodes::Radau.positions()[0].min(first) * h
    }

    /// The past as exponentials.
    pub(super) fn past(&self) -> Option<&History> {
        self.past.as_ref()
    }

    pub(super) fn local(&self) -> &Local {
        &self.local
    }

    /// [`Self::singular_part`] at t, its integral from `from` on, and the integral of that.
    pub(crate) fn singular_motion(&self, from: f64, t: f64) -> [f64; 3] {
        if !self.is_singular() {
            return [0.0; 3];
        }
        let parts = |t: f64| {
            let value = if t == 0.0 { 0.0 } else { self.singular_part(t) };
            [value, value * t / (1.0 - self.alpha), value * t * t / ((1.0 - self.alpha) * (2.0 - self.alpha))]
        };
        let ([value, once, twice], [_, before, before_twice]) = (parts(t), parts(from));
        [value, once - before, twice - before_twice - (t - from) * before]
    }

    /// x(0) of a singular start, else 0.
    pub(super) fn singular_jump(&self) -> f64 {
        self.jump
    }

    /// Puts a past before the first step: the modes as a function of their λ, x' just before t = 0, D^alpha x at t = 0, and the mean of
    /// x, which counts as unloaded at alpha = 0.
    pub(crate) fn recall(&mut self, mode: &dyn Fn(f64) -> f64, last: &RatePolynomial, derivative: f64, mean: f64) {
        if self.alpha == 0.0 {
            (self.kind, self.origin) = (Kind::Caputo, mean);
        }
        if let Some(past) = &mut self.past {
            past.recall(mode, last.h, last.coefficients());
            self.now = derivative;
        }
    }

    /// Moves t = 0 on to `age` after a singular start, s: what jumped there is a past like any other.
    pub(crate) fn age(&mut self, age: f64) {
        self.now += self.singular_part(age);
        let jump = std::mem::take(&mut self.jump);
        self.is_accounted = true;
        if let Some(past) = &mut self.past {
            past.add_jump(jump, age);
        }
    }

    /// Appends all numbers of the memory to `numbers`.
    pub(crate) fn save(&self, numbers: &mut Vec<f64>) {
        numbers.extend([self.origin, self.jump, self.travelled, self.now]);
        if let Some(past) = &self.past {
            past.save(numbers);
        }
    }

    /// Takes back what [`Self::save`] wrote of a memory of the same order, from the front of `numbers`; `None` where it is not that.
    pub(crate) fn load(&mut self, numbers: &mut &[f64]) -> Option<()> {
        let &[origin, jump, travelled, now] = numbers.split_off(..4)? else { return None };
        (self.origin, self.jump, self.travelled, self.now) = (origin, jump, travelled, now);
        self.prepared = None;
        self.past.as_mut().map_or(Some(()), |past| past.load(numbers))
    }

    /// The stroke that counts as unloaded at alpha = 0.
    pub(super) fn held(&self) -> f64 {
        match self.kind {
            Kind::Caputo => self.origin,
            Kind::RiemannLiouville => 0.0,
        }
    }
}

/// Values at the nodes whose collocation has these integrals, over h, up to c; with one node the mean.
pub(super) fn collocated(impulse: impl Fn(f64) -> f64, nodes: Nodes, places: Option<&Places>) -> [f64; MAX_NODES] {
    if let Some(places) = places {
        let impulses = places.positions().map(impulse);
        return places.inverse().map(|row| row.iter().zip(impulses).map(|(a, i)| a * i).sum());
    }
    match nodes {
        Nodes::One | Nodes::Midpoint => [impulse(1.0), 0.0, 0.0, 0.0],
        Nodes::Radau | Nodes::Inner => {
            let mut impulses = [0.0; MAX_NODES];
            impulses.iter_mut().zip(nodes.positions()).for_each(|(value, c)| *value = impulse(*c));
            nodes.inverse().map(|row| row.iter().zip(impulses).map(|(a, i)| a * i).sum())
        }
    }
}

/// The mean of the past over lags up to h; modes above the kernel's have settled to z = x'/λ and add d2·x'/h.
fn mean_history(past: &History, h: f64) -> f64 {
    if past.is_empty() {
        return 0.0;
    }
    let [_, d2, _] = past.fast_tail();
    past.mean(h) + d2 * past.last_value() / h
}
