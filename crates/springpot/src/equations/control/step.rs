//! A step: what is seen at its nodes, and what laws answer.

use super::eye::{Eye, InputSlopes};
use super::mode::Bound;
use super::term::{Integrand, Term};
use super::{ControlRun, LawRun, Node, Target, at, input};
use crate::collocation::{Nodes, RADAU_NODES, STAGES};
use crate::control::TorqueSlopes;
use crate::dynamics::RneaDerivatives;
use crate::elements::ElementBank;
use crate::equations::context::Context;
use crate::law::InputValue;
use crate::system::System;
use crate::system::error::RunError;

/// An end of a step: t, q and v.
pub(crate) type End<'a> = (f64, &'a [f64], &'a [f64]);

impl ControlRun {
    /// Begins a step of size `h` from t whose last node is at `t_end`; the start was seen.
    ///
    /// # Errors
    /// Where the reference cannot be followed.
    pub(crate) fn start(&mut self, cx: Context, t: f64, h: f64, t_end: f64) -> Result<(), RunError> {
        self.changing.at_end.clear();
        for node in 1..=STAGES {
            let at = if node == STAGES { t_end } else { t + RADAU_NODES[node - 1] * h };
            self.nodes[node].t = at;
            self.aim_at(cx.system, at, node)?;
        }
        let Self { terms, joints, nodes, .. } = self;
        for term in terms {
            let (c, joint) = joints
                .iter()
                .enumerate()
                .find(|(_, joint)| joint.velocity == term.law.velocity)
                .expect("a term of a joint that is driven");
            term.start(t, h, Nodes::Radau, nodes[0].taken_by(term, c), joint.mode.integrand);
        }
        Ok(())
    }

    /// Looks at the start of a step, where nothing is known yet.
    ///
    /// # Errors
    /// Where the reference cannot be followed.
    pub(crate) fn see_start(&mut self, eye: &Eye) -> Result<(), RunError> {
        self.aim_at(eye.system, eye.t, 0)?;
        (self.nodes[0].t, self.known.aim) = (eye.t, true);
        self.see(0, eye);
        Ok(())
    }

    /// Looks at the start (0) or at a node of the step.
    pub(crate) fn see(&mut self, node: usize, eye: &Eye) {
        let Self { control, laws, joints, nodes, scratch, is_continuous, .. } = self;
        let node = &mut nodes[node];
        node.seen.clear();
        for law in laws.iter() {
            node.seen.extend(law.law.senses().iter().map(|sense| eye.value(*sense)));
        }
        node.rates.clear();
        node.rates.extend(laws.iter().map(|law| if law.stretches { law.rate(eye) } else { 0.0 }));
        let Some(controlled) = &control.controller else { return };
        let at = at(eye, &node.aim, &controlled.shaping);
        node.errors.clear();
        node.errors.extend(joints.iter().map(|joint| at.error(joint.velocity)));
        node.derived.clear();
        node.derived.extend(joints.iter().map(|joint| at.taken(joint.velocity)));
        if *is_continuous {
            controlled.torque(&at, scratch, &mut node.law);
        }
    }

    /// Time of the start (0) or of a node of the step, s.
    pub(crate) fn time(&self, node: usize) -> f64 {
        self.nodes[node].t
    }

    /// Writes the inputs that follow from what was seen at a node, where nobody holds them.
    pub(crate) fn write_inputs(&self, cx: Context, node: usize, bank: &mut ElementBank) {
        self.write_inputs_to(cx, [node; 2], bank);
    }

    /// The same to a point of the bank that is not the node.
    pub(crate) fn write_inputs_to(&self, cx: Context, [node, point]: [usize; 2], bank: &mut ElementBank) {
        self.for_each_law(node, |target, value| match target {
            Target::Input(e, i) if !cx.holds_input(e, i) => bank.inputs_mut(e, point)[i] = value,
            _ => {}
        });
    }

    /// Looks at the robot at any time, in the place of a node.
    ///
    /// # Errors
    /// Where the reference cannot be followed.
    pub(crate) fn look_from(&mut self, node: usize, eye: &Eye) -> Result<(), RunError> {
        self.nodes[node].t = eye.t;
        self.aim_at(eye.system, eye.t, node)?;
        self.see(node, eye);
        Ok(())
    }

    /// What laws without terms answer to what was seen so, where elements pull by `pull` (nv).
    pub(crate) fn answer_from(&mut self, node: usize, pull: &[f64]) {
        self.combine(node, &|_, _| 0.0, pull);
    }

    /// Whether the forces of the elements are taken off.
    pub(crate) fn compensates(&self) -> bool {
        self.compensates
    }

    /// Keeps ∂y/∂q of an element at a node, where its force is to be taken off.
    pub(crate) fn keep_gradient(&mut self, node: usize, e: usize, gradient: &[f64]) {
        if self.compensates {
            let kept = &mut self.nodes[node].gradients;
            kept.resize(kept.len().max((e + 1) * gradient.len()), 0.0);
            kept[e * gradient.len()..][..gradient.len()].copy_from_slice(gradient);
        }
    }

    fn for_each_law(&self, node: usize, mut take: impl FnMut(Target, InputValue)) {
        let node = &self.nodes[node];
        let mut seen = &node.seen[..];
        for (law, rate) in self.laws.iter().zip(&node.rates) {
            let (own, rest) = seen.split_at(law.law.senses().len());
            take(law.target, input(law.law.value_on(law.branch, node.t, own), *rate));
            seen = rest;
        }
    }

    /// Takes in how large the values of expressions with kinks are at the start.
    fn take_largest(&mut self) {
        let Self { laws, nodes: [start, ..], .. } = self;
        let mut seen = &start.seen[..];
        for law in laws {
            let (own, rest) = seen.split_at(law.law.senses().len());
            seen = rest;
            if law.law.has_kinks() {
                law.largest = law.largest.max(law.law.value_on(law.branch, start.t, own).abs());
            }
        }
    }

    /// Writes the inputs of element `element` at the start, where nobody holds them.
    pub(crate) fn inputs_at_start(&self, cx: Context, element: usize, inputs: &mut [InputValue]) {
        self.for_each_law(0, |target, value| match target {
            Target::Input(e, i) if e == element && !cx.holds_input(e, i) => inputs[i] = value,
            _ => {}
        });
    }

    /// What laws and terms answer at all nodes, where the elements answered as the bank has it.
    pub(crate) fn answer(&mut self, bank: &ElementBank) {
        if self.is_continuous || !self.terms.is_empty() {
            let Self { terms, joints, nodes, .. } = &mut *self;
            for term in terms {
                let found = joints.iter().enumerate().find(|(_, joint)| joint.velocity == term.law.velocity);
                let Some((c, joint)) = found else { continue };
                let errors = std::array::from_fn(|i| nodes[i + 1].taken_by(term, c));
                term.take(&errors, joint.mode.integrand);
            }
        }
        for node in 1..=STAGES {
            let mut pull = std::mem::take(&mut self.spare);
            pull.clear();
            pull.resize(self.nodes[node].torque.len(), 0.0);
            if self.compensates {
                for (e, gradient) in self.nodes[node].gradients.chunks_exact(pull.len()).enumerate() {
                    let force = bank.response(e).force[node - 1];
                    pull.iter_mut().zip(gradient).for_each(|(sum, slope)| *sum += force * slope);
                }
            }
            let terms = |run: &Self, m: usize| run.terms[m].law.gain * run.terms[m].value[node];
            self.combine(node, &terms, &pull);
            self.spare = pull;
        }
    }

    /// What all say at the start, whose terms are as they were left; `pull` adds Σ F·∂y/∂q of the elements there.
    pub(super) fn answer_at_start(&mut self, pull: &mut dyn FnMut(&Self, &mut [f64])) {
        let mut sum = vec![0.0; self.nodes[0].torque.len()];
        if self.compensates {
            pull(self, &mut sum);
        }
        let value = |run: &Self, m: usize| {
            let law = run.terms[m].law;
            let found = run.joints.iter().enumerate().find(|(_, joint)| joint.velocity == law.velocity);
            found.map_or(0.0, |(c, joint)| {
                run.terms[m].now(run.nodes[0].taken_by(&run.terms[m], c), joint.mode.integrand)
            })
        };
        self.combine(0, &value, &sum);
    }

    /// The forces at a node from what was seen there, from the terms and from the `pull` of the elements.
    fn combine(&mut self, node: usize, term: &dyn Fn(&Self, usize) -> f64, pull: &[f64]) {
        let mut torque = std::mem::take(&mut self.nodes[node].torque);
        torque.fill(0.0);
        if self.is_continuous {
            let (mut wanted, mut shaped) =
                (std::mem::take(&mut self.nodes[node].wanted), std::mem::take(&mut self.nodes[node].shaped));
            wanted.clear();
            for joint in &self.joints {
                wanted.push(self.nodes[node].law[joint.velocity] + pull[joint.velocity]);
            }
            for m in 0..self.terms.len() {
                let value = term(self, m);
                let velocity = self.terms[m].law.velocity;
                let place = self.joints.iter().position(|joint| joint.velocity == velocity);
                wanted[place.expect("a joint that is driven")] += value;
            }
            shaped.clear();
            let t = self.nodes[node].t;
            for (joint, wanted) in self.joints.iter().zip(&wanted) {
                shaped.push(joint.mode.shaped(*wanted, joint.limit.rate, t));
                torque[joint.velocity] += joint.mode.force(*wanted, joint.limit, t);
            }
            (self.nodes[node].wanted, self.nodes[node].shaped) = (wanted, shaped);
        }
        self.for_each_law(node, |target, value| {
            if let Target::Torque(k) = target {
                torque[k] += value.value;
            }
        });
        self.nodes[node].torque = torque;
    }

    /// Takes ∂τ/∂q and ∂τ/∂v off the derivatives of the equations of motion at the start, and keeps those of inputs.
    pub(crate) fn linearise(&mut self, eye: &Eye, derivatives: &mut RneaDerivatives) {
        let n = eye.system.model.nv();
        let Self { control, laws, joints, nodes, scratch, slopes, input_slopes, spare, is_continuous, .. } = self;
        let node = &nodes[0];
        let TorqueSlopes { d_q, d_v } = &mut *slopes;
        d_q.fill(0.0);
        d_v.fill(0.0);
        if let Some(controlled) = control.controller.as_ref().filter(|_| *is_continuous) {
            controlled.law.slopes(&at(eye, &node.aim, &controlled.shaping), scratch, slopes);
            for k in 0..n {
                let follows = joints.iter().any(|joint| joint.velocity == k && joint.mode.follows());
                if !follows {
                    slopes.d_q[k * n..][..n].fill(0.0);
                    slopes.d_v[k * n..][..n].fill(0.0);
                }
            }
        }
        input_slopes.clear();
        let mut seen = &node.seen[..];
        for law in laws {
            let (own, rest) = seen.split_at(law.law.senses().len());
            seen = rest;
            law.law.slopes_on(law.branch, node.t, own, spare);
            let by_state = eye.answer(&law.law, spare);
            match law.target {
                Target::Torque(k) => {
                    let [by_q, by_v] = by_state;
                    slopes.d_q[k * n..][..n].iter_mut().zip(by_q).for_each(|(sum, own)| *sum += own);
                    slopes.d_v[k * n..][..n].iter_mut().zip(by_v).for_each(|(sum, own)| *sum += own);
                }
                Target::Input(element, _) => {
                    input_slopes.push(InputSlopes { element, by_state, force: Default::default() });
                }
            }
        }
        derivatives.d_q.iter_mut().zip(&slopes.d_q).for_each(|(sum, own)| *sum -= own);
        derivatives.d_v.iter_mut().zip(&slopes.d_v).for_each(|(sum, own)| *sum -= own);
    }

    /// How forces answer to inputs that follow from the state, at what the bank was told.
    pub(crate) fn take_input_forces(&mut self, bank: &ElementBank) {
        let inputs = self.laws.iter().filter_map(|law| match law.target {
            Target::Input(e, i) => Some((e, i)),
            Target::Torque(_) => None,
        });
        for ((e, i), slopes) in inputs.zip(&mut self.input_slopes) {
            slopes.force = bank.by_input(e, i);
        }
    }

    /// Whether elements count for nothing in the force balance of velocity `k`, since its actuator takes their forces off.
    pub(crate) fn takes_off_elements(&self, k: usize) -> bool {
        self.takes_off_any() && self.joints.iter().any(|joint| joint.velocity == k && joint.mode.follows())
    }

    /// Whether there may be such a velocity.
    pub(crate) fn takes_off_any(&self) -> bool {
        self.compensates && self.is_continuous
    }

    /// Solves for what integrals take that keep their force at its limit, once the step is solved; `false` where there is nothing.
    pub(crate) fn slide(&mut self) -> bool {
        for joint in &self.joints {
            let (Integrand::Slides, Bound::At(sign), Some(m)) =
                (joint.mode.integrand, joint.mode.bound, joint.integral)
            else {
                continue;
            };
            let place = self.joints.iter().position(|other| other.velocity == joint.velocity).expect("itself");
            let limit = f64::from(sign) * joint.limit.torque;
            let own = |i: usize| self.terms[m].law.gain * self.terms[m].value[i + 1];
            let wanted = std::array::from_fn(|i| limit - (self.nodes[i + 1].wanted[place] - own(i)));
            if !self.terms[m].slide(wanted) {
                return false;
            }
        }
        true
    }

    /// How far and how fast each velocity that a controller drives is to go with its reference.
    pub(crate) fn going(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        self.joints.iter().map(|joint| (joint.velocity, joint.going))
    }

    /// How far and how fast velocity `k` of this mass still has to go for a memory of its error that begins like no power of t; zeros without one.
    pub(crate) fn missing(&self, k: usize, mass: f64) -> [f64; 2] {
        let steep = self.terms.iter().find(|term| term.law.velocity == k && term.law.order > -1.0);
        let place = self.joints.iter().position(|joint| joint.velocity == k);
        let (Some(term), Some(place), true) = (steep, place, mass > 0.0) else { return [0.0; 2] };
        let [error, rate] = self.nodes[0].errors[place].map(f64::abs);
        // The rate at which it answers: m ω² = gain·ω^order.
        let omega = (term.law.gain / mass).powf((2.0 - term.law.order).recip());
        if omega > 0.0 { [error.max(rate / omega), rate.max(omega * error)] } else { [0.0; 2] }
    }

    /// The size of the force on velocity `k` at the start: of the nodes a run that goes on knows nothing yet.
    pub(crate) fn largest(&self, k: usize) -> f64 {
        self.nodes[0].torque[k].abs()
    }

    /// Adds the torques (nv) that expressions say at `t` of what was seen at the start, and writes the inputs of the elements, where nobody holds
    /// them.
    pub(crate) fn expressions_at(&self, cx: Context, t: f64, torques: &mut [f64], inputs: &mut [Vec<InputValue>]) {
        let node = &self.nodes[0];
        let mut seen = &node.seen[..];
        for law in &self.laws {
            let (own, rest) = seen.split_at(law.law.senses().len());
            seen = rest;
            let value = law.law.value(t, own);
            match law.target {
                Target::Torque(k) if !cx.holds_force(k) => torques[k] += value,
                Target::Input(e, i) if !cx.holds_input(e, i) => inputs[e][i] = input(value, 0.0),
                _ => {}
            }
        }
    }

    /// What rounding makes of the torques on velocity `k` that expressions say, at the start.
    pub(crate) fn rounded_torque(&self, k: usize) -> f64 {
        let mut sum = 0.0;
        self.for_each_rounded(|target, lost| {
            sum += if matches!(target, Target::Torque(own) if own == k) { lost } else { 0.0 }
        });
        sum
    }

    /// Hands over the inputs of element `element` that expressions say, and what rounding makes of them at the start.
    pub(crate) fn for_each_rounded_input(&self, element: usize, take: &mut dyn FnMut(usize, f64)) {
        self.for_each_rounded(|target, lost| match target {
            Target::Input(e, i) if e == element => take(i, lost),
            _ => {}
        });
    }

    fn for_each_rounded(&self, mut take: impl FnMut(Target, f64)) {
        let node = &self.nodes[0];
        let mut seen = &node.seen[..];
        for law in &self.laws {
            let (own, rest) = seen.split_at(law.law.senses().len());
            take(law.target, law.law.rounding_on(law.branch, node.t, own));
            seen = rest;
        }
    }

    /// The terms of the force on velocity `k` between two steps, where its error, and what derivatives take, and the rates of these are so.
    pub(super) fn terms_now(&self, k: usize, error: [f64; 2], derived: [f64; 2]) -> f64 {
        let integrand =
            |k: usize| self.joints.iter().find(|joint| joint.velocity == k).map(|joint| joint.mode.integrand);
        let own = self.terms.iter().filter(|term| term.law.velocity == k);
        let taken = |term: &Term| if term.is_integral() { error } else { derived };
        own.map(|term| term.now(taken(term), integrand(k).unwrap_or_default())).sum()
    }

    /// Takes over on which side of its limit each force of a sampled controller is (nv).
    pub(crate) fn set_sides(&mut self, sides: &[i8]) {
        if self.is_continuous {
            return;
        }
        let stops = self.stops_windup();
        for joint in &mut self.joints {
            let (sign, error) = (sides[joint.velocity], joint.integral.filter(|_| stops));
            joint.mode.bound = if sign == 0 || error.is_none() { Bound::Free } else { Bound::At(sign) };
            joint.mode.integrand = Integrand::Runs;
        }
    }

    /// Takes the step into the past; where its nodes are not known it was told its ends.
    pub(crate) fn commit(&mut self) {
        if self.knows_nodes {
            self.terms.iter_mut().for_each(super::Term::commit);
            self.nodes.swap(0, STAGES);
            self.take_largest();
            return;
        }
        for m in 0..self.terms.len() {
            let (h, errors, integrand) = self.end_of_term(m);
            self.terms[m].commit_ends(h, errors, integrand);
        }
    }

    /// Takes the ends of a step whose nodes are not known, as terms remember errors there.
    ///
    /// # Errors
    /// Where the reference cannot be followed.
    pub(crate) fn take_ends(&mut self, system: &System, ends: [End; 2]) -> Result<(), RunError> {
        if self.knows_nodes || self.terms.is_empty() {
            return Ok(());
        }
        let [(from, ..), (to, ..)] = ends;
        self.span = [from, to];
        for (k, (t, q, v)) in ends.into_iter().enumerate() {
            self.aim_at(system, t, 0)?;
            let Self { control, terms, nodes, ends, .. } = &mut *self;
            ends[k].clear();
            let (aim, shaping) = (&nodes[0].aim, control.controller.as_ref().map(|own| &own.shaping));
            ends[k].extend(terms.iter().map(|term| match shaping.filter(|_| !term.is_integral()) {
                Some(shaping) => shaping.taken(aim, &system.model, term.law.velocity, [q, v]),
                None => aim.error(&system.model, term.law.velocity, q, v),
            }));
        }
        Ok(())
    }

    /// Whether errors are remembered.
    pub(crate) fn remembers(&self) -> bool {
        !self.terms.is_empty()
    }

    /// What term `m` takes in from a step whose ends were told: its size, the error and its rate at both ends, and what an integral does.
    pub(super) fn end_of_term(&self, m: usize) -> (f64, [[f64; 2]; 2], Integrand) {
        let ([from, to], errors) = (self.span, self.ends.each_ref().map(|errors| errors[m]));
        let joint = self.joints.iter().find(|joint| joint.velocity == self.terms[m].law.velocity);
        let integrand = match joint.map(|joint| joint.mode).unwrap_or_default().bound {
            Bound::At(sign) if f64::from(sign) * errors[0][0] > 0.0 => Integrand::Frozen,
            _ => Integrand::Runs,
        };
        (to - from, errors, integrand)
    }
}

impl Node {
    /// What a term of joint `c` takes here: its error, or what is derived in place of it, and the rate of that.
    pub(super) fn taken_by(&self, term: &Term, c: usize) -> [f64; 2] {
        if term.is_integral() { self.errors[c] } else { self.derived[c] }
    }
}

impl LawRun {
    /// How fast it changes, which hangs on no acceleration: of the state it sees places alone.
    fn rate(&self, eye: &Eye) -> f64 {
        let still = vec![0.0; eye.v.len()];
        let jets: Vec<_> = self.law.senses().iter().map(|sense| eye.jet(*sense, &still)).collect();
        self.law.jet_on(self.branch, eye.t, &jets).first
    }
}
