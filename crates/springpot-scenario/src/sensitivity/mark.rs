//! Marks the numbers that are parameters, so that their readers tell what they are.

use super::asked::{Asked, By};
use super::rows::{self, LeftOut};
use crate::changes::path::{self, Step, Target};
use crate::reader::element::law_of;
use crate::reader::{Context, Read, Refused, all};
use crate::text::document::{Node, Value, shorten};
use crate::text::refusal::{Refusal, RefusalKind};
use crate::units;
use std::sync::Arc;

/// Tags every number that is a parameter, from `first` on, and puts those into the document that it leaves out.
pub(crate) fn mark(ctx: &Context<'_>, document: &mut Node, asked: &Asked, first: usize) -> Read<()> {
    let targets = asked.by.iter().flat_map(|by| &by.targets);
    let marked = targets.enumerate().map(|(k, target)| one(ctx, document, target, first + k));
    all(marked.collect::<Vec<_>>()).map(|_| ())
}

fn one(ctx: &Context<'_>, document: &mut Node, target: &Target, tag: usize) -> Read<()> {
    let refuse = |why: &str, help: Option<String>| {
        let message = format!("{} cannot be a parameter: {why}", target.written);
        let refusal = target.place.refuse(RefusalKind::Rule, message);
        Err(ctx.refuse(match help {
            Some(help) => refusal.help(help),
            None => refusal,
        }))
    };
    let is_constant = matches!(&target.steps[..], [Step::Key(section), Step::Key(_)] if section == "constants");
    let row = rows::find(&target.steps);
    if row.is_none() && !is_constant {
        let (why, help) = why_not(document, target);
        return refuse(&why, help);
    }
    let Some(node) = path::get(document, target) else {
        if is_constant {
            return refuse("there is no such constant", None);
        }
        let Some(value) = row.and_then(|row| left_out(ctx, document, target, row.left_out)) else {
            return refuse("the file does not say it", Some("write its value into the file".to_owned()));
        };
        let (target, at) = value;
        let place = target.place.clone();
        let number =
            |value: f64, tag| Node { value: Value::Number { value, integer: None }, place: place.clone(), tag };
        match at {
            Left::Number(value) => path::set(document, &target, number(value, Some(tag))),
            Left::Vector(vector, which) => {
                let own = |k: usize| (k == which).then_some(tag);
                let items = vector.into_iter().enumerate().map(|(k, value)| Arc::new(number(value, own(k))));
                let value = Value::Array(items.collect());
                path::set(document, &target, Node { value, place: place.clone(), tag: None });
            }
        }
        return Ok(());
    };
    let is_signal = row.is_some_and(|row| row.is_signal);
    match &node.value {
        Value::Number { .. } => {}
        Value::Text(text) if units::split_quantity(text).is_some() || text.trim().parse::<f64>().is_ok() => {}
        Value::Text(text) if is_signal => {
            let help = follows(document, text).unwrap_or_else(|| {
                "write a number of it as [constants] NAME = …, and differentiate by constants.NAME".to_owned()
            });
            return refuse("it is an expression", Some(help));
        }
        Value::Text(_) => return refuse(&format!("it is the text {}", node.written()), Some(of_a_number())),
        Value::Table(_) if node.get("expression").is_some() => {
            let text = node.get("expression").and_then(|text| text.text()).unwrap_or_default();
            let help = follows(document, text);
            return refuse("it is an expression", help.or_else(|| Some("write its value".to_owned())));
        }
        Value::Table(_) if node.get("csv").is_some() => return refuse("it is a column of a file", None),
        Value::Array(_) | Value::Table(_) => {
            let help = match &node.value {
                Value::Table(entries) => entries
                    .first()
                    .map(|entry| format!("go on to one of its numbers, as in {}.{}", target.written, entry.key)),
                _ => Some(format!("go on to one of its numbers, as in {}.0", target.written)),
            };
            return refuse(&format!("it is {} and no number", node.kind()), help);
        }
        Value::Boolean(_) | Value::Date => return refuse(&format!("it is {} and no number", node.kind()), None),
    }
    let node = Node { tag: Some(tag), ..node.clone() };
    path::set(document, target, node);
    Ok(())
}

/// What stands for a number that the file leaves out: there, or as a component of an array.
enum Left {
    Number(f64),
    Vector([f64; 3], usize),
}

fn left_out(ctx: &Context<'_>, document: &Node, target: &Target, row: LeftOut) -> Option<(Target, Left)> {
    match row {
        LeftOut::Nothing => None,
        LeftOut::Zero => Some((target.clone(), Left::Number(0.0))),
        LeftOut::One => Some((target.clone(), Left::Number(1.0))),
        LeftOut::Vector(vector) => {
            let (last, before) = target.steps.split_last()?;
            let Step::Key(key) = last else { return None };
            let which = key.parse().ok().filter(|which| *which < 3)?;
            Some((Target { steps: before.to_vec(), ..target.clone() }, Left::Vector(vector, which)))
        }
        LeftOut::OfLaw => {
            let (Step::Key(name), before) = target.steps.split_last()? else { return None };
            let element = Target { steps: before.split_last()?.1.to_vec(), ..target.clone() };
            let law = law_of(ctx, path::get(document, &element)?)?;
            let value = law.params.iter().find(|param| param.name == *name)?.default?;
            Some((target.clone(), Left::Number(value)))
        }
    }
}

/// Which constants an expression follows from.
fn follows(document: &Node, text: &str) -> Option<String> {
    let words: Vec<&str> = text.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let entries = document.get("constants")?.entries()?;
    let found: Vec<String> = entries
        .iter()
        .filter(|entry| words.contains(&entry.key.as_str()))
        .map(|entry| format!("constants.{}", entry.key))
        .collect();
    (!found.is_empty()).then(|| format!("it follows from {}: differentiate by that", found.join(" and ")))
}

/// What to take in place of what is no number.
fn of_a_number() -> String {
    "take a number of the equations, such as element.NAME.PARAMETER".to_owned()
}

/// Why no number that the equations know stands at a path.
fn why_not(document: &Node, target: &Target) -> (String, Option<String>) {
    let (section, last) = target.ends();
    let node = path::get(document, target);
    let is_of_file = document.get("robot").is_some_and(|robot| robot.get("urdf").or(robot.get("mjcf")).is_some());
    match (section, last) {
        ("robot", _) if is_of_file && node.is_none() => (
            "numbers in a robot's file have no path".to_owned(),
            Some("write the robot as [[robot.body]] blocks".to_owned()),
        ),
        ("time", _) => ("rows say when the run is looked at, not what it does".to_owned(), Some(of_a_number())),
        ("solver", _) => ("it says how exactly is computed, not what".to_owned(), Some(of_a_number())),
        (_, "sample" | "delay" | "period") => (format!("no derivative is known of a `{last}`"), None),
        _ => match node.map(|node| &node.value) {
            Some(Value::Text(text)) if units::split_quantity(text).is_none() => {
                (format!("it is the text {:?}", shorten(text)), Some(of_a_number()))
            }
            Some(Value::Boolean(_)) => ("it is a switch and no number".to_owned(), Some(of_a_number())),
            Some(Value::Array(items)) if items.iter().all(|item| item.entries().is_none()) => {
                let help = format!("go on to one of its numbers, as in {}.0", target.written);
                ("it is an array and no number".to_owned(), Some(help))
            }
            _ => ("no derivative by it is known".to_owned(), None),
        },
    }
}

/// What the readers have found at the numbers that were tagged from `first` on: value and unit.
pub(super) fn values(ctx: &Context<'_>, asked: &Asked, first: usize) -> Read<Vec<(f64, String)>> {
    let mut tag = first;
    let each = asked.by.iter().map(|by| {
        let own = tag;
        tag += by.targets.len();
        let noted = |tag: usize| Some((ctx.swept(tag)?, ctx.swept_unit(tag).unwrap_or_default()));
        for (k, target) in by.targets.iter().enumerate() {
            if noted(own + k).is_none() {
                let message = format!("{} cannot be a parameter: no number is read there", target.written);
                ctx.refuse(target.place.refuse(RefusalKind::Rule, message));
                return Err(Refused);
            }
        }
        let first = noted(own).ok_or(Refused)?;
        for (k, target) in by.targets.iter().enumerate().skip(1) {
            let other = noted(own + k).ok_or(Refused)?;
            if other.0 != first.0 {
                return Err(ctx.refuse(differ(by, (target, &other), &first)));
            }
        }
        Ok(first)
    });
    all(each.collect::<Vec<_>>())
}

/// Refuses to move numbers together that are not the same.
fn differ(by: &By, (target, other): (&Target, &(f64, String)), first: &(f64, String)) -> Refusal {
    let said = |(value, unit): &(f64, String)| match &**unit {
        "" | "1" => format!("{value}"),
        unit => format!("{value} {unit}"),
    };
    let (path, value) = (&by.targets[0].written, said(first));
    let message = format!(
        "{:?} moves numbers together that differ: {path} is {value}, {} is {}",
        by.name,
        target.written,
        said(other)
    );
    let help = format!("write {value} in both places, or let each follow from a constant, and take that as the path");
    target.place.refuse(RefusalKind::Rule, message).help(help)
}

/// Puts the first `start` of a parameter in place of an order that is 0 or 1, where nothing can be differentiated: a search begins there in any case.
pub(crate) fn leave_ends(document: &mut Node, by: &[By]) {
    for own in by {
        let block = own.block.and_then(|k| document.get("parameter")?.items()?.get(k).cloned());
        let start = block.as_ref().and_then(|block| block.get("start"));
        let first =
            start.and_then(|start| start.items().map_or(Some(&**start), |items| items.first().map(|one| &**one)));
        let Some(first) = first.cloned() else { continue };
        for target in own.targets.iter().filter(|target| is_order(target)) {
            let is_end = |node: &Node| match &node.value {
                Value::Number { value, .. } => *value == 0.0 || *value == 1.0,
                _ => false,
            };
            if path::get(document, target).is_some_and(is_end) {
                path::set(document, target, first.clone());
            }
        }
    }
}

/// Whether an order stands at a path.
fn is_order(target: &Target) -> bool {
    let key = target.ends().1;
    let of_controller = ["motion.controller.lambda", "motion.controller.mu"];
    key == "alpha" || key.starts_with("alpha_") || of_controller.iter().any(|path| target.written.starts_with(path))
}
