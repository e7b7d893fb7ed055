//! Temperatures that losses raise.

use crate::support::{run, try_run};
use crate::{LAWS, along, departure, forward, heat_gap, slider};
use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{Catalog, Derivative, Heat, InputValue, Shift, Start, Thermal};

const THERMAL: &str = "thermal = { capacity = 0.2, conductance = 0.05, ambient = 293, start = 300 }";
const SHIFT: &str = "shift = { kind = \"wlf\", C1 = 17.44, C2 = 51.6, T_ref = 290 }";
const EXPANSION: &str = "expansion = { coefficient = \"1 mm/K\", T_ref = 293 }";

/// A dashpot under a sine: T in closed form.
#[test]
fn a_dashpot_warms_itself_as_in_closed_form() {
    let (c, amplitude, omega) = (20.0, 0.1f64, 5.0f64);
    let element = format!("law = \"dashpot\"\nparameters = {{ c = {c} }}\n{THERMAL}");
    let (capacity, conductance, ambient) = (0.2, 0.05, 293.0);
    let kappa: f64 = conductance / capacity;
    let mean = 0.5 * c * (amplitude * omega).powi(2);
    // P = mean·(1 + cos 2ωt).
    let exact = |t: f64| {
        let (decay, w) = ((-kappa * t).exp(), 2.0 * omega);
        let wave = (kappa * (w * t).cos() + w * (w * t).sin() - kappa * decay) / (kappa * kappa + w * w);
        ambient + 7.0 * decay + mean / conductance * (1.0 - decay) + mean / capacity * wave
    };
    for rtol in [1e-6, 1e-9] {
        let run = run(&slider(
            &element,
            &along(&format!("{amplitude}*sin({omega}*t)")),
            20.0,
            100,
            &format!("rtol = {rtol:e}"),
        ));
        let above = |values: Vec<f64>| values.into_iter().map(|t| t - ambient).collect::<Vec<f64>>();
        let wanted = above(run.t().into_iter().map(exact).collect());
        let error = departure(&above(run.column("e.T")), &wanted);
        println!("{error:.1e} at {rtol:e}");
        assert!(error < rtol, "{error:e} at {rtol:e}");
        assert!(heat_gap(&run, capacity) < 1e-11, "{:e}", heat_gap(&run, capacity));
    }
}

#[test]
fn losses_are_heat_stored_and_heat_lost() {
    let motions = [along("0.1*sin(3*t)"), forward(0.1, "5*sin(4*t)")];
    for (name, law) in LAWS {
        for heat in [THERMAL.to_owned(), format!("{THERMAL}\n{SHIFT}"), format!("{THERMAL}\n{SHIFT}\n{EXPANSION}")] {
            for motion in &motions {
                for solver in ["rtol = 1e-6", "rtol = 1e-9"] {
                    let run = run(&slider(&format!("{law}\n{heat}"), motion, 3.0, 60, solver));
                    println!("{name}: {:.1e}, {:.1e}", heat_gap(&run, 0.2), run.residual());
                    assert!(heat_gap(&run, 0.2) < 1e-10, "{name} {heat} {motion} {solver}: {:e}", heat_gap(&run, 0.2));
                    let rtol = if solver.ends_with('6') { 1e-6 } else { 1e-9 };
                    assert!(run.residual() < 10.0 * rtol, "{name} {heat} {motion} {solver}: {:e}", run.residual());
                }
            }
        }
    }
}

/// In steps of one size too.
#[test]
fn steps_of_one_size_warm_alike() {
    let law = format!("{}\n{THERMAL}\n{SHIFT}", LAWS[1].1);
    let motion = forward(0.1, "5*sin(4*t)");
    let fine = run(&slider(&law, &motion, 2.0, 20, "rtol = 1e-10"));
    let rise = |values: &[f64]| values.iter().map(|t| t - values[0]).collect::<Vec<_>>();
    for (method, order) in [("backward-euler", 1.0), ("midpoint", 1.6)] {
        let error = |step: f64| {
            let run = run(&slider(&law, &motion, 2.0, 20, &format!("step = {step}\nmethod = \"{method}\"")));
            assert!(heat_gap(&run, 0.2) < 1e-10, "{method}: {:e}", heat_gap(&run, 0.2));
            departure(&rise(&run.column("e.T")), &rise(&fine.column("e.T")))
        };
        let [coarse, half] = [2e-3, 1e-3].map(error);
        assert!((coarse / half).log2() > 0.8 * order && half < 0.02, "{method}: {coarse:e} {half:e}");
    }
}

/// The law that takes a temperature takes that of the state.
#[test]
fn a_law_of_temperature_takes_that_of_the_state() {
    let law = "law = \"thermoviscoelastic\"\nparameters = { E_c = 20, E_kv = 30, E_d = 40, alpha = 0.5, a_kv = 0.001, T_ref = 293 }";
    let own = run(&slider(&format!("{law}\n{THERMAL}"), &along("0.1*sin(3*t)"), 3.0, 30, "rtol = 1e-9"));
    let told = run(&slider(&format!("{law}\ninputs = {{ T = 293 }}"), &along("0.1*sin(3*t)"), 3.0, 30, "rtol = 1e-9"));
    assert_eq!(own.names.iter().filter(|name| *name == "e.T").count(), 1);
    for (k, temperature) in own.column("e.T").into_iter().enumerate() {
        let expected = told.column("e.force")[k] - 30.0 * 0.001 * (temperature - 293.0);
        assert!((own.column("e.force")[k] - expected).abs() < 1e-8, "row {k}");
    }
}

/// A dashpot that is driven whatever it loses, and surroundings that take next to nothing.
#[test]
fn running_away_is_told_with_its_time() {
    let element = "law = \"springpot\"\nparameters = { c = 2000, alpha = 1 }\n\
                   thermal = { capacity = \"1 J/K\", conductance = \"0.01 W/K\", ambient = 293 }";
    for motion in
        [along("0.3*sin(20*t)"), format!("{}\nprescribed = {{ q = \"0.3*sin(20*t)\" }}", "kind = \"forward\"")]
    {
        let run = try_run(&slider(element, &motion, 10.0, 1000, "rtol = 1e-6"));
        let error = run.error.expect("1500 K after 0.034 s").to_string();
        assert!(error.starts_with("t = 0.0") && error.contains("\"e\" runs away"), "{error}");
        assert!(!run.rows.is_empty());
    }
}

#[test]
fn a_jump_at_the_start_has_no_temperature() {
    let element = format!("{}\nderivative = \"riemann-liouville\"\n{THERMAL}", LAWS[0].1);
    let run = try_run(&slider(&element, &along("0.1 + 0.1*t"), 1.0, 10, "rtol = 1e-6"));
    let error = run.error.expect("a refusal").to_string();
    assert!(error.contains("t = 0 s") && error.contains("temperature of its own"), "{error}");
}

/// Any engine drives a heated law: what was saved goes on to the bit.
#[test]
fn banks_carry_heat() {
    let shift = Some(Shift::Wlf { c1: 17.44, c2: 51.6, reference: 290.0 });
    let thermal = Some(Thermal { capacity: 0.2, conductance: 0.05, ambient: 293.0, start: 300.0 });
    let catalog = Catalog::standard();
    let zener = catalog.get("fractional-zener").unwrap();
    let law = |heat: Heat| zener.with_heat(heat).unwrap().build(&[20.0, 100.0, 30.0, 0.5], Derivative::Caputo).unwrap();
    let laws = [Heat { shift, thermal, expansion: None }, Heat { shift, ..Heat::default() }].map(law);
    let inputs = |t: f64| [InputValue { value: 300.0 + 5.0 * t, rate: 5.0 }];
    let begun = || {
        let mut bank = ElementBank::new(laws.to_vec(), Nodes::Radau, Form::Rates);
        let first = inputs(0.0);
        let starts = [Start { stroke: 0.0, jump: 0.0, inputs: &[] }, Start { stroke: 0.0, jump: 0.0, inputs: &first }];
        bank.begin(&starts, MemoryRange { tolerance: 1e-10, shortest: 0.01, horizon: 2.0 }).unwrap();
        bank
    };
    let go_on = |bank: &mut ElementBank, n: u32| {
        let (t, h) = (0.01 * f64::from(n), 0.01);
        bank.start(t, h);
        for (k, c) in [0.0].iter().chain(Nodes::Radau.positions()).enumerate() {
            let at = t + c * h;
            bank.set(0, k, at * at, 2.0 * at, &[]);
            bank.set(1, k, at * at, 2.0 * at, &inputs(at));
        }
        bank.evaluate();
        bank.commit();
    };
    let (mut bank, mut numbers) = (begun(), Vec::new());
    (0..60).for_each(|n| go_on(&mut bank, n));
    bank.save(&mut numbers);
    let mut other = begun();
    assert!(other.load(&numbers));
    for n in 60..100 {
        go_on(&mut bank, n);
        go_on(&mut other, n);
        assert_eq!((bank.response(0), bank.response(1)), (other.response(0), other.response(1)), "step {n}");
    }
    let warmth = bank.warmth(0, None).unwrap();
    assert!(warmth.temperature > 300.0 && warmth.lost > 0.0 && bank.warmth(1, None).is_none(), "{warmth:?}");
}

/// A temperature is a column like any other: it stops a run.
#[test]
fn events_watch_temperatures() {
    let element = format!("law = \"dashpot\"\nparameters = {{ c = 20 }}\n{THERMAL}");
    let event = "[[event]]\nname = \"warm\"\nwhen = \"e.T - 305\"\naction = \"stop\"\n";
    let driven = "kind = \"forward\"\nprescribed = { q = \"0.2*sin(5*t)\" }";
    let run = run(&(slider(&element, driven, 5.0, 50, "rtol = 1e-8") + event));
    let temperature = run.column("e.T");
    assert!(run.rows.len() < 51 && temperature.iter().all(|t| *t < 305.0 + 1e-6), "{temperature:?}");
    assert!(temperature.last().is_some_and(|t| *t > 303.0), "{temperature:?}");
}

/// What expands cannot jump.
#[test]
fn a_jump_of_the_temperature_does_not_stretch() {
    for (expansion, is_refused) in [(EXPANSION, true), ("", false)] {
        let element = format!("{}\n{SHIFT}\n{expansion}\ninputs = {{ T = \"300 + 5*step(t - 1)\" }}", LAWS[1].1);
        for motion in [along("0.1*sin(3*t)"), forward(0.1, "0")] {
            let run = try_run(&slider(&element, &motion, 2.0, 20, "rtol = 1e-6"));
            match run.error {
                Some(error) if is_refused => {
                    let error = error.to_string();
                    assert!(error.starts_with("t = 1 s") && error.contains("does not jump"), "{error}");
                }
                None if !is_refused => assert!(run.residual() < 1e-5, "{:e}", run.residual()),
                other => panic!("{other:?}"),
            }
        }
    }
}
