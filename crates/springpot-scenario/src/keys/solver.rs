//! `[time]` and `[solver]`, and where the numbers of `[solver]` go.

use super::sweep::SCALE;
use super::{Bound, Field, Keys, Need, Shape, Slot, key};
use springpot::methods::fixed::Method;
use springpot::system::{Adaptive, Settings};

pub(crate) static TIME: Keys = Keys {
    words: "Duration and rows.",
    keys: &[
        key(
            "end",
            Shape::Number("s", Bound::Positive),
            Need::Required("end = \"10 s\""),
            "Duration; the motion starts at t = 0.",
        ),
        key(
            "output_step",
            Shape::Number("s", Bound::Positive),
            Need::OneOf,
            "Rows at its multiples, and one at the end.",
        ),
        key(
            "output_times",
            Shape::NumbersOr("s", &TIMES),
            Need::OneOf,
            "Rows at these increasing times and nowhere else.",
        ),
    ],
};

/// Most rows of one run.
pub(crate) const MAX_ROWS: f64 = 2e7;

const TIMES_KEYS: &str = "from, to and count";

pub(crate) static TIMES: Keys = Keys {
    words: "Times from one to another.",
    keys: &[
        key("from", Shape::Number("s", Bound::NotNegative), Need::Written(TIMES_KEYS), "The first."),
        key("to", Shape::Number("s", Bound::Positive), Need::Written(TIMES_KEYS), "The last, not beyond `end`."),
        key("count", Shape::Whole(2, Some(MAX_ROWS as i64)), Need::Written(TIMES_KEYS), "How many."),
        SCALE,
    ],
};

/// Methods that choose their steps.
pub(crate) const ADAPTIVE: [Adaptive; 2] = [Adaptive::Explicit, Adaptive::Radau];
/// Their names.
pub(crate) fn adaptive() -> impl Iterator<Item = &'static str> + Clone {
    ADAPTIVE.into_iter().filter_map(Adaptive::name)
}
/// Methods with steps of one size.
pub(crate) const FIXED: [Method; 2] = [Method::BackwardEuler, Method::Midpoint];
/// Smallest error of the memory's kernel; it is a hundredth of `rtol` where nothing else is said, and not below this.
pub(crate) const SMALLEST_MEMORY_RTOL: f64 = 1e-12;
const LARGEST_RTOL: f64 = 0.1;
const SUCH_AS: &str = "write a relative error such as 1e-9";
/// What steps of one size have no use for.
pub(crate) const OF_CHOSEN_STEPS: [&str; 3] = ["atol", "first_step", "max_step"];
/// The kind of motion that follows from forces.
pub(crate) const FORWARD_RUNS: &str = "forward";
const FORWARD: &[&str] = &[FORWARD_RUNS];

/// The kinds of it that `only` knows: `forward`, runs of that kind of motion.
pub(crate) static SOLVER: Keys = Keys {
    words: "Accuracy and steps.",
    keys: &[
        key(
            "rtol",
            Shape::Number("", Bound::Within(1e-13, LARGEST_RTOL, SUCH_AS)),
            Need::Number(1e-9),
            "Error of every D^alpha x, relative to its largest value so far; forward: of q and v.",
        ),
        key(
            "atol",
            Shape::Number("", Bound::Positive),
            Need::Said("none"),
            "Errors below this are not looked at: of D^alpha x; forward: of q and v.",
        ),
        key(
            "memory_rtol",
            Shape::Number("", Bound::Within(SMALLEST_MEMORY_RTOL, LARGEST_RTOL, SUCH_AS)),
            Need::Said("rtol/100, not below 1e-12"),
            "Relative error of the memory's kernel.",
        ),
        key(
            "first_step",
            Shape::Number("s", Bound::Positive),
            Need::Said(
                "max_step/64, less where rows come before its end or springpots in series begin with a jump; forward: chosen by the run",
            ),
            "First inner step.",
        ),
        key(
            "max_step",
            Shape::Number("s", Bound::Positive),
            Need::Said("end/500; forward, where nothing varies with time: end/50"),
            "Largest inner step.",
        ),
        key(
            "max_steps",
            Shape::Whole(1, None),
            Need::Said("10 000 000, and 100 more for every switch of a signal"),
            "Most inner steps of one case.",
        ),
        key(
            "method",
            Shape::Words(|| adaptive().chain(FIXED.map(Method::name)).collect()),
            Need::Said("chosen by the run: \"explicit\" or \"radau\""),
            "How it steps; \"explicit\" and \"radau\" choose their steps.",
        )
        .only(FORWARD),
        key(
            "step",
            Shape::Number("s", Bound::Positive),
            Need::Optional,
            "The step of \"backward-euler\" and \"midpoint\".",
        )
        .only(FORWARD),
    ],
};

/// Its keys that are numbers of the settings.
pub(crate) const SOLVER_FIELDS: &[Field<Settings>] = &[
    ("rtol", |settings| Slot::Number(&mut settings.rtol)),
    ("atol", |settings| Slot::Perhaps(&mut settings.atol)),
    ("memory_rtol", |settings| Slot::Number(&mut settings.memory_rtol)),
    ("first_step", |settings| Slot::Perhaps(&mut settings.first_step)),
    ("max_step", |settings| Slot::Perhaps(&mut settings.max_step)),
    ("max_steps", |settings| Slot::Count(&mut settings.max_steps)),
];
