//! Kinks that hang on t alone, in expressions that also name a state.

use super::support::forward::{distance, every, largest, slider, state};
use super::support::{Run, run, try_run};
use springpot::Simulation;
use springpot::system::RunError;

const ELEMENT: &str = "law = \"kelvin-voigt\"\nparameters = { k = 4, c = 0.2 }";

/// A mass of 1 kg on a spring and a dashpot, `torque` on it.
fn driven(torque: &str, start: &str, rest: &str) -> String {
    format!("{}torque = {{ q = {torque} }}\n{rest}", slider("1", 0.0, ELEMENT, start))
}

/// What the same function does as a signal, which hangs on t alone, it does beside a state.
#[test]
fn beside_a_state_functions_of_time_switch_as_signals_do() {
    for of_time in [
        "10*step(t - 2)",
        "10*abs(sin(0.9*t))",
        "10*min(1, t/2)",
        "10*max(0, sin(3*t))",
        "3*sign(cos(2*t))",
        "5*asin(sin(4*t))",
        "2*atan2(sin(3*t), -1)",
        "sqrt(sin(2*t)^2)",
        "max(-1, min(1, 4*sin(t)))*step(t - 1.5)",
        "1e4*max(0, 1 - abs(t - 3.4)/1e-4)",
        "1e6*(step(t - 3.4) - step(t - 3.400001))",
    ] {
        for start in [state("0", "0"), state("0.3", "1")] {
            let rest = every(6.0, 0.05, 1e-9);
            let alone = run(&driven(&format!("\"{of_time}\""), &start, &rest));
            for beside in [
                format!("\"{of_time} + 0*q.q\""),
                format!("\"0*v.q + ({of_time})*(1 + 0*q.q)\""),
                format!("{{ expression = \"0*e.rate + 0.001*({of_time})\", unit = \"kN\" }}"),
            ] {
                let Ok(fed) = std::panic::catch_unwind(|| run(&driven(&beside, &start, &rest))) else {
                    panic!("{beside} from {start}")
                };
                for column in ["q.q", "tau.q"] {
                    let (a, b) = (alone.column(column), fed.column(column));
                    let off = distance(&a, &b) / largest(a.iter().copied());
                    assert!(off < 1e-7, "{beside} from {start}: {column} is off by {off:e}");
                }
                assert!(fed.residual() < 1e-7, "{beside}: {:e}", fed.residual());
            }
        }
    }
}

/// Beside a switch of time the sides of a state's kinks jump too.
#[test]
fn a_state_whose_kink_jumps_with_time_is_on_its_new_side() {
    let (start, rest) = (state("0.2", "0"), every(4.0, 0.05, 1e-9));
    // |x| < 3: the larger of the two is the switched one from t = 1 on.
    let switched = run(&driven("\"max(10*step(t - 1), q.q) - max(0, q.q)*step(1 - t)\"", &start, &rest));
    let alone = run(&driven("\"10*step(t - 1)\"", &start, &rest));
    let early = alone.t().iter().filter(|t| **t < 1.0).count();
    let off = distance(&switched.column("q.q"), &alone.column("q.q"));
    let bound = run(&driven("\"max(10*step(t - 1), q.q)*step(t - 1)\"", &start, &rest));
    assert!(distance(&bound.column("q.q"), &alone.column("q.q")) < 1e-7);
    assert!(early > 10 && off < 1e-7, "{off:e}");
}

/// A state that is told as sampled, or in steps of one size, was always looked at with its sign.
#[test]
fn other_ways_to_act_agree() {
    let (start, end) = (state("0.3", "0"), "\n[time]\nend = 3\noutput_step = 0.05\n[solver]\n");
    let text = "10*step(t - 1.5) - q.q*step(t - 2.5)";
    let at_all_times = run(&driven(&format!("\"{text}\""), &start, &every(3.0, 0.05, 1e-9)));
    for method in ["midpoint", "backward-euler"] {
        let rest = format!("{end}method = \"{method}\"\nstep = 1e-4\n");
        let fixed = run(&driven(&format!("\"{text}\""), &start, &rest));
        let off = distance(&fixed.column("q.q"), &at_all_times.column("q.q"));
        assert!(off < 2e-3, "{method}: {off:e}");
    }
    let sampled = format!("{{ expression = \"{text}\", unit = \"N\", sample = \"1 ms\" }}");
    let sampled = run(&driven(&sampled, &start, &every(3.0, 0.05, 1e-9)));
    let off = distance(&sampled.column("q.q"), &at_all_times.column("q.q"));
    assert!(off < 1e-2, "{off:e}");
}

/// A simulation that is driven from outside, and one that goes on from a state before the switch.
#[test]
fn simulations_and_states_cross_switches() {
    let text = driven("\"0*q.q + 10*step(t - 1) - 4*abs(sin(2*t))*v.q\"", &state("0.1", "0"), &every(3.0, 0.25, 1e-9));
    let whole = run(&text);
    let plan = super::support::cases(&text).plan(0).unwrap();
    let mut simulation = Simulation::new(plan.system(), plan.settings.clone()).unwrap();
    let mut other = Simulation::new(plan.system(), plan.settings).unwrap();
    for (k, expected) in whole.column("q.q").into_iter().enumerate().skip(1) {
        simulation.step_to(0.25 * k as f64).unwrap();
        let off = (simulation.q()[0] - expected).abs();
        assert!(off < 1e-8, "row {k}: {off:e}");
        let state = simulation.state().unwrap();
        other.set_state(&state).unwrap();
        assert_eq!(other.state().unwrap().t(), simulation.t());
        std::mem::swap(&mut simulation, &mut other);
    }
}

/// An input that jumps by feedback is accounted for, and one that must not jump is refused.
#[test]
fn inputs_that_switch_with_time_close_the_balance() {
    let damper =
        "law = \"magnetorheological\"\nparameters = { E_c = 5, mu_0 = 1, mu = 2, alpha = 0.6 }\ninputs = { u = INPUT }";
    let strut = |u: &str| slider("1", 0.0, &damper.replace("INPUT", u), &state("0.5", "0"));
    let rest = every(5.0, 0.05, 1e-9);
    let of_time = ["step(t - 2)", "abs(sin(3*t))", "max(0, 1 - abs(t - 2)/1e-3)"];
    for of_time in of_time {
        let alone = run(&format!("{}{rest}", strut(&format!("\"{of_time}\""))));
        let fed: Run = run(&format!("{}{rest}", strut(&format!("\"{of_time} + 0*q.q\""))));
        for column in ["q.q", "e.u", "e.input"] {
            let off = distance(&alone.column(column), &fed.column(column));
            assert!(off < 1e-7, "{of_time}: {column} is off by {off:e}");
        }
        assert!(fed.residual() < 1e-8, "{of_time}: {:e}", fed.residual());
    }
    let heated = "law = \"spring\"\nparameters = { k = 40 }\ninputs = { T = \"300 + 10*step(t - 2) + 0*q.q\" }\n\
                  expansion = { coefficient = 1e-3, T_ref = 300 }";
    let hot = try_run(&format!("{}{rest}", slider("1", 0.0, heated, &state("0.5", "0"))));
    assert!(matches!(hot.error, Some(RunError::Heat { .. })), "{:?}", hot.error);
}
