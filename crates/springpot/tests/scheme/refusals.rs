//! Names, and what the schemes refuse.

use springpot::fractional::Kind;
use springpot::fractional::scheme::{Samples, Scheme, SchemeError, SchemeNameError};

const SCHEMES: [(&str, Scheme); 14] = [
    ("grunwald-letnikov", Scheme::GrunwaldLetnikov),
    ("grunwald-letnikov(50)", Scheme::ShortGrunwaldLetnikov(50)),
    ("grunwald-letnikov(1000000000)", Scheme::ShortGrunwaldLetnikov(1_000_000_000)),
    ("l1", Scheme::L1),
    ("l1-2", Scheme::L12),
    ("fbdf-1", Scheme::Fbdf(1)),
    ("fbdf-2", Scheme::Fbdf(2)),
    ("fbdf-3", Scheme::Fbdf(3)),
    ("fbdf-4", Scheme::Fbdf(4)),
    ("fbdf-5", Scheme::Fbdf(5)),
    ("fbdf-6", Scheme::Fbdf(6)),
    ("expansion-2004(30)", Scheme::Expansion2004(30)),
    ("expansion-2008(7)", Scheme::Expansion2008(7)),
    ("expansion-2008(5000)", Scheme::Expansion2008(5000)),
];

#[test]
fn names_read_and_write() {
    for (name, scheme) in SCHEMES {
        assert_eq!(name.parse(), Ok(scheme));
        assert_eq!(scheme.to_string(), name);
        let json = serde_json::to_string(&scheme).unwrap();
        assert_eq!(json, format!("\"{name}\""));
        assert_eq!(serde_json::from_str::<Scheme>(&json).unwrap(), scheme);
    }
}

#[test]
fn the_list_of_names_is_the_parsers() {
    for name in Scheme::NAMES {
        assert_eq!(name.replace("(N)", "(9)").parse::<Scheme>().unwrap().to_string().replace("(9)", "(N)"), name);
    }
}

#[test]
fn wrong_names_say_what_is_right() {
    for name in [
        "",
        "L1",
        "l2",
        "fbdf",
        "fbdf-",
        "fbdf-+2",
        "fbdf-2.5",
        "expansion-2004",
        "expansion-2004()",
        "grunwald-letnikov()",
    ] {
        assert_eq!(name.parse::<Scheme>(), Err(SchemeNameError::Unknown(name.into())));
    }
    for name in ["expansion-2004(-3)", "expansion-2008( 7)", "expansion-2008(7", "expansion-2012(7)", " l1"] {
        let message = name.parse::<Scheme>().unwrap_err().to_string();
        for right in [
            "grunwald-letnikov, ",
            "grunwald-letnikov(N) with N ≥ 2",
            "l1-2",
            "fbdf-6",
            "expansion-2004(N)",
            "from 2 to 5000",
            "from 1 to 5000",
        ] {
            assert!(message.contains(right), "{message}");
        }
    }
    for (name, order) in [("fbdf-0", 0), ("fbdf-7", 7), ("fbdf-256", 256)] {
        assert_eq!(name.parse::<Scheme>(), Err(SchemeNameError::Order(order)));
    }
    for (name, samples) in [("grunwald-letnikov(0)", 0), ("grunwald-letnikov(1)", 1)] {
        let error = name.parse::<Scheme>().unwrap_err();
        assert_eq!(error, SchemeNameError::Memory(samples));
        assert!(error.to_string().contains("2 to 1000000000 samples"), "{error}");
    }
    for (name, form, terms, min) in
        [("expansion-2004(1)", 2004, 1, 2), ("expansion-2008(0)", 2008, 0, 1), ("expansion-2008(5001)", 2008, 5001, 1)]
    {
        assert_eq!(name.parse::<Scheme>(), Err(SchemeNameError::Terms { form, terms, min, max: 5000 }));
    }
    // What no number holds is told as it was written.
    for (name, min, max) in [
        ("fbdf-99999999999", 1, 6),
        ("grunwald-letnikov(99999999999)", 2, 1_000_000_000),
        ("expansion-2004(4294967296)", 2, 5000),
        ("expansion-2008(99999999999999999999999)", 1, 5000),
    ] {
        let error = name.parse::<Scheme>().unwrap_err();
        assert_eq!(error, SchemeNameError::Large { name: name.into(), min, max });
        assert_eq!(error.to_string(), format!("{name} does not exist: its number must lie between {min} and {max}"));
    }
}

fn refusal(scheme: Scheme, t: &[f64], x: &[f64], rate: Option<&[f64]>, alpha: f64) -> SchemeError {
    scheme.differentiate(&Samples { t, x, rate }, alpha, Kind::Caputo).unwrap_err()
}

#[test]
fn bad_samples_are_refused_by_row() {
    let t: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.1).collect();
    let x = vec![1.0; 20];
    for (_, scheme) in SCHEMES {
        for alpha in [-2.1, 2.1, f64::INFINITY, f64::NAN] {
            assert!(matches!(refusal(scheme, &t, &x, None, alpha), SchemeError::Order(_)), "{scheme}");
        }
        // The same at order 0, where no formula is needed.
        for alpha in [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0] {
            if !scheme.orders().contains(&alpha) {
                continue;
            }
            assert_eq!(
                refusal(scheme, &t, &x[..19], None, alpha),
                SchemeError::Length { column: "x", expected: 20, found: 19 }
            );
            assert_eq!(
                refusal(scheme, &t, &x, Some(&x[..3]), alpha),
                SchemeError::Length { column: "rate", expected: 20, found: 3 }
            );
            let needed = scheme.min_rows(alpha);
            assert_eq!(
                refusal(scheme, &t[..needed - 1], &x[..needed - 1], None, alpha),
                SchemeError::TooShort { scheme, needed, found: needed - 1 }
            );
            assert!(
                scheme
                    .differentiate(&Samples { t: &t[..needed], x: &x[..needed], rate: None }, alpha, Kind::Caputo)
                    .is_ok()
            );
            assert_eq!(refusal(scheme, &[], &[], None, alpha), SchemeError::TooShort { scheme, needed, found: 0 });

            let with = |column: &[f64], row: usize, value: f64| -> Vec<f64> {
                let mut changed = column.to_vec();
                changed[row] = value;
                changed
            };
            let infinite = with(&x, 7, f64::INFINITY);
            let not_finite = |column, row, value| SchemeError::NotFinite { column, row, value };
            assert_eq!(refusal(scheme, &t, &infinite, None, alpha), not_finite("x", 7, f64::INFINITY));
            assert_eq!(refusal(scheme, &t, &x, Some(&infinite), alpha), not_finite("rate", 7, f64::INFINITY));
            let refused = refusal(scheme, &with(&t, 3, f64::NAN), &x, None, alpha);
            assert!(matches!(refused, SchemeError::NotFinite { column: "t", row: 3, .. }));
            assert_eq!(refusal(scheme, &with(&t, 0, 0.05), &x, None, alpha), SchemeError::Start(0.05));
            assert_eq!(
                refusal(scheme, &with(&t, 5, t[4]), &x, None, alpha),
                SchemeError::NotIncreasing { row: 5, t: t[4], previous: t[4] }
            );
        }
    }
}

#[test]
fn orders_that_a_scheme_lacks_are_refused_with_those_that_have_them() {
    let t: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.1).collect();
    let mut refused = 0;
    for (_, scheme) in SCHEMES {
        for order in [-2.0, -1.5, -0.1, 0.0, 0.5, 1.0, 1.1, 2.0] {
            let result = scheme.differentiate(&Samples { t: &t, x: &t, rate: None }, order, Kind::Caputo);
            assert_eq!(result.is_ok(), scheme.orders().contains(&order), "{scheme}, order {order}");
            assert_eq!(scheme.order(order).is_nan(), result.is_err());
            if let Err(error) = result {
                let (min, max) = scheme.orders().into_inner();
                assert_eq!(error, SchemeError::OrderOfScheme { scheme, order, min, max });
                let message = error.to_string();
                assert!(message.contains(&format!("from {min} to {max}, not {order}")), "{message}");
                assert!(message.contains("l1-2"), "{message}");
                refused += 1;
            }
        }
    }
    // Two short memories lack three of them, l1 two, three expansions five each.
    assert_eq!(refused, 2 * 3 + 2 + 3 * 5);
}

#[test]
fn uneven_steps_are_refused_where_they_must_be() {
    let mut t: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.1).collect();
    let x = vec![1.0; 20];
    t[19] -= 0.04;
    for (_, scheme) in SCHEMES {
        let result = scheme.differentiate(&Samples { t: &t, x: &x, rate: None }, 0.5, Kind::Caputo);
        if scheme.needs_uniform_grid() {
            let error = result.unwrap_err();
            assert!(matches!(error, SchemeError::NotUniform { row: 19, .. }), "{error:?}");
            assert!(error.to_string().contains("row 19"), "{error}");
        } else {
            result.unwrap();
        }
    }
    // A sum of 2·10⁸ terms or more is not begun.
    let t: Vec<f64> = (0..30_000).map(|k| f64::from(k).powf(1.1)).collect();
    let x = vec![1.0; t.len()];
    for scheme in [Scheme::L1, Scheme::L12] {
        assert!(matches!(refusal(scheme, &t, &x, None, 0.5), SchemeError::TooManyIrregularRows { rows: 29_998, .. }));
    }
}

#[test]
fn rounding_of_the_times_is_no_unevenness() {
    let steps = 100_000;
    let product: Vec<f64> = (0..=steps).map(|k| f64::from(k) * 1e-3).collect();
    let quotient: Vec<f64> = (0..=steps).map(|k| f64::from(k) / 1e3).collect();
    let sum: Vec<f64> = std::iter::successors(Some(0.0), |t| Some(t + 1e-3)).take(product.len()).collect();
    let printed: Vec<f64> = (0..=steps).map(|k| format!("{:.11}", f64::from(k) / 30.0).parse().unwrap()).collect();
    let offset_free = [product, quotient, sum, printed];
    for t in &offset_free {
        let prefix = Samples { t, x: t, rate: None }.uniform_prefix();
        assert_eq!(prefix.rows, t.len());
        assert!((prefix.step / (t[t.len() - 1] / f64::from(steps)) - 1.0).abs() < 1e-12);
    }
    // A drift that no single step shows is seen: 5000 steps a little short, 5000 a little long.
    let bent: Vec<f64> = (0..=10_000).map(|k| f64::from(k) + 4e-10 * f64::from((k - 5000i32).abs() - 5000)).collect();
    let prefix = Samples { t: &bent, x: &bent, rate: None }.uniform_prefix();
    assert!((1000..5000).contains(&prefix.rows), "{}", prefix.rows);
}

#[test]
fn schemes_built_by_hand_are_checked_too() {
    let t = [0.0, 1.0];
    for (scheme, error) in [
        (Scheme::Fbdf(0), SchemeNameError::Order(0)),
        (Scheme::Fbdf(9), SchemeNameError::Order(9)),
        (Scheme::ShortGrunwaldLetnikov(1), SchemeNameError::Memory(1)),
        (Scheme::Expansion2004(1), SchemeNameError::Terms { form: 2004, terms: 1, min: 2, max: 5000 }),
        (Scheme::Expansion2008(0), SchemeNameError::Terms { form: 2008, terms: 0, min: 1, max: 5000 }),
    ] {
        assert_eq!(refusal(scheme, &t, &t, None, 0.5), SchemeError::Scheme(error));
    }
}
