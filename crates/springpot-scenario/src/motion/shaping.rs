//! Filter, weights, feed-forward and measurement of `[motion.controller]`.

use super::controller::{Joints, by_joint};
use crate::keys::{MEASUREMENT, NOISE};
use crate::reader::{Field, Read, Table, all};
use crate::robot::OwnJoint;
use crate::signals::feedback;
use crate::signals::of_time::Wanted;
use crate::text::refusal::RefusalKind;
use serde_json::{Map, Value, json};
use springpot::control::{Measurement, Sampling, Shaping};
use springpot::law::Range;
use springpot::signal::Signal;

/// What lies between the errors of a controller and its law; `record` takes what was read.
pub(super) fn shaping(table: &Table<'_>, joints: &Joints<'_>, record: &mut Map<String, Value>) -> Read<Shaping> {
    let filter = table.get("filter").map(|field| field.quantity()).transpose();
    let derived = table.get("derivative_on").map(|field| field.word("rule")).transpose();
    let set_point = table.get("set_point_weight").map(|_| {
        by_joint(table, "set_point_weight", joints, 1.0, &|field, _, _| {
            let value = field.number("")?;
            if value >= 0.0 {
                return Ok(value);
            }
            let message = format!("is {value}, but a weight is not negative");
            Err(field.refuse(RefusalKind::OutOfRange, message, Some("write a number from 0 to 1".to_owned())))
        })
    });
    let (filter, derived, set_point) = (filter?, derived?, set_point.transpose()?.unwrap_or_default());
    if let Some(time) = filter {
        record.insert("filter".to_owned(), json!(time));
    }
    if let Some(word) = derived {
        record.insert("derivative_on".to_owned(), json!(word));
    }
    if !set_point.is_empty() {
        list(record, "set_point_weight", joints, &set_point);
    }
    let is_plain = set_point.iter().all(|weight| *weight == 1.0);
    let set_point = if is_plain { Vec::new() } else { set_point };
    Ok(Shaping { set_point, on_measurement: derived == Some(MEASUREMENT), filter })
}

/// Forces that are added to those of the law: velocities and functions of time.
pub(super) fn feed_forward(
    table: &Table<'_>,
    joints: &Joints<'_>,
    end: Option<f64>,
    record: &mut Map<String, Value>,
) -> Read<Vec<(usize, Signal)>> {
    let Some(field) = table.get("feed_forward") else { return Ok(Vec::new()) };
    let given = joints.open(&field)?;
    let driven: Vec<_> = joints.driven().collect();
    let given = driven.iter().filter_map(|(k, joint)| Some((*k, joint, given.get(joint)?)));
    let read = all(given.map(|(k, joint, field)| {
        let unit = joint.units().map_or("", |units| units.force);
        let plan = feedback::read_of_time(&field, Wanted { unit, range: Range::ANY, smooth: false, end })?;
        Ok((k, joint.name.to_owned(), plan))
    }))?;
    let listed: Map<_, _> = read.iter().map(|(_, name, plan)| (name.clone(), plan.record())).collect();
    record.insert("feed_forward".to_owned(), listed.into());
    Ok(read.into_iter().map(|(k, _, plan)| (k, plan.signal.clone())).collect())
}

/// How a sampled controller sees coordinates.
pub(super) fn measurement(
    table: &Table<'_>,
    joints: &Joints<'_>,
    sampling: Option<&Sampling>,
    record: &mut Map<String, Value>,
) -> Read<Option<Measurement>> {
    let given = [table.get("noise"), table.get("quantization")];
    let Some(first) = given.iter().flatten().next() else { return Ok(None) };
    if sampling.is_none() {
        let message = "needs a `sample`: what acts at every time sees coordinates as they are";
        return Err(first.refuse(RefusalKind::Rule, message, Some("write sample = \"1 ms\"".to_owned())));
    }
    let size = |table: &Table<'_>, key: &'static str, what: &str| {
        by_joint(table, key, joints, 0.0, &|field: &Field<'_>, joint: &OwnJoint<'_>, _| {
            let value = field.number(joint.units().map_or("", |units| units.coordinate))?;
            if value >= 0.0 {
                return Ok(value);
            }
            let message = format!("is {}, but {what} is not negative", field.node.label());
            Err(field.refuse(RefusalKind::OutOfRange, message, None))
        })
    };
    let quantum = size(table, "quantization", "a step")?;
    if table.get("quantization").is_some() {
        list(record, "quantization", joints, &quantum);
    }
    let (mut deviation, mut seed) = (vec![0.0; joints.robot.model().nv()], 1);
    if let Some(field) = table.get("noise") {
        let own = field.table(&NOISE)?;
        if own.get("sd").is_none() {
            return Err(own.lacks("sd"));
        }
        deviation = size(&own, "sd", "a standard deviation")?;
        seed = own.get("seed").map(|field| field.whole()).transpose()?.unwrap_or(1).unsigned_abs();
        let mut listed = Map::new();
        list(&mut listed, "sd", joints, &deviation);
        listed.insert("seed".to_owned(), json!(seed));
        record.insert("noise".to_owned(), listed.into());
    }
    Ok(Some(Measurement { deviation, quantum, seed }))
}

/// Keeps values of velocities by the names of their joints.
pub(super) fn list(record: &mut Map<String, Value>, key: &str, joints: &Joints<'_>, values: &[f64]) {
    let listed = joints.driven().map(|(k, joint)| (joint.name.to_owned(), json!(values[k])));
    record.insert(key.to_owned(), listed.collect::<Map<_, _>>().into());
}
