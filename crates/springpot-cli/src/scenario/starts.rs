//! What is said of a survey: starts that deserve a warning, and cases that cannot run.

use crate::scenario::swept::{NAMED_LIMITS, in_case, in_cases};
use springpot_run::numbers::{count, short};
use springpot_run::sweep::CasesPassing;
use springpot_run::{ElementSurvey, Found, Survey};
use springpot_scenario::{Cases, Remark};

/// Warnings of elements that start far from their rest, or with an infinite force, and of runs shorter than a row.
pub(crate) fn remarks(survey: &Survey, cases: &Cases) -> Vec<Remark> {
    let named = |(index, remark): &(usize, Remark)| {
        let message = if *index == 0 { remark.message.clone() } else { in_case(cases, *index, &remark.message) };
        Remark { message, ..remark.clone() }
    };
    let mut remarks: Vec<Remark> = survey.warnings.iter().map(named).collect();
    let mut say = |message: String, help: String| remarks.push(Remark { message, place: None, help: Some(help) });
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
            say(placed(found, &message), help.to_owned());
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
            say(placed(found, &message), help);
        }
    }
    if let Some([end, step]) = survey.short {
        let message =
            format!("the run ends at {} s, before a row is due: rows come every {} s", short(end), short(step));
        let help = "look at `end` and `output_step` of [time]: are they swapped?";
        say(message, help.to_owned());
    }
    remarks
}

/// Warnings of joints that start beyond their limits.
pub(crate) fn of_limits(survey: &Survey, cases: &Cases) -> Vec<Remark> {
    let passing = survey.limits.passing();
    let said = |message| Remark { message, place: None, help: None };
    let named = passing.iter().take(NAMED_LIMITS).map(|CasesPassing { passed, case, cases: found }| {
        said(in_cases(cases, survey.looked_at, *case, *found, &passed.to_string()))
    });
    let mut remarks: Vec<Remark> = named.collect();
    if let Some(more @ 1..) = passing.len().checked_sub(NAMED_LIMITS) {
        let more = count(more, "more limit of a joint is", "more limits of joints are");
        remarks.push(said(format!("{more} passed at the start")));
    }
    remarks
}
