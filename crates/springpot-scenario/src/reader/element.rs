//! What the table of an element says of it before it is read.

use super::Context;
use super::constants::unit_of;
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
    network_of(element).map_or(Vec::new(), |network| network.files().map(str::to_owned).collect())
}

/// Those that are no numbers: files, and texts of expressions.
pub(crate) fn words_of(element: &Node) -> Vec<String> {
    network_of(element)
        .map_or(Vec::new(), |network| network.files().chain(network.texts()).map(str::to_owned).collect())
}

/// The network of an element, with the expressions and the units that its parameters say.
fn network_of(element: &Node) -> Option<NetworkText> {
    let mut network = NetworkText::parse(element.get("network")?.text()?).ok()?;
    let parameters = element.get("parameters");
    let texts: Vec<String> = network.texts().map(str::to_owned).collect();
    for name in texts {
        if let Some(text) = parameters.and_then(|parameters| parameters.get(&name)?.text()) {
            network = network.with_text(&name, text).ok()?;
        }
    }
    Some(with_units(network, parameters.map(|parameters| &**parameters)))
}

/// The network, with the units that its parameters are written in where no leaf says one.
pub(crate) fn with_units(network: NetworkText, parameters: Option<&Node>) -> NetworkText {
    let open: Vec<String> = network.open().map(str::to_owned).collect();
    open.iter().fold(network, |network, name| {
        let unit = parameters.and_then(|parameters| Some(unit_of(parameters.get(name)?)));
        network.with_unit(name, &unit.unwrap_or_default())
    })
}

/// The law of an element that says one; nothing where it is none.
pub(crate) fn law_of(ctx: &Context<'_>, element: &Node) -> Option<Arc<Entry>> {
    let law = match (element.get("law"), element.get("network")) {
        (Some(law), None) => ctx.catalog.get(law.text()?).cloned()?,
        (None, Some(_)) => Arc::new(network_of(element)?.entry()),
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
