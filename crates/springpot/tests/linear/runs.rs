//! Free decays of runs against the modes.

use crate::support::forward::every;
use crate::support::{run, system};
use crate::{arm, modes, on_joints, slider};

/// Times at which a column passes zero upwards, by the cubic through four rows.
fn crossings(t: &[f64], x: &[f64]) -> Vec<f64> {
    let mut found = Vec::new();
    for k in 1..x.len() - 2 {
        if x[k] < 0.0 && x[k + 1] >= 0.0 {
            let at = |u: f64| {
                let nodes = [-1.0, 0.0, 1.0, 2.0];
                (0..4)
                    .map(|i| {
                        let weight = |j: usize| if i == j { 1.0 } else { (u - nodes[j]) / (nodes[i] - nodes[j]) };
                        x[k - 1 + i] * (0..4).map(weight).product::<f64>()
                    })
                    .sum::<f64>()
            };
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if at(middle) < 0.0 { low = middle } else { high = middle }
            }
            found.push(t[k] + low * (t[k + 1] - t[k]));
        }
    }
    found
}

#[test]
fn a_mass_decays_as_its_mode_does() {
    // About 2.5 % of damping; beside it stands a tail that falls like t^(−1−alpha).
    let law = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 100, c = 2, alpha = 0.5 }";
    let text = slider(1.0, law, "start = { v = { x = 1 } }", &every(8.0, 2e-3, 1e-10));
    let mode = modes(&system(&text)).modes.remove(0);
    let run = run(&text);
    let (t, v) = (run.t(), run.column("v.x"));
    let turns = crossings(&t, &v);
    let (first, last) = (turns[1], turns[turns.len() - 2]);
    let periods = (turns.len() - 3) as f64;
    let frequency = periods / (last - first);
    assert!((frequency / mode.damped_frequency() - 1.0).abs() < 2e-4, "{frequency} {mode:?}");
    let peak = |from: f64, to: f64| {
        let within = t.iter().zip(&v).filter(|(t, _)| **t >= from && **t < to);
        within.fold(0.0f64, |most, (_, v)| most.max(*v))
    };
    let decrement = (peak(turns[1], turns[2]) / peak(turns[turns.len() - 2], turns[turns.len() - 1])).ln() / periods;
    let expected = -mode.eigenvalue.re / mode.damped_frequency();
    assert!((decrement / expected - 1.0).abs() < 5e-3, "{decrement} {expected}");
}

#[test]
fn an_arm_in_one_of_its_modes_stays_in_it() {
    let laws = [
        "law = \"kelvin-voigt\"\nparameters = { k = 80, c = 2 }",
        "law = \"zener\"\nparameters = { k_e = 150, k_m = 100, c = 6 }",
        "law = \"kelvin-voigt\"\nparameters = { k = 60, c = 0.5 }",
    ];
    let at = |q: &[f64], v: [f64; 3]| {
        let named = |values: &[f64]| format!("{{ q1 = {:?}, q2 = {:?}, q3 = {:?} }}", values[0], values[1], values[2]);
        let text = arm(&on_joints(laws), &format!("start = {{ q = {}, v = {} }}", named(q), named(&v)));
        text.replace("[time]\nend = 1\noutput_step = 0.5\n", &every(1.0, 0.05, 1e-10))
    };
    let rest = system(&at(&[0.0; 3], [0.0; 3])).equilibrium(&[0.0; 3], 0.0).unwrap().q;
    let found = system(&at(&rest, [0.0; 3])).linearised(&rest, 0.0).unwrap().modes().unwrap();
    let amp = 1e-4;
    // Every force of zener's branch begins at rest: a velocity alone, whose answer all modes share.
    let start = [0.3 * amp, -0.2 * amp, 0.5 * amp];
    let run = run(&at(&rest, start));
    assert!(found.modes.iter().filter(|mode| mode.eigenvalue.im > 0.0).count() == 3, "{found:?}");
    // q(t) = Σ c_i φ_i e^{s_i t} with real and conjugate modes: fitted at as many rows as there are unknowns, it holds at all others.
    let t = run.t();
    let columns: Vec<Vec<f64>> = (1..=3).map(|j| run.column(&format!("q.q{j}"))).collect();
    let mut basis: Vec<Box<dyn Fn(f64, usize) -> f64>> = Vec::new();
    for mode in &found.modes {
        let (s, shape) = (mode.eigenvalue, mode.shape.clone());
        let other = shape.clone();
        basis.push(Box::new(move |t, j| (shape[j] * (s * t).exp()).re));
        if s.im > 0.0 {
            basis.push(Box::new(move |t, j| (other[j] * (s * t).exp()).im));
        }
    }
    let n = basis.len();
    let mut normal = vec![vec![0.0; n + 1]; n];
    for (row, &time) in t.iter().enumerate() {
        for j in 0..3 {
            let values: Vec<f64> = basis.iter().map(|f| f(time, j)).collect();
            for a in 0..n {
                (0..n).for_each(|b| normal[a][b] += values[a] * values[b]);
                normal[a][n] += values[a] * (columns[j][row] - rest[j]);
            }
        }
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| normal[a][k].abs().total_cmp(&normal[b][k].abs())).unwrap();
        normal.swap(k, pivot);
        for i in (0..n).filter(|&i| i != k) {
            let factor = normal[i][k] / normal[k][k];
            for c in 0..=n {
                let entry = factor * normal[k][c];
                normal[i][c] -= entry;
            }
        }
    }
    let weights: Vec<f64> = (0..n).map(|k| normal[k][n] / normal[k][k]).collect();
    for (row, &time) in t.iter().enumerate() {
        for j in 0..3 {
            let sum: f64 = basis.iter().zip(&weights).map(|(f, w)| w * f(time, j)).sum();
            let off = (columns[j][row] - rest[j] - sum).abs();
            assert!(off < 1e-3 * 0.05 * amp, "q{} at {time} s: {off}", j + 1);
        }
    }
}
