//! What forces come to that only begin: a motion that starts as a power of t has no size of its own yet.

use super::step::RadauStep;
use crate::actuation::Drive;
use crate::elements::{ElementBank, Forces};
use crate::equations::context::Context;
use crate::equations::control::ControlRun;
use crate::equations::drives::{force_at, take_path};
use crate::law::{InputValue, Point};
use crate::linalg::Lu;
use crate::system::error::RunError;

/// How far a joint may turn while a robot is thought to go on as it begins, rad.
const TURN: f64 = 0.3;

/// Share of the largest acceleration that rounding may make of none.
const ROUNDED: f64 = 1e-12;

/// How often the stretch that is looked at is brought nearer to the time in which the system answers what comes.
const MOST_LOOKS: usize = 12;

/// Where in the stretch ahead forces are looked at.
const PLACES: [f64; 5] = [0.01, 0.09, 0.31, 0.66, 1.0];

impl RadauStep {
    /// The accelerations that come within `stretch` seconds at most, and the time in which the system answers them, s, which no look goes beyond.
    ///
    /// # Errors
    /// Where what drives the robot is not finite.
    pub(super) fn foresee(
        &self,
        cx: Context,
        bank: &ElementBank,
        control: Option<&ControlRun>,
        mut stretch: f64,
    ) -> Result<(Vec<f64>, f64), RunError> {
        let mut ahead = self.look_ahead(cx, bank, control, stretch)?;
        for _ in 0..MOST_LOOKS {
            let answer = self.answering_rate(cx, bank, &ahead, 0.0).recip();
            if answer >= 0.5 * stretch {
                break;
            }
            stretch = answer;
            ahead = self.look_ahead(cx, bank, control, stretch)?;
        }
        Ok((ahead.into_iter().map(f64::abs).collect(), stretch))
    }

    /// By how much the accelerations of all velocities change most within `stretch` seconds from the origin, m/s² or rad/s², were the robot to
    /// stay where it is: M Δa = Δτ − Σ g ΔF − M_fp Δa_p, where torques, inputs and prescribed joints go on.
    ///
    /// # Errors
    /// Where what drives the robot is not finite.
    fn look_ahead(
        &self,
        cx: Context,
        bank: &ElementBank,
        control: Option<&ControlRun>,
        stretch: f64,
    ) -> Result<Vec<f64>, RunError> {
        let (n, free) = (self.model.nv(), &self.free);
        let mut largest = vec![0.0; n];
        let mut mass = Lu::default();
        let (varies, rests) = (cx.system.varies(), self.rests());
        if !(varies || rests) || free.is_empty() || !mass.factor_part(n, &self.slopes.d_a, free) {
            return Ok(largest);
        }
        if rests {
            self.accelerate(&mut mass, &self.drift(cx, bank), &mut largest);
        }
        if !varies {
            self.spread(cx, bank, &mut mass, stretch, &mut largest);
            return Ok(largest);
        }
        let t = self.origin.t;
        let now = self.drive_at(cx, bank, control, t)?;
        for place in PLACES {
            let then = self.drive_at(cx, bank, control, t + place * stretch)?;
            let mut change: Vec<f64> = then.forces.iter().zip(&now.forces).map(|(then, now)| then - now).collect();
            for (e, element) in self.elements.iter().enumerate() {
                // What prescribed joints stretch until then is answered as fast as that.
                let stroke: f64 = element
                    .gradient
                    .iter()
                    .zip(then.places.iter().zip(&now.places))
                    .map(|(g, (a, b))| g * (a - b))
                    .sum();
                let stiffness = cx.system.elements[e].law.stiffness(&bank.point(e, 0), (place * stretch).recip());
                let pull = then.pulls[e] - now.pulls[e] + if stroke == 0.0 { 0.0 } else { stiffness * stroke };
                change.iter_mut().zip(&element.gradient).for_each(|(sum, g)| *sum -= g * pull);
            }
            for (k, sum) in change.iter_mut().enumerate() {
                let row = &self.slopes.d_a[k * n..][..n];
                let led = row.iter().zip(then.accelerations.iter().zip(&now.accelerations));
                *sum -= led.map(|(m, (then, now))| m * (then - now)).sum::<f64>();
            }
            self.accelerate(&mut mass, &change, &mut largest);
        }
        self.spread(cx, bank, &mut mass, stretch, &mut largest);
        Ok(largest)
    }

    /// Whether any free velocity has been 0 so far.
    pub(super) fn rests(&self) -> bool {
        self.free.iter().any(|&k| self.sizes.rests(k))
    }

    /// Takes in the accelerations that forces `change` on the free velocities lead to.
    fn accelerate(&self, mass: &mut Lu, change: &[f64], largest: &mut [f64]) {
        let mut x: Vec<f64> = self.free.iter().map(|&k| change[k]).collect();
        mass.solve(&mut x);
        for (&k, a) in self.free.iter().zip(x).filter(|(_, a)| a.is_finite()) {
            if a.abs() > largest[k].abs() {
                largest[k] = a;
            }
        }
    }

    /// What moves within `stretch` seconds takes others along that rest till then, one after another: through springs, inertia and feedback.
    fn spread(&self, cx: Context, bank: &ElementBank, mass: &mut Lu, stretch: f64, largest: &mut [f64]) {
        let (n, a, slopes) = (self.model.nv(), &self.origin.a, &self.slopes);
        for _ in &self.free {
            let unmoved = |k: usize| largest[k] == 0.0 && a[k] == 0.0 && self.sizes.rests(k);
            let unmoved: Vec<usize> = self.free.iter().copied().filter(|&k| unmoved(k)).collect();
            let speed: Vec<f64> = largest.iter().zip(a).map(|(ahead, a)| stretch * (ahead.abs() + a.abs())).collect();
            if unmoved.is_empty() || speed.iter().all(|speed| *speed == 0.0) {
                return;
            }
            let mut change: Vec<f64> = (0..n)
                .map(|k| {
                    let rows = slopes.d_q[k * n..][..n].iter().zip(&slopes.d_v[k * n..][..n]);
                    rows.zip(&speed).map(|((by_q, by_v), speed)| -(0.5 * stretch * by_q + by_v) * speed).sum()
                })
                .collect();
            for (e, element) in self.elements.iter().enumerate() {
                let rate: f64 = element.gradient.iter().zip(&speed).map(|(g, speed)| g * speed).sum();
                if rate != 0.0 {
                    let stiffness = cx.system.elements[e].law.stiffness(&bank.point(e, 0), stretch.recip());
                    let pull = stiffness * 0.5 * stretch * rate;
                    change.iter_mut().zip(&element.gradient).for_each(|(sum, g)| *sum -= g * pull);
                }
            }
            let mut taken = vec![0.0; n];
            self.accelerate(mass, &change, &mut taken);
            let least = ROUNDED * taken.iter().fold(0.0, |largest: f64, a| largest.max(a.abs()));
            let along: Vec<usize> = unmoved.into_iter().filter(|&k| taken[k].abs() > least).collect();
            if along.is_empty() {
                return;
            }
            along.into_iter().for_each(|k| largest[k] = taken[k]);
        }
    }

    /// By how much the forces on all velocities change while the robot goes on with the accelerations at the origin: what joints at rest are
    /// moved by that no force moves yet.
    fn drift(&self, cx: Context, bank: &ElementBank) -> Vec<f64> {
        let (model, origin) = (&self.model, &self.origin);
        let turning = model.turning(&origin.a).fold(0.0, |largest: f64, a| largest.max(a.abs()));
        let h = self.sizes.response().min((2.0 * TURN / turning).sqrt());
        let way: Vec<f64> = origin.v.iter().zip(&origin.a).map(|(v, a)| h * (v + 0.5 * h * a)).collect();
        let v: Vec<f64> = origin.v.iter().zip(&origin.a).map(|(v, a)| v + h * a).collect();
        let q = model.integrate(&origin.q, &way);
        let [now, then] = [[&origin.q, &origin.v], [&q, &v]]
            .map(|[q, v]| Forces::default().inverse_dynamics(model, [q, v, &origin.a]));
        let mut change: Vec<f64> = now.iter().zip(&then).map(|(now, then)| now - then).collect();
        for (e, element) in self.elements.iter().enumerate() {
            let stroke: f64 = element.gradient.iter().zip(&way).map(|(g, way)| g * way).sum();
            if stroke != 0.0 {
                let pull = cx.system.elements[e].law.stiffness(&bank.point(e, 0), h.recip()) * stroke;
                change.iter_mut().zip(&element.gradient).for_each(|(sum, g)| *sum -= g * pull);
            }
        }
        change
    }

    /// How fast the stroke of element `e` may be at the end of a step of size `h` by what was seen ahead, m/s or rad/s.
    pub(super) fn coming_rate(&self, e: usize, h: f64) -> f64 {
        let until = self.origin.t + h;
        self.elements[e].gradient.iter().enumerate().map(|(k, g)| g.abs() * self.sizes.coming(k, until)).sum()
    }

    /// What drives the robot at `t`, which stays where it is but for its prescribed joints.
    fn drive_at(
        &self,
        cx: Context,
        bank: &ElementBank,
        control: Option<&ControlRun>,
        t: f64,
    ) -> Result<Driven, RunError> {
        let model = &self.model;
        let (mut forces, mut accelerations) = (vec![0.0; model.nv()], vec![0.0; model.nv()]);
        let (mut q, mut v) = (self.origin.q.clone(), self.origin.v.clone());
        for (j, drive) in model.own_joints().zip(&self.forward.drives) {
            match drive {
                Drive::Force(signals) => {
                    for (k, signal) in model.v_range(j).zip(signals) {
                        forces[k] = force_at(cx, k, signal, t)?;
                    }
                }
                Drive::Prescribed(path) => take_path(model, j, path, t, &mut q, &mut v, &mut accelerations)?,
                Drive::Locked => {}
            }
        }
        let mut inputs: Vec<Vec<InputValue>> = Vec::with_capacity(cx.system.elements.len());
        for (e, element) in cx.system.elements.iter().enumerate() {
            let mut own = vec![InputValue::default(); element.inputs.len()];
            cx.inputs_at(e, t, &mut own);
            inputs.push(own);
        }
        if let Some(control) = control {
            control.expressions_at(cx, t, &mut forces, &mut inputs);
        }
        let pulls = cx.system.elements.iter().enumerate().map(|(e, element)| {
            // What takes no input pulls as before.
            if element.inputs.is_empty() {
                return 0.0;
            }
            let point = Point { inputs: &inputs[e], ..bank.point(e, 0) };
            bank.now(e, &point).map_or(0.0, |now| now.finite_force())
        });
        let pulls = pulls.map(|pull| if pull.is_finite() { pull } else { 0.0 }).collect();
        Ok(Driven { forces, accelerations, places: model.difference(&self.origin.q, &q), pulls })
    }
}

/// What drives a robot at one time.
struct Driven {
    /// Torques and forces of the actuators (nv).
    forces: Vec<f64>,
    /// Of prescribed joints (nv).
    accelerations: Vec<f64>,
    /// How far prescribed joints are from the origin (nv).
    places: Vec<f64>,
    /// Forces of the elements that have inputs, N.
    pulls: Vec<f64>,
}
