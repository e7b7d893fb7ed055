//! Networks as text: `series(spring(k0), parallel(springpot(c, alpha), slow: dashpot(eta)))`.

mod read;

use super::catalog::{Entry, Param};
use super::leaf::{Free, Holds, Leaf, LeafBuild, LeafKind, Table};
use super::network::Network;
use super::rule::RuleError;
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use crate::signal::{ExpressionError, StrokeExpression};
use std::borrow::Cow;
use std::ops::Range as Span;
use std::sync::Arc;

/// A network as it is written: leaves whose arguments are names of parameters, in series and in parallel. A leaf may be named,
/// `glass: spring(k0)`; else leaves are `spring1`, `spring2`, `dashpot1`, … in the order they are written. The leaf `expression` takes its
/// text in quotes, and then the parameters that it names: `expression("k*x + b*x^3", k, b)`; or the name of a parameter that is the text.
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
    /// Those whose unit no leaf says.
    open: Vec<usize>,
    files: Vec<TableFile>,
    texts: Vec<Text>,
}

/// A parameter that is the text of an expression.
#[derive(Debug, Clone)]
struct Text {
    name: Cow<'static, str>,
    expression: Option<Said>,
}

/// An expression, and where its parameters stand among those of the law.
#[derive(Debug, Clone)]
struct Said {
    expression: Arc<StrokeExpression>,
    params: Vec<usize>,
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
    pub span: Span<usize>,
    /// What would be right.
    pub help: String,
    /// A name that is not known, and those that are.
    pub unknown: Option<(String, Vec<&'static str>)>,
}

#[derive(Debug, Clone)]
struct Part {
    span: Span<usize>,
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
    /// A leaf from an expression that stands there, or that a text says.
    Expression {
        name: Arc<str>,
        build: fn(&Arc<StrokeExpression>, Vec<Dual>) -> Arc<dyn Leaf>,
        source: Source,
    },
    Parallel(Vec<Part>),
    Series(Vec<Part>),
}

/// Where the expression of a leaf comes from.
#[derive(Debug, Clone)]
enum Source {
    Here(Said),
    Text(usize),
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
        read::network(text)
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

    /// Parameters that are texts of expressions; they are none of the law's own, and what they name is.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.texts.iter().map(|text| &*text.name)
    }

    /// Takes the expression of one of its texts; others are passed over. Without it the law cannot be built.
    ///
    /// # Errors
    /// What stands there in place of an expression.
    pub fn with_text(mut self, text: &str, source: &str) -> Result<Self, ExpressionError> {
        let expression = Arc::new(StrokeExpression::parse(source)?);
        if let Some(at) = self.texts.iter().position(|own| own.name == text) {
            let params = expression.parameters().iter();
            let params = params.map(|name| read::number(&mut self.params, &mut self.open, name)).collect();
            self.texts[at].expression = Some(Said { expression, params });
        }
        Ok(self)
    }

    /// Parameters whose unit no leaf says, since only expressions name them: it is that in which they are given.
    pub fn open(&self) -> impl Iterator<Item = &str> {
        self.open.iter().map(|at| &*self.params[*at].name)
    }

    /// Takes the unit of one of those; others are passed over.
    pub fn with_unit(mut self, parameter: &str, unit: &str) -> Self {
        if let Some(at) = self.open.iter().find(|at| self.params[**at].name == parameter) {
            self.params[*at].unit = unit.to_owned().into();
        }
        self
    }

    /// A law with the parameters that the network names, in the order it names them.
    pub fn entry(self) -> Entry {
        let (text, params) = (self.text.trim().to_owned(), self.params.clone());
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
            let names = self.params.iter().map(|param| &*param.name).chain(self.files()).chain(self.texts());
            let names: Vec<&str> = names.collect();
            let parameter = names.first().map_or(Cow::Borrowed(""), |name| (*name).to_owned().into());
            let rule = match &names[..] {
                [] => "a part that gives a force".to_owned(),
                names => format!("a part that gives a force: one of {} to be positive", names.join(", ")),
            };
            return Err(RuleError { rule, parameter });
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
            PartKind::Expression { name, build, source } => {
                let said = match source {
                    Source::Here(said) => said,
                    Source::Text(at) => {
                        let Text { name: parameter, expression } = &self.texts[*at];
                        expression.as_ref().ok_or_else(|| {
                            let rule = format!("the expression that `{parameter}` stands for");
                            RuleError { rule, parameter: parameter.clone() }
                        })?
                    }
                };
                let own = said.params.iter().map(|at| values[*at]).collect();
                Ok(Network::shared(build(&said.expression, own)).named(name))
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
            PartKind::Expression { source: Source::Text(at), .. } => self.texts[*at].name.clone(),
            PartKind::Expression { source: Source::Here(said), .. } => {
                said.params.first().map_or("".into(), |at| self.params[*at].name.clone())
            }
            PartKind::Parallel(parts) | PartKind::Series(parts) => {
                parts.first().map_or("".into(), |part| self.first_parameter(part))
            }
        }
    }
}

/// Whether parts stand beside each other of which one is free at some strokes, or slides.
fn lets_go_aside(network: &Network) -> bool {
    matches!(network, Network::Parallel(parts) if parts.iter().any(|part| part.holds() == Holds::LetsGo || lets_go_aside(part)))
}
