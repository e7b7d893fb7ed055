//! Random trees of joints and bodies, and comparisons.

#![allow(dead_code, reason = "every test file uses its own share")]

pub(crate) mod robots;

use proptest::collection::vec;
use proptest::prelude::*;
use springpot::model::{Anchor, BodySpec, JointKind, JointSpec, Model, ModelBuilder, Parent, Site};
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

fn kind() -> impl Strategy<Value = JointKind> {
    prop_oneof![4 => Just(JointKind::Revolute), 2 => Just(JointKind::Prismatic), 1 => Just(JointKind::Fixed)]
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

fn body() -> impl Strategy<Value = BodySpec> {
    (kind(), axis(), vector(0.8), vector(3.0), 0.1..5.0, vector(0.4), inertia()).prop_map(
        |(kind, axis, origin, rpy, mass, com, inertia)| BodySpec {
            name: String::new(),
            parent: Parent::World,
            joint: JointSpec { name: String::new(), kind, axis, origin, rpy, damping: 0.0, friction: 0.0 },
            mass,
            com,
            inertia,
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

/// Trees of 1 to 8 bodies, half of them single chains, with at least one moving joint.
pub(crate) fn case() -> impl Strategy<Value = Case> {
    let state = (vec(-3.0..3.0, 8), vec(-2.0..2.0, 8), vec(-4.0..4.0, 8));
    let anchors = proptest::array::uniform2((0usize..9, vector(0.5)));
    (vec((body(), 0usize..8), 1..=8), any::<bool>(), state, anchors).prop_map(
        |(mut bodies, chain, (q, v, a), anchors)| {
            bodies[0].0.joint.kind = match bodies[0].0.joint.kind {
                JointKind::Fixed => JointKind::Revolute,
                kind => kind,
            };
            let parent = |k: usize, drawn: usize| match if chain { k } else { drawn % (k + 1) } {
                0 => Parent::World,
                number => Parent::Body(number - 1),
            };
            let count = bodies.len();
            let bodies: Vec<BodySpec> = bodies
                .into_iter()
                .enumerate()
                .map(|(k, (body, drawn))| BodySpec {
                    name: format!("b{k}"),
                    parent: parent(k, drawn),
                    joint: JointSpec { name: format!("j{k}"), ..body.joint },
                    ..body
                })
                .collect();
            let moving = bodies.iter().filter(|body| body.joint.kind != JointKind::Fixed).count();
            Case {
                q: q[..moving].to_vec(),
                v: v[..moving].to_vec(),
                a: a[..moving].to_vec(),
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

/// Central difference of fourth order of a vector function along one coordinate.
pub(crate) fn difference(q: &[f64], j: usize, f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    const STEP: f64 = 1e-3;
    let at = |shift: f64| {
        let mut moved = q.to_vec();
        moved[j] += shift;
        f(&moved)
    };
    let (pp, p, m, mm) = (at(2.0 * STEP), at(STEP), at(-STEP), at(-2.0 * STEP));
    (0..p.len()).map(|k| (8.0 * (p[k] - m[k]) - (pp[k] - mm[k])) / (12.0 * STEP)).collect()
}

/// Central difference of fourth order along the motion q(s) = q + s v + ½ s² a, v(s) = v + s a at s = 0.
pub(crate) fn time_difference(case: &Case, f: impl Fn(&[f64], &[f64]) -> Vec<f64>) -> Vec<f64> {
    const STEP: f64 = 1e-3;
    let at = |s: f64| {
        let q: Vec<f64> = (0..case.q.len()).map(|k| case.q[k] + s * case.v[k] + 0.5 * s * s * case.a[k]).collect();
        let v: Vec<f64> = (0..case.q.len()).map(|k| case.v[k] + s * case.a[k]).collect();
        f(&q, &v)
    };
    let (pp, p, m, mm) = (at(2.0 * STEP), at(STEP), at(-STEP), at(-2.0 * STEP));
    (0..p.len()).map(|k| (8.0 * (p[k] - m[k]) - (pp[k] - mm[k])) / (12.0 * STEP)).collect()
}
