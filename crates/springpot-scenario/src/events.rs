//! `[[event]]`: what is watched in forward runs.

use super::document::shorten;
use super::feedback;
use super::keys::{ACTION, EVENT, RECORD, STOP};
use super::names;
use super::plan::Plan;
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::{Place, RefusalKind};
use super::robot::{checked_name, unique};
use super::signals::Wanted;
use serde_json::{Map, Value, json};
use springpot::actuation::Drive;
use springpot::integrate::{Action, Direction, Event, Motion, Setting};
use springpot::law::Range;
use springpot::observe::{ElementQuantity, Observables, Quantity};
use springpot::signal::ColumnExpression;
use springpot::signal::expression::ExpressionError;
use std::collections::HashMap;

/// Most of them.
const MAX_EVENTS: usize = 1_000;

/// An event, and as the record of a run has it.
#[derive(Debug, Clone)]
pub struct EventPlan {
    /// The event.
    pub event: Event,
    /// Where it stands.
    pub place: Place,
    /// As the record of a run has it.
    pub(crate) record: Value,
}

/// What may be set.
struct Settable {
    /// The column that tells it.
    name: String,
    unit: String,
    range: Range,
    made: fn(usize, usize, f64) -> Setting,
    at: (usize, usize),
}

/// Reads the events of a plan that has all else.
pub(crate) fn read(root: &Table<'_>, plan: &Plan) -> Read<Vec<EventPlan>> {
    let Some(field) = root.get("event") else { return Ok(Vec::new()) };
    let items = field.items("an array of tables: [[event]]")?;
    if items.is_empty() {
        return Ok(Vec::new());
    }
    if !plan.motion.is_forward() {
        let message =
            "stands beside a motion that is given in advance: events are found where the motion follows from forces";
        let help = format!(
            "write motion.kind = \"forward\", or leave the events out; this motion is {:?}",
            plan.motion.kind()
        );
        return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
    }
    if items.len() > MAX_EVENTS {
        let message = format!("has {} events; at most {MAX_EVENTS} are taken", items.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    let observables = plan.observables().with_leaves().with_joint_losses();
    let settable = settable(plan, &observables);
    let mut seen = HashMap::new();
    all(items.iter().enumerate().map(|(k, item)| {
        let name = item.node.get("name").and_then(|node| node.text());
        let what = name.map_or_else(|| format!("event {}", k + 1), |name| format!("event {:?}", shorten(name)));
        let table = Table::of(item.ctx, item.node, what, &EVENT)?;
        let name = table.require("name").and_then(|field| {
            let name = checked_name(&field)?;
            unique(&mut seen, &field, name).map(|()| name)
        });
        let when = table.require("when").and_then(|field| when(&field, &observables));
        let direction = table.word("direction", "direction").map(|word| (word, direction(word)));
        let action = action(&table, &settable);
        let (name, (when, columns), (word, direction), (action, done)) = (name?, when?, direction?, action?);
        let record = json!({ "name": name, "when": when.to_string(), "direction": word, "action": done });
        let event = Event { name: name.to_owned(), when, columns, direction, action };
        Ok(EventPlan { event, place: item.node.place.clone(), record })
    }))
}

fn direction(word: &str) -> Direction {
    Direction::ALL
        .into_iter()
        .find(|(name, _)| *name == word)
        .map_or_else(Direction::default, |(_, direction)| direction)
}

/// The function, and what its columns hold.
fn when(field: &Field<'_>, observables: &Observables) -> Read<(ColumnExpression, Vec<Quantity>)> {
    let text = field.text()?;
    let (columns, quantities) = (observables.columns(), observables.quantities());
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let when = ColumnExpression::parse(text, &field.ctx.constants(), &names).map_err(|error| {
        let help = match &error {
            ExpressionError::UnknownName { name, suggestion: None, .. } => names::suggest(name, names.iter().copied()),
            _ => "write an expression of t and of columns, such as \"gripper.z - 0.1\"".to_owned(),
        };
        let place = field.node.place_in_text(error.span());
        field.ctx.refuse(place.refuse(RefusalKind::BadQuantity, format!("{field}: {error}")).help(help))
    })?;
    if let Some(value) = when.is_constant() {
        let message = format!("is {value} all the time: neither t nor a column occurs in it");
        let help = "write a function that passes zero, such as \"gripper.z - 0.1\"".to_owned();
        return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
    }
    let held: Vec<Quantity> = when.columns().iter().map(|&k| quantities[k]).collect();
    if let Some(k) = held.iter().position(|quantity| matches!(quantity, Quantity::Acceleration(_))) {
        let name = names[when.columns()[k]];
        let message =
            format!("has {name:?} in it: accelerations jump where forces do, and need not pass zero at any time");
        let help = format!("write it of a velocity or of a force, such as {:?}", name.replacen('a', "v", 1));
        return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
    }
    Ok((when, held))
}

/// What is done, and as the record has it.
fn action(table: &Table<'_>, settable: &[Settable]) -> Read<(Action, Value)> {
    let Some(field) = table.get("action") else { return Ok((Action::Record, json!(RECORD))) };
    if field.node.entries().is_none() {
        let word = field.word("action")?;
        return Ok((if word == STOP { Action::Stop } else { Action::Record }, json!(word)));
    }
    let set = field.table(&ACTION)?.require("set")?;
    let Some(entries) = set.node.entries() else { return Err(set.wrong_type("a table of values by column")) };
    if entries.is_empty() {
        let message = "sets nothing";
        return Err(set.refuse(RefusalKind::Missing, message, Some("write { \"strut.u\" = \"3 V\" }".to_owned())));
    }
    let values = Table::of_any(set.ctx, set.node, set.to_string())?;
    let read = all(values.fields().map(|field| setting(&field, settable)).collect::<Vec<_>>())?;
    let (settings, records): (Vec<Setting>, Vec<(String, Value)>) = read.into_iter().unzip();
    Ok((Action::Set(settings), json!({ "set": records.into_iter().collect::<Map<_, _>>() })))
}

fn setting(field: &Field<'_>, settable: &[Settable]) -> Read<(Setting, (String, Value))> {
    let Some(Settable { name, unit, range, made, at }) = settable.iter().find(|one| one.name == field.key) else {
        return Err(unsettable(field, settable));
    };
    let wanted = Wanted { unit, range: *range, smooth: false, end: None };
    let signal = feedback::read_of_time(field, wanted)?;
    let Some(value) = signal.constant.or_else(|| signal.signal.is_constant()) else {
        let message = "varies with t, but what an event sets is a number";
        return Err(field.refuse(RefusalKind::Rule, message, Some("write a number or a quantity".to_owned())));
    };
    Ok((made(at.0, at.1, value), (name.clone(), json!(value))))
}

fn unsettable(field: &Field<'_>, settable: &[Settable]) -> Refused {
    let names = settable.iter().map(|one| one.name.as_str());
    let what = if field.node.entries().is_some() {
        format!("is a table; a column is written in quotes, as in {{ {:?} = 0 }}", format!("{}.u", field.key))
    } else {
        "is no input of an element and no torque that a force drives".to_owned()
    };
    field.refuse(RefusalKind::UnknownName, what, Some(names::suggest(field.key, names)))
}

/// The inputs of all elements, and the actuator forces on the velocities that forces drive.
fn settable(plan: &Plan, observables: &Observables) -> Vec<Settable> {
    let column = |quantity| observables.column(quantity);
    let inputs =
        plan.elements.iter().enumerate().flat_map(|(e, plan)| {
            plan.element.entry.inputs.iter().enumerate().map(move |(i, input)| (e, i, input.range))
        });
    let inputs = inputs.map(|(e, i, range)| {
        let column = column(Quantity::Element(e, ElementQuantity::InputValue(i)));
        let made = |element, input, value| Setting::Input { element, input, value };
        Settable { name: column.name, unit: column.unit, range, made, at: (e, i) }
    });
    let Motion::Forward(forward) = plan.system_at_start().motion else { return inputs.collect() };
    let drives = plan.model.own_joints().zip(&forward.drives);
    let driven = drives.filter(|(_, drive)| matches!(drive, Drive::Force(_)));
    let torques = driven.flat_map(|(j, _)| plan.model.v_range(j)).map(|k| {
        let column = column(Quantity::Torque(k));
        let made = |velocity, _, value| Setting::Torque { velocity, value };
        Settable { name: column.name, unit: column.unit, range: Range::ANY, made, at: (k, 0) }
    });
    inputs.chain(torques).collect()
}
