//! Networks as text: `series(spring(k0), parallel(springpot(c, alpha), slow: dashpot(eta)))`.

use super::catalog::{Entry, Param};
use super::leaf::{Free, Holds, Leaf, LeafBuild, LeafKind, Table};
use super::network::Network;
use super::rule::RuleError;
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use crate::names::is_name;
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Most leaves of a network, and how deep it may be nested.
const MOST_LEAVES: usize = 1_000;
const DEEPEST: usize = 64;

/// Names that leaves may not have: columns of an element.
const COLUMNS: [&str; 9] = ["length", "stroke", "rate", "derivative", "force", "Q", "stored", "dissipated", "input"];

const GRAMMAR: &str = "write leaves such as spring(k), or parts in series(…) and parallel(…)";

/// A network as it is written: leaves whose arguments are names of parameters, in series and in parallel. A leaf may be named,
/// `glass: spring(k0)`; else leaves are `spring1`, `spring2`, `dashpot1`, … in the order they are written.
///
/// ```
/// use springpot::law::{Derivative, NetworkText};
///
/// let zener = NetworkText::parse("parallel(spring(k_e), series(spring(k_m), springpot(c, alpha)))")?.entry();
/// let names: Vec<_> = zener.params.iter().map(|param| (&*param.name, &*param.unit)).collect();
/// assert_eq!(names, [("k_e", "N/m"), ("k_m", "N/m"), ("c", "N*s^alpha/m"), ("alpha", "")]);
/// let law = zener.build(&[10.0, 90.0, 5.0, 0.5], Derivative::Caputo)?;
/// assert_eq!(law.leaf_names(), ["spring1", "spring2", "springpot1"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct NetworkText {
    text: String,
    root: Part,
    params: Vec<Param>,
    files: Vec<TableFile>,
}

/// A parameter that is the name of a file.
#[derive(Debug, Clone)]
struct TableFile {
    name: Cow<'static, str>,
    table: Option<Arc<Table>>,
}

/// Why a text is no network.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct NetworkTextError {
    /// What is wrong.
    pub message: String,
    /// Where, in bytes of the text.
    pub span: Range<usize>,
    /// What would be right.
    pub help: String,
    /// A name that is not known, and those that are.
    pub unknown: Option<(String, Vec<&'static str>)>,
}

#[derive(Debug, Clone)]
struct Part {
    span: Range<usize>,
    kind: PartKind,
}

#[derive(Debug, Clone)]
enum PartKind {
    /// A leaf with its name and where its parameters stand among those of the law.
    Leaf {
        name: Arc<str>,
        kind: Arc<LeafKind>,
        params: Vec<usize>,
    },
    /// A leaf from the table of a file, and which.
    Table {
        name: Arc<str>,
        build: fn(&Arc<Table>) -> Arc<dyn Leaf>,
        file: usize,
    },
    Parallel(Vec<Part>),
    Series(Vec<Part>),
}

impl Part {
    /// The parts of a series, and of those in it.
    fn leaves_in_series<'a>(&'a self, leaves: &mut Vec<&'a Self>) {
        match &self.kind {
            PartKind::Series(parts) => parts.iter().for_each(|part| part.leaves_in_series(leaves)),
            _ => leaves.push(self),
        }
    }
}

impl NetworkText {
    /// Reads a network.
    ///
    /// # Errors
    /// [`NetworkTextError`] says what is wrong, and where.
    pub fn parse(text: &str) -> Result<Self, NetworkTextError> {
        let kinds = LeafKind::all().into_iter().map(Arc::new).collect();
        let mut reader = Reader { text, at: 0, kinds, params: Vec::new(), files: Vec::new(), leaves: Vec::new() };
        let root = reader.part(0)?;
        if let Some(rest) = reader.peek() {
            return Err(reader.error(
                reader.at..text.len(),
                format!("nothing may follow the network, not `{rest}`"),
                GRAMMAR,
            ));
        }
        let root = reader.named(root)?;
        let files = reader.files.into_iter().map(|name| TableFile { name: name.into(), table: None }).collect();
        Ok(Self { text: text.trim().to_owned(), root, params: reader.params, files })
    }

    /// Parameters that are names of files, each of which has a table; they are none of the law's own.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|file| &*file.name)
    }

    /// Takes the table of one of its files; others are passed over. Without it the law cannot be built.
    pub fn with_table(mut self, file: &str, table: Table) -> Self {
        if let Some(own) = self.files.iter_mut().find(|own| own.name == file) {
            own.table = Some(Arc::new(table));
        }
        self
    }

    /// A law with the parameters that the network names, in the order it names them.
    pub fn entry(self) -> Entry {
        let (text, params) = (self.text.clone(), self.params.clone());
        Entry {
            name: text.clone().into(),
            equation: text.into(),
            params,
            inputs: Vec::new(),
            source: "a network of its scenario".into(),
            build: Arc::new(move |values, derivative| self.build(values, derivative)),
        }
    }

    fn build(&self, values: &[Dual], derivative: Derivative) -> Result<Network, RuleError> {
        let network = self.part(&self.root, values, derivative)?;
        if network.holds() == Holds::Never {
            let names: Vec<&str> = self.params.iter().map(|param| &*param.name).chain(self.files()).collect();
            let parameter = names.first().map_or(Cow::Borrowed(""), |name| (*name).to_owned().into());
            return Err(RuleError {
                rule: format!("a part that gives a force: one of {} to be positive", names.join(", ")),
                parameter,
            });
        }
        Ok(network)
    }

    fn part(&self, part: &Part, values: &[Dual], derivative: Derivative) -> Result<Network, RuleError> {
        match &part.kind {
            PartKind::Leaf { name, kind, params } => {
                let own: Vec<Dual> = params.iter().map(|at| values[*at]).collect();
                let LeafBuild::Values(build) = kind.build else { unreachable!("a leaf from values") };
                let leaf = build(&own, derivative).map_err(|error| {
                    let at = kind.params.iter().position(|param| param.name == error.parameter);
                    let parameter = at.map_or(error.parameter, |at| self.params[params[at]].name.clone());
                    RuleError { parameter, rule: format!("{} in `{}`", error.rule, self.words(part)) }
                })?;
                Ok(Network::shared(leaf).named(name))
            }
            PartKind::Table { name, build, file } => {
                let TableFile { name: parameter, table } = &self.files[*file];
                let Some(table) = table else {
                    let rule = format!("the table that `{parameter}` stands for");
                    return Err(RuleError { rule, parameter: parameter.clone() });
                };
                Ok(Network::shared(build(table)).named(name))
            }
            PartKind::Parallel(parts) => {
                let parts = parts.iter().map(|part| self.part(part, values, derivative));
                Ok(Network::parallel(parts.collect::<Result<Vec<_>, _>>()?))
            }
            PartKind::Series(parts) => {
                let built = parts.iter().map(|part| self.part(part, values, derivative));
                let built = built.collect::<Result<Vec<_>, _>>()?;
                // Springs that slip and plain ones are one leaf; what slips knows what is left of the stroke, but not beside others that let go.
                if let whole @ Network::Leaf(_) = Network::series(built.clone()) {
                    return Ok(whole);
                }
                let lets_go = built.iter().any(|network| network.holds() == Holds::LetsGo);
                let built = parts.iter().zip(built).map(|(part, network)| {
                    let what = match network.holds() {
                        Holds::Always | Holds::LetsGo => return Ok(network),
                        Holds::AtTimes if network.slips() && !lets_go => return Ok(network),
                        Holds::AtTimes if lets_go_aside(&network) => {
                            "has parts beside each other of which one lets go: in a series that has to stand by itself"
                        }
                        Holds::AtTimes => "does not hold at times: what stands behind it would be free",
                        Holds::Never => "gives none",
                    };
                    let rule = format!("every part of a series to carry its force, but `{}` {what}", self.words(part));
                    Err(RuleError { rule, parameter: self.first_parameter(part) })
                });
                let built = built.collect::<Result<Vec<_>, _>>()?;
                let series = Network::series(built).after(derivative);
                self.carries(parts, &series)?;
                Ok(series)
            }
        }
    }

    /// A series that gives a force somewhere: of one part that only pulls and one that only pushes there is none.
    fn carries(&self, parts: &[Part], series: &Network) -> Result<(), RuleError> {
        if series.holds() != Holds::Never {
            return Ok(());
        }
        let mut leaves = Vec::new();
        parts.iter().for_each(|part| part.leaves_in_series(&mut leaves));
        let never = |end: fn(&Free) -> f64| {
            let own = leaves.iter().zip(series.parts());
            own.filter(|(_, part)| part.free().is_some_and(|free| end(&free).is_infinite()))
                .map(|(leaf, _)| *leaf)
                .next()
        };
        let [pushes, pulls] =
            [never(|free| free.upper), never(|free| free.lower)].map(|part| part.unwrap_or(&parts[0]));
        let rule = format!(
            "parts of a series that carry one force, but `{}` only pulls and `{}` only pushes: together they give none",
            self.words(pulls),
            self.words(pushes)
        );
        Err(RuleError { rule, parameter: self.first_parameter(pushes) })
    }

    fn words(&self, part: &Part) -> &str {
        &self.text[part.span.clone()]
    }

    fn first_parameter(&self, part: &Part) -> Cow<'static, str> {
        match &part.kind {
            PartKind::Leaf { params, .. } => params.first().map_or("".into(), |at| self.params[*at].name.clone()),
            PartKind::Table { file, .. } => self.files[*file].name.clone(),
            PartKind::Parallel(parts) | PartKind::Series(parts) => {
                parts.first().map_or("".into(), |part| self.first_parameter(part))
            }
        }
    }
}

/// A leaf as it is written.
struct LeafText {
    name: Option<(String, Range<usize>)>,
    kind: Arc<LeafKind>,
    /// Where its parameters stand among those of the law; of a table where its file stands among the files.
    params: Vec<usize>,
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    kinds: Vec<Arc<LeafKind>>,
    params: Vec<Param>,
    files: Vec<String>,
    leaves: Vec<LeafText>,
}

/// A part whose leaves are numbers of [`Reader::leaves`].
struct Unnamed {
    span: Range<usize>,
    kind: UnnamedKind,
}

enum UnnamedKind {
    Leaf(usize),
    Parallel(Vec<Unnamed>),
    Series(Vec<Unnamed>),
}

impl Reader<'_> {
    fn error(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> NetworkTextError {
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
    fn found(&mut self) -> (Range<usize>, String) {
        match self.peek() {
            None => (self.text.len()..self.text.len(), "the end".to_owned()),
            Some(c) => (self.at..self.at + c.len_utf8(), format!("`{c}`")),
        }
    }

    fn name(&mut self, wanted: &str) -> Result<(String, Range<usize>), NetworkTextError> {
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
        span: Range<usize>,
        name: Option<(String, Range<usize>)>,
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
            let message = format!("`{written}` takes {} names, not {}", kind.params.len(), arguments.len());
            return Err(self.error(
                span.start..self.at,
                message,
                format!("write {written}({wanted}): {}", kind.equation),
            ));
        }
        if let LeafBuild::Table(_) = kind.build {
            let file = arguments.into_iter().map(|(name, span)| self.file(name, span)).collect::<Result<_, _>>()?;
            return Ok(LeafText { name, kind, params: file });
        }
        let params = kind.params.iter().zip(&arguments).map(|(param, argument)| {
            let unit = in_arguments(&param.unit, &kind.params, &arguments);
            let own = Param { name: argument.0.clone().into(), unit: unit.into(), ..param.clone() };
            self.param(own, argument.1.clone())
        });
        let params = params.collect::<Result<_, _>>()?;
        Ok(LeafText { name, kind, params })
    }

    /// Where a file stands among those of the law.
    fn file(&mut self, name: String, span: Range<usize>) -> Result<usize, NetworkTextError> {
        if self.params.iter().any(|param| param.name == name) {
            return Err(self.error(
                span,
                format!("`{name}` is a file here, but a number before"),
                "write another name",
            ));
        }
        Ok(self.files.iter().position(|known| *known == name).unwrap_or_else(|| {
            self.files.push(name);
            self.files.len() - 1
        }))
    }

    /// Where a parameter stands among those of the law; one that is named twice must be the same both times.
    fn param(&mut self, param: Param, span: Range<usize>) -> Result<usize, NetworkTextError> {
        if self.files.iter().any(|file| *file == param.name) {
            let message = format!("`{}` is a number here, but a file before", param.name);
            return Err(self.error(span, message, "write another name"));
        }
        let Some(at) = self.params.iter().position(|known| known.name == param.name) else {
            self.params.push(param);
            return Ok(self.params.len() - 1);
        };
        let (known, unit) =
            (&mut self.params[at], |unit: &str| if unit.is_empty() { "a number" } else { unit }.to_owned());
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
                let LeafText { kind, params, .. } = &self.leaves[k];
                let name = names[k].clone();
                match kind.build {
                    LeafBuild::Values(_) => PartKind::Leaf { name, kind: kind.clone(), params: params.clone() },
                    LeafBuild::Table(build) => PartKind::Table { name, build, file: params[0] },
                }
            }
        };
        Part { span: part.span, kind }
    }
}

/// A unit whose exponents are names of a leaf's own parameters, with the arguments in their place.
fn in_arguments(unit: &str, params: &[Param], arguments: &[(String, Range<usize>)]) -> String {
    params.iter().zip(arguments).fold(unit.to_owned(), |unit, (param, (argument, _))| {
        unit.replace(&format!("^{}", param.name), &format!("^{argument}"))
    })
}
/// Whether parts stand beside each other of which one is free at some strokes, or slides.
fn lets_go_aside(network: &Network) -> bool {
    matches!(network, Network::Parallel(parts) if parts.iter().any(|part| part.holds() == Holds::LetsGo || lets_go_aside(part)))
}
