//! The papers' first scenario as a user runs it: six orders, 10 s at 10 ms, CSV and figures.

use criterion::{Criterion, criterion_group, criterion_main};
use springpot::law::Catalog;
use std::ffi::OsString;
use std::path::Path;

fn thermoviscoelastic_order(criterion: &mut Criterion) {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/thermoviscoelastic_order.toml");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arguments = |more: &[&str]| -> Vec<OsString> {
        let fixed = ["springpot".into(), "run".into(), scenario.clone().into(), "--quiet".into()];
        let out = ["--out".into(), folder.path().as_os_str().to_owned()];
        fixed.into_iter().chain(out).chain(more.iter().map(OsString::from)).collect()
    };
    let mut group = criterion.benchmark_group("run thermoviscoelastic_order");
    group.sample_size(20);
    group.bench_function("CSV and figures", |b| {
        b.iter(|| springpot_cli::main_from(&Catalog::standard(), arguments(&[])))
    });
    group.bench_function("CSV alone", |b| {
        b.iter(|| springpot_cli::main_from(&Catalog::standard(), arguments(&["--no-figures"])))
    });
    group.bench_function("CSV alone, one job", |b| {
        b.iter(|| springpot_cli::main_from(&Catalog::standard(), arguments(&["--no-figures", "--jobs", "1"])));
    });
    group.finish();
    assert!(folder.path().join("results.csv").exists(), "the run wrote nothing");
}

criterion_group!(benches, thermoviscoelastic_order);
criterion_main!(benches);
