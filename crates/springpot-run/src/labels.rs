//! Column names as a reader of a figure wants them.

use springpot::observe::Quantity;
use springpot::observe::symbol::subscript;
use springpot::table::Column;

/// What stands at an axis: symbol or words, then the unit.
pub fn axis(column: &Column, unit: Option<&str>) -> String {
    let unit = unit.map_or_else(|| written_unit(&column.unit), written_unit);
    let name = quantity(&column.name);
    if unit.is_empty() { name } else { format!("{name}, {unit}") }
}

/// The quantity alone: `strut.Q.q2` becomes "Q₂ of strut"; what no run of ours calls a column stays.
pub fn quantity(name: &str) -> String {
    Quantity::read(name).map_or_else(|| name.into(), |quantity| quantity.symbol())
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
