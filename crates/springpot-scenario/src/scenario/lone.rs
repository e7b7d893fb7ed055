//! Elements without a robot: laws, parameters and inputs as a scenario writes them, for engines that have bodies of their own.

use super::written::Scenario;
use crate::elements::material::{self, InputsOf, Material};
use crate::elements::past::{self, PastPlan};
use crate::elements::{MAX_ELEMENTS, check, element_name};
use crate::keys::LONE;
use crate::reader::files::CsvCache;
use crate::reader::files::DescriptionCache;
use crate::reader::{Context, Read, Refused, Table, all};
use crate::signals::plan::SignalPlan;
use crate::text::document::{Entry as Written, Node, shorten};
use crate::text::names;
use crate::text::refusal::{Place, Refusal, RefusalKind, Refusals};
use springpot::law::{Catalog, Derivative, Entry, Network};
use std::collections::HashMap;
use std::sync::Arc;

/// An element without a robot.
#[derive(Debug, Clone)]
pub struct LoneElement {
    /// Its name.
    pub name: String,
    /// The entry of its law.
    pub entry: Arc<Entry>,
    /// The law with its parameters.
    pub law: Network,
    /// Which fractional derivative it takes.
    pub derivative: Derivative,
    /// The parameters in the order of the entry, SI.
    pub parameters: Vec<f64>,
    /// Its inputs where the text says them as functions of time, in the order of its law.
    pub inputs: Vec<Option<SignalPlan>>,
}

impl Scenario {
    /// The elements of a text that is no whole scenario: one `[[element]]` for each, or the keys of a single one. They have no ends, joint, rest or scheme, a
    /// `name` may be left out (`element1`, …), and so may inputs that come from elsewhere. Strokes are in m, forces in N.
    ///
    /// # Errors
    /// As [`Scenario::cases`]; other keys; a past that needs more than x(0); inputs that follow from columns.
    pub fn lone_elements(&self, catalog: &Catalog) -> Result<Vec<LoneElement>, Refusals> {
        let elements = self.written()?;
        let (tables, robots) = (CsvCache::default(), DescriptionCache::default());
        let ctx = Context::new(catalog, &self.folder, &tables, &robots);
        let unnamed = elements.iter().enumerate().filter(|(_, element)| element.get("name").is_none());
        let mut seen = unnamed.map(|(k, element)| (default_name(k), element.place.clone())).collect();
        let read = all(elements.iter().enumerate().map(|(k, element)| lone(&ctx, element, k, &mut seen)));
        ctx.finish(read)
    }

    /// The tables of the elements as they are written.
    fn written(&self) -> Result<Vec<Node>, Refusals> {
        let root = &self.document;
        let is_one = ["law", "network"].iter().any(|key| root.get(key).is_some());
        let elements = match root.get("element") {
            _ if is_one => vec![root.clone()],
            Some(elements) if elements.items().is_some_and(|items| !items.is_empty()) => {
                let other = root.entries().unwrap_or_default().iter().find(|entry| entry.key != "element");
                if let Some(other) = other {
                    let message = format!("`{}` stands beside the elements, which are alone here", other.key);
                    return Err(other.key_place.refuse(RefusalKind::UnknownKey, message).into());
                }
                elements.items().unwrap_or_default().iter().map(|item| Node::clone(item)).collect()
            }
            _ => {
                let refusal = root.place.refuse(RefusalKind::Missing, "there is no element");
                return Err(refusal.help("write [[element]] with a law or a network and its parameters").into());
            }
        };
        if elements.len() > MAX_ELEMENTS {
            let message = format!("there are {} elements; at most {MAX_ELEMENTS} are taken", elements.len());
            return Err(root.place.refuse(RefusalKind::TooLarge, message).into());
        }
        let entries = elements.iter().flat_map(|element| element.entries().unwrap_or_default());
        let unknown: Vec<Refusal> = entries.filter(|entry| LONE.get(&entry.key).is_none()).map(refused).collect();
        if unknown.is_empty() { Ok(elements) } else { Err(Refusals::of(unknown)) }
    }
}

fn refused(entry: &Written) -> Refusal {
    let message = format!("`{}` is no key of an element without a robot", entry.key);
    entry.key_place.refuse(RefusalKind::UnknownKey, message).help(names::suggest(&entry.key, LONE.names()))
}

fn default_name(k: usize) -> String {
    format!("element{}", k + 1)
}

fn lone(ctx: &Context<'_>, element: &Node, k: usize, seen: &mut HashMap<String, Place>) -> Read<LoneElement> {
    let default = default_name(k);
    let called = element.get("name").and_then(|name| name.text()).unwrap_or(&default);
    let table = Table::of(ctx, element, format!("element {:?}", shorten(called)), &LONE)?;
    let name = table.get("name").map(|field| element_name(&field, seen).map(str::to_owned));
    let past = past::read(&table);
    let material = material::read(&table, false, InputsOf::Lone)?;
    check(&table, &material, &past);
    let Material { law: entry, parameters, inputs, .. } = material;
    let (parameters, (derivative, past)) = (parameters?, past?);
    let law = entry.build(&parameters, derivative).map_err(|_| Refused)?;
    let name = name.unwrap_or(Ok(default))?;
    if !matches!(past, PastPlan::OfDerivative) {
        let message = format!("element {name:?} has a past that is not the whole of it here");
        let place = table.get("parameters").map_or(&element.place, |field| &field.node.place);
        let refusal = place.refuse(RefusalKind::Rule, message);
        return Err(ctx.refuse(refusal.help("write past = \"held\" or past = \"unloaded\"")));
    }
    Ok(LoneElement { name, entry, law, derivative, parameters, inputs: inputs? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<LoneElement>, Refusals> {
        Scenario::parse(text, "bank", "").and_then(|scenario| scenario.lone_elements(&Catalog::standard()))
    }

    #[test]
    fn elements_are_read_without_a_robot() {
        let text = "[[element]]\nlaw = \"thermoviscoelastic\"\n\
                    parameters = { E_c = \"30 N/m\", E_kv = 20, E_d = \"50 N*s^alpha/m\", alpha = 0.5, a_kv = \"0.0007 m/K\" }\n\
                    [[element]]\nname = \"mr\"\nlaw = \"magnetorheological\"\n\
                    parameters = { E_c = 1, mu_0 = 2, mu = 3, alpha = 0.4 }\ninputs = { u = \"2*t\" }\nderivative = \"riemann-liouville\"\n\
                    [[element]]\nnetwork = \"series(spring(k), springpot(c, alpha))\"\nparameters = { k = 1, c = 2, alpha = 0.3 }\n";
        let elements = read(text).unwrap();
        let names: Vec<_> = elements.iter().map(|element| element.name.as_str()).collect();
        assert_eq!(names, ["element1", "mr", "element3"]);
        assert_eq!(elements[0].parameters[..3], [30.0, 20.0, 50.0]);
        assert!(elements[0].inputs.len() == 1 && elements[0].inputs[0].is_none());
        assert_eq!(elements[1].inputs[0].as_ref().unwrap().signal.at(1.5).value, 3.0);
        assert!(read("law = \"spring\"\nparameters = { k = \"2 N/mm\" }\n").unwrap()[0].parameters == [2000.0]);
    }

    #[test]
    fn what_belongs_to_a_robot_or_is_wrong_is_refused_where_it_stands() {
        for (text, wanted) in [
            ("", "bank:1:1: there is no element"),
            ("element = []", "bank:1:1: there is no element"),
            ("law = \"sprung\"\nparameters = { k = 1 }", "bank:1:7: `law` of element \"element1\" is \"sprung\""),
            ("law = \"spring\"\nrest_length = 1\nparameters = { k = 1 }", "bank:2:1: `rest_length` is no key"),
            ("law = \"spring\"\nparameters = { k = \"1 N\" }", "bank:2:23:"),
            (
                "law = \"spring\"\npast = { held = 3 }\nparameters = { k = 1 }",
                "bank:3:14: element \"element1\" has a past",
            ),
            ("element = 3", "bank:1:1: there is no element"),
            ("law = \"spring\"\npast = \"steady\"\nparameters = { k = 1 }", "bank:1:1: "),
            (
                "law = \"magnetorheological\"\ninputs = { u = \"2*q.x\" }\nparameters = { E_c = 1, mu_0 = 2, mu = 3, alpha = 0.4 }",
                "bank:2:16: `u` ",
            ),
            (
                "[[element]]\nname = \"element2\"\nlaw = \"spring\"\nparameters = { k = 1 }\n[[element]]\nlaw = \"spring\"\nparameters = { k = 1 }",
                "bank:2:8: ",
            ),
            ("element = [3]", "bank:1:12:"),
            ("title = 3\n[[element]]\nlaw = \"spring\"", "bank:1:1: `title` stands beside"),
            (
                "law = \"magnetorheological\"\ninputs = { v = 2 }\nparameters = { E_c = 1, mu_0 = 2, mu = 3, alpha = 0.4 }",
                "bank:2:12:",
            ),
        ] {
            let refusals = read(text).map(|_| ()).unwrap_err().to_string();
            assert!(refusals.starts_with(wanted), "{text}\n{refusals}");
        }
    }
}
