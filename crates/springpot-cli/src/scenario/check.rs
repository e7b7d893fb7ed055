//! `springpot check`.

use crate::arguments::CheckOptions;
use crate::scenario::{failures, fit, starts, swept};
use crate::{Ending, diagnostic, plain, printed, signals, terminal};
use springpot::elements::Element;
use springpot::equations::ElementStart;
use springpot::law::{Catalog, Entry, Expansion, Heat, Shift, Thermal};
use springpot::system::{RowTimes, Stop};
use springpot_run::numbers::{count, short};
use springpot_run::sweep::Layout;
use springpot_run::{Depth, Survey, Trouble, Warning, robot_warnings};
use springpot_scenario::{
    Cases, ElementPlan, ParameterPlan, Plan, Refusals, Remark, Scenario, ShapePlan, SignalPlan, json_schema,
};
use std::ops::RangeInclusive;
use std::path::Path;

/// Numbers of a gradient that are printed even where they are 0, and what counts as 0.
const PRINTED_GRADIENT: usize = 6;
const ROUNDING: f64 = 1e-12;

/// Joints that are named.
const NAMED_JOINTS: usize = 100;

pub(crate) fn check(options: &CheckOptions, catalog: &Catalog) -> Ending {
    // Nothing is left behind that would have to be tidied up.
    signals::before_the_end(|| terminal::print_error("interrupted\n"));
    let Some(file) = &options.file else {
        let schema = json_schema(catalog);
        return printed(terminal::try_print(&format!("{schema:#}\n")));
    };
    match describe(file, options, catalog) {
        Ok(ending) => ending,
        Err(refused) => {
            diagnostic::refused(&refused);
            Ending::Refused
        }
    }
}

/// A scenario that was looked through.
struct Looked {
    /// What is said of its measurements, line by line, and what deserves a warning of them.
    measured: Vec<(String, String)>,
    warnings: Vec<String>,
    /// Nothing where it has elements alone.
    cases: Option<LookedAt>,
}

/// Its cases, the first of them, its kinks and jumps, and what is known to fail or deserves a warning in any.
struct LookedAt {
    cases: Cases,
    plan: Plan,
    switches: u64,
    survey: Survey,
}

fn look(scenario: &Scenario, is_swept: bool, catalog: &Catalog) -> Result<Looked, Refusals> {
    if scenario.is_of_elements() && !is_swept {
        let (measured, warnings) = fit::ahead(scenario, catalog)?;
        return Ok(Looked { measured, warnings, cases: None });
    }
    let measured = scenario.has_data().then(|| fit::ahead(scenario, catalog)).transpose()?;
    let (measured, warnings) = measured.unwrap_or_default();
    let cases = scenario.cases(catalog)?;
    let plan = cases.plan(0)?;
    let system = plan.system().sharing(cases.shared());
    Layout::new(&cases, &plan)?;

    let mut survey = Survey::of(&cases, &plan, &system, Depth::Paths, &Stop::new(false))?;
    let switches = match plan.settings.fixed_step {
        Some(_) => 0,
        None => system.switches(&plan.settings, &Stop::new(false)).unwrap_or_else(|error| {
            // Said already, where it was seen with the jumps.
            if survey.failures.iter().all(|(index, _)| *index != 0) {
                survey.failures.insert(0, (0, Trouble::of(&error, &plan)));
            }
            0
        }),
    };
    Ok(Looked { measured, warnings, cases: Some(LookedAt { cases, plan, switches, survey }) })
}

impl Looked {
    /// All that deserves a warning, in the order in which it is told.
    fn remarks(&self) -> Vec<Remark> {
        let of = |Warning { message, help }| Remark { message, place: None, help };
        let mut remarks: Vec<Remark> = self.warnings.iter().cloned().map(|warning| of(warning.into())).collect();
        if let Some(LookedAt { cases, survey, .. }) = &self.cases {
            remarks.extend(robot_warnings(cases).into_iter().map(of));
            remarks.extend(starts::remarks(survey, cases));
            remarks.extend(starts::of_limits(survey, cases));
        }
        remarks
    }
}

/// What deserves a warning in a scenario, and why cases cannot run, by their index.
pub type Findings = (Vec<Remark>, Vec<(usize, Trouble)>);

/// What `springpot check` says of a scenario: what deserves a warning, and why cases cannot run, by their index; none where all can.
///
/// # Errors
/// The scenario is refused.
pub fn findings(scenario: &Scenario, catalog: &Catalog) -> Result<Findings, Refusals> {
    let looked = look(scenario, false, catalog)?;
    let remarks = looked.remarks();
    Ok((remarks, looked.cases.map_or_else(Vec::new, |at| at.survey.failures)))
}

/// Prints the plan of the first case, and what is known to fail or deserves a warning in any.
fn describe(file: &Path, options: &CheckOptions, catalog: &Catalog) -> Result<Ending, Refusals> {
    let mut scenario = diagnostic::scenario(file, &options.overrides)?;
    options.sweeps.iter().try_for_each(|assignment| scenario.sweep(assignment))?;
    options.sensitivity.iter().try_for_each(|paths| scenario.differentiate(paths))?;
    let looked = look(&scenario, !options.sweeps.is_empty(), catalog)?;
    let described = |at: &LookedAt| text(&at.cases, &at.plan, at.switches, &at.survey);
    let words = looked.cases.as_ref().map_or_else(String::new, described) + &of_data(&looked.measured);
    let ending = if options.quiet { Ending::Done } else { printed(terminal::try_print(&words)) };
    looked.remarks().into_iter().for_each(diagnostic::remark);
    let Some(LookedAt { cases, survey, .. }) = &looked.cases else { return Ok(ending) };
    failures::tell(survey, cases);
    Ok(match survey.failures.is_empty() {
        true => ending,
        // As a run of it.
        false if survey.refused > 0 && survey.is_hopeless(cases) => Ending::Refused,
        false => Ending::Failed,
    })
}

/// What is said of measurements.
fn of_data(lines: &[(String, String)]) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let mut last = "";
    let mut text = String::new();
    for (lead, words) in lines {
        let shown = if lead == last { "" } else { lead.as_str() };
        text.push_str(&terminal::hanging(&format!("{shown:<10}"), &plain::words(words), width));
        last = lead;
    }
    text
}

/// The description of a scenario.
fn text(cases: &Cases, plan: &Plan, switches: u64, survey: &Survey) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let mut text = String::new();
    let mut line = |lead: &str, words: &str| {
        text.push_str(&terminal::hanging(&format!("{lead:<10}"), &plain::words(words), width));
    };
    if let Some(title) = &plan.title {
        line("title", &plain::title(title));
    }
    line("robot", &robot(plan));
    for joint in followers(plan) {
        line("", &joint);
    }
    line("motion", &format!("{}, 0 to {} s", plan.motion.kind(), short(plan.settings.end)));
    if let Some(control) = plan.motion.controller_words() {
        line("control", &control);
    }
    if switches > 0 {
        line("signals", &format!("{}, each of which ends a step", count(switches, "kink or jump", "kinks and jumps")));
    }
    line("rows", &rows(&plan.settings.rows));
    line("accuracy", &format!("rtol {}, memory_rtol {}", short(plan.settings.rtol), short(plan.settings.memory_rtol)));
    if cases.axis_count() > 0 {
        line("cases", &cases.len().to_string());
    }
    for axis in 0..cases.axis_count() {
        line("", &swept::words(cases, axis));
    }
    for (k, words) in parameters_of(plan).into_iter().enumerate() {
        line(if k == 0 { "by" } else { "" }, &words);
    }
    let figures: Vec<&str> = cases.figures().iter().map(|figure| figure.name.as_str()).collect();
    if !figures.is_empty() {
        line("figures", &figures.join(", "));
    }
    for (e, (place, plan_of)) in plan.placed_elements().enumerate() {
        let element = &plan_of.element;
        let law = if plan_of.is_network { "network" } else { &*element.entry.name };
        let along = match &plan_of.shape {
            ShapePlan::Points(points) if points.len() > 2 => {
                format!(", cable over {}", count(points.len() - 2, "point", "points"))
            }
            ShapePlan::Points(_) | ShapePlan::Bushing { .. } => String::new(),
            ShapePlan::Joint(joint) => format!(", on joint {joint}"),
        };
        let past = plan_of.past.words().unwrap_or_else(|| memory(element));
        line("element", &format!("{}: {law}{along}, {past}", element.name));
        line("", &element.entry.equation);
        line("", &parameters(plan_of));
        if let Some(heated) = element.law.as_heated() {
            line("", &heat(heated.heat(), survey.elements[place].unit));
        }
        let Some(start) = survey.first.as_ref().map(|starts| &starts[e]) else { continue };
        let (length, stroke) = (survey.elements[place].lengths(), survey.elements[place].strokes());
        let unit = survey.elements[place].unit;
        let (length, stroke) = (range(start.length, length, unit), range(start.stroke, stroke, unit));
        let y = if matches!(plan_of.shape, ShapePlan::Points(_)) { "l" } else { "y" };
        line("", &format!("{y}(0) = {length}, {y}0 = {} {unit}", short(element.rest)));
        line("", &format!("x(0) = {stroke}"));
        line("", &format!("d{y}/dq = {}", gradient(plan, start)));
    }
    for (_, absent) in &plan.absent {
        line("element", &format!("{}: not enabled", absent.element.name));
    }
    text
}

/// By what the run is differentiated, and what of it.
fn parameters_of(plan: &Plan) -> Vec<String> {
    let Some(sensitivity) = &plan.sensitivity else { return Vec::new() };
    let parameter = |parameter: &ParameterPlan| {
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
        let path = parameter.paths.join(", ");
        let path = if path == parameter.name { String::new() } else { format!(" ({path})") };
        format!("{}{path} = {}{unit}", parameter.name, short(parameter.value))
    };
    let mut words: Vec<String> = sensitivity.parameters.iter().map(parameter).collect();
    if sensitivity.is_asked() {
        words.push(count(sensitivity.columns.len(), "derivative", "derivatives"));
    }
    let left_out = &sensitivity.left_out;
    if !left_out.is_empty() {
        words.push(format!("no derivative is known of {}", left_out.join(", ")));
    }
    if !sensitivity.no_gradient.is_empty() {
        words.push(format!("no gradient is known of the metrics {}", sensitivity.no_gradient.join(", ")));
    }
    words
}

/// What temperature does to an element whose lengths are in `unit`.
fn heat(heat: &Heat, unit: &str) -> String {
    let shift = heat.shift.map(|shift| match shift {
        Shift::Wlf { c1, c2, reference } => {
            format!("shifts by WLF, C1 = {}, C2 = {} K, T_ref = {} K", short(c1), short(c2), short(reference))
        }
        Shift::Arrhenius { energy, reference } => {
            format!("shifts by Arrhenius, {} J/mol, T_ref = {} K", short(energy), short(reference))
        }
    });
    let thermal = heat.thermal.map(|Thermal { capacity, conductance, ambient, start }| {
        let (capacity, conductance) = (short(capacity), short(conductance));
        format!("warms itself from {} K, {capacity} J/K, {conductance} W/K to {} K", short(start), short(ambient))
    });
    let expansion = heat.expansion.map(|Expansion { coefficient, reference }| {
        format!("expands by {} {unit}/K from {} K", short(coefficient), short(reference))
    });
    [shift, thermal, expansion].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// Where the robot comes from, its bodies and its joints.
fn robot(plan: &Plan) -> String {
    let joints: Vec<&str> = plan.joint_names().collect();
    let named = joints.iter().take(NAMED_JOINTS).copied().collect::<Vec<_>>().join(", ");
    let more = joints.len().checked_sub(NAMED_JOINTS).filter(|more| *more > 0);
    let more = more.map_or(String::new(), |more| format!(" and {more} more"));
    let joints = format!("{}: {named}{more}", count(joints.len(), "joint", "joints"));
    match &plan.urdf {
        None => format!("{}; {joints}", count(plan.bodies.len(), "body", "bodies")),
        Some(urdf) => {
            let links = plan.bodies.len() + usize::from(!urdf.robot.floating_base);
            let base = if urdf.robot.floating_base { "floating base" } else { "fixed base" };
            format!("{}, {base}, {}; {joints}", urdf.written, count(links, "link", "links"))
        }
    }
}

/// Joints that follow others.
fn followers(plan: &Plan) -> Vec<String> {
    let (model, names) = (&plan.model, plan.model.joint_names());
    let follows = |j: usize| {
        let (leader, ratio, offset) = model.followed(j)?;
        let ratio = if ratio == 1.0 { String::new() } else { format!("{} times ", short(ratio)) };
        let offset = if offset == 0.0 { String::new() } else { format!(", from {}", short(offset)) };
        Some(format!("{} follows {ratio}{}{offset}", names[j], names[leader]))
    };
    (0..model.joint_count()).filter_map(follows).take(NAMED_JOINTS).collect()
}

/// ∂l/∂q by coordinate; of a robot of many those that are not 0.
fn gradient(plan: &Plan, start: &ElementStart) -> String {
    let labels = plan.model.v_labels();
    let all = labels.len() <= PRINTED_GRADIENT;
    let shown: Vec<String> = labels
        .iter()
        .zip(start.gradient.iter().map(|g| if g.abs() > ROUNDING { *g } else { 0.0 }))
        .filter(|(_, g)| all || *g != 0.0)
        .map(|(label, g)| format!("{}: {}", label.name, short(g)))
        .collect();
    let rest = (shown.len() < labels.len()).then(|| if shown.is_empty() { "0" } else { "others 0" }.to_owned());
    shown.into_iter().chain(rest).collect::<Vec<_>>().join(", ")
}

fn rows(rows: &RowTimes) -> String {
    match rows {
        RowTimes::Step { step, .. } => format!("{}, every {} s", rows.count(), short(*step)),
        RowTimes::Times(_) => format!("{}, at given times", rows.count()),
    }
}

/// Which derivative, and by which scheme.
fn memory(element: &Element) -> String {
    match element.scheme {
        None => element.derivative.name().to_owned(),
        Some(scheme) => format!("{} by {scheme}", element.derivative.name()),
    }
}

/// Parameters in SI, then inputs as written.
fn parameters(element: &ElementPlan) -> String {
    let Entry { params, inputs, .. } = &*element.element.entry;
    let with_unit = |value: String, unit: &str| if unit.is_empty() { value } else { format!("{value} {unit}") };
    let parameter = |(param, value): (&springpot::law::Param, &f64)| {
        format!("{} = {}", param.name, with_unit(short(*value), &param.unit)).replace(' ', terminal::NO_BREAK)
    };
    let input = |(input, signal): (&springpot::law::Input, &SignalPlan)| match signal.constant {
        Some(value) => {
            format!("{} = {}", input.name, with_unit(short(value), &input.unit)).replace(' ', terminal::NO_BREAK)
        }
        None => format!("{} = {}", input.name, signal.written),
    };
    let parameters = params.iter().zip(&element.parameters).map(parameter);
    let files = element.files.iter().map(|(name, file)| format!("{name} = {file}"));
    parameters.chain(files).chain(inputs.iter().zip(&element.inputs).map(input)).collect::<Vec<_>>().join(", ")
}

/// A coordinate, and the range it has over the cases where that is wider.
fn range(first: f64, all: RangeInclusive<f64>, unit: &str) -> String {
    let (first, low, high) = (short(first), short(*all.start()), short(*all.end()));
    if low == high {
        format!("{first} {unit}")
    } else {
        format!("{first} {unit} ({low} to {high} {unit} over the cases)")
    }
}
