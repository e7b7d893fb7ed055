//! Reading a file of states.

use super::json_text::Json;
use super::order::Order;
use crate::robot::Robot;
use springpot_scenario::{Place, RefusalKind, Refusals, Source};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

/// Largest file, bytes.
const MAX_BYTES: u64 = 256 << 20;

const ROOT_KEYS: [&str; 2] = ["joints", "states"];
const STATE_KEYS: [&str; 4] = ["q", "v", "a", "tau"];
/// A quaternion may differ by this from length 1.
const LENGTH_TOLERANCE: f64 = 1e-6;

/// The states of a file, in the order of the model.
#[derive(Debug)]
pub(super) struct States {
    pub(super) order: Order,
    pub(super) states: Vec<State>,
    /// What was assumed.
    pub(super) warnings: Vec<String>,
}

/// One state: q (nq), v, a, tau (nv).
#[derive(Debug)]
pub(super) struct State {
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) a: Vec<f64>,
    pub(super) tau: Vec<f64>,
}

/// Reads the text of a regular file; `-` is the standard input.
pub(super) fn source(file: &Path) -> Result<Arc<Source>, Refusals> {
    let is_stdin = file == Path::new("-");
    let name = if is_stdin { "standard input".to_owned() } else { file.display().to_string() };
    let source = |text: String| Arc::new(Source { name: name.clone(), text: text.into() });
    let refuse = |kind, message: String| Place { source: source(String::new()), span: 0..0 }.refuse(kind, message);
    let unreadable = |error: io::Error| refuse(RefusalKind::File, format!("cannot be read: {error}"));
    let mut bytes = Vec::new();
    if is_stdin {
        io::stdin().lock().take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    } else {
        // Looked at before it is opened: opening a pipe would wait for its other end.
        if !fs::metadata(file).map_err(unreadable)?.is_file() {
            let refusal = refuse(RefusalKind::File, "cannot be read: not a regular file".to_owned());
            return Err(refusal.help("--states - reads the standard input").into());
        }
        File::open(file).map_err(unreadable)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    }
    if bytes.len() as u64 > MAX_BYTES {
        let refusal = refuse(RefusalKind::TooLarge, format!("larger than {} MiB", MAX_BYTES >> 20));
        return Err(refusal.help("split the states over several files").into());
    }
    match String::from_utf8(bytes) {
        // Some editors begin their files with a byte order mark.
        Ok(text) => Ok(source(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            let place = Place { source: source(text), span: at..at + '\u{fffd}'.len_utf8() };
            Err(place.refuse(RefusalKind::Syntax, "not UTF-8").help("save the file as UTF-8").into())
        }
    }
}

/// Reads all states; the first mistake is refused.
pub(super) fn read(robot: &Robot, source: &Arc<Source>) -> Result<States, Refusals> {
    let document = Json::read(source)?;
    let [joints, states] = fields(&document, "the file", ROOT_KEYS)?;
    let order = joints.map_or_else(|| Ok(Order::of_model(robot)), |names| Order::read(robot, &names))?;
    let states = states.ok_or_else(|| {
        let refusal = document.refuse(RefusalKind::Missing, "the file has no \"states\"");
        refusal.help("write {\"states\": [{\"q\": […], \"v\": […], \"a\": […], \"tau\": […]}]}")
    })?;
    let items = states.items().ok_or_else(|| {
        let message = format!("\"states\" is {}, but must be an array of states", states.written());
        states.refuse(RefusalKind::WrongType, message)
    })?;
    let floating = attitudes(robot);
    let (mut read, mut unnormalised) = (Vec::with_capacity(items.len()), Vec::new());
    for (k, item) in items.iter().enumerate() {
        let (state, lengths) = state(k, item, &order, &floating)?;
        read.push(state);
        unnormalised.extend(lengths.into_iter().map(|(joint, length)| (k, joint, length)));
    }
    Ok(States { order, states: read, warnings: quaternion_warning(robot, &unnormalised).into_iter().collect() })
}

/// The values of an object's keys, which are the only ones that it may have.
fn fields<'a, const N: usize>(
    object: &Json<'a>,
    what: &str,
    keys: [&'static str; N],
) -> Result<[Option<Json<'a>>; N], Refusals> {
    let Some(entries) = object.entries() else {
        let message = format!("{what} is {}, but must be an object with {}", object.written(), quoted(&keys));
        return Err(object.refuse(RefusalKind::WrongType, message).into());
    };
    let mut found = std::array::from_fn(|_| None);
    for (key, value) in entries {
        let name = key.text().unwrap_or_default();
        let Some(k) = keys.iter().position(|known| *known == name) else {
            let refusal = key.refuse(RefusalKind::UnknownKey, format!("unknown key {name:?} in {what}"));
            return Err(refusal.label("unknown key").help(format!("there is {}", quoted(&keys))).into());
        };
        if found[k].is_some() {
            return Err(key.refuse(RefusalKind::BadName, format!("{name:?} stands twice in {what}")).into());
        }
        found[k] = Some(value);
    }
    Ok(found)
}

/// `"q", "v" and "a"`.
fn quoted(keys: &[&str]) -> String {
    let quoted: Vec<String> = keys.iter().map(|key| format!("{key:?}")).collect();
    match quoted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => quoted.concat(),
    }
}

/// Reads a state, and the lengths of its quaternions that are not 1.
fn state(
    k: usize,
    item: &Json<'_>,
    order: &Order,
    floating: &[(usize, usize)],
) -> Result<(State, Vec<(usize, f64)>), Refusals> {
    let what = format!("states[{k}]");
    let found = fields(item, &what, STATE_KEYS)?;
    let missing: Vec<&str> =
        STATE_KEYS.into_iter().zip(&found).filter(|(_, value)| value.is_none()).map(|(key, _)| key).collect();
    let [Some(q), Some(v), Some(a), Some(tau)] = found else {
        let refusal = item.refuse(RefusalKind::Missing, format!("{what} has no {}", quoted(&missing)));
        return Err(refusal
            .help("write all of \"q\", \"v\", \"a\" and \"tau\"; zeros where the robot is at rest")
            .into());
    };
    let numbers = |key: &str, value: &Json<'_>, names: &[String], indices: &[usize]| {
        numbers(&format!("{key:?} of {what}"), value, names, &order.joints)
            .map(|read| Order::into_model(indices, &read))
    };
    let mut state = State {
        q: numbers("q", &q, &order.q_names, &order.q)?,
        v: numbers("v", &v, &order.v_names, &order.v)?,
        a: numbers("a", &a, &order.v_names, &order.v)?,
        tau: numbers("tau", &tau, &order.v_names, &order.v)?,
    };
    let mut lengths = Vec::new();
    for &(joint, at) in floating {
        let attitude = &mut state.q[at..at + 4];
        let length = normalise(attitude);
        if length == 0.0 {
            let message = format!("\"q\" of {what}: the quaternion is 0 0 0 0, which is no attitude");
            return Err(q.refuse(RefusalKind::OutOfRange, message).help("no turn is qx qy qz qw = 0 0 0 1").into());
        }
        if (length - 1.0).abs() > LENGTH_TOLERANCE {
            lengths.push((joint, length));
        }
    }
    Ok((state, lengths))
}

/// The finite numbers of an array, as many as there are names.
fn numbers(what: &str, array: &Json<'_>, names: &[String], joints: &[String]) -> Result<Vec<f64>, Refusals> {
    let Some(items) = array.items() else {
        let message = format!("{what} is {}, but must be an array of {} numbers", array.written(), names.len());
        return Err(array.refuse(RefusalKind::WrongType, message).into());
    };
    if items.len() != names.len() {
        let message = format!("{what} holds {} numbers, but must hold {}", items.len(), names.len());
        let refusal = array.refuse(RefusalKind::WrongType, message);
        return Err(refusal.help(blocks(names, joints)).into());
    }
    let number = |(item, name): (&Json<'_>, &String)| match item.number() {
        Some(number) if number.is_finite() => Ok(number),
        Some(_) => {
            let message = format!("{what}: {} of {name} is beyond all numbers of 64 bits", item.written());
            Err(item.refuse(RefusalKind::OutOfRange, message).into())
        }
        None => {
            let message = format!("{what}: the entry of {name} is {}, but must be a number", item.written());
            Err(item.refuse(RefusalKind::WrongType, message).into())
        }
    };
    items.iter().zip(names).map(number).collect()
}

/// Which numbers an array holds.
fn blocks(names: &[String], joints: &[String]) -> String {
    const SHOWN: usize = 12;
    if names.len() <= SHOWN {
        return format!("write {}", names.join(", "));
    }
    if names.len() == joints.len() {
        return format!(
            "write one number a joint: {}, …, {}",
            joints[..SHOWN - 1].join(", "),
            joints[joints.len() - 1]
        );
    }
    format!("write {}, …, {}", names[..SHOWN - 1].join(", "), names[names.len() - 1])
}

/// The joints that turn freely, and where their quaternions stand in the model's q.
fn attitudes(robot: &Robot) -> Vec<(usize, usize)> {
    let model = &robot.model;
    let free = robot.own_joints().filter_map(|(joint, _)| Some((joint, model.joint_space(joint).quaternion()?)));
    free.map(|(joint, first)| (joint, model.q_range(joint).start + first)).collect()
}

/// Divides by the length and returns it; components that are all tiny or huge lose nothing.
fn normalise(components: &mut [f64]) -> f64 {
    let largest = components.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    let scaled = components.iter().map(|c| (c / largest).powi(2)).sum::<f64>().sqrt();
    let length = largest * scaled;
    // What is of length 1 to rounding is left as it is written.
    if (length - 1.0).abs() > 4.0 * f64::EPSILON {
        components.iter_mut().for_each(|c| *c = *c / largest / scaled);
    }
    length
}

/// One line for all quaternions that are not of length 1.
fn quaternion_warning(robot: &Robot, found: &[(usize, usize, f64)]) -> Option<String> {
    let &(state, joint, length) = found.first()?;
    let name = &robot.model.joint_names()[joint];
    let others = match found.len() - 1 {
        0 => String::new(),
        1 => "; so it is of 1 other".to_owned(),
        more => format!("; so it is of {more} others"),
    };
    Some(format!(
        "the quaternion of {name} in states[{state}] has the length {length}, not 1, and is normalised{others}"
    ))
}

#[cfg(test)]
mod tests {
    use super::{Source, States, normalise, read};
    use crate::arguments::RobotOptions;
    use crate::robot::{self, Robot};
    use proptest::prelude::*;
    use springpot::law::Catalog;
    use std::sync::Arc;

    fn floating_pendulum() -> Robot {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/multibody/double_pendulum.urdf");
        let options = RobotOptions {
            file: file.into(),
            floating_base: true,
            ignore_mimic: false,
            accept_inertia: false,
            package_path: Vec::new(),
        };
        robot::read(&options, &[], &Catalog::standard()).unwrap()
    }

    const STATES: &str = r#"{"joints": ["joint2", "floating_base", "joint1"],
 "states": [{"q": [0.1, 1, 2, 3, 0, 0, 0, 1e0, -0.2], "v": [1, 2, 3, 4, 5, 6, 7, 8],
   "a": [0, 0, 0, 0, 0, 0, 0, 0], "tau": [8, 7, 6, 5, 4, 3, 2, 1]}]}"#;

    #[test]
    fn blocks_go_to_their_joints() {
        let source = Arc::new(Source { name: String::new(), text: STATES.into() });
        let States { order, states, warnings } = read(&floating_pendulum(), &source).unwrap();
        assert_eq!(order.joints, ["joint2", "floating_base", "joint1"]);
        assert_eq!(states[0].q, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, -0.2, 0.1]);
        assert_eq!(states[0].v, [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 1.0]);
        assert_eq!(states[0].tau, [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 8.0]);
        assert!(warnings.is_empty());
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn broken_files_are_refused_with_a_place(
            edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4usize, 0..16usize), 1..4),
        ) {
            const PIECES: [&str; 16] =
                ["", "\"", "[", "]", "{", "}", ",", ":", "1e999", "NaN", "null", "\"v\"", "ä", "\\u0000", "-", "\n"];
            let mut text = STATES.to_owned();
            for (at, length, piece) in edits {
                let at = at.index(text.len() + 1);
                let end = (at + length).min(text.len());
                if text.is_char_boundary(at) && text.is_char_boundary(end) {
                    text.replace_range(at..end, PIECES[piece]);
                }
            }
            let source = Arc::new(Source { name: "states.json".into(), text: text.as_str().into() });
            match read(&floating_pendulum(), &source) {
                Ok(States { states, .. }) => {
                    prop_assert!(states.iter().all(|s| s.q.len() == 9 && s.q.iter().all(|x| x.is_finite())));
                }
                Err(refusals) => {
                    let refusal = refusals.first().unwrap();
                    prop_assert!(text.get(refusal.span.clone()).is_some(), "{refusal}");
                    prop_assert!(!refusal.message.is_empty() && refusal.line >= 1 && refusal.column >= 1);
                }
            }
        }
    }

    #[test]
    fn quaternions_of_any_size_are_normalised() {
        for size in [1e-310, 1e-200, 0.5, 3.0, 1e200, 1e308] {
            let mut quaternion = [0.0, 0.6 * size, 0.0, -0.8 * size];
            let length = normalise(&mut quaternion);
            assert!((length / size - 1.0).abs() < 1e-9, "{length} {size}");
            let expected = [0.0, 0.6, 0.0, -0.8];
            assert!(quaternion.iter().zip(expected).all(|(q, e)| (q - e).abs() < 1e-9), "{quaternion:?}");
        }
        let unit = [0.1, 0.7, 0.1, 0.7];
        let mut same = unit;
        assert_eq!(normalise(&mut same), 1.0);
        assert_eq!(same, unit);
        assert_eq!(normalise(&mut [0.0; 4]), 0.0);
    }
}
