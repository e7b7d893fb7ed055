use serde_json::Value;
use springpot::law::Catalog;
use springpot::motion::{Drive, Forward, Motion};
use springpot::scenario::Scenario;
use springpot::signal::Signal;
use springpot::simulate::{System, forward};
use std::time::Instant;

fn system(text: &str, q: Vec<f64>, v: Vec<f64>) -> (System, springpot::simulate::Settings) {
    let cases = Scenario::parse(text, "x.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
    let plan = cases.plan(0).unwrap();
    let mut system = plan.system();
    let n = system.model.nv();
    system.motion = Motion::Forward(Box::new(Forward {
        q,
        v,
        drives: (0..n).map(|_| Drive::Force(vec![Signal::constant(0.0)])).collect(),
    }));
    (system, plan.settings())
}

#[test]
fn arm() {
    let text = std::fs::read_to_string("../../scenarios/thermoviscoelastic_order.toml").unwrap();
    let (system, mut settings) = {
        let cases = Scenario::parse(&text, "x.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
        let k = (0..6)
            .find(|&k| {
                let p = cases.plan(k).unwrap();
                p.elements[0].parameters.contains(&0.5)
            })
            .unwrap();
        let plan = cases.plan(k).unwrap();
        println!("{:?} {}", plan.elements[0].parameters, plan.elements[0].derivative.name());
        let mut system = plan.system();
        system.motion = Motion::Forward(Box::new(Forward {
            q: vec![0.0; 3],
            v: vec![0.0; 3],
            drives: (0..3).map(|_| Drive::Force(vec![Signal::constant(0.0)])).collect(),
        }));
        (system, plan.settings())
    };
    let file: Value = serde_json::from_str(
        &std::fs::read_to_string("../../testdata/papers/forward_thermoviscoelastic.json").unwrap(),
    )
    .unwrap();
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10, 1e-11] {
        settings.rtol = rtol;
        settings.atol = Some(rtol);
        settings.memory_rtol = (rtol / 100.0).max(1e-12);
        settings.end = 5.0;
        let start = Instant::now();
        let (out, counts) = forward::prototype(&system, &settings, &[0.5, 1.0, 2.0, 5.0]).unwrap();
        let time = start.elapsed();
        let mut worst = [0f64; 2];
        for (t, (q, v)) in ["0.5", "1.0", "2.0", "5.0"].iter().zip(&out) {
            for j in 0..3 {
                worst[0] = worst[0].max((q[j] - file["A"][t]["q"][j].as_f64().unwrap()).abs());
                worst[1] = worst[1].max((v[j] - file["A"][t]["qd"][j].as_f64().unwrap()).abs());
            }
        }
        println!("{rtol:e} q {:.1e} v {:.1e} steps {counts:?} {time:?}", worst[0], worst[1]);
    }
}

#[test]
fn slider() {
    let file: Value =
        serde_json::from_str(&std::fs::read_to_string("../../testdata/papers/one_mass_exact.json").unwrap()).unwrap();
    for case in file["cases"].as_array().unwrap() {
        let num = |k: &str| case[k].as_str().unwrap().parse::<f64>().unwrap();
        let kind = if case["kind"] == "RL" { "riemann-liouville" } else { "caputo" };
        let (m, k, c, a) = (num("m"), num("K"), num("C"), num("lambda"));
        // f = -m g + force: put the constant force into the torque.
        let text = format!(
            r#"
robot.body = [{{ name = "mass", joint = {{ name = "q1", kind = "prismatic", axis = [0, 0, 1] }}, mass = {m} }}]
motion = {{ kind = "prescribed", joints = {{ q1 = "1" }} }}
time = {{ end = "5 s", output_step = "10 ms" }}
[[element]]
name = "strut"
from = {{ body = "world", point = [0, 0, 0] }}
to = {{ body = "mass", point = [0, 0, 0] }}
rest_length = 0.7
law = "fractional-kelvin-voigt"
derivative = "{kind}"
parameters = {{ k = {k}, c = {c}, alpha = {a} }}
"#
        );
        let (mut system, mut settings) = system(&text, vec![0.7 + num("x0")], vec![num("v0")]);
        let Motion::Forward(f) = &mut system.motion else { panic!() };
        f.drives = vec![Drive::Force(vec![Signal::constant(num("f") + m * 9.81)])];
        print!("{} {} {} x0 {} v0 {}:", case["element"], a, kind, num("x0"), num("v0"));
        for rtol in [1e-6, 1e-8, 1e-10] {
            settings.rtol = rtol;
            settings.atol = Some(rtol);
            settings.memory_rtol = (rtol / 100.0).max(1e-12);
            let start = Instant::now();
            let (out, counts) = forward::prototype(&system, &settings, &[0.5, 1.0, 2.0, 5.0]).unwrap();
            let time = start.elapsed();
            let mut worst = [0f64; 2];
            for (t, (q, v)) in ["0.5", "1", "2", "5"].iter().zip(&out) {
                let at = |k: &str| case[k][*t].as_str().unwrap().parse::<f64>().unwrap();
                worst[0] = worst[0].max((q[0] - 0.7 - at("x")).abs());
                worst[1] = worst[1].max((v[0] - at("xdot")).abs());
            }
            print!("  {rtol:.0e} x {:.1e} v {:.1e} {counts:?} {:.1}ms;", worst[0], worst[1], time.as_secs_f64() * 1e3);
        }
        println!();
    }
}
