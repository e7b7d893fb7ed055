//! What parameters change of parts one behind the other whose strokes before t = 0 are recalled.

use super::Series;
use super::start::shares;
use crate::dual::Dual;
use crate::law::network::Network;
use crate::law::network::part::{Onset, Part, asymptote_by};
use crate::law::network::vary::Vary;
use crate::law::past::{Recalled, RecalledVariation};
use crate::law::state::StateRef;
use crate::law::step::{Point, Term};
use crate::law::variation::{PointVariation, VariationMut};
use num_complex::Complex64;

/// [`super::start::recall`]: X_m = C_m/C·X at each s, so that δX_m = X_m (δC_m/C_m − δC/C) + C_m/C·δX, the compliances changing with s too.
pub(super) fn recall(
    series: &Series,
    (whole, changes): (&Recalled, &RecalledVariation),
    (at, told): (&Point, &PointVariation),
    laws: &[&Network],
    state: &mut StateRef,
    own: &mut VariationMut,
) -> Result<(), String> {
    let (parts, count) = (series.parts(), own.count);
    let unknown = || "springs and memories in series whose past is recalled".to_owned();
    let inputs: Vec<_> = (0..count).map(|p| told.inputs_of(at, p, count)).collect();
    let points: Vec<Point<Dual>> = inputs.iter().map(|inputs| at.with_inputs(inputs)).collect();
    let mut inner = vec![Vec::new(); parts.len()];
    let mut moved = vec![Vec::new(); parts.len()];
    for (&[s, stroke], changes) in whole.exponentials().iter().zip(&changes.exponentials) {
        let compliances: Vec<Complex64> = parts.iter().map(|part| part.modulus(at, s).inv()).collect();
        let compliance: Complex64 = compliances.iter().sum();
        for (inner, own) in inner.iter_mut().zip(&compliances) {
            inner.push([s, own / compliance * stroke]);
        }
        let mut of_parts = vec![Vec::with_capacity(count); parts.len()];
        for (p, [by_s, by_stroke]) in changes.iter().enumerate() {
            let slope = |(k, own): (usize, &Complex64)| {
                let [_, slope] = laws[p].parts()[k].ask().modulus_slope(&points[p], [s, *by_s])?;
                Some(-slope * own * own)
            };
            let slopes = compliances.iter().enumerate().map(slope).collect::<Option<Vec<_>>>().ok_or_else(unknown)?;
            let all: Complex64 = slopes.iter().sum();
            for (k, of_part) in of_parts.iter_mut().enumerate() {
                let share = compliances[k] / compliance;
                let by_share = slopes[k] / compliance - share * all / compliance;
                of_part.push([*by_s, by_share * stroke + share * by_stroke]);
            }
        }
        moved.iter_mut().zip(of_parts).for_each(|(moved, of_part)| moved.push(of_part));
    }
    let rest = rest_of(series, whole.mean(), &changes.mean, (at, &points), laws).ok_or_else(unknown)?;
    let mut share = own.take(series.number_count(), series.size());
    let strokes = share.take(0, series.own_size());
    state.take(series.own_size());
    state.take_ready();
    for (k, (part, (inner, moved))) in parts.iter().zip(inner.into_iter().zip(moved)).enumerate() {
        let [mean, by_mean] = &rest[k];
        let own = whole.with(mean[0], inner);
        let changes = RecalledVariation { mean: by_mean.clone(), exponentials: moved };
        strokes.variables[k * count..(k + 1) * count].copy_from_slice(&changes.stroke(&own, 0.0));
        let laws: Vec<&Network> = laws.iter().map(|law| &law.parts()[k]).collect();
        part.ask().recall_variation((&own, &changes), (at, told), &laws, state, &mut share)?;
    }
    Ok(())
}

/// Of each part its stroke at rest, and what changes of that, where the whole rests at `mean`, which changes by `by`.
fn rest_of(
    series: &Series,
    mean: f64,
    by: &[f64],
    (at, points): (&Point, &[Point<Dual>]),
    laws: &[&Network],
) -> Option<Vec<[Vec<f64>; 2]>> {
    let of_parts = shares(series, at, Onset::Long).of_parts;
    let mut rest: Vec<[Vec<f64>; 2]> =
        of_parts.iter().map(|share| [vec![share * mean], by.iter().map(|by| share * by).collect()]).collect();
    if mean == 0.0 || of_parts.iter().filter(|share| **share != 0.0).count() < 2 {
        return Some(rest);
    }
    for (p, law) in laws.iter().enumerate() {
        // C_m = 1/c_m of those that share it.
        let compliance = |k: usize| -> Option<[f64; 2]> {
            let (Term { coefficient, .. }, slope) = asymptote_by(&law.parts()[k], &points[p], Onset::Long)?;
            Some([coefficient.recip(), -slope / (coefficient * coefficient)])
        };
        let own = (0..of_parts.len())
            .map(|k| if of_parts[k] == 0.0 { Some([0.0; 2]) } else { compliance(k) })
            .collect::<Option<Vec<_>>>()?;
        let [all, by_all] = own.iter().fold([0.0; 2], |[a, b], [own, slope]| [a + own, b + slope]);
        for (rest, [own, slope]) in rest.iter_mut().zip(&own) {
            rest[1][p] += (slope - own / all * by_all) / all * mean;
        }
    }
    Some(rest)
}
