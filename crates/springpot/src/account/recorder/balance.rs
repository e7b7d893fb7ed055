//! The balance of energies, and what a step may add to its error.

use super::Recorder;
use crate::account::ledger::{Balance, NodePower, singular_work, work, work_defect};
use crate::account::works::{DISSIPATED, OF_ELEMENT, SUPPLIED};
use crate::collocation::STAGES;
use crate::equations::Equations;
use crate::equations::evaluate::Evaluation;
use crate::observe::Snapshot;
use crate::observe::evaluation::ElementRow;

/// A step this short, as a share of the motion, is kept whatever it does to the energy ledger: behind a kink of the rates the
/// powers rise like t^{1−alpha}, which no step resolves, and such a step turns over next to nothing.
const SHORTEST_LEDGER_STEP: f64 = 1e-11;

/// Share of what a stroke comes to soon that is not looked at more closely.
const BEGUN: f64 = 1e-3;

/// Energies below this count as none, J.
const TINY_ENERGY: f64 = 1e-280;

/// What rounding of strokes does to work, in units of stroke times force.
const WORK_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// What the energy ledger may err in one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Allowed {
    /// In units of the energy turned over.
    whole: f64,
    /// What an element has dissipated, in units of itself.
    account: f64,
}

/// What an element has dissipated counts at least as so many times rtol^⅔ of the energy turned over: beside a violent motion an element may lose little.
const ACCOUNT_FLOOR: f64 = 100.0;

impl Allowed {
    /// Where errors are told by an estimate of order 4 of a quadrature of order 5.
    pub(crate) fn by_defects(rtol: f64) -> Self {
        let allowed = rtol.powf(2.0 / 3.0);
        Self { whole: 0.01 * allowed, account: 0.03 * allowed }
    }

    /// Where they are told by an estimate of the order at which works are known, or one less: a thousand steps may add up.
    pub(crate) fn by_differences(rtol: f64) -> Self {
        Self { whole: 2e-3 * rtol, account: 6e-3 * rtol }
    }
}

impl Recorder {
    /// Time and size of the step.
    pub(super) fn span(&self) -> (f64, f64) {
        let [from, .., to] = &self.evaluations;
        (from.t, to.t - from.t)
    }

    /// Work of the actuators and losses of the joints from the start of the step to θ.
    pub(super) fn work_until(&self, theta: f64) -> (f64, f64) {
        if let Some(works) = &self.works {
            return works.of_joints(theta);
        }
        let (t, h) = self.span();
        let mut actuators = work(&self.powers.actuators, h, theta);
        for e in 0..self.equations.bank.len() {
            if !self.takes_elements_work || !self.equations.bank.is_singular(e) {
                continue;
            }
            // Without their power of t, which singular_work integrates exactly.
            let mut shares: Vec<(f64, NodePower)> = Vec::new();
            for k in 0..=STAGES {
                let (at, mut m) = (self.equations.bank.point(e, k), 0);
                self.equations.bank.for_each_singularity(e, at.inputs, &mut |term| {
                    if k == 0 {
                        shares.push((term.order, [0.0; STAGES + 1]));
                    }
                    shares[m].1[k] = term.coefficient * at.rate;
                    m += 1;
                });
            }
            actuators += shares.iter().map(|(alpha, g)| singular_work(g, t, h, theta, *alpha)).sum::<f64>();
        }
        (actuators, work(&self.powers.joints, h, theta))
    }

    /// Energies that element `e` has dissipated and been supplied with since t = 0, until θ of the step.
    pub(super) fn energies_until(&self, e: usize, theta: f64) -> (f64, f64) {
        let Some(works) = &self.works else { return self.equations.bank.energies_until(e, theta) };
        let ((dissipated, supplied), step) = (self.equations.bank.energies(e), works.of_element(e, theta));
        (dissipated + step.0, supplied + step.1)
    }

    /// Adds the regular power that element `e` takes from the actuators of kinematics given in advance.
    pub(crate) fn add_actuator_power(&mut self, e: usize) {
        self.equations.bank.evaluate_element(e);
        let response = *self.equations.bank.response(e);
        for k in 0..=STAGES {
            let at = self.equations.bank.point(e, k);
            let regular = match k {
                0 => self.equations.bank.now(e, &at).map_or(0.0, |observation| observation.regular),
                _ => response.force[k - 1] - response.singular[k - 1],
            };
            self.powers.actuators[k] += regular * at.rate;
        }
    }

    /// Takes in the powers of the actuators and the losses of the joints at the start of the step and at its nodes, where `force` is that of an
    /// element there.
    pub(crate) fn take_powers(&mut self, force: impl Fn(&Equations, usize, usize) -> f64) {
        for (node, evaluation) in self.evaluations.iter().enumerate() {
            let of_joint = |j: usize| {
                let computed = || {
                    let elements = evaluation.elements.iter().enumerate();
                    let pull = elements.map(|(e, at)| force(&self.equations, e, node) * at.gradient[j]);
                    evaluation.rigid[j] + pull.sum::<f64>()
                };
                evaluation.driven[j].unwrap_or_else(computed)
            };
            let moving = evaluation.v.iter().enumerate().filter(|(_, v)| **v != 0.0);
            self.powers.actuators[node] = moving.map(|(j, v)| of_joint(j) * v).sum();
            self.powers.joints[node] = evaluation.joint_loss;
        }
    }

    /// The energy turned over so far, J.
    pub(crate) fn turned_over(&self) -> f64 {
        self.ledger.turnover.total()
    }

    /// The balance at a snapshot, `actuators` and `joints` being the work since the start of the step.
    pub(super) fn balance(&self, snapshot: &Snapshot, actuators: f64, joints: f64) -> Balance {
        let sum = |of: fn(&ElementRow) -> f64| snapshot.elements.iter().map(of).sum::<f64>();
        let stored = sum(|row| row.observation.stored.unwrap_or(f64::NAN));
        self.balance_of(
            &snapshot.evaluation,
            [stored, sum(|row| row.dissipated), sum(|row| row.input)],
            actuators,
            joints,
        )
    }

    /// The balance of what elements have stored, dissipated and been supplied with.
    pub(super) fn balance_of(
        &self,
        evaluation: &Evaluation,
        [stored, dissipated, input]: [f64; 3],
        actuators: f64,
        joints: f64,
    ) -> Balance {
        Balance {
            kinetic: evaluation.kinetic,
            potential: evaluation.potential - self.ledger.potential_origin,
            stored,
            dissipated: dissipated + (self.ledger.joints + joints),
            input,
            actuators: if self.actuators_unknown() { f64::NAN } else { self.ledger.actuators + actuators },
        }
    }

    /// Potential energy at t = 0, J.
    pub(crate) fn potential_origin(&self) -> f64 {
        self.ledger.potential_origin
    }

    /// Forces of a named scheme are known at the rows alone.
    fn actuators_unknown(&self) -> bool {
        (0..self.equations.bank.len()).any(|e| !self.equations.bank.takes_part(e))
    }

    /// The largest of the first so many local errors of element `e` in units of their tolerances, and how it falls, where the stroke is about to be as
    /// fast as `rate` and what acts began at the time `since`: what has only begun is not looked at more closely than a share of what that leads
    /// to in the step.
    pub(crate) fn memory_error(&self, e: usize, first: usize, rate: f64, since: f64) -> (f64, f64) {
        let settings = &self.settings;
        let mut worst = (0.0, 4.0);
        // Strokes inside a series may begin like no power of t, alike on every scale of time: the very first steps err by what is soon nothing.
        let is_onset =
            self.equations.bank.from() + self.equations.bank.size() - since <= SHORTEST_LEDGER_STEP * settings.end;
        for (m, error) in self.equations.bank.errors(e).iter().enumerate().take(first) {
            let soon = if rate > 0.0 { BEGUN * rate * self.equations.bank.size().powf(1.0 - error.order) } else { 0.0 };
            let scale = self.equations.bank.scale(e, m).max(soon);
            let allowed = settings.atol.unwrap_or(0.0).max(settings.rtol * scale);
            let share = match error.share(scale, allowed) {
                share if is_onset && share.is_finite() => share.min(1.0),
                share => share,
            };
            // What is no number is no step to keep.
            if share > worst.0 || share.is_nan() {
                worst = (share, error.falls);
            }
        }
        worst
    }

    /// The powers of the step just worked out, in the order of [`Works`](crate::account::works::Works).
    pub(crate) fn flows(&self) -> Vec<NodePower> {
        let of_elements = (0..self.equations.bank.len()).flat_map(|e| {
            let powers = self.equations.bank.powers(e);
            [std::array::from_fn(|k| powers[k].dissipation), std::array::from_fn(|k| powers[k].input)]
        });
        [self.powers.actuators, self.powers.joints].into_iter().chain(of_elements).collect()
    }

    /// Estimate of what the step just worked out adds to the error of the ledger, by the differences of its quadrature, in units of its tolerance;
    /// `floor` is a lower bound of the energy turned over.
    pub(crate) fn energy_error(&self, h: f64, floor: f64) -> f64 {
        let defects: Vec<f64> = self.flows().iter().map(|power| work_defect(power, h)).collect();
        self.share_of_ledger(h, floor, &defects, Allowed::by_defects(self.settings.rtol))
    }

    /// What `defects`, in the order of [`Self::flows`], add to the error of the ledger in a step of size `h`, in units of what is allowed.
    pub(crate) fn share_of_ledger(&self, h: f64, floor: f64, defects: &[f64], allowed: Allowed) -> f64 {
        let turned_over = floor.max(self.turned_over()).max(self.ledger.stretching);
        // Of denormal energies no share can be told.
        if self.actuators_unknown() || turned_over < TINY_ENERGY || h <= SHORTEST_LEDGER_STEP * self.settings.end {
            return 0.0;
        }
        let rounding = self.rounding_of_work();
        let floor = (ACCOUNT_FLOOR * self.settings.rtol.powf(2.0 / 3.0)).min(1.0) * turned_over;
        let (joints, elements) = defects.split_at(OF_ELEMENT);
        let mut defect: f64 = joints.iter().sum();
        let mut worst_account = 0.0f64;
        for (e, own) in elements.chunks_exact(SUPPLIED + 1).enumerate() {
            let (dissipated, _) = self.equations.bank.energies(e);
            defect += own[DISSIPATED] + own[SUPPLIED];
            // Of NaN the larger is the other one.
            let size = dissipated.abs() + floor;
            worst_account = worst_account.max(own[DISSIPATED] / (allowed.account * size + rounding));
        }
        if defect.is_nan() {
            // What is no number is no step to keep, but where no account is kept.
            return if self.knows_energies() { f64::INFINITY } else { 0.0 };
        }
        worst_account.max(defect / (allowed.whole * turned_over + rounding))
    }

    /// What rounding of the strokes does to the work of the elements in a step, J: what has relaxed is known no better.
    fn rounding_of_work(&self) -> f64 {
        let works = (0..self.equations.bank.len()).map(|e| {
            let [strokes, _] = self.equations.bank.told(e);
            let largest = |values: &[f64]| values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
            largest(strokes) * largest(&self.equations.bank.response(e).force)
        });
        WORK_ROUNDING * works.filter(|work| work.is_finite()).sum::<f64>()
    }
}
