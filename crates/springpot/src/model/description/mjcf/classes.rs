//! `<default>`: attributes that elements of a class have where they say nothing else.

use super::element::{At, Element};
use super::error::DescriptionError;
use super::given::{Defaults, Reader};
use super::problem::Owner;
use crate::names::nearest;
use std::collections::BTreeMap;

/// The class of what names none.
const MAIN: &str = "main";

/// Attributes by class and tag.
#[derive(Debug)]
pub(super) struct Classes(BTreeMap<String, BTreeMap<String, Defaults>>);

impl Classes {
    /// Those of all `<default>` of a file.
    pub(super) fn of(reader: &Reader<'_>, root: &Element) -> Result<Self, DescriptionError> {
        let mut classes = Self(BTreeMap::from([(MAIN.to_owned(), BTreeMap::new())]));
        for default in root.all("default") {
            let name = default.text("class").unwrap_or(MAIN);
            let parent = BTreeMap::new();
            classes.take(reader, default, name, &parent)?;
        }
        Ok(classes)
    }

    /// Takes a class, first its own attributes, then the classes in it, which begin with them.
    fn take(
        &mut self,
        reader: &Reader<'_>,
        default: &Element,
        name: &str,
        parent: &BTreeMap<String, Defaults>,
    ) -> Result<(), DescriptionError> {
        let mut own = self.0.get(name).cloned().unwrap_or_else(|| parent.clone());
        for element in default.children.iter().filter(|child| child.tag != "default") {
            let attributes = element.attributes.iter().map(|attribute| (attribute.name.clone(), attribute.clone()));
            own.entry(element.tag.clone()).or_default().extend(attributes);
        }
        for inner in default.all("default") {
            let Some(name) = inner.text("class") else {
                return Err(reader.refuse(inner.at, &Owner::Mujoco, "a <default> in another one has no class"));
            };
            if name == MAIN || self.0.contains_key(name) {
                let why = format!("there are two <default> of class {name:?}");
                return Err(reader.refuse(inner.at, &Owner::Mujoco, why));
            }
            self.take(reader, inner, name, &own)?;
        }
        self.0.insert(name.to_owned(), own);
        Ok(())
    }

    /// What elements of a tag have in the class, that of `at`; in that of what names none without it.
    pub(super) fn find(
        &self,
        reader: &Reader<'_>,
        class: Option<&str>,
        tag: &str,
        (at, owner): (At, &Owner),
    ) -> Result<Option<&Defaults>, DescriptionError> {
        let name = class.unwrap_or(MAIN);
        if let Some(class) = self.0.get(name) {
            return Ok(class.get(tag));
        }
        let meant = nearest(name, self.0.keys().map(String::as_str));
        let meant = meant.map_or_else(String::new, |name| format!("; did you mean {name:?}?"));
        let shown: String = name.chars().take(40).collect();
        Err(reader.refuse(at, owner, format!("names the class {shown:?}, and there is none{meant}")))
    }
}
