//! What forces come to that only begin: a motion that starts as a power of t has no size of its own yet.

use super::assembly::Equations;
use super::context::Context;
use super::drives::force_at;
use super::node::Node;
use super::solve::Solve;
use crate::elements::Forces;
use crate::law::{InputValue, Point};
use crate::system::error::RunError;

/// How far a joint may turn while a robot is thought to go on as it begins, rad.
const TURN: f64 = 0.3;

/// Share of the largest acceleration that rounding may make of none.
const ROUNDED: f64 = 1e-12;

/// How often the stretch that is looked at is brought nearer to the time in which the system answers what comes.
const MOST_LOOKS: usize = 12;

/// Where in the stretch ahead forces are looked at.
const PLACES: [f64; 5] = [0.01, 0.09, 0.31, 0.66, 1.0];

/// Where a motion is looked ahead from.
#[derive(Clone, Copy)]
pub(crate) struct Outlook<'a> {
    pub(crate) at: Node<'a>,
    /// Whether a velocity has been 0 so far.
    pub(crate) rests: &'a dyn Fn(usize) -> bool,
    /// The time in which the system answers the accelerations there, s.
    pub(crate) response: f64,
}

impl Equations {
    /// The rate ω at which the system answers accelerations `a` from where it is, rad/s: the Rayleigh quotient of stiffness and mass along
    /// them, with ω² aᵀMa = |aᵀKa| + Σ (k + c ω^α)(g·a)². Not below `slowest` and |a|/|v|, by the mass matrix, where the velocities are `v`.
    pub(crate) fn answering_rate(&self, cx: Context, v: &[f64], a: &[f64], slowest: f64) -> f64 {
        let (n, slopes) = (cx.system.model.nv(), self.slopes());
        let along = |matrix: &[f64], x: &[f64]| -> f64 {
            let rows =
                self.free.iter().map(|&r| x[r] * self.free.iter().map(|&c| matrix[r * n + c] * x[c]).sum::<f64>());
            rows.sum()
        };
        let (mass, rigid) = (along(&slopes.d_a, a), along(&slopes.d_q, a).abs());
        let moving = along(&slopes.d_a, v);
        // What moves already is answered as fast as its velocities change.
        let slowest = if moving > 0.0 { slowest.max((mass / moving).sqrt()) } else { slowest };
        if !(mass > 0.0 && mass.is_finite() && rigid.is_finite()) {
            return slowest;
        }
        let squares: Vec<f64> = self
            .elements
            .iter()
            .map(|nodes| self.free.iter().map(|&k| nodes.gradient[k] * a[k]).sum::<f64>().powi(2))
            .collect();
        let mut omega = slowest.max((rigid / mass).sqrt());
        for _ in 0..30 {
            let each = squares.iter().enumerate();
            let stiffness: f64 = each.map(|(e, square)| self.stiffness(cx, e, omega) * square).sum();
            let next = slowest.max(((rigid + stiffness) / mass).sqrt());
            if (next - omega).abs() <= 0.1 * omega {
                return next;
            }
            omega = next;
        }
        omega
    }

    /// How stiff element `e` is at the start to what changes at the rate `omega`, rad/s: N/m or N·m/rad.
    pub(crate) fn stiffness(&self, cx: Context, e: usize, omega: f64) -> f64 {
        cx.system.elements[e].law.stiffness(&self.bank.point(e, 0), omega)
    }

    /// The accelerations that come within `stretch` seconds at most, and the time in which the system answers them, s, which no look goes beyond.
    ///
    /// # Errors
    /// Where what drives the robot is not finite.
    pub(crate) fn foresee(&self, cx: Context, from: Outlook, mut stretch: f64) -> Result<(Vec<f64>, f64), RunError> {
        let mut ahead = self.look_ahead(cx, from, stretch)?;
        for _ in 0..MOST_LOOKS {
            let answer = self.answering_rate(cx, from.at.v, &ahead, 0.0).recip();
            if answer >= 0.5 * stretch {
                break;
            }
            stretch = answer;
            ahead = self.look_ahead(cx, from, stretch)?;
        }
        Ok((ahead.into_iter().map(f64::abs).collect(), stretch))
    }

    /// By how much the accelerations of all velocities change most within `stretch` seconds, m/s² or rad/s², were the robot to
    /// stay where it is: M Δa = Δτ − Σ g ΔF − M_fp Δa_p, where torques, inputs and prescribed joints go on.
    fn look_ahead(&self, cx: Context, from: Outlook, stretch: f64) -> Result<Vec<f64>, RunError> {
        let (n, free, slopes) = (cx.system.model.nv(), &self.free, self.slopes());
        let mut largest = vec![0.0; n];
        let mut mass = Solve::default();
        let (varies, rests) = (cx.system.varies(), free.iter().any(|&k| (from.rests)(k)));
        if !(varies || rests) || free.is_empty() || !mass.factor_part(&slopes.d_a, n, free) {
            return Ok(largest);
        }
        if rests {
            self.accelerate_by(&mut mass, &self.drift(cx, from), &mut largest);
        }
        if !varies {
            self.spread(cx, from, &mut mass, stretch, &mut largest);
            return Ok(largest);
        }
        let t = from.at.t;
        let now = self.driven_at(cx, from.at, t)?;
        for place in PLACES {
            let then = self.driven_at(cx, from.at, t + place * stretch)?;
            let mut change: Vec<f64> = then.forces.iter().zip(&now.forces).map(|(then, now)| then - now).collect();
            for (e, nodes) in self.elements.iter().enumerate() {
                // What prescribed joints stretch until then is answered as fast as that.
                let way = then.places.iter().zip(&now.places).map(|(a, b)| a - b);
                let stroke: f64 = nodes.gradient.iter().zip(way).map(|(g, way)| g * way).sum();
                let stiffness = self.stiffness(cx, e, (place * stretch).recip());
                let pull = then.pulls[e] - now.pulls[e] + if stroke == 0.0 { 0.0 } else { stiffness * stroke };
                change.iter_mut().zip(&nodes.gradient).for_each(|(sum, g)| *sum -= g * pull);
            }
            for (k, sum) in change.iter_mut().enumerate() {
                let row = &slopes.d_a[k * n..][..n];
                let led = row.iter().zip(then.accelerations.iter().zip(&now.accelerations));
                *sum -= led.map(|(m, (then, now))| m * (then - now)).sum::<f64>();
            }
            self.accelerate_by(&mut mass, &change, &mut largest);
        }
        self.spread(cx, from, &mut mass, stretch, &mut largest);
        Ok(largest)
    }

    /// Takes in the accelerations that forces `change` on the free velocities lead to.
    fn accelerate_by(&self, mass: &mut Solve, change: &[f64], largest: &mut [f64]) {
        let mut x: Vec<f64> = self.free.iter().map(|&k| change[k]).collect();
        mass.solve(&mut x);
        for (&k, a) in self.free.iter().zip(x).filter(|(_, a)| a.is_finite()) {
            if a.abs() > largest[k].abs() {
                largest[k] = a;
            }
        }
    }

    /// What moves within `stretch` seconds takes others along that rest till then, one after another: through springs, inertia and feedback.
    fn spread(&self, cx: Context, from: Outlook, mass: &mut Solve, stretch: f64, largest: &mut [f64]) {
        let (n, a, slopes) = (cx.system.model.nv(), from.at.a, self.slopes());
        for _ in &self.free {
            let unmoved = |k: usize| largest[k] == 0.0 && a[k] == 0.0 && (from.rests)(k);
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
            for (e, nodes) in self.elements.iter().enumerate() {
                let rate = nodes.travel(&speed);
                if rate != 0.0 {
                    let pull = self.stiffness(cx, e, stretch.recip()) * 0.5 * stretch * rate;
                    change.iter_mut().zip(&nodes.gradient).for_each(|(sum, g)| *sum -= g * pull);
                }
            }
            let mut taken = vec![0.0; n];
            self.accelerate_by(mass, &change, &mut taken);
            let least = ROUNDED * taken.iter().fold(0.0, |largest: f64, a| largest.max(a.abs()));
            let along: Vec<usize> = unmoved.into_iter().filter(|&k| taken[k].abs() > least).collect();
            if along.is_empty() {
                return;
            }
            along.into_iter().for_each(|k| largest[k] = taken[k]);
        }
    }

    /// By how much the forces on all velocities change while the robot goes on with its accelerations: what joints at rest are
    /// moved by that no force moves yet.
    fn drift(&self, cx: Context, Outlook { at, response, .. }: Outlook) -> Vec<f64> {
        let model = &cx.system.model;
        let turning = model.turning(at.a).fold(0.0, |largest: f64, a| largest.max(a.abs()));
        let h = response.min((2.0 * TURN / turning).sqrt());
        let way: Vec<f64> = at.v.iter().zip(at.a).map(|(v, a)| h * (v + 0.5 * h * a)).collect();
        let v: Vec<f64> = at.v.iter().zip(at.a).map(|(v, a)| v + h * a).collect();
        let q = model.integrate(at.q, &way);
        let [now, then] =
            [[at.q, at.v], [&q, &v]].map(|[q, v]| Forces::default().inverse_dynamics(model, [q, v, at.a]));
        let mut change: Vec<f64> = now.iter().zip(&then).map(|(now, then)| now - then).collect();
        for (e, nodes) in self.elements.iter().enumerate() {
            let stroke = nodes.travel(&way);
            if stroke != 0.0 {
                let pull = self.stiffness(cx, e, h.recip()) * stroke;
                change.iter_mut().zip(&nodes.gradient).for_each(|(sum, g)| *sum -= g * pull);
            }
        }
        change
    }

    /// What drives the robot at `t`, which stays where it is but for its prescribed joints.
    fn driven_at(&self, cx: Context, at: Node, t: f64) -> Result<Driven, RunError> {
        let model = &cx.system.model;
        let (mut forces, mut accelerations) = (vec![0.0; model.nv()], vec![0.0; model.nv()]);
        let (mut q, mut v) = (at.q.to_vec(), at.v.to_vec());
        for (k, signal) in self.forward.forces(model) {
            forces[k] = force_at(cx, k, signal, t)?;
        }
        self.forward.take_paths(model, t, &mut q, &mut v, &mut accelerations)?;
        let mut inputs: Vec<Vec<InputValue>> = Vec::with_capacity(cx.system.elements.len());
        for (e, element) in cx.system.elements.iter().enumerate() {
            let mut own = vec![InputValue::default(); element.inputs.len()];
            cx.inputs_at(e, t, &mut own);
            inputs.push(own);
        }
        if let Some(control) = &self.control {
            control.expressions_at(cx, t, &mut forces, &mut inputs);
        }
        let pulls = cx.system.elements.iter().enumerate().map(|(e, element)| {
            // What takes no input pulls as before.
            if element.inputs.is_empty() {
                return 0.0;
            }
            let point = Point { inputs: &inputs[e], ..self.bank.point(e, 0) };
            self.bank.now(e, &point).map_or(0.0, |now| now.finite_force())
        });
        let pulls = pulls.map(|pull| if pull.is_finite() { pull } else { 0.0 }).collect();
        Ok(Driven { forces, accelerations, places: model.difference(at.q, &q), pulls })
    }
}

/// What drives a robot at one time.
struct Driven {
    /// Torques and forces of the actuators (nv).
    forces: Vec<f64>,
    /// Of prescribed joints (nv).
    accelerations: Vec<f64>,
    /// How far prescribed joints are from where the robot is (nv).
    places: Vec<f64>,
    /// Forces of the elements that have inputs, N.
    pulls: Vec<f64>,
}
