//! What a law is made of, as Python says it.

use super::{PyLaw, definition_name};
use crate::array::column;
use crate::error::{type_error, value_error};
use crate::quantity::number_with;
use crate::scenario::CATALOG;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use springpot::law::{Derivative, Entry, NetworkText, Param, Table};
use springpot_scenario::suggest;
use springpot_scenario::units::si_unit;
use std::borrow::Cow;
use std::sync::Arc;

/// Keys of a description.
const KEYS: [&str; 5] = ["name", "law", "network", "parameters", "derivative"];

/// A law as it is described: `{"law": name | "network": text, "parameters": {…}, "derivative": "caputo", "name": …}`.
#[derive(Debug, Clone)]
pub(crate) struct Description {
    /// What the element is called.
    pub(crate) name: Option<String>,
    is_network: bool,
    text: String,
    /// SI numbers, lists of them, points of a table, or expressions.
    values: Vec<(String, Value)>,
    /// Units of parameters that expressions alone name.
    units: Vec<(String, String)>,
    derivative: Derivative,
    entry: Option<Arc<Entry>>,
}

#[derive(Debug, Clone, PartialEq)]
enum Value {
    One(f64),
    List(Vec<f64>),
    /// x and F of a leaf `table`.
    Points(Vec<f64>, Vec<f64>),
    /// The text of a leaf `expression`.
    Text(String),
}

/// Reads a description, or a `Law`.
pub(crate) fn described(said: &Bound<'_, PyAny>) -> PyResult<Description> {
    if let Ok(law) = said.cast::<PyLaw>() {
        return Ok(law.get().made_of.clone());
    }
    let words = said.cast::<PyDict>().map_err(|_| {
        type_error("a law is a Law, or a dict {\"law\": …} or {\"network\": …} with \"parameters\" and \"derivative\"")
    })?;
    for key in words.keys() {
        let key: String = key.extract()?;
        if !KEYS.contains(&key.as_str()) {
            return Err(value_error(format!("a law has no key \"{key}\"; {}", suggest(&key, KEYS))));
        }
    }
    let derivative = match words.get_item("derivative")? {
        None => Derivative::Caputo,
        Some(name) => derivative(&name)?,
    };
    let name = words.get_item("name")?.map(|name| name.extract()).transpose()?;
    let parameters = words.get_item("parameters")?;
    let parameters = match &parameters {
        None => PyDict::new(said.py()),
        Some(given) => given.cast::<PyDict>().map_err(|_| type_error("parameters must be a dict"))?.clone(),
    };
    match (words.get_item("law")?, words.get_item("network")?) {
        (Some(law), None) => {
            if let Ok(law) = law.cast::<PyLaw>() {
                return Ok(Description { name, ..law.get().made_of.clone() });
            }
            let text: String = law.extract().map_err(|_| type_error("law must be the name of a law"))?;
            let Some(entry) = CATALOG.get(&text) else {
                let help = suggest(&text, CATALOG.entries().iter().map(|entry| &*entry.name).collect::<Vec<_>>());
                return Err(value_error(format!("there is no law \"{text}\"; {help}")));
            };
            let values = values(&entry.params, (&[], &[]), &parameters)?;
            let (units, entry) = (Vec::new(), Some(entry.clone()));
            Ok(Description { name, is_network: false, text, values, units, derivative, entry })
        }
        (None, Some(network)) => {
            let text: String = network.extract().map_err(|_| type_error("network must be a text"))?;
            let (read, mut words) = with_texts(parse(&text)?, &parameters)?;
            let units = units(&read, &parameters)?;
            let read = with_units(read, &units);
            let files: Vec<String> = read.files().map(str::to_owned).collect();
            let texts: Vec<String> = read.texts().map(str::to_owned).collect();
            let mut values = values(&read.entry().params, (&files, &texts), &parameters)?;
            values.append(&mut words);
            Ok(Description { name, is_network: true, text, values, units, derivative, entry: None })
        }
        _ => Err(value_error("a law needs either \"law\" or \"network\"")),
    }
}

fn parse(text: &str) -> PyResult<NetworkText> {
    NetworkText::parse(text).map_err(|error| {
        let help = match &error.unknown {
            Some((name, known)) => suggest(name, known.iter().copied()),
            None => error.help.clone(),
        };
        value_error(format!("network, character {}: {}; {help}", error.span.start + 1, error.message))
    })
}

/// The network with the expressions that its parameters say, and these.
fn with_texts(network: NetworkText, given: &Bound<'_, PyDict>) -> PyResult<(NetworkText, Vec<(String, Value)>)> {
    let names: Vec<String> = network.texts().map(str::to_owned).collect();
    names.into_iter().try_fold((network, Vec::new()), |(network, mut words), name| {
        let missing = || {
            value_error(format!(
                "the expression \"{name}\" is missing: a text of the stroke x, its rate v and parameters"
            ))
        };
        let text = given.get_item(&name)?.ok_or_else(missing)?;
        let text: String =
            text.extract().map_err(|_| type_error(format!("{name} must be a text, such as \"k*x + c*v\"")))?;
        let network = with_text(network, &name, &text)?;
        words.push((name, Value::Text(text)));
        Ok((network, words))
    })
}

fn with_text(network: NetworkText, name: &str, text: &str) -> PyResult<NetworkText> {
    network.with_text(name, text).map_err(|error| match error.span() {
        Some(span) => value_error(format!("{name}, character {}: {error}", span.start + 1)),
        None => value_error(format!("{name}: {error}")),
    })
}

/// The SI units of parameters that expressions alone name, as they are given.
fn units(network: &NetworkText, given: &Bound<'_, PyDict>) -> PyResult<Vec<(String, String)>> {
    let mut units = Vec::new();
    for name in network.open() {
        let Some(value) = given.get_item(name)? else { continue };
        let Ok(text) = value.extract::<String>() else { continue };
        let unit = si_unit(&text).map_err(|error| value_error(format!("{name}: {error}")))?;
        units.push((name.to_owned(), unit));
    }
    Ok(units)
}

fn with_units(network: NetworkText, units: &[(String, String)]) -> NetworkText {
    units.iter().fold(network, |network, (name, unit)| network.with_unit(name, unit))
}

/// The definition of that name.
pub(crate) fn derivative(name: &Bound<'_, PyAny>) -> PyResult<Derivative> {
    let name: String = name.extract().map_err(|_| type_error("derivative must be a text"))?;
    let all = [Derivative::Caputo, Derivative::RiemannLiouville];
    let found = all.into_iter().find(|derivative| definition_name(*derivative) == name);
    found.ok_or_else(|| value_error(format!("derivative is \"{name}\"; write \"caputo\" or \"riemann-liouville\"")))
}

/// Parameters in SI, in the order of the law; what is left out has its default.
fn values(
    params: &[Param],
    (files, texts): (&[String], &[String]),
    given: &Bound<'_, PyDict>,
) -> PyResult<Vec<(String, Value)>> {
    let words = files.iter().chain(texts).map(String::as_str);
    let known: Vec<&str> = params.iter().map(|param| &*param.name).chain(words).collect();
    for key in given.keys() {
        let key: String = key.extract()?;
        if !known.contains(&key.as_str()) {
            return Err(value_error(format!("the law has no parameter \"{key}\"; {}", suggest(&key, known.clone()))));
        }
    }
    // Orders may stand in units as exponents.
    let order = |name: &str| given.get_item(name).ok().flatten().and_then(|value| value.extract::<f64>().ok());
    let in_range = |param: &Param, value: f64| match param.range.contains(value) {
        true => Ok(value),
        false => {
            let (low, high) = (param.range.low, param.range.high);
            let range = match (low > f64::MIN, high < f64::MAX) {
                (true, true) => format!("between {low} and {high}"),
                (true, false) if low <= f64::MIN_POSITIVE => if low > 0.0 { "positive" } else { "not negative" }.into(),
                (true, false) => format!("at least {low}"),
                _ => format!("at most {high}"),
            };
            Err(value_error(format!("{} is {value}; it must be {range}", param.name)))
        }
    };
    let mut values: Vec<(String, Value)> = Vec::new();
    for param in params {
        let value = match given.get_item(&*param.name)? {
            None => Value::One(param.default.ok_or_else(|| {
                let unit = if param.unit.is_empty() { "a pure number" } else { &param.unit };
                value_error(format!("the parameter \"{}\" is missing: {}, {unit}", param.name, param.meaning))
            })?),
            Some(list) if param.is_list => {
                if list.is_instance_of::<PyString>() {
                    return Err(type_error(format!("{} must be a list", param.name)));
                }
                let items = list
                    .try_iter()?
                    .map(|item| in_range(param, number_with(&item?, &param.unit, &param.name, &order)?));
                Value::List(items.collect::<PyResult<_>>()?)
            }
            Some(value) => Value::One(in_range(param, number_with(&value, &param.unit, &param.name, &order)?)?),
        };
        values.push((param.name.to_string(), value));
    }
    let mut lists = values.iter().filter_map(|(name, value)| match value {
        Value::List(items) => Some((name, items.len())),
        _ => None,
    });
    if let Some((first, count)) = lists.next()
        && let Some((other, found)) = lists.find(|(_, other)| *other != count)
    {
        return Err(value_error(format!(
            "{first} has {count} values, and {other} has {found}; they must have as many"
        )));
    }
    for file in files {
        let Some(points) = given.get_item(file)? else {
            return Err(value_error(format!("the table \"{file}\" is missing: a tuple of strokes, m, and forces, N")));
        };
        let (x, force): (Bound<'_, PyAny>, Bound<'_, PyAny>) =
            points.extract().map_err(|_| type_error(format!("{file} must be a tuple of strokes, m, and forces, N")))?;
        values.push((file.clone(), Value::Points(column(&x, file)?, column(&force, file)?)));
    }
    Ok(values)
}

impl Description {
    /// Whether both describe one law, whatever the elements are called.
    pub(super) fn is_same_law(&self, other: &Self) -> bool {
        let of = |one: &Self| (one.is_network, one.derivative);
        of(self) == of(other) && self.text == other.text && self.values == other.values
    }

    /// Names, strokes and forces of its tables.
    pub(super) fn tables(&self) -> impl Iterator<Item = (&str, &[f64], &[f64])> {
        self.values.iter().filter_map(|(name, value)| match value {
            Value::Points(x, force) => Some((name.as_str(), &x[..], &force[..])),
            _ => None,
        })
    }

    /// Names and texts of its expressions.
    pub(super) fn texts(&self) -> impl Iterator<Item = (&str, &str)> {
        self.values.iter().filter_map(|(name, value)| match value {
            Value::Text(text) => Some((name.as_str(), text.as_str())),
            _ => None,
        })
    }

    /// The law that it describes.
    pub(crate) fn build(self) -> PyResult<PyLaw> {
        let entry = match &self.entry {
            Some(entry) => entry.clone(),
            None => {
                let mut text = parse(&self.text)?;
                for (file, value) in &self.values {
                    if let Value::Points(x, force) = value {
                        if x.len() != force.len() {
                            return Err(value_error(format!(
                                "{file} has {} strokes and {} forces",
                                x.len(),
                                force.len()
                            )));
                        }
                        let points = x.iter().copied().zip(force.iter().copied());
                        let table = Table::new(points).map_err(|error| value_error(format!("{file}: {error}")))?;
                        text = text.with_table(file, table);
                    }
                }
                for (name, source) in self.texts() {
                    text = with_text(text, name, source)?;
                }
                Arc::new(with_units(text, &self.units).entry())
            }
        };
        let numbers = self.values.iter().filter_map(|(_, value)| match value {
            Value::One(value) => Some(vec![*value]),
            Value::List(values) => Some(values.clone()),
            Value::Points(..) | Value::Text(_) => None,
        });
        let values: Vec<Vec<f64>> = numbers.collect();
        let built = entry.build(&values.concat(), self.derivative);
        let network = built.map_err(|broken| {
            let parameter: &Cow<'_, str> = &broken.parameter;
            value_error(format!("the law demands {} ({parameter})", broken.rule))
        })?;
        Ok(PyLaw { entry, network, derivative: self.derivative, values, made_of: self })
    }

    /// As a dict that describes the same.
    pub(crate) fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (words, parameters) = (PyDict::new(py), PyDict::new(py));
        if let Some(name) = &self.name {
            words.set_item("name", name)?;
        }
        words.set_item(if self.is_network { "network" } else { "law" }, &self.text)?;
        for (name, value) in &self.values {
            let unit = self.units.iter().find(|(own, unit)| own == name && !unit.is_empty());
            match value {
                Value::One(value) => match unit {
                    Some((_, unit)) => parameters.set_item(name, format!("{value:?} {unit}"))?,
                    None => parameters.set_item(name, value)?,
                },
                Value::Text(text) => parameters.set_item(name, text)?,
                Value::List(values) => parameters.set_item(name, values)?,
                Value::Points(x, force) => parameters.set_item(name, (x, force))?,
            }
        }
        words.set_item("parameters", parameters)?;
        words.set_item("derivative", definition_name(self.derivative))?;
        Ok(words)
    }
}
