//! The tables of `springpot info`.

use crate::grid::{Grid, Set};
use crate::plain;
use crate::robot::Robot;
use springpot::model::{Dimension, JointSpec, Limits, Parent};
use springpot_run::numbers::brief;
use std::ops::Range;

/// Branches in branches that are drawn; deeper ones stand at the same indentation.
const MOST_LEVELS: usize = 10;

/// Joints and the links that they move, as a tree: what is alone on the link above stands under it, several are branches.
pub(super) fn tree(robot: &Robot) -> Grid {
    let model = &robot.model;
    // By link; a joint of several coordinates moves the link of its last one.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); model.joint_count() + 1];
    for joint in model.described_joints() {
        children[model.parent_link(joint.joints.start)].push(joint.joints.end - 1);
    }
    let columns = [("joint", Set::Name), ("link", Set::Name), ("kind", Set::Text), ("axis", Set::Text)];
    let mut grid = Grid::new(columns.into_iter().chain([("mass, kg", Set::Number)]));
    let base = plain::line(&robot.base.0);
    let fixed = robot.fixed_mass();
    let mass = if fixed == 0.0 { String::new() } else { brief(fixed) };
    let is_named = base != "world";
    grid.row(vec![String::new(), base, if is_named { "world" } else { "" }.to_owned(), String::new(), mass]);

    // What is still to be drawn, the next one last: joint, its branch, and what stands before all that it carries.
    let mut rest: Vec<(usize, &str, String)> = Vec::new();
    let branches = |link: usize, before: &str| -> Vec<(usize, &str, String)> {
        let joints = &children[link];
        let levels = before.chars().count() / 3;
        let branch = |(k, &joint): (usize, &usize)| match joints.len() {
            1 => (joint, "", before.to_owned()),
            _ if levels >= MOST_LEVELS => (joint, "┄ ", before.to_owned()),
            n if k + 1 == n => (joint, "└─ ", format!("{before}   ")),
            _ => (joint, "├─ ", format!("{before}│  ")),
        };
        joints.iter().enumerate().rev().map(branch).collect()
    };
    rest.extend(branches(0, ""));
    while let Some((joint, branch, before)) = rest.pop() {
        let drawn = match branch {
            "" | "┄ " => before.clone(),
            _ => before.chars().take(before.chars().count() - 3).collect(),
        };
        let body = &robot.bodies[model.joint_body(joint)];
        let kind = body.joint.kind;
        grid.row(vec![
            format!("{drawn}{branch}{}", plain::line(&body.joint.name)),
            plain::line(&body.name),
            kind.name().to_owned(),
            axes(&body.joint),
            brief(model.link_inertia(joint).mass),
        ]);
        rest.extend(branches(joint + 1, &before));
    }
    grid
}

/// Where the joints' numbers stand in q and v, what they are built for, what they lose.
pub(super) fn joints(robot: &Robot) -> Grid {
    let model = &robot.model;
    let titles = ["q", "v", "from", "to"].map(|title| (title, Set::Number));
    let more = ["speed", "effort", "damping", "friction", "armature"].map(|title| (title, Set::Number));
    let columns = [("joint", Set::Name)].into_iter().chain(titles).chain([("", Set::Text)]).chain(more);
    let mut grid = Grid::new(columns);
    let all = 0..model.joint_count();
    let any = |finite: fn(&Limits) -> bool| all.clone().any(|j| finite(model.limits(j)));
    let ranges = any(|limits| limits.lower.is_finite() || limits.upper.is_finite());
    let (speeds, efforts) = (any(|limits| limits.velocity.is_finite()), any(|limits| limits.effort.is_finite()));
    let some = |values: &[f64]| values.iter().any(|value| *value != 0.0);
    let [damped, rubs, has_rotors] = [model.damping(), model.friction(), model.armature()].map(some);
    for j in all {
        let dimension = model.joint_space(j).dimension();
        let own = model.followed(j).is_none();
        let Limits { lower, upper, velocity, effort } = *model.limits(j);
        let shown = |shown: bool, value: f64| if shown && dimension.is_some() { limit(value) } else { String::new() };
        grid.row(vec![
            plain::line(&model.joint_names()[j]),
            if own { numbers(model.q_range(j)) } else { String::new() },
            if own { numbers(model.v_range(j)) } else { String::new() },
            shown(ranges, lower),
            shown(ranges, upper),
            dimension.map_or("", |dimension| dimension.units().coordinate).to_owned(),
            shown(speeds, velocity),
            shown(efforts, effort),
            shown(damped, model.damping()[j]),
            shown(rubs, model.friction()[j]),
            shown(has_rotors, model.armature()[j]),
        ]);
    }
    grid.without_empty_columns()
}

/// The units of what [`joints`] shows.
pub(super) fn units(robot: &Robot) -> String {
    let model = &robot.model;
    let all = 0..model.joint_count();
    let finite = |what: fn(&Limits) -> f64| all.clone().any(|j| what(model.limits(j)).is_finite());
    let shown = [
        (finite(|limits| limits.velocity), "speed", ["rad/s", "m/s"]),
        (finite(|limits| limits.effort), "effort", ["N·m", "N"]),
        (model.damping().iter().any(|d| *d != 0.0), "damping", ["N·m·s/rad", "N·s/m"]),
        (model.friction().iter().any(|f| *f != 0.0), "friction", ["N·m", "N"]),
        (model.armature().iter().any(|a| *a != 0.0), "armature", ["kg·m²", "kg"]),
    ];
    let kinds: Vec<usize> = [Dimension::Angle, Dimension::Length]
        .into_iter()
        .enumerate()
        .filter(|(_, dimension)| all.clone().any(|j| model.joint_space(j).dimension() == Some(*dimension)))
        .map(|(k, _)| k)
        .collect();
    let shown = shown.into_iter().filter(|(shown, ..)| *shown);
    let unit = |(_, what, units): (bool, &str, [&str; 2])| {
        let units: Vec<&str> = kinds.iter().map(|&k| units[k]).collect();
        format!("{what} in {}", units.join(" or "))
    };
    shown.map(unit).collect::<Vec<_>>().join(", ")
}

/// `b = -1·a + 0.5`, for every joint b that follows a joint a.
pub(super) fn followers(robot: &Robot) -> Vec<String> {
    let model = &robot.model;
    let names = model.joint_names();
    let follower = |j: usize| {
        let (leader, ratio, offset) = model.followed(j)?;
        let factor = if ratio == 1.0 { String::new() } else { format!("{}·", brief(ratio)) };
        let sum = match offset {
            0.0 => String::new(),
            offset if offset < 0.0 => format!(" - {}", brief(-offset)),
            offset => format!(" + {}", brief(offset)),
        };
        Some(format!("{} = {factor}{}{sum}", plain::line(&names[j]), plain::line(&names[leader])))
    };
    (0..model.joint_count()).filter_map(follower).collect()
}

/// The links on fixed joints by what carries them: the world, or a link that moves.
pub(super) fn frames(robot: &Robot) -> Vec<(String, String)> {
    let mut groups: Vec<Vec<String>> = vec![Vec::new(); robot.model.joint_count() + 1];
    for (index, body) in robot.fixed_bodies() {
        if let Ok(frame) = robot.model.frame(Parent::Body(index)) {
            groups[frame.link()].push(plain::line(&body.name));
        }
    }
    let groups = groups.into_iter().enumerate().filter(|(_, links)| !links.is_empty());
    groups.map(|(link, links)| (plain::line(robot.body_name(robot.carrier(link))), links.join(", "))).collect()
}

/// `3`, or `0-6`.
fn numbers(range: Range<usize>) -> String {
    if range.len() == 1 { range.start.to_string() } else { format!("{}-{}", range.start, range.end - 1) }
}

/// At most four digits behind the point.
fn limit(value: f64) -> String {
    let rounded = (value * 1e4).round() / 1e4;
    match value {
        f64::INFINITY => "∞".to_owned(),
        f64::NEG_INFINITY => "-∞".to_owned(),
        _ if rounded == 0.0 || value.abs() > 1e4 => brief(value),
        _ => brief(rounded),
    }
}

/// The axes of a joint and its lead, as far as it has them.
fn axes(joint: &JointSpec) -> String {
    let mut text = if joint.kind.has_axis() { axis(joint.axis) } else { String::new() };
    if joint.kind.has_axis2() {
        text += &format!(", then {}", axis(joint.axis2));
    }
    if joint.kind.has_lead() {
        text += &format!(", {} m per turn", brief(joint.lead));
    }
    text
}

/// `z`, `-y`, or the components of the direction.
fn axis(axis: [f64; 3]) -> String {
    let largest = axis.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let scaled = axis.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = scaled.map(|x| x / length);
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        if 1.0 - unit[k].abs() < 1e-12 {
            return if unit[k] < 0.0 { format!("-{name}") } else { name.to_owned() };
        }
    }
    let [x, y, z] = unit.map(|x| format!("{}", (x * 1e3).round() / 1e3 + 0.0));
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::axis;

    #[test]
    fn axes_are_short() {
        assert_eq!(axis([0.0, 0.0, 2.0]), "z");
        assert_eq!(axis([-1e-200, 0.0, 0.0]), "-x");
        assert_eq!(axis([3.0, -1e-5, 4.0]), "(0.6, 0, 0.8)");
    }
}
