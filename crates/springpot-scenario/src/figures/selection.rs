//! Which cases a figure draws.

use crate::changes::path;
use crate::changes::sweep::Axis;
use crate::reader::{Field, Read, Table, all};
use crate::text::document::Node;
use crate::text::names;
use crate::text::refusal::RefusalKind;

/// One value of one sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Selection {
    /// Index of the `[[sweep]]`.
    pub axis: usize,
    /// Index of its value.
    pub value: usize,
}

/// Finds which value of which sweep is meant by a value under a path; told by the cases, which know SI values.
pub(crate) type Finder<'f> = dyn Fn(usize, usize, &Node) -> Option<usize> + 'f;

/// Reads `where`.
pub(super) fn selection(root: &Table<'_>, field: &Field<'_>, axes: &[Axis], find: &Finder<'_>) -> Read<Vec<Selection>> {
    let Some(entries) = field.node.entries() else { return Err(field.wrong_type("a table of values by swept path")) };
    all(entries.iter().map(|entry| {
        let target = path::resolve(root.ctx, root.node, &entry.key, &entry.key_place)?;
        let mut swept = axes
            .iter()
            .enumerate()
            .flat_map(|(axis, swept)| swept.targets.iter().enumerate().map(move |(at, target)| (axis, at, target)));
        let Some((axis, at, _)) = swept.find(|(_, _, swept)| swept.steps == target.steps) else {
            let message = format!("`where` selects {}, which is not swept", target.written);
            let swept: Vec<&str> =
                axes.iter().flat_map(|axis| &axis.targets).map(|target| target.written.as_str()).collect();
            let help = match names::nearest(&target.written, swept.iter().copied()) {
                Some(right) => format!("did you mean `{right}`?"),
                None => format!("swept: {}", names::list(swept)),
            };
            let refusal = entry.key_place.refuse(RefusalKind::UnknownName, message);
            return Err(root.ctx.refuse(refusal.help(help)));
        };
        let Some(value) = find(axis, at, &entry.node) else {
            let message = format!("`where` selects {} = {}, which is not swept", target.written, entry.node.written());
            let shown: Vec<String> = (0..axes[axis].len().min(20)).map(|k| axes[axis].label(k)).collect();
            let help = format!("swept values: {}", names::list(shown.iter().map(String::as_str)));
            return Err(root.ctx.refuse(entry.node.place.refuse(RefusalKind::UnknownName, message).help(help)));
        };
        Ok(Selection { axis, value })
    }))
}
