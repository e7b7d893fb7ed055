//! The records and parameters of a scenario, gathered.

use super::material::{self, Material};
use super::plan::{DataPlan, FitParameter, FitPlan, Role};
use super::record::{self, Of, Record};
use super::{Case, Fitting, settings};
use crate::cases::{read_plan, root};
use crate::changes::path::{self, Step};
use crate::plan::Plan;
use crate::plan::sensitivity::ParameterPlan;
use crate::reader::files::{CsvCache, DescriptionCache};
use crate::reader::{Context, Field, Read, Refused, Table, all};
use crate::robot;
use crate::scenario::Scenario;
use crate::scenario::overrides;
use crate::scenario::root::SCENARIO;
use crate::sensitivity::{self, Asked, By};
use crate::text::document::{Node, shorten};
use crate::text::refusal::{RefusalKind, Refusals, Remark};
use springpot::identification::{Parameter, Scale};
use springpot::law::Catalog;
use springpot::observe::Quantity;
use springpot::sensitivity::has_derivative;
use std::collections::HashMap;

/// What reading a record gives.
struct Gathered {
    case: Case,
    data: DataPlan,
    /// Of each parameter of the record what its place says, where the record sees it.
    seen: Vec<Option<ParameterPlan>>,
    bounds: Vec<Option<[f64; 2]>>,
}

impl Fitting {
    /// Reads the measurements, with this law in place of that of the element of `[fit]`.
    pub(super) fn new(
        scenario: &Scenario,
        catalog: &Catalog,
        law: Option<(&str, super::laws::Size)>,
    ) -> Result<Self, Refusals> {
        let (tables, robots) = (CsvCache::default(), DescriptionCache::default());
        let context = || Context::new(catalog, &scenario.folder, &tables, &robots).of_whole(&SCENARIO);
        let mut document = scenario.document.clone();
        let ctx = context();
        let applied = overrides::apply(&ctx, scenario, &mut document).map(|_| ());
        ctx.finish(applied)?;
        let ctx = context();
        let read = root(&ctx, &document).and_then(|root| {
            refuse_sweeps(&root)?;
            let title = root.get("title").and_then(|title| title.node.text()).map(str::to_owned);
            Ok((title, settings::read(&root)?))
        });
        let (title, settings) = ctx.finish(read)?;
        let element = settings.element.as_deref().unwrap_or_default();
        let ctx = context();
        let read = root(&ctx, &document).and_then(|root| blocks(&root, law.map(|_| element)));
        let mut global = ctx.finish(read)?;
        if let Some(law) = law {
            super::laws::replace(catalog, &mut document, element, law);
            let ctx = context();
            let read = root(&ctx, &document).and_then(|root| all_of(&root, element));
            global.extend(ctx.finish(read)?);
        }
        sensitivity::leave_ends(&mut document, &global);
        let ctx = context();
        let count = root(&ctx, &document).and_then(|root| Ok(data(&root)?.len()));
        let count = ctx.finish(count)?;
        let (mut records, mut data, mut parameters): (Vec<Case>, Vec<DataPlan>, Vec<Option<FitParameter>>) =
            Default::default();
        parameters.resize_with(global.len(), || None);
        let mut remarks: Vec<Remark> = Vec::new();
        let mut own: Vec<FitParameter> = Vec::new();
        let (mut offsets, mut delays): (Vec<Vec<usize>>, Vec<Vec<usize>>) = Default::default();
        for k in 0..count {
            let ctx = context();
            let read = root(&ctx, &document).and_then(|root| one(&ctx, &root, k, &global));
            remarks.extend(ctx.warnings().into_iter().filter(|remark| !remarks.contains(remark)).collect::<Vec<_>>());
            let (gathered, wanted) = ctx.finish(read)?;
            let Gathered { case, data: mut plan, seen, bounds } = gathered;
            for (at, (found, range)) in seen.into_iter().zip(bounds).enumerate() {
                let Some(found) = found else { continue };
                let parameter = |role| made(&found, range, role);
                if at < global.len() {
                    if parameters[at].is_none() {
                        parameters[at] = Some(parameter(Role::Number { record: None }));
                    }
                } else {
                    own.push(parameter(Role::Number { record: Some(k) }));
                }
            }
            let first = global.len() + own.iter().filter(|one| one.role != Role::Number { record: Some(k) }).count();
            plan.parameters = (0..global.len()).chain(first..global.len() + own.len()).collect();
            offsets.push(wanted.0);
            delays.push(wanted.1);
            for (column, is_delay) in offsets[k].iter().map(|c| (*c, false)).chain(delays[k].iter().map(|c| (*c, true)))
            {
                let at = global.len() + own.len();
                own.push(beside(&plan, k, column, is_delay));
                let column = &mut plan.columns[column];
                if is_delay { column.delay = Some(at) } else { column.offset = Some(at) }
            }
            records.push(case);
            data.push(plan);
        }
        let ctx = context();
        let may_lack = law.is_none() && !settings.laws.is_empty();
        let read = root(&ctx, &document).and_then(|root| finished(&root, &global, parameters, own, (&data, may_lack)));
        let parameters = ctx.finish(read)?;
        let plan = FitPlan { title, parameters, data, settings };
        let folder = scenario.folder.clone();
        Ok(Self {
            scenario: scenario.clone(),
            catalog: catalog.clone(),
            folder,
            tables,
            robots,
            records,
            plan,
            remarks,
        })
    }
}

fn refuse_sweeps(root: &Table<'_>) -> Read<()> {
    match root.get("sweep") {
        None => Ok(()),
        Some(field) => {
            let refusal = field.node.place.refuse(RefusalKind::Rule, "a fit has no sweeps");
            Err(field.ctx.refuse(refusal.help("take [[sweep]] out, and write `set` in each [[data]]")))
        }
    }
}

/// The items of `[[data]]`.
fn data<'a>(root: &Table<'a>) -> Read<Vec<Field<'a>>> {
    let Some(field) = root.get("data") else {
        let refusal =
            root.node.place.refuse(RefusalKind::Missing, "the scenario has no [[data]]: there is nothing to fit it to");
        return Err(root.ctx.refuse(refusal.help("write [[data]] with a csv and its columns")));
    };
    let items = field.items("an array of tables: [[data]]")?;
    if items.is_empty() {
        return Err(field.refuse(
            RefusalKind::Missing,
            "is empty",
            Some("write [[data]] with a csv and its columns".to_owned()),
        ));
    }
    Ok(items)
}

/// The parameters of all records, those of an element whose law is replaced not among them.
fn blocks(root: &Table<'_>, replaced: Option<&str>) -> Read<Vec<By>> {
    let mut all = match root.get("parameter") {
        None => Vec::new(),
        Some(field) => sensitivity::blocks(root, &field)?,
    };
    if let Some(element) = replaced {
        let steps = material::steps(root.ctx, root.node, element, &place_of_fit(root))?;
        let moves = |by: &By| by.targets.iter().any(|target| target.steps.starts_with(&steps));
        all.retain(|by| !moves(by));
    }
    sensitivity::apart(root.ctx, &all)?;
    Ok(all)
}

/// Every number of the law of an element, under its own name.
fn all_of(root: &Table<'_>, element: &str) -> Read<Vec<By>> {
    let place = place_of_fit(root);
    let steps = material::steps(root.ctx, root.node, element, &place)?;
    let table = material::table(root.node, &steps).and_then(|own| own.get("parameters"));
    let entries = table.and_then(|table| table.entries()).unwrap_or_default();
    all(entries.iter().map(|entry| {
        let written = format!("element.{element}.{}", entry.key);
        let target = path::resolve(root.ctx, root.node, &written, &place)?;
        Ok(By { name: entry.key.clone(), targets: vec![target], block: None, place: place.clone() })
    }))
}

fn place_of_fit(root: &Table<'_>) -> crate::Place {
    root.get("fit").map_or_else(|| root.node.place.clone(), |field| field.node.place.clone())
}

/// The columns whose zero is sought, and those whose lateness is.
type Beside = (Vec<usize>, Vec<usize>);

/// Record `k`, and the columns whose zero and lateness are sought.
fn one(ctx: &Context<'_>, root: &Table<'_>, k: usize, global: &[By]) -> Read<(Gathered, Beside)> {
    let items = data(root)?;
    let mut taken = HashMap::new();
    // Names of those before it.
    for (at, item) in items.iter().enumerate().take(k) {
        let name = item
            .node
            .get("name")
            .and_then(|name| name.text())
            .map_or_else(|| format!("data-{}", at + 1), str::to_owned);
        taken.insert(name, item.node.place.clone());
    }
    let written = record::read(root, &items[k], k, &mut taken)?;
    let mut bys = global.to_vec();
    for target in &written.free {
        let name = format!("{}.{}", written.name, target.written);
        bys.push(By { name, targets: vec![target.clone()], block: None, place: target.place.clone() });
    }
    sensitivity::apart(ctx, &bys)?;
    let mut document = root.node.clone();
    for (target, node) in &written.set {
        if let Some(by) = bys[..global.len()].iter().find(|by| by.targets.iter().any(|own| own.overlaps(target))) {
            let message = format!("{} is set, and is the parameter {:?}", target.written, by.name);
            let refusal = target.place.refuse(RefusalKind::Rule, message);
            return Err(ctx.refuse(refusal.help("leave one of them out, or make it `free` of this record")));
        }
        path::set(&mut document, target, node.clone());
    }
    let asked = Asked { by: bys, of: None, control: false, adjoint: None, is_asked: true };
    sensitivity::mark(ctx, &mut document, &asked, 0)?;
    // Its own constants are those of the conditions.
    let inner = Context::new(ctx.catalog, ctx.folder, ctx.tables, ctx.robots).of_whole(&SCENARIO);
    let read = match written.table.get("element") {
        _ if written.kind == crate::keys::RUN => of_run(&inner, &document, &written, asked.clone()),
        Some(field) => {
            crate::cases::root(&inner, &document).and_then(|root| of_element(&root, &field, &written, &asked))
        }
        None => return Err(written.table.missing("element", "element = \"NAME\"")),
    };
    inner.warnings().into_iter().for_each(|remark| ctx.warn(remark));
    // What the record itself refuses is noted where it was opened.
    if read.is_err() && inner.is_clean() {
        return Err(Refused);
    }
    let (mut gathered, offsets, delays) = match inner.finish(read) {
        Ok(gathered) => {
            let offsets = written.named("offset", &gathered.data.columns)?;
            let delays = written.named("delay", &gathered.data.columns)?;
            (gathered, offsets, delays)
        }
        Err(refusals) => {
            for refusal in refusals {
                ctx.refuse(refusal);
            }
            return Err(Refused);
        }
    };
    for (by, (plan, range)) in asked.by.iter().zip(gathered.seen.iter().zip(&gathered.bounds)) {
        let Some(([low, high], [least, most])) = plan.as_ref().and_then(|plan| plan.bounds).zip(*range) else {
            continue;
        };
        if low < least || high > most {
            let block = by.block.and_then(|k| root.node.get("parameter")?.items()?.get(k)?.get("bounds"));
            let place = block.map_or(&by.place, |bounds| &bounds.place);
            let message =
                format!("`bounds` of parameter {:?} are {low} … {high}, and its place takes {least} … {most}", by.name);
            return Err(ctx.refuse(place.refuse(RefusalKind::OutOfRange, message).help("write bounds within that")));
        }
    }
    gathered.case.document = document;
    let places = |all: Vec<(usize, crate::Place)>| all.into_iter().map(|(at, _)| at).collect();
    Ok((gathered, (places(offsets), places(delays))))
}

/// What is noted of the parameters that the readers have seen.
fn seen(root: &Table<'_>, asked: &Asked, exponents: &dyn Fn(&str) -> Option<f64>) -> Read<Vec<Option<ParameterPlan>>> {
    let mut tag = 0;
    let each = asked.by.iter().map(|by| {
        let own = tag;
        tag += by.targets.len();
        let Some(value) = (own..tag).find_map(|tag| root.ctx.swept(tag)) else { return Ok(None) };
        let unit = (own..tag).find_map(|tag| root.ctx.swept_unit(tag)).unwrap_or_default();
        sensitivity::block_of(root, by, exponents, (value, &unit)).map(Some)
    });
    all(each.collect::<Vec<_>>())
}

fn of_element(root: &Table<'_>, element: &Field<'_>, written: &Record<'_>, asked: &Asked) -> Read<Gathered> {
    let (ctx, document) = (root.ctx, root.node);
    let name = element.text()?;
    let steps = material::steps(ctx, document, name, &element.node.place)?;
    let is_rotation = is_rotation(root, &steps);
    let material = Material::read(ctx, document, (steps, is_rotation), &asked.by)?;
    let entry = material.entry().clone();
    let exponent = |name: &str| {
        let at = entry.params.iter().position(|param| param.name == name)?;
        material.parameters.get(at).copied()
    };
    let seen = seen(root, asked, &exponent)?;
    let bounds = (0..asked.by.len()).map(|k| match material.number(k) {
        Some(number) => Some(open(entry.params[number].range.low, entry.params[number].range.high)),
        None => material.is_shift(k).then_some([0.0, f64::INFINITY]),
    });
    let bounds = bounds.collect();
    for (by, plan) in asked.by.iter().zip(&seen) {
        if let Some(plan) =
            plan.as_ref().filter(|plan| (plan.value == 0.0 || plan.value == 1.0) && plan.unit.is_empty())
            && by.targets.iter().any(|target| target.ends().1.starts_with("alpha"))
        {
            let message = format!(
                "{} cannot be a parameter: it is {}, where the law has no derivative by it",
                by.name, plan.value
            );
            let refusal = by.place.refuse(RefusalKind::Rule, message);
            return Err(ctx.refuse(refusal.help("start at 0.01 or 0.99")));
        }
    }
    let inputs = material.inputs();
    let mut data = written.plan(Of::Element { inputs: &inputs, is_rotation })?;
    data.element = Some(name.to_owned());
    for ((input, _), signal) in inputs.iter().zip(material.signals()) {
        if data.told(input).is_none() && signal.is_none() {
            let message = format!("{:?} has the input `{input}`, which nothing says", shorten(name));
            let refusal = element.node.place.refuse(RefusalKind::Missing, message);
            let help = format!("write it in `inputs` of the element, in `set`, or {input} = \"COLUMN\" in `columns`");
            return Err(ctx.refuse(refusal.help(help)));
        }
    }
    let case =
        Case { document: document.clone(), asked: asked.clone(), material: Some(material), quantities: Vec::new() };
    Ok(Gathered { case, data, seen, bounds })
}

/// Whether an element turns, as far as the document says.
fn is_rotation(root: &Table<'_>, steps: &[Step]) -> bool {
    match steps {
        [_, _, _, Step::Key(component)] => component.starts_with('r'),
        [_, Step::Index(at)] => {
            let items = root.node.get("element").and_then(|all| all.items()).unwrap_or_default();
            let joint = items.get(*at).and_then(|element| element.get("joint")?.text());
            let Some(joint) = joint.filter(|_| root.get("robot").is_some()) else { return false };
            // What is wrong with the robot is no matter here.
            let ctx =
                Context::new(root.ctx.catalog, root.ctx.folder, root.ctx.tables, root.ctx.robots).of_whole(&SCENARIO);
            let read = crate::cases::root(&ctx, root.node).and_then(|root| robot::read(&root));
            read.is_ok_and(|robot| {
                let model = robot.model();
                let at = model.joint_names().iter().position(|name| name == joint);
                at.is_some_and(|at| model.joint_space(at).dimension() == Some(springpot::model::Dimension::Angle))
            })
        }
        _ => false,
    }
}

fn of_run(ctx: &Context<'_>, document: &Node, written: &Record<'_>, mut asked: Asked) -> Read<Gathered> {
    let plan: Plan = read_plan(ctx, document)?;
    let root = Table::of(ctx, document, "the scenario", &SCENARIO)?;
    let observables = plan.acting_observables();
    let known: Vec<(String, String)> =
        plan.columns().into_iter().map(|column| (column.name, column.unit)).filter(|(name, _)| name != "t").collect();
    let data = written.plan(Of::Run { columns: &known, end: plan.settings.end })?;
    let named: HashMap<String, Quantity> = observables
        .quantities()
        .into_iter()
        .map(|quantity| (observables.named(quantity).to_string(), quantity))
        .collect();
    let mut quantities = Vec::new();
    for (column, wanted) in data.columns.iter().zip(&written.wanted) {
        match named.get(&column.name).copied().filter(|quantity| has_derivative(*quantity, |_| None)) {
            Some(quantity) => quantities.push(quantity),
            None => {
                let message = format!("{:?} cannot be fitted: no derivative is known of it", column.name);
                return Err(ctx.refuse(wanted.field.node.place.refuse(RefusalKind::Rule, message)));
            }
        }
    }
    let glob =
        |column: &crate::fit::DataColumn| crate::ColumnGlob { text: column.name.clone(), place: data.place.clone() };
    asked.of = Some(data.columns.iter().map(glob).collect());
    let sensitivity = sensitivity::judge(&root, &plan, &asked, 0)?;
    let bounds = asked.by.iter().map(|by| admissible(&plan, document, by)).collect();
    let seen = sensitivity.parameters.into_iter().map(Some).collect();
    let case = Case { document: document.clone(), asked, material: None, quantities };
    Ok(Gathered { case, data, seen, bounds })
}

fn open(low: f64, high: f64) -> [f64; 2] {
    [if low <= f64::MIN { f64::NEG_INFINITY } else { low }, if high >= f64::MAX { f64::INFINITY } else { high }]
}

/// What the place of a parameter takes, where that is no whole line.
fn admissible(plan: &Plan, document: &Node, by: &By) -> Option<[f64; 2]> {
    let positive = Some([0.0, f64::INFINITY]);
    let target = by.targets.first()?;
    let (section, last) = target.ends();
    let has = |key: &str| target.steps.iter().any(|step| *step == Step::Key(key.to_owned()));
    match section {
        "element" if has("parameters") => {
            let Step::Index(at) = target.steps.get(1)? else { return None };
            let name = document.get("element")?.items()?.get(*at)?.get("name")?.text()?;
            let own = |plan: &&crate::ElementPlan| {
                plan.element.name == name
                    || plan.element.name.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'))
            };
            let entry = &plan.elements.iter().find(own)?.element.entry;
            let param = entry.params.iter().find(|param| param.name == last)?;
            Some(open(param.range.low, param.range.high))
        }
        "element" if last == "rest_length" => positive,
        "robot" if matches!(last, "mass" | "damping" | "friction" | "armature" | "force" | "xx" | "yy" | "zz") => {
            positive
        }
        _ => None,
    }
}

/// A parameter as its block and its place say.
fn made(plan: &ParameterPlan, place: Option<[f64; 2]>, role: Role) -> FitParameter {
    let given = plan.bounds.or(place).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let mut sought = Parameter::new(plan.name.clone(), plan.value, given);
    if let Some(scale) = plan.scale {
        sought.scale = scale;
        // A logarithm begins at 0.
        if scale == Scale::Log && sought.bounds[0] < 0.0 {
            sought.bounds[0] = 0.0;
        }
    }
    if !plan.starts.is_empty() {
        sought.start.clone_from(&plan.starts);
    }
    sought.typical = plan.typical;
    sought.prior = plan.prior;
    FitParameter {
        sought,
        paths: plan.paths.clone(),
        value: plan.value,
        unit: plan.unit.clone(),
        role,
        place: plan.place.clone(),
    }
}

/// The zero or the lateness of a column.
fn beside(data: &DataPlan, record: usize, column: usize, is_delay: bool) -> FitParameter {
    let own = &data.columns[column];
    let name = format!("{}.{}.{}", data.name, if is_delay { "delay" } else { "offset" }, own.name);
    let mut sought = Parameter::free(name, 0.0);
    let count = data.at.len().max(1) as f64;
    sought.typical = if is_delay {
        ((data.at[data.at.len() - 1] - data.at[0]) / count).max(1e-12)
    } else {
        let mean = own.measured.iter().sum::<f64>() / count;
        let spread = (own.measured.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
        if spread > 0.0 { 0.1 * spread } else { mean.abs().max(1.0) }
    };
    let (unit, role) = match is_delay {
        true => ("s".to_owned(), Role::Delay { record, column }),
        false => (own.unit.clone(), Role::Offset { record, column }),
    };
    FitParameter { sought, paths: Vec::new(), value: 0.0, unit, role, place: data.place.clone() }
}

/// All parameters, judged with the rows that there are.
fn finished(
    root: &Table<'_>,
    global: &[By],
    parameters: Vec<Option<FitParameter>>,
    own: Vec<FitParameter>,
    (data, may_lack): (&[DataPlan], bool),
) -> Read<Vec<FitParameter>> {
    let mut found = Vec::new();
    for (by, parameter) in global.iter().zip(parameters) {
        match parameter {
            Some(parameter) => found.push(parameter),
            None => {
                let message = format!("{:?} is a parameter that no data see", by.name);
                let refusal = by.place.refuse(RefusalKind::Rule, message);
                return Err(root.ctx.refuse(refusal.help("leave it out, or bring data of what it moves")));
            }
        }
    }
    found.extend(own);
    let place = root.get("data").map_or_else(|| root.node.place.clone(), |field| field.node.place.clone());
    if found.is_empty() && !may_lack {
        let refusal = place.refuse(RefusalKind::Missing, "there is no parameter to be fitted");
        return Err(root.ctx.refuse(refusal.help("write [[parameter]] with path = \"element.NAME.PARAMETER\"")));
    }
    if let Some(faulty) = found.iter().find(|one| one.sought.start.iter().any(|start| !within(&one.sought, *start))) {
        let [low, high] = faulty.sought.bounds;
        let message = format!("{:?} starts at {:?}, outside {low} … {high}", faulty.sought.name, faulty.sought.start);
        let refusal = faulty.place.refuse(RefusalKind::OutOfRange, message);
        return Err(root.ctx.refuse(refusal.help("write bounds that hold where it starts, or `start`")));
    }
    if let Some((faulty, fault)) = found.iter().find_map(|one| Some((one, one.sought.fault()?))) {
        let refusal =
            faulty.place.refuse(RefusalKind::Rule, format!("the parameter {:?}: {fault}", faulty.sought.name));
        return Err(root.ctx.refuse(refusal.help("write `bounds`, or another `scale`")));
    }
    let fitted = |data: &&DataPlan| data.is_fitted;
    let rows: usize = data.iter().filter(fitted).map(|data| data.rows() * data.columns.len()).sum();
    if !data.iter().any(|data| data.is_fitted) {
        let refusal = place.refuse(RefusalKind::Rule, "every record is a validation: there is nothing to fit to");
        return Err(root.ctx.refuse(refusal.help("write use = \"fit\" in one of them")));
    }
    if rows < found.len() {
        let message = format!("there are {rows} numbers to fit {} parameters to", found.len());
        let refusal = place.refuse(RefusalKind::Rule, message);
        return Err(root.ctx.refuse(refusal.help("bring more rows, or leave parameters out")));
    }
    Ok(found)
}

fn within(parameter: &Parameter, value: f64) -> bool {
    let [low, high] = parameter.bounds;
    (low..=high).contains(&value)
}
