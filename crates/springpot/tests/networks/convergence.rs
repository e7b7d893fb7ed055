//! The order of forward motions with networks in them, by steps of one size: a mass on an element, m x'' = f(t) − F.

use springpot::collocation::{Nodes, RADAU_NODES, STAGES};
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{Course, Derivative, Network, Start};

type Values = [f64; STAGES];

const MASS: f64 = 2.0;
const END: f64 = 2.0;

/// A force that begins as smoothly as no order can tell.
fn force(t: f64) -> f64 {
    2000.0 * t.powi(7) * (-3.0 * t).exp()
}

/// A matrix times a vector, and the matrix of the stages squared.
fn times(matrix: &[Values; STAGES], vector: &Values) -> Values {
    matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum())
}

fn stages() -> ([Values; STAGES], [Values; STAGES]) {
    let full = Nodes::Radau.matrix();
    let a: [Values; STAGES] = std::array::from_fn(|i| std::array::from_fn(|j| full[i][j]));
    let square = std::array::from_fn(|i| std::array::from_fn(|j| (0..STAGES).map(|k| a[i][k] * a[k][j]).sum()));
    (a, square)
}

/// x and v after each of `count` steps of Radau IIA from x = 0 and v = `start`.
fn moved(law: &Network, form: Form, h: f64, count: u32, start: f64, force: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let (a, square) = stages();
    let mut bank = ElementBank::new(vec![law.clone()], Nodes::Radau, form);
    bank.set_course(Course::Sought);
    let range = MemoryRange { tolerance: 1e-13, shortest: h, horizon: f64::from(count) * h };
    bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &[] }], range).unwrap();
    let [mut x, mut v] = [0.0, start];
    let mut states = Vec::new();
    let mut accelerations = [0.0; STAGES];
    for n in 0..count {
        let t = f64::from(n) * h;
        bank.start(t, h);
        for _ in 0..3 {
            let (rates, strokes) = (times(&a, &accelerations), times(&square, &accelerations));
            bank.set(0, 0, x, v, &[]);
            for i in 0..STAGES {
                let stroke = x + h * RADAU_NODES[i] * v + h * h * strokes[i];
                bank.set(0, i + 1, stroke, v + h * rates[i], &[]);
            }
            bank.evaluate();
            let response = *bank.response(0);
            // (m + h² G A² + h P A) Δa = f − F − m a.
            let mut system = [[0.0; STAGES + 1]; STAGES];
            for i in 0..STAGES {
                for j in 0..STAGES {
                    let through =
                        |m: usize| h * h * response.d_stroke[i][m] * square[m][j] + h * response.d_rate[i][m] * a[m][j];
                    system[i][j] = (0..STAGES).map(through).sum::<f64>() + if i == j { MASS } else { 0.0 };
                }
                system[i][STAGES] = force(t + RADAU_NODES[i] * h) - response.force[i] - MASS * accelerations[i];
            }
            eliminate(&mut system);
            (0..STAGES).for_each(|i| accelerations[i] += system[i][STAGES]);
        }
        bank.commit();
        let (rates, strokes) = (times(&a, &accelerations), times(&square, &accelerations));
        (x, v) = (x + h * v + h * h * strokes[STAGES - 1], v + h * rates[STAGES - 1]);
        states.push([x, v]);
    }
    states
}

fn eliminate(system: &mut [[f64; STAGES + 1]; STAGES]) {
    for k in 0..STAGES {
        let scale = system[k][k];
        system[k].iter_mut().for_each(|entry| *entry /= scale);
        for i in (0..STAGES).filter(|&i| i != k) {
            let (factor, row) = (system[i][k], system[k]);
            system[i].iter_mut().zip(row).for_each(|(entry, other)| *entry -= factor * other);
        }
    }
}

/// Mean order of the state at eight times under a smooth force, from sixteen steps to 128, and the error with 64.
fn order(law: &Network) -> (f64, f64) {
    let at = |count: u32| {
        let states = moved(law, Form::Rates, END / f64::from(count), count, 0.0, force);
        states.into_iter().skip(count as usize / 8 - 1).step_by(count as usize / 8).collect::<Vec<_>>()
    };
    let best = at(1024);
    let sizes = [0, 1].map(|k| best.iter().map(|state| state[k].abs()).fold(0.0, f64::max));
    let error = |count: u32| {
        let gap = |(state, best): (&[f64; 2], &[f64; 2])| {
            ((state[0] - best[0]) / sizes[0]).powi(2) + ((state[1] - best[1]) / sizes[1]).powi(2)
        };
        at(count).iter().zip(&best).map(gap).sum::<f64>().sqrt()
    };
    ((error(16) / error(128)).log2() / 3.0, error(64))
}

fn springpot(c: f64, alpha: f64) -> Network {
    Network::springpot(c, alpha, Derivative::Caputo)
}

#[test]
fn series_have_order_five() {
    let spring = Network::spring;
    for alpha in [0.2, 0.5, 0.8, 0.95] {
        let maxwell = || Network::series([spring(90.0), springpot(40.0, alpha)]);
        let kelvin = || Network::parallel([spring(50.0), springpot(40.0, alpha)]);
        for (name, law) in [
            ("parallel", kelvin()),
            ("maxwell", maxwell()),
            ("zener", Network::parallel([spring(50.0), maxwell()])),
            ("poynting-thomson", Network::series([spring(90.0), kelvin()])),
            ("burgers", Network::series([maxwell(), kelvin()])),
            ("in two ways", Network::parallel([springpot(20.0, 0.3), maxwell()])),
            ("without a spring", Network::series([springpot(40.0, alpha), springpot(60.0, 0.4)])),
        ] {
            let (order, error) = order(&law);
            println!("{alpha} {name}: order {order:.2}, {error:.1e}");
            assert!(order >= 4.7, "{alpha} {name}: {order}");
        }
    }
    let dashpot = Network::dashpot;
    for (name, law) in [
        ("maxwell", Network::series([spring(90.0), dashpot(40.0)])),
        ("jeffreys", Network::series([dashpot(40.0), Network::parallel([spring(90.0), dashpot(10.0)])])),
    ] {
        let (order, error) = order(&law);
        println!("{name}: order {order:.2}, {error:.1e}");
        assert!(order >= 4.7, "{name}: {order}");
    }
}

/// A stiff spring in a series is stable however long the steps are; only what the steps resolve has order five.
#[test]
fn series_are_stable_however_stiff() {
    let h = 1e-2;
    for alpha in [0.05, 0.2, 0.5, 0.8, 0.95] {
        for periods in [0.1f64, 1.0, 10.0, 100.0, 1e4] {
            for slow in [1e-3, 1.0, 1e3] {
                let k = MASS * (periods / h).powi(2);
                let c = k * (slow * h).powf(alpha);
                for law in [
                    Network::series([Network::spring(k), springpot(c, alpha)]),
                    Network::parallel([
                        Network::spring(0.1 * k),
                        Network::series([Network::spring(k), springpot(c, alpha)]),
                    ]),
                ] {
                    let states = moved(&law, Form::Strokes, h, 400, 1.0, |_| 0.0);
                    let fastest = states.iter().map(|state| state[1].abs()).fold(0.0, f64::max);
                    assert!(fastest <= 1.0 + 1e-6, "{alpha} {periods} {slow}: {fastest}");
                }
            }
        }
    }
}
