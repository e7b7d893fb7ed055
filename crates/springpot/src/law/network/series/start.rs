//! Who takes the stroke at t = 0.

use super::solve::SLIPPING;
use super::{ENOUGH, MOST_HALVINGS, MOST_ITERATIONS, MOST_SECANTS, Play, Series};
use crate::fractional::{KernelError, Kind as Derivative, Memory};
use crate::law::network::Network;
use crate::law::network::part::{Onset, Part, Reported, Take};
use crate::law::past::Recalled;
use crate::law::state::{State, StateMut, StateRef};
use crate::law::step::{Point, Start, Term};
use num_complex::Complex64;

/// The strokes of the parts at t = 0, and the parts' own states. A play takes what it can for free.
pub(super) fn begin(series: &Series, start: &Start, state: &mut State) -> Result<(), KernelError> {
    let parts = series.parts();
    // What was held since ever has relaxed; what begins at t = 0 has not.
    let onset = match parts.iter().find_map(|part| derivative(part, start)) {
        Some(Derivative::RiemannLiouville) => Onset::Short,
        None if start.jump != 0.0 || series.is_unloaded => Onset::Short,
        Some(Derivative::Caputo) | None => Onset::Long,
    };
    if let Some(rest) = (onset == Onset::Long).then(|| relaxed(series, start)).transpose()?.flatten() {
        return begin_at(series, &rest, start, state);
    }
    let free = series.play().map_or(0.0, |play| play.free(start.stroke));
    let left = start.stroke - free;
    let at = Point { t: 0.0, stroke: left, rate: 0.0, inputs: start.inputs };
    let Shares { of_parts, order, is_limp } = shares(series, &at, onset);
    let holding: Vec<usize> = (0..parts.len()).filter(|&k| of_parts[k] != 0.0 && !series.lets_go(k)).collect();
    let place = |share: f64| -> Result<Placed, KernelError> {
        let mut strokes: Vec<f64> = of_parts.iter().map(|own| own * left * share).collect();
        let mut play = series.play().map(|play| free + play.stroke(|k| strokes[k]));
        if order == 0.0 && !is_limp {
            balance(series, &holding, start, &mut strokes, &mut play)?;
        }
        Ok((strokes, play))
    };
    // Friction gives way to what jumps at once, until no more than it can hold is left.
    let slides = (0..parts.len()).find(|&k| series.slides(k)).filter(|_| onset == Onset::Short && start.jump != 0.0);
    let share = match slides {
        Some(_) if order > 0.0 => 0.0,
        Some(_) => {
            let most = parts.iter().filter_map(|part| part.ask().slides(start.inputs)).map(|slide| slide.force);
            let most = most.fold(f64::INFINITY, f64::min);
            let force = |share: f64| -> Result<f64, KernelError> {
                let (strokes, play) = place(share)?;
                Ok(match (series.play().zip(play), holding.first()) {
                    (Some((play, x)), _) => play.force(x),
                    (None, Some(&k)) => at_rest(&parts[k], strokes[k], start)?[0],
                    (None, None) => 0.0,
                })
            };
            largest_share(|share| Ok(force(share)?.abs() <= most))?
        }
        None => 1.0,
    };
    let (mut strokes, play) = place(share)?;
    if let Some((play, x)) = series.play().zip(play) {
        let side = play.side(x, 0.0).unwrap_or(0);
        let own = play.spread(x, play.force(x), side);
        (0..parts.len()).filter(|k| play.has(*k)).for_each(|k| strokes[k] = own[k]);
    }
    if let Some(k) = slides {
        strokes[k] += left * (1.0 - share);
    }
    strokes.iter().for_each(|stroke| state.push_variable(*stroke));
    if series.play().is_some() {
        state.push_variable(0.0);
    }
    let jump = if start.stroke == 0.0 { 0.0 } else { start.jump * (left / start.stroke) * share };
    let first = state.memories().len();
    for (k, part) in parts.iter().enumerate() {
        part.ask().begin(&Start { stroke: strokes[k], jump: of_parts[k] * jump, ..*start }, state)?;
    }
    if onset == Onset::Short && jump != 0.0 {
        state.memories_mut()[first..].iter_mut().for_each(Memory::lose_account);
    }
    Ok(())
}

/// Begins the parts at these strokes, at rest.
fn begin_at(series: &Series, strokes: &[f64], start: &Start, state: &mut State) -> Result<(), KernelError> {
    strokes.iter().for_each(|stroke| state.push_variable(*stroke));
    if series.play().is_some() {
        state.push_variable(0.0);
    }
    let mut parts = series.parts().iter().zip(strokes);
    parts.try_for_each(|(part, &stroke)| part.ask().begin(&Start { stroke, jump: 0.0, ..*start }, state))
}

/// The strokes of the parts held since ever, where some part gives a force that was not stretched and another flows: what flows has flowed till
/// it carries no more than it does at rest, and the others have that force too. Nothing where no part gives such a force, or none flows.
fn relaxed(series: &Series, start: &Start) -> Result<Option<Vec<f64>>, KernelError> {
    let parts = series.parts();
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: start.inputs };
    let Shares { of_parts, order, .. } = shares(series, &at, Onset::Long);
    if order == 0.0 {
        return Ok(None);
    }
    let unstretched = |k: usize| match series.is_free(k) {
        true => Ok(0.0),
        false => at_rest(&parts[k], 0.0, start).map(|[force, _]| force),
    };
    let forces = (0..parts.len()).map(unstretched).collect::<Result<Vec<_>, _>>()?;
    if forces.iter().all(|force| *force == 0.0) {
        return Ok(None);
    }
    // What flows is at rest under Σ (F − F_m)/c_m = 0; a play that cannot carry that stays slack.
    let flowing = of_parts.iter().zip(&forces).map(|(share, own)| share * own).sum::<f64>();
    let carries = |play: &Play| flowing == 0.0 || play.end(if flowing > 0.0 { 1 } else { -1 }).is_finite();
    let force = if series.play().is_none_or(carries) { flowing } else { 0.0 };
    let mut strokes = vec![0.0; parts.len()];
    for k in (0..parts.len()).filter(|&k| !series.lets_go(k) && of_parts[k] == 0.0) {
        strokes[k] = stroke_under(&parts[k], force, start)?;
    }
    let mut left = start.stroke - strokes.iter().sum::<f64>();
    if let Some(play) = series.play() {
        let side = i8::from(force > 0.0) - i8::from(force < 0.0);
        let x = if side == 0 { play.free(left) } else { play.end(side) + force / play.stiffness() };
        let own = play.spread(x, force, side);
        (0..parts.len()).filter(|k| play.has(*k)).for_each(|k| strokes[k] = own[k]);
        left -= x;
    }
    strokes.iter_mut().zip(&of_parts).for_each(|(stroke, share)| *stroke += share * left);
    Ok(Some(strokes))
}

/// The stroke at which a part at rest has the force `force`, which grows with it.
fn stroke_under(part: &Network, force: f64, start: &Start) -> Result<f64, KernelError> {
    let (mut x, mut low, mut high) = (0.0f64, f64::NEG_INFINITY, f64::INFINITY);
    for _ in 0..MOST_SECANTS {
        let [own, slope] = at_rest(part, x, start)?;
        let missing = force - own;
        match missing {
            0.0 => break,
            missing if missing > 0.0 => low = x,
            _ => high = x,
        }
        let newton = x + missing / slope;
        let next = match low + high {
            _ if low < newton && newton < high => newton,
            both if both.is_finite() => 0.5 * both,
            // Flat where it is not stretched.
            _ if x == 0.0 => FIRST.copysign(missing),
            _ => 2.0 * x,
        };
        let is_there = (next - x).abs() <= 2.0 * f64::EPSILON * next.abs();
        x = next;
        if is_there {
            break;
        }
    }
    Ok(x)
}

/// The first stroke that is looked at where a force is flat, m.
const FIRST: f64 = 1e-9;

/// Strokes of parts, and of a play.
type Placed = (Vec<f64>, Option<f64>);

/// The largest share, up to 1, that holds.
fn largest_share(mut holds: impl FnMut(f64) -> Result<bool, KernelError>) -> Result<f64, KernelError> {
    if holds(1.0)? {
        return Ok(1.0);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..MOST_BISECTIONS {
        let middle = 0.5 * (low + high);
        if holds(middle)? { low = middle } else { high = middle }
    }
    Ok(low)
}

/// Halvings that find a share to the last bit.
const MOST_BISECTIONS: usize = 60;

/// The force of a part that is at rest at `stroke`, and its slope.
fn at_rest(part: &Network, stroke: f64, start: &Start) -> Result<[f64; 2], KernelError> {
    let mut state = State::default();
    part.ask().begin(&Start { stroke, jump: 0.0, ..*start }, &mut state)?;
    let at = Point { t: 0.0, stroke, rate: 0.0, inputs: start.inputs };
    let force = part.ask().now(&at, &mut state.view(), &mut |_| ()).observation.regular;
    let slope = match part {
        // What slips yields, though not without end.
        Network::Leaf(leaf) if leaf.slips().is_some_and(|own| force.abs() >= own.limit()) => SLIPPING,
        _ => 1.0,
    };
    Ok([force, slope * part.ask().asymptote(&at, Onset::Long).coefficient])
}

/// What is slack counts as this soft, in units of the stiffest part.
const SOFTEST: f64 = 1e-30;

/// How the parts share a stroke.
pub(super) struct Shares {
    pub(super) of_parts: Vec<f64>,
    /// The order of the parts that take some.
    order: f64,
    /// Whether a part gives no force at all.
    is_limp: bool,
}

/// What share of a stroke each part takes at once, or at last; a play as the spring that it is where it is engaged.
pub(super) fn shares(series: &Series, at: &Point, onset: Onset) -> Shares {
    let parts = series.parts();
    let term = |(k, part): (usize, &Network)| match series.play() {
        Some(play) if play.has(k) => Term { coefficient: play.stiffness_of(k), order: 0.0 },
        _ => part.ask().asymptote(at, onset),
    };
    let terms: Vec<_> = parts.iter().enumerate().map(term).collect();
    let softer = |a: f64, b: f64| if onset == Onset::Short { a < b } else { a > b };
    let order = terms.iter().map(|term| term.order).reduce(|a, b| if softer(b, a) { b } else { a }).unwrap_or(0.0);
    let compliance = |k: usize| if terms[k].order == order { terms[k].coefficient.recip() } else { 0.0 };
    let whole: f64 = (0..parts.len()).map(compliance).sum();
    // Where a part gives no force at all, the first of them takes everything.
    let limp = (0..parts.len()).find(|&k| compliance(k).is_infinite());
    let share = |k: usize| limp.map_or(compliance(k) / whole, |limp| f64::from(u8::from(k == limp)));
    Shares { of_parts: (0..parts.len()).map(share).collect(), order, is_limp: limp.is_some() }
}

/// Moves the strokes of the parts that hold at rest, and of a play, to where all have one force: what is not linear, or gives a force at x = 0,
/// shares differently.
fn balance(
    series: &Series,
    holding: &[usize],
    start: &Start,
    strokes: &mut [f64],
    play: &mut Option<f64>,
) -> Result<(), KernelError> {
    let parts = series.parts();
    let (mut from, mut apart_before, mut halvings) = ((strokes.to_vec(), *play), f64::INFINITY, 0);
    for _ in 0..MOST_ITERATIONS {
        let mut known =
            holding.iter().map(|&k| at_rest(&parts[k], strokes[k], start)).collect::<Result<Vec<_>, _>>()?;
        if let Some((own, x)) = series.play().zip(*play) {
            let force = own.force(x);
            // What is slack yields, though not without end.
            let slack = SOFTEST * known.iter().fold(own.stiffness(), |most, [_, slope]| most.max(*slope));
            known.push([force, if force == 0.0 { slack } else { own.stiffness() }]);
        }
        let (low, high) =
            known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [f, _]| (low.min(*f), high.max(*f)));
        if high - low <= ENOUGH * low.abs().max(high.abs()) {
            return Ok(());
        }
        if high - low >= apart_before && halvings < MOST_HALVINGS {
            halvings += 1;
            strokes.iter_mut().zip(&from.0).for_each(|(stroke, from)| *stroke = 0.5 * (*stroke + from));
            *play = play.zip(from.1).map(|(x, from)| 0.5 * (x + from));
            continue;
        }
        (apart_before, halvings) = (high - low, 0);
        from = (strokes.to_vec(), *play);
        let compliance: f64 = known.iter().map(|[_, slope]| slope.recip()).sum();
        let whole = known.iter().map(|[force, slope]| force / slope).sum::<f64>() / compliance;
        let mut longer = known.iter().map(|[force, slope]| (whole - force) / slope);
        for (&k, longer) in holding.iter().zip(longer.by_ref()) {
            strokes[k] += longer;
        }
        if let Some((x, longer)) = play.as_mut().zip(longer.next()) {
            *x += longer;
        }
    }
    Ok(())
}

/// Behind a jump at t = 0: by how much the force of each leaf of a part is more than its memory knows, so that the part has the force `whole`.
/// Springs and dashpots have what their strokes and rates say; what is left is the springpots'. Empty where nothing is.
pub(super) fn owed(part: &Network, at: &Point, whole: f64, state: &StateRef) -> Vec<f64> {
    let known = part.ask().now(at, &mut state.clone(), &mut |_| ()).observation.force();
    let (missing, mut shares) = (whole - known, Vec::new());
    // No number where the force is infinite.
    if missing.abs() > KNOWN * whole.abs() && part.ask().size().memories > 0 {
        share_out(part, at, missing, &mut shares);
    }
    shares
}

/// How well forces of parts at rest are known to be one.
const KNOWN: f64 = 1e-10;

/// The share of each leaf in a force that is there at once: parts side by side leave it to those of the highest order, one behind the other
/// all have it.
fn share_out(part: &Network, at: &Point, force: f64, shares: &mut Vec<f64>) {
    match part {
        Network::Leaf(leaf) => shares.push(if leaf.size().memories > 0 { force } else { 0.0 }),
        Network::Series(series) => series.parts().iter().for_each(|part| share_out(part, at, force, shares)),
        _ => {
            let whole = part.ask().asymptote(at, Onset::Short);
            for part in part.parts() {
                let Term { coefficient, order } = part.ask().asymptote(at, Onset::Short);
                let own = if order == whole.order { coefficient / whole.coefficient } else { 0.0 };
                share_out(part, at, own * force, shares);
            }
        }
    }
}

/// A part between two steps, its leaves with what they are [`owed`].
pub(super) fn now_with(part: &Network, at: &Point, owed: &[f64], state: &mut StateRef, take: Take) -> Reported {
    if owed.is_empty() {
        return part.ask().now(at, state, take);
    }
    let (mut left, mut told) = (owed.iter(), None);
    let mut sum = part.ask().now(at, state, &mut |mut leaf| {
        let own = left.next().copied().unwrap_or(0.0);
        if leaf.leaf.size().memories > 0 {
            leaf.observation.regular += own;
            leaf.observation.derivative += own / leaf.leaf.linearised(&leaf.at).coefficient;
            told = told.or(Some(leaf.observation.derivative));
        }
        take(leaf);
    });
    sum.observation.derivative = told.unwrap_or(sum.observation.derivative);
    sum
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
    let rest = rest_of(series, whole.mean(), at);
    for &[s, stroke] in whole.exponentials() {
        let compliances: Vec<Complex64> = parts.iter().map(|part| part.modulus(at, s).inv()).collect();
        let compliance: Complex64 = compliances.iter().sum();
        for (inner, own) in inner.iter_mut().zip(compliances) {
            inner.push([s, own / compliance * stroke]);
        }
    }
    let strokes = &mut state.take(series.own_size()).variables[..parts.len()];
    for (k, (part, (exponentials, stroke))) in parts.iter().zip(inner.into_iter().zip(strokes)).enumerate() {
        let own = whole.with(rest[k], exponentials);
        *stroke = own.stroke(0.0);
        part.ask().recall(&own, at, state);
    }
}

/// The strokes of linear parts at rest under the stroke `mean`.
fn rest_of(series: &Series, mean: f64, at: &Point) -> Vec<f64> {
    let parts = series.parts();
    let start = Start { stroke: mean, jump: 0.0, inputs: at.inputs };
    let Shares { of_parts, order, .. } = shares(series, at, Onset::Long);
    let mut strokes: Vec<f64> = of_parts.iter().map(|share| share * mean).collect();
    if order > 0.0 {
        return relaxed(series, &start).ok().flatten().unwrap_or(strokes);
    }
    let gives = |part: &Network| at_rest(part, 0.0, &start).is_ok_and(|[force, _]| force != 0.0);
    if parts.iter().any(gives) {
        let holding: Vec<usize> = (0..parts.len()).filter(|&k| of_parts[k] != 0.0).collect();
        // A part that cannot begin was refused before.
        let _ = balance(series, &holding, &start, &mut strokes, &mut None);
    }
    strokes
}
