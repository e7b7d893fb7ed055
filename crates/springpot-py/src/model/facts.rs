//! What a model is: names, sizes, limits, masses.

use super::PyModel;
use crate::notebook;
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;
use springpot::model::{Limits, Space};

impl PyModel {
    /// A number of each joint of its own for each of its coordinates (or velocities).
    fn by_joint(&self, count: impl Fn(Space) -> usize, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let model = &self.core.model;
        model.own_joints().flat_map(|j| std::iter::repeat_n(value(j), count(model.joint_space(j)))).collect()
    }

    fn limit(&self, count: impl Fn(Space) -> usize, of: impl Fn(&Limits) -> f64) -> Vec<f64> {
        self.by_joint(count, |j| of(self.core.model.limits(j)))
    }
}

#[pymethods]
impl PyModel {
    /// Name of the robot in its URDF file, or empty.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Number of coordinates q.
    #[getter]
    pub(super) fn nq(&self) -> usize {
        self.core.model.nq()
    }

    /// Number of velocities v.
    #[getter]
    pub(super) fn nv(&self) -> usize {
        self.core.model.nv()
    }

    /// Names of the moving joints, those that follow another one included; of a joint of several coordinates that are numbers, one
    /// for each, such as ``c.z`` and ``c.rz``.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.core.model.joint_names().to_vec()
    }

    /// What they are, or are part of: revolute, continuous, prismatic, helical, cylindrical, universal, planar, spherical, floating.
    #[getter]
    fn joint_kinds(&self) -> Vec<&'static str> {
        let model = &self.core.model;
        (0..model.joint_count()).map(|j| model.described_joint(j).kind.name()).collect()
    }

    /// Names of the coordinates, in the order of q: joints, with a component where they have several.
    #[getter]
    fn q_names(&self) -> Vec<String> {
        self.core.model.q_labels().into_iter().map(|label| label.name).collect()
    }

    /// Names of the velocities, in the order of v.
    #[getter]
    fn v_names(&self) -> Vec<String> {
        self.core.model.v_labels().into_iter().map(|label| label.name).collect()
    }

    /// Names of the bodies (links).
    #[getter]
    fn body_names(&self) -> Vec<String> {
        self.core.model.body_names().to_vec()
    }

    /// Names that :meth:`frame_jacobian` knows: world, bodies, and the gripper of a scenario.
    #[getter]
    #[pyo3(name = "frame_names")]
    fn names_of_frames(&self) -> Vec<String> {
        self.frame_names().map(str::to_owned).collect()
    }

    /// The body that carries each body.
    #[getter]
    fn body_parents(&self) -> Vec<String> {
        self.bodies.iter().map(|body| self.parent_name(body.parent).to_owned()).collect()
    }

    /// The body that carries the gripper of a scenario.
    #[getter]
    fn gripper_body(&self) -> Option<&str> {
        self.gripper.as_ref().map(|(_, body)| body.as_str())
    }

    /// What of a URDF file was not used or was assumed.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Gravitational acceleration, shape ``(3,)``, m/s².
    #[getter]
    fn gravity_vector<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.core.model.gravity())
    }

    /// Mass of all bodies, kg.
    #[getter]
    fn mass(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass).sum()
    }

    /// Masses of the bodies, shape ``(bodies,)``, kg.
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.bodies.iter().map(|body| body.mass))
    }

    /// Inertia tensors about the centres of mass, in the axes of the bodies, shape ``(bodies, 3, 3)``, kg·m².
    #[getter]
    fn inertias<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let rows: Vec<Vec<Vec<f64>>> =
            self.bodies.iter().map(|body| body.inertia.iter().map(|row| row.to_vec()).collect()).collect();
        if rows.is_empty() {
            return Ok(PyArray3::zeros(py, [0, 3, 3], false));
        }
        Ok(PyArray3::from_vec3(py, &rows)?)
    }

    /// Lower limits of q, shape ``(nq,)``, −inf where there is none.
    #[getter]
    fn lower_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.limit(Space::nq, |limits| limits.lower))
    }

    /// Upper limits of q, shape ``(nq,)``.
    #[getter]
    fn upper_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.limit(Space::nq, |limits| limits.upper))
    }

    /// Limits of \|v\|, shape ``(nv,)``, inf where there is none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.limit(Space::nv, |limits| limits.velocity))
    }

    /// Limits of \|tau\|, shape ``(nv,)``.
    #[getter]
    fn effort_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.limit(Space::nv, |limits| limits.effort))
    }

    /// Viscous damping of the joints, shape ``(nv,)``, N·m·s/rad or N·s/m; no algorithm here adds it.
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.by_joint(Space::nv, |j| self.core.model.damping()[j]))
    }

    /// Coulomb friction of the joints, shape ``(nv,)``, N·m or N; no algorithm here adds it.
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.by_joint(Space::nv, |j| self.core.model.friction()[j]))
    }

    /// Inertia of the rotors as felt along the velocities, shape ``(nv,)``, kg·m² or kg: on the diagonal of the mass matrix.
    #[getter]
    fn armature<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.core.model.rotors())
    }

    /// What :meth:`joint_torque_regressor` has columns for: 10 numbers a body, kg, kg·m and kg·m², shape ``(10 bodies,)``.
    #[getter]
    fn body_numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, springpot::dynamics::body_numbers(&self.core.model))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        notebook::html("model", slf)
    }

    fn __repr__(&self) -> String {
        let model = &self.core.model;
        let name = if self.name.is_empty() { String::new() } else { format!("\"{}\", ", self.name) };
        format!("Model({name}nq={}, nv={}, joints={})", model.nq(), model.nv(), model.joint_count())
    }
}
