//! `[[data]]` and `[fit]`: measurements, what is sought, and the scenario at other values of it.

mod columns;
mod fitted;
mod gathered;
mod laws;
mod material;
mod plan;
mod record;
mod settings;

pub use material::{MaterialAt, Moved};
pub use plan::{DataColumn, DataKind, DataPlan, FitParameter, FitPlan, FitSettings, Intervals, PastOfStroke, Role};

use self::material::Material;
use crate::cases::{read_plan, root};
use crate::changes::path::Step;
use crate::plan::Plan;
use crate::reader::Context;
use crate::reader::files::{CsvCache, DescriptionCache};
use crate::scenario::Scenario;
use crate::scenario::root::SCENARIO;
use crate::sensitivity::{self, Asked, By};
use crate::text::document::{Node, Value};
use crate::text::refusal::{Refusals, Remark};
use springpot::law::{Catalog, Derivative};
use springpot::observe::Quantity;
use springpot::signal::Signal;
use std::path::PathBuf;
use std::sync::Arc;

/// A scenario with its measurements, at any values of its parameters.
#[derive(Debug)]
pub struct Fitting {
    scenario: Scenario,
    catalog: Catalog,
    folder: PathBuf,
    tables: CsvCache,
    robots: DescriptionCache,
    records: Vec<Case>,
    plan: FitPlan,
    remarks: Vec<Remark>,
}

/// What the model of a record follows from.
#[derive(Debug)]
struct Case {
    /// Under the conditions of the record, its parameters tagged.
    document: Node,
    asked: Asked,
    material: Option<Material>,
    /// Of a run: its columns.
    quantities: Vec<Quantity>,
}

impl Scenario {
    /// The measurements of the scenario, and what is sought: a file whose data are all of elements needs no robot, motion or time, and its
    /// elements no ends.
    ///
    /// # Errors
    /// All refusals that could be collected.
    pub fn fit(&self, catalog: &Catalog) -> Result<Fitting, Refusals> {
        Fitting::new(self, catalog, None)
    }

    /// Whether it has measurements.
    pub fn has_data(&self) -> bool {
        self.document.get("data").is_some()
    }

    /// Whether all of its measurements are of elements.
    pub fn is_of_elements(&self) -> bool {
        let items = self.document.get("data").and_then(|data| data.items()).unwrap_or_default();
        let is_run = |item: &Arc<Node>| item.get("kind").is_none_or(|kind| kind.text() == Some(crate::keys::RUN));
        !items.is_empty() && !items.iter().any(is_run)
    }
}

impl Fitting {
    /// What is fitted to what.
    pub fn plan(&self) -> &FitPlan {
        &self.plan
    }

    /// What deserves a warning.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// The scenario that it was read of.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    fn context(&self) -> Context<'_> {
        Context::new(&self.catalog, &self.folder, &self.tables, &self.robots).of_whole(&SCENARIO)
    }

    /// The document of a record with these values of its parameters, SI, those that are wanted being tagged in their order.
    fn document_at(&self, record: usize, values: &[f64], wanted: impl Fn(usize) -> bool) -> Node {
        let case = &self.records[record];
        let mut document = case.document.clone();
        let indices = &self.plan.data[record].parameters;
        let mut tags = 0..;
        for (by, k) in case.asked.by.iter().zip(indices) {
            for target in &by.targets {
                let tag = if wanted(*k) { tags.next() } else { None };
                put(&mut document, &target.steps, (values[*k], tag));
            }
        }
        document
    }

    /// The element of a record at these values of all parameters.
    ///
    /// # Errors
    /// Why there is none.
    ///
    /// # Panics
    /// Of a record that is of a run.
    pub fn material_at(&self, record: usize, values: &[f64]) -> Result<MaterialAt, String> {
        let (case, data) = (&self.records[record], &self.plan.data[record]);
        let material = case.material.as_ref().expect("a record of an element");
        let derivative =
            if data.past == PastOfStroke::Unloaded { Derivative::RiemannLiouville } else { Derivative::Caputo };
        if !material.follows_constants() {
            let own: Vec<f64> = data.parameters.iter().map(|k| values[*k]).collect();
            return material.at(&own, derivative);
        }
        let document = self.document_at(record, values, |_| false);
        let ctx = self.context();
        let read = root(&ctx, &document).and_then(|_| material.again(&ctx, &document, derivative));
        ctx.finish(read).map_err(|refusals| refusals.to_string())?
    }

    /// Names of the inputs of the element of a record, and their signals where the file says them.
    pub fn inputs(&self, record: usize) -> Vec<(String, Option<Signal>)> {
        let Some(material) = &self.records[record].material else { return Vec::new() };
        let signals = material.signals().iter().map(|signal| signal.as_ref().map(|signal| signal.signal.clone()));
        material.inputs().into_iter().map(|(name, _)| name).zip(signals).collect()
    }

    /// The run of a record at these values, differentiated by those of the record's parameters that are `wanted`.
    ///
    /// # Errors
    /// Why there is none.
    pub fn run_at(&self, record: usize, values: &[f64], wanted: &[bool]) -> Result<Plan, String> {
        let document = self.document_at(record, values, |k| wanted[k]);
        let case = &self.records[record];
        let sought = case.asked.by.iter().zip(&self.plan.data[record].parameters).filter(|(_, k)| wanted[**k]);
        let by: Vec<By> = sought.map(|(by, _)| by.clone()).collect();
        let asked = Asked { is_asked: !by.is_empty(), by, of: case.asked.of.clone(), control: false, adjoint: None };
        self.planned(&document, &asked).map_err(|refusals| refusals.to_string())
    }

    fn planned(&self, document: &Node, asked: &Asked) -> Result<Plan, Refusals> {
        let ctx = self.context();
        let read = read_plan(&ctx, document).and_then(|plan| {
            if !asked.is_asked {
                return Ok(plan);
            }
            let root = crate::reader::Table::of(&ctx, document, "the scenario", &SCENARIO)?;
            let sensitivity = sensitivity::judge(&root, &plan, asked, 0)?;
            Ok(Plan { sensitivity: Some(sensitivity), ..plan })
        });
        ctx.finish(read)
    }

    /// What of the run of a record was measured.
    pub fn quantities(&self, record: usize) -> &[Quantity] {
        &self.records[record].quantities
    }
}

/// Puts a number where there is one; an array may be led into by names of its places.
fn put(document: &mut Node, steps: &[Step], (value, tag): (f64, Option<usize>)) {
    let mut node = document;
    for step in steps {
        node = match (step, &mut node.value) {
            (Step::Index(at), Value::Array(items)) => match items.get_mut(*at) {
                Some(item) => Arc::make_mut(item),
                None => return,
            },
            (Step::Key(key), Value::Array(items)) => match key.parse().ok().and_then(|at: usize| items.get_mut(at)) {
                Some(item) => Arc::make_mut(item),
                None => return,
            },
            (Step::Key(key), Value::Table(entries)) => match entries.iter_mut().find(|entry| entry.key == *key) {
                Some(entry) => Arc::make_mut(&mut entry.node),
                None => return,
            },
            _ => return,
        };
    }
    node.value = Value::Number { value, integer: None };
    node.tag = tag;
}
