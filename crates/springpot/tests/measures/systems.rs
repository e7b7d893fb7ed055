//! Systems built in code: elements on joints are no part of scenarios.

use crate::support::{Run, run_system};
use springpot::actuation::{Drive, Forward};
use springpot::elements::{Element, Joint, Measure};
use springpot::law::{Catalog, Derivative};
use springpot::methods::fixed::Method;
use springpot::model::{BodySpec, JointKind, JointSpec, Mimic, Model, ModelBuilder, Parent};
use springpot::motion::{JointPath, Trajectory};
use springpot::signal::{Expression, Signal};
use springpot::system::{FixedStep, Motion, RowTimes, Settings, System};

pub(crate) fn signal(text: &str) -> Signal {
    Signal::expression(Expression::parse(text).unwrap())
}

/// An element named `name` with Caputo's derivative.
pub(crate) fn element(name: &str, measure: impl Into<Measure>, rest: f64, law: &str, parameters: &[f64]) -> Element {
    element_with(Derivative::Caputo, name, measure.into(), rest, (law, parameters))
}

pub(crate) fn element_with(
    derivative: Derivative,
    name: &str,
    measure: Measure,
    rest: f64,
    (law, parameters): (&str, &[f64]),
) -> Element {
    Element::new(name, measure, rest, Catalog::standard().get(law).unwrap(), parameters, derivative).unwrap()
}

pub(crate) fn body(name: &str, parent: Parent, joint: JointSpec) -> BodySpec {
    let inertia = [[0.3, 0.01, 0.0], [0.01, 0.2, 0.02], [0.0, 0.02, 0.25]];
    BodySpec { name: name.into(), parent, joint, mass: 2.0, com: [0.2, -0.05, 0.1], inertia }
}

/// Ratio and offset with which `follower` follows `knee`.
pub(crate) const FOLLOWS: (f64, f64) = (-1.6, 0.3);

/// A chain of turn (revolute), rail (prismatic) and knee (revolute), and beside it a follower of the knee.
pub(crate) fn arm(gravity: [f64; 3]) -> Model {
    let mut builder = ModelBuilder::new(gravity);
    let turn = builder.push(body("a", Parent::World, JointSpec::revolute("turn", [0.1, 0.2, 1.0], [0.0; 3]))).unwrap();
    let rail = JointSpec::prismatic("rail", [1.0, 0.0, 0.2], [0.1, 0.0, 0.3]);
    let rail = builder.push(body("b", Parent::Body(turn), rail)).unwrap();
    let knee = JointSpec::revolute("knee", [0.0, 1.0, 0.3], [0.4, 0.0, 0.0]);
    let knee = builder.push(body("c", Parent::Body(rail), knee)).unwrap();
    let (multiplier, offset) = FOLLOWS;
    let mimic = Some(Mimic { joint: "knee".into(), multiplier, offset });
    let follower = JointSpec { mimic, ..JointSpec::revolute("follower", [0.0, 1.0, 0.0], [0.3, 0.1, 0.0]) };
    builder.push(body("d", Parent::Body(knee), follower)).unwrap();
    builder.push(body("e", Parent::Body(knee), JointSpec::fixed("weld", [0.1; 3]))).unwrap();
    builder.finish().unwrap()
}

/// One joint about or along x, with inertia 0.5 kg m² or mass 0.5 kg and nothing else.
pub(crate) fn single(kind: JointKind) -> Model {
    let mut builder = ModelBuilder::new([0.0; 3]);
    let joint = JointSpec { kind, ..JointSpec::revolute("q", [1.0, 0.0, 0.0], [0.0; 3]) };
    let inertia = [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]];
    let spec = BodySpec { name: "b".into(), parent: Parent::World, joint, mass: 0.5, com: [0.0; 3], inertia };
    builder.push(spec).unwrap();
    builder.finish().unwrap()
}

pub(crate) fn joint(model: &Model, name: &str) -> Joint {
    Joint::named(model, name).unwrap()
}

pub(crate) fn system(model: Model, elements: Vec<Element>, motion: impl Into<Motion>) -> System {
    let motion = motion.into();
    System::new(model, elements, motion)
}

/// Forward dynamics without actuators.
pub(crate) fn free(q: &[f64], v: &[f64]) -> Forward {
    let drives = q.iter().map(|_| Drive::Force(vec![Signal::constant(0.0)])).collect();
    Forward { q: q.to_vec(), v: v.to_vec(), drives }
}

/// Joints of one degree along signals.
pub(crate) fn given(paths: &[&str]) -> Trajectory {
    Trajectory::Prescribed(paths.iter().map(|path| JointPath::Coordinate(signal(path))).collect())
}

/// 40 rows.
pub(crate) fn settings(end: f64, rtol: f64) -> Settings {
    Settings {
        rtol,
        memory_rtol: (rtol / 100.0).max(1e-13),
        ..Settings::new(end, RowTimes::Step { step: end / 40.0, end })
    }
}

pub(crate) fn in_steps(end: f64, method: Method, step: f64) -> Settings {
    Settings { fixed_step: Some(FixedStep { method, step }), ..settings(end, 1e-10) }
}

/// A run to the end.
pub(crate) fn run(system: &System, settings: &Settings) -> Run {
    let run = run_system(system, settings);
    assert!(run.error.is_none(), "{}", run.error.unwrap());
    run
}
