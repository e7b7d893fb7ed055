//! Every law and every leaf of the language by all its numbers, whatever they are called: who adds one need not think of this test.

use crate::laws::slider;
use crate::{plan, scenario};
use springpot::Simulation;
use springpot::law::{Catalog, Input, LeafBuild, LeafKind, Param};
use springpot::observe::{ElementQuantity, Quantity};

/// Laws that are refused where derivatives are asked for, with why.
const REFUSED: [(&str, &str); 0] = [];

/// Times that are compared: of free motions behind what is switched on, and of led ones.
const FREE: [f64; 2] = [0.0334, 0.0534];
const LED: [f64; 2] = [0.0134, 0.0334];

/// Laws of more numbers have half of them compared in each motion.
const MANY: usize = 3;

/// Two sizes of a number of this name and unit, which are those of a stiff and light device, and the step of its differences.
fn sizes(param: &Param) -> [f64; 3] {
    let (name, unit) = (&*param.name, &*param.unit);
    let [one, other] = match (name, unit) {
        ("alpha_creep" | "creep", _) => [0.2, 0.3],
        (alpha, "" | "1") if alpha.starts_with("alpha") => [0.4, 0.7],
        ("A" | "A_z", _) => [1.1, 0.9],
        ("n", _) => [2.2, 2.0],
        ("a", _) => [0.15, 0.1],
        ("beta" | "gamma", _) if unit.contains("V^n") => [0.004, 0.003],
        ("beta", _) => [150.0, 120.0],
        ("gamma", _) => [260.0, 240.0],
        ("F_block", _) => [40.0, 30.0],
        ("V_max", _) => [100.0, 90.0],
        ("V_min", _) => [-90.0, -80.0],
        ("x_0", _) => [0.6, 0.5],
        ("lower", _) => [-0.01, -0.02],
        ("upper", _) => [0.012, 0.013],
        ("a_kv" | "alpha_pz", _) => [1e-3, 2e-3],
        ("T_ref", _) => [294.0, 296.0],
        ("k_3", _) => [900.0, 800.0],
        ("tau" | "tau_i", _) => [0.05, 0.2],
        (_, "N") => [1.3, 2.1],
        (_, "m") => [0.01, 0.02],
        (_, "m/s") => [0.2, 0.3],
        (_, "s") => [0.05, 0.2],
        (_, "1/s") => [60.0, 50.0],
        (_, "V") => [3.0, 8.0],
        (_, "F") => [1e-3, 2e-3],
        (_, "ohm") => [5.0, 6.0],
        (_, "") | (_, "1") => [0.3, 0.2],
        (_, unit) if unit.contains('V') => [2.0, 3.0],
        (_, unit) if unit.contains("s^") => [12.0, 7.0],
        (_, unit) if unit.starts_with("N*s/m") => [6.0, 4.0],
        (_, unit) if unit.starts_with("N/m") => [60.0, 40.0],
        other => panic!("which size has {other:?}?"),
    };
    [one, other, 5e-3 * one.abs()]
}

/// Its parameters as a file has them, and the path and the step of each.
fn written(params: &[Param]) -> (String, Vec<(String, f64)>) {
    let (mut text, mut paths) = (Vec::new(), Vec::new());
    for (k, param) in params.iter().enumerate() {
        let [one, other, step] = sizes(param);
        // Numbers of one kind differ.
        let one = if k % 2 == 0 { one } else { one * 1.07 };
        let path = format!("element.strut.parameters.{}", param.name);
        if param.is_list {
            text.push(format!("{} = [{one:?}, {other:?}]", param.name));
            paths.extend((0..2).map(|k| (format!("{path}.{k}"), step)));
        } else {
            text.push(format!("{} = {one:?}", param.name));
            paths.push((path, step));
        }
    }
    (format!("parameters = {{ {} }}", text.join(", ")), paths)
}

/// Functions of time of inputs.
fn inputs(inputs: &[Input]) -> String {
    let one = |input: &Input| match &*input.unit {
        "K" => format!("{} = \"296 + 3*sin(20*t)\"", input.name),
        _ => format!("{} = \"10 + 4*sin(20*t)\"", input.name),
    };
    match inputs {
        [] => String::new(),
        inputs => format!("\ninputs = {{ {} }}", inputs.iter().map(one).collect::<Vec<_>>().join(", ")),
    }
}

/// q, v, force and what is stored, at these times, or what parameters change of them.
fn rows(text: &str, times: [f64; 2], set: &[String], by: Option<&str>) -> Vec<Vec<f64>> {
    let mut asked = scenario(text);
    set.iter().for_each(|set| asked.set(set).unwrap());
    by.into_iter().for_each(|by| asked.differentiate(by).unwrap());
    let plan = plan(&asked).unwrap_or_else(|refusals| panic!("{refusals}"));
    let mut simulation =
        Simulation::new(plan.system(), plan.settings.clone()).unwrap_or_else(|error| panic!("{error}"));
    let of_element = [ElementQuantity::Force, ElementQuantity::Stored].map(|of| Quantity::Element(0, of));
    let own = [Quantity::Coordinate(0), Quantity::Velocity(0)].into_iter().chain(of_element);
    let quantities: Vec<Quantity> = match by {
        None => own.collect(),
        Some(by) => {
            let count = by.split(',').count();
            let observables = plan.system().observables();
            let told = observables.quantities().into_iter().filter(|of| matches!(of, Quantity::Derivative(_)));
            let told: Vec<Quantity> = told.collect();
            let names: Vec<String> = own.map(|of| observables.named(of).to_string()).collect();
            let is_of =
                |of: &Quantity, name: &str| observables.named(*of).to_string().starts_with(&format!("d({name})/"));
            let found = names.iter().flat_map(|name| told.iter().filter(move |of| is_of(of, name)).copied());
            let found: Vec<Quantity> = found.collect();
            assert_eq!(found.len(), 4 * count, "{text}");
            found
        }
    };
    let row = |t: f64| {
        while simulation.t() < t {
            simulation.step().unwrap_or_else(|error| panic!("{error}\n{text}"));
        }
        let snapshot = simulation.interpolate(t).unwrap();
        quantities.iter().map(|quantity| snapshot.value(*quantity)).collect()
    };
    times.map(row).to_vec()
}

/// Derivatives by all numbers against differences of the fourth order of whole runs, free under a force that is switched on and grows, and led.
fn compare(name: &str, element: &str, paths: &[(String, f64)]) {
    let free = slider(element)
        .replace(
            "q1 = 0.1 }, v = { q1 = 1 } }",
            "q1 = 0.06 }, v = { q1 = 0.4 } }\ntorque = { q1 = \"4*step(t - 0.02) + 20*t\" }",
        )
        .replace("end = 0.4", "end = 0.06")
        .replace("rtol = 1e-10", "rtol = 1e-9");
    let led = slider(element)
        .replace(
            "kind = \"forward\"\nstart = { q = { q1 = 0.1 }, v = { q1 = 1 } }",
            "kind = \"prescribed\"\njoints = { q1 = \"0.04 + 0.03*sin(30*t)\" }",
        )
        .replace("end = 0.4", "end = 0.04")
        .replace("rtol = 1e-10", "rtol = 1e-9");
    let all: Vec<&str> = paths.iter().map(|(path, _)| &**path).collect();
    for (motion, (text, times, tight)) in
        [(&free, FREE, "solver.rtol=1e-10"), (&led, LED, "solver.rtol=1e-9")].into_iter().enumerate()
    {
        let found = rows(text, times, &[], Some(&all.join(",")));
        let compared = |p: &usize| paths.len() <= MANY || p % 2 == motion;
        for (p, (path, step)) in paths.iter().enumerate().filter(|(p, _)| compared(p)) {
            let mut asked = scenario(text);
            asked.differentiate(path).unwrap();
            let value = plan(&asked).unwrap().sensitivity.unwrap().parameters[0].value;
            let at =
                |steps: f64| rows(text, times, &[format!("{path}={:?}", value + steps * step), tight.to_owned()], None);
            let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
            for k in 0..4 {
                let truth = |r: usize| (8.0 * (a[r][k] - b[r][k]) - (c[r][k] - d[r][k])) / (12.0 * step);
                let size = (0..times.len()).map(|r| truth(r).abs()).fold(0.0, f64::max);
                for r in 0..times.len() {
                    let of = found[r][k * paths.len() + p];
                    // What the runs that are compared may be off.
                    let known = 1e-6 * size + 2e-11 * (1.0 + a[r][k].abs()) / step;
                    assert!(
                        (of - truth(r)).abs() <= known,
                        "{name}: {k} by {path} at {}: {of} for {}",
                        times[r],
                        truth(r)
                    );
                }
            }
        }
    }
}

fn laws(part: usize) {
    let catalog = Catalog::standard();
    for entry in catalog.entries().iter().skip(part).step_by(2) {
        let refused = REFUSED.iter().any(|(name, _)| *name == entry.name);
        let (parameters, paths) = written(&entry.params);
        let element = format!("law = \"{}\"\n{parameters}{}", entry.name, inputs(&entry.inputs));
        assert!(!refused, "{}: who says that it is refused shows it", entry.name);
        compare(&entry.name, &element, &paths);
    }
}

#[test]
fn every_other_law() {
    laws(0);
}

#[test]
fn and_the_others() {
    laws(1);
}

/// Beside a spring, since some hold nothing alone.
#[test]
fn every_leaf() {
    for kind in LeafKind::all() {
        // A table is a file: it has no numbers.
        let LeafBuild::Values(_) = kind.build else { continue };
        let (parameters, paths) = written(&kind.params);
        let names: Vec<&str> = kind.params.iter().map(|param| &*param.name).collect();
        let parameters = parameters.replace(" }", ", k_beside = 35 }");
        let element =
            format!("network = \"parallel({}({}), spring(k_beside))\"\n{parameters}", kind.name, names.join(", "));
        compare(kind.name, &element, &paths);
    }
}
