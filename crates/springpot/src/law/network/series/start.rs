//! Who takes the stroke at t = 0.

use super::{ENOUGH, MOST_HALVINGS, MOST_ITERATIONS, Series};
use crate::fractional::{KernelError, Kind as Derivative, Memory};
use crate::law::network::Network;
use crate::law::network::part::{Onset, Part};
use crate::law::past::Recalled;
use crate::law::state::{State, StateMut};
use crate::law::step::{Point, Start};
use num_complex::Complex64;

/// The strokes of the parts at t = 0, and the parts' own states.
pub(super) fn begin(parts: &[Network], start: &Start, state: &mut State) -> Result<(), KernelError> {
    // What was held since ever has relaxed; what begins at t = 0 has not.
    let onset = match parts.iter().find_map(|part| derivative(part, start)) {
        Some(Derivative::RiemannLiouville) => Onset::Short,
        None if start.jump != 0.0 => Onset::Short,
        Some(Derivative::Caputo) | None => Onset::Long,
    };
    let at = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: start.inputs };
    let Shares { of_parts, order, is_limp } = shares(parts, &at, onset);
    let mut strokes: Vec<f64> = of_parts.iter().map(|share| share * start.stroke).collect();
    if order == 0.0 && !is_limp {
        let holding: Vec<usize> = (0..parts.len()).filter(|&k| of_parts[k] != 0.0).collect();
        balance(parts, &holding, start, &mut strokes)?;
    }
    strokes.iter().for_each(|stroke| state.push_variable(*stroke));
    let first = state.memories().len();
    for (k, part) in parts.iter().enumerate() {
        part.ask().begin(&Start { stroke: strokes[k], jump: of_parts[k] * start.jump, ..*start }, state)?;
    }
    if onset == Onset::Short && start.jump != 0.0 {
        state.memories_mut()[first..].iter_mut().for_each(Memory::lose_account);
    }
    Ok(())
}

/// How the parts share a stroke.
struct Shares {
    of_parts: Vec<f64>,
    /// The order of the parts that take some.
    order: f64,
    /// Whether a part gives no force at all.
    is_limp: bool,
}

/// What share of a stroke each part takes at once, or at last.
fn shares(parts: &[Network], at: &Point, onset: Onset) -> Shares {
    let terms: Vec<_> = parts.iter().map(|part| part.ask().asymptote(at, onset)).collect();
    let softer = |a: f64, b: f64| if onset == Onset::Short { a < b } else { a > b };
    let order = terms.iter().map(|term| term.order).reduce(|a, b| if softer(b, a) { b } else { a }).unwrap_or(0.0);
    let compliance = |k: usize| if terms[k].order == order { terms[k].coefficient.recip() } else { 0.0 };
    let whole: f64 = (0..parts.len()).map(compliance).sum();
    // Where a part gives no force at all, the first of them takes everything.
    let limp = (0..parts.len()).find(|&k| compliance(k).is_infinite());
    let share = |k: usize| limp.map_or(compliance(k) / whole, |limp| f64::from(u8::from(k == limp)));
    Shares { of_parts: (0..parts.len()).map(share).collect(), order, is_limp: limp.is_some() }
}

/// Moves the strokes of the parts that hold at rest to where all have one force: what is not linear, or gives a force at x = 0, shares
/// differently.
fn balance(parts: &[Network], holding: &[usize], start: &Start, strokes: &mut [f64]) -> Result<(), KernelError> {
    let rest = |part: &Network, stroke: f64| -> Result<[f64; 2], KernelError> {
        let mut state = State::default();
        part.ask().begin(&Start { stroke, jump: 0.0, ..*start }, &mut state)?;
        let at = Point { t: 0.0, stroke, rate: 0.0, inputs: start.inputs };
        let force = part.ask().now(&at, &mut state.view(), &mut |_| ()).observation.regular;
        Ok([force, part.ask().asymptote(&at, Onset::Long).coefficient])
    };
    let (mut from, mut apart_before, mut halvings) = (strokes.to_vec(), f64::INFINITY, 0);
    for _ in 0..MOST_ITERATIONS {
        let known = holding.iter().map(|&k| rest(&parts[k], strokes[k])).collect::<Result<Vec<_>, _>>()?;
        let (low, high) =
            known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [f, _]| (low.min(*f), high.max(*f)));
        if high - low <= ENOUGH * low.abs().max(high.abs()) {
            return Ok(());
        }
        if high - low >= apart_before && halvings < MOST_HALVINGS {
            halvings += 1;
            strokes.iter_mut().zip(&from).for_each(|(stroke, from)| *stroke = 0.5 * (*stroke + from));
            continue;
        }
        (apart_before, halvings) = (high - low, 0);
        from.copy_from_slice(strokes);
        let compliance: f64 = known.iter().map(|[_, slope]| slope.recip()).sum();
        let whole = known.iter().map(|[force, slope]| force / slope).sum::<f64>() / compliance;
        for (&k, [force, slope]) in holding.iter().zip(&known) {
            strokes[k] += (whole - force) / slope;
        }
    }
    Ok(())
}

/// The derivative that the first springpot takes.
fn derivative(part: &Network, start: &Start) -> Option<Derivative> {
    let mut state = State::default();
    part.ask().begin(start, &mut state).ok()?;
    state.memories().first().map(Memory::kind)
}

/// The strokes of the parts under a stroke made of exponentials: all have one force at each of them.
pub(super) fn recall(series: &Series, whole: &Recalled, at: &Point, state: &mut StateMut) {
    let parts = series.parts();
    let mut inner: Vec<Vec<[Complex64; 2]>> = vec![Vec::new(); parts.len()];
    let rest = shares(parts, at, Onset::Long).of_parts;
    for &[s, stroke] in whole.exponentials() {
        let compliances: Vec<Complex64> = parts.iter().map(|part| part.modulus(at, s).inv()).collect();
        let compliance: Complex64 = compliances.iter().sum();
        for (inner, own) in inner.iter_mut().zip(compliances) {
            inner.push([s, own / compliance * stroke]);
        }
    }
    let strokes = state.take(series.own_size()).variables;
    for (k, (part, (exponentials, stroke))) in parts.iter().zip(inner.into_iter().zip(strokes)).enumerate() {
        let own = whole.with(rest[k] * whole.mean(), exponentials);
        *stroke = own.stroke(0.0);
        part.ask().recall(&own, at, state);
    }
}
