//! What a moving picture of a robot is made of: bodies on joints, elements between them, and paths. All numbers are SI, axes are those of the world, z up.

mod pose;

pub use pose::{Drive, Kinematics, Placement};

use crate::robot::ElementSign;
use serde::{Deserialize, Serialize};

/// A robot with its elements, without its motion.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Parents before children.
    pub bodies: Vec<Body>,
    /// What stands still in the world and belongs to the robot.
    pub root: Option<Root>,
    /// Where the robot stands.
    pub ground: Option<[f64; 3]>,
    /// The point whose path is drawn.
    pub gripper: Option<Spot>,
    /// Its elements.
    pub elements: Vec<SceneElement>,
    /// Where the gripper is to be.
    pub wanted: Option<Path>,
}

/// A body on its joint; its frame is that of the joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Index of the body that carries it; `None`: the world.
    pub parent: Option<usize>,
    /// Origin of the joint's frame in that of the parent, m.
    pub origin: [f64; 3],
    /// Roll, pitch and yaw against the parent's frame, R = Rz(yaw) Ry(pitch) Rx(roll), rad.
    pub rpy: [f64; 3],
    /// The joint.
    pub joint: Joint,
    /// Centre of mass in its frame, m.
    pub com: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
    /// What it looks like, where that is known.
    pub visuals: Vec<Visual>,
}

/// What a joint does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Its name; columns are `q.<name>`.
    pub name: String,
    /// How it moves.
    pub kind: Freedom,
    /// Its axis in its frame.
    pub axis: [f64; 3],
    /// Of a helical joint: the advance along the axis per turn, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lead: Option<f64>,
    /// What its velocity is called, where that is not its own name; columns are `v.<rate>`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<String>,
    /// The joint that it follows, if it has no coordinate of its own.
    pub follows: Option<Follows>,
}

/// The kinds of joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Freedom {
    /// Not at all.
    Fixed,
    /// About the axis, rad.
    Revolute,
    /// About the axis, without limits, rad.
    Continuous,
    /// Along the axis, m.
    Prismatic,
    /// About the axis, rad, and along it by the lead in each turn.
    Helical,
    /// A quaternion, columns `.qx` … `.qw`.
    Spherical,
    /// Freely: position in the parent's frame and a quaternion, columns `.x` … `.z` and `.qx` … `.qw`.
    Floating,
}

/// coordinate = ratio · (coordinate of `joint`) + offset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Follows {
    /// Name of the other joint.
    pub joint: String,
    /// Ratio of the speeds.
    pub ratio: f64,
    /// rad or m.
    pub offset: f64,
}

/// A shape on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Visual {
    /// Its origin in the body's frame, m.
    pub origin: [f64; 3],
    /// Roll, pitch and yaw, rad.
    pub rpy: [f64; 3],
    /// Red, green, blue and opacity, 0 … 1.
    pub color: Option<[f64; 4]>,
    /// What it is.
    pub shape: Shape,
}

/// What a [`Visual`] is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// A file of triangles.
    Mesh {
        /// Where it is.
        path: String,
        /// Factors along its axes.
        scale: [f64; 3],
    },
    /// Full sizes, m.
    Box([f64; 3]),
    /// Radius and length along z, centred, m.
    Cylinder(f64, f64),
    /// Radii along its axes, m.
    Ellipsoid([f64; 3]),
    /// Radius, m.
    Sphere(f64),
}

/// What does not move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Root {
    /// Its name.
    pub name: String,
    /// What it looks like.
    pub visuals: Vec<Visual>,
}

/// A point of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spot {
    /// Index of the body; `None`: the world.
    pub body: Option<usize>,
    /// In the body's frame, m.
    pub point: [f64; 3],
}

/// A frame of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Placed {
    /// Index of the body; `None`: the world.
    pub body: Option<usize>,
    /// Its origin, m.
    pub point: [f64; 3],
    /// Roll, pitch and yaw, rad.
    pub rpy: [f64; 3],
}

/// An element, or the components of one that are drawn together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SceneElement {
    /// Its name; columns begin with it.
    pub name: String,
    /// What its law holds.
    pub sign: ElementSign,
    /// Whether its force can let go.
    pub contact: bool,
    /// Where it is.
    pub shape: SceneShape,
}

/// Where an element is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SceneShape {
    /// From point to point, two or more.
    Points(Vec<Spot>),
    /// At a joint.
    Joint {
        /// Index of the body on it.
        body: usize,
        /// Its axis in the body's frame.
        axis: [f64; 3],
        /// Whether it turns.
        turns: bool,
    },
    /// Between two frames.
    Bushing {
        /// The frame whose axes count.
        from: Placed,
        /// The other one.
        to: Placed,
        /// Names of the elements that are its components.
        parts: Vec<String>,
    },
}

/// A path in the world.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// s.
    pub t: Vec<f64>,
    /// m.
    pub x: Vec<f64>,
    /// m.
    pub y: Vec<f64>,
    /// m.
    pub z: Vec<f64>,
}

/// What is said of an element beside its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawText {
    /// Name of the element.
    pub name: String,
    /// Name of its law, or its network.
    pub law: String,
    /// The law in one line.
    pub equation: String,
    /// Where the law comes from.
    pub source: String,
    /// Its parts, drawn with characters.
    #[serde(default)]
    pub drawing: Option<String>,
    /// Its complex modulus K*(ω) as a formula, where it is linear.
    #[serde(default)]
    pub modulus: Option<String>,
    /// The force that a step of the stroke to 1 leaves, as a formula, where there is a closed form.
    #[serde(default)]
    pub relaxation: Option<String>,
    /// Values of the parameters in the first case.
    pub parameters: Vec<Parameter>,
    /// Names of its inputs with what drives them.
    pub inputs: Vec<Driven>,
}

/// A parameter of a law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// SI.
    pub value: f64,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What it is.
    pub meaning: String,
}

/// An input of a law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Its name.
    pub name: String,
    /// As written.
    pub written: String,
    /// Its unit.
    pub unit: String,
}
