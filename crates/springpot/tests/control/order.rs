//! The order of forward runs under continuous feedback.

use super::support::forward::{distance, slider, state};
use super::support::run;

/// By `"radau"`, −d ln(error)/d ln(steps) from loose to tight tolerances, by least squares.
fn order(rest: &str) -> f64 {
    let law = "law = \"spring\"\nparameters = { k = 30 }";
    let text = slider("2", 0.0, law, &state("0", "0"));
    let solved = |rtol: f64| {
        let run = run(&format!(
            "{text}{rest}\n[time]\nend = 2\noutput_times = [1, 2]\n[solver]\nmethod = \"radau\"\nrtol = {rtol:e}\nmax_step = 2\n"
        ));
        ([run.column("q.q"), run.column("v.q")].concat(), run.report.steps)
    };
    let (exact, _) = solved(1e-13);
    let points = [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11].map(|rtol| {
        let (end, steps) = solved(rtol);
        ((steps as f64).ln(), distance(&end, &exact).ln())
    });
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mx) * (y - my), xx + (x - mx).powi(2)));
    -xy / xx
}

#[test]
fn the_order_is_five_with_continuous_feedback() {
    for (name, rest) in [
        ("a cubic spring", "torque = { q = \"20*t^7*exp(-3*t) - 40*q.q^3 - 2*v.q\" }"),
        ("an input", "torque = { q = \"20*t^7*exp(-3*t)*cos(3*q.q)\" }"),
        (
            "pid",
            "[motion.controller]\nkind = \"pid\"\nkp = 20\nki = 30\nkd = 4\nreference = { kind = \"joints\", q = \"10*t^7*exp(-3*t)\" }",
        ),
        (
            "fractional",
            "[motion.controller]\nkind = \"fractional-pid\"\nkp = 20\nki = 30\nkd = 4\nlambda = 0.4\nmu = 0.6\nreference = { kind = \"joints\", q = \"10*t^7*exp(-3*t)\" }",
        ),
    ] {
        let order = order(rest);
        println!("{name}: {order:.2}");
        assert!(order > 4.5, "{name}: {order}");
    }
}
