//! Piezo stacks with their circuit: closed forms, passivity, creep, hysteresis and its inverse.

use crate::departure;
use crate::support::{Run, run, try_run};
use springpot::law::PrandtlIshlinskii;
use std::f64::consts::PI;

/// A stack of 18 mm, N, m, V, F, ohm.
const STACK: &str = "F_block = 900, x_0 = \"15 um\", V_max = 100, V_min = \"-20 V\", C = \"1.5 uF\", R = 20";
const K: f64 = 900.0 / 15e-6;
const T: f64 = 9.0;
const C: f64 = 1.5e-6;
const R: f64 = 20.0;

fn text(law: &str, parameters: &str, u: &str, motion: &str, time: &str, rtol: f64) -> String {
    format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 0.5\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0] }}\n\
         [[element]]\nname = \"s\"\njoint = \"q\"\nlaw = \"{law}\"\nparameters = {{ {STACK}, {parameters} }}\ninputs = {{ U = \"{u}\" }}\n\
         [motion]\n{motion}\n[time]\n{time}\n[solver]\nrtol = {rtol:e}\nmax_steps = 400000\n"
    )
}

fn scenario(law: &str, parameters: &str, u: &str, motion: &str, time: &str, rtol: f64) -> Run {
    run(&text(law, parameters, u, motion, time, rtol))
}

const HELD: &str = "kind = \"prescribed\"\njoints = { q = 0 }";

/// Blocked, R·C·V' + V = U: after a step of U V rises as 1 − e^(−t/RC), and half of what the source gives is lost.
#[test]
fn a_blocked_stack_is_charged() {
    let run =
        scenario("piezo-stack", "c = 0, alpha = 1", "100*step(t - 1e-5)", HELD, "end = 3e-4\noutput_step = 1e-5", 1e-9);
    let times = run.t();
    let exact = |of: &dyn Fn(f64) -> f64| times.iter().map(|t| of((t - 1e-5).max(0.0))).collect::<Vec<_>>();
    let voltage = exact(&|t| 100.0 * (1.0 - (-t / (R * C)).exp()));
    let force: Vec<f64> = voltage.iter().map(|v| -T * v).collect();
    for (column, wanted) in [
        ("s.force", force),
        ("s.voltage", voltage.clone()),
        ("s.charge", voltage.iter().map(|v| C * v).collect()),
        ("s.stored", voltage.iter().map(|v| 0.5 * C * v * v).collect()),
        ("s.input", voltage.iter().map(|v| 100.0 * C * v).collect()),
        ("s.dissipated", voltage.iter().map(|v| 100.0 * C * v - 0.5 * C * v * v).collect()),
    ] {
        let error = departure(&run.column(column), &wanted);
        assert!(error < 1e-8, "{column}: {error:e}");
    }
    let current: Vec<f64> = exact(&|t| 100.0 / R * (-t / (R * C)).exp());
    let error = departure(&run.column("s.current")[2..], &current[2..]);
    assert!(error < 1e-8, "{error:e}");
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}

/// A drive that begins at 0 V and rest is there with the rounding of what it is the difference of; every stack finds its first step.
#[test]
fn a_drive_may_begin_at_nothing() {
    let laws = [
        ("piezo-stack", ""),
        ("piezo-stack-bouc-wen", ", alpha_h = 0.2, A = 1, beta = 0.02, gamma = 0.02, n = 1"),
        ("piezo-stack-prandtl-ishlinskii", ", a = [0.2, 0.1], r = [10, 25]"),
        ("piezo-stack-feed-forward", ", a = [0.2, 0.1], r = [10, 25]"),
    ];
    for (law, parameters) in laws {
        for u in ["50*(1 - cos(2*pi*t))", "2*(1 - cos(2*pi*t))", "40*t", "20*t^3"] {
            let parameters = format!("c = 10, alpha = 0.5, creep = 0.015{parameters}");
            let run = scenario(law, &parameters, u, HELD, "end = 0.2\noutput_step = 1e-2", 1e-9);
            assert!(run.column("s.voltage").last().unwrap().abs() > 1e-3, "{law} {u}");
            assert!(run.residual() < 1e-8, "{law} {u}: {:e}", run.residual());
        }
    }
}

/// A sine at the drive along a sine of the stroke: all is linear, and has its phasors.
#[test]
fn under_sines_it_has_its_phasors() {
    use num_complex::Complex64;
    let omega = 2.0 * PI * 400.0;
    let motion = "kind = \"prescribed\"\njoints = { q = \"2e-6*sin(2*pi*400*t)\" }";
    let run = scenario(
        "piezo-stack",
        "c = 0, alpha = 1",
        "40 + 40*cos(2*pi*400*t)",
        motion,
        "end = 0.01\noutput_step = 1e-5",
        1e-9,
    );
    let s = Complex64::new(0.0, omega);
    let stroke = Complex64::new(0.0, -2e-6);
    let voltage = (40.0 - R * T * s * stroke) / (1.0 + R * C * s);
    let late = |column: &str| run.column(column)[500..].to_vec();
    let of = |mean: f64, phasor: Complex64| -> Vec<f64> {
        run.t()[500..].iter().map(|t| mean + (phasor * (s * t).exp()).re).collect()
    };
    for (column, wanted) in [
        ("s.force", of(-T * 40.0, K * stroke - T * voltage)),
        ("s.charge", of(C * 40.0, C * voltage + T * stroke)),
        ("s.current", of(0.0, s * (C * voltage + T * stroke))),
        ("s.voltage", of(40.0, voltage)),
    ] {
        let error = departure(&late(column), &wanted);
        assert!(error < 1e-7, "{column}: {error:e}");
    }
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}

/// A free stack at rest follows the plays of its voltage; behind the inverse it follows its input.
#[test]
fn free_stacks_have_loops_and_their_inverse_has_none() {
    let plays = "c = 200, alpha = 1, a = [0.08, 0.05], r = [\"5 V\", \"20 V\"]";
    let u = "40 + 40*sin(2*pi*t) + 15*sin(6*pi*t)";
    let motion = "kind = \"forward\"\nstart = { q = { q = 6e-6 } }";
    let moved = |law: &str| {
        let run = scenario(law, plays, u, motion, "end = 2\noutput_step = 0.01", 1e-8);
        assert!(run.residual() < 1e-7, "{law}: {:e}", run.residual());
        let lost = run.column("s.dissipated");
        assert!(lost.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12 * lost[200]), "{law}");
        run
    };
    let hysteresis = PrandtlIshlinskii::new(&[0.08, 0.05], &[5.0, 20.0]).unwrap();
    // Turning points among the samples: finely. Hysteresis counts from where it starts.
    let fine = 200;
    let drive: Vec<f64> = (0..=200 * fine)
        .map(|k| f64::from(k) * 0.01 / f64::from(fine))
        .map(|t| 40.0 * (2.0 * PI * t).sin() + 15.0 * (6.0 * PI * t).sin())
        .collect();
    let strokes = |volts: &[f64]| volts.iter().step_by(fine as usize).map(|v| 15e-8 * (40.0 + v)).collect::<Vec<f64>>();
    let (loops, straight) = (strokes(&hysteresis.outputs(&drive)), strokes(&drive));
    let [plain, inverse] = ["piezo-stack-prandtl-ishlinskii", "piezo-stack-feed-forward"].map(moved);
    // What is left is the circuit, the dashpot and the mass, at 1 Hz.
    let off = [(&plain, &loops), (&inverse, &straight), (&plain, &straight)]
        .map(|(run, wanted)| departure(&run.column("q.q"), wanted));
    println!("{off:?} in {} and {} steps", plain.effort(), inverse.effort());
    assert!(off[0] < 1e-3 && off[1] < 1e-3 && off[2] > 0.015, "{off:?}");
}

/// Driven and pushed at frequencies of their own, hysteresis never makes energy, and what it loses is what the cycles take.
#[test]
fn hysteresis_makes_no_energy() {
    let motion = "kind = \"prescribed\"\njoints = { q = \"4e-6*sin(2*pi*30*t)\" }";
    let u = "40 + 35*sin(2*pi*8*t)";
    for (law, more) in [
        ("piezo-stack-bouc-wen", "alpha_h = 0.3, A = 0.5, beta = 0.02, gamma = 0.05, n = 1"),
        ("piezo-stack-bouc-wen", "alpha_h = 0.3, A = 0.5, beta = -0.002, gamma = 0.002001, n = 2"),
        ("piezo-stack-prandtl-ishlinskii", "a = [0.08, 0.05], r = [5, 20]"),
        ("piezo-stack-feed-forward", "a = [0.08, 0.05], r = [5, 20]"),
    ] {
        let parameters = format!("c = 300, alpha = 0.4, {more}");
        for rtol in [1e-6, 1e-9] {
            let run = scenario(law, &parameters, u, motion, "end = 0.5\noutput_step = 1e-3", rtol);
            assert!(run.residual() < 10.0 * rtol, "{law}: {:e} at {rtol:e}", run.residual());
            let [lost, taken] = ["s.dissipated", "s.input"].map(|name| run.column(name));
            let rises = lost.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12 * lost[500]);
            assert!(rises && lost[500] > 1e-4, "{law}: {} J of {} J", lost[500], taken[500]);
            println!("{law} {rtol:e}: residual {:.1e}, {} steps", run.residual(), run.effort());
        }
    }
}

/// Free under a constant voltage the stack creeps by its share of x_0 from 1 s to 10 s, by a little more in the next decade.
#[test]
fn it_creeps_by_the_decade() {
    let parameters = "c = 2000, alpha = 1, creep = 0.015, alpha_creep = 0.1";
    let run = scenario("piezo-stack", parameters, "100", "kind = \"forward\"", "end = 100\noutput_step = 1", 1e-7);
    let q = run.column("q.q");
    let [one, ten, hundred] = [q[1], q[10], q[100]].map(|q| q / 15e-6);
    let exact = |t: f64| 0.015 * t.powf(0.1) / (10f64.powf(0.1) - 1.0);
    println!("{one} {ten} {hundred}, {} steps", run.effort());
    assert!(
        (one - 1.0 - exact(1.0)).abs() < 1e-5
            && (ten - one - 0.015).abs() < 1e-5
            && (hundred - ten - exact(100.0) + exact(10.0)).abs() < 1e-5
    );
    assert!(run.residual() < 1e-6, "{:e}", run.residual());
}

#[test]
fn voltages_beyond_the_limits_are_refused() {
    let parameters = "c = 0, alpha = 1";
    let run = try_run(&text("piezo-stack", parameters, "200*t", HELD, "end = 1\noutput_step = 0.1", 1e-6));
    let error = run.error.expect("more than 100 V").to_string();
    assert!(
        error.contains("V_min ≤ U ≤ V_max is broken: the voltage is 1") && error.contains("V_max is 100 V"),
        "{error}"
    );
    let run = try_run(&text("piezo-stack", parameters, "-30*t", HELD, "end = 1\noutput_step = 0.1", 1e-6));
    assert!(run.error.expect("less than -20 V").to_string().contains("V_min is -20 V"));
}

/// About rest the circuit is a spring T²/C in series with a dashpot T²R: stiff at constant charge, soft at constant voltage.
#[test]
fn about_rest_it_is_stiffer_open_than_closed() {
    use num_complex::Complex64;
    use springpot::law::{Catalog, Derivative, InputValue, Point};
    let catalog = Catalog::standard();
    let common = [900.0, 15e-6, 100.0, -20.0, 0.0, 1.0, C, R, 0.0, 0.1];
    let u = [InputValue { value: 40.0, rate: 0.0 }];
    for (name, more, elastic) in [
        ("piezo-stack", vec![], 0.0),
        ("piezo-stack-bouc-wen", vec![0.3, 0.5, 0.02, 0.05, 1.0], 0.15),
        // 1/0.87 − 1: at rest no play has moved.
        ("piezo-stack-prandtl-ishlinskii", vec![0.08, 0.05, 5.0, 20.0], 1.0 / 0.87 - 1.0),
    ] {
        let law = catalog.get(name).unwrap().build(&[&common[..], &more].concat(), Derivative::Caputo).unwrap();
        let rest = law.at_rest(&Point { t: 0.0, stroke: 2e-6, rate: 0.0, inputs: &u }, 0.0).unwrap();
        assert!((rest.force - (K * 2e-6 - T * 40.0)).abs() < 1e-10, "{name}: {rest:?}");
        for omega in [1.0, 3e4, 1e9] {
            let s = Complex64::new(0.0, omega);
            // (R s + 1/C + v_h/q) q = U + T x/C, F = k x − T (q − T x)/C.
            let meets = R * s + 1.0 / C + elastic / (C + T * T / K);
            let exact = K + T * T / C - T * T / (C * C) / meets;
            assert!((rest.tangent.modulus(s) - exact).norm() < 1e-12 * exact.norm(), "{name} {omega}");
            let gain = -T / C / meets;
            assert!((rest.tangent.gain(s, 0) - gain).norm() < 1e-12 * gain.norm(), "{name} {omega}");
        }
    }
}
