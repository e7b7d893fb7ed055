//! Orders of convergence under temperatures that vary, by steps of one size.

use springpot::collocation::{Nodes, RADAU_NODES, STAGES};
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{Course, Derivative, Expansion, Heat, InputValue, Network, NetworkText, Shift, Start, Thermal};

type Values = [f64; STAGES];

const MASS: f64 = 2.0;
const END: f64 = 2.0;

const SHIFT: Shift = Shift::Arrhenius { energy: 60000.0, reference: 300.0 };
const THERMAL: Thermal = Thermal { capacity: 100.0, conductance: 30.0, ambient: 300.0, start: 300.0 };
const EXPANSION: Expansion = Expansion { coefficient: 1e-3, reference: 300.0 };

/// A force, or a rate, that begins as smoothly as no order can tell.
fn push(t: f64) -> f64 {
    400.0 * t.powi(7) * (-3.0 * t).exp()
}

/// A stroke that begins as smoothly, and its rate.
fn travel(t: f64) -> [f64; 2] {
    let e = 5.0 * (-3.0 * t).exp();
    [t.powi(8) * e, (8.0 * t.powi(7) - 3.0 * t.powi(8)) * e]
}

fn temperature(t: f64) -> InputValue {
    // Smooth at the start too, where what expands would begin to move at once.
    let e = 20.0 * (-2.0 * t).exp();
    InputValue { value: 300.0 + e * t.powi(6), rate: e * (6.0 * t.powi(5) - 2.0 * t.powi(6)) }
}

fn law(text: &str, values: &[f64], heat: Heat) -> Network {
    let entry = NetworkText::parse(text).unwrap().entry().with_heat(heat).unwrap();
    entry.build(values, Derivative::Caputo).unwrap()
}

fn bank(law: &Network, form: Form, h: f64, count: u32) -> (ElementBank, usize) {
    let inputs: Vec<InputValue> = match law.as_heated().and_then(|heated| heated.input()) {
        Some(_) => vec![temperature(0.0)],
        None => Vec::new(),
    };
    let mut bank = ElementBank::new(vec![law.clone()], Nodes::Radau, form);
    let range = MemoryRange { tolerance: 1e-13, shortest: h, horizon: f64::from(count) * h };
    bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &inputs }], range).unwrap();
    (bank, inputs.len())
}

fn tell(bank: &mut ElementBank, point: usize, t: f64, stroke: f64, rate: f64, inputs: usize) {
    bank.set(0, point, stroke, rate, &[temperature(t)][..inputs]);
}

/// x and v after each of `count` steps of Radau IIA of m x'' = f(t) − F from rest, in a forward run.
fn moved(law: &Network, h: f64, count: u32) -> Vec<[f64; 2]> {
    let full = Nodes::Radau.matrix();
    let a: [Values; STAGES] = std::array::from_fn(|i| std::array::from_fn(|j| full[i][j]));
    let square: [Values; STAGES] =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..STAGES).map(|k| a[i][k] * a[k][j]).sum()));
    let times =
        |matrix: &[Values; STAGES], vector: &Values| matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum());
    let (mut bank, inputs) = bank(law, Form::Rates, h, count);
    bank.set_course(Course::Sought);
    let [mut x, mut v] = [0.0; 2];
    let mut accelerations = [0.0; STAGES];
    let mut states = Vec::new();
    for n in 0..count {
        let t = f64::from(n) * h;
        bank.start(t, h);
        for _ in 0..20 {
            let (rates, strokes): (Values, Values) = (times(&a, &accelerations), times(&square, &accelerations));
            tell(&mut bank, 0, t, x, v, inputs);
            for i in 0..STAGES {
                let stroke = x + h * RADAU_NODES[i] * v + h * h * strokes[i];
                tell(&mut bank, i + 1, t + RADAU_NODES[i] * h, stroke, v + h * rates[i], inputs);
            }
            bank.evaluate();
            let response = *bank.response(0);
            let mut system = [[0.0; STAGES + 1]; STAGES];
            for i in 0..STAGES {
                for j in 0..STAGES {
                    let through =
                        |m: usize| h * h * response.d_stroke[i][m] * square[m][j] + h * response.d_rate[i][m] * a[m][j];
                    system[i][j] = (0..STAGES).map(through).sum::<f64>() + if i == j { MASS } else { 0.0 };
                }
                system[i][STAGES] = push(t + RADAU_NODES[i] * h) - response.force[i] - MASS * accelerations[i];
            }
            for k in 0..STAGES {
                let scale = system[k][k];
                system[k].iter_mut().for_each(|entry| *entry /= scale);
                for i in (0..STAGES).filter(|&i| i != k) {
                    let (factor, row) = (system[i][k], system[k]);
                    system[i].iter_mut().zip(row).for_each(|(entry, other)| *entry -= factor * other);
                }
            }
            (0..STAGES).for_each(|i| accelerations[i] += system[i][STAGES]);
        }
        bank.commit();
        let (rates, strokes): (Values, Values) = (times(&a, &accelerations), times(&square, &accelerations));
        (x, v) = (x + h * v + h * h * strokes[STAGES - 1], v + h * rates[STAGES - 1]);
        states.push([x, v]);
    }
    states
}

/// F, and T where it is a state, after each of `count` steps along x(t).
fn followed(law: &Network, h: f64, count: u32) -> Vec<[f64; 2]> {
    let (mut bank, inputs) = bank(law, Form::Rates, h, count);
    let mut states = Vec::new();
    for n in 0..count {
        let t = f64::from(n) * h;
        bank.start(t, h);
        for (k, c) in [0.0].into_iter().chain(RADAU_NODES).enumerate() {
            let [x, v] = travel(t + c * h);
            tell(&mut bank, k, t + c * h, x, v, inputs);
        }
        bank.evaluate();
        bank.commit();
        states.push([bank.force(0), bank.warmth(0, None).map_or(0.0, |warmth| warmth.temperature - 300.0)]);
    }
    states
}

/// Mean order at eight times from 16 steps to 128, and the error with 64.
fn order(at: impl Fn(f64, u32) -> Vec<[f64; 2]>) -> (f64, f64) {
    let at = |count: u32| {
        let states = at(END / f64::from(count), count);
        states.into_iter().skip(count as usize / 8 - 1).step_by(count as usize / 8).collect::<Vec<_>>()
    };
    let best = at(1024);
    let sizes = [0, 1].map(|k| best.iter().map(|state| state[k].abs()).fold(f64::MIN_POSITIVE, f64::max));
    let error = |count: u32| {
        let gap = |(state, best): (&[f64; 2], &[f64; 2])| {
            ((state[0] - best[0]) / sizes[0]).powi(2) + ((state[1] - best[1]) / sizes[1]).powi(2)
        };
        at(count).iter().zip(&best).map(gap).sum::<f64>().sqrt()
    };
    ((error(16) / error(128)).log2() / 3.0, error(64))
}

fn laws(heat: Heat) -> Vec<(String, Network)> {
    let mut laws = Vec::new();
    for alpha in [0.2, 0.5, 0.8] {
        for (name, text, values) in [
            ("parallel", "parallel(spring(k), springpot(c, alpha))", vec![50.0, 40.0, alpha]),
            ("zener", "parallel(spring(k), series(spring(j), springpot(c, alpha)))", vec![50.0, 90.0, 40.0, alpha]),
            (
                "burgers",
                "series(spring(k), springpot(c, alpha), parallel(spring(j), dashpot(d)))",
                vec![90.0, 40.0, alpha, 50.0, 20.0],
            ),
        ] {
            laws.push((format!("{name} {alpha}"), law(text, &values, heat)));
        }
    }
    laws
}

fn heats() -> [(&'static str, Heat); 4] {
    let shift = Some(SHIFT);
    [
        ("input", Heat { shift, ..Heat::default() }),
        ("input, expanding", Heat { shift, expansion: Some(EXPANSION), thermal: None }),
        ("state", Heat { shift, thermal: Some(THERMAL), expansion: None }),
        ("state, expanding", Heat { shift, thermal: Some(THERMAL), expansion: Some(EXPANSION) }),
    ]
}

#[test]
fn forward_motions_have_order_five() {
    for (heat, of) in heats() {
        for (name, law) in laws(of) {
            let (order, error) = order(|h, count| moved(&law, h, count));
            println!("{heat}, {name}: order {order:.2}, {error:.1e}");
            assert!(order >= 4.5, "{heat}, {name}: {order}");
        }
    }
}

#[test]
fn motions_given_keep_theirs() {
    for (heat, of) in heats() {
        for (name, law) in laws(of) {
            let (order, error) = order(|h, count| followed(&law, h, count));
            println!("{heat}, {name}: order {order:.2}, {error:.1e}");
            // The losses that make a temperature are known to what their exponentials hold, some 1e-9.
            assert!(order >= 4.1 || (law.is_thermal() && error < 1e-8), "{heat}, {name}: {order} {error:e}");
        }
    }
}
