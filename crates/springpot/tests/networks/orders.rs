//! Several memories in one law, in any order of building, against an element for each.

use crate::{along, departure, force, slider};
use springpot::law::{Derivative, Network};

const CAPUTO: Derivative = Derivative::Caputo;

/// The motions under which laws are compared, and the relative tolerance of the runs.
fn motions() -> [(String, f64); 4] {
    [
        (along("0.2*sin(5*t)+0.1*t"), 1e-9),
        (along("0.1*abs(t-1)"), 1e-9),
        (along("0.1+0.05*cos(3*t)"), 1e-9),
        ("kind = \"forward\"\nstart = { q = { q = 0.1 } }\ntorque = { q = \"3*sin(2*t)\" }".to_owned(), 1e-11),
    ]
}

#[test]
fn two_orders_in_one_law_are_two_elements() {
    let (slow, fast, dashpot) =
        (|| Network::springpot(50.0, 0.3, CAPUTO), || Network::springpot(20.0, 0.7, CAPUTO), || Network::dashpot(4.0));
    for (motion, rtol) in motions() {
        for parts in [
            vec![slow(), fast()],
            vec![fast(), slow()],
            vec![dashpot(), slow(), fast()],
            vec![dashpot(), fast(), slow()],
            vec![slow(), fast(), dashpot()],
            vec![fast(), slow(), dashpot()],
            vec![slow(), dashpot(), fast()],
        ] {
            let apart = slider(&parts, &motion, 2.0, 40, rtol);
            let together = slider(&[Network::parallel(parts.clone())], &motion, 2.0, 40, rtol);
            let error = departure(&force(&together), &force(&apart));
            assert!(error <= 1e-9, "{error:e}: {parts:?} under {motion}");
            let effort = [&together, &apart].map(|run| run.effort());
            assert!(effort[0] <= 3 * effort[1], "{effort:?} steps: {parts:?} under {motion}");
        }
    }
}

/// Every kind of leaf that needs no input, at the orders where it differs.
fn leaves() -> Vec<Network> {
    let mut leaves = vec![Network::spring(7.0), Network::dashpot(3.0)];
    for derivative in [CAPUTO, Derivative::RiemannLiouville] {
        leaves.extend([0.0, 0.2, 0.6, 0.95, 1.0].map(|alpha| Network::springpot(5.0, alpha, derivative)));
    }
    leaves
}

#[test]
fn every_pair_of_leaves_in_every_order_of_building() {
    for motion in [along("0.1*sin(4*t)"), along("0.2*abs(t-0.5)-0.1")] {
        for a in leaves() {
            for b in leaves() {
                let apart = slider(&[a.clone(), b.clone()], &motion, 1.0, 10, 1e-9);
                let nested = Network::parallel([Network::parallel([a.clone()]), b.clone()]);
                for law in [Network::parallel([a.clone(), b.clone()]), nested] {
                    let together = slider(&[law], &motion, 1.0, 10, 1e-9);
                    let error = departure(&force(&together), &force(&apart));
                    assert!(error <= 1e-9, "{error:e}: {a:?} and {b:?} under {motion}");
                    assert!(together.effort() <= 3 * apart.effort(), "{a:?} and {b:?} under {motion}");
                }
            }
        }
    }
}

#[test]
fn a_dashpot_beside_a_springpot_may_stand_first() {
    let parts = [Network::springpot(5.0, 0.4, CAPUTO), Network::dashpot(3.0)];
    let swapped = [parts[1].clone(), parts[0].clone()];
    for (motion, rtol) in motions() {
        let [one, other] =
            [&parts, &swapped].map(|parts| slider(&[Network::parallel(parts.iter().cloned())], &motion, 2.0, 40, rtol));
        assert!(departure(&force(&one), &force(&other)) < 1e-9, "{motion}");
        // The derivative that is told is the springpot's.
        assert!(departure(&one.column("e0.derivative"), &other.column("e0.derivative")) < 1e-9, "{motion}");
    }
}
