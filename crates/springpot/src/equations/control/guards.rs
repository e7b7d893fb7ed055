//! Where a branch is left, and onto which one.

use super::eye::Eye;
use super::mode::{Bound, Guard, Slew};
use super::term::Integrand;
use super::{ControlRun, LawRun, Node};
use crate::collocation::{Cubic, RADAU_NODES, STAGES};
use crate::control::Aim;
use crate::equations::zero::first_zero_of;
use crate::system::System;
use crate::system::error::RunError;

/// Where a step is first looked at that starts where a branch begins.
const EARLY: f64 = 1.0 / 64.0;

/// How far behind its change a step may end, in units of what the guard goes over in it.
const SHARE: f64 = 1e-8;

/// What of a guard is rounding, in units of its largest value.
const ROUNDING: f64 = 1e-12;

/// Share of a coordinate that is no jump of its reference.
const STILL: f64 = 1e-9;

/// Branches that one jump may leave.
const MOST_AT_ONCE: usize = 64;

/// So many changes within this share of the run get nowhere.
const CHATTER: f64 = 1e-9;
const MOST_CHANGES: u32 = 1000;

/// What is seen of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ControlSeen {
    Nothing,
    /// The first change is at θ; at 0 the step starts on the wrong branch.
    Within(f64, Guard),
    /// It is at the end, and noted.
    AtEnd,
}

type Values = [f64; STAGES + 1];

impl ControlRun {
    /// Whether no branch is ever left.
    pub(crate) fn is_smooth(&self) -> bool {
        let has_limits = |joint: &super::JointRun| joint.limit.torque.is_finite() || joint.limit.rate.is_finite();
        let integrates = self.is_continuous || self.joints.iter().any(|joint| joint.integral.is_some());
        !(integrates && self.joints.iter().any(has_limits)) && self.laws.iter().all(|law| !law.law.has_kinks())
    }

    /// The guards of the present branch of the controller.
    fn guards_of_joints(&self) -> Vec<Guard> {
        let mut guards = Vec::new();
        if !self.is_continuous {
            // Of a sampled controller only what its integrals take can change between samples.
            let at_limit = |own: &super::JointRun| own.mode.bound != Bound::Free;
            let joints = self.joints.iter().enumerate().filter(|(_, own)| at_limit(own));
            guards.extend(joints.map(|(joint, _)| Guard::Turns { joint }));
            return guards;
        }
        for (joint, own) in self.joints.iter().enumerate() {
            let mode = own.mode;
            if own.limit.rate.is_finite() {
                match mode.slew {
                    Slew::Follows => guards.extend([1, -1].map(|sign| Guard::Outruns { joint, sign })),
                    Slew::Goes { .. } => guards.push(Guard::Catches { joint }),
                }
            }
            match (mode.bound, mode.integrand) {
                (Bound::Free, _) if own.limit.torque.is_finite() => {
                    guards.extend([1, -1].map(|sign| Guard::Reaches { joint, sign }));
                }
                (Bound::At(_), Integrand::Slides) => {
                    guards.extend([Guard::Empties { joint }, Guard::Fills { joint }]);
                }
                (Bound::At(_), _) => {
                    guards.push(Guard::Returns { joint });
                    if own.integral.is_some() && self.stops_windup() {
                        guards.push(Guard::Turns { joint });
                    }
                }
                (Bound::Free, _) => {}
            }
        }
        guards
    }

    /// Hands over the kinks of an expression that hang on the state, with their values at the start (0) or at a node; those of t alone end steps as
    /// kinks of signals do.
    fn branch_guards(&self, law: usize, node: usize, take: &mut dyn FnMut(u32, f64)) {
        let own = &self.laws[law];
        let of_time = own.law.expression().kinks_of_time();
        let node = &self.nodes[node];
        own.law.expression().guards(own.branch, node.t, self.seen_by(law, node), &mut |bit, value| {
            if of_time >> bit & 1 == 0 {
                take(bit, value);
            }
        });
    }

    /// What an expression sees at a node.
    pub(super) fn seen_by<'n>(&self, law: usize, node: &'n Node) -> &'n [f64] {
        let before: usize = self.laws[..law].iter().map(|law| law.law.senses().len()).sum();
        &node.seen[before..][..self.laws[law].law.senses().len()]
    }

    /// The guards of the present branch with their values at the start and at the nodes of the step.
    fn guards_with_values(&self) -> Vec<(Guard, Values)> {
        let mut kinks: Vec<(Guard, Values)> = Vec::new();
        for law in (0..self.laws.len()).filter(|&law| self.laws[law].law.has_kinks()) {
            let first = kinks.len();
            for node in 0..=STAGES {
                let mut at = first;
                self.branch_guards(law, node, &mut |bit, value| {
                    let guard = Guard::Branch { law, bit };
                    // The angle of a point has one where it is beside its cut.
                    while kinks.get(at).is_some_and(|(known, _)| known.precedes(guard)) {
                        at += 1;
                    }
                    if kinks.get(at).is_none_or(|(known, _)| *known != guard) {
                        kinks.insert(at, (guard, [f64::NAN; STAGES + 1]));
                    }
                    kinks[at].1[node] = value;
                    at += 1;
                });
            }
        }
        kinks.extend(self.guards_of_joints().into_iter().map(|guard| (guard, self.values(guard))));
        kinks
    }

    /// The values of a guard at the start and at the nodes of the step.
    fn values(&self, guard: Guard) -> Values {
        std::array::from_fn(|node| self.value(guard, node))
    }

    /// The value of a guard at the start (0) or at a node of the step.
    fn value(&self, guard: Guard, node: usize) -> f64 {
        let at = &self.nodes[node];
        let sign_of = |joint: usize| match self.joints[joint].mode.bound {
            Bound::At(sign) => f64::from(sign),
            Bound::Free => 0.0,
        };
        match guard {
            Guard::Branch { law, bit } => {
                let mut value = f64::NAN;
                self.branch_guards(law, node, &mut |own, argument| {
                    if own == bit {
                        value = argument;
                    }
                });
                value
            }
            Guard::Reaches { joint, sign } => self.joints[joint].limit.torque - f64::from(sign) * at.shaped[joint],
            Guard::Returns { joint } => sign_of(joint) * at.shaped[joint] - self.joints[joint].limit.torque,
            Guard::Turns { joint } => {
                // Frozen while the error pushes outwards.
                let inwards = if self.joints[joint].mode.integrand == Integrand::Frozen { 1.0 } else { -1.0 };
                inwards * sign_of(joint) * at.errors[joint][0]
            }
            Guard::Empties { joint } => sign_of(joint) * self.taken(joint)[node],
            Guard::Fills { joint } => sign_of(joint) * (at.errors[joint][0] - self.taken(joint)[node]),
            Guard::Outruns { joint, sign } => {
                let theta = if node == 0 { 0.0 } else { RADAU_NODES[node - 1] };
                self.joints[joint].limit.rate - f64::from(sign) * self.drift(joint, theta)
            }
            Guard::Catches { joint } => match self.joints[joint].mode.slew {
                Slew::Goes { sign, .. } => f64::from(sign) * (at.wanted[joint] - at.shaped[joint]),
                Slew::Follows => 0.0,
            },
        }
    }

    /// What the integral of a joint takes at the start and at the nodes.
    fn taken(&self, joint: usize) -> Values {
        self.joints[joint].integral.map_or([0.0; STAGES + 1], |m| self.terms[m].integrand())
    }

    /// dτ/dt of the force that is wanted of a joint, at θ of the step.
    pub(super) fn drift(&self, joint: usize, theta: f64) -> f64 {
        let values: Values = std::array::from_fn(|node| self.nodes[node].wanted[joint]);
        let h = self.nodes[STAGES].t - self.nodes[0].t;
        Cubic::through(&values).slope(theta) / h
    }

    /// The first change in the step that was solved.
    pub(crate) fn look(&mut self) -> ControlSeen {
        self.changing.at_end.clear();
        if !self.slide() {
            return ControlSeen::Nothing;
        }
        let (mut first, mut at_end): (Option<(f64, Guard)>, Vec<Guard>) = (None, Vec::new());
        for (guard, values) in self.guards_with_values() {
            let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            if !values.iter().all(|value| value.is_finite()) || largest == 0.0 {
                continue;
            }
            let noise = ROUNDING * largest.max(self.size(guard));
            let on_it = values[0] <= noise;
            let cubic = Cubic::through(&values);
            if values[0] < -noise || (on_it && cubic.at(EARLY) < -noise) {
                return ControlSeen::Within(0.0, guard);
            }
            let found = first_zero_of(&cubic, if on_it { EARLY } else { 0.0 });
            let Some(theta) = found.filter(|theta| *theta > 0.0) else { continue };
            let moved = values.iter().fold(0.0, |moved: f64, value| moved.max((value - values[0]).abs()));
            let behind = -values[STAGES];
            if (0.0..=(SHARE * moved).max(noise)).contains(&behind) && theta > 0.9 {
                at_end.push(guard);
            } else if first.is_none_or(|(earliest, _)| theta < earliest) {
                first = Some((theta, guard));
            }
        }
        match first {
            Some((theta, guard)) => ControlSeen::Within(theta, guard),
            None if at_end.is_empty() => ControlSeen::Nothing,
            None => {
                self.changing.at_end = at_end;
                ControlSeen::AtEnd
            }
        }
    }

    /// What the values of a guard are differences of.
    fn size(&self, guard: Guard) -> f64 {
        match guard {
            Guard::Reaches { joint, .. } | Guard::Returns { joint } => self.joints[joint].limit.torque,
            Guard::Outruns { joint, .. } => self.joints[joint].limit.rate,
            Guard::Catches { joint } => self.nodes.iter().fold(0.0, |m, node| f64::max(m, node.wanted[joint].abs())),
            Guard::Empties { joint } | Guard::Fills { joint } => {
                self.nodes.iter().fold(0.0, |m, node| f64::max(m, 1e3 * node.errors[joint][0].abs()))
            }
            Guard::Branch { .. } | Guard::Turns { .. } => 0.0,
        }
    }

    /// How far a change is away at θ; negative behind it.
    pub(crate) fn guard_at(&self, guard: Guard, theta: f64) -> f64 {
        Cubic::through(&self.values(guard)).at(theta)
    }

    /// Notes a change that is here.
    pub(crate) fn note(&mut self, guard: Guard) {
        if !self.changing.at_end.contains(&guard) {
            self.changing.at_end.push(guard);
        }
    }

    /// Whether the branch is left at the end of the step, or at its start.
    pub(crate) fn changes(&self) -> bool {
        !self.changing.at_end.is_empty()
    }

    /// Goes onto the branches behind the changes that were noted: at the end of the step, or at its start.
    ///
    /// # Errors
    /// [`RunError::ControlChatter`] where branches are left again and again at one time.
    pub(crate) fn change(&mut self, system: &System, is_end: bool, end: f64) -> Result<(), RunError> {
        let (theta, node) = if is_end { (1.0, STAGES) } else { (0.0, 0) };
        let changes = std::mem::take(&mut self.changing.at_end);
        let Some(&last) = changes.last() else { return Ok(()) };
        for &guard in &changes {
            let drift = match guard {
                Guard::Reaches { joint, .. } | Guard::Returns { joint } | Guard::Catches { joint } => {
                    Some(self.drift(joint, theta))
                }
                _ => None,
            };
            self.leave(guard, node, drift);
        }
        let (t, span) = (self.nodes[node].t, CHATTER * end);
        self.changing.left = (t, changes);
        let (first, count) = &mut self.changing.together;
        (*first, *count) = if t - *first <= span && *count > 0 { (*first, *count + 1) } else { (t, 1) };
        let count = *count;
        if count <= MOST_CHANGES {
            return Ok(());
        }
        let (what, signal) = self.named(last, system);
        Err(RunError::ControlChatter { t, what, signal, count, span })
    }

    /// Goes onto the branch behind a guard; `drift` is dτ/dt of the wanted force before, where it is known.
    fn leave(&mut self, guard: Guard, node: usize, drift: Option<f64>) {
        let stops_windup = self.stops_windup();
        let nodes = &self.nodes[node];
        let outward = |terms: &[super::Term], own: &super::JointRun, joint: usize, sign: i8| {
            let m = own.integral.filter(|_| stops_windup)?;
            let push = f64::from(sign) * nodes.errors[joint][0];
            (push > 0.0).then(|| (terms[m].law, terms[m].law.gain * push))
        };
        match guard {
            Guard::Branch { law, bit } => self.laws[law].branch ^= 1 << bit,
            Guard::Reaches { joint, sign } => {
                let own = &self.joints[joint];
                let integrand = match outward(&self.terms, own, joint, sign) {
                    None => Integrand::Runs,
                    Some(_) if own.mode.slew != Slew::Follows => Integrand::Frozen,
                    // Without the integral the force comes back at once, with it it goes on: it stays where it is.
                    Some((law, push)) => match drift {
                        Some(drift) if law.order > -1.0 || f64::from(sign) * drift - push < 0.0 => Integrand::Slides,
                        _ => Integrand::Frozen,
                    },
                };
                let mode = &mut self.joints[joint].mode;
                (mode.bound, mode.integrand) = (Bound::At(sign), integrand);
            }
            Guard::Returns { joint } => {
                let own = &self.joints[joint];
                let Bound::At(sign) = own.mode.bound else { return };
                let slides = own.mode.integrand == Integrand::Frozen
                    && own.mode.slew == Slew::Follows
                    && outward(&self.terms, own, joint, sign).is_some_and(|(law, push)| {
                        law.order > -1.0 || drift.is_some_and(|drift| f64::from(sign) * drift + push > 0.0)
                    });
                let mode = &mut self.joints[joint].mode;
                if slides {
                    mode.integrand = Integrand::Slides;
                } else {
                    (mode.bound, mode.integrand) = (Bound::Free, Integrand::Runs);
                }
            }
            Guard::Turns { joint } => {
                let mode = &mut self.joints[joint].mode;
                let was_frozen = mode.integrand == Integrand::Frozen;
                mode.integrand = if was_frozen { Integrand::Runs } else { Integrand::Frozen };
            }
            Guard::Empties { joint } => self.joints[joint].mode.integrand = Integrand::Frozen,
            Guard::Fills { joint } => {
                let mode = &mut self.joints[joint].mode;
                (mode.bound, mode.integrand) = (Bound::Free, Integrand::Runs);
            }
            Guard::Outruns { joint, sign } => {
                let (from, since) = (nodes.wanted[joint], nodes.t);
                self.joints[joint].mode.slew = Slew::Goes { sign, from, since };
            }
            Guard::Catches { joint } => {
                let (from, since, rate) = (nodes.shaped[joint], nodes.t, self.joints[joint].limit.rate);
                self.joints[joint].mode.slew = match drift {
                    Some(drift) if drift.abs() > rate => {
                        Slew::Goes { sign: if drift > 0.0 { 1 } else { -1 }, from, since }
                    }
                    _ => Slew::Follows,
                };
            }
        }
    }

    /// Looks at a start, where something may have jumped, finds the branches and works out what acts there; `pull` adds Σ F·∂y/∂q of the elements.
    ///
    /// # Errors
    /// Where the reference cannot be followed.
    pub(crate) fn find_branches(&mut self, eye: &Eye, pull: &mut dyn FnMut(&Self, &mut [f64])) -> Result<(), RunError> {
        if !self.acts_continuously() {
            return Ok(());
        }
        self.changing.at_end.clear();
        let before = self.known.branches.then(|| self.nodes[0].shaped.clone());
        let (from, aimed) = (self.nodes[0].t, self.known.aim.then(|| self.nodes[0].aim.clone()));
        self.take_sides(eye);
        self.see_start(eye)?;
        if let Some(aimed) = aimed {
            self.refuse_jump(eye, from, &aimed)?;
        }
        let answer = &mut |run: &mut Self| run.answer_at_start(pull);
        answer(self);
        let Some(before) = before.filter(|before| self.is_continuous && before.len() == self.joints.len()) else {
            self.leave_wrong(eye, answer);
            return Ok(());
        };
        for joint in 0..self.joints.len() {
            let (rate, wanted, last) = (self.joints[joint].limit.rate, self.nodes[0].wanted[joint], before[joint]);
            let jump = wanted - last;
            if rate.is_finite() && jump.abs() > 1e-9 * (wanted.abs() + last.abs()) {
                let sign = if jump > 0.0 { 1 } else { -1 };
                self.joints[joint].mode.slew = Slew::Goes { sign, from: last, since: self.nodes[0].t };
            }
        }
        answer(self);
        self.leave_wrong(eye, answer);
        Ok(())
    }

    /// Takes the sides of kinks just after the time of `eye`: of all at the first start, later of those that hang on t alone, whose switches ended the step.
    fn take_sides(&mut self, eye: &Eye) {
        let still = vec![0.0; eye.v.len()];
        for own in self.laws.iter_mut().filter(|own| own.law.has_kinks()) {
            let expression = own.law.expression();
            let taken = if self.known.branches { expression.kinks_of_time() } else { u64::MAX };
            if taken == 0 {
                continue;
            }
            let jets: Vec<_> = own.law.senses().iter().map(|sense| eye.jet(*sense, &still)).collect();
            own.branch = own.branch & !taken | expression.branch(eye.t, &jets) & taken;
        }
        self.known.branches = true;
    }

    /// Refuses a reference that jumps, where the law would answer with an impulse.
    fn refuse_jump(&self, eye: &Eye, from: f64, before: &Aim) -> Result<(), RunError> {
        let Some(controlled) = self.controlled() else { return Ok(()) };
        let (model, aim) = (&eye.system.model, &self.nodes[0].aim);
        for joint in &self.joints {
            let k = joint.velocity;
            let derives = self.terms.iter().any(|term| term.law.velocity == k && term.law.order > 0.0);
            let Some(place) = model.coordinate_of(k).filter(|_| derives || controlled.law.follows_accelerations())
            else {
                continue;
            };
            let jump = aim.q[place] - before.q[place];
            let reach = 2.0 * (eye.t - from).abs() * (aim.v[k].abs() + before.v[k].abs());
            if jump.abs() > reach + STILL * (aim.q[place].abs() + before.q[place].abs()) {
                let what = format!("joint \"{}\"", model.v_labels()[k].name);
                return Err(RunError::ReferenceJump { t: eye.t, what, jump });
            }
        }
        Ok(())
    }

    /// Leaves branches whose guards say so at the start, until none does.
    fn leave_wrong(&mut self, eye: &Eye, answer: &mut dyn FnMut(&mut Self)) {
        for _ in 0..MOST_AT_ONCE {
            let Some(guard) = self.wrong_at_start() else { return };
            self.leave(guard, 0, None);
            if matches!(guard, Guard::Branch { .. }) {
                self.see(0, eye);
            }
            answer(self);
        }
    }

    /// A guard whose branch is not that of the start.
    fn wrong_at_start(&self) -> Option<Guard> {
        for law in 0..self.laws.len() {
            let mut wrong = None;
            self.branch_guards(law, 0, &mut |bit, value| {
                let guard = Guard::Branch { law, bit };
                if value < 0.0 && wrong.is_none() && !self.has_just_left(guard) {
                    wrong = Some(guard);
                }
            });
            if wrong.is_some() {
                return wrong;
            }
        }
        self.guards_of_joints().into_iter().find(|guard| match guard {
            Guard::Outruns { .. } | Guard::Empties { .. } | Guard::Fills { .. } => false,
            _ => self.value(*guard, 0) < -ROUNDING * self.size(*guard),
        })
    }

    /// Whether a guard was left at the start: it may stand before its change by the rounding of the time.
    fn has_just_left(&self, guard: Guard) -> bool {
        let (t, left) = &self.changing.left;
        self.nodes[0].t - t <= 8.0 * f64::EPSILON * t && left.contains(&guard)
    }

    /// What a guard belongs to, for messages, and the column of what an expression says.
    fn named(&self, guard: Guard, system: &System) -> (String, Option<String>) {
        let Guard::Branch { law, .. } = guard else { return ("the controller".to_owned(), None) };
        let LawRun { law, target, .. } = &self.laws[law];
        let column = target.column(system);
        (format!("the expression \"{}\" of {column}", law.expression()), Some(column))
    }
}
