//! Coordinates may have kinks, no jumps.

use super::error::RunError;
use crate::model::Model;

/// Neighbouring times on either side of a kink by which rounding is judged.
const NEIGHBOURS: usize = 4;

/// Refuses coordinates that jump from `before` to `after` (time and q): that move farther than at their `speeds`, than they are `solved` for
/// and than rounding makes of them, which `places` shows at neighbouring times. No jump is too small to count.
///
/// # Errors
/// [`RunError::Jump`], and those of `places`.
pub(crate) fn refuse_jumps(
    model: &Model,
    (before, q_before): (f64, &[f64]),
    (after, q_after): (f64, &[f64]),
    speeds: impl Fn(usize) -> f64,
    solved: f64,
    mut places: impl FnMut(f64, &mut Vec<f64>) -> Result<(), RunError>,
) -> Result<(), RunError> {
    let jumps = model.difference(q_before, q_after);
    let mut noise: Option<Vec<f64>> = None;
    for j in model.own_joints() {
        let size = q_after[model.q_range(j)].iter().fold(0.0, |largest: f64, q| largest.max(q.abs()));
        for k in model.v_range(j) {
            let reach = (after - before) * speeds(k) + 16.0 * f64::EPSILON * size + solved;
            if jumps[k].abs() <= reach {
                continue;
            }
            if noise.is_none() {
                noise = Some(rounding(model, before, after, &mut places)?);
            }
            let rounding = noise.as_ref().map_or(0.0, |noise| noise[k]);
            if jumps[k].abs() > reach + 8.0 * rounding {
                return Err(RunError::Jump { t: after, joint: model.joint_names()[j].clone(), jump: jumps[k] });
            }
        }
    }
    Ok(())
}

/// The largest difference of each velocity's coordinate between neighbouring times next to a kink.
fn rounding(
    model: &Model,
    before: f64,
    after: f64,
    places: &mut impl FnMut(f64, &mut Vec<f64>) -> Result<(), RunError>,
) -> Result<Vec<f64>, RunError> {
    let mut largest = vec![0.0f64; model.nv()];
    let (mut one, mut other) = (vec![0.0; model.nq()], vec![0.0; model.nq()]);
    for (from, step) in [(before, f64::next_down as fn(f64) -> f64), (after, f64::next_up)] {
        let mut t = from;
        places(t, &mut one)?;
        for _ in 0..NEIGHBOURS {
            t = step(t);
            if t < 0.0 {
                break;
            }
            places(t, &mut other)?;
            let moved = model.difference(&one, &other);
            largest.iter_mut().zip(moved).for_each(|(largest, moved)| *largest = largest.max(moved.abs()));
            std::mem::swap(&mut one, &mut other);
        }
    }
    Ok(largest)
}
