//! When a function of t passes zero in a run: found with bounds over stretches of time, as the kinks of signals are, so that none is too narrow.

use super::agenda::Agenda;
use super::expression::Expression;
use super::function::Signal;
use super::watched::{AgendaError, Watched};
use std::sync::atomic::AtomicBool;

/// A value is zero that rounding may have made: what this share of t, and so much, change in it.
const ROUNDING: f64 = 1e-12;
const LEAST: f64 = 1e-14;

/// Times at which a function is first behind a zero, ascending, and whether it rises there.
pub(crate) type Passages = Vec<(f64, bool)>;

/// The passages of `function` from 0 to `end`, and a time > 0 at which it is no number, if one was met. A function that leaves zero does not pass it,
/// nor does one that only touches it.
///
/// # Errors
/// [`AgendaError`] where it changes more than `most` times, or where `stop` is set.
pub(crate) fn passages(
    function: &Expression,
    end: f64,
    most: u64,
    stop: Option<&AtomicBool>,
) -> Result<(Passages, Option<f64>), AgendaError> {
    let sign = Signal::expression(function.sign());
    let watched = [Watched { signal: &sign, is_position: false, slack: 1.0 }];
    let agenda = Agenda::new(&watched, end, 1.0, most, stop)?;
    let (mut passages, mut undefined, mut side) = (Passages::new(), None, 0i8);
    let starts = std::iter::once(0.0).chain(agenda.kinks().iter().copied());
    let ends = agenda.kinks().iter().copied().chain([end]);
    for (from, to) in starts.zip(ends) {
        let middle = from + 0.5 * (to - from);
        let value = function.value(middle);
        if !value.is_finite() && middle > 0.0 {
            undefined = undefined.or(Some(middle));
        }
        let now = if value > 0.0 { 1 } else { -i8::from(value < 0.0) };
        let moved = function.value(middle + ROUNDING * middle + LEAST);
        if now != 0 && value.abs() <= (moved - value).abs() && to - from < ROUNDING.sqrt() * end {
            // Between two zeros that rounding made of one.
            continue;
        }
        if side != 0 && now != side {
            passages.push((from, side < 0));
        }
        side = now;
    }
    Ok((passages, undefined))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str, end: f64) -> Passages {
        passages(&text.parse().unwrap(), end, 1_000_000, None).unwrap().0
    }

    #[test]
    fn every_passage_is_found() {
        let pulse = found("max(0, 1 - abs(t - 31.4)/1e-4) - 0.5", 60.0);
        assert_eq!(pulse.iter().map(|(_, rises)| *rises).collect::<Vec<_>>(), [true, false]);
        let near = |t: f64, at: f64| assert!((t - at).abs() < 1e-12, "{t} {at}");
        near(pulse[0].0, 31.399_95);
        near(pulse[1].0, 31.400_05);
        let waves = found("sin(200*t)", 60.0);
        assert_eq!(waves.len(), 3819);
        assert!(waves.iter().enumerate().all(|(k, (_, rises))| *rises == (k % 2 == 1)));
        near(waves[3818].0, 3819.0 * std::f64::consts::PI / 200.0);
        assert_eq!(found("step(t - 3) - 0.5", 60.0), [(3.0, true)]);
        assert_eq!(found("1/(t - 3)", 60.0).len(), 1);
    }

    #[test]
    fn what_leaves_zero_or_touches_it_does_not_pass() {
        for text in [
            "t",
            "max(0, t - 3)",
            "-max(0, t - 3)",
            "abs(sin(t))",
            "sin(t)^2",
            "(t - 3)^2",
            "0*t",
            "5 - 0*t",
            "sign(t - 3)^2",
        ] {
            assert_eq!(found(text, 10.0), [], "{text}");
        }
        // It comes to zero, stays there, and leaves it.
        assert_eq!(found("min(0, t - 3)", 10.0), [(3.0, true)]);
        assert_eq!(found("min(0, t - 3) + max(0, t - 5)", 10.0), [(3.0, true)]);
    }
}
