//! First harmonics of laws that are not linear: closed forms, and the steady loops of runs.

use crate::jenkins::{cut, sine};
use crate::{along, force, slider};
use springpot::law::leaf::{BoucWen, Friction, Jenkins, Polynomial, Stop};
use springpot::law::{Derivative, Network, NetworkText, Point};
use std::f64::consts::{PI, TAU};

const AT: Point<'static> = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };

fn departure(found: Option<[f64; 2]>, exact: [f64; 2]) -> f64 {
    let found = found.expect("a steady turn");
    (found[0] - exact[0]).hypot(found[1] - exact[1]) / exact[0].hypot(exact[1])
}

/// K' and K'' of forces at the middles of equal shares of a turn: right to 1/N² at kinks.
fn of_turn(amplitude: f64, count: usize, force: impl Fn(f64) -> f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for k in 0..count {
        let phase = TAU * (k as f64 + 0.5) / count as f64;
        let (sine, cosine) = phase.sin_cos();
        let force = force(phase);
        sums[0] += force * sine;
        sums[1] += force * cosine;
    }
    sums.map(|sum| 2.0 * sum / (count as f64 * amplitude))
}

#[test]
fn springs_that_slip_have_caugheys_stiffness() {
    let (k, yields) = (2e4, 12.0);
    let law = Network::leaf(Jenkins::new(k, yields).unwrap());
    for amplitude in [1e-4, 6e-4, 6.1e-4, 1e-3, 1e-2, 1.0] {
        let found = law.first_harmonic(&AT, amplitude, 3.0);
        let exact = of_turn(amplitude, 1_000_000, |phase| cut(k, yields, sine(amplitude, 1.0, phase + 4.0 * PI))[0]);
        assert!(departure(found, exact) < 1e-9, "{amplitude}: {found:?} {exact:?}");
        // What a turn loses is what slips.
        let turn = [2, 4].map(|turns| cut(k, yields, sine(amplitude, 1.0, PI * f64::from(turns)))[1]);
        let lost = PI * found.unwrap()[1] * amplitude * amplitude;
        assert!((lost - (turn[1] - turn[0])).abs() < 1e-12 * yields * amplitude, "{amplitude}: {lost} {turn:?}");
    }
}

#[test]
fn sums_are_closed_forms() {
    let (k, c, alpha, omega) = (3e4, 900.0, 0.3, 40.0f64);
    let fillers = [[4e4, 6.0], [2e4, 15.0], [1e4, 40.0]];
    let coefficients = [500.0, 2e5, 3e9];
    let slips = fillers.map(|[k, yields]| Network::leaf(Jenkins::new(k, yields).unwrap()));
    let springs = [
        Network::spring(k),
        Network::springpot(c, alpha, Derivative::Caputo),
        Network::leaf(Polynomial { coefficients: coefficients.map(Into::into) }),
        Network::series([Network::spring(800.0), Network::dashpot(20.0)]),
    ];
    let law = Network::parallel(springs.into_iter().chain(slips));
    for amplitude in [1e-5, 1e-3, 7e-3] {
        let maxwell = 800.0 * 20.0 * omega / (800.0f64.powi(2) + (20.0 * omega).powi(2));
        let angle = 0.5 * PI * alpha;
        let mut exact = [
            k + c * omega.powf(alpha) * angle.cos()
                + coefficients[0]
                + 0.75 * coefficients[2] * amplitude * amplitude
                + maxwell * 20.0 * omega,
            c * omega.powf(alpha) * angle.sin() + maxwell * 800.0,
        ];
        for [k, yields] in fillers {
            let share = yields / k / amplitude;
            let back = (1.0 - 2.0 * share).max(-1.0).acos();
            exact[0] += k / PI * (back - 0.5 * (2.0 * back).sin());
            exact[1] += if share < 1.0 { 4.0 * yields / (PI * amplitude) * (1.0 - share) } else { 0.0 };
        }
        let found = law.first_harmonic(&AT, amplitude, omega);
        assert!(departure(found, exact) < 1e-12, "{amplitude}: {found:?} {exact:?}");
    }
    // About another place a cubic is another spring.
    let cubic = Network::leaf(Polynomial { coefficients: [0.0, 0.0, 7.0].map(Into::into) });
    let found = cubic.first_harmonic(&Point { stroke: 0.2, ..AT }, 0.1, 1.0);
    assert!(departure(found, [7.0 * (3.0 * 0.04 + 0.75 * 0.01), 0.0]) < 1e-13);
}

#[test]
fn what_follows_from_one_time_is_integrated_between_its_kinks() {
    // A stop at ±a: 2k/π (ϑ − sin ϑ cos ϑ), cos ϑ = a/A; friction that turns over fast: 4f/(πA).
    let stop = Network::leaf(Stop::new(50.0, -0.03, 0.03).unwrap());
    let angle = (0.3f64).acos();
    let exact = 100.0 / PI * (angle - 0.3 * angle.sin());
    assert!(departure(stop.first_harmonic(&AT, 0.1, 2.0), [exact, 0.0]) < 1e-12);
    assert_eq!(stop.first_harmonic(&AT, 0.02, 2.0), Some([0.0, 0.0]));
    let friction = Network::leaf(Friction::new(3.0, 1e-6).unwrap());
    assert!(departure(friction.first_harmonic(&AT, 0.1, 2.0), [0.0, 4.0 * 3.0 / (PI * 0.1)]) < 1e-9);
    let gentle = Network::leaf(Friction::new(3.0, 1e3).unwrap());
    assert!(departure(gentle.first_harmonic(&AT, 0.1, 2.0), [0.0, 3.0 / 1e3 * 2.0]) < 1e-7);
}

#[test]
fn what_has_a_state_is_driven_until_it_is_steady() {
    let network = |text: &str, values: &[f64]| {
        NetworkText::parse(text).unwrap().entry().build(values, Derivative::Caputo).unwrap()
    };
    let (omega, amplitude) = (6.0, 0.1);
    let (turn, turns, rows) = (TAU / omega, 12.0, 400);
    for law in [
        Network::leaf(BoucWen::new(50.0, 1.0, 100.0, 250.0, 2.0).unwrap()),
        network("series(spring(k), friction(f, v))", &[200.0, 5.0, 0.1]),
        network("series(polynomial(k, z, c), dashpot(d))", &[100.0, 0.0, 2e4, 12.0]),
        network("series(tension(k), parallel(spring(s), dashpot(d)))", &[300.0, 40.0, 9.0]),
    ] {
        let found = law.first_harmonic(&AT, amplitude, omega).unwrap_or_else(|| panic!("no steady turn: {law:?}"));
        // The last turn of a run from rest, by the rows in it.
        let motion = along(&format!("{amplitude}*sin({omega}*t)"));
        let run = slider(std::slice::from_ref(&law), &motion, turns * turn, rows * turns as usize, 1e-9);
        let force = force(&run);
        let last = &force[force.len() - 1 - rows..];
        let mut sums = [0.0; 2];
        for (k, force) in last.iter().enumerate() {
            let (sine, cosine) = (TAU * k as f64 / rows as f64).sin_cos();
            let weight = if k == 0 || k == rows { 0.5 } else { 1.0 };
            sums[0] += weight * force * sine;
            sums[1] += weight * force * cosine;
        }
        let exact = sums.map(|sum| 2.0 * sum / (rows as f64 * amplitude));
        let off = departure(Some(found), exact);
        assert!(off < 1e-4, "{off:e}: {found:?} {exact:?} {law:?}");
    }
    // A springpot behind a spring that is hardly bent: linear in the limit, though told no formula.
    let bent = network("series(polynomial(k, z, c), springpot(d, a))", &[100.0, 0.0, 1e-6, 30.0, 0.5]);
    let linear = network("series(spring(k), springpot(d, a))", &[100.0, 30.0, 0.5]);
    let exact = linear.first_harmonic(&AT, amplitude, omega).unwrap();
    assert_eq!(exact, linear.complex_modulus(&AT, omega));
    let off = departure(bent.first_harmonic(&AT, amplitude, omega), exact);
    assert!(off < 1e-7, "{off:e}");
}
