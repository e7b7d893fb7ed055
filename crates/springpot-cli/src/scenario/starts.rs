//! What is said of a survey: starts that deserve a warning, and cases that cannot run.

use crate::diagnostic;
use crate::scenario::swept::{NAMED_LIMITS, in_case, in_cases};
use springpot_run::numbers::{count, short};
use springpot_run::sweep::CasesPassing;
use springpot_run::{ElementSurvey, Found, Survey};
use springpot_scenario::{Cases, Remark};

/// Prints warnings of elements that start far from their rest, or with an infinite force, and of runs shorter than a row.
pub(crate) fn warn(survey: &Survey, cases: &Cases) {
    for (index, remark) in &survey.warnings {
        let message = if *index == 0 { remark.message.clone() } else { in_case(cases, *index, &remark.message) };
        diagnostic::remark(Remark { message, ..remark.clone() });
    }
    let placed = |found: &Found, message: &str| in_cases(cases, survey.looked_at, found.index, found.cases, message);
    for ElementSurvey { name, unit, rest_key, large, singular, .. } in &survey.elements {
        if let Some(found) = large {
            let Found { start, rest_length, .. } = found;
            let message = format!(
                "element \"{name}\" starts with a stroke of {} m, more than 20 % of its rest length {} m",
                short(start.stroke),
                short(*rest_length)
            );
            let help = "look at rest_length and at the points of from and to, or at the start of the motion; \
                        rest_length = \"start\" makes x(0) = 0";
            diagnostic::warning(placed(found, &message), Some(help.into()));
        }
        if let Some(found) = singular {
            let what = match found.start.infinite {
                true => "its force is infinite at t = 0 and its energy is not known",
                false => "its energy is not known",
            };
            let message = format!(
                "element \"{name}\" starts with x(0) = {} {unit} and the Riemann-Liouville derivative: {what}",
                short(found.start.stroke)
            );
            let help = format!(
                "this says that it jumped there from x = 0; derivative = \"caputo\" says that it was held there before, \
                 past = {{ held = \"1 s\" }} for a while, {rest_key} = \"start\" that x(0) = 0"
            );
            diagnostic::warning(placed(found, &message), Some(help));
        }
    }
    if let Some([end, step]) = survey.short {
        let message =
            format!("the run ends at {} s, before a row is due: rows come every {} s", short(end), short(step));
        let help = "look at `end` and `output_step` of [time]: are they swapped?";
        diagnostic::warning(message, Some(help.into()));
    }
}

/// Prints warnings of joints that start beyond their limits.
pub(crate) fn warn_of_limits(survey: &Survey, cases: &Cases) {
    let passing = survey.limits.passing();
    for CasesPassing { passed, case, cases: found } in passing.iter().take(NAMED_LIMITS) {
        diagnostic::warning(in_cases(cases, survey.looked_at, *case, *found, &passed.to_string()), None);
    }
    if let Some(more @ 1..) = passing.len().checked_sub(NAMED_LIMITS) {
        let more = count(more, "more limit of a joint is", "more limits of joints are");
        diagnostic::warning(format!("{more} passed at the start"), None);
    }
}
