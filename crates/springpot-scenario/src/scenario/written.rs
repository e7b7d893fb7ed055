//! A scenario as it is written.

use crate::changes::more::More;
use crate::text::document::{MAX_BYTES, Node, Value};
use crate::text::mistaken;
use crate::text::refusal::{Place, Refusal, RefusalKind, Refusals, Source};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A value for a path.
#[derive(Debug, Clone)]
pub(crate) struct Override {
    pub(crate) path: String,
    pub(crate) place: Place,
    /// `None`: what is there is taken out.
    pub(crate) value: Option<Node>,
}

/// A scenario as written: a TOML document and the overrides of `--set`.
#[derive(Debug, Clone)]
pub struct Scenario {
    pub(crate) document: Node,
    pub(crate) source: Arc<Source>,
    pub(crate) folder: PathBuf,
    pub(crate) overrides: Vec<Override>,
    /// Sweeps that take the place of its own, or stand beside them: paths and `values`.
    pub(super) sweeps: Vec<Override>,
    /// By what it is differentiated besides.
    pub(crate) sensitivity: Vec<More>,
}

impl Scenario {
    /// Reads a file. Paths that it names are relative to its folder.
    ///
    /// # Errors
    /// A path of something else than a regular file; a file that cannot be read, is larger than 4 MiB, not UTF-8, not TOML, or too deeply nested.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Refusals> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let refuse = |message: String| {
            let source = Source { name: name.clone(), text: "".into() };
            Place { source: Arc::new(source), span: 0..0 }.refuse(RefusalKind::File, message)
        };
        let unopened = |error: std::io::Error| {
            let refusal = refuse(format!("cannot be opened: {error}"));
            match mistaken::meant(path).filter(|_| error.kind() == std::io::ErrorKind::NotFound) {
                Some(help) => refusal.help(help),
                None => refusal,
            }
        };
        // Looked at before it is opened: opening a pipe would wait for its other end.
        if !std::fs::metadata(path).map_err(unopened)?.is_file() {
            let refusal = refuse("cannot be read: not a regular file".to_owned());
            return Err(refusal.help(mistaken::folder(path)).into());
        }
        let mut bytes = Vec::new();
        let file = std::fs::File::open(path).map_err(unopened)?;
        let read = file.take(MAX_BYTES + 1).read_to_end(&mut bytes);
        read.map_err(|error| refuse(format!("cannot be read: {error}")))?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(too_large(&name).into());
        }
        match String::from_utf8(bytes) {
            Ok(text) => {
                let parsed = Self::parse(&text, name.clone(), path.parent().unwrap_or(Path::new("")));
                // What is no TOML may be something else that people have at hand.
                parsed.map_err(|refusals| match mistaken::instead(path, &text) {
                    Some((what, help)) => refuse(what.to_owned()).help(help).into(),
                    None => refusals,
                })
            }
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let text: Arc<str> = String::from_utf8_lossy(error.as_bytes()).into();
                let place = Place { source: Arc::new(Source { name, text }), span: at..at + '\u{fffd}'.len_utf8() };
                Err(place.refuse(RefusalKind::Syntax, "not UTF-8").help("save the file as UTF-8").into())
            }
        }
    }

    /// Reads a text that stands for the file `name`; paths in it are relative to `folder`.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn parse(text: &str, name: impl Into<String>, folder: impl Into<PathBuf>) -> Result<Self, Refusals> {
        let name = name.into();
        if text.len() as u64 > MAX_BYTES {
            return Err(too_large(&name).into());
        }
        // Editors of one system begin their files with a byte order mark; it is no part of line 1.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Arc::new(Source { name, text: text.into() });
        let document = Node::document(&source)?;
        Ok(Self {
            document,
            source,
            folder: folder.into(),
            overrides: Vec::new(),
            sweeps: Vec::new(),
            sensitivity: Vec::new(),
        })
    }

    /// The folder that paths in it are relative to.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The text as written.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The one case that the values of the file itself make: its sweeps are dropped, and its figures with them, which may ask for swept values.
    #[must_use]
    pub fn without_sweeps(mut self) -> Self {
        if let Value::Table(entries) = &mut self.document.value {
            entries.retain(|entry| !matches!(entry.key.as_str(), "sweep" | "figure"));
        }
        self
    }
}

fn too_large(name: &str) -> Refusal {
    let source = Source { name: name.to_owned(), text: "".into() };
    let message = format!("larger than {} MiB", MAX_BYTES >> 20);
    Place { source: Arc::new(source), span: 0..0 }.refuse(RefusalKind::TooLarge, message)
}
