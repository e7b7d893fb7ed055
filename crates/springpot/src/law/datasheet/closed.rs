//! Springpot, Kelvin–Voigt and fractional Kelvin–Voigt element in closed form.

use super::{Datum, Identified, Model, Quantity};
use std::f64::consts::FRAC_PI_2;

/// The law where K is known at one frequency, and beside it at most k.
pub(super) fn form(model: Model, data: &[Datum]) -> Option<Identified> {
    let (at_rest, moving): (Vec<&Datum>, Vec<&Datum>) = data.iter().partition(|datum| datum.omega == 0.0);
    let k_known = match at_rest[..] {
        [] => 0.0,
        [one] if !one.quantity.is_of_losses() => one.value,
        _ => return None,
    };
    let [first, second] = moving[..] else { return None };
    if first.omega != second.omega {
        return None;
    }
    let omega = first.omega;
    let [re, im] = complex(first, second).or_else(|| complex(second, first))?;
    let (stiffness, order) = match (model, at_rest.len()) {
        (Model::Springpot, 0) => (0.0, im.atan2(re) / FRAC_PI_2),
        (Model::KelvinVoigt, 0) => (re, 1.0),
        (Model::FractionalKelvinVoigt, 1) => (k_known, im.atan2(re - k_known) / FRAC_PI_2),
        _ => return None,
    };
    let rest = if model == Model::KelvinVoigt { im } else { (re - stiffness).hypot(im) };
    // Beyond alpha = 1 the nearest admissible one is looked for, to say how far off it is.
    (order <= 1.0).then(|| Identified { model, stiffness, coefficient: rest / omega.powf(order), order })
}

/// K from two quantities at one frequency; `None` where this pair in this order does not tell it.
fn complex(first: &Datum, second: &Datum) -> Option<[f64; 2]> {
    let in_stiffness = |datum: &Datum| match datum.quantity {
        Quantity::Damping => (Quantity::Loss, datum.value * datum.omega),
        quantity => (quantity, datum.value),
    };
    let ((first, a), (second, b)) = (in_stiffness(first), in_stiffness(second));
    let leg = |hypotenuse: f64, leg: f64| {
        let square = (hypotenuse - leg) * (hypotenuse + leg);
        (square >= 0.0).then(|| square.sqrt())
    };
    match (first, second) {
        (Quantity::LossFactor, Quantity::Stiffness) => Some([b / a.hypot(1.0), a * b / a.hypot(1.0)]),
        (Quantity::LossFactor, Quantity::Storage) => Some([b, a * b]),
        (Quantity::LossFactor, Quantity::Loss) => Some([b / a, b]),
        (Quantity::Stiffness, Quantity::Storage) => leg(a, b).map(|im| [b, im]),
        (Quantity::Stiffness, Quantity::Loss) => leg(a, b).map(|re| [re, b]),
        (Quantity::Storage, Quantity::Loss) => Some([a, b]),
        _ => None,
    }
}
