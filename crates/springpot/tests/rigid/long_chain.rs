//! A chain of 10⁵ links: no recursion, and time linear in the number of links.

use crate::work::Work;
use std::time::Duration;

use springpot::dynamics::{Kinematics, pair, rnea};
use springpot::model::{Anchor, BodySpec, JointSpec, ModelBuilder, Parent};

const LINKS: usize = 100_000;

#[test]
fn a_chain_of_a_hundred_thousand_links() {
    let work = Work::begin();
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    for k in 0..LINKS {
        let spec = BodySpec {
            name: format!("b{k}"),
            parent: k.checked_sub(1).map_or(Parent::World, Parent::Body),
            joint: JointSpec::revolute(format!("q{k}"), [0.0, 1.0, 0.0], [if k == 0 { 0.0 } else { 0.01 }, 0.0, 0.0]),
            mass: 0.01,
            com: [0.005, 0.0, 0.0],
            inertia: [[1e-7, 0.0, 0.0], [0.0, 1e-7, 0.0], [0.0, 0.0, 1e-7]],
        };
        builder.push(spec).unwrap();
    }
    let model = builder.finish().unwrap();
    let built = work.done();
    let zero = vec![0.0; LINKS];
    let tau = rnea(&model, &zero, &zero, &zero, &[]);
    let kinematics = Kinematics::at_velocity(&model, &zero, &zero);
    let last = model.resolve(&Anchor { body: Parent::Body(LINKS - 1), point: [0.01, 0.0, 0.0] }).unwrap();
    let base = model.resolve(&Anchor { body: Parent::World, point: [0.0; 3] }).unwrap();
    let (pair, _) = pair(&model, &kinematics, &base, &last);

    // 1000 kg, 1000 m long, held out level: the moment m g L/2, about y against z.
    assert!((tau[0] / (-1000.0 * 9.81 * 500.0) - 1.0).abs() < 1e-9, "{}", tau[0]);
    assert!((pair.length / 1000.0 - 1.0).abs() < 1e-9, "{}", pair.length);
    // About a second is wanted; a quadratic build would take minutes.
    assert!(built < Duration::from_secs(10), "{built:?}");
    println!("built in {built:?}, all in {:?}", work.done());
}
