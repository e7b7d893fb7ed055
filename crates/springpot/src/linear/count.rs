//! How many zeros of the determinant lie in the plane cut along the negative axis, by the principle of the argument.

use super::pencil::Pencil;
use crate::linalg::ComplexLu;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// How far from the cut, rad.
pub(super) const BESIDE: f64 = 1e-6;
/// Halvings of a piece of the way.
const MOST_HALVINGS: u32 = 60;
const PIECES: usize = 64;

/// A place on the way.
#[derive(Clone, Copy)]
struct At {
    place: f64,
    phase: f64,
    rate: f64,
}

/// Zeros with `from` < |s| < `to` and |arg s| < π − [`BESIDE`]; `None` where the phase cannot be followed. The way along the cut stops where it
/// passes the zeros `beside` it, whose |s| these are: two quick turns in one piece would not be seen.
///
/// Along the upper half of the edge the phase of det T turns by π for every zero inside, since it does the opposite along the lower half.
pub(super) fn count(pencil: &Pencil, (from, to): (f64, f64), beside: &[f64]) -> Option<usize> {
    let theta = PI - BESIDE;
    let (low, high) = (from.ln(), to.ln());
    let arc = |radius: f64, angle: f64| Complex64::from_polar(radius, angle);
    let outer = follow(pencil, &[], &|u| (arc(to, u * theta), Complex64::I * theta * arc(to, u * theta)))?;
    let along = |u: f64| arc((high + u * (low - high)).exp(), theta);
    let passed: Vec<f64> = beside.iter().map(|radius| (high - radius.ln()) / (high - low)).collect();
    let cut = follow(pencil, &passed, &|u| (along(u), (low - high) * along(u)))?;
    let inner = follow(pencil, &[], &|u| {
        let s = arc(from, (1.0 - u) * theta);
        (s, -Complex64::I * theta * s)
    })?;
    let turns = (outer + cut + inner) / PI;
    let whole = turns.round();
    ((turns - whole).abs() < 0.05 && whole >= 0.0).then_some(whole as usize)
}

/// By how much the phase turns on the way from u = 0 to 1, which tells s and ds/du; it is looked at where `passed` says.
fn follow(pencil: &Pencil, passed: &[f64], way: &dyn Fn(f64) -> (Complex64, Complex64)) -> Option<f64> {
    let look = |place: f64| {
        let (s, direction) = way(place);
        let [value, slope] = pencil.at(s);
        let (n, lu) = (pencil.size, ComplexLu::new(pencil.size, value));
        // d ln det T/ds = tr T⁻¹ T'.
        let column = |c: usize| (0..n).map(|r| slope[r * n + c]).collect::<Vec<_>>();
        let trace: Complex64 = (0..n).map(|c| lu.solve(&column(c))[c]).sum();
        At { place, phase: lu.phase(), rate: (trace * direction).im }
    };
    let mut turned = 0.0;
    let even = (1..=PIECES).map(|piece| piece as f64 / PIECES as f64);
    let mut places: Vec<f64> = even.chain(passed.iter().copied().filter(|u| (0.0..1.0).contains(u))).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| *a - *b < 1e-9);
    let mut before = look(0.0);
    for place in places {
        let after = look(place);
        turned += between(&look, before, after, MOST_HALVINGS)?;
        before = after;
    }
    Some(turned)
}

fn between(look: &dyn Fn(f64) -> At, a: At, b: At, halvings: u32) -> Option<f64> {
    let turned = (b.phase - a.phase + PI).rem_euclid(TAU) - PI;
    let expected = 0.5 * (a.rate + b.rate) * (b.place - a.place);
    if turned.abs() < 1.0 && (turned - expected).abs() < 0.3 {
        return Some(turned);
    }
    if halvings == 0 {
        return None;
    }
    let middle = look(0.5 * (a.place + b.place));
    Some(between(look, a, middle, halvings - 1)? + between(look, middle, b, halvings - 1)?)
}
