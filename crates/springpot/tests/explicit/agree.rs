//! The same motion as implicit steps find, and energies that balance.

use super::{BENDING, SPRING_DAMPER, apart, cases, chain, floating, run, system};
use crate::support::forward::{every, slider, state};
use crate::support::run_system;
use springpot::Simulation;
use springpot::system::{Adaptive, Settings};
use std::f64::consts::PI;

#[test]
fn energies_balance_within_the_tolerance() {
    for text in [chain(2, [SPRING_DAMPER; 2]), chain(4, [SPRING_DAMPER, BENDING]), floating()] {
        let system = system(&text, 3.0);
        let truth = run(&system, 3.0, &[1.0, 2.2, 3.0], Adaptive::Radau, 1e-12);
        for rtol in [1e-4, 1e-6, 1e-8, 1e-10] {
            let run = run(&system, 3.0, &[1.0, 2.2, 3.0], Adaptive::Either, rtol);
            let (residual, error) = (run.residual(), apart(&truth, &run));
            println!(
                "{rtol:e}: {residual:.1e} {error:.1e}, {:?} of {} steps",
                run.report.explicit_steps, run.report.steps
            );
            assert!(residual < 10.0 * rtol, "{rtol:e}: {residual:e}");
            assert!(error < 30.0 * rtol, "{rtol:e}: {error:e}");
        }
    }
}

/// What acts beside elements: every law of control without memory, what varies, kinks, stops, switches.
#[test]
fn what_else_acts_does_as_in_implicit_steps() {
    let arm = chain(3, [SPRING_DAMPER, BENDING]);
    let reference = "reference = { kind = \"move\", to = { q0 = 0.3, q1 = 0.1, q2 = -0.1 }, duration = 0.6 }";
    let controller = |law: &str| format!("{arm}controller = {{ {law}, {reference} }}\n");
    let stops = arm.replacen("[robot]\n", "[robot]\nlimits = { stiffness = 2000, damping = 20 }\n", 1);
    let stops = stops.replace("name = \"q1\",", "name = \"q1\", lower = -0.2, upper = 0.25,");
    let rope =
        arm.replace(SPRING_DAMPER, "network = \"parallel(tension(k), dashpot(c))\"\nparameters = { k = 90, c = 1 }");
    for (name, text) in [
        ("switched", format!("{arm}torque = {{ q1 = \"2*sign(sin(9*t))\", q2 = \"0.4*step(t - 0.35)\" }}\n")),
        ("seen", format!("{arm}torque = {{ q1 = \"-2*q.q0 - v.q1*abs(v.q1)\", q2 = \"-max(0, q.q2 - 0.05)*30\" }}\n")),
        ("pd", controller("kind = \"pd-gravity\", kp = 30, kd = 4")),
        (
            "limited",
            controller(
                "kind = \"pd-gravity\", kp = 60, kd = 6, limits = { q0 = 4, q1 = 3 }, rate_limits = { q0 = 90 }",
            ),
        ),
        ("computed", controller("kind = \"computed-torque\", kp = 60, kd = 9, compensate_elements = true")),
        ("sampled", controller("kind = \"pd-gravity\", kp = 4, kd = 0.3, sample = \"20 ms\"")),
        ("stops", stops),
        ("rope", rope),
        ("locked", format!("{arm}locked = [\"q1\"]\n")),
        (
            "led",
            arm.replace("q = { q0 = 0.7 }, v = { q0 = -0.4 }", "")
                + "prescribed = { q0 = \"0.7 + 0.3*abs(sin(4*t))\" }\n",
        ),
    ] {
        let cases = cases(&format!("{text}[time]\nend = 1.5\noutput_step = 0.13\n[solver]\nrtol = 1e-8\n"));
        let plan = cases.plan(0).expect("a plan");
        let run = |adaptive: Adaptive| {
            let settings = Settings { adaptive, ..plan.settings.clone() };
            run_system(&plan.system(), &settings)
        };
        let [implicit, explicit] = [Adaptive::Radau, Adaptive::Explicit].map(run);
        let error = [&implicit, &explicit].map(|run| run.error.as_ref().map(ToString::to_string));
        assert!(error == [None, None], "{name}: {error:?}");
        let apart = apart(&implicit, &explicit);
        let (steps, before) = (explicit.effort(), implicit.effort());
        println!(
            "{name}: {apart:.1e}, balance {:.1e}; {before} steps, {steps} of which {:?}",
            explicit.residual(),
            explicit.report.explicit_steps
        );
        assert!(explicit.report.explicit_steps.is_some_and(|steps| steps > 0), "{name}");
        assert!(apart < 3e-6, "{name}: {apart:e}");
        assert!(explicit.residual() < 1e-7, "{name}: {:e}", explicit.residual());
    }
}

/// A robot from its file, with a joint that follows another one, is let go on two struts.
#[test]
fn a_robot_let_go_falls_as_in_implicit_steps() {
    let strut = |name: &str, ends: &str, rest: f64| {
        format!(
            "[[element]]\nname = \"{name}\"\n{ends}\nrest_length = {rest}\nlaw = \"kelvin-voigt\"\nparameters = {{ k = 400, c = 30 }}\n"
        )
    };
    let text = String::from(
        "[robot]\nurdf = \"robots/panda.urdf\"\naccept = [\"unknown-attribute\", \"mesh-not-found\", \"not-used\"]\n",
    ) + &strut(
        "strut",
        "from = { body = \"world\", point = [0.35, 0.1, 0] }\nto = { body = \"panda_link4\", point = [0, 0, 0.1] }",
        0.78,
    ) + &strut(
        "elbow",
        "from = { body = \"panda_link2\", point = [0.04, -0.14, 0] }\nto = { body = \"panda_link4\", point = [-0.02, 0.18, 0] }",
        0.25,
    ) + "[motion]\nkind = \"forward\"\nstart = { q = { panda_joint2 = -0.35, panda_joint4 = -1.92, panda_joint6 = 1.75 } }\n";
    let system = system(&text, 0.6);
    let [implicit, explicit] =
        [Adaptive::Radau, Adaptive::Either].map(|adaptive| run(&system, 0.6, &[0.2, 0.4, 0.6], adaptive, 1e-9));
    let apart = apart(&implicit, &explicit);
    println!("{apart:.1e}, {} steps and {}", implicit.report.steps, explicit.report.steps);
    assert!(apart < 1e-6 && explicit.residual() < 1e-8, "{apart:e} {:e}", explicit.residual());
    assert!(3 * explicit.report.steps < implicit.report.steps, "{:?}", explicit.report);
}

/// q = cos t passes ½ at π/3 and 5π/3, and 0 with the velocity −1 at π/2.
#[test]
fn events_are_met_to_twelve_digits() {
    let text = slider("1", 0.0, "law = \"spring\"\nparameters = { k = 1 }", &state("1", "0"))
        + "[[event]]\nname = \"half\"\nwhen = \"q.q - 0.5\"\n[[event]]\nname = \"zero\"\nwhen = \"q.q\"\n"
        + &every(6.0, 6.0, 1e-13);
    let plan = cases(&text).plan(0).expect("a plan");
    let settings = Settings { adaptive: Adaptive::Explicit, ..plan.settings.clone() };
    let mut simulation = Simulation::new(plan.system(), settings).expect("a simulation");
    let mut times = Vec::new();
    while simulation.step().expect("a step") {
        times.extend(simulation.passed().map(|(_, t)| t));
    }
    let exact = [PI / 3.0, PI / 2.0, 1.5 * PI, 5.0 * PI / 3.0];
    assert_eq!(times.len(), exact.len(), "{times:?}");
    for (t, exact) in times.iter().zip(exact) {
        println!("{:.1e}", t - exact);
        assert!((t - exact).abs() < 1e-12, "{t} {exact}");
    }
    assert!(simulation.report().steps < 80, "{:?}", simulation.report());
}
