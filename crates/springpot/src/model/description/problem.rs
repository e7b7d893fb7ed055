//! What can be wrong with a URDF file.

use crate::model::error::ModelError;
use crate::model::kind::JointKind;
use std::fmt;

/// Whose element it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Owner {
    /// The `<robot>` itself.
    Robot,
    /// The `<mujoco>` itself.
    Mujoco,
    /// The body of that name, of MJCF.
    Body(String),
    /// The shape of that name, of MJCF.
    Geom(String),
    /// The mesh of that name, of MJCF.
    Mesh(String),
    /// The link of that name.
    Link(String),
    /// The joint of that name.
    Joint(String),
}

impl Owner {
    /// The name of what has one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Robot | Self::Mujoco => None,
            Self::Body(name) | Self::Geom(name) | Self::Mesh(name) | Self::Link(name) | Self::Joint(name) => Some(name),
        }
    }
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Robot => f.write_str("<robot>"),
            Self::Mujoco => f.write_str("<mujoco>"),
            Self::Body(name) => write!(f, "body {name:?}"),
            Self::Geom(name) => write!(f, "geom {name:?}"),
            Self::Mesh(name) => write!(f, "mesh {name:?}"),
            Self::Link(name) => write!(f, "link {name:?}"),
            Self::Joint(name) => write!(f, "joint {name:?}"),
        }
    }
}

/// The types of joints that are read.
pub(super) const TYPES: [JointKind; 7] = [
    JointKind::Fixed,
    JointKind::Revolute,
    JointKind::Continuous,
    JointKind::Prismatic,
    JointKind::Planar,
    JointKind::Spherical,
    JointKind::Floating,
];

/// What is wrong with a URDF file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionProblem {
    /// The operating system refused.
    #[error("cannot be read: {source}")]
    Unreadable {
        /// Why.
        source: std::io::Error,
    },
    /// A folder, a pipe or a device.
    #[error("not a regular file")]
    NotAFile,
    /// Bytes that are not UTF-8.
    #[error("not UTF-8 text; save the file as UTF-8")]
    NotUtf8,
    /// More than any robot has.
    #[error("more than {limit} {what}; this is no description of a robot")]
    TooLarge {
        /// The limit.
        limit: usize,
        /// Of what.
        what: &'static str,
    },
    /// The XML is broken.
    #[error("not XML: {reason}")]
    NotXml {
        /// Why.
        reason: String,
    },
    /// XML of another kind.
    #[error("the outermost element is <{root}>, neither <robot> (URDF) nor <mujoco> (MJCF){}", root_help(root))]
    NoRobot {
        /// The outermost element.
        root: String,
    },
    /// A macro file.
    #[error("<{element}> is xacro, not URDF; expand it first: xacro robot.urdf.xacro > robot.urdf")]
    Xacro {
        /// The first element of it.
        element: String,
    },
    /// Nothing to build.
    #[error("the robot has no <link>")]
    NoLinks,
    /// An element stands twice where one is allowed.
    #[error("{owner} has two <{element}>, the first in line {first}; one is allowed")]
    DuplicateElement {
        /// Whose.
        owner: Owner,
        /// The element.
        element: String,
        /// Line of the first one.
        first: usize,
    },
    /// A needed element is not there.
    #[error("{owner} has no <{element}>")]
    MissingElement {
        /// Whose.
        owner: Owner,
        /// The element.
        element: &'static str,
    },
    /// A needed attribute is not there.
    #[error("<{element}>{} has no {attribute}", of(owner))]
    MissingAttribute {
        /// Whose.
        owner: Owner,
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// A link or joint without name.
    #[error("the name of this <{element}> is empty")]
    EmptyName {
        /// `link` or `joint`.
        element: &'static str,
    },
    /// Two links, or two joints, of one name.
    #[error("there are two of {owner}, the first in line {first}; names must be unique")]
    DuplicateName {
        /// Both of them.
        owner: Owner,
        /// Line of the first one.
        first: usize,
    },
    /// The name of the inertial frame on a link that is not the root.
    #[error(
        "a link is called \"world\", which is the inertial frame; only the root link can have that name: rename it"
    )]
    ReservedLink,
    /// The name of the joint that lets the base float.
    #[error("a joint is called \"floating_base\", the name of the joint that lets the base float; rename it")]
    ReservedJoint,
    /// Text where a number is needed.
    #[error("{attribute} of <{element}>{} holds {text:?}, which is not a number{}", of(owner), number_help(text))]
    NotANumber {
        /// Whose.
        owner: Owner,
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// The text, its start where it is long.
        text: String,
    },
    /// NaN, infinity, or beyond the range of numbers.
    #[error("{attribute} of <{element}>{} holds {text:?}; it must be a finite number", of(owner))]
    NotFinite {
        /// Whose.
        owner: Owner,
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// The text, its start where it is long.
        text: String,
    },
    /// More or fewer numbers than needed.
    #[error("{attribute} of <{element}>{} has {}; it needs {wanted}", of(owner), numbers(*.given))]
    WrongCount {
        /// Whose.
        owner: Owner,
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// How many there are.
        given: usize,
        /// How many there must be.
        wanted: usize,
    },
    /// A mass, damping or friction below zero.
    #[error("{attribute} of <{element}>{} is {value}; it must be 0 or more", of(owner))]
    Negative {
        /// Whose.
        owner: Owner,
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// The value.
        value: f64,
    },
    /// An inertia tensor with a negative principal moment.
    #[error(
        "the <inertia> of link {link:?} has the principal moment {} kg*m^2; all three must be 0 or \
            more", brief(*.smallest)
    )]
    InertiaNotPositive {
        /// The link.
        link: String,
        /// The smallest principal moment.
        smallest: f64,
    },
    /// An axis without direction.
    #[error("the <axis> of joint {joint:?} is 0 0 0; it must point somewhere, as in xyz=\"0 0 1\"")]
    ZeroAxis {
        /// The joint.
        joint: String,
    },
    /// A type of joint that URDF does not have.
    #[error("joint {joint:?} has the unknown type {kind:?}{}; the types are {}", meant(suggestion), kinds())]
    UnknownJointType {
        /// The joint.
        joint: String,
        /// Its type.
        kind: String,
        /// What was probably meant.
        suggestion: Option<String>,
    },
    /// A type of joint that this version does not move.
    #[error("joint {joint:?} is {kind}, which is not supported yet; supported are {}", kinds())]
    UnsupportedJointType {
        /// The joint.
        joint: String,
        /// Its type.
        kind: String,
    },
    /// Something that changes the motion and is not supported.
    #[error("{what}{} changes the motion of the robot and is not supported", of(owner))]
    Unsupported {
        /// Whose.
        owner: Owner,
        /// The element or attribute.
        what: String,
    },
    /// Something of an MJCF file that is wrong, or not supported.
    #[error("{owner} {why}")]
    Refused {
        /// Whose.
        owner: Owner,
        /// What is wrong with it.
        why: String,
    },
    /// A joint names a link that does not exist.
    #[error("the <{element}> of joint {joint:?} is link {link:?}, which does not exist{}", meant(suggestion))]
    UnknownLink {
        /// The joint.
        joint: String,
        /// `parent` or `child`.
        element: &'static str,
        /// The link.
        link: String,
        /// What was probably meant.
        suggestion: Option<String>,
    },
    /// A joint joins a link to itself.
    #[error("joint {joint:?} has link {link:?} as parent and as child")]
    JoinsItself {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A link that hangs on two joints.
    #[error("link {link:?} is the child of joint {second:?} and, in line {line}, of joint {first:?}; one is allowed")]
    TwoParents {
        /// The link.
        link: String,
        /// The first joint.
        first: String,
        /// Its line.
        line: usize,
        /// The second joint.
        second: String,
    },
    /// Links that are not joined to the others.
    #[error(
        "the links are not one tree: no joint leads to {}; all but one need a joint that has them as child",
        quoted(roots)
    )]
    SeveralRoots {
        /// Every link that is the child of no joint, in the order of the file.
        roots: Vec<String>,
    },
    /// Links that carry one another in a circle.
    #[error("the links {} carry one another in a circle; a robot is a tree", quoted(links))]
    Cycle {
        /// The links of the circle, from parent to child.
        links: Vec<String>,
    },
    /// A joint mimics one that does not exist.
    #[error("joint {joint:?} mimics joint {target:?}, which does not exist{}", mimic_help(suggestion))]
    UnknownMimic {
        /// The joint.
        joint: String,
        /// What it follows.
        target: String,
        /// What was probably meant.
        suggestion: Option<String>,
    },
    /// A mimic joint, or the one that it follows, has not exactly one degree of freedom.
    #[error("joint {joint:?} mimics joint {target:?}, but joint {culprit:?} is {}; only joints of one degree \
        can", kind.name())]
    MimicOfManyDegrees {
        /// The joint.
        joint: String,
        /// What it follows.
        target: String,
        /// The one of the two that cannot.
        culprit: String,
        /// Its kind.
        kind: JointKind,
    },
    /// Joints that mimic one another in a circle.
    #[error("{} in a circle; one of them must be free", circle(joints))]
    MimicCycle {
        /// The joints, each following the next.
        joints: Vec<String>,
    },
    /// A robot of one link on a fixed base.
    #[error(
        "the robot is the single link {link:?}, which is the world on a fixed base; with floating_base it can move"
    )]
    NothingMoves {
        /// The link.
        link: String,
    },
    /// The robot as a whole cannot be built.
    #[error("{source}")]
    Model {
        /// Why.
        source: ModelError,
    },
}

impl DescriptionProblem {
    /// Whether it is an inertia that no distribution of mass has, which
    /// [`DescriptionOptions::accept_inertia`](super::DescriptionOptions::accept_inertia) takes as it is.
    pub fn is_of_no_mass(&self) -> bool {
        match self {
            Self::InertiaNotPositive { .. } => true,
            Self::Model { source } => source.is_of_no_mass(),
            _ => false,
        }
    }
}

/// ` of link "a"`; nothing for the robot.
fn of(owner: &Owner) -> String {
    if owner.name().is_none() { String::new() } else { format!(" of {owner}") }
}

fn numbers(count: usize) -> String {
    if count == 1 { "1 number".to_owned() } else { format!("{count} numbers") }
}

fn kinds() -> String {
    TYPES.map(JointKind::name).join(", ")
}

fn meant(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map_or_else(String::new, |name| format!("; did you mean {name:?}?"))
}

fn mimic_help(suggestion: &Option<String>) -> String {
    match suggestion {
        Some(_) => meant(suggestion),
        None => "; with ignore_mimic it has its own coordinate".to_owned(),
    }
}

fn root_help(root: &str) -> &'static str {
    match root {
        "sdf" => "; this is an SDF file, which is not read",
        "Robot" | "ROBOT" => "; names are case-sensitive",
        _ => "",
    }
}

fn number_help(text: &str) -> &'static str {
    if text.contains("${") {
        " but xacro; expand the file first: xacro robot.urdf.xacro > robot.urdf"
    } else if text.contains(',') {
        "; numbers are separated by blanks and have a decimal point"
    } else {
        ""
    }
}

fn circle(joints: &[String]) -> String {
    match joints {
        [joint] => format!("joint {joint:?} mimics itself,"),
        _ => format!("the joints {} mimic one another", quoted(joints)),
    }
}

/// `x` to four digits.
pub(super) fn brief(x: f64) -> String {
    format!("{:?}", format!("{x:.3e}").parse().unwrap_or(x))
}

/// `"a", "b" and "c"`, shortened after six.
fn quoted(names: &[String]) -> String {
    const SHOWN: usize = 6;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("{name:?}")).collect();
    match (names.len().saturating_sub(SHOWN), shown.split_last()) {
        (0, Some((last, others))) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        (0, _) => shown.concat(),
        (more, _) => format!("{} and {more} more", shown.join(", ")),
    }
}
