//! Columns of measured numbers, in SI.

use crate::csv::{CsvError, CsvProblem, CsvRows, MAX_ROWS, bracket};
use crate::keys::DATA_COLUMN;
use crate::reader::{Field, Read, Refused, Table};
use crate::text::document::{Value, shorten};
use crate::text::names;
use crate::text::refusal::RefusalKind;
use crate::units::Unit;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A unit that is taken, and what its SI values are multiplied by.
pub(super) type Taken<'u> = (&'u str, f64);

/// A column that is wanted of a file.
pub(super) struct Wanted<'a> {
    pub(super) field: Field<'a>,
    pub(super) column: String,
    unit: Option<Field<'a>>,
    sd: Option<Field<'a>>,
    pub(super) sd_column: Option<Field<'a>>,
}

impl<'a> Wanted<'a> {
    /// `"NAME"`, or a table.
    pub(super) fn read(field: &Field<'a>) -> Read<Self> {
        let field = field.clone();
        if let Value::Text(text) = &field.node.value {
            return Ok(Self { column: text.clone(), unit: None, sd: None, sd_column: None, field });
        }
        let table = Table::of(field.ctx, field.node, field.to_string(), &DATA_COLUMN)?;
        let column = table.require("column")?.text()?.to_owned();
        let (unit, sd, sd_column) = (table.get("unit"), table.get("sd"), table.get("sd_column"));
        if let (Some(_), Some(second)) = (&sd, &sd_column) {
            let help = Some("leave one of them out".to_owned());
            return Err(second.refuse(RefusalKind::Rule, "stands beside `sd`", help));
        }
        Ok(Self { column, unit, sd, sd_column, field })
    }

    /// Refuses a standard deviation where it has no meaning.
    pub(super) fn without_sd(&self, why: &str) -> Read<()> {
        match self.sd.as_ref().or(self.sd_column.as_ref()) {
            Some(field) => Err(field.refuse(RefusalKind::Rule, why, None)),
            None => Ok(()),
        }
    }
}

/// The numbers of a file as they stand there.
pub(super) struct Numbers {
    pub(super) lines: Vec<u64>,
    pub(super) skipped: usize,
    headers: Vec<String>,
    /// Of each of the headers that were wanted.
    columns: Vec<Vec<f64>>,
    names: Vec<String>,
    /// Units that stand in a row of their own below the header, by name.
    units: Vec<String>,
}

impl Numbers {
    /// Reads the columns of these names; rows that lack one of them are skipped.
    pub(super) fn read(csv: &Field<'_>, path: &Path, separator: char, wanted: &[(&Field<'_>, &str)]) -> Read<Self> {
        let unreadable = |problem: CsvProblem| {
            let help = match &problem {
                CsvProblem::OtherSeparator { separator, .. } => Some(format!("write separator = {separator:?}")),
                CsvProblem::NoHeader { .. } => Some("write the names of the columns above the numbers".to_owned()),
                CsvProblem::NotANumber { .. } | CsvProblem::NotFinite { .. } => {
                    Some("write a number there, or leave the cell empty: its row is then skipped".to_owned())
                }
                _ => None,
            };
            let error = CsvError { file: path.to_owned(), problem };
            csv.refuse(RefusalKind::File, format!("cannot be read: {error}"), help)
        };
        let io = |source| unreadable(CsvProblem::Unreadable { source });
        if !std::fs::metadata(path).map_err(io)?.is_file() {
            return Err(unreadable(CsvProblem::NotAFile));
        }
        let mut rows =
            CsvRows::separated(BufReader::new(File::open(path).map_err(io)?), separator).map_err(unreadable)?;
        let headers = rows.headers().to_vec();
        let mut names: Vec<String> = Vec::new();
        let mut at = Vec::new();
        for (field, name) in wanted {
            let found = header(&headers, name).ok_or_else(|| {
                let message = format!("is {:?}, but {} has no such column", shorten(name), path.display());
                field.refuse(
                    RefusalKind::UnknownName,
                    message,
                    Some(names::suggest(name, headers.iter().map(String::as_str))),
                )
            })?;
            if !names.iter().any(|known| known == name) {
                names.push((*name).to_owned());
                at.push(found);
            }
        }
        let (mut lines, mut skipped, mut columns) = (Vec::new(), 0, vec![Vec::new(); at.len()]);
        let mut units = Vec::new();
        while let Some(row) = rows.next_row().map_err(unreadable)? {
            if lines.len() as u64 >= MAX_ROWS {
                return Err(unreadable(CsvProblem::TooLarge { limit: MAX_ROWS, what: "rows" }));
            }
            if lines.is_empty() && skipped == 0 && units.is_empty() {
                units =
                    units_of(&at.iter().map(|at| row.text(*at)).collect::<Result<Vec<_>, _>>().map_err(unreadable)?);
                if !units.is_empty() {
                    continue;
                }
            }
            let mut lacks = false;
            for at in &at {
                lacks |= row.text(*at).map_err(unreadable)?.is_empty();
            }
            if lacks {
                skipped += 1;
                continue;
            }
            for (column, at) in columns.iter_mut().zip(&at) {
                column.push(row.number(*at).map_err(unreadable)?);
            }
            lines.push(row.line());
        }
        Ok(Self { lines, skipped, headers, columns, names, units })
    }

    /// A column as it stands in the file.
    pub(super) fn plain(&self, name: &str) -> &[f64] {
        self.raw(name)
    }

    fn raw(&self, name: &str) -> &[f64] {
        let at = self.names.iter().position(|own| own == name);
        at.map_or(&[], |at| &self.columns[at])
    }

    /// A column in the first of these units whose dimension it has, SI times its factor; where it has no unit, the first. And the factor of its
    /// standard deviations.
    pub(super) fn si(&self, wanted: &Wanted<'_>, taken: &[Taken<'_>]) -> Read<Vec<f64>> {
        let (unit, (_, factor)) = self.unit(wanted, taken)?;
        let own = |x: &f64| factor * unit.as_ref().map_or(*x, |unit| unit.to_si(*x));
        Ok(self.raw(&wanted.column).iter().map(own).collect())
    }

    /// The standard deviation of every number, SI.
    pub(super) fn sd(&self, wanted: &Wanted<'_>, taken: &[Taken<'_>]) -> Read<Option<Vec<f64>>> {
        let (unit, (si, factor)) = self.unit(wanted, taken)?;
        let positive = |field: &Field<'_>, all: Vec<f64>| match all.iter().find(|sd| **sd <= 0.0) {
            None => Ok(Some(all)),
            Some(sd) => {
                let help = Some("a standard deviation is positive".to_owned());
                Err(field.refuse(RefusalKind::OutOfRange, format!("holds {sd}"), help))
            }
        };
        if let Some(field) = &wanted.sd {
            field.refuse_affine()?;
            let sd = factor * field.number(si)?;
            return positive(field, vec![sd; self.lines.len()]);
        }
        let Some(field) = &wanted.sd_column else { return Ok(None) };
        let scale = factor * unit.as_ref().map_or(1.0, Unit::scale);
        positive(field, self.raw(field.text()?).iter().map(|x| scale * x).collect())
    }

    /// The unit in brackets behind the name of a column.
    fn headed(&self, name: &str) -> Option<&str> {
        header(&self.headers, name).and_then(|at| bracket(&self.headers[at])).map(|(_, unit)| unit)
    }

    /// The unit below it.
    fn below(&self, name: &str) -> Option<&str> {
        let at = self.names.iter().position(|own| own == name)?;
        self.units.get(at).map(String::as_str)
    }

    fn unit<'u>(&self, wanted: &Wanted<'_>, taken: &[Taken<'u>]) -> Read<(Option<Unit>, Taken<'u>)> {
        let none = |_: &str| None;
        let (text, field) = match &wanted.unit {
            Some(field) => (field.text()?.to_owned(), field),
            None => match (self.headed(&wanted.column), self.below(&wanted.column)) {
                (Some(unit), _) | (None, Some(unit)) => (unit.to_owned(), &wanted.field),
                (None, None) => return Ok((None, taken[0])),
            },
        };
        let list =
            || taken.iter().map(|(unit, _)| if unit.is_empty() { "pure numbers" } else { unit }).collect::<Vec<_>>();
        let refuse = |why: String| -> Refused {
            let mut help = format!("write a unit of the dimension of {}", names::either(list()));
            let has = |unit: &str| taken.iter().any(|(si, _)| *si == unit);
            if has("N/m") && !has("Pa") || has("m/N") && !has("1/Pa") {
                help.push_str("; moduli take `area` and `length` of the sample");
            }
            field.refuse(RefusalKind::BadQuantity, why, Some(help))
        };
        let unit = Unit::parse(&text, &none).map_err(|error| refuse(format!("has the unit {text:?}: {error}")))?;
        let fits = |si: &str| Unit::parse(si, &none).is_ok_and(|si| si.dimension().agrees_with(&unit.dimension()));
        // Turns a second and radians a second have one dimension, and are not one.
        let is_angular = text.contains("rad") || text.contains("deg");
        let found = taken.iter().find(|(si, _)| fits(si) && (!is_angular || si.contains("rad") || !fits("rad/s")));
        match found {
            Some(found) => Ok((Some(unit), *found)),
            None => Err(refuse(format!("has the unit {text:?}, of another dimension"))),
        }
    }
}

/// The units that a row of texts is, `-` of pure numbers; nothing where it is none.
fn units_of(cells: &[&str]) -> Vec<String> {
    let unit = |cell: &&str| {
        let text = match *cell {
            "-" | "" => "1",
            "C" | "°C" => "degC",
            "F" | "°F" => "degF",
            other => other,
        };
        let is_number = cell.parse::<f64>().is_ok();
        (!is_number && Unit::parse(text, &|_| None).is_ok()).then(|| text.to_owned())
    };
    if cells.iter().all(|cell| cell.is_empty()) {
        return Vec::new();
    }
    cells.iter().map(unit).collect::<Option<_>>().unwrap_or_default()
}

/// The column of this name, or whose name before its unit in brackets is this.
fn header(headers: &[String], name: &str) -> Option<usize> {
    headers
        .iter()
        .position(|header| header == name)
        .or_else(|| headers.iter().position(|header| bracket(header).is_some_and(|(own, _)| own == name)))
}
