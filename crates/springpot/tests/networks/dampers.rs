//! Dampers behind a driver: Spencer's against an integration of its own, the others against closed forms, tangents, energies, rules.

use crate::departure;
use crate::support::oracle::{column, file};
use crate::support::{Run, run, try_run};
use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{Catalog, Derivative, InputValue, Network, Point, Start};

/// The published set of the prototype, N, m, s, V.
pub(crate) const SPENCER: &str = "c_0a = \"21 N*s/cm\", c_0b = \"3.5 N*s/(cm*V)\", c_1a = \"283 N*s/cm\", \
    c_1b = \"2.95 N*s/(cm*V)\", k_0 = \"46.9 N/cm\", k_1 = \"5 N/cm\", x_0 = \"14.3 cm\", alpha_a = \"140 N/cm\", \
    alpha_b = \"695 N/(cm*V)\", A = 301, beta = 3.63e6, gamma = 3.63e6, n = 2, eta = \"190 1/s\"";

const SPENCER_SI: [f64; 14] =
    [2100.0, 350.0, 28300.0, 295.0, 4690.0, 500.0, 0.143, 14000.0, 69500.0, 301.0, 3.63e6, 3.63e6, 2.0, 190.0];

/// A slider with one element on its joint.
fn slider(law: &str, parameters: &str, u: &str, motion: &str, time: &str, rtol: f64) -> String {
    format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 10\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0] }}\n\
         [[element]]\nname = \"d\"\njoint = \"q\"\nlaw = \"{law}\"\nparameters = {{ {parameters} }}\ninputs = {{ u = \"{u}\" }}\n\
         [motion]\n{motion}\n[time]\n{time}\n[solver]\nrtol = {rtol:e}\nmax_steps = 400000\n"
    )
}

const SINE: &str = "kind = \"prescribed\"\njoints = { q = \"0.015*sin(5*pi*t)\" }";

fn tested(u: &str, rtol: f64) -> Run {
    run(&slider("spencer", SPENCER, u, SINE, "end = 1\noutput_step = 0.005", rtol))
}

/// 2.5 Hz, 1.5 cm, 0 … 2.25 V, and a command that is switched (testdata/dampers): forces and energies of every row.
#[test]
fn spencers_damper_under_the_standard_test() {
    let reference = file("dampers/spencer.json");
    let commands = [
        ("sine 0.0 V", "0"),
        ("sine 0.75 V", "0.75"),
        ("sine 1.5 V", "1.5"),
        ("sine 2.25 V", "2.25"),
        ("steps", "2.25*step(t - 0.3) - 1.75*step(t - 0.7)"),
    ];
    for (case, u) in commands {
        let rows = &reference["cases"][case];
        for rtol in [1e-6, 1e-9] {
            let run = tested(u, rtol);
            let off = |name: &str, index: usize| departure(&run.column(name), &column(rows, index));
            let force = off("d.force", 1);
            let energies = [off("d.stored", 5), off("d.dissipated", 6)];
            println!(
                "{case} {rtol:e}: force {force:.1e}, stored and dissipated {:.1e} {:.1e}, residual {:.1e}, {} steps",
                energies[0],
                energies[1],
                run.residual(),
                run.effort()
            );
            assert!(force < rtol, "{case}: {force:e} at {rtol:e}");
            assert!(energies.iter().all(|error| *error < 0.1 * rtol), "{case}: {energies:?} at {rtol:e}");
            assert!(run.residual() < 10.0 * rtol, "{case}: {:e} at {rtol:e}", run.residual());
            if case == "steps" {
                let input = off("d.input", 7);
                assert!(input < 100.0 * rtol, "{input:e}");
            }
        }
    }
}
