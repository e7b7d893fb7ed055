//! Bouc–Wen hysteresis against its closed form, alone, on a robot and in networks.

use crate::{along, departure, force, slider};
use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::leaf::BoucWen;
use springpot::law::{Network, Start};

const STIFFNESS: f64 = 50.0;
const GAMMA: f64 = 300.0;

/// F = k z, z' = v − γ|v| z|z| − γ v z².
fn leaf() -> Network {
    Network::leaf(BoucWen::new(STIFFNESS, 1.0, GAMMA, GAMMA, 2.0).unwrap())
}

/// For β = γ and n = 2: away from 0, z = Z tanh(κ x) with Z² = 1/(2γ), κ² = 2γ; back to 0 along a straight line of slope 1.
fn closed_form(path: impl Iterator<Item = f64>) -> Vec<f64> {
    let (top, kappa) = ((0.5 / GAMMA).sqrt(), (2.0 * GAMMA).sqrt());
    let (mut x, mut z) = (0.0f64, 0.0f64);
    let mut values = Vec::new();
    for next in path {
        // In two parts where z passes 0 on the way.
        let mut left = next - x;
        if z * left < 0.0 {
            let to_zero = z.abs().min(left.abs()).copysign(left);
            z += to_zero;
            left -= to_zero;
        }
        if left != 0.0 {
            z = top * ((z / top).atanh() + kappa * left).tanh();
        }
        x = next;
        values.push(STIFFNESS * z);
    }
    values
}

/// Steps end where a mass turns round, so that its hysteresis keeps the tolerance.
#[test]
fn a_mass_turns_round_without_an_error() {
    for n in [1.0, 1.5, 2.0] {
        let law = Network::leaf(BoucWen::new(STIFFNESS, 1.0, 2.0, 3.0, n).unwrap());
        let moved = |rtol| {
            let motion = "kind = \"forward\"\nstart = { v = { q = 1 } }\ntorque = { q = \"3*sin(4*t)\" }";
            force(&slider(std::slice::from_ref(&law), motion, 2.0, 25, rtol))
        };
        let error = departure(&moved(1e-9), &moved(1e-12));
        println!("n = {n}: {error:.1e}");
        assert!(error < 1e-8, "{n}: {error:e}");
    }
}

#[test]
fn loops_follow_the_closed_form() {
    // The closed form follows every turn: x is sampled finely in between, turning points among the samples.
    let run = slider(&[leaf()], &along("0.1*sin(t)"), 10.0, 200, 1e-9);
    let fine = 400;
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut times: Vec<f64> = (1..=200 * fine).map(|k| k as f64 * 0.05 / fine as f64).collect();
    times.extend((0..4).map(|k| quarter * f64::from(2 * k + 1)).filter(|t| *t < 10.0));
    times.sort_by(f64::total_cmp);
    let forces = closed_form(times.iter().map(|t| 0.1 * t.sin()));
    let at = |t: f64| {
        if t == 0.0 { 0.0 } else { forces[times.partition_point(|time| *time < t - 1e-9)] }
    };
    let exact: Vec<f64> = run.t().iter().map(|t| at(*t)).collect();
    let error = departure(&force(&run), &exact);
    assert!(error < 1e-7, "{error:e} in {} steps", run.effort());
    assert!(run.residual() < 1e-6, "{:e}", run.residual());
    let lost = run.column("e0.dissipated");
    assert!(lost.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12) && lost[200] > 0.1, "{}", lost[200]);
}

#[test]
fn it_moves_a_robot_and_stands_in_networks() {
    let forward = "kind = \"forward\"\nstart = { q = { q = 0.1 }, v = { q = 1 } }";
    let beside = Network::parallel([leaf(), Network::spring(20.0)]);
    let apart = slider(&[leaf(), Network::spring(20.0)], forward, 2.0, 20, 1e-9);
    let together = slider(&[beside], forward, 2.0, 20, 1e-9);
    assert!(departure(&force(&together), &force(&apart)) < 1e-7);
    assert!(together.residual() < 1e-6, "{:e}", together.residual());
    // Behind a stiff spring it is nearly what it is alone.
    let behind = Network::series([leaf(), Network::spring(5e7)]);
    let [alone, behind] = [leaf(), behind].map(|law| slider(&[law], &along("0.1*sin(t)"), 4.0, 40, 1e-9));
    let error = departure(&force(&behind), &force(&alone));
    assert!(error < 1e-5, "{error:e}");
}

/// In steps whose node stands for their middle an inner variable goes on to their ends.
#[test]
fn steps_with_one_node_converge() {
    let (x, end) = (|t: f64| 0.1 * t.sin(), 1.5);
    let forces = closed_form((1..=6000).map(|k| x(end * f64::from(k) / 6000.0)));
    for (nodes, order) in [(Nodes::One, 0.9), (Nodes::Midpoint, 1.8)] {
        let error = |steps: u32| {
            let h = end / f64::from(steps);
            let mut bank = ElementBank::new(vec![leaf()], nodes, Form::Strokes);
            let memory = MemoryRange { tolerance: 1e-9, shortest: h, horizon: end };
            bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &[] }], memory).unwrap();
            let mut worst = 0.0f64;
            for n in 0..steps {
                let (t, from, to) = (f64::from(n) * h, x(f64::from(n) * h), x(f64::from(n + 1) * h));
                bank.start(t, h);
                bank.set(0, 0, from, t.cos() * 0.1, &[]);
                let c = nodes.positions()[0];
                bank.set(0, 1, from + c * (to - from), (to - from) / h, &[]);
                bank.evaluate();
                let at = ((t + c * h) / end * 6000.0).round() as usize;
                worst = worst.max((bank.force(0) - forces[at - 1]).abs());
                bank.commit();
            }
            worst
        };
        let found = (error(150) / error(600)).log2() / 2.0;
        assert!(found > order, "{nodes:?}: order {found}");
    }
}
