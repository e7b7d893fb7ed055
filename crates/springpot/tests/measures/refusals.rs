//! What no element can act on.

use crate::systems::*;
use springpot::elements::{Joint, JointMeasureError, Line, Measure};
use springpot::methods::fixed::{Loop, LoopError, MemorySettings, Method};
use springpot::model::{Anchor, JointKind, JointSpec, ModelBuilder, Parent};
use springpot::system::{Motion, RunError};

#[test]
fn joints_without_one_coordinate_are_refused() {
    let mut builder = ModelBuilder::new([0.0; 3]);
    let floating = JointSpec { kind: JointKind::Floating, ..JointSpec::revolute("base", [0.0; 3], [0.0; 3]) };
    let base = builder.push(body("b", Parent::World, floating)).unwrap();
    builder.push(body("c", Parent::Body(base), JointSpec::fixed("weld", [0.1; 3]))).unwrap();
    let model = builder.finish().unwrap();
    let error = |joint: Result<Joint, JointMeasureError>| joint.unwrap_err().to_string();
    let kinds = "an element acts on the coordinate of a joint of one degree of freedom (revolute, continuous, prismatic or helical)";
    assert_eq!(error(Joint::named(&model, "base")), format!("joint \"base\" is floating: {kinds}"));
    assert_eq!(error(Joint::new(&model, 0)), format!("joint \"base\" is floating: {kinds}"));
    assert_eq!(error(Joint::named(&model, "weld")), format!("joint \"weld\" is fixed: {kinds}"));
    assert_eq!(error(Joint::named(&model, "bass")), "the robot has no joint \"bass\"");
    assert_eq!(error(Joint::new(&model, 1)), "there is no joint 1: the robot has 1 moving joints");
}

/// A joint has a direction everywhere, a line has none at length 0.
#[test]
fn lines_of_no_length_are_refused_and_joints_at_zero_are_not() {
    let of = |on_joint: bool, motion: Motion| {
        let model = single(JointKind::Prismatic);
        let site = |body| model.resolve(&Anchor { body, point: [0.0; 3] }).unwrap();
        let line = Line { from: site(Parent::World), to: site(Parent::Body(0)) };
        let measure = if on_joint { Measure::from(joint(&model, "q")) } else { line.into() };
        system(model, vec![element("e", measure, 0.0, "springpot", &[1.0, 0.5])], motion)
    };
    let settings = settings(1.0, 1e-9);
    let words = "t = 0 s: element \"e\" has no direction: its points met (length 0.0e0 m)";
    let memory = MemorySettings { tolerance: 1e-8, horizon: 10.0 };
    let at_zero: [fn() -> Motion; 2] = [|| free(&[0.0], &[1.0]).into(), || given(&["sin(3*t)"]).into()];
    for motion in at_zero {
        let refused = crate::support::run_system(&of(false, motion()), &settings).error.unwrap();
        assert!(matches!(refused, RunError::ZeroLength { .. }));
        assert_eq!(refused.to_string(), words);
        run(&of(true, motion()), &settings);
    }
    let (line, on_joint) = (of(false, at_zero[0]()), of(true, at_zero[0]()));
    for method in [Method::BackwardEuler, Method::Midpoint] {
        let refused = Loop::new(&line, method, 1e-3, memory).unwrap_err();
        assert!(matches!(refused, LoopError::Run(RunError::ZeroLength { .. })));
        assert_eq!(refused.to_string(), words);
        let mut robot = Loop::new(&on_joint, method, 1e-3, memory).unwrap();
        robot.advance(&[0.0]).unwrap();
    }
    // Through zero, back and forth.
    for motion in [|| given(&["0.5*cos(9*t)"]).into(), || free(&[0.3], &[-2.0]).into()] as [fn() -> Motion; 2] {
        let through = run(&of(true, motion()), &settings);
        let coordinates = through.column("e.length");
        assert!(coordinates.iter().any(|y| *y > 0.1) && coordinates.iter().any(|y| *y < -0.1));
        let refused = crate::support::run_system(&of(false, motion()), &settings).error.unwrap();
        assert!(matches!(refused, RunError::ZeroLength { .. }), "{refused}");
    }
}
