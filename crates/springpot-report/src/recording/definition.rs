//! What messages are made of, in the language of ROS 2 (`.msg` files, those that one names behind it).

use super::names::{self, Names};
use crate::page::ViewColumn;
use std::fmt::Write as _;

/// A type of messages.
#[derive(Debug, Clone)]
pub(super) struct Schema {
    pub(super) name: String,
    pub(super) text: String,
}

const HEADER: (&str, &str) = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
const POINT: (&str, &str) = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
const VECTOR: (&str, &str) = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
const QUATERNION: (&str, &str) = ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
const TRANSFORM: (&str, &str) =
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n");
const STAMPED: (&str, &str) = (
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
);

/// `sensor_msgs/msg/JointState`.
pub(super) fn joint_state() -> Schema {
    let text = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n";
    whole("sensor_msgs/msg/JointState", text, &[HEADER, TIME])
}

/// `tf2_msgs/msg/TFMessage`.
pub(super) fn transforms() -> Schema {
    let text = "geometry_msgs/TransformStamped[] transforms\n";
    whole("tf2_msgs/msg/TFMessage", text, &[STAMPED, HEADER, TIME, TRANSFORM, VECTOR, QUATERNION])
}

/// `geometry_msgs/msg/PointStamped`.
pub(super) fn point() -> Schema {
    let text = "std_msgs/Header header\ngeometry_msgs/Point point\n";
    whole("geometry_msgs/msg/PointStamped", text, &[HEADER, TIME, POINT])
}

/// A name at a time.
pub(super) fn event() -> Schema {
    whole("springpot_msgs/msg/Event", "std_msgs/Header header\n# what happened\nstring name\n", &[HEADER, TIME])
}

/// A number for each column, and the names of those fields; columns stand beside the names that fields are made of.
pub(super) fn columns<'a>(
    kind: &str,
    about: &str,
    columns: impl Iterator<Item = (String, &'a ViewColumn)>,
) -> (Schema, Vec<String>) {
    let (mut text, mut fields) = (format!("# {}\nstd_msgs/Header header\n", names::comment(about)), Vec::new());
    let mut taken = Names::with(&["header"]);
    for (name, ViewColumn { name: column, unit, meaning }) in columns {
        let field = taken.take(names::field(&name));
        let unit = if unit.is_empty() { "1" } else { unit };
        let comment = names::comment(&format!("{column}, {unit}: {meaning}"));
        _ = write!(text, "# {comment}\nfloat64 {field}\n");
        fields.push(field);
    }
    (whole(&format!("springpot_msgs/msg/{kind}"), &text, &[HEADER, TIME]), fields)
}

/// A definition with all that it names.
fn whole(name: &str, text: &str, parts: &[(&str, &str)]) -> Schema {
    let mut text = text.to_owned();
    for (part, definition) in parts {
        _ = write!(text, "{}\nMSG: {part}\n{definition}", "=".repeat(80));
    }
    Schema { name: name.to_owned(), text }
}
