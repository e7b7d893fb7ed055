//! Laws as networks: any number of memories in any order, parts in series, leaves with inner variables.

mod bouc_wen;
mod convergence;
mod dampers;
mod expressions;
mod harmonics;
mod jenkins;
mod named;
mod nonlinear;
mod one_sided;
mod orders;
mod pasts;
mod piezo;
mod series;
mod starts;
#[path = "../support/mod.rs"]
mod support;
mod tolerance;

use springpot::law::Network;
use support::{Run, cases, run_system};

/// A slider along x with an element `e0`, `e1`, … for each law, each between the world and the slider; their stroke is q.
pub(crate) fn slider(laws: &[Network], motion: &str, end: f64, rows: usize, rtol: f64) -> Run {
    solved(laws, motion, end, rows, &format!("rtol = {rtol:e}"))
}

/// As [`slider`] with more to say to the solver.
pub(crate) fn solved(laws: &[Network], motion: &str, end: f64, rows: usize, solver: &str) -> Run {
    let element = |k: usize| {
        format!(
            "[[element]]\nname = \"e{k}\"\nfrom = {{ body = \"world\", point = [0, 0, 0] }}\n\
             to = {{ body = \"b\", point = [0, 0, 0] }}\nrest_length = 1\nlaw = \"spring\"\nparameters = {{ k = 1 }}\n"
        )
    };
    let elements: String = (0..laws.len()).map(element).collect();
    let text = format!(
        "[robot]\ngravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 1\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0], origin = [1, 0, 0] }}\n{elements}\
         [motion]\n{motion}\n[time]\nend = {end}\noutput_step = {step}\n[solver]\n{solver}\nmax_steps = 400000\n",
        step = end / rows as f64
    );
    let plan = cases(&text).plan(0).expect("a valid plan");
    let mut system = plan.system();
    for (element, law) in system.elements.iter_mut().zip(laws) {
        element.law = law.clone();
    }
    let run = run_system(&system, &plan.settings);
    assert!(run.error.is_none(), "{:?} under {laws:?}", run.error);
    run
}

/// Along q(t).
pub(crate) fn along(q: &str) -> String {
    format!("kind = \"prescribed\"\njoints = {{ q = \"{q}\" }}")
}

/// The forces of all elements together, row by row.
pub(crate) fn force(run: &Run) -> Vec<f64> {
    let columns: Vec<Vec<f64>> =
        run.names.iter().filter(|name| name.ends_with(".force")).map(|name| run.column(name)).collect();
    (0..run.rows.len()).map(|row| columns.iter().map(|column| column[row]).sum()).collect()
}

/// Largest difference, in units of the largest value of `b`.
pub(crate) fn departure(a: &[f64], b: &[f64]) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(0.0, |m: f64, x| if x.is_nan() { f64::INFINITY } else { m.max(x.abs()) })
    };
    assert_eq!(a.len(), b.len());
    largest(&mut a.iter().zip(b).map(|(a, b)| a - b)) / largest(&mut b.iter().copied())
}
