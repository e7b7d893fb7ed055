//! On a rotation N reads N·m and m reads rad, in the columns too.

use crate::systems::*;
use springpot::elements::{Line, Measure};
use springpot::model::{Anchor, Parent};

/// Unit and meaning of the columns of an element `e`.
fn columns(law: &str, parameters: &[f64], on: Option<&str>) -> Vec<[String; 2]> {
    let model = arm([0.0; 3]);
    let site = |body| model.resolve(&Anchor { body, point: [0.1; 3] }).unwrap();
    let line = Measure::from(Line { from: site(Parent::World), to: site(Parent::Body(1)) });
    let measure = on.map_or(line, |name| joint(&model, name).into());
    let system = system(model, vec![element("e", measure, 0.0, law, parameters)], free(&[0.0; 3], &[0.0; 3]));
    let of = |name: &str| system.columns().into_iter().find(|column| column.name == name).unwrap();
    ["length", "stroke", "rate", "derivative", "force", "stored"]
        .map(|quantity| {
            let column = of(&format!("e.{quantity}"));
            [column.unit, column.meaning]
        })
        .to_vec()
}

fn units(law: &str, parameters: &[f64], on: Option<&str>) -> Vec<String> {
    columns(law, parameters, on).into_iter().map(|[unit, _]| unit).collect()
}

#[test]
fn follow_from_the_measure() {
    let rotations = ["turn", "knee", "follower"].map(Some);
    for on in rotations {
        assert_eq!(units("springpot", &[1.0, 0.5], on), ["rad", "rad", "rad/s", "rad/s^alpha", "N*m", "J"]);
        assert_eq!(units("spring", &[1.0], on), ["rad", "rad", "rad/s", "rad", "N*m", "J"]);
        assert_eq!(units("dashpot", &[1.0], on), ["rad", "rad", "rad/s", "rad/s", "N*m", "J"]);
    }
    for on in [Some("rail"), None] {
        assert_eq!(units("springpot", &[1.0, 0.5], on), ["m", "m", "m/s", "m/s^alpha", "N", "J"]);
        assert_eq!(units("spring", &[1.0], on), ["m", "m", "m/s", "m", "N", "J"]);
    }
}

#[test]
fn words_follow_from_the_measure() {
    let words = |on| columns("spring", &[1.0], on).into_iter().map(|[_, meaning]| meaning).collect::<Vec<_>>();
    assert_eq!(
        words(None),
        [
            "length of e",
            "length of e less its rest length",
            "rate of the stroke of e",
            "fractional derivative of the stroke of e",
            "force of e, positive in tension",
            "energy stored in e"
        ]
    );
    assert_eq!(
        words(Some("rail")),
        [
            "coordinate of the joint of e",
            "coordinate of the joint of e less its rest value",
            "rate of the stroke of e",
            "fractional derivative of the stroke of e",
            "force of e, positive where it drives the coordinate down",
            "energy stored in e"
        ]
    );
}
