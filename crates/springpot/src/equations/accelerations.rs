//! Accelerations and forces at one time, whatever came before: M a = τ − nle − Σ g F, with friction at rest.

mod at_once;

use super::assembly::Equations;
use super::context::Context;
use super::control::{ControlRun, Eye};
use super::drives::{finite, force_at};
use super::node::{ElementNodes, Origin};
use super::resistance::add_smooth_resistance;
use super::solve::Solve;
use crate::actuation::Forward;
use crate::dynamics::{Kinematics, crba};
use crate::elements::{ElementBank, Forces, Pull};
use crate::law::{Derivative, InputValue, Point, State, Term};
use crate::system::error::RunError;
use crate::system::jump::refuse_jumps;

pub(crate) use at_once::{AtOnce, OWN_POWERS};

/// When the force of a singular start is looked at, s.
const SOON: f64 = 1e-12;

/// What of the elements' forces is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Share {
    /// All; where that is infinite at t = 0, as it is soon after.
    Whole,
    /// Without the share of a singular start.
    Regular,
}

/// One element where a motion starts.
#[derive(Debug)]
pub(crate) struct ElementAtStart {
    pub(crate) stroke: f64,
    /// x(0) where it counts as different from 0 and as a jump, else 0, m or rad.
    pub(crate) jump: f64,
    /// ∂y/∂q.
    pub(crate) gradient: Vec<f64>,
    /// Its springpots of orders between 0 and 1, where the motion starts.
    pub(crate) springpots: Vec<Term>,
}

/// What is known before accelerations are.
struct Balance {
    kinematics: Kinematics,
    elements: Vec<ElementAtStart>,
    /// What the accelerations of prescribed joints alone leave over, without friction that sticks (nv).
    residual: Vec<f64>,
    /// τ (nv).
    drives: Vec<f64>,
}

impl Equations {
    /// Goes to where the motion starts: accelerations of the joints that forces drive, and forces of the elements.
    ///
    /// # Errors
    /// What keeps a run from starting.
    pub(crate) fn at_start(&mut self, cx: Context) -> Result<(Origin, Vec<ElementAtStart>), RunError> {
        let mut origin = Origin::new(&cx.system.model, &self.forward);
        self.decide(cx, &mut origin, &begun)?;
        let mut elements = self.accelerate(cx, Share::Regular, &mut origin, &begun)?;
        for (e, (element, start)) in cx.system.elements.iter().zip(&mut elements).enumerate() {
            let mut inputs = vec![InputValue::default(); element.inputs.len()];
            cx.inputs_at(e, 0.0, &mut inputs);
            let point = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: &inputs };
            element.law.for_each_springpot(&point, &mut |term| start.springpots.push(term));
            start.springpots.retain(|term| term.order > 0.0 && term.order < 1.0);
        }
        Ok((origin, elements))
    }

    /// Goes to the far side of a break or kink of the signals at the time of `origin`, where prescribed velocities and accelerations may jump;
    /// gives all accelerations there, those of a singular start included.
    ///
    /// # Errors
    /// What must not jump.
    pub(crate) fn cross(&mut self, cx: Context, origin: &mut Origin) -> Result<Vec<f64>, RunError> {
        self.restart();
        take_jumps(cx, &self.forward, origin)?;
        self.decide(cx, origin, &now)?;
        self.accelerate(cx, Share::Whole, origin, &now)?;
        let a = origin.a.clone();
        if self.is_singular() {
            self.accelerate(cx, Share::Regular, origin, &now)?;
        }
        Ok(a)
    }

    /// Decides which joints friction holds at the origin.
    ///
    /// # Errors
    /// [`RunError::NoHold`].
    fn decide(&mut self, cx: Context, origin: &mut Origin, force: &Answer) -> Result<(), RunError> {
        if self.rubs() {
            let model = &cx.system.model;
            let Balance { kinematics, elements, residual, drives } = self.balance(cx, Share::Whole, origin, force)?;
            let size = |k: usize| {
                let pulls = elements.iter().zip(&self.elements);
                let pull = pulls.map(|(element, nodes)| (element.gradient[k] * nodes.force).abs());
                residual[k].abs() + drives[k].abs() + pull.sum::<f64>()
            };
            let sizes: Vec<f64> = (0..model.nv()).map(size).collect();
            let outcome = self.friction.decide(&origin.v, &residual, &sizes, &crba(model, &kinematics));
            outcome.map_err(|k| RunError::NoHold { t: origin.t, joint: model.v_labels()[k].name.clone() })?;
        }
        self.take_free();
        Ok(())
    }

    /// Accelerations and forces of the elements at the origin's time.
    fn accelerate(
        &mut self,
        cx: Context,
        share: Share,
        origin: &mut Origin,
        force: &Answer,
    ) -> Result<Vec<ElementAtStart>, RunError> {
        let Balance { kinematics, elements, mut residual, .. } = self.balance(cx, share, origin, force)?;
        self.friction.add_sliding(&mut residual);
        let mut change: Vec<f64> = self.free().iter().map(|&k| -residual[k]).collect();
        solve_mass(cx, &kinematics, self.free(), &mut change);
        self.free().iter().zip(change).for_each(|(&k, change)| origin.a[k] += change);
        Ok(elements)
    }

    fn balance(&mut self, cx: Context, share: Share, origin: &mut Origin, force: &Answer) -> Result<Balance, RunError> {
        let Self { bank, control, forward, elements, .. } = self;
        let force = |e: usize, point: &Point, coordinate: f64| force(cx, bank, share, e, point, coordinate);
        balance(cx, forward, (control.as_deref_mut(), elements), origin, force)
    }

    /// Pushes the free velocities by impulses of forces, of each element that has one, and takes over the forces behind it: the motion goes from
    /// t = 0 to soon after.
    pub(crate) fn kick(
        &mut self,
        cx: Context,
        elements: &[ElementAtStart],
        jolts: &[Option<(State, f64)>],
        origin: &mut Origin,
    ) {
        let kinematics = Kinematics::at_velocity(&cx.system.model, &origin.q, &origin.v);
        let free = self.free().to_vec();
        let push = |gradient: &[f64], size: f64, pushed: &mut [f64]| {
            let mut share: Vec<f64> = free.iter().map(|&k| -gradient[k] * size).collect();
            solve_mass(cx, &kinematics, &free, &mut share);
            free.iter().zip(share).for_each(|(&k, share)| pushed[k] += share);
        };
        let jolted =
            || elements.iter().zip(jolts).enumerate().filter_map(|(e, (at, jolt))| Some((e, at, jolt.as_ref()?)));
        for (_, element, (_, impulse)) in jolted() {
            push(&element.gradient, *impulse, &mut origin.v);
        }
        for (e, element, (state, _)) in jolted() {
            let mut inputs = vec![InputValue::default(); cx.system.elements[e].inputs.len()];
            cx.inputs_at(e, 0.0, &mut inputs);
            let rate = element.gradient.iter().zip(&origin.v).map(|(g, v)| g * v).sum();
            let point = Point { t: 0.0, stroke: element.stroke, rate, inputs: &inputs };
            let force = cx.system.elements[e].law.now(&point, state).force();
            push(&element.gradient, force - self.elements[e].force, &mut origin.a);
            self.elements[e].force = force;
        }
    }
}

/// What an element answers at a point and a coordinate.
type Answer = dyn Fn(Context, &ElementBank, Share, usize, &Point, f64) -> Result<f64, RunError>;

/// At t = 0, before laws have begun.
fn begun(
    cx: Context,
    _: &ElementBank,
    share: Share,
    e: usize,
    point: &Point,
    coordinate: f64,
) -> Result<f64, RunError> {
    let element = &cx.system.elements[e];
    let law = element.begin(coordinate, point.inputs).map_err(RunError::of_kernel(&element.name))?;
    let mut force = element.law.now(point, &law).regular;
    if share == Share::Whole {
        let mut add = |term: Term| force += term.coefficient * SOON.powf(-term.order);
        element.law.for_each_singularity(point.inputs, &law, &mut add);
    }
    Ok(force)
}

/// Between two steps.
fn now(_: Context, bank: &ElementBank, share: Share, e: usize, point: &Point, _: f64) -> Result<f64, RunError> {
    Ok(bank.now(e, point).map_or(0.0, |now| match share {
        Share::Whole => now.finite_force(),
        Share::Regular => now.regular,
    }))
}

/// Accelerations of prescribed joints and forces of the elements at the origin's time, and what they leave over.
fn balance(
    cx: Context,
    forward: &Forward,
    (mut control, nodes): (Option<&mut ControlRun>, &mut [ElementNodes]),
    origin: &mut Origin,
    force: impl Fn(usize, &Point, f64) -> Result<f64, RunError>,
) -> Result<Balance, RunError> {
    let (system, model) = (cx.system, &cx.system.model);
    let Origin { t, q, v, a } = origin;
    let t = *t;
    a.fill(0.0);
    forward.take_paths(model, t, q, v, a)?;
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
    for (e, ((element, nodes), (reading, gradient))) in system.elements.iter().zip(nodes).zip(readings).enumerate() {
        let inputs = inputs(e, control.as_deref())?;
        let stroke = element.stroke(reading.coordinate);
        let point = Point { t, stroke, rate: reading.rate, inputs: &inputs };
        nodes.force = force(e, &point, reading.coordinate)?;
        pulls.push(&element.measure, Pull::constant(nodes.force));
        let is_jump = element.derivative == Derivative::RiemannLiouville;
        let jump = if is_jump { element.jump(reading.coordinate) } else { 0.0 };
        elements.push(ElementAtStart { stroke, jump, gradient, springpots: Vec::new() });
    }
    let mut residual = pulls.inverse_dynamics(model, [q, v, a]);
    add_smooth_resistance(system, v, &mut residual);
    let mut drives = vec![0.0; model.nv()];
    for (k, signal) in forward.forces(model) {
        drives[k] = force_at(cx, k, signal, t)?;
        if let Some(control) = control.as_deref().filter(|_| !cx.holds_force(k)) {
            drives[k] = finite(cx, k, t, drives[k] + control.torque(0)[k])?;
        }
        residual[k] -= drives[k];
    }
    Ok(Balance { kinematics, elements, residual, drives })
}

/// Takes over what prescribed joints jump to at the origin's time. A velocity that jumps takes an impulse of its actuator, and the
/// free joints get their share of it: M_ff Δv_f = −M_fp Δv_p.
fn take_jumps(cx: Context, forward: &Forward, origin: &mut Origin) -> Result<(), RunError> {
    if !forward.has_paths() {
        return Ok(());
    }
    let model = &cx.system.model;
    let (before_q, before_v) = (origin.q.clone(), origin.v.clone());
    let Origin { t, q, v, a } = origin;
    forward.take_paths(model, *t, q, v, a)?;
    let (now, q_now, v_now) = (*t, q.clone(), v.clone());
    let (mut spare_v, mut spare_a) = (v.clone(), a.clone());
    let speed = |k: usize| v_now[k].abs() + before_v[k].abs();
    refuse_jumps(model, (now.next_down(), &before_q), (now, &q_now), speed, 0.0, |at, places| {
        places.clone_from(&before_q);
        forward.take_paths(model, at, places, &mut spare_v, &mut spare_a)
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

/// x ← M⁻¹ x over the velocities `free`.
pub(crate) fn solve_mass(cx: Context, kinematics: &Kinematics, free: &[usize], x: &mut [f64]) {
    let (model, mut mass) = (&cx.system.model, Solve::default());
    if mass.factor_part(&crba(model, kinematics), model.nv(), free) {
        mass.solve(x);
    }
}
