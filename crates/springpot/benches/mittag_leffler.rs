//! E_{a,b} at 1000 arguments: relaxations, oscillations, the whole plane; derivatives; and what preparing costs.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler, mittag_leffler};
use std::hint::black_box;

const COUNT: usize = 1000;

/// 1e-4 … 1e4, spread evenly in the logarithm.
fn radius(k: usize) -> f64 {
    10f64.powf(-4.0 + 8.0 * k as f64 / COUNT as f64)
}

fn slices(criterion: &mut Criterion) {
    let negative: Vec<f64> = (0..COUNT).map(|k| -radius(k)).collect();
    let plane: Vec<Complex64> = (0..COUNT).map(|k| Complex64::from_polar(radius(k), 2.4 * k as f64)).collect();
    let mut group = criterion.benchmark_group("mittag-leffler");
    group.throughput(Throughput::Elements(COUNT as u64));
    let mut values = vec![0.0; COUNT];
    for (a, n) in [(0.5, 0), (0.9, 0), (1.7, 0), (0.5, 1), (0.5, 2)] {
        let function = MittagLeffler::derivative(a, 1.0, n).unwrap();
        group.bench_function(format!("negative x, a = {a}, derivative {n}"), |b| {
            b.iter(|| function.real_into(black_box(&negative), &mut values));
        });
    }
    let mut complex = vec![Complex64::ZERO; COUNT];
    for a in [0.5, 1.7] {
        let function = MittagLeffler::new(a, 1.0).unwrap();
        group.bench_function(format!("complex z, a = {a}"), |b| {
            b.iter(|| function.complex_into(black_box(&plane), &mut complex));
        });
    }
    group.finish();
    criterion.bench_function("mittag-leffler/prepare, a = 0.5", |b| b.iter(|| MittagLeffler::new(black_box(0.5), 1.0)));
    let z = Complex64::new(-3.0, 1.0);
    criterion.bench_function("mittag-leffler/one call, a = 0.5", |b| b.iter(|| mittag_leffler(black_box(0.5), 1.0, z)));
}

criterion_group!(benches, slices);
criterion_main!(benches);
