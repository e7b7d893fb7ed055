//! What laws tell of themselves beside stroke, force and energies.

/// A number that rows show of a law beside stroke, force and energies, such as a voltage or a temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Told {
    /// What follows the name of the element in a column.
    pub key: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// What it holds, in a few words: `{}` stands for the element.
    pub meaning: &'static str,
    /// What figures call it: `{}` stands for the element.
    pub symbol: &'static str,
}

impl Told {
    /// Voltage across the terminals of a circuit.
    pub const VOLTAGE: Self = Self::new("voltage", "V", "voltage across {}", "voltage across {}");
    /// Charge on them.
    pub const CHARGE: Self = Self::new("charge", "C", "charge on {}", "charge on {}");
    /// Current into them.
    pub const CURRENT: Self = Self::new("current", "A", "current into {}", "current into {}");
    /// T of what warms itself.
    pub const TEMPERATURE: Self = Self::new("T", "K", "temperature of {}", "T of {}");
    /// What that loses to its surroundings.
    pub const HEAT: Self = Self::new("heat", "J", "heat lost by {} to its surroundings since t = 0", "heat lost by {}");

    /// Those that a column's name tells from an input.
    pub(crate) const BY_NAME: [Self; 4] = [Self::VOLTAGE, Self::CHARGE, Self::CURRENT, Self::HEAT];

    /// A number of this key, unit, meaning and symbol.
    pub const fn new(key: &'static str, unit: &'static str, meaning: &'static str, symbol: &'static str) -> Self {
        Self { key, unit, meaning, symbol }
    }

    /// What it holds of an element.
    pub fn meaning_of(&self, element: &str) -> String {
        self.meaning.replace("{}", element)
    }

    /// What figures call it of an element.
    pub fn symbol_of(&self, element: &str) -> String {
        self.symbol.replace("{}", element)
    }
}
