//! `[[metric]]`.

use super::{Keys, Need, Shape, key};
use crate::plan::metrics::MetricKind;

/// The kinds that look for a band.
const WITH_BAND: [&str; 5] = ["settling-time", "overshoot", "frequency", "log-decrement", "residual-vibration"];

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
        key("target", Shape::OfColumn, Need::Said("the last row"), "Where the column is to go.").only(&WITH_BAND),
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
    }
}
