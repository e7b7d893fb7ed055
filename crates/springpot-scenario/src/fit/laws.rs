//! Another law in place of that of an element.

use super::Fitting;
use super::plan::{DataKind, DataPlan};
use crate::text::document::{Entry, Node, Value};
use crate::text::refusal::Refusals;
use springpot::law::{Catalog, NetworkText, Param};
use std::sync::Arc;

/// About how stiff an element is, N/m, and at which rate, rad/s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    stiffness: f64,
    rate: f64,
}

impl Fitting {
    /// The same measurements with another law of the element of `[fit]`, by its name or as a network, all parameters of which are sought under their own names.
    ///
    /// # Errors
    /// The refusals of a scenario with that law.
    pub fn with_law(&self, law: &str) -> Result<Self, Refusals> {
        let element = self.plan.settings.element.as_deref();
        let own = self.plan.data.iter().find(|data| data.element.as_deref() == element && data.is_fitted);
        let size = own.and_then(size).unwrap_or(Size { stiffness: 100.0, rate: 10.0 });
        Self::new(&self.scenario, &self.catalog, Some((law, size)))
    }
}

/// What a record says of its element.
fn size(data: &DataPlan) -> Option<Size> {
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = values.filter(|x| x.is_finite()).fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x));
        (count > 0.0).then(|| f64::exp(sum / count))
    };
    let first = &data.columns[0].measured;
    let size = match data.kind {
        DataKind::Dma { is_polar } => {
            let second = &data.columns[1].measured;
            let stiffness = |(a, b): (&f64, &f64)| if is_polar { a.ln() } else { a.hypot(*b).ln() };
            let stiffness = mean(&mut first.iter().zip(second).map(stiffness))?;
            Size { stiffness, rate: mean(&mut data.at.iter().map(|w| w.ln()))? }
        }
        DataKind::Relaxation | DataKind::Creep => {
            let stiffness = mean(&mut first.iter().map(|x| x.ln()))?;
            let stiffness = if data.kind == DataKind::Creep { stiffness.recip() } else { stiffness };
            Size { stiffness, rate: mean(&mut data.at.iter().map(|t| -t.ln()))? }
        }
        DataKind::Stroke => {
            let stroke = data.told("stroke")?;
            let spread = |values: &[f64]| {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
            };
            let rates: Vec<f64> =
                (1..stroke.len()).map(|k| (stroke[k] - stroke[k - 1]) / (data.at[k] - data.at[k - 1])).collect();
            Size { stiffness: spread(first) / spread(stroke), rate: spread(&rates) / spread(stroke) }
        }
        DataKind::Run => return None,
    };
    (size.stiffness > 0.0 && size.stiffness.is_finite() && size.rate > 0.0 && size.rate.is_finite()).then_some(size)
}

/// Gives the element another law, with parameters of about that size; those of the same name stay.
pub(super) fn replace(catalog: &Catalog, document: &mut Node, element: &str, (law, size): (&str, Size)) {
    let written = || NetworkText::parse(law).ok().map(|network| Arc::new(network.entry()));
    let Some((entry, key)) =
        catalog.get(law).cloned().map(|entry| (entry, "law")).or_else(|| Some((written()?, "network")))
    else {
        return;
    };
    let Value::Table(sections) = &mut document.value else { return };
    let Some(elements) = sections.iter_mut().find(|section| section.key == "element") else { return };
    let Value::Array(items) = &mut Arc::make_mut(&mut elements.node).value else { return };
    let (name, component) = match items.iter().any(|item| item.get("name").and_then(|own| own.text()) == Some(element))
    {
        true => (element, None),
        false => match element.rsplit_once('.') {
            Some((name, component)) => (name, Some(component)),
            None => return,
        },
    };
    let own = |item: &&mut Arc<Node>| item.get("name").and_then(|own| own.text()) == Some(name);
    let Some(item) = items.iter_mut().find(own) else { return };
    let mut node = Arc::make_mut(item);
    for key in component.into_iter().flat_map(|component| ["bushing", component]) {
        let Value::Table(entries) = &mut node.value else { return };
        let Some(entry) = entries.iter_mut().find(|entry| entry.key == key) else { return };
        node = Arc::make_mut(&mut entry.node);
    }
    let place = node.place.clone();
    let given = node.get("parameters").cloned();
    let made = |key: &str, value: Value| Entry {
        key: key.to_owned(),
        key_place: place.clone(),
        node: Arc::new(Node { value, place: place.clone(), tag: None }),
    };
    let one = |param: &Param| {
        let kept =
            given.as_ref().and_then(|given| given.entries()?.iter().find(|entry| entry.key == param.name).cloned());
        kept.unwrap_or_else(|| made(&param.name, Value::Number { value: about(param, size), integer: None }))
    };
    let parameters = Value::Table(entry.params.iter().map(one).collect());
    let parameters = made("parameters", parameters);
    let law = made(key, Value::Text(law.to_owned()));
    let Value::Table(entries) = &mut node.value else { return };
    entries.retain(|entry| !["law", "network", "parameters"].contains(&entry.key.as_str()));
    entries.extend([law, parameters]);
}

/// About how large a parameter is.
fn about(param: &Param, Size { stiffness, rate }: Size) -> f64 {
    let value = match &*param.unit {
        "" if param.range.high <= 1.0 => 0.5,
        unit if unit.starts_with("N*s^") || unit.starts_with("N*m*s^") => stiffness / rate.sqrt(),
        unit if unit.starts_with("N*s/") || unit.starts_with("N*m*s/") => stiffness / rate,
        unit if unit.starts_with("N/") || unit.starts_with("N*m/") => stiffness,
        _ => param.default.unwrap_or(1.0),
    };
    value.clamp(param.range.low, param.range.high)
}
