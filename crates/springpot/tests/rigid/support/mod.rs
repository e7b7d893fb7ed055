//! Random trees of joints and bodies, and comparisons.

#![allow(dead_code, reason = "every test file uses its own share")]

pub(crate) mod robots;

use proptest::collection::vec;
use proptest::prelude::*;
use springpot::model::{Anchor, BodySpec, JointKind, JointSpec, Mimic, Model, ModelBuilder, Parent, Site};
use springpot::spatial::{Rotation, Symmetric3};

pub(crate) const GRAVITY: [f64; 3] = [0.3, -0.7, -9.81];

pub(crate) fn config(seed: u64) -> ProptestConfig {
    ProptestConfig {
        cases: 256,
        rng_seed: proptest::test_runner::RngSeed::Fixed(seed),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn vector(size: f64) -> impl Strategy<Value = [f64; 3]> {
    proptest::array::uniform3(-size..size)
}

/// Inertia R diag(b + c, a + c, a + b) Rᵀ with positive second moments a, b, c: a mass distribution exists.
fn inertia() -> impl Strategy<Value = [[f64; 3]; 3]> {
    (proptest::array::uniform3(0.005..0.3), vector(3.0)).prop_map(|([a, b, c], rpy)| {
        let principal = Symmetric3 { xx: b + c, yy: a + c, zz: a + b, ..Symmetric3::ZERO };
        principal.rotated(&Rotation::from_rpy(rpy)).to_matrix()
    })
}

/// Which joints a random tree may have.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
enum Joints {
    /// Fixed ones and chains of turns, shifts and screws.
    Plain,
    /// And such that follow others.
    OneDegree,
    /// And spherical and floating ones.
    All,
}

fn kind(joints: Joints) -> impl Strategy<Value = JointKind> {
    let of_all = |kind| if joints == Joints::All { kind } else { JointKind::Continuous };
    prop_oneof![
        6 => Just(JointKind::Revolute),
        3 => Just(JointKind::Prismatic),
        2 => Just(JointKind::Fixed),
        3 => Just(of_all(JointKind::Floating)),
        2 => Just(of_all(JointKind::Spherical)),
        2 => Just(JointKind::Helical),
        1 => Just(JointKind::Cylindrical),
        1 => Just(JointKind::Universal),
        1 => Just(JointKind::Planar),
    ]
}

/// Any direction, the six coordinate directions included.
fn axis() -> impl Strategy<Value = [f64; 3]> {
    let coordinate = (0..3usize, any::<bool>()).prop_map(|(k, negative)| {
        let mut axis = [0.0; 3];
        axis[k] = if negative { -2.0 } else { 1.0 };
        axis
    });
    let any_axis = vector(2.0).prop_filter("too short", |a| a.iter().map(|x| x * x).sum::<f64>() > 0.01);
    prop_oneof![1 => coordinate, 3 => any_axis]
}

fn body(joints: Joints) -> impl Strategy<Value = BodySpec> {
    let screw = (0.3..2.0, any::<bool>()).prop_map(|(lead, back): (f64, bool)| if back { -lead } else { lead });
    let armature = prop_oneof![1 => Just([0.0; 3]), 1 => proptest::array::uniform3(0.0..0.5)];
    let joint = (kind(joints), axis(), axis(), vector(0.8), vector(3.0), screw, armature);
    (joint, 0.1..5.0, vector(0.4), inertia()).prop_map(
        |((kind, axis, axis2, origin, rpy, lead, armature), mass, com, inertia)| {
            let along: f64 = axis.iter().zip(&axis2).map(|(x, y)| x * y).sum();
            let lengths: f64 =
                [axis, axis2].iter().map(|axis| axis.iter().map(|x| x * x).sum::<f64>().sqrt()).product();
            // Nearly parallel axes are nearly one: nothing can be told of them to many digits.
            let axis2 = if along.abs() > 0.9 * lengths { [axis[1], axis[2], -axis[0] - 0.5] } else { axis2 };
            BodySpec {
                name: String::new(),
                parent: Parent::World,
                joint: JointSpec { kind, rpy, axis2, lead, armature, ..JointSpec::revolute("", axis, origin) },
                mass,
                com,
                inertia,
            }
        },
    )
}

/// A robot with a state and two anchors on bodies chosen at random (the world included).
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) bodies: Vec<BodySpec>,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) a: Vec<f64>,
    pub(crate) anchors: [Anchor; 2],
}

impl Case {
    pub(crate) fn model(&self) -> Model {
        build(&self.bodies)
    }

    pub(crate) fn sites(&self, model: &Model) -> [Site; 2] {
        self.anchors.map(|anchor| model.resolve(&anchor).unwrap())
    }
}

pub(crate) fn build(bodies: &[BodySpec]) -> Model {
    let mut builder = ModelBuilder::new(GRAVITY);
    for body in bodies {
        builder.push(body.clone()).unwrap();
    }
    builder.finish().unwrap()
}

/// Trees of 1 to 8 bodies with all kinds of joints, half of them single chains, with at least one moving joint.
pub(crate) fn case() -> impl Strategy<Value = Case> {
    case_of(Joints::All)
}

/// The same with joints of one degree, some of which follow others.
pub(crate) fn one_degree_case() -> impl Strategy<Value = Case> {
    case_of(Joints::OneDegree)
}

/// The same with joints of one degree, each with its own coordinate.
pub(crate) fn plain_case() -> impl Strategy<Value = Case> {
    case_of(Joints::Plain)
}

fn case_of(joints: Joints) -> impl Strategy<Value = Case> {
    let state = (vec(-3.0..3.0, 56), vec(-2.0..2.0, 48), vec(-4.0..4.0, 48));
    let anchors = proptest::array::uniform2((0usize..9, vector(0.5)));
    let follows = vec((0usize..24, -1.5..1.5f64, -0.5..0.5), 8);
    (vec((body(joints), 0usize..8), 1..=8), any::<bool>(), state, anchors, follows).prop_map(
        move |(mut bodies, chain, (q, v, a), anchors, follows)| {
            bodies[0].0.joint.kind = match bodies[0].0.joint.kind {
                JointKind::Fixed => JointKind::Revolute,
                kind => kind,
            };
            let parent = |k: usize, drawn: usize| match if chain { k } else { drawn % (k + 1) } {
                0 => Parent::World,
                number => Parent::Body(number - 1),
            };
            let count = bodies.len();
            let mut bodies: Vec<BodySpec> = bodies
                .into_iter()
                .enumerate()
                .map(|(k, (body, drawn))| BodySpec {
                    name: format!("b{k}"),
                    parent: parent(k, drawn),
                    joint: JointSpec { name: format!("j{k}"), ..body.joint },
                    ..body
                })
                .collect();
            if joints > Joints::Plain {
                for (k, &(target, multiplier, offset)) in follows.iter().enumerate().take(count) {
                    let moves = |k: usize| bodies[k].joint.kind.nv() == 1;
                    // Only a joint without followers of its own may follow, so that there is no circle.
                    let leads = |k: usize| {
                        bodies.iter().any(|b| b.joint.mimic.as_ref().is_some_and(|m| m.joint == format!("j{k}")))
                    };
                    if target < count
                        && target != k
                        && moves(k)
                        && moves(target)
                        && !leads(k)
                        && bodies[target].joint.mimic.is_none()
                    {
                        let joint = format!("j{target}");
                        bodies[k].joint.mimic = Some(Mimic { joint, multiplier, offset });
                    }
                }
            }
            let model = build(&bodies);
            let mut q = q[..model.nq()].to_vec();
            model.normalise(&mut q);
            let (v, a) = (v[..model.nv()].to_vec(), a[..model.nv()].to_vec());
            Case {
                q,
                v,
                a,
                anchors: anchors.map(|(drawn, point)| Anchor { body: parent(count, drawn), point }),
                bodies,
            }
        },
    )
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Asserts |x − y| ≤ tolerance · scale, entry by entry.
#[track_caller]
pub(crate) fn close(what: &str, x: &[f64], y: &[f64], tolerance: f64, scale: f64) {
    assert_eq!(x.len(), y.len(), "{what}");
    for (k, (x, y)) in x.iter().zip(y).enumerate() {
        assert!((x - y).abs() <= tolerance * scale, "{what}[{k}]: {x} instead of {y} (scale {scale})");
    }
}

/// Central difference of fourth order of a vector function along velocity `j` of the configuration manifold.
pub(crate) fn difference(model: &Model, q: &[f64], j: usize, f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    central(|shift| {
        let mut step = vec![0.0; model.nv()];
        step[j] = shift;
        f(&model.integrate(q, &step))
    })
}

/// The same along one entry of a vector.
pub(crate) fn plain_difference(at: &[f64], j: usize, f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    central(|shift| {
        let mut moved = at.to_vec();
        moved[j] += shift;
        f(&moved)
    })
}

/// The same along the motion q(s) = q ⊕ (s v + ½ s² a), v(s) = v + s a.
pub(crate) fn time_difference(model: &Model, case: &Case, f: impl Fn(&[f64], &[f64]) -> Vec<f64>) -> Vec<f64> {
    central(|s| {
        let step: Vec<f64> = case.v.iter().zip(&case.a).map(|(v, a)| s * v + 0.5 * s * s * a).collect();
        let v: Vec<f64> = case.v.iter().zip(&case.a).map(|(v, a)| v + s * a).collect();
        f(&model.integrate(&case.q, &step), &v)
    })
}

fn central(at: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    const STEP: f64 = 1e-3;
    let (pp, p, m, mm) = (at(2.0 * STEP), at(STEP), at(-STEP), at(-2.0 * STEP));
    (0..p.len()).map(|k| (8.0 * (p[k] - m[k]) - (pp[k] - mm[k])) / (12.0 * STEP)).collect()
}
