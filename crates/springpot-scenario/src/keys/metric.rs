//! `[[metric]]`.

use super::{Keys, Need, Shape, key};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The kinds that look for a band.
const WITH_BAND: [&str; 5] = ["settling-time", "overshoot", "frequency", "log-decrement", "residual-vibration"];

/// The kinds that look for a target.
const WITH_TARGET: [&str; 9] = [
    "settling-time",
    "overshoot",
    "frequency",
    "log-decrement",
    "residual-vibration",
    "rise-time",
    "iae",
    "ise",
    "itae",
];

/// The kind that looks for levels.
const WITH_LEVELS: [&str; 1] = ["rise-time"];

pub(crate) static METRIC: Keys = Keys {
    words: "A number that says how good a run is.",
    keys: &[
        key("name", Shape::Name(&[]), Need::Written("name = \"settle\""), "Name."),
        key("of", Shape::Column, Need::Required("of = \"gripper.error\": a column"), "The column that it is taken from."),
        key(
            "kind",
            Shape::Words(|| MetricKind::ALL.map(MetricKind::name).to_vec()),
            Need::Required("kind = \"rms\""),
            "What of it.",
        ),
        key("window", Shape::Pair("s"), Need::Said("the whole run"), "Only rows with t in between count."),
        key(
            "band",
            Shape::OfColumn,
            Need::Said("settling-time 2 %, others 0.1 % of the range"),
            "How far the column may stay from the target, or what swings are above; in % of the way from the first row to the target.",
        )
        .only(&WITH_BAND),
        key("target", Shape::OfColumn, Need::Said("the last row"), "Where the column is to go.").only(&WITH_TARGET),
        key(
            "levels",
            Shape::Pair(""),
            Need::Said("[0.1, 0.9]"),
            "Shares of the way from the first row to the target between which it rises.",
        )
        .only(&WITH_LEVELS),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kinds_with_a_band_are_those_that_use_one() {
        let with: Vec<&str> =
            MetricKind::ALL.into_iter().filter(|kind| kind.takes_band()).map(MetricKind::name).collect();
        assert_eq!(with, WITH_BAND);
        let with: Vec<&str> =
            MetricKind::ALL.into_iter().filter(|kind| kind.takes_target()).map(MetricKind::name).collect();
        assert_eq!(with, WITH_TARGET);
    }
}

/// What is taken from a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MetricKind {
    /// Smallest value.
    Min,
    /// Largest value.
    Max,
    /// Value of the last row.
    Final,
    /// Largest less smallest value.
    PeakToPeak,
    /// Mean over the time.
    Mean,
    /// Root of the mean square over the time.
    Rms,
    /// Time until it stays within the band.
    SettlingTime,
    /// How far it swings past the target.
    Overshoot,
    /// Of its swings.
    Frequency,
    /// Natural logarithm of how much a swing is larger than the next one to the same side.
    LogDecrement,
    /// Half the largest swing.
    ResidualVibration,
    /// Time from one level of the way to the target to another.
    RiseTime,
    /// ∫|e| dt, e = y − target.
    Iae,
    /// ∫e² dt.
    Ise,
    /// ∫(t − t_0)·|e| dt from the start of the window on.
    Itae,
    /// ∫|y| dt.
    Effort,
}

impl MetricKind {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Min,
        Self::Max,
        Self::Final,
        Self::PeakToPeak,
        Self::Mean,
        Self::Rms,
        Self::SettlingTime,
        Self::Overshoot,
        Self::Frequency,
        Self::LogDecrement,
        Self::ResidualVibration,
        Self::RiseTime,
        Self::Iae,
        Self::Ise,
        Self::Itae,
        Self::Effort,
    ];

    /// What stands under `kind`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Final => "final",
            Self::PeakToPeak => "peak-to-peak",
            Self::Mean => "mean",
            Self::Rms => "rms",
            Self::SettlingTime => "settling-time",
            Self::Overshoot => "overshoot",
            Self::Frequency => "frequency",
            Self::LogDecrement => "log-decrement",
            Self::ResidualVibration => "residual-vibration",
            Self::RiseTime => "rise-time",
            Self::Iae => "iae",
            Self::Ise => "ise",
            Self::Itae => "itae",
            Self::Effort => "effort",
        }
    }

    /// The kind of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether a band belongs to it.
    pub const fn takes_band(self) -> bool {
        matches!(self, Self::SettlingTime | Self::Overshoot)
            || matches!(self, Self::Frequency | Self::LogDecrement | Self::ResidualVibration)
    }

    /// Whether a target belongs to it, of some with a band in % alone.
    pub const fn takes_target(self) -> bool {
        self.takes_band() || self.has_target()
    }

    /// Whether a target belongs to it, whatever its band is.
    pub(crate) const fn has_target(self) -> bool {
        matches!(self, Self::SettlingTime | Self::Overshoot | Self::RiseTime | Self::Iae | Self::Ise | Self::Itae)
    }

    /// The unit of its value, where that of the column is `column`; empty for pure numbers.
    pub fn unit(self, column: &str) -> Cow<'_, str> {
        let times = |factor: &str| match column {
            "" => factor.to_owned(),
            _ if column.contains('/') => format!("{factor}*{column}"),
            _ => format!("{column}*{factor}"),
        };
        let is_one = column.chars().all(char::is_alphanumeric);
        match self {
            Self::SettlingTime | Self::RiseTime => "s".into(),
            Self::Frequency => "Hz".into(),
            Self::Overshoot | Self::LogDecrement => "".into(),
            Self::Iae | Self::Effort => times("s").into(),
            Self::Itae => times("s^2").into(),
            Self::Ise if column.is_empty() => "s".into(),
            Self::Ise if is_one => format!("{column}^2*s").into(),
            Self::Ise => format!("({column})^2*s").into(),
            _ => column.into(),
        }
    }
}
