//! Elements without a robot: laws, parameters and inputs as a scenario writes them, for engines that have bodies of their own.

use super::document::{Entry, Node, Value};
use super::material;
use super::past::PastPlan;
use super::plan::{ElementPlan, SignalPlan};
use super::reader::Context;
use super::refusal::{Refusal, RefusalKind, Refusals, Source};
use super::signals::CsvCache;
use super::urdf::UrdfCache;
use super::{Scenario, names};
use springpot::law::{Catalog, Input};
use std::path::PathBuf;
use std::sync::Arc;

/// What an element may say here; all else is about a robot or about rows.
const KEYS: [&str; 10] =
    ["name", "law", "network", "parameters", "inputs", "derivative", "past", "shift", "thermal", "expansion"];

/// What elements hang on while they are read: a joint whose coordinate is the stroke.
const SLIDER: &str = r#"
robot.body = [{ name = "slider", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 1 }]
motion.kind = "forward"
time = { end = 1, output_step = 1 }
"#;

/// A temperature that every law takes, K.
const TEMPERATE: f64 = 293.15;

/// An element without a robot.
#[derive(Debug, Clone)]
pub struct LoneElement {
    /// All of it; what it acts along, and inputs that the text leaves out, stand for nothing.
    pub plan: ElementPlan,
    /// Its inputs where the text says them as functions of time, in the order of its law.
    pub inputs: Vec<Option<SignalPlan>>,
}

impl Scenario {
    /// The elements of a text that is no whole scenario: one `[[element]]` for each, or the keys of a single one. They have no ends, joint, rest or scheme, a
    /// `name` may be left out (`element1`, …), and so may inputs that come from elsewhere. Strokes are in m, forces in N.
    ///
    /// # Errors
    /// As [`Scenario::cases`]; other keys; a past that needs more than x(0).
    pub fn lone_elements(&self, catalog: &Catalog) -> Result<Vec<LoneElement>, Refusals> {
        let elements = self.written()?;
        let (tables, robots) = (CsvCache::default(), UrdfCache::default());
        let ctx = Context::new(catalog, &self.folder, &tables, &robots);
        let mut given = Vec::with_capacity(elements.len());
        let mut items = Vec::with_capacity(elements.len());
        for (k, element) in elements.into_iter().enumerate() {
            let law = material::law_of(&ctx, &element);
            let inputs = law.as_ref().map_or(&[][..], |law| &law.inputs[..]);
            let (hung, known) = hung(element, k, inputs);
            given.push(known);
            items.push(Arc::new(hung));
        }
        let cases = self.on_slider(items)?.cases(catalog)?;
        let plans = cases.plan(0)?.elements.into_iter().zip(given);
        let lone = plans.map(|(plan, given)| match plan.past {
            PastPlan::OfDerivative => {
                let inputs = plan.inputs.iter().zip(given).map(|(input, given)| given.then(|| input.clone()));
                Ok(LoneElement { inputs: inputs.collect(), plan })
            }
            _ => {
                let message = format!("element {:?} has a past that is not the whole of it here", plan.element.name);
                let refusal = plan.place.refuse(RefusalKind::Rule, message);
                Err(refusal.help("write past = \"held\" or past = \"unloaded\"").into())
            }
        });
        lone.collect()
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
        let entries = elements.iter().flat_map(|element| element.entries().unwrap_or_default());
        let unknown: Vec<Refusal> = entries.filter(|entry| !KEYS.contains(&entry.key.as_str())).map(refused).collect();
        if unknown.is_empty() { Ok(elements) } else { Err(Refusals::of(unknown)) }
    }

    /// A scenario of these elements alone.
    fn on_slider(&self, items: Vec<Arc<Node>>) -> Result<Self, Refusals> {
        let source = Arc::new(Source { name: self.source.name.clone(), text: SLIDER.into() });
        let mut document = Node::document(&source)?;
        let place = self.document.place.clone();
        let node = Node { value: Value::Array(items), place: place.clone(), tag: None };
        if let Value::Table(entries) = &mut document.value {
            entries.push(Entry { key: "element".to_owned(), key_place: place, node: Arc::new(node) });
        }
        Ok(Self { document, source: self.source.clone(), folder: PathBuf::clone(&self.folder), ..self.clone() })
    }
}

fn refused(entry: &Entry) -> Refusal {
    let message = format!("`{}` is no key of an element without a robot", entry.key);
    entry.key_place.refuse(RefusalKind::UnknownKey, message).help(names::suggest(&entry.key, KEYS))
}

/// An element on the slider with a name and all of its inputs, and which of them it says itself.
fn hung(element: Node, k: usize, inputs: &[Input]) -> (Node, Vec<bool>) {
    let place = element.place.clone();
    let entry = |key: &str, value: Value| Entry {
        key: key.to_owned(),
        key_place: place.clone(),
        node: Arc::new(Node { value, place: place.clone(), tag: None }),
    };
    let Value::Table(mut entries) = element.value else { return (element, Vec::new()) };
    let own = entries.iter().position(|entry| entry.key == "inputs").map(|at| entries.remove(at));
    let said = |name: &str| own.as_ref().is_some_and(|own| own.node.get(name).is_some());
    let given: Vec<bool> = inputs.iter().map(|input| said(&input.name)).collect();
    let silent = inputs.iter().zip(&given).filter(|(_, given)| !**given);
    let made = silent.map(|(Input { name, range, .. }, _)| {
        let value = [0.0, TEMPERATE, range.low].into_iter().find(|value| range.contains(*value)).unwrap_or(range.high);
        entry(name, Value::Number { value, integer: None })
    });
    let made: Vec<Entry> = made.collect();
    match own {
        // What is no table is refused as it stands.
        Some(own) if own.node.entries().is_none() => entries.push(own),
        own => {
            let written = own.as_ref().and_then(|own| own.node.entries()).unwrap_or_default();
            let all: Vec<Entry> = written.iter().cloned().chain(made).collect();
            if !all.is_empty() {
                entries.push(entry("inputs", Value::Table(all)));
            }
        }
    }
    entries.push(entry("joint", Value::Text("x".to_owned())));
    if !entries.iter().any(|entry| entry.key == "name") {
        entries.push(entry("name", Value::Text(format!("element{}", k + 1))));
    }
    (Node { value: Value::Table(entries), place, tag: element.tag }, given)
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
        let names: Vec<_> = elements.iter().map(|element| element.plan.element.name.as_str()).collect();
        assert_eq!(names, ["element1", "mr", "element3"]);
        assert_eq!(elements[0].plan.parameters[..3], [30.0, 20.0, 50.0]);
        assert!(elements[0].inputs.len() == 1 && elements[0].inputs[0].is_none());
        assert_eq!(elements[1].inputs[0].as_ref().unwrap().signal.at(1.5).value, 3.0);
        assert!(read("law = \"spring\"\nparameters = { k = \"2 N/mm\" }\n").unwrap()[0].plan.parameters == [2000.0]);
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
