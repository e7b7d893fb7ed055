//! A springpot without a robot: its force under the stroke sin(8 t), a row at every millisecond.
//!
//! `cargo run --release -p springpot --example bank`

use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::{Form, KernelError};
use springpot::law::{Derivative, Network, Start};

fn main() -> Result<(), KernelError> {
    let (h, nodes) = (1e-3, Nodes::Radau);
    let mut bank = ElementBank::new(vec![Network::springpot(1.0, 0.5, Derivative::Caputo)], nodes, Form::Rates);
    let memory = MemoryRange { tolerance: 1e-11, shortest: h, horizon: 2.0 };
    bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &[] }], memory)?;

    println!("t,force");
    println!("0,0");
    for n in 0..2000 {
        let t = f64::from(n) / 1000.0;
        bank.start(t, h);
        for (point, c) in [0.0].iter().chain(nodes.positions()).enumerate() {
            let at = t + c * h;
            bank.set(0, point, (8.0 * at).sin(), 8.0 * (8.0 * at).cos(), &[]);
        }
        bank.evaluate();
        bank.commit();
        println!("{},{:e}", f64::from(n + 1) / 1000.0, bank.force(0));
    }
    Ok(())
}
