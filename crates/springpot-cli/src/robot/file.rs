//! The robot that a command is about, from a file of its own or from the `[robot]` of a scenario.

use crate::arguments::RobotOptions;
use crate::diagnostic;
use springpot::law::Catalog;
use springpot::model::description::{DescriptionOptions, DescriptionWarning, RobotDescription};
use springpot::model::{BodySpec, JointKind, Model, Parent};
use springpot_scenario::{RobotPlan, Scenario};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Gravity of a robot whose file says nothing of it, m/s².
const STANDARD_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// A robot as it is described, and the model built of it.
#[derive(Debug)]
pub(crate) struct Robot {
    /// Its name in its file, or else the stem of the file.
    pub(crate) name: String,
    pub(crate) model: Arc<Model>,
    /// In the order of [`Model::body_names`].
    pub(crate) bodies: Vec<BodySpec>,
    /// What the world is called, and the mass of that link, kg.
    pub(crate) base: (String, f64),
    /// The gripper of a scenario: its body and its point there, m.
    pub(crate) gripper: Option<(String, [f64; 3])>,
    /// Its file, if there is one.
    pub(crate) urdf: Option<PathBuf>,
    /// What of it was not used or was assumed.
    pub(crate) warnings: Vec<DescriptionWarning>,
}

/// The robot was refused; why is on stderr.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Refused;

/// Whether the file is a scenario, not that of a robot.
pub(crate) fn is_scenario(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// Reads the robot, where it is one of a scenario with the laws of `catalog`; what is wrong goes to stderr.
pub(crate) fn read(options: &RobotOptions, overrides: &[String], catalog: &Catalog) -> Result<Robot, Refused> {
    if is_scenario(&options.file) { from_scenario(options, overrides, catalog) } else { from_urdf(options, overrides) }
}

fn from_urdf(options: &RobotOptions, overrides: &[String]) -> Result<Robot, Refused> {
    if !overrides.is_empty() {
        diagnostic::error("--set changes values of a scenario; a robot's file is taken as it is");
        return Err(Refused);
    }
    let how = DescriptionOptions {
        floating_base: options.floating_base,
        ignore_mimic: options.ignore_mimic,
        accept_inertia: options.accept_inertia,
        package_path: options.package_path.clone(),
    };
    let read = RobotDescription::read(&options.file, &how).and_then(|urdf| {
        let model = urdf.model(urdf.gravity.unwrap_or(STANDARD_GRAVITY))?;
        Ok((urdf, model))
    });
    let (urdf, model) = read.map_err(|error| {
        diagnostic::description_refused(&error);
        Refused
    })?;
    Ok(Robot {
        base: base(&urdf),
        name: if urdf.name.is_empty() { stem(&options.file) } else { urdf.name },
        model: Arc::new(model),
        bodies: urdf.bodies,
        gripper: None,
        urdf: urdf.file,
        warnings: urdf.warnings,
    })
}

/// Refuses what only a robot's file can be asked for.
pub(crate) fn refuse_urdf_flags(options: &RobotOptions) -> Result<(), Refused> {
    let given = [
        ("--floating-base", options.floating_base, "floating_base = true"),
        ("--ignore-mimic", options.ignore_mimic, "ignore_mimic = true"),
        ("--accept-inertia", options.accept_inertia, "accept_inertia = true"),
        ("--package-path", !options.package_path.is_empty(), "package_path = [\"DIR\"]"),
    ];
    let Some((flag, _, key)) = given.into_iter().find(|(_, given, _)| *given) else { return Ok(()) };
    let message = format!("{flag} is for files of robots, and {} is a scenario", options.file.display());
    diagnostic::error_with_help(message, format!("write {key} beside its file in its [robot]"));
    Err(Refused)
}

fn from_scenario(options: &RobotOptions, overrides: &[String], catalog: &Catalog) -> Result<Robot, Refused> {
    refuse_urdf_flags(options)?;
    let read = Scenario::read(&options.file).and_then(|mut scenario| {
        for assignment in overrides {
            scenario.set(assignment)?;
        }
        scenario.robot(catalog)
    });
    let RobotPlan { model, bodies, urdf, gripper, .. } = read.map_err(|refusals| {
        diagnostic::refused(&refusals);
        Refused
    })?;
    let urdf = urdf.map(|plan| plan.robot);
    Ok(Robot {
        name: urdf
            .as_ref()
            .map(|urdf| urdf.name.clone())
            .filter(|name| !name.is_empty())
            .unwrap_or(stem(&options.file)),
        model,
        bodies,
        base: urdf.as_ref().map_or(("world".to_owned(), 0.0), |urdf| base(urdf)),
        gripper: gripper.map(|gripper| (gripper.body, gripper.anchor.point)),
        urdf: urdf.as_ref().and_then(|urdf| urdf.file.clone()),
        warnings: urdf.map_or(Vec::new(), |urdf| urdf.warnings.clone()),
    })
}

/// What the world is called, and the mass of that link, kg.
fn base(urdf: &RobotDescription) -> (String, f64) {
    match urdf.floating_base {
        true => ("world".to_owned(), 0.0),
        false => (urdf.root.name.clone(), urdf.root.inertial.map_or(0.0, |inertial| inertial.mass)),
    }
}

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

impl Robot {
    /// Names of the joints that have coordinates of their own, in the order of q, with their numbers in the model.
    pub(crate) fn own_joints(&self) -> impl Iterator<Item = (usize, &str)> {
        let names = self.model.joint_names().iter().enumerate();
        names.filter(|(j, _)| self.model.followed(*j).is_none()).map(|(j, name)| (j, name.as_str()))
    }

    /// Name of the body, or of the world.
    pub(crate) fn body_name(&self, body: Parent) -> &str {
        match body {
            Parent::World => &self.base.0,
            Parent::Body(index) => &self.bodies[index].name,
        }
    }

    /// The link called `name`, or else the link that the joint of that name moves.
    pub(crate) fn find_frame(&self, name: &str) -> Option<Parent> {
        let of_joint = || self.bodies.iter().position(|body| body.joint.name == name).map(Parent::Body);
        self.model.find_body(name).or_else(of_joint)
    }

    /// The body whose joint moves `link`, or the world.
    pub(crate) fn carrier(&self, link: usize) -> Parent {
        link.checked_sub(1).map_or(Parent::World, |joint| Parent::Body(self.model.joint_body(joint)))
    }

    /// Bodies on fixed joints.
    pub(crate) fn fixed_bodies(&self) -> impl Iterator<Item = (usize, &BodySpec)> {
        self.bodies.iter().enumerate().filter(|(_, body)| body.joint.kind == JointKind::Fixed)
    }

    /// Mass of all that moves, kg.
    pub(crate) fn moving_mass(&self) -> f64 {
        let model = &self.model;
        (0..model.joint_count()).map(|j| model.link_inertia(j).mass).sum()
    }

    /// Mass of all that is fixed to the world, kg.
    pub(crate) fn fixed_mass(&self) -> f64 {
        let fixed = self.bodies.iter().enumerate().filter(|(index, _)| {
            let frame = self.model.frame(Parent::Body(*index));
            frame.is_ok_and(|frame| frame.link() == 0)
        });
        self.base.1 + fixed.map(|(_, body)| body.mass).sum::<f64>()
    }

    /// Prints the warnings of its file on stderr.
    pub(crate) fn warn(&self) {
        let file = self.urdf.as_deref().unwrap_or(Path::new("")).display();
        for warning in &self.warnings {
            diagnostic::warning(format!("{file}: {warning}"), None);
        }
    }
}
