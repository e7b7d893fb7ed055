//! Along its axis a prismatic joint and the line between two points of the axis measure the same.

use crate::support::largest;
use crate::systems::*;
use springpot::elements::{Line, Measure};
use springpot::law::Derivative;
use springpot::methods::fixed::Method;
use springpot::model::{Anchor, BodySpec, JointSpec, Model, ModelBuilder, Parent};
use springpot::system::{Motion, Settings};

/// Distance of the slider from the world's origin where its joint stands at 0.
const REACH: f64 = 2.0;

/// A slider along a slanted axis through the world's origin, with an arm on it.
fn slider() -> Model {
    let axis = [0.48, 0.6, 0.64];
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    let joint = JointSpec::prismatic("slide", axis, axis.map(|x| REACH * x));
    let slider = builder.push(body("slider", Parent::World, joint)).unwrap();
    let swing = JointSpec::revolute("swing", [0.0, 1.0, 0.0], [0.1, 0.0, 0.0]);
    builder.push(BodySpec { mass: 0.5, ..body("arm", Parent::Body(slider), swing) }).unwrap();
    builder.finish().unwrap()
}

/// Largest difference of all columns with a line and with the joint, in units of the largest value, at least 1.
fn apart(derivative: Derivative, law: (&str, &[f64]), motion: &dyn Fn() -> Motion, settings: &Settings) -> f64 {
    let of = |on_joint: bool| {
        let model = slider();
        let site = |body| model.resolve(&Anchor { body, point: [0.0; 3] }).unwrap();
        let line = Line { from: site(Parent::World), to: site(Parent::Body(0)) };
        let (measure, rest) =
            if on_joint { (Measure::from(joint(&model, "slide")), -0.1) } else { (line.into(), REACH - 0.1) };
        let e = element_with(derivative, "e", measure, rest, law);
        run(&system(model, vec![e], motion()), settings)
    };
    let [line, joint] = [false, true].map(of);
    let mut worst = 0.0f64;
    for name in line.names.iter().filter(|name| *name != "e.length" && *name != "energy.residual") {
        let (a, b) = (line.column(name), joint.column(name));
        for (a, b) in a.iter().zip(&b) {
            assert_eq!(a.is_nan(), b.is_nan(), "{name}");
        }
        let off = a.iter().zip(&b).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        worst = worst.max(off / largest(&a).max(1.0));
    }
    worst
}

#[test]
fn a_prismatic_joint_is_the_line_along_its_axis() {
    let laws: [(&str, &[f64]); 4] = [
        ("spring", &[80.0]),
        ("dashpot", &[9.0]),
        ("springpot", &[30.0, 0.4]),
        ("fractional-kelvin-voigt", &[80.0, 20.0, 0.6]),
    ];
    let kinds = [Derivative::Caputo, Derivative::RiemannLiouville];
    for (law, derivative) in laws.into_iter().flat_map(|law| kinds.map(|kind| (law, kind))) {
        let given = apart(derivative, law, &|| given(&["0.2*sin(3*t)", "0.4*cos(2*t)"]).into(), &settings(1.0, 1e-10));
        let fall = || free(&[0.05, 0.3], &[0.4, -0.5]).into();
        let forward = apart(derivative, law, &fall, &settings(1.0, 1e-11));
        let fixed = apart(derivative, law, &fall, &in_steps(1.0, Method::Midpoint, 1e-3));
        println!("{law:?} {derivative:?}: {given:.1e} {forward:.1e} {fixed:.1e}");
        assert!(given < 1e-12 && forward < 1e-9 && fixed < 1e-9, "{law:?}: {given:e} {forward:e} {fixed:e}");
    }
}
