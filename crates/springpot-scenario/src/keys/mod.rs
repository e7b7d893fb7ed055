//! The keys of a scenario, as data: name, what may stand there, what stands for it where it is left out, words.
//!
//! Everything that lists keys reads these tables: the readers (which keys there are, units, ranges, defaults), what is suggested in
//! the place of a misspelt one, the JSON schema, and a test that compares them with the tables of docs/scenario/.

mod constants;
mod controller;
mod data;
mod design;
mod element;
mod event;
mod heat;
mod kind_of_motion;
mod metric;
mod motion;
mod output;
mod robot;
mod sensitivity;
pub(crate) mod solver;
mod sweep;
#[cfg(test)]
mod tests;

pub(crate) use constants::SCALAR;
pub(crate) use controller::{
    CONDITIONAL, CONTROLLER, ControllerKind, GRIPPER_PATH, Gained, Gains, MEASUREMENT, MOVE, NOISE, NONE, REFERENCE,
    TRAPEZOID,
};
pub(crate) use data::{CREEP, DATA, DATA_COLUMN, DMA, FIT, HUBER, RELAXATION, RUN, STROKE};
pub(crate) use design::{CONSTRAINT, DESIGN};
pub(crate) use element::{
    BETWEEN, BUSHING, COMPONENT, COMPONENTS, ELEMENT, ELEMENT_FIELDS, END, HELD, LONE, ON_JOINT, PASTS, RESERVED_NAMES,
    START as AT_START,
};
pub(crate) use event::{ACTION, EVENT, RECORD, STOP};
pub(crate) use heat::{ARRHENIUS, EXPANSION, SHIFT, THERMAL};
pub(crate) use kind_of_motion::{MOTION, MotionKind};
pub(crate) use metric::METRIC;
pub use metric::MetricKind;
pub(crate) use motion::{FLOATING, FORCES, POSE, SEPARATOR, SIGNAL, SPHERICAL, START, START_POSE, START_VELOCITIES};
pub(crate) use output::OUTPUT;
pub(crate) use robot::{
    ANCHOR, BODY, CHANGED_JOINT, END_STOPS, FRICTION, FROM_MJCF, FROM_URDF, INERTIA, JOINT, MIMIC, ROBOT,
};
pub(crate) use sensitivity::{ADJOINT, FORWARD, PARAMETER, PRIOR, SENSITIVITY};
pub(crate) use solver::{FORWARD_RUNS, SOLVER, SOLVER_FIELDS, TIME, TIMES};
pub use sweep::MAX_CASES;
pub(crate) use sweep::{MAX_BLOCKS, MAX_TOGETHER, SPAN, SWEEP};

use crate::text::names;
use crate::text::refusal::RefusalKind;
use serde_json::{Map, Value, json};
use springpot::model::JointKind;
use std::borrow::Cow;

/// What stands for three numbers that a file leaves out, by their key; `None` where it is the key of no such.
pub(crate) fn vector(name: &str) -> Option<[f64; 3]> {
    let tables = [&ROBOT, &BODY, &JOINT, &END, &ANCHOR, &POSE, &START_POSE];
    tables.into_iter().flat_map(|table| table.keys).find(|key| key.name == name).and_then(|key| match key.need {
        Need::Vector(default) => Some(default),
        _ => None,
    })
}

/// A table of a scenario and its keys.
#[derive(Debug)]
pub(crate) struct Keys {
    /// What a table of this kind is, where several may stand in one place.
    pub(crate) words: &'static str,
    /// In the order in which messages list them.
    pub(crate) keys: &'static [Key],
}

/// One key.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) shape: Shape,
    pub(crate) need: Need,
    /// What it says, as a sentence; nothing where it follows from its kinds.
    pub(crate) words: &'static str,
    /// The kinds of its table that it belongs to, such as the kinds of motion; empty: all.
    pub(crate) only: &'static [&'static str],
}

/// What may stand under a key.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shape {
    /// Any text.
    Text,
    /// A name of the scenario's own, but none of these.
    Name(&'static [&'static str]),
    /// The name of a file, without an ending.
    FileName,
    /// One of these words.
    Words(fn() -> Vec<&'static str>),
    /// One of the kinds of its table: their names, and what they are.
    Kinds(fn() -> Vec<(&'static str, &'static str)>),
    /// true or false.
    Flag,
    /// A number or a quantity in a unit; an empty unit is that of a pure number.
    Number(&'static str, Bound),
    /// A number as above, or this word.
    NumberOrWord(&'static str, Bound, &'static str),
    /// A number that belongs to a joint: in the first unit where it turns, in the second where it slides.
    JointNumber([&'static str; 2], Bound),
    /// A number that belongs to a joint as above, or a table of them by coordinates.
    JointNumbers([&'static str; 2], Bound),
    /// A number of a joint as above, or this word.
    JointNumberOrWord([&'static str; 2], Bound, &'static str),
    /// A whole number from the first on, to the second if there is one.
    Whole(i64, Option<i64>),
    /// Three numbers in a unit.
    Vector(&'static str),
    /// Two numbers in a unit.
    Pair(&'static str),
    /// Two numbers or quantities of what is drawn.
    Range,
    /// Any number of numbers in a unit, zero and above, or a table that says them.
    NumbersOr(&'static str, &'static Keys),
    /// A number in the unit of a parameter, such as an end of a span.
    SweptNumber,
    /// So many numbers at least and at most in the unit of the parameter; where one may stand, it may stand alone.
    SweptNumbers(usize, usize),
    /// A number in the unit of a column.
    OfColumn,
    /// A function of time in a unit.
    Signal(&'static str),
    /// Three functions of time in a unit.
    Signals(&'static str),
    /// A text, or an array of texts.
    Texts,
    /// A path of a parameter, or an array of so many at most.
    Paths(usize),
    /// An array of texts.
    TextList,
    /// A column.
    Column,
    /// A column or glob, or an array of them.
    Columns,
    /// A table.
    Table(&'static Keys),
    /// A table, or an array of them.
    TableOrTables(&'static Keys),
    /// An array of tables, so many at most where that is said.
    Tables(&'static Keys, Option<usize>),
    /// A number that belongs to a joint as above, or a table, or a table of such by coordinates.
    JointNumberOr([&'static str; 2], Bound, &'static Keys),
    /// One of these words, or a table.
    WordsOr(fn() -> Vec<&'static str>, &'static Keys),
    /// Values, or a table that says them.
    ValuesOr(&'static Keys),
    /// A table with a value for each joint.
    ByJoint(Each),
    /// A number for all joints, or a table with one for each.
    ByJointOrNumber,
    /// A table with keys of its own and with how joints move.
    TableWithJoints(&'static Keys),
    /// A table of texts under names that other keys give.
    TextsByName,
    /// A table of texts as above, or false.
    TextsByNameOrFalse,
    /// A text, or false.
    TextOrFalse,
    /// An array of these words.
    WordList(fn() -> Vec<&'static str>),
    /// A table of columns of a file, each a name or a table, under names that other keys give.
    ColumnsByName(&'static Keys),
    /// A table of anything under names that other keys give.
    ByName,
    /// A table of numbers in any units, under names of its own.
    Scalars,
    /// A unit, or a table of units under names that other keys give.
    UnitOrByName,
    /// A law of the catalog.
    Law,
    /// A named scheme, or the exact memory.
    Scheme,
}

/// What a table by joints holds for each of them.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Each {
    /// How it moves: a signal, or the pose of a floating joint.
    Path,
    /// What its actuator gives: a signal, or the six of a floating joint.
    Force,
    /// A coordinate.
    Coordinate,
    /// A number in units of its own, zero and above.
    Number,
    /// A number, or a table for a floating joint.
    NumberOr(&'static Keys),
}

/// Which numbers are right.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bound {
    /// All finite ones.
    Any,
    /// Zero and above; what is below is refused where it is used, with words of its own.
    NotNegative,
    /// Zero and above, since it is a length.
    Length,
    /// Above zero.
    Positive,
    /// An interval, and what to write.
    Within(f64, f64, &'static str),
}

/// Whether a key must be there, and what stands for it where it is left out.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Need {
    /// It must be written in the file, as these words say.
    Written(&'static str),
    /// It must be there, as these words say; the file may leave it to a sweep.
    Required(&'static str),
    /// It must be there and tell the kind of a table; the file may leave it to a sweep.
    Kind,
    /// It or another one must be there.
    OneOf,
    /// Nothing stands for it.
    Optional,
    /// This number.
    Number(f64),
    /// These numbers.
    Vector([f64; 3]),
    /// This.
    Flag(bool),
    /// This word.
    Word(&'static str),
    /// What these words say.
    Said(&'static str),
}

pub(crate) const fn key(name: &'static str, shape: Shape, need: Need, words: &'static str) -> Key {
    Key { name, shape, need, words, only: &[] }
}

impl Key {
    /// The same key, of these kinds only.
    pub(crate) const fn only(self, only: &'static [&'static str]) -> Self {
        Self { only, ..self }
    }

    /// What stands for it where it is left out, as a file would say it; `None` where nothing does, or it cannot be left out.
    pub(crate) fn default(&self) -> Option<String> {
        match self.need {
            Need::Written(_) | Need::Required(_) | Need::Kind | Need::OneOf | Need::Optional => None,
            Need::Number(number) if number != 0.0 && number.abs() < 0.01 => Some(format!("{number:e}")),
            Need::Number(number) => Some(number.to_string()),
            Need::Vector([x, y, z]) => Some(format!("[{x}, {y}, {z}]")),
            Need::Flag(flag) => Some(flag.to_string()),
            Need::Word(word) => Some(format!("{word:?}")),
            Need::Said(words) => Some(words.to_owned()),
        }
    }

    /// What to write where it must be there and is not.
    pub(crate) fn right(&self) -> Cow<'static, str> {
        match (self.need, self.shape) {
            (Need::Written(right) | Need::Required(right), _) => right.into(),
            (Need::Kind, Shape::Table(keys)) => {
                let kind = keys.get("kind").map(Self::right).unwrap_or_default();
                format!("[{}] with {kind}", self.name).into()
            }
            (Need::Kind, _) => {
                let choices = self.choices().into_iter().map(|choice| format!("{choice:?}"));
                format!("{} = {}", self.name, names::either(choices)).into()
            }
            _ => self.name.into(),
        }
    }

    /// What it says, as a sentence; of the kinds of a table, what they are.
    pub(crate) fn sentence(&self) -> Cow<'static, str> {
        let Shape::Kinds(kinds) = self.shape else { return self.words.into() };
        let kinds: Vec<&str> = kinds().into_iter().map(|(_, words)| words).collect();
        let (last, others) = kinds.split_last().expect("a table of kinds has some");
        format!("{}, or {last}.", others.join(", ")).into()
    }

    /// The words that may stand there; none where it takes no words.
    pub(crate) fn choices(&self) -> Vec<&'static str> {
        match self.shape {
            Shape::Words(words) | Shape::WordsOr(words, _) | Shape::WordList(words) => words(),
            Shape::Kinds(kinds) => kinds().into_iter().map(|(name, _)| name).collect(),
            _ => Vec::new(),
        }
    }
}

impl Need {
    /// Whether something must be there, in the file or by a sweep.
    pub(crate) fn is_required(self) -> bool {
        matches!(self, Self::Required(_) | Self::Kind)
    }
}

impl Keys {
    /// All names, in their order.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.keys.iter().map(|key| key.name).collect()
    }

    /// Names that belong to the kind `kind` of the table.
    pub(crate) fn names_for(&self, kind: &str) -> Vec<&'static str> {
        self.of(kind).map(|key| key.name).collect()
    }

    /// Keys that belong to the kind `kind` of the table.
    pub(crate) fn of<'k>(&self, kind: &'k str) -> impl Iterator<Item = &'static Key> + use<'k> {
        let keys = self.keys;
        keys.iter().filter(move |key| key.only.is_empty() || key.only.contains(&kind))
    }

    /// Keys that belong to other kinds of the table than `kind`.
    pub(crate) fn not_of<'k>(&self, kind: &'k str) -> impl Iterator<Item = &'static Key> + use<'k> {
        let keys = self.keys;
        keys.iter().filter(move |key| !key.only.is_empty() && !key.only.contains(&kind))
    }

    /// Whether `name` belongs to some kinds of the table only.
    pub(crate) fn is_of_a_kind(&self, name: &str) -> bool {
        self.get(name).is_some_and(|key| !key.only.is_empty())
    }

    /// Why the key `name` of `owner`, a joint of this kind, is none of its own, where it is of other kinds.
    pub(crate) fn without_meaning(&self, name: &str, owner: &str, kind: JointKind) -> Option<(RefusalKind, String)> {
        let message = || format!("`{name}` of {owner} has no meaning: a {} joint {}", kind.name(), kind.says());
        self.is_of_a_kind(name).then(|| (RefusalKind::Rule, message()))
    }

    /// The key of that name.
    pub(crate) fn get(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

impl Shape {
    /// The unit of a signal, of three, or nothing.
    pub(crate) fn signal_unit(self) -> &'static str {
        match self {
            Self::Signal(unit) | Self::Signals(unit) => unit,
            _ => "",
        }
    }
}

/// Where the number under a key goes.
pub(crate) enum Slot<'t> {
    Number(&'t mut f64),
    Perhaps(&'t mut Option<f64>),
    Count(&'t mut Option<u64>),
}

/// A key that is a field of what is made of its table. What a file says of it is put there, and the record of a run takes it from
/// there.
pub(crate) type Field<T> = (&'static str, fn(&mut T) -> Slot<'_>);

/// The fields of `made` as the record of a run has them.
pub(crate) fn record<T: Clone>(fields: &[Field<T>], made: &T) -> Map<String, Value> {
    let mut made = made.clone();
    let value = |slot: Slot<'_>| match slot {
        Slot::Number(number) => json!(number),
        Slot::Perhaps(number) => json!(number),
        Slot::Count(count) => json!(count),
    };
    fields.iter().map(|(key, slot)| ((*key).to_owned(), value(slot(&mut made)))).collect()
}
