//! What a step may err.

use super::step::RadauStep;
use crate::elements::ElementBank;
use crate::equations::context::Context;
use crate::equations::control::ControlRun;

/// Share of the speed that all the energy turned over would give a joint alone: slower joints are not looked at more closely.
const ENERGY_FLOOR: f64 = 1e-6;

impl RadauStep {
    /// What the errors of velocities and coordinates may be in a step of size `h`, in the order of the free velocities.
    pub(super) fn allow(&mut self, cx: Context, bank: &ElementBank, control: Option<&ControlRun>, h: f64) {
        self.size_up(cx, bank, control, h);
        let (tolerance, sized) = (self.tolerance, std::mem::take(&mut self.sized));
        self.round(cx, bank, control, h, |r| tolerance.of(sized[r][0]));
        self.allowed.clear();
        self.noise.clear();
        for (r, (&k, [speed, travel])) in self.free.iter().zip(&sized).enumerate() {
            let noise = h * self.rounding.accelerations[r];
            let place = self.model.coordinate_of(k).map_or(1.0, |c| self.origin.q[c]);
            let rounding = 4.0 * f64::EPSILON * place.abs();
            let allowed = (tolerance.of(*speed) + noise).max(f64::MIN_POSITIVE);
            self.noise.push(noise);
            self.allowed.push([allowed, (tolerance.of(*travel) + rounding + h * noise).max(f64::MIN_POSITIVE)]);
        }
        self.sized = sized;
    }

    /// What rounding of the accelerations does to the stroke of element `e` in a step of size `h`, m or rad.
    pub(super) fn stroke_noise(&self, e: usize, h: f64) -> f64 {
        let noise = self.free.iter().zip(&self.noise);
        noise.map(|(&k, noise)| self.elements[e].gradient[k].abs() * h * noise).sum()
    }

    /// How fast and how far each free velocity moves until the end of a step of size `h`.
    fn size_up(&mut self, cx: Context, bank: &ElementBank, control: Option<&ControlRun>, h: f64) {
        let (n, sizes) = (self.model.nv(), &self.sizes);
        let until = self.origin.t + h;
        self.sized.clear();
        for &k in &self.free {
            let mass = self.slopes.d_a[k * n + k];
            let of_energy = if mass > 0.0 { ENERGY_FLOOR * (2.0 * self.energy / mass).sqrt() } else { 0.0 };
            // Memories of errors begin as steeply as no step resolves: they are measured by what is still missing.
            let [mut missing, mut slip] = control.map_or([0.0; 2], |control| control.missing(k, mass));
            // Joints that nothing drives are moved by those that are.
            for (own, [far, fast]) in control.into_iter().flat_map(ControlRun::going) {
                let share = (self.slopes.d_a[k * n + own] / mass).abs();
                if share.is_finite() {
                    (missing, slip) = (missing.max(share * far), slip.max(share * fast));
                }
            }
            let speed = sizes.speed(k, until).max(self.origin.v[k].abs()).max(of_energy).max(slip);
            // A joint that no force moved yet is measured by what this very step does.
            let own = || self.stages.iter().fold(0.0, |largest: f64, stage| largest.max(h * stage.a[k].abs()));
            let speed = if speed > 0.0 { speed } else { own() };
            // What a stop takes up is little beside the flights between: there an error of the place is one of the energy.
            let stops = self.stops.iter().map(|&e| {
                let stiffness = cx.system.elements[e].law.stiffness(&bank.point(e, 0), 0.0);
                stiffness * self.elements[e].gradient[k].powi(2)
            });
            let square = stops.sum::<f64>() / mass;
            let taken_up = if square > 0.0 { speed / square.sqrt() } else { f64::INFINITY };
            self.sized.push([speed, sizes.travel(k, until).min(taken_up).max(h * speed).max(missing)]);
        }
    }

    /// The rate ω at which the system answers accelerations `a` from the origin, rad/s: the Rayleigh quotient of stiffness and mass along
    /// them, with ω² aᵀMa = |aᵀKa| + Σ (k + c ω^α)(g·a)². Not below `slowest` and |a|/|v|, by the mass matrix.
    pub(super) fn answering_rate(&self, cx: Context, bank: &ElementBank, a: &[f64], slowest: f64) -> f64 {
        let (n, slopes) = (self.model.nv(), &self.slopes);
        let along = |matrix: &[f64], x: &[f64]| -> f64 {
            let rows =
                self.free.iter().map(|&r| x[r] * self.free.iter().map(|&c| matrix[r * n + c] * x[c]).sum::<f64>());
            rows.sum()
        };
        let (mass, rigid) = (along(&slopes.d_a, a), along(&slopes.d_q, a).abs());
        let moving = along(&slopes.d_a, &self.origin.v);
        // What moves already is answered as fast as its velocities change.
        let slowest = if moving > 0.0 { slowest.max((mass / moving).sqrt()) } else { slowest };
        if !(mass > 0.0 && mass.is_finite() && rigid.is_finite()) {
            return slowest;
        }
        let squares: Vec<f64> = self
            .elements
            .iter()
            .map(|stage| self.free.iter().map(|&k| stage.gradient[k] * a[k]).sum::<f64>().powi(2))
            .collect();
        let mut omega = slowest.max((rigid / mass).sqrt());
        for _ in 0..30 {
            let each = cx.system.elements.iter().zip(&squares).enumerate();
            let stiffness: f64 =
                each.map(|(e, (element, square))| element.law.stiffness(&bank.point(e, 0), omega) * square).sum();
            let next = slowest.max(((rigid + stiffness) / mass).sqrt());
            if (next - omega).abs() <= 0.1 * omega {
                return next;
            }
            omega = next;
        }
        omega
    }

    /// Expects what the accelerations at the origin begin.
    pub(super) fn expect(&mut self, cx: Context, bank: &ElementBank, slowest: f64) {
        let omega = self.answering_rate(cx, bank, &self.origin.a, slowest);
        self.sizes.expect(self.origin.t, &self.origin.a, omega, self.is_singular);
    }
}

/// Of a singular start with the stroke `jump`, how far it moves each velocity: |jump|·|g_k|/g·g.
pub(super) fn jump_travel(jump: f64, gradient: &[f64], k: usize) -> f64 {
    let square: f64 = gradient.iter().map(|g| g * g).sum();
    if square > 0.0 { jump.abs() * gradient[k].abs() / square } else { 0.0 }
}
