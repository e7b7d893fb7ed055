//! What the table of an element says of it before it is read.

use super::Context;
use crate::keys::{BETWEEN, BUSHING, ON_JOINT};
use crate::text::document::Node;
use springpot::law::heat::{INPUT as TEMPERATURE, TEMPERATURE as RANGE};
use springpot::law::{Entry, Input, NetworkText};
use std::sync::Arc;

/// The keys of heat.
pub(crate) const HEATED: [&str; 3] = ["shift", "thermal", "expansion"];

/// What the element is by its keys.
pub(crate) fn kind_of(element: &Node) -> &'static str {
    match (element.get("joint"), element.get("bushing")) {
        (Some(_), _) => ON_JOINT,
        (None, Some(_)) => BUSHING,
        (None, None) => BETWEEN,
    }
}

/// The parameters of a network that are names of files; of other laws none.
pub(crate) fn files_of(element: &Node) -> Vec<String> {
    let network = element.get("network").and_then(|network| NetworkText::parse(network.text()?).ok());
    network.map_or(Vec::new(), |network| network.files().map(str::to_owned).collect())
}

/// The law of an element that says one; nothing where it is none.
pub(crate) fn law_of(ctx: &Context<'_>, element: &Node) -> Option<Arc<Entry>> {
    let law = match (element.get("law"), element.get("network")) {
        (Some(law), None) => ctx.catalog.get(law.text()?).cloned()?,
        (None, Some(network)) => Arc::new(NetworkText::parse(network.text()?).ok()?.entry()),
        _ => return None,
    };
    let takes = law.inputs.iter().any(|input| input.name == TEMPERATURE);
    let is_thermal = element.get("thermal").is_some();
    let is_heated = HEATED.iter().any(|key| element.get(key).is_some());
    if !is_heated || takes != is_thermal {
        return Some(law);
    }
    // The temperature is an input, or no longer one.
    let mut heated = Entry::clone(&law);
    match is_thermal {
        true => heated.inputs.retain(|input| input.name != TEMPERATURE),
        false => heated.inputs.push(Input::new(TEMPERATURE, "K", "temperature", RANGE)),
    }
    Some(Arc::new(heated))
}
