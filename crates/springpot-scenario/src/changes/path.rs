//! Dotted paths into a scenario: `element.strut.alpha`, `solver.rtol`, `robot.body.forearm.mass`.

use crate::keys::{COMPONENT, COMPONENTS, ELEMENT, Keys, Shape, vector};
use crate::reader::element::{kind_of, law_of, words_of};
use crate::reader::{Context, Read};
use crate::text::document::{Entry, Node, Value, shorten};
use crate::text::names;
use crate::text::quoted::toml_key;
use crate::text::refusal::{Place, RefusalKind, Source};
use std::sync::Arc;
use toml::de::DeValue;

/// The key that holds the components of a bushing.
const BUSHING: &str = "bushing";

/// Longest path, in keys.
const MAX_KEYS: usize = 16;

/// One step from a node to a child.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Step {
    Key(String),
    Index(usize),
}

/// A path as written and what it leads to; the last keys may not exist yet.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    pub(crate) written: String,
    pub(crate) place: Place,
    pub(crate) steps: Vec<Step>,
}

impl Target {
    /// Whether one leads to the other or into it.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let n = self.steps.len().min(other.steps.len());
        self.steps[..n] == other.steps[..n]
    }

    /// The top-level key and the last one.
    pub(crate) fn ends(&self) -> (&str, &str) {
        (key(self.steps.first()), key(self.steps.last()))
    }
}

/// The key of a step by name.
fn key(step: Option<&Step>) -> &str {
    match step {
        Some(Step::Key(key)) => key,
        _ => "",
    }
}

/// Splits a path into its keys; keys may be quoted as in TOML. `None` where it is not a path.
pub(crate) fn keys(path: &str) -> Option<Vec<String>> {
    let mut keys = Vec::new();
    let mut rest = path.trim();
    loop {
        let end = match rest.chars().next()? {
            '\'' => rest[1..].find('\'')? + 2,
            '"' => closing_quote(rest)? + 1,
            _ => rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '-')).unwrap_or(rest.len()),
        };
        let (key, after) = rest.split_at(end);
        keys.push(match key.chars().next()? {
            '\'' | '"' => DeValue::parse(key).ok()?.get_ref().as_str()?.to_owned(),
            _ => key.to_owned(),
        });
        rest = after.trim_start();
        match rest.strip_prefix('.') {
            Some(after) if keys.len() < MAX_KEYS => rest = after.trim_start(),
            None if rest.is_empty() => return Some(keys),
            _ => return None,
        }
    }
}

/// Byte of the `=` after a path, as in `PATH=VALUE`; quoted keys and values may hold one too.
pub fn equals_sign(assignment: &str) -> Option<usize> {
    let mut at = 0;
    while at < assignment.len() {
        let rest = &assignment[at..];
        at += match rest.chars().next()? {
            '=' => return Some(at),
            '"' => closing_quote(rest)? + 1,
            '\'' => rest[1..].find('\'')? + 2,
            c => c.len_utf8(),
        };
    }
    None
}

/// Byte of the quote that ends the string at the start of `text`.
fn closing_quote(text: &str) -> Option<usize> {
    let mut escaped = false;
    text.char_indices().skip(1).find_map(|(at, c)| match c {
        '\\' if !escaped => {
            escaped = true;
            None
        }
        '"' if !escaped => Some(at),
        _ => {
            escaped = false;
            None
        }
    })
}

/// Where `path` leads in `document`. Refuses names that do not exist, and whole tables; keys of tables may be new, the reader judges them.
pub(crate) fn resolve(ctx: &Context<'_>, document: &Node, path: &str, place: &Place) -> Read<Target> {
    let target = lead(ctx, document, path, place)?;
    let node = get(document, &target);
    let is_table = node.is_some_and(|node| node.entries().is_some());
    if matches!(target.steps.last(), Some(Step::Index(_))) && is_table
        || (target.steps.len() == 1 && node.is_some_and(is_section))
    {
        let message = format!("path {:?} leads to a whole table", shorten(path));
        let help = match parts_of(document, &target) {
            parts if parts.is_empty() => "go on to one of its keys".to_owned(),
            parts => format!("go on to one of its keys: {}", names::list(parts.iter().map(String::as_str))),
        };
        return Err(ctx.refuse(place.refuse(RefusalKind::WrongType, message).help(help)));
    }
    Ok(target)
}

/// What a path may go on with.
fn parts_of(document: &Node, target: &Target) -> Vec<String> {
    let start = keys(&target.written).unwrap_or_default();
    let longer = all(document).into_iter().filter(|path| path.len() == start.len() + 1 && path.starts_with(&start));
    longer.filter_map(|path| path.last().map(|key| toml_key(key))).collect()
}

/// As [`resolve`], whatever it leads to.
pub(crate) fn lead(ctx: &Context<'_>, document: &Node, path: &str, place: &Place) -> Read<Target> {
    let refuse = |kind, message: String, help: String| ctx.refuse(place.refuse(kind, message).help(help));
    let Some(keys) = keys(path) else {
        let message = format!("{:?} is not a path", shorten(path));
        let help = "write keys joined by dots, as in element.strut.alpha or solver.rtol".to_owned();
        return Err(refuse(RefusalKind::BadName, message, help));
    };
    if keys[0] == "sweep" {
        let message = format!("{:?} is not a path: a [[sweep]] has no name", shorten(path));
        return Err(refuse(RefusalKind::BadName, message, "write --sweep PATH=v1,v2,…".to_owned()));
    }
    if ctx.whole.get(&keys[0]).is_none() {
        let message = format!("path {:?}: the scenario has no `{}`", shorten(path), shorten(&keys[0]));
        return Err(refuse(RefusalKind::UnknownName, message, meant(ctx, document, &keys)));
    }
    let mut node = Some(document);
    let mut steps = Vec::with_capacity(keys.len() + 1);
    for (at, key) in keys.iter().enumerate() {
        let walked = || dotted(&keys[..at]);
        let Some(here) = node else {
            steps.push(Step::Key(key.clone()));
            continue;
        };
        match &here.value {
            Value::Table(entries) => {
                let owner = owner_of_a_law(&steps);
                if let Some(keys) = owner
                    && let Some(section) = section_of(ctx, here, keys, key)
                {
                    steps.push(Step::Key(section.to_owned()));
                    node = here.get(section).map(|node| &**node).and_then(|node| node.get(key)).map(|node| &**node);
                } else if let Some(keys) = owner
                    && let Some(names) = names_of_element(ctx, here, keys)
                    && !names.contains(key)
                {
                    let message = format!("path {:?}: `{}` has no `{}`", shorten(path), walked(), shorten(key));
                    return Err(refuse(
                        RefusalKind::UnknownName,
                        message,
                        names::suggest(key, names.iter().map(String::as_str)),
                    ));
                } else {
                    node = entries.iter().find(|entry| entry.key == *key).map(|entry| &*entry.node);
                }
                steps.push(Step::Key(key.clone()));
            }
            Value::Array(items) if items.iter().all(|item| item.entries().is_some()) && !items.is_empty() => {
                let name = |item: &Arc<Node>| item.get("name").and_then(|name| name.text()).map(str::to_owned);
                let found = items.iter().position(|item| name(item).as_deref() == Some(key));
                // What has no names is counted.
                let counted = || key.parse().ok().filter(|&at: &usize| at < items.len() && name(&items[at]).is_none());
                let found = found.or_else(counted);
                let Some(index) = found else {
                    let names: Vec<String> = items.iter().filter_map(name).collect();
                    let message = format!("path {:?}: no {} is named {:?}", shorten(path), walked(), shorten(key));
                    let help = names::suggest(key, names.iter().map(String::as_str));
                    return Err(refuse(RefusalKind::UnknownName, message, help));
                };
                steps.push(Step::Index(index));
                node = Some(&items[index]);
            }
            Value::Array(items) if items.iter().all(|item| item.entries().is_none()) && !items.is_empty() => {
                let Some(index) = key.parse().ok().filter(|&index: &usize| index < items.len()) else {
                    let message =
                        format!("path {:?}: `{}` has no component `{}`", shorten(path), walked(), shorten(key));
                    let help = format!("components count from 0: 0 to {}", items.len() - 1);
                    return Err(refuse(RefusalKind::UnknownName, message, help));
                };
                steps.push(Step::Index(index));
                node = Some(&items[index]);
            }
            _ => {
                let message = format!("path {:?}: `{}` is {} and has no keys", shorten(path), walked(), here.kind());
                let help = format!("end the path at `{}`; an array is given as a whole", walked());
                return Err(refuse(RefusalKind::UnknownName, message, help));
            }
        }
    }
    Ok(Target { written: dotted(&keys), place: place.clone(), steps })
}

fn is_section(node: &Node) -> bool {
    matches!(node.value, Value::Table(_))
        || node.items().is_some_and(|items| items.iter().any(|item| item.entries().is_some()))
}

/// Paths of all that is written in a document, tables among it; array items by name, parameters and inputs of elements as their own keys.
pub(crate) fn all(document: &Node) -> Vec<Vec<String>> {
    let (mut paths, mut walked) = (Vec::new(), Vec::new());
    below(document, &mut walked, &mut paths);
    paths
}

fn below(node: &Node, walked: &mut Vec<String>, paths: &mut Vec<Vec<String>>) {
    if walked.len() >= MAX_KEYS {
        return;
    }
    let mut go = |key: &str, node: &Node| {
        walked.push(key.to_owned());
        paths.push(walked.clone());
        below(node, walked, paths);
        walked.pop();
    };
    match &node.value {
        Value::Table(entries) => {
            for entry in entries.iter().filter(|entry| entry.key != "sweep") {
                let is_own = matches!(entry.key.as_str(), "parameters" | "inputs" | BUSHING);
                match entry.node.entries().filter(|_| is_own) {
                    Some(own) => own.iter().for_each(|entry| go(&entry.key, &entry.node)),
                    None => go(&entry.key, &entry.node),
                }
            }
        }
        Value::Array(items) => {
            for item in items.iter() {
                if let Some(name) = item.get("name").and_then(|name| name.text()) {
                    go(name, item);
                }
            }
        }
        _ => {}
    }
}

/// What to say of a path that begins with no part of a scenario: the whole path that ends like it, if one does.
fn meant(ctx: &Context<'_>, document: &Node, keys: &[String]) -> String {
    let all = all(document);
    let ends: Vec<String> = all.iter().filter(|path| path.ends_with(keys)).map(|path| dotted(path)).collect();
    let sections = ctx.whole.names();
    // What need not be written in the file, as of [solver].
    let unwritten = || {
        let tables = ctx.whole.keys.iter().filter_map(|row| match row.shape {
            Shape::Table(table) => Some((row.name, table)),
            _ => None,
        });
        let mut holding = tables.filter(|(_, table)| keys.len() == 1 && table.get(&keys[0]).is_some());
        holding.next().map(|(section, _)| format!("did you mean {section}.{}?", keys[0]))
    };
    match ends.len() {
        0 => unwritten().unwrap_or_else(|| {
            let paths: Vec<String> = all.iter().map(|path| dotted(path)).collect();
            match names::nearest(&dotted(keys), paths.iter().map(String::as_str)) {
                Some(right) => format!("did you mean {right}?"),
                None => names::suggest(&keys[0], sections),
            }
        }),
        1 => format!("did you mean {}?", ends[0]),
        _ => format!("did you mean {}?", names::either(ends.iter().map(String::as_str).take(5))),
    }
}

/// Keys as a path.
pub(crate) fn dotted(keys: &[String]) -> String {
    keys.iter().map(|key| toml_key(key)).collect::<Vec<_>>().join(".")
}

/// The keys of the table that `steps` lead to, where it is an element or a component of a bushing.
fn owner_of_a_law(steps: &[Step]) -> Option<&'static Keys> {
    match steps {
        [Step::Key(root), Step::Index(_)] if root == "element" => Some(&ELEMENT),
        [Step::Key(root), Step::Index(_), Step::Key(bushing), Step::Key(_)]
            if root == "element" && bushing == BUSHING =>
        {
            Some(&COMPONENT)
        }
        _ => None,
    }
}

/// The table of an element in which `key` is looked up: parameters, then inputs, then (`None`) the element's own keys.
fn section_of(ctx: &Context<'_>, element: &Node, keys: &Keys, key: &str) -> Option<&'static str> {
    if element.get(BUSHING).is_some() {
        return COMPONENTS.get(key).map(|_| BUSHING);
    }
    for section in ["parameters", "inputs"] {
        if element.get(section).is_some_and(|table| table.get(key).is_some()) {
            return Some(section);
        }
    }
    if keys.get(key).is_some() {
        return None;
    }
    let law = law_of(ctx, element)?;
    if law.params.iter().any(|param| param.name == key) || words_of(element).iter().any(|word| word == key) {
        Some("parameters")
    } else if law.inputs.iter().any(|input| input.name == key) {
        Some("inputs")
    } else {
        None
    }
}

/// Everything that a path into an element can name; `None` where its law is not known.
fn names_of_element(ctx: &Context<'_>, element: &Node, keys: &Keys) -> Option<Vec<String>> {
    if element.get(BUSHING).is_some() {
        let own = keys.names_for(kind_of(element)).into_iter();
        return Some(own.chain(COMPONENTS.names()).map(str::to_owned).collect());
    }
    let law = law_of(ctx, element)?;
    let parameters = law.params.iter().map(|param| &*param.name);
    let inputs = law.inputs.iter().map(|input| &*input.name);
    let names = parameters.chain(inputs).chain(keys.names()).map(str::to_owned);
    Some(names.chain(words_of(element)).collect())
}

/// What stands where `target` leads.
pub(crate) fn get<'n>(document: &'n Node, target: &Target) -> Option<&'n Node> {
    target.steps.iter().try_fold(document, |node, step| match (step, &node.value) {
        (Step::Index(index), Value::Array(items)) => items.get(*index).map(|item| &**item),
        (Step::Key(key), Value::Table(_)) => node.get(key).map(|node| &**node),
        _ => None,
    })
}

/// Puts `value` where `target` leads; tables on the way are made where they lack.
pub(crate) fn set(document: &mut Node, target: &Target, value: Node) {
    let mut node = document;
    for (at, step) in target.steps.iter().enumerate() {
        node = match (step, &mut node.value) {
            (Step::Index(index), Value::Array(items)) => match items.get_mut(*index) {
                Some(item) => Arc::make_mut(item),
                None => return,
            },
            (Step::Key(key), Value::Array(items)) => match key.parse().ok().and_then(|k: usize| items.get_mut(k)) {
                Some(item) => Arc::make_mut(item),
                None => return,
            },
            (Step::Key(key), Value::Table(entries)) => {
                let at = entries.iter().position(|entry| entry.key == *key).unwrap_or_else(|| {
                    let table = Node { value: Value::Table(Vec::new()), place: target.place.clone(), tag: None };
                    let node = component(&target.steps[at..]).and_then(|(vector, _)| written(vector, &target.place));
                    let node = node.unwrap_or(table);
                    entries.push(Entry { key: key.clone(), key_place: target.place.clone(), node: Arc::new(node) });
                    entries.len() - 1
                });
                Arc::make_mut(&mut entries[at].node)
            }
            _ => return,
        };
    }
    *node = value;
}

/// What stands for the three numbers whose component the steps lead to, where the file leaves them out, and which component that is.
pub(crate) fn component(steps: &[Step]) -> Option<([f64; 3], usize)> {
    let [Step::Key(name), Step::Key(component)] = steps else { return None };
    let component = component.parse().ok().filter(|component| *component < 3)?;
    Some((vector(name)?, component))
}

/// Three numbers as if they stood at `place`.
fn written(vector: [f64; 3], place: &Place) -> Option<Node> {
    let text: Arc<str> = format!("{vector:?}").into();
    let source = Arc::new(Source { name: place.source.name.clone(), text: text.clone() });
    Node::value(&source, 0..text.len()).ok().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_split_like_toml_keys() {
        let split = |path: &str| keys(path).map(|keys| keys.join("|"));
        assert_eq!(split("element.strut.alpha").as_deref(), Some("element|strut|alpha"));
        assert_eq!(split(" a . \"b.c\" . 'd\"e' ").as_deref(), Some("a|b.c|d\"e"));
        assert_eq!(split(r#""q\"1".x"#).as_deref(), Some("q\"1|x"));
        for bad in ["", ".", "a.", ".a", "a..b", "a b", "\"a", "'a", "a.\"b\"c", "ä", "a=b"] {
            assert_eq!(split(bad), None, "{bad}");
        }
        assert_eq!(keys(&["a"; MAX_KEYS + 1].join(".")), None);
    }

    #[test]
    fn every_key_has_a_path() {
        for key in ["q1", "left knee", "a.b", "", "ü", "a\"b", "a\\b", "tab\tnull\0", "'", "a=b", "\u{7f}"] {
            let path = format!("motion.joints.{}", toml_key(key));
            assert_eq!(keys(&path), Some(vec!["motion".into(), "joints".into(), key.to_owned()]), "{path}");
            assert_eq!(equals_sign(&format!("{path}=1")), Some(path.len()), "{path}");
        }
        assert_eq!(["q1", "left knee", "a\"b"].map(toml_key), ["q1", "\"left knee\"", "\"a\\\"b\""]);
    }
}
