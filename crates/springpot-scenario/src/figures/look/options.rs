//! The options of the look of a figure: a field of [`Look`] and a row each.

use super::super::{CURVES, DRAWN, PLANE, ROBOT};
use super::{FigureFormat, FigureLabel, RangeEnd, Said};
use crate::keys::{Key, Need, Shape, key};

/// How a figure looks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Look {
    /// Along x.
    pub x: AxisLook,
    /// Along y.
    pub y: AxisLook,
    /// Lengths along x and y have one scale.
    pub is_equal: bool,
    /// Width and height, m.
    pub size: Option<[f64; 2]>,
    /// What columns are called.
    pub labels: Vec<FigureLabel>,
    /// What stands above the legend.
    pub legend: Option<String>,
    /// There is no legend.
    pub hides_legend: bool,
    /// Only rows with t from the first to the second are drawn, s.
    pub window: Option<[f64; 2]>,
    /// The files that are written.
    pub formats: Vec<FigureFormat>,
    /// From where the robot is seen: turned about z, and above the horizon, degrees.
    pub view: Option<[f64; 2]>,
    /// Nothing of the robot is named.
    pub hides_names: bool,
    /// Where each option was asked for.
    pub said: Vec<Said>,
}

/// How one axis looks.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AxisLook {
    /// From where to where it runs.
    pub range: Option<[RangeEnd; 2]>,
    /// It is logarithmic.
    pub is_log: bool,
    /// What stands at it, its unit included.
    pub label: Option<String>,
}

/// An option of the look of a figure: a key of `[[figure]]`, and, where it is spelt for them, an option of `springpot plot` and an argument in Python.
#[derive(Debug, Clone, Copy)]
pub struct LookOption {
    pub(super) key: Key,
    /// As an option of the command; nothing where it is of scenarios alone.
    pub spelt: Option<Spelt>,
    /// What may stand there, and where it goes.
    pub takes: Takes,
}

/// An option as the command has it.
#[derive(Debug, Clone, Copy)]
pub struct Spelt {
    /// Its name without the dashes.
    pub option: &'static str,
    /// What stands for its value in help.
    pub value: &'static str,
    /// What help says of it.
    pub help: &'static str,
    /// The option that takes it away, and what help says of that, where there is one.
    pub without: Option<(&'static str, &'static str)>,
}

/// What an option may take, and where in a [`Look`] that goes.
#[derive(Debug, Clone, Copy)]
pub enum Takes {
    /// First and last value of an axis.
    Range(fn(&mut Look) -> &mut Option<[RangeEnd; 2]>),
    /// One of a few words, of which one says something.
    Flag {
        /// What the words are.
        of: &'static str,
        /// The word.
        word: &'static str,
        /// Set where it stands there.
        at: fn(&mut Look) -> &mut bool,
    },
    /// A text.
    Text(fn(&mut Look) -> &mut Option<String>),
    /// A text, or that there is none.
    TextOrFalse {
        /// The text.
        text: fn(&mut Look) -> &mut Option<String>,
        /// Set where there is none.
        hides: fn(&mut Look) -> &mut bool,
    },
    /// Width and height, m.
    Size(fn(&mut Look) -> &mut Option<[f64; 2]>),
    /// Two times, s.
    Times(fn(&mut Look) -> &mut Option<[f64; 2]>),
    /// Two angles, degrees.
    Direction(fn(&mut Look) -> &mut Option<[f64; 2]>),
    /// Texts by column.
    Labels,
    /// Formats of files.
    Formats,
}

impl LookOption {
    /// Its name: the key of a scenario, and the argument in Python.
    pub const fn name(&self) -> &'static str {
        self.key.name
    }

    /// The words that it may be; none where it takes no words.
    pub fn choices(&self) -> Vec<&'static str> {
        self.key.choices()
    }
}

const SCALES: fn() -> Vec<&'static str> = || vec!["linear", "log"];

/// The options, in the order in which they are listed.
pub const OPTIONS: [LookOption; 13] = [
    LookOption {
        key: range("x_range", "First and last value of x, in the unit it is drawn in or as quantities."),
        spelt: spelt(
            "x-range",
            "A,B",
            "First and last value of x, in its unit or as quantities, such as 0,10 or 5ms,8ms",
        ),
        takes: Takes::Range(|look| &mut look.x.range),
    },
    LookOption {
        key: range("y_range", "First and last value of y, in the unit it is drawn in or as quantities."),
        spelt: spelt("y-range", "A,B", "First and last value of y"),
        takes: Takes::Range(|look| &mut look.y.range),
    },
    LookOption {
        key: scale("x_scale", "Scale of x."),
        spelt: spelt("x-scale", "SCALE", "Scale of x: linear or log"),
        takes: Takes::Flag { of: "scale", word: "log", at: |look| &mut look.x.is_log },
    },
    LookOption {
        key: scale("y_scale", "Scale of y."),
        spelt: spelt("y-scale", "SCALE", "Scale of y: linear or log"),
        takes: Takes::Flag { of: "scale", word: "log", at: |look| &mut look.y.is_log },
    },
    LookOption {
        key: key("aspect", Shape::Words(|| vec!["equal"]), Need::Optional, "Equal: x and y have one scale.")
            .only(&[CURVES]),
        spelt: spelt("aspect", "ASPECT", "equal: x and y have one scale, so that a circle is round"),
        takes: Takes::Flag { of: "aspect", word: "equal", at: |look| &mut look.is_equal },
    },
    LookOption {
        key: key("size", Shape::Pair("m"), Need::Said("150 mm wide"), "Width and height of the page."),
        spelt: spelt("size", "WIDTH,HEIGHT", "Width and height of the page, such as 90mm,60mm [default: 150 mm wide]"),
        takes: Takes::Size(|look| &mut look.size),
    },
    LookOption {
        key: key("x_label", Shape::Text, Need::Optional, "What stands at x, its unit included.").only(&PLANE),
        spelt: spelt("x-label", "TEXT", "What stands at x, its unit included"),
        takes: Takes::Text(|look| &mut look.x.label),
    },
    LookOption {
        key: key("y_label", Shape::Text, Need::Optional, "What stands at y, its unit included.").only(&PLANE),
        spelt: spelt("y-label", "TEXT", "What stands at y, its unit included"),
        takes: Takes::Text(|look| &mut look.y.label),
    },
    LookOption {
        key: key(
            "labels",
            Shape::TextsByNameOrFalse,
            Need::Optional,
            "What columns are called, by column or glob; false: nothing of the robot is named.",
        ),
        spelt: spelt("label", "COLUMN=TEXT", "What a column is called; may be given several times"),
        takes: Takes::Labels,
    },
    LookOption {
        key: key("legend", Shape::TextOrFalse, Need::Optional, "What stands above the legend; false: there is none.")
            .only(&DRAWN),
        spelt: Some(Spelt {
            option: "legend",
            value: "TEXT",
            help: "What stands above the legend",
            without: Some(("no-legend", "Draw no legend")),
        }),
        takes: Takes::TextOrFalse { text: |look| &mut look.legend, hides: |look| &mut look.hides_legend },
    },
    LookOption {
        key: key("window", Shape::Pair("s"), Need::Said("the whole run"), "Only rows with t in between are drawn.")
            .only(&PLANE),
        spelt: spelt("window", "A,B", "Draw only rows with t from A to B, in s or with a unit"),
        takes: Takes::Times(|look| &mut look.window),
    },
    LookOption {
        key: key(
            "formats",
            Shape::WordList(|| FigureFormat::ALL.map(FigureFormat::name).to_vec()),
            Need::Said("[\"svg\", \"png\"]"),
            "The files that are written.",
        ),
        // The command writes what it draws, and lists them with its files.
        spelt: None,
        takes: Takes::Formats,
    },
    LookOption {
        key: key(
            "view",
            Shape::Pair("deg"),
            Need::Said("where least is hidden"),
            "From where the robot is seen: the turn about z and the height above the horizon.",
        )
        .only(&[ROBOT]),
        spelt: None,
        takes: Takes::Direction(|look| &mut look.view),
    },
];

/// Their keys.
pub(in crate::figures) const KEYS: [Key; OPTIONS.len()] = {
    let (mut keys, mut k) = ([OPTIONS[0].key; OPTIONS.len()], 0);
    while k < keys.len() {
        keys[k] = OPTIONS[k].key;
        k += 1;
    }
    keys
};

const fn spelt(option: &'static str, value: &'static str, help: &'static str) -> Option<Spelt> {
    Some(Spelt { option, value, help, without: None })
}

const fn range(name: &'static str, words: &'static str) -> Key {
    key(name, Shape::Range, Need::Said("what is drawn"), words).only(&DRAWN)
}

const fn scale(name: &'static str, words: &'static str) -> Key {
    key(name, Shape::Words(SCALES), Need::Word("linear"), words).only(&PLANE)
}
