//! Branches that are left: what moves the times of that, and what becomes of forces and integrals.

use super::super::eye::Eye;
use super::super::mode::{Bound, Guard, Mode, Slew};
use super::super::term::Integrand;
use super::super::{ControlRun, Target};
use super::see::add_sense;
use super::{ControlVariation, Place};
use crate::signal::Jet;
use crate::system::sensitivity::SensitivityError;

/// A force that jumps at a time that parameters move.
#[derive(Debug)]
pub(crate) struct Jump {
    /// δt*.
    pub(crate) moved: Vec<f64>,
    /// The element whose input it is, where it is one.
    pub(crate) element: Option<usize>,
}

/// A joint that was on another branch.
#[derive(Debug)]
pub(super) struct Left {
    joint: usize,
    mode: Mode,
    /// Of its force before the last limit.
    shaped: Vec<f64>,
    /// Of the time at which it was left.
    moved: Vec<f64>,
}

impl ControlVariation {
    /// Looks at what `run` is about to leave at node `i`, where the motion changes by these blocks: by how much parameters move the times of jumps of
    /// forces, and what jumps.
    pub(crate) fn foresee(&mut self, i: usize, run: &ControlRun, at: Place, motion: [&[f64]; 2]) -> Vec<Jump> {
        let mut found = Vec::new();
        if i > 0 {
            self.push(i, run, true);
        } else {
            self.push_at(i, None, (run, true), motion);
        }
        for &guard in run.leaves() {
            match guard {
                Guard::Branch { law, bit } if self.laws[law].law.expression().jumps_at(bit) => {
                    let target = self.laws[law].target;
                    let element = if let Target::Input(e, _) = target { Some(e) } else { None };
                    let moved = self.moved((law, bit), run, at, motion);
                    found.push(Jump { moved, element });
                }
                Guard::Branch { .. } => {}
                Guard::Reaches { joint, .. }
                | Guard::Returns { joint }
                | Guard::Turns { joint }
                | Guard::Empties { joint }
                | Guard::Fills { joint }
                | Guard::Outruns { joint, .. }
                | Guard::Catches { joint } => {
                    let mode = run.joints[joint].mode;
                    let shaped = self.shaped(i, joint, mode, at.t, motion);
                    let own = &self.joints[joint];
                    let drift = self.drift(i, joint, run);
                    let moved = match (guard, mode.bound, mode.slew) {
                        (Guard::Reaches { sign, .. }, ..) | (Guard::Returns { .. }, Bound::At(sign), _) => {
                            let over = shaped.iter().zip(&own.limit);
                            over.map(|(shaped, limit)| (f64::from(sign) * limit - shaped) / drift).collect()
                        }
                        (Guard::Catches { .. }, _, Slew::Goes { sign, .. }) => {
                            let follows = Mode { slew: Slew::Follows, ..mode };
                            let wanted = self.shaped(i, joint, follows, at.t, motion);
                            let rate = f64::from(sign) * run.joints[joint].limit.rate;
                            let off = shaped.iter().zip(&wanted);
                            off.map(|(shaped, wanted)| (shaped - wanted) / (drift - rate)).collect()
                        }
                        _ => vec![0.0; shaped.len()],
                    };
                    self.left.push(Left { joint, mode, shaped, moved });
                }
            }
        }
        found
    }

    /// By how much parameters move the time at which a kink of an expression is passed: δt* = −δγ/γ̇.
    fn moved(&self, (law, bit): (usize, u32), run: &ControlRun, at: Place, motion: [&[f64]; 2]) -> Vec<f64> {
        let (count, own, branch) = (self.count(), &self.laws[law], run.laws[law].branch);
        let [q, v, a] = at.motion;
        let read = |e: usize| at.readings[e];
        let eye = Eye { system: &self.system, t: at.t, q, v, kinematics: at.kinematics, element: &read };
        let jets: Vec<Jet> = own.senses.iter().map(|sense| eye.jet(*sense, a)).collect();
        let seen: Vec<f64> = jets.iter().map(|jet| jet.value).collect();
        let guard = |time: Jet, jets: &[Jet]| own.law.expression().guard_jet(branch, bit, time, jets);
        let rate = guard(Jet::time(at.t), &jets).map_or(0.0, |jet| jet.first);
        let (mut by_state, mut change) = ([vec![0.0; v.len()], vec![0.0; v.len()]], vec![0.0; count]);
        for (k, sense) in own.senses.iter().enumerate() {
            let alone = seen.iter().enumerate().map(|(j, value)| Jet {
                value: *value,
                first: if j == k { 1.0 } else { 0.0 },
                second: 0.0,
            });
            let alone: Vec<Jet> = alone.collect();
            let slope = guard(Jet::constant(at.t), &alone).map_or(0.0, |jet| jet.first);
            add_sense(&eye, *sense, slope, at, (&mut by_state, &mut change));
        }
        for (p, change) in change.iter_mut().enumerate() {
            *change += own.own[p].iter().map(|slope| slope.guard_on(branch, bit, at.t, &seen)).sum::<f64>();
            for (slopes, blocks) in by_state.iter().zip(motion) {
                *change += slopes.iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum::<f64>();
            }
            *change /= -rate;
        }
        change
    }

    /// How fast the force that is wanted of a joint changes at node `i`: at the end of the step, or at its start.
    fn drift(&self, i: usize, joint: usize, run: &ControlRun) -> f64 {
        let mut sum = self.nodes[i].drifts[joint];
        for term in run.terms.iter().filter(|term| term.law.velocity == self.joints[joint].velocity) {
            if term.law.order > -1.0 {
                sum = f64::NAN;
            }
            let runs = run.joints[joint].mode.integrand == Integrand::Runs;
            sum += if runs { term.law.gain * self.nodes[i].errors[joint][0] } else { 0.0 };
        }
        if sum.is_finite() { sum } else { run.drift(joint, if i == 0 { 0.0 } else { 1.0 }) }
    }

    /// What changes of the force of a joint before its last limit at node `i`, on a branch.
    pub(super) fn shaped(&self, i: usize, joint: usize, mode: Mode, t: f64, [q, v]: [&[f64]; 2]) -> Vec<f64> {
        let (n, count, node, own) = (self.system.model.nv(), self.count(), &self.nodes[i], &self.joints[joint]);
        let along = |slopes: &[f64], blocks: &[f64], p: usize| -> f64 {
            slopes[own.row * n..][..n].iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        let of = |p: usize| match mode.slew {
            Slew::Goes { sign, since, .. } => own.from[p] + f64::from(sign) * (t - since) * own.rate_limit[p],
            Slew::Follows => {
                let still = node.wanted_explicit[own.row * count + p] + node.pushed[own.row * count + p];
                still + along(&node.wanted.d_q, q, p) + along(&node.wanted.d_v, v, p)
            }
        };
        (0..count).map(of).collect()
    }

    /// Goes onto the branches that `run` is on at t, from those that were left.
    ///
    /// # Errors
    /// Where that has no derivative.
    pub(crate) fn settle(&mut self, run: &ControlRun, t: f64, motion: [&[f64]; 2]) -> Result<(), SensitivityError> {
        let unknown = |what: &str| Err(SensitivityError::Unknown { what: format!("{what}, at t = {t} s") });
        for Left { joint, mode, shaped, moved } in std::mem::take(&mut self.left) {
            let (now, error) = (run.joints[joint].mode, self.nodes[0].errors[joint][0]);
            if let Some(m) = run.joints[joint].integral.filter(|_| now.integrand != mode.integrand) {
                let own = run.terms.iter().filter(|term| term.law.velocity == run.joints[joint].velocity);
                if own.count() > 1 && [mode, now].iter().any(|mode| mode.integrand == Integrand::Slides) {
                    return unknown("a fractional derivative of a controller beside an integral that keeps its limit");
                }
                if run.terms[m].law.order > -1.0 {
                    return unknown("a fractional integral of a controller that stops at its limit");
                }
                let taken = |mode: Mode| if mode.integrand == Integrand::Runs { error } else { 0.0 };
                match [mode.integrand, now.integrand] {
                    [_, Integrand::Slides] => self.slide(0, joint, run, motion),
                    [Integrand::Slides, _] => {}
                    _ => self.terms[m].jump(taken(mode) - taken(now), &moved),
                }
            }
            match (mode.slew, now.slew) {
                (Slew::Follows, Slew::Goes { .. }) => self.joints[joint].from = shaped,
                (Slew::Goes { sign: before, .. }, Slew::Goes { sign, .. }) if mode.slew != now.slew => {
                    let turn = f64::from(before - sign) * run.joints[joint].limit.rate;
                    let turned = shaped.iter().zip(&moved).map(|(shaped, moved)| shaped + turn * moved);
                    self.joints[joint].from = turned.collect();
                }
                _ => {}
            }
            self.joints[joint].mode = now;
        }
        for joint in 0..self.joints.len() {
            let (now, before) = (run.joints[joint].mode, self.joints[joint].mode);
            if now.slew != before.slew && now.slew != Slew::Follows {
                // The reference jumped.
                self.joints[joint].from = self.shaped(0, joint, before, t, motion);
            }
            self.joints[joint].mode = now;
        }
        Ok(())
    }

    /// The integral of a joint keeps its force at the limit at node `i`, whatever else changes of it.
    pub(super) fn slide(&mut self, i: usize, joint: usize, run: &ControlRun, [q, v]: [&[f64]; 2]) {
        let (Some(m), Bound::At(sign)) = (run.joints[joint].integral, run.joints[joint].mode.bound) else { return };
        let (n, count, node, own) = (self.system.model.nv(), self.count(), &self.nodes[i], &self.joints[joint]);
        let along = |slopes: &[f64], blocks: &[f64], p: usize| -> f64 {
            slopes[own.row * n..][..n].iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum()
        };
        let others = |p: usize| {
            let still = node.wanted_explicit[own.row * count + p];
            still + along(&node.wanted.d_q, q, p) + along(&node.wanted.d_v, v, p)
        };
        let wanted = (0..count).map(|p| f64::from(sign) * own.limit[p] - others(p)).collect::<Vec<_>>();
        self.terms[m].slide(i, &run.terms[m], &wanted);
    }
}
