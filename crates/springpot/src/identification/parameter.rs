//! What is sought: its admissible values, and the variable in which it moves.

/// The variable u in which a parameter p moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// u = p.
    Linear,
    /// u = ln p, for [low, high] with low ≥ 0.
    Log,
    /// u = ln((p − low)/(high − p)), for a finite range.
    Logit,
}

/// What is known of a parameter beforehand: one more residual (p − mean)/sd.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Its value.
    pub mean: f64,
    /// Its standard deviation; positive.
    pub sd: f64,
}

/// An end of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The lower one.
    Lower,
    /// The upper one.
    Upper,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, for messages.
    pub name: String,
    /// Where fits begin: the k-th with the k-th of them, or the last; at least one.
    pub start: Vec<f64>,
    /// Least and largest admissible value; infinite where there is none.
    pub bounds: [f64; 2],
    /// The variable in which it moves.
    pub scale: Scale,
    /// Its size where its value may be 0; positive.
    pub typical: f64,
    /// What is known beforehand.
    pub prior: Option<Prior>,
}

impl Parameter {
    /// A parameter that starts at a value and moves as its range says: ln p on [0, ∞) and parts of it that do not end, logit on finite
    /// ranges, else p itself.
    pub fn new(name: impl Into<String>, start: f64, bounds: [f64; 2]) -> Self {
        let scale = match bounds {
            [low, high] if low.is_finite() && high.is_finite() => Scale::Logit,
            [low, _] if low >= 0.0 => Scale::Log,
            _ => Scale::Linear,
        };
        let typical = if start == 0.0 { 1.0 } else { start.abs() };
        Self { name: name.into(), start: vec![start], bounds, scale, typical, prior: None }
    }

    /// One that may have any value.
    pub fn free(name: impl Into<String>, start: f64) -> Self {
        Self::new(name, start, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// u at a value.
    pub(super) fn variable(&self, value: f64) -> f64 {
        let [low, high] = self.bounds;
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.ln(),
            Scale::Logit => ((value - low) / (high - value)).ln(),
        }
    }

    /// The value at u, within the bounds; a bound that u can reach is met to the bit.
    pub(super) fn value(&self, u: f64) -> f64 {
        let [low, high] = self.bounds;
        let [least, most] = self.ends();
        match self.scale {
            _ if u <= least => low,
            _ if u >= most => high,
            Scale::Linear => u,
            Scale::Log => u.exp().clamp(low, high),
            Scale::Logit => (low + (high - low) / (1.0 + (-u).exp())).clamp(low, high),
        }
    }

    /// dp/du.
    pub(super) fn slope(&self, value: f64) -> f64 {
        let [low, high] = self.bounds;
        match self.scale {
            Scale::Linear => 1.0,
            Scale::Log => value,
            Scale::Logit => (value - low) * ((high - value) / (high - low)),
        }
    }

    /// Bounds of u; infinite where a bound is not reached in u.
    pub(super) fn ends(&self) -> [f64; 2] {
        match self.scale {
            Scale::Linear => self.bounds,
            Scale::Log => self.bounds.map(f64::ln),
            Scale::Logit => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The bound of that side.
    pub(super) fn bound(&self, side: Side) -> f64 {
        self.bounds[usize::from(side == Side::Upper)]
    }

    /// Whether u drifts towards a finite bound that it never reaches.
    pub(super) fn drifts_to(&self, side: Side) -> bool {
        let at = usize::from(side == Side::Upper);
        self.bounds[at].is_finite() && self.ends()[at].is_infinite()
    }

    /// A start that lies inside where u cannot stand on the bound.
    pub(super) fn inside(&self, start: f64) -> f64 {
        let [low, high] = self.bounds;
        match self.scale {
            Scale::Logit => start.clamp(low + 0.01 * (high - low), high - 0.01 * (high - low)),
            Scale::Log if start <= 0.0 => self.typical.min(high),
            _ => start.clamp(low, high),
        }
    }

    /// What keeps it from being sought, if anything does.
    pub fn fault(&self) -> Option<&'static str> {
        let [low, high] = self.bounds;
        let admissible = |value: &f64| value.is_finite() && (low..=high).contains(value);
        match self.scale {
            _ if low.is_nan() || high.is_nan() || low >= high => Some("its lower bound is not below its upper one"),
            _ if self.start.is_empty() || !self.start.iter().all(admissible) => {
                Some("its start is not within its bounds")
            }
            Scale::Log if low < 0.0 => Some("it moves by its logarithm, and may be negative"),
            Scale::Logit if !(low.is_finite() && high.is_finite()) => Some("it moves between bounds, and has not both"),
            _ if !(self.typical > 0.0 && self.typical.is_finite()) => Some("its typical size is not positive"),
            _ if self.prior.is_some_and(|prior| !(prior.sd > 0.0 && prior.mean.is_finite())) => {
                Some("the standard deviation of its prior is not positive")
            }
            _ => None,
        }
    }
}
