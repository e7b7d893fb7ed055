//! What temperature does to a law: a shift of its rates, a stroke of its own, a temperature that its losses raise.

use super::catalog::{Built, Entry, Input, Range};
use super::network::Network;
use super::rule::RuleError;
use crate::dual::Dual;
use std::sync::Arc;

/// Temperatures of materials, K.
pub const TEMPERATURE: Range = Range { low: 150.0, high: 1500.0 };

/// Name of the temperature among the inputs and columns of an element.
pub const INPUT: &str = "T";

/// The molar gas constant R, J/(mol·K).
pub const GAS: f64 = 8.314_462_618_153_24;

/// Largest |ln a_T|: beyond it no clock tells two times apart.
const FARTHEST: f64 = 230.0;

/// What temperature does to a law. The temperature is an input, or a state where `thermal` is there.
///
/// A law that temperature shifts is asked in reduced time ξ, dξ = dt/a_T: springpots and dashpots see dx/dξ = a_T x' and remember what was ξ ago, all
/// others what they see anyway. D^alpha x is then that in ξ, and energies in J stay what they are: P dt = (P a_T) dξ.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Heat {
    /// By how much the rates of springpots and dashpots are slower than they are at a reference temperature.
    pub shift: Option<Shift>,
    /// The temperature as a state.
    pub thermal: Option<Thermal>,
    /// The stroke of heat.
    pub expansion: Option<Expansion>,
}

/// The factor a_T of all times of relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shift {
    /// log₁₀ a_T = −C1 (T − T_ref)/(C2 + T − T_ref) (Williams, Landel and Ferry 1955), for C2 + T − T_ref > 0.
    Wlf {
        /// C1 ≥ 0.
        c1: f64,
        /// C2 > 0, K.
        c2: f64,
        /// T_ref, where a_T = 1, K.
        reference: f64,
    },
    /// ln a_T = (energy/R)(1/T − 1/T_ref).
    Arrhenius {
        /// Activation energy ≥ 0, J/mol.
        energy: f64,
        /// T_ref, where a_T = 1, K.
        reference: f64,
    },
}

/// One temperature of the whole element: capacity·T' = dissipated power − conductance·(T − ambient).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thermal {
    /// Heat capacity > 0, J/K.
    pub capacity: f64,
    /// Conductance to the surroundings ≥ 0, W/K.
    pub conductance: f64,
    /// Temperature of the surroundings, K.
    pub ambient: f64,
    /// T at t = 0, K.
    pub start: f64,
}

/// The stroke that the law sees is x − coefficient·(T − T_ref).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expansion {
    /// m/K.
    pub coefficient: f64,
    /// T without it, K.
    pub reference: f64,
}

impl Shift {
    /// ln a_T at `temperature`; NaN at and beyond the pole of WLF.
    pub fn ln_factor(&self, temperature: f64) -> f64 {
        match *self {
            Self::Wlf { c1, c2, reference } => {
                let above = temperature - reference;
                if c2 + above > 0.0 { -std::f64::consts::LN_10 * c1 * above / (c2 + above) } else { f64::NAN }
            }
            Self::Arrhenius { energy, reference } => energy / GAS * (temperature.recip() - reference.recip()),
        }
    }

    /// a_T at `temperature`.
    pub fn factor(&self, temperature: f64) -> f64 {
        self.ln_factor(temperature).exp()
    }

    /// d(ln a_T)/dT at `temperature`, 1/K.
    pub fn slope(&self, temperature: f64) -> f64 {
        match *self {
            Self::Wlf { c1, c2, reference } => {
                -std::f64::consts::LN_10 * c1 * c2 / (c2 + temperature - reference).powi(2)
            }
            Self::Arrhenius { energy, .. } => -energy / GAS / temperature.powi(2),
        }
    }

    /// Whether there is an a_T at `temperature`.
    ///
    /// # Errors
    /// [`RuleError`]: what it needs, C2 + T − T_ref > 0 of WLF; a_T between 1e-100 and 1e100.
    pub fn check(&self, temperature: f64) -> Result<(), RuleError> {
        let refuse = |rule: String| Err(RuleError { rule, parameter: INPUT.into() });
        let factor = self.ln_factor(temperature);
        match *self {
            Self::Wlf { c2, reference, .. } if factor.is_nan() => {
                let pole = (1e9 * (reference - c2)).round() / 1e9;
                refuse(format!("C2 + T − T_ref > 0: T = {temperature} K is at or below the pole at {pole} K"))
            }
            _ if factor.abs() <= FARTHEST => Ok(()),
            _ => {
                let decades = factor / std::f64::consts::LN_10;
                refuse(format!("an a_T between 1e-100 and 1e100: at T = {temperature} K log10 a_T is {decades:.3e}"))
            }
        }
    }

    /// # Errors
    /// [`RuleError`]: C1 ≥ 0 and C2 > 0, or energy ≥ 0; T_ref between 150 and 1500 K.
    fn check_constants(&self) -> Result<(), RuleError> {
        let reference = match *self {
            Self::Wlf { c1, c2, reference } => {
                RuleError::unless(c1 >= 0.0 && c1.is_finite(), "C1 ≥ 0", "C1")?;
                RuleError::unless(c2 > 0.0 && c2.is_finite(), "C2 > 0", "C2")?;
                reference
            }
            Self::Arrhenius { energy, reference } => {
                RuleError::unless(energy >= 0.0 && energy.is_finite(), "energy ≥ 0", "energy")?;
                reference
            }
        };
        RuleError::unless(TEMPERATURE.contains(reference), "T_ref between 150 and 1500 K", "T_ref")
    }
}

impl Heat {
    /// Whether it does anything.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Its rules, where its numbers are known.
    ///
    /// # Errors
    /// [`RuleError`]: those of the shift, also where the temperature of a state starts and ends; capacity > 0, conductance ≥ 0, temperatures between 150
    /// and 1500 K.
    pub fn check(&self) -> Result<(), RuleError> {
        if let Some(shift) = &self.shift {
            shift.check_constants()?;
        }
        if let Some(Thermal { capacity, conductance, ambient, start }) = self.thermal {
            RuleError::unless(capacity > 0.0 && capacity.is_finite(), "capacity > 0", "capacity")?;
            RuleError::unless(conductance >= 0.0 && conductance.is_finite(), "conductance ≥ 0", "conductance")?;
            RuleError::unless(TEMPERATURE.contains(ambient), "ambient between 150 and 1500 K", "ambient")?;
            RuleError::unless(TEMPERATURE.contains(start), "start between 150 and 1500 K", "start")?;
            for (temperature, parameter) in [(ambient, "ambient"), (start, "start")] {
                let checked = self.shift.map_or(Ok(()), |shift| shift.check(temperature));
                checked.map_err(|broken| RuleError { parameter: parameter.into(), ..broken })?;
            }
        }
        if let Some(Expansion { coefficient, reference }) = self.expansion {
            RuleError::unless(coefficient.is_finite(), "coefficient to be finite", "coefficient")?;
            RuleError::unless(TEMPERATURE.contains(reference), "T_ref between 150 and 1500 K", "T_ref")?;
        }
        Ok(())
    }

    /// Its numbers: those of the shift, of the thermal state and of the expansion, of those that are there.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        match self.shift {
            Some(Shift::Wlf { c1, c2, reference }) => numbers.extend([c1, c2, reference]),
            Some(Shift::Arrhenius { energy, reference }) => numbers.extend([energy, reference]),
            None => {}
        }
        if let Some(Thermal { capacity, conductance, ambient, start }) = self.thermal {
            numbers.extend([capacity, conductance, ambient, start]);
        }
        numbers.extend(self.expansion.iter().flat_map(|own| [own.coefficient, own.reference]));
        numbers
    }

    /// The same made of 0: of which no number moves.
    pub fn still(&self) -> Self {
        let shift = self.shift.map(|shift| match shift {
            Shift::Wlf { .. } => Shift::Wlf { c1: 0.0, c2: 0.0, reference: 0.0 },
            Shift::Arrhenius { .. } => Shift::Arrhenius { energy: 0.0, reference: 0.0 },
        });
        let thermal = self.thermal.map(|_| Thermal { capacity: 0.0, conductance: 0.0, ambient: 0.0, start: 0.0 });
        Self { shift, thermal, expansion: self.expansion.map(|_| Expansion { coefficient: 0.0, reference: 0.0 }) }
    }

    /// x − coefficient·(T − T_ref) less x.
    pub(super) fn stroke(&self, temperature: f64) -> f64 {
        self.expansion.map_or(0.0, |Expansion { coefficient, reference }| -coefficient * (temperature - reference))
    }

    /// Its derivative by T, m/K.
    pub(super) fn stroke_by_temperature(&self) -> f64 {
        self.expansion.map_or(0.0, |expansion| -expansion.coefficient)
    }

    /// a_T; 1 without a shift.
    pub(super) fn factor(&self, temperature: f64) -> f64 {
        self.shift.map_or(1.0, |shift| shift.factor(temperature))
    }
}

impl Entry {
    /// The law under `heat`. It has the input T where the temperature is one, and has none where it is a state, also if the law itself takes T: it is then
    /// told that of the state.
    ///
    /// ```
    /// use springpot::law::{Catalog, Heat, Shift, Thermal};
    ///
    /// let shift = Some(Shift::Wlf { c1: 17.44, c2: 51.6, reference: 300.0 });
    /// let zener = Catalog::standard().get("fractional-zener").expect("a law that comes with Springpot").clone();
    /// let shifted = zener.with_heat(Heat { shift, ..Heat::default() })?;
    /// assert_eq!(shifted.inputs.len(), 1);
    /// let thermal = Some(Thermal { capacity: 50.0, conductance: 0.5, ambient: 293.0, start: 293.0 });
    /// assert!(zener.with_heat(Heat { shift, thermal, ..Heat::default() })?.inputs.is_empty());
    /// # Ok::<(), springpot::law::RuleError>(())
    /// ```
    ///
    /// # Errors
    /// [`RuleError`] of [`Heat::check`].
    pub fn with_heat(&self, heat: Heat) -> Result<Self, RuleError> {
        heat.check()?;
        if heat.is_none() {
            return Ok(self.clone());
        }
        let takes = self.inputs.iter().position(|input| input.name == INPUT);
        let mut inputs = self.inputs.clone();
        match (heat.thermal, takes) {
            (Some(_), Some(at)) => drop(inputs.remove(at)),
            (None, None) => inputs.push(Input::new(INPUT, "K", "temperature", TEMPERATURE)),
            (Some(_), None) | (None, Some(_)) => {}
        }
        let (build, count) = (Arc::clone(&self.build), self.inputs.len());
        let heated = move |values: &[Dual], derivative| -> Built {
            let law = build(values, derivative)?;
            let one_clock = "to have no driver or circuit, which keeps a clock of its own, where temperature shifts it";
            RuleError::unless(heat.shift.is_none() || !law.has_clock(), one_clock, "shift")?;
            RuleError::unless(
                law.tells().is_empty(),
                "to have no electrical side where it has `thermal` or `expansion`",
                "thermal",
            )?;
            Ok(Network::heated(law, heat, count, takes))
        };
        Ok(Self { inputs, build: Arc::new(heated), ..self.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_have_their_slopes() {
        let shifts = [
            Shift::Wlf { c1: 40.2, c2: 222.6, reference: 293.15 },
            Shift::Arrhenius { energy: 8e4, reference: 293.15 },
        ];
        for shift in shifts {
            assert_eq!(shift.factor(293.15), 1.0);
            for temperature in [240.0, 293.15, 350.0] {
                let step = 1e-3;
                let by = (shift.ln_factor(temperature + step) - shift.ln_factor(temperature - step)) / (2.0 * step);
                assert!((by / shift.slope(temperature) - 1.0).abs() < 1e-8, "{shift:?} {temperature}");
            }
        }
        // −35 °C with the constants of a foam: −40.2·(−55)/(222.6 − 55) = 13.19 decades.
        let cold = shifts[0].ln_factor(238.15) / std::f64::consts::LN_10;
        assert!((cold - 40.2 * 55.0 / 167.6).abs() < 1e-12, "{cold}");
    }

    #[test]
    fn rules_are_named() {
        let wlf = |c1, c2| Shift::Wlf { c1, c2, reference: 300.0 };
        let of = |shift| Heat { shift: Some(shift), ..Heat::default() }.check().map_err(|broken| broken.parameter);
        assert_eq!(of(wlf(-1.0, 50.0)), Err("C1".into()));
        assert_eq!(of(wlf(1.0, 0.0)), Err("C2".into()));
        assert_eq!(of(Shift::Arrhenius { energy: f64::NAN, reference: 300.0 }), Err("energy".into()));
        assert_eq!(of(Shift::Arrhenius { energy: 1.0, reference: 20.0 }), Err("T_ref".into()));
        assert_eq!(of(wlf(17.44, 51.6)), Ok(()));
        let pole = wlf(17.44, 51.6).check(248.3).unwrap_err();
        assert!(pole.rule.ends_with("T = 248.3 K is at or below the pole at 248.4 K"), "{pole}");
        let near = wlf(17.44, 51.6).check(248.4).unwrap_err();
        assert!(near.rule.contains("an a_T between 1e-100 and 1e100: at T = 248.4 K log10 a_T is 1.2"), "{near}");
        assert!(wlf(17.44, 51.6).check(248.5).is_err() && wlf(17.44, 51.6).check(270.0).is_ok());
        let warm = Thermal { capacity: 1.0, conductance: 0.0, ambient: 300.0, start: 300.0 };
        let check = |thermal, shift| Heat { shift, thermal: Some(thermal), expansion: None }.check();
        for (thermal, parameter) in [
            (Thermal { capacity: -1.0, ..warm }, "capacity"),
            (Thermal { conductance: -1.0, ..warm }, "conductance"),
            (Thermal { ambient: 20.0, ..warm }, "ambient"),
            (Thermal { start: 240.0, ..warm }, "start"),
        ] {
            assert_eq!(check(thermal, Some(wlf(17.44, 51.6))).unwrap_err().parameter, parameter);
        }
        assert_eq!(check(warm, None), Ok(()));
    }
}
