//! Quantities as a reader of a figure wants them.

use super::quantity::{EnergyQuantity, Quantity};
use super::subscript::at_joint;
pub use super::subscript::subscript;

impl Quantity<&str> {
    /// Symbol or words without unit: "q̇₂", "Q₂ of strut", "energy residual".
    pub fn symbol(&self) -> String {
        match self {
            Self::Time => "time t".into(),
            Self::Coordinate(label) => state("q", &FLOATING_Q, "", label),
            Self::Velocity(label) => state("q\u{307}", &FLOATING_V, "", label),
            Self::Acceleration(label) => state("q\u{308}", &FLOATING_V, "\u{307}", label),
            Self::Torque(label) => format!("actuator τ{}", at_joint(label)),
            Self::Element(name, quantity) => quantity.symbol(name),
            Self::Gripper(axis) => format!("{} of the gripper", axis.name()),
            Self::GripperError => "distance of the gripper from its path".into(),
            Self::Energy(EnergyQuantity::Residual) => "energy residual".into(),
            Self::Energy(energy) => format!("{} energy", energy.key()),
            Self::Derivative(name) => derivative(name),
        }
    }
}

/// ∂F/∂alpha, of strut: what is differentiated by its symbol, and the last name of the parameter.
fn derivative(name: &str) -> String {
    let Some((of, by)) = Quantity::of_derivative(name) else { return name.to_owned() };
    let symbol = Quantity::read(of).map_or_else(|| of.to_owned(), |quantity| quantity.symbol());
    let (symbol, whose) = match symbol.split_once(" of ") {
        Some((symbol, whose)) => (symbol.to_owned(), format!(" of {whose}")),
        None => (symbol, String::new()),
    };
    // The letter behind the words: "force F".
    let symbol = symbol.rsplit(' ').next().unwrap_or_default();
    let by = by.rsplit('.').next().unwrap_or(by);
    format!("∂{symbol}/∂{by}{whose}")
}

/// Parts of a floating joint's coordinates.
const FLOATING_Q: [(&str, &str, &str); 7] = [
    ("x", "x", ""),
    ("y", "y", ""),
    ("z", "z", ""),
    ("qx", "qx", ""),
    ("qy", "qy", ""),
    ("qz", "qz", ""),
    ("qw", "qw", ""),
];

/// Parts of its velocities, v and ω in its own axes: name, symbol, index.
const FLOATING_V: [(&str, &str, &str); 6] =
    [("vx", "v", "_x"), ("vy", "v", "_y"), ("vz", "v", "_z"), ("wx", "ω", "_x"), ("wy", "ω", "_y"), ("wz", "ω", "_z")];

/// A coordinate, velocity or acceleration: of a joint of one degree q with its dots, of a floating one its part, with a dot where
/// it is a rate.
fn state(symbol: &str, of_floating: &[(&str, &str, &str)], dot: &str, label: &str) -> String {
    let part = label.rsplit_once('.').and_then(|(joint, part)| {
        let (_, symbol, index) = of_floating.iter().find(|(name, ..)| *name == part)?;
        Some(format!("{symbol}{dot}{index} of {joint}"))
    });
    part.unwrap_or_else(|| match label.strip_prefix('q').filter(|rest| rest.chars().all(|c| c.is_ascii_digit())) {
        Some(digits) => format!("{symbol}{}", subscript(digits)),
        None => format!("{symbol} of {label}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols() {
        for (name, symbol) in [
            ("t", "time t"),
            ("q.q12", "q₁₂"),
            ("v.q2", "q\u{307}₂"),
            ("a.elbow", "q\u{308} of elbow"),
            ("q.base.qw", "qw of base"),
            ("v.base.wx", "ω_x of base"),
            ("a.base.vz", "v\u{307}_z of base"),
            ("v.base.qw", "q\u{307} of base.qw"),
            ("tau.q1", "actuator τ₁"),
            ("tau.base.vz", "actuator τ at base.vz"),
            ("strut.Q.q2", "Q₂ of strut"),
            ("strut.Q.base.wz", "Q at base.wz of strut"),
            ("strut.input", "energy supplied to strut"),
            ("strut.T", "T of strut"),
            ("mount.rx.force", "force F of mount.rx"),
            ("mount.y.Q.q2", "Q₂ of mount.y"),
            ("gripper.y", "y of the gripper"),
            ("gripper.error", "distance of the gripper from its path"),
            ("energy.kinetic", "kinetic energy"),
            ("energy.residual", "energy residual"),
            ("d(strut.force)/d(alpha)", "∂F/∂alpha of strut"),
            ("d(q.q2)/d(motion.start.v.q1)", "∂q₂/∂q1"),
        ] {
            let quantity = Quantity::read(name).unwrap();
            assert_eq!((quantity.symbol().as_str(), quantity.to_string().as_str()), (symbol, name));
        }
        assert_eq!(["alpha", "element.strut.alpha", "strut.force.x"].map(Quantity::read), [None; 3]);
    }
}
