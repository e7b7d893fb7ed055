//! What the command line says in place of the file: values (`--set`) and sweeps (`--sweep`).

mod removal;
mod span;

use self::removal::{forget_figures, take_out};
use super::written::{Override, Scenario};
use crate::changes::more::{More, OPTION};
use crate::changes::path::{self, Target};
use crate::reader::{Context, Read};
use crate::text::document::{self, Entry, MAX_BYTES, Node, Value};
use crate::text::refusal::{Place, Refusal, RefusalKind, Refusals, SWEEP_FORM, SWEEP_OPTION, Source};
use std::ops::Range;
use std::sync::Arc;

/// An option and what is written behind it: `PATH=…`.
struct Assignment {
    source: Arc<Source>,
    path: String,
    path_place: Place,
    /// Where the text behind the `=` stands; empty where there is none.
    value: Range<usize>,
}

impl Assignment {
    fn read(option: &str, right: &str, text: &str) -> Result<Self, Refusals> {
        let source = Arc::new(Source { name: option.to_owned(), text: text.into() });
        let place = |span| Place { source: source.clone(), span };
        let refuse = |message: &str| -> Refusals {
            place(0..text.len()).refuse(RefusalKind::Syntax, message).help(right).into()
        };
        if text.len() as u64 > MAX_BYTES {
            return Err(refuse(&format!("{option} takes no more than 4 MiB")));
        }
        let Some(equals) = path::equals_sign(text) else {
            return Err(refuse(&format!("{option} {:?} has no `=`", document::shorten(text))));
        };
        let (path, value) = (text[..equals].trim(), text[equals + 1..].trim());
        if path.is_empty() {
            return Err(refuse(&format!("{option} {:?} has no path", document::shorten(text))));
        }
        let start = equals + 1 + (text[equals + 1..].len() - text[equals + 1..].trim_start().len());
        let path_start = text.len() - text.trim_start().len();
        let path_place = place(path_start..path_start + path.len());
        let (path, value) = (path.to_owned(), start..start + value.len());
        Ok(Self { source, path, path_place, value })
    }

    /// What stands at `range`: a TOML value, else a text.
    fn value(&self, range: Range<usize>) -> Result<Node, Refusals> {
        let text = self.source.text[range.clone()].to_owned();
        let place = Place { source: self.source.clone(), span: range.clone() };
        let node = Node::value(&self.source, range)?;
        Ok(node.unwrap_or(Node { value: Value::Text(text), place, tag: None }))
    }

    fn refuse_second(&self, earlier: &[Override], what: &str) -> Result<(), Refusals> {
        let Some(earlier) = earlier.iter().find(|earlier| earlier.path == self.path) else { return Ok(()) };
        let before = match &earlier.value {
            Some(value) => format!("was {} before", document::shorten(value.place.text())),
            None => "was taken out before".to_owned(),
        };
        let message = format!("{} is {what} twice, and {before}", self.path);
        Err(self.path_place.refuse(RefusalKind::Rule, message).help("leave one of them out").into())
    }

    fn with(self, value: Option<Node>) -> Override {
        Override { path: self.path, place: self.path_place, value }
    }
}

impl Scenario {
    /// Overrides one value: `PATH=VALUE`, as in `element.strut.alpha=0.5`. VALUE is read as a TOML value, else as a text; without one,
    /// `PATH=`, the key is taken out, and `sweep=` takes all sweeps out, with the figures of swept values.
    /// What the path leads to is checked with everything else, in [`Scenario::cases`].
    ///
    /// # Errors
    /// No `=`, an empty path; a path that was set before.
    pub fn set(&mut self, assignment: &str) -> Result<(), Refusals> {
        let right =
            "write PATH=VALUE, as in element.strut.alpha=0.5 or element.strut.T=\"25 degC\"; PATH= takes the key out";
        let read = Assignment::read("--set", right, assignment)?;
        read.refuse_second(&self.overrides, "set")?;
        let value = (!read.value.is_empty()).then(|| read.value(read.value.clone())).transpose()?;
        self.overrides.push(read.with(value));
        Ok(())
    }

    /// As [`Self::set`], but in place of what was set at this path before.
    ///
    /// # Errors
    /// No `=`, an empty path.
    pub fn set_anew(&mut self, assignment: &str) -> Result<(), Refusals> {
        if let Some(path) = path::equals_sign(assignment).and_then(|equals| path::keys(assignment[..equals].trim())) {
            self.overrides.retain(|earlier| path::keys(&earlier.path) != Some(path.clone()));
        }
        self.set(assignment)
    }

    /// Sweeps a parameter: `PATH=v1,v2,…`, `PATH=FROM:TO:COUNT` or `PATH=FROM:TO:COUNT:log`. It takes the place of the file's sweep of that
    /// path, or stands beside the sweeps of the file and runs fastest. Commas inside brackets or quotes belong to a value. Paths that move together
    /// are `[PATH, PATH]=[v, w],…`.
    ///
    /// # Errors
    /// No `=`, an empty path or an empty value; a path that was swept before; what begins as a span and is none.
    pub fn sweep(&mut self, assignment: &str) -> Result<(), Refusals> {
        let read = Assignment::read(SWEEP_OPTION, SWEEP_FORM, assignment)?;
        read.refuse_second(&self.sweeps, "swept")?;
        let refuse = |span: Range<usize>, message: &str| -> Refusals {
            let place = Place { source: read.source.clone(), span };
            place.refuse(RefusalKind::Syntax, message).help(SWEEP_FORM).into()
        };
        let text = &*read.source.text;
        if read.value.is_empty() {
            let message = format!("{SWEEP_OPTION} {:?} has no value", document::shorten(text));
            return Err(refuse(0..text.len(), &message));
        }
        let parts = split(text, read.value.clone(), ',');
        let place = Place { source: read.source.clone(), span: read.value.clone() };
        let value = if parts.len() == 1
            && let Some(ends) = span::ends(text, read.value.clone()).map_err(|(at, why)| refuse(at, &why))?
        {
            let mut entries = Vec::new();
            let keys = ["from", "to", "count", "scale"];
            for (key, range) in keys.into_iter().zip(ends) {
                let node = read.value(range.clone())?;
                let key_place = Place { source: read.source.clone(), span: range };
                entries.push(Entry { key: key.to_owned(), key_place, node: Arc::new(node) });
            }
            Value::Table(entries)
        } else {
            if let Some(empty) = parts.iter().find(|part| part.is_empty()) {
                return Err(refuse(empty.start..text.len().min(empty.end + 1), "a value of --sweep is empty"));
            }
            let values = parts.into_iter().map(|part| read.value(part).map(Arc::new));
            Value::Array(values.collect::<Result<_, _>>()?)
        };
        self.sweeps.push(read.with(Some(Node { value, place, tag: None })));
        Ok(())
    }
}

impl Scenario {
    /// Differentiates by the numbers at these paths too, or by parameters of these names: `PATH,PATH`.
    ///
    /// # Errors
    /// An empty path.
    pub fn differentiate(&mut self, paths: &str) -> Result<(), Refusals> {
        let source = Arc::new(Source { name: OPTION.to_owned(), text: paths.into() });
        for part in split(paths, 0..paths.len(), ',') {
            let place = Place { source: source.clone(), span: part.clone() };
            if part.is_empty() {
                let refusal = place.refuse(RefusalKind::Syntax, format!("a path of {OPTION} is empty"));
                return Err(refusal.help("write PATH,PATH, as in element.strut.alpha,motion.start.v.q1").into());
            }
            self.sensitivity.push(More { written: paths[part].to_owned(), place });
        }
        Ok(())
    }
}

/// The stretches between separators that stand in no brackets and no quotes, without blanks around them.
fn split(text: &str, range: Range<usize>, separator: char) -> Vec<Range<usize>> {
    let trimmed = |start: usize, end: usize| {
        let part = &text[start..end];
        let start = start + (part.len() - part.trim_start().len());
        start..start + part.trim().len()
    };
    let (mut parts, mut start, mut depth, mut quote) = (Vec::new(), range.start, 0usize, None);
    let mut escaped = false;
    for (at, c) in text[range.clone()].char_indices() {
        match (quote, c) {
            (Some('"'), '\\') if !escaped => {
                escaped = true;
                continue;
            }
            (Some(open), c) if c == open && !escaped => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth = depth.saturating_sub(1),
            (None, c) if c == separator && depth == 0 => {
                parts.push(trimmed(start, range.start + at));
                start = range.start + at + c.len_utf8();
            }
            _ => {}
        }
        escaped = false;
    }
    parts.push(trimmed(start, range.end));
    parts
}

/// Puts values and sweeps into the document; the paths of the values.
pub(crate) fn apply(ctx: &Context<'_>, scenario: &Scenario, document: &mut Node) -> Read<Vec<Target>> {
    let mut set: Vec<Target> = Vec::new();
    let mut freed = Vec::new();
    for item in &scenario.overrides {
        let Some(value) = &item.value else {
            freed.extend(take_out(ctx, document, item)?);
            // Tables behind one that is gone have moved.
            let paths: Vec<_> = set.iter().map(|target| (target.written.clone(), target.place.clone())).collect();
            set.clear();
            for (path, place) in paths {
                set.push(path::resolve(ctx, document, &path, &place)?);
            }
            continue;
        };
        let target = path::resolve(ctx, document, &item.path, &item.place)?;
        path::set(document, &target, value.clone());
        set.push(target);
    }
    for item in &scenario.sweeps {
        let paths = together(&item.path);
        for path in &paths {
            path::resolve(ctx, document, path, &item.place)?;
        }
        replace_sweep(ctx, document, &paths, item)?;
    }
    forget_figures(ctx, document, &freed);
    Ok(set)
}

/// The paths that move together, `[PATH, PATH]`, or the one there is.
fn together(written: &str) -> Vec<&str> {
    match written.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        Some(paths) => split(paths, 0..paths.len(), ',').into_iter().map(|range| &paths[range]).collect(),
        None => vec![written],
    }
}

/// Gives the sweep of these paths other values, or adds one.
fn replace_sweep(ctx: &Context<'_>, document: &mut Node, wanted: &[&str], item: &Override) -> Read<()> {
    let Some(values) = &item.value else { return Ok(()) };
    let wanted_keys: Vec<_> = wanted.iter().map(|path| path::keys(path)).collect();
    let blocks = document.get("sweep").and_then(|sweep| sweep.items()).unwrap_or_default();
    let mut found = None;
    for (at, block) in blocks.iter().enumerate() {
        let Some(parameter) = block.get("parameter") else { continue };
        let paths: Vec<&Node> =
            parameter.items().map_or(vec![parameter], |items| items.iter().map(|item| &**item).collect());
        let keys: Vec<_> = paths.iter().map(|node| node.text().and_then(path::keys)).collect();
        if let Some(both) = wanted_keys.iter().position(|wanted| wanted.is_some() && keys.contains(wanted)) {
            if paths.len() != wanted.len() || !wanted_keys.iter().all(|wanted| keys.contains(wanted)) {
                let how = if paths.len() > 1 { "together with others" } else { "alone" };
                let message = format!("{} is swept {how} in the file", wanted[both]);
                let refusal: Refusal = item.place.refuse(RefusalKind::Rule, message);
                return Err(ctx.refuse(refusal.help("change its [[sweep]] in the file")));
            }
            found = Some(at);
        }
    }
    let text = |text: &str| Node { value: Value::Text(text.to_owned()), place: item.place.clone(), tag: None };
    let entry =
        |key: &str, node: Node| Entry { key: key.to_owned(), key_place: item.place.clone(), node: Arc::new(node) };
    let parameter = match wanted {
        [path] if !item.path.starts_with('[') => text(path),
        paths => {
            let nodes = paths.iter().map(|path| Arc::new(text(path))).collect();
            Node { value: Value::Array(nodes), place: item.place.clone(), tag: None }
        }
    };
    let block = Value::Table(vec![entry("parameter", parameter), entry("values", values.clone())]);
    let block = Arc::new(Node { value: block, place: item.place.clone(), tag: None });
    let mut blocks = blocks.to_vec();
    match found {
        Some(at) => blocks[at] = block,
        None => blocks.push(block),
    }
    if let Value::Table(entries) = &mut document.value {
        entries.retain(|entry| entry.key != "sweep");
        let node = Node { value: Value::Array(blocks), place: item.place.clone(), tag: None };
        entries.push(entry("sweep", node));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_split_outside_brackets_and_quotes() {
        let parts =
            |text: &str| split(text, 0..text.len(), ',').into_iter().map(|at| text[at].to_owned()).collect::<Vec<_>>();
        assert_eq!(parts("0.2, 0.5"), ["0.2", "0.5"]);
        assert_eq!(parts("[1,2],[3, 4]"), ["[1,2]", "[3, 4]"]);
        assert_eq!(parts("\"a,b\",'c,d'"), ["\"a,b\"", "'c,d'"]);
        assert_eq!(parts("min(1,t),\"x\\\",y\""), ["min(1,t)", "\"x\\\",y\""]);
        assert_eq!(parts("1,,2"), ["1", "", "2"]);
    }
}
