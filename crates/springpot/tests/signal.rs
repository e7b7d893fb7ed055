//! Signals: expressions with their derivatives and kinks, samples; no panic on any text.

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use springpot::signal::expression::{MAX_DEPTH, MAX_KINKS, MAX_LENGTH};
use springpot::signal::{ColumnExpression, Expression, ExpressionError, Jet, SampleError, Signal};
use std::f64::consts::{E, PI};

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..ProptestConfig::default() }
}

fn expression(text: &str) -> Expression {
    Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

mod expressions {
    use super::*;

    #[test]
    fn values() {
        let t = 1.7_f64;
        for (text, value) in [
            ("-2^2", -4.0),
            ("(-2)^2", 4.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("2^-2^2", 0.0625),
            ("2^+2", 4.0),
            ("-sin(1)^2", -1.0_f64.sin() * 1.0_f64.sin()),
            ("1e-3", 1e-3),
            ("1e+3 + .5 + 5.", 1005.5),
            ("1 - 2 - 3", -4.0),
            ("8/4/2", 1.0),
            ("8/4*2", 4.0),
            ("2 + 3*4^2", 50.0),
            ("2--3", 5.0),
            ("2*-3", -6.0),
            ("-+-3", 3.0),
            ("\u{2212}3\u{b7}2", -6.0),
            ("pi", PI),
            ("\u{3c0}", PI),
            ("e^2", E.powf(2.0)),
            ("2*e", 2.0 * E),
            ("0^0", 1.0),
            ("t^0", 1.0),
            ("0.1*sin(8*t)", 0.1 * (8.0 * t).sin()),
            ("atan2(-1, -t)", (-1.0_f64).atan2(-t)),
            ("log(exp(t))", t.exp().ln()),
            ("sqrt(abs(-t))", t.sqrt()),
            ("min(3, t, 2)", t),
            ("max(3, t, 2)", 3.0),
            ("sign(-t) + sign(0) + sign(t)", 0.0),
            ("step(-1e-300)", 0.0),
            ("step(0)", 1.0),
            ("step(t)", 1.0),
            ("tan(t)+asin(t/2)+acos(t/2)+atan(t)", t.tan() + (t / 2.0).asin() + (t / 2.0).acos() + t.atan()),
            ("sinh(t)+cosh(t)+tanh(t)", t.sinh() + t.cosh() + t.tanh()),
        ] {
            let read = expression(text);
            assert_eq!(read.value(t), value, "{text}");
            assert_eq!(read.at(t).value, value, "{text}");
        }
    }

    #[test]
    fn value_and_jet_are_the_same_number_at_a_tie() {
        let read = expression("atan2(min(t, t), min(-t, t))");
        assert_eq!(read.at(0.0).value.to_bits(), read.value(0.0).to_bits());
    }

    #[test]
    fn numbers_are_folded() {
        for (text, constant) in [("2*pi^2 - min(1, 2)", Some(2.0 * (PI * PI) - 1.0)), ("sin(t)", None), ("0*t", None)] {
            assert_eq!(expression(text).is_constant(), constant, "{text}");
            assert_eq!(
                Signal::scaled(expression(text).into(), 2.0, 1.0).is_constant(),
                constant.map(|c| 2.0 * c + 1.0)
            );
        }
        assert!(!expression("abs(-2) + t").has_kinks());
        assert_eq!(expression(" 2*t ").source(), " 2*t ");
    }

    #[test]
    fn derivatives_where_formulas_divide_by_zero() {
        let jet = |value, first, second| Jet { value, first, second };
        for (text, t, expected) in [
            ("t^2", 0.0, jet(0.0, 0.0, 2.0)),
            ("t^1", 0.0, jet(0.0, 1.0, 0.0)),
            ("t^0", 0.0, jet(1.0, 0.0, 0.0)),
            ("t^3", 0.0, jet(0.0, 0.0, 0.0)),
            ("t^7", 0.0, jet(0.0, 0.0, 0.0)),
            ("t^1.5", 0.0, jet(0.0, 0.0, f64::INFINITY)),
            ("t^2.5", 0.0, jet(0.0, 0.0, 0.0)),
            ("(t-1)^2", 1.0, jet(0.0, 0.0, 2.0)),
            ("t^-1", -2.0, jet(-0.5, -0.25, -0.25)),
            ("(-t)^3", 2.0, jet(-8.0, -12.0, -12.0)),
            ("sqrt(max(0, t - 1))", 0.5, jet(0.0, 0.0, 0.0)),
            ("max(0, t - 1)^1.5", 0.5, jet(0.0, 0.0, 0.0)),
            ("0^t", 1.0, jet(0.0, 0.0, 0.0)),
            ("abs(1 - t)", 1.0, jet(0.0, 1.0, 0.0)),
            ("abs(t - 1)", 1.0, jet(0.0, 1.0, 0.0)),
            ("max(t, 2*t)", 0.0, jet(0.0, 2.0, 0.0)),
            ("min(t, 2*t)", 0.0, jet(0.0, 1.0, 0.0)),
            ("min(0, -t^2)", 0.0, jet(0.0, 0.0, -2.0)),
            ("tanh(t)", 400.0, jet(1.0, 0.0, 0.0)),
        ] {
            let found = expression(text).at(t);
            assert_eq!(found, expected, "{text} at {t}");
        }
        // What does not exist is not invented.
        assert!(expression("sqrt(t)").at(0.0).first.is_infinite());
        assert!(expression("1/t").value(0.0).is_infinite());
        assert!(expression("log(t)").value(-1.0).is_nan());
        assert!(expression("min(log(t), 1)").at(-1.0).value.is_nan());
        assert!(expression("max(1, log(t))").value(-1.0).is_nan());
        assert!(expression("sign(log(t))").value(-1.0).is_nan());
    }

    #[test]
    fn branches_change_where_a_kink_is() {
        for (text, kinks) in [
            ("abs(t - 0.3)", vec![0.3]),
            ("abs(0.3 - t)", vec![0.3]),
            ("max(0, 1 - abs(t))", vec![-1.0, 0.0, 1.0]),
            ("min(t, t^2)", vec![0.0, 1.0]),
            ("step(t + 0.5)*sign(t - 1.25)", vec![-0.5, 1.25]),
            ("sin(abs(t) + step(sin(3*t)))", vec![-2.0 * PI / 3.0, -PI / 3.0, 0.0, PI / 3.0, 2.0 * PI / 3.0]),
            ("atan2(t, -1)", vec![0.0]),
            ("abs(t^2 + 1)", vec![]),
        ] {
            let read = expression(text);
            assert!(read.has_kinks());
            let mut found: Vec<f64> = Vec::new();
            let grid = |i: i32| -2.5 + 5.0 * f64::from(i) / 97.0;
            for i in 0..97 {
                let (mut low, mut high) = (grid(i), grid(i + 1));
                if read.branch(low) == read.branch(high) {
                    continue;
                }
                let before = read.branch(low);
                for _ in 0..80 {
                    let middle = 0.5 * (low + high);
                    *(if read.branch(middle) == before { &mut low } else { &mut high }) = middle;
                }
                found.push(high);
            }
            assert_eq!(found.len(), kinks.len(), "{text}: {found:?}");
            for (found, kink) in found.iter().zip(kinks) {
                assert!((found - kink).abs() < 1e-15, "{text}: {found} for {kink}");
            }
        }
        assert!(!expression("sin(t)").has_kinks());
        assert_eq!(expression("sin(t)").branch(1.0), Default::default());
    }

    #[test]
    fn refusals_say_where_and_what_would_be_right() {
        for (text, marked, says) in [
            ("0.1*sn(t)", "sn", "unknown name `sn`"),
            ("0.1*sinn(t)", "sinn", "did you mean `sin`?"),
            ("ln(t)", "ln", "did you mean `log`?"),
            ("Sin(t)", "Sin", "did you mean `sin`?"),
            ("2*T", "T", "did you mean `t`?"),
            ("2*x", "x", "unknown name `x`; an expression knows t, pi, e"),
            ("3*2t", "t", "a product is written with `*`"),
            ("2(t)", "(", "a product is written with `*`"),
            ("t**2", "*", "a power is written `^`"),
            ("sin t", "sin", "`sin` takes its argument in parentheses"),
            ("t(2)", "(", "an operator"),
            ("sin()", "sin()", "`sin` takes one argument, not 0"),
            ("sin(t, 1)", "sin(t, 1)", "`sin` takes one argument, not 2"),
            ("2 + atan2(t)", "atan2(t)", "`atan2` takes two arguments, not 1"),
            ("max(t)", "max(t)", "`max` takes two or more arguments, not 1"),
            ("min()", "min()", "not 0"),
            ("(1 + (2*t)", "(", "never closed"),
            ("1 + t)", ")", "`)` stands where an operator belongs"),
            ("sin(t", "(", "never closed"),
            ("", "", "ends where a number, t, a function"),
            ("2*", "", "ends where"),
            ("2*(", "", "ends where"),
            ("1 + , 2", ",", "`,` stands where"),
            ("1, 2", ",", "stands where an operator"),
            ("t $ 2", "$", "`$` stands where"),
            ("3 + \u{1f600}", "\u{1f600}", "stands where"),
            (".", ".", "a number"),
            ("1e999*t", "1e999", "beyond the range"),
            ("2*1e+t", "e", "stands where"),
        ] {
            let error = Expression::parse(text).expect_err(text);
            let place = &text[error.span().unwrap()];
            assert!(error.to_string().contains(says), "{text}: {error}");
            assert_eq!(place, marked, "{text}: {error}");
        }
    }

    #[test]
    fn limits() {
        let parse = |text: String| Expression::parse(&text);
        let nested = |n: usize| format!("{}t{}", "(".repeat(n), ")".repeat(n));
        assert!(parse(nested(MAX_DEPTH - 1)).is_ok());
        assert!(matches!(parse(nested(MAX_DEPTH)), Err(ExpressionError::TooDeep { .. })));
        assert!(matches!(parse("-".repeat(MAX_LENGTH)), Err(ExpressionError::TooDeep { .. })));
        assert!(matches!(parse("t^".repeat(100) + "t"), Err(ExpressionError::TooDeep { .. })));
        assert!(matches!(parse("t+(".repeat(40) + "t" + &")".repeat(40)), Err(ExpressionError::TooDeep { .. })));
        let half = MAX_LENGTH / 2;
        assert!(parse("t+".repeat(half - 1) + "t").is_ok());
        assert!(matches!(parse("t+".repeat(half) + "t"), Err(ExpressionError::TooLong { limit: MAX_LENGTH, .. })));
        // A name that fills the whole text is shown in part.
        let unknown = parse("x".repeat(MAX_LENGTH)).unwrap_err();
        assert!(matches!(unknown, ExpressionError::UnknownName { ref at, .. } if *at == (0..MAX_LENGTH)));
        assert!(unknown.to_string().len() < 5000);
        // Of time there may be any number of kinks; of columns as many as fit into one word.
        let many = parse("abs(t)+".repeat(10 * MAX_KINKS) + "t").unwrap();
        assert_eq!((many.branch(-1.0).below().count(), many.branch(1.0).below().count()), (10 * MAX_KINKS, 0));
        let of_columns = |count| ColumnExpression::parse(&("abs(q.x)+".repeat(count) + "t"), &[], &["t", "q.x"]);
        assert!(of_columns(MAX_KINKS).is_ok());
        assert!(matches!(of_columns(MAX_KINKS + 1), Err(ExpressionError::TooManyKinks { .. })));
    }

    /// Well-formed expressions, with every function and operator.
    fn trees() -> impl Strategy<Value = String> {
        let leaf = prop_oneof![
            3 => Just("t".to_owned()),
            1 => (0.1..3.0_f64).prop_map(|x| format!("{x}")),
            1 => prop::sample::select(vec!["pi", "e", "2", "1e-1"]).prop_map(str::to_owned),
        ];
        leaf.prop_recursive(4, 20, 2, |inner| {
            let functions = vec![
                "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs",
                "sign", "step", "-",
            ];
            let operators = vec!["+", "-", "*", "/", "^"];
            prop_oneof![
                (prop::sample::select(functions), inner.clone()).prop_map(|(f, a)| format!("({f}({a}))")),
                (inner.clone(), prop::sample::select(operators), inner.clone())
                    .prop_map(|(a, op, b)| format!("({a}){op}({b})")),
                (prop::sample::select(vec!["min", "max", "atan2"]), inner.clone(), inner)
                    .prop_map(|(f, a, b)| format!("{f}({a}, {b})")),
            ]
        })
    }

    fn texts() -> impl Strategy<Value = String> {
        let fragments = vec![
            "t",
            "2",
            "1e",
            "1e-3",
            ".",
            "+",
            "-",
            "*",
            "/",
            "^",
            "(",
            ")",
            ",",
            "sin",
            "(",
            "max(",
            "atan2(",
            "pi",
            "e",
            " ",
            "\u{2212}",
            "\u{b7}",
            "abs(",
            "x",
            "_",
            "\u{0}",
            "\u{1f600}",
            "step(t",
            "^t",
            "99999999999",
        ];
        let pieces = prop::collection::vec(prop::sample::select(fragments), 0..40).prop_map(|pieces| pieces.concat());
        let mutated = (trees(), any::<prop::sample::Index>(), any::<char>()).prop_map(|(text, index, c)| {
            let mut characters: Vec<char> = text.chars().collect();
            let at = index.index(characters.len());
            characters[at] = c;
            characters.into_iter().collect()
        });
        prop_oneof![any::<String>(), pieces, mutated, trees()]
    }

    fn never_panics(cases: u32) {
        let mut runner = TestRunner::new(config(cases));
        let outcome = runner.run(&(texts(), any::<f64>()), |(text, t)| {
            match Expression::parse(&text) {
                Ok(read) => {
                    for t in [t, 0.0, -1.0, 0.5] {
                        let (jet, value) = (read.at(t), read.value(t));
                        prop_assert!(
                            jet.value.to_bits() == value.to_bits() || (jet.value.is_nan() && value.is_nan()),
                            "{text} at {t}"
                        );
                        read.branch(t);
                    }
                }
                Err(error) => {
                    let span = error.span().unwrap_or_default();
                    prop_assert!(text.get(span).is_some() && !error.to_string().is_empty());
                }
            }
            Ok(())
        });
        if let Err(error) = outcome {
            panic!("{error}");
        }
    }

    #[test]
    fn never_panics_on_any_text() {
        never_panics(10_000);
    }

    #[test]
    #[ignore = "a minute"]
    fn never_panics_on_a_million_texts() {
        never_panics(1_000_000);
    }

    /// Fourth-order central differences of the values and of the first derivatives, where the two steps agree.
    #[test]
    fn derivatives_agree_with_differences() {
        let (compared, unknown) = (std::cell::Cell::new(0_u32), std::cell::Cell::new(0_u32));
        let mut runner = TestRunner::new(config(10_000));
        let difference = |f: &dyn Fn(f64) -> f64, t: f64, h: f64| {
            (8.0 * (f(t + h) - f(t - h)) - (f(t + 2.0 * h) - f(t - 2.0 * h))) / (12.0 * h)
        };
        let outcome = runner.run(&(trees(), 0.05..2.0_f64), |(text, t)| {
            let read = expression(&text);
            let jet = read.at(t);
            let value = |t: f64| read.value(t);
            let first = |t: f64| read.at(t).first;
            for (f, exact) in [(&value as &dyn Fn(f64) -> f64, jet.first), (&first, jet.second)] {
                let h = 1e-4;
                let near = |i: i32| t + h * f64::from(i);
                let sizes: f64 = (-4..=4).map(|i| f(near(i)).abs()).sum();
                let same_branch = (-4..=4).all(|i| read.branch(near(i)) == read.branch(t));
                let (coarse, fine) = (difference(f, t, 2.0 * h), difference(f, t, h));
                let noise = 1e-11 * sizes / h;
                // Near a singularity the differences know nothing; then they do not agree with one another either.
                let trusted = (coarse - fine).abs() <= 1e-7 * (fine.abs() + 1.0) && noise < 1e-3 * (fine.abs() + 1.0);
                // 1/(t/(t - t)) is zero, but an infinity on the way leaves its derivative unknown.
                if exact.is_nan() && sizes.is_finite() {
                    unknown.set(unknown.get() + 1);
                } else if same_branch && trusted && sizes.is_finite() {
                    compared.set(compared.get() + 1);
                    prop_assert!(
                        (exact - fine).abs() <= 1e-6 * (fine.abs() + 1.0) + noise,
                        "{text} at {t}: {exact} not {fine}"
                    );
                }
            }
            Ok(())
        });
        if let Err(error) = outcome {
            panic!("{error}");
        }
        println!("{} derivatives compared, {} unknown", compared.get(), unknown.get());
        assert!(unknown.get() < 20, "{} derivatives are NaN where the function is finite", unknown.get());
        assert!(compared.get() > 10_000, "only {} derivatives could be compared", compared.get());
    }
}

mod samples {
    use super::*;

    /// Uneven, increasing times on [0, 2].
    fn uneven(n: usize) -> Vec<f64> {
        let map = |s: f64| 2.0 * (s + 0.12 * (2.0 * PI * s).sin());
        (0..n).map(|i| map(i as f64 / (n - 1) as f64)).collect()
    }

    fn sampled(times: &[f64], f: impl Fn(f64) -> f64) -> Vec<f64> {
        times.iter().map(|&t| f(t)).collect()
    }

    #[test]
    fn splines_reproduce_polynomials() {
        for (n, degree) in [(2, 1), (3, 2), (4, 3), (5, 3), (12, 3)] {
            let coefficients = [0.3, -1.1, 0.7, 2.3];
            let c: Vec<f64> = (0..4).map(|k| if k <= degree { coefficients[k] } else { 0.0 }).collect();
            let times = uneven(n);
            let spline =
                Signal::spline(&times, &sampled(&times, |t| c[0] + t * (c[1] + t * (c[2] + t * c[3])))).unwrap();
            for i in -5..=55 {
                // A little beyond the ends too: the last polynomials go on.
                let t = 2.0 * f64::from(i) / 50.0;
                let jet = spline.at(t);
                let exact = Jet {
                    value: c[0] + t * (c[1] + t * (c[2] + t * c[3])),
                    first: c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]),
                    second: 2.0 * c[2] + 6.0 * t * c[3],
                };
                assert!((jet.value - exact.value).abs() < 1e-12, "{n} samples at {t}");
                assert!((jet.first - exact.first).abs() < 1e-11, "{n} samples at {t}");
                assert!((jet.second - exact.second).abs() < 1e-10, "{n} samples at {t}");
            }
        }
    }

    #[test]
    fn a_spline_is_twice_differentiable_and_meets_its_samples() {
        let times = uneven(23);
        let values = sampled(&times, |t| (5.0 * t).sin() * (1.0 + t));
        let spline = Signal::spline(&times, &values).unwrap();
        for (i, (&t, &value)) in times.iter().zip(&values).enumerate() {
            assert_eq!(spline.value(t), value);
            if 0 < i && i < 22 {
                let (left, right) = (spline.at(t.next_down()), spline.at(t));
                assert!((left.first - right.first).abs() < 1e-12 && (left.second - right.second).abs() < 1e-10);
            }
        }
        assert_eq!(spline.break_points(), &times[2..21]);
        assert_eq!(spline.domain(), Some((0.0, 2.0)));
    }

    #[test]
    fn order_of_convergence() {
        let f = |t: f64| Jet { value: (3.0 * t).sin(), first: 3.0 * (3.0 * t).cos(), second: -9.0 * (3.0 * t).sin() };
        let errors = |n: usize, linear: bool| {
            let times = uneven(n);
            let values = sampled(&times, |t| f(t).value);
            let make = if linear { Signal::linear } else { Signal::spline };
            let signal = make(&times, &values).unwrap();
            (0..=16_000).map(|i| f64::from(i) / 8000.0).fold([0.0_f64; 3], |[a, b, c], t| {
                let (found, exact) = (signal.at(t), f(t));
                let difference = |x: f64, y: f64| (x - y).abs();
                [
                    a.max(difference(found.value, exact.value)),
                    b.max(difference(found.first, exact.first)),
                    c.max(difference(found.second, exact.second)),
                ]
            })
        };
        let orders = |linear: bool| {
            let (coarse, fine) = (errors(401, linear), errors(801, linear));
            std::array::from_fn::<f64, 3, _>(|k| (coarse[k] / fine[k]).log2())
        };
        let [value, first, second] = orders(false);
        println!("spline: measured orders {value:.2} {first:.2} {second:.2}");
        assert!((value - 4.0).abs() < 0.15 && (first - 3.0).abs() < 0.15 && (second - 2.0).abs() < 0.15);
        let [value, first, _] = orders(true);
        println!("lines: measured orders {value:.2} {first:.2}");
        assert!((value - 2.0).abs() < 0.1 && (first - 1.0).abs() < 0.1);
    }

    #[test]
    fn straight_lines() {
        let lines = Signal::linear(&[0.0, 1.0, 3.0], &[1.0, 3.0, -1.0]).unwrap();
        for (t, value, first) in
            [(0.0, 1.0, 2.0), (0.5, 2.0, 2.0), (1.0, 3.0, -2.0), (3.0, -1.0, -2.0), (4.0, -3.0, -2.0)]
        {
            assert_eq!(lines.at(t), Jet { value, first, second: 0.0 });
        }
        assert_eq!((lines.break_points(), lines.domain()), (&[1.0][..], Some((0.0, 3.0))));
        let scaled = Signal::scaled(Signal::scaled(lines, 2.0, 1.0), -3.0, 10.0);
        assert_eq!(scaled.at(0.5), Jet { value: -5.0, first: -12.0, second: 0.0 });
        assert_eq!(scaled.value(0.5), -5.0);
        assert_eq!((scaled.break_points(), scaled.is_constant()), (&[1.0][..], None));
        assert_eq!(Signal::scaled(Signal::constant(25.0), 1.0, 273.15).is_constant(), Some(298.15));
    }

    #[test]
    fn bad_samples() {
        let refused = |times: &[f64], values: &[f64]| Signal::spline(times, values).unwrap_err();
        assert_eq!(refused(&[0.0, 1.0], &[0.0]), SampleError::LengthMismatch { times: 2, values: 1 });
        assert_eq!(refused(&[0.0], &[0.0]), SampleError::TooFew { given: 1 });
        let late = SampleError::NotIncreasing { index: 2, time: 1.0, before: 1.0 };
        assert_eq!(refused(&[0.0, 1.0, 1.0], &[0.0; 3]), late);
        assert!(matches!(refused(&[0.0, f64::NAN], &[0.0; 2]), SampleError::NotFinite { index: 1, .. }));
        assert!(matches!(refused(&[0.0, 1.0], &[f64::INFINITY, 0.0]), SampleError::NotFinite { index: 0, .. }));
        assert!(Signal::linear(&[], &[]).is_err());
    }
}
