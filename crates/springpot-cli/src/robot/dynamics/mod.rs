//! `springpot dynamics`.

mod along;
mod answer;
mod json_text;
mod latex;
mod order;
mod states;
mod terms;

use crate::arguments::DynamicsOptions;
use crate::robot::{Refused, Robot};
use crate::{Ending, diagnostic, plain, printed, robot};
use answer::Answers;
use springpot::law::Catalog;
use springpot::model::{Dimension, Frame};
use springpot_run::numbers::{count, short};
use springpot_scenario::suggest;
use states::States;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

/// Most velocities for which nv × nv matrices, and nv × nv × nv symbols, are printed.
const MOST_VELOCITIES: usize = 3_000;
const MOST_WITH_CHRISTOFFEL: usize = 400;
/// States that are named one by one in an error.
const NAMED: usize = 5;

pub(crate) fn dynamics(options: &DynamicsOptions, catalog: &Catalog) -> Ending {
    let ended = match (&options.states, &options.at) {
        (Some(file), _) => in_states(options, catalog, file),
        (None, Some(at)) => along::at(options, catalog, at),
        (None, None) => unreachable!("one of them is required"),
    };
    ended.unwrap_or(Ending::Refused)
}

/// Reads everything before anything is printed.
fn in_states(options: &DynamicsOptions, catalog: &Catalog, file: &Path) -> Result<Ending, Refused> {
    let robot = robot::read(&options.robot, &options.overrides, catalog)?;
    let frame = options.frame.as_deref().map(|name| find_frame(&robot, name)).transpose()?;
    check_size(&robot, options.christoffel)?;
    let read = states::source(file).and_then(|source| states::read(&robot, &source));
    let states = read.map_err(|refusals| {
        diagnostic::refused(&refusals);
        Refused
    })?;
    robot.warn();
    if let Some(left_out) = joint_losses(&robot) {
        diagnostic::warning(format!("joint damping and friction are no part of the numbers: {left_out}"), None);
    }
    for warning in &states.warnings {
        diagnostic::warning(warning, None);
    }
    let stdout = io::stdout().lock();
    match print(stdout, &robot, &states, options.christoffel, frame) {
        Ok(wrong) if !wrong.is_empty() => {
            complain(&wrong);
            Ok(Ending::Failed)
        }
        ended => Ok(printed(ended.map(drop))),
    }
}

fn find_frame(robot: &Robot, name: &str) -> Result<Frame, Refused> {
    let found = robot.find_frame(name).and_then(|body| robot.model.frame(body).ok());
    found.ok_or_else(|| {
        let bodies = robot.bodies.iter().map(|body| body.name.as_str());
        let joints = robot.bodies.iter().map(|body| body.joint.name.as_str());
        let names: Vec<&str> = bodies.chain(joints).chain([robot.base.0.as_str()]).collect();
        let message = format!("--frame {name:?}: the robot has no link and no joint of that name");
        diagnostic::error_with_help(message, suggest(name, names.iter().copied()));
        Refused
    })
}

/// Refuses what no computer holds, and symbols that do not exist.
fn check_size(robot: &Robot, christoffel: bool) -> Result<(), Refused> {
    let n = robot.model.nv();
    let refuse = |message: String| {
        diagnostic::error(message);
        Err(Refused)
    };
    if n > MOST_VELOCITIES {
        return refuse(format!("the robot has nv = {n}; matrices are printed up to nv = {MOST_VELOCITIES}"));
    }
    if !christoffel {
        return Ok(());
    }
    let several = |(joint, _): &(usize, &str)| robot.model.joint_space(*joint).nv() != 1;
    if let Some((joint, name)) = robot.own_joints().find(several) {
        let degrees = robot.model.joint_space(joint).nv();
        return refuse(format!(
            "--christoffel: joint {name:?} has {degrees} degrees of freedom, and Christoffel symbols exist only where every \
             joint has one; \"coriolis\" holds the forces C v of all joints"
        ));
    }
    if n > MOST_WITH_CHRISTOFFEL {
        return refuse(format!(
            "--christoffel: the robot has nv = {n}; Christoffel symbols are printed up to nv = {MOST_WITH_CHRISTOFFEL}"
        ));
    }
    Ok(())
}

/// The joints that lose energy, by value.
fn joint_losses(robot: &Robot) -> Option<String> {
    let model = &robot.model;
    let mut groups: BTreeMap<(&str, u64, &str), Vec<&str>> = BTreeMap::new();
    for (j, name) in model.joint_names().iter().enumerate() {
        let slides = model.joint_space(j).dimension() == Some(Dimension::Length);
        let (damping, friction) = if slides { ("N·s/m", "N") } else { ("N·m·s/rad", "N·m") };
        for (what, value, unit) in
            [("damping", model.damping()[j], damping), ("friction", model.friction()[j], friction)]
        {
            if value != 0.0 {
                groups.entry((what, value.to_bits(), unit)).or_default().push(name);
            }
        }
    }
    let group = |((what, bits, unit), names): (&(&str, u64, &str), &Vec<&str>)| {
        format!("{what} {} {unit} of {}", short(f64::from_bits(*bits)), names.join(", "))
    };
    let groups: Vec<String> = groups.iter().map(group).collect();
    (!groups.is_empty()).then(|| groups.join("; "))
}

/// Writes the answer state by state; returns what is wrong with the terms of some.
fn print(
    out: impl Write,
    robot: &Robot,
    States { order, states, .. }: &States,
    christoffel: bool,
    frame: Option<Frame>,
) -> io::Result<Vec<(usize, String)>> {
    let mut out = io::BufWriter::new(out);
    let mut answers = Answers::new(&robot.model, order, christoffel, frame);
    let joints = serde_json::to_string(&order.joints)?;
    write!(out, "{{\"joints\": {},\n\"states\": [", plain::json(&joints))?;
    let mut wrong = Vec::new();
    let mut text = String::new();
    for (k, state) in states.iter().enumerate() {
        text.clear();
        text.push_str(if k == 0 { "\n" } else { ",\n" });
        let not_finite = answers.write(state, &mut text);
        if !not_finite.is_empty() {
            let (are, list) = (if not_finite.len() == 1 { "is" } else { "are" }, not_finite.join(", "));
            wrong.push((
                k,
                format!("{list} {are} not finite and written as null: the mass matrix is singular there, or numbers overflow"),
            ));
        } else if let Some(joint) = answers.indefinite_joint() {
            wrong.push((
                k,
                format!(
                    "the mass matrix is not positive definite at joint {joint:?}: an accepted inertia is negative there, and aba \
                     and its derivatives mean nothing"
                ),
            ));
        }
        out.write_all(text.as_bytes())?;
    }
    out.write_all(b"\n]}\n")?;
    out.flush()?;
    Ok(wrong)
}

fn complain(wrong: &[(usize, String)]) {
    for (k, what) in wrong.iter().take(NAMED) {
        diagnostic::error(format!("states[{k}]: {what}"));
    }
    if wrong.len() > NAMED {
        diagnostic::error(format!("so it is in {}", count(wrong.len() - NAMED, "other state", "other states")));
    }
}
