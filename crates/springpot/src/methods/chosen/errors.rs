//! What a step may err.

use super::sizes::{Sizes, Tolerance};
use crate::equations::context::Context;
use crate::equations::{Equations, Origin};

/// Share of the speed that all the energy turned over would give a joint alone: slower joints are not looked at more closely.
const ENERGY_FLOOR: f64 = 1e-6;

/// What a step may err, and what that is measured by.
#[derive(Debug)]
pub(in crate::methods) struct Errors {
    pub(in crate::methods) tolerance: Tolerance,
    /// How large the motion is.
    pub(in crate::methods) sizes: Sizes,
    /// The energy turned over so far, J.
    pub(in crate::methods) energy: f64,
    /// How fast and how far each free velocity moves until the end of this step.
    pub(in crate::methods) sized: Vec<[f64; 2]>,
    /// Errors that are allowed in this step, of each free velocity and of its coordinate.
    pub(in crate::methods) allowed: Vec<[f64; 2]>,
    /// What rounding makes of each free velocity in this step.
    pub(in crate::methods) noise: Vec<f64>,
}

impl Errors {
    pub(in crate::methods) fn new(tolerance: Tolerance, sizes: Sizes) -> Self {
        Self { tolerance, sizes, energy: 0.0, sized: Vec::new(), allowed: Vec::new(), noise: Vec::new() }
    }

    /// Whether a velocity has no size that its error could be measured by.
    pub(in crate::methods) fn finds_nothing_moving(&self) -> bool {
        self.sized.iter().any(|[speed, _]| *speed == 0.0)
    }

    /// What the errors of velocities and coordinates may be in a step of size `h` from the origin under a `tolerance`, in the order of the free
    /// velocities. Of one that no force moved yet `own` says how fast this very step makes it.
    pub(in crate::methods) fn allow(
        &mut self,
        cx: Context,
        equations: &mut Equations,
        (origin, h): (&Origin, f64),
        tolerance: Tolerance,
        own: impl Fn(usize) -> f64,
    ) {
        self.size_up(cx, equations, (origin, h), own);
        let (model, Self { sized, allowed, noise, .. }) = (&cx.system.model, self);
        let rounded = equations.round(cx, origin.node(), h, |r| tolerance.of(sized[r][0]));
        noise.clear();
        noise.extend(rounded.iter().map(|a| h * a));
        allowed.clear();
        for ((&k, [speed, travel]), noise) in equations.free().iter().zip(&*sized).zip(&*noise) {
            let place = model.coordinate_of(k).map_or(1.0, |c| origin.q[c]);
            let rounding = 4.0 * f64::EPSILON * place.abs();
            let of_velocity = (tolerance.of(*speed) + noise).max(f64::MIN_POSITIVE);
            allowed.push([of_velocity, (tolerance.of(*travel) + rounding + h * noise).max(f64::MIN_POSITIVE)]);
        }
    }

    /// How fast and how far each free velocity moves until the end of a step of size `h`.
    fn size_up(&mut self, cx: Context, equations: &Equations, (origin, h): (&Origin, f64), own: impl Fn(usize) -> f64) {
        let (n, mass_matrix) = (cx.system.model.nv(), &equations.slopes().d_a);
        let Self { sizes, energy, sized, .. } = self;
        let until = origin.t + h;
        sized.clear();
        for &k in equations.free() {
            let mass = mass_matrix[k * n + k];
            let of_energy = if mass > 0.0 { ENERGY_FLOOR * (2.0 * *energy / mass).sqrt() } else { 0.0 };
            // Memories of errors begin as steeply as no step resolves: they are measured by what is still missing.
            let [mut missing, mut slip] = equations.missing(k, mass);
            // Joints that nothing drives are moved by those that are.
            for (own, [far, fast]) in equations.going() {
                let share = (mass_matrix[k * n + own] / mass).abs();
                if share.is_finite() {
                    (missing, slip) = (missing.max(share * far), slip.max(share * fast));
                }
            }
            let speed = sizes.speed(k, until).max(origin.v[k].abs()).max(of_energy).max(slip);
            // A joint that no force moved yet is measured by what this very step does.
            let speed = if speed > 0.0 { speed } else { own(k) };
            // What a stop takes up is little beside the flights between: there an error of the place is one of the energy.
            let square = equations.stiffness_of_stops(cx, k) / mass;
            let taken_up = if square > 0.0 { speed / square.sqrt() } else { f64::INFINITY };
            sized.push([speed, sizes.travel(k, until).min(taken_up).max(h * speed).max(missing)]);
        }
    }
}
