//! The keys of the look of a figure.

use super::super::super::keys::{Key, Need, Shape, key};
use super::super::{CURVES, DRAWN, ROBOT};
use super::FigureFormat;

const SCALES: fn() -> Vec<&'static str> = || vec!["linear", "log"];

pub(in crate::figures) const X_RANGE: Key =
    range("x_range", "First and last value of x, in the unit it is drawn in or as quantities.");
pub(in crate::figures) const Y_RANGE: Key =
    range("y_range", "First and last value of y, in the unit it is drawn in or as quantities.");
pub(in crate::figures) const X_SCALE: Key = scale("x_scale", "Scale of x.");
pub(in crate::figures) const Y_SCALE: Key = scale("y_scale", "Scale of y.");
pub(in crate::figures) const ASPECT: Key =
    key("aspect", Shape::Words(|| vec!["equal"]), Need::Optional, "Equal: x and y have one scale.").only(&[CURVES]);
pub(in crate::figures) const SIZE: Key =
    key("size", Shape::Pair("m"), Need::Said("150 mm wide"), "Width and height of the page.");
pub(in crate::figures) const X_LABEL: Key =
    key("x_label", Shape::Text, Need::Optional, "What stands at x, its unit included.").only(&DRAWN);
pub(in crate::figures) const Y_LABEL: Key =
    key("y_label", Shape::Text, Need::Optional, "What stands at y, its unit included.").only(&DRAWN);
pub(in crate::figures) const LABELS: Key = key(
    "labels",
    Shape::TextsByNameOrFalse,
    Need::Optional,
    "What columns are called, by column or glob; false: nothing of the robot is named.",
);
pub(in crate::figures) const LEGEND: Key =
    key("legend", Shape::TextOrFalse, Need::Optional, "What stands above the legend; false: there is none.")
        .only(&DRAWN);
pub(in crate::figures) const WINDOW: Key =
    key("window", Shape::Pair("s"), Need::Said("the whole run"), "Only rows with t in between are drawn.").only(&DRAWN);
pub(in crate::figures) const FORMATS: Key = key(
    "formats",
    Shape::WordList(|| FigureFormat::ALL.map(FigureFormat::name).to_vec()),
    Need::Said("[\"svg\", \"png\"]"),
    "The files that are written.",
);
pub(in crate::figures) const VIEW: Key = key(
    "view",
    Shape::Pair("deg"),
    Need::Said("where least is hidden"),
    "From where the robot is seen: the turn about z and the height above the horizon.",
)
.only(&[ROBOT]);

const fn range(name: &'static str, words: &'static str) -> Key {
    key(name, Shape::Range, Need::Said("what is drawn"), words).only(&DRAWN)
}

const fn scale(name: &'static str, words: &'static str) -> Key {
    key(name, Shape::Words(SCALES), Need::Word("linear"), words).only(&DRAWN)
}
