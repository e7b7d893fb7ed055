//! Physical dimensions with real exponents.

use std::fmt;

const NAMES: [&str; 6] = ["kg", "m", "s", "A", "K", "mol"];
const TOLERANCE: f64 = 1e-9;

/// Names that a reader recognises, tried before anything is composed: exponents of kg, m, s, A, K.
const KNOWN: [(&str, [f64; 5]); 12] = [
    ("W", [1.0, 2.0, -3.0, 0.0, 0.0]),
    ("Pa", [1.0, -1.0, -2.0, 0.0, 0.0]),
    ("Pa*s", [1.0, -1.0, -1.0, 0.0, 0.0]),
    ("V", [1.0, 2.0, -3.0, -1.0, 0.0]),
    ("V/m", [1.0, 1.0, -3.0, -1.0, 0.0]),
    ("m/V", [-1.0, -1.0, 3.0, 1.0, 0.0]),
    ("1/V", [-1.0, -2.0, 3.0, 1.0, 0.0]),
    ("C", [0.0, 0.0, 1.0, 1.0, 0.0]),
    ("F", [-1.0, -2.0, 4.0, 2.0, 0.0]),
    ("ohm", [1.0, 2.0, -3.0, -2.0, 0.0]),
    ("kg*m^2", [1.0, 2.0, 0.0, 0.0, 0.0]),
    ("kg", [1.0, 0.0, 0.0, 0.0, 0.0]),
];

/// A physical dimension kg^a·m^b·s^c·A^d·K^e·mol^f with real exponents; angles, percent and 1 have none.
///
/// Its text is the shortest recognisable SI unit of that dimension: `N`, `N*m`, `N*s^0.3/m`, `m/K`, `1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimension {
    exponents: [f64; 6],
}

impl Dimension {
    /// No dimension: pure numbers and angles.
    pub const NONE: Self = Self::new([0.0; 5]);

    /// The dimension with these exponents of kilogram, metre, second, ampere and kelvin.
    pub const fn new([kg, m, s, a, k]: [f64; 5]) -> Self {
        Self { exponents: [kg, m, s, a, k, 0.0] }
    }

    /// The dimension with these exponents of kilogram, metre, second, ampere, kelvin and mole.
    pub const fn with_amount(exponents: [f64; 6]) -> Self {
        Self { exponents }
    }

    /// Exponents of kilogram, metre, second, ampere, kelvin and mole.
    pub const fn exponents(&self) -> [f64; 6] {
        self.exponents
    }

    /// Whether all exponents agree within 1e-9.
    pub fn agrees_with(&self, other: &Self) -> bool {
        self.exponents.iter().zip(&other.exponents).all(|(a, b)| (a - b).abs() <= TOLERANCE)
    }

    /// Whether it is a pure number or an angle.
    pub fn is_none(&self) -> bool {
        self.agrees_with(&Self::NONE)
    }

    /// Whether it is a temperature.
    pub fn is_temperature(&self) -> bool {
        self.agrees_with(&Self::new([0.0, 0.0, 0.0, 0.0, 1.0]))
    }

    /// self·other^power.
    pub(super) fn times(self, other: Self, power: f64) -> Self {
        Self { exponents: std::array::from_fn(|i| self.exponents[i] + power * other.exponents[i]) }
    }

    pub(super) fn pow(self, power: f64) -> Self {
        Self::NONE.times(self, power)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.agrees_with(&Self::with_amount([1.0, 2.0, -2.0, 0.0, 0.0, -1.0])) {
            return f.write_str("J/mol");
        }
        if let Some((name, _)) = KNOWN.iter().find(|(_, exponents)| self.agrees_with(&Self::new(*exponents))) {
            return f.write_str(name);
        }
        let [mass, length, time, current, temperature, amount] = self.exponents;
        // Anything with kg·s^-1 … kg·s^-2 in it is read more easily as a force over something.
        let force = (mass - 1.0).abs() <= TOLERANCE && time <= -1.0 + TOLERANCE;
        let factors = if force {
            [("N", 1.0), ("m", length - 1.0), ("s", time + 2.0), ("A", current), ("K", temperature), ("mol", amount)]
        } else {
            std::array::from_fn(|i| (NAMES[i], self.exponents[i]))
        };
        let above = factors.iter().filter(|(_, power)| *power > TOLERANCE);
        let below = factors.iter().filter(|(_, power)| *power < -TOLERANCE);
        let mut separator = "";
        for (name, power) in above {
            write!(f, "{separator}{name}{}", Exponent(*power))?;
            separator = "*";
        }
        if separator.is_empty() {
            f.write_str("1")?;
        }
        for (name, power) in below {
            write!(f, "/{name}{}", Exponent(-power))?;
        }
        Ok(())
    }
}

/// `^2`, `^0.3`, or nothing for 1.
struct Exponent(f64);

impl fmt::Display for Exponent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = (self.0 / TOLERANCE).round() * TOLERANCE;
        if (rounded - 1.0).abs() <= TOLERANCE {
            return Ok(());
        }
        let text = format!("{rounded:.9}");
        write!(f, "^{}", text.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::Dimension;

    #[test]
    fn reads_like_a_unit() {
        for (exponents, text) in [
            ([0.0, 0.0, 0.0, 0.0, 0.0], "1"),
            ([1.0, 1.0, -2.0, 0.0, 0.0], "N"),
            ([1.0, 2.0, -2.0, 0.0, 0.0], "N*m"),
            ([1.0, 0.0, -2.0, 0.0, 0.0], "N/m"),
            ([1.0, 0.0, -1.0, 0.0, 0.0], "N*s/m"),
            ([1.0, 0.0, -1.7, 0.0, 0.0], "N*s^0.3/m"),
            ([0.0, 1.0, 0.0, 0.0, -1.0], "m/K"),
            ([0.0, 1.0, -2.0, 0.0, 0.0], "m/s^2"),
            ([1.0, 2.0, 0.0, 0.0, 0.0], "kg*m^2"),
            ([0.0, 0.0, -1.0, 0.0, 0.0], "1/s"),
            ([-1.0, -1.0, 3.0, 1.0, 0.0], "m/V"),
        ] {
            assert_eq!(Dimension::new(exponents).to_string(), text);
        }
    }
}
