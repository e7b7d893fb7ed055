//! `springpot info`.

mod json;
mod tables;

use crate::arguments::InfoOptions;
use crate::grid::width_of;
use crate::robot::{Refused, Robot};
use crate::{Ending, plain, printed, robot, terminal};
use springpot::law::Catalog;
use springpot::model::JointKind;
use springpot_run::numbers::brief;

/// Columns of the words that lead a line.
const LEAD: usize = 10;
/// Names of what carries other links stand on a line of their own where they are wider.
const WIDEST_CARRIER: usize = 24;

pub(crate) fn info(options: &InfoOptions, catalog: &Catalog) -> Ending {
    match robot::read(&options.robot, &[], catalog) {
        Ok(robot) => {
            let text = if options.json { json::text(&robot, &options.robot.file) } else { text(&robot) };
            printed(terminal::try_print(&text))
        }
        Err(Refused) => Ending::Refused,
    }
}

/// The description of a robot. Names are cut where they do not fit into a terminal, and never elsewhere.
fn text(robot: &Robot) -> String {
    let model = &robot.model;
    let (width, lines) = (terminal::stdout_columns(), terminal::stdout_width().or(Some(80)));
    let mut text = String::new();
    let mut line = |lead: &str, words: &str| {
        text.push_str(&terminal::hanging(&format!("{lead:<LEAD$}"), words, lines));
    };
    line("robot", &plain::line(&robot.name));
    line("joints", &format!("{}; nq = {}, nv = {}", kinds(robot), model.nq(), model.nv()));
    line("mass", &masses(robot));
    line("gravity", &format!("{} m/s²", vector(model.gravity())));
    if let Some((body, point)) = &robot.gripper {
        line("gripper", &format!("{} m of {}", vector(*point), plain::line(body)));
    }

    text.push('\n');
    text.push_str(&tables::tree(robot).text(width));
    text.push('\n');
    text.push_str(&tables::joints(robot).text(width));
    let units = tables::units(robot);
    if !units.is_empty() {
        text.push_str(&terminal::hanging("", &units, lines));
    }
    text.push_str(&section("joints that follow others", "  ", tables::followers(robot), lines));
    let frames = tables::frames(robot);
    let widths = frames.iter().map(|(carrier, _)| width_of(carrier)).filter(|width| *width <= WIDEST_CARRIER);
    let widest = widths.max().unwrap_or(0);
    if !frames.is_empty() {
        text.push_str("\nlinks on fixed joints, behind what carries them\n");
    }
    for (carrier, links) in frames {
        if width_of(&carrier) <= widest {
            text.push_str(&terminal::hanging(&format!("  {carrier:<widest$}  "), &links, lines));
        } else {
            text.push_str(&format!("  {carrier}\n"));
            text.push_str(&terminal::hanging(&" ".repeat(widest + 4), &links, lines));
        }
    }
    let warnings = robot.warnings.iter().map(|warning| plain::line(&warning.to_string())).collect();
    text.push_str(&section("not used or assumed", "- ", warnings, lines));
    text
}

fn vector(components: [f64; 3]) -> String {
    format!("({})", components.map(brief).join(", "))
}

/// A headline and its items; nothing where there are none.
fn section(headline: &str, lead: &str, items: Vec<String>, width: Option<usize>) -> String {
    let lines: String = items.iter().map(|item| terminal::hanging(lead, item, width)).collect();
    if lines.is_empty() { lines } else { format!("\n{headline}\n{lines}") }
}

/// How many joints of which kind there are.
fn kinds(robot: &Robot) -> String {
    let model = &robot.model;
    let of = |kind: JointKind| model.described_joints().iter().filter(|joint| joint.kind == kind).count();
    let kinds = JointKind::ALL.into_iter().filter(|kind| of(*kind) > 0);
    let kinds: Vec<String> = kinds.map(|kind| format!("{} {}", of(kind), kind.name())).collect();
    let followers = model.joint_count() - robot.own_joints().count();
    let following = match followers {
        0 => String::new(),
        1 => ", of which 1 follows another".to_owned(),
        many => format!(", of which {many} follow others"),
    };
    format!("{}{following}", kinds.join(", "))
}

fn masses(robot: &Robot) -> String {
    let fixed = robot.fixed_mass();
    let moving = format!("{} kg", brief(robot.moving_mass()));
    if fixed == 0.0 { moving } else { format!("{moving} that moves, {} kg fixed to the world", brief(fixed)) }
}
