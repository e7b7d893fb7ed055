//! `[robot]`.

use super::{Bound, Key, Keys, Need, Shape, key};
use springpot::model::description::DescriptionWarningKind;
use springpot::model::{FRICTION_SPEED, JointKind};

/// What to write where a name is missing.
pub(super) const NAME: &str = "name = \"…\"";
const KILOGRAM_METRE_SQUARED: &str = "kg*m^2";
/// N·m where a joint turns, N where it slides.
const FORCE: [&str; 2] = ["N*m", "N"];
/// The kind of robots from a URDF file.
pub(crate) const FROM_URDF: &str = "with urdf";
const WITH_URDF: &[&str] = &[FROM_URDF];
/// The kind of robots from an MJCF file.
pub(crate) const FROM_MJCF: &str = "with mjcf";
const WITH_FILE: &[&str] = &[FROM_URDF, FROM_MJCF];
const ZERO: Need = Need::Vector([0.0; 3]);

/// The kinds of it that `only` knows: robots from files.
pub(crate) static ROBOT: Keys = Keys {
    words: "A robot.",
    keys: &[
        key(
            "gravity",
            Shape::Vector("m/s^2"),
            Need::Vector([0.0, 0.0, -9.81]),
            "Gravity in the axes of the world; of an MJCF file its own where it is left out.",
        ),
        key("body", Shape::Tables(&BODY, None), Need::OneOf, "Bodies, parents before children."),
        key("gripper", Shape::Table(&ANCHOR), Need::Optional, "The point that a gripper path moves."),
        key("urdf", Shape::Text, Need::OneOf, "Path of a URDF file, relative to the scenario."),
        key("mjcf", Shape::Text, Need::OneOf, "Path of an MJCF file, relative to the scenario."),
        key(
            "floating_base",
            Shape::Flag,
            Need::Flag(false),
            "Whether the root link floats on a joint called floating_base.",
        )
        .only(WITH_URDF),
        key("ignore_mimic", Shape::Flag, Need::Flag(false), "Whether mimic joints have coordinates of their own.")
            .only(WITH_URDF),
        key(
            "accept_inertia",
            Shape::Flag,
            Need::Flag(false),
            "Whether inertias that no distribution of mass has are taken as they are.",
        )
        .only(WITH_FILE),
        key(
            "limits",
            Shape::Table(&END_STOPS),
            Need::Optional,
            "Makes limits of joints end stops: outside, the force -stiffness*excess - damping*v, never pulling.",
        ),
        key(
            "joint",
            Shape::Tables(&CHANGED_JOINT, None),
            Need::Optional,
            "Joints of the file with another kind or with a rotor.",
        )
        .only(WITH_FILE),
        key(
            "package_path",
            Shape::Texts,
            Need::Said("[]"),
            "Folders that are packages or hold some, for package:// paths.",
        )
        .only(WITH_FILE),
        key(
            "accept",
            Shape::WordList(|| DescriptionWarningKind::ALL.map(DescriptionWarningKind::name).to_vec()),
            Need::Said("[]"),
            "Kinds of warnings of the file that were read and need not be told again.",
        )
        .only(WITH_FILE),
    ],
};

pub(crate) static END_STOPS: Keys = Keys {
    words: "Limits of joints as end stops.",
    keys: &[
        key(
            "stiffness",
            Shape::Number("", Bound::Positive),
            Need::Required("stiffness = 1e4 (SI of each joint)"),
            "Stiffness, N*m/rad or N/m.",
        ),
        key("damping", Shape::Number("", Bound::NotNegative), Need::Number(0.0), "Damping, N*m*s/rad or N*s/m."),
    ],
};

/// A point on a body.
pub(crate) static ANCHOR: Keys = Keys {
    words: "A point on a body.",
    keys: &[
        key(
            "body",
            Shape::Text,
            Need::Required("body = \"NAME\" or body = \"world\""),
            "Name of a body or link, or \"world\".",
        ),
        key(
            "point",
            Shape::Vector("m"),
            Need::Required("point = [x, y, z] in the body's joint frame, m"),
            "The point in the frame of the body's joint.",
        ),
    ],
};

pub(crate) static BODY: Keys = Keys {
    words: "A body and the joint that it hangs on.",
    keys: &[
        key("name", Shape::Name(&[]), Need::Written(NAME), "Name of the body; not \"world\"."),
        key(
            "parent",
            Shape::Text,
            Need::Said("the body before; the first hangs on \"world\""),
            "\"world\" or an earlier body.",
        ),
        key(
            "joint",
            Shape::Table(&JOINT),
            Need::Required("joint = { name = \"…\", kind = \"revolute\", axis = [0, 0, 1], origin = [0, 0, 0] }"),
            "The joint between the body and its parent.",
        ),
        key("mass", Shape::Number("kg", Bound::NotNegative), Need::Required("mass = 1.0 (in kg)"), "Mass."),
        key("com", Shape::Vector("m"), ZERO, "Centre of mass in the frame of the joint."),
        key(
            "inertia",
            Shape::Table(&INERTIA),
            Need::Said("0 (a point mass)"),
            "Inertia about the centre of mass in the axes of the joint, kg*m^2.",
        ),
    ],
};

const fn moment(name: &'static str) -> Key {
    key(
        name,
        Shape::Number(KILOGRAM_METRE_SQUARED, Bound::NotNegative),
        Need::Required("xx, yy and zz, in kg*m^2"),
        "Moment of inertia.",
    )
}

const fn product(name: &'static str) -> Key {
    let words = "Component of the tensor, J_xy = -∫xy dm.";
    key(name, Shape::Number(KILOGRAM_METRE_SQUARED, Bound::Any), Need::Number(0.0), words)
}

pub(crate) static INERTIA: Keys = Keys {
    words: "Inertia about the centre of mass.",
    keys: &[moment("xx"), moment("yy"), moment("zz"), product("xy"), product("xz"), product("yz")],
};

// The kinds of joint that take a key: a test compares them with what the kinds are.
const AXIS: &[&str] = &["revolute", "continuous", "prismatic", "helical", "cylindrical", "universal", "planar"];
const AXIS2: &[&str] = &["universal"];
const LEAD: &[&str] = &["helical"];
/// Those with coordinates that are numbers.
const NUMBERS: &[&str] = AXIS;
/// Those of these that end somewhere.
const ENDS: &[&str] = &["revolute", "prismatic", "helical", "cylindrical", "universal", "planar"];
/// Those of one coordinate.
const ONE: &[&str] = &["revolute", "continuous", "prismatic", "helical"];

fn joint_kinds() -> Vec<&'static str> {
    JointKind::ALL.map(JointKind::name).to_vec()
}

/// The kinds of it that `only` knows: kinds of joint.
pub(crate) static JOINT: Keys = Keys {
    words: "The joint between the body and its parent.",
    keys: &[
        key("name", Shape::Name(&[]), Need::Written(NAME), "Name of the joint."),
        key("kind", Shape::Words(joint_kinds), Need::Required("kind = \"revolute\", or another of the kinds of joint"), "How it moves."),
        key("origin", Shape::Vector("m"), ZERO, "Origin of the joint frame in the parent's joint frame."),
        key("rpy", Shape::Vector("rad"), ZERO, "Roll, pitch, yaw of the joint frame in the parent's."),
        key(
            "axis",
            Shape::Vector(""),
            Need::Required("axis = [0, 0, 1]"),
            "Axis in the joint frame, of any length but 0; of planar joints the normal, [0, 0, 1] where it is left out.",
        )
        .only(AXIS),
        AXIS2_KEY,
        LEAD_KEY,
        key(
            "damping",
            Shape::JointNumbers(["N*m*s/rad", "N*s/m"], Bound::NotNegative),
            Need::Number(0.0),
            "Viscous damping.",
        )
        .only(NUMBERS),
        key(
            "friction",
            Shape::JointNumberOr(FORCE, Bound::NotNegative, &FRICTION),
            Need::Number(0.0),
            "Coulomb friction: a number or quantity, or a table with `force`.",
        )
        .only(NUMBERS),
        ARMATURE_KEY,
        key("lower", Shape::JointNumbers(["rad", "m"], Bound::Any), Need::Said("none"), "Smallest coordinate.").only(ENDS),
        key("upper", Shape::JointNumbers(["rad", "m"], Bound::Any), Need::Said("none"), "Largest coordinate.").only(ENDS),
        key("velocity", Shape::JointNumbers(["rad/s", "m/s"], Bound::Positive), Need::Said("none"), "Largest speed.")
            .only(NUMBERS),
        key("effort", Shape::JointNumbers(FORCE, Bound::Positive), Need::Said("none"), "Largest actuator force.").only(NUMBERS),
        key("mimic", Shape::Table(&MIMIC), Need::Optional, "The joint that it follows.").only(ONE),
    ],
};

const AXIS2_KEY: Key = key(
    "axis2",
    Shape::Vector(""),
    Need::Required("axis2 = [0, 1, 0]"),
    "Second axis, fixed in the body, in the joint frame at q = 0; not parallel to `axis`.",
)
.only(AXIS2);
const LEAD_KEY: Key = key(
    "lead",
    Shape::Number("m", Bound::Any),
    Need::Required("lead = \"5 mm\""),
    "Advance along the axis in each turn, not 0.",
)
.only(LEAD);
const ARMATURE_KEY: Key = key(
    "armature",
    Shape::JointNumbers([KILOGRAM_METRE_SQUARED, "kg"], Bound::NotNegative),
    Need::Number(0.0),
    "Inertia of the rotor as felt at the joint.",
)
.only(NUMBERS);

/// A joint that follows another one.
pub(crate) static MIMIC: Keys = Keys {
    words: "The joint that one follows: its coordinate is multiplier·q + offset.",
    keys: &[
        key(
            "joint",
            Shape::Text,
            Need::Required("joint = \"NAME\""),
            "Name of a joint of one coordinate, or of a coordinate, \"c.rz\".",
        ),
        key("multiplier", Shape::Number("", Bound::Any), Need::Number(1.0), "Ratio of the two speeds."),
        key("offset", Shape::JointNumber(["rad", "m"], Bound::Any), Need::Number(0.0), "Where it stands at q = 0."),
    ],
};

/// What a scenario says of a joint of a URDF file; the kinds of it that `only` knows are kinds of joint.
pub(crate) static CHANGED_JOINT: Keys = Keys {
    words: "What the scenario says of a joint of the file.",
    keys: &[
        key("name", Shape::Text, Need::Required(NAME), "Name of the joint."),
        key("kind", Shape::Words(joint_kinds), Need::Said("as in the file"), "Another kind; axis and origin stay."),
        AXIS2_KEY,
        LEAD_KEY,
        ARMATURE_KEY,
    ],
};

pub(crate) static FRICTION: Keys = Keys {
    words: "Coulomb friction, and what it does near rest.",
    keys: &[
        key(
            "force",
            Shape::JointNumber(FORCE, Bound::NotNegative),
            Need::Written("force = \"0.2 N*m\" (prismatic: \"0.2 N\")"),
            "Coulomb friction.",
        ),
        key(
            "speed",
            Shape::JointNumber(["rad/s", "m/s"], Bound::Positive),
            Need::Number(FRICTION_SPEED),
            "v_0 of force·tanh(v/v_0), at which a load below the force creeps. Not used where it sticks.",
        ),
        key("stick", Shape::Flag, Need::Flag(false), "Whether Coulomb's law holds as it stands, with rest."),
    ],
};
