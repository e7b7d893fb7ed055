//! The robot and its elements at one time, before any law is asked.

use super::context::Context;
use super::resistance::{add_resistance, joint_loss};
use crate::dynamics::{CoincidentAnchors, Kinematics, Workspace, kinetic_energy, potential_energy, rnea_at_into};
use crate::elements::{Element, NoDirection, Reading};
use crate::law::{InputValue, Point, RuleError, State, heat};
use crate::model::Model;
use crate::motion::{Trajectory, Wanted};
use crate::observe::Snapshot;
use crate::observe::evaluation::ElementRow;
pub(crate) use crate::observe::evaluation::{ElementEvaluation, Evaluation};
use crate::observe::{ElementQuantity, Needs, Quantity};
use crate::system::System;
use crate::system::error::RunError;

/// Scratch of [`Context::evaluate`].
#[derive(Debug)]
pub(crate) struct Scratch {
    kinematics: Kinematics,
    workspace: Workspace,
}

impl Scratch {
    pub(crate) fn new(model: &Model) -> Self {
        Self { kinematics: Kinematics::new(model), workspace: Workspace::new(model) }
    }
}

impl ElementEvaluation {
    pub(crate) fn point(&self, t: f64) -> Point<'_> {
        Point { t, stroke: self.stroke, rate: self.reading.rate, inputs: &self.inputs }
    }
}

impl Evaluation {
    pub(crate) fn new(system: &System) -> Self {
        let n = system.model.nv();
        let element = |element: &Element| ElementEvaluation {
            reading: Reading::default(),
            stroke: 0.0,
            gradient: vec![0.0; n],
            inputs: vec![InputValue::default(); element.inputs.len()],
        };
        Self {
            t: 0.0,
            q: vec![0.0; system.model.nq()],
            v: vec![0.0; n],
            a: vec![0.0; n],
            rigid: vec![0.0; n],
            driven: vec![None; n],
            joint_loss: 0.0,
            kinetic: 0.0,
            potential: 0.0,
            elements: system.elements.iter().map(element).collect(),
            gripper: [0.0; 3],
            gripper_error: None,
        }
    }

    /// Whether it can be one of the same system as another.
    pub(crate) fn has_shape_of(&self, other: &Self) -> bool {
        let sizes = |of: &Self| [of.q.len(), of.v.len(), of.a.len(), of.elements.len()];
        let inputs = |of: &Self| of.elements.iter().map(|element| element.inputs.len()).collect::<Vec<_>>();
        sizes(self) == sizes(other) && inputs(self) == inputs(other)
    }

    /// Power of the actuators were there no elements, W.
    pub(crate) fn rigid_power(&self) -> f64 {
        self.rigid.iter().zip(&self.v).map(|(tau, v)| tau * v).sum()
    }
}

impl Snapshot {
    /// Room for what is known of a system.
    pub(crate) fn new(system: &System) -> Self {
        Self {
            evaluation: Evaluation::new(system),
            // Of which nothing is known until their laws are asked.
            elements: vec![ElementRow::UNKNOWN; system.elements.len()],
            actuators: 0.0,
            joints: 0.0,
            residual: 0.0,
            derivatives: Vec::new(),
        }
    }
}

impl Context<'_> {
    /// Fills `evaluation` for the time `t` of a trajectory; inputs are taken at `t_inputs`, which differs from `t` by one bit where a break point
    /// is meant from its left side.
    ///
    /// # Errors
    /// [`RunError`] where the motion cannot be followed, a signal is not finite, or an element has no direction.
    pub(crate) fn evaluate(
        &self,
        trajectory: &Trajectory,
        t: f64,
        t_inputs: f64,
        scratch: &mut Scratch,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        let wanted = trajectory.at(&self.system.model, t, &mut evaluation.q, &mut evaluation.v, &mut evaluation.a)?;
        self.require_finite(t, evaluation)?;
        self.fill(t, t_inputs, wanted, scratch, evaluation)
    }

    /// Fills `evaluation`, whose q, v and a are there, for the time `t`, inputs taken at `t_inputs`.
    ///
    /// # Errors
    /// [`RunError`] where an input is not finite or breaks a rule, or an element has no direction.
    pub(crate) fn fill(
        &self,
        t: f64,
        t_inputs: f64,
        wanted: Option<Wanted>,
        scratch: &mut Scratch,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        evaluation.t = t;
        let kinematics = &mut scratch.kinematics;
        kinematics.update_velocity(&self.system.model, &evaluation.q, &evaluation.v);
        let workspace = &mut scratch.workspace;
        rnea_at_into(
            &self.system.model,
            kinematics,
            &evaluation.q,
            &evaluation.a,
            &[],
            workspace,
            &mut evaluation.rigid,
        );
        evaluation.kinetic = kinetic_energy(&self.system.model, kinematics);
        evaluation.potential = potential_energy(&self.system.model, kinematics);
        evaluation.joint_loss = add_resistance(self.system, &evaluation.v, &mut evaluation.rigid);
        for (e, (element, state)) in self.system.elements.iter().zip(&mut evaluation.elements).enumerate() {
            element.measure.read_into(&self.system.model, kinematics, &mut state.gradient, &mut state.reading);
            element.check_direction(t, &state.reading)?;
            state.stroke = element.stroke(state.reading.coordinate);
            self.inputs_at(e, t_inputs, &mut state.inputs);
            element.check_inputs(t, &state.inputs)?;
        }
        if let Some(site) = &self.system.gripper {
            evaluation.gripper = kinematics.position(site).0;
            evaluation.gripper_error = wanted.map(|Wanted { position, .. }| {
                let square = |k: usize| (evaluation.gripper[k] - position[k]).powi(2);
                (square(0) + square(1) + square(2)).sqrt()
            });
        }
        Ok(())
    }

    /// Fills what `needs` say of an `evaluation` whose q and v are there, for the time `t`; from `kinematics`, where they are known.
    ///
    /// # Errors
    /// [`RunError`] where an element that is asked has no direction.
    pub(crate) fn fill_readings(
        &self,
        (t, needs): (f64, Needs),
        kinematics: Option<&Kinematics>,
        scratch: &mut Scratch,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        evaluation.t = t;
        if needs < Needs::Gripper {
            return Ok(());
        }
        let kinematics = kinematics.unwrap_or_else(|| {
            scratch.kinematics.update_velocity(&self.system.model, &evaluation.q, &evaluation.v);
            &scratch.kinematics
        });
        if let Some(site) = &self.system.gripper {
            evaluation.gripper = kinematics.position(site).0;
        }
        let elements = self.system.elements.iter().zip(&mut evaluation.elements);
        for (element, state) in elements.filter(|_| needs >= Needs::Readings) {
            element.measure.read_into(&self.system.model, kinematics, &mut state.gradient, &mut state.reading);
            element.check_direction(t, &state.reading)?;
            state.stroke = element.stroke(state.reading.coordinate);
        }
        Ok(())
    }

    /// As [`Self::fill`] for all but the actuators and what rows alone ask for: from kinematics that are there, and from the
    /// readings and inputs of the `elements`.
    pub(crate) fn fill_energies<'s>(
        &self,
        t: f64,
        kinematics: &Kinematics,
        elements: impl Iterator<Item = (&'s Reading, &'s [InputValue])>,
        evaluation: &mut Evaluation,
    ) {
        evaluation.t = t;
        evaluation.kinetic = kinetic_energy(&self.system.model, kinematics);
        evaluation.potential = potential_energy(&self.system.model, kinematics);
        evaluation.joint_loss = joint_loss(self.system, &evaluation.v);
        let states = self.system.elements.iter().zip(&mut evaluation.elements);
        for ((element, state), (reading, inputs)) in states.zip(elements) {
            state.reading.clone_from(reading);
            state.stroke = element.stroke(reading.coordinate);
            state.inputs.copy_from_slice(inputs);
        }
    }

    fn require_finite(&self, t: f64, evaluation: &Evaluation) -> Result<(), RunError> {
        let q = evaluation.q.iter().enumerate().map(|(k, x)| (Quantity::Coordinate(k), *x));
        let v = evaluation.v.iter().enumerate().map(|(k, x)| (Quantity::Velocity(k), *x));
        let a = evaluation.a.iter().enumerate().map(|(k, x)| (Quantity::Acceleration(k), *x));
        if let Some((quantity, value)) = q.chain(v).chain(a).find(|(_, x)| !x.is_finite()) {
            let what = self.system.observables().named(quantity).to_string();
            return Err(RunError::NotFinite { t, what, value });
        }
        Ok(())
    }
}

impl Element {
    /// # Errors
    /// [`Self::without_direction`] where its force has none.
    #[inline]
    pub(crate) fn check_direction(&self, t: f64, reading: &Reading) -> Result<(), RunError> {
        reading.check().map_err(|why| self.without_direction(t, why))
    }

    /// Why its force had no direction at `t`.
    pub(crate) fn without_direction(&self, t: f64, why: NoDirection) -> RunError {
        let element = self.name.clone();
        match why {
            NoDirection::Line(CoincidentAnchors { length }) => RunError::ZeroLength { t, element, length },
            NoDirection::Segment { segment, length } => RunError::SegmentLength { t, element, segment, length },
            NoDirection::HalfTurn { angle } => RunError::HalfTurn { t, element, angle },
        }
    }

    /// # Errors
    /// [`RunError::Heat`] where it warms itself by what nobody knows: a start that takes infinite work, or begins as steeply.
    pub(crate) fn check_start(&self, state: &State) -> Result<(), RunError> {
        if !self.law.is_thermal() || state.has_finite_work() {
            return Ok(());
        }
        let why = "a temperature of its own needs to know what is lost, and a jump to the stroke at t = 0 does not \
                    tell: write past = \"held\", or begin at a stroke of 0";
        Err(RunError::Heat { t: 0.0, element: self.name.clone(), why: why.to_owned() })
    }

    pub(crate) fn check_inputs(&self, t: f64, inputs: &[InputValue]) -> Result<(), RunError> {
        for (row, input) in self.entry.inputs.iter().zip(inputs) {
            if !input.value.is_finite() {
                let what = Quantity::Element(&*self.name, ElementQuantity::InputValue(&*row.name)).to_string();
                return Err(RunError::NotFinite { t, what, value: input.value });
            }
            if !row.range.contains(input.value) {
                return Err(RunError::InputRange {
                    t,
                    element: self.name.clone(),
                    input: row.name.to_string(),
                    value: input.value,
                    low: row.range.low,
                    high: row.range.high,
                });
            }
        }
        self.law.check_inputs(inputs).map_err(|RuleError { rule, parameter }| {
            let element = self.name.clone();
            match parameter == heat::INPUT {
                true => RunError::Heat { t, element, why: rule },
                false => RunError::Rule { t, element, rule },
            }
        })
    }
}
