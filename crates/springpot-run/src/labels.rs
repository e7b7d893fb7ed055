//! Column names as a reader of a figure wants them.

mod value;

pub use value::values;

use springpot::observe::{ElementQuantity, EnergyQuantity, Quantity};
use springpot::table::Column;
use springpot_scenario::units::Unit;

/// What stands at an axis: symbol or words, then the unit.
pub fn axis(column: &Column, unit: Option<&str>) -> String {
    let unit = unit.map_or_else(|| written_unit(&column.unit), written_unit);
    let name = quantity(&column.name);
    if unit.is_empty() { name } else { format!("{name}, {unit}") }
}

/// The quantity alone: `strut.Q.q2` becomes "Q₂ of strut", of a joint that is called by one letter `q.s` becomes "s"; what no run of ours calls
/// a column stays.
pub fn quantity(name: &str) -> String {
    let letter = |name: &&str, dots: &str| {
        let mut all = name.chars();
        let is_letter = all.next().is_some_and(char::is_alphabetic) && all.next().is_none();
        is_letter.then(|| format!("{name}{dots}"))
    };
    let Some(quantity) = Quantity::read(name) else { return name.into() };
    let own = match &quantity {
        Quantity::Coordinate(name) => letter(name, ""),
        Quantity::Velocity(name) => letter(name, "\u{307}"),
        Quantity::Acceleration(name) => letter(name, "\u{308}"),
        Quantity::Energy(EnergyQuantity::Actuators) => Some("work of the actuators".to_owned()),
        Quantity::Energy(EnergyQuantity::Joints) => Some("energy lost in joints".to_owned()),
        Quantity::Derivative(name) => derivative(name),
        _ => None,
    };
    own.unwrap_or_else(|| quantity.symbol())
}

/// ∂F/∂α of strut.
fn derivative(name: &str) -> Option<String> {
    let (of, by) = Quantity::of_derivative(name)?;
    let symbol = quantity(of);
    let (symbol, whose) = symbol.split_once(" of ").unwrap_or((&symbol, ""));
    // The letter behind the words: "force F".
    let symbol = symbol.rsplit(' ').next()?;
    let whose = if whose.is_empty() { String::new() } else { format!(" of {whose}") };
    Some(format!("∂{symbol}/∂{}{whose}", parameter(by)))
}

/// What several columns have in common: "force F", "coordinate q"; of different quantities what their unit measures.
pub fn common(columns: &[&Column]) -> Option<String> {
    let first = columns.first()?;
    let kind = kind(&first.name);
    if kind.is_some() && columns.iter().all(|column| self::kind(&column.name) == kind) {
        return kind;
    }
    let measured = match first.unit.as_str() {
        "N" => "force",
        "N*m" => "torque",
        "m" => "length",
        "rad" => "angle",
        "m/s" => "velocity",
        "rad/s" => "angular velocity",
        "m/s^2" => "acceleration",
        "rad/s^2" => "angular acceleration",
        "J" => "energy",
        "K" => "temperature",
        "V" => "voltage",
        "s" => "time",
        _ => return None,
    };
    columns.iter().all(|column| column.unit == first.unit).then(|| measured.into())
}

/// The quantity of a column without whose it is.
fn kind(name: &str) -> Option<String> {
    let quantity = Quantity::read(name)?;
    Some(match quantity {
        Quantity::Coordinate(_) => "coordinate q".into(),
        Quantity::Velocity(_) => "velocity q\u{307}".into(),
        Quantity::Acceleration(_) => "acceleration q\u{308}".into(),
        Quantity::Torque(_) => "actuator τ".into(),
        Quantity::Gripper(_) => "position of the gripper".into(),
        Quantity::Energy(_) => "energy".into(),
        Quantity::Element(_, ElementQuantity::GeneralizedForce(_)) => "generalized force Q".into(),
        Quantity::Element(
            _,
            ElementQuantity::Stored
            | ElementQuantity::Dissipated
            | ElementQuantity::Input
            | ElementQuantity::Told("heat"),
        ) => "energy".into(),
        Quantity::Time | Quantity::GripperError | Quantity::Element(..) | Quantity::Derivative(_) => {
            let symbol = quantity.symbol();
            symbol.split_once(" of ").map_or(symbol.clone(), |(kind, _)| kind.into())
        }
    })
}

/// What a sweep and its values are called in legends: values that have names are these, and need no heading; else the parameters, and the
/// values as written with as few digits as tell them apart.
pub fn sweep<'a>(
    parameters: impl Iterator<Item = &'a str>,
    labels: &[String],
    are_names: bool,
) -> (String, Vec<String>) {
    if are_names {
        return (String::new(), labels.to_vec());
    }
    (parameters.map(parameter).collect::<Vec<_>>().join(", "), values(labels))
}

/// Last name of a path as a symbol: `alpha` becomes α, `mu_0` μ₀, `E_d` E with an index; other names stay.
pub fn parameter(path: &str) -> String {
    let last = match path.strip_suffix('"') {
        Some(quoted) => quoted.rsplit_once(".\"").map_or(quoted, |(_, last)| last),
        None => path.rsplit('.').next().unwrap_or(path),
    };
    value::symbol(last)
}

/// Text as a reader writes it: "25 degC" becomes "25 °C", "N*m" becomes "N·m", "um" becomes "µm".
pub fn written_unit(unit: &str) -> String {
    let mut text = String::new();
    let mut rest = unit;
    while let Some(start) = rest.find(char::is_alphabetic) {
        let end = start + rest[start..].find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len() - start);
        text.push_str(&rest[..start]);
        text.push_str(&written_symbol(&rest[start..end]));
        rest = &rest[end..];
    }
    text.push_str(rest);
    raise(&text.replace('*', "·"))
}

/// The symbol of a unit, or the name of an exponent.
fn written_symbol(symbol: &str) -> String {
    match symbol {
        "degC" => "°C".to_owned(),
        "degF" => "°F".to_owned(),
        "deg" => "°".to_owned(),
        "alpha" => "α".to_owned(),
        _ => match symbol.strip_prefix('u').filter(|base| Unit::parse(base, &|_| None).is_ok()) {
            Some(base) => format!("µ{}", base.replace("ohm", "Ω")),
            None if Unit::parse(symbol, &|_| None).is_ok() => symbol.replace("ohm", "Ω"),
            None => symbol.to_owned(),
        },
    }
}

/// `^2` becomes ², `^alpha` ᵅ; other exponents stay.
fn raise(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace("^α", "ᵅ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_in_common() {
        let column = |name: &str, unit: &str| Column::new(name, unit, "");
        let common = |list: &[(&str, &str)]| {
            let columns: Vec<Column> = list.iter().map(|(name, unit)| column(name, unit)).collect();
            super::common(&columns.iter().collect::<Vec<_>>())
        };
        assert_eq!(common(&[("q.mass", "m"), ("q.exact", "m")]).as_deref(), Some("coordinate q"));
        assert_eq!(common(&[("strut.force", "N"), ("pad.force", "N")]).as_deref(), Some("force F"));
        assert_eq!(common(&[("strut.Q.q1", "N*m"), ("pad.Q.q2", "N*m")]).as_deref(), Some("generalized force Q"));
        assert_eq!(common(&[("strut.Q.q1", "N*m"), ("tau.q1", "N*m")]).as_deref(), Some("torque"));
        assert_eq!(common(&[("strut.stored", "J"), ("energy.kinetic", "J")]).as_deref(), Some("energy"));
        assert_eq!(common(&[("strut.rate", "m/s"), ("v.x", "m/s")]).as_deref(), Some("velocity"));
        assert_eq!(common(&[("a", "bar"), ("b", "bar")]), None);
    }

    #[test]
    fn axes() {
        let column = |name: &str, unit: &str| Column::new(name, unit, "");
        assert_eq!(axis(&column("strut.Q.q2", "N*m"), None), "Q₂ of strut, N·m");
        assert_eq!(axis(&column("strut.stroke", "m"), Some("cm")), "stroke x of strut, cm");
        assert_eq!(axis(&column("t", "s"), None), "time t, s");
        assert_eq!(axis(&column("a.q12", "rad/s^2"), None), "q\u{308}₁₂, rad/s²");
        assert_eq!(axis(&column("arm.derivative", "m/s^alpha"), None), "Dᵅ x of arm, m/sᵅ");
        assert_eq!(axis(&column("d(strut.force)/d(alpha)", "N"), None), "∂F/∂α of strut, N");
        assert_eq!(axis(&column("d(q.q2)/d(element.strut.c)", "rad/(N*s/m)"), None), "∂q₂/∂c, rad/(N·s/m)");
        assert_eq!(axis(&column("strut.Q.elbow", "N*m"), None), "Q at elbow of strut, N·m");
        assert_eq!(written_unit("25 degC"), "25 °C");
        let written =
            ["um", "uC", "kN*um", "N/um", "1/us", "µm", "kJ/mol", "Mohm", "deg/s", "N*s^alpha/m"].map(written_unit);
        assert_eq!(written, ["µm", "µC", "kN·µm", "N/µm", "1/µs", "µm", "kJ/mol", "MΩ", "°/s", "N·sᵅ/m"]);
        let letters = ["q.s", "v.s", "a.z", "q.x1", "tau.s", "q.µ"].map(quantity);
        assert_eq!(letters, ["s", "s\u{307}", "z\u{308}", "q of x1", "actuator τ at s", "µ"]);
        assert_eq!(axis(&column("q.left knee", "rad"), None), "q of left knee, rad");
        assert_eq!(axis(&column("q.base.qw", "1"), None), "qw of base, 1");
        assert_eq!(axis(&column("v.base.wx", "rad/s"), None), "ω_x of base, rad/s");
        assert_eq!(axis(&column("a.base.vz", "m/s^2"), None), "v\u{307}_z of base, m/s²");
        assert_eq!(axis(&column("q.arm.1", "rad"), None), "q of arm.1, rad");
        assert_eq!(axis(&column("tau.base.vz", "N"), None), "actuator τ at base.vz, N");
        assert_eq!(axis(&column("strut.Q.base.wz", "N*m"), None), "Q at base.wz of strut, N·m");
        assert_eq!(["motion.joints.\"left knee\"", "motion.joints.\"a.b\""].map(parameter), ["left knee", "a.b"]);
        let symbols = ["element.strut.alpha", "e.mu_0", "e.mu", "e.E_kv", "e.alpha_pz", "solver.rtol", "T"];
        assert_eq!(symbols.map(parameter), ["α", "μ₀", "μ", "E_{kv}", "α_{pz}", "rtol", "T"]);
    }
}
