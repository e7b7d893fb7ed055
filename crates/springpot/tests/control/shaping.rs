//! Filters, weights, feed-forward and measurement of controllers, against Runge–Kutta steps of their own.

use super::support::forward::{every, largest, slider, state};
use super::support::run;

/// A mass of 2 kg on a slide without gravity whose element does nothing, off its reference.
fn mass(controller: &str, rtol: f64) -> String {
    let free = slider("2", 0.0, "law = \"spring\"\nparameters = { k = 1e-30 }", &state("0.02", "0"));
    let reference = "reference = { kind = \"joints\", q = \"0.1*sin(3*t)\" }";
    format!("{free}[motion.controller]\n{controller}\n{reference}\n{}", every(2.0, 0.05, rtol))
}

const KP: f64 = 300.0;
const KI: f64 = 200.0;
const KD: f64 = 40.0;
const T: f64 = 0.02;
const STEPS: usize = 400;

fn wanted(t: f64) -> [f64; 2] {
    [0.1 * (3.0 * t).sin(), 0.3 * (3.0 * t).cos()]
}

/// q every 0.05 s where q, v, ∫e and y start so; `force` is told t and them, and `derived` is what the filter takes. With `sample` the force holds.
fn reference(
    force: &dyn Fn(f64, [f64; 4]) -> f64,
    derived: &dyn Fn(f64, [f64; 4]) -> f64,
    sample: Option<usize>,
) -> Vec<f64> {
    let h = 0.05 / STEPS as f64;
    let (mut z, mut rows, mut held) = ([0.02, 0.0, 0.0, 0.0], vec![0.02], 0.0);
    for step in 0..40 * STEPS {
        let t = h * step as f64;
        if sample.is_some_and(|every| step % every == 0) {
            held = force(t, z);
        }
        let slope = |t: f64, z: [f64; 4]| {
            let force = if sample.is_some() { held } else { force(t, z) };
            [z[1], force / 2.0, wanted(t)[0] - z[0], (derived(t, z) - z[3]) / T]
        };
        let along = |z: [f64; 4], k: [f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| z[i] + h * k[i]) };
        let a = slope(t, z);
        let b = slope(t + h / 2.0, along(z, a, h / 2.0));
        let c = slope(t + h / 2.0, along(z, b, h / 2.0));
        let d = slope(t + h, along(z, c, h));
        z = std::array::from_fn(|i| z[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        if (step + 1) % STEPS == 0 {
            rows.push(z[0]);
        }
    }
    rows
}

fn off(controller: &str, rows: &[f64]) -> f64 {
    let run = run(&mass(controller, 1e-10));
    assert!(run.error.is_none(), "{:?}", run.error);
    largest(run.column("q.q").iter().zip(rows).map(|(a, b)| (a - b).abs()))
}

const PID: &str = "kind = \"pid\"\nkp = 300\nki = 200\nkd = 40\n";

#[test]
fn filters_and_weights_act_at_every_time() {
    let on_error = |t: f64, z: [f64; 4]| wanted(t)[1] - z[1];
    let on_measurement = |_: f64, z: [f64; 4]| -z[1];
    let pid = |b: f64| move |t: f64, z: [f64; 4]| KP * (b * wanted(t)[0] - z[0]) + KI * z[2] + KD * z[3];
    let filter = "filter = \"20 ms\"\n";
    assert!(off(&format!("{PID}{filter}"), &reference(&pid(1.0), &on_error, None)) < 1e-10);
    let measured = "derivative_on = \"measurement\"\nset_point_weight = 0.6\n";
    assert!(off(&format!("{PID}{filter}{measured}"), &reference(&pid(0.6), &on_measurement, None)) < 1e-10);
    let ahead = |t: f64, z: [f64; 4]| KP * (0.6 * wanted(t)[0] - z[0]) - KD * z[1] + 5.0 * (4.0 * t).sin();
    let text = format!("kind = \"pd-gravity\"\nkp = 300\nkd = 40\n{measured}feed_forward = {{ q = \"5*sin(4*t)\" }}\n");
    assert!(off(&text, &reference(&ahead, &on_error, None)) < 1e-10);
    let limited =
        |t: f64, z: [f64; 4]| (KP * (wanted(t)[0] - z[0]) + KD * z[3] + 5.0 * (4.0 * t).sin()).clamp(-6.0, 6.0);
    let text = format!(
        "kind = \"pd-gravity\"\nkp = 300\nkd = 40\n{filter}limits = {{ q = 6 }}\nfeed_forward = {{ q = \"5*sin(4*t)\" }}\n"
    );
    // The reference steps over its kinks.
    assert!(off(&text, &reference(&limited, &on_error, None)) < 1e-8);
}

#[test]
fn sampled_ones_see_what_is_measured() {
    let (every, on_error) = (Some(STEPS / 5), |t: f64, z: [f64; 4]| wanted(t)[1] - z[1]);
    let steps = |q: f64, step: f64| if step == 0.0 { q } else { step * (q / step).round() };
    for (extra, step, is_filtered) in
        [("", 0.0, false), ("quantization = \"1 mm\"\n", 1e-3, false), ("filter = \"20 ms\"\n", 0.0, true)]
    {
        let force = |t: f64, z: [f64; 4]| {
            let [q, v] = wanted(t);
            KP * (q - steps(z[0], step)) + KI * z[2] + KD * if is_filtered { z[3] } else { v - z[1] }
        };
        let off = off(&format!("{PID}sample = \"10 ms\"\n{extra}"), &reference(&force, &on_error, every));
        assert!(off < 1e-10, "{extra}: {off:e}");
    }
}

/// What the force tells of the noise: its deviation, the same in two runs and another with another seed.
#[test]
fn noise_is_that_of_its_seed() {
    let noise = |seed: u64| -> Vec<f64> {
        let law = format!(
            "kind = \"pd-gravity\"\nkp = 300\nsample = \"10 ms\"\nnoise = {{ sd = \"0.5 mm\", seed = {seed} }}\n"
        );
        let text = mass(&law, 1e-8).replace("output_step = 0.05", "output_step = 0.01");
        let run = run(&text);
        let columns = run.t().into_iter().zip(run.column("q.q")).zip(run.column("tau.q"));
        columns.map(|((t, q), tau)| wanted(t)[0] - q - tau / KP).collect()
    };
    let (own, again, other) = (noise(1), noise(1), noise(2));
    assert!(own.len() > 190 && own == again && own != other);
    let deviation = (own.iter().map(|n| n * n).sum::<f64>() / own.len() as f64).sqrt();
    assert!((deviation / 5e-4 - 1.0).abs() < 4.0 / (2.0 * own.len() as f64).sqrt(), "{deviation:e}");
}
