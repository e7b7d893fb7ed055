//! One law with two springpots of different orders on the arm of the first paper, along its motion.
//!
//! `cargo run --release -p springpot --example network` prints the force of the element and a coordinate at every tenth of a second, and the
//! force of the same law built the other way round; the last number on stderr is that of the inner steps.

use springpot::driver::{Report, run};
use springpot::law::{Catalog, Derivative, Network};
use springpot::observe::Table;
use springpot::system::{Settings, Stop, System};
use springpot_scenario::Scenario;

/// The robot, the anchors and the motion of the arm; its element gets the law below.
const SCENARIO: &str = r#"
[[robot.body]]
name = "column"
joint = { name = "q1", kind = "revolute", axis = [0, 0, 1], origin = [0, 0, 0] }
mass = 6.0
com = [0.02, 0.0, 0.3]
inertia = { xx = 0.20, yy = 0.20, zz = 0.06, xz = 0.01 }
[[robot.body]]
name = "upper_arm"
joint = { name = "q2", kind = "revolute", axis = [0, 1, 0], origin = [0, 0, 0.6] }
mass = 3.0
com = [0.25, 0.01, 0.02]
inertia = { xx = 0.01, yy = 0.07, zz = 0.07, xy = 0.001, yz = 0.0005 }
[[robot.body]]
name = "forearm"
joint = { name = "q3", kind = "revolute", axis = [0, 1, 0], origin = [0.5, 0, 0] }
mass = 2.0
com = [0.18, -0.01, 0.01]
inertia = { xx = 0.006, yy = 0.03, zz = 0.03, xz = -0.001, yz = 0.0004 }
[[element]]
name = "strut"
from = { body = "column", point = [0.14, -0.1, 0.08] }
to = { body = "forearm", point = [-0.06, 0.1, 0.08] }
rest_length = "70 cm"
law = "spring"
parameters = { k = 1 }
[motion]
kind = "prescribed"
joints = { q1 = 0, q2 = "0.1*sin(8*t)", q3 = "0.1*t" }
[time]
end = "10 s"
output_step = "100 ms"
"#;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let plan = Scenario::parse(SCENARIO, "network.toml", "")?.cases(&Catalog::standard())?.plan(0)?;
    let parts = [Network::springpot(50.0, 0.3, Derivative::Caputo), Network::springpot(20.0, 0.7, Derivative::Caputo)];
    let [first, second] = parts.clone();
    let (report, table) = with_law(plan.system(), &plan.settings, Network::parallel(parts))?;
    let (_, swapped) = with_law(plan.system(), &plan.settings, Network::parallel([second, first]))?;

    let [t, force, q2] = ["t", "strut.force", "q.q2"].map(|name| table.column(name).expect("a column"));
    let other = swapped.column("strut.force").expect("a column");
    println!("t,force,q2,swapped");
    for k in 0..t.len() {
        println!("{},{:e},{:e},{:e}", t[k], force[k], q2[k], other[k]);
    }
    eprintln!("inner steps: {}", report.steps);
    Ok(())
}

/// A run of the system whose element has this law.
fn with_law(mut system: System, settings: &Settings, law: Network) -> Result<(Report, Table), Failure> {
    system.elements[0].law = law;
    let mut table = system.table();
    let (report, outcome) = run(&system, settings, &mut table, &Stop::new(false));
    outcome?;
    Ok((report, table))
}
