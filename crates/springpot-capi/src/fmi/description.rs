//! modelDescription.xml (FMI 2.0.4, 2.2 and 4.3).

use super::variables::{Role, Variable};
use springpot_scenario::units::Unit;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// What a description says besides its variables.
pub(super) struct Head<'a> {
    pub(super) title: &'a str,
    pub(super) identifier: &'a str,
    pub(super) guid: &'a str,
    /// End of the scenario, s.
    pub(super) end: f64,
    /// Distance of its rows, s, where they have one.
    pub(super) step: Option<f64>,
    /// None of steps of one size.
    pub(super) tolerance: Option<f64>,
}

/// The categories of messages.
pub(super) const CATEGORIES: [(&str, &str); 3] = [
    ("logStatusDiscard", "steps beyond the end of the scenario, or beyond an event that ends it"),
    ("logStatusError", "what was refused, and why"),
    ("logAll", "all messages"),
];

/// The text of a description.
pub(super) fn xml(head: &Head, variables: &[Variable]) -> String {
    let Head { title, identifier, guid, end, step, tolerance } = head;
    let (title, tool) = (escaped(title), concat!("Springpot ", env!("CARGO_PKG_VERSION")));
    let step = step.map_or(String::new(), |step| format!(" stepSize=\"{step:?}\""));
    let tolerance = tolerance.map_or(String::new(), |tolerance| format!(" tolerance=\"{tolerance:?}\""));
    let categories =
        CATEGORIES.map(|(name, words)| format!("    <Category name=\"{name}\" description=\"{words}\"/>\n"));
    let (outputs, unknowns) = structure(variables);
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{title}" guid="{guid}" generationTool="{tool}" variableNamingConvention="flat" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="{identifier}" needsExecutionTool="false" canHandleVariableCommunicationStepSize="true" canInterpolateInputs="false" maxOutputDerivativeOrder="0" canRunAsynchronuously="false" canBeInstantiatedOnlyOncePerProcess="false" canNotUseMemoryManagementFunctions="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true" providesDirectionalDerivative="false"/>
{units}  <LogCategories>
{categories}  </LogCategories>
  <DefaultExperiment startTime="0" stopTime="{end:?}"{tolerance}{step}/>
  <ModelVariables>
{variables}  </ModelVariables>
  <ModelStructure>
{outputs}{unknowns}  </ModelStructure>
</fmiModelDescription>
"#,
        units = units(variables),
        categories = categories.concat(),
        variables = variables.iter().enumerate().map(|(k, variable)| scalar(k, variable)).collect::<String>(),
    )
}

fn units(variables: &[Variable]) -> String {
    let names: BTreeSet<&str> = variables.iter().filter_map(unit).collect();
    if names.is_empty() {
        return String::new();
    }
    let mut text = "  <UnitDefinitions>\n".to_owned();
    for name in names {
        let base = base(name).map_or("/>".to_owned(), |base| format!("><BaseUnit{base}/></Unit>"));
        _ = writeln!(text, "    <Unit name=\"{}\"{base}", escaped(name));
    }
    text + "  </UnitDefinitions>\n"
}

/// The unit of a variable, if it has one.
fn unit(variable: &Variable) -> Option<&str> {
    Some(variable.unit.as_str()).filter(|unit| !matches!(*unit, "" | "1"))
}

/// A unit in those of the standard, where all exponents are whole numbers.
fn base(name: &str) -> Option<String> {
    let exponents = |name: &str| Some(Unit::parse(name, &|_| None).ok()?.dimension().exponents());
    let own = exponents(name)?;
    // Angles have no dimension there: they are counted as what no such unit has.
    let turned = exponents(&name.replace("rad", "K"))?;
    let counted = [
        ("kg", own[0]),
        ("m", own[1]),
        ("s", own[2]),
        ("A", own[3]),
        ("K", own[4]),
        ("mol", own[5]),
        ("rad", turned[4] - own[4]),
    ];
    let whole = counted.iter().all(|(_, exponent)| exponent.fract() == 0.0);
    let written = counted.iter().filter(|(_, exponent)| *exponent != 0.0);
    whole.then(|| written.map(|(unit, exponent)| format!(" {unit}=\"{exponent}\"")).collect())
}

fn scalar(reference: usize, variable: &Variable) -> String {
    let Variable { name, meaning, role, .. } = variable;
    let (name, meaning) = (escaped(name), escaped(meaning));
    let unit = unit(variable).map_or(String::new(), |unit| format!(" unit=\"{}\"", escaped(unit)));
    let kind = match role {
        Role::Time => "causality=\"independent\" variability=\"continuous\"",
        Role::Torque { .. } | Role::Input { .. } => "causality=\"input\" variability=\"continuous\"",
        Role::Parameter { .. } => "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"",
        Role::Output { .. } => "causality=\"output\" variability=\"continuous\" initial=\"calculated\"",
    };
    let start = match role {
        Role::Time | Role::Output { .. } => String::new(),
        _ => variable.start().map_or(String::new(), |start| format!(" start=\"{start:?}\"")),
    };
    format!(
        "    <ScalarVariable name=\"{name}\" valueReference=\"{reference}\" {kind} description=\"{meaning}\"><Real{start}{unit}/></ScalarVariable>\n"
    )
}

/// The outputs with what they follow from at once, and at the start.
fn structure(variables: &[Variable]) -> (String, String) {
    let (mut outputs, mut unknowns) = (String::new(), String::new());
    for (k, variable) in variables.iter().enumerate() {
        let Role::Output { inputs, .. } = &variable.role else { continue };
        // Indices count from 1.
        let indices: Vec<String> = inputs.iter().map(|input| (input + 1).to_string()).collect();
        _ = writeln!(outputs, "      <Unknown index=\"{}\" dependencies=\"{}\"/>", k + 1, indices.join(" "));
        // At the start all of them follow from all that can be set.
        _ = writeln!(unknowns, "      <Unknown index=\"{}\"/>", k + 1);
    }
    let within = |name: &str, lines: String| match lines.is_empty() {
        true => String::new(),
        false => format!("    <{name}>\n{lines}    </{name}>\n"),
    };
    (within("Outputs", outputs), within("InitialUnknowns", unknowns))
}

/// A text as the value of an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // XML 1.0 knows no other control characters.
            '\n' | '\r' | '\t' => escaped.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_the_standard() {
        for (unit, wanted) in [
            ("N*m", Some(" kg=\"1\" m=\"2\" s=\"-2\"")),
            ("rad/s^2", Some(" s=\"-2\" rad=\"1\"")),
            ("N*m/rad", Some(" kg=\"1\" m=\"2\" s=\"-2\" rad=\"-1\"")),
            ("V", Some(" kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\"")),
            ("m/K", Some(" m=\"1\" K=\"-1\"")),
            ("s", Some(" s=\"1\"")),
            ("N*s^0.5/m", None),
            ("N*s^alpha/m", None),
        ] {
            assert_eq!(base(unit).as_deref(), wanted, "{unit}");
        }
        assert_eq!(escaped("a<b> & \"c\"\n\u{1}"), "a&lt;b&gt; &amp; &quot;c&quot; \u{fffd}");
    }
}
