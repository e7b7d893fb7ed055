//! Leaves that are not linear: closed forms, tangents, energies, kinks that steps end on.

use crate::{along, departure, force, slider};
use springpot::collocation::{MAX_NODES, Nodes};
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::leaf::{BoucWen, Friction, Jenkins, Polynomial, Preload, Stop};
use springpot::law::{Derivative, Elastic, Holds, Network, NetworkText, Start, Table};
use std::f64::consts::PI;

/// A network as text with its values.
fn network(text: &str, values: &[f64]) -> Network {
    NetworkText::parse(text).unwrap().entry().build(values, Derivative::Caputo).unwrap()
}

fn forward(q: f64, v: f64, torque: &str) -> String {
    format!("kind = \"forward\"\nstart = {{ q = {{ q = {q} }}, v = {{ q = {v} }} }}\ntorque = {{ q = \"{torque}\" }}")
}

fn leaf_table() -> Table {
    Table::new([(-0.2, -9.0), (-0.1, -3.0), (0.0, 0.0), (0.05, 2.0), (0.15, 5.0), (0.2, 9.0)]).unwrap()
}

/// Every leaf, of sizes that matter at strokes of some 0.1 m and rates of some 1 m/s.
fn leaves() -> Vec<Network> {
    vec![
        Network::leaf(Polynomial::new([20.0, -30.0, 900.0])),
        Network::leaf(leaf_table()),
        Network::leaf(Stop::tension(60.0)),
        Network::leaf(Stop::compression(60.0)),
        Network::leaf(Stop::new(80.0, -0.05, 0.07).unwrap()),
        Network::leaf(Friction::new(1.5, 0.3).unwrap()),
        Network::leaf(Preload { force: (-2.0).into() }),
        Network::leaf(BoucWen::new(50.0, 1.0, 100.0, 250.0, 2.0).unwrap()),
        Network::leaf(BoucWen::new(50.0, 1.0, -5.0, 15.0, 1.0).unwrap()),
        Network::leaf(BoucWen::new(50.0, 0.5, 300.0, 400.0, 2.5).unwrap()),
        // Sticks, slips, and slips and comes back within the step.
        Network::leaf(Jenkins::new(50.0, 8.0).unwrap()),
        Network::leaf(Jenkins::new(50.0, 2.0).unwrap()),
        Network::leaf(Jenkins::new(50.0, 0.9).unwrap()),
    ]
}

/// A bank with one law that was told one step from x0 with the strokes and rates at its nodes.
fn told(law: &Network, nodes: Nodes, h: f64, strokes: &[f64], rates: &[f64]) -> ElementBank {
    let mut bank = ElementBank::new(vec![law.clone()], nodes, Form::Strokes);
    bank.begin(
        &[Start { stroke: strokes[0], jump: 0.0, inputs: &[] }],
        MemoryRange { tolerance: 1e-9, shortest: h, horizon: 1.0 },
    )
    .unwrap();
    bank.start(0.0, h);
    strokes.iter().zip(rates).enumerate().for_each(|(k, (x, v))| bank.set(0, k, *x, *v, &[]));
    bank.evaluate();
    bank
}

#[test]
fn tangents_are_those_of_differences() {
    let beside = |leaf: &Network| {
        Network::series([Network::spring(70.0), Network::parallel([Network::spring(40.0), leaf.clone()])])
    };
    for law in leaves().iter().flat_map(|leaf| [leaf.clone(), beside(leaf)]) {
        for nodes in [Nodes::Radau, Nodes::Midpoint, Nodes::One] {
            let count = nodes.count();
            let (x, v) = ([0.03, 0.062, 0.081, 0.13], [0.4, 0.51, -0.2, 0.33]);
            let whole = told(&law, nodes, 0.05, &x[..=count], &v[..=count]);
            let force = whole.response(0).force;
            assert!(force.iter().all(|force| force.is_finite()));
            for j in 0..count {
                let step = 1e-6;
                let [by_stroke, by_rate] = [0, 1].map(|which| {
                    let sides = [step, -step].map(|step| {
                        let mut data = [x, v];
                        data[which][j + 1] += step;
                        told(&law, nodes, 0.05, &data[0][..=count], &data[1][..=count]).response(0).force
                    });
                    move |i: usize| (sides[0][i] - sides[1][i]) / (2.0 * step)
                });
                for i in 0..count {
                    let response = whole.response(0);
                    for (exact, difference) in
                        [(response.d_stroke[i][j], by_stroke(i)), (response.d_rate[i][j], by_rate(i))]
                    {
                        let off = (exact - difference).abs();
                        assert!(off < 2e-5 * (1.0 + exact.abs()), "{exact} {difference}: {law:?} {nodes:?} {i} {j}");
                    }
                }
            }
        }
    }
}

/// Half a period on each side: π√(m/k) each.
#[test]
fn two_springs_that_take_turns() {
    let (soft, hard) = (25.0, 400.0);
    let law = Network::parallel([Network::leaf(Stop::tension(soft)), Network::leaf(Stop::compression(hard))]);
    let (amplitude, end) = (0.1, 10.0);
    for rtol in [1e-6, 1e-9] {
        let run = slider(std::slice::from_ref(&law), &forward(amplitude, 0.0, "0"), end, 200, rtol);
        let halves = [soft, hard].map(|k: f64| PI / k.sqrt());
        let exact = |t: f64| {
            let t = (t + 0.5 * halves[0]) % (halves[0] + halves[1]);
            let [w_soft, w_hard] = [soft, hard].map(f64::sqrt);
            if t < halves[0] {
                amplitude * (w_soft * t).sin()
            } else {
                -amplitude * w_soft / w_hard * (w_hard * (t - halves[0])).sin()
            }
        };
        let wanted: Vec<f64> = run.t().iter().map(|t| exact(*t)).collect();
        let error = departure(&run.column("q.q"), &wanted);
        assert!(error < 100.0 * rtol, "{error:e} at {rtol:e} in {} steps", run.effort());
        assert!(run.residual() < 10.0 * rtol, "{:e} at {rtol:e}", run.residual());
    }
}

/// A ball on a stiff floor: free fall and half sines, no energy lost.
#[test]
fn a_ball_bounces() {
    let (stiffness, drop, g) = (1e6f64, 0.5f64, 9.81f64);
    let law = Network::leaf(Stop::new(stiffness, 0.0, 10.0).unwrap());
    for rtol in [1e-6, 1e-9] {
        let run = slider(std::slice::from_ref(&law), &forward(drop, 0.0, "-9.81"), 4.0, 100, rtol);
        // In contact x = g/ω² (cos ωt − 1) − v/ω sin ωt: 0 again where tan ωt/2 = −ωv/g.
        let (fall, omega) = ((2.0 * drop / g).sqrt(), stiffness.sqrt());
        let (v, sag) = (g * fall, g / (omega * omega));
        let contact = 2.0 * (PI - (v / omega / sag).atan()) / omega;
        let exact = |t: f64| {
            let period = 2.0 * fall + contact;
            let s = (t + fall + contact) % period;
            if s < contact {
                return f64::NAN;
            }
            let s = s - contact;
            v * s - 0.5 * g * s * s
        };
        let q = run.column("q.q");
        let times = run.t();
        let off = times.iter().zip(&q).map(|(t, q)| (exact(*t) - q).abs()).filter(|off| !off.is_nan());
        let off = off.fold(0.0, f64::max) / drop;
        assert!(off < 1e3 * rtol, "{off:e}");
        assert!(run.residual() < 10.0 * rtol, "{:e} at {rtol:e}", run.residual());
    }
}

/// ½v² + k1 x²/2 + k3 x⁴/4 stays, and so does the period of the quartic one: 4·K-like Γ(¼)²/√(2π k3)/A… of x'' = −k3 x³.
#[test]
fn duffing_oscillators() {
    let gamma_quarter = 3.625_609_908_221_908_f64;
    let (k3, amplitude) = (900.0f64, 0.2);
    let period = gamma_quarter.powi(2) / (PI.sqrt() * k3.sqrt() * amplitude);
    let law = network("polynomial(a, b, c)", &[0.0, 0.0, k3]);
    let run = slider(&[law], &forward(amplitude, 0.0, "0"), 5.0 * period, 20, 1e-9);
    let q = run.column("q.q");
    for turn in 0..=5 {
        assert!((q[4 * turn] - amplitude).abs() < 1e-6 * amplitude, "{}", q[4 * turn] / amplitude - 1.0);
    }
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
    // Along a motion: F and what it stores.
    let law = network("polynomial(a, b, c)", &[20.0, -30.0, 900.0]);
    let run = slider(&[law], &along("0.1*sin(3*t)"), 2.0, 20, 1e-9);
    let x = |t: f64| 0.1 * (3.0 * t).sin();
    let (mut forces, mut stored) = (Vec::new(), Vec::new());
    for t in run.t() {
        forces.push(20.0 * x(t) - 30.0 * x(t).powi(2) + 900.0 * x(t).powi(3));
        stored.push(10.0 * x(t).powi(2) - 10.0 * x(t).powi(3) + 225.0 * x(t).powi(4));
    }
    assert!(departure(&force(&run), &forces) < 1e-13);
    assert!(departure(&run.column("e0.stored"), &stored) < 1e-13);
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}

/// At the constant rate v friction loses f·v·tanh(v/v0)·t; it slows a mass by v' = −f/m·tanh(v/v0): sinh(v/v0) = sinh(v(0)/v0)·e^(−f t/(m v0)).
#[test]
fn friction_loses_what_it_should() {
    let (f, v0) = (2.0, 0.05);
    let law = network("friction(f, v0)", &[f, v0]);
    let run = slider(std::slice::from_ref(&law), &along("0.1*t"), 1.0, 10, 1e-9);
    let lost: Vec<f64> = run.t().iter().map(|t| f * 0.1 * (0.1f64 / v0).tanh() * t).collect();
    assert!(departure(&run.column("e0.dissipated"), &lost) < 1e-12);
    let run = slider(&[law], &forward(0.0, 1.0, "0"), 1.0, 20, 1e-9);
    let exact: Vec<f64> = run.t().iter().map(|t| v0 * ((1.0 / v0).sinh() * (-f * t / v0).exp()).asinh()).collect();
    let error = departure(&run.column("v.q"), &exact);
    assert!(error < 1e-7, "{error:e}");
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}

/// For β = γ, n = 2 and A = 1: from 0 z = Z·tanh(x/Z), Z² = 1/(2γ); back to 0 straight.
#[test]
fn loops_of_bouc_and_wen() {
    let (alpha_h, gamma) = (50.0, 300.0);
    let law = network("bouc-wen(a, A, b, g, n)", &[alpha_h, 1.0, gamma, gamma, 2.0]);
    let run = slider(&[law], &along("0.1*sin(t)"), 2.0, 40, 1e-9);
    let top = (2.0f64 * gamma).sqrt().recip();
    let end = top * (0.1 / top).tanh();
    let exact = |t: f64| {
        let x = 0.1 * t.sin();
        let back = end - (0.1 - x);
        alpha_h * if t <= 0.5 * PI { top * (x / top).tanh() } else { back }
    };
    let wanted: Vec<f64> = run.t().iter().map(|t| exact(*t)).collect();
    let error = departure(&force(&run), &wanted);
    assert!(error < 1e-7, "{error:e}");
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}

/// Numbers between 0 and 1 from a fixed seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }
}

/// A network whose parts in series all hold.
fn random_network(random: &mut Random, depth: usize) -> Network {
    let size = |random: &mut Random| 10.0f64.powf(1.0 + random.next());
    let spring = |random: &mut Random| Network::spring(size(random));
    if depth == 0 {
        return match random.below(4) {
            0 => spring(random),
            1 => Network::parallel([spring(random), Network::dashpot(0.1 * size(random))]),
            _ => {
                let mut leaves = leaves();
                Network::parallel([spring(random), leaves.swap_remove(random.below(leaves.len()))])
            }
        };
    }
    let parts = (0..2 + random.below(2)).map(|_| random_network(random, depth - 1)).collect::<Vec<_>>();
    if random.below(2) == 0 { Network::series(parts) } else { Network::parallel(parts) }
}

#[test]
fn random_networks_keep_their_energy() {
    let mut random = Random(7);
    for case in 0..30 {
        let law = random_network(&mut random, 1 + case % 2);
        let (rtol, motion) = match case % 3 {
            0 => (1e-7, along("0.1*sin(4*t)+0.03*t")),
            1 => (1e-7, forward(0.05, 1.0, "2*sin(3*t)")),
            _ => (1e-5, forward(0.1, -0.5, "0")),
        };
        let run = slider(std::slice::from_ref(&law), &motion, 2.0, 40, rtol);
        let residual = run.residual();
        assert!(residual < 10.0 * rtol, "case {case}: {residual:e} at {rtol:e}: {law:?}");
        let lost = run.column("e0.dissipated");
        let size = run.report.energy_turned_over.unwrap();
        assert!(lost.windows(2).all(|pair| pair[1] >= pair[0] - rtol * size), "case {case}: {lost:?}: {law:?}");
    }
}

/// Steps of one size that do not know where kinks are converge all the same, and series find their strokes from anywhere.
#[test]
fn series_find_their_force_over_long_steps() {
    let mut random = Random(11);
    for case in 0..400 {
        let law = random_network(&mut random, 1 + case % 3);
        for nodes in [Nodes::Radau, Nodes::One, Nodes::Midpoint] {
            let reach = 10.0f64.powf(2.0 * random.next() - 1.0);
            let to = reach * (2.0 * random.next() - 1.0);
            let h = 10.0f64.powf(-4.0 * random.next());
            let places: Vec<f64> = std::iter::once(0.0).chain(nodes.positions().iter().copied()).collect();
            let strokes: Vec<f64> = places.iter().map(|c| to * c).collect();
            let rates = vec![to / h; MAX_NODES + 1];
            let bank = told(&law, nodes, h, &strokes, &rates);
            let forces = &bank.response(0).force[..nodes.count()];
            assert!(forces.iter().all(|force| force.is_finite()), "case {case}, {nodes:?} to {to} in {h}: {law:?}");
        }
    }
}

/// A stop that does not tell where its kinks are.
#[derive(Debug)]
struct Blind(Stop);

impl Elastic for Blind {
    fn name(&self) -> &'static str {
        "blind"
    }

    fn force(&self, x: f64) -> f64 {
        self.0.force(x)
    }

    fn slope(&self, x: f64) -> f64 {
        self.0.slope(x)
    }

    fn energy(&self, x: f64) -> f64 {
        self.0.energy(x)
    }

    fn holds(&self) -> Holds {
        Elastic::holds(&self.0)
    }
}

/// Kinks cost a few steps each, not a crowd of short ones.
#[test]
fn steps_end_on_kinks() {
    let stop = Stop::new(1e4, -0.01, 0.01).unwrap();
    let (seen, blind) = (Network::leaf(stop), Network::leaf(Blind(stop)));
    let beside = |law: &Network| {
        Network::series([Network::spring(50.0), Network::parallel([Network::spring(50.0), law.clone()])])
    };
    let [free, bound] = [forward(0.0, 1.0, "0"), along("0.1*sin(2*t)")];
    for (law, other, motion, rtol, is_stiff) in [
        (&seen, &blind, &free, 1e-6, true),
        (&seen, &blind, &free, 1e-8, true),
        (&beside(&seen), &beside(&blind), &free, 1e-8, false),
        (&seen, &blind, &bound, 1e-9, true),
        (&beside(&seen), &beside(&blind), &bound, 1e-9, false),
    ] {
        let [told, untold] = [law, other].map(|law| slider(std::slice::from_ref(law), motion, 2.0, 40, rtol));
        let [effort, other] = [&told, &untold].map(|run| run.effort() as f64);
        let [residual, without] = [&told, &untold].map(|run| run.residual());
        eprintln!("{effort} and {other} steps, residuals {residual:e} and {without:e}");
        assert!(effort < 1.1 * other && residual < 10.0 * rtol, "{effort} {other}, {residual:e}");
        if *motion == free {
            assert!(residual < 0.2 * without, "{residual:e} {without:e}");
        }
        if is_stiff && *motion == free {
            assert!(effort < 0.9 * other, "{effort} {other}");
        }
    }
    // Along a motion a stop behind a spring: its force is that of what is engaged.
    let run = slider(&[beside(&seen)], &bound, 4.0, 80, 1e-9);
    let exact = |t: f64| {
        let x = 0.1 * (2.0 * t).sin();
        // F = 50 (x − y) = 50 y + 1e4 (|y| − 0.01)⁺.
        let y = 0.5 * x.abs();
        let y = if y <= 0.01 { y } else { (50.0 * x.abs() + 100.0) / 10_100.0 };
        50.0 * (x.abs() - y) * x.signum()
    };
    let wanted: Vec<f64> = run.t().iter().map(|t| exact(*t)).collect();
    let error = departure(&force(&run), &wanted);
    assert!(error < 1e-10, "{error:e}");
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}
