//! `[design]`: what `springpot design` moves the parameters for.

use crate::cases::root;
use crate::keys::{CONSTRAINT, DESIGN};
use crate::plan::Plan;
use crate::reader::files::{CsvCache, DescriptionCache};
use crate::reader::{Context, Field, Read, Table, all};
use crate::scenario::Scenario;
use crate::scenario::root::SCENARIO;
use crate::sensitivity;
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind, Refusals};
use springpot::law::Catalog;

/// What parameters are moved for.
#[derive(Debug, Clone)]
pub struct DesignPlan {
    /// Which metric, by its place among those of the plan.
    pub metric: usize,
    /// Whether it is to be large.
    pub maximise: bool,
    /// Of swept cases: whether the worst counts, or their mean.
    pub worst: bool,
    /// What must hold besides.
    pub constraints: Vec<Constraint>,
    /// Starts of the search.
    pub starts: usize,
    /// Of the random ones.
    pub seed: u64,
    /// How exactly parameters are found.
    pub rtol: f64,
    /// Where the table stands.
    pub place: Place,
}

/// A limit of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint {
    /// Which metric, by its place among those of the plan.
    pub metric: usize,
    /// The limit, SI.
    pub limit: f64,
    /// Whether it is the smallest value, and not the largest.
    pub is_min: bool,
}

impl Scenario {
    /// The scenario with all its parameters differentiated for the sake of its metrics alone, and its first case, whose [`Plan::design`] is there.
    ///
    /// # Errors
    /// There is no `[design]` or no `[[parameter]]`, one has no bounds, or a metric that is asked for has no gradient.
    pub fn for_design(&self, catalog: &Catalog) -> Result<(Self, Plan), Refusals> {
        let document = &self.document;
        let missing = |what: &str, help: &str| -> Refusals {
            document.place.refuse(RefusalKind::Missing, format!("there is no {what}")).help(help).into()
        };
        if document.get("design").is_none() {
            return Err(missing("[design]", "write [design] with minimise = \"NAME\", the name of a [[metric]]"));
        }
        if document.get("parameter").is_none() {
            let help = "write a [[parameter]] with path and bounds for every number that may be moved";
            return Err(missing("[[parameter]]", help));
        }
        let mut scenario = self.clone();
        let (tables, robots) = (CsvCache::default(), DescriptionCache::default());
        let ctx = Context::new(catalog, &self.folder, &tables, &robots).of_whole(&SCENARIO);
        let blocks = root(&ctx, document).and_then(|root| match root.get("parameter") {
            Some(field) => sensitivity::blocks(&root, &field),
            None => Ok(Vec::new()),
        });
        sensitivity::leave_ends(&mut scenario.document, &ctx.finish(blocks)?);
        scenario.sensitivity.clear();
        if document.get("sensitivity").is_some_and(|table| table.get("by").is_some()) {
            scenario.set_anew("sensitivity.by=")?;
        }
        scenario.set_anew("sensitivity.of=[\"t\"]")?;
        scenario.set_anew("sensitivity.method=\"forward\"")?;
        let plan = scenario.cases(catalog)?.plan(0)?;
        let (Some(design), Some(sensitivity)) = (&plan.design, &plan.sensitivity) else {
            return Err(missing("[design]", "write it into the file"));
        };
        for parameter in &sensitivity.parameters {
            if parameter.bounds.is_none() {
                let message = format!("parameter {:?} has no bounds", shorten(&parameter.name));
                let refusal = parameter.place.refuse(RefusalKind::Missing, message);
                return Err(refusal.help("write bounds = [LOW, HIGH]: where it may be moved").into());
            }
        }
        for metric in [design.metric].into_iter().chain(design.constraints.iter().map(|one| one.metric)) {
            let own = &plan.metrics[metric];
            if sensitivity.no_gradient.contains(&own.metric.name) {
                let message = format!("no gradient is known of metric {:?}", own.metric.name);
                let refusal = own.of.refuse(RefusalKind::Rule, message);
                return Err(refusal
                    .help(format!("no derivative is known of {}: take another column", own.metric.of))
                    .into());
            }
        }
        Ok((scenario, plan))
    }
}

/// Reads the table of a plan that has its metrics.
pub(crate) fn read(root: &Table<'_>, plan: &Plan) -> Read<Option<DesignPlan>> {
    let Some(field) = root.get("design") else { return Ok(None) };
    let table = field.table(&DESIGN)?;
    let (minimise, maximise) = (table.get("minimise"), table.get("maximise"));
    let (metric, maximise) = match (&minimise, &maximise) {
        (Some(field), None) => (metric(field, plan)?, false),
        (None, Some(field)) => (metric(field, plan)?, true),
        (Some(_), Some(field)) => {
            let help = "leave one of them out; write the other metric as a constraint".to_owned();
            return Err(field.refuse(RefusalKind::Rule, "stands beside `minimise`", Some(help)));
        }
        (None, None) => return Err(table.missing("minimise", "minimise = \"NAME\", a [[metric]], or maximise")),
    };
    let constraints = match table.get("constraints") {
        None => Vec::new(),
        Some(field) => {
            let items = field.items("an array of tables such as { metric = \"peak\", max = 20 }")?;
            let read = items.iter().map(|item| constraint(item, plan)).collect::<Vec<_>>();
            all(read)?.into_iter().flatten().collect()
        }
    };
    let whole = |key, default: i64| table.get(key).map_or(Ok(default), |field| field.whole());
    let (starts, seed, rtol) = (whole("starts", 8)?, whole("seed", 1)?, table.number("rtol")?);
    Ok(Some(DesignPlan {
        metric,
        maximise,
        worst: table.flag("worst")?,
        constraints,
        starts: usize::try_from(starts).unwrap_or(1),
        seed: seed.unsigned_abs(),
        rtol,
        place: table.node.place.clone(),
    }))
}

/// The metric of that name.
fn metric(field: &Field<'_>, plan: &Plan) -> Read<usize> {
    let name = field.text()?;
    plan.metrics.iter().position(|own| own.metric.name == name).ok_or_else(|| {
        let help = match plan.metrics.is_empty() {
            true => "write a [[metric]] of that name: name, of and kind".to_owned(),
            false => names::suggest(name, plan.metrics.iter().map(|own| own.metric.name.as_str())),
        };
        field.refuse(RefusalKind::UnknownName, format!("is {:?}, which is no metric", shorten(name)), Some(help))
    })
}

fn constraint(item: &Field<'_>, plan: &Plan) -> Read<Vec<Constraint>> {
    let table = Table::of(item.ctx, item.node, "a constraint", &CONSTRAINT)?;
    let metric = metric(&table.require("metric")?, plan)?;
    let own = &plan.metrics[metric].metric;
    let of = plan.row_columns().into_iter().find(|column| column.name == own.of);
    let unit = own.kind.unit(of.as_ref().map_or("", |column| &column.unit)).into_owned();
    let limit = |key| table.get(key).map(|field| field.number(&unit).map(|limit| (limit, field))).transpose();
    let (min, max) = (limit("min")?, limit("max")?);
    if let (Some((low, _)), Some((high, field))) = (&min, &max)
        && low >= high
    {
        let help = "write the smaller value as `min`".to_owned();
        return Err(field.refuse(RefusalKind::Rule, format!("is {high}, and `min` is {low}"), Some(help)));
    }
    if min.is_none() && max.is_none() {
        return Err(table.missing("max", "max = \"20 N\", or min"));
    }
    let of = |limit: Option<(f64, Field<'_>)>, is_min| limit.map(|(limit, _)| Constraint { metric, limit, is_min });
    Ok(of(min, true).into_iter().chain(of(max, false)).collect())
}
