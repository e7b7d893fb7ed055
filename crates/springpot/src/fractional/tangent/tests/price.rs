//! What a derivative costs beside its memory.

use super::super::order::ByOrder;
use super::super::{EnergyTangent, MemoryTangent, Singular, TangentEnd, TangentPoint, TangentSeeds, TangentStep};
use crate::collocation::{Nodes, RADAU_NODES};
use crate::fractional::{Form, Kernel, Kind, Memory, RatePolynomial, StepStart};
use std::hint::black_box;
use std::time::Instant;

/// Nanoseconds of a step of the memory, of a derivative by P parameters beside it, and of its energies at the start and at the nodes.
fn price(parameters: usize, order: f64) -> [f64; 3] {
    let h = 1e-3;
    let mut memory = Memory::new(0.5, Kind::Caputo, 0.0, 0.0, 1e-11, RADAU_NODES[0] * h, 100.0).unwrap();
    let mut alpha = vec![0.0; parameters];
    alpha[0] = order;
    let zeros = vec![0.0; parameters];
    let seeds = TangentSeeds { alpha: &alpha, origin: &zeros, jump: &zeros };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let delta_u = vec![0.1; 4 * parameters];
    let ones = vec![1.0; parameters];
    let mut explicit = vec![0.0; 3 * parameters];
    let [mut stored, mut dissipation] = [zeros.clone(), zeros.clone()];
    let mut spent = [0.0; 3];
    let mut best = [f64::INFINITY; 3];
    for n in 0..12_000 {
        let t = n as f64 * h;
        let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| (8.0 * (t + c * h)).cos()).collect();
        let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &rates);
        let stroke = (8.0 * t).sin() / 8.0;
        let start = StepStart { t, h, stroke, rate: rates[0] };
        let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
        let point = TangentPoint { stroke, rate: rates[0], delta_stroke: &ones, delta_rate: &ones };
        let end = TangentEnd { stroke, delta_stroke: &ones, resolution: 1e-15 };
        let begin = Instant::now();
        memory.prepare(&start, Nodes::Radau, Form::Rates);
        black_box(memory.respond(&start, Nodes::Radau, Form::Rates));
        let middle = Instant::now();
        tangent.explicit(&memory, &step, Singular::Moments, &point, &mut explicit);
        let account = Instant::now();
        let mut out = EnergyTangent { stored: &mut stored, dissipation: &mut dissipation };
        for theta in [0.0, RADAU_NODES[0], RADAU_NODES[1], 1.0] {
            tangent.energy(&memory, &step, theta, &point, &delta_u, &mut out);
        }
        spent[2] += account.elapsed().as_secs_f64();
        let rest = account.elapsed().as_secs_f64();
        tangent.commit(&memory, &step, &delta_u, Some(&end));
        let late = Instant::now();
        black_box(&explicit);
        memory.commit_rates(&polynomial, None, stroke, 1e-15);
        let own = (late - middle).as_secs_f64();
        spent[0] += begin.elapsed().as_secs_f64() - own;
        spent[1] += own - rest;
        if n % 100 == 99 {
            best = std::array::from_fn(|k| best[k].min(spent[k] * 1e7));
            spent = [0.0; 3];
        }
    }
    best
}

#[test]
#[ignore = "a measurement, for its table"]
fn of_a_step() {
    for order in [0.0, 1.0] {
        for parameters in [1, 8, 16, 32, 64] {
            let [memory, tangent, energies] = price(parameters, order);
            println!(
                "alpha {order}, P = {parameters}: memory {memory:.0} ns, derivative {tangent:.0} ns, of energies {energies:.0} ns"
            );
        }
    }
}

#[test]
#[ignore = "a measurement"]
fn of_a_kernel() {
    for tolerance in [1e-8, 1e-11] {
        let begin = Instant::now();
        let kernels: Vec<Kernel> =
            (1..100).map(|k| Kernel::new(0.01 * f64::from(k), tolerance, 1e-5, 10.0).unwrap()).collect();
        let middle = Instant::now();
        kernels.iter().for_each(|kernel| drop(black_box(ByOrder::of(kernel))));
        let [kernel, by_order] = [middle - begin, middle.elapsed()].map(|time| time.as_secs_f64() * 1e6 / 99.0);
        println!("{tolerance:e}: kernel {kernel:.0} µs, its derivative {by_order:.0} µs");
    }
}
