//! The element of a record, and what parameters move of it.

use crate::changes::path::Step;
use crate::elements::material::{self, InputsOf};
use crate::keys::ELEMENT;
use crate::reader::{Context, Read, Table};
use crate::sensitivity::{By, Slope, followers, slopes};
use crate::signals::plan::SignalPlan;
use crate::text::document::{Node, shorten};
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use springpot::dual::Dual;
use springpot::law::{Derivative, Entry, Heat, Network, RuleError, Shift};
use std::sync::Arc;

/// Where the element of this name, or the component of a bushing, stands in a document.
pub(super) fn steps(ctx: &Context<'_>, document: &Node, name: &str, place: &Place) -> Read<Vec<Step>> {
    let elements = document.get("element").and_then(|all| all.items()).unwrap_or_default();
    let find = |name: &str| {
        let own = |element: &Arc<Node>| element.get("name").and_then(|own| own.text()) == Some(name);
        elements.iter().position(own)
    };
    let first = || Step::Key("element".to_owned());
    if let Some(at) = find(name).filter(|at| elements[*at].get("bushing").is_none()) {
        return Ok(vec![first(), Step::Index(at)]);
    }
    if let Some((bushing, component)) = name.rsplit_once('.')
        && let Some(at) = find(bushing)
        && elements[at].get("bushing").and_then(|parts| parts.get(component)).is_some()
    {
        let within = [Step::Key("bushing".to_owned()), Step::Key(component.to_owned())];
        return Ok([first(), Step::Index(at)].into_iter().chain(within).collect());
    }
    let message = format!("{:?} is no element with a law", shorten(name));
    let all = elements.iter().filter_map(|element| element.get("name")?.text());
    Err(ctx.refuse(place.refuse(RefusalKind::UnknownName, message).help(names::suggest(name, all))))
}

/// What a parameter moves of an element.
#[derive(Debug, Clone, PartialEq)]
enum Way {
    Nothing,
    /// Numbers of its law.
    Law(Vec<usize>),
    /// A number of its shift.
    Shift(String),
    /// Whatever follows from a constant.
    Constant(String),
}

/// The element of a record.
#[derive(Debug, Clone)]
pub(super) struct Material {
    steps: Vec<Step>,
    is_rotation: bool,
    entry: Arc<Entry>,
    /// Without what temperature does to it.
    cold: Arc<Entry>,
    heat: Heat,
    pub(super) parameters: Vec<f64>,
    inputs: Vec<Option<SignalPlan>>,
    /// By each parameter of the record.
    ways: Vec<Way>,
}

/// An element of a record at some values of its parameters.
#[derive(Debug, Clone)]
pub struct MaterialAt {
    /// The law.
    pub law: Network,
    /// Its entry.
    pub entry: Arc<Entry>,
    /// Its parameters, SI, in the order of the entry.
    pub parameters: Vec<f64>,
    /// How temperature shifts it.
    pub shift: Option<Shift>,
    /// What each parameter of the record moves of it.
    pub moved: Vec<Moved>,
}

/// What a parameter moves.
#[derive(Debug, Clone)]
pub enum Moved {
    /// Nothing.
    Nothing,
    /// The law: it is built of numbers that carry their derivatives.
    Law(Network),
    /// Its clock: ln a_T by the number of this name of its shift.
    Clock(String),
}

impl MaterialAt {
    /// What ln a_T changes by with the number of the shift of this name, at a temperature, K.
    pub fn clock(&self, name: &str, temperature: f64) -> f64 {
        match self.shift {
            Some(Shift::Wlf { c1, c2, reference }) => {
                let above = temperature - reference;
                match name {
                    "C1" => -std::f64::consts::LN_10 * above / (c2 + above),
                    "C2" => std::f64::consts::LN_10 * c1 * above / (c2 + above).powi(2),
                    _ => std::f64::consts::LN_10 * c1 * c2 / (c2 + above).powi(2),
                }
            }
            Some(Shift::Arrhenius { energy, reference }) => match name {
                "energy" => (temperature.recip() - reference.recip()) / springpot::law::heat::GAS,
                _ => energy / springpot::law::heat::GAS / reference.powi(2),
            },
            None => 0.0,
        }
    }
}

/// The table that steps lead to.
pub(super) fn table<'n>(document: &'n Node, steps: &[Step]) -> Option<&'n Node> {
    steps.iter().try_fold(document, |node, step| match step {
        Step::Index(at) => node.items()?.get(*at).map(|item| &**item),
        Step::Key(key) => node.get(key).map(|node| &**node),
    })
}

impl Material {
    /// Reads the element of a document whose numbers are tagged.
    pub(super) fn read(
        ctx: &Context<'_>,
        document: &Node,
        (steps, is_rotation): (Vec<Step>, bool),
        bys: &[By],
    ) -> Read<Self> {
        let (entry, cold, heat, parameters, inputs) = Self::parts(ctx, document, &steps, is_rotation)?;
        let mut own = Self { steps, is_rotation, entry, cold, heat, parameters, inputs, ways: Vec::new() };
        own.ways = bys.iter().map(|by| own.way(by)).collect();
        Ok(own)
    }

    #[allow(clippy::type_complexity)]
    fn parts(
        ctx: &Context<'_>,
        document: &Node,
        steps: &[Step],
        is_rotation: bool,
    ) -> Read<(Arc<Entry>, Arc<Entry>, Heat, Vec<f64>, Vec<Option<SignalPlan>>)> {
        let node = table(document, steps).unwrap_or(document);
        let name = node.get("name").and_then(|name| name.text()).unwrap_or("?");
        let table = Table::of(ctx, node, format!("element {:?}", shorten(name)), &ELEMENT)?;
        let material::Material { law, cold, heat, parameters, inputs, .. } =
            material::read(&table, is_rotation, InputsOf::Lone)?;
        let (parameters, inputs) = (parameters?, inputs?);
        law.build(&parameters, Derivative::Caputo).map_err(|RuleError { rule, parameter }| {
            let place =
                node.get("parameters").and_then(|all| all.get(&parameter)).map_or(&node.place, |one| &one.place);
            let message = format!("{}: law {} needs {rule}", table.what, law.quoted());
            ctx.refuse(place.refuse(RefusalKind::Rule, message).label(format!("change `{parameter}`")))
        })?;
        Ok((law, cold, heat, parameters, inputs))
    }

    /// The number of the law that steps behind those of the element lead to.
    fn index(&self, rest: &[Step]) -> Option<usize> {
        let name = match rest {
            [Step::Key(section), Step::Key(name)] if section == "parameters" => name.clone(),
            [Step::Key(section), Step::Key(list), Step::Index(k)] if section == "parameters" => format!("{list}.{k}"),
            _ => return None,
        };
        self.entry.params.iter().position(|param| param.name == name)
    }

    fn way(&self, by: &By) -> Way {
        let within = |steps: &[Step]| steps.strip_prefix(self.steps.as_slice()).map(<[Step]>::to_vec);
        let mut law = Vec::new();
        for target in &by.targets {
            match &target.steps[..] {
                [Step::Key(section), Step::Key(name)] if section == "constants" => return Way::Constant(name.clone()),
                steps => {
                    let Some(rest) = within(steps) else { continue };
                    if let [Step::Key(section), Step::Key(name)] = &rest[..]
                        && section == "shift"
                    {
                        return Way::Shift(name.clone());
                    }
                    law.extend(self.index(&rest));
                }
            }
        }
        if law.is_empty() { Way::Nothing } else { Way::Law(law) }
    }

    /// Names and units of its inputs.
    pub(super) fn inputs(&self) -> Vec<(String, String)> {
        self.entry.inputs.iter().map(|input| (input.name.to_string(), input.unit.to_string())).collect()
    }

    /// The signals of its inputs where the file says them.
    pub(super) fn signals(&self) -> &[Option<SignalPlan>] {
        &self.inputs
    }

    pub(super) fn entry(&self) -> &Arc<Entry> {
        &self.entry
    }

    /// Which number of its law the parameter `k` of the record is.
    pub(super) fn number(&self, k: usize) -> Option<usize> {
        match &self.ways[k] {
            Way::Law(numbers) => numbers.first().copied(),
            _ => None,
        }
    }

    /// Whether the parameter `k` of the record is a number of its shift.
    pub(super) fn is_shift(&self, k: usize) -> bool {
        matches!(self.ways[k], Way::Shift(_))
    }

    /// Whether a constant may move it: the document is then to be read again.
    pub(super) fn follows_constants(&self) -> bool {
        self.ways.iter().any(|way| matches!(way, Way::Constant(_)))
    }

    /// It at these values of the record's parameters.
    pub(super) fn at(&self, values: &[f64], derivative: Derivative) -> Result<MaterialAt, String> {
        let (mut parameters, mut heat) = (self.parameters.clone(), self.heat);
        for (way, value) in self.ways.iter().zip(values) {
            match way {
                Way::Law(numbers) => numbers.iter().for_each(|k| parameters[*k] = *value),
                Way::Shift(name) => heat.shift = heat.shift.map(|shift| shifted(shift, name, *value)),
                Way::Nothing | Way::Constant(_) => {}
            }
        }
        let by = self.ways.iter().map(|way| match way {
            Way::Law(numbers) => Turned::Law((0..parameters.len()).map(|k| f64::from(numbers.contains(&k))).collect()),
            Way::Shift(name) => Turned::Shift(name.clone()),
            Way::Nothing | Way::Constant(_) => Turned::Nothing,
        });
        let by: Vec<Turned> = by.collect();
        self.made(parameters, heat, by, derivative)
    }

    /// It as a document with other values has it.
    pub(super) fn again(
        &self,
        ctx: &Context<'_>,
        document: &Node,
        derivative: Derivative,
    ) -> Read<Result<MaterialAt, String>> {
        let (_, _, heat, parameters, _) = Self::parts(ctx, document, &self.steps, self.is_rotation)?;
        let constants = ctx.constants().clone();
        let by = self.ways.iter().map(|way| match way {
            Way::Law(numbers) => {
                Ok(Turned::Law((0..parameters.len()).map(|k| f64::from(numbers.contains(&k))).collect()))
            }
            Way::Shift(name) => Ok(Turned::Shift(name.clone())),
            Way::Nothing => Ok(Turned::Nothing),
            Way::Constant(name) => {
                let slopes = slopes(document, name, &constants)?;
                let mut own = vec![0.0; parameters.len()];
                for (steps, slope) in followers(document, &slopes) {
                    let Some(rest) = steps.strip_prefix(self.steps.as_slice()) else { continue };
                    let Some(k) = self.index(rest) else {
                        let what = rest.last().map_or(String::new(), |step| format!("{step:?}"));
                        return Err(format!(
                            "constants.{name} moves {what} of the element, by which no derivative is known"
                        ));
                    };
                    own[k] += match slope? {
                        Slope::Number(by) => by,
                        // A number of a law names no time.
                        Slope::Signal { by, .. } => by.at(0.0).value,
                        Slope::Feedback(_) => {
                            return Err(format!("constants.{name} moves what follows from the state"));
                        }
                    };
                }
                Ok(Turned::Law(own))
            }
        });
        let by: Result<Vec<Turned>, String> = by.collect();
        Ok(by.and_then(|by| self.made(parameters, heat, by, derivative)))
    }

    fn made(
        &self,
        parameters: Vec<f64>,
        heat: Heat,
        by: Vec<Turned>,
        derivative: Derivative,
    ) -> Result<MaterialAt, String> {
        for (param, value) in self.entry.params.iter().zip(&parameters) {
            if !param.range.contains(*value) {
                return Err(format!("{} = {value} is outside its range", param.name));
            }
        }
        let entry = match heat == self.heat {
            true => self.entry.clone(),
            false => Arc::new(Entry::clone(&self.cold).with_heat(heat).map_err(|error| error.to_string())?),
        };
        let build = |slopes: Option<&[f64]>| {
            let slope = |k: usize| slopes.map_or(0.0, |slopes| slopes[k]);
            let numbers = parameters.iter().enumerate().map(|(k, value)| Dual { value: *value, slope: slope(k) });
            (entry.build)(&numbers.collect::<Vec<_>>(), derivative).map_err(|error| error.to_string())
        };
        let law = build(None)?;
        let moved = by.into_iter().map(|by| {
            Ok(match by {
                Turned::Law(slopes) if slopes.iter().any(|slope| *slope != 0.0) => Moved::Law(build(Some(&slopes))?),
                Turned::Shift(name) => Moved::Clock(name),
                Turned::Law(_) | Turned::Nothing => Moved::Nothing,
            })
        });
        let moved = moved.collect::<Result<_, String>>()?;
        Ok(MaterialAt { law, moved, shift: heat.shift, entry, parameters })
    }
}

/// What a parameter turns.
enum Turned {
    Nothing,
    /// The numbers of the law, each by so much.
    Law(Vec<f64>),
    Shift(String),
}

/// A shift with another number.
fn shifted(shift: Shift, name: &str, value: f64) -> Shift {
    match (shift, name) {
        (Shift::Wlf { c2, reference, .. }, "C1") => Shift::Wlf { c1: value, c2, reference },
        (Shift::Wlf { c1, reference, .. }, "C2") => Shift::Wlf { c1, c2: value, reference },
        (Shift::Wlf { c1, c2, .. }, "T_ref") => Shift::Wlf { c1, c2, reference: value },
        (Shift::Arrhenius { reference, .. }, "energy") => Shift::Arrhenius { energy: value, reference },
        (Shift::Arrhenius { energy, .. }, "T_ref") => Shift::Arrhenius { energy, reference: value },
        (other, _) => other,
    }
}
