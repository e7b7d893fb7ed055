//! The leaf whose force a text says, against the leaves that it can be written for.

use crate::{along, slider};
use springpot::law::{Catalog, Derivative, Network, NetworkText};

/// A network of these values, in the order in which its parameters are named.
fn network(text: &str, values: &[f64]) -> Network {
    NetworkText::parse(text).unwrap().entry().build(values, Derivative::Caputo).unwrap()
}

/// Networks, the same with expressions, and their values.
const PAIRS: [(&str, &str, &[f64]); 10] = [
    ("spring(k)", "expression(\"k*x\", k)", &[300.0]),
    ("polynomial(a, b, c)", "expression(\"a*x + b*x^2 + c*x^3\", a, b, c)", &[20.0, -300.0, 9e4]),
    ("parallel(spring(k), dashpot(c))", "expression(\"k*x + c*v\", k, c)", &[300.0, 5.0]),
    ("parallel(spring(k), friction(f, s))", "expression('k*x + f*tanh(v/s)', k, f, s)", &[300.0, 2.0, 0.02]),
    ("tension(k)", "expression(\"max(k*x, 0)\", k)", &[300.0]),
    ("stop(k, a, b)", "expression(\"k*(max(x - b, 0) + min(x - a, 0))\", k, a, b)", &[5e3, -0.02, 0.013]),
    ("preload(f)", "expression(\"f\", f)", &[3.0]),
    ("parallel(spring(k), preload(f))", "parallel(spring(k), expression(\"f + 0*x\", f))", &[300.0, 3.0]),
    (
        "series(polynomial(a, b, c), springpot(d, alpha))",
        "series(expression(\"a*x + b*x^2 + c*x^3\", a, b, c), springpot(d, alpha))",
        &[80.0, 30.0, 9e3, 20.0, 0.4],
    ),
    (
        "series(dashpot(c), springpot(d, alpha))",
        "series(expression(\"c*v\", c), springpot(d, alpha))",
        &[5.0, 20.0, 0.4],
    ),
];

#[test]
fn laws_that_a_text_says_are_those_laws() {
    for motion in ["0.05*sin(9*t)", "0.04*min(max((t - 0.3)/0.05, 0), 1)", "0.1*t - 0.03"] {
        for (leaf, text, values) in PAIRS {
            let laws = [network(leaf, values), network(text, values)];
            let run = slider(&laws, &along(motion), 1.0, 50, 1e-9);
            for quantity in ["force", "stored", "dissipated"] {
                let [own, other] = [0, 1].map(|k| run.column(&format!("e{k}.{quantity}")));
                let size = own.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
                let has_rate = text.contains('v');
                let is_unknown = quantity != "force" && has_rate;
                for (own, other) in own.iter().zip(&other) {
                    if is_unknown {
                        assert!(other.is_nan(), "{quantity} of {text} along {motion}: {other}");
                        continue;
                    }
                    assert!((own - other).abs() <= 1e-12 * size, "{quantity} of {text} along {motion}: {own} {other}");
                }
            }
        }
    }
}

#[test]
fn parameters_go_by_their_names() {
    let text = NetworkText::parse("parallel(expression(f), spring(k), one: expression('a*x', a))").unwrap();
    assert_eq!(text.texts().collect::<Vec<_>>(), ["f"]);
    assert_eq!(text.open().collect::<Vec<_>>(), ["a"]);
    assert!(text.clone().entry().build(&[1.0, 2.0], Derivative::Caputo).is_err());
    let text = text.with_text("f", "k*x^3 + b").unwrap().with_unit("b", "N").with_unit("k", "kg");
    let entry = text.entry();
    let named: Vec<_> = entry.params.iter().map(|param| (&*param.name, &*param.unit)).collect();
    assert_eq!(named, [("k", "N/m"), ("a", ""), ("b", "N")]);
    let law = entry.build(&[300.0, 4.0, 2.0], Derivative::Caputo).unwrap();
    assert_eq!(law.leaf_names(), ["expression1", "spring1", "one"]);
}

#[test]
fn what_is_no_law_is_refused() {
    let words = |text: &str| NetworkText::parse(text).unwrap_err().to_string();
    for (text, wanted) in [
        ("expression(\"k*x\")", "`k` is not named behind the expression"),
        ("expression(\"k*x\", k, b)", "`b` does not occur"),
        ("expression(\"k*x\", k, k)", "named twice"),
        ("expression(\"k*x\", k, x)", "`x` is no parameter"),
        ("expression(\"k*x*pi\", k, pi)", "every expression knows it"),
        ("expression(\"k*x, k)", "never closed"),
        ("expression(\"k*x*t\", k)", "`t` has no place here"),
        ("expression(\"k*x(2)\", k)", "`(` stands where an operator"),
        ("expression(f, k)", "takes 1 name, not 2"),
        ("parallel(spring(f), expression(f))", "an expression here, but a number before"),
        ("parallel(expression(f), spring(f))", "a number here, but an expression before"),
        ("parallel(table(f), expression(f))", "an expression here, but a file before"),
        ("parallel(expression(f), expression(\"f*x\", f))", "a number here, but an expression before"),
    ] {
        assert!(words(text).contains(wanted), "{text}: {}", words(text));
    }
    let series = |text: &str, values: &[f64]| {
        NetworkText::parse(&format!("series(expression({text}), springpot(c, alpha))"))
            .unwrap()
            .entry()
            .build(values, Derivative::Caputo)
    };
    assert!(series("\"k*sinh(x/d)\", k, d", &[3.0, 0.1, 2.0, 0.5]).is_ok());
    for (text, values) in
        [("\"k*x - b*x^3\", k, b", [3.0, 1.0, 2.0, 0.5]), ("\"k*sin(x/d)\", k, d", [3.0, 0.1, 2.0, 0.5])]
    {
        assert!(series(text, &values).unwrap_err().rule.contains("does not hold at times"), "{text}");
    }
    // What rests is what it is at no rate.
    let law = network("expression(\"k*x + c*v\", k, c)", &[300.0, 5.0]);
    let kelvin = Catalog::standard().get("kelvin-voigt").unwrap().build(&[300.0, 5.0], Derivative::Caputo).unwrap();
    let at = springpot::law::Point { t: 0.0, stroke: 0.01, rate: 0.0, inputs: &[] };
    for omega in [0.0, 3.0, 70.0] {
        assert_eq!(law.complex_modulus(&at, omega), kelvin.complex_modulus(&at, omega));
    }
}
