//! Attributes: those of an element, and behind them those of its class.

use super::element::{At, Attribute, Element};
use super::error::DescriptionError;
use super::problem::{DescriptionProblem, Owner};
use super::source::Source;
use super::warning::{DescriptionWarningKind, Warnings};
use crate::names::nearest;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Text of an attribute that messages show, characters.
const SHOWN: usize = 40;

/// The files, and what is said of them.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    /// The first, then those that are included.
    pub(super) sources: Vec<Source<'a>>,
    pub(super) warnings: Warnings,
}

impl Reader<'_> {
    pub(super) fn fail(&self, at: At, problem: DescriptionProblem) -> DescriptionError {
        self.sources[at.file].fail(at.byte, problem)
    }

    pub(super) fn refuse(&self, at: At, owner: &Owner, why: impl Into<String>) -> DescriptionError {
        self.fail(at, DescriptionProblem::Refused { owner: owner.clone(), why: why.into() })
    }

    pub(super) fn line(&self, at: At) -> usize {
        self.sources[at.file].line(at.byte)
    }

    pub(super) fn warn(&mut self, kind: DescriptionWarningKind, owner: &Owner, at: At, what: impl Into<String>) {
        let line = self.line(at);
        self.warnings.add(kind, owner, line, what);
    }

    /// Notes attributes that nobody knows.
    pub(super) fn check_attributes(&mut self, element: &Element, owner: &Owner, known: &[&[&str]]) {
        for attribute in &element.attributes {
            if !known.iter().any(|known| known.contains(&attribute.name.as_str())) {
                let name: String = attribute.name.chars().take(SHOWN).collect();
                let what = format!("{name} of <{}>", element.tag);
                self.warn(DescriptionWarningKind::UnknownAttribute, owner, attribute.at, what);
            }
        }
    }
}

/// Attributes of one tag in one class.
pub(super) type Defaults = BTreeMap<String, Attribute>;

/// An element with its class.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given<'d> {
    pub(super) element: &'d Element,
    pub(super) class: Option<&'d Defaults>,
    /// Whose it is.
    pub(super) owner: &'d Owner,
}

impl<'d> Given<'d> {
    /// An element that has no class.
    pub(super) fn alone(element: &'d Element, owner: &'d Owner) -> Self {
        Self { element, class: None, owner }
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&'d Attribute> {
        self.element.attribute(name).or_else(|| self.class?.get(name))
    }

    pub(super) fn text(&self, name: &str) -> Option<&'d str> {
        self.attribute(name).map(|attribute| attribute.value.as_str())
    }

    /// Finite numbers, as many as `counts` allows.
    pub(super) fn numbers(
        &self,
        reader: &Reader<'_>,
        name: &'static str,
        counts: RangeInclusive<usize>,
    ) -> Result<Option<Vec<f64>>, DescriptionError> {
        let Some(attribute) = self.attribute(name) else { return Ok(None) };
        let (owner, element) = (|| self.owner.clone(), || self.element.tag.clone());
        let mut numbers = Vec::new();
        for word in attribute.value.split_ascii_whitespace() {
            let text = || word.chars().take(SHOWN).collect::<String>();
            let Ok(value) = word.parse::<f64>() else {
                let (owner, element, text) = (owner(), element(), text());
                let problem = DescriptionProblem::NotANumber { owner, element, attribute: name, text };
                return Err(reader.fail(attribute.at, problem));
            };
            if !value.is_finite() {
                let (owner, element, text) = (owner(), element(), text());
                let problem = DescriptionProblem::NotFinite { owner, element, attribute: name, text };
                return Err(reader.fail(attribute.at, problem));
            }
            numbers.push(value);
        }
        if !counts.contains(&numbers.len()) {
            let wanted = if numbers.len() < *counts.start() { *counts.start() } else { *counts.end() };
            let (owner, element, given) = (owner(), element(), numbers.len());
            let problem = DescriptionProblem::WrongCount { owner, element, attribute: name, given, wanted };
            return Err(reader.fail(attribute.at, problem));
        }
        Ok(Some(numbers))
    }

    /// Exactly `N` of them.
    pub(super) fn array<const N: usize>(
        &self,
        reader: &Reader<'_>,
        name: &'static str,
    ) -> Result<Option<[f64; N]>, DescriptionError> {
        let numbers = self.numbers(reader, name, N..=N)?;
        Ok(numbers.and_then(|numbers| numbers.try_into().ok()))
    }

    pub(super) fn number(&self, reader: &Reader<'_>, name: &'static str) -> Result<Option<f64>, DescriptionError> {
        Ok(self.array(reader, name)?.map(|[number]| number))
    }

    /// A number that must not be below zero; 0 where it is not there.
    pub(super) fn not_negative(&self, reader: &Reader<'_>, name: &'static str) -> Result<f64, DescriptionError> {
        let value = self.number(reader, name)?.unwrap_or(0.0);
        if value < 0.0 {
            let (owner, element) = (self.owner.clone(), self.element.tag.clone());
            let at = self.attribute(name).map_or(self.element.at, |attribute| attribute.at);
            return Err(reader.fail(at, DescriptionProblem::Negative { owner, element, attribute: name, value }));
        }
        Ok(value)
    }

    /// One of these words.
    pub(super) fn word(
        &self,
        reader: &Reader<'_>,
        name: &'static str,
        words: &[&'static str],
    ) -> Result<Option<&'static str>, DescriptionError> {
        let Some(attribute) = self.attribute(name) else { return Ok(None) };
        let written = attribute.value.trim();
        if let Some(word) = words.iter().find(|word| **word == written) {
            return Ok(Some(word));
        }
        let text: String = written.chars().take(SHOWN).collect();
        let meant = nearest(&text, words.iter().copied());
        let meant = meant.map_or_else(String::new, |word| format!("; did you mean {word:?}?"));
        let why = format!(
            "{name} of <{}> is {text:?}; it is one of {}{meant}",
            self.element.tag,
            words.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", ")
        );
        Err(reader.refuse(attribute.at, self.owner, why))
    }

    /// "true" or "false".
    pub(super) fn flag(&self, reader: &Reader<'_>, name: &'static str) -> Result<Option<bool>, DescriptionError> {
        Ok(self.word(reader, name, &["true", "false"])?.map(|word| word == "true"))
    }
}
