//! `[[element]]`: what it acts along, law, parameters, inputs.

pub(crate) mod heat;
pub(crate) mod material;
pub(crate) mod past;
pub(crate) mod plan;
mod shape;

use self::material::{InputsOf, Material};
use self::past::PastPlan;
use crate::elements::plan::{ElementPlan, ShapePlan};
use crate::keys::{AT_START, BUSHING, COMPONENT, COMPONENTS, ELEMENT, ELEMENT_FIELDS, ON_JOINT, RESERVED_NAMES};
use crate::reader::element::kind_of;
use crate::reader::named::{checked_name, unique};
use crate::reader::{Field, Read, Refused, Table, all};
use crate::robot::Robot;
use crate::signals::plan::SignalPlan;
use crate::text::document::{Entry, Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::RefusalKind;
use crate::time::Duration;
use shape::Shape;
use springpot::elements::{Component, Element};
use springpot::fractional::scheme::{Scheme, SchemeNameError};
use springpot::law::{Derivative, Past, RuleError};
use springpot::model::description::JointSpring;
use springpot::system::RowTimes;
use std::collections::HashMap;
use std::sync::Arc;

/// Most elements of a robot.
pub(crate) const MAX_ELEMENTS: usize = 10_000;
/// Most numbers ∂l/∂q_b of all elements.
const MAX_GRADIENTS: usize = 10_000_000;

/// The elements of a case.
#[derive(Debug, Default)]
pub(crate) struct Elements {
    /// Those that act.
    pub(crate) acting: Vec<ElementPlan>,
    /// Those that are not enabled, with their places among all.
    pub(crate) absent: Vec<(usize, ElementPlan)>,
}

/// Reads every `[[element]]`; each component of a bushing is an element of its own.
pub(crate) fn read(root: &Table<'_>, robot: &Robot, time: Option<&Duration>) -> Read<Elements> {
    let field = root.get("element");
    let items = field.as_ref().map_or(Ok(Vec::new()), |field| field.items("an array of tables: [[element]]"))?;
    let springs = springs(root, robot);
    let springs =
        springs.iter().map(|node| Field { ctx: root.ctx, node, key: "element", row: None, owner: root.what.clone() });
    let items: Vec<Field<'_>> = items.into_iter().chain(springs).collect();
    let count: usize = items.iter().map(|item| bushing(item.node).map_or(1, <[_]>::len)).sum();
    let nv = robot.model().nv();
    if let Some(field) = items.first() {
        if count > MAX_ELEMENTS {
            let message = format!("holds {count} elements; at most {MAX_ELEMENTS} are taken");
            return Err(field.refuse(RefusalKind::TooLarge, message, None));
        }
        if count * nv > MAX_GRADIENTS {
            let message = format!("holds {count} elements on a robot of {nv} velocities");
            let help = format!("elements times velocities may be {MAX_GRADIENTS} at most: each pair makes a column");
            return Err(field.refuse(RefusalKind::TooLarge, message, Some(help)));
        }
    }
    let mut seen = HashMap::new();
    let read = all(items.iter().enumerate().map(|(i, item)| {
        if item.ctx.full() {
            return Err(Refused);
        }
        let name = item.node.get("name").and_then(|node| node.text());
        let what = name.map_or_else(|| format!("element {}", i + 1), |name| format!("element {:?}", shorten(name)));
        let kind = kind_of(item.node);
        let misplaced = |key: &str| Some((RefusalKind::Rule, format!("{what} {}", why_not(key, kind)?)));
        let table = Table::of_kind(item.ctx, item.node, what.clone(), (&ELEMENT, kind), misplaced)?;
        let name = table.require("name").and_then(|field| element_name(&field, &mut seen));
        let is_enabled = table.flag("enabled");
        let elements = match kind {
            BUSHING => bushing_elements(&table, robot, time)?,
            ON_JOINT => vec![element(&table, shape::on_joint(&table, robot)?, time)?],
            _ => {
                let shape = shape::between_points(&table, robot);
                // What the law refuses is told beside what is wrong with the ends.
                let material = Materials::read(&table, false, time)?;
                vec![material.element(&table, shape?)?]
            }
        };
        let (name, is_enabled) = (name?, is_enabled?);
        Ok(elements.into_iter().map(|plan| (named(plan, name), is_enabled)).collect::<Vec<_>>())
    }))?;
    let mut elements = Elements::default();
    for (place, (plan, is_enabled)) in read.into_iter().flatten().enumerate() {
        if is_enabled { elements.acting.push(plan) } else { elements.absent.push((place, plan)) }
    }
    Ok(elements)
}

/// The springs that the robot's file gives its joints, as elements that were written so: `NAME_spring` on joint NAME.
fn springs(root: &Table<'_>, robot: &Robot) -> Vec<Node> {
    let file = root.node.get("robot").and_then(|robot| robot.get("mjcf"));
    let place = file.map_or(&root.node.place, |file| &file.place);
    let table = |entries: Vec<(&str, Value)>| {
        let entry = |(key, value): (&str, Value)| Entry {
            key: key.to_owned(),
            key_place: place.clone(),
            node: Arc::new(Node { value, place: place.clone(), tag: None }),
        };
        Value::Table(entries.into_iter().map(entry).collect())
    };
    let number = |value: f64| Value::Number { value, integer: None };
    let springs = robot.parts.urdf.iter().flat_map(|plan| &plan.robot.springs);
    let elements = springs.map(|JointSpring { joint, stiffness, slack }| {
        table(vec![
            ("name", Value::Text(format!("{joint}_spring"))),
            ("joint", Value::Text(joint.clone())),
            ("network", Value::Text("spring(k)".to_owned())),
            ("parameters", table(vec![("k", number(*stiffness))])),
            ("rest", number(*slack)),
        ])
    });
    elements.map(|value| Node { value, place: place.clone(), tag: None }).collect()
}

/// Why a key of another kind of element cannot stand in this one.
fn why_not(key: &str, kind: &str) -> Option<String> {
    if !ELEMENT.is_of_a_kind(key) {
        return None;
    }
    Some(match (kind, key) {
        (ON_JOINT, "rest_length") => "acts on a joint and has no `rest_length`: write `rest`".to_owned(),
        (ON_JOINT, _) => format!("has both `joint` and `{key}`: leave one of them out"),
        (BUSHING, _) => format!("is a bushing and has no `{key}`: write it in a component, as in bushing.x.{key}"),
        (_, "rest") => "is between points and has no `rest`: write `rest_length`".to_owned(),
        _ => format!("has no `{key}`: it is {kind}"),
    })
}

/// The components that an element's table holds.
fn bushing(element: &Node) -> Option<&[crate::text::document::Entry]> {
    element.get("bushing").and_then(|bushing| bushing.entries())
}

fn named(plan: ElementPlan, name: &str) -> ElementPlan {
    let name = match &plan.shape {
        ShapePlan::Bushing { component, .. } => format!("{name}.{}", component.name()),
        _ => name.to_owned(),
    };
    ElementPlan { element: Element { name, ..plan.element }, ..plan }
}

pub(crate) fn element_name<'a>(field: &Field<'a>, seen: &mut HashMap<String, crate::Place>) -> Read<&'a str> {
    let name = checked_name(field)?;
    if RESERVED_NAMES.contains(&name) {
        let message = format!("is {name:?}, which the columns of the results use");
        let help = format!("an element may not be called {}", RESERVED_NAMES.join(", "));
        return Err(field.refuse(RefusalKind::BadName, message, Some(help)));
    }
    unique(seen, field, name)?;
    Ok(name)
}

/// The components of a bushing, in the order x, y, z, rx, ry, rz.
fn bushing_elements(table: &Table<'_>, robot: &Robot, time: Option<&Duration>) -> Read<Vec<ElementPlan>> {
    let frames = shape::frames(table, robot);
    let field = table.require("bushing")?;
    let parts = Table::of(field.ctx, field.node, format!("`bushing` of {}", table.what), &COMPONENTS)?;
    let given = Component::ALL.into_iter().filter_map(|component| Some((component, parts.get(component.name())?)));
    let elements = all(given.map(|(component, part)| {
        let what = format!("`{}` in {field}", component.name());
        let part = Table::of(part.ctx, part.node, what, &COMPONENT)?;
        // What a law refuses is told beside what is wrong with the frames.
        let materials = Materials::read(&part, component.is_rotation(), time)?;
        let frames = frames.as_ref().map_err(|refused| *refused)?;
        materials.element(&part, frames.shape(robot, component))
    }))?;
    frames?;
    if elements.is_empty() {
        let names = names::list(Component::ALL.map(Component::name));
        let message = "has no component, so that it carries nothing";
        return Err(field.refuse(RefusalKind::Missing, message, Some(format!("write some of {names}"))));
    }
    Ok(elements)
}

/// An element on what it acts along.
fn element(table: &Table<'_>, shape: Shape, time: Option<&Duration>) -> Read<ElementPlan> {
    Materials::read(table, shape.measure.is_rotation(), time)?.element(table, shape)
}

/// What is to be done about a broken rule.
fn change(parameter: &str) -> String {
    if parameter.is_empty() { "here".to_owned() } else { format!("change `{parameter}`") }
}

/// Notes what the law of an element refuses.
pub(crate) fn check(table: &Table<'_>, material: &Material, past: &Read<(Derivative, PastPlan)>) {
    let Material { law, parameters: Ok(parameters), .. } = material else { return };
    let Ok((derivative, _)) = past else { return };
    if let Err(RuleError { parameter, rule }) = law.build(parameters, *derivative) {
        let table_field = table.get("parameters");
        let node = table_field.as_ref().map_or(table.node, |field| field.node);
        let place = node.get(&parameter).map_or(&node.place, |parameter| &parameter.place);
        let message = format!("{}: law {} needs {rule}", table.what, law.quoted());
        table.ctx.refuse(place.refuse(RefusalKind::Rule, message).label(change(&parameter)));
    }
}

/// All of an element but what it acts along.
struct Materials {
    material: Material,
    past: Read<(Derivative, PastPlan)>,
    scheme: Read<Option<Scheme>>,
}

impl Materials {
    fn read(table: &Table<'_>, is_rotation: bool, time: Option<&Duration>) -> Read<Self> {
        let past = past::read(table);
        let scheme = table.get("scheme").map_or(Ok(None), |field| scheme(&field, time));
        let material = material::read(table, is_rotation, InputsOf::Robot(time))?;
        check(table, &material, &past);
        Ok(Self { material, past, scheme })
    }

    fn element(self, table: &Table<'_>, Shape { measure, plan, ends }: Shape) -> Read<ElementPlan> {
        let Material { law, is_network, files, parameters, inputs, .. } = self.material;
        let (is_length, is_rotation) = (matches!(plan, ShapePlan::Points(_)), measure.is_rotation());
        let (parameters, (derivative, past)) = (parameters?, self.past?);
        let element = Element::new("", measure, 0.0, &law, &parameters, derivative).map_err(|_| Refused);
        let place = table.get("parameters").map_or(&table.node.place, |field| &field.node.place).clone();
        let scheme_place = table.get("scheme").map(|field| field.node.place.clone());
        let (inputs, mut element): (Vec<SignalPlan>, _) = (inputs?.into_iter().flatten().collect(), element?);
        element.inputs = inputs.iter().map(|input| input.signal.clone()).collect();
        element.scheme = self.scheme?;
        if let PastPlan::Held(age) = past {
            element.past = Past::Held(age);
        }
        refuse_scheme(table, &element, &past)?;
        let rest = if is_length { "rest_length" } else { "rest" };
        let rest_at_start = table.get(rest).is_some_and(|field| field.node.text() == Some(AT_START));
        match (rest_at_start, is_length) {
            (true, _) => {}
            (false, true) => table.fill(ELEMENT_FIELDS, &mut element)?,
            (false, false) => element.rest = table.joint_number(rest, !is_rotation)?,
        }
        let shape = plan;
        Ok(ElementPlan {
            element,
            past,
            rest_at_start,
            shape,
            is_network,
            files,
            parameters,
            inputs,
            place,
            ends,
            scheme_place,
        })
    }
}

/// Refuses a named scheme where it cannot know what the law does.
fn refuse_scheme(table: &Table<'_>, element: &Element, past: &PastPlan) -> Read<()> {
    if element.scheme.is_none() {
        return Ok(());
    }
    let refuse = |key: &'static str, why: &str, help: &str| {
        let place = table.get(key).map_or(&table.node.place, |field| &field.node.place);
        Err(table.ctx.refuse(place.refuse(RefusalKind::Rule, format!("{} has {why}", table.what)).help(help)))
    };
    if !matches!(past, PastPlan::OfDerivative) {
        let help = "leave the scheme out, or write past = \"held\" or \"unloaded\"";
        return refuse("past", "a named scheme, which knows nothing before t = 0", help);
    }
    if element.law.as_heated().is_some() {
        let why = "a temperature, of which no named scheme knows";
        return refuse("scheme", why, "leave the scheme out: the exact memory takes every law");
    }
    if element.law.has_inner_variables() {
        let why = "a law with strokes of its own inside, which no named scheme knows";
        return refuse("scheme", why, "leave the scheme out: the exact memory takes every law");
    }
    Ok(())
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
