//! What the tables say before anything of the case is known.

use crate::changes::more::More;
use crate::changes::path::{self, Target};
use crate::changes::sweep::Axis;
use crate::figures::{ColumnGlob, columns};
use crate::keys::{ADJOINT, MAX_TOGETHER, PARAMETER, SENSITIVITY};
use crate::reader::named::{checked_name, unique};
use crate::reader::{Context, Field, Read, Refused, Table, all};
use crate::text::document::{Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use std::collections::HashMap;
use std::sync::Arc;

/// By what is differentiated, and what.
#[derive(Debug, Clone, Default)]
pub(crate) struct Asked {
    /// The numbers; where nothing is differentiated those of the blocks.
    pub(crate) by: Vec<By>,
    pub(crate) of: Option<Vec<ColumnGlob>>,
    pub(crate) control: bool,
    /// Where gradients of metrics are found by going back through the run: what says so.
    pub(crate) adjoint: Option<Place>,
    /// Whether anything is to be differentiated.
    pub(crate) is_asked: bool,
}

/// A number that is differentiated by.
#[derive(Debug, Clone)]
pub(crate) struct By {
    pub(crate) name: String,
    pub(crate) targets: Vec<Target>,
    /// Its block among those of the file.
    pub(crate) block: Option<usize>,
    pub(crate) place: Place,
}

/// Reads both tables; `more` stands beside `by`.
pub(crate) fn read(root: &Table<'_>, axes: &[Axis], more: &[More]) -> Read<Option<Asked>> {
    let blocks = match root.get("parameter") {
        None => Vec::new(),
        Some(field) => blocks(root, &field)?,
    };
    let table = root.get("sensitivity").map(|field| field.table(&SENSITIVITY)).transpose()?;
    if blocks.is_empty() && table.is_none() && more.is_empty() {
        return Ok(None);
    }
    let mut asked =
        Asked { by: Vec::new(), of: None, control: true, adjoint: None, is_asked: table.is_some() || !more.is_empty() };
    if let Some(table) = &table {
        asked.control = table.flag("control")?;
        let method = table.word("method", "method of derivatives")?;
        if method == ADJOINT {
            asked.adjoint = Some(table.require("method")?.node.place.clone());
        }
        asked.of = table.get("of").map(|field| columns::globs(&field)).transpose()?;
    }
    let ctx = root.ctx;
    let written = table.as_ref().and_then(|table| table.get("by"));
    match &written {
        Some(field) => {
            let items = match &field.node.value {
                Value::Text(_) => vec![field.clone()],
                _ => field.items("the name of a parameter, a path, or an array of them")?,
            };
            let read = items.iter().map(|item| one(ctx, root.node, &blocks, item.text()?, &item.node.place));
            asked.by = all(read.collect::<Vec<_>>())?;
        }
        None if table.is_some() || more.is_empty() => asked.by.clone_from(&blocks),
        None => {}
    }
    let more = more.iter().map(|more| one(ctx, root.node, &blocks, &more.written, &more.place));
    asked.by.extend(all(more.collect::<Vec<_>>())?);
    if asked.is_asked && asked.by.is_empty() {
        // What a command adds to the file is no place to look at.
        let is_of_file = |place: &Place| Arc::ptr_eq(&place.source, &root.node.place.source);
        let place = written.map_or_else(
            || root.get("sensitivity").map(|field| field.node.place.clone()).filter(is_of_file),
            |field| Some(field.node.place.clone()),
        );
        let message = "[sensitivity] has no parameter: nothing says by what is differentiated";
        let refusal = place.as_ref().unwrap_or(&root.node.place).refuse(RefusalKind::Missing, message);
        let help = "write a [[parameter]] with such a path as \"element.NAME.PARAMETER\", by = [\"PATH\"], or --by PATH on the command line";
        return Err(ctx.refuse(refusal.help(help)));
    }
    apart(ctx, &asked.by)?;
    let swept = axes.iter().flat_map(|axis| &axis.targets);
    for swept in swept {
        let both = asked.by.iter().flat_map(|by| &by.targets).find(|target| target.overlaps(swept));
        if let Some(target) = both {
            let message = format!("{} cannot be a parameter: it is swept", target.written);
            let refusal = target.place.refuse(RefusalKind::Rule, message);
            return Err(ctx.refuse(refusal.help("leave it out of the sweeps, or differentiate by something else")));
        }
    }
    Ok(Some(asked))
}

/// Refuses two parameters on one place.
pub(crate) fn apart(ctx: &Context<'_>, by: &[By]) -> Read<()> {
    let all: Vec<(&By, &Target)> = by.iter().flat_map(|by| by.targets.iter().map(move |target| (by, target))).collect();
    for (k, (own, target)) in all.iter().enumerate() {
        if let Some((earlier, _)) = all[..k].iter().find(|(_, earlier)| earlier.overlaps(target)) {
            let message =
                format!("{} is a parameter twice: of {:?} and of {:?}", target.written, earlier.name, own.name);
            let refusal = target.place.refuse(RefusalKind::Rule, message);
            return Err(ctx.refuse(refusal.help("leave one of them out")));
        }
    }
    Ok(())
}

/// The numbers of all `[[parameter]]`.
pub(crate) fn blocks(root: &Table<'_>, field: &Field<'_>) -> Read<Vec<By>> {
    let items = field.items("an array of tables: [[parameter]]")?;
    let mut seen = HashMap::new();
    all(items.iter().enumerate().map(|(k, item)| {
        let table = Table::of(item.ctx, item.node, format!("[[parameter]] {}", k + 1), &PARAMETER)?;
        let path = table.require("path")?;
        let name = table.get("name").map(|field| {
            let name = checked_name(&field)?;
            unique(&mut seen, &field, name).map(|()| name.to_owned())
        });
        let name = name.transpose();
        let paths = match &path.node.value {
            Value::Text(_) => vec![path.clone()],
            _ => path.items("a path or an array of paths")?,
        };
        if paths.is_empty() || paths.len() > MAX_TOGETHER {
            let message = format!("holds {} paths", paths.len());
            let help = format!("write 1 to {MAX_TOGETHER} paths");
            return Err(path.refuse(RefusalKind::OutOfRange, message, Some(help)));
        }
        let targets = paths.iter().map(|path| path::resolve(path.ctx, root.node, path.text()?, &path.node.place));
        let targets = all(targets.collect::<Vec<_>>())?;
        let name = name?.unwrap_or_else(|| targets[0].written.clone());
        Ok(By { name, targets, block: Some(k), place: item.node.place.clone() })
    }))
}

/// The parameter of that name, or the number at that path.
fn one(ctx: &Context<'_>, document: &Node, blocks: &[By], written: &str, place: &Place) -> Read<By> {
    if let Some(block) = blocks.iter().find(|block| block.name == written) {
        return Ok(block.clone());
    }
    let is_path = path::keys(written).is_some_and(|keys| keys.len() > 1);
    if !is_path && !blocks.is_empty() {
        let message = format!("names no parameter: {:?}", shorten(written));
        let help = names::suggest(written, blocks.iter().map(|block| block.name.as_str()));
        ctx.refuse(place.refuse(RefusalKind::UnknownName, message).help(help));
        return Err(Refused);
    }
    let target = path::resolve(ctx, document, written, place)?;
    Ok(By { name: written.trim().to_owned(), targets: vec![target], block: None, place: place.clone() })
}
