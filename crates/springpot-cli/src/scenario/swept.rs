//! What is swept, in words.

use crate::terminal;
use springpot_run::numbers::count;
use springpot_scenario::Cases;

/// Values of a sweep that are printed.
const PRINTED: usize = 12;

/// Limits of joints that are named one by one.
pub(crate) const NAMED_LIMITS: usize = 10;

/// What a run is about to go through: a line for each sweep; nothing where nothing is swept.
pub(crate) fn lines(cases: &Cases, width: Option<usize>) -> String {
    (0..cases.axis_count()).map(|axis| terminal::hanging("sweep    ", &words(cases, axis), width)).collect()
}

/// `PATH = value, value, …`: paths that move together, and values as written, or `PATH, PATH: name, name, …`; of many the first ones and the
/// last.
pub(crate) fn words(cases: &Cases, axis: usize) -> String {
    let parameters: Vec<&str> = cases.axis_parameters(axis).collect();
    let moved = match cases.axis_names(axis) {
        Some(_) => format!("{}:", parameters.join(", ")),
        None => format!("{} =", parameters.join(" = ")),
    };
    format!("{moved} {}", values(cases, axis))
}

fn values(cases: &Cases, axis: usize) -> String {
    let len = cases.axis_len(axis);
    // A name with a comma would read as two.
    let label = |k: usize| match cases.axis_label(axis, k) {
        name if cases.axis_names(axis).is_some() && name.contains(',') => format!("{name:?}"),
        label => label,
    };
    if len <= PRINTED {
        return (0..len).map(label).collect::<Vec<_>>().join(", ");
    }
    let first: Vec<String> = (0..3).map(label).collect();
    format!("{}, …, {} ({len} values)", first.join(", "), label(len - 1))
}

/// `message` with the swept values of its case in front, where anything is swept.
pub(crate) fn in_case(cases: &Cases, index: usize, message: &str) -> String {
    let name = cases.name(index);
    if name.is_empty() { message.to_owned() } else { format!("{name}: {message}") }
}

/// `message` about the case `first` with its swept values in front, and how many others it holds for; as it is where
/// it holds for all that were looked at.
pub(crate) fn in_cases(cases: &Cases, looked_at: usize, first: usize, found: usize, message: &str) -> String {
    if found >= looked_at {
        message.to_owned()
    } else if found == 1 {
        in_case(cases, first, message)
    } else {
        let others = count(found - 1, "other case", "other cases");
        format!("{} and {others}: {message}", cases.name(first))
    }
}
