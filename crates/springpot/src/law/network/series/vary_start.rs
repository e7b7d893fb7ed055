//! What parameters change of the strokes of the parts at t = 0.

use super::start::shares;
use super::{Derivative, Play, Series};
use crate::fractional::Memory;
use crate::law::leaf::When;
use crate::law::network::part::{Onset, Part};
use crate::law::network::vary::Vary;
use crate::law::state::StateRef;
use crate::law::step::Point;
use crate::law::variation::{ObservationVariation, PointVariation, VariationMut};

/// [`Part::begin_variation`]: parts that hold at rest have one force, what is slack takes the rest; of parts that flow the one that was stretched
/// does.
pub(super) fn begin(series: &Series, at: &Point, state: &mut StateRef, told: &PointVariation, own: &mut VariationMut) {
    let parts = &series.parts;
    let mut share = own.take(series.number_count(), series.size());
    let (of_strokes, count) = (share.take(0, series.own_size()), share.count);
    state.take_ready();
    let (strokes, _) = series.own(state);
    let mut states = Vec::with_capacity(parts.len());
    let mut each: Vec<VariationMut> = Vec::with_capacity(parts.len());
    for part in parts {
        states.push(*state);
        part.ask().pass(state);
        each.push(share.take(part.ask().number_count(), part.ask().size()));
    }
    let slack = series.play().filter(|play| play.force(play.stroke(|k| strokes[k])) == 0.0);
    // What a play that is slack leaves to the others; where that is nothing it takes all.
    let left = slack.map_or(0.0, |play| at.stroke - play.free(at.stroke));
    let takes_all = slack.filter(|_| left == 0.0).map(Play::first);
    let is_unstretched = strokes.iter().all(|stroke| *stroke == 0.0);
    let of_parts = shares(series, at, onset(series, &states)).of_parts;
    let holds = |k: &usize| if is_unstretched { of_parts[*k] != 0.0 } else { strokes[*k] != 0.0 };
    let holding: Vec<usize> =
        (0..parts.len()).filter(holds).filter(|k| slack.is_none() || !series.is_free(*k)).collect();
    let [still, one] = [vec![0.0; count], vec![1.0; count]];
    // What changes of part `k`, at rest at its stroke or next to it, which changes by so much: that of its force is told.
    let mut begin_at = |k: usize, [place, rate]: [f64; 2], stroke: &[f64]| -> Vec<f64> {
        let inside = Point { stroke: place, rate, ..*at };
        let told = PointVariation { stroke, rate: &still, step: None, ..*told };
        parts[k].ask().begin_variation(&inside, &mut states[k].clone(), &told, &mut each[k].reborrow());
        let (mut force, mut spare) = (vec![0.0; count], [vec![0.0; count], vec![0.0; count]]);
        let [stored, derivative] = &mut spare;
        let mut sum =
            ObservationVariation { force: &mut force, stored, derivative, told: &mut Vec::new(), leaves: None };
        let mut own = each[k].view();
        parts[k].ask().vary_at((When::Between, &inside), &mut states[k].clone(), &told, &mut own, &mut sum);
        force
    };
    // C_k of parts that flow is 1/c_k: what changes of ln C_k, each by its force at a rate.
    let mut flows = |k: usize, place: f64| -> Vec<f64> {
        let [rest, moving] = [0.0, SLOW].map(|rate| begin_at(k, [place, rate], &still));
        let whole = parts[k].ask().asymptote(at, Onset::Long).coefficient * SLOW;
        rest.iter().zip(&moving).map(|(rest, moving)| (rest - moving) / whole).collect()
    };
    let stays = |k: &usize| of_parts[*k] == 0.0 || parts[*k].ask().size().memories > 0;
    let flowing: Vec<usize> = if (0..parts.len()).all(|k| stays(&k)) { Vec::new() } else { holding.clone() };
    let of_flow: Vec<(usize, Vec<f64>)> = flowing.iter().map(|&k| (k, flows(k, strokes[k]))).collect();
    let mut begin_part = |k: usize, place: f64, stroke: &[f64]| begin_at(k, [place, 0.0], stroke);
    // δF = slope·δx + what changes where its stroke stays.
    let mut line = |k: usize, place: f64| {
        let explicit = begin_part(k, place, &still);
        let slope = begin_part(k, place, &one)[0] - explicit[0];
        (k, explicit, slope)
    };
    let mut moved = vec![vec![0.0; count]; parts.len()];
    let takes_rest = takes_all.or(match &holding[..] {
        [only] => Some(*only),
        _ => None,
    });
    if takes_all.is_some() || takes_rest.is_none() {
        let mut lines: Vec<(usize, Vec<f64>, f64)> = holding.iter().map(|&k| line(k, strokes[k])).collect();
        if takes_all.is_some() {
            lines.retain(|(.., slope)| *slope != 0.0);
        }
        // What slips has its force, whatever the others leave it.
        let slipping = lines.iter().position(|(k, _, slope)| *slope == 0.0 && series.slips(*k).is_some());
        let yielding = slipping.map(|at| lines.remove(at));
        let compliance: f64 = lines.iter().map(|(.., slope)| slope.recip()).sum();
        for p in 0..count {
            let owed: f64 = lines.iter().map(|(_, explicit, slope)| explicit[p] / slope).sum();
            let force = match &yielding {
                _ if takes_all.is_some() => 0.0,
                Some((_, explicit, _)) => explicit[p],
                None => (told.stroke[p] + owed) / compliance,
            };
            for (k, explicit, slope) in &lines {
                moved[*k][p] = match compliance.is_finite() {
                    true => (force - explicit[p]) / slope,
                    // Parts that flow have shared the stroke as they yield; of memories of one order nothing asks how.
                    false => {
                        let all: f64 = of_flow.iter().map(|(k, own)| of_parts[*k] * own[p]).sum();
                        let own = of_flow.iter().find(|(own, _)| own == k).map_or(0.0, |(_, own)| own[p] - all);
                        of_parts[*k] * (told.stroke[p] + own * at.stroke)
                    }
                };
            }
            if let Some((rest, ..)) = &yielding {
                moved[*rest][p] = told.stroke[p] - lines.iter().map(|(k, ..)| moved[*k][p]).sum::<f64>();
            }
        }
    }
    if left != 0.0 {
        // On its end: where it begins to carry.
        for k in (0..parts.len()).filter(|k| series.is_free(*k)) {
            let beyond = if left > 0.0 { strokes[k].next_up() } else { strokes[k].next_down() };
            let (_, explicit, slope) = line(k, beyond);
            moved[k].iter_mut().zip(&explicit).for_each(|(moved, explicit)| *moved = -explicit / slope);
        }
    }
    if let Some(rest) = takes_rest {
        for p in 0..count {
            let others: f64 = (0..parts.len()).filter(|k| *k != rest).map(|k| moved[k][p]).sum();
            moved[rest][p] = told.stroke[p] - others;
        }
    }
    for (k, moved) in moved.iter().enumerate() {
        begin_part(k, strokes[k], moved);
        of_strokes.variables[k * count..(k + 1) * count].copy_from_slice(moved);
    }
}

/// A rate at which every force that flows is in proportion to it, m/s.
const SLOW: f64 = 1e-30;

/// Which end of the times shares what a series begins with: of what was held since ever what has relaxed, of what jumps at t = 0 what has not begun.
fn onset(series: &Series, states: &[StateRef]) -> Onset {
    let kind = states.iter().find_map(|state| state.memories.first()).map(Memory::kind);
    let unloaded = kind.map_or(series.is_unloaded, |kind| kind == Derivative::RiemannLiouville);
    if unloaded { Onset::Short } else { Onset::Long }
}
