//! Feedback: torques and inputs as expressions of the state.
//!
//! Signals are read before all elements are known, so that an expression that names what is seen of the state is kept as it is written
//! ([`read`]) and read when the plan is whole ([`settle`]).

use crate::keys::SIGNAL;
use crate::plan::{Plan, SignalPlan};
use crate::reader::{Context, Field, Read, Refused, all};
use crate::signals::of_time::{self, Wanted};
use crate::text::document::{Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind, Remark};
use crate::units;
use springpot::control::{Control, Feedback, InputFeedback, Sampling, Sense, TorqueFeedback};
use springpot::law::Range;
use springpot::observe::Axis;
use springpot::signal::expression::{ExpressionError, is_of_module};
use springpot::signal::{ColumnExpression, Signal};
use springpot::system::Settings;

/// Feedback as it is written.
#[derive(Debug, Clone)]
pub(crate) struct FeedbackText {
    /// The text of the expression.
    node: Node,
    /// What it is, for messages.
    owner: String,
    /// What makes it SI.
    scale: f64,
    offset: f64,
    /// Time between two samples, s.
    sample: Option<f64>,
}

const MAY_NAME: &str = "feedback may name q.JOINT, v.JOINT, ELEMENT.length, .stroke, .rate and gripper.x, .vx";

/// A column that only some runs have.
const GRIPPER_ERROR: &str = "gripper.error";

/// What follows the name of an element or of the gripper in what feedback may see.
const OF_ELEMENT: [&str; 3] = ["length", "stroke", "rate"];
const OF_FORCES: [&str; 2] = ["force", "derivative"];
const OF_GRIPPER: [(&str, Sense); 6] = [
    ("x", Sense::Gripper(Axis::X)),
    ("y", Sense::Gripper(Axis::Y)),
    ("z", Sense::Gripper(Axis::Z)),
    ("vx", Sense::GripperVelocity(Axis::X)),
    ("vy", Sense::GripperVelocity(Axis::Y)),
    ("vz", Sense::GripperVelocity(Axis::Z)),
];

/// A signal, or feedback in its place.
pub(crate) fn read(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    match &field.node.value {
        Value::Text(text) if names_state(text) => {
            let text = FeedbackText {
                node: field.node.clone(),
                owner: field.to_string(),
                scale: 1.0,
                offset: 0.0,
                sample: None,
            };
            Ok(in_place_of_signal(field, wanted.range, text))
        }
        Value::Table(_) if field.node.get("expression").is_some() => {
            let sampled = field.node.get("sample").is_some();
            let text = field.node.get("expression").and_then(|node| node.text());
            if sampled || text.is_some_and(names_state) { table(field, wanted) } else { of_time::read(field, wanted) }
        }
        _ => of_time::read(field, wanted),
    }
}

/// A signal where the state may not stand.
pub(crate) fn read_of_time(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let node = field.node.get("expression").map_or(field.node, |node| node);
    match node.text() {
        Some(text) if names_state(text) && units::split_quantity(text).is_none() => {
            let message = format!("{field} follows from the state, but has to be a signal of t");
            let help = "feedback may stand in the inputs of elements and the torques of joints of one degree, where motion.kind = \"forward\"";
            Err(field.ctx.refuse(node.place.refuse(RefusalKind::Rule, message).help(help)))
        }
        _ => of_time::read(field, wanted),
    }
}

fn table(field: &Field<'_>, wanted: Wanted<'_>) -> Read<SignalPlan> {
    let table = field.table(&SIGNAL)?;
    let of_csv = ["csv", "column", "time", "time_unit", "separator", "outside"];
    if let Some(field) = of_csv.into_iter().find_map(|key| table.get(key)) {
        return Err(field.refuse(RefusalKind::UnknownKey, "stands beside feedback, which is an expression", None));
    }
    let expression = table.require("expression")?;
    expression.text()?;
    let unit = table.get("unit");
    let unit = unit.map(|unit| of_time::in_unit(&unit, Signal::constant(1.0), wanted.unit).map(|one| (unit, one)));
    let (scale, offset) = match unit.transpose()? {
        None => (1.0, 0.0),
        Some((unit, one)) => {
            let zero = of_time::in_unit(&unit, Signal::constant(0.0), wanted.unit)?.value(0.0);
            (one.value(0.0) - zero, zero)
        }
    };
    let sample = table.get("sample").map(|field| field.quantity()).transpose()?;
    let text = FeedbackText { node: expression.node.clone(), owner: field.to_string(), scale, offset, sample };
    Ok(in_place_of_signal(field, wanted.range, text))
}

/// What a temperature is before the first sample, K: its range has no 0.
const ROOM: f64 = 293.15;

/// The signal counts for nothing, but before the first sample; it must be one that its place takes.
fn in_place_of_signal(field: &Field<'_>, range: Range, text: FeedbackText) -> SignalPlan {
    let before = if range.low > 0.0 { ROOM } else { 0.0 };
    SignalPlan {
        signal: Signal::constant(before.clamp(range.low, range.high)),
        constant: None,
        written: field.node.place.text().to_owned(),
        place: field.node.place.clone(),
        feedback: Some(text.into()),
    }
}

/// Whether a text has a name with a dot in it, which only what is seen of the state has.
fn names_state(text: &str) -> bool {
    let bytes = text.as_bytes();
    let is_part = |c: u8| c.is_ascii_alphanumeric() || c == b'_' || c >= 0x80;
    text.match_indices('.').any(|(at, _)| {
        let follows = bytes.get(at + 1).is_some_and(|c| c.is_ascii_alphabetic() || *c == b'_' || *c >= 0x80);
        let start = bytes[..at].iter().rposition(|c| !is_part(*c)).map_or(0, |before| before + 1);
        let after = &text[at + 1..];
        let word = &after[..after.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(after.len())];
        let is_number = bytes.get(start).is_none_or(|c| c.is_ascii_digit()) || start == at;
        let is_of_module = is_of_module(&text[start..at + 1 + word.len()]);
        follows && !is_of_module && (!is_number || OF_ELEMENT.contains(&word) || OF_FORCES.contains(&word))
    })
}

/// Everything that feedback may see of a plan, by name.
fn senses(plan: &Plan) -> Vec<(String, Sense)> {
    let mut senses = Vec::new();
    let model = &plan.model;
    for j in model.own_joints() {
        let (velocity, name, rate) = (model.v_range(j).start, &model.joint_names()[j], &model.velocity_names()[j]);
        let Some(place) = model.coordinate_of(velocity) else { continue };
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

/// The torques of a motion that are feedback, by velocity.
pub(crate) type TorqueTexts = Vec<(usize, std::sync::Arc<FeedbackText>)>;

#[cfg(test)]
mod tests {
    use super::names_state;

    #[test]
    fn names_with_dots_are_of_the_state() {
        for text in
            ["q.q1", "2*strut.rate", "-gripper.vx*3", "strut-2.force", "1.5*a_b.stroke", "strut.rat", "x+µ.rate"]
        {
            assert!(names_state(text), "{text}");
        }
        for text in ["1.5*t", "sin(2.*t)", "1.e5", "t-1.e5", ".5", "t*.5", "3.", "0.1*sin(8*t)", "20*np.sin(2*np.pi*t)"]
        {
            assert!(!names_state(text), "{text}");
        }
    }
}
