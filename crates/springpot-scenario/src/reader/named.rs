//! Names that things of a scenario have.

use super::{Field, Read};
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Refuses a name that breaks the rule of names.
pub(crate) fn checked_name<'a>(field: &Field<'a>) -> Read<&'a str> {
    let name = field.text()?;
    if names::is_name(name) {
        return Ok(name);
    }
    let message = format!("is {}, which is not a name", field.node.written());
    let rule = "a name starts with a letter or _, then letters, digits, _ and - follow; letters are those from a to z and A to Z";
    let help = match names::as_name(name) {
        Some(right) => format!("{rule}; write {right:?}"),
        None => rule.to_owned(),
    };
    Err(field.refuse(RefusalKind::BadName, message, Some(help)))
}

/// Notes where `name` was used first, or refuses the second use.
pub(crate) fn unique(seen: &mut HashMap<String, Place>, field: &Field<'_>, name: &str) -> Read<()> {
    match seen.entry(name.to_owned()) {
        Entry::Vacant(entry) => {
            entry.insert(field.node.place.clone());
            Ok(())
        }
        Entry::Occupied(entry) => {
            let message = format!("is {:?}, which is taken on line {}", name, entry.get().position().0);
            Err(field.refuse(RefusalKind::BadName, message, Some("names are unique; choose another".to_owned())))
        }
    }
}
