//! Elements whose past is steady: the strokes of their period, once the plan has all else.

use crate::elements::past::PastPlan;
use crate::plan::Plan;
use crate::reader::{Context, Read};
use crate::text::refusal::RefusalKind;

/// Gives elements whose past is steady the strokes of their period.
pub(crate) fn settle(ctx: &Context<'_>, plan: &mut Plan) -> Read<()> {
    if !plan.elements.iter().any(|plan| matches!(plan.past, PastPlan::Steady { .. })) {
        return Ok(());
    }
    let (system, end) = (plan.system(), plan.settings.end);
    for (e, plan) in plan.elements.iter_mut().enumerate() {
        let PastPlan::Steady { period, place } = &plan.past else { continue };
        let name = &plan.element.name;
        let refuse = |why: String| {
            let message = format!("`past` of element {name:?} cannot be steady: {why}");
            let help = "write past = { held = \"30 s\" }, or run some periods first";
            ctx.refuse(place.refuse(RefusalKind::Rule, message).help(help))
        };
        let past = system.steady_past(e, *period, end).map_err(|error| refuse(error.to_string()))?;
        let settled = plan.element.clone().with_past(past);
        plan.element = settled.map_err(|error| refuse(format!("its law needs {error}")))?;
    }
    Ok(())
}
