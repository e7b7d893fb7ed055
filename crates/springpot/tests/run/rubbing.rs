//! Friction that sticks along motions given in advance, and in the equations of motion.

use crate::support::robots::{ARM, PATH, every, prescribed, springpot};
use crate::support::{cases, run};

/// The arm with friction that sticks in two joints.
fn rubbing() -> String {
    ARM.replace("name = \"q2\",", "name = \"q2\", friction = { force = \"0.2 N*m\", stick = true },")
        .replace("name = \"q3\",", "name = \"q3\", friction = { force = 1, stick = true },")
}

#[test]
fn friction_of_a_prescribed_joint_has_the_sign_of_its_velocity() {
    let with = |arm: &str| {
        run(&format!(
            "{arm}{}{}{}",
            springpot(0.5, "caputo"),
            prescribed("0.3*sin(2*t)", "0.2*cos(3*t)"),
            every(3.0, 0.02)
        ))
    };
    let (run, smooth) = (with(&rubbing()), with(ARM));
    let report = run.report;
    assert!(report.energy_residual.unwrap() <= 1e-9 * report.energy_turned_over.unwrap(), "{report:?}");
    // ∫ F|v| dt, from one turn to the next.
    let path = |height: f64, omega: f64, phase: f64, t: f64| {
        let x = |t: f64| height * (omega * t + phase).sin();
        let turns = (0..10).map(|k| ((f64::from(k) + 0.5) * std::f64::consts::PI - phase) / omega);
        let mut places = vec![0.0];
        places.extend(turns.filter(|turn| *turn > 0.0 && *turn < t));
        places.push(t);
        places.windows(2).map(|pair| (x(pair[1]) - x(pair[0])).abs()).sum::<f64>()
    };
    let phase = std::f64::consts::FRAC_PI_2;
    for (t, lost) in run.t().iter().zip(run.column("energy.joints")) {
        let wanted = 0.2 * path(0.3, 2.0, 0.0, *t) + path(0.2, 3.0, phase, *t);
        assert!((lost - wanted).abs() < 1e-9, "{t}: {lost} {wanted}");
    }
    for (joint, force) in [("q2", 0.2), ("q3", 1.0)] {
        let (tau, without) = (run.column(&format!("tau.{joint}")), smooth.column(&format!("tau.{joint}")));
        for ((tau, without), v) in tau.iter().zip(&without).zip(run.column(&format!("v.{joint}"))) {
            let friction = if v == 0.0 { 0.0 } else { force * v.signum() };
            assert!((tau - without - friction).abs() < 1e-12, "{tau} {without} {v}");
        }
    }
}

#[test]
fn the_balance_closes_along_a_gripper_path() {
    let run = run(&format!("{}{}{PATH}{}", rubbing(), springpot(0.5, "caputo"), every(2.0, 0.05)));
    let report = run.report;
    assert!(report.energy_residual.unwrap() <= 1e-9 * report.energy_turned_over.unwrap(), "{report:?}");
}

#[test]
fn the_equation_closes_where_joints_hold_and_where_they_slide() {
    let motion = "\n[motion]\nkind = \"forward\"\nstart = { q = { q2 = 0.1 } }\n\
                  torque = { q1 = \"0.1*sin(3*t)\", q2 = \"-12 + 14*sin(4*t)\", q3 = -3.4 }\n";
    let text = format!("{}{}{motion}{}", rubbing(), springpot(0.5, "caputo"), every(1.0, 0.05));
    let plan = cases(&text).plan(0).unwrap();
    let (system, settings) = (plan.system(), plan.settings.clone());
    let (mut held, mut slid) = (0, 0);
    for k in 0..=20 {
        let t = settings.rows.at(k);
        let equation = system.equation(&settings, t).unwrap();
        let residual = equation.residual().iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        assert!(residual < 1e-9 * equation.largest_term(), "{t}: {residual:e}");
        for (k, force) in [(1, 0.2), (2, 1.0)] {
            let (v, friction) = (equation.state.v[k], equation.joints[k]);
            if v == 0.0 {
                assert!(friction.abs() <= force * (1.0 + 1e-9), "{t}: {friction}");
                held += 1;
            } else {
                assert_eq!(friction, -force * v.signum(), "{t}");
                slid += 1;
            }
        }
    }
    assert!(held > 0 && slid > 0, "{held} {slid}");
}
