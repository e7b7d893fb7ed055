//! The rigid-body terms of one state, as JSON.

use super::order::Order;
use super::states::State;
use springpot::dynamics::{
    AbaDerivatives, Kinematics, RneaDerivatives, Workspace, aba_derivatives_into, christoffel_into, com, coriolis_into,
    crba_into, frame_jacobian_into, gravity_into, indefinite_joint_into, kinetic_energy, potential_energy,
    rnea_derivatives_into, rnea_into,
};
use springpot::model::{Frame, Model};
use std::fmt::Write;

/// Room for the terms of a model, reused from state to state.
#[derive(Debug)]
pub(super) struct Answers<'a> {
    model: &'a Model,
    order: &'a Order,
    frame: Option<Frame>,
    kinematics: Kinematics,
    workspace: Workspace,
    inverse: RneaDerivatives,
    forward: AbaDerivatives,
    mass: Vec<f64>,
    coriolis: Vec<f64>,
    /// Empty unless asked for.
    christoffel: Vec<f64>,
    gravity: Vec<f64>,
    rnea: Vec<f64>,
    jacobian: Vec<f64>,
}

/// How the indices of a quantity run.
#[derive(Clone, Copy)]
enum Index<'a> {
    /// Over so many.
    All(usize),
    /// Over the velocities, in the order of the file.
    Velocity(&'a [usize]),
}

impl<'a> Answers<'a> {
    pub(super) fn new(model: &'a Model, order: &'a Order, christoffel: bool, frame: Option<Frame>) -> Self {
        let n = model.nv();
        Self {
            model,
            order,
            frame,
            kinematics: Kinematics::new(model),
            workspace: Workspace::new(model),
            inverse: RneaDerivatives::new(model),
            forward: AbaDerivatives::new(model),
            mass: vec![0.0; n * n],
            coriolis: vec![0.0; n * n],
            christoffel: if christoffel { vec![0.0; n * n * n] } else { Vec::new() },
            gravity: vec![0.0; n],
            rnea: vec![0.0; n],
            jacobian: vec![0.0; 6 * n],
        }
    }

    /// Appends the terms of a state to `text`; returns the names of those that are not finite, which are written as null.
    pub(super) fn write(&mut self, state: &State, text: &mut String) -> Vec<&'static str> {
        self.compute(state);
        let (model, order) = (self.model, self.order);
        let v = Index::Velocity(&order.v);
        let mut object = Object { text, infinite: Vec::new(), is_first: true };
        object.text.push('{');
        object.entry("M", &self.mass, &[v, v]);
        object.entry("coriolis", &self.coriolis, &[v, v]);
        if !self.christoffel.is_empty() {
            object.entry("christoffel", &self.christoffel, &[v, v, v]);
        }
        object.entry("gravity", &self.gravity, &[v]);
        object.entry("rnea", &self.rnea, &[v]);
        object.entry("aba", &self.forward.a, &[v]);
        object.entry("rnea_dq", &self.inverse.d_q, &[v, v]);
        object.entry("rnea_dv", &self.inverse.d_v, &[v, v]);
        object.entry("aba_dq", &self.forward.d_q, &[v, v]);
        object.entry("aba_dv", &self.forward.d_v, &[v, v]);
        object.entry("aba_dtau", &self.forward.d_tau, &[v, v]);
        object.entry("kinetic", &[kinetic_energy(model, &self.kinematics)], &[]);
        object.entry("potential", &[potential_energy(model, &self.kinematics)], &[]);
        object.entry("com", &com(model, &self.kinematics).0, &[Index::All(3)]);
        if let Some(frame) = &self.frame {
            let pose = self.kinematics.frame(frame);
            object.key("pose");
            let mut inner = Object { text: object.text, infinite: Vec::new(), is_first: true };
            inner.text.push('{');
            inner.entry("R", pose.rotation.0.as_flattened(), &[Index::All(3), Index::All(3)]);
            inner.entry("p", &pose.translation.0, &[Index::All(3)]);
            inner.text.push('}');
            if !inner.infinite.is_empty() {
                object.infinite.push("pose");
            }
            object.entry("jacobian", &self.jacobian, &[Index::All(6), v]);
        }
        object.text.push('}');
        object.infinite
    }

    /// Name of the joint at which the mass matrix of the state that was written last is not positive definite, where inertias were
    /// accepted that let it be so.
    pub(super) fn indefinite_joint(&mut self) -> Option<&str> {
        if !self.model.may_be_indefinite() {
            return None;
        }
        let Self { model, kinematics, workspace, mass, .. } = self;
        let joint = indefinite_joint_into(model, kinematics, workspace, mass)?;
        Some(&self.model.joint_names()[joint])
    }

    fn compute(&mut self, State { q, v, a, tau }: &State) {
        let Self { model, kinematics, workspace, .. } = self;
        kinematics.update_velocity(model, q, v);
        crba_into(model, kinematics, workspace, &mut self.mass);
        coriolis_into(model, kinematics, workspace, &mut self.coriolis);
        if !self.christoffel.is_empty() {
            christoffel_into(model, kinematics, workspace, &mut self.christoffel);
        }
        gravity_into(model, kinematics, workspace, &mut self.gravity);
        rnea_into(model, q, v, a, &[], workspace, &mut self.rnea);
        rnea_derivatives_into(model, kinematics, a, &[], workspace, &mut self.inverse);
        aba_derivatives_into(model, kinematics, tau, &[], workspace, &mut self.forward);
        if let Some(frame) = &self.frame {
            frame_jacobian_into(model, kinematics, frame, &mut self.jacobian);
        }
    }
}

/// An object that is being written, one entry a line.
struct Object<'t> {
    text: &'t mut String,
    infinite: Vec<&'static str>,
    is_first: bool,
}

impl Object<'_> {
    fn key(&mut self, key: &str) {
        let separator = if self.is_first { "" } else { ",\n " };
        self.is_first = false;
        let _ = write!(self.text, "{separator}\"{key}\": ");
    }

    /// A number or nested arrays; null where a number is not finite, which JSON cannot say.
    fn entry(&mut self, key: &'static str, numbers: &[f64], shape: &[Index<'_>]) {
        self.key(key);
        if numbers.iter().all(|number| number.is_finite()) {
            push_array(self.text, numbers, shape);
        } else {
            self.text.push_str("null");
            self.infinite.push(key);
        }
    }
}

/// `numbers` are row-major in the order of the model; what is written is in the order of the file.
fn push_array(text: &mut String, numbers: &[f64], shape: &[Index<'_>]) {
    let Some((first, inner)) = shape.split_first() else {
        // The shortest text that reads back to the same bits; no number says -0.
        let _ = write!(text, "{:?}", numbers[0] + 0.0);
        return;
    };
    let count = match first {
        Index::All(count) => *count,
        Index::Velocity(order) => order.len(),
    };
    text.push('[');
    for k in 0..count {
        if k > 0 {
            text.push_str(", ");
        }
        let index = match first {
            Index::All(_) => k,
            Index::Velocity(order) => order[k],
        };
        let size = numbers.len() / count;
        push_array(text, &numbers[index * size..(index + 1) * size], inner);
    }
    text.push(']');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_come_in_the_order_of_the_file() {
        let order = Index::Velocity(&[2, 0, 1]);
        let mut text = String::new();
        let numbers: Vec<f64> = (0..9).map(f64::from).collect();
        push_array(&mut text, &numbers, &[order, order]);
        assert_eq!(text, "[[8.0, 6.0, 7.0], [2.0, 0.0, 1.0], [5.0, 3.0, 4.0]]");
        text.clear();
        push_array(&mut text, &numbers[..6], &[Index::All(2), order]);
        assert_eq!(text, "[[2.0, 0.0, 1.0], [5.0, 3.0, 4.0]]");
        text.clear();
        push_array(&mut text, &[-0.0], &[]);
        assert_eq!(text, "0.0");
    }

    #[test]
    fn numbers_are_json_and_read_back() {
        for number in [0.1, -1e-300, 5e-324, 1e16, 1.7976931348623157e308, 123456789.0] {
            let mut text = String::new();
            push_array(&mut text, &[number], &[]);
            assert_eq!(serde_json::from_str::<f64>(&text).unwrap().to_bits(), f64::to_bits(number), "{text}");
        }
    }
}
