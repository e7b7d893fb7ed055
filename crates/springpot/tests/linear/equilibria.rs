//! Where robots come to rest.

use crate::support::forward::every;
use crate::support::{run, system};
use crate::{arm, on_joints, slider};
use springpot::linear::LinearError;

const DAMPED: [&str; 3] = [
    "law = \"kelvin-voigt\"\nparameters = { k = 20, c = 30 }",
    "network = \"parallel(polynomial(k1, k2, k3), dashpot(c), series(spring(k1), dashpot(c)))\"\n\
     parameters = { k1 = 15, k2 = 0, k3 = 40, c = 20 }",
    "network = \"series(parallel(spring(k), dashpot(c)), parallel(spring(k_2), dashpot(c)))\"\n\
     parameters = { k = 30, k_2 = 50, c = 9 }",
];

#[test]
fn it_is_where_a_long_run_ends() {
    let motion = "start = { q = { q2 = -0.8, q3 = 0.5 } }\ntorque = { q1 = 2, q3 = -1.5 }";
    let text = arm(&on_joints(DAMPED), motion);
    let found = system(&text).equilibrium(&[0.0, -0.8, 0.5], 0.0).unwrap();
    assert!(found.residual < 1e-12, "{found:?}");
    let long = text.replace("[time]\nend = 1\noutput_step = 0.5\n", &every(120.0, 120.0, 1e-8));
    let rows = run(&long);
    for (j, q) in found.q.iter().enumerate() {
        let end = *rows.column(&format!("q.q{}", j + 1)).last().unwrap();
        assert!((end - q).abs() < 1e-6, "q{}: {end} {q}", j + 1);
    }
    let about = system(&text).linearised(&found.q, 0.0).unwrap();
    assert_eq!(about.largest_left_over(), None);
    assert!(system(&text).linearised(&[0.0, -0.8, 0.5], 0.0).unwrap().largest_left_over().is_some());
}

#[test]
fn pendulums_hang_and_springs_that_buckle_give_way() {
    let hanging = system(&arm("", "start = { q = { q2 = -1.2, q3 = 0.2 } }"));
    let found = hanging.equilibrium(&[0.0, -1.2, 0.2], 0.0).unwrap();
    let stable = hanging.linearised(&found.q, 0.0).unwrap().modes().unwrap();
    assert!(stable.modes.iter().all(|mode| !mode.is_unstable()) && stable.free_motions == 1, "{found:?} {stable:?}");
    // Two wells: F = −30 x + 100 x³ is 0 at √0.3.
    let wells = "network = \"polynomial(k1, k2, k3)\"\nparameters = { k1 = -30, k2 = 0, k3 = 100 }";
    let text = slider(1.0, wells, "start = { q = { x = -0.01 } }", "[time]\nend = 1\noutput_step = 1");
    let found = system(&text).equilibrium(&[-0.01], 0.0).unwrap();
    assert!((found.q[0] + 0.3f64.sqrt()).abs() < 1e-12, "{found:?}");
}

#[test]
fn what_nothing_holds_is_refused() {
    let time = "[time]\nend = 1\noutput_step = 1";
    let flowing = "law = \"maxwell\"\nparameters = { k = 100, c = 5 }";
    let pushed = system(&slider(1.0, flowing, "torque = { x = 3 }", time));
    match pushed.equilibrium(&[0.0], 0.0) {
        Err(LinearError::NothingHolds { joint, torque, unit }) => {
            assert_eq!((joint.as_str(), torque, unit), ("x", 3.0, "N"));
        }
        other => panic!("{other:?}"),
    }
    let text = arm("", "").replace("kind = \"forward\"", "kind = \"prescribed\"\njoints = { q1 = 0, q2 = 0, q3 = 0 }");
    assert_eq!(system(&text).equilibrium(&[0.0; 3], 0.0), Err(LinearError::Given));
}
