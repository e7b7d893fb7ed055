//! The first evaluation and the first step.

use super::scale::jump_travel;
use super::sizes::Tolerance;
use super::step::{Origin, RadauStep};
use super::stick::Stick;
use crate::actuation::{Drive, Forward};
use crate::dynamics::{Kinematics, crba};
use crate::elements::{ElementBank, Forces, Pull};
use crate::equations::context::Context;
use crate::equations::control::{ControlRun, Eye};
use crate::equations::drives::{finite, force_at, take_path};
use crate::equations::evaluate::Evaluation;
use crate::equations::resistance::add_smooth_resistance;
use crate::law::{Derivative, InputValue, Point, State, Term};
use crate::linalg::Lu;
use crate::system::error::RunError;
use crate::system::jump::refuse_jumps;
use crate::system::settings::Settings;

/// When the force of a singular start is looked at, s.
const SOON: f64 = 1e-12;

/// One element where a motion starts.
pub(super) struct ElementStart {
    stroke: f64,
    /// x(0) where it counts as different from 0, else 0, m or rad.
    pub(super) jump: f64,
    gradient: Vec<f64>,
}

/// The start: prescribed joints where their signals say, and accelerations.
pub(super) fn origin(
    cx: Context,
    forward: &Forward,
    stick: &mut Stick,
    mut control: Option<&mut ControlRun>,
) -> Result<(Origin, Vec<ElementStart>), RunError> {
    let (system, model) = (cx.system, &cx.system.model);
    let mut origin = Origin::new(system, forward);
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        if matches!(drive, Drive::Locked) {
            origin.v[model.v_range(j)].fill(0.0);
        }
    }
    decide(cx, forward, stick, &mut origin, control.as_deref_mut(), |e, point, coordinate| {
        let (element, law) = (&system.elements[e], begin(cx, e, point, coordinate)?);
        let mut force = element.law.now(point, &law).regular;
        // Infinite at t = 0: as it is soon after.
        let mut add = |term: Term| force += term.coefficient * SOON.powf(-term.order);
        element.law.for_each_singularity(point.inputs, &law, &mut add);
        Ok(force)
    })?;
    let elements = accelerate(cx, forward, stick, &mut origin, control, |e, point, coordinate| {
        Ok(system.elements[e].law.now(point, &begin(cx, e, point, coordinate)?).regular)
    })?;
    Ok((origin, elements))
}

/// What jumps at t = 0 do at once, of each element ([`crate::law::past::jolt`]).
///
/// # Errors
/// Where a memory cannot be.
pub(super) fn jolts(
    cx: Context,
    evaluation: &Evaluation,
    settings: &Settings,
) -> Result<Vec<Option<(State, f64)>>, RunError> {
    let elements = cx.system.elements.iter().zip(&evaluation.elements);
    let jolts = elements.map(|(element, at)| {
        let start = element.start(at.reading.coordinate, &at.inputs);
        let jolt = element.jolt(&start, settings.memory_rtol, settings.end);
        jolt.map_err(RunError::of_kernel(&element.name))
    });
    jolts.collect()
}

/// Goes from t = 0 to soon after, where `jolts` have pushed the free velocities.
pub(super) fn kick(
    cx: Context,
    elements: &[ElementStart],
    jolts: &[Option<(State, f64)>],
    free: &[usize],
    origin: &mut Origin,
) {
    let kinematics = Kinematics::at_velocity(&cx.system.model, &origin.q, &origin.v);
    let push = |gradient: &[f64], size: f64, pushed: &mut [f64]| {
        let mut share: Vec<f64> = free.iter().map(|&k| -gradient[k] * size).collect();
        solve_mass(cx, &kinematics, free, &mut share);
        free.iter().zip(share).for_each(|(&k, share)| pushed[k] += share);
    };
    let jolted = || elements.iter().zip(jolts).enumerate().filter_map(|(e, (at, jolt))| Some((e, at, jolt.as_ref()?)));
    for (_, element, (_, impulse)) in jolted() {
        push(&element.gradient, *impulse, &mut origin.v);
    }
    for (e, element, (state, _)) in jolted() {
        let mut inputs = vec![InputValue::default(); cx.system.elements[e].inputs.len()];
        cx.inputs_at(e, 0.0, &mut inputs);
        let rate = element.gradient.iter().zip(&origin.v).map(|(g, v)| g * v).sum();
        let point = Point { t: 0.0, stroke: element.stroke, rate, inputs: &inputs };
        let force = cx.system.elements[e].law.now(&point, state).force();
        push(&element.gradient, force - origin.forces[e], &mut origin.a);
        origin.forces[e] = force;
    }
}

/// The state of a law at t = 0, before its first step is chosen.
fn begin(cx: Context, e: usize, point: &Point, coordinate: f64) -> Result<State, RunError> {
    let element = &cx.system.elements[e];
    let begun = element.begin(coordinate, point.inputs);
    begun.map_err(RunError::of_kernel(&element.name))
}

/// Decides which joints friction holds at the origin, with the whole `force` of each element, which is told its
/// coordinate.
///
/// # Errors
/// [`RunError::NoHold`].
pub(super) fn decide(
    cx: Context,
    forward: &Forward,
    stick: &mut Stick,
    origin: &mut Origin,
    control: Option<&mut ControlRun>,
    force: impl Fn(usize, &Point, f64) -> Result<f64, RunError>,
) -> Result<(), RunError> {
    if stick.rubbing().next().is_none() {
        return Ok(());
    }
    let model = &cx.system.model;
    let Balance { kinematics, elements, residual, drives, .. } = balance(cx, forward, origin, control, force)?;
    let sizes: Vec<f64> = (0..model.nv())
        .map(|k| {
            let pull = elements.iter().zip(&origin.forces).map(|(element, force)| (element.gradient[k] * force).abs());
            residual[k].abs() + drives[k].abs() + pull.sum::<f64>()
        })
        .collect();
    let outcome = stick.decide(&origin.v, &residual, &sizes, &crba(model, &kinematics));
    outcome.map_err(|k| RunError::NoHold { t: origin.t, joint: model.v_labels()[k].name.clone() })
}

/// Accelerations and forces of the elements at the origin's time, whatever came before: from M a = τ − nle − Σ g F with the
/// `force` of each, which is told its coordinate, without the share of a singular start.
pub(super) fn accelerate(
    cx: Context,
    forward: &Forward,
    stick: &Stick,
    origin: &mut Origin,
    control: Option<&mut ControlRun>,
    force: impl Fn(usize, &Point, f64) -> Result<f64, RunError>,
) -> Result<Vec<ElementStart>, RunError> {
    let Balance { kinematics, elements, mut residual, .. } = balance(cx, forward, origin, control, force)?;
    stick.add_sliding(&mut residual);
    let free = stick.free();
    let mut change: Vec<f64> = free.iter().map(|&k| -residual[k]).collect();
    solve_mass(cx, &kinematics, &free, &mut change);
    for (&k, change) in free.iter().zip(change) {
        origin.a[k] += change;
    }
    Ok(elements)
}

/// What the accelerations of prescribed joints alone leave over in the equations of motion.
struct Balance {
    kinematics: Kinematics,
    elements: Vec<ElementStart>,
    /// nle + M a + Σ g F − τ without the friction that sticks (nv).
    residual: Vec<f64>,
    /// τ (nv).
    drives: Vec<f64>,
}

/// Accelerations of prescribed joints and forces of the elements at the origin's time, and what they leave over.
fn balance(
    cx: Context,
    forward: &Forward,
    origin: &mut Origin,
    mut control: Option<&mut ControlRun>,
    force: impl Fn(usize, &Point, f64) -> Result<f64, RunError>,
) -> Result<Balance, RunError> {
    let (system, model) = (cx.system, &cx.system.model);
    let Origin { t, q, v, a, forces } = origin;
    let t = *t;
    a.fill(0.0);
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        if let Drive::Prescribed(path) = drive {
            take_path(model, j, path, t, q, v, a)?;
        }
    }
    let kinematics = Kinematics::at_velocity(model, q, v);
    let readings: Vec<_> = system.elements.iter().map(|element| element.measure.read(model, &kinematics)).collect();
    for (element, (reading, _)) in system.elements.iter().zip(&readings) {
        element.check_direction(t, reading)?;
    }
    let inputs = |e: usize, control: Option<&ControlRun>| -> Result<Vec<InputValue>, RunError> {
        let element = &system.elements[e];
        let mut inputs = vec![InputValue::default(); element.inputs.len()];
        cx.inputs_at(e, t, &mut inputs);
        if let Some(control) = control {
            control.inputs_at_start(cx, e, &mut inputs);
        }
        element.check_inputs(t, &inputs).map(|()| inputs)
    };
    if let Some(control) = control.as_deref_mut() {
        let read = |e: usize| [readings[e].0.coordinate, readings[e].0.rate];
        control.find_branches(&Eye { system, t, q, v, kinematics: &kinematics, element: &read }, &mut |own, sum| {
            for (e, (reading, gradient)) in readings.iter().enumerate() {
                let stroke = system.elements[e].stroke(reading.coordinate);
                let Ok(inputs) = inputs(e, Some(own)) else { continue };
                let point = Point { t, stroke, rate: reading.rate, inputs: &inputs };
                let pull = force(e, &point, reading.coordinate).unwrap_or(f64::NAN);
                sum.iter_mut().zip(gradient).for_each(|(sum, slope)| *sum += pull * slope);
            }
        })?;
    }
    let (mut elements, mut pulls) = (Vec::new(), Forces::default());
    for (e, ((element, known), (reading, gradient))) in system.elements.iter().zip(forces).zip(readings).enumerate() {
        let inputs = inputs(e, control.as_deref())?;
        let stroke = element.stroke(reading.coordinate);
        let point = Point { t, stroke, rate: reading.rate, inputs: &inputs };
        let jump = element.jump(reading.coordinate);
        let force = force(e, &point, reading.coordinate)?;
        pulls.push(&element.measure, Pull::constant(force));
        *known = force;
        elements.push(ElementStart { stroke, jump, gradient });
    }
    let mut residual = pulls.inverse_dynamics(model, [q, v, a]);
    add_smooth_resistance(model, v, &mut residual);
    let mut drives = vec![0.0; model.nv()];
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        if let Drive::Force(signals) = drive {
            for (k, signal) in model.v_range(j).zip(signals) {
                drives[k] = force_at(cx, k, signal, t)?;
                if let Some(control) = control.as_deref().filter(|_| !cx.holds_force(k)) {
                    drives[k] = finite(cx, k, t, drives[k] + control.torque(0)[k])?;
                }
                residual[k] -= drives[k];
            }
        }
    }
    Ok(Balance { kinematics, elements, residual, drives })
}

/// Takes over what prescribed joints jump to at the origin's time. A velocity that jumps takes an impulse of its actuator, and the
/// free joints get their share of it: M_ff Δv_f = −M_fp Δv_p.
pub(super) fn take_jumps(cx: Context, forward: &Forward, origin: &mut Origin) -> Result<(), RunError> {
    if !forward.has_paths() {
        return Ok(());
    }
    let model = &cx.system.model;
    let (before_q, before_v) = (origin.q.clone(), origin.v.clone());
    let Origin { t, q, v, a, .. } = origin;
    for (j, drive) in model.own_joints().zip(&forward.drives) {
        if let Drive::Prescribed(path) = drive {
            take_path(model, j, path, *t, q, v, a)?;
        }
    }
    let (now, q_now, v_now) = (*t, q.clone(), v.clone());
    let (mut spare_v, mut spare_a) = (v.clone(), a.clone());
    let speed = |k: usize| v_now[k].abs() + before_v[k].abs();
    refuse_jumps(model, (now.next_down(), &before_q), (now, &q_now), speed, 0.0, |at, places| {
        places.clone_from(&before_q);
        let drives = model.own_joints().zip(&forward.drives);
        for (j, drive) in drives {
            if let Drive::Prescribed(path) = drive {
                take_path(model, j, path, at, places, &mut spare_v, &mut spare_a)?;
            }
        }
        Ok(())
    })?;
    let change: Vec<f64> = v.iter().zip(&before_v).map(|(after, before)| after - before).collect();
    if change.iter().all(|change| *change == 0.0) {
        return Ok(());
    }
    let kinematics = Kinematics::at_velocity(model, q, v);
    let (mass, n, free) = (crba(model, &kinematics), model.nv(), forward.free_velocities(model));
    let mut share: Vec<f64> =
        free.iter().map(|&k| -change.iter().zip(&mass[k * n..]).map(|(change, m)| change * m).sum::<f64>()).collect();
    solve_mass(cx, &kinematics, &free, &mut share);
    free.iter().zip(share).for_each(|(&k, share)| v[k] += share);
    Ok(())
}

/// x ← M⁻¹ x over the free velocities.
fn solve_mass(cx: Context, kinematics: &Kinematics, free: &[usize], x: &mut [f64]) {
    let mut lu = Lu::default();
    if lu.factor_part(cx.system.model.nv(), &crba(&cx.system.model, kinematics), free) {
        lu.solve(x);
    }
}

/// The first step, s: a small share of the time in which the system answers its accelerations, a power-of-two share of it where
/// the layer at t = 0 asks for less: h max_i |(M⁻¹ g)_i|/tol_i |F(h) − F(0)| ≤ 1 with F(h) − F(0) ≈ c h^−alpha |x(h) − x(0)|.
/// A singular start moves the positions by (M⁻¹ g)_i c x(0) h^{2−alpha}: that must stay within `strict`, the tolerance that the user
/// asks for, since the estimate does not see it.
pub(super) fn first_step(
    cx: Context,
    (step, bank): (&RadauStep, &ElementBank),
    elements: &[ElementStart],
    strict: Tolerance,
    end: f64,
) -> f64 {
    let RadauStep { model, origin, free, sizes, tolerance, .. } = step;
    let kinematics = Kinematics::at_velocity(model, &origin.q, &origin.v);
    let mut h = (tolerance.rtol.powf(0.25) / step.answering_rate(cx, bank, &origin.a, 1.0 / end)).min(0.1 * end);
    for (e, (element, start)) in cx.system.elements.iter().zip(elements).enumerate() {
        let mut inputs = vec![Default::default(); element.inputs.len()];
        cx.inputs_at(e, 0.0, &mut inputs);
        let point = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: &inputs };
        let mut terms = Vec::new();
        element.law.for_each_springpot(&point, &mut |term| terms.push(term));
        terms.retain(|term| term.order > 0.0 && term.order < 1.0);
        if terms.is_empty() {
            continue;
        }
        let mut push: Vec<f64> = free.iter().map(|&k| start.gradient[k]).collect();
        solve_mass(cx, &kinematics, free, &mut push);
        // What does not move has no share of its own.
        let largest = |share: &dyn Fn(usize, f64) -> f64| {
            let shares = push.iter().zip(free).map(|(push, &k)| share(k, push.abs()));
            shares.filter(|share| share.is_finite()).fold(0.0, f64::max)
        };
        // x(h) − x(0) to second order, from the motion at the start.
        let slope: f64 = start.gradient.iter().zip(&origin.v).map(|(g, v)| g * v).sum();
        let bend: f64 = start.gradient.iter().zip(&origin.a).map(|(g, a)| g * a).sum();
        for Term { coefficient, order } in terms {
            if element.derivative == Derivative::RiemannLiouville && start.jump != 0.0 {
                let travel = |k: usize| sizes.travel(k, end).max(jump_travel(start.jump, &start.gradient, k));
                let kick = largest(&|k, push| push / strict.of(travel(k))) * (coefficient * start.jump).abs();
                if kick > 0.0 {
                    h = h.min((1.0 / kick).powf(1.0 / (2.0 - order)));
                }
            }
            let reach = largest(&|k, push| push / tolerance.of(sizes.speed(k, end))) * coefficient.abs();
            for _ in 0..200 {
                let travel = (h * slope).abs() + (0.5 * h * h * bend).abs();
                if h * reach * h.powf(-order) * travel <= 1.0 {
                    break;
                }
                h *= 0.5;
            }
        }
    }
    h
}
