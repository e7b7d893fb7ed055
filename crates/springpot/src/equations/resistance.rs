//! Damping and friction of the joints, on the side of the actuators, in joints of one degree: d·v + f·tanh(v/v_0), or
//! d·v + f·sign(v) where friction sticks ([`FrictionLaw`]).

use crate::model::{FrictionLaw, Model};
use crate::system::System;

/// A joint that resists.
struct Resisting {
    /// Its velocity is ratio · v\[index\].
    index: usize,
    ratio: f64,
    speed: f64,
    damping: f64,
    friction: f64,
    law: FrictionLaw,
}

impl Resisting {
    fn resistance(&self) -> f64 {
        self.damping * self.speed + self.friction * direction(self.law, self.speed)
    }

    /// Its derivative by the speed, without the friction that sticks.
    fn slope(&self) -> f64 {
        match self.law {
            FrictionLaw::Smooth { speed: width } => {
                let sign = (self.speed / width).tanh();
                self.damping + self.friction * (1.0 - sign * sign) / width
            }
            FrictionLaw::Sticking => self.damping,
        }
    }
}

/// What friction of 1 N or 1 N·m comes to at this speed.
pub(super) fn direction(law: FrictionLaw, speed: f64) -> f64 {
    match law {
        FrictionLaw::Smooth { speed: width } => (speed / width).tanh(),
        FrictionLaw::Sticking => sign(speed),
    }
}

fn resisting<'a>(model: &'a Model, v: &'a [f64]) -> impl Iterator<Item = Resisting> + 'a {
    (0..model.joint_count()).filter_map(move |j| {
        let (damping, friction) = (model.damping()[j], model.friction()[j]);
        if damping == 0.0 && friction == 0.0 {
            return None;
        }
        let (index, ratio) = (model.v_range(j).start, model.followed(j).map_or(1.0, |(_, ratio, _)| ratio));
        let law = model.friction_laws()[j];
        Some(Resisting { index, ratio, speed: ratio * v[index], damping, friction, law })
    })
}

/// −1, 0 or 1.
pub(super) fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

/// Adds what the joints ask of the actuators at the velocities `v` (nv) to `tau` (nv); returns the power that they take, W.
///
/// Friction that sticks is f·sign(v) here, 0 at rest: what holds a joint there is no matter of its velocity.
pub(crate) fn add_resistance(system: &System, v: &[f64], tau: &mut [f64]) -> f64 {
    let mut power = 0.0;
    for joint in resisting(&system.model, v) {
        let resistance = joint.resistance();
        tau[joint.index] += joint.ratio * resistance;
        power += resistance * joint.speed;
    }
    power
}

/// The power that damping and friction of the joints take at the velocities `v` (nv), W.
pub(crate) fn joint_loss(system: &System, v: &[f64]) -> f64 {
    resisting(&system.model, v).map(|joint| joint.resistance() * joint.speed).sum()
}

/// Hands over what the power that damping and friction take changes by with each velocity: its index and the slope, W/(m/s) or W/(rad/s).
///
/// That of friction that sticks is f·|v|, with a bend at rest: its slope is that of the side on which the velocity moves, `sliding` (−1, 0 where friction
/// holds, or 1), whatever rounding has made of a velocity that comes to rest.
pub(super) fn each_loss_slope(
    system: &System,
    v: &[f64],
    sliding: impl Fn(usize) -> f64,
    mut take: impl FnMut(usize, f64),
) {
    for joint in resisting(&system.model, v) {
        let Resisting { index, ratio, speed, damping, friction, law } = joint;
        let resistance = match law {
            FrictionLaw::Smooth { .. } => joint.resistance(),
            FrictionLaw::Sticking => damping * speed + friction * sign(ratio) * sliding(index),
        };
        take(index, ratio * (resistance + speed * joint.slope()));
    }
}

/// [`add_resistance`] without the friction that sticks.
pub(crate) fn add_smooth_resistance(system: &System, v: &[f64], tau: &mut [f64]) {
    for Resisting { index, ratio, speed, damping, friction, law } in resisting(&system.model, v) {
        let resistance = match law {
            FrictionLaw::Smooth { speed: width } => damping * speed + friction * (speed / width).tanh(),
            FrictionLaw::Sticking => damping * speed,
        };
        tau[index] += ratio * resistance;
    }
}

/// Adds the derivatives of [`add_smooth_resistance`] by v to ∂τ/∂v (nv × nv).
pub(crate) fn add_tangents(system: &System, v: &[f64], d_v: &mut [f64]) {
    let n = system.model.nv();
    for joint in resisting(&system.model, v) {
        d_v[joint.index * n + joint.index] += joint.ratio * joint.ratio * joint.slope();
    }
}

/// Adds resistance/velocity, the secants through rest, to ∂τ/∂v (nv × nv): for an iteration of fixed length.
///
/// Where friction brings a joint to rest within a step, tangents lead to and fro across rest; secants, which are never smaller,
/// lead towards it from one side, so that an iteration cut short never makes energy. Friction that sticks has no part in them.
pub(crate) fn add_secants(system: &System, v: &[f64], d_v: &mut [f64]) {
    let n = system.model.nv();
    for Resisting { index, ratio, speed, damping, friction, law } in resisting(&system.model, v) {
        let slope = match law {
            FrictionLaw::Smooth { speed: width } => {
                let share = speed / width;
                let secant = if share == 0.0 { 1.0 } else { share.tanh() / share };
                damping + friction / width * secant
            }
            FrictionLaw::Sticking => damping,
        };
        d_v[index * n + index] += ratio * ratio * slope;
    }
}

/// Of every velocity what friction can hold at rest, Σ |ratio|·f over the joints that it moves and that stick, N·m or N (nv).
pub(crate) fn holding_forces(model: &Model) -> Vec<f64> {
    let mut forces = vec![0.0; model.nv()];
    let still = forces.clone();
    for Resisting { index, ratio, friction, law, .. } in resisting(model, &still) {
        if law == FrictionLaw::Sticking {
            forces[index] += ratio.abs() * friction;
        }
    }
    forces
}
