//! Feedback: torques and inputs as expressions of the state.
//!
//! Signals are read before all elements are known, so that an expression that names what is seen of the state is kept as it is written
//! ([`read`]) and read when the plan is whole ([`settle`]).

use super::plan::FeedbackText;
use crate::keys::SIGNAL;
use crate::reader::{Field, Read};
use crate::signals::of_time::{self, Wanted};
use crate::signals::plan::SignalPlan;
use crate::text::document::Value;
use crate::text::refusal::RefusalKind;
use crate::units;
use springpot::law::Range;
use springpot::signal::Signal;
use springpot::signal::expression::is_of_module;

/// What follows the name of an element or of the gripper in what feedback may see.
pub(crate) const OF_ELEMENT: [&str; 3] = ["length", "stroke", "rate"];
pub(crate) const OF_FORCES: [&str; 2] = ["force", "derivative"];

/// A signal, or feedback in its place.
pub(crate) fn read(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    match &field.node.value {
        Value::Text(text) if names_state(text) => {
            let text = FeedbackText {
                node: field.node.clone(),
                owner: field.to_string(),
                scale: 1.0,
                offset: 0.0,
                sample: None,
            };
            Ok(in_place_of_signal(field, wanted.range, text))
        }
        Value::Table(_) if field.node.get("expression").is_some() => {
            let sampled = field.node.get("sample").is_some();
            let text = field.node.get("expression").and_then(|node| node.text());
            if sampled || text.is_some_and(names_state) { table(field, wanted) } else { of_time::read(field, wanted) }
        }
        _ => of_time::read(field, wanted),
    }
}

/// A signal where the state may not stand.
pub(crate) fn read_of_time(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let node = field.node.get("expression").map_or(field.node, |node| node);
    match node.text() {
        Some(text) if names_state(text) && units::split_quantity(text).is_none() => {
            let message = format!("{field} follows from the state, but has to be a signal of t");
            let help = "feedback may stand in the inputs of elements and the torques of joints, where motion.kind = \"forward\"";
            Err(field.ctx.refuse(node.place.refuse(RefusalKind::Rule, message).help(help)))
        }
        _ => of_time::read(field, wanted),
    }
}

fn table(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let table = field.table(&SIGNAL)?;
    let of_csv = ["csv", "column", "time", "time_unit", "separator", "outside"];
    if let Some(field) = of_csv.into_iter().find_map(|key| table.get(key)) {
        return Err(field.refuse(RefusalKind::UnknownKey, "stands beside feedback, which is an expression", None));
    }
    let expression = table.require("expression")?;
    expression.text()?;
    let unit = table.get("unit");
    let unit = unit.map(|unit| of_time::in_unit(&unit, Signal::constant(1.0), wanted.unit).map(|one| (unit, one)));
    let (scale, offset) = match unit.transpose()? {
        None => (1.0, 0.0),
        Some((unit, one)) => {
            let zero = of_time::in_unit(&unit, Signal::constant(0.0), wanted.unit)?.value(0.0);
            (one.value(0.0) - zero, zero)
        }
    };
    let sample = table.get("sample").map(|field| field.quantity()).transpose()?;
    let text = FeedbackText { node: expression.node.clone(), owner: field.to_string(), scale, offset, sample };
    Ok(in_place_of_signal(field, wanted.range, text))
}

/// What a temperature is before the first sample, K: its range has no 0.
const ROOM: f64 = 293.15;

/// The signal counts for nothing, but before the first sample; it must be one that its place takes.
fn in_place_of_signal(field: &Field<'_>, range: Range, text: FeedbackText) -> SignalPlan {
    let before = if range.low > 0.0 { ROOM } else { 0.0 };
    SignalPlan {
        signal: Signal::constant(before.clamp(range.low, range.high)),
        constant: None,
        written: field.node.place.text().to_owned(),
        place: field.node.place.clone(),
        feedback: Some(text.into()),
    }
}

/// Whether a text has a name with a dot in it, which only what is seen of the state has.
fn names_state(text: &str) -> bool {
    let bytes = text.as_bytes();
    let is_part = |c: u8| c.is_ascii_alphanumeric() || c == b'_' || c >= 0x80;
    text.match_indices('.').any(|(at, _)| {
        let follows = bytes.get(at + 1).is_some_and(|c| c.is_ascii_alphabetic() || *c == b'_' || *c >= 0x80);
        let start = bytes[..at].iter().rposition(|c| !is_part(*c)).map_or(0, |before| before + 1);
        let after = &text[at + 1..];
        let word = &after[..after.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(after.len())];
        let is_number = bytes.get(start).is_none_or(|c| c.is_ascii_digit()) || start == at;
        let is_of_module = is_of_module(&text[start..at + 1 + word.len()]);
        follows && !is_of_module && (!is_number || OF_ELEMENT.contains(&word) || OF_FORCES.contains(&word))
    })
}

#[cfg(test)]
mod tests {
    use super::names_state;

    #[test]
    fn names_with_dots_are_of_the_state() {
        for text in
            ["q.q1", "2*strut.rate", "-gripper.vx*3", "strut-2.force", "1.5*a_b.stroke", "strut.rat", "x+µ.rate"]
        {
            assert!(names_state(text), "{text}");
        }
        for text in ["1.5*t", "sin(2.*t)", "1.e5", "t-1.e5", ".5", "t*.5", "3.", "0.1*sin(8*t)", "20*np.sin(2*np.pi*t)"]
        {
            assert!(!names_state(text), "{text}");
        }
    }
}
