//! `[[event]]`: what is watched in forward runs.

use crate::keys::{ACTION, EVENT, RECORD, STOP};
use crate::plan::Plan;
use crate::reader::named::{checked_name, unique};
use crate::reader::{Field, Read, Refused, Table, all};
use crate::signals::feedback;
use crate::signals::of_time::Wanted;
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use serde_json::{Map, Value, json};
use springpot::actuation::Drive;
use springpot::law::Range;
use springpot::observe::{ElementQuantity, Observables, Quantity};
use springpot::signal::ColumnExpression;
use springpot::signal::expression::ExpressionError;
use springpot::system::{Action, Direction, Event, Motion, Setting};
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

impl EventPlan {
    /// The columns that functions of events may name.
    pub(crate) fn columns(plan: &Plan) -> Vec<String> {
        Seen::of(plan).names
    }
}

/// What may be set.
struct Settable {
    /// The column that tells it.
    name: String,
    unit: String,
    range: Range,
    /// Nothing where its element is not enabled.
    made: Option<fn(usize, usize, f64) -> Setting>,
    at: (usize, usize),
}

/// What a plan has, by the names of its columns.
struct Seen {
    names: Vec<String>,
    /// `None` of elements that are not enabled.
    quantities: Vec<Option<Quantity>>,
}

impl Seen {
    fn of(plan: &Plan) -> Self {
        let whole = |observables: Observables| observables.with_leaves().with_joint_losses();
        let names = |observables: &Observables| observables.columns().into_iter().map(|column| column.name.to_string());
        let acting = whole(plan.acting_observables());
        let known: HashMap<String, Quantity> = names(&acting).zip(acting.quantities()).collect();
        let names: Vec<String> = names(&whole(plan.observables())).collect();
        let quantities = names.iter().map(|name| known.get(name).copied()).collect();
        Self { names, quantities }
    }
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
    let (columns, settable) = (Seen::of(plan), settable(plan));
    let mut seen = HashMap::new();
    all(items.iter().enumerate().map(|(k, item)| {
        let name = item.node.get("name").and_then(|node| node.text());
        let what = name.map_or_else(|| format!("event {}", k + 1), |name| format!("event {:?}", shorten(name)));
        let table = Table::of(item.ctx, item.node, what, &EVENT)?;
        let name = table.require("name").and_then(|field| {
            let name = checked_name(&field)?;
            unique(&mut seen, &field, name).map(|()| name)
        });
        let when = table.require("when").and_then(|field| when(&field, &columns));
        let direction = table.word("direction", "direction").map(|word| (word, direction(word)));
        let action = action(&table, &settable);
        let (name, (when, columns), (word, direction), (action, done)) = (name?, when?, direction?, action?);
        let written = table.get("when").and_then(|field| field.node.text());
        let record = json!({ "name": name, "when": written, "direction": word, "action": done });
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

/// What passes zero where a comparison becomes true.
fn compared(text: &str, names: &[&str]) -> String {
    let sides: Vec<&str> = text.split(['<', '>', '=', '\u{2264}', '\u{2265}']).map(str::trim).collect();
    let sides: Vec<&str> = sides.into_iter().filter(|side| !side.is_empty()).collect();
    let [left, right] = sides[..] else {
        return "an event happens where `when` passes zero: write \"gripper.z - 0.1\"; `direction` says which way"
            .to_owned();
    };
    let left = if names.contains(&left) { left } else { names::nearest(left, names.iter().copied()).unwrap_or(left) };
    let right =
        if right.parse::<f64>().is_ok_and(|number| number >= 0.0) { right.to_owned() } else { format!("({right})") };
    let way = if text.contains('<') { "falling" } else { "rising" };
    format!("an event happens where `when` passes zero: write \"{left} - {right}\" and direction = \"{way}\"")
}

/// The function, and what its columns hold; of an element that is not enabled one that never passes zero.
fn when(field: &Field<'_>, seen: &Seen) -> Read<(ColumnExpression, Vec<Quantity>)> {
    let text = field.text()?;
    let names: Vec<&str> = seen.names.iter().map(String::as_str).collect();
    let when = ColumnExpression::parse(text, &field.ctx.constants(), &names).map_err(|error| {
        let several = match &error {
            ExpressionError::UnknownName { name, .. } => {
                names::inside(name, names.iter().copied()).map(|help| (name, help))
            }
            _ => None,
        };
        if let Some((name, help)) = several {
            let place = field.node.place_in_text(error.span());
            let message = format!("{field}: unknown name `{name}`");
            return field.ctx.refuse(place.refuse(RefusalKind::BadQuantity, message).help(help));
        }
        let help = match &error {
            ExpressionError::UnknownName { name, suggestion: None, .. } => names::suggest(name, names.iter().copied()),
            ExpressionError::Condition { .. } => compared(text, &names),
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
    let held: Option<Vec<Quantity>> = when.columns().iter().map(|&k| seen.quantities[k]).collect();
    let Some(held) = held else {
        let never = ColumnExpression::parse("1", &[], &[]).expect("a number");
        return Ok((never, Vec::new()));
    };
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
    let (settings, records): (Vec<Option<Setting>>, Vec<(String, Value)>) = read.into_iter().unzip();
    Ok((
        Action::Set(settings.into_iter().flatten().collect()),
        json!({ "set": records.into_iter().collect::<Map<_, _>>() }),
    ))
}

fn setting(field: &Field<'_>, settable: &[Settable]) -> Read<(Option<Setting>, (String, Value))> {
    let Some(Settable { name, unit, range, made, at }) = settable.iter().find(|one| one.name == field.key) else {
        return Err(unsettable(field, settable));
    };
    let wanted = Wanted { unit, range: *range, smooth: false, end: None };
    let signal = feedback::read_of_time(field, wanted)?;
    let Some(value) = signal.constant.or_else(|| signal.signal.is_constant()) else {
        let message = "varies with t, but what an event sets is a number";
        return Err(field.refuse(RefusalKind::Rule, message, Some("write a number or a quantity".to_owned())));
    };
    Ok((made.map(|made| made(at.0, at.1, value)), (name.clone(), json!(value))))
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
fn settable(plan: &Plan) -> Vec<Settable> {
    let observables = plan.observables();
    let mut acting = 0;
    let mut settable = Vec::new();
    for (place, element) in plan.all_elements().into_iter().enumerate() {
        let is_absent = plan.absent.iter().any(|(absent, _)| *absent == place);
        for (i, input) in element.element.entry.inputs.iter().enumerate() {
            let column = observables.column(Quantity::Element(place, ElementQuantity::InputValue(i)));
            let made: fn(usize, usize, f64) -> Setting =
                |element, input, value| Setting::Input { element, input, value };
            let made = (!is_absent).then_some(made);
            settable.push(Settable { name: column.name, unit: column.unit, range: input.range, made, at: (acting, i) });
        }
        acting += usize::from(!is_absent);
    }
    let Motion::Forward(forward) = plan.system_at_start().motion else { return settable };
    let drives = plan.model.own_joints().zip(&forward.drives);
    let driven = drives.filter(|(_, drive)| matches!(drive, Drive::Force(_)));
    settable.extend(driven.flat_map(|(j, _)| plan.model.v_range(j)).map(|k| {
        let column = observables.column(Quantity::Torque(k));
        let made: fn(usize, usize, f64) -> Setting = |velocity, _, value| Setting::Torque { velocity, value };
        Settable { name: column.name, unit: column.unit, range: Range::ANY, made: Some(made), at: (k, 0) }
    }));
    settable
}
