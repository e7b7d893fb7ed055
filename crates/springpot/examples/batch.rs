//! Inverse dynamics of many states of a robot on all cores, as springpot-py does them: `cargo run --release --example batch -- ROBOT.urdf [N]`.

use springpot::dynamics::batch::{self, BatchWorkspace};
use springpot::model::description::{DescriptionOptions, RobotDescription};
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("which robot?")?;
    let count: usize = arguments.next().map_or(Ok(100_000), |count| count.parse())?;
    let model = RobotDescription::read(Path::new(&path), &DescriptionOptions::default())?.model([0.0, 0.0, -9.81])?;
    let (nq, nv) = (model.nq(), model.nv());
    let q: Vec<f64> = (0..count as u64).flat_map(|seed| model.random(seed)).collect();
    let [v, a] = [0.3, 0.7].map(|seed| (0..count * nv).map(|k| (seed + k as f64).sin()).collect::<Vec<_>>());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = count.div_ceil(threads);
    let mut taken = Vec::new();
    for _ in 0..15 {
        let begun = Instant::now();
        let mut tau = vec![0.0; count * nv];
        std::thread::scope(|scope| {
            for (part, tau) in tau.chunks_mut(rows * nv).enumerate() {
                let (model, from, states) = (&model, part * rows, tau.len() / nv);
                let q = &q[from * nq..][..states * nq];
                let [v, a] = [&v, &a].map(|all| &all[from * nv..][..states * nv]);
                scope.spawn(move || {
                    let mut workspace = BatchWorkspace::new(model).expect("a level that this processor has");
                    batch::rnea_into(model, &mut workspace, q, v, a, tau).expect("finite states");
                });
            }
        });
        taken.push(begun.elapsed().as_secs_f64());
    }
    taken.sort_by(f64::total_cmp);
    println!(
        "{:.0} ns a state, median of {}, {count} states, {threads} threads",
        taken[7] / count as f64 * 1e9,
        taken.len()
    );
    Ok(())
}
