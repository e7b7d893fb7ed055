//! Numbers from one to another at equal differences or equal ratios: `{ from, to, count, scale }`.

use crate::reader::{Field, Read, Table};
use crate::text::document::shorten;
use crate::text::refusal::RefusalKind;

/// So many numbers, both ends among them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spacing {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) count: usize,
    pub(crate) is_logarithmic: bool,
}

impl Spacing {
    /// The numbers between two ends that were read, with `count` and `scale` of the table `table`, which is the value of `field`.
    pub(crate) fn read<T>(field: &Field<'_>, table: &Table<'_>, ends: Read<([f64; 2], T)>) -> Read<(Self, T)> {
        let count = table.require("count").and_then(|field| field.whole());
        let is_logarithmic = table.get("scale").map_or(Ok(false), |field| match field.text()? {
            "linear" => Ok(false),
            LOG => Ok(true),
            other => {
                let message = format!("is {:?}, which is no scale", shorten(other));
                Err(field.refuse(RefusalKind::UnknownName, message, Some("write \"linear\" or \"log\"".to_owned())))
            }
        });
        let (([from, to], rest), count, is_logarithmic) = (ends?, count?, is_logarithmic?);
        if is_logarithmic && (from == 0.0 || to == 0.0 || (from > 0.0) != (to > 0.0)) {
            let message = format!("runs from {from} to {to}, which has no logarithmic scale");
            let help = "both ends must be above zero, or both below".to_owned();
            return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
        }
        Ok((Self { from, to, count: usize::try_from(count).unwrap_or(2), is_logarithmic }, rest))
    }

    /// Number `k`; the ends are exact, what lies between is rounded to 15 digits so that 0.3 is 0.3.
    pub(crate) fn number(&self, k: usize) -> f64 {
        let last = self.count - 1;
        if k == 0 {
            return self.from;
        }
        if k >= last {
            return self.to;
        }
        let part = k as f64 / last as f64;
        let exact = if self.is_logarithmic {
            self.from * (self.to / self.from).powf(part)
        } else {
            self.from * (1.0 - part) + self.to * part
        };
        format!("{exact:.14e}").parse().unwrap_or(exact)
    }

    /// Index of the value that is `number`.
    pub(crate) fn index(&self, number: f64) -> Option<usize> {
        let part = if self.is_logarithmic {
            (number / self.from).ln() / (self.to / self.from).ln()
        } else {
            (number - self.from) / (self.to - self.from)
        };
        let k = (part * (self.count - 1) as f64).round();
        let inside = k >= 0.0 && k < self.count as f64;
        let near = |k: usize| (self.number(k) - number).abs() <= 1e-12 * number.abs();
        inside.then_some(k as usize).filter(|&k| near(k))
    }
}

/// Equal ratios.
const LOG: &str = "log";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_met_to_the_last_bit() {
        let five = Spacing { from: 1e-2, to: 1e3, count: 51, is_logarithmic: true };
        let decades: Vec<f64> = (0..=50).step_by(10).map(|k| five.number(k)).collect();
        assert_eq!(decades, [1e-2, 0.1, 1.0, 10.0, 100.0, 1e3]);
        assert!((0..51).all(|k| five.index(five.number(k)) == Some(k)));
        let tenths = Spacing { from: 0.0, to: 1.0, count: 11, is_logarithmic: false };
        assert_eq!((tenths.number(3), tenths.index(0.3), tenths.index(0.35)), (0.3, Some(3), None));
    }
}
