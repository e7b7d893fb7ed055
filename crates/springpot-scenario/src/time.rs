//! `[time]` and `[solver]`.

use super::document::{Value, shorten};
use super::names;
use super::plan::{SolverPlan, TimePlan};
use super::reader::{Field, Read, Table};
use super::refusal::RefusalKind;
use springpot::simulate::fixed::Method;
use springpot::simulate::{FixedStep, RowTimes};

/// The method that chooses its steps.
pub(super) const ADAPTIVE: &str = "radau";

pub(super) const KEYS: [&str; 3] = ["end", "output_step", "output_times"];
pub(super) const SOLVER_KEYS: [&str; 8] =
    ["rtol", "atol", "memory_rtol", "first_step", "max_step", "max_steps", "method", "step"];
/// Those of them that every kind of motion takes.
const COMMON_SOLVER_KEYS: usize = 6;
/// Methods with steps of one size.
pub(super) const FIXED: [Method; 2] = [Method::BackwardEuler, Method::Midpoint];
/// Most rows of one run.
const MAX_ROWS: f64 = 2e7;
const DEFAULT_RTOL: f64 = 1e-9;
/// Smallest default error of the memory's kernel; the default is this share of `rtol`.
pub(super) const SMALLEST_MEMORY_RTOL: f64 = 1e-12;
const MEMORY_SHARE: f64 = 100.0;
pub(super) const TOLERANCES: (f64, f64) = (1e-13, 0.1);

/// Duration and rows, for the readers that need them.
pub(crate) type Duration = TimePlan;

/// Reads `[time]`.
pub(crate) fn read(root: &Table<'_>) -> Read<TimePlan> {
    let field = root.require("time", "[time] with end = \"10 s\" and output_step = \"10 ms\"")?;
    let table = Table::open(root.ctx, field.node, "[time]", &KEYS)?;
    let end = table.require("end", "end = \"10 s\"").and_then(|field| field.positive("s"));
    match (table.get("output_step"), table.get("output_times")) {
        (Some(step), None) => {
            let step_size = step.positive("s")?;
            let end = end?;
            let rows = end / step_size;
            if rows > MAX_ROWS {
                let rows = if rows < 1e15 { format!("{rows:.0}") } else { format!("{rows:.1e}") };
                let message = format!("makes {rows} rows; at most {MAX_ROWS:.0} are written");
                let help = "write a larger output_step or a smaller end".to_owned();
                return Err(step.refuse(RefusalKind::TooLarge, message, Some(help)));
            }
            Ok(TimePlan { end, rows: RowTimes::Step { step: step_size, end } })
        }
        (None, Some(times)) => {
            let end = end?;
            Ok(TimePlan { end, rows: RowTimes::Times(output_times(&times, end)?.into()) })
        }
        (Some(_), Some(times)) => {
            let help = "write one of them".to_owned();
            Err(times.refuse(RefusalKind::Rule, "stands beside `output_step`", Some(help)))
        }
        (None, None) => Err(table.missing("output_step", "output_step = \"10 ms\" or output_times = [0, …]")),
    }
}

fn output_times(field: &Field<'_>, end: f64) -> Read<Vec<f64>> {
    let items = field.items("an array of times")?;
    if items.is_empty() {
        return Err(field.refuse(RefusalKind::Missing, "is empty", Some("write times in 0 … end".to_owned())));
    }
    let mut times: Vec<f64> = Vec::with_capacity(items.len());
    for item in items {
        let time = item.number("s")?;
        if !(0.0..=end).contains(&time) {
            let message = format!("holds {}, outside 0 … {end} s", item.node.label());
            return Err(item.refuse(RefusalKind::OutOfRange, message, Some("write times in 0 … end".to_owned())));
        }
        if times.last().is_some_and(|&last| time <= last) {
            let message = format!("holds {} after {} s", item.node.label(), times[times.len() - 1]);
            return Err(item.refuse(
                RefusalKind::Rule,
                message,
                Some("write the times in increasing order".to_owned()),
            ));
        }
        times.push(time);
    }
    Ok(times)
}

/// Reads `[solver]`.
pub(crate) fn read_solver(root: &Table<'_>) -> Read<SolverPlan> {
    let known = if moves_by_itself(root) { &SOLVER_KEYS[..] } else { &SOLVER_KEYS[..COMMON_SOLVER_KEYS] };
    let forward_only = |key: &str| {
        matches!(key, "method" | "step").then(|| {
            let why = "belongs to forward runs; along a prescribed motion or a gripper path the run chooses its steps";
            (RefusalKind::Rule, format!("`{key}` of [solver] {why}"))
        })
    };
    let table = match root.get("solver") {
        Some(field) => Some(Table::open_with(root.ctx, field.node, "[solver]", known, forward_only)?),
        None => None,
    };
    let get = |key: &'static str| table.as_ref().and_then(|table| table.get(key));
    let rtol = get("rtol").map_or(Ok(DEFAULT_RTOL), |field| tolerance(&field, TOLERANCES));
    let atol = get("atol").map(|field| field.positive("")).transpose();
    let default_memory = (rtol.unwrap_or(DEFAULT_RTOL) / MEMORY_SHARE).max(SMALLEST_MEMORY_RTOL);
    let memory_rtol =
        get("memory_rtol").map_or(Ok(default_memory), |field| tolerance(&field, (SMALLEST_MEMORY_RTOL, TOLERANCES.1)));
    let optional = |key| get(key).map(|field| field.positive("s")).transpose();
    let (first_step, max_step) = (optional("first_step"), optional("max_step"));
    let max_steps = get("max_steps").map(|field| field.integer(1, i64::MAX)).transpose();
    let fixed_step = fixed_step(table.as_ref());
    Ok(SolverPlan {
        rtol: rtol?,
        atol: atol?,
        memory_rtol: memory_rtol?,
        first_step: first_step?,
        max_step: max_step?,
        max_steps: max_steps?.map(i64::unsigned_abs),
        fixed_step: fixed_step?,
    })
}

/// Whether the motion follows from forces, as far as one can see before it is read.
fn moves_by_itself(root: &Table<'_>) -> bool {
    let kind = root.get("motion").and_then(|motion| motion.node.get("kind"));
    kind.is_some_and(|kind| matches!(&kind.value, Value::Text(kind) if kind == "forward"))
}

/// `method` and `step`.
fn fixed_step(table: Option<&Table<'_>>) -> Read<Option<FixedStep>> {
    let get = |key: &'static str| table.and_then(|table| table.get(key));
    let method = get("method").map(|field| method(&field)).transpose()?.flatten();
    match (method, get("step"), table) {
        (None, None, _) | (_, _, None) => Ok(None),
        (None, Some(step), _) => {
            let help = "add method = \"backward-euler\" or \"midpoint\", or leave step out".to_owned();
            Err(step.refuse(
                RefusalKind::Rule,
                "belongs to a fixed-step method; \"radau\" chooses its steps",
                Some(help),
            ))
        }
        (Some(_), None, Some(table)) => Err(table.missing("step", "step = \"1 ms\", as fixed-step methods need it")),
        (Some(method), Some(step), Some(table)) => {
            for key in ["atol", "first_step", "max_step"] {
                if let Some(field) = table.get(key) {
                    let message = format!("has no effect with method = {:?}, whose steps are all alike", method.name());
                    return Err(field.refuse(RefusalKind::Rule, message, Some("leave it out".to_owned())));
                }
            }
            Ok(Some(FixedStep { method, step: step.positive("s")? }))
        }
    }
}

/// The method by its name; `None`: the adaptive one.
fn method(field: &Field<'_>) -> Read<Option<Method>> {
    let name = field.text()?;
    if name == ADAPTIVE {
        return Ok(None);
    }
    if let Some(method) = FIXED.into_iter().find(|method| method.name() == name) {
        return Ok(Some(method));
    }
    let names = FIXED.map(Method::name);
    let help = names::suggest(name, std::iter::once(ADAPTIVE).chain(names));
    Err(field.refuse(RefusalKind::UnknownName, format!("names no method: {:?}", shorten(name)), Some(help)))
}

fn tolerance(field: &Field<'_>, (low, high): (f64, f64)) -> Read<f64> {
    let value = field.number("")?;
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    let message = format!("is {}, outside {low:e} … {high}", field.node.label());
    Err(field.refuse(RefusalKind::OutOfRange, message, Some("write a relative error such as 1e-9".to_owned())))
}
