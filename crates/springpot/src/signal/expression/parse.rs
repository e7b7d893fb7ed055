//! Precedence climbing (V. R. Pratt, "Top down operator precedence", POPL 1973) from text to a postfix program.

use super::error::ExpressionError;
use super::of_stroke::VARIABLES;
use super::program::{MAX_DEPTH, MAX_LENGTH, MAX_STACK, NAMES, Name, Op, Trace, lookup, run};
use crate::signal::jet::Smooth;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

const SIGN: u8 = 5;

pub(super) fn program(text: &str, constants: &[(String, f64)]) -> Result<Vec<Op>, ExpressionError> {
    program_of(text, constants, &[]).map(|(program, _)| program)
}

/// The program of an expression that may name columns, and those that it names.
pub(super) fn program_of(
    text: &str,
    constants: &[(String, f64)],
    columns: &[&str],
) -> Result<(Vec<Op>, Vec<usize>), ExpressionError> {
    check(text, columns)?;
    Parser { constants, columns, ..Parser::of(text) }.whole()
}

/// Refuses what is too long, or compares.
fn check(text: &str, columns: &[&str]) -> Result<(), ExpressionError> {
    if text.len() > MAX_LENGTH {
        return Err(ExpressionError::TooLong { length: text.len(), limit: MAX_LENGTH });
    }
    match condition(text, columns) {
        Some(at) => Err(ExpressionError::Condition { found: text[at.clone()].to_owned(), at }),
        None => Ok(()),
    }
}

/// The same where constants called `open` stay open: they are columns behind those that it names, each of them whether it occurs or not.
pub(super) fn program_of_columns_and_open(
    text: &str,
    constants: &[(String, f64)],
    columns: &[&str],
    open: &[&str],
) -> Result<(Vec<Op>, Vec<usize>), ExpressionError> {
    if text.len() > MAX_LENGTH {
        return Err(ExpressionError::TooLong { length: text.len(), limit: MAX_LENGTH });
    }
    let (mut program, mut named) = Parser { constants, columns, open, ..Parser::of(text) }.whole()?;
    for op in &mut program {
        if let Op::Column(k) = op
            && *k >= columns.len()
        {
            *k = *k - columns.len() + named.len();
        }
    }
    named.extend((0..open.len()).map(|k| columns.len() + k));
    Ok((program, named))
}

/// The program of an expression of a stroke and its rate, and the names of its parameters, which are columns behind those two.
pub(super) fn program_of_stroke(text: &str) -> Result<(Vec<Op>, Vec<String>), ExpressionError> {
    check(text, &[])?;
    let mut parser = Parser { open: &VARIABLES, free: Some(Vec::new()), ..Parser::of(text) };
    let program = parser.read()?;
    Ok((program, parser.free.unwrap_or_default()))
}

/// The program of an expression in which constants of these names stay open: they are its columns, by their places here.
pub(super) fn program_of_open(text: &str, open: &[&str]) -> Result<Vec<Op>, ExpressionError> {
    if text.len() > MAX_LENGTH {
        return Err(ExpressionError::TooLong { length: text.len(), limit: MAX_LENGTH });
    }
    Parser { open, ..Parser::of(text) }.whole().map(|(program, _)| program)
}

/// Where a text compares or decides, as other languages do, with signs that no column has in its name.
fn condition(text: &str, columns: &[&str]) -> Option<Range<usize>> {
    let is_sign = |c: char| matches!(c, '<' | '>' | '=' | '?' | '&' | '|' | '\u{2264}' | '\u{2265}');
    let sign = text.char_indices().find(|(_, c)| is_sign(*c) && !columns.iter().any(|column| column.contains(*c)));
    let word = ["if ", "if(", "where(", "piecewise("].iter().find(|word| text.trim_start().starts_with(**word));
    match (word, sign) {
        (Some(word), _) => {
            let start = text.len() - text.trim_start().len();
            Some(start..start + word.len() - 1)
        }
        (None, Some((at, c))) => Some(at..at + c.len_utf8()),
        (None, None) => None,
    }
}

/// Length of the number that `text` starts with: `digits[.digits][e[+-]digits]`, at least one digit before the exponent.
pub fn number_length(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(0);
    let (mut end, mut given) = (whole, whole);
    if bytes.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        given += fraction;
        end += 1 + fraction;
    }
    if given == 0 {
        return None;
    }
    // An e that no digits follow is not part of the number.
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let from = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if from < bytes.len() && digits(from) > 0 {
            end = from + digits(from);
        }
    }
    Some(end)
}

struct Parser<'a> {
    text: &'a str,
    constants: &'a [(String, f64)],
    columns: &'a [&'a str],
    /// Constants that are columns of the program.
    open: &'a [&'a str],
    /// Where names that nobody knows are columns behind those: these names.
    free: Option<Vec<String>>,
    at: usize,
    depth: usize,
    /// Intermediate results on the stack after the program so far.
    height: usize,
    program: Vec<Op>,
    /// The columns that occur.
    named: Vec<usize>,
}

impl<'a> Parser<'a> {
    fn of(text: &'a str) -> Self {
        let (program, named) = (Vec::new(), Vec::new());
        Self { text, constants: &[], columns: &[], open: &[], free: None, at: 0, depth: 0, height: 0, program, named }
    }

    /// The program of the whole text, and the columns that it names.
    fn whole(mut self) -> Result<(Vec<Op>, Vec<usize>), ExpressionError> {
        Ok((self.read()?, self.named))
    }

    fn read(&mut self) -> Result<Vec<Op>, ExpressionError> {
        self.expression(0)?;
        match self.peek() {
            None => Ok(std::mem::take(&mut self.program)),
            Some(_) => Err(self.unexpected("an operator")),
        }
    }

    /// An operand and every operator after it that binds more tightly than `floor`.
    fn expression(&mut self, floor: u8) -> Result<(), ExpressionError> {
        if self.depth == MAX_DEPTH {
            return Err(self.too_deep());
        }
        self.depth += 1;
        self.operand()?;
        while let Some(c) = self.peek() {
            let (op, left, right) = match c {
                '+' => (Op::Add, 1, 2),
                '-' | '\u{2212}' => (Op::Subtract, 1, 2),
                '*' | '\u{b7}' | '\u{22c5}' => (Op::Multiply, 3, 4),
                '/' => (Op::Divide, 3, 4),
                '^' => (Op::Power, 8, 7),
                ')' | ',' => break,
                _ => return Err(self.unexpected("an operator (a product is written with `*`)")),
            };
            if left < floor {
                break;
            }
            self.at += c.len_utf8();
            self.expression(right)?;
            self.emit(op)?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), ExpressionError> {
        const WANTED: &str = "a number, t, a function or a parenthesis";
        match self.peek() {
            Some(c @ ('-' | '\u{2212}')) => {
                self.at += c.len_utf8();
                self.expression(SIGN)?;
                self.emit(Op::Negate)
            }
            Some('+') => {
                self.at += 1;
                self.expression(SIGN)
            }
            Some('(') => {
                let open = self.at;
                self.at += 1;
                self.expression(0)?;
                self.close(open)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some('*') if self.text[..self.at].ends_with('*') => {
                Err(self.unexpected("a factor (a power is written `^`)"))
            }
            _ => Err(self.unexpected(WANTED)),
        }
    }

    fn number(&mut self) -> Result<(), ExpressionError> {
        let rest = &self.text[self.at..];
        let Some(length) = number_length(rest) else {
            return Err(self.unexpected("a number"));
        };
        let at = self.at..self.at + length;
        self.at = at.end;
        match rest[..length].parse::<f64>() {
            Ok(value) if value.is_finite() => self.emit(Op::Number(value)),
            _ => Err(ExpressionError::NotFinite { number: shown(&rest[..length]), at }),
        }
    }

    fn name(&mut self) -> Result<(), ExpressionError> {
        let rest = &self.text[self.at..];
        if let Some(column) = self.column(rest) {
            self.at += self.columns[column].len();
            let known = self.named.iter().position(|named| *named == column);
            let place = known.unwrap_or_else(|| {
                self.named.push(column);
                self.named.len() - 1
            });
            return self.emit(Op::Column(place));
        }
        let name = &rest[..rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len())];
        let at = self.at..self.at + name.len();
        self.at = at.end;
        match lookup(name) {
            Some(Name::Operand(Op::Time)) if self.free.is_some() => Err(ExpressionError::Time { at }),
            Some(Name::Operand(op)) => self.emit(op),
            Some(Name::Function(op)) if self.peek() == Some('(') => self.call(name, op, at.start),
            Some(Name::Function(_)) => Err(ExpressionError::NeedsParentheses { function: name.to_owned(), at }),
            None if self.open.contains(&name) => {
                // Behind all that may be named.
                let place = self.open.iter().position(|open| *open == name).unwrap_or(0);
                self.emit(Op::Column(self.columns.len() + place))
            }
            None if self.free.is_some() && !matches!(self.peek(), Some('(' | '.')) => {
                let free = self.free.get_or_insert_default();
                let place = free.iter().position(|free| free == name).unwrap_or_else(|| {
                    free.push(name.to_owned());
                    free.len() - 1
                });
                let place = self.columns.len() + self.open.len() + place;
                self.emit(Op::Column(place))
            }
            None => match self.constants.iter().find(|(constant, _)| constant == name) {
                Some(&(_, value)) => self.emit(Op::Number(value)),
                None if !self.columns.is_empty() => {
                    // The dots of its columns belong to a name here.
                    let length = rest.find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.')));
                    let name = &rest[..length.unwrap_or(rest.len())];
                    let near = nearest_column(name, self.columns).map(str::to_owned);
                    let of_module = || of_module(name).map(str::to_owned);
                    let suggestion = near.or_else(of_module).or_else(|| suggest(name, self.constants));
                    let at = at.start..at.start + name.len();
                    Err(ExpressionError::UnknownName { name: shown(name), suggestion, at })
                }
                None => {
                    let length = rest.find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.')));
                    let whole = &rest[..length.unwrap_or(rest.len())];
                    if let Some(own) = of_module(whole) {
                        let (name, suggestion) = (shown(whole), Some(own.to_owned()));
                        return Err(ExpressionError::UnknownName {
                            name,
                            suggestion,
                            at: at.start..at.start + whole.len(),
                        });
                    }
                    let suggestion = suggest(name, self.constants);
                    Err(ExpressionError::UnknownName { name: shown(name), suggestion, at })
                }
            },
        }
    }

    /// The column with the longest name that `rest` begins with: names may hold dots and signs.
    fn column(&self, rest: &str) -> Option<usize> {
        let ends =
            |name: &str| !rest[name.len()..].starts_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '.'));
        let fits = |name: &str| name.contains('.') && rest.starts_with(name) && ends(name);
        let found = self.columns.iter().enumerate().filter(|(_, name)| fits(name));
        found.max_by_key(|(_, name)| name.len()).map(|(k, _)| k)
    }

    fn call(&mut self, name: &str, op: Op, start: usize) -> Result<(), ExpressionError> {
        let open = self.at;
        self.at += 1;
        let any_number = matches!(op, Op::Min | Op::Max);
        let mut given = 0;
        if self.peek() != Some(')') {
            loop {
                self.expression(0)?;
                given += 1;
                if any_number && given > 1 {
                    self.emit(op)?;
                }
                if self.peek() != Some(',') {
                    break;
                }
                self.at += 1;
            }
        }
        self.close(open)?;
        let wanted = match op.operands() {
            1 => "one argument",
            _ if any_number => "two or more arguments",
            _ => "two arguments",
        };
        if given != op.operands() && !(any_number && given > 1) {
            let (function, at) = (name.to_owned(), start..self.at);
            return Err(ExpressionError::ArgumentCount { function, wanted, given, at });
        }
        if any_number { Ok(()) } else { self.emit(op) }
    }

    fn close(&mut self, open: usize) -> Result<(), ExpressionError> {
        match self.peek() {
            Some(')') => {
                self.at += 1;
                Ok(())
            }
            None => Err(ExpressionError::Unclosed { at: open..open + 1 }),
            Some(_) => Err(self.unexpected("`)`")),
        }
    }

    /// Appends an instruction; one whose operands are all numbers is carried out at once.
    fn emit(&mut self, op: Op) -> Result<(), ExpressionError> {
        self.height = self.height + 1 - op.operands();
        if self.height > MAX_STACK {
            return Err(self.too_deep());
        }
        self.program.push(op);
        let start = self.program.len() - 1 - op.operands();
        let operands = &self.program[start..self.program.len() - 1];
        if !operands.is_empty() && operands.iter().all(|op| matches!(op, Op::Number(_))) {
            let value = run(&self.program[start..], 0.0_f64, &mut Trace::default());
            self.program.truncate(start);
            self.program.push(Op::Number(value));
        }
        self.unfold();
        Ok(())
    }

    /// Inverse functions of what they undo lose half their digits at their kinks: asin(sin u), acos(cos u), sqrt(u^2) and their like
    /// become the wave that they are.
    fn unfold(&mut self) {
        use Op::{AcosCos, AsinSin, Multiply, Negate, Number, Power};
        use Smooth::{Acos, Asin, Cos, Sin, Sqrt};
        // π/2 − wave.
        let opposite = |wave: Op| vec![wave, Negate, Number(FRAC_PI_2), Op::Add];
        let (count, instead) = match self.program[..] {
            [.., Op::Smooth(Sin), Op::Smooth(Asin)] => (2, vec![AsinSin]),
            [.., Op::Smooth(Cos), Op::Smooth(Acos)] => (2, vec![AcosCos]),
            [.., Op::Smooth(Cos), Op::Smooth(Asin)] => (2, opposite(AcosCos)),
            [.., Op::Smooth(Sin), Op::Smooth(Acos)] => (2, opposite(AsinSin)),
            [.., Number(0.5), Power] => {
                self.program.truncate(self.program.len() - 2);
                self.program.push(Op::Smooth(Sqrt));
                return self.unfold();
            }
            [.., Number(2.0), Power, Op::Smooth(Sqrt)] => (3, vec![Op::Abs]),
            [.., Number(n), Power, Op::Smooth(Sqrt)] if n > 0.0 && n % 2.0 == 0.0 => {
                (3, vec![Op::Abs, Number(0.5 * n), Power])
            }
            [.., Multiply, Op::Smooth(Sqrt)] => {
                let second = self.operand_start(self.program.len() - 3);
                let first = self.operand_start(second - 1);
                if self.program[first..second] != self.program[second..self.program.len() - 2] {
                    return;
                }
                (self.program.len() - second, vec![Op::Abs])
            }
            _ => return,
        };
        self.program.truncate(self.program.len() - count);
        self.program.extend(instead);
    }

    /// Where the instructions begin whose result the instruction at `last` leaves.
    fn operand_start(&self, last: usize) -> usize {
        let (mut at, mut wanted) = (last, self.program[last].operands());
        while wanted > 0 {
            at -= 1;
            wanted = wanted - 1 + self.program[at].operands();
        }
        at
    }

    /// The next character that is not blank.
    fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest.chars().next()
    }

    fn here(&self) -> Range<usize> {
        let width = self.text[self.at..].chars().next().map_or(0, char::len_utf8);
        self.at..self.at + width
    }

    fn too_deep(&self) -> ExpressionError {
        ExpressionError::TooDeep { at: self.here() }
    }

    fn unexpected(&self, wanted: &'static str) -> ExpressionError {
        let at = self.here();
        match &self.text[at.clone()] {
            "" => ExpressionError::UnexpectedEnd { wanted, at },
            found => ExpressionError::Unexpected { found: found.to_owned(), wanted, at },
        }
    }
}

/// A name or number as messages show it: of one that fills pages the beginning.
fn shown(text: &str) -> String {
    const MOST: usize = 4096;
    let end = text.char_indices().nth(MOST).map_or(text.len(), |(end, _)| end);
    if end == text.len() { text.to_owned() } else { format!("{}…", &text[..end]) }
}

/// Spellings that people try, and ours.
const OTHER_SPELLINGS: [(&str, &str); 12] = [
    ("ln", "log"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("arctan2", "atan2"),
    ("sgn", "sign"),
    ("signum", "sign"),
    ("heaviside", "step"),
    ("pow", "^"),
    ("power", "^"),
    ("time", "t"),
    ("fabs", "abs"),
];

/// What a name of another language's module is called here: `sin` for `np.sin`.
fn of_module(name: &str) -> Option<&str> {
    let (_, word) = name.rsplit_once('.')?;
    let other = OTHER_SPELLINGS.iter().find(|(other, _)| *other == word).map(|(_, ours)| *ours);
    other.or_else(|| lookup(word).is_some().then_some(word))
}

/// Whether a name is one of ours behind that of another language's module, as in `np.sin`.
pub fn is_of_module(name: &str) -> bool {
    const MODULES: [&str; 8] = ["np", "numpy", "math", "Math", "sp", "scipy", "torch", "jnp"];
    let module = name.split('.').next().unwrap_or_default();
    MODULES.contains(&module) && of_module(name).is_some()
}

fn suggest(name: &str, constants: &[(String, f64)]) -> Option<String> {
    let lower = name.to_lowercase();
    let spelled = OTHER_SPELLINGS.iter().find(|(other, _)| *other == lower).map(|(_, ours)| *ours);
    let meant = spelled.or_else(|| NAMES.iter().map(|(known, _)| *known).find(|known| *known == lower));
    meant.or_else(|| nearest(name, constants)).map(str::to_owned)
}

fn nearest<'c>(name: &str, constants: &'c [(String, f64)]) -> Option<&'c str> {
    // Long names are nobody's slip, and the distance takes quadratic time.
    if name.len() > 16 || name.chars().count() < 3 {
        return None;
    }
    let own = constants.iter().map(|(constant, _)| constant.as_str());
    let known = NAMES.iter().map(|(known, _)| *known).chain(own).filter(|known| known.len() > 2);
    let measured = known.map(|known| (strsim::damerau_levenshtein(name, known), known));
    measured.filter(|(distance, _)| *distance <= 2).min_by_key(|(distance, _)| *distance).map(|(_, known)| known)
}

fn nearest_column<'c>(name: &str, columns: &[&'c str]) -> Option<&'c str> {
    // Longer names resemble nothing.
    if name.len() > 64 {
        return None;
    }
    let measured = columns.iter().map(|known| (strsim::damerau_levenshtein(name, known), *known));
    measured.filter(|(distance, _)| *distance <= 2).min_by_key(|(distance, _)| *distance).map(|(_, known)| known)
}
