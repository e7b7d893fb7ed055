//! `[[element]]`: anchors, law, parameters, inputs.

use super::document::shorten;
use super::keys::{AT_START, ELEMENT, ELEMENT_FIELDS, RESERVED_NAMES};
use super::material::{self, Material};
use super::names;
use super::past::{self, PastPlan};
use super::plan::ElementPlan;
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::RefusalKind;
use super::robot::{Robot, checked_name, unique};
use super::time::Duration;
use springpot::elements::{Element, Line};
use springpot::fractional::scheme::{Scheme, SchemeNameError};
use springpot::integrate::RowTimes;
use springpot::law::{Past, RuleError};
use springpot::model::Anchor;
use std::collections::HashMap;

/// Most elements of a robot.
const MAX_ELEMENTS: usize = 10_000;
/// Most numbers ∂l/∂q_b of all elements.
const MAX_GRADIENTS: usize = 10_000_000;

/// Reads every `[[element]]`.
pub(crate) fn read(root: &Table<'_>, robot: &Robot, time: Option<&Duration>) -> Read<Vec<ElementPlan>> {
    let Some(field) = root.get("element") else { return Ok(Vec::new()) };
    let items = field.items("an array of tables: [[element]]")?;
    if items.len() > MAX_ELEMENTS {
        let message = format!("holds {} elements; at most {MAX_ELEMENTS} are taken", items.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    let nv = robot.model().nv();
    if items.len() * nv > MAX_GRADIENTS {
        let message = format!("holds {} elements on a robot of {nv} velocities", items.len());
        let help = format!("elements times velocities may be {MAX_GRADIENTS} at most: each pair makes a column");
        return Err(field.refuse(RefusalKind::TooLarge, message, Some(help)));
    }
    let mut seen = HashMap::new();
    all(items.iter().enumerate().map(|(i, item)| {
        if item.ctx.full() {
            return Err(Refused);
        }
        let name = item.node.get("name").and_then(|node| node.text());
        let what = name.map_or_else(|| format!("element {}", i + 1), |name| format!("element {:?}", shorten(name)));
        let table = Table::of(item.ctx, item.node, what, &ELEMENT)?;
        let name = table.require("name").and_then(|field| element_name(&field, &mut seen));
        let element = element(&table, robot, time)?;
        Ok(ElementPlan { element: Element { name: name?.to_owned(), ..element.element }, ..element })
    }))
}

fn element_name<'a>(field: &Field<'a>, seen: &mut HashMap<String, super::Place>) -> Read<&'a str> {
    let name = checked_name(field)?;
    if RESERVED_NAMES.contains(&name) {
        let message = format!("is {name:?}, which the columns of the results use");
        let help = format!("an element may not be called {}", RESERVED_NAMES.join(", "));
        return Err(field.refuse(RefusalKind::BadName, message, Some(help)));
    }
    unique(seen, field, name)?;
    Ok(name)
}

/// Everything but the name.
fn element(table: &Table<'_>, robot: &Robot, time: Option<&Duration>) -> Read<ElementPlan> {
    let from = table.require("from").and_then(|field| robot.anchor(&field));
    let to = table.require("to").and_then(|field| robot.anchor(&field));
    if let (Ok((first, from)), Ok((second, to))) = (&from, &to)
        && robot.carrier(from.body) == robot.carrier(to.body)
    {
        let why = if first == second {
            format!("has both ends on {first:?}")
        } else if from.body == to.body {
            format!(
                "has both ends on the world, which is also called {:?}",
                if first == "world" { second } else { first }
            )
        } else {
            format!("joins {first:?} and {second:?}, which fixed joints hold together")
        };
        let place = table.get("to").map_or(&table.node.place, |field| &field.node.place);
        let message = format!("{} {why}: its length cannot change", table.what);
        table.ctx.refuse(place.refuse(RefusalKind::Rule, message).help("join two bodies that move against each other"));
    }
    let past = past::read(table);
    let scheme = table.get("scheme").map_or(Ok(None), |field| scheme(&field, time));
    let Material { law, is_network, files, parameters, inputs } = material::read(table, time)?;
    let (parameters, (derivative, past)) = (parameters?, past?);
    let refuse = |error: RuleError| {
        let table_field = table.get("parameters");
        let node = table_field.as_ref().map_or(table.node, |field| field.node);
        let place = node.get(&error.parameter).map_or(&node.place, |parameter| &parameter.place);
        let message = format!("{}: law {:?} needs {}", table.what, law.name, error.rule);
        table.ctx.refuse(place.refuse(RefusalKind::Rule, message).label(format!("change `{}`", error.parameter)))
    };
    // What the law refuses is told beside what is wrong with the ends.
    let Ok(((_, from), (_, to))) = from.and_then(|from| Ok((from, to?))) else {
        _ = (law.build)(&parameters, derivative).map_err(refuse);
        return Err(Refused);
    };
    let site = |anchor: &Anchor| robot.model().resolve(anchor).expect("an anchor that was read");
    let line = Line { from: site(&from), to: site(&to) };
    let element = Element::new("", line, 0.0, &law, &parameters, derivative).map_err(refuse);
    let place = table.get("parameters").map_or(&table.node.place, |field| &field.node.place).clone();
    let (inputs, mut element) = (inputs?, element?);
    element.inputs = inputs.iter().map(|input| input.signal.clone()).collect();
    element.scheme = scheme?;
    if let PastPlan::Held(age) = past {
        element.past = Past::Held(age);
    }
    if let (Some(_), Some(field)) = (&element.scheme, table.get("past"))
        && !matches!(past, PastPlan::OfDerivative)
    {
        let message = format!("{} has a named scheme, which knows nothing before t = 0", table.what);
        let refusal = field.node.place.refuse(RefusalKind::Rule, message);
        return Err(table.ctx.refuse(refusal.help("leave the scheme out, or write past = \"held\" or \"unloaded\"")));
    }
    if let (Some(_), Some(field)) = (&element.scheme, table.get("scheme"))
        && element.law.has_inner_variables()
    {
        let message = format!("{} has a law with strokes of its own inside, which no named scheme knows", table.what);
        let refusal = field.node.place.refuse(RefusalKind::Rule, message);
        return Err(table.ctx.refuse(refusal.help("leave the scheme out: the exact memory takes every law")));
    }
    let rest_at_start = table.get("rest_length").is_some_and(|field| field.node.text() == Some(AT_START));
    if !rest_at_start {
        table.fill(ELEMENT_FIELDS, &mut element)?;
    }
    Ok(ElementPlan { element, past, rest_at_start, from, to, is_network, files, parameters, inputs, place })
}

fn scheme(field: &Field<'_>, time: Option<&Duration>) -> Read<Option<Scheme>> {
    let text = field.text()?;
    if text == "exact" {
        return Ok(None);
    }
    let scheme: Scheme = text.parse().map_err(|error: SchemeNameError| match error {
        SchemeNameError::Unknown(_) => {
            let names = Scheme::NAMES.into_iter().chain(["exact"]);
            let message = format!("is {:?}, which is no scheme", shorten(text));
            field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(text, names)))
        }
        other => field.refuse(RefusalKind::OutOfRange, format!("is {:?}: {other}", shorten(text)), None),
    })?;
    if let Some(why) = time.and_then(|time| misfit(scheme, time)) {
        let help = "write such a [time], or leave the scheme out".to_owned();
        return Err(field.refuse(RefusalKind::Rule, format!("is {text:?}, {why}"), Some(help)));
    }
    Ok(Some(scheme))
}

/// Why the scheme cannot work on the rows of the run.
fn misfit(scheme: Scheme, time: &Duration) -> Option<&'static str> {
    if time.rows.at(0) != 0.0 {
        return Some("which starts at t = 0: the first of `output_times` must be 0");
    }
    let uniform = match &time.rows {
        RowTimes::Times(_) => false,
        RowTimes::Step { step, end } => (end / step - (end / step).round()).abs() < 1e-9,
    };
    (scheme.needs_uniform_grid() && !uniform).then_some("which needs equal steps: an `output_step` that divides `end`")
}
