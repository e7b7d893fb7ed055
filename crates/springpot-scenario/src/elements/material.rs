//! The law of an element: by name or as a network, with its parameters and inputs.

use crate::csv;
use crate::elements::heat;
use crate::reader::element::with_units;
use crate::reader::{Field, Read, Refused, Table, all};
use crate::signals::feedback;
use crate::signals::of_time::{Wanted, celsius, how_outside, interval};
use crate::signals::plan::SignalPlan;
use crate::text::document::{Node, shorten};
use crate::text::names;
use crate::text::refusal::RefusalKind;
use crate::time::Duration;
use crate::units;
use springpot::law::heat::INPUT as TEMPERATURE;
use springpot::law::{Entry, Heat, NetworkText, NetworkTextError, Param, Table as LawTable};
use std::sync::Arc;

/// Most values of a list of parameters.
const MAX_LIST: usize = 1_000;

/// Most rows of the table of a leaf.
const MAX_TABLE: usize = 100_000;

/// Where the columns of lists are, in `parameters`.
pub(crate) const TABLE: &str = "table";

/// Parameters that are names of files, and these.
type Files = Vec<(String, String)>;

/// A law as it is written.
struct Law {
    entry: Arc<Entry>,
    files: Files,
    /// Parameters that are texts of expressions.
    texts: Vec<String>,
    /// Parameters whose unit is that in which they are written.
    open: Vec<String>,
}

/// The law of an element, its parameters (SI, in the order of the law), and its inputs.
pub(crate) struct Material {
    pub(crate) law: Arc<Entry>,
    /// It without what temperature does to it.
    pub(crate) cold: Arc<Entry>,
    pub(crate) heat: Heat,
    /// It is written as a network.
    pub(crate) is_network: bool,
    pub(crate) files: Files,
    pub(crate) parameters: Read<Vec<f64>>,
    pub(crate) inputs: Read<Vec<Option<SignalPlan>>>,
}

/// What the inputs of an element may be.
#[derive(Clone, Copy)]
pub(crate) enum InputsOf<'t> {
    /// Functions of time and of what is fed back, over this time, all of them said.
    Robot(Option<&'t Duration>),
    /// Functions of time; those that are not said come from elsewhere.
    Lone,
}

/// Reads `law` or `network`, `parameters` and `inputs`, in the units of a rotation where it is one.
pub(crate) fn read(table: &Table<'_>, is_rotation: bool, with: InputsOf<'_>) -> Read<Material> {
    let Law { entry: law, files, texts, open } = match (table.get("law"), table.get("network")) {
        (Some(law), None) => by_name(&law)?,
        (None, Some(network)) => of_text(&network, table.get("parameters").as_ref())?,
        (Some(_), Some(network)) => {
            let message = "stands beside a `law`";
            return Err(network.refuse(RefusalKind::Rule, message, Some("leave one of them out".to_owned())));
        }
        (None, None) => return Err(table.missing("law", "law = \"…\" or network = \"…\"")),
    };
    let law = if is_rotation { Arc::new(on_rotation(&law, &open)) } else { law };
    let lists = Lists::read(table, &law)?;
    let law = if law.has_lists() { Arc::new(law.with_lists(lists.length)) } else { law };
    let names: Vec<&str> =
        files.iter().map(|(name, _)| name.as_str()).chain(texts.iter().map(String::as_str)).collect();
    // What the parameters lack is told beside what is wrong with the heat.
    let parameters = parameters(table, &law, &lists, &names);
    let heat = heat::read(table, is_rotation)?;
    let cold = law.clone();
    let law = if heat.is_none() { law } else { Arc::new(law.with_heat(heat).map_err(|_| Refused)?) };
    let inputs = inputs(table, &law, &heat, with);
    Ok(Material { law, cold, heat, is_network: table.get("network").is_some(), files, parameters, inputs })
}

/// The law where it acts on an angle: N reads N·m and m reads rad, but for parameters whose unit is `open`.
fn on_rotation(law: &Entry, open: &[String]) -> Entry {
    let mut law = law.clone();
    let said = law.params.iter_mut().filter(|param| !open.iter().any(|open| *open == param.name));
    let units = said.map(|param| &mut param.unit);
    for unit in units.chain(law.inputs.iter_mut().map(|input| &mut input.unit)) {
        *unit = unit_on_rotation(unit).into();
    }
    law
}

fn unit_on_rotation(unit: &str) -> String {
    let mut turned = String::new();
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut rest = unit;
    while let Some(first) = rest.chars().next() {
        let length = rest.find(|c| is_part(c) != is_part(first)).unwrap_or(rest.len());
        let (token, after) = rest.split_at(length);
        // An exponent may have the name of a unit.
        let is_exponent = turned.ends_with('^');
        // N^2 is (N·m)^2.
        turned.push_str(match token {
            "N" if !is_exponent && after.starts_with('^') => "(N*m)",
            "N" if !is_exponent && turned.ends_with('/') => "(N*m)",
            "N" if !is_exponent => "N*m",
            "m" if !is_exponent => "rad",
            other => other,
        });
        rest = after;
    }
    turned
}

fn by_name(field: &Field<'_>) -> Read<Law> {
    let name = field.text()?;
    let entry = field.ctx.catalog.get(name).cloned().ok_or_else(|| {
        let laws = field.ctx.catalog.entries().iter().map(|entry| &*entry.name);
        let message = format!("is {:?}, which is no law", shorten(name));
        field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, laws)))
    })?;
    Ok(Law { entry, files: Vec::new(), texts: Vec::new(), open: Vec::new() })
}

/// A network with the tables of its files and its expressions.
fn of_text(field: &Field<'_>, parameters: Option<&Field<'_>>) -> Read<Law> {
    let text = field.text()?;
    let mut network = NetworkText::parse(text).map_err(|NetworkTextError { message, span, help, unknown }| {
        let refusal = field.node.place_in_text(Some(span)).refuse(RefusalKind::BadName, format!("{field}: {message}"));
        let help = unknown.map_or(help, |(name, known)| names::suggest(&name, known));
        field.ctx.refuse(refusal.help(help))
    })?;
    let names: Vec<String> = network.files().map(str::to_owned).collect();
    let files = all(names.into_iter().map(|name| {
        let Word { what, node, text: file, .. } = word(field, parameters, &name, FILE)?;
        let unusable = |why: String| {
            let refusal = node.place.refuse(RefusalKind::File, format!("{what} cannot be used: {why}"));
            field.ctx.refuse(refusal)
        };
        let columns = csv::columns(&field.ctx.folder.join(file), &["x", "F"], MAX_TABLE);
        let columns = columns.map_err(|error| unusable(error.to_string()))?;
        let points = columns[0].iter().copied().zip(columns[1].iter().copied());
        let table = LawTable::new(points).map_err(|error| unusable(format!("{file}: {error}")))?;
        Ok((name, file.to_owned(), table))
    }))?;
    for (name, _, table) in &files {
        network = network.with_table(name, table.clone());
    }
    let texts: Vec<String> = network.texts().map(str::to_owned).collect();
    for name in &texts {
        let Word { what, node, text } = word(field, parameters, name, EXPRESSION)?;
        network = network.with_text(name, text).map_err(|error| {
            let refusal = node.place_in_text(error.span()).refuse(RefusalKind::BadQuantity, format!("{what}: {error}"));
            field.ctx.refuse(refusal.help(format!("it is {}", EXPRESSION[2])))
        })?;
    }
    let network = with_units(network, parameters.map(|parameters| parameters.node));
    let open = network.open().map(str::to_owned).collect();
    let files = files.into_iter().map(|(name, file, _)| (name, file)).collect();
    Ok(Law { entry: Arc::new(network.entry()), files, texts, open })
}

/// What a parameter that is a text is: in a word, as an example, and in words.
type Kind = [&'static str; 3];
const FILE: Kind = ["the name of a file", "FILE", "a CSV file with the columns x and F, m and N"];
const EXPRESSION: Kind =
    ["an expression in quotes", "k*x + c*v", "an expression of the stroke x, its rate v and parameters"];

/// A parameter that is a text.
struct Word<'a> {
    what: String,
    node: &'a Node,
    text: &'a str,
}

/// The parameter of a network that is this `kind` of text.
fn word<'a>(
    field: &Field<'_>,
    parameters: Option<&Field<'a>>,
    name: &str,
    [kind, example, words]: Kind,
) -> Read<Word<'a>> {
    let right = || format!("{name} = \"{example}\": {words}");
    let Some(node) = parameters.and_then(|parameters| parameters.node.get(name)) else {
        let place = parameters.map_or(&field.node.place, |parameters| &parameters.node.place);
        let refusal = place.refuse(RefusalKind::Missing, format!("{field} needs the parameter {name}"));
        return Err(field.ctx.refuse(refusal.label("missing parameter").help(right())));
    };
    let what = format!("`{name}` of {field}");
    let Some(text) = node.text() else {
        let message = format!("{what} must be {kind}, not {} {}", node.kind(), node.written());
        let refusal = node.place.refuse(RefusalKind::WrongType, message);
        return Err(field.ctx.refuse(refusal.help(right())));
    };
    Ok(Word { what, node, text })
}

/// The parameters of a law that are lists.
#[derive(Default)]
struct Lists {
    /// Their common length.
    length: usize,
    /// Where they are columns of a file: their values, by name.
    columns: Vec<(String, Vec<f64>)>,
}

impl Lists {
    fn read(table: &Table<'_>, law: &Entry) -> Read<Self> {
        let wanted: Vec<&str> = law.params.iter().filter(|param| param.is_list).map(|param| &*param.name).collect();
        let Some(given) = table.get("parameters").filter(|_| !wanted.is_empty()) else { return Ok(Self::default()) };
        let at = |name: &str| given.node.get(name).map(|node| Field { node, key: "parameters", ..given.clone() });
        if let Some(field) = at(TABLE) {
            if let Some(name) = wanted.iter().find(|name| at(name).is_some()) {
                let message = format!("`table` in {given} stands beside `{name}`");
                let refusal = field.node.place.refuse(RefusalKind::Rule, message);
                return Err(field.ctx.refuse(refusal.help("leave one of them out")));
            }
            return Self::of_file(&field, &wanted);
        }
        let mut first: Option<(&str, usize)> = None;
        for name in wanted {
            let Some(field) = at(name) else { continue };
            let length = field.node.items().map_or(0, <[_]>::len);
            let refuse = |message: String, help: String| {
                let message = format!("`{name}` in {given} {message}");
                Err(field.ctx.refuse(field.node.place.refuse(RefusalKind::WrongType, message).help(help)))
            };
            if !(1..=MAX_LIST).contains(&length) {
                let help = format!("write {name} = [first, second, …], with {MAX_LIST} values at most");
                return refuse(
                    format!("must be an array of values, not {} {}", field.node.kind(), field.node.written()),
                    help,
                );
            }
            let (other, wanted) = *first.get_or_insert((name, length));
            if length != wanted {
                return refuse(format!("has {length} values, but `{other}` has {wanted}"), "write as many".to_owned());
            }
        }
        Ok(Self { length: first.map_or(1, |(_, length)| length), columns: Vec::new() })
    }

    /// The columns that `table = { csv = …, k = … }` names.
    fn of_file(field: &Field<'_>, wanted: &[&str]) -> Read<Self> {
        let known: Vec<&str> = ["csv"].into_iter().chain(wanted.iter().copied()).collect();
        let table = Table::open(field.ctx, field.node, format!("`table` in {field}"), &known)?;
        let file = table.require_with("csv", "csv = \"FILE\", and the names of its columns")?;
        let path = field.ctx.folder.join(file.text()?);
        let names = wanted.iter().map(|name| {
            let column = table.require_with(name, &format!("{name} = \"COLUMN\""))?;
            column.text()
        });
        let names = all(names)?;
        let columns = csv::columns(&path, &names, MAX_LIST)
            .map_err(|error| file.refuse(RefusalKind::File, format!("cannot be used: {error}"), None))?;
        let length = columns.first().map_or(0, Vec::len);
        let columns = wanted.iter().map(|name| (*name).to_owned()).zip(columns).collect();
        Ok(Self { length, columns })
    }

    /// The value of the parameter `k.2` in a file.
    fn value(&self, name: &str) -> Option<f64> {
        let (list, k) = name.rsplit_once('.')?;
        let (_, values) = self.columns.iter().find(|(name, _)| name == list)?;
        values.get(k.parse::<usize>().ok()?).copied()
    }
}

/// The list that a parameter is a value of; else itself.
fn list_of(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(list, _)| list)
}

/// What stands for a parameter, which may be a value of a list.
fn given<'a>(table: &Table<'a>, name: &'a str) -> Option<Field<'a>> {
    let Some((list, k)) = name.rsplit_once('.') else { return table.get(name) };
    let field = table.get(list)?;
    let item = field.node.items()?.get(k.parse::<usize>().ok()?)?;
    Some(field.item(item))
}

/// Parameter values in the order of the catalog.
fn parameters<'a>(table: &Table<'a>, law: &'a Entry, lists: &Lists, files: &[&str]) -> Read<Vec<f64>> {
    let names: Vec<&str> = law.params.iter().map(|param| &*param.name).collect();
    let mut known: Vec<&str> = names.iter().map(|name| list_of(name)).collect();
    known.dedup();
    if known.len() < names.len() || !lists.columns.is_empty() {
        known.push(TABLE);
    }
    known.extend(files);
    let field = table.get("parameters");
    let open = field.as_ref().map(|field| {
        let what = format!("`parameters` of {} (law {})", table.what, law.quoted());
        Table::open(field.ctx, field.node, what, &known)
    });
    let given = open.transpose()?;
    let get = |param: &'a Param| given.as_ref().and_then(|table| self::given(table, &param.name));

    let in_file = |param: &Param| lists.value(&param.name);
    let lacking = |param: &&'a Param| param.default.is_none() && get(param).is_none() && in_file(param).is_none();
    let missing: Vec<&Param> = law.params.iter().filter(lacking).collect();
    let untold = missing.iter().filter(|param| !given.as_ref().is_some_and(|table| table.suspects(&param.name)));
    let untold: Vec<&str> = untold.map(|param| list_of(&param.name)).collect();
    let missing_refused = if untold.is_empty() {
        (!missing.is_empty()).then_some(Refused)
    } else {
        let right: Vec<String> =
            missing.iter().map(|param| describe(list_of(&param.name), &param.unit, &param.meaning)).collect();
        let place = field.as_ref().map_or(&table.node.place, |field| &field.node.place);
        let message = format!("{}: law {} needs the parameters {}", table.what, law.quoted(), names::list(untold));
        let refusal = place.refuse(RefusalKind::Missing, message).label("missing parameters");
        Some(table.ctx.refuse(refusal.help(right.join("; "))))
    };

    // Exponents name pure numbers, so those are read first.
    let pure = |param: &'a Param| match get(param) {
        Some(field) if param.unit.is_empty() => match swapped(&field, param, law) {
            Some(order) => Some(Err(refuse_swapped(&field, param, order))),
            None => Some(value(&field, param, &|_| None)),
        },
        _ => None,
    };
    let pure: Vec<Option<Read<f64>>> = law.params.iter().map(pure).collect();
    let exponent = |name: &str| {
        let at = names.iter().position(|param| *param == name)?;
        match pure[at] {
            Some(read) => read.ok(),
            None => law.params[at].default.filter(|_| law.params[at].unit.is_empty()),
        }
    };
    // A quantity whose exponent was refused or is missing would be refused for the wrong reason.
    if pure.contains(&Some(Err(Refused))) || missing.iter().any(|param| param.unit.is_empty()) {
        return Err(Refused);
    }
    let values = law.params.iter().zip(&pure).map(|(param, pure)| match (pure, get(param)) {
        (Some(read), _) => *read,
        (None, Some(field)) => value(&field, param, &exponent),
        (None, None) => in_file(param).or(param.default).ok_or(Refused),
    });
    let values = all(values)?;
    missing_refused.map_or(Ok(values), Err)
}

/// The parameter of a network that stands where a coefficient does, though the unit of `param`, which stands where an order does, has it as its
/// exponent: `springpot(alpha, c)`.
fn swapped<'a>(field: &Field<'_>, param: &Param, law: &'a Entry) -> Option<&'a Param> {
    let (_, unit) = units::split_quantity(field.node.text()?)?;
    let (_, exponent) = unit.split_once('^')?;
    let name: String = exponent.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    law.params.iter().find(|other| other.name == name && other.name != param.name && !other.unit.is_empty())
}

fn refuse_swapped(field: &Field<'_>, param: &Param, order: &Param) -> Refused {
    let (param, order) = (&param.name, &order.name);
    let message = format!("is {}, but stands in the network where an order does, a pure number", field.node.written());
    field.refuse(RefusalKind::Rule, message, Some(format!("the coefficient comes first: springpot({param}, {order})")))
}

fn describe(name: &str, unit: &str, meaning: &str) -> String {
    let unit = if unit.is_empty() { "a number" } else { unit };
    format!("{name} [{unit}]: {meaning}")
}

fn value(field: &Field<'_>, param: &Param, exponents: &dyn Fn(&str) -> Option<f64>) -> Read<f64> {
    let value = field.number_with(&param.unit, exponents)?;
    if param.range.contains(value) {
        return Ok(value);
    }
    let unit = if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
    let message = format!("is {value}{unit}, {}", how_outside(param.range));
    let of = if param.unit.is_empty() { "a number" } else { &*param.unit };
    let right = || format!("{}: {} ({of}, {})", param.name, param.meaning, interval(param.range));
    let help = celsius(field.node, &param.unit, param.range, value).unwrap_or_else(right);
    Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)))
}

/// Inputs in the order of the catalog.
fn inputs<'a>(table: &Table<'a>, law: &'a Entry, heat: &Heat, with: InputsOf<'_>) -> Read<Vec<Option<SignalPlan>>> {
    let names: Vec<&str> = law.inputs.iter().map(|input| &*input.name).collect();
    let field = table.get("inputs");
    let open = field.as_ref().map(|field| {
        let what = format!("`inputs` of {} (law {})", table.what, law.quoted());
        let beside_thermal = |key: &str| {
            let why = || {
                (
                    RefusalKind::Rule,
                    format!("`{TEMPERATURE}` in {what} stands beside `thermal`, which makes it a state"),
                )
            };
            (key == TEMPERATURE && heat.thermal.is_some()).then(why)
        };
        Table::open_with(field.ctx, field.node, &*what, &names, beside_thermal)
    });
    let given = open.transpose()?;
    let missing: Vec<_> =
        law.inputs.iter().filter(|input| given.as_ref().is_none_or(|given| given.get(&input.name).is_none())).collect();
    let untold = missing.iter().filter(|input| !given.as_ref().is_some_and(|given| given.suspects(&input.name)));
    let untold: Vec<&str> = untold.map(|input| &*input.name).collect();
    if !untold.is_empty() && !matches!(with, InputsOf::Lone) {
        let right: Vec<String> =
            missing.iter().map(|input| describe(&input.name, &input.unit, &input.meaning)).collect();
        let place = field.as_ref().map_or(&table.node.place, |field| &field.node.place);
        let message =
            format!("{}: law {} needs the inputs {}", table.what, law.quoted(), names::list(untold.iter().copied()));
        let refusal = place.refuse(RefusalKind::Missing, message).label("missing inputs");
        let mut help = right.join("; ");
        if !heat.is_none() && untold.contains(&TEMPERATURE) {
            help.push_str("; or a table `thermal`, which makes it a state");
        }
        table.ctx.refuse(refusal.help(help));
    }
    all(law.inputs.iter().map(|input| {
        let wanted = |end| Wanted { unit: &input.unit, range: input.range, smooth: false, end };
        let (field, signal) = match (given.as_ref().and_then(|given| given.get(&input.name)), with) {
            (Some(field), InputsOf::Robot(time)) => {
                let signal = feedback::read(&field, wanted(time.map(|time| time.end)))?;
                (field, signal)
            }
            (Some(field), InputsOf::Lone) => {
                let signal = feedback::read_of_time(&field, wanted(None))?;
                (field, signal)
            }
            (None, InputsOf::Lone) => return Ok(None),
            (None, InputsOf::Robot(_)) => return Err(Refused),
        };
        let shift = heat.shift.filter(|_| input.name == TEMPERATURE);
        if let Some((shift, temperature)) = shift.zip(signal.constant)
            && let Err(broken) = shift.check(temperature)
        {
            return Err(field.refuse(
                RefusalKind::Rule,
                format!("does not go with `shift`, which needs {broken}"),
                None,
            ));
        }
        Ok(Some(signal))
    }))
}

#[cfg(test)]
mod tests {
    use super::unit_on_rotation;

    #[test]
    fn units_turn() {
        for (unit, turned) in [
            ("N/m", "N*m/rad"),
            ("N*s^alpha/m", "N*m*s^alpha/rad"),
            ("N*s^alpha/(m*V)", "N*m*s^alpha/(rad*V)"),
            ("m/K", "rad/K"),
            ("N/m^3", "N*m/rad^3"),
            ("N", "N*m"),
            ("1/N", "1/(N*m)"),
            ("N^2*s^m", "(N*m)^2*s^m"),
            ("mm", "mm"),
            ("", ""),
        ] {
            assert_eq!(unit_on_rotation(unit), turned);
        }
    }
}
