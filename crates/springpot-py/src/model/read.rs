//! Models from files.

use super::PyModel;
use super::core::Core;
use crate::error::{guarded, model_error, scenario_error, urdf_error};
use crate::scenario::{CATALOG, read};
use pyo3::prelude::*;
use springpot::model::urdf::{Urdf, UrdfOptions};
use springpot::spatial::Rotation;
use springpot_scenario::RobotPlan;
use std::path::PathBuf;
use std::sync::Arc;

/// Gravity of a URDF robot, m/s²; the file says nothing of it.
const STANDARD_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

#[pymethods]
impl PyModel {
    /// The robot of a URDF file.
    ///
    /// Args:
    ///     path: the file.
    ///     floating_base: whether the root link floats, on a joint called ``floating_base``: seven coordinates x y z qx qy qz qw, six velocities
    ///         vx vy vz wx wy wz in its own axes.
    ///     ignore_mimic: whether joints that follow others have coordinates of their own.
    ///     accept_inertia: whether inertias that no distribution of mass has are taken.
    ///     package_path: folders that are packages or hold some.
    ///     gravity: m/s², shape ``(3,)``; (0, 0, −9.81) where left out.
    ///
    /// Raises:
    ///     ModelError: what is wrong, with the file and the line.
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
        let options = UrdfOptions { floating_base, ignore_mimic, accept_inertia, package_path };
        guarded(py, || {
            let built = Urdf::read(&path, &options).and_then(|urdf| {
                let model = urdf.model(gravity.unwrap_or(STANDARD_GRAVITY))?;
                Ok((urdf, model))
            });
            let (urdf, model) = built.map_err(|error| urdf_error(py, &error))?;
            let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Ok(Self {
                core: Core::new(Arc::new(model)),
                name: if urdf.name.is_empty() { stem() } else { urdf.name },
                bodies: urdf.bodies,
                gripper: None,
                warnings: urdf.warnings.iter().map(ToString::to_string).collect(),
            })
        })
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
        guarded(py, || {
            let scenario = read(scenario, set)?;
            let plan = scenario.robot(&CATALOG).map_err(|refusals| scenario_error(py, &refusals))?;
            Self::of(py, plan)
        })
    }
}

impl PyModel {
    /// The robot of a scenario.
    pub(crate) fn of(py: Python<'_>, robot: RobotPlan) -> PyResult<Self> {
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
        })
    }
}
