//! Columns as scenarios name them, and `[output]`.

use crate::keys::OUTPUT;
use crate::reader::{Field, Read, Table, all};
use crate::text::refusal::{Place, RefusalKind};
use crate::units::Unit;
use std::sync::Arc;

/// Name of a column, or a glob over names, not yet matched.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnGlob {
    /// As written.
    pub text: String,
    /// Where it stands; where it was left out: the figure.
    pub place: Place,
}

/// A column and the unit it is drawn in.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureUnit {
    /// The column or glob.
    pub column: ColumnGlob,
    /// The unit, in the grammar of quantities; known to parse, its dimension not yet compared with the column's.
    pub unit: String,
}

pub(super) fn glob(field: &Field<'_>) -> Read<ColumnGlob> {
    let text = field.text()?;
    if text.trim().is_empty() {
        let help = "write the name of a column, as in \"strut.Q.q2\"".to_owned();
        return Err(field.refuse(RefusalKind::BadName, "is empty", Some(help)));
    }
    Ok(ColumnGlob { text: text.to_owned(), place: field.node.place.clone() })
}

pub(crate) fn globs(field: &Field<'_>) -> Read<Vec<ColumnGlob>> {
    if field.node.text().is_some() {
        return glob(field).map(|glob| vec![glob]);
    }
    let items = field.items("the name of a column or an array of them")?;
    if items.is_empty() {
        let help = "write the names of columns, as in [\"strut.Q.q2\"]".to_owned();
        return Err(field.refuse(RefusalKind::Missing, "is empty", Some(help)));
    }
    all(items.iter().map(glob))
}

/// Reads units by column.
pub(super) fn units(field: &Field<'_>) -> Read<Vec<FigureUnit>> {
    if field.node.entries().is_none() {
        return Err(field.wrong_type("a table of units by column"));
    }
    all(field.node.entries().unwrap_or_default().iter().map(|entry| {
        let column = ColumnGlob { text: entry.key.clone(), place: entry.key_place.clone() };
        let unit =
            Field { node: &entry.node, key: &entry.key, row: None, owner: field.to_string().into(), ..field.clone() };
        let text = unit.text()?;
        match Unit::parse(text, &|_| None) {
            Ok(_) => Ok(FigureUnit { column, unit: text.to_owned() }),
            Err(error) => {
                let place = unit.node.place_in_text(error.span());
                let refusal = place.refuse(RefusalKind::BadQuantity, format!("{unit}: {error}"));
                Err(unit.ctx.refuse(refusal.help("write a unit such as N*cm")))
            }
        }
    }))
}

/// Reads `[output]`: globs of the columns to write.
pub(crate) fn read_columns(root: &Table<'_>) -> Read<Option<Arc<[ColumnGlob]>>> {
    let Some(field) = root.get("output") else { return Ok(None) };
    let table = Table::of(root.ctx, field.node, "[output]", &OUTPUT)?;
    let Some(field) = table.get("columns") else { return Ok(None) };
    Ok(Some(globs(&field)?.into()))
}
