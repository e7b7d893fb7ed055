//! Column names as a reader of a figure wants them.

use springpot::table::Column;

/// What stands at an axis: symbol or words, then the unit.
pub fn axis(column: &Column, unit: Option<&str>) -> String {
    let unit = unit.map_or_else(|| written_unit(&column.unit), written_unit);
    let name = quantity(&column.name);
    if unit.is_empty() { name } else { format!("{name}, {unit}") }
}

/// The quantity alone: `strut.Q.q2` becomes "Q₂ of strut".
pub fn quantity(name: &str) -> String {
    // Names of elements hold no dot; those of joints may, and the parts of a floating joint follow one.
    let (first, rest) = name.split_once('.').map_or((name, None), |(first, rest)| (first, Some(rest)));
    match (first, rest) {
        ("q" | "v" | "a", Some(joint)) => return motion(first, joint),
        ("tau", Some(joint)) => return format!("actuator τ{}", joint_suffix(joint)),
        _ => {}
    }
    let (second, third) =
        rest.map_or((None, None), |rest| rest.split_once('.').map_or((Some(rest), None), |(a, b)| (Some(a), Some(b))));
    match (first, second, third) {
        ("t", None, None) => "time t".into(),
        ("gripper", Some("error"), None) => "distance of the gripper from its path".into(),
        ("gripper", Some(axis), None) => format!("{axis} of the gripper"),
        ("energy", Some("residual"), None) => "energy residual".into(),
        ("energy", Some(kind), None) => format!("{kind} energy"),
        (element, Some("Q"), Some(joint)) => format!("Q{} of {element}", joint_suffix(joint)),
        (element, Some("length"), None) => format!("length l of {element}"),
        (element, Some("stroke"), None) => format!("stroke x of {element}"),
        (element, Some("rate"), None) => format!("stroke rate of {element}"),
        (element, Some("derivative"), None) => format!("Dᵅ x of {element}"),
        (element, Some("force"), None) => format!("force F of {element}"),
        (element, Some("stored"), None) => format!("energy stored in {element}"),
        (element, Some("dissipated"), None) => format!("energy dissipated in {element}"),
        (element, Some("input"), None) => format!("energy supplied to {element}"),
        (element, Some(input), None) => format!("{input} of {element}"),
        _ => name.into(),
    }
}

/// A coordinate, velocity or acceleration: of a joint of one degree q with its dots, of a floating one its part.
fn motion(kind: &str, joint: &str) -> String {
    let dots = match kind {
        "q" => "",
        "v" => "\u{307}",
        _ => "\u{308}",
    };
    let floating = joint.rsplit_once('.').and_then(|(joint, part)| Some((joint, part_of_floating(kind, part)?)));
    if let Some((joint, part)) = floating {
        return format!("{part} of {joint}");
    }
    match joint.strip_prefix('q').filter(|rest| rest.chars().all(|c| c.is_ascii_digit())) {
        Some(index) => format!("q{dots}{}", subscript(index)),
        None => format!("q{dots} of {joint}"),
    }
}

/// A part of a floating joint as a symbol: its velocities are v and ω in its own axes, their rates have a dot.
fn part_of_floating(kind: &str, part: &str) -> Option<String> {
    let dot = if kind == "a" { "\u{307}" } else { "" };
    match (kind, part) {
        ("q", "x" | "y" | "z" | "qx" | "qy" | "qz" | "qw") => Some(part.to_owned()),
        ("v" | "a", "vx" | "vy" | "vz") => Some(format!("v{dot}_{}", &part[1..])),
        ("v" | "a", "wx" | "wy" | "wz") => Some(format!("ω{dot}_{}", &part[1..])),
        _ => None,
    }
}

/// Last name of a path as a symbol: `alpha` becomes α, `mu_0` μ₀; other names stay.
pub fn parameter(path: &str) -> String {
    let last = match path.strip_suffix('"') {
        Some(quoted) => quoted.rsplit_once(".\"").map_or(quoted, |(_, last)| last),
        None => path.rsplit('.').next().unwrap_or(path),
    };
    let (root, index) = last.split_once('_').map_or((last, None), |(root, index)| (root, Some(index)));
    let root = match root {
        "alpha" => "α",
        "mu" => "μ",
        other => other,
    };
    match index {
        None => root.into(),
        Some(digits) if digits.bytes().all(|b| b.is_ascii_digit()) => format!("{root}{}", subscript(digits)),
        Some(index) => format!("{root}_{index}"),
    }
}

/// Text as a reader writes it: "25 degC" becomes "25 °C", "N*m" becomes "N·m".
pub fn written_unit(unit: &str) -> String {
    let text = unit.replace("degC", "°C").replace("degF", "°F").replace("alpha", "α").replace('*', "·");
    raise(&text.replace("deg", "°"))
}

/// `q2` becomes ₂, other names " of NAME".
fn joint_suffix(joint: &str) -> String {
    match joint.strip_prefix('q').filter(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit())) {
        Some(index) => subscript(index),
        None => format!(" at {joint}"),
    }
}

fn subscript(digits: &str) -> String {
    digits.chars().map(|c| char::from_u32('₀' as u32 + c.to_digit(10).unwrap_or(0)).unwrap_or(c)).collect()
}

/// `^2` becomes ², `^alpha` ᵅ; other exponents stay.
fn raise(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace("^α", "ᵅ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes() {
        let column = |name: &str, unit: &str| Column::new(name, unit, "");
        assert_eq!(axis(&column("strut.Q.q2", "N*m"), None), "Q₂ of strut, N·m");
        assert_eq!(axis(&column("strut.stroke", "m"), Some("cm")), "stroke x of strut, cm");
        assert_eq!(axis(&column("t", "s"), None), "time t, s");
        assert_eq!(axis(&column("a.q12", "rad/s^2"), None), "q\u{308}₁₂, rad/s²");
        assert_eq!(axis(&column("arm.derivative", "m/s^alpha"), None), "Dᵅ x of arm, m/sᵅ");
        assert_eq!(axis(&column("strut.Q.elbow", "N*m"), None), "Q at elbow of strut, N·m");
        assert_eq!(written_unit("25 degC"), "25 °C");
        assert_eq!(axis(&column("q.left knee", "rad"), None), "q of left knee, rad");
        assert_eq!(axis(&column("q.base.qw", "1"), None), "qw of base, 1");
        assert_eq!(axis(&column("v.base.wx", "rad/s"), None), "ω_x of base, rad/s");
        assert_eq!(axis(&column("a.base.vz", "m/s^2"), None), "v\u{307}_z of base, m/s²");
        assert_eq!(axis(&column("q.arm.1", "rad"), None), "q of arm.1, rad");
        assert_eq!(axis(&column("tau.base.vz", "N"), None), "actuator τ at base.vz, N");
        assert_eq!(axis(&column("strut.Q.base.wz", "N*m"), None), "Q at base.wz of strut, N·m");
        assert_eq!(["motion.joints.\"left knee\"", "motion.joints.\"a.b\""].map(parameter), ["left knee", "a.b"]);
        let symbols = ["element.strut.alpha", "e.mu_0", "e.mu", "e.E_kv", "e.alpha_pz", "solver.rtol", "T"];
        assert_eq!(symbols.map(parameter), ["α", "μ₀", "μ", "E_kv", "α_pz", "rtol", "T"]);
    }
}
