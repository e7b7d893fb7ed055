//! Bad input: typed errors that leave the loop usable, and refusals of scenario files.

use crate::loops::*;
use springpot::actuation::{Drive, Forward};
use springpot::law::Catalog;
use springpot::methods::fixed::{Loop, LoopError, Method};
use springpot::model::{BodySpec, JointSpec, ModelBuilder, Parent};
use springpot::signal::Signal;
use springpot::system::{RowTimes, RunError, Settings, System};
use springpot::{Simulation, dynamics};
use springpot_scenario::Scenario;

#[test]
fn steps_must_be_positive_and_motions_free() {
    let free_arm = system(&arm(&free("")));
    for step in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let error = Loop::new(&free_arm, Method::Midpoint, step, MEMORY).unwrap_err();
        assert!(matches!(error, LoopError::Step(_)), "{error}");
    }
    let given =
        "[motion]\nkind = \"prescribed\"\njoints = { q1 = 0, q2 = 0, q3 = 0 }\n[time]\nend = 1\noutput_step = 0.1\n";
    let given = system(&arm(given));
    let error = Loop::new(&given, Method::Midpoint, 1e-3, MEMORY).unwrap_err();
    assert!(matches!(error, LoopError::MotionGiven), "{error}");
    let elastic = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(""))));
    let forgetful = springpot::methods::fixed::MemorySettings { tolerance: 0.0, ..MEMORY };
    let error = Loop::new(&elastic, Method::Midpoint, 1e-3, forgetful).unwrap_err();
    assert!(matches!(error, LoopError::Run(RunError::Kernel { .. })), "{error}");
}

#[test]
fn a_torque_that_is_no_number_stops_one_step_alone() {
    let system = system(&arm(&(thermoviscoelastic(0.5, "caputo") + &free(""))));
    for method in METHODS {
        let mut robot = looped(&system, method, 1e-3, 0.1);
        let mut other = robot.clone();
        let error = robot.advance(&[0.0, f64::NAN, 0.0]).unwrap_err();
        let RunError::NotFinite { t, what, value } = error else { panic!("{error}") };
        assert!((0.1..=0.101).contains(&t) && what == "tau.q2" && value.is_nan(), "{t} {what} {value}");
        for robot in [&mut robot, &mut other] {
            robot.advance(&[0.0; 3]).unwrap();
        }
        assert_eq!(state(&robot), state(&other));
        // A force beyond all bounds has no finite answer.
        let error = robot.advance(&[0.0, 1e308, 0.0]).unwrap_err();
        assert!(matches!(error, RunError::FixedStep { .. } | RunError::ZeroLength { .. }), "{error}");
    }
}

#[test]
fn an_element_whose_points_meet_is_named() {
    let text = r#"
[[robot.body]]
name = "slider"
joint = { name = "q", kind = "prismatic", axis = [1, 0, 0], origin = [1, 0, 0] }
mass = 1
[[element]]
name = "e"
from = { body = "world", point = [0, 0, 0] }
to = { body = "slider", point = [0, 0, 0] }
rest_length = 1
law = "springpot"
parameters = { c = 1, alpha = 0.5 }
"#;
    let system = system(&format!("{text}{}", free("start = { v = { q = -8 } }")));
    for method in METHODS {
        let mut robot = Loop::new(&system, method, 1e-2, MEMORY).unwrap();
        let error = (0..100).find_map(|_| robot.advance(&[0.0]).err()).expect("the points meet");
        let RunError::ZeroLength { t, element, .. } = error else { panic!("{error}") };
        assert!((0.1..0.2).contains(&t) && element == "e", "{t} {element}");
        assert!(robot.length(0) > 0.0 && robot.t() < t);
    }
}

#[test]
fn scenario_files_are_refused_with_what_would_be_right() {
    let cases = [
        ("method = \"midpont\"\nstep = 1e-3", "names no method: \"midpont\"", "did you mean `midpoint`?"),
        ("method = 3", "method", "a text"),
        ("method = \"midpoint\"", "step", "step = \"1 ms\""),
        ("step = 1e-3", "belongs to a fixed-step method", "backward-euler"),
        ("method = \"radau\"\nstep = 1e-3", "belongs to a fixed-step method", "backward-euler"),
        ("method = \"midpoint\"\nstep = 0", "0", "positive"),
        ("method = \"midpoint\"\nstep = \"-1 ms\"", "-1 ms", "positive"),
        ("method = \"midpoint\"\nstep = \"1 mm\"", "`mm`", "this place takes `s`"),
        (
            "method = \"midpoint\"\nstep = 1e-3\nmax_step = 1",
            "has no effect with method = \"midpoint\"",
            "leave it out",
        ),
        ("metod = \"midpoint\"", "metod", "method"),
    ];
    for (solver, message, help) in cases {
        let text = arm(&format!("{}[solver]\n{solver}\n", free("")));
        let scenario = Scenario::parse(&text, "arm.toml", "").unwrap();
        let refusals = scenario.cases(&Catalog::standard()).unwrap_err().to_string();
        assert!(refusals.contains(message) && refusals.contains(help), "{solver}: {refusals}");
    }
    let fine = arm(&format!("{}[solver]\nmethod = \"radau\"\nmax_step = 0.1\n", free("")));
    assert!(Scenario::parse(&fine, "arm.toml", "").unwrap().cases(&Catalog::standard()).is_ok());
}

/// A cross that rolls about x and carries a blade that turns about z, whose moment about its own x axis is negative.
fn mixer(spin: f64) -> System {
    let body = |name: &str, parent, axis, [xx, yy, zz]: [f64; 3]| BodySpec {
        name: name.into(),
        parent,
        joint: JointSpec::revolute(format!("{name}_joint"), axis, [0.0; 3]),
        mass: 1.0,
        com: [0.0; 3],
        inertia: [[xx, 0.0, 0.0], [0.0, yy, 0.0], [0.0, 0.0, zz]],
    };
    let mut builder = ModelBuilder::new([0.0; 3]);
    builder.accept_inertia();
    builder.push(body("cross", Parent::World, [1.0, 0.0, 0.0], [5e-3; 3])).unwrap();
    builder.push(body("blade", Parent::Body(0), [0.0, 0.0, 1.0], [-0.01, 1.0, 1.0])).unwrap();
    let drives = [(); 2].map(|()| Drive::Force(vec![Signal::constant(0.0)])).into();
    System::new(builder.finish().unwrap(), Vec::new(), Forward { q: vec![0.0, spin], v: vec![0.0, -1.0], drives })
}

#[test]
fn a_mass_matrix_that_is_no_longer_positive_definite_is_met() {
    // 5e-3 - 0.01 cos² + sin² vanishes at this spin.
    let limit = (5e-3f64 / 1.01).sqrt().asin();
    let system = mixer(1.0);
    assert!(system.model.may_be_indefinite());
    for (spin, joint) in [(limit + 1e-9, None), (limit - 1e-9, Some(0))] {
        let kinematics = dynamics::Kinematics::at_position(&system.model, &[0.3, spin]);
        assert_eq!(dynamics::indefinite_joint(&system.model, &kinematics), joint);
    }
    let is_of = |error: &RunError, at: f64| match error {
        RunError::IndefiniteMassMatrix { t, joint } => joint == "cross_joint" && (t - at).abs() < 2e-3,
        _ => false,
    };
    let settings = Settings { max_step: Some(1e-3), ..Settings::new(2.0, RowTimes::Step { step: 0.1, end: 2.0 }) };
    let mut stepping = Simulation::new(system.clone(), settings.clone()).unwrap();
    let error = stepping.step_to(2.0).unwrap_err();
    assert!(is_of(&error, 1.0 - limit), "{error}");
    // However long the steps: it is met in the first turn.
    let long_steps = Settings::new(2000.0, RowTimes::Step { step: 100.0, end: 2000.0 });
    let error = Simulation::new(system.clone(), long_steps).unwrap().step_to(2000.0).unwrap_err();
    assert!(matches!(error, RunError::IndefiniteMassMatrix { t, .. } if t < 1.0), "{error}");
    for method in METHODS {
        let mut robot = Loop::new(&system, method, 1e-3, MEMORY).unwrap();
        let error = (0..2000).find_map(|_| robot.advance(&[0.0; 2]).err()).unwrap();
        assert!(is_of(&error, 1.0 - limit), "{error}");
        // The robot stays where it was.
        assert!(robot.q()[1] > limit);
    }
    // No start there, and none is found fit for one.
    let system = mixer(0.0);
    let errors = [
        Simulation::new(system.clone(), settings).map(drop).unwrap_err(),
        system.element_starts().unwrap_err(),
        match Loop::new(&system, Method::Midpoint, 1e-3, MEMORY).map(drop).unwrap_err() {
            LoopError::Run(error) => error,
            error => panic!("{error}"),
        },
    ];
    assert!(errors.iter().all(|error| is_of(error, 0.0)), "{errors:?}");
}
