//! `--set PATH=`: what is taken out of the document.

use crate::changes::path::{self, Step};
use crate::reader::{Context, Read, Refused};
use crate::scenario::written::Override;
use crate::text::document::{Node, Value};
use crate::text::names;
use crate::text::refusal::{RefusalKind, Remark};
use std::sync::Arc;

/// Paths that were swept, as keys.
type Paths = Vec<Vec<String>>;

/// Takes out what `item` leads to; the paths that are no longer swept then.
pub(super) fn take_out(ctx: &Context<'_>, document: &mut Node, item: &Override) -> Read<Paths> {
    let keys = path::keys(&item.path);
    if keys.as_ref().is_some_and(|keys| matches!(&keys[..], [only] if only == "sweep")) {
        return Ok(take_sweeps_out(document));
    }
    let target = path::lead(ctx, document, &item.path, &item.place)?;
    let taken = target.steps.split_last().is_some_and(|(last, before)| {
        let holder = before.iter().try_fold(&mut *document, |node, step| child(node, step));
        holder.is_some_and(|holder| remove(holder, last))
    });
    match taken {
        true => Ok(Vec::new()),
        false => Err(not_there(ctx, document, item)),
    }
}

/// All sweeps; there may be none.
fn take_sweeps_out(document: &mut Node) -> Paths {
    let Value::Table(entries) = &mut document.value else { return Vec::new() };
    let Some(at) = entries.iter().position(|entry| entry.key == "sweep") else { return Vec::new() };
    let sweeps = entries.remove(at).node;
    let blocks = sweeps.items().unwrap_or_default().iter();
    blocks.filter_map(|block| block.get("parameter")).flat_map(|parameter| texts(parameter)).collect()
}

/// The paths that a text, or each text of an array, says.
fn texts(node: &Node) -> Paths {
    let one = |node: &Node| node.text().and_then(path::keys);
    node.items()
        .map_or_else(|| one(node).into_iter().collect(), |items| items.iter().filter_map(|item| one(item)).collect())
}

/// Takes the figures out that speak of paths which are no longer swept, and says which.
pub(super) fn forget_figures(ctx: &Context<'_>, document: &mut Node, freed: &[Vec<String>]) {
    if freed.is_empty() {
        return;
    }
    let blocks = document.get("sweep").and_then(|sweep| sweep.items()).unwrap_or_default();
    let swept: Paths = blocks.iter().filter_map(|block| block.get("parameter")).flat_map(|node| texts(node)).collect();
    let is_gone = |path: &Vec<String>| freed.contains(path) && !swept.contains(path);
    let Value::Table(entries) = &mut document.value else { return };
    let Some(figures) = entries.iter_mut().find(|entry| entry.key == "figure") else { return };
    let Value::Array(items) = &mut Arc::make_mut(&mut figures.node).value else { return };
    let speaks = |figure: &Node| {
        let selected = figure.get("where").and_then(|selected| selected.entries()).unwrap_or_default();
        let selects = selected.iter().filter_map(|entry| path::keys(&entry.key)).any(|path| is_gone(&path));
        selects
            || ["x", "y"]
                .iter()
                .filter_map(|axis| figure.get(axis))
                .flat_map(|node| texts(node))
                .any(|path| is_gone(&path))
    };
    let (gone, kept): (Vec<_>, Vec<_>) = items.drain(..).enumerate().partition(|(_, figure)| speaks(figure));
    *items = kept.into_iter().map(|(_, figure)| figure).collect();
    let named = |(k, figure): &(usize, Arc<Node>)| {
        figure.get("name").and_then(|name| name.text()).map_or(format!("figure-{}", k + 1), str::to_owned)
    };
    let gone: Vec<String> = gone.iter().map(named).collect();
    if !gone.is_empty() {
        let names = names::list(gone.iter().map(String::as_str));
        let are =
            if gone.len() == 1 { "figure {} is not drawn: it speaks" } else { "figures {} are not drawn: they speak" };
        ctx.warn(Remark::new(format!("{} of values that are no longer swept", are.replace("{}", &names))));
    }
}

/// What a step leads to.
fn child<'n>(node: &'n mut Node, step: &Step) -> Option<&'n mut Node> {
    match (step, &mut node.value) {
        (Step::Index(index), Value::Array(items)) => items.get_mut(*index).map(Arc::make_mut),
        (Step::Key(key), Value::Table(entries)) => {
            entries.iter_mut().find(|entry| entry.key == *key).map(|entry| Arc::make_mut(&mut entry.node))
        }
        _ => None,
    }
}

/// Takes one child out, if it is there. Components of vectors stay: there are always three.
fn remove(holder: &mut Node, step: &Step) -> bool {
    match (step, &mut holder.value) {
        (Step::Index(index), Value::Array(items)) if items.get(*index).is_some_and(|item| item.entries().is_some()) => {
            items.remove(*index);
            true
        }
        (Step::Key(key), Value::Table(entries)) => {
            let before = entries.len();
            entries.retain(|entry| entry.key != *key);
            entries.len() < before
        }
        _ => false,
    }
}

fn not_there(ctx: &Context<'_>, document: &Node, item: &Override) -> Refused {
    let keys = path::keys(&item.path).unwrap_or_default();
    let all = path::all(document);
    let paths: Vec<String> = all.iter().map(|path| path::dotted(path)).collect();
    let beside: Vec<&str> = all
        .iter()
        .filter(|path| path.len() == keys.len() && path[..path.len() - 1] == keys[..keys.len() - 1])
        .filter_map(|path| path.last().map(String::as_str))
        .collect();
    let written = path::dotted(&keys);
    let help = match names::nearest(&written, paths.iter().map(String::as_str)) {
        Some(right) => format!("did you mean {right}=?"),
        None if beside.is_empty() => "leave it out".to_owned(),
        None => format!("beside it there is {}", names::list(beside)),
    };
    let message = format!("there is no {written} to take out");
    ctx.refuse(item.place.refuse(RefusalKind::UnknownName, message).help(help))
}
