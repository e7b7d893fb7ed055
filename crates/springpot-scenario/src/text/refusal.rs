//! Refusals: what is wrong in a scenario, where it stands, and what would be right.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// What sweeps of the command line are called.
pub(crate) const SWEEP_OPTION: &str = "--sweep";

/// How they are written.
pub(crate) const SWEEP_FORM: &str =
    "write PATH=v1,v2,… or PATH=FROM:TO:COUNT[:log], as in element.strut.alpha=0.2,0.5 or element.strut.c=1:100:5:log";

/// A text that was read: the scenario file or one `--set` argument.
#[derive(Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's path as it was given, or `--set`.
    pub name: String,
    /// The whole text.
    pub text: Arc<str>,
}

/// A stretch of a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Where it stands.
    pub source: Arc<Source>,
    /// Bytes of the source's text.
    pub span: Range<usize>,
}

impl Place {
    /// A refusal that points here.
    pub fn refuse(&self, kind: RefusalKind, message: impl Into<String>) -> Refusal {
        Refusal::new(self, kind, message.into())
    }

    /// Line and column (both from 1, columns in characters).
    pub fn position(&self) -> (usize, usize) {
        let text = &self.source.text;
        let mut start = self.span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// The text that stands here.
    pub fn text(&self) -> &str {
        self.source.text.get(self.span.clone()).unwrap_or("")
    }
}

/// What sort of mistake it is: what its author can do about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum RefusalKind {
    /// A file cannot be read.
    File,
    /// The text is not TOML.
    Syntax,
    /// A key that does not exist here.
    UnknownKey,
    /// A name (law, body, joint, input, function, unit, parameter path) that does not exist.
    UnknownName,
    /// A name that breaks the rules of names or is taken.
    BadName,
    /// Something needed is not there.
    Missing,
    /// A text where a number is needed, and the like.
    WrongType,
    /// A quantity or expression that cannot be read or has another dimension.
    BadQuantity,
    /// A number outside its admissible range, NaN or infinite.
    OutOfRange,
    /// A rule between values is broken.
    Rule,
    /// More than this program takes on.
    TooLarge,
}

/// One mistake in a scenario: message, place, label under the place, and what would be right.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Refusal {
    /// What sort of mistake it is.
    pub kind: RefusalKind,
    /// What is wrong, with the value; of runs without a blank that are longer than 120 characters the ends alone.
    pub message: String,
    /// The file's path as it was given, or `--set`.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Bytes of `text` to underline.
    pub span: Range<usize>,
    /// The whole source.
    pub text: Arc<str>,
    /// A few words to stand under the place.
    pub label: String,
    /// What would be right.
    pub help: Option<String>,
}

/// Longest run without a blank in a message, and what is kept of a longer one, in characters.
const LONGEST_RUN: usize = 120;
const HEAD: usize = 60;
const TAIL: usize = 40;

/// A message in which values and names that are too long to be read are cut in their middle.
fn brief(message: String) -> String {
    if message.len() <= LONGEST_RUN {
        return message;
    }
    let cut = |run: &str| match run.chars().count() {
        count if count > LONGEST_RUN => {
            let tail = run.chars().skip(count - TAIL);
            run.chars().take(HEAD).chain(['…']).chain(tail).collect()
        }
        _ => run.to_owned(),
    };
    message.split_inclusive(char::is_whitespace).map(cut).collect()
}

impl Refusal {
    fn new(place: &Place, kind: RefusalKind, message: String) -> Self {
        let (line, column) = place.position();
        let end = place.source.text.len();
        Self {
            kind,
            message: brief(message),
            file: place.source.name.clone(),
            line,
            column,
            span: place.span.start.min(end)..place.span.end.min(end),
            text: place.source.text.clone(),
            label: "here".to_owned(),
            help: None,
        }
    }

    /// With how a sweep is written, where it is about one of the command line.
    fn with_form(mut self) -> Self {
        let help = self.help.take();
        self.help = match help {
            Some(help) if self.file == SWEEP_OPTION && !help.contains("FROM:TO:COUNT") => {
                Some(format!("{help}; a sweep is PATH=v1,v2,… or PATH=FROM:TO:COUNT[:log]"))
            }
            None if self.file == SWEEP_OPTION => Some(SWEEP_FORM.to_owned()),
            help => help,
        };
        self
    }

    /// With these words under the place.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// With what would be right.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// With what would be right, where that is known.
    pub fn help_if(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.message)?;
        match &self.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

/// What a run goes on in spite of, and its author should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// What it is, with the value.
    pub message: String,
    /// Where it stands, if it stands in one place.
    pub place: Option<Place>,
    /// What can be done.
    pub help: Option<String>,
}

impl Remark {
    /// What stands nowhere.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: brief(message.into()), place: None, help: None }
    }

    /// What stands at `place`.
    pub fn at(place: &Place, message: impl Into<String>) -> Self {
        Self { place: Some(place.clone()), ..Self::new(message) }
    }

    /// With what can be done.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// Why a scenario is refused: at least one refusal, in the order of the text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct Refusals(Vec<Refusal>);

impl Refusals {
    pub(crate) fn of(mut list: Vec<Refusal>) -> Self {
        debug_assert!(!list.is_empty());
        list.sort_by(|a, b| (&a.file, a.span.start).cmp(&(&b.file, b.span.start)));
        list.dedup();
        Self(list.into_iter().map(Refusal::with_form).collect())
    }

    /// All of them.
    pub fn iter(&self) -> std::slice::Iter<'_, Refusal> {
        self.0.iter()
    }

    /// The first in the order of the text.
    pub fn first(&self) -> Option<&Refusal> {
        self.0.first()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Always false.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl From<Refusal> for Refusals {
    fn from(refusal: Refusal) -> Self {
        Self(vec![refusal.with_form()])
    }
}

impl IntoIterator for Refusals {
    type Item = Refusal;
    type IntoIter = std::vec::IntoIter<Refusal>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl fmt::Display for Refusals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, refusal) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{refusal}")?;
        }
        Ok(())
    }
}
