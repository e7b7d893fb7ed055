//! The first moment and the first step.

use super::stepper::{Origin, Tolerance, add_resistance, force_at};
use crate::dynamics::{Kinematics, PairForce, crba, rnea};
use crate::element::Element;
use crate::law::Point;
use crate::motion::{Drive, Forward};
use crate::simulate::lu::Lu;
use crate::simulate::{RunError, System};

/// One element where a motion starts.
pub(super) struct ElementStart {
    stroke: f64,
    /// x(0) where it counts as different from 0, else 0, m.
    pub(super) jump: f64,
    gradient: Vec<f64>,
}

/// The start: prescribed joints where their signals say, and accelerations.
pub(super) fn origin(system: &System, forward: &Forward) -> Result<(Origin, Vec<ElementStart>), RunError> {
    let model = &system.model;
    let mut origin = Origin {
        t: 0.0,
        q: forward.q.clone(),
        v: forward.v.clone(),
        a: vec![0.0; model.nv()],
        forces: vec![0.0; system.elements.len()],
    };
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        if matches!(drive, Drive::Locked) {
            origin.v[model.v_range(j)].fill(0.0);
        }
    }
    let elements = accelerate(system, forward, &mut origin, |element, point| {
        element.law.start_derivative(point, element.derivative)
    })?;
    Ok((origin, elements))
}

/// Accelerations and forces of the elements at the origin's time, whatever came before: from M a = τ − nle − Σ g F with the
/// `derivative` of each, without the share of a singular start.
pub(super) fn accelerate(
    system: &System,
    forward: &Forward,
    origin: &mut Origin,
    derivative: impl Fn(&Element, &Point) -> f64,
) -> Result<Vec<ElementStart>, RunError> {
    let model = &system.model;
    let Origin { t, q, v, a, forces } = origin;
    let t = *t;
    a.fill(0.0);
    let mut free = Vec::new();
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        let (q, v, a) = (&mut q[model.q_range(j)], &mut v[model.v_range(j)], &mut a[model.v_range(j)]);
        match drive {
            Drive::Force(_) => free.extend(model.v_range(j)),
            Drive::Prescribed(path) => path.at(t, q, v, a),
            Drive::Locked => {}
        }
    }
    let kinematics = Kinematics::at_velocity(model, q, v);
    let (mut elements, mut pairs) = (Vec::new(), Vec::new());
    for (element, known) in system.elements.iter().zip(forces) {
        let (pair, gradient) = crate::dynamics::pair(model, &kinematics, &element.from, &element.to);
        if pair.check().is_err() {
            return Err(RunError::ZeroLength { t, element: element.name.clone(), length: pair.length });
        }
        let mut inputs = vec![Default::default(); element.inputs.len()];
        element.inputs_at(t, &mut inputs);
        element.check_inputs(t, &inputs)?;
        let stroke = pair.length - element.rest_length;
        let point = Point { t, stroke, rate: pair.rate, inputs: &inputs };
        let force = element.law.force(&point, derivative(element, &point));
        pairs.push(PairForce { from: element.from, to: element.to, force, d_length: 0.0, d_rate: 0.0 });
        *known = force;
        elements.push(ElementStart { stroke, jump: element.jump(pair.length), gradient });
    }
    let mut residual = rnea(model, q, v, a, &pairs);
    add_resistance(model, v, &mut residual);
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        if let Drive::Force(signals) = drive {
            for (k, signal) in model.v_range(j).zip(signals) {
                residual[k] -= force_at(model, j, signal, t)?;
            }
        }
    }
    let mut change: Vec<f64> = free.iter().map(|&k| -residual[k]).collect();
    solve_mass(system, &kinematics, &free, &mut change);
    for (&k, change) in free.iter().zip(change) {
        a[k] += change;
    }
    Ok(elements)
}

/// x ← M⁻¹ x over the free velocities.
fn solve_mass(system: &System, kinematics: &Kinematics, free: &[usize], x: &mut [f64]) {
    let (mass, n, count) = (crba(&system.model, kinematics), system.model.nv(), free.len());
    let mut lu = Lu::default();
    if count > 0
        && lu.factor(count, |m| (0..count * count).for_each(|k| m[k] = mass[free[k / count] * n + free[k % count]]))
    {
        lu.solve(x);
    }
}

/// The largest power-of-two share of a second whose step keeps the layer at t = 0 within the tolerance of the velocities:
/// h max_i |(M⁻¹ g)_i|/tol_i |F(h) − F(0)| ≤ 1 with F(h) − F(0) ≈ c h^−alpha |x(h) − x(0)|, and no longer than
/// (1/max(|v|/tol, |a|/tol))^¼.
pub(super) fn first_step(
    system: &System,
    origin: &Origin,
    elements: &[ElementStart],
    tolerance: Tolerance,
    end: f64,
) -> f64 {
    let model = &system.model;
    let kinematics = Kinematics::at_velocity(model, &origin.q, &origin.v);
    let all: Vec<usize> = (0..model.nv()).collect();
    let fastest = all.iter().fold(0.0, |m: f64, &k| {
        let (v, a) = (origin.v[k].abs(), origin.a[k].abs());
        m.max(v / tolerance.of(if model.is_one_degree() { origin.q[k] } else { 1.0 })).max(a / tolerance.of(v))
    });
    let mut h = end.min(0.1);
    if fastest > 0.0 {
        h = h.min((1.0 / fastest).powf(0.25));
    }
    for (element, start) in system.elements.iter().zip(elements) {
        let order = element.law.order();
        if !(order > 0.0 && order < 1.0) {
            continue;
        }
        let mut inputs = vec![Default::default(); element.inputs.len()];
        element.inputs_at(0.0, &mut inputs);
        let point = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: &inputs };
        let coefficient = element.law.force(&point, 1.0) - element.law.force(&point, 0.0);
        let mut push = start.gradient.clone();
        solve_mass(system, &kinematics, &all, &mut push);
        let reach =
            push.iter().zip(&origin.v).map(|(p, v)| p.abs() / tolerance.of(*v)).fold(0.0, f64::max) * coefficient.abs();
        // x(h) − x(0) to second order, from the motion at the start.
        let slope: f64 = start.gradient.iter().zip(&origin.v).map(|(g, v)| g * v).sum();
        let bend: f64 = start.gradient.iter().zip(&origin.a).map(|(g, a)| g * a).sum();
        for _ in 0..200 {
            let travel = (h * slope).abs() + (0.5 * h * h * bend).abs();
            if h * reach * h.powf(-order) * travel <= 1.0 {
                break;
            }
            h *= 0.5;
        }
    }
    h
}
