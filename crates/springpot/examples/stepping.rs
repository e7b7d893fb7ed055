//! A scenario stepped by hand: the force of its first element and its second coordinate at every tenth of a second.
//!
//! `cargo run --release -p springpot --example stepping [scenario.toml]` prints `t,force,q2`; sweeps are dropped, the values of the file itself
//! count.

/// The system of a scenario file at t = 0, with the settings of the file.
fn simulation(path: &str) -> Result<springpot::Simulation, Box<dyn std::error::Error>> {
    let scenario = springpot_scenario::Scenario::read(path)?.without_sweeps();
    let plan = scenario.cases(&springpot::law::Catalog::standard())?.plan(0)?;
    Ok(springpot::Simulation::new(plan.system(), plan.settings)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let falling = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/falling_thermoviscoelastic.toml");
    let path = std::env::args().nth(1).unwrap_or_else(|| falling.to_owned());
    let mut simulation = simulation(&path)?;
    let end = simulation.end();
    println!("t,force,q2");
    for tenth in 0u32.. {
        let t = (f64::from(tenth) / 10.0).min(end);
        while simulation.t() < t {
            simulation.step()?;
        }
        let now = simulation.interpolate(t)?;
        println!("{t},{:e},{:e}", now.force(0), now.q()[1]);
        if t == end {
            return Ok(());
        }
    }
    Ok(())
}
