//! What one case is differentiated by: values, units, and what the engine is told.

use super::asked::{Asked, By};
use super::constants;
use super::extended::{Extended, Virtual};
use super::gather::{Gather, Scene, Slope};
use super::mark::values;
use super::rows;
use crate::changes::path::{Step, Target};
use crate::figures::read_columns;
use crate::keys::{PARAMETER, PRIOR};
use crate::plan::Plan;
use crate::plan::sensitivity::{ParameterPlan, SensitivityPlan, over};
use crate::reader::{Field, Read, Refused, Table, all};
use crate::text::document::{Node, shorten};
use crate::text::glob::matches;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use springpot::identification::{Prior, Scale};
use springpot::observe::Quantity;
use springpot::sensitivity::{DerivativeColumn, Parameter, Sensitivity, has_derivative};
use springpot::table::Column;
use std::collections::HashMap;
use std::sync::Arc;

/// Most derivatives that rows tell.
const MAX_COLUMNS: usize = 65_536;

/// By what `plan` is differentiated, whose numbers are tagged from `first` on in the document of `root`.
pub(crate) fn judge(root: &Table<'_>, plan: &Plan, asked: &Asked, first: usize) -> Read<SensitivityPlan> {
    let ctx = root.ctx;
    let base = plan.system_at_start();
    let scene = Scene { plan, document: root.node, system: &base };
    let values = values(ctx, asked, first);
    let gathered = all(asked.by.iter().map(|by| gather(root, &scene, by)).collect::<Vec<_>>());
    let (values, gathered) = (values?, gathered?);
    let read = asked.by.iter().zip(&values).map(|(by, (value, unit))| parameter(root, &scene, by, *value, unit));
    let parameters = all(read.collect::<Vec<_>>())?;
    let plain = SensitivityPlan {
        parameters,
        columns: Vec::new(),
        for_metrics: Vec::new(),
        no_gradient: Vec::new(),
        left_out: Vec::new(),
        adjoint: None,
        engine: None,
    };
    if !asked.is_asked {
        return Ok(plain);
    }
    let mut virtuals: Vec<Virtual> = Vec::new();
    for joint in gathered.iter().flat_map(Gather::virtuals) {
        if !virtuals.contains(joint) {
            virtuals.push(*joint);
        }
    }
    let extended = Extended::new(plan, &base, virtuals).map_err(|why| refuse_unknown(root, asked, &why))?;
    let told = plain.parameters.iter().zip(gathered).map(|(parameter, gather)| Parameter {
        name: parameter.name.clone(),
        value: parameter.value,
        typical: parameter.typical,
        seeds: gather.seeds(plan, &extended),
    });
    let told = told.collect();
    let mut engine = Sensitivity {
        parameters: told,
        extended: extended.is_extended().then(|| extended.system.clone()),
        control: asked.control,
        columns: Vec::new(),
        adjoint: None,
    };
    if let Some(place) = &asked.adjoint {
        let OfMetrics { quantities, places, no_gradient } = of_metrics(root, plan, place)?;
        engine.adjoint = Some(quantities);
        return Ok(SensitivityPlan { no_gradient, adjoint: Some(places), engine: Some(Arc::new(engine)), ..plain });
    }
    let Chosen { columns, for_metrics, no_gradient, known, left_out } = columns(root, plan, asked, &plain.parameters)?;
    engine.columns = known;
    Ok(SensitivityPlan { columns, for_metrics, no_gradient, left_out, engine: Some(Arc::new(engine)), ..plain })
}

/// What metrics are of.
#[derive(Default)]
struct OfMetrics {
    quantities: Vec<Quantity>,
    /// Of each metric the place of its own among them, where that is known.
    places: Vec<Option<usize>>,
    /// The metrics of which no gradient is known.
    no_gradient: Vec<String>,
}

/// Whether derivatives of what a plan describes are known.
fn is_known(plan: &Plan, of: Quantity) -> bool {
    has_derivative(of, |e| plan.elements.get(e).map(|element| &element.element))
}

/// What metrics are of, which `place` wants to be gone back through.
fn of_metrics(root: &Table<'_>, plan: &Plan, place: &Place) -> Read<OfMetrics> {
    if plan.metrics.is_empty() {
        let message = "the adjoint gives gradients of metrics, and there is no [[metric]]";
        let help = "add a [[metric]], or write method = \"forward\"".to_owned();
        return Err(root.ctx.refuse(place.refuse(RefusalKind::Missing, message).help(help)));
    }
    let [acting, described] = by_name(plan);
    let mut of = OfMetrics::default();
    for metric in plan.metrics.iter().map(|plan| &plan.metric) {
        if !described.get(&metric.of).copied().is_some_and(|of| is_known(plan, of)) {
            of.no_gradient.push(metric.name.clone());
            of.places.push(None);
            continue;
        }
        let own = acting.get(&metric.of);
        of.places.push(own.map(|own| {
            of.quantities.iter().position(|known| known == own).unwrap_or_else(|| {
                of.quantities.push(*own);
                of.quantities.len() - 1
            })
        }));
    }
    Ok(of)
}

/// What can be observed of the system, and of all elements, by the names of columns.
fn by_name(plan: &Plan) -> [HashMap<String, Quantity>; 2] {
    [plan.acting_observables(), plan.observables()].map(|observables| {
        let tells_losses = plan.output.tells_joint_losses;
        let observables = if tells_losses { observables.with_joint_losses() } else { observables };
        let quantities = observables.quantities().into_iter();
        quantities.map(|quantity| (observables.named(quantity).to_string(), quantity)).collect()
    })
}

/// What a parameter moves.
fn gather(root: &Table<'_>, scene: &Scene<'_>, by: &By) -> Read<Gather> {
    let mut gather = Gather::default();
    let moved = by.targets.iter().map(|target| {
        moves(root, scene, target, &mut gather).map_err(|why| {
            let message = format!("{} cannot be a parameter: {why}", target.written);
            root.ctx.refuse(target.place.refuse(RefusalKind::Rule, message))
        })
    });
    all(moved.collect::<Vec<_>>())?;
    if gather.moves_paths() && super::control::solves_path(scene) {
        let target = &by.targets[0];
        let why =
            "the reference is a path of the gripper, solved for the joints, of whose derivatives nothing is known";
        let message = format!("{} cannot be a parameter: {why}", target.written);
        return Err(root.ctx.refuse(target.place.refuse(RefusalKind::Rule, message)));
    }
    Ok(gather)
}

fn moves(root: &Table<'_>, scene: &Scene<'_>, target: &Target, gather: &mut Gather) -> Result<(), String> {
    let name = match &target.steps[..] {
        [Step::Key(section), Step::Key(name)] if section == "constants" => name,
        steps => {
            let row = rows::find(steps).ok_or("no derivative by it is known")?;
            return (row.moves)(gather, scene, steps, Slope::Number(1.0));
        }
    };
    let slopes = constants::slopes(root.node, name, &root.ctx.constants())?;
    for (steps, slope) in constants::followers(root.node, &slopes) {
        let what = || format!("{} follows from it, and ", written(root.node, &steps));
        let slope = slope.map_err(|why| what() + &why)?;
        let row = rows::find(&steps).ok_or_else(|| what() + "no derivative by that is known")?;
        (row.moves)(gather, scene, &steps, slope).map_err(|why| what() + &why)?;
    }
    Ok(())
}

/// Steps as a path.
fn written(document: &Node, steps: &[Step]) -> String {
    let (mut node, mut keys) = (Some(document), Vec::new());
    for step in steps {
        node = node.and_then(|node| match step {
            Step::Key(key) => {
                keys.push(key.clone());
                node.get(key).map(|node| &**node)
            }
            Step::Index(k) => {
                let item = node.items().and_then(|items| items.get(*k)).map(|item| &**item);
                let name = item.and_then(|item| item.get("name")?.text().map(str::to_owned));
                keys.push(name.unwrap_or_else(|| k.to_string()));
                item
            }
        });
    }
    keys.retain(|key| !matches!(key.as_str(), "parameters" | "inputs" | "bushing"));
    crate::changes::path::dotted(&keys)
}

/// Value, unit and size of a parameter, and what its block says besides.
fn parameter(root: &Table<'_>, scene: &Scene<'_>, by: &By, value: f64, unit: &str) -> Read<ParameterPlan> {
    let exponents = |name: &str| rows::exponent(scene, &by.targets[0].steps, name);
    block_of(root, by, &exponents, (value, unit))
}

/// The parameter whose number has this value and unit, with what its `[[parameter]]` says, if it has one.
pub(crate) fn block_of(
    root: &Table<'_>,
    by: &By,
    exponents: &dyn Fn(&str) -> Option<f64>,
    (value, unit): (f64, &str),
) -> Read<ParameterPlan> {
    let mut plan = ParameterPlan {
        name: by.name.clone(),
        paths: by.targets.iter().map(|target| target.written.clone()).collect(),
        value,
        unit: unit.to_owned(),
        typical: if value == 0.0 { 1.0 } else { value.abs() },
        bounds: None,
        scale: None,
        starts: Vec::new(),
        prior: None,
        place: by.place.clone(),
    };
    let block = by.block.and_then(|k| Some(root.get("parameter")?.item(root.node.get("parameter")?.items()?.get(k)?)));
    if let Some(item) = block {
        let table = Table::of(root.ctx, item.node, format!("parameter {:?}", shorten(&by.name)), &PARAMETER)?;
        judged(&table, exponents, &mut plan)?;
    }
    Ok(plan)
}

/// Judges a `[[parameter]]` and takes what it says.
fn judged(table: &Table<'_>, exponents: &dyn Fn(&str) -> Option<f64>, plan: &mut ParameterPlan) -> Read<()> {
    let (value, unit) = (plan.value, plan.unit.clone());
    let number = |field: &Field<'_>| field.number_with(&unit, exponents);
    let numbers = |field: &Field<'_>| match field.node.items() {
        Some(items) => all(items.iter().map(|item| number(&field.item(item))).collect::<Vec<_>>()),
        None => number(field).map(|one| vec![one]),
    };
    plan.bounds = match table.get("bounds") {
        None => None,
        Some(field) => match numbers(&field)?[..] {
            [low, high] if low < high => Some([low, high]),
            [low, high] => {
                let message = format!("goes from {low} to {high}");
                let help = "write the smaller bound first".to_owned();
                return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
            }
            _ => return Err(field.wrong_type("two numbers, [low, high]")),
        },
    };
    let starts = table.get("start").map(|field| numbers(&field)).transpose()?;
    if let Some([low, high]) = plan.bounds {
        let starts = starts.as_deref().unwrap_or(std::slice::from_ref(&value));
        if let Some(outside) = starts.iter().find(|start| !(low..=high).contains(*start)) {
            let (field, message, help) = match table.get("start") {
                Some(field) => (
                    field,
                    format!("holds {outside}, outside its bounds {low} … {high}"),
                    "write starts within the bounds, or wider bounds",
                ),
                None => (
                    table.require("bounds")?,
                    format!("is {low} … {high}, and the file begins outside, at {outside}"),
                    "write bounds that hold the value of the file, or `start`",
                ),
            };
            return Err(field.refuse(RefusalKind::Rule, message, Some(help.to_owned())));
        }
    }
    plan.starts = starts.unwrap_or_default();
    if let Some(field) = table.get("scale") {
        let scale = field.word("scale")?;
        let low = plan.bounds.map_or(value, |[low, _]| low);
        if scale == "log" && low < 0.0 {
            let message = format!("is \"log\", but values may be {low}");
            return Err(field.refuse(
                RefusalKind::Rule,
                message,
                Some("write bounds from 0 on, or \"linear\"".to_owned()),
            ));
        }
        plan.scale = [("log", Scale::Log), ("logit", Scale::Logit), ("linear", Scale::Linear)]
            .into_iter()
            .find_map(|(word, own)| (word == scale).then_some(own));
    }
    if let Some(field) = table.get("prior") {
        let prior = field.table(&PRIOR)?;
        let (mean, sd) = (prior.require("mean").and_then(|field| number(&field)), prior.require("sd")?);
        let positive = number(&sd)?;
        let mean = mean?;
        if positive <= 0.0 {
            let message = format!("is {positive}, but must be positive");
            return Err(sd.refuse(RefusalKind::OutOfRange, message, None));
        }
        plan.prior = Some(Prior { mean, sd: positive });
    }
    let Some(field) = table.get("typical") else { return Ok(()) };
    plan.typical = number(&field)?;
    if plan.typical > 0.0 {
        return Ok(());
    }
    let message = format!("is {}, but must be positive", plan.typical);
    Err(field.refuse(RefusalKind::OutOfRange, message, Some("write about how large the parameter is".to_owned())))
}

/// The columns of derivatives.
struct Chosen {
    /// Of all cases.
    columns: Vec<Column>,
    for_metrics: Vec<Column>,
    no_gradient: Vec<String>,
    /// Those that the system knows, in their order.
    known: Vec<DerivativeColumn>,
    left_out: Vec<String>,
}

/// What is differentiated, column by column.
fn columns(root: &Table<'_>, plan: &Plan, asked: &Asked, parameters: &[ParameterPlan]) -> Read<Chosen> {
    let refuse = |place: &Place, kind, message: String, help: String| {
        Err(root.ctx.refuse(place.refuse(kind, message).help(help)))
    };
    let all = plan.columns();
    let written = read_columns(root)?;
    let [acting, described] = by_name(plan);
    let globs = asked.of.as_deref().or(written.as_deref());
    for glob in asked.of.iter().flatten() {
        if !all.iter().any(|column| matches(&glob.text, &column.name)) {
            let help = names::suggest(&glob.text, all.iter().map(|column| column.name.as_str()));
            return refuse(&glob.place, RefusalKind::UnknownName, format!("{:?} matches no column", glob.text), help);
        }
    }
    let (mut columns, mut known, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for column in all.iter().filter(|column| column.name != "t") {
        let by_glob = |glob: &&crate::ColumnGlob| matches(&glob.text, &column.name);
        if !globs.is_none_or(|globs| globs.iter().any(|glob| by_glob(&glob))) {
            continue;
        }
        let quantity = acting.get(&column.name);
        // Of an element that is not enabled as where it is: all cases have the same columns.
        if !described.get(&column.name).copied().is_some_and(|of| is_known(plan, of)) {
            if let Some(glob) = asked.of.iter().flatten().find(|glob| glob.text == column.name) {
                let message = format!("{:?} cannot be differentiated: no derivative is known of it", column.name);
                return refuse(&glob.place, RefusalKind::Rule, message, "leave it out of `of`".to_owned());
            }
            left_out.push(column.name.clone());
            continue;
        }
        by_parameters(column, quantity, parameters, &mut columns, &mut known);
    }
    let (mut for_metrics, mut no_gradient) = (Vec::new(), Vec::new());
    let names: HashMap<&str, &Column> = all.iter().map(|column| (&*column.name, column)).collect();
    for metric in plan.metrics.iter().map(|plan| &plan.metric) {
        let told = SensitivityPlan::name(&metric.of, &parameters[0].name);
        if columns.iter().chain(&for_metrics).any(|column| column.name == told) {
            continue;
        }
        match names.get(&*metric.of) {
            Some(column) if described.get(&metric.of).copied().is_some_and(|of| is_known(plan, of)) => {
                by_parameters(column, acting.get(&metric.of), parameters, &mut for_metrics, &mut known);
            }
            _ => no_gradient.push(metric.name.clone()),
        }
    }
    if columns.len() + for_metrics.len() > MAX_COLUMNS {
        let place =
            root.get("sensitivity").map_or_else(|| parameters[0].place.clone(), |field| field.node.place.clone());
        let message = format!(
            "makes {} columns of derivatives; at most {MAX_COLUMNS} are told",
            columns.len() + for_metrics.len()
        );
        return refuse(
            &place,
            RefusalKind::TooLarge,
            message,
            "choose columns, of = [\"q.*\"], or fewer parameters".to_owned(),
        );
    }
    Ok(Chosen { columns, for_metrics, no_gradient, known, left_out })
}

/// The derivatives of a column, which the system knows as `quantity` where it has it.
fn by_parameters(
    column: &Column,
    quantity: Option<&Quantity>,
    parameters: &[ParameterPlan],
    columns: &mut Vec<Column>,
    known: &mut Vec<DerivativeColumn>,
) {
    for (by, parameter) in parameters.iter().enumerate() {
        let name = SensitivityPlan::name(&column.name, &parameter.name);
        let meaning = format!("derivative of {} by {}", column.name, parameter.name);
        let told = Column::new(name, over(&column.unit, &parameter.unit), meaning);
        known.extend(quantity.map(|&of| DerivativeColumn { of, by, column: told.clone() }));
        columns.push(told);
    }
}

/// Where a refusal of what the engine does not know points.
pub(crate) fn refuse_unknown(root: &Table<'_>, asked: &Asked, why: &str) -> Refused {
    let place = root.get("sensitivity").map(|field| field.node.place.clone());
    let place = place.or_else(|| asked.by.first().map(|by| by.place.clone()));
    let message = format!("the run cannot be differentiated: {why}");
    root.ctx.refuse(place.as_ref().unwrap_or(&root.node.place).refuse(RefusalKind::Rule, message))
}
