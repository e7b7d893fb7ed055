//! `urdf` and `mjcf` of `[robot]`: a robot from a file.

use crate::reader::{Field, Read, Refused, Table, all};
use crate::robot::changed;
use crate::robot::described::Parts;
use crate::robot::described::{BodyPlaces, DescriptionPlan};
use crate::text::refusal::{RefusalKind, Remark};
use springpot::model::description::{DescriptionError, DescriptionOptions, DescriptionProblem, DescriptionWarningKind};
use springpot::model::{Label, Model};
use std::collections::HashSet;
use std::sync::Arc;

/// Most moving joints of a robot in a scenario: every one makes columns.
const MAX_JOINTS: usize = 10_000;
/// Most folders of `package_path`.
const MAX_FOLDERS: usize = 1_000;

/// Reads the file that `field`, the `urdf` or `mjcf` of `table`, names.
pub(super) fn read(table: &Table<'_>, field: &Field<'_>, gravity: Read<[f64; 3]>) -> Read<Parts> {
    let is_urdf = field.key == "urdf";
    let flag = |key: &'static str| if is_urdf { table.flag(key) } else { Ok(false) };
    let (floating_base, ignore_mimic) = (flag("floating_base"), flag("ignore_mimic"));
    let accept_inertia = table.flag("accept_inertia");
    let package_path = table.get("package_path").map_or(Ok(Vec::new()), |field| folders(&field));
    let written = field.text()?.to_owned();
    let accepted = table.get("accept").map_or(Ok(Vec::new()), |field| accepted(&field));
    let (floating_base, ignore_mimic, package_path) = (floating_base?, ignore_mimic?, package_path?);
    let accept_inertia = accept_inertia?;
    field.ctx.robots.accept(accepted?);

    let options = DescriptionOptions {
        floating_base,
        ignore_mimic,
        accept_inertia,
        package_path: package_path.iter().map(|folder| field.ctx.folder.join(folder)).collect(),
    };
    let robot = field.ctx.robots.read(&written, field.ctx.folder.join(&written), options);
    let mut robot = robot.map_err(|error| refuse(field, &error))?;
    if robot.is_mjcf() == is_urdf {
        let (is, key) = if is_urdf { ("an MJCF", "mjcf") } else { ("a URDF", "urdf") };
        let help = format!("write {key} = {written:?}");
        return Err(field.refuse(RefusalKind::Rule, format!("names {is} file"), Some(help)));
    }
    let place = BodyPlaces { table: field.node.place.clone(), fields: Vec::new() };
    let mut changes = vec![place; robot.bodies.len()];
    if let Some(joints) = table.get("joint") {
        changed::change(&joints, &mut Arc::make_mut(&mut robot).bodies, &mut changes)?;
    }
    let gravity = match robot.gravity {
        Some(own) if table.get("gravity").is_none() => own,
        _ => gravity?,
    };
    let model = robot.model(gravity).map_err(|error| {
        let DescriptionProblem::Model { source } = &*error.problem else { return refuse(field, &error) };
        let subject = source.subject().and_then(|subject| Some((changes.get(subject.body)?, subject.field.key())));
        let own = subject.and_then(|(changes, key)| changes.fields.iter().find(|(field, _)| field == key));
        match own {
            // It is the scenario that says so, not the file.
            Some((_, place)) => {
                field.ctx.refuse(place.refuse(RefusalKind::Rule, source.to_string()).label("not physical"))
            }
            None => refuse(field, &error),
        }
    })?;
    if model.joint_count() == 0 {
        let help = is_urdf.then(|| "floating_base = true lets it move as a whole".to_owned());
        return Err(field.refuse(RefusalKind::Missing, "has no joint that moves: all are fixed", help));
    }
    if model.joint_count() > MAX_JOINTS {
        let message = format!("has {} moving joints; at most {MAX_JOINTS} are taken", model.joint_count());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    if let Some(column) = shared_column(&model) {
        let message = format!("has joints whose names make the same column twice: {column:?}");
        return Err(field.refuse(RefusalKind::BadName, message, Some("rename one of them in the file".to_owned())));
    }
    let place = BodyPlaces { table: field.node.place.clone(), fields: Vec::new() };
    Ok(Parts {
        bodies: robot.bodies.clone(),
        places: vec![place; robot.bodies.len()],
        model: Arc::new(model),
        urdf: Some(DescriptionPlan { written, ignore_mimic, package_path, robot }),
    })
}

/// Kinds of warnings by their names.
fn accepted(field: &Field<'_>) -> Read<Vec<DescriptionWarningKind>> {
    let items = field.items("an array of kinds of warnings")?;
    all(items.iter().map(|item| {
        let word = item.word("kind of warning")?;
        DescriptionWarningKind::ALL.into_iter().find(|kind| kind.name() == word).ok_or(Refused)
    }))
}

/// One folder, or an array of them; says which are not there.
fn folders(field: &Field<'_>) -> Read<Vec<String>> {
    let folder = |item: &Field<'_>| -> Read<String> {
        let written = item.text()?.to_owned();
        let folder = item.ctx.folder.join(&written);
        if !folder.is_dir() {
            let message =
                format!("`package_path` of [robot] names {written:?}, and there is no folder {}", folder.display());
            let help = "it is relative to the scenario; meshes are looked for in it";
            item.ctx.warn(Remark::at(&item.node.place, message).help(help));
        }
        Ok(written)
    };
    if field.node.text().is_some() {
        return Ok(vec![folder(field)?]);
    }
    let items = field.items("the path of a folder, or an array of them")?;
    if items.len() > MAX_FOLDERS {
        let message = format!("holds {} folders; at most {MAX_FOLDERS} are taken", items.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    all(items.iter().map(folder))
}

/// Refuses a file, with its own place in the words of the reader of URDF files.
fn refuse(field: &Field<'_>, error: &DescriptionError) -> Refused {
    let help = match &*error.problem {
        DescriptionProblem::Unreadable { .. } | DescriptionProblem::NotAFile => {
            Some("write the path of the robot's file, relative to the scenario".to_owned())
        }
        problem if problem.is_of_no_mass() => {
            Some("correct it, or write accept_inertia = true in [robot] to take it as it is".to_owned())
        }
        _ => None,
    };
    let refusal = field.refusal(RefusalKind::File, format!("cannot be used: {error}"));
    field.ctx.refuse(refusal.label("this file").help_if(help))
}

/// A name that two of the numbers of q, or two of those of v, have.
fn shared_column(model: &Model) -> Option<String> {
    let twice = |labels: Vec<Label>| {
        let mut seen = HashSet::new();
        labels.into_iter().map(|label| label.name).find(|name| !seen.insert(name.clone()))
    };
    twice(model.q_labels()).or_else(|| twice(model.v_labels()))
}
