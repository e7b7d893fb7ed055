//! The test at bounds towards which a logarithm only drifts.

use super::descent::{Descent, End, descend};
use super::estimate::inverse;
use super::look::{Look, Place};
use super::parameter::Side;

/// Standard deviations from a bound within which it is tried.
const NEAR: f64 = 5.0;
/// The cosine of r with the column at a bound above which the cost presses towards it.
const PRESSED: f64 = 1e-5;
const SAME: f64 = 1e-12;

/// Puts parameters to bounds where the cost is least there, lets those go that another one has freed, and ends at the minimum of the rest.
pub(super) fn settle(look: &Look<'_>, mut at: Descent, most: usize) -> Descent {
    let mut tries = 4 * at.places.len();
    let mut let_go = vec![false; at.places.len()];
    'again: loop {
        for (j, side) in near(look, &at) {
            if tries == 0 || look.is_stopped() || let_go[j] {
                continue;
            }
            tries -= 1;
            let mut places = at.places.clone();
            places[j] = Place::Bound(side);
            let tried = descend(look, &places, most);
            let is_less = tried.cost < 0.999 * at.cost;
            if is_less
                || tried.cost <= at.cost * (1.0 + SAME) && pressure(look, &tried, j, side).is_none_or(|p| p > PRESSED)
            {
                at = tried;
                continue 'again;
            }
        }
        for j in 0..at.places.len() {
            let Place::Bound(side) = at.places[j] else { continue };
            if let_go[j] || tries == 0 || look.is_stopped() || pressure(look, &at, j, side).is_none_or(|p| p > -PRESSED)
            {
                continue;
            }
            (tries, let_go[j]) = (tries - 1, true);
            let parameter = &look.parameters()[j];
            let other = parameter.bounds[usize::from(side == Side::Lower)];
            let reach =
                if other.is_finite() { 0.01 * (other - parameter.bound(side)).abs() } else { 0.01 * parameter.typical };
            let inside = parameter.bound(side) + if side == Side::Lower { reach } else { -reach };
            let mut places = at.places.clone();
            places[j] = Place::At(parameter.variable(inside));
            let tried = descend(look, &places, most);
            if tried.cost < at.cost {
                at = tried;
                continue 'again;
            }
        }
        if look.is_stopped() {
            at.end = End::Interrupted;
        }
        return at;
    }
}

/// What is near a bound that u does not reach, in standard deviations, nearest first.
fn near(look: &Look<'_>, at: &Descent) -> Vec<(usize, Side)> {
    let n = at.places.len();
    let free: Vec<bool> = at.places.iter().map(|place| matches!(place, Place::At(_))).collect();
    let values = look.values(&at.places);
    let Some(triangle) = look.by_values(&values, &free) else { return Vec::new() };
    let columns: Vec<usize> = (0..n).filter(|j| free[*j]).collect();
    let inverse = inverse(&triangle, &columns);
    // Without more rows than parameters the scatter of the rest is as good as any.
    let noise = at.cost / look.freedom(columns.len()).max(1.0);
    let mut found: Vec<(f64, usize, Side)> = Vec::new();
    for (k, &j) in columns.iter().enumerate() {
        if triangle.norm(j) == 0.0 {
            continue;
        }
        let parameter = &look.parameters()[j];
        let sd = (noise * inverse[k * columns.len() + k]).sqrt();
        for side in [Side::Lower, Side::Upper] {
            let distance = (values[j] - parameter.bound(side)).abs();
            let is_near = distance <= NEAR * sd || sd.is_nan() || distance <= 1e-6 * parameter.typical;
            if parameter.drifts_to(side) && is_near {
                found.push((distance / sd, j, side));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, j, side)| (j, side)).collect()
}

/// The cosine of r with the column of what stands at a bound, positive where the cost falls towards it; `None` where there is no column.
fn pressure(look: &Look<'_>, at: &Descent, j: usize, side: Side) -> Option<f64> {
    let n = at.places.len();
    let wanted: Vec<bool> = (0..n).map(|i| i == j).collect();
    let triangle = look.by_values(&look.values(&at.places), &wanted)?;
    let cosine = triangle.product(j, n) / (triangle.norm(j) * triangle.norm(n));
    if cosine.is_nan() {
        return Some(0.0);
    }
    Some(if side == Side::Lower { cosine } else { -cosine })
}
