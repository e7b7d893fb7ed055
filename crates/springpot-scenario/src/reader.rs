//! Reading tables by hand: every key is asked for by name, everything wrong is noted with its place.

pub(crate) mod constants;
pub(crate) mod element;
pub(crate) mod files;
pub(crate) mod named;
pub(crate) mod spacing;

use self::constants::Constant;
use crate::keys::{self, Bound, Key, Keys, Need, Shape, Slot};
use crate::reader::files::CsvCache;
use crate::reader::files::DescriptionCache;
use crate::text::document::{self, Entry, Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::{Refusal, RefusalKind, Refusals, Remark};
use crate::units::{self, Unit};
use springpot::law::Catalog;
use std::cell::RefCell;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// Most refusals that are collected.
const MAX_REFUSALS: usize = 50;
/// An angle without a unit that is larger may be meant in degrees, rad.
const FAR_TURN: f64 = 4.0 * std::f64::consts::PI;

/// Something was refused; what, is noted in the [`Context`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Refused;

/// A reading: the value, or a note in the context.
pub(crate) type Read<T> = Result<T, Refused>;

/// What the readers share: where names come from, and the list of what is wrong.
pub(crate) struct Context<'a> {
    pub(crate) catalog: &'a Catalog,
    /// Folder that paths in the scenario are relative to.
    pub(crate) folder: &'a Path,
    pub(crate) tables: &'a CsvCache,
    pub(crate) robots: &'a DescriptionCache,
    /// The keys of the whole scenario, which paths begin with.
    pub(crate) whole: &'static Keys,
    refusals: RefCell<Vec<Refusal>>,
    /// SI value of every swept number and its unit, by tag.
    swept: RefCell<Vec<Option<(f64, String)>>>,
    /// The constants read so far.
    constants: RefCell<Vec<Constant>>,
    /// What deserves a warning.
    warnings: RefCell<Vec<Remark>>,
}

impl<'a> Context<'a> {
    pub(crate) fn new(
        catalog: &'a Catalog,
        folder: &'a Path,
        tables: &'a CsvCache,
        robots: &'a DescriptionCache,
    ) -> Self {
        static NONE: Keys = Keys { words: "", keys: &[] };
        let (refusals, swept, constants, warnings) = Default::default();
        Self { catalog, folder, tables, robots, whole: &NONE, refusals, swept, constants, warnings }
    }

    /// Of a scenario with these keys.
    pub(crate) fn of_whole(self, whole: &'static Keys) -> Self {
        Self { whole, ..self }
    }

    /// Notes a refusal.
    pub(crate) fn refuse(&self, refusal: Refusal) -> Refused {
        let mut refusals = self.refusals.borrow_mut();
        if refusals.len() < MAX_REFUSALS {
            refusals.push(refusal);
        }
        Refused
    }

    /// Whether nothing more is noted.
    pub(crate) fn full(&self) -> bool {
        self.refusals.borrow().len() >= MAX_REFUSALS
    }

    /// Whether nothing was noted so far.
    pub(crate) fn is_clean(&self) -> bool {
        self.refusals.borrow().is_empty()
    }

    /// Itself, if nothing was noted so far.
    pub(crate) fn going_on<T>(self, read: Read<T>) -> Result<Self, Refusals> {
        if read.is_ok() && self.refusals.borrow().is_empty() {
            return Ok(self);
        }
        Err(Refusals::of(self.refusals.into_inner()))
    }

    /// The reading if nothing was noted on the way.
    pub(crate) fn finish<T>(self, read: Read<T>) -> Result<T, Refusals> {
        let refusals = self.refusals.into_inner();
        match read {
            Ok(value) if refusals.is_empty() => Ok(value),
            _ => Err(Refusals::of(refusals)),
        }
    }

    /// Notes what deserves a warning.
    pub(crate) fn warn(&self, remark: Remark) {
        let mut warnings = self.warnings.borrow_mut();
        if !warnings.contains(&remark) && warnings.len() < MAX_REFUSALS {
            warnings.push(remark);
        }
    }

    /// What was noted so far.
    pub(crate) fn warnings(&self) -> Vec<Remark> {
        self.warnings.borrow().clone()
    }

    /// Makes a constant known to all expressions that are read from now on.
    pub(crate) fn know(&self, name: &str, value: f64) {
        self.constants.borrow_mut().push((name.to_owned(), value));
    }

    /// The constants read so far.
    pub(crate) fn constants(&self) -> std::cell::Ref<'_, Vec<Constant>> {
        self.constants.borrow()
    }

    /// Remembers the SI value of a swept number and its unit.
    pub(crate) fn note_swept(&self, node: &Node, value: f64, unit: &str) {
        if let Some(tag) = node.tag {
            let mut swept = self.swept.borrow_mut();
            if swept.len() <= tag {
                swept.resize(tag + 1, None);
            }
            swept[tag] = Some((value, unit.to_owned()));
        }
    }

    /// SI value of the swept parameter `tag`, where it was read as a number.
    pub(crate) fn swept(&self, tag: usize) -> Option<f64> {
        self.swept.borrow().get(tag)?.as_ref().map(|(value, _)| *value)
    }

    /// SI unit of the swept parameter `tag`, where it was read as a number.
    pub(crate) fn swept_unit(&self, tag: usize) -> Option<String> {
        self.swept.borrow().get(tag)?.as_ref().map(|(_, unit)| unit.clone())
    }
}

/// All readings, or none if one was refused; all of them are tried.
pub(crate) fn all<T>(reads: impl IntoIterator<Item = Read<T>>) -> Read<Vec<T>> {
    let reads: Vec<_> = reads.into_iter().collect();
    reads.into_iter().collect()
}

/// A table whose unknown keys have been refused.
pub(crate) struct Table<'a> {
    pub(crate) ctx: &'a Context<'a>,
    pub(crate) node: &'a Node,
    /// What it is, for messages.
    pub(crate) what: Arc<str>,
    entries: &'a [Entry],
    /// Its keys, where the scenario's own tables have them.
    keys: Option<&'static Keys>,
    /// Keys that a misspelled key stands for, as already refused.
    suspected: Vec<String>,
}

impl<'a> Table<'a> {
    /// Opens `node` as a table with the keys of `keys`.
    pub(crate) fn of(
        ctx: &'a Context<'a>,
        node: &'a Node,
        what: impl Into<Arc<str>>,
        keys: &'static Keys,
    ) -> Read<Self> {
        Ok(Self { keys: Some(keys), ..Self::open(ctx, node, what, &keys.names())? })
    }

    /// Opens `node` as a table with any keys.
    pub(crate) fn of_any(ctx: &'a Context<'a>, node: &'a Node, what: impl Into<Arc<str>>) -> Read<Self> {
        let keys: Vec<&str> = node.entries().unwrap_or_default().iter().map(|entry| entry.key.as_str()).collect();
        Self::open(ctx, node, what, &keys)
    }

    /// Opens `node` as a table of the kind `kind` with those of `keys` that belong to it; `reason` may say why another one cannot
    /// stand here.
    pub(crate) fn of_kind(
        ctx: &'a Context<'a>,
        node: &'a Node,
        what: impl Into<Arc<str>>,
        (keys, kind): (&'static Keys, &str),
        reason: impl Fn(&str) -> Option<(RefusalKind, String)>,
    ) -> Read<Self> {
        Ok(Self { keys: Some(keys), ..Self::open_with(ctx, node, what, &keys.names_for(kind), reason)? })
    }

    /// Opens `node` as a table that may hold `known` keys.
    pub(crate) fn open(ctx: &'a Context<'a>, node: &'a Node, what: impl Into<Arc<str>>, known: &[&str]) -> Read<Self> {
        Self::open_with(ctx, node, what, known, |_| None)
    }

    /// Opens a table; `reason` may say why a key that is not known cannot stand here.
    pub(crate) fn open_with(
        ctx: &'a Context<'a>,
        node: &'a Node,
        what: impl Into<Arc<str>>,
        known: &[&str],
        reason: impl Fn(&str) -> Option<(RefusalKind, String)>,
    ) -> Read<Self> {
        let what: Arc<str> = what.into();
        let Some(entries) = node.entries() else {
            let message = format!("{what} must be a table, not {} {}", node.kind(), node.written());
            let refusal = node.place.refuse(RefusalKind::WrongType, message).label("not a table");
            let right = format!("write {{ {} = … }}", known.first().copied().unwrap_or("NAME"));
            let help = if known.len() > 1 {
                format!("{right}; its keys are {}", names::list(known.iter().copied()))
            } else {
                right
            };
            return Err(ctx.refuse(refusal.help(help)));
        };
        let mut suspected = Vec::new();
        for entry in entries.iter().filter(|entry| !known.contains(&entry.key.as_str())) {
            if ctx.full() {
                break;
            }
            let key = shorten(&entry.key);
            if let Some((kind, reason)) = reason(&entry.key) {
                ctx.refuse(entry.key_place.refuse(kind, reason));
                continue;
            }
            let other = names::other_word(&entry.key, known);
            let meant = other.or_else(|| names::nearest(&entry.key, known.iter().copied()));
            suspected.extend(meant.map(str::to_owned));
            let message = format!("unknown key `{key}` in {what}");
            let help = other.map(|right| format!("did you mean `{right}`?"));
            ctx.refuse(
                entry
                    .key_place
                    .refuse(RefusalKind::UnknownKey, message)
                    .label("unknown key")
                    .help(help.unwrap_or_else(|| names::suggest(&entry.key, known.iter().copied()))),
            );
        }
        Ok(Self { ctx, node, what, entries, keys: None, suspected })
    }

    /// The field of that name.
    pub(crate) fn get(&self, key: &'a str) -> Option<Field<'a>> {
        let entry = self.entries.iter().find(|entry| entry.key == key)?;
        Some(Field { ctx: self.ctx, node: &entry.node, key, row: self.row(key), owner: self.what.clone() })
    }

    /// What the scenario's tables say of a key.
    fn row(&self, key: &str) -> Option<&'static Key> {
        self.keys.and_then(|keys| keys.get(key))
    }

    /// What stands for `key` where it is left out.
    fn default(&self, key: &str) -> Need {
        self.row(key).map_or(Need::Optional, |row| row.need)
    }

    /// The number under `key`; where it is left out, the one that stands for it.
    pub(crate) fn number(&self, key: &'a str) -> Read<f64> {
        self.joint_number(key, false)
    }

    /// As [`Self::number`], of a joint that slides or turns.
    pub(crate) fn joint_number(&self, key: &'a str, slides: bool) -> Read<f64> {
        match (self.get(key), self.default(key)) {
            (Some(field), _) => field.joint_quantity(slides),
            (None, Need::Number(number)) => Ok(number),
            (None, _) => Err(self.lacks(key)),
        }
    }

    /// The three numbers under `key`; where they are left out, those that stand for them.
    pub(crate) fn vector(&self, key: &'a str) -> Read<[f64; 3]> {
        match (self.get(key), self.default(key)) {
            (Some(field), _) => field.components(),
            (None, Need::Vector(vector)) => Ok(vector),
            (None, _) => Err(self.lacks(key)),
        }
    }

    /// The flag under `key`; where it is left out, what stands for it.
    pub(crate) fn flag(&self, key: &'a str) -> Read<bool> {
        match (self.get(key), self.default(key)) {
            (Some(field), _) => field.boolean(),
            (None, Need::Flag(flag)) => Ok(flag),
            (None, _) => Err(self.lacks(key)),
        }
    }

    /// The word under `key`, `kind` says what it names; where it is left out, the one that stands for it.
    pub(crate) fn word(&self, key: &'a str, kind: &str) -> Read<&'a str> {
        match (self.get(key), self.default(key)) {
            (Some(field), _) => field.word(kind),
            (None, Need::Word(word)) => Ok(word),
            (None, _) => Err(self.lacks(key)),
        }
    }

    /// Puts the numbers of the table into the fields of `made`; where they are left out, what stands for them.
    pub(crate) fn fill<T>(&self, fields: &'static [keys::Field<T>], made: &mut T) -> Read<()> {
        let mut read = Ok(());
        for &(key, slot) in fields {
            let put = match (slot(made), self.get(key)) {
                (Slot::Number(number), None) => match self.default(key) {
                    // It follows from others.
                    Need::Said(_) => Ok(()),
                    _ => self.number(key).map(|value| *number = value),
                },
                (_, None) => Ok(()),
                (Slot::Number(number), Some(field)) => field.quantity().map(|value| *number = value),
                (Slot::Perhaps(number), Some(field)) => field.quantity().map(|value| *number = Some(value)),
                (Slot::Count(count), Some(field)) => field.whole().map(|value| *count = Some(value.unsigned_abs())),
            };
            read = read.and(put);
        }
        read
    }

    /// The field of that name, which must be there.
    pub(crate) fn require(&self, key: &'a str) -> Read<Field<'a>> {
        self.get(key).ok_or_else(|| self.lacks(key))
    }

    /// The field of that name, which must be there; `right` says what to write.
    pub(crate) fn require_with(&self, key: &'a str, right: &str) -> Read<Field<'a>> {
        self.get(key).ok_or_else(|| self.missing(key, right))
    }

    /// Refuses the absence of a key that must be there.
    pub(crate) fn lacks(&self, key: &str) -> Refused {
        match self.row(key) {
            Some(row) => self.missing(key, &row.right()),
            None => self.missing(key, key),
        }
    }

    /// Refuses the absence of `key`, unless a misspelled key stands for it.
    pub(crate) fn missing(&self, key: &str, right: &str) -> Refused {
        if self.suspected.iter().any(|suspect| suspect == key) {
            return Refused;
        }
        let message = format!("{} has no `{key}`", self.what);
        let refusal = self.node.place.refuse(RefusalKind::Missing, message);
        self.ctx.refuse(refusal.label(format!("`{key}` is missing")).help(format!("write {right}")))
    }

    /// Whether a misspelled key stands for `key`.
    pub(crate) fn suspects(&self, key: &str) -> bool {
        self.suspected.iter().any(|suspect| suspect == key)
    }

    /// Keys and values in the order of the text.
    pub(crate) fn fields(&self) -> impl Iterator<Item = Field<'a>> + '_ {
        self.entries.iter().map(|entry| Field {
            ctx: self.ctx,
            node: &entry.node,
            key: &entry.key,
            row: self.row(&entry.key),
            owner: self.what.clone(),
        })
    }
}

/// A value under its key. Shown as "`key` of owner".
#[derive(Clone)]
pub(crate) struct Field<'a> {
    pub(crate) ctx: &'a Context<'a>,
    pub(crate) node: &'a Node,
    pub(crate) key: &'a str,
    /// What the scenario's tables say of it.
    pub(crate) row: Option<&'static Key>,
    pub(crate) owner: Arc<str>,
}

impl fmt::Display for Field<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` of {}", shorten(self.key), self.owner)
    }
}

impl<'a> Field<'a> {
    /// Notes a refusal: `` `key` of owner `` + `message`, pointing at the value.
    pub(crate) fn refuse(&self, kind: RefusalKind, message: impl fmt::Display, help: Option<String>) -> Refused {
        if self.ctx.full() {
            return Refused;
        }
        self.ctx.refuse(self.refusal(kind, message).help_if(help))
    }

    pub(crate) fn refusal(&self, kind: RefusalKind, message: impl fmt::Display) -> Refusal {
        self.node.place.refuse(kind, format!("{self} {message}"))
    }

    /// Refuses the kind of value; `right` says what it must be.
    pub(crate) fn wrong_type(&self, right: &str) -> Refused {
        if self.ctx.full() {
            return Refused;
        }
        let message = format!("must be {right}, not {} {}", self.node.kind(), self.node.written());
        self.ctx.refuse(self.refusal(RefusalKind::WrongType, message).label(format!("expected {right}")))
    }

    /// A text.
    pub(crate) fn text(&self) -> Read<&'a str> {
        self.node.text().ok_or_else(|| self.wrong_type("a text"))
    }

    /// true or false.
    pub(crate) fn boolean(&self) -> Read<bool> {
        match self.node.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(self.wrong_type("true or false")),
        }
    }

    /// The same field of another value: an item of an array.
    pub(crate) fn item(&self, node: &'a Node) -> Self {
        Self { node, ..self.clone() }
    }

    /// The items of an array; `right` says what they must be.
    pub(crate) fn items(&self, right: &str) -> Read<Vec<Field<'a>>> {
        match self.node.items() {
            Some(items) => Ok(items.iter().map(|node| self.item(node)).collect()),
            None => Err(self.wrong_type(right)),
        }
    }

    /// A table with the keys of `keys`.
    pub(crate) fn table(&self, keys: &'static Keys) -> Read<Table<'a>> {
        Table::of(self.ctx, self.node, self.to_string(), keys)
    }

    /// One of the words that may stand here; `kind` says what they name.
    pub(crate) fn word(&self, kind: &str) -> Read<&'a str> {
        let written = self.text()?;
        let choices = self.row.map(Key::choices).unwrap_or_default();
        if choices.contains(&written) {
            return Ok(written);
        }
        let message = format!("is {:?}, which is no {kind}", shorten(written));
        Err(self.refuse(RefusalKind::UnknownName, message, Some(names::suggest(written, choices))))
    }

    /// A whole number from `low` to `high`.
    fn integer(&self, low: i64, high: i64) -> Read<i64> {
        let value = match &self.node.value {
            Value::Table(_) if constants::is_expression(self.node) => {
                let value = constants::expression(self, Some(""), &|_| None)?;
                Value::Number { value, integer: document::whole(value) }
            }
            Value::Number { value, integer: None } => Value::Number { value: *value, integer: document::whole(*value) },
            value => value.clone(),
        };
        match value {
            Value::Number { integer: Some(integer), .. } if (low..=high).contains(&integer) => {
                self.ctx.note_swept(self.node, integer as f64, "");
                Ok(integer)
            }
            Value::Number { value, integer } if integer.is_some() || value.fract() == 0.0 => {
                let message = format!("is {}, outside {low} … {high}", self.node.label());
                let kind = if value > high as f64 { RefusalKind::TooLarge } else { RefusalKind::OutOfRange };
                Err(self.refuse(kind, message, Some(format!("write a whole number from {low} to {high}"))))
            }
            _ => Err(self.wrong_type("a whole number")),
        }
    }

    /// A finite number, SI, or a quantity of the dimension of `unit`.
    pub(crate) fn number(&self, unit: &str) -> Read<f64> {
        self.number_with(unit, &|_| None)
    }

    /// A finite number or quantity whose unit may have the exponents that `exponents` knows.
    pub(crate) fn number_with(&self, unit: &str, exponents: &dyn Fn(&str) -> Option<f64>) -> Read<f64> {
        let value = match &self.node.value {
            Value::Number { value, .. } => *value,
            Value::Text(text) => units::parse_quantity(text, unit, exponents).map_err(|error| {
                if self.ctx.full() {
                    return Refused;
                }
                let place = self.node.place_in_text(error.span());
                let refusal = place.refuse(RefusalKind::BadQuantity, format!("{self}: {error}"));
                self.ctx.refuse(refusal.label(unit_label(unit)).help(unit_help(unit)))
            })?,
            Value::Table(_) if constants::is_expression(self.node) => {
                constants::expression(self, Some(unit), exponents)?
            }
            _ => return Err(self.wrong_type(&format!("a number{}", or_quantity(unit)))),
        };
        if !value.is_finite() {
            let message = format!("is {}, not a finite number", self.node.label());
            return Err(self.refuse(RefusalKind::OutOfRange, message, Some(unit_help(unit))));
        }
        self.ctx.note_swept(self.node, value, unit);
        if unit == "rad" && value.abs() > FAR_TURN && self.node.text().is_none_or(is_bare) {
            let turns = value.abs() / std::f64::consts::TAU;
            let message = format!("{self} is {} without a unit: rad, and so {turns:.1} turns", self.node.label());
            let help = format!("if it is in degrees, write \"{0} deg\"; if not, \"{0} rad\"", self.node.label().trim());
            self.ctx.warn(Remark::at(&self.node.place, message).help(help));
        }
        Ok(value)
    }

    /// A number in the unit and the range of its key.
    pub(crate) fn quantity(&self) -> Read<f64> {
        self.joint_quantity(false)
    }

    /// As [`Self::quantity`], of a joint that slides or turns.
    pub(crate) fn joint_quantity(&self, slides: bool) -> Read<f64> {
        let (unit, bound) = match self.row.map(|row| row.shape) {
            Some(Shape::Number(unit, bound) | Shape::NumberOrWord(unit, bound, _)) => (unit, bound),
            Some(
                Shape::JointNumber(units, bound)
                | Shape::JointNumbers(units, bound)
                | Shape::JointNumberOr(units, bound, _)
                | Shape::JointNumberOrWord(units, bound, _),
            ) => (units[usize::from(slides)], bound),
            _ => ("", Bound::Any),
        };
        match bound {
            Bound::Any | Bound::NotNegative => self.number(unit),
            Bound::Positive => self.positive(unit),
            Bound::Length => {
                let value = self.number(unit)?;
                if value >= 0.0 {
                    return Ok(value);
                }
                let message = format!("is {}, but a length is not negative", self.node.label());
                Err(self.refuse(RefusalKind::OutOfRange, message, Some(unit_help(unit))))
            }
            Bound::Within(low, high, right) => {
                let value = self.number(unit)?;
                if (low..=high).contains(&value) {
                    return Ok(value);
                }
                let message = format!("is {}, outside {low:?} … {high}", self.node.label());
                Err(self.refuse(RefusalKind::OutOfRange, message, Some(right.to_owned())))
            }
        }
    }

    /// Refuses a temperature in degC or degF where a difference of two belongs: these scales have zeros of their own.
    pub(crate) fn refuse_affine(&self) -> Read<()> {
        let in_quantity = self.node.text().and_then(units::split_quantity).map(|(_, unit)| unit);
        let unit = in_quantity.or_else(|| self.node.get("unit")?.text());
        if !unit.is_some_and(|unit| Unit::parse(unit, &|_| None).is_ok_and(|unit| unit.is_affine())) {
            return Ok(());
        }
        let message = format!("is {}, a temperature and no difference of two", self.node.written());
        Err(self.refuse(RefusalKind::BadQuantity, message, Some("write it in K, as in \"2 K\"".to_owned())))
    }

    /// A whole number in the range of its key.
    pub(crate) fn whole(&self) -> Read<i64> {
        match self.row.map(|row| row.shape) {
            Some(Shape::Whole(low, high)) => self.integer(low, high.unwrap_or(i64::MAX)),
            _ => self.integer(i64::MIN, i64::MAX),
        }
    }

    /// Three numbers in the unit of its key.
    pub(crate) fn components(&self) -> Read<[f64; 3]> {
        match self.row.map(|row| row.shape) {
            Some(Shape::Vector(unit)) => self.vector(unit),
            _ => self.vector(""),
        }
    }

    /// A number above zero.
    fn positive(&self, unit: &str) -> Read<f64> {
        let value = self.number(unit)?;
        if value > 0.0 {
            return Ok(value);
        }
        let message = format!("is {}, but must be positive", self.node.label());
        Err(self.refuse(RefusalKind::OutOfRange, message, Some(unit_help(unit))))
    }

    /// Three numbers.
    fn vector(&self, unit: &str) -> Read<[f64; 3]> {
        let right = format!("an array of three numbers{}", or_quantities(unit));
        let items = self.items(&right)?;
        let [x, y, z] = &items[..] else {
            let message = format!("has {} entries, but must be {right}", items.len());
            return Err(self.refuse(RefusalKind::WrongType, message, Some("write [x, y, z]".to_owned())));
        };
        let read = [x.number(unit), y.number(unit), z.number(unit)];
        Ok([read[0]?, read[1]?, read[2]?])
    }
}

/// Whether a text is a number and nothing else.
fn is_bare(text: &str) -> bool {
    text.trim().parse::<f64>().is_ok()
}

fn or_quantity(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" or a quantity in {unit}") }
}

fn or_quantities(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" or quantities in {unit}") }
}

fn unit_label(unit: &str) -> String {
    if unit.is_empty() { "expected a number".to_owned() } else { format!("expected {unit}") }
}

/// What would be right where a number of `unit` is expected.
pub(crate) fn unit_help(unit: &str) -> String {
    if unit.is_empty() {
        "write a number".to_owned()
    } else {
        format!("write a number (in {unit}) or a quantity such as \"1 {unit}\"")
    }
}
