//! What models are made of: files, texts and dicts; a model that is sent to another process is made there again.

use super::PyModel;
use super::core::Core;
use crate::error::{description_error, guarded, missing_model, model_error, scenario_error};
use crate::pickle::{self, Reduced, reduced};
use crate::scenario::{CATALOG, asked};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use springpot::model::description::{DescriptionOptions, RobotDescription};
use springpot::spatial::Rotation;
use springpot_run::Asked;
use springpot_scenario::RobotPlan;
use std::path::PathBuf;
use std::sync::Arc;

/// What the bytes of a model begin with.
const TAG: &str = "springpot model 2\n";

/// Gravity of a robot whose file says nothing of it, m/s².
const STANDARD_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// All that a model is made of, but the files that a scenario names.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum Origin {
    File { path: PathBuf, text: String, options: DescriptionOptions, gravity: Option<[f64; 3]> },
    Scenario(Asked),
}

impl Origin {
    fn model(self, py: Python<'_>) -> PyResult<PyModel> {
        match &self {
            Self::File { path, text, options, gravity } => {
                let built = RobotDescription::parse(text, Some(path), options).and_then(|urdf| {
                    let model = urdf.model(gravity.or(urdf.gravity).unwrap_or(STANDARD_GRAVITY))?;
                    Ok((urdf, model))
                });
                let (urdf, model) = built.map_err(|error| description_error(py, &error))?;
                let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                Ok(PyModel {
                    core: Core::new(Arc::new(model)),
                    name: if urdf.name.is_empty() { stem() } else { urdf.name },
                    bodies: urdf.bodies,
                    gripper: None,
                    warnings: urdf.warnings.iter().map(ToString::to_string).collect(),
                    origin: self,
                })
            }
            Self::Scenario(asked) => {
                let plan = asked.scenario().and_then(|scenario| scenario.robot(&CATALOG));
                let plan = plan.map_err(|refusals| scenario_error(py, &refusals))?;
                PyModel::of(py, plan, self)
            }
        }
    }
}

#[pymethods]
impl PyModel {
    /// The robot of a URDF file.
    ///
    /// Args:
    ///     path: the file.
    ///     floating_base: whether the root link floats, on a joint called ``floating_base``: seven coordinates x y z qx qy qz qw, the real part of
    ///         the quaternion last, and six velocities vx vy vz wx wy wz in its own axes: both as Pinocchio has them. MuJoCo has the real part
    ///         first, and the linear velocity in the axes of the world.
    ///     ignore_mimic: whether joints that follow others have coordinates of their own.
    ///     accept_inertia: whether inertias that no distribution of mass has are taken.
    ///     package_path: folders that are packages or hold some.
    ///     gravity: m/s², shape ``(3,)``; (0, 0, −9.81) where left out.
    ///
    /// Raises:
    ///     ModelError: what is wrong, with the file and the line; a FileNotFoundError too where there is no such file.
    #[staticmethod]
    #[pyo3(signature = (path, floating_base=false, *, ignore_mimic=false, accept_inertia=false, package_path=Vec::new(), gravity=None))]
    fn from_urdf(
        py: Python<'_>,
        path: PathBuf,
        floating_base: bool,
        ignore_mimic: bool,
        accept_inertia: bool,
        package_path: Vec<PathBuf>,
        gravity: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        guarded(py, || {
            let text = RobotDescription::read_text(&path).map_err(|error| match path.try_exists() {
                Ok(false) => missing_model(py, &error, &path),
                _ => description_error(py, &error),
            })?;
            let options = DescriptionOptions { floating_base, ignore_mimic, accept_inertia, package_path };
            Origin::File { path, text, options, gravity }.model(py)
        })
    }

    /// The robot of an MJCF file.
    ///
    /// Coordinates of hinges and slides are the file's qpos. What is free has x y z qx qy qz qw, the real part of the quaternion last, and vx vy vz wx wy wz in
    /// its own axes; MuJoCo has the real part first, and the linear velocity in the axes of the world. ``stiffness`` of joints makes elements of scenarios and
    /// is no part of this model.
    ///
    /// Args:
    ///     path: the file.
    ///     accept_inertia: whether inertias that no distribution of mass has are taken.
    ///     package_path: folders that hold what it includes and its meshes, beside its own.
    ///     gravity: m/s², shape ``(3,)``; the file's where left out.
    ///
    /// Raises:
    ///     ModelError: what is wrong, with the file and the line; a FileNotFoundError too where there is no such file.
    #[staticmethod]
    #[pyo3(signature = (path, *, accept_inertia=false, package_path=Vec::new(), gravity=None))]
    fn from_mjcf(
        py: Python<'_>,
        path: PathBuf,
        accept_inertia: bool,
        package_path: Vec<PathBuf>,
        gravity: Option<[f64; 3]>,
    ) -> PyResult<Self> {
        Self::from_urdf(py, path, false, false, accept_inertia, package_path, gravity)
    }

    /// The robot of a scenario: a path, a text (with a line break or ``=``) or a dict, of which ``[robot]`` alone counts.
    ///
    /// Args:
    ///     scenario: the scenario.
    ///     set: values in place of its own, by dotted path: ``{"robot.gravity": [0, 0, -1.62]}``.
    ///
    /// Raises:
    ///     ScenarioError: what is wrong, and where.
    #[staticmethod]
    #[pyo3(signature = (scenario, *, set=None))]
    fn from_scenario(py: Python<'_>, scenario: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        guarded(py, || Origin::Scenario(asked(scenario, set)?).model(py))
    }

    /// What `__reduce__` made.
    #[staticmethod]
    fn _from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let origin: Origin = pickle::of_bytes(TAG, "model", bytes)?;
        guarded(py, || origin.model(py))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "_from_bytes", pickle::to_bytes(py, TAG, &self.origin)?)
    }
}

impl PyModel {
    /// The robot of a scenario.
    pub(crate) fn of(py: Python<'_>, robot: RobotPlan, origin: Origin) -> PyResult<Self> {
        let gripper = match &robot.gripper {
            None => None,
            Some(gripper) => {
                let frame = robot.model.resolve_frame(&gripper.anchor, &Rotation::IDENTITY);
                Some((frame.map_err(|error| model_error(py, error))?, gripper.body.clone()))
            }
        };
        let urdf = robot.urdf.as_ref().map(|urdf| &urdf.robot);
        Ok(Self {
            core: Core::new(robot.model),
            name: urdf.map_or_else(String::new, |urdf| urdf.name.clone()),
            warnings: urdf.map_or_else(Vec::new, |urdf| urdf.warnings.iter().map(ToString::to_string).collect()),
            bodies: robot.bodies,
            gripper,
            origin,
        })
    }
}
