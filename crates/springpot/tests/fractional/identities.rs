//! Identities of fractional calculus.

use super::support::{FUNCTIONS, Random, distance, even, of, of_power, uneven};
use springpot::fractional::{Definition, Method};

const METHODS: [Method; 3] = [Method::Spline, Method::Hermite, Method::Exponential];

fn grids() -> [Vec<f64>; 2] {
    [even(2000, 5.0), uneven(2000, 5.0, 11)]
}

#[test]
fn riemann_liouville_is_caputo_and_the_start() {
    for t in grids() {
        // x(0) = 1, x'(0) = −0.3
        let (_, x) = FUNCTIONS[4];
        let x: Vec<f64> = t.iter().map(|t| x(*t)).collect();
        for order in [0.01, 0.5, 0.99, 1.01, 1.5, 1.99] {
            for method in METHODS {
                let caputo = of(&t, &x, order, Definition::Caputo, method);
                let rl = of(&t, &x, order, Definition::RiemannLiouville, method);
                let gl = of(&t, &x, order, Definition::GrunwaldLetnikov, method);
                let start =
                    |t: f64| of_power(0.0, order, t) + if order > 1.0 { -0.3 * of_power(1.0, order, t) } else { 0.0 };
                let sum: Vec<f64> = t.iter().zip(&caputo).map(|(t, c)| c + start(*t)).collect();
                // x'(0) is what the method's differences make of it.
                let bound = if method == Method::Hermite { 1e-6 } else { 1e-9 };
                let error = distance(&rl[1..], &sum[1..]);
                assert!(error < bound, "a = {order}, {method}: {error:e}");
                assert_eq!(rl[1..], gl[1..]);
                assert!(rl[0].is_nan() && gl[0].is_nan());
            }
        }
    }
}

#[test]
fn integrals_form_a_semigroup() {
    // I^a I^b x = I^{a+b} x; the inner one starts like t^b, so x starts like t³.
    for t in grids() {
        let x: Vec<f64> = t.iter().map(|t| t.powi(3) * (2.0 * t).cos()).collect();
        for (a, b) in [(0.5, 0.5), (0.3, 1.2), (1.0, 0.7), (0.99, 0.99)] {
            let inner = of(&t, &x, -b, Definition::Caputo, Method::Spline);
            let twice = of(&t, &inner, -a, Definition::Caputo, Method::Spline);
            let once = of(&t, &x, -(a + b), Definition::Caputo, Method::Spline);
            let error = distance(&twice, &once);
            assert!(error < 2e-10, "I^{a} I^{b}: {error:e}");
        }
    }
}

#[test]
fn derivatives_undo_integrals() {
    for t in grids() {
        let x: Vec<f64> = t.iter().map(|t| t.powi(3) * (2.0 * t).cos()).collect();
        for (order, bound) in [(0.3, 1e-9), (0.5, 1e-9), (0.99, 1e-8), (1.5, 1e-6)] {
            let integral = of(&t, &x, -order, Definition::RiemannLiouville, Method::Spline);
            let back = of(&t, &integral, order, Definition::RiemannLiouville, Method::Spline);
            let error = distance(&back[1..], &x[1..]);
            assert!(error < bound, "D^{order} I^{order}: {error:e}");
        }
    }
}

#[test]
fn every_order_is_linear() {
    let mut random = Random(5);
    for t in grids() {
        let noise: Vec<Vec<f64>> = (0..2).map(|_| t.iter().map(|_| random.next() - 0.5).collect()).collect();
        let sum: Vec<f64> = noise[0].iter().zip(&noise[1]).map(|(a, b)| 2.0 * a - 3.0 * b).collect();
        for order in [-1.5, -0.5, 0.5, 1.5] {
            for method in METHODS {
                let parts: Vec<Vec<f64>> = noise.iter().map(|x| of(&t, x, order, Definition::Caputo, method)).collect();
                let added: Vec<f64> = parts[0].iter().zip(&parts[1]).map(|(a, b)| 2.0 * a - 3.0 * b).collect();
                let whole = of(&t, &sum, order, Definition::Caputo, method);
                assert!(distance(&added, &whole) < 1e-12, "a = {order}, {method}");
            }
        }
    }
}

/// The order may go through an integer without a step, but for what the definitions say.
#[test]
fn orders_are_continuous() {
    let t = even(1000, 5.0);
    let (_, x) = FUNCTIONS[4];
    let x: Vec<f64> = t.iter().map(|t| x(*t)).collect();
    for integer in [-2.0, -1.0, 0.0, 1.0, 2.0] {
        let at = of(&t, &x, integer, Definition::Caputo, Method::Spline);
        let near = |order: f64| of(&t, &x, order, Definition::Caputo, Method::Spline);
        // From above for all; from below Caputo jumps by x(0) at 0 and by x'(0) at 1.
        if integer < 2.0 && integer != 1.0 {
            assert!(distance(&near(integer + 1e-9)[1..], &at[1..]) < 1e-7, "{integer} from above");
        }
        if integer > -2.0 && integer != 0.0 {
            assert!(distance(&near(integer - 1e-9)[1..], &at[1..]) < 1e-7, "{integer} from below");
        }
    }
}
