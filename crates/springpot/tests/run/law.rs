//! Laws on their own: tangents, sums, the catalog, and the rules that keep an element passive.

use crate::steps::random_steps;
use springpot::collocation::Nodes;
use springpot::fractional::Form;
use springpot::law::{Catalog, Derivative, Entry, InputValue, Network, Point, Start, State, Step};
use springpot_scenario::units::{Unit, parse_quantity};
use std::sync::Arc;

/// Parameter values well inside their ranges; alpha where the law has one.
fn parameters(entry: &Entry, alpha: f64) -> Vec<f64> {
    let value = |(k, param): (usize, &springpot::law::Param)| match (&*param.name, param.default) {
        ("alpha", _) => alpha,
        (_, Some(default)) => default,
        _ => 3.0 + k as f64,
    };
    entry.params.iter().enumerate().map(value).collect()
}

/// The laws whose parts stand side by side and are linear.
fn plain() -> Vec<Arc<Entry>> {
    Catalog::standard().entries()[..8].to_vec()
}

fn build(entry: &Entry, alpha: f64, derivative: Derivative) -> Network {
    entry.build(&parameters(entry, alpha), derivative).unwrap()
}

/// An input and its rate: a temperature near 300 K, a voltage near 0.6 V.
fn input(entry: &Entry, t: f64) -> Vec<InputValue> {
    let wave = InputValue { value: 0.6 + 0.3 * (5.0 * t).sin(), rate: 1.5 * (5.0 * t).cos() };
    let shift = |low: f64| if low > 0.0 { 300.0 } else { 0.0 };
    entry.inputs.iter().map(|i| InputValue { value: wave.value + shift(i.range.low), ..wave }).collect()
}

fn stroke(t: f64) -> f64 {
    0.02 + 0.1 * (7.0 * t).sin()
}

fn rate(t: f64) -> f64 {
    0.7 * (7.0 * t).cos()
}

/// Data of one step, owned.
#[derive(Clone)]
struct Samples {
    t: f64,
    h: f64,
    nodes: Nodes,
    form: Form,
    stroke: Vec<f64>,
    rate: Vec<f64>,
    inputs: Vec<InputValue>,
}

impl Samples {
    fn new(entry: &Entry, t: f64, h: f64, nodes: Nodes, form: Form) -> Self {
        let times: Vec<f64> = [0.0].iter().chain(nodes.positions()).map(|c| t + c * h).collect();
        let inputs = times.iter().flat_map(|t| input(entry, *t)).collect();
        let (stroke, rate) = times.iter().map(|t| (stroke(*t), rate(*t))).unzip();
        Self { t, h, nodes, form, stroke, rate, inputs }
    }

    fn step(&self) -> Step<'_> {
        Step {
            t: self.t,
            h: self.h,
            nodes: self.nodes,
            places: None,
            form: self.form,
            stroke: &self.stroke,
            rate: &self.rate,
            inputs: &self.inputs,
            resolution: 1e-16,
            course: springpot::law::Course::Given,
        }
    }
}

/// The state of a law at the start of the motion, of which x(0) counts as a jump or not.
fn begin(law: &Network, jump: bool, inputs: &[InputValue]) -> State {
    let x = stroke(0.0);
    let mut state = law.begin(&Start { stroke: x, jump: if jump { x } else { 0.0 }, inputs }).unwrap();
    state.open(1e-11, 1e-3, 5.0).unwrap();
    state
}

const FORMS: [(Nodes, Form); 4] = [
    (Nodes::Radau, Form::Rates),
    (Nodes::Radau, Form::Strokes),
    (Nodes::One, Form::Rates),
    (Nodes::One, Form::Strokes),
];

const KINDS: [Derivative; 2] = [Derivative::Caputo, Derivative::RiemannLiouville];

/// Calls `check` on every law, order, kind and form, in the middle of a motion.
fn everywhere(mut check: impl FnMut(&Entry, &Network, &State, &Samples, &str)) {
    let mut count = 0;
    for entry in &plain() {
        for alpha in [0.0, 0.2, 0.5, 0.9, 1.0] {
            for kind in KINDS {
                for (nodes, form) in FORMS {
                    let law = build(entry, alpha, kind);
                    let mut state = begin(&law, kind == Derivative::RiemannLiouville, &input(entry, 0.0));
                    for (t, h) in random_steps(3, 12, 1e-3, 0.1) {
                        let samples = Samples::new(entry, t, h, nodes, form);
                        let case = format!("{} alpha = {alpha} {kind:?} {nodes:?} {form:?} t = {t}", entry.name);
                        check(entry, &law, &state, &samples, &case);
                        law.commit(&samples.step(), &mut state);
                        count += 1;
                    }
                }
            }
        }
    }
    assert_eq!(count, 8 * 5 * 2 * 4 * 12);
}

#[test]
fn tangents_are_the_differences_of_the_forces() {
    let mut compared = 0;
    everywhere(|_, law, state, samples, case| {
        let response = law.evaluate(&samples.step(), state);
        let count = samples.nodes.count();
        for j in 0..count {
            // All laws are affine in strokes and rates: any difference is the tangent.
            for (by_rate, size) in [(false, 0.05), (true, 0.4)] {
                let mut moved = samples.clone();
                let data = if by_rate { &mut moved.rate } else { &mut moved.stroke };
                data[j + 1] += size;
                let after = law.evaluate(&moved.step(), state);
                for i in 0..count {
                    let tangent = if by_rate { response.d_rate[i][j] } else { response.d_stroke[i][j] };
                    let difference = (after.force[i] - response.force[i]) / size;
                    let scale = tangent.abs().max(response.force[i].abs() / size).max(1e-3);
                    assert!((tangent - difference).abs() < 1e-12 * scale, "{case}: {tangent} {difference}");
                    compared += 1;
                }
                assert_eq!((after.d_stroke, after.d_rate), (response.d_stroke, response.d_rate), "{case}");
            }
        }
    });
    println!("{compared} tangents");
    // 8 laws · 5 orders · 2 kinds · 12 steps · (two forms of 3 × 3 · 2 and two of 1 · 2)
    assert_eq!(compared, 8 * 5 * 2 * 12 * 2 * (18 + 2));
}

#[test]
fn forces_and_observations_agree() {
    everywhere(|_, law, state, samples, case| {
        let step = samples.step();
        let response = law.evaluate(&step, state);
        for (i, c) in samples.nodes.positions().iter().enumerate() {
            let at = step.point(i + 1);
            // Observation takes the exact rate where the strokes' polynomial has its own: order 1 by strokes is left out.
            if law.reported_order(&at) == 1.0 && samples.form == Form::Strokes {
                continue;
            }
            let seen = law.at(&step, *c, &at, state);
            let scale = response.force[i].abs().max(1.0);
            assert!(
                (seen.force() - response.force[i]).abs() < 1e-9 * scale,
                "{case}: {} {}",
                seen.force(),
                response.force[i]
            );
        }
    });
}

#[test]
fn laws_without_memory_answer_by_their_equations() {
    everywhere(|entry, law, state, samples, case| {
        let step = samples.step();
        let response = law.evaluate(&step, state);
        for i in 0..samples.nodes.count() {
            let (x, v) = (samples.stroke[i + 1], samples.rate[i + 1]);
            let wanted = match &*entry.name {
                "spring" => 3.0 * x,
                "dashpot" => 3.0 * v,
                "kelvin-voigt" => 3.0 * x + 4.0 * v,
                _ => return,
            };
            assert!((response.force[i] - wanted).abs() < 1e-14, "{case}");
        }
    });
}

#[test]
fn parallel_parts_add() {
    let kind = Derivative::Caputo;
    let two = Network::parallel([
        Network::springpot(3.0, 0.3, kind),
        Network::spring(5.0),
        Network::springpot(2.0, 0.8, kind),
        Network::dashpot(0.5),
        Network::parallel([Network::spring(1.0), Network::dashpot(0.25)]),
    ]);
    let parts = [
        Network::springpot(3.0, 0.3, kind),
        Network::springpot(2.0, 0.8, kind),
        Network::spring(6.0),
        Network::dashpot(0.75),
    ];
    let entry = Catalog::standard();
    let entry = entry.get("spring").unwrap();
    let mut whole = begin(&two, false, &[]);
    let mut states: Vec<State> = parts.iter().map(|part| begin(part, false, &[])).collect();
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
    assert_eq!(two.reported_order(&at), 0.3, "the first springpot is the one reported");
    for (t, h) in random_steps(4, 20, 1e-3, 0.1) {
        let samples = Samples::new(entry, t, h, Nodes::Radau, Form::Rates);
        let step = samples.step();
        let together = two.evaluate(&step, &whole);
        let powers = two.powers(&step, &whole);
        let at = step.point(3);
        let stored = two.at(&step, 1.0, &at, &whole).stored.unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * (1.0 + b.abs());
        let sum = |f: &dyn Fn(usize) -> f64| -> f64 { (0..parts.len()).map(f).sum() };
        for i in 0..3 {
            assert!(close(together.force[i], sum(&|p| parts[p].evaluate(&step, &states[p]).force[i])));
            for j in 0..3 {
                assert!(close(together.d_rate[i][j], sum(&|p| parts[p].evaluate(&step, &states[p]).d_rate[i][j])));
                assert!(close(together.d_stroke[i][j], sum(&|p| parts[p].evaluate(&step, &states[p]).d_stroke[i][j])));
            }
        }
        for k in 0..4 {
            assert!(close(powers[k].dissipation, sum(&|p| parts[p].powers(&step, &states[p])[k].dissipation)));
        }
        assert!(close(stored, sum(&|p| parts[p].at(&step, 1.0, &at, &states[p]).stored.unwrap())));
        two.commit(&step, &mut whole);
        parts.iter().zip(&mut states).for_each(|(part, state)| part.commit(&step, state));
        assert_eq!(whole.modes(), states.iter().map(State::modes).sum::<usize>());
    }
}

#[test]
fn asking_is_pure_and_states_go_through_json() {
    for entry in &plain() {
        let law = build(entry, 0.4, Derivative::RiemannLiouville);
        let mut state = begin(&law, true, &input(entry, 0.0));
        for (t, h) in random_steps(8, 30, 1e-5, 0.1) {
            let samples = Samples::new(entry, t, h, Nodes::Radau, Form::Rates);
            let step = samples.step();
            let before = serde_json::to_string(&state).unwrap();
            let first = law.evaluate(&step, &state);
            law.powers(&step, &state);
            law.local_errors(&step, &state, &mut Vec::new());
            law.at(&step, 0.3, &step.point(2), &state);
            law.now(&step.point(0), &state);
            assert_eq!(first, law.evaluate(&step, &state), "{}", entry.name);
            assert_eq!(before, serde_json::to_string(&state).unwrap(), "{}", entry.name);
            let mut read: State = serde_json::from_str(&before).unwrap();
            law.commit(&step, &mut state);
            law.commit(&step, &mut read);
            assert_eq!(serde_json::to_string(&state).unwrap(), serde_json::to_string(&read).unwrap(), "{}", entry.name);
        }
    }
}

#[test]
fn constant_and_varying_inputs() {
    // Magnetorheological: c = mu_0 + u·mu outside the derivative, so forces of equal memories are in the ratio of the c.
    let catalog = Catalog::standard();
    let entry = catalog.get("magnetorheological").unwrap();
    let law = entry.build(&[0.0, 5.0, 2.0, 0.5], Derivative::Caputo).unwrap();
    let mut state = begin(&law, false, &input(entry, 0.0));
    for (t, h) in random_steps(5, 20, 1e-3, 0.1) {
        let varying = Samples::new(entry, t, h, Nodes::Radau, Form::Rates);
        let mut constant = varying.clone();
        constant.inputs.iter_mut().for_each(|u| *u = InputValue { value: 1.5, rate: 0.0 });
        let (a, b) = (law.evaluate(&varying.step(), &state), law.evaluate(&constant.step(), &state));
        for i in 0..3 {
            let u = varying.inputs[i + 1].value;
            let wanted = b.force[i] / 8.0 * (5.0 + 2.0 * u);
            assert!((a.force[i] - wanted).abs() < 1e-13 * b.force[i].abs().max(1.0));
        }
        // Only a varying coefficient exchanges energy with its input, at the rate mu·u'·ψ.
        let powers = law.powers(&varying.step(), &state);
        assert!(law.powers(&constant.step(), &state).iter().all(|p| p.input == 0.0));
        let psi = law.now(&constant.step().point(0), &state).stored.unwrap() / 8.0;
        let wanted = 2.0 * varying.inputs[0].rate * psi;
        assert!((powers[0].input - wanted).abs() < 1e-12 * wanted.abs().max(1e-3), "{} {wanted}", powers[0].input);
        law.commit(&varying.step(), &mut state);
    }
    // Rules over the inputs: the coefficient must not turn negative.
    let weak = entry.build(&[0.0, 5.0, -2.0, 0.5], Derivative::Caputo).unwrap();
    let u = |value: f64| [InputValue { value, rate: 0.0 }];
    assert!(weak.check_inputs(&u(2.5)).is_ok());
    let broken = weak.check_inputs(&u(2.6)).unwrap_err();
    assert!(broken.rule.contains("mu_0 + u·mu ≥ 0") && broken.parameter == "mu", "{broken}");
    assert!(weak.check_inputs(&u(f64::NAN)).is_err());
}

#[test]
fn drives_push_by_their_gain() {
    let catalog = Catalog::standard();
    for (name, values, gain, reference) in [
        ("thermoviscoelastic", vec![30.0, 20.0, 50.0, 0.5, 0.0007, 293.15], 0.014, 293.15),
        ("piezo-kelvin-voigt", vec![2000.0, 3000.0, 5000.0, 0.5, 1e-5], 0.03, 0.0),
    ] {
        let entry = catalog.get(name).unwrap();
        let law = entry.build(&values, Derivative::Caputo).unwrap();
        let state = begin(&law, false, &input(entry, 0.0));
        let force = |value: f64| {
            let inputs = [InputValue { value, rate: 0.0 }];
            law.now(&Point { t: 1.0, stroke: 0.01, rate: 0.2, inputs: &inputs }, &state).force()
        };
        for value in [reference - 20.0, reference, reference + 35.0] {
            assert!((force(value) - force(reference) + gain * (value - reference)).abs() < 1e-12, "{name}");
        }
        // The drive supplies −F_drive·x'.
        let samples = Samples::new(entry, 0.1, 0.01, Nodes::Radau, Form::Rates);
        let powers = law.powers(&samples.step(), &state);
        for k in 0..4 {
            let wanted = gain * (samples.inputs[k].value - reference) * samples.rate[k];
            assert!((powers[k].input - wanted).abs() < 1e-13, "{name}: {} {wanted}", powers[k].input);
        }
    }
}

#[test]
fn the_catalog_is_complete_and_in_order() {
    let catalog = Catalog::standard();
    let names: Vec<_> = catalog.entries().iter().map(|entry| &*entry.name).collect();
    assert_eq!(
        names,
        [
            "spring",
            "dashpot",
            "springpot",
            "kelvin-voigt",
            "fractional-kelvin-voigt",
            "thermoviscoelastic",
            "piezo-kelvin-voigt",
            "magnetorheological",
            "magnetorheological-bouc-wen",
            "piezo-stack",
            "piezo-stack-bouc-wen",
            "piezo-stack-prandtl-ishlinskii",
            "piezo-stack-feed-forward",
            "spencer",
            "bouc-wen-damper",
            "fractional-bouc-wen-damper",
            "bingham",
            "fractional-bingham",
            "filled-rubber",
            "maxwell",
            "fractional-maxwell",
            "zener",
            "fractional-zener",
            "poynting-thomson",
            "burgers",
            "fractional-burgers",
            "jeffreys",
            "bouc-wen",
            "prony"
        ]
    );
    for entry in catalog.entries() {
        let name = &*entry.name;
        assert!(entry.equation.starts_with("F ") && !entry.source.is_empty(), "{name}");
        // Every symbol of the row stands in its equation, and every parameter that is a name alone.
        for symbol in entry.params.iter().map(|p| &*p.name).chain(entry.inputs.iter().map(|i| &*i.name)) {
            assert!(entry.equation.contains(symbol), "{name}: {symbol} is not in {}", entry.equation);
        }
        let all: Vec<_> = entry.params.iter().map(|p| &*p.name).chain(entry.inputs.iter().map(|i| &*i.name)).collect();
        assert!((1..all.len()).all(|k| !all[..k].contains(&all[k])), "{name}: a symbol stands twice");
        for param in &entry.params {
            let is_number = |symbol: &str| entry.params.iter().any(|p| p.name == symbol && p.unit.is_empty());
            let alpha = |symbol: &str| is_number(symbol).then_some(0.5);
            let unit = Unit::parse(&param.unit, &alpha).unwrap_or_else(|e| panic!("{name}.{}: {e}", param.name));
            assert!(unit.scale() == 1.0 && unit.shift() == 0.0, "{name}.{}: the unit is not SI", param.name);
            assert!(parse_quantity("3", &param.unit, &alpha).is_ok(), "{name}.{}", param.name);
            assert!(!param.meaning.is_empty() && param.range.low <= param.range.high, "{name}.{}", param.name);
            assert!(param.default.is_none_or(|value| param.range.contains(value)), "{name}.{}", param.name);
            assert!(!param.range.contains(f64::NAN) && !param.range.contains(f64::INFINITY));
            if param.name == "alpha" {
                assert_eq!((param.range.low, param.range.high, &*param.unit), (0.0, 1.0, ""));
            }
        }
        for input in &entry.inputs {
            let unit = Unit::parse(&input.unit, &|_| None).unwrap_or_else(|e| panic!("{name}.{}: {e}", input.name));
            assert!(unit.scale() == 1.0 && unit.shift() == 0.0, "{name}.{}", input.name);
            assert!(!input.meaning.is_empty());
        }
    }
}

#[test]
fn a_law_without_any_coefficient_is_refused() {
    // A piezo stack, and springs of a filler, are stiff whatever their parameters, all of which are positive.
    let is_stiff = |entry: &Arc<Entry>| entry.name.starts_with("piezo-stack") || entry.name == "filled-rubber";
    for (k, entry) in Catalog::standard().entries().iter().enumerate().filter(|(_, entry)| !is_stiff(entry)) {
        let zeros: Vec<f64> =
            entry.params.iter().map(|p| if p.name == "alpha" { 0.5 } else { 0.0f64.max(p.range.low) }).collect();
        let broken = entry.build(&zeros, Derivative::Caputo).expect_err(&entry.name);
        assert!(entry.params.iter().any(|p| p.name == broken.parameter), "{}: {}", entry.name, broken.parameter);
        assert!(broken.rule.contains(&*broken.parameter), "{}: {broken}", entry.name);
        // One positive coefficient of a stiffness or of a viscosity makes it a material, but where parts stand in series.
        if k >= 8 {
            continue;
        }
        let passive = |p: &&springpot::law::Param| p.range.low == 0.0 && p.name != "alpha";
        for param in entry.params.iter().filter(passive) {
            let mut values = zeros.clone();
            values[entry.params.iter().position(|p| p.name == param.name).unwrap()] = 1.0;
            assert!(entry.build(&values, Derivative::Caputo).is_ok(), "{}: {} = 1", entry.name, param.name);
        }
    }
}

#[test]
fn rows_can_be_added_and_replaced() {
    // Owned text and what the closure keeps: nothing of the row is known before the program runs.
    let stiffness = 1000.0;
    let stiff = Entry {
        name: "stiff".into(),
        equation: format!("F = {stiffness}·x").into(),
        params: vec![],
        inputs: vec![],
        source: "a user's crate".into(),
        build: Arc::new(move |_, _| Ok(Network::spring(stiffness))),
    };
    let count = Catalog::standard().entries().len();
    let catalog = Catalog::standard().with(stiff.clone());
    assert_eq!(catalog.entries().len(), count + 1);
    assert_eq!(catalog.get("stiff").unwrap().source, "a user's crate");
    let replaced = catalog.with(Entry { name: "spring".into(), ..stiff });
    assert_eq!(replaced.entries().len(), count + 1);
    assert_eq!(replaced.get("spring").unwrap().equation, "F = 1000·x");
    assert!(replaced.get("spr1ng").is_none());
    let text = r#"
[[robot.body]]
name = "slider"
joint = { name = "q", kind = "prismatic", axis = [1, 0, 0] }
mass = 2.0
[[element]]
name = "e"
from = { body = "world", point = [-1, 0, 0] }
to = { body = "slider", point = [0, 0, 0] }
rest_length = 1
law = "stiff"
[motion]
kind = "prescribed"
joints = { q = "0.1*t" }
[time]
end = 1
output_step = 0.5
"#;
    let scenario = springpot_scenario::Scenario::parse(text, "user.toml", "").unwrap();
    assert!(scenario.cases(&Catalog::standard()).is_err());
    let plan = scenario.cases(&replaced).unwrap().plan(0).unwrap();
    let system = plan.system();
    let mut table = system.table();
    let (report, outcome) =
        springpot::driver::run(&system, &plan.settings, &mut table, &springpot::system::Stop::new(false));
    outcome.unwrap();
    let forces = table.column("e.force").unwrap();
    assert_eq!(report.modes, 0);
    assert!(forces.iter().zip([0.0, 50.0, 100.0]).all(|(a, b)| (a - b).abs() < 1e-10), "{forces:?}");
}
