//! `shift`, `thermal` and `expansion` of an element: what temperature does to its law.

use crate::keys::{ARRHENIUS, EXPANSION, SHIFT, THERMAL};
use crate::reader::element::HEATED;
use crate::reader::{Field, Read, Refused, Table};
use crate::signals::of_time::{celsius, how_outside};
use crate::text::refusal::RefusalKind;
use serde_json::{Map, Value, json};
use springpot::law::heat::TEMPERATURE;
use springpot::law::{Expansion, Heat, RuleError, Shift, Thermal};

/// Reads `shift`, `thermal` and `expansion`, the last in the units of a rotation where it is one.
pub(crate) fn read(table: &Table<'_>, is_rotation: bool) -> Read<Heat> {
    let shift = table.get("shift").map(|field| shift(&field)).transpose();
    let thermal = table.get("thermal").map(|field| thermal(&field)).transpose();
    let expansion = table.get("expansion").map(|field| expansion(&field, is_rotation)).transpose();
    let heat = Heat { shift: shift?, thermal: thermal?, expansion: expansion? };
    heat.check().map_err(|RuleError { rule, parameter }| {
        let fields = HEATED.into_iter().filter_map(|key| table.get(key));
        let fields: Vec<Field<'_>> = fields.collect();
        let node = fields.iter().find_map(|field| field.node.get(&parameter));
        let place = node.map_or(&table.node.place, |node| &node.place);
        let refusal = place.refuse(RefusalKind::Rule, format!("{} needs {rule}", table.what));
        table.ctx.refuse(refusal.label(format!("change `{parameter}`")))
    })?;
    Ok(heat)
}

fn shift(field: &Field<'_>) -> Read<Shift> {
    // The kind says which keys there are.
    let kind = match field.node.get("kind") {
        Some(node) => match node.text() {
            Some(text) if SHIFT.get("kind").is_some_and(|key| key.choices().contains(&text)) => text,
            _ => {
                let any = Table::of(field.ctx, field.node, field.to_string(), &SHIFT)?;
                return Err(any.word("kind", "kind of shift").err().unwrap_or(Refused));
            }
        },
        None => return Err(Table::of(field.ctx, field.node, field.to_string(), &SHIFT)?.lacks("kind")),
    };
    let other = |key: &str| {
        let reason = || (RefusalKind::Rule, format!("`{key}` of {field} is none of kind = {kind:?}"));
        SHIFT.is_of_a_kind(key).then(reason)
    };
    let table = Table::of_kind(field.ctx, field.node, field.to_string(), (&SHIFT, kind), other)?;
    let reference = temperature(&table, "T_ref");
    if kind == ARRHENIUS {
        let energy = table.number("energy");
        return Ok(Shift::Arrhenius { energy: energy?, reference: reference? });
    }
    let c2 = table.get("C2").map_or(Ok(()), |field| field.refuse_affine()).and_then(|()| table.number("C2"));
    let c1 = table.number("C1");
    Ok(Shift::Wlf { c1: c1?, c2: c2?, reference: reference? })
}

fn thermal(field: &Field<'_>) -> Read<Thermal> {
    let table = field.table(&THERMAL)?;
    let (capacity, conductance) = (table.number("capacity"), table.number("conductance"));
    let ambient = temperature(&table, "ambient");
    let start = if table.get("start").is_some() { temperature(&table, "start") } else { ambient };
    Ok(Thermal { capacity: capacity?, conductance: conductance?, ambient: ambient?, start: start? })
}

fn expansion(field: &Field<'_>, is_rotation: bool) -> Read<Expansion> {
    let table = field.table(&EXPANSION)?;
    let coefficient = table.joint_number("coefficient", !is_rotation);
    let reference = temperature(&table, "T_ref");
    Ok(Expansion { coefficient: coefficient?, reference: reference? })
}

/// A temperature that materials have, K.
fn temperature<'a>(table: &Table<'a>, key: &'a str) -> Read<f64> {
    let field = table.require(key)?;
    let value = field.number("K")?;
    if TEMPERATURE.contains(value) {
        return Ok(value);
    }
    let message = format!("is {value} K, {}", how_outside(TEMPERATURE));
    Err(field.refuse(RefusalKind::OutOfRange, message, celsius(field.node, "K", TEMPERATURE, value)))
}

/// Its record: the tables that there are, SI.
pub(crate) fn record(heat: &Heat) -> Map<String, Value> {
    let Heat { shift, thermal, expansion } = *heat;
    let shift = shift.map(|shift| match shift {
        Shift::Wlf { c1, c2, reference } => json!({ "kind": "wlf", "C1": c1, "C2": c2, "T_ref": reference }),
        Shift::Arrhenius { energy, reference } => json!({ "kind": "arrhenius", "energy": energy, "T_ref": reference }),
    });
    let thermal = thermal.map(|Thermal { capacity, conductance, ambient, start }| {
        json!({ "capacity": capacity, "conductance": conductance, "ambient": ambient, "start": start })
    });
    let expansion =
        expansion.map(|Expansion { coefficient, reference }| json!({ "coefficient": coefficient, "T_ref": reference }));
    let tables = HEATED.into_iter().zip([shift, thermal, expansion]);
    tables.filter_map(|(key, table)| Some((key.to_owned(), table?))).collect()
}
