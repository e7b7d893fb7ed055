//! Laws under heat: reduced time, expansion, temperatures of their own.

mod orders;
mod reduced_time;
#[path = "../support/mod.rs"]
mod support;
mod warming;

use support::Run;

/// A slider of 2 kg with the element `e` on its joint, whose stroke is its coordinate.
pub(crate) fn slider(element: &str, motion: &str, end: f64, rows: usize, solver: &str) -> String {
    format!(
        "robot.gravity = [0, 0, 0]\n[[robot.body]]\nname = \"b\"\nmass = 2\n\
         joint = {{ name = \"q\", kind = \"prismatic\", axis = [1, 0, 0], origin = [0, 0, 0] }}\n\
         [[element]]\nname = \"e\"\njoint = \"q\"\n{element}\n[motion]\n{motion}\n[time]\nend = {end}\n\
         output_step = {step}\n[solver]\n{solver}\nmax_steps = 400000\n",
        step = end / rows as f64
    )
}

/// Along q(t).
pub(crate) fn along(q: &str) -> String {
    format!("kind = \"prescribed\"\njoints = {{ q = \"{q}\" }}")
}

/// From q(0) under a torque.
pub(crate) fn forward(q: f64, torque: &str) -> String {
    format!("kind = \"forward\"\nstart = {{ q = {{ q = {q} }} }}\ntorque = {{ q = \"{torque}\" }}")
}

/// Largest difference, in units of the largest value of `b`.
pub(crate) fn departure(a: &[f64], b: &[f64]) -> f64 {
    support::relative_difference(b, a)
}

/// Laws of every kind, by name.
pub(crate) const LAWS: [(&str, &str); 7] = [
    ("springpot", "law = \"springpot\"\nparameters = { c = 50, alpha = 0.4 }"),
    ("zener", "law = \"fractional-zener\"\nparameters = { k_e = 20, k_m = 100, c = 30, alpha = 0.5 }"),
    (
        "burgers",
        "law = \"fractional-burgers\"\nparameters = { k_1 = 90, c_1 = 40, alpha_1 = 0.9, k_2 = 50, c_2 = 20, alpha_2 = 0.4 }",
    ),
    ("maxwell", "law = \"maxwell\"\nparameters = { k = 30, c = 6 }"),
    ("kelvin-voigt", "law = \"kelvin-voigt\"\nparameters = { k = 30, c = 6 }"),
    (
        "filled-rubber",
        "law = \"filled-rubber\"\nparameters = { k = 20, c = 30, alpha = 0.3, k_f = [60, 30], F_f = [1, 2] }",
    ),
    (
        "mixed",
        "network = \"parallel(polynomial(k, z, k3), series(spring(ks), springpot(d, alpha)), bouc-wen(ah, A, b, g, n), \
         dashpot(c), springpot(f, beta))\"\n\
         parameters = { k = 3, z = 0, k3 = 40, ks = 40, d = 8, alpha = 0.6, f = 6, beta = 0.2, ah = 30, A = 1, b = 20, g = 60, n = 1.5, c = 1 }",
    ),
];

/// Largest |dissipated − capacity·ΔT − heat| of the rows, in units of the largest dissipated.
pub(crate) fn heat_gap(run: &Run, capacity: f64) -> f64 {
    let [dissipated, temperature, heat] = ["e.dissipated", "e.T", "e.heat"].map(|name| run.column(name));
    let gap = |k: usize| (dissipated[k] - capacity * (temperature[k] - temperature[0]) - heat[k]).abs();
    (0..dissipated.len()).map(gap).fold(0.0, f64::max) / support::largest(&dissipated)
}
