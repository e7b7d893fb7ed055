//! Parts one behind the other, against Mittag-Leffler closed forms and against other ways to write them.

use crate::{along, departure, force, slider, solved};
use springpot::fractional::mittag_leffler::MittagLeffler;
use springpot::law::{Derivative, Network};

const CAPUTO: Derivative = Derivative::Caputo;
const RIEMANN_LIOUVILLE: Derivative = Derivative::RiemannLiouville;

/// E_{a,b}(−(t/τ)^a) with τ^a = c/k.
fn relaxed(a: f64, b: f64, c: f64, k: f64, t: f64) -> f64 {
    MittagLeffler::new(a, b).unwrap().real(-k / c * t.powf(a))
}

fn maxwell(k: f64, c: f64, alpha: f64, derivative: Derivative) -> Network {
    Network::series([Network::spring(k), Network::springpot(c, alpha, derivative)])
}

/// Under x = v t the Maxwell element has F = v k t E_{a,2}(−(t/τ)^a), the Zener element v E_∞ t more.
#[test]
fn ramps_of_maxwell_and_zener_elements() {
    for alpha in [0.3, 0.5, 0.8] {
        let (k, c, rest) = (90.0, 40.0, 25.0);
        for swapped in [false, true] {
            let mut parts = vec![Network::spring(k), Network::springpot(c, alpha, CAPUTO)];
            if swapped {
                parts.reverse();
            }
            let law = Network::parallel([Network::spring(rest), Network::series(parts)]);
            let run = slider(&[law], &along("0.1*t"), 2.0, 20, 1e-10);
            let exact: Vec<f64> =
                run.t().iter().map(|t| 0.1 * t * (rest + k * relaxed(alpha, 2.0, c, k, *t))).collect();
            let error = departure(&force(&run), &exact);
            assert!(error < 1e-9, "{alpha}: {error:e} in {} steps", run.effort());
            assert!(run.residual() < 1e-6, "{alpha}: {:e}", run.residual());
        }
    }
}

/// Held at x(0) from t = 0 on the spring takes it all and F = k x(0) E_a(−(t/τ)^a); held since ever there is no force left.
#[test]
fn steps_relax() {
    for alpha in [0.3, 0.5, 0.8] {
        let (k, c) = (90.0, 40.0);
        let held = along("0.1");
        let run = slider(&[maxwell(k, c, alpha, RIEMANN_LIOUVILLE)], &held, 2.0, 20, 1e-10);
        let exact: Vec<f64> = run.t().iter().map(|t| 0.1 * k * relaxed(alpha, 1.0, c, k, *t)).collect();
        let error = departure(&force(&run), &exact);
        assert!(error < 1e-8, "{alpha}: {error:e} in {} steps", run.effort());
        let still = slider(&[maxwell(k, c, alpha, CAPUTO)], &held, 2.0, 20, 1e-10);
        assert!(force(&still).iter().all(|force| force.abs() < 1e-13));
    }
}

/// A spring and a dashpot: F = c v (1 − e^{−kt/c}).
#[test]
fn the_maxwell_element_of_textbooks() {
    let run =
        slider(&[Network::series([Network::dashpot(8.0), Network::spring(20.0)])], &along("0.1*t"), 2.0, 20, 1e-10);
    let exact: Vec<f64> = run.t().iter().map(|t| 0.8 * -(-20.0 / 8.0 * t).exp_m1()).collect();
    let error = departure(&force(&run), &exact);
    assert!(error < 1e-9, "{error:e}");
}

#[test]
fn the_same_network_written_differently() {
    let [a, b, c, d] = [
        Network::spring(90.0),
        Network::springpot(40.0, 0.6, CAPUTO),
        Network::parallel([Network::spring(30.0), Network::dashpot(2.0)]),
        Network::springpot(15.0, 0.25, CAPUTO),
    ];
    let ways = [
        Network::series([a.clone(), b.clone(), c.clone(), d.clone()]),
        Network::series([d.clone(), b.clone(), a.clone(), c.clone()]),
        Network::series([Network::series([a.clone(), b.clone()]), Network::series([c.clone(), d.clone()])]),
        Network::series([Network::parallel([Network::series([a, Network::series([b, c])])]), d]),
    ];
    // The same steps for all: what differs is the network alone.
    let solver = "rtol = 1e-3\nfirst_step = 0.0005\nmax_step = 0.0005";
    for motion in
        [along("0.1*sin(3*t)+0.05*t"), "kind = \"forward\"\nstart = { q = { q = 0.1 }, v = { q = 1 } }".to_owned()]
    {
        let runs = ways.each_ref().map(|law| solved(std::slice::from_ref(law), &motion, 1.0, 10, solver));
        for run in &runs[1..] {
            assert_eq!(run.effort(), runs[0].effort());
            let error = departure(&force(run), &force(&runs[0]));
            assert!(error < 1e-12, "{error:e} under {motion}, {} and {} steps", run.effort(), runs[0].effort());
        }
    }
}

/// The Zener element as Poynting and Thomson's: k1 behind (k2 beside a springpot).
#[test]
fn zener_and_poynting_thomson_elements_are_one() {
    let (instant, rest, c, alpha) = (120.0, 30.0, 40.0, 0.6);
    let zener = Network::parallel([Network::spring(rest), maxwell(instant - rest, c, alpha, CAPUTO)]);
    // k2 = k1 E_∞/(k1 − E_∞), and both relax at the same τ.
    let inner = instant * rest / (instant - rest);
    let beside = c / (instant - rest) * (instant + inner);
    let other = Network::series([
        Network::spring(instant),
        Network::parallel([Network::spring(inner), Network::springpot(beside, alpha, CAPUTO)]),
    ]);
    for (motion, rtol, bound) in
        [(along("0.1*sin(3*t)"), 1e-9, 1e-8), ("kind = \"forward\"\nstart = { v = { q = 1 } }".to_owned(), 1e-9, 1e-7)]
    {
        let [one, two] = [&zener, &other].map(|law| slider(std::slice::from_ref(law), &motion, 2.0, 20, rtol));
        let error = departure(&force(&one), &force(&two));
        assert!(error < bound, "{error:e} under {motion}");
        assert!(one.residual() < 1e-5 && two.residual() < 1e-5, "{:e} {:e}", one.residual(), two.residual());
    }
}

#[test]
fn more_parts_than_fit_side_by_side() {
    let many = Network::series((0..21).map(|_| Network::spring(21.0)));
    let run = slider(&[many], &along("0.1*t"), 1.0, 4, 1e-9);
    let exact: Vec<f64> = run.t().iter().map(|t| 0.1 * t).collect();
    assert!(departure(&force(&run), &exact) < 1e-13);
}
