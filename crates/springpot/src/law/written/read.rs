//! From the text of a network to its parts.

use super::{NetworkText, NetworkTextError, Part, PartKind, Said, Source, TableFile, Text};
use crate::law::catalog::{Param, Range};
use crate::law::leaf::{LeafBuild, LeafKind};
use crate::names::is_name;
use crate::signal::StrokeExpression;
use crate::signal::expression::is_name as is_known;
use std::ops::Range as Span;
use std::sync::Arc;

/// Most leaves of a network, and how deep it may be nested.
const MOST_LEAVES: usize = 1_000;
const DEEPEST: usize = 64;

/// Names that leaves may not have: columns of an element.
const COLUMNS: [&str; 9] = ["length", "stroke", "rate", "derivative", "force", "Q", "stored", "dissipated", "input"];

const GRAMMAR: &str = "write leaves such as spring(k), or parts in series(…) and parallel(…)";

/// The network that a text is.
pub(super) fn network(text: &str) -> Result<NetworkText, NetworkTextError> {
    let kinds = LeafKind::all().into_iter().map(Arc::new).collect();
    let params = Params { all: Vec::new(), open: Vec::new(), files: Vec::new(), texts: Vec::new() };
    let mut reader = Reader { text, at: 0, kinds, params, leaves: Vec::new() };
    let root = reader.part(0)?;
    if let Some(rest) = reader.peek() {
        let message = format!("nothing may follow the network, not `{rest}`");
        return Err(reader.error(reader.at..text.len(), message, GRAMMAR));
    }
    let root = reader.named(root)?;
    let Params { all: params, open, files, texts } = reader.params;
    let files = files.into_iter().map(|name| TableFile { name: name.into(), table: None }).collect();
    let texts = texts.into_iter().map(|name| Text { name: name.into(), expression: None }).collect();
    Ok(NetworkText { text: text.to_owned(), root, params, open, files, texts })
}

/// A leaf as it is written.
struct LeafText {
    name: Option<(String, Span<usize>)>,
    kind: Arc<LeafKind>,
    of: Of,
}

/// What a leaf is made of.
#[derive(Clone)]
enum Of {
    /// Where its parameters stand among those of the law.
    Values(Vec<usize>),
    /// Where its file stands among the files.
    File(usize),
    Expression(Source),
}

/// What the leaves of a network name.
struct Params {
    all: Vec<Param>,
    /// Those whose unit no leaf has said.
    open: Vec<usize>,
    files: Vec<String>,
    texts: Vec<String>,
}

/// Where a parameter of an expression stands among all.
pub(super) fn number(all: &mut Vec<Param>, open: &mut Vec<usize>, name: &str) -> usize {
    all.iter().position(|param| param.name == name).unwrap_or_else(|| {
        open.push(all.len());
        all.push(Param::new(name.to_owned(), "", "parameter of an expression", Range::ANY));
        all.len() - 1
    })
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    kinds: Vec<Arc<LeafKind>>,
    params: Params,
    leaves: Vec<LeafText>,
}

/// A part whose leaves are numbers of [`Reader::leaves`].
struct Unnamed {
    span: Span<usize>,
    kind: UnnamedKind,
}

enum UnnamedKind {
    Leaf(usize),
    Parallel(Vec<Unnamed>),
    Series(Vec<Unnamed>),
}

impl Reader<'_> {
    fn error(&self, span: Span<usize>, message: impl Into<String>, help: impl Into<String>) -> NetworkTextError {
        NetworkTextError { message: message.into(), span, help: help.into(), unknown: None }
    }

    /// The next character that is no blank, which is then at `self.at`.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn take(&mut self, wanted: char) -> bool {
        let is_there = self.peek() == Some(wanted);
        self.at += if is_there { wanted.len_utf8() } else { 0 };
        is_there
    }

    /// What stands where something else is wanted.
    fn found(&mut self) -> (Span<usize>, String) {
        match self.peek() {
            None => (self.text.len()..self.text.len(), "the end".to_owned()),
            Some(c) => (self.at..self.at + c.len_utf8(), format!("`{c}`")),
        }
    }

    fn name(&mut self, wanted: &str) -> Result<(String, Span<usize>), NetworkTextError> {
        self.peek();
        let rest = &self.text[self.at..];
        let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-' || c == '.';
        let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        let (span, name) = (self.at..self.at + length, &rest[..length]);
        if length == 0 {
            let (span, found) = self.found();
            return Err(self.error(span, format!("{wanted} is wanted, not {found}"), GRAMMAR));
        }
        if !is_name(name) {
            let is_number = name.starts_with(|c: char| c.is_ascii_digit() || c == '.' || c == '-');
            let help = if is_number {
                "write names of parameters, and their values in `parameters`"
            } else {
                "a name starts with a letter or _, and goes on with letters, digits, _ and -; letters are a to z"
            };
            return Err(self.error(span, format!("{wanted} is wanted, not `{name}`"), help));
        }
        self.at = span.end;
        Ok((name.to_owned(), span))
    }

    fn part(&mut self, depth: usize) -> Result<Unnamed, NetworkTextError> {
        let (mut name, mut span) = self.name("a part")?;
        let start = span.start;
        if depth > DEEPEST {
            return Err(self.error(span, format!("parts may stand in one another {DEEPEST} times at most"), GRAMMAR));
        }
        let mut label = None;
        if self.take(':') {
            label = Some((name, span));
            (name, span) = self.name("a leaf")?;
        }
        let combine = match name.as_str() {
            "series" => Some(UnnamedKind::Series as fn(_) -> _),
            "parallel" => Some(UnnamedKind::Parallel as fn(_) -> _),
            _ => None,
        };
        if let (Some(_), Some((_, at))) = (combine, &label) {
            return Err(self.error(at.clone(), "only leaves have names", "name the leaves in it"));
        }
        let kind = match combine {
            Some(combine) => {
                let open = self.open(&name)?;
                let mut parts = vec![self.part(depth + 1)?];
                while self.take(',') {
                    parts.push(self.part(depth + 1)?);
                }
                self.close(open)?;
                combine(parts)
            }
            None => {
                let leaf = self.leaf(&name, span, label)?;
                self.leaves.push(leaf);
                UnnamedKind::Leaf(self.leaves.len() - 1)
            }
        };
        Ok(Unnamed { span: start..self.at, kind })
    }

    /// Takes the opening parenthesis, and says where it is.
    fn open(&mut self, before: &str) -> Result<usize, NetworkTextError> {
        if self.take('(') {
            return Ok(self.at - 1);
        }
        let (span, found) = self.found();
        Err(self.error(span, format!("`(` is wanted behind `{before}`, not {found}"), GRAMMAR))
    }

    fn close(&mut self, open: usize) -> Result<(), NetworkTextError> {
        if self.take(')') {
            return Ok(());
        }
        match self.found() {
            (_, found) if found == "the end" => {
                Err(self.error(open..open + 1, "this parenthesis is never closed", "write the missing `)`"))
            }
            (span, found) => Err(self.error(span, format!("`,` or `)` is wanted, not {found}"), GRAMMAR)),
        }
    }

    fn leaf(
        &mut self,
        written: &str,
        span: Span<usize>,
        name: Option<(String, Span<usize>)>,
    ) -> Result<LeafText, NetworkTextError> {
        if self.leaves.len() >= MOST_LEAVES {
            return Err(self.error(span, format!("a network has {MOST_LEAVES} leaves at most"), "write fewer"));
        }
        let Some(kind) = self.kinds.iter().find(|kind| kind.name == written).map(Arc::clone) else {
            let known = self.kinds.iter().map(|kind| kind.name).chain(["series", "parallel"]).collect();
            let error = self.error(span, format!("there is no leaf `{written}`"), "");
            return Err(NetworkTextError { unknown: Some((written.to_owned(), known)), ..error });
        };
        let open = self.open(written)?;
        if let LeafBuild::Expression(_) = kind.build
            && let Some(quote @ ('"' | '\'')) = self.peek()
        {
            let said = self.expression(quote, written)?;
            self.close(open)?;
            return Ok(LeafText { name, kind, of: Of::Expression(Source::Here(said)) });
        }
        let mut arguments = vec![];
        if self.peek() != Some(')') {
            arguments.push(self.name("the name of a parameter")?);
            while self.take(',') {
                arguments.push(self.name("the name of a parameter")?);
            }
        }
        self.close(open)?;
        if arguments.len() != kind.params.len() {
            let wanted = kind.params.iter().map(|param| &*param.name).collect::<Vec<_>>().join(", ");
            let names = if kind.params.len() == 1 { "name" } else { "names" };
            let message = format!("`{written}` takes {} {names}, not {}", kind.params.len(), arguments.len());
            let mut help = format!("write {written}({wanted}): {}", kind.equation);
            if let LeafBuild::Expression(_) = kind.build {
                help.push_str(&format!("; or {written}(\"k*x + c*v\", k, c)"));
            }
            return Err(self.error(span.start..self.at, message, help));
        }
        let of = match kind.build {
            LeafBuild::Table(_) => {
                let (file, span) = arguments.swap_remove(0);
                Of::File(self.file(file, span)?)
            }
            LeafBuild::Expression(_) => {
                let (text, span) = arguments.swap_remove(0);
                Of::Expression(Source::Text(self.words_of(text, span)?))
            }
            LeafBuild::Values(_) => {
                let params = kind.params.iter().zip(&arguments).map(|(param, argument)| {
                    let unit = in_arguments(&param.unit, &kind.params, &arguments);
                    let own = Param { name: argument.0.clone().into(), unit: unit.into(), ..param.clone() };
                    self.param(own, argument.1.clone())
                });
                Of::Values(params.collect::<Result<_, _>>()?)
            }
        };
        Ok(LeafText { name, kind, of })
    }

    /// An expression in quotes, and the parameters behind it.
    fn expression(&mut self, quote: char, written: &str) -> Result<Said, NetworkTextError> {
        let start = self.at + quote.len_utf8();
        let Some(length) = self.text[start..].find(quote) else {
            let help = format!("write the missing `{quote}`");
            return Err(self.error(self.at..start, "this quote is never closed", help));
        };
        let source = &self.text[start..start + length];
        let expression = StrokeExpression::parse(source).map_err(|error| {
            let span = error.span().map_or(start..start + length, |span| start + span.start..start + span.end);
            self.error(span, error.to_string(), "an expression of the stroke x, its rate v and parameters")
        })?;
        self.at = start + length + quote.len_utf8();
        let mut named: Vec<(String, Span<usize>)> = Vec::new();
        while self.take(',') {
            let (name, span) = self.name("the name of a parameter")?;
            let error = match name.as_str() {
                "x" | "v" => Some((format!("`{name}` is no parameter: it is the stroke or its rate"), "leave it out")),
                known if is_known(known) => {
                    Some((format!("`{name}` is no parameter: every expression knows it"), "write another name"))
                }
                _ if !expression.parameters().contains(&name) => {
                    Some((format!("`{name}` does not occur in the expression"), "leave it out"))
                }
                _ if named.iter().any(|(other, _)| *other == name) => {
                    Some((format!("`{name}` is named twice"), "leave one out"))
                }
                _ => None,
            };
            if let Some((message, help)) = error {
                return Err(self.error(span, message, help));
            }
            named.push((name, span));
        }
        let own = expression.parameters();
        if let Some(missing) = own.iter().find(|own| !named.iter().any(|(name, _)| name == *own)) {
            let help = format!("write {written}({quote}{source}{quote}, {})", own.join(", "));
            let message = format!("`{missing}` is not named behind the expression");
            return Err(self.error(start..start + length, message, help));
        }
        for (name, span) in &named {
            self.is_no_other(name, span, "a number")?;
            number(&mut self.params.all, &mut self.params.open, name);
        }
        let params = own.iter().map(|name| number(&mut self.params.all, &mut self.params.open, name)).collect();
        Ok(Said { expression: Arc::new(expression), params })
    }

    /// Refuses a name that stands for something else before.
    fn is_no_other(&self, name: &str, span: &Span<usize>, what: &str) -> Result<(), NetworkTextError> {
        let Params { all, files, texts, .. } = &self.params;
        let others = [
            ("a number", all.iter().any(|param| param.name == name)),
            ("a file", files.iter().any(|file| file == name)),
            ("an expression", texts.iter().any(|text| text == name)),
        ];
        match others.into_iter().find(|(other, is_there)| *is_there && *other != what) {
            None => Ok(()),
            Some((other, _)) => {
                let message = format!("`{name}` is {what} here, but {other} before");
                Err(self.error(span.clone(), message, "write another name"))
            }
        }
    }

    /// Where a file stands among those of the law.
    fn file(&mut self, name: String, span: Span<usize>) -> Result<usize, NetworkTextError> {
        self.is_no_other(&name, &span, "a file")?;
        Ok(place(&mut self.params.files, name))
    }

    /// Where the text of an expression stands among those of the law.
    fn words_of(&mut self, name: String, span: Span<usize>) -> Result<usize, NetworkTextError> {
        self.is_no_other(&name, &span, "an expression")?;
        Ok(place(&mut self.params.texts, name))
    }

    /// Where a parameter stands among those of the law; one that is named twice must be the same both times.
    fn param(&mut self, param: Param, span: Span<usize>) -> Result<usize, NetworkTextError> {
        self.is_no_other(&param.name, &span, "a number")?;
        let Params { all, open, .. } = &mut self.params;
        let Some(at) = all.iter().position(|known| known.name == param.name) else {
            all.push(param);
            return Ok(all.len() - 1);
        };
        if open.contains(&at) {
            open.retain(|open| *open != at);
            all[at] = param;
            return Ok(at);
        }
        let (known, unit) = (&mut all[at], |unit: &str| if unit.is_empty() { "a number" } else { unit }.to_owned());
        if known.unit != param.unit {
            let message =
                format!("`{}` is in {} here, but {} before", param.name, unit(&param.unit), unit(&known.unit));
            return Err(self.error(span, message, "write another name"));
        }
        known.range.low = known.range.low.max(param.range.low);
        known.range.high = known.range.high.min(param.range.high);
        Ok(at)
    }

    /// The network, every leaf under its name.
    fn named(&self, root: Unnamed) -> Result<Part, NetworkTextError> {
        let mut names: Vec<Arc<str>> = Vec::with_capacity(self.leaves.len());
        for (k, leaf) in self.leaves.iter().enumerate() {
            let before =
                self.leaves[..k].iter().filter(|other| other.kind.name == leaf.kind.name && other.name.is_none());
            let name = match &leaf.name {
                Some((name, _)) => name.clone(),
                None => format!("{}{}", leaf.kind.name, before.count() + 1),
            };
            names.push(name.into());
        }
        for (k, leaf) in self.leaves.iter().enumerate() {
            let Some((name, span)) = &leaf.name else { continue };
            if names.iter().enumerate().any(|(other, taken)| other != k && **taken == **name) {
                return Err(self.error(span.clone(), format!("there are two leaves `{name}`"), "write another name"));
            }
            if COLUMNS.contains(&name.as_str()) {
                let help = format!("a leaf may not be called {}", COLUMNS.join(", "));
                return Err(self.error(span.clone(), format!("`{name}` is a column of every element"), help));
            }
        }
        Ok(self.finish(&names, root))
    }

    fn finish(&self, names: &[Arc<str>], part: Unnamed) -> Part {
        let all = |parts: Vec<Unnamed>| parts.into_iter().map(|part| self.finish(names, part)).collect();
        let kind = match part.kind {
            UnnamedKind::Parallel(parts) => PartKind::Parallel(all(parts)),
            UnnamedKind::Series(parts) => PartKind::Series(all(parts)),
            UnnamedKind::Leaf(k) => {
                let LeafText { kind, of, .. } = &self.leaves[k];
                let name = names[k].clone();
                match (kind.build, of.clone()) {
                    (LeafBuild::Table(build), Of::File(file)) => PartKind::Table { name, build, file },
                    (LeafBuild::Expression(build), Of::Expression(source)) => {
                        PartKind::Expression { name, build, source }
                    }
                    (_, Of::Values(params)) => PartKind::Leaf { name, kind: kind.clone(), params },
                    _ => unreachable!("a leaf is made of what its kind says"),
                }
            }
        };
        Part { span: part.span, kind }
    }
}

/// Where a name stands among these, at their end if it is new.
fn place(names: &mut Vec<String>, name: String) -> usize {
    names.iter().position(|known| *known == name).unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    })
}

/// A unit whose exponents are names of a leaf's own parameters, with the arguments in their place.
fn in_arguments(unit: &str, params: &[Param], arguments: &[(String, Span<usize>)]) -> String {
    params.iter().zip(arguments).fold(unit.to_owned(), |unit, (param, (argument, _))| {
        unit.replace(&format!("^{}", param.name), &format!("^{argument}"))
    })
}
