//! The cases of a scenario: the grid of its sweeps, each planned when it is asked for.

use crate::changes::path;
use crate::changes::sweep::{self, Axis};
use crate::elements;
use crate::elements::Elements;
use crate::figures::{self, ColumnGlob, FigurePlan};
use crate::keys::OUTPUT;
use crate::motion;
use crate::plan::design;
use crate::plan::events;
use crate::plan::metrics::{self, MetricPlan};
use crate::plan::{OutputPlan, Plan};
use crate::plan::{control, steady};
use crate::reader::constants;
use crate::reader::files::CsvCache;
use crate::reader::files::DescriptionCache;
use crate::reader::{Context, Read, Table};
use crate::robot;
use crate::robot::Robot;
use crate::robot::described::RobotPlan;
use crate::scenario::overrides;
use crate::scenario::root::SCENARIO;
use crate::scenario::written::Scenario;
use crate::sensitivity::{self, Asked};
use crate::text::document::Node;
use crate::text::refusal::{Place, RefusalKind, Refusals, Remark};
use crate::time;
use crate::units::Unit;
use serde::{Deserialize, Serialize};
use springpot::Simulation;
use springpot::law::Catalog;
use springpot::system::{Adaptive, RunError, Shared};
use std::cell::{Cell, OnceCell};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Values of a sweep that are tried before the first run; of longer ones the first of them and the last.
const TRIED: usize = 1_000;

/// A value of a swept parameter, as a column of the results shows it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum SweptValue {
    /// A number or quantity, SI.
    Number(f64),
    /// As written, where it is neither.
    Text(String),
}

/// The cases of a scenario; one where nothing is swept. The first `[[sweep]]` is the outer loop, the last runs fastest.
#[derive(Debug)]
pub struct Cases {
    catalog: Catalog,
    folder: PathBuf,
    tables: CsvCache,
    robots: DescriptionCache,
    document: Node,
    axes: Vec<Axis>,
    /// By what runs are differentiated.
    sensitivity: Option<Asked>,
    /// By axis, value and target: the SI value, where it was read as a number; shorter than the axis for long ones.
    numbers: Vec<Vec<Vec<Option<f64>>>>,
    figures: Arc<[FigurePlan]>,
    columns: Option<Arc<[ColumnGlob]>>,
    /// Those of the first case.
    metrics: Vec<MetricPlan>,
    parameters: Vec<String>,
    /// Units of the swept parameters; empty where they are no numbers, or pure ones.
    units: Vec<String>,
    /// Whether the results have the column of the energy lost in joints.
    tell_joint_losses: bool,
    /// What is to be said of the sweeps.
    remarks: Vec<Remark>,
    /// What the systems of cases have in common.
    shared: Shared,
}

impl Scenario {
    /// Validates everything: robot, elements, motion, time, solver, figures, and every swept value once.
    ///
    /// # Errors
    /// All refusals that could be collected, in the order of the text.
    pub fn cases(&self, catalog: &Catalog) -> Result<Cases, Refusals> {
        Cases::new(self, catalog)
    }

    /// The robot alone, as the first case has it: `[robot]` is all that the scenario needs to hold.
    ///
    /// # Errors
    /// All refusals about the robot and the sweeps that could be collected; the rest of the scenario is not looked at.
    pub fn robot(&self, catalog: &Catalog) -> Result<RobotPlan, Refusals> {
        let Robot { gravity, gripper, parts, .. } = Cases::robot(self, catalog)?;
        Ok(RobotPlan { gravity, bodies: parts.bodies, model: parts.model, urdf: parts.urdf, gripper })
    }
}

impl Cases {
    /// Applies the overrides, reads sweeps and figures, and tries every swept value once.
    pub(super) fn new(scenario: &Scenario, catalog: &Catalog) -> Result<Self, Refusals> {
        let mut cases = Self::with_sweeps(scenario, catalog)?;
        cases.try_values()?;
        let ctx = cases.context();
        let read = cases.read_figures(&ctx);
        let (figures, columns) = ctx.finish(read)?;
        cases.figures = figures;
        cases.columns = columns;
        Ok(cases)
    }

    /// Reads the robot of the first case, and nothing but the sweeps besides.
    pub(super) fn robot(scenario: &Scenario, catalog: &Catalog) -> Result<Robot, Refusals> {
        let cases = Self::with_sweeps(scenario, catalog)?;
        let document = cases.document_at(&vec![0; cases.axes.len()]);
        let ctx = cases.context();
        let read = root(&ctx, &document).and_then(|root| robot::read(&root));
        ctx.finish(read)
    }

    fn with_sweeps(scenario: &Scenario, catalog: &Catalog) -> Result<Self, Refusals> {
        let mut cases = Self {
            catalog: catalog.clone(),
            folder: scenario.folder.clone(),
            tables: CsvCache::default(),
            robots: DescriptionCache::default(),
            document: scenario.document.clone(),
            axes: Vec::new(),
            sensitivity: None,
            numbers: Vec::new(),
            figures: Arc::new([]),
            columns: None,
            metrics: Vec::new(),
            parameters: Vec::new(),
            units: Vec::new(),
            tell_joint_losses: false,
            remarks: Vec::new(),
            shared: Shared::default(),
        };
        cases.read_sweeps(scenario)?;
        Ok(cases)
    }

    /// Number of cases.
    pub fn len(&self) -> usize {
        self.axes.iter().map(Axis::len).product()
    }

    /// Always false.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What the systems of cases have in common ([`System::sharing`](springpot::system::System::sharing)).
    pub fn shared(&self) -> &Shared {
        &self.shared
    }

    /// Number of sweeps.
    pub fn axis_count(&self) -> usize {
        self.axes.len()
    }

    /// Number of values of a sweep.
    pub fn axis_len(&self, axis: usize) -> usize {
        self.axes[axis].len()
    }

    /// Paths of the parameters that a sweep moves together.
    pub fn axis_parameters(&self, axis: usize) -> impl Iterator<Item = &str> {
        self.axes[axis].targets.iter().map(|target| target.written.as_str())
    }

    /// Value `k` of a sweep for a legend: its name, else as written.
    pub fn axis_label(&self, axis: usize, k: usize) -> String {
        self.axes[axis].label(k)
    }

    /// What the values of a sweep are called, where the scenario says so.
    pub fn axis_names(&self, axis: usize) -> Option<&[String]> {
        self.axes[axis].names.as_deref()
    }

    /// Value `k` that a sweep gives to the parameter with this path, as written.
    pub fn axis_label_of(&self, axis: usize, path: &str, k: usize) -> String {
        let targets = &self.axes[axis].targets;
        let at = targets.iter().position(|target| target.written == path).unwrap_or(0);
        self.axes[axis].label_of(k, at)
    }

    /// Paths of all swept parameters, in the order of [`Cases::values`].
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// SI units of [`Cases::values`], in their order; empty for pure numbers and what is none.
    pub fn units(&self) -> &[String] {
        &self.units
    }

    /// Index of the value that each sweep has in case `i`.
    pub fn position(&self, i: usize) -> Vec<usize> {
        let mut rest = i;
        let mut position: Vec<usize> = vec![0; self.axes.len()];
        for (at, axis) in position.iter_mut().zip(&self.axes).rev() {
            *at = rest % axis.len();
            rest /= axis.len();
        }
        position
    }

    /// Values of the swept parameters in case `i`.
    pub fn values(&self, i: usize) -> Vec<SweptValue> {
        let position = self.position(i);
        let mut values = Vec::with_capacity(self.parameters.len());
        for (axis, &k) in position.iter().enumerate() {
            let targets = 0..self.axes[axis].targets.len();
            match self.numbers[axis].get(k) {
                Some(numbers) => values.extend(targets.map(|at| self.swept_value((axis, at), k, numbers[at]))),
                None => {
                    let numbers = self.read_numbers(axis, k);
                    values.extend(targets.map(|at| self.swept_value((axis, at), k, numbers[at])));
                }
            }
        }
        values
    }

    /// Values of the swept parameters in case `i`, as written.
    pub fn labels(&self, i: usize) -> Vec<String> {
        let position = self.position(i);
        let axes = self.axes.iter().zip(position);
        axes.flat_map(|(axis, k)| (0..axis.targets.len()).map(move |at| axis.label_of(k, at))).collect()
    }

    /// What case `i` is called: the names of its swept values, or paths and values as written, `element.strut.alpha = 0.5, …`; empty where
    /// nothing is swept.
    pub fn name(&self, i: usize) -> String {
        let mut words = Vec::with_capacity(self.parameters.len());
        for (axis, k) in self.axes.iter().zip(self.position(i)) {
            match &axis.names {
                Some(names) => words.push(names[k].clone()),
                None => words.extend(
                    axis.targets
                        .iter()
                        .enumerate()
                        .map(|(at, target)| format!("{} = {}", target.written, axis.label_of(k, at))),
                ),
            }
        }
        words.join(", ")
    }

    /// What case `i` is called where values of its sweeps have names: these; empty where none has.
    pub fn given_name(&self, i: usize) -> String {
        let names = self.axes.iter().zip(self.position(i)).filter_map(|(axis, k)| Some(&*axis.names.as_ref()?[k]));
        names.collect::<Vec<_>>().join(", ")
    }

    /// Globs of the columns to write; `None`: all.
    pub fn columns(&self) -> Option<&[ColumnGlob]> {
        self.columns.as_deref()
    }

    /// What the URDF files hold that is not used, or lack and is assumed: one line each, which names the file.
    pub fn warnings(&self) -> Vec<String> {
        self.robots.warnings()
    }

    /// What `accept` of `[robot]` would say, whole, to have none of [`Cases::warnings`].
    pub fn warning_kinds(&self) -> Vec<&'static str> {
        self.robots.kinds()
    }

    /// What deserves a warning in the sweeps.
    pub fn remarks(&self) -> Vec<Remark> {
        let equal = (0..self.axes.len()).filter_map(|axis| self.equal_values(axis));
        self.remarks.iter().cloned().chain(equal).collect()
    }

    /// Two values of a sweep that are the same, so that two cases are.
    fn equal_values(&self, axis: usize) -> Option<Remark> {
        let swept = &self.axes[axis];
        let mut seen: HashMap<String, usize> = HashMap::new();
        let twice = (0..swept.len().min(TRIED)).find_map(|k| {
            let targets = 0..swept.targets.len();
            let one = |at: usize| match self.numbers[axis].get(k).and_then(|numbers| numbers[at]) {
                Some(number) => number.to_string(),
                None => swept.label_of(k, at),
            };
            let earlier = seen.insert(targets.map(one).collect::<Vec<_>>().join(", "), k)?;
            Some((earlier, k))
        });
        let (first, second) = twice?;
        let path = swept.targets.first().map_or("", |target| target.written.as_str());
        let (one, other) = (swept.label(first), swept.label(second));
        let values =
            if one == other { format!("{one} twice") } else { format!("{one} and {other}, which are the same") };
        let message = format!("the sweep of {path} holds {values}: cases that are alike are run again");
        let place = swept.node(second, 0, 0).place;
        Some(Remark::at(&place, message).help("leave one of them out"))
    }

    /// The figures.
    pub fn figures(&self) -> &[FigurePlan] {
        &self.figures
    }

    /// The metrics of the first case; others may have other windows, bands and targets.
    pub fn metrics(&self) -> &[MetricPlan] {
        &self.metrics
    }

    /// Plans case `i`.
    ///
    /// # Errors
    /// The refusals of a combination of swept values that no single value shows.
    ///
    /// # Panics
    /// Where `i` is not below [`Cases::len`].
    pub fn plan(&self, i: usize) -> Result<Plan, Refusals> {
        assert!(i < self.len(), "case {i} of {}", self.len());
        let ctx = self.context();
        let document = self.document_at(&self.position(i));
        let plan = self.read_case(ctx, document)?;
        let (figures, columns) = (self.figures.clone(), self.columns.clone());
        let tells_joint_losses = self.tell_joint_losses;
        Ok(Plan { output: OutputPlan { figures, columns, tells_joint_losses, ..plan.output }, ..plan })
    }

    /// Reads a case, and by what it is differentiated.
    fn read_case(&self, ctx: Context<'_>, mut document: Node) -> Result<Plan, Refusals> {
        let Some(asked) = &self.sensitivity else {
            let read = read_plan(&ctx, &document);
            return ctx.finish(read);
        };
        let first = self.first_tag(self.axes.len());
        let read = sensitivity::mark(&ctx, &mut document, asked, first).and_then(|()| {
            let mut plan = read_plan(&ctx, &document)?;
            plan.output.tells_joint_losses = self.tell_joint_losses || has_joint_losses(&plan);
            let root = Table::of(&ctx, &document, "the scenario", &SCENARIO)?;
            let sensitivity = sensitivity::judge(&root, &plan, asked, first)?;
            Ok(Plan { sensitivity: Some(sensitivity), ..plan })
        });
        ctx.finish(read)
    }

    /// Refuses what the engine knows no derivative of in the first case.
    fn try_sensitivity(&self, first: &Plan) -> Result<(), Refusals> {
        let Some(asked) =
            self.sensitivity.as_ref().filter(|_| first.sensitivity.as_ref().is_some_and(|plan| plan.is_asked()))
        else {
            return Ok(());
        };
        // What else keeps it from starting is told by the run.
        let Err(RunError::Sensitivity(error)) = Simulation::new(first.system(), first.settings.clone()) else {
            return Ok(());
        };
        let ctx = self.context();
        let read = Table::of(&ctx, &self.document, "the scenario", &SCENARIO);
        let read = read.and_then(|root| Err::<(), _>(sensitivity::refuse_unknown(&root, asked, &error.to_string())));
        ctx.finish(read)
    }

    fn context(&self) -> Context<'_> {
        Context::new(&self.catalog, &self.folder, &self.tables, &self.robots).of_whole(&SCENARIO)
    }

    fn swept_value(&self, (axis, at): (usize, usize), k: usize, number: Option<f64>) -> SweptValue {
        number.map_or_else(|| SweptValue::Text(self.axes[axis].label_of(k, at)), SweptValue::Number)
    }

    /// The document with the swept values of one case.
    fn document_at(&self, position: &[usize]) -> Node {
        let mut document = self.document.clone();
        let mut tag = 0;
        for (axis, &k) in self.axes.iter().zip(position) {
            for (at, target) in axis.targets.iter().enumerate() {
                path::set(&mut document, target, axis.node(k, at, tag));
                tag += 1;
            }
        }
        document
    }

    fn first_tag(&self, axis: usize) -> usize {
        self.axes[..axis].iter().map(|axis| axis.targets.len()).sum()
    }

    /// SI values of value `k` of a sweep where it reads as a number, the other sweeps at their first values.
    fn read_numbers(&self, axis: usize, k: usize) -> Vec<Option<f64>> {
        let mut position = vec![0; self.axes.len()];
        position[axis] = k;
        let ctx = self.context();
        // What is wrong with it is said by the case's plan.
        let _ = read_plan(&ctx, &self.document_at(&position));
        self.noted(&ctx, axis)
    }

    fn noted(&self, ctx: &Context<'_>, axis: usize) -> Vec<Option<f64>> {
        let first = self.first_tag(axis);
        (first..first + self.axes[axis].targets.len()).map(|tag| ctx.swept(tag)).collect()
    }

    fn read_sweeps(&mut self, scenario: &Scenario) -> Result<(), Refusals> {
        let mut document = std::mem::replace(&mut self.document, Node::empty_table(&scenario.document.place));
        let ctx = self.context();
        let read = (|| {
            let set = overrides::apply(&ctx, scenario, &mut document)?;
            let root = Table::of(&ctx, &document, "the scenario", &SCENARIO)?;
            let axes = sweep::read(&root)?;
            for swept in axes.iter().flat_map(|axis| &axis.targets) {
                if let Some(target) = set.iter().find(|target| target.overlaps(swept)) {
                    let message = format!("--set {} has no effect: it is swept", target.written);
                    let refusal = target.place.refuse(RefusalKind::Rule, message);
                    return Err(ctx.refuse(refusal.help("sweep it: --sweep PATH=v1,v2,…; or remove its [[sweep]]")));
                }
            }
            let asked = sensitivity::read(&root, &axes, &scenario.sensitivity)?;
            Ok((axes, asked))
        })();
        let mut remarks = ctx.warnings();
        let (axes, asked) = ctx.finish(read)?;
        remarks.extend(axes.iter().filter_map(Axis::read_otherwise));
        self.remarks = remarks;
        self.document = document;
        self.parameters = axes.iter().flat_map(|axis| &axis.targets).map(|target| target.written.clone()).collect();
        self.axes = axes;
        self.sensitivity = asked;
        Ok(())
    }

    /// Reads what the file itself says where something is swept, each beside the first values of all other sweeps.
    fn judge_unswept(&self) -> Result<(), Refusals> {
        for (axis, swept) in self.axes.iter().enumerate() {
            let written: Vec<Option<&Node>> =
                swept.targets.iter().map(|target| path::get(&self.document, target)).collect();
            let Some(written) = written.into_iter().collect::<Option<Vec<_>>>() else { continue };
            let mut document = self.document_at(&vec![0; self.axes.len()]);
            for (target, node) in self.axes[axis].targets.iter().zip(written) {
                path::set(&mut document, target, node.clone());
            }
            let ctx = self.context();
            let read = read_plan(&ctx, &document);
            ctx.finish(read)?;
        }
        Ok(())
    }

    /// Plans the first case, then every other value of every sweep with the rest at their first values.
    fn try_values(&mut self) -> Result<(), Refusals> {
        let first = self.plan(0)?;
        self.try_sensitivity(&first)?;
        self.judge_unswept()?;
        let columns = columns_of(&first);
        let losses = Cell::new(has_joint_losses(&first));
        let mut numbers = Vec::with_capacity(self.axes.len());
        let mut units = vec![String::new(); self.parameters.len()];
        for (axis, values) in self.axes.iter().enumerate() {
            let count = values.len();
            let mut position = vec![0; self.axes.len()];
            // By target the first value that tells its unit.
            let mut told = vec![None; values.targets.len()];
            let mut known = Vec::with_capacity(count.min(TRIED));
            let last = (count > TRIED).then_some(count - 1);
            for k in (0..count.min(TRIED)).chain(last) {
                position[axis] = k;
                let ctx = self.context();
                let read = read_plan(&ctx, &self.document_at(&position)).and_then(|plan| {
                    losses.set(losses.get() || has_joint_losses(&plan));
                    let (message, help) = if columns_of(&plan) != columns {
                        ("columns", "all cases of a sweep need the same elements, inputs and joints")
                    } else if !are_alike(&plan.metrics, &first.metrics) {
                        ("metrics", "all cases of a sweep need metrics of the same columns and kinds")
                    } else {
                        return Ok(());
                    };
                    let place: Place = values.node(k, 0, 0).place;
                    let what = values.targets.first().map_or("", |target| target.written.as_str());
                    let message =
                        format!("{what} = {}: the case has other {message} than the first one", values.label(k));
                    Err(ctx.refuse(place.refuse(RefusalKind::Rule, message).help(help)))
                });
                if k < TRIED {
                    known.push(self.noted(&ctx, axis));
                }
                let first = self.first_tag(axis);
                for at in 0..values.targets.len() {
                    let own = ctx.swept_unit(first + at).unwrap_or_default();
                    // 0 is one of all units.
                    let is_bare_zero = own.is_empty() && ctx.swept(first + at) == Some(0.0);
                    match told[at] {
                        None if is_bare_zero => {}
                        None => {
                            told[at] = Some(k);
                            units[first + at] = own;
                        }
                        Some(_) if is_bare_zero || own == units[first + at] => {}
                        Some(earlier) => self.refuse_unit((axis, at), [earlier, k], &ctx, [&units[first + at], &own]),
                    }
                }
                ctx.finish(read)?;
            }
            numbers.push(known);
        }
        self.numbers = numbers;
        self.units = units;
        self.metrics = first.metrics;
        self.tell_joint_losses = losses.get();
        Ok(())
    }

    /// Refuses a value of a swept constant in another SI unit than the first: a constant has any, and a column one.
    fn refuse_unit(
        &self,
        (axis, at): (usize, usize),
        [earlier, k]: [usize; 2],
        ctx: &Context<'_>,
        [first, own]: [&str; 2],
    ) {
        let values = &self.axes[axis];
        let target = &values.targets[at];
        if !matches!(target.ends(), ("constants", _)) || ctx.swept(self.first_tag(axis) + at).is_none() {
            return;
        }
        let read = |unit: &str| Unit::parse(unit, &|_| None).map(|unit| unit.dimension());
        // Of one dimension, but not one quantity: Hz and rad/s, rad and pure numbers.
        let is_told = |unit: &&str| unit.contains("Hz") || unit.contains("rad");
        if read(first) == read(own) && ![first, own].iter().any(is_told) {
            return;
        }
        let named = |unit: &str| if unit.is_empty() { "a pure number".to_owned() } else { format!("in {unit}") };
        let message = format!(
            "{} is swept through {}, which is {}, and {}, which is {}",
            target.written,
            values.label_of(earlier, at),
            named(first),
            values.label_of(k, at),
            named(own)
        );
        let place = values.node(k, at, 0).place;
        let help = "write all values of a constant in units of one kind, or all without";
        _ = ctx.refuse(place.refuse(RefusalKind::BadQuantity, message).help(help));
    }

    #[allow(clippy::type_complexity)]
    fn read_figures(&self, ctx: &Context<'_>) -> Read<(Arc<[FigurePlan]>, Option<Arc<[ColumnGlob]>>)> {
        // Constants that are swept have their first values.
        let document = self.document_at(&vec![0; self.axes.len()]);
        let root = root(ctx, &document)?;
        let unread = |axis: &Axis| axis.targets.iter().map(|_| OnceCell::new()).collect();
        let labels: Vec<Vec<OnceCell<HashMap<String, usize>>>> = self.axes.iter().map(unread).collect();
        let figures = figures::read(&root, &self.axes, &|axis, at, node| {
            let labels = labels[axis][at].get_or_init(|| self.axes[axis].labels(at));
            labels.get(&node.label()).copied().or_else(|| self.find(axis, at, node))
        });
        let columns = figures::read_columns(&root);
        Ok((figures?, columns?))
    }

    /// Which value of a sweep has the number of `node`: that of a span, or one of a list in SI.
    fn find(&self, axis: usize, at: usize, node: &Node) -> Option<usize> {
        let swept = &self.axes[axis];
        if let Some(k) = swept.index_in_span(node) {
            return Some(k);
        }
        let mut document = self.document_at(&vec![0; self.axes.len()]);
        let tag = self.first_tag(axis) + at;
        path::set(&mut document, &swept.targets[at], Node { tag: Some(tag), ..node.clone() });
        let ctx = self.context();
        let _ = read_plan(&ctx, &document);
        let wanted = ctx.swept(tag)?;
        let near = |number: f64| (number - wanted).abs() <= 1e-12 * wanted.abs();
        self.numbers[axis].iter().position(|numbers| numbers[at].is_some_and(near))
    }
}

/// Whether a joint has damping or friction.
fn has_joint_losses(plan: &Plan) -> bool {
    plan.end_stops.is_some() || plan.model.damping().iter().chain(plan.model.friction()).any(|x| *x != 0.0)
}

/// Names of the columns of a case, but for the energy lost in joints, which all cases have or none.
fn columns_of(plan: &Plan) -> Vec<String> {
    let observables = plan.observables();
    observables.quantities().into_iter().map(|quantity| observables.named(quantity).to_string()).collect()
}

/// Whether metrics are of the same columns and kinds.
fn are_alike(some: &[MetricPlan], others: &[MetricPlan]) -> bool {
    let pairs = || some.iter().map(|plan| &plan.metric).zip(others.iter().map(|plan| &plan.metric));
    some.len() == others.len()
        && pairs().all(|(one, other)| (&one.name, &one.of, one.kind) == (&other.name, &other.of, other.kind))
}

/// The whole scenario, its constants known to the context.
pub(crate) fn root<'a>(ctx: &'a Context<'a>, document: &'a Node) -> Read<Table<'a>> {
    let root = Table::of(ctx, document, "the scenario", &SCENARIO)?;
    // What else is wrong is told all the same.
    _ = constants::read(&root);
    Ok(root)
}

/// Refuses the explicit method where it is asked for and what acts is not for it.
fn check_method(root: &Table<'_>, plan: &Plan) -> Read<()> {
    if plan.settings.adaptive != Adaptive::Explicit {
        return Ok(());
    }
    let Err(why) = plan.system_at_start().fits_explicit() else { return Ok(()) };
    let method = root.get("solver").and_then(|solver| solver.node.get("method"));
    let place = method.map_or(&root.node.place, |method| &method.place);
    let refusal = place.refuse(RefusalKind::Rule, format!("`method` is \"explicit\": {why}"));
    Err(root.ctx.refuse(refusal.help("leave it out: the run then takes \"radau\" where it has to")))
}

/// Reads everything but sweeps and what is the same in every case.
pub(crate) fn read_plan(ctx: &Context<'_>, document: &Node) -> Read<Plan> {
    let root = root(ctx, document)?;
    let title = root.get("title").map(|field| field.text().map(str::to_owned)).transpose();
    let time = time::read(&root);
    let settings = time::read_solver(&root, &time);
    let robot = robot::read(&root);
    let Ok(robot) = robot else {
        if root.get("motion").is_none() {
            root.lacks("motion");
        }
        return Err(crate::reader::Refused);
    };
    let elements = elements::read(&root, &robot, time.as_ref().ok());
    let motion = motion::read(&root, &robot, time.as_ref().ok().map(|time| time.end));
    if let (Ok(elements), Ok(motion)) = (&elements, &motion)
        && motion.is_forward()
        && let Some(element) = elements.acting.iter().find(|plan| plan.element.scheme.is_some())
    {
        let message = format!("element {:?} has a `scheme`, but the robot moves by itself", element.element.name);
        let place = element.scheme_place.as_ref().unwrap_or(&element.place);
        let refusal = place.refuse(RefusalKind::Rule, message);
        let help = "leave the scheme out: named schemes need a motion that is given in advance";
        return Err(ctx.refuse(refusal.help(help)));
    }
    let tells_leaves = root.get("output").map_or(Ok(false), |field| field.table(&OUTPUT)?.flag("leaves"));
    let Elements { acting, absent } = elements?;
    let mut plan = Plan {
        title: title?,
        gravity: robot.gravity,
        bodies: robot.parts.bodies,
        model: robot.parts.model,
        body_places: robot.parts.places,
        urdf: robot.parts.urdf,
        gripper: robot.gripper,
        end_stops: robot.end_stops,
        elements: acting,
        absent,
        motion: motion?,
        events: Vec::new(),
        metrics: Vec::new(),
        design: None,
        sensitivity: None,
        warnings: Vec::new(),
        settings: time.and(settings)?,
        output: OutputPlan { tells_leaves: tells_leaves?, ..OutputPlan::default() },
    };
    plan.rest_at_start();
    steady::settle(ctx, &mut plan)?;
    let control = control::settle(ctx, &plan)?;
    plan.motion.follow(control);
    check_method(&root, &plan)?;
    plan.events = events::read(&root, &plan)?;
    plan.metrics = metrics::read(&root, &plan)?;
    plan.design = design::read(&root, &plan)?;
    plan.warnings = ctx.warnings();
    Ok(plan)
}
