//! The scenario with other numbers, everything else as it is written.

use super::Fitting;
use super::plan::{FitParameter, Role};
use crate::changes::path::{self, Step};
use crate::scenario::put::{Edits, written};
use crate::text::quoted::{toml_key, toml_text};

impl Fitting {
    /// The text of the scenario with what `--set` said and these values of the parameters put in; comments stay. Parameters of one record go into its
    /// `set`.
    pub fn fitted(&self, values: &[f64]) -> String {
        let scenario = &self.scenario;
        let mut edits = Edits::default();
        let parameters: Vec<(&[Step], String, &str)> = self.global(values).collect();
        for one in &scenario.overrides {
            let ctx = self.context();
            let Ok(target) = path::resolve(&ctx, &scenario.document, &one.path, &one.place) else { continue };
            let is_sought = parameters.iter().any(|(steps, ..)| *steps == target.steps.as_slice());
            let Some(value) = one.value.as_ref().filter(|_| !is_sought) else { continue };
            edits.put(&scenario.document, &target.steps, written(value), &one.path);
        }
        for (steps, text, name) in parameters {
            edits.put(&scenario.document, steps, text, name);
        }
        for record in 0..self.plan.data.len() {
            let is_own = |parameter: &FitParameter| parameter.role == Role::Number { record: Some(record) };
            let own = self.plan.parameters.iter().zip(values).filter(|(parameter, _)| is_own(parameter));
            let own: Vec<(&str, String)> =
                own.map(|(parameter, value)| (&*parameter.paths[0], quantity(*value, &parameter.unit))).collect();
            let table = |key: &str| Step::Key(key.to_owned());
            let steps = [table("data"), Step::Index(record), table("set")];
            let data = scenario.document.get("data").and_then(|data| data.items()?.get(record).cloned());
            if data.is_some_and(|data| data.get("set").is_none()) && !own.is_empty() {
                let entries = own.iter().map(|(path, text)| format!("{} = {text}", toml_key(path)));
                let text = format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "));
                edits.put(&scenario.document, &steps, text, "set");
                continue;
            }
            for (path, text) in own {
                let steps: Vec<Step> = steps.iter().cloned().chain([table(path)]).collect();
                edits.put(&scenario.document, &steps, text, path);
            }
        }
        edits.applied(&scenario.source.text, "has")
    }

    /// Where the numbers of all records stand, as they are to be written, and their paths.
    fn global(&self, values: &[f64]) -> impl Iterator<Item = (&[Step], String, &str)> {
        let all = &self.records[0].asked.by;
        let sought = self.plan.parameters.iter().zip(values).zip(all);
        let sought = sought.filter(|((parameter, _), _)| parameter.role == Role::Number { record: None });
        sought.flat_map(move |((parameter, value), by)| {
            by.targets.iter().map(move |target| {
                let is_text = path::get(&self.scenario.document, target).is_some_and(|node| node.text().is_some());
                let text = if is_text { quantity(*value, &parameter.unit) } else { number(*value) };
                (target.steps.as_slice(), text, target.written.as_str())
            })
        })
    }
}

/// A number as TOML has it.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn quantity(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { toml_text(&format!("{value:?} {unit}")) }
}
