//! One `[[data]]` block, before anything of the case is known.

use super::columns::{Numbers, Taken, Wanted};
use super::plan::{DataColumn, DataKind, DataPlan, PastOfStroke};
use crate::changes::path::{self, Target};
use crate::csv::TIME;
use crate::keys::{CREEP, DATA, DMA, HUBER, RELAXATION, RUN, STROKE};
use crate::reader::named::{checked_name, unique};
use crate::reader::{Field, Read, Table, all};
use crate::text::document::{Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use crate::units::Unit;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Columns that a kind tells besides those of its own.
const TEMPERATURE: &str = "T";
const AMPLITUDE: &str = "amplitude";

/// A block as it is written.
pub(super) struct Record<'a> {
    pub(super) table: Table<'a>,
    pub(super) name: String,
    pub(super) kind: &'static str,
    /// The conditions.
    pub(super) set: Vec<(Target, Node)>,
    /// Parameters of its own.
    pub(super) free: Vec<Target>,
    pub(super) wanted: Vec<Wanted<'a>>,
}

/// What a column of the kind is called, and the units that it takes.
type Kept<'u> = (&'u str, Vec<Taken<'u>>);

/// Reads a block; `taken` are the names before it.
pub(super) fn read<'a>(
    root: &Table<'a>,
    item: &Field<'a>,
    k: usize,
    taken: &mut HashMap<String, Place>,
) -> Read<Record<'a>> {
    let given = item.node.get("name").and_then(|name| name.text());
    let default = format!("data-{}", k + 1);
    let what = format!("data {:?}", shorten(given.unwrap_or(&default)));
    let kind = kind(item, &what)?;
    let other = |key: &str| {
        let reason = || (RefusalKind::Rule, format!("`{key}` of {what} has no meaning where kind = {kind:?}"));
        DATA.is_of_a_kind(key).then(reason)
    };
    let table = Table::of_kind(item.ctx, item.node, what.clone(), (&DATA, kind), other)?;
    let name = match table.get("name") {
        Some(field) => {
            let name = checked_name(&field)?;
            unique(taken, &field, name)?;
            name.to_owned()
        }
        None => {
            taken.insert(default.clone(), item.node.place.clone());
            default
        }
    };
    let set = match table.get("set") {
        None => Vec::new(),
        Some(field) => {
            let Some(entries) = field.node.entries() else { return Err(field.wrong_type("a table of values by path")) };
            let each = entries.iter().map(|entry| {
                let target = path::resolve(item.ctx, root.node, &entry.key, &entry.key_place)?;
                Ok((target, Node::clone(&entry.node)))
            });
            all(each.collect::<Vec<_>>())?
        }
    };
    let free = texts(&table, "free")?;
    let free = all(free.iter().map(|(text, field)| path::resolve(item.ctx, root.node, text, &field.node.place)))?;
    let columns = table.require("columns")?;
    let Some(entries) = columns.node.entries().filter(|entries| !entries.is_empty()) else {
        return Err(columns.wrong_type("a table of columns of the file"));
    };
    let wanted = entries.iter().map(|entry| {
        let owner = columns.to_string().into();
        Wanted::read(&Field { node: &entry.node, key: &entry.key, row: None, owner, ..columns.clone() })
    });
    let wanted = all(wanted.collect::<Vec<_>>())?;
    Ok(Record { table, name, kind, set, free, wanted })
}

/// The word of its kind, which says which keys there are.
fn kind(item: &Field<'_>, what: &str) -> Read<&'static str> {
    let Some(node) = item.node.get("kind") else { return Ok(RUN) };
    let known = [RUN, STROKE, DMA, RELAXATION, CREEP];
    if let Some(kind) = node.text().and_then(|text| known.into_iter().find(|kind| *kind == text)) {
        return Ok(kind);
    }
    let message = format!("`kind` of {what} is {}, which is no kind of record", node.written());
    let refusal = node.place.refuse(RefusalKind::UnknownName, message);
    Err(item.ctx.refuse(refusal.help(names::suggest(node.text().unwrap_or_default(), known))))
}

/// A text, or an array of them.
fn texts<'a>(table: &Table<'a>, key: &'a str) -> Read<Vec<(&'a str, Field<'a>)>> {
    let Some(field) = table.get(key) else { return Ok(Vec::new()) };
    let items = match &field.node.value {
        Value::Text(_) => vec![field.clone()],
        _ => field.items("a text or an array of texts")?,
    };
    all(items.into_iter().map(|item| Ok((item.text()?, item))).collect::<Vec<_>>())
}

impl<'a> Record<'a> {
    fn get(&self, name: &str) -> Option<&Wanted<'a>> {
        self.wanted.iter().find(|wanted| wanted.field.key == name)
    }

    /// Refuses columns of other names.
    fn known(&self, names: &[&str]) -> Read<()> {
        if let Some(wanted) = self.wanted.iter().find(|wanted| !names.contains(&wanted.field.key)) {
            let key = wanted.field.key;
            let message = format!("`columns` of {} has no {:?}", self.table.what, shorten(key));
            let refusal = wanted.field.node.place.refuse(RefusalKind::UnknownName, message);
            return Err(wanted.field.ctx.refuse(refusal.help(names::suggest(key, names.iter().copied()))));
        }
        Ok(())
    }

    fn needed(&self, names: &[&str]) -> Read<()> {
        for name in names {
            if self.get(name).is_none() {
                let columns = self.table.require("columns")?;
                let message = format!("`columns` of {} has no `{name}`", self.table.what);
                let refusal = columns.node.place.refuse(RefusalKind::Missing, message);
                let help = format!("a record of kind {:?} has {}", self.kind, names::list(names.iter().copied()));
                return Err(columns.ctx.refuse(refusal.help(help)));
            }
        }
        Ok(())
    }

    /// The names of its columns in the order of the kind, and what each may be in: those that are measured, then those that are told.
    fn kept<'u>(
        &'u self,
        inputs: &'u [(String, String)],
        is_rotation: bool,
    ) -> Read<(DataKind, Vec<Kept<'u>>, Vec<Kept<'u>>)> {
        let [force, stroke] = if is_rotation { ["N*m", "rad"] } else { ["N", "m"] };
        let [stiff, soft] = if is_rotation { ["N*m/rad", "rad/(N*m)"] } else { ["N/m", "m/N"] };
        let area = self.table.get("area").map(|field| field.quantity()).transpose()?;
        let length = self.table.get("length").map(|field| field.quantity()).transpose()?;
        let shape = match (area, length) {
            (Some(area), Some(length)) => Some(area / length),
            (None, None) => None,
            _ => {
                let (there, lacks) = if area.is_some() { ("area", "length") } else { ("length", "area") };
                let message = format!("stands without `{lacks}`: a sample has both");
                return Err(self.table.require(there)?.refuse(RefusalKind::Rule, message, None));
            }
        };
        // Moduli where the sample is given; a number without a unit is then one too.
        let stiffness = match shape {
            Some(factor) => vec![("Pa", factor), (stiff, 1.0)],
            None => vec![(stiff, 1.0)],
        };
        let compliance = match shape {
            Some(factor) => vec![("1/Pa", 1.0 / factor), (soft, 1.0)],
            None => vec![(soft, 1.0)],
        };
        let own: Vec<&str> = inputs.iter().map(|(name, _)| name.as_str()).collect();
        let input = |name: &'u str| {
            inputs.iter().find(|(own, _)| own == name).map(|(own, unit)| (own.as_str(), vec![(unit.as_str(), 1.0)]))
        };
        let names =
            |fixed: &[&'static str]| -> Vec<&str> { fixed.iter().copied().chain(own.iter().copied()).collect() };
        if let Some(temperature) = self.get(TEMPERATURE).filter(|_| !own.contains(&TEMPERATURE)) {
            let message = "says nothing: the element has neither `shift` nor an input T";
            let help = Some("write shift = { kind = \"wlf\", C1 = …, C2 = …, T_ref = … } into the element".to_owned());
            return Err(temperature.field.refuse(RefusalKind::Rule, message, help));
        }
        let told = |fixed: Vec<Kept<'u>>| -> Vec<Kept<'u>> {
            let of_inputs = self.wanted.iter().filter_map(|wanted| input(wanted.field.key));
            fixed.into_iter().filter(|(name, _)| self.get(name).is_some()).chain(of_inputs).collect()
        };
        Ok(match self.kind {
            DMA => {
                let polar = self.get("modulus").is_some() || self.get("tan_delta").is_some();
                let columns = if polar { ["modulus", "tan_delta"] } else { ["storage", "loss"] };
                self.known(&names(&["frequency", "storage", "loss", "modulus", "tan_delta", AMPLITUDE]))?;
                self.needed(&["frequency", columns[0], columns[1]])?;
                let second = if polar { vec![("", 1.0)] } else { stiffness.clone() };
                let kept = vec![(columns[0], stiffness), (columns[1], second)];
                (DataKind::Dma { is_polar: polar }, kept, told(vec![(AMPLITUDE, vec![(stroke, 1.0)])]))
            }
            STROKE => {
                self.known(&names(&["stroke", "force"]))?;
                self.needed(&["stroke", "force"])?;
                (DataKind::Stroke, vec![("force", vec![(force, 1.0)])], told(vec![("stroke", vec![(stroke, 1.0)])]))
            }
            RELAXATION => {
                self.known(&names(&["t", RELAXATION]))?;
                self.needed(&["t", RELAXATION])?;
                (DataKind::Relaxation, vec![(RELAXATION, stiffness)], told(Vec::new()))
            }
            _ => {
                self.known(&names(&["t", "compliance"]))?;
                self.needed(&["t", "compliance"])?;
                (DataKind::Creep, vec![("compliance", compliance)], told(Vec::new()))
            }
        })
    }

    /// The record with its rows, of an element with these inputs, name and unit, or of a run with these columns until `end`.
    pub(super) fn plan(&self, of: Of<'_>) -> Read<DataPlan> {
        let table = &self.table;
        let columns: Vec<(String, String)>;
        let (kind, kept, told) = match of {
            Of::Run { columns: known, .. } => {
                let each = self.wanted.iter().map(|wanted| {
                    let name = wanted.field.key;
                    let found = known.iter().find(|(own, _)| own == name);
                    found.cloned().ok_or_else(|| {
                        let message = format!(
                            "`columns` of {} names {:?}, which is no column of the run",
                            table.what,
                            shorten(name)
                        );
                        let refusal = wanted.field.node.place.refuse(RefusalKind::UnknownName, message);
                        wanted
                            .field
                            .ctx
                            .refuse(refusal.help(names::suggest(name, known.iter().map(|(own, _)| own.as_str()))))
                    })
                });
                columns = all(each.collect::<Vec<_>>())?;
                let kept = columns.iter().map(|(name, unit)| (name.as_str(), vec![(unit.as_str(), 1.0)]));
                (DataKind::Run, kept.collect::<Vec<_>>(), Vec::new())
            }
            Of::Element { inputs, is_rotation } => self.kept(inputs, is_rotation)?,
        };
        for wanted in self
            .wanted
            .iter()
            .filter(|wanted| kind.is_relative() || !kept.iter().any(|(name, _)| *name == wanted.field.key))
        {
            let why = if kind.is_relative() {
                "has no meaning here: write `relative_sd` of the record"
            } else {
                "has no meaning of what is told"
            };
            wanted.without_sd(why)?;
        }
        let csv = table.require("csv")?;
        let path = csv.ctx.folder.join(csv.text()?);
        let separator = table.word("separator", "separator")?.chars().next().unwrap_or(',');
        let time = self.time()?;
        let mut names: Vec<(&Field<'_>, &str)> =
            self.wanted.iter().map(|wanted| (&wanted.field, wanted.column.as_str())).collect();
        for field in self.wanted.iter().filter_map(|wanted| wanted.sd_column.as_ref()) {
            names.push((field, field.text()?));
        }
        let time_field = table.get("time").unwrap_or_else(|| csv.clone());
        if let Some((name, _)) = &time {
            names.push((&time_field, name));
        }
        let numbers = Numbers::read(&csv, &path, separator, &names)?;
        let at = match (&time, self.kind) {
            (Some((name, scale)), _) => numbers.plain(name).iter().map(|t| in_seconds(*t, *scale)).collect(),
            (None, DMA) => {
                let wanted = self.get("frequency").expect("a column that was asked for");
                numbers.si(wanted, &[("Hz", TAU), ("rad/s", 1.0)])?
            }
            (None, _) => numbers.si(self.get("t").expect("a column that was asked for"), &[("s", 1.0)])?,
        };
        let find = |name: &str| self.get(name).expect("a column that was asked for");
        let measured = kept.iter().map(|(name, taken)| {
            Ok(DataColumn {
                name: (*name).to_owned(),
                unit: taken.last().map_or("", |(unit, _)| unit).to_owned(),
                measured: numbers.si(find(name), taken)?,
                sd: numbers.sd(find(name), taken)?,
                offset: None,
                delay: None,
            })
        });
        let measured = all(measured.collect::<Vec<_>>())?;
        let told = told.iter().map(|(name, taken)| Ok(((*name).to_owned(), numbers.si(find(name), taken)?)));
        let told = all(told.collect::<Vec<_>>())?;
        let loss = table.get("loss");
        let huber = match &loss {
            Some(field) if field.node.entries().is_some() => Some(field.table(&HUBER)?.number("huber")?),
            Some(field) if field.node.text() == Some("squares") => None,
            Some(field) => {
                let message = format!("is {}, which is no loss", field.node.written());
                let help = "write \"squares\", or { huber = 1.345 } against outliers".to_owned();
                return Err(field.refuse(RefusalKind::UnknownName, message, Some(help)));
            }
            None => None,
        };
        let optional = |key: &'static str| -> Read<Option<f64>> {
            DATA.names_for(self.kind)
                .contains(&key)
                .then(|| table.get(key))
                .flatten()
                .map(|field| field.quantity())
                .transpose()
        };
        let past = match DATA.names_for(self.kind).contains(&"past") {
            true => match table.word("past", "past")? {
                "held" => PastOfStroke::Held,
                "unloaded" => PastOfStroke::Unloaded,
                _ => PastOfStroke::Free,
            },
            false => PastOfStroke::Held,
        };
        let mut plan = DataPlan {
            name: self.name.clone(),
            kind,
            element: None,
            file: path,
            lines: numbers.lines,
            skipped: numbers.skipped,
            at,
            columns: measured,
            told,
            relative_sd: optional("relative_sd")?,
            is_fitted: table.word("use", "use")? == "fit",
            huber,
            window: None,
            past,
            low_pass: optional("low_pass")?,
            parameters: Vec::new(),
            place: table.node.place.clone(),
        };
        self.judge(&plan)?;
        self.window(&mut plan)?;
        let covered = |t: &f64| match of {
            Of::Run { end, .. } => (0.0..=end).contains(t),
            Of::Element { .. } => *t >= 0.0 || self.kind == STROKE,
        };
        if let Some(row) = plan.at.iter().position(|t| !covered(t)) {
            let span = match of {
                Of::Run { end, .. } => format!("the run goes from 0 s to {end} s"),
                Of::Element { .. } => "times begin at 0 s".to_owned(),
            };
            let message = format!("has t = {} s on line {}, but {span}", plan.at[row], plan.lines[row]);
            let help = Some("choose a `window`, or another `time.end`".to_owned());
            return Err(csv.refuse(RefusalKind::OutOfRange, message, help));
        }
        if plan.at.is_empty() {
            let message = match plan.skipped {
                0 => "has no rows".to_owned(),
                skipped => format!("has no row with all cells: {skipped} lack one"),
            };
            return Err(csv.refuse(RefusalKind::Missing, message, None));
        }
        Ok(plan)
    }

    /// Column and unit of the times, of kinds that have them beside their columns.
    fn time(&self) -> Read<Option<(String, f64)>> {
        if ![RUN, STROKE].contains(&self.kind) {
            return Ok(None);
        }
        let name = self.table.get("time").map_or(Ok(TIME), |field| field.text())?;
        let scale = match self.table.get("time_unit") {
            None => 1.0,
            Some(field) => {
                let text = field.text()?;
                let second = Unit::parse("s", &|_| None).map(|second| second.dimension());
                match Unit::parse(text, &|_| None) {
                    Ok(unit) if second.is_ok_and(|second| second == unit.dimension()) => unit.scale(),
                    _ => {
                        let message = format!("is {:?}, which is no unit of time", shorten(text));
                        let help = Some("write s, ms, min or h".to_owned());
                        return Err(field.refuse(RefusalKind::BadQuantity, message, help));
                    }
                }
            }
        };
        Ok(Some((name.to_owned(), scale)))
    }

    /// Refuses numbers that no record has.
    fn judge(&self, plan: &DataPlan) -> Read<()> {
        let csv = self.table.require("csv")?;
        let refuse =
            |message: String, help: &str| Err(csv.refuse(RefusalKind::OutOfRange, message, Some(help.to_owned())));
        if !matches!(plan.kind, DataKind::Dma { .. })
            && let Some(row) = plan.at.windows(2).position(|pair| pair[1] <= pair[0])
        {
            let message = format!(
                "has t = {} s on line {} behind {} s: times must increase",
                plan.at[row + 1],
                plan.lines[row + 1],
                plan.at[row]
            );
            return refuse(message, "sort the rows by time, and leave out times that come twice");
        }
        if !plan.kind.is_relative() {
            return Ok(());
        }
        let positive = plan.columns.iter().map(|column| (column.name.as_str(), &column.measured));
        let abscissa = if matches!(plan.kind, DataKind::Dma { .. }) { "frequency" } else { "t" };
        for (name, numbers) in positive.chain([(abscissa, &plan.at)]) {
            if let Some(row) = numbers.iter().position(|x| *x <= 0.0) {
                let message =
                    format!("has {} in {name} on line {}, which must be positive", numbers[row], plan.lines[row]);
                return refuse(message, "correct the row or leave it out");
            }
        }
        Ok(())
    }

    /// Keeps the rows of the window.
    fn window(&self, plan: &mut DataPlan) -> Read<()> {
        if matches!(plan.kind, DataKind::Dma { .. }) {
            return Ok(());
        }
        let Some(field) = self.table.get("window") else { return Ok(()) };
        let items = field.items("an array of two times, [from, to]")?;
        let [from, to] = &items[..] else {
            return Err(field.wrong_type("an array of two times, [from, to]"));
        };
        let [from, to] = [from.number("s")?, to.number("s")?];
        let keep: Vec<bool> = plan.at.iter().map(|t| (from..=to).contains(t)).collect();
        if from >= to {
            let message = format!("runs from {from} s to {to} s, which is not forwards");
            return Err(field.refuse(
                RefusalKind::OutOfRange,
                message,
                Some("write the earlier time first".to_owned()),
            ));
        }
        if !keep.contains(&true) {
            let message = format!("runs from {from} s to {to} s, where there is no row");
            let help = format!("the rows go from {} s to {} s", plan.at[0], plan.at[plan.at.len() - 1]);
            return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
        }
        // The stroke before the window is the past of what is in it.
        plan.window = Some([from, to]);
        if plan.kind == DataKind::Stroke {
            return Ok(());
        }
        let kept = |values: &mut Vec<f64>| {
            let mut at = keep.iter();
            values.retain(|_| *at.next().unwrap_or(&false));
        };
        kept(&mut plan.at);
        plan.columns.iter_mut().for_each(|column| {
            kept(&mut column.measured);
            column.sd.iter_mut().for_each(kept);
        });
        plan.told.iter_mut().for_each(|(_, values)| kept(values));
        let mut at = keep.iter();
        plan.lines.retain(|_| *at.next().unwrap_or(&false));
        Ok(())
    }

    /// The places among `columns` that `offset` or `delay` name.
    pub(super) fn named(&self, key: &'static str, columns: &[DataColumn]) -> Read<Vec<(usize, Place)>> {
        if !DATA.names_for(self.kind).contains(&key) {
            return Ok(Vec::new());
        }
        let mut found: Vec<(usize, Place)> = Vec::new();
        for (name, field) in texts(&self.table, key)? {
            let at = columns.iter().position(|column| column.name == name);
            let Some(at) = at.filter(|at| !found.iter().any(|(known, _)| known == at)) else {
                let message = format!("names {:?}, which is no column of the record, or stands twice", shorten(name));
                let help = names::suggest(name, columns.iter().map(|column| column.name.as_str()));
                return Err(field.refuse(RefusalKind::UnknownName, message, Some(help)));
            };
            found.push((at, field.node.place.clone()));
        }
        Ok(found)
    }
}

/// What a record is compared with.
#[derive(Clone, Copy)]
pub(super) enum Of<'o> {
    /// A run with these columns and units, until this time, s.
    Run { columns: &'o [(String, String)], end: f64 },
    /// An element with these inputs and their units.
    Element { inputs: &'o [(String, String)], is_rotation: bool },
}

/// A time in a unit of so many seconds: of what divides a second the nearest number, as it is read where it is written.
fn in_seconds(t: f64, scale: f64) -> f64 {
    if scale < 1.0 { t / scale.recip() } else { t * scale }
}
