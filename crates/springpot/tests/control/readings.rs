//! What independent readers of the contract found, each as it should be.

use super::support::{cases, relative_difference, run, run_case, try_run};
use springpot::system::RunError;
use springpot_scenario::Scenario;

/// A slide of 1.5 kg without gravity along it; `element`, then all that follows.
fn slide(element: &str, rest: &str) -> String {
    format!(
        "[[robot.body]]\nname = \"m\"\njoint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0] }}\nmass = 1.5\n\
         [robot.gripper]\nbody = \"m\"\npoint = [0, 0, 0]\n{element}\n{rest}"
    )
}

fn element(law: &str, parameters: &str, more: &str) -> String {
    format!("[[element]]\nname = \"e\"\njoint = \"q\"\nlaw = \"{law}\"\nparameters = {{ {parameters} }}\n{more}\n")
}

/// F = k x_s + c x_s' with x_s = x − 2 mm/K·20 K/m·x = 0.96 x: the temperature follows from the stroke, and how fast it changes from its rate.
#[test]
fn a_temperature_that_follows_from_places_stretches_at_its_rate() {
    let motion = "[motion]\nkind = \"forward\"\nstart = { q = { q = 0.1 }, v = { q = 0.5 } }\ntorque = { q = \"sin(2*t)\" }\n\
                  [time]\nend = 2\noutput_step = 0.05\n[solver]\nrtol = 1e-10\n";
    let heated = "inputs = { T = { expression = \"30 + 20*e.stroke\", unit = \"degC\" } }\n\
                  expansion = { coefficient = \"2 mm/K\", T_ref = \"30 degC\" }";
    let stretched = run(&slide(&element("kelvin-voigt", "k = 60, c = 3", heated), motion));
    let softer = run(&slide(&element("kelvin-voigt", "k = 57.6, c = 2.88", ""), motion));
    let off = relative_difference(&softer.column("q.q"), &stretched.column("q.q"));
    assert!(off < 1e-9, "{off:e}");
    let fractional = run(&slide(&element("fractional-kelvin-voigt", "k = 60, c = 8, alpha = 0.5", heated), motion));
    let softer = run(&slide(&element("fractional-kelvin-voigt", "k = 57.6, c = 7.68, alpha = 0.5", ""), motion));
    let off = relative_difference(&softer.column("q.q"), &fractional.column("q.q"));
    assert!(off < 1e-9 && fractional.residual() < 1e-9, "{off:e} {:e}", fractional.residual());
}

#[test]
fn a_temperature_that_stretches_is_neither_sampled_nor_follows_from_velocities() {
    let text = |temperature: &str, solver: &str| {
        let heated = format!("inputs = {{ T = {temperature} }}\nexpansion = {{ coefficient = 1e-3, T_ref = 300 }}");
        slide(
            &element("kelvin-voigt", "k = 60, c = 3", &heated),
            &format!("[motion]\nkind = \"forward\"\n[time]\nend = 1\noutput_step = 0.1\n{solver}"),
        )
    };
    for (temperature, solver, why) in [
        ("{ expression = \"300+q.q\", unit = \"K\", sample = 0.1 }", "", "a sampled temperature jumps"),
        ("\"300+v.q\"", "", "follows from velocities"),
        ("\"300+q.q\"", "[solver]\nmethod = \"midpoint\"\nstep = 1e-3", "steps of one size hold it"),
    ] {
        let scenario = Scenario::parse(&text(temperature, solver), "slide.toml", "").unwrap();
        let refusals = scenario.cases(&springpot::law::Catalog::standard()).unwrap_err().to_string();
        assert!(refusals.contains(why), "{refusals}");
    }
}

/// At t = 0 a sampled input sees the start, and never the 0 of before, which is no temperature.
#[test]
fn a_sampled_temperature_starts_where_the_robot_does() {
    let law = element(
        "thermoviscoelastic",
        "E_c = 30, E_kv = 20, E_d = 50, alpha = 0.5, a_kv = 7e-4",
        "inputs = { T = { expression = \"20 + 10*q.q\", unit = \"degC\", sample = \"10 ms\" } }",
    );
    let motion = "[motion]\nkind = \"forward\"\nstart = { q = { q = 0.1 } }\n[time]\nend = 0.1\noutput_step = 0.01\n";
    let run = run(&slide(&law, motion));
    let (temperature, q) = (run.column("e.T"), run.column("q.q"));
    assert!((temperature[0] - 294.15).abs() < 1e-12);
    assert!(temperature.iter().zip(&q).all(|(kelvin, q)| (kelvin - 293.15 - 10.0 * q).abs() < 1e-9));
}

/// After a jump of the thermal stroke at t = 0, D_RL x_s = D_C x_s + x_s(0) t^−alpha/Γ(1 − alpha).
#[test]
fn a_thermal_stroke_may_jump_at_the_start() {
    let text = |past: &str| {
        let heated = format!(
            "rest = -0.05\npast = \"{past}\"\ninputs = {{ T = {{ expression = \"20+15*sin(2*t)\", unit = \"degC\" }} }}\n\
             expansion = {{ coefficient = \"1 mm/K\", T_ref = \"10 degC\" }}"
        );
        slide(
            &element("fractional-kelvin-voigt", "k = 20, c = 30, alpha = 0.4", &heated),
            "[motion]\nkind = \"prescribed\"\njoints = { q = \"0.2*sin(3*t)\" }\n[time]\nend = 2\noutput_step = 0.05\n",
        )
    };
    let (unloaded, held) = (run(&text("unloaded")), run(&text("held")));
    assert!(unloaded.report.steps < 1000, "{:?}", unloaded.report);
    let gamma = 1.489_192_248_812_817_2; // Γ(0.6)
    let rows = unloaded.t().into_iter().zip(unloaded.column("e.force")).zip(held.column("e.force"));
    let jump = 0.05 - 1e-3 * 10.0;
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for ((t, unloaded), held) in rows.skip(1) {
        worst = worst.max((unloaded - held - 30.0 * jump * t.powf(-0.4) / gamma).abs());
        largest = largest.max(unloaded.abs());
    }
    assert!(worst < 1e-8 * largest, "{worst:e}");
}

/// Inside a series of a spring and a springpot of low order the strokes begin alike on all scales of time.
#[test]
fn series_of_low_order_start_from_a_velocity() {
    for alpha in [0.05, 0.1, 0.2, 0.3] {
        let law = element("fractional-maxwell", &format!("k = 300, c = 10, alpha = {alpha}"), "");
        let forward = "[motion]\nkind = \"forward\"\nstart = { v = { q = 0.5 } }\ntorque = { q = \"2*sin(3*t)\" }\n";
        let given = "[motion]\nkind = \"prescribed\"\njoints = { q = \"0.2*sin(3*t)\" }\n";
        for motion in [forward, given] {
            let run = run(&slide(&law, &format!("{motion}[time]\nend = 2\noutput_step = 0.05\n")));
            assert!(run.residual() < 1e-9, "{alpha}: {:e}", run.residual());
            assert!(run.effort() < 2000, "{alpha}: {:?}", run.report);
        }
    }
}

/// A mass that cannot be moved, a reference that turns over: the force before its bound goes down from 10 N, not from the bound.
#[test]
fn rates_are_limited_before_forces_sampled_or_not() {
    for sample in ["", "sample = \"10 ms\"\n"] {
        let motion = format!(
            "[motion]\nkind = \"forward\"\n[motion.controller]\nkind = \"pd-gravity\"\nkp = 100\nkd = 0\n\
             reference = {{ kind = \"joints\", q = \"0.1 - 0.2*step(t-1)\" }}\nlimits = {{ q = 4 }}\nrate_limits = {{ q = 50 }}\n{sample}\
             [time]\nend = 1.5\noutput_step = 0.01\n"
        );
        let text = slide("", &motion).replace("mass = 1.5", "mass = 1e9");
        let run = run(&text);
        for (t, tau) in run.t().into_iter().zip(run.column("tau.q")) {
            let before = if t <= 1.0 { (50.0 * t).min(10.0) } else { (10.0 - 50.0 * (t - 1.0)).max(-10.0) };
            let wanted = before.clamp(-4.0, 4.0);
            // The first force is taken as it is; a sample is late by one period at most.
            let late = if sample.is_empty() { 1e-6 } else { 0.5 + 1e-6 };
            if t > 0.2 {
                assert!((tau - wanted).abs() <= late, "{sample:?} t = {t}: {tau} {wanted}");
            }
        }
    }
}

#[test]
fn steps_of_one_size_take_samples_at_their_ends_and_show_them_there() {
    let motion = |sample: f64, method: &str| {
        format!(
            "[motion]\nkind = \"forward\"\ntorque = {{ q = {{ expression = \"t+0*q.q\", unit = \"N\", sample = {sample} }} }}\n\
             [time]\nend = 0.02\noutput_step = 1e-3\n[solver]\n{method}"
        )
    };
    let fixed = "method = \"midpoint\"\nstep = 1e-3\n";
    for (sample, method) in [(2e-3, fixed), (1e-3, fixed), (2e-3, "rtol = 1e-9\n")] {
        let run = run(&slide("", &motion(sample, method)));
        for (t, tau) in run.t().into_iter().zip(run.column("tau.q")) {
            let last = sample * (t / sample + 1e-9).floor();
            assert!((tau - last).abs() < 1e-12, "{sample} {method}: t = {t}: {tau}");
        }
    }
    for sample in [0.3e-3, 1.5e-3, 1e-300, 1e-9] {
        for method in [fixed, "rtol = 1e-9\n"] {
            let scenario = Scenario::parse(&slide("", &motion(sample, method)), "slide.toml", "").unwrap();
            let cases = scenario.cases(&springpot::law::Catalog::standard());
            let is_good = sample > 1e-6 && method != fixed;
            assert_eq!(cases.is_ok(), is_good, "{sample} {method}");
        }
    }
}

const ARM: &str = "[[robot.body]]\nname = \"arm\"\njoint = { name = \"q1\", kind = \"revolute\", axis = [0, 1, 0] }\nmass = 1\ncom = [0.2, 0, 0]\n\
    inertia = { xx = 0.01, yy = 0.01, zz = 0.01 }\n\
    [[robot.body]]\nname = \"fore\"\njoint = { name = \"q2\", kind = \"revolute\", axis = [0, 1, 0], origin = [0.4, 0, 0] }\nmass = 0.5\n\
    com = [0.1, 0, 0]\ninertia = { xx = 0.01, yy = 0.01, zz = 0.01 }\n[robot.gripper]\nbody = \"fore\"\npoint = [0.3, 0, 0]\n";

/// ë + kd ė + kp e = 0 of the joint that is driven, whatever the other one does.
#[test]
fn computed_torque_knows_how_prescribed_joints_move() {
    let run = run(&format!(
        "{ARM}[motion]\nkind = \"forward\"\nstart = {{ q = {{ q1 = 0.3 }} }}\nprescribed = {{ q2 = \"0.4*cos(2*t)\" }}\n\
         [motion.controller]\nkind = \"computed-torque\"\nkp = 25\nkd = 10\nreference = {{ kind = \"joints\", q1 = \"0\" }}\n\
         [time]\nend = 2\noutput_step = 0.05\n[solver]\nrtol = 1e-10\n"
    ));
    for (t, q) in run.t().into_iter().zip(run.column("q.q1")) {
        let exact = 0.3 * (1.0 + 5.0 * t) * (-5.0 * t).exp();
        assert!((q - exact).abs() < 1e-9, "{t}: {q} {exact}");
    }
}

/// The gripper is pulled towards a point out of reach and of the plane, until the arm is straight.
#[test]
fn impedance_pulls_towards_points_out_of_reach() {
    let run = run(&format!(
        "{ARM}[motion]\nkind = \"forward\"\nstart = {{ q = {{ q2 = 0.5 }} }}\n[motion.controller]\nkind = \"impedance\"\nkp = 100\nkd = 20\n\
         reference = {{ kind = \"gripper-path\", x = \"1\", y = \"0.1\", z = \"0\" }}\n[time]\nend = 20\noutput_step = 0.1\n"
    ));
    let (x, error) = (run.column("gripper.x"), run.column("gripper.error"));
    assert!((x.last().unwrap() - 0.7).abs() < 1e-6);
    assert!((error.last().unwrap() - 0.3f64.hypot(0.1)).abs() < 1e-6);
}

#[test]
fn a_robot_that_is_held_takes_few_steps() {
    for control in [
        "[motion.controller]\nkind = \"impedance\"\nkp = 100\nkd = 10\nreference = { kind = \"move\", to = {}, duration = 1 }\n",
        "[motion.controller]\nkind = \"pd-gravity\"\nkp = 100\nkd = 10\nreference = { kind = \"move\", to = {}, duration = 1 }\n",
        "[motion.torque]\nq1 = \"-9.81*(1*0.2*cos(q.q1)+0.5*(0.4*cos(q.q1)+0.1*cos(q.q1+q.q2)))\"\nq2 = \"-9.81*0.05*cos(q.q1+q.q2)\"\n",
    ] {
        let run = run(&format!(
            "{ARM}[motion]\nkind = \"forward\"\nstart = {{ q = {{ q1 = 0.3 }} }}\n{control}[time]\nend = 5\noutput_step = 0.01\n"
        ));
        assert!(run.effort() < 500, "{control}: {:?}", run.report);
        assert!(run.report.is_balanced() && run.column("v.q1").iter().all(|v| v.abs() < 1e-9), "{control}");
    }
}

#[test]
fn references_and_temperatures_that_jump_are_seen_before_the_run() {
    let stop = springpot::system::Stop::new(false);
    let controlled = |kind: &str, more: &str| {
        format!(
            "{ARM}[motion]\nkind = \"forward\"\n[motion.controller]\nkind = \"{kind}\"\nkp = 25\nkd = 10\n{more}\n\
             reference = {{ kind = \"joints\", q1 = \"0.3*step(t-0.1)\", q2 = 0 }}\n[time]\nend = 0.2\noutput_step = 0.01\n"
        )
    };
    let solvers = ["", "[solver]\nmethod = \"midpoint\"\nstep = 1e-3\n"];
    for solver in solvers {
        for (kind, more, is_good) in [
            ("computed-torque", "", false),
            ("computed-torque", "sample = \"1 ms\"", false),
            ("fractional-pid", "mu = 0.5", false),
            ("fractional-pid", "mu = 1", true),
            ("pd-gravity", "", true),
        ] {
            let cases = cases(&format!("{}{solver}", controlled(kind, more)));
            let plan = cases.plan(0).unwrap();
            let looked = plan.system().look_for_jumps(&plan.settings, &stop);
            assert_eq!(looked.is_ok(), is_good, "{kind} {more} {solver}: {looked:?}");
            let run = run_case(&cases, 0);
            let refused = matches!(run.error, Some(RunError::ReferenceJump { .. }));
            assert!(refused != is_good, "{kind} {more} {solver}: {:?}", run.error);
        }
        let heated = "inputs = { T = \"300+10*step(t-0.1)\" }\nexpansion = { coefficient = 1e-3, T_ref = 300 }";
        let text = slide(
            &element("kelvin-voigt", "k = 60, c = 3", heated),
            &format!("[motion]\nkind = \"forward\"\n[time]\nend = 0.2\noutput_step = 0.01\n{solver}"),
        );
        let error = try_run(&text).error;
        assert!(matches!(error, Some(RunError::Heat { .. })), "{error:?}");
    }
}

#[test]
fn an_event_whose_function_is_no_number_ends_the_run() {
    let text = |when: &str| {
        let motion = "[motion]\nkind = \"forward\"\ntorque = { q = 1 }\n[time]\nend = 1\noutput_step = 0.1\n";
        slide("", &format!("{motion}[[event]]\nname = \"odd\"\nwhen = \"{when}\"\n"))
    };
    let error = try_run(&text("1/(q.q-q.q)")).error.map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains("`when` of event \"odd\" is"), "{error}");
    assert!(try_run(&text("log(q.q)+3")).error.is_none());
}
