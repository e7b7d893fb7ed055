//! The elements of a file, with those that it includes in place of `<include>`.

use super::error::DescriptionError;
use super::package::{Found, Packages};
use super::problem::{DescriptionProblem, Owner};
use super::source::{self, Source};
use roxmltree::Node;
use std::path::{Path, PathBuf};

/// Most levels of elements in elements: whoever walks them goes as deep.
const MAX_LEVELS: usize = 1_000;
/// Most files that one includes.
const MAX_FILES: usize = 1_000;

/// Where something stands: which file, and which byte of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct At {
    pub(super) file: usize,
    pub(super) byte: usize,
}

/// An attribute as it is written.
#[derive(Debug, Clone)]
pub(super) struct Attribute {
    pub(super) name: String,
    pub(super) value: String,
    pub(super) at: At,
}

/// An element as it is written.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub(super) tag: String,
    pub(super) at: At,
    pub(super) attributes: Vec<Attribute>,
    pub(super) children: Vec<Self>,
}

impl Element {
    /// The children of that tag.
    pub(super) fn all<'e>(&'e self, tag: &'e str) -> impl Iterator<Item = &'e Self> {
        self.children.iter().filter(move |child| child.tag == tag)
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// The text of an attribute.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|attribute| attribute.value.as_str())
    }
}

/// A file that another one includes.
#[derive(Debug)]
pub(super) struct Included {
    pub(super) path: PathBuf,
    pub(super) text: String,
}

/// Reads the elements of `root` and of what it includes: files by paths from the folder of the first one, each once, and none outside it.
pub(super) fn load(
    source: &Source<'_>,
    root: Node<'_, '_>,
    packages: Option<&mut Packages>,
) -> Result<(Element, Vec<Included>), DescriptionError> {
    let mut loader = Loader { packages, home: source.file.map(Path::to_path_buf), files: Vec::new() };
    let mut all = Vec::new();
    loader.take(source, 0, root, 1, &mut all)?;
    let root = all.pop().unwrap_or_else(|| unreachable!("the outermost element is none that includes"));
    Ok((root, loader.files))
}

struct Loader<'p> {
    packages: Option<&'p mut Packages>,
    home: Option<PathBuf>,
    files: Vec<Included>,
}

impl Loader<'_> {
    /// Adds an element, or what it includes, to `all`.
    fn take(
        &mut self,
        source: &Source<'_>,
        file: usize,
        node: Node<'_, '_>,
        level: usize,
        all: &mut Vec<Element>,
    ) -> Result<(), DescriptionError> {
        let byte = node.range().start;
        if level > MAX_LEVELS {
            let what = "levels of elements in elements";
            return Err(source.fail(byte, DescriptionProblem::TooLarge { limit: MAX_LEVELS, what }));
        }
        if level > 1 && node.tag_name().name() == "include" {
            return self.include(source, node, level, all);
        }
        let attributes = node.attributes().map(|attribute| Attribute {
            name: attribute.name().to_owned(),
            value: attribute.value().to_owned(),
            at: At { file, byte: attribute.range_value().start },
        });
        let mut element = Element {
            tag: node.tag_name().name().to_owned(),
            at: At { file, byte },
            attributes: attributes.collect(),
            children: Vec::new(),
        };
        for child in node.children().filter(Node::is_element) {
            self.take(source, file, child, level + 1, &mut element.children)?;
        }
        all.push(element);
        Ok(())
    }

    fn include(
        &mut self,
        source: &Source<'_>,
        node: Node<'_, '_>,
        level: usize,
        all: &mut Vec<Element>,
    ) -> Result<(), DescriptionError> {
        let byte = node.range().start;
        let refused = |why: String| source.fail(byte, DescriptionProblem::Refused { owner: Owner::Mujoco, why });
        let Some(name) = node.attribute("file") else {
            return Err(refused("an <include> has no file".to_owned()));
        };
        let Some(packages) = &mut self.packages else {
            return Err(refused(format!("includes {name:?}, and a text by itself has no folder to look in")));
        };
        let path = match packages.find(name) {
            Found::At(place) => place.path,
            Found::Outside => {
                return Err(refused(format!("includes {name:?}, which is outside its folder and its packages")));
            }
            Found::Nowhere | Found::Elsewhere => {
                return Err(refused(format!("includes {name:?}, and there is no such file from its folder")));
            }
        };
        let is_here = |other: &Path| same(other, &path);
        if self.home.as_deref().is_some_and(is_here) || self.files.iter().any(|file| is_here(&file.path)) {
            return Err(refused(format!("includes {name:?} a second time; a file can be included once")));
        }
        if self.files.len() >= MAX_FILES {
            return Err(source.fail(byte, DescriptionProblem::TooLarge { limit: MAX_FILES, what: "included files" }));
        }
        let text = source::read(&path)?;
        self.files.push(Included { path: path.clone(), text: text.clone() });
        let file = self.files.len();
        let inner = Source::new(&text, Some(&path));
        let document = inner.parse()?;
        for child in document.root_element().children().filter(Node::is_element) {
            self.take(&inner, file, child, level + 1, all)?;
        }
        Ok(())
    }
}

/// Whether two paths lead to one file.
fn same(one: &Path, other: &Path) -> bool {
    one == other || matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}
