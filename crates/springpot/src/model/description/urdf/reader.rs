//! Elements and attributes with their mistakes.

use roxmltree::{Attribute, Node as XmlNode};

use super::error::DescriptionError;
use super::problem::DescriptionProblem;
use super::problem::Owner;
use super::source::Source;
use super::warning::{DescriptionWarningKind, Warnings};

pub(super) type Node<'a> = XmlNode<'a, 'a>;

/// Text of an attribute that messages show, characters.
const SHOWN: usize = 40;

/// Reads elements and notes what it does not use.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) warnings: Warnings,
    /// Namespace of `<robot>`, which the other elements share.
    namespace: Option<&'a str>,
}

impl<'a> Reader<'a> {
    /// Reads what stands in `robot`.
    pub(super) fn new(source: &'a Source<'a>, robot: Node<'a>) -> Self {
        Self { source, warnings: Warnings::default(), namespace: robot.tag_name().namespace() }
    }

    pub(super) fn fail(&self, node: Node<'a>, problem: DescriptionProblem) -> DescriptionError {
        self.source.fail(node.range().start, problem)
    }

    pub(super) fn line(&self, node: Node<'a>) -> usize {
        self.source.line(node.range().start)
    }

    /// The name of an element of URDF; `None` for text, comments and elements of other namespaces.
    pub(super) fn name(&self, node: Node<'a>) -> Option<&'a str> {
        let tag = node.tag_name();
        let is_ours = tag.namespace().is_none() || tag.namespace() == self.namespace;
        (node.is_element() && is_ours).then(|| tag.name())
    }

    /// The name of an element as it is written, with its prefix.
    fn written(&self, node: Node<'a>) -> String {
        let tag = self.source.text.get(node.range().start + 1..).unwrap_or("");
        let end = tag.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>')).unwrap_or(tag.len());
        tag[..end].chars().take(SHOWN).collect()
    }

    /// Notes an element that nothing reads.
    ///
    /// # Errors
    /// Elements of xacro.
    pub(super) fn unknown_element(&mut self, node: Node<'a>, owner: &Owner) -> Result<(), DescriptionError> {
        let element = self.written(node);
        let namespace = node.tag_name().namespace().unwrap_or("");
        if element.starts_with("xacro:") || namespace.contains("xacro") {
            return Err(self.fail(node, DescriptionProblem::Xacro { element }));
        }
        self.warnings.add(DescriptionWarningKind::UnknownElement, owner, self.line(node), format!("<{element}>"));
        Ok(())
    }

    /// Notes a known element that has no part in the dynamics; `what` is what to call it.
    pub(super) fn not_used(&mut self, node: Node<'a>, owner: &Owner, what: &str) {
        self.warnings.add(DescriptionWarningKind::NotUsed, owner, self.line(node), what);
    }

    /// Notes text that is not blank.
    pub(super) fn stray_text(&mut self, node: Node<'a>, owner: &Owner) {
        if node.is_text() && node.text().is_some_and(|text| !text.trim().is_empty()) {
            let parent = node.parent().map(|parent| parent.tag_name().name()).unwrap_or_default();
            self.warnings.add(DescriptionWarningKind::StrayText, owner, self.line(node), format!("in <{parent}>"));
        }
    }

    /// The children called `wanted`, at most one of each; those called `unused` are noted as known, all others as
    /// unknown.
    pub(super) fn children<const N: usize>(
        &mut self,
        parent: Node<'a>,
        owner: &Owner,
        wanted: [&'static str; N],
        unused: &[&str],
    ) -> Result<[Option<Node<'a>>; N], DescriptionError> {
        let mut found = [None; N];
        for node in parent.children() {
            let name = self.name(node);
            if let Some(k) = wanted.iter().position(|wanted| name == Some(wanted)) {
                if let Some(first) = found[k].replace(node) {
                    let (owner, element, first) = (owner.clone(), wanted[k].to_owned(), self.line(first));
                    return Err(self.fail(node, DescriptionProblem::DuplicateElement { owner, element, first }));
                }
            } else if let Some(name) = name.filter(|name| unused.contains(name)) {
                self.not_used(node, owner, &format!("<{name}>"));
            } else if node.is_element() {
                self.unknown_element(node, owner)?;
            } else {
                self.stray_text(node, owner);
            }
        }
        Ok(found)
    }

    /// Notes the attributes of an element beyond `used`, those of `unused` as known.
    pub(super) fn attributes(&mut self, node: Node<'a>, owner: &Owner, used: &[&str], unused: &[&str]) {
        for attribute in node.attributes() {
            let name = attribute.name();
            let is_plain = attribute.namespace().is_none();
            if is_plain && used.contains(&name) {
                continue;
            }
            let is_known = is_plain && unused.contains(&name);
            let kind =
                if is_known { DescriptionWarningKind::NotUsed } else { DescriptionWarningKind::UnknownAttribute };
            let name: String = name.chars().take(SHOWN).collect();
            let what = format!("{name} of <{}>", node.tag_name().name());
            self.warnings.add(kind, owner, self.source.line(attribute.range().start), what);
        }
    }

    /// An element of which nothing but these attributes is read.
    pub(super) fn leaf(
        &mut self,
        node: Node<'a>,
        owner: &Owner,
        used: &[&str],
        unused: &[&str],
    ) -> Result<(), DescriptionError> {
        self.attributes(node, owner, used, unused);
        self.children(node, owner, [], &[]).map(|[]| ())
    }

    /// An attribute's text.
    pub(super) fn text(&self, node: Node<'a>, name: &str) -> Option<&'a str> {
        attribute(node, name).map(|attribute| attribute.value())
    }

    /// An attribute's text, which must be there.
    pub(super) fn required(
        &self,
        node: Node<'a>,
        owner: &Owner,
        attribute: &'static str,
    ) -> Result<&'a str, DescriptionError> {
        self.text(node, attribute).ok_or_else(|| self.missing(node, owner, attribute))
    }

    fn missing(&self, node: Node<'a>, owner: &Owner, attribute: &'static str) -> DescriptionError {
        let (owner, element) = (owner.clone(), node.tag_name().name().to_owned());
        self.fail(node, DescriptionProblem::MissingAttribute { owner, element, attribute })
    }

    /// The name of a link or joint.
    pub(super) fn own_name(&self, node: Node<'a>, element: &'static str) -> Result<&'a str, DescriptionError> {
        let name = self.required(node, &Owner::Robot, "name")?;
        if name.trim().is_empty() {
            return Err(self.fail(node, DescriptionProblem::EmptyName { element }));
        }
        Ok(name)
    }

    /// An attribute of `N` finite numbers.
    pub(super) fn numbers<const N: usize>(
        &self,
        node: Node<'a>,
        owner: &Owner,
        name: &'static str,
    ) -> Result<Option<[f64; N]>, DescriptionError> {
        let Some(attribute) = attribute(node, name) else { return Ok(None) };
        let (owner, element) = (|| owner.clone(), || node.tag_name().name().to_owned());
        let at = attribute.range_value().start;
        let mut values = [0.0; N];
        let mut given = 0;
        for word in attribute.value().split_ascii_whitespace() {
            let shown = || {
                if word.len() > SHOWN {
                    format!("{}…", word.chars().take(SHOWN).collect::<String>())
                } else {
                    word.to_owned()
                }
            };
            let Ok(value) = word.parse::<f64>() else {
                // An expression with blanks in it is shown whole.
                let text = if word.contains("${") { attribute.value().chars().take(SHOWN).collect() } else { shown() };
                let problem =
                    DescriptionProblem::NotANumber { owner: owner(), element: element(), attribute: name, text };
                return Err(self.source.fail(at, problem));
            };
            if !value.is_finite() {
                let text = shown();
                let problem =
                    DescriptionProblem::NotFinite { owner: owner(), element: element(), attribute: name, text };
                return Err(self.source.fail(at, problem));
            }
            if let Some(place) = values.get_mut(given) {
                *place = value;
            }
            given += 1;
        }
        if given != N {
            let (owner, element) = (owner(), element());
            let problem = DescriptionProblem::WrongCount { owner, element, attribute: name, given, wanted: N };
            return Err(self.source.fail(at, problem));
        }
        Ok(Some(values))
    }

    /// An attribute of one finite number.
    pub(super) fn number(
        &self,
        node: Node<'a>,
        owner: &Owner,
        name: &'static str,
    ) -> Result<Option<f64>, DescriptionError> {
        Ok(self.numbers(node, owner, name)?.map(|[value]| value))
    }

    /// An attribute of one finite number, which must be there.
    pub(super) fn required_number(
        &self,
        node: Node<'a>,
        owner: &Owner,
        name: &'static str,
    ) -> Result<f64, DescriptionError> {
        self.number(node, owner, name)?.ok_or_else(|| self.missing(node, owner, name))
    }

    /// `value`, which must not be below zero.
    pub(super) fn not_negative(
        &self,
        node: Node<'a>,
        owner: &Owner,
        name: &'static str,
        value: f64,
    ) -> Result<f64, DescriptionError> {
        if value < 0.0 {
            let (owner, element) = (owner.clone(), node.tag_name().name().to_owned());
            return Err(self.fail(node, DescriptionProblem::Negative { owner, element, attribute: name, value }));
        }
        Ok(value)
    }

    /// Origin and roll, pitch, yaw of an `<origin>`; zeros where it or one of its attributes is not there.
    pub(super) fn origin(
        &mut self,
        node: Option<Node<'a>>,
        owner: &Owner,
    ) -> Result<([f64; 3], [f64; 3]), DescriptionError> {
        let Some(node) = node else { return Ok(([0.0; 3], [0.0; 3])) };
        if self.text(node, "quat_xyzw").is_some() {
            let what = "quat_xyzw of <origin>".to_owned();
            return Err(self.fail(node, DescriptionProblem::Unsupported { owner: owner.clone(), what }));
        }
        self.leaf(node, owner, &["xyz", "rpy"], &[])?;
        let xyz = self.numbers(node, owner, "xyz")?.unwrap_or([0.0; 3]);
        let rpy = self.numbers(node, owner, "rpy")?.unwrap_or([0.0; 3]);
        Ok((xyz, rpy))
    }
}

/// The attribute without prefix of that name.
fn attribute<'a>(node: Node<'a>, name: &str) -> Option<Attribute<'a, 'a>> {
    node.attributes().find(|attribute| attribute.name() == name && attribute.namespace().is_none())
}
