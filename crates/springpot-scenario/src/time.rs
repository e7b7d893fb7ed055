//! `[time]` and `[solver]`.

use crate::keys::MotionKind;
use crate::keys::solver::{ADAPTIVE, FIXED, MAX_ROWS, OF_CHOSEN_STEPS, SMALLEST_MEMORY_RTOL, adaptive};
use crate::keys::{FORWARD_RUNS, SOLVER, SOLVER_FIELDS, TIME, TIMES};
use crate::reader::spacing::Spacing;
use crate::reader::{Field, Read, Table};
use crate::text::document::{Node, shorten};
use crate::text::names;
use crate::text::refusal::RefusalKind;
use springpot::methods::fixed::Method;
use springpot::system::{Adaptive, FixedStep, RowTimes, Settings};

/// Where nothing is said of the memory's kernel, its error is `rtol` divided by this.
const MEMORY_SHARE: f64 = 100.0;

/// Duration and rows of a run.
#[derive(Debug, Clone)]
pub(crate) struct Duration {
    /// End, s.
    pub(crate) end: f64,
    /// When rows are written.
    pub(crate) rows: RowTimes,
}

/// Reads `[time]`.
pub(crate) fn read(root: &Table<'_>) -> Read<Duration> {
    let field = root.require("time")?;
    let table = Table::of(root.ctx, field.node, "[time]", &TIME)?;
    let end = table.number("end");
    match (table.get("output_step"), table.get("output_times")) {
        (Some(step), None) => {
            let step_size = step.quantity()?;
            let end = end?;
            let rows = end / step_size;
            if rows > MAX_ROWS {
                let rows = if rows < 1e15 { format!("{rows:.0}") } else { format!("{rows:.1e}") };
                let message = format!("makes {rows} rows; at most {MAX_ROWS:.0} are written");
                let help = "write a larger output_step or a smaller end".to_owned();
                // What the command line says is looked at first.
                let is_set = |field: &Field<'_>| field.node.place.source.name.starts_with("--");
                let step = table.get("end").filter(|end| is_set(end) && !is_set(&step)).unwrap_or(step);
                return Err(step.refuse(RefusalKind::TooLarge, message, Some(help)));
            }
            Ok(Duration { end, rows: RowTimes::Step { step: step_size, end } })
        }
        (None, Some(times)) => {
            let end = end?;
            Ok(Duration { end, rows: RowTimes::Times(output_times(&times, end)?.into()) })
        }
        (Some(_), Some(times)) => {
            let help = "write one of them".to_owned();
            Err(times.refuse(RefusalKind::Rule, "stands beside `output_step`", Some(help)))
        }
        (None, None) => Err(table.missing("output_step", "output_step = \"10 ms\" or output_times = [0, …]")),
    }
}

fn output_times(field: &Field<'_>, end: f64) -> Read<Vec<f64>> {
    if field.node.entries().is_some() {
        return spaced_times(field, end);
    }
    let items = field.items("an array of times, or a table with from, to, count")?;
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

/// Times at equal differences or equal ratios.
fn spaced_times(field: &Field<'_>, end: f64) -> Read<Vec<f64>> {
    let table = field.table(&TIMES)?;
    let times = ["from", "to"].map(|key| table.require(key).and_then(|field| Ok((field.quantity()?, field))));
    let ends = (|| {
        let [from, to] = times;
        let ((from, from_field), (to, to_field)) = (from?, to?);
        let inside = || Some("write times in 0 … end".to_owned());
        if from < 0.0 {
            let message = format!("is {}, before the motion starts", from_field.node.label());
            return Err(from_field.refuse(RefusalKind::OutOfRange, message, inside()));
        }
        if to > end {
            let message = format!("is {}, beyond the end at {end} s", to_field.node.label());
            return Err(to_field.refuse(RefusalKind::OutOfRange, message, inside()));
        }
        if from >= to {
            let message = format!("runs from {from} s to {to} s");
            let help = "write the earlier time as `from`".to_owned();
            return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
        }
        Ok(([from, to], ()))
    })();
    let (spacing, ()) = Spacing::read(field, &table, ends)?;
    let times: Vec<f64> = (0..spacing.count).map(|k| spacing.number(k)).collect();
    if times.windows(2).any(|pair| pair[1] <= pair[0]) {
        let message = format!("holds {} times too close to one another to be told apart", times.len());
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some("write a smaller count".to_owned())));
    }
    Ok(times)
}

/// Reads `[solver]`: how a run of the duration `time` is carried out.
pub(crate) fn read_solver(root: &Table<'_>, time: &Read<Duration>) -> Read<Settings> {
    let kind = if moves_by_itself(root) { FORWARD_RUNS } else { "" };
    let forward_only = |key: &str| {
        SOLVER.is_of_a_kind(key).then(|| {
            let given = MotionKind::given();
            let why = format!("belongs to forward runs; along {given} the run chooses its steps");
            (RefusalKind::Rule, format!("`{key}` of [solver] {why}"))
        })
    };
    let nothing = Node::empty_table(&root.node.place);
    let field = root.get("solver");
    let node = field.as_ref().map_or(&nothing, |field| field.node);
    let table = Table::of_kind(root.ctx, node, "[solver]", (&SOLVER, kind), forward_only)?;
    // Where [time] is refused, what is wrong with [solver] is told all the same.
    let rows = RowTimes::Times(Vec::new().into());
    let Duration { end, rows } = time.clone().unwrap_or(Duration { end: 0.0, rows });
    let mut settings = Settings::new(end, rows);
    let read = table.fill(SOLVER_FIELDS, &mut settings);
    if table.get("memory_rtol").is_none() {
        settings.memory_rtol = (settings.rtol / MEMORY_SHARE).max(SMALLEST_MEMORY_RTOL);
    }
    let method = table.get("method").map(|field| method(&field)).transpose()?;
    if let Some(Steps::Chosen(adaptive)) = method {
        settings.adaptive = adaptive;
    }
    settings.fixed_step = fixed_step(&table, method)?;
    read.map(|()| settings)
}

/// Whether the motion follows from forces, as far as one can see before it is read.
fn moves_by_itself(root: &Table<'_>) -> bool {
    let kind = root.get("motion").and_then(|motion| motion.node.get("kind"));
    kind.is_some_and(|kind| kind.text() == Some(FORWARD_RUNS))
}

/// A method by who chooses its steps.
#[derive(Clone, Copy)]
enum Steps {
    Chosen(Adaptive),
    Alike(Method),
}

/// `step`, beside the method.
fn fixed_step(table: &Table<'_>, method: Option<Steps>) -> Read<Option<FixedStep>> {
    let alike = match method {
        Some(Steps::Alike(method)) => Some(method),
        _ => None,
    };
    match (alike, table.get("step")) {
        (None, None) => Ok(None),
        (None, Some(step)) => {
            let help = "add method = \"backward-euler\" or \"midpoint\", or leave step out".to_owned();
            let name = match method {
                Some(Steps::Chosen(adaptive)) => adaptive.name(),
                _ => None,
            };
            let who = name.map_or_else(|| "without one the run".to_owned(), |name| format!("{name:?}"));
            let message = format!("belongs to a fixed-step method; {who} chooses its steps");
            Err(step.refuse(RefusalKind::Rule, message, Some(help)))
        }
        (Some(_), None) => Err(table.missing("step", "step = \"1 ms\", as fixed-step methods need it")),
        (Some(method), Some(step)) => {
            for key in OF_CHOSEN_STEPS {
                if let Some(field) = table.get(key) {
                    let message = format!("has no effect with method = {:?}, whose steps are all alike", method.name());
                    return Err(field.refuse(RefusalKind::Rule, message, Some("leave it out".to_owned())));
                }
            }
            Ok(Some(FixedStep { method, step: step.quantity()? }))
        }
    }
}

/// The method by its name.
fn method(field: &Field<'_>) -> Read<Steps> {
    let name = field.text()?;
    if let Some(adaptive) = ADAPTIVE.into_iter().find(|adaptive| adaptive.name() == Some(name)) {
        return Ok(Steps::Chosen(adaptive));
    }
    if let Some(method) = FIXED.into_iter().find(|method| method.name() == name) {
        return Ok(Steps::Alike(method));
    }
    let names = FIXED.map(Method::name);
    let help = names::suggest(name, adaptive().chain(names));
    Err(field.refuse(RefusalKind::UnknownName, format!("names no method: {:?}", shorten(name)), Some(help)))
}
