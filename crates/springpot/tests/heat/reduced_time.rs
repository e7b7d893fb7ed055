//! Time that runs as the temperature says.

use crate::support::{run, try_run};
use crate::{LAWS, along, departure, forward, slider};
use serde_json::Value;

/// Arrhenius with 60 kJ/mol about 300 K.
const SHIFT: &str = "shift = { kind = \"arrhenius\", energy = 60000, T_ref = 300 }";

/// a_T at 320 K.
fn warm() -> f64 {
    (60000.0 / 8.314_462_618_153_24 * (1.0f64 / 320.0 - 1.0 / 300.0)).exp()
}

#[test]
fn a_constant_shift_is_another_clock() {
    let a = warm();
    for (name, law) in LAWS {
        for (derivative, start) in [("caputo", 0.05), ("riemann-liouville", 0.0)] {
            let derivative = format!("derivative = \"{derivative}\"");
            let warm = format!("{law}\n{derivative}\n{SHIFT}\ninputs = {{ T = 320 }}");
            let motion = |speed: f64| along(&format!("{start} + 0.1*sin({speed}*t)^2"));
            // Each run errs by its own steps.
            let shifted = run(&slider(&warm, &motion(3.0), 4.0, 40, "rtol = 1e-11"));
            let plain = run(&slider(&format!("{law}\n{derivative}"), &motion(3.0 * a), 4.0 / a, 40, "rtol = 1e-11"));
            for column in ["e.force", "e.stored", "e.dissipated"] {
                let error = departure(&shifted.column(column), &plain.column(column));
                println!("{name} {column}: {error:.1e}");
                assert!(error < 1e-10, "{name} {column}: {error:e}");
            }
            assert!(shifted.effort() <= plain.effort() + plain.effort() / 4, "{name}: {}", shifted.effort());
        }
    }
}

/// c → c·a_T^alpha, also where the motion follows from the force.
#[test]
fn a_constant_shift_is_another_coefficient() {
    let a = warm();
    let zener =
        |c: f64| format!("law = \"fractional-zener\"\nparameters = {{ k_e = 20, k_m = 100, c = {c}, alpha = 0.5 }}");
    let springpot = |c: f64| format!("law = \"springpot\"\nparameters = {{ c = {c}, alpha = 0.3 }}");
    let dashpot = |c: f64| format!("law = \"kelvin-voigt\"\nparameters = {{ k = 40, c = {c} }}");
    let motion = forward(0.1, "5*sin(4*t)");
    let laws: [(&dyn Fn(f64) -> String, f64); 3] = [(&zener, 0.5), (&springpot, 0.3), (&dashpot, 1.0)];
    for (law, order) in laws {
        for past in ["past = \"held\"", "past = \"unloaded\"", "past = { held = \"2 s\" }"] {
            // What the past lasted counts by its own clock in both.
            let is_jump = past.contains("unloaded");
            let solver = if is_jump { "rtol = 1e-8" } else { "rtol = 1e-11" };
            let shifted = format!("{}\n{past}\n{SHIFT}\ninputs = {{ T = 320 }}", law(30.0));
            let plain = format!("{}\n{past}", law(30.0 * a.powf(order)));
            let [shifted, plain] = [shifted, plain].map(|law| run(&slider(&law, &motion, 3.0, 30, solver)));
            for column in ["q.q", "v.q"] {
                let error = departure(&shifted.column(column), &plain.column(column));
                println!("{past}: {error:.1e}");
                assert!(error < if is_jump { 1e-7 } else { 1e-9 }, "{past} {}: {error:e}", law(1.0));
            }
        }
    }
}

#[test]
fn a_steady_past_is_one_by_its_own_clock() {
    let law =
        |c: f64| format!("law = \"fractional-zener\"\nparameters = {{ k_e = 20, k_m = 100, c = {c}, alpha = 0.5 }}");
    let steady = "past = \"steady\"\nperiod = 2";
    let motion = along("0.02 + 0.1*sin(pi*t)");
    let shifted = format!("{}\n{steady}\n{SHIFT}\ninputs = {{ T = 320 }}", law(30.0));
    let plain = format!("{}\n{steady}", law(30.0 * warm().sqrt()));
    let [shifted, plain] = [shifted, plain].map(|law| run(&slider(&law, &motion, 4.0, 40, "rtol = 1e-10")));
    let error = departure(&shifted.column("e.force"), &plain.column("e.force"));
    assert!(error < 1e-10, "{error:e}");
}

/// Forces under a temperature that varies, by quadrature of the memory integral; clamped, where the force is that of the expansion alone, which
/// relaxes.
#[test]
fn varying_shifts_are_those_of_quadrature() {
    let text = include_str!("../../../../testdata/heat/reduced_time.json");
    let reference: Value = serde_json::from_str(text).unwrap();
    let number = |value: &Value| value.as_str().unwrap().parse::<f64>().unwrap();
    let times: Vec<f64> = reference["times"].as_array().unwrap().iter().map(number).collect();
    let temperature = "inputs = { T = \"1/(1/300 - 8.31446261815324/60000*log(1 + 0.8*sin(3*t)))\" }";
    let mut compared = 0;
    for case in reference["cases"].as_array().unwrap() {
        let law = match case["law"].as_str().unwrap() {
            "zener" => LAWS[1].1.to_owned(),
            springpot => {
                let alpha = springpot.split_once(' ').unwrap().1;
                format!("law = \"springpot\"\nparameters = {{ c = 50, alpha = {alpha} }}")
            }
        };
        let (motion, expansion) = match case["motion"].as_str().unwrap() {
            "moved" => (along("0.1*sin(5*t)"), ""),
            _ => (along("0"), "expansion = { coefficient = \"2 mm/K\", T_ref = 300 }"),
        };
        let element = format!("{law}\n{SHIFT}\n{temperature}\n{expansion}");
        for rtol in [1e-6, 1e-9] {
            let run = run(&slider(&element, &motion, 4.0, 80, &format!("rtol = {rtol:e}")));
            let force = run.column("e.force");
            let wanted: Vec<f64> = case["force"].as_array().unwrap().iter().map(number).collect();
            let found: Vec<f64> = times.iter().map(|t| force[(t / 0.05).round() as usize]).collect();
            let error = departure(&found, &wanted);
            assert!(error < 0.1 * rtol, "{case}: {error:e} at {rtol:e}");
            assert!(run.residual() < 10.0 * rtol, "{case}: {:e} at {rtol:e}", run.residual());
            // The geometric stroke is told, not that of the law.
            if motion == along("0") {
                assert!(run.column("e.stroke").iter().all(|x| *x == 0.0));
            }
            compared += found.len();
        }
    }
    assert_eq!(compared, 60);
}

/// A clamped Maxwell bar in closed form: F = −k b r τ (1 − e^{−t/τ}) while it is warmed at the rate r, without a shift; with one it relaxes sooner.
#[test]
fn a_clamped_bar_relaxes_its_thermal_force() {
    let bar = "law = \"maxwell\"\nparameters = { k = 1000, c = 500 }\n\
               expansion = { coefficient = \"0.1 mm/K\", T_ref = 300 }\ninputs = { T = \"300 + 5*t - 5*(t - 2)*step(t - 2)\" }";
    let plain = run(&slider(bar, &along("0"), 6.0, 60, "rtol = 1e-9"));
    let exact = |t: f64| {
        let grown = |t: f64| -1000.0 * 1e-4 * 5.0 * 0.5 * (1.0 - (-t / 0.5f64).exp());
        if t < 2.0 { grown(t) } else { grown(t) - grown(t - 2.0) }
    };
    let wanted: Vec<f64> = plain.t().iter().map(|t| exact(*t)).collect();
    let error = departure(&plain.column("e.force"), &wanted);
    println!("{error:.1e}");
    assert!(error < 1e-9, "{error:e}");
    assert!(plain.residual() < 1e-8, "{:e}", plain.residual());
    let shifted = run(&slider(&format!("{bar}\n{SHIFT}"), &along("0"), 6.0, 60, "rtol = 1e-9"));
    assert!(shifted.column("e.force")[59].abs() < 0.5 * plain.column("e.force")[59].abs());
    assert!(shifted.residual() < 1e-8, "{:e}", shifted.residual());
}

/// Friction and stops see x' as it is, whatever the memories' time does; in a series too.
#[test]
fn friction_does_not_shift() {
    for (parts, force) in [("friction(f, v0)", 1.0), ("series(parallel(friction(f, v0), spring(k)), spring(k))", 1.0)] {
        let law = |shift: &str| {
            let element = format!(
                "network = \"parallel({parts}, springpot(c, alpha))\"\n\
                 parameters = {{ f = {force}, v0 = 0.05{}, c = 0, alpha = 0.5 }}\n{shift}",
                if parts.contains("spring(k)") { ", k = 200" } else { "" }
            );
            run(&slider(&element, &along("0.1*sin(3*t)"), 3.0, 30, "rtol = 1e-9"))
        };
        let plain = law("");
        let shifted = law(&format!("{SHIFT}\ninputs = {{ T = \"300 + 8*sin(2*t)\" }}"));
        let error = departure(&shifted.column("e.force"), &plain.column("e.force"));
        assert!(error < 1e-7, "{parts}: {error:e}");
        assert!(departure(&shifted.column("e.dissipated"), &plain.column("e.dissipated")) < 1e-7, "{parts}");
    }
}

/// Leaves and their rates by the clock of the wall.
#[test]
fn leaves_are_told_by_the_clock_of_the_wall() {
    let element = format!(
        "network = \"parallel(spring(k), series(spring(ks), dashpot(c)))\"\nparameters = {{ k = 3, ks = 40, c = 8 }}\n{SHIFT}\n\
         inputs = {{ T = \"300 + 8*sin(2*t)\" }}"
    );
    let text = slider(&element, &along("0.1*sin(3*t)"), 3.0, 60, "rtol = 1e-9") + "[output]\nleaves = true\n";
    let run = run(&text);
    let factor =
        |t: f64| (60000.0 / 8.314_462_618_153_24 * (1.0 / (300.0 + 8.0 * (2.0 * t).sin()) - 1.0 / 300.0)).exp();
    let [rates, force, whole] = ["e.dashpot1.rate", "e.dashpot1.force", "e.rate"].map(|name| run.column(name));
    let other = run.column("e.spring2.rate");
    for (k, t) in run.t().into_iter().enumerate().skip(1) {
        // F = c a_T x'.
        assert!((8.0 * factor(t) * rates[k] - force[k]).abs() < 1e-4 * 2.0, "{t}: {} {}", rates[k], force[k]);
        assert!((rates[k] + other[k] - whole[k]).abs() < 1e-4, "{t}");
    }
}

#[test]
fn a_pole_on_the_way_stops_the_run() {
    let wlf = "shift = { kind = \"wlf\", C1 = 17.44, C2 = 51.6, T_ref = 300 }";
    let element = format!("{}\n{wlf}\ninputs = {{ T = \"300 - 40*t\" }}", LAWS[0].1);
    for motion in [along("0.1*sin(3*t)"), forward(0.1, "0")] {
        let run = try_run(&slider(&element, &motion, 2.0, 20, "rtol = 1e-6"));
        let error = run.error.expect("a pole at t = 1.29 s").to_string();
        let time: f64 = error.strip_prefix("t = ").unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(error.contains("shift") || error.contains("pole"), "{error}");
        assert!((0.9..1.3).contains(&time), "{error}");
    }
}
