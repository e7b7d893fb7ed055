//! The TOML text as a tree in which every key and value knows where it stands.

use crate::text::names;
use crate::text::refusal::{Place, Refusal, RefusalKind, Refusals, Source};
use std::ops::Range;
use std::sync::Arc;
use toml::de::{DeTable, DeValue};

/// Largest scenario file, bytes.
pub(crate) const MAX_BYTES: u64 = 4 << 20;
/// Most values in one array.
const MAX_ITEMS: usize = 1_000_000;
/// Most keys in one table.
const MAX_KEYS: usize = 10_000;
/// Deepest nesting of tables and arrays.
const MAX_DEPTH: usize = 24;
/// Stack of the thread that reads the text: nested inline tables with dotted keys are dropped by recursion.
const PARSER_STACK: usize = 64 << 20;

/// A value and its place. Children are shared, so that a case of a sweep copies only what it changes.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) place: Place,
    /// Which swept parameter stands here.
    pub(crate) tag: Option<usize>,
}

/// What a TOML value can be.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Text(String),
    /// A TOML integer or float; `integer` is set for integers that fit.
    Number {
        value: f64,
        integer: Option<i64>,
    },
    Boolean(bool),
    Date,
    Array(Vec<Arc<Node>>),
    Table(Vec<Entry>),
}

/// One key of a table.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) key_place: Place,
    pub(crate) node: Arc<Node>,
}

impl Node {
    /// Reads a whole document.
    pub(crate) fn document(source: &Arc<Source>) -> Result<Self, Refusals> {
        on_a_deep_stack(source, || {
            let table = DeTable::parse(&source.text).map_err(|error| syntax(source, &error))?;
            let value = Builder { source, offset: 0 }.table(table.get_ref(), 0)?;
            Ok(Self { value, place: place(source, 0..0), tag: None })
        })
    }

    /// Reads one value that stands at `range` of the source; `None` where it is not TOML.
    pub(crate) fn value(source: &Arc<Source>, range: Range<usize>) -> Result<Option<Self>, Refusals> {
        on_a_deep_stack(source, || {
            let Some(Ok(value)) = source.text.get(range.clone()).map(DeValue::parse) else { return Ok(None) };
            let builder = Builder { source, offset: range.start };
            builder.node(value.get_ref(), value.span(), 0).map(Some)
        })
    }

    /// The same, with its places in another source.
    pub(crate) fn moved_to(&self, source: &Arc<Source>) -> Self {
        let place = |place: &Place| Place { source: source.clone(), span: place.span.clone() };
        let value = match &self.value {
            Value::Array(items) => Value::Array(items.iter().map(|item| Arc::new(item.moved_to(source))).collect()),
            Value::Table(entries) => Value::Table(
                entries
                    .iter()
                    .map(|entry| Entry {
                        key: entry.key.clone(),
                        key_place: place(&entry.key_place),
                        node: Arc::new(entry.node.moved_to(source)),
                    })
                    .collect(),
            ),
            value => value.clone(),
        };
        Self { value, place: place(&self.place), tag: self.tag }
    }

    /// A table without keys.
    pub(crate) fn empty_table(place: &Place) -> Self {
        Self { value: Value::Table(Vec::new()), place: place.clone(), tag: None }
    }

    pub(crate) fn entries(&self) -> Option<&[Entry]> {
        match &self.value {
            Value::Table(entries) => Some(entries),
            _ => None,
        }
    }

    pub(crate) fn items(&self) -> Option<&[Arc<Node>]> {
        match &self.value {
            Value::Array(items) => Some(items),
            _ => None,
        }
    }

    pub(crate) fn get(&self, key: &str) -> Option<&Arc<Node>> {
        self.entries()?.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    pub(crate) fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The value in the words of its author, shortened.
    pub(crate) fn written(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("{:?}", shorten(text)),
            Value::Boolean(value) => value.to_string(),
            _ => shorten(self.place.text()),
        }
    }

    /// The value for a legend or a column: texts without their quotes, everything else as it stands in the file.
    pub(crate) fn label(&self) -> String {
        match &self.value {
            Value::Text(text) => text.clone(),
            Value::Number { value, .. } if value.is_finite() && self.place.text().parse::<f64>() != Ok(*value) => {
                shortest(*value)
            }
            _ => self.place.text().to_owned(),
        }
    }

    /// Kind of value, with its article.
    pub(crate) fn kind(&self) -> &'static str {
        match &self.value {
            Value::Text(_) => "the text",
            Value::Number { .. } => "the number",
            Value::Boolean(_) => "the boolean",
            Value::Date => "the date",
            Value::Array(_) => "the array",
            Value::Table(_) => "the table",
        }
    }

    /// Place of a stretch of this text value; the whole value where there is none or escapes hide it.
    pub(crate) fn place_in_text(&self, range: Option<Range<usize>>) -> Place {
        let (Some(range), Value::Text(text)) = (range, &self.value) else { return self.place.clone() };
        let raw = self.place.text();
        let is_quoted_by = |quotes: &usize| {
            raw.len().checked_sub(2 * quotes) == Some(text.len()) && raw.get(*quotes..raw.len() - quotes) == Some(text)
        };
        let Some(quotes) = [0, 1, 3].into_iter().find(is_quoted_by) else { return self.place.clone() };
        let start = (self.place.span.start + quotes + range.start).min(self.place.span.end);
        let end = (self.place.span.start + quotes + range.end).clamp(start, self.place.span.end);
        Place { source: self.place.source.clone(), span: start..end }
    }
}

/// The shortest text that reads back to the same number.
pub(crate) fn shortest(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// The whole number that a number is, where it is one.
pub(crate) fn whole(number: f64) -> Option<i64> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    (number.fract() == 0.0 && number.abs() <= EXACT).then_some(number as i64)
}

/// At most 60 characters of a text, on one line.
pub(crate) fn shorten(text: &str) -> String {
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(61).collect();
    match line.char_indices().nth(60) {
        Some((at, _)) => format!("{}…", &line[..at]),
        None => line,
    }
}

fn place(source: &Arc<Source>, span: Range<usize>) -> Place {
    Place { source: source.clone(), span }
}

fn syntax(source: &Arc<Source>, error: &toml::de::Error) -> Refusal {
    let span = error.span().unwrap_or(0..0);
    let help = syntax_help(&source.text, &span, error.message());
    let message = match source.text.get(span.start..).and_then(|text| text.chars().next()) {
        Some(quote) if is_typographic(quote) => format!("{quote} is a quote of running text, not of TOML"),
        _ => format!("not TOML: {}", error.message()),
    };
    place(source, span).refuse(RefusalKind::Syntax, message).help_if(help)
}

fn is_typographic(c: char) -> bool {
    matches!(c, '“' | '”' | '„' | '‟' | '‘' | '’' | '‚' | '«' | '»' | '´' | '`')
}

/// A line as it would be with straight quotes.
fn with_straight_quotes(line: &str) -> String {
    line.trim().chars().map(|c| if is_typographic(c) { '"' } else { c }).collect()
}

/// `KEY = VALUE` for a line that has a colon, as YAML and JSON have it.
fn with_equals_sign(line: &str) -> Option<String> {
    let (key, value) = line.split_once(':')?;
    let key = key.trim().trim_matches('"');
    let value = value.trim().trim_end_matches(',');
    let is_key = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'));
    if !is_key || value.is_empty() {
        return None;
    }
    let is_value =
        value.parse::<f64>().is_ok() || value.starts_with(['"', '\'', '[', '{']) || value == "true" || value == "false";
    Some(if is_value { format!("{key} = {value}") } else { format!("{key} = \"{value}\"") })
}

/// What is likely meant where a text is not TOML.
fn syntax_help(text: &str, span: &Range<usize>, message: &str) -> Option<String> {
    if message.contains("duplicate key") {
        let line_start = text.get(..span.start)?.rfind('\n').map_or(0, |at| at + 1);
        let line = text[line_start..].lines().next()?.trim();
        let key = line.split('=').next()?.trim();
        let is_same = |earlier: &str| match line.starts_with('[') {
            true => earlier.trim() == line,
            false => earlier.split_once('=').is_some_and(|(start, _)| start.trim() == key),
        };
        let first = text[..line_start].lines().position(is_same)?;
        return Some(format!("{key} stands on line {} already: write it once", first + 1));
    }
    let letter = text.get(span.start..)?.chars().next()?;
    let start = text[..span.start].rfind('\n').map_or(0, |at| at + 1);
    let line = text[start..].lines().next()?;
    if is_typographic(letter) {
        return Some(format!("write straight quotes: {}", shorten(&with_straight_quotes(line))));
    }
    if let Some(right) = with_equals_sign(line).filter(|_| message.contains("expected `=`") || letter == ':') {
        return Some(format!("write {}", shorten(&right)));
    }
    if let Some(name) = names::greek(letter) {
        return Some(format!("write {name} for {letter}"));
    }
    mistaken_value(span, start, line)
}

/// What is likely meant by a line of which a value is none of TOML: a comment, a number, a word.
fn mistaken_value(span: &Range<usize>, start: usize, line: &str) -> Option<String> {
    let (before, at) = (line.get(..span.start - start)?, line.get(span.start - start..)?);
    let outside = |text: &str| text.matches('"').count().is_multiple_of(2);
    if let Some(comment) = line.find("//").filter(|comment| outside(&line[..*comment])) {
        let (kept, words) = (&line[..comment], line[comment + 2..].trim());
        return Some(format!("a comment begins with #: write {}", shorten(format!("{kept}# {words}").trim())));
    }
    let heading = line.split('#').next().unwrap_or(line).trim();
    if heading.starts_with('[') && !heading.contains('=') {
        let (open, close) = if heading.starts_with("[[") { ("[[", "]]") } else { ("[", "]") };
        let name = heading.trim_matches(['[', ']']);
        return (!heading.ends_with(close)).then(|| format!("write {open}{}{close}", shorten(name)));
    }
    // The value that the place lies in: from the sign or bracket before it to the one behind.
    let from = before.rfind(['=', '[', '{']).map_or(0, |at| at + 1);
    let comma = before.rfind(',').filter(|comma| *comma >= from).map_or(from, |comma| comma + 1);
    let to = |from: usize| line[from..].find([',', ']', '}', '#']).map_or(line.len(), |length| from + length);
    let key = before.split('=').next().map(str::trim).filter(|_| before.contains('='))?;
    let whole = |value: &str| match before.matches('=').count() == 1 && !before.contains(['[', '{']) {
        true => format!("write {key} = {value}"),
        false => format!("write {value}"),
    };
    if let Some(behind) = at.strip_prefix(',')
        && let Some(digits) = behind.find(|c: char| !c.is_ascii_digit()).or(Some(behind.len())).filter(|n| *n > 0)
    {
        let (unit, number) =
            (behind[digits..].split(['#', ']', '}']).next().unwrap_or("").trim(), before[from..].trim());
        let number = format!("{number}.{}", &behind[..digits]);
        let value = if unit.is_empty() { number } else { format!("\"{number} {unit}\"") };
        return Some(format!("{}: numbers have a decimal point", whole(&value)));
    }
    let value = line[comma..to(comma)].trim();
    match value.to_lowercase().as_str() {
        "" => return None,
        "true" | "yes" | "on" => return Some(whole("true")),
        "false" | "no" | "off" => return Some(whole("false")),
        "none" | "null" | "nil" | "nan" => {
            return Some(format!("leave {key} out: a key without a value is not written"));
        }
        _ => {}
    }
    if value.contains(';') {
        return Some("write commas between values, and points in numbers, as in [0.1, 0, 0]".to_owned());
    }
    let sign = value.strip_prefix(['-', '+']).map_or("", |_| &value[..1]);
    let digits = &value[sign.len()..];
    let is_number = |text: &str| text.parse::<f64>().is_ok() && text.contains(|c: char| c.is_ascii_digit());
    if let Some(fraction) = digits.strip_prefix('.').filter(|_| is_number(digits)) {
        return Some(format!("{}: a digit stands before the point", whole(&format!("{sign}0.{fraction}"))));
    }
    if digits.ends_with('.') && is_number(digits) {
        return Some(format!("{}: a digit stands behind the point", whole(&format!("{sign}{digits}0"))));
    }
    // What is half quoted is something else.
    (!value.contains(['"', '\''])).then(|| {
        format!("{}: quantities, words and expressions stand in quotes", whole(&format!("\"{}\"", shorten(value))))
    })
}

/// Runs `read` on a thread whose stack holds the deepest tree the parser lets through.
fn on_a_deep_stack<T: Send>(
    source: &Arc<Source>,
    read: impl FnOnce() -> Result<T, Refusals> + Send,
) -> Result<T, Refusals> {
    let refuse = |message: &str| place(source, 0..0).refuse(RefusalKind::Syntax, message);
    std::thread::scope(|scope| match std::thread::Builder::new().stack_size(PARSER_STACK).spawn_scoped(scope, read) {
        Ok(reader) => reader.join().unwrap_or_else(|_| Err(refuse("the TOML reader broke down on this text").into())),
        Err(error) => Err(refuse(&format!("no thread to read the text: {error}")).into()),
    })
}

struct Builder<'s> {
    source: &'s Arc<Source>,
    /// Where the parsed text starts in the source.
    offset: usize,
}

impl Builder<'_> {
    fn place(&self, span: Range<usize>) -> Place {
        place(self.source, span.start + self.offset..span.end + self.offset)
    }

    fn refuse(&self, span: Range<usize>, message: String) -> Refusals {
        self.place(span).refuse(RefusalKind::TooLarge, message).into()
    }

    fn table(&self, table: &DeTable<'_>, depth: usize) -> Result<Value, Refusals> {
        if table.len() > MAX_KEYS {
            let span = table.keys().next().map_or(0..0, toml::Spanned::span);
            return Err(self.refuse(span, format!("a table of {} keys; at most {MAX_KEYS} are taken", table.len())));
        }
        let mut entries = Vec::with_capacity(table.len());
        for (key, value) in table {
            entries.push(Entry {
                key: key.get_ref().to_string(),
                key_place: self.place(key.span()),
                node: Arc::new(self.node(value.get_ref(), value.span(), depth + 1)?),
            });
        }
        entries.sort_by_key(|entry| entry.key_place.span.start);
        Ok(Value::Table(entries))
    }

    fn node(&self, value: &DeValue<'_>, span: Range<usize>, depth: usize) -> Result<Node, Refusals> {
        if depth > MAX_DEPTH {
            return Err(self.refuse(span, format!("nested more than {MAX_DEPTH} levels deep")));
        }
        let value = match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(number) => integer(number.as_str(), number.radix()),
            DeValue::Float(number) => float(number.as_str()),
            DeValue::Boolean(value) => Value::Boolean(*value),
            DeValue::Datetime(_) => Value::Date,
            DeValue::Array(items) if items.len() > MAX_ITEMS => {
                let message = format!("an array of {} values; at most {MAX_ITEMS} are taken", items.len());
                return Err(self.refuse(span, message));
            }
            DeValue::Array(items) => Value::Array(
                items
                    .iter()
                    .map(|item| self.node(item.get_ref(), item.span(), depth + 1).map(Arc::new))
                    .collect::<Result<_, _>>()?,
            ),
            DeValue::Table(table) => self.table(table, depth)?,
        };
        Ok(Node { value, place: self.place(span), tag: None })
    }
}

fn integer(digits: &str, radix: u32) -> Value {
    match i64::from_str_radix(digits, radix) {
        Ok(integer) => Value::Number { value: integer as f64, integer: Some(integer) },
        Err(_) if radix == 10 => float(digits),
        Err(_) => {
            let scale = f64::from(radix);
            let digit = |c: char| f64::from(c.to_digit(radix).unwrap_or(0));
            Value::Number { value: digits.chars().fold(0.0, |sum, c| sum * scale + digit(c)), integer: None }
        }
    }
}

fn float(digits: &str) -> Value {
    Value::Number { value: digits.parse().unwrap_or(f64::NAN), integer: None }
}
