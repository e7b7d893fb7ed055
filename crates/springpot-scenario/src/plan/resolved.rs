//! The plan as JSON, for the record of a run.

use crate::elements::heat;
use crate::elements::plan::{ElementPlan, FramePlan, ShapePlan};
use crate::figures::FigurePlan;
use crate::keys::{ELEMENT_FIELDS, SOLVER_FIELDS, record};
use crate::plan::Plan;
use crate::robot::described::{DescriptionPlan, EndStops};
use crate::signals::plan::SignalPlan;
use serde_json::{Map, Value, json};
use springpot::model::{Anchor, BodySpec, FrictionLaw, JointSpec, Limits, Mimic, Parent};
use springpot::system::RowTimes;

/// Most output times that are listed one by one.
const LISTED_TIMES: usize = 10_000;

impl Plan {
    /// Everything the run depends on, defaults filled in: numbers in SI, signals that vary as they were written.
    pub fn resolved(&self) -> Value {
        let mut time = json!({ "end": self.settings.end, "rows": self.settings.rows.count() });
        match &self.settings.rows {
            RowTimes::Step { step, .. } => time["output_step"] = json!(step),
            RowTimes::Times(times) if times.len() <= LISTED_TIMES => time["output_times"] = json!(times[..]),
            RowTimes::Times(times) => {
                time["output_times"] = json!(format!("{} times", times.len()));
            }
        }
        let mut resolved = json!({
            "title": self.title,
            "gravity": self.gravity,
            "urdf": self.urdf.as_ref().map(urdf),
            "bodies": self.bodies.iter().map(|body| self.body(body)).collect::<Vec<_>>(),
            "gripper": self.gripper.as_ref().map(|gripper| self.anchor(&gripper.anchor)),
            "elements": self.resolved_elements(),
            "motion": self.motion.resolved(),
            "time": time,
            "solver": self.solver(),
            "figures": self.output.figures.iter().map(FigurePlan::record).collect::<Vec<_>>(),
            "columns": self.output.columns.as_ref().map(|globs| globs.iter().map(|glob| &glob.text).collect::<Vec<_>>()),
        });
        if let Some(EndStops { stiffness, damping }) = self.end_stops {
            resolved["limits"] = json!({ "stiffness": stiffness, "damping": damping });
        }
        if !self.events.is_empty() {
            resolved["events"] = self.events.iter().map(|plan| plan.record.clone()).collect();
        }
        if !self.metrics.is_empty() {
            resolved["metrics"] = self.metrics.iter().map(|plan| json!(plan.metric)).collect();
        }
        resolved
    }

    /// All elements; only those that are not enabled say so.
    fn resolved_elements(&self) -> Vec<Value> {
        let mut elements: Vec<Value> = self.elements.iter().map(|plan| self.element(plan)).collect();
        for (place, plan) in &self.absent {
            let mut element = self.element(plan);
            element["enabled"] = json!(false);
            elements.insert(*place, element);
        }
        elements
    }

    /// The keys of `[solver]`.
    fn solver(&self) -> Value {
        let mut solver = record(SOLVER_FIELDS, &self.settings);
        let fixed_step = self.settings.fixed_step;
        solver.insert("method".to_owned(), json!(self.method()));
        solver.insert("step".to_owned(), json!(fixed_step.map(|by| by.step)));
        solver.into()
    }

    /// The method of forward dynamics, unless the run chooses it.
    fn method(&self) -> Option<&'static str> {
        let fixed = self.settings.fixed_step.map(|by| by.method.name());
        self.motion.is_forward().then(|| fixed.or(self.settings.adaptive.name()))?
    }

    fn body_name(&self, body: Parent) -> &str {
        match body {
            Parent::World => "world",
            Parent::Body(index) => self.bodies.get(index).map_or("", |body| body.name.as_str()),
        }
    }

    fn anchor(&self, anchor: &Anchor) -> Value {
        json!({ "body": self.body_name(anchor.body), "point": anchor.point })
    }

    fn body(&self, body: &BodySpec) -> Value {
        let joint = &body.joint;
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = body.inertia;
        json!({
            "name": body.name,
            "parent": self.body_name(body.parent),
            "joint": described(joint),
            "mass": body.mass,
            "com": body.com,
            "inertia": { "xx": xx, "yy": yy, "zz": zz, "xy": xy, "xz": xz, "yz": yz },
        })
    }

    fn element(&self, plan: &ElementPlan) -> Value {
        let ElementPlan { element, shape, is_network, files, parameters, inputs, .. } = plan;
        let mut values = Map::new();
        for (param, value) in element.entry.params.iter().zip(parameters) {
            match param.name.rsplit_once('.') {
                None => _ = values.insert(param.name.to_string(), json!(value)),
                Some((list, _)) => {
                    let list = values.entry(list).or_insert_with(|| json!([]));
                    list.as_array_mut().expect("made as one").push(json!(value));
                }
            }
        }
        values.extend(files.iter().map(|(name, file)| (name.clone(), json!(file))));
        let inputs: Map<String, Value> =
            element.entry.inputs.iter().zip(inputs).map(|(i, s)| (i.name.to_string(), s.record())).collect();
        let mut value = match shape {
            ShapePlan::Points(points) => {
                let [from, via @ .., to] = &points[..] else { unreachable!("two ends") };
                let mut ends = json!({ "from": self.anchor(from), "to": self.anchor(to) });
                if !via.is_empty() {
                    ends["via"] = via.iter().map(|point| self.anchor(point)).collect();
                }
                if let Value::Object(ends) = &mut ends {
                    ends.extend(record(ELEMENT_FIELDS, element));
                }
                ends
            }
            ShapePlan::Joint(joint) => json!({ "joint": joint, "rest": element.rest }),
            ShapePlan::Bushing { from, to, component } => {
                let frame = |frame: &FramePlan| {
                    let mut value = self.anchor(&frame.anchor);
                    value["rpy"] = json!(frame.rpy);
                    value
                };
                let (from, to) = (frame(from), frame(to));
                json!({ "bushing": component.name(), "from": from, "to": to, "rest": element.rest })
            }
        };
        let others = json!({
            "name": element.name,
            (if *is_network { "network" } else { "law" }): element.entry.name,
            "parameters": values,
            "inputs": inputs,
            "derivative": element.derivative.name(),
            "scheme": element.scheme.map_or_else(|| "exact".into(), |scheme| scheme.to_string()),
        });
        if let (Value::Object(value), Value::Object(others)) = (&mut value, others) {
            value.extend(others);
            value.extend(plan.past.record().map(|past| ("past".to_owned(), past)));
            value.extend(element.law.as_heated().map(|heated| heat::record(heated.heat())).unwrap_or_default());
        }
        value
    }
}

fn urdf(plan: &DescriptionPlan) -> Value {
    json!({
        "file": plan.written,
        "robot": plan.robot.name,
        "root": plan.robot.root.name,
        "floating_base": plan.robot.floating_base,
        "ignore_mimic": plan.ignore_mimic,
        "accept_inertia": plan.robot.accept_inertia,
        "package_path": plan.package_path,
    })
}

fn described(joint: &JointSpec) -> Value {
    let mut value = json!({
        "name": joint.name,
        "kind": joint.kind.name(),
        "axis": joint.axis,
        "origin": joint.origin,
        "rpy": joint.rpy,
        "damping": by_coordinate(joint, |k| json!(joint.damping[k])),
        "friction": by_coordinate(joint, |k| friction(joint.friction[k], joint.friction_law[k])),
        "armature": by_coordinate(joint, |k| json!(joint.armature[k])),
        "limits": by_coordinate(joint, |k| limits(&joint.limits[k])),
        "mimic": joint.mimic.as_ref().map(|Mimic { joint, multiplier, offset }| {
            json!({ "joint": joint, "multiplier": multiplier, "offset": offset })
        }),
    });
    if joint.kind.has_axis2() {
        value["axis2"] = json!(joint.axis2);
    }
    if joint.kind.has_lead() {
        value["lead"] = json!(joint.lead);
    }
    value
}

/// One value, or of a joint of several coordinates one for each.
fn by_coordinate(joint: &JointSpec, of: impl Fn(usize) -> Value) -> Value {
    if joint.kind.numbers().count() < 2 {
        return of(0);
    }
    let each = joint.kind.numbers().enumerate();
    each.map(|(k, (name, _))| (name.to_owned(), of(k))).collect::<Map<_, _>>().into()
}

/// Force, speed of a smooth law, and whether it sticks.
fn friction(force: f64, law: FrictionLaw) -> Value {
    let (speed, stick) = match law {
        FrictionLaw::Smooth { speed } => (Some(speed), false),
        FrictionLaw::Sticking => (None, true),
    };
    json!({ "force": force, "speed": speed, "stick": stick })
}

/// The limits that there are.
fn limits(limits: &Limits) -> Value {
    let Limits { lower, upper, velocity, effort } = *limits;
    let all = [("lower", lower), ("upper", upper), ("velocity", velocity), ("effort", effort)];
    all.into_iter()
        .filter(|(_, limit)| limit.is_finite())
        .map(|(name, limit)| (name.to_owned(), json!(limit)))
        .collect()
}

impl SignalPlan {
    /// A number in SI, or what varies as it was written.
    pub(crate) fn record(&self) -> Value {
        self.constant.map_or_else(|| json!(self.written), |value| json!(value))
    }
}
