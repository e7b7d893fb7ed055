//! What spoils the order that a force along a stroke tells, and what mends it.

use crate::support::{Found, Noise, Place, found, pad, rows_of};
use springpot::observe::{ElementQuantity, Quantity};
use std::fmt::Write as _;

/// F = 1000 x + 300 D^0.3 x.
const ALPHA: f64 = 0.3;
const SWEPT: &str = "5e-3*sin(2*pi*(0.2*t + 0.4*t^2))";

/// Times, and stroke and force of a pad that was at rest before t = 0 and moves as an expression says.
fn moved(stroke: &str, times: &[f64]) -> Vec<[f64; 2]> {
    let end = times[times.len() - 1];
    let text = format!(
        "[[robot.body]]\nname = \"end\"\njoint = {{ name = \"x\", kind = \"prismatic\", axis = [1, 0, 0] }}\nmass = 1\n\
         [[element]]\nname = \"pad\"\njoint = \"x\"\nlaw = \"fractional-kelvin-voigt\"\n\
         parameters = {{ k = 1000, c = 300, alpha = {ALPHA} }}\n\
         [motion]\nkind = \"prescribed\"\njoints = {{ x = \"{stroke}\" }}\n[time]\nend = {end}\noutput_step = {end}\n"
    );
    let quantities = [Quantity::Coordinate(0), Quantity::Element(0, ElementQuantity::Force)];
    rows_of(&Place::new(), &text, &quantities, times).into_iter().map(|row| [row[0], row[1]]).collect()
}

/// Times that are 8 ms apart over six seconds, from `first` on.
fn times(first: f64) -> Vec<f64> {
    (0..750).map(|row| first + 8e-3 * f64::from(row)).collect()
}

/// Alpha of these rows of t, stroke and force, with and without what mends it.
fn alphas(rows: &[[f64; 3]], mended: &str) -> [Found; 2] {
    let place = Place::new();
    let mut text = "t,x,F\n".to_owned();
    rows.iter().for_each(|[t, x, force]| _ = writeln!(text, "{t},{x},{force}"));
    place.write("rows.csv", &text);
    let law = pad("law = \"fractional-kelvin-voigt\"", &[("k", 600.0), ("c", 500.0), ("alpha", 0.45)]);
    let data = "[[data]]\nname = \"loops\"\nkind = \"stroke\"\nelement = \"pad\"\ncsv = \"rows.csv\"\n\
                columns = { stroke = \"x\", force = \"F\" }\n";
    [mended, ""].map(|more| found(&place.fit(&format!("{law}{data}{more}[fit]\nstarts = 1\n")), "alpha"))
}

/// Within two standard deviations with what mends it, `off` without it.
fn is_mended([mended, plain]: [Found; 2], off: f64) {
    let Found { value, sd, .. } = mended;
    println!("{value:.5} ± {sd:.1e}, plain {:.4} ± {:.1e}", plain.value, plain.sd);
    assert!((value - ALPHA).abs() < 2.0 * sd && sd < 0.01, "{value} ± {sd}");
    assert!((plain.value - ALPHA).abs() > off, "{} and nothing to mend", plain.value);
}

/// A sweep from 0.2 to 5 Hz, whose force is 2 ms late and has an unknown zero.
#[test]
fn a_force_that_is_late_with_an_unknown_zero() {
    let at = times(0.0);
    let late: Vec<f64> = at.iter().map(|t| (t - 2e-3).max(0.0)).collect();
    let mut noise = Noise(61);
    let (now, then) = (moved(SWEPT, &at), moved(SWEPT, &late));
    let rows: Vec<[f64; 3]> = at
        .iter()
        .zip(now.iter().zip(&then))
        .map(|(t, ([x, _], [_, force]))| [*t, *x, force + 2.0 + 0.03 * noise.normal()])
        .collect();
    is_mended(alphas(&rows, "offset = \"force\"\ndelay = \"force\"\n"), 0.12);
}

/// Three sines that have gone on for eight seconds when the record begins.
#[test]
fn a_record_from_the_middle_of_a_motion() {
    let stroke = "5e-3*(sin(2*pi*0.31*t) + 0.6*sin(2*pi*0.97*t + 1) + 0.3*sin(2*pi*2.3*t + 2))";
    let at = times(8.0);
    let mut noise = Noise(62);
    let mut all = vec![0.0];
    all.extend(&at);
    let rows: Vec<[f64; 3]> = at
        .iter()
        .zip(&moved(stroke, &all)[1..])
        .map(|(t, [x, force])| [t - 8.0, *x, force + 0.02 * noise.normal()])
        .collect();
    is_mended(alphas(&rows, "past = \"free\"\n"), 0.25);
}

/// One row of twenty is off by up to 20 N, and the zero of the force is not known.
#[test]
fn outliers() {
    let at = times(0.0);
    let mut noise = Noise(63);
    let rows: Vec<[f64; 3]> = at
        .iter()
        .zip(moved(SWEPT, &at))
        .map(|(t, [x, force])| {
            let wild = if noise.share() < 0.05 { 20.0 * noise.share() } else { 0.0 };
            [*t, x, force + wild + 0.05 * noise.normal()]
        })
        .collect();
    is_mended(alphas(&rows, "loss = { huber = 1.345 }\noffset = \"force\"\n"), 0.06);
}
