//! What elements cost: the same leaves in series and in parallel, and many elements on one robot.

use criterion::{Criterion, criterion_group, criterion_main};
use springpot::driver::{Report, run};
use springpot::law::Catalog;
use springpot::system::{Stop, System};
use springpot_scenario::{Plan, Scenario};

const ARM: &str = r#"
[robot]
gravity = [0, 0, -9.81]
[[robot.body]]
name = "column"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0] }
mass = 3
inertia = { xx = 0.1, yy = 0.1, zz = 0.05 }
[[robot.body]]
name = "upper"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.4] }
mass = 2
com = [0.3, 0, 0]
inertia = { xx = 0.01, yy = 0.1, zz = 0.1 }
[[robot.body]]
name = "fore"
joint = { name = "q3", kind = "revolute", axis = [0, 1, 0], origin = [0.6, 0, 0] }
mass = 1
com = [0.2, 0, 0]
inertia = { xx = 0.005, yy = 0.04, zz = 0.04 }
"#;

fn plan(elements: usize, network: &str) -> Plan {
    let mut text = ARM.to_owned();
    for e in 0..elements {
        let place = 0.1 + 0.3 * e as f64 / elements as f64;
        text += &format!(
            "[[element]]\nname = \"e{e}\"\nfrom = {{ body = \"column\", point = [0.1, 0, {place}] }}\n\
             to = {{ body = \"fore\", point = [{place}, 0, 0.05] }}\nrest_length = \"start\"\n{network}\n\
             parameters = {{ k = {}, m = {}, c = {}, alpha = 0.6 }}\n",
            800.0 / elements as f64,
            2000.0 / elements as f64,
            300.0 / elements as f64
        );
    }
    text += "[motion]\nkind = \"forward\"\nstart = { q = { q2 = 0.4, q3 = 0.5 } }\n\
             [time]\nend = 1\noutput_times = [1]\n[solver]\nrtol = 1e-12\nmax_step = 1e-3\n";
    let cases = Scenario::parse(&text, "bench", ".").unwrap_or_else(|refusals| panic!("{refusals}"));
    let cases = cases.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"));
    cases.plan(0).unwrap_or_else(|refusals| panic!("{refusals}"))
}

const PARALLEL: &str = "network = \"parallel(spring(k), parallel(spring(m), springpot(c, alpha)))\"";
const SERIES: &str = "network = \"parallel(spring(k), series(spring(m), springpot(c, alpha)))\"";

/// A run from t = 0, and what it did.
fn once(plan: &Plan, system: &System) -> Report {
    let mut table = system.table();
    let (report, ended) = run(system, &plan.settings, &mut table, &Stop::new(false));
    ended.expect("a run");
    report
}

fn measure(criterion: &mut Criterion, group: &str, plans: [(&str, Plan); 2]) {
    let mut group = criterion.benchmark_group(group);
    group.sample_size(20);
    for (name, plan) in plans {
        let system = plan.system();
        let report = once(&plan, &system);
        println!("{name}: {} steps", report.steps + report.rejected_steps);
        group.bench_function(name, |bench| bench.iter(|| once(&plan, &system)));
    }
    group.finish();
}

fn networks(criterion: &mut Criterion) {
    measure(criterion, "one second of the arm", [("in parallel", plan(1, PARALLEL)), ("in series", plan(1, SERIES))]);
}

fn many(criterion: &mut Criterion) {
    measure(criterion, "elements on the arm", [("one", plan(1, PARALLEL)), ("two hundred", plan(200, PARALLEL))]);
}

criterion_group! { name = benches; config = Criterion::default().without_plots(); targets = networks, many }
criterion_main!(benches);
