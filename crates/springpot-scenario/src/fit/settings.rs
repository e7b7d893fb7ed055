//! `[fit]`.

use super::plan::{FitSettings, Intervals};
use crate::keys::FIT;
use crate::reader::{Read, Table, all};
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::RefusalKind;
use springpot::law::{NetworkText, NetworkTextError};

/// Reads `[fit]`; what it leaves out has its default.
pub(super) fn read(root: &Table<'_>) -> Read<FitSettings> {
    let mut settings = FitSettings {
        starts: 20,
        seed: 1,
        confidence: 0.95,
        intervals: Intervals::Wald,
        laws: Vec::new(),
        element: None,
    };
    let Some(field) = root.get("fit") else { return Ok(settings) };
    let table = Table::of(field.ctx, field.node, "[fit]", &FIT)?;
    if let Some(field) = table.get("starts") {
        settings.starts = usize::try_from(field.whole()?).unwrap_or(1);
    }
    if let Some(field) = table.get("seed") {
        settings.seed = field.whole()?.unsigned_abs();
    }
    settings.confidence = table.number("confidence")?;
    if let Some(field) = table.get("intervals") {
        let text = field.text()?;
        settings.intervals = Intervals::named(text).ok_or_else(|| {
            let message = format!("is {:?}, which is no way to find intervals", shorten(text));
            let help = "write \"wald\", \"profile\", or \"bootstrap(200)\" with 20 to 100000 draws".to_owned();
            field.refuse(RefusalKind::UnknownName, message, Some(help))
        })?;
    }
    if let Some(field) = table.get("laws") {
        let items = field.items("an array of names of laws and of networks")?;
        settings.laws = all(items.iter().map(|item| {
            let text = item.text()?;
            match item.ctx.catalog.get(text) {
                Some(law) if law.has_lists() => {
                    let message = format!("names {text:?}, and how many terms it has is not known");
                    Err(item.refuse(RefusalKind::Rule, message, Some("write a law of single numbers".to_owned())))
                }
                Some(_) => Ok(text.to_owned()),
                None if text.contains('(') => match NetworkText::parse(text) {
                    Ok(network) if is_of_numbers(&network) => Ok(text.to_owned()),
                    Ok(_) => {
                        let message = format!(
                            "holds {:?}, which has a table, a list or an expression whose parameters have no unit",
                            shorten(text)
                        );
                        let help = "write a network of single numbers whose units its leaves say".to_owned();
                        Err(item.refuse(RefusalKind::Rule, message, Some(help)))
                    }
                    Err(NetworkTextError { message, span, help, unknown }) => {
                        let refusal = item.node.place_in_text(Some(span));
                        let refusal = refusal.refuse(RefusalKind::BadName, format!("`laws` of [fit]: {message}"));
                        let help = unknown.map_or(help, |(name, known)| names::suggest(&name, known));
                        Err(item.ctx.refuse(refusal.help(help)))
                    }
                },
                None => {
                    let laws = item.ctx.catalog.entries().iter().map(|entry| &*entry.name);
                    let message = format!("names {:?}, which is no law", shorten(text));
                    Err(item.refuse(RefusalKind::UnknownName, message, Some(names::suggest(text, laws))))
                }
            }
        }))?;
        if settings.laws.is_empty() {
            return Err(field.refuse(RefusalKind::Missing, "is empty", Some("write the names of laws".to_owned())));
        }
    }
    if let Some(field) = table.get("element") {
        settings.element = Some(field.text()?.to_owned());
    }
    if let (Some(laws), None) = (table.get("laws"), &settings.element) {
        let elements = root.node.get("element").and_then(|all| all.items()).unwrap_or_default();
        let names: Vec<&str> = elements.iter().filter_map(|element| element.get("name")?.text()).collect();
        match names[..] {
            [only] => settings.element = Some(only.to_owned()),
            _ => {
                let help = Some(format!("write element = one of {}", names::list(names)));
                return Err(laws.refuse(RefusalKind::Missing, "does not say of which element", help));
            }
        }
    }
    Ok(settings)
}

/// Whether all that a network names is single numbers of a known size.
fn is_of_numbers(network: &NetworkText) -> bool {
    let words = network.files().chain(network.texts()).chain(network.open());
    words.count() == 0 && !network.clone().entry().has_lists()
}
