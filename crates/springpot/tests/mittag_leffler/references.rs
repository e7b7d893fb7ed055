//! Against the files of reference values, read whole.

use serde_json::Value;
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler, mittag_leffler};
use std::collections::HashSet;

fn file(name: &str) -> Value {
    let path = format!("{}/../../testdata/fractional/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

/// |error| over max(|E|, 1e-3).
fn defect(computed: Complex64, exact: Complex64) -> f64 {
    let error = (computed - exact).norm();
    if error.is_nan() { f64::INFINITY } else { error / exact.norm().max(1e-3) }
}

#[test]
fn the_table_of_common_parameters_is_met() {
    let table = file("mittag_leffler.json");
    let mut count = 0;
    for row in table["rows"].as_array().unwrap() {
        let complex = |key: &str| Complex64::new(number(&row[key][0]), number(&row[key][1]));
        let (a, b, z, exact) = (number(&row["a"]), number(&row["b"]), complex("z"), complex("re_im"));
        let error = defect(mittag_leffler(a, b, z).unwrap(), exact);
        assert!(error <= 1e-12, "E_{{{a},{b}}}({z}): {error:e}");
        if z.im == 0.0 {
            let error = defect(MittagLeffler::new(a, b).unwrap().real(z.re).into(), exact);
            assert!(error <= 1e-12, "E_{{{a},{b}}}({}): {error:e}", z.re);
        }
        count += 1;
    }
    assert_eq!(count, 238);
}

/// Every row of every group within 1e-12; the number of rows, and of pairs a, b.
fn groups_are_met(name: &str) -> (Vec<(String, usize)>, usize) {
    let table = file(name);
    let mut parameters = HashSet::new();
    let mut counts = Vec::new();
    for (name, group) in table["groups"].as_object().unwrap() {
        let rows = group.as_array().unwrap();
        let mut worst = 0.0f64;
        for row in rows {
            let [a, b, n, re, im, exact_re, exact_im] = std::array::from_fn(|k| number(&row[k]));
            let (z, exact) = (Complex64::new(re, im), Complex64::new(exact_re, exact_im));
            let error = defect(MittagLeffler::derivative(a, b, n as usize).unwrap().complex(z), exact);
            assert!(error <= 1e-12, "{name}: derivative {n} of E_{{{a},{b}}} at {z}: {error:e}");
            worst = worst.max(error);
            parameters.insert((a.to_bits(), b.to_bits()));
        }
        println!("{name}: {} rows, worst {worst:.1e}", rows.len());
        counts.push((name.clone(), rows.len()));
    }
    (counts, parameters.len())
}

#[test]
fn the_whole_plane_is_met() {
    let (counts, parameters) = groups_are_met("mittag_leffler_plane.json");
    assert_eq!(counts, PLANE.map(|(name, rows)| (name.to_owned(), rows)));
    assert!(parameters > 500, "{parameters}");
}

#[test]
fn the_hard_places_are_met() {
    let (counts, parameters) = groups_are_met("mittag_leffler_hard.json");
    assert_eq!(counts, HARD.map(|(name, rows)| (name.to_owned(), rows)));
    assert!(parameters > 1000, "{parameters}");
}

const PLANE: [(&str, usize); 6] = [
    ("derivatives", 160),
    ("negative axis", 100),
    ("orders above two", 100),
    ("plane", 400),
    ("small orders", 60),
    ("wide b", 100),
];

const HARD: [(&str, usize); 9] = [
    ("derivatives", 160),
    ("far", 120),
    ("near poles, b above -1", 200),
    ("near poles, b below -1", 200),
    ("nearly whole b", 160),
    ("negative b", 160),
    ("negative b, derivatives", 160),
    ("small orders", 120),
    ("whole b", 220),
];
