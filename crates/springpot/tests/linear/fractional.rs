//! Eigenvalues of fractional equations against roots that are found another way, and their number.

use crate::support::system;
use crate::{arm, modes, on_joints, slider};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

const TIME: &str = "[time]\nend = 1\noutput_step = 0.5";

/// The root r e^{iφ} of m s² + c s^α + k with π/2 < φ < π: its imaginary part says r(φ), its real part φ by bisection.
fn root(m: f64, c: f64, k: f64, alpha: f64) -> Complex64 {
    let radius = |phi: f64| (-c * (alpha * phi).sin() / (m * (2.0 * phi).sin())).powf((2.0 - alpha).recip());
    let real = |phi: f64| {
        let r = radius(phi);
        m * r * r * (2.0 * phi).cos() + c * r.powf(alpha) * (alpha * phi).cos() + k
    };
    let (mut low, mut high) = (FRAC_PI_2, PI);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if real(middle) < 0.0 { low = middle } else { high = middle }
    }
    Complex64::from_polar(radius(0.5 * (low + high)), 0.5 * (low + high))
}

#[test]
fn one_mass_at_many_orders() {
    for alpha in [0.02, 0.1, 0.25, 0.5, 1.0 / 3.0, 0.61, 0.8, 0.95, 0.999] {
        for (m, c, k) in [(2.0, 3.0, 50.0), (0.1, 40.0, 1e4), (5.0, 300.0, 2.0), (1e-3, 1e-3, 1.0)] {
            let law =
                format!("law = \"fractional-kelvin-voigt\"\nparameters = {{ k = {k}, c = {c}, alpha = {alpha} }}");
            let modes = modes(&system(&slider(m, &law, "", TIME)));
            let expected = root(m, c, k, alpha);
            assert!(modes.modes.len() == 1 && modes.counted == Some(2), "{alpha} {m} {c} {k}: {modes:?} {expected}");
            let s = modes.modes[0].eigenvalue;
            assert!((s - expected).norm() < 1e-11 * s.norm(), "{alpha} {m} {c} {k}: {s} {expected}");
            let terms = [m * s * s, c * s.powf(alpha), Complex64::from(k)];
            let residual: Complex64 = terms.iter().sum();
            assert!(residual.norm() < 1e-13 * terms.iter().map(|term| term.norm()).sum::<f64>() * 10.0);
        }
    }
}

#[test]
fn springs_behind_springpots() {
    // m s² + k_e + k_m c s^α/(k_m + c s^α), and a springpot alone, which has no spring to come back to.
    let law = "law = \"fractional-zener\"\nparameters = { k_e = 40, k_m = 200, c = 15, alpha = 0.4 }";
    let s = modes(&system(&slider(1.5, law, "", TIME))).modes[0].eigenvalue;
    let springpot = 15.0 * s.powf(0.4);
    assert!((1.5 * s * s + 40.0 + 200.0 * springpot / (200.0 + springpot)).norm() < 1e-11, "{s}");
    let alone = modes(&system(&slider(2.0, "law = \"springpot\"\nparameters = { c = 9, alpha = 0.5 }", "", TIME)));
    let expected = Complex64::from_polar(4.5f64.powf(1.0 / 1.5), PI / 1.5);
    assert!((alone.modes[0].eigenvalue - expected).norm() < 1e-12, "{alone:?}");
    assert_eq!(alone.free_motions, 1);
}

#[test]
fn the_number_is_that_of_the_argument() {
    let laws = [
        "law = \"springpot\"\nparameters = { c = 9, alpha = 0.3 }",
        "law = \"fractional-zener\"\nparameters = { k_e = 40, k_m = 200, c = 15, alpha = 0.7 }",
        "law = \"fractional-burgers\"\nparameters = { k_1 = 90, c_1 = 60, alpha_1 = 0.9, k_2 = 30, c_2 = 5, alpha_2 = 0.2 }",
        "law = \"kelvin-voigt\"\nparameters = { k = 30, c = 4 }",
        "law = \"fractional-kelvin-voigt\"\nparameters = { k = 60, c = 300, alpha = 0.95 }",
        "law = \"zener\"\nparameters = { k_e = 40, k_m = 20, c = 5 }",
    ];
    let mut count = 0;
    for first in laws {
        for second in laws {
            for third in laws {
                let text = arm(&on_joints([first, second, third]), "start = { q = { q2 = 0.3, q3 = 0.4 } }");
                let modes = modes(&system(&text));
                // `modes` has compared the counts; whatever is overdamped, three bodies have six eigenvalues or more.
                let all: usize = modes.modes.iter().map(|mode| if mode.eigenvalue.im > 0.0 { 2 } else { 1 }).sum();
                assert!(all >= 6 && modes.modes.iter().all(|mode| !mode.is_unstable()), "{modes:?}\n{text}");
                count += 1;
            }
        }
    }
    assert_eq!(count, 216);
}

#[test]
fn what_no_springpot_reaches_stays_on_the_axis() {
    // Two sliders on the world, one with a springpot and one without, which is overdamped: s² + 20 s/2 + 32/2.
    let own = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 50, c = 3, alpha = 0.5 }";
    let other = "[[robot.body]]\nname = \"c\"\nparent = \"world\"\nmass = 2\n\
                 joint = { name = \"y\", kind = \"prismatic\", axis = [0, 1, 0], origin = [0, 0, 0] }\n\
                 [[element]]\nname = \"f\"\njoint = \"y\"\nlaw = \"kelvin-voigt\"\nparameters = { k = 32, c = 20 }\n";
    let text =
        slider(2.0, own, "", TIME).replace("[[element]]\nname = \"e\"", &format!("{other}[[element]]\nname = \"e\""));
    let modes = modes(&system(&text));
    let values: Vec<Complex64> = modes.modes.iter().map(|mode| mode.eigenvalue).collect();
    assert_eq!((values.len(), modes.counted), (3, Some(2)), "{modes:?}");
    let expected = [Complex64::from(-2.0), root(2.0, 3.0, 50.0, 0.5), Complex64::from(-8.0)];
    assert!(values.iter().zip(expected).all(|(s, e)| (s - e).norm() < 1e-11 * e.norm()), "{values:?}");
}
