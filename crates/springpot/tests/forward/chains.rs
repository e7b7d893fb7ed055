//! Chains of many links.

use crate::support::forward::{distance, every};
use crate::support::run;
use std::fmt::Write as _;

/// Links in a row, 2 m and 4 kg in all, bent at the middle, with a strut of an order from the world to the last one and more of them between links.
fn chain(links: usize, alpha: f64, others: usize) -> String {
    let (length, mass) = (2.0 / links as f64, 4.0 / links as f64);
    let mut text = String::from("[robot]\n");
    for k in 0..links {
        let from = if k == 0 { 0.0 } else { length };
        writeln!(
            text,
            "[[robot.body]]\nname = \"b{k}\"\nmass = {mass}\ncom = [{com}, 0, 0]\ninertia = {{ xx = 1e-4, yy = {yy}, zz = {yy} }}\n\
             joint = {{ name = \"q{k}\", kind = \"revolute\", axis = [0, 1, 0], origin = [{from}, 0, 0], damping = {damping} }}",
            com = 0.5 * length,
            yy = mass * length * length / 12.0,
            damping = 0.2 / links as f64,
        )
        .unwrap();
    }
    let mut strut = |name: &str, from: &str, to: usize, rest: f64, c: f64| {
        writeln!(
            text,
            "[[element]]\nname = \"{name}\"\nfrom = {from}\nto = {{ body = \"b{to}\", point = [{length}, 0, 0] }}\nrest_length = {rest}\n\
             law = \"fractional-kelvin-voigt\"\nparameters = {{ k = 30, c = {c}, alpha = {alpha} }}",
        )
        .unwrap();
    };
    strut("strut", "{ body = \"world\", point = [0.5, 0, 0.8] }", links - 1, 1.4, 5.0);
    for k in 0..others {
        strut(&format!("s{k}"), &format!("{{ body = \"b{k}\", point = [0, 0, 0.1] }}"), k + 2, 0.3, 0.2);
    }
    let middle = links / 2;
    text + &format!("[motion]\nkind = \"forward\"\n[motion.start.q]\nq0 = 0.3\nq{middle} = 0.5\n")
}

#[test]
fn no_tolerance_is_dearer_than_a_finer_one() {
    let efforts =
        [1e-2, 1e-3, 1e-4, 1e-5, 1e-6].map(|rtol| run(&(chain(20, 0.5, 0) + &every(2.0, 2.0, rtol))).effort());
    println!("steps tried from rtol 1e-2 to 1e-6: {efforts:?}");
    assert!(efforts.windows(2).all(|pair| pair[0] as f64 <= 1.05 * pair[1] as f64), "{efforts:?}");
}

#[test]
fn elements_with_memory_are_met_by_the_iteration_as_any_others() {
    // The system is taken apart where there are few of them, and factored whole where there are many.
    for (links, others) in [(8, 1), (8, 6)] {
        let of = |rtol: f64| run(&(chain(links, 0.6, others) + &every(0.5, 0.1, rtol)));
        let (coarse, fine) = (of(1e-6), of(1e-9));
        let steps = fine.effort() as f64;
        let iterations = fine.report.newton_iterations.expect("Newton's") as f64 / steps;
        let error = distance(&coarse.column("q.q7"), &fine.column("q.q7"));
        println!("{others} more elements: {iterations:.2} iterations a step, q within {error:.1e}");
        assert!(iterations < 3.0 && error < 2e-6, "{iterations} {error}");
        assert!(fine.residual() < 1e-8, "{}", fine.residual());
    }
}
