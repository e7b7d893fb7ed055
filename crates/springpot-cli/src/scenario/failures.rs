//! Cases that fail: those that say the same are one message, with its place and its cure.

use crate::diagnostic;
use crate::scenario::swept::in_cases;
use springpot_run::numbers::count;
use springpot_run::{Survey, Trouble};
use springpot_scenario::Cases;

/// Failures that are told one by one.
const NAMED: usize = 5;

/// Prints the failures of a survey.
pub(crate) fn tell(survey: &Survey, cases: &Cases) {
    let failures: Vec<(usize, &Trouble)> = survey.failures.iter().map(|(index, trouble)| (*index, trouble)).collect();
    tell_all(&failures, survey.looked_at, cases);
    if failures.len() > 1 {
        diagnostic::error(format!("{} of the {} cases looked at cannot run", failures.len(), survey.looked_at));
    }
}

/// Prints failures of cases, `looked_at` in all.
pub(crate) fn tell_all(failures: &[(usize, &Trouble)], looked_at: usize, cases: &Cases) {
    let mut groups: Vec<(usize, &Trouble, usize)> = Vec::new();
    for (index, trouble) in failures {
        match groups.iter_mut().find(|(_, first, _)| is_alike(first, trouble)) {
            Some((.., number)) => *number += 1,
            None => groups.push((*index, trouble, 1)),
        }
    }
    for (index, trouble, number) in groups.iter().take(NAMED) {
        let message = in_cases(cases, looked_at, *index, *number, &trouble.message);
        if let Some(place) = &trouble.at {
            diagnostic::error_at(place, message, trouble.help.clone());
            continue;
        }
        match (&trouble.place, &trouble.help) {
            (Some(place), Some(help)) => diagnostic::error_with_help(message, format!("{place}: {help}")),
            (Some(place), None) => diagnostic::error_with_help(message, format!("look at {place}")),
            (None, Some(help)) => diagnostic::error_with_help(message, help.clone()),
            (None, None) => diagnostic::error(message),
        }
    }
    let left: usize = groups.iter().skip(NAMED).map(|(.., number)| number).sum();
    if left > 0 {
        diagnostic::error(format!("{} failed; run.json says which and why", count(left, "more case", "more cases")));
    }
}

/// Whether two say the same but for their numbers.
fn is_alike(one: &Trouble, other: &Trouble) -> bool {
    let words =
        |text: &str| text.chars().filter(|c| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+'))).collect::<String>();
    words(&one.message) == words(&other.message)
}
