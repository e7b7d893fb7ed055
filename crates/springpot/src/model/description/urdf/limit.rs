//! `<limit>` of a joint.

use super::error::DescriptionError;
use super::problem::Owner;
use super::reader::{Node, Reader};
use super::warning::DescriptionWarningKind;
use crate::model::kind::JointKind;
use crate::model::spec::Limits;

/// Attributes of other programs and of later versions of the format.
const UNUSED: [&str; 6] = ["acceleration", "deceleration", "jerk", "current", "command_effort", "gear_velocity"];

/// A limit beyond this, rad, is one in degrees by the look of it.
const MOST_TURN: f64 = 6.0 * std::f64::consts::PI;

/// Reads the `<limit>` of a joint with an axis.
///
/// The format asks for effort and velocity, and takes 0 for lower and upper that are left out; `inf` stands for no
/// limit. No algorithm enforces limits, so that what makes no sense is noted and left out, not refused (other readers
/// take it as it is).
pub(super) fn read<'a>(
    reader: &mut Reader<'a>,
    joint: Node<'a>,
    limit: Option<Node<'a>>,
    owner: &Owner,
    kind: JointKind,
) -> Result<Limits, DescriptionError> {
    let turns_freely = kind == JointKind::Continuous;
    let Some(node) = limit else {
        if !turns_freely {
            reader.warnings.add(DescriptionWarningKind::NoLimit, owner, reader.line(joint), "");
        }
        return Ok(Limits::NONE);
    };
    let line = reader.line(node);
    reader.leaf(node, owner, &["lower", "upper", "effort", "velocity"], &UNUSED)?;
    let [lower, upper, effort, velocity] = [
        bound(reader, node, owner, "lower")?,
        bound(reader, node, owner, "upper")?,
        bound(reader, node, owner, "effort")?,
        bound(reader, node, owner, "velocity")?,
    ];
    let mut limits = Limits::NONE;
    for (name, value, limit) in [("effort", effort, &mut limits.effort), ("velocity", velocity, &mut limits.velocity)] {
        match value {
            None => {
                let what = format!("{name} taken as unlimited");
                reader.warnings.add(DescriptionWarningKind::IncompleteLimit, owner, line, what);
            }
            // Some exporters write 0 where they know nothing.
            Some(value) if value <= 0.0 => {
                reader.warnings.add(DescriptionWarningKind::SenselessLimit, owner, line, format!("{name} {value}"));
            }
            Some(value) => *limit = value,
        }
    }
    if turns_freely {
        if lower.is_some() || upper.is_some() {
            reader.not_used(node, owner, "lower and upper <limit> of continuous joints");
        }
        return Ok(limits);
    }
    let missing = match (lower, upper) {
        (None, None) => "lower and upper taken as 0",
        (None, _) => "lower taken as 0",
        (_, None) => "upper taken as 0",
        _ => "",
    };
    if !missing.is_empty() {
        reader.warnings.add(DescriptionWarningKind::IncompleteLimit, owner, line, missing);
    }
    let (lower, upper) = (lower.unwrap_or(0.0), upper.unwrap_or(0.0));
    if lower > upper || lower == f64::INFINITY || upper == f64::NEG_INFINITY {
        let what = format!("lower {lower} and upper {upper}");
        reader.warnings.add(DescriptionWarningKind::SenselessLimit, owner, line, what);
    } else {
        let farthest = [lower, upper].into_iter().filter(|x| x.is_finite()).fold(0.0, |most: f64, x| most.max(x.abs()));
        if kind == JointKind::Revolute && farthest > MOST_TURN {
            let what = format!("lower {lower} and upper {upper}");
            reader.warnings.add(DescriptionWarningKind::LimitInDegrees, owner, line, what);
        }
        (limits.lower, limits.upper) = (lower, upper);
    }
    Ok(limits)
}

/// A number that may be infinite.
fn bound<'a>(
    reader: &Reader<'a>,
    node: Node<'a>,
    owner: &Owner,
    name: &'static str,
) -> Result<Option<f64>, DescriptionError> {
    match reader.text(node, name).map(|text| text.trim().to_ascii_lowercase()).as_deref() {
        Some("inf" | "+inf" | "infinity" | "+infinity") => Ok(Some(f64::INFINITY)),
        Some("-inf" | "-infinity") => Ok(Some(f64::NEG_INFINITY)),
        _ => reader.number(node, owner, name),
    }
}
