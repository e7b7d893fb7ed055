//! D^½ of uniform samples, and the price of one step of the memory as the past grows.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use springpot::collocation::{Nodes, RADAU_NODES};
use springpot::fractional::scheme::Samples;
use springpot::fractional::{
    Definition, Form, Kind, Memory, Method, RatePolynomial, RatedStream, StepStart, derivative,
};
use std::hint::black_box;

fn signal(t: f64) -> f64 {
    0.7 * (8.0 * t).sin() + 0.1 * t
}

fn rate(t: f64) -> f64 {
    5.6 * (8.0 * t).cos() + 0.1
}

/// 10⁵ and 10⁶ samples over 10 s: error ≤ 1e-8 of the largest value (asserted against the reference at t = 10).
fn samples(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("samples");
    group.sample_size(20);
    for count in [100_000, 1_000_000] {
        let h = 10.0 / (count - 1) as f64;
        let t: Vec<f64> = (0..count).map(|n| n as f64 * h).collect();
        let x: Vec<f64> = t.iter().map(|t| signal(*t)).collect();
        let samples = Samples { t: &t, x: &x, rate: None };
        group.throughput(Throughput::Elements(count as u64));
        for method in [Method::Spline, Method::Hermite, Method::Exponential] {
            let values = derivative(&samples, 0.5, Definition::Caputo, method).unwrap();
            let largest = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let error = (values[count - 1] + 1.189_941_531_700_918).abs() / largest;
            assert!(error <= 1e-8, "{method}: error {error:e}");
            println!("{method}, {count} samples: error at t = 10 s {error:.1e} of the largest value");
            group.bench_function(BenchmarkId::new(method.to_string(), count), |b| {
                b.iter(|| derivative(black_box(&samples), 0.5, Definition::Caputo, method).unwrap());
            });
        }
    }
    let (count, h) = (1_000_000, 10.0 / 999_999.0);
    let rated: Vec<[f64; 3]> = (0..count).map(|n| n as f64 * h).map(|t| [t, signal(t), rate(t)]).collect();
    let stream = || RatedStream::until(10.0, 0.5, Definition::Caputo).unwrap().with_tolerance(1e-8);
    let pass = |mut stream: RatedStream| -> f64 {
        rated.iter().map(|[t, x, rate]| stream.push(*t, *x, *rate).unwrap()).last().unwrap()
    };
    let error = (pass(stream()) + 1.189_941_531_700_918).abs();
    assert!(error <= 1e-8, "stream: error {error:e}");
    println!("stream with rates, {count} samples, kernel 1e-8: error at t = 10 s {error:.1e}");
    group.bench_function("stream with rates/1000000", |b| b.iter(|| pass(stream())));
    group.finish();
}

/// One Radau step (respond, energy, commit) after 10², 10⁴ and 10⁶ steps of past.
fn step_after(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("memory step");
    let h = 1e-3;
    for past in [100usize, 10_000, 1_000_000] {
        let mut memory = Memory::new(0.5, Kind::Caputo, 0.0, 0.0, 1e-11, RADAU_NODES[0] * h, 4e3).unwrap();
        let step = |n: usize| {
            let t = n as f64 * h;
            let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| rate(t + c * h)).collect();
            (
                StepStart { t, h, stroke: signal(t), rate: rates[0] },
                RatePolynomial::through_rates(h, Nodes::Radau, &rates),
            )
        };
        for n in 0..past {
            memory.commit(&step(n).1);
        }
        group.bench_with_input(BenchmarkId::from_parameter(past), &past, |b, &past| {
            let (start, polynomial) = step(past);
            b.iter(|| {
                let response = memory.respond(black_box(&start), Nodes::Radau, Form::Rates);
                let energy = memory.energy(&polynomial, 1.0, 0.0, polynomial.u[0]);
                memory.commit(&polynomial);
                (response, energy)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, samples, step_after);
criterion_main!(benches);
