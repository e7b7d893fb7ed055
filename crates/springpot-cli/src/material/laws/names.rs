//! What data sheets and measurements call their quantities.

use springpot::law::datasheet::Quantity;

/// Names that are suggested for wrong ones.
pub(super) const SUGGESTED: [&str; 6] = ["tan_delta", "stiffness", "storage", "loss", "damping", "loss_factor"];

/// The quantity of that name, and whether the name is that of a modulus, E or G.
pub(super) fn quantity(name: &str) -> Option<(Quantity, bool)> {
    Some(match &*plain(name) {
        "tan_delta" | "tan(delta)" | "loss_factor" | "loss_tangent" => (Quantity::LossFactor, false),
        "stiffness" | "dynamic_stiffness" | "|k*|" => (Quantity::Stiffness, false),
        "dynamic_modulus" | "complex_modulus" | "|e*|" | "|g*|" | "e" | "g" | "young's_modulus" | "shear_modulus" => {
            (Quantity::Stiffness, true)
        }
        "storage" | "storage_stiffness" | "k'" => (Quantity::Storage, false),
        "storage_modulus" | "e'" | "g'" => (Quantity::Storage, true),
        "loss" | "loss_stiffness" | "k''" => (Quantity::Loss, false),
        "loss_modulus" | "e''" | "g''" => (Quantity::Loss, true),
        "damping" => (Quantity::Damping, false),
        _ => return None,
    })
}

/// What columns of tables are called besides.
pub(super) fn column(name: &str) -> Option<(Quantity, bool)> {
    Some(match &*plain(name) {
        "modulus" => (Quantity::Stiffness, true),
        "e_stor" | "g_stor" => (Quantity::Storage, true),
        "e_loss" | "g_loss" => (Quantity::Loss, true),
        _ => return None,
    })
}

pub(super) fn is_frequency(name: &str) -> bool {
    matches!(&*plain(name), "frequency" | "freq" | "f") || is_angular(name)
}

/// Whether a name is that of 2π times the frequency, in rad/s where nothing else is said.
pub(super) fn is_angular(name: &str) -> bool {
    matches!(&*plain(name), "angular_frequency" | "ang._frequency" | "ang_frequency" | "ang._freq" | "ang._freq.")
}

pub(super) fn is_temperature(name: &str) -> bool {
    matches!(&*plain(name), "temperature" | "temp" | "temp.")
}

/// Small letters, words joined by `_`, primes as typewriters have them.
fn plain(name: &str) -> String {
    let name = name.to_lowercase().replace(['\u{2032}', '\u{2019}', '\u{b4}', '`'], "'");
    let name = name.replace(['\u{2033}', '\u{201d}', '"'], "''").replace('δ', " delta");
    let words: Vec<&str> = name.split(|c: char| c.is_whitespace() || matches!(c, '_' | '-')).collect();
    words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join("_").replace("(_", "(")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_names_are_known() {
        for (quantity_meant, is_modulus, names) in [
            (Quantity::LossFactor, false, &["tan_delta", "tan δ", "tanδ", "tan(δ)", "Tan(Delta)", "loss factor"][..]),
            (Quantity::Storage, true, &["E'", "E′", "E’", "G′", "Storage Modulus", "storage-modulus"]),
            (Quantity::Storage, false, &["K'", "k′", "storage stiffness", "Storage"]),
            (Quantity::Loss, true, &["E''", "E″", "E\"", "E′′", "G”", "loss_modulus"]),
            (Quantity::Loss, false, &["K″", "loss"]),
            (Quantity::Stiffness, true, &["|E*|", "complex modulus"]),
        ] {
            for name in names {
                assert_eq!(quantity(name), Some((quantity_meant, is_modulus)), "{name}");
            }
        }
        assert_eq!(quantity("E"), Some((Quantity::Stiffness, true)));
        for name in ["tandelta", "''", "", "modulus", "tan"] {
            assert_eq!(quantity(name), None, "{name}");
        }
        assert!(is_frequency("Frequency") && is_frequency(" f") && !is_frequency("omega"));
        assert!(SUGGESTED.iter().all(|name| quantity(name).is_some()));
    }
}
