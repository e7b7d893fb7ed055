//! What follows from the state: feedback of a plan that has all else.

use crate::plan::Plan;
use crate::reader::{Context, Read, Refused, all};
use crate::signals::feedback::{OF_ELEMENT, OF_FORCES};
use crate::signals::plan::FeedbackText;
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind, Remark};
use springpot::control::{Control, Feedback, InputFeedback, Sampling, Sense, TorqueFeedback};
use springpot::model::Dimension;
use springpot::observe::Axis;
use springpot::signal::ColumnExpression;
use springpot::signal::expression::ExpressionError;
use springpot::system::Settings;

const MAY_NAME: &str = "feedback may name q.JOINT, v.JOINT, ELEMENT.length, .stroke, .rate and gripper.x, .vx";

/// A column that only some runs have.
const GRIPPER_ERROR: &str = "gripper.error";

const OF_GRIPPER: [(&str, Sense); 6] = [
    ("x", Sense::Gripper(Axis::X)),
    ("y", Sense::Gripper(Axis::Y)),
    ("z", Sense::Gripper(Axis::Z)),
    ("vx", Sense::GripperVelocity(Axis::X)),
    ("vy", Sense::GripperVelocity(Axis::Y)),
    ("vz", Sense::GripperVelocity(Axis::Z)),
];

/// Everything that feedback may see of a plan, by name.
pub(crate) fn senses(plan: &Plan) -> Vec<(String, Sense)> {
    let mut senses = Vec::new();
    let model = &plan.model;
    let (q_labels, v_labels) = (model.q_labels(), model.v_labels());
    for j in model.own_joints() {
        let (velocity, name, rate) = (model.v_range(j).start, &model.joint_names()[j], &model.velocity_names()[j]);
        let Some(place) = model.coordinate_of(velocity) else {
            let coordinates = model.q_range(j).map(|place| (place, Sense::Part { place, joint: j }));
            senses.extend(coordinates.map(|(place, sense)| (format!("q.{}", q_labels[place].name), sense)));
            for k in model.v_range(j) {
                let rate = &v_labels[k].name;
                senses
                    .extend([(format!("v.{rate}"), Sense::Velocity(k)), (format!("a.{rate}"), Sense::Acceleration(k))]);
            }
            continue;
        };
        senses.push((format!("q.{name}"), Sense::Coordinate { place, velocity }));
        senses.push((format!("v.{rate}"), Sense::Velocity(velocity)));
        senses.push((format!("a.{rate}"), Sense::Acceleration(velocity)));
    }
    for (e, plan) in plan.elements.iter().enumerate() {
        let made = [Sense::Length(e), Sense::Stroke(e), Sense::Rate(e), Sense::Force(e), Sense::Derivative(e)];
        let words = OF_ELEMENT.into_iter().chain(OF_FORCES);
        senses.extend(words.zip(made).map(|(word, sense)| (format!("{}.{word}", plan.element.name), sense)));
    }
    if plan.gripper.is_some() {
        senses.extend(OF_GRIPPER.into_iter().map(|(word, sense)| (format!("gripper.{word}"), sense)));
    }
    senses
}

/// Reads all feedback of a plan that has all else.
pub(crate) fn settle(ctx: &Context<'_>, plan: &Plan) -> Read<Control> {
    let inputs = plan.elements.iter().enumerate().flat_map(|(element, plan)| {
        let inputs = plan.inputs.iter().enumerate();
        inputs.filter_map(move |(input, plan)| Some(((element, input), plan.feedback.as_deref()?)))
    });
    let inputs: Vec<_> = inputs.collect();
    let torques = plan.motion.feedback();
    if let Some((place, period)) = plan.motion.controller_sample() {
        check_sample(ctx, place, "[motion.controller]", period, &plan.settings)?;
    }
    if inputs.is_empty() && torques.is_empty() {
        return Ok(Control::default());
    }
    if let (false, Some((_, text))) = (plan.motion.is_forward(), inputs.first()) {
        let message = format!("{} follows from the state, but the motion is given in advance", text.owner);
        let help = "write a signal, or motion.kind = \"forward\": where the motion follows from forces, these may follow from it";
        return Err(ctx.refuse(text.node.place.refuse(RefusalKind::Rule, message).help(help)));
    }
    let senses = senses(plan);
    let inputs = all(inputs.into_iter().map(|((element, input), text)| {
        let (law, sampling) = text.made(ctx, plan, &senses)?;
        if plan.elements[element].element.law.stretched_by() == Some(input) {
            text.check_stretch(ctx, &law, &plan.settings)?;
        }
        Ok(InputFeedback { element, input, law, sampling })
    }));
    let torques = all(torques.iter().map(|(velocity, text)| {
        let (law, sampling) = text.made(ctx, plan, &senses)?;
        Ok(TorqueFeedback { velocity: *velocity, law, sampling })
    }));
    let (torques, inputs) = (torques?, inputs?);
    let texts = plan.elements.iter().flat_map(|plan| &plan.inputs).filter_map(|input| input.feedback.as_deref());
    for text in texts.chain(plan.motion.feedback().iter().map(|(_, text)| &**text)) {
        if let Some(period) = text.sample {
            check_sample(ctx, &text.node.place, &text.owner, period, &plan.settings)?;
        }
    }
    Ok(Control { torques, inputs, controller: None })
}

/// Refuses samples that are due inside steps of one size, and more of them than a run may take steps.
fn check_sample(ctx: &Context<'_>, place: &Place, what: &str, period: f64, settings: &Settings) -> Read<()> {
    let times = settings.end / period;
    let limit = settings.max_steps.unwrap_or(Settings::MOST_STEPS);
    let (message, help) = match settings.fixed_step {
        _ if times > limit as f64 => (
            format!(
                "{what} is sampled every {period:e} s: {times:.1e} times until time.end, and a run takes at most {limit} steps"
            ),
            "write a longer `sample`, or raise solver.max_steps".to_owned(),
        ),
        Some(fixed) if !is_whole(period / fixed.step) => (
            format!("{what} is sampled every {period} s, which is no whole number of steps of {} s", fixed.step),
            "steps of one size know the state at their ends alone: make `sample` a multiple of solver.step".to_owned(),
        ),
        _ => {
            if period > settings.end {
                let message = format!("{what} is sampled every {period} s, and the run ends at {} s", settings.end);
                let help = "it stays what it is at t = 0: write a shorter `sample`, or a later time.end";
                ctx.warn(Remark::at(place, message).help(help));
            }
            return Ok(());
        }
    };
    Err(ctx.refuse(place.refuse(RefusalKind::Rule, message).help(help)))
}

fn is_whole(ratio: f64) -> bool {
    let count = ratio.round();
    count >= 1.0 && (ratio - count).abs() <= 1e-9 * count
}

impl FeedbackText {
    fn made(&self, ctx: &Context<'_>, plan: &Plan, senses: &[(String, Sense)]) -> Read<(Feedback, Option<Sampling>)> {
        let text = self.node.text().unwrap_or_default();
        let names: Vec<&str> = senses.iter().map(|(name, _)| name.as_str()).collect();
        let expression = ColumnExpression::parse(text, &ctx.constants(), &names).map_err(|error| {
            let (what, help) = match &error {
                ExpressionError::UnknownName { name, suggestion, .. } => {
                    let what = self.of_unknown(name, suggestion.as_deref(), plan, senses);
                    what.unwrap_or_else(|| (error.to_string(), MAY_NAME.to_owned()))
                }
                _ => (error.to_string(), "write an expression of t and of the state, such as \"-5*v.q1\"".to_owned()),
            };
            let place = self.node.place_in_text(error.span());
            ctx.refuse(place.refuse(RefusalKind::BadQuantity, format!("{}: {what}", self.owner)).help(help))
        })?;
        let seen: Vec<Sense> = expression.columns().iter().map(|&k| senses[k].1).collect();
        if self.sample.is_none()
            && let Some(k) = seen.iter().position(|sense| sense.follows_from_forces())
        {
            return Err(self.not_known_yet(ctx, names[expression.columns()[k]]));
        }
        let jumps = |sense: &Sense| match *sense {
            Sense::Part { place, .. } => plan.model.q_labels()[place].dimension == Dimension::Quaternion,
            _ => false,
        };
        if self.sample.is_none()
            && let Some(k) = seen.iter().position(jumps)
        {
            let name = names[expression.columns()[k]];
            let message = format!("{}: {name} changes its sign where the joint is half a turn away from 0", self.owner);
            let help = "sample it, { expression = …, unit = …, sample = \"1 ms\" }, or let the torque follow from velocities and from elements";
            let at = text.find(name).map(|start| start..start + name.len());
            return Err(ctx.refuse(self.node.place_in_text(at).refuse(RefusalKind::Rule, message).help(help)));
        }
        let law = Feedback::new(expression, seen).scaled(self.scale, self.offset);
        Ok((law, self.sample.map(|period| Sampling { period, delay: 0 })))
    }

    /// A temperature that stretches an element is felt by how fast it changes, which must be known, and never jumps.
    fn check_stretch(&self, ctx: &Context<'_>, law: &Feedback, settings: &Settings) -> Read<()> {
        let unknown = law.senses().iter().any(|sense| !sense.is_place());
        let (why, help) = if self.sample.is_some() {
            ("a sampled temperature jumps", "write it without `sample`, or the element without `expansion`")
        } else if settings.fixed_step.is_some() {
            (
                "steps of one size hold it over each step, so that it jumps",
                "leave solver.method out, or the element's `expansion`",
            )
        } else if unknown {
            (
                "where it follows from velocities, how fast it changes follows from the forces, of which the element's is one",
                "let it follow from places (q.JOINT, ELEMENT.stroke, ELEMENT.length, gripper.x) and t alone",
            )
        } else {
            return Ok(());
        };
        let message = format!("{} stretches its element by `expansion`: {why}", self.owner);
        Err(ctx.refuse(self.node.place.refuse(RefusalKind::Rule, message).help(help)))
    }

    /// What to say of a name that is none of the state; nothing where `suggestion`, what is most like it, may stand here.
    fn of_unknown(
        &self,
        name: &str,
        suggestion: Option<&str>,
        plan: &Plan,
        senses: &[(String, Sense)],
    ) -> Option<(String, String)> {
        let is_known = |sense: &Sense| self.sample.is_some() || !sense.follows_from_forces();
        let known = senses.iter().filter(|(_, sense)| is_known(sense)).map(|(name, _)| name.as_str());
        if plan.lacks(name) {
            let what = format!("{name} is of an element that is not enabled");
            return Some((what, "enable it, or leave it out of the expression".to_owned()));
        }
        let columns = || plan.observables().with_leaves().with_joint_losses().columns();
        if name == GRIPPER_ERROR || name.starts_with("energy.") || columns().iter().any(|column| column.name == name) {
            let what = format!("{name} is a column of the results, but no part of the state");
            return Some((what, format!("feedback may name {}", names::list(known))));
        }
        let unknown = format!("unknown name `{name}`");
        if let Some(help) =
            names::inside(name, senses.iter().filter(|(_, sense)| is_known(sense)).map(|(name, _)| name.as_str()))
        {
            return Some((unknown, help));
        }
        match suggestion.or_else(|| names::nearest(name, senses.iter().map(|(name, _)| name.as_str()))) {
            Some(right) if senses.iter().any(|(name, sense)| name == right && !is_known(sense)) => {
                let help = format!(
                    "did you mean `{right}`? it follows from the forces, so that feedback on it needs a `sample`"
                );
                Some((unknown, help))
            }
            Some(_) if suggestion.is_some() => None,
            _ => Some((unknown, names::suggest(name, known))),
        }
    }

    /// An algebraic loop: what the expression says would be a part of what it sees.
    fn not_known_yet(&self, ctx: &Context<'_>, name: &str) -> Refused {
        let text = self.node.text().unwrap_or_default();
        let at = text.find(name).map(|start| start..start + name.len());
        let message = format!("{}: {name} follows from the forces, of which this is one", self.owner);
        let help = format!(
            "sample it: {{ expression = \"{}\", unit = \"…\", sample = \"1 ms\" }} sees what was just before",
            shorten(text)
        );
        ctx.refuse(self.node.place_in_text(at).refuse(RefusalKind::Rule, message).help(help))
    }
}
