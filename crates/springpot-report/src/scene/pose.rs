//! Where the bodies of a scene are, from the values of a row.

use super::{Body, Freedom, Joint, Scene};
use crate::vector::norm;
use std::f64::consts::TAU;

const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];

/// Joints that follow one another, at most.
const MOST_FOLLOWERS: usize = 16;
/// A quaternion that is shorter is none.
const LEAST_NORM: f64 = 1e-9;

/// A turn, then a shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Unit quaternion x, y, z, w.
    pub turn: [f64; 4],
    /// m.
    pub shift: [f64; 3],
}

impl Placement {
    /// Nothing turned, nothing shifted.
    pub const IDENTITY: Self = Self { turn: [0.0, 0.0, 0.0, 1.0], shift: [0.0; 3] };

    /// A frame at `origin`, m, turned by R = Rz(yaw) Ry(pitch) Rx(roll), rad.
    pub fn new(origin: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        let ((sr, cr), (sp, cp), (sy, cy)) = ((roll / 2.0).sin_cos(), (pitch / 2.0).sin_cos(), (yaw / 2.0).sin_cos());
        let turn = [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ];
        Self { turn, shift: origin }
    }

    /// By `angle`, rad, about a unit vector.
    pub fn about(axis: [f64; 3], angle: f64) -> Self {
        let (s, c) = (angle / 2.0).sin_cos();
        Self { turn: [s * axis[0], s * axis[1], s * axis[2], c], shift: [0.0; 3] }
    }

    /// A placement that is given in this frame, in the frame that this one is given in.
    pub fn of(&self, inner: &Self) -> Self {
        let ([ax, ay, az, aw], [bx, by, bz, bw]) = (self.turn, inner.turn);
        let turn = [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ];
        Self { turn, shift: self.point(inner.shift) }
    }

    /// A point of this frame.
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.direction(point);
        [0, 1, 2].map(|k| turned[k] + self.shift[k])
    }

    /// A direction of this frame.
    pub fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c, w] = self.turn;
        // p + 2 w (u × p) + 2 u × (u × p)
        let [tx, ty, tz] = [2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)];
        [x + w * tx + b * tz - c * ty, y + w * ty + c * tx - a * tz, z + w * tz + a * ty - b * tx]
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.turn.iter().chain(&self.shift).all(|number| number.is_finite())
    }
}

/// What moves a joint: a column, scaled and shifted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Its index in a row.
    pub column: usize,
    /// Coordinate over value.
    pub ratio: f64,
    /// rad or m.
    pub offset: f64,
}

impl Drive {
    /// The coordinate in a row.
    pub fn value(&self, row: &[f64]) -> f64 {
        self.ratio * row[self.column] + self.offset
    }
}

/// What a joint does in a row.
#[derive(Debug, Clone, Copy)]
enum Motion {
    None,
    Turn([f64; 3], Option<Drive>),
    Slide([f64; 3], Option<Drive>),
    /// With the shift in m/rad.
    Screw([f64; 3], f64, Option<Drive>),
    /// A quaternion.
    Ball([usize; 4]),
    /// A position and a quaternion.
    Float([usize; 3], [usize; 4]),
}

/// The tree of a scene, ready to be placed.
#[derive(Debug, Clone)]
pub struct Kinematics {
    bodies: Vec<(Option<usize>, Placement, Motion)>,
    missing: Vec<String>,
}

impl Kinematics {
    /// Of a scene, and what tells the index of a column by its name.
    pub fn new(scene: &Scene, column: impl Fn(&str) -> Option<usize>) -> Self {
        let mut missing = Vec::new();
        let mut bodies = Vec::with_capacity(scene.bodies.len());
        for (index, body) in scene.bodies.iter().enumerate() {
            let motion = motion(&scene.bodies, &body.joint, &column);
            if matches!(motion, Motion::Turn(_, None) | Motion::Slide(_, None) | Motion::Screw(_, _, None))
                || body.joint.kind != Freedom::Fixed && matches!(motion, Motion::None)
            {
                missing.push(body.joint.name.clone());
            }
            // Parents stand before their children; what does not is no parent.
            let parent = body.parent.filter(|parent| *parent < index);
            bodies.push((parent, Placement::new(body.origin, body.rpy), motion));
        }
        Self { bodies, missing }
    }

    /// Names of joints that move, but of whose coordinates there are no columns: they rest at zero.
    pub fn missing(&self) -> &[String] {
        &self.missing
    }

    /// The body that carries a body; `None`: the world.
    pub fn parent(&self, body: usize) -> Option<usize> {
        self.bodies[body].0
    }

    /// What moves the joint of a body that has one coordinate; `None` where there is no column of it.
    pub fn drive(&self, body: usize) -> Option<Drive> {
        match self.bodies[body].2 {
            Motion::Turn(_, drive) | Motion::Slide(_, drive) | Motion::Screw(_, _, drive) => drive,
            _ => None,
        }
    }

    /// Every body in the frame of its parent.
    pub fn local(&self, row: &[f64]) -> Vec<Placement> {
        let one = |(_, origin, motion): &(_, Placement, Motion)| {
            let value = |drive: &Option<Drive>| drive.map_or(0.0, |drive| drive.value(row));
            match motion {
                Motion::None => *origin,
                Motion::Turn(axis, drive) => origin.of(&Placement::about(*axis, value(drive))),
                Motion::Slide(axis, drive) => {
                    origin.of(&Placement { shift: axis.map(|along| along * value(drive)), ..Placement::IDENTITY })
                }
                Motion::Screw(axis, pitch, drive) => {
                    let angle = value(drive);
                    let turn = Placement::about(*axis, angle);
                    origin.of(&Placement { shift: axis.map(|along| along * pitch * angle), ..turn })
                }
                Motion::Ball(columns) => {
                    origin.of(&Placement { turn: unit(columns.map(|column| row[column])), shift: [0.0; 3] })
                }
                Motion::Float(shift, turn) => origin.of(&Placement {
                    turn: unit(turn.map(|column| row[column])),
                    shift: shift.map(|column| row[column]),
                }),
            }
        };
        self.bodies.iter().map(one).collect()
    }

    /// Every body in the world, from what [`Self::local`] tells.
    pub fn world(&self, local: &[Placement]) -> Vec<Placement> {
        let mut placed: Vec<Placement> = Vec::with_capacity(local.len());
        for ((parent, ..), own) in self.bodies.iter().zip(local) {
            placed.push(parent.map_or(*own, |parent| placed[parent].of(own)));
        }
        placed
    }
}

fn motion(bodies: &[Body], joint: &Joint, column: &impl Fn(&str) -> Option<usize>) -> Motion {
    let length = norm(joint.axis);
    let axis = joint.axis.map(|part| if length > 0.0 { part / length } else { 0.0 });
    match joint.kind {
        Freedom::Fixed => Motion::None,
        Freedom::Revolute | Freedom::Continuous => Motion::Turn(axis, drive(bodies, joint, column)),
        Freedom::Prismatic => Motion::Slide(axis, drive(bodies, joint, column)),
        Freedom::Helical => Motion::Screw(axis, joint.lead.unwrap_or_default() / TAU, drive(bodies, joint, column)),
        Freedom::Spherical => columns(joint, QUATERNION, column).map_or(Motion::None, Motion::Ball),
        Freedom::Floating => {
            let found = columns(joint, ["x", "y", "z"], column).zip(columns(joint, QUATERNION, column));
            found.map_or(Motion::None, |(shift, turn)| Motion::Float(shift, turn))
        }
    }
}

/// The columns of these coordinates of a joint, if all are there.
fn columns<const N: usize>(
    joint: &Joint,
    parts: [&str; N],
    column: &impl Fn(&str) -> Option<usize>,
) -> Option<[usize; N]> {
    let found = parts.map(|part| column(&format!("q.{}.{part}", joint.name)));
    found.iter().all(Option::is_some).then(|| found.map(Option::unwrap_or_default))
}

/// A quaternion of length 1; unturned where it has none.
fn unit(turn: [f64; 4]) -> [f64; 4] {
    let length = norm(turn);
    if length < LEAST_NORM { Placement::IDENTITY.turn } else { turn.map(|part| part / length) }
}

/// Along the joints that it follows to the one that has a coordinate.
fn drive(bodies: &[Body], joint: &Joint, column: &impl Fn(&str) -> Option<usize>) -> Option<Drive> {
    // A sum with -0 keeps every bit.
    let (mut ratio, mut offset, mut at) = (1.0, -0.0, joint);
    for _ in 0..MOST_FOLLOWERS {
        let Some(follows) = &at.follows else { break };
        offset += ratio * follows.offset;
        ratio *= follows.ratio;
        match bodies.iter().find(|body| body.joint.name == follows.joint) {
            Some(leader) => at = &leader.joint,
            // The leader may be absent from the tree; its column still is the coordinate.
            None => return Some(Drive { column: column(&format!("q.{}", follows.joint))?, ratio, offset }),
        }
    }
    Some(Drive { column: column(&format!("q.{}", at.name))?, ratio, offset })
}
