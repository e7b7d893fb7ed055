//! Where frames and points are, and how they move.

use super::PyModel;
use super::batch::Symbol::{Q, V};
use super::batch::{each, one_result};
use crate::error::{model_error, type_error};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use springpot::dynamics::batch::{self, BatchWorkspace};
use springpot::dynamics::{frame_jacobian_at_into, frame_jacobian_rate_into, pair_into};
use springpot::model::{Anchor, Model, Site};

type Any<'py> = Bound<'py, PyAny>;

impl PyModel {
    fn site(&self, py: Python<'_>, name: &str, point: [f64; 3]) -> PyResult<Site> {
        let refuse = |error| model_error(py, error);
        match self.core.model.find_body(name) {
            Some(body) => self.core.model.resolve(&Anchor { body, point }).map_err(refuse),
            None => Err(self.frame(py, name).err().unwrap_or_else(|| type_error("a point belongs to a body"))),
        }
    }
}

#[pymethods]
impl PyModel {
    /// The configuration in which every joint stands at 0: shape ``(nq,)``.
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.core.model.neutral())
    }

    /// A random configuration within the limits, the same for the same seed: shape ``(nq,)``, or ``(count, nq)`` from consecutive seeds.
    #[pyo3(signature = (seed, count=None))]
    fn random<'py>(&self, py: Python<'py>, seed: u64, count: Option<usize>) -> PyResult<Any<'py>> {
        let model = &self.core.model;
        let Some(count) = count else { return Ok(PyArray1::from_vec(py, model.random(seed)).into_any()) };
        let (mut all, wanted) = (Vec::new(), count.saturating_mul(model.nq()));
        all.try_reserve_exact(wanted).map_err(|_| PyMemoryError::new_err(format!("no room for {wanted} numbers")))?;
        (0..count as u64).for_each(|k| all.extend(model.random(seed.wrapping_add(k))));
        let flat = PyArray1::from_vec(py, all);
        let matrix: Bound<'py, PyArray2<f64>> = flat.reshape([count, model.nq()])?;
        Ok(matrix.into_any())
    }

    /// Where a frame is: its rotation, shape ``(3, 3)``, which takes its components to those of the world, and its origin, shape ``(3,)``, m.
    #[pyo3(signature = (name, q, out=None))]
    fn frame_placement<'py>(&self, name: &str, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<[Any<'py>; 2]> {
        let frame = self.frame(q.py(), name)?;
        let shapes: [&[usize]; 2] = [&[3, 3], &[3]];
        each(
            &self.core,
            [(q, Q("q"))],
            shapes,
            out,
            |m, w, [q], [rotation, position]| batch::frame_placement_into(m, w, &frame, q, rotation, position),
            |model, scratch, [q], [rotation, position]| {
                scratch.kinematics.update_position(model, q);
                let placement = scratch.kinematics.frame(&frame);
                position.copy_from_slice(&placement.translation.0);
                let turn = &placement.rotation;
                for column in 0..3 {
                    let mut axis = [0.0; 3];
                    axis[column] = 1.0;
                    let turned = *turn * springpot::spatial::Vec3(axis);
                    (0..3).for_each(|row| rotation[3 * row + column] = turned.0[row]);
                }
            },
        )
    }

    /// The Jacobian of a frame, (dr/dt, ω) = J v, both in world axes: shape ``(6, nv)``, the linear rows of its origin first.
    ///
    /// ``name`` is one of :attr:`frame_names`.
    #[pyo3(signature = (name, q, out=None))]
    fn frame_jacobian<'py>(&self, name: &str, q: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        let (frame, n) = (self.frame(q.py(), name)?, self.nv());
        one_result(
            &self.core,
            [(q, Q("q"))],
            &[6, n],
            out,
            |m, w, [q], [jacobian]| batch::frame_jacobian_into(m, w, &frame, q, jacobian),
            |model, scratch, [q], jacobian| {
                frame_jacobian_at_into(model, q, &frame, &mut scratch.workspace, jacobian);
            },
        )
    }

    /// dJ/dt of :meth:`frame_jacobian`, so that (d²r/dt², dω/dt) = J a + (dJ/dt) v: shape ``(6, nv)``.
    #[pyo3(signature = (name, q, v, out=None))]
    fn frame_jacobian_rate<'py>(
        &self,
        name: &str,
        q: &Any<'py>,
        v: &Any<'py>,
        out: Option<&Any<'py>>,
    ) -> PyResult<Any<'py>> {
        let (frame, n, inputs) = (self.frame(q.py(), name)?, self.nv(), [(q, Q("q")), (v, V("v"))]);
        one_result(
            &self.core,
            inputs,
            &[6, n],
            out,
            |m, w, [q, v], [rate]| batch::frame_jacobian_rate_into(m, w, &frame, q, v, rate),
            |model, scratch, [q, v], rate| {
                scratch.kinematics.update_velocity(model, q, v);
                frame_jacobian_rate_into(model, &scratch.kinematics, &frame, rate);
            },
        )
    }

    /// The distance of two points of bodies, m, and its gradient ∂l/∂q, shape ``(nv,)``.
    ///
    /// Each point is a tuple of a body and its place there, m: ``("forearm", [0.1, 0, 0])``. A tension F has the generalized force −F ∂l/∂q.
    #[pyo3(signature = (from_, to, q, out=None))]
    fn pair_length<'py>(
        &self,
        from_: (String, [f64; 3]),
        to: (String, [f64; 3]),
        q: &Any<'py>,
        out: Option<&Any<'py>>,
    ) -> PyResult<[Any<'py>; 2]> {
        let (from, to) = (self.site(q.py(), &from_.0, from_.1)?, self.site(q.py(), &to.0, to.1)?);
        let (n, still) = (self.nv(), vec![0.0; self.nv()]);
        let shapes: [&[usize]; 2] = [&[], &[n]];
        let together = |m: &Model, w: &mut BatchWorkspace, [q]: [&[f64]; 1], [length, gradient]: [&mut [f64]; 2]| {
            let (rows, mut rates) = (length.len(), vec![0.0; length.len()]);
            batch::pair_into(m, w, [&from, &to], q, &vec![0.0; rows * n], [length, &mut rates, gradient])
        };
        each(&self.core, [(q, Q("q"))], shapes, out, together, |model, scratch, [q], [length, gradient]| {
            scratch.kinematics.update_velocity(model, q, &still);
            length[0] = pair_into(model, &scratch.kinematics, &from, &to, gradient).length;
        })
    }
}
