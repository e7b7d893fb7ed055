//! Friction that sticks in steps of one size.

use crate::loops::*;
use springpot::methods::fixed::Loop;
use springpot::system::FixedStep;

/// Sliders along x, one on the other.
fn sliders(joints: &[(&str, &str)], motion: &str, more: &str) -> String {
    let mut text = "[robot]\n".to_owned();
    for (k, (mass, joint)) in joints.iter().enumerate() {
        text += &format!(
            "[[robot.body]]\nname = \"b{k}\"\n\
             joint = {{ name = \"q{k}\", kind = \"prismatic\", axis = [1, 0, 0], {joint} }}\nmass = {mass}\n"
        );
    }
    text + more + &format!("[motion]\nkind = \"forward\"\n{motion}\n[time]\nend = 10\noutput_step = 1\n")
}

const STICKS: &str = "friction = { force = 3, stick = true }";

#[test]
fn a_block_stops_and_stays_to_the_bit() {
    let system = system(&sliders(&[("1", STICKS)], "start = { v = { q0 = 1.5 } }", ""));
    for method in METHODS {
        let mut off = Vec::new();
        for step in [1e-3, 1e-4] {
            let mut robot = Loop::new(&system, method, step, MEMORY).unwrap();
            while robot.v()[0] != 0.0 {
                let before = robot.v()[0];
                robot.advance(&[0.0]).unwrap();
                assert!(robot.v()[0] >= 0.0 && robot.v()[0] < before);
            }
            assert!((robot.t() - 0.5).abs() < 1.5 * step, "{}", robot.t());
            off.push((robot.q()[0] - 0.375).abs());
            let rest = robot.q()[0];
            for torque in [2.9, -2.9, 0.0, 2.9999] {
                for _ in 0..50 {
                    robot.advance(&[torque]).unwrap();
                    assert!(robot.q()[0].to_bits() == rest.to_bits() && robot.v()[0] == 0.0);
                }
            }
            for _ in 0..100 {
                robot.advance(&[4.0]).unwrap();
            }
            assert!((robot.v()[0] - 100.0 * step).abs() < 1e-12, "{}", robot.v()[0]);
        }
        assert!(off[0] < 1.5e-3 && off[1] < 1.5e-4, "{method:?} {off:?}");
    }
}

#[test]
fn sliders_on_sliders_hold_together() {
    // Three of them in a row: the push of the lowest carries the others until friction is too little.
    let joints =
        [("3", ""), ("1", "friction = { force = 2, stick = true }"), ("1", "friction = { force = 0.5, stick = true }")];
    let system = system(&sliders(&joints, "", ""));
    for method in METHODS {
        let mut robot = Loop::new(&system, method, 1e-3, MEMORY).unwrap();
        for _ in 0..200 {
            robot.advance(&[2.0, 0.0, 0.0]).unwrap();
        }
        assert!(robot.q()[1] == 0.0 && robot.q()[2] == 0.0);
        assert!((robot.v()[0] - 0.4 * 0.2).abs() < 1e-12);
        for _ in 0..200 {
            robot.advance(&[5.0, 0.0, 0.0]).unwrap();
        }
        // 5 N on 5 kg would be 1 m/s² with the uppermost, which 0.5 N cannot: 4.5/4 for the two below.
        assert!(robot.q()[1] == 0.0 && robot.q()[2] < 0.0);
        assert!((robot.v()[0] - 0.08 - 4.5 / 4.0 * 0.2).abs() < 1e-12, "{}", robot.v()[0]);
    }
}

#[test]
fn whole_runs_come_near_those_that_choose_their_steps() {
    let spring = "[[element]]\nname = \"s\"\nfrom = { body = \"world\", point = [-8, 0, 0] }\n\
                  to = { body = \"b0\", point = [0, 0, 0] }\nrest_length = 8\nlaw = \"spring\"\nparameters = { k = 100 }\n";
    let text = sliders(
        &[("1", STICKS), ("0.5", "friction = { force = 1, stick = true }")],
        "start = { q = { q0 = 0.5 } }",
        spring,
    );
    let system = system(&text);
    let end = 2.0;
    let truth = truth(&system, end);
    let times: Vec<f64> = (0..=20).map(|k| 0.1 * f64::from(k)).collect();
    for method in METHODS {
        let errors = [1e-3, 5e-4, 2.5e-4].map(|step| {
            let by = FixedStep { method, step };
            let (rows, report, outcome) = rows(&system, &settings(end, &times, Some(by)));
            outcome.unwrap();
            // The columns t, q, v, a: at rest at the end, with no acceleration.
            let last = rows.last().unwrap();
            assert!(last[3] == 0.0 && last[5] == 0.0, "{last:?}");
            let share = report.energy_residual.unwrap() / report.energy_turned_over.unwrap();
            assert!(share < 60.0 * step, "{method:?} {step}: {share}");
            (last[1] - truth[0]).abs().max((last[2] - truth[1]).abs())
        });
        println!("{method:?} {errors:?}");
        assert!(errors[2] < 40.0 * 2.5e-4 && errors[2] < 0.4 * errors[0], "{method:?} {errors:?}");
    }
}
