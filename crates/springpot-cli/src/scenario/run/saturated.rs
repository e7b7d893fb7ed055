//! Controllers that never leave their limits.

use crate::diagnostic;
use crate::scenario::swept::in_cases;
use springpot::model::Dimension;
use springpot_run::Finished;
use springpot_run::numbers::short;
use springpot_scenario::Remark;

/// A force that is its limit in every row has a root mean square of this share of it, but for rounding.
const WHOLE: f64 = 1.0 - 1e-9;

/// Says which joints have the largest force that their controller may give in every row, from the statistics of the columns.
pub(super) fn warn(Finished { cases, folder, outcome, .. }: &Finished) {
    let are_swept = cases.parameters().iter().any(|path| path.starts_with("motion.controller.limits"));
    let Some(plan) = cases.plan(0).ok().filter(|_| !are_swept) else { return };
    let Some((place, limits)) = plan.motion.force_limits() else { return };
    let Ok(mut summary) = csv::Reader::from_path(folder.path().join("summary.csv")) else { return };
    let lead = cases.parameters().len();
    let velocity_of = |joint: &str| {
        let names = plan.model.velocity_names();
        plan.model.joint_index(joint).map_or_else(|| joint.to_owned(), |j| names[j].clone())
    };
    // By joint: the cases in their order, as they are told.
    let mut found: Vec<(usize, Option<usize>)> = vec![(0, None); limits.len()];
    let mut told = vec![0; limits.len()];
    for row in summary.records().filter_map(Result::ok) {
        let text = |k: usize| row.get(lead + k).unwrap_or_default();
        let Some(joint) = text(0).strip_prefix("tau.") else { continue };
        let Some(at) = limits.iter().position(|(name, _)| velocity_of(name) == joint) else { continue };
        let rms: f64 = text(4).parse().unwrap_or(f64::NAN);
        if rms >= WHOLE * limits[at].1 {
            found[at].0 += 1;
            found[at].1.get_or_insert(told[at]);
        }
        told[at] += 1;
    }
    for ((joint, limit), (number, first)) in limits.iter().zip(found) {
        let Some(case) = first.and_then(|first| outcome.cases.get(first)) else { continue };
        let slides = plan
            .model
            .joint_index(joint)
            .is_some_and(|j| plan.model.joint_space(j).dimension() == Some(Dimension::Length));
        let unit = if slides { "N" } else { "N*m" };
        let joint = velocity_of(joint);
        let message = format!("tau.{joint} is at its limit, {} {unit}, in every row", short(*limit));
        let message = in_cases(cases, outcome.cases.len(), case.index, number, &message);
        diagnostic::remark(
            Remark::at(place, message)
                .help("nothing of the controller's law is seen then: are limit, gains and units as they are meant?"),
        );
    }
}
