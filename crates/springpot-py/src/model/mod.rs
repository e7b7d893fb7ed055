//! `springpot.Model`: the robot, and every rigid-body algorithm on arrays.

mod algorithms;
mod batch;
mod core;
mod facts;
mod frames;
pub(crate) mod origin;

use self::core::Core;
use self::origin::Origin;
use crate::error::model_error;
use pyo3::prelude::*;
use springpot::model::{BodySpec, Frame, Parent};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyModel>()
}

/// A robot: bodies, joints, frames; constant, and shared by threads.
///
/// Algorithms take one state or many. ``q`` has shape ``(nq,)`` or ``(N, nq)``; ``v``, ``a``, ``tau`` have ``(nv,)`` or ``(N, nv)``; one of one
/// dimension goes with every row of the others. Results of many states have N before their shape. Many states are worked out on all cores without
/// the interpreter's lock: do not write into their arrays meanwhile. ``out`` is a C-contiguous float64 array (a tuple of them where there are
/// several results) that is written and given back. Numbers are SI, axes those of the world.
///
/// Any real dtype and strides are taken; ``ValueError`` for a wrong shape, NaN and infinities, ``TypeError`` for what holds no real numbers.
#[pyclass(frozen, name = "Model", module = "springpot._springpot")]
#[derive(Debug)]
pub(crate) struct PyModel {
    core: Core,
    name: String,
    bodies: Vec<BodySpec>,
    /// Its body and the point there, of a scenario that has one.
    gripper: Option<(Frame, String)>,
    warnings: Vec<String>,
    origin: Origin,
}

impl PyModel {
    /// The frame called `name`: a body's, the world's, or the gripper.
    fn frame(&self, py: Python<'_>, name: &str) -> PyResult<Frame> {
        let model = &self.core.model;
        match (model.find_body(name), &self.gripper) {
            (Some(body), _) => model.frame(body).map_err(|error| model_error(py, error)),
            (None, Some((frame, _))) if name == "gripper" => Ok(*frame),
            _ => {
                let known: Vec<&str> = self.frame_names().collect();
                let help = springpot_scenario::suggest(name, known.iter().copied());
                Err(model_error(py, format!("no frame is called \"{name}\"; {help}")))
            }
        }
    }

    fn frame_names(&self) -> impl Iterator<Item = &str> {
        let gripper = self.gripper.as_ref().filter(|_| self.core.model.body_index("gripper").is_none());
        let bodies = self.core.model.body_names().iter().map(String::as_str);
        std::iter::once("world").chain(bodies).chain(gripper.map(|_| "gripper"))
    }

    /// Name of a body that carries something.
    fn parent_name(&self, parent: Parent) -> &str {
        match parent {
            Parent::World => "world",
            Parent::Body(body) => &self.core.model.body_names()[body],
        }
    }
}
