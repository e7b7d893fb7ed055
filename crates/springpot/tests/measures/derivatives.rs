//! Gradients and rates against finite differences, on random trees.

use crate::random::{case, close, config, difference, largest, one_degree_case, time_difference};
use proptest::prelude::*;
use springpot::dynamics::Kinematics;
use springpot::elements::{Joint, JointMeasureError, Line, Measure};
use springpot::model::{Dimension, Model};

/// Distances below this make differences inaccurate.
const SHORTEST: f64 = 0.15;

/// y of a measure at q.
fn coordinate<'a>(model: &'a Model, measure: &'a Measure, v: &'a [f64]) -> impl Fn(&[f64]) -> Vec<f64> + 'a {
    move |q| vec![measure.read(model, &Kinematics::at_velocity(model, q, v)).0.coordinate]
}

/// Compares gradient and rate with differences of y.
fn check(case: &crate::random::Case, model: &Model, measure: &Measure, tolerance: f64) -> Result<(), TestCaseError> {
    let (reading, gradient) = measure.read(model, &Kinematics::at_velocity(model, &case.q, &case.v));
    reading.check().unwrap();
    let y = coordinate(model, measure, &case.v);
    let slopes: Vec<f64> = (0..model.nv()).map(|k| difference(model, &case.q, k, &y)[0]).collect();
    close("gradient", &gradient, &slopes, tolerance, largest(&gradient).max(1.0));
    let along: f64 = gradient.iter().zip(&case.v).map(|(g, v)| g * v).sum();
    prop_assert!((reading.rate - along).abs() <= 1e-12 * (1.0 + along.abs()), "{} {along}", reading.rate);
    let by_time = time_difference(model, case, |q, _| y(q))[0];
    let off = (reading.rate - by_time).abs();
    prop_assert!(off <= 100.0 * tolerance * (1.0 + by_time.abs()), "{} {by_time}", reading.rate);
    Ok(())
}

proptest! {
    #![proptest_config(config(0x5eed_0031))]

    #[test]
    fn of_joints(case in case()) {
        let model = case.model();
        for j in 0..model.joint_count() {
            let name = &model.joint_names()[j];
            let Some(dimension) = model.joint_space(j).dimension() else {
                let kind = model.described_joint(j).kind;
                let error = JointMeasureError::Kind { joint: name.clone(), kind };
                prop_assert_eq!(Joint::new(&model, j), Err(error.clone()));
                prop_assert_eq!(Joint::named(&model, name), Err(error));
                continue;
            };
            let measure = Measure::from(Joint::new(&model, j).unwrap());
            prop_assert_eq!(&measure, &Joint::named(&model, name).unwrap().into());
            prop_assert_eq!(measure.is_rotation(), dimension == Dimension::Angle);
            check(&case, &model, &measure, 1e-10)?;
        }
    }

    #[test]
    fn of_joints_that_follow(case in one_degree_case()) {
        let model = case.model();
        for j in 0..model.joint_count() {
            let measure = Measure::from(Joint::new(&model, j).unwrap());
            check(&case, &model, &measure, 1e-10)?;
            let (_, ratio, offset) = model.followed(j).unwrap_or((j, 1.0, 0.0));
            let own = ratio * case.q[model.q_range(j).start] + offset;
            let y = coordinate(&model, &measure, &case.v)(&case.q)[0];
            prop_assert!((y - own).abs() <= 1e-15 * (1.0 + own.abs()), "{y} {own}");
        }
    }

    #[test]
    fn of_lines(case in case()) {
        let model = case.model();
        let [from, to] = case.sites(&model);
        let measure = Measure::from(Line { from, to });
        prop_assume!(coordinate(&model, &measure, &case.v)(&case.q)[0] > SHORTEST);
        check(&case, &model, &measure, 1e-7)?;
    }
}
