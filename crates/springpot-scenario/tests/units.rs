//! Quantities: exact factors, dimensions, what is refused and how, and no panic on any text.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use springpot_scenario::units::{Dimension, MAX_LENGTH, Unit, UnitError, parse_quantity, split_quantity};

fn alpha(name: &str) -> Option<f64> {
    match name {
        "alpha" => Some(0.3),
        "beta_2" => Some(1.0),
        "broken" => Some(f64::NAN),
        _ => None,
    }
}

fn si(text: &str, expected: &str) -> Result<f64, UnitError> {
    parse_quantity(text, expected, &alpha)
}

fn unit(text: &str) -> Unit {
    Unit::parse(text, &alpha).unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn factors_are_exact() {
    for (text, expected, value) in [
        ("70 cm", "m", 0.7),
        ("70cm", "m", 0.7),
        ("1 ms", "s", 0.001),
        ("0.1 cm", "m", 0.001),
        ("1.1 mm", "m", 0.0011),
        ("123456789.123456789 um", "m", 123.456_789_123_456_79),
        ("3 \u{b5}m", "m", 3e-6),
        ("3 \u{3bc}m", "m", 3e-6),
        ("20 N/cm", "N/m", 2000.0),
        ("1 N*cm/mm^2", "Pa*m", 1e4),
        ("30 min", "s", 1800.0),
        ("1.1 min", "s", 66.0),
        ("0.1 h", "s", 360.0),
        ("36 km/h", "m/s", 10.0),
        ("0.1 km/h", "m/s", 1.0 / 36.0),
        ("0.05 mm/min", "m/s", 1.0 / 1_200_000.0),
        ("1 m/min^2", "m/s^2", 1.0 / 3600.0),
        ("25 degC", "K", 298.15),
        ("-40 degF", "K", 233.15),
        ("212 degF", "K", 373.15),
        ("0 degF", "K", 45967.0 / 180.0),
        ("20.1 degC", "K", 293.25),
        ("25 (degC)", "K", 298.15),
        ("0.7 mm/degC", "m/K", 0.0007),
        ("0.0007 m/K", "m/K", 0.0007),
        ("1 m/degF", "m/K", 1.8),
        ("1 degC^1", "K", 1.0),
        ("180 deg", "", std::f64::consts::PI),
        ("180 deg", "rad", std::f64::consts::PI),
        ("90 deg", "rad", std::f64::consts::FRAC_PI_2),
        ("60 deg", "rad", std::f64::consts::FRAC_PI_3),
        ("30 deg", "rad", std::f64::consts::FRAC_PI_6),
        ("30 %", "", 0.3),
        ("30%", "", 0.3),
        ("5 1/s", "1/s", 5.0),
        ("5 1", "", 5.0),
        ("60 Hz", "1/s", 60.0),
        ("2 g", "kg", 0.002),
        ("2 kg", "kg", 2.0),
        ("1 g*cm^2", "kg*m^2", 1e-7),
        ("4.7 kohm", "ohm", 4700.0),
        ("47 pF", "F", 47e-12),
        ("3 mJ", "N*m", 0.003),
        ("2 GPa", "N/m^2", 2e9),
        ("1 C", "A*s", 1.0),
        ("5 V\u{b7}A", "W", 5.0),
        ("+3 mm", "m", 0.003),
        ("-3 mm", "m", -0.003),
        ("\u{2212}3 mm", "m", -0.003),
        (" 5e-3\u{a0}m ", "m", 0.005),
        ("1e3 mm", "m", 1.0),
        ("60", "m", 60.0),
        ("-1e-3", "m", -0.001),
        ("1e-320 km", "m", 1e-317),
        ("1e310 pm", "m", 1e298),
    ] {
        assert_eq!(si(text, expected), Ok(value), "{text}");
    }
}

#[test]
fn every_power_of_ten_is_correctly_rounded() {
    for (prefix, power) in
        [("p", -12), ("n", -9), ("u", -6), ("m", -3), ("c", -2), ("", 0), ("k", 3), ("M", 6), ("G", 9)]
    {
        for number in ["1", "0.1", "0.7", "3.3", "123.456", "9.87654321e-7", "299792458", "0.30000000000000004"] {
            let shifted: f64 = match number.split_once('e') {
                Some((digits, e)) => format!("{digits}e{}", e.parse::<i32>().unwrap() + power).parse().unwrap(),
                None => format!("{number}e{power}").parse().unwrap(),
            };
            assert_eq!(si(&format!("{number} {prefix}N"), "N"), Ok(shifted), "{number} {prefix}N");
        }
    }
}

#[test]
fn structure_of_units() {
    let sum = |a: f64, b: f64| (a - b).abs() <= 1e-15 * b.abs();
    // Left to right: (N/m)*s.
    assert_eq!(si("5 N/m*s", "N*s/m"), Ok(5.0));
    assert_eq!(si("5 N/(m/s)", "N*s/m"), Ok(5.0));
    assert_eq!(si("5 kN / ( cm * s )", "N/m/s"), Ok(500_000.0));
    assert_eq!(si("5 (N/cm)^2", "N^2/m^2"), Ok(50_000.0));
    assert_eq!(si("5 m^-1", "1/m"), Ok(5.0));
    assert_eq!(si("5 cm^(-1)", "1/m"), Ok(500.0));
    assert_eq!(si("5 s^1/2", "s^0.5"), Ok(5.0));
    assert_eq!(si("5 s^(1/2)", "s^0.5"), Ok(5.0));
    assert_eq!(si("5 s^+0.5", "s^(1/2)"), Ok(5.0));
    assert_eq!(si("5 s^(3/2)/m^2/1", "s^1.5/m^2"), Ok(5.0));
    assert_eq!(si("5 s^(-alpha)", "1/s^0.3"), Ok(5.0));
    // Exponents named by the law.
    assert_eq!(si("50 N*s^alpha/m", "N*s^alpha/m"), Ok(50.0));
    assert_eq!(si("50 N*s^0.3/m", "N*s^alpha/m"), Ok(50.0));
    assert_eq!(si("50 N*s^(3/10)/m", "N*s^alpha/m"), Ok(50.0));
    assert_eq!(si("50 N*s/m", "N*s^beta_2/m"), Ok(50.0));
    assert_eq!(si("0.5 N*s^alpha/cm", "N*s^alpha/m"), Ok(50.0));
    assert!(sum(si("50 N*ms^alpha/m", "N*s^alpha/m").unwrap(), 50.0 * 0.001_f64.powf(0.3)));
    assert!(sum(si("1 min^(1/2)", "s^0.5").unwrap(), 60.0_f64.sqrt()));
    assert!(sum(si("1 min^(-1/2)", "s^-0.5").unwrap(), 1.0 / 60.0_f64.sqrt()));
    // A power of ten stays exact through a root.
    assert_eq!(si("7 um^(1/3)", "m^(1/3)"), Ok(0.07));
    assert!(matches!(si("50 N*s/m", "N*s^alpha/m"), Err(UnitError::WrongDimension { .. })));
}

#[test]
fn a_whole_symbol_wins() {
    assert_eq!(si("1 min", "s"), Ok(60.0));
    assert_eq!(si("1 Pa", "N/m^2"), Ok(1.0));
    assert_eq!(si("1 pA", "A"), Ok(1e-12));
    assert_eq!(si("1 m", "m"), Ok(1.0));
    assert_eq!(si("1 mm", "m"), Ok(1e-3));
    for none in ["mmin", "kh", "mdeg", "mdegC", "m%", "dm", "hN", "Tm", "kk", "k"] {
        assert!(Unit::parse(none, &alpha).is_err(), "{none}");
    }
}

#[test]
fn conversion_both_ways() {
    assert_eq!(unit("cm").from_si(0.7), 70.0);
    // 298.15 is no double: the nearest one is 25 degC but for half a unit in its last place.
    assert!((unit("degC").from_si(298.15) - 25.0).abs() <= 298.0 * f64::EPSILON / 2.0);
    assert_eq!(unit("deg").from_si(std::f64::consts::PI), 180.0);
    assert_eq!((unit("degC").scale(), unit("degC").shift()), (1.0, 273.15));
    assert_eq!((unit("mm/min").scale(), unit("N").shift()), (1e-3 / 60.0, 0.0));
    assert!(unit("degF").is_affine() && !unit("degF/s").is_affine() && !unit("K").is_affine());
    assert_eq!(unit("").dimension(), Dimension::NONE);
    assert_eq!(unit(" N*cm ").to_string(), "N*cm");
    for special in [f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        assert_eq!(unit("km").to_si(special), special * 1000.0);
        assert!(unit("km").to_si(f64::NAN).is_nan() && unit("degC").from_si(f64::NAN).is_nan());
    }
    assert_eq!(unit("min").to_si(f64::MIN_POSITIVE), 60.0 * f64::MIN_POSITIVE);
}

#[test]
fn what_is_a_quantity() {
    for (text, parts) in [
        ("5 mm", Some(("5", "mm"))),
        ("5mm", Some(("5", "mm"))),
        ("60", Some(("60", ""))),
        (" -1e-3 ", Some(("-1e-3", ""))),
        ("5e-3 m", Some(("5e-3", "m"))),
        ("+3 mm", Some(("+3", "mm"))),
        ("-3 mm", Some(("-3", "mm"))),
        ("2e", Some(("2", "e"))),
        ("5 t", Some(("5", "t"))),
        ("2 sin(t)", Some(("2", "sin(t)"))),
        ("20 (N*s)/m", Some(("20", "(N*s)/m"))),
        ("30%", Some(("30", "%"))),
        ("5 1/s", Some(("5", "1/s"))),
        ("5 mm + 3 mm", Some(("5", "mm + 3 mm"))),
        ("5 \u{b0}C", Some(("5", "\u{b0}C"))),
        ("0.1*t", None),
        ("2 - t", None),
        ("2 + t", None),
        ("2^t", None),
        ("1/2", None),
        ("1/s", None),
        ("2\u{b7}t", None),
        ("t", None),
        ("-t", None),
        ("- 3 mm", None),
        ("(2)", None),
        ("", None),
        ("nan", None),
        ("1,5 mm", None),
        ("5 3", None),
    ] {
        assert_eq!(split_quantity(text), parts, "{text}");
    }
}

/// Message and marked text of an error.
fn complaint(text: &str, expected: &str) -> (String, String) {
    let error = si(text, expected).expect_err(text);
    let span = error.span().unwrap_or(0..text.len());
    (error.to_string(), text[span].to_owned())
}

#[test]
fn refusals_say_where_and_what_would_be_right() {
    for (text, expected, marked, says) in [
        ("5 furlong", "m", "furlong", "unknown unit `furlong`"),
        ("5 Nm", "N*m", "Nm", "did you mean `N*m`?"),
        ("5 m/s2", "m/s^2", "s2", "did you mean `s^2`?"),
        ("5 m\u{b2}", "m^2", "m\u{b2}", "did you mean `m^2`?"),
        ("25 \u{b0}C", "K", "\u{b0}C", "did you mean `degC`?"),
        ("25 kn", "N", "kn", "did you mean `kN`?"),
        ("5 s", "N", "s", "`s` does not fit: this place takes `N`"),
        ("5 N*s/m", "N*s^alpha/m", "N*s/m", "`N*s^alpha/m` (that is N*s^0.3/m)"),
        ("5 m", "", "m", "takes a pure number"),
        ("5 t", "m", "t", "`t` is no unit; in an expression write every product out, as in `2*t`"),
        ("2e", "m", "e", "`e` is no unit"),
        ("2 sin(t)", "m", "sin", "`sin` is no unit"),
        ("5 s^gamma", "s", "gamma", "`gamma` is not a known exponent"),
        ("5 s^broken", "s", "broken", "cannot be an exponent"),
        ("5 s^1/0", "s", "1/0", "cannot be an exponent"),
        ("5 s^1.2.3", "s", "1.2.3", "cannot be an exponent"),
        ("5 s^1000", "s", "1000", "cannot be an exponent"),
        ("5 s^", "s", "", "the text ends where an exponent belongs"),
        ("5 N m", "N*m", "m", "`m` stands where one of * · / or the end belongs"),
        ("5 mm + 3 mm", "m", "+", "`+` stands where"),
        ("5 N/", "N", "", "the text ends where a unit belongs"),
        ("5 (N/m", "N/m", "", "the text ends where a closing parenthesis belongs"),
        ("5 N)", "N", ")", "`)` stands where"),
        ("1,5 mm", "m", ",", "decimals are written with a point"),
        ("mm", "m", "mm", "does not start with a number"),
        ("nan", "m", "nan", "does not start with a number"),
        ("", "m", "", "does not start with a number"),
        (" 1e999 m ", "m", "1e999 m", "beyond the range"),
        ("1e308 km", "m", "1e308 km", "beyond the range"),
        ("1 Gm^99", "m^99", "Gm^99", "beyond the range"),
        ("1 (Gm^30)^99", "m", "(Gm^30)^99", "beyond the range"),
    ] {
        let (message, place) = complaint(text, expected);
        assert!(message.contains(says), "{text}: {message}");
        assert_eq!(place, marked, "{text}: {message}");
    }
    let long = format!("5 {}", "m*".repeat(MAX_LENGTH));
    assert!(matches!(si(&long, "m"), Err(UnitError::TooLong { limit: MAX_LENGTH, .. })));
    assert!(matches!(Unit::parse(&long, &alpha), Err(UnitError::TooLong { .. })));
    let deep = format!("5 {}m", "(".repeat(400));
    assert!(matches!(si(&deep, "m"), Err(UnitError::TooDeep { .. })));
    assert!(matches!(si("5 m", "m^gamma"), Err(UnitError::Expected { .. })));
}

#[test]
fn dimensions_with_real_exponents() {
    let c = unit("N*s^alpha/m").dimension();
    assert_eq!(c.to_string(), "N*s^0.3/m");
    assert!(c.agrees_with(&unit("kg*s^-1.7").dimension()));
    assert!(c.agrees_with(&unit("N*s^0.30000000005/m").dimension()));
    assert!(!c.agrees_with(&unit("N*s^0.30001/m").dimension()));
    // The unit that a dimension prints is a unit of that dimension.
    for text in
        ["J", "W", "V/m", "N*s^alpha/(m*V)", "C", "F", "ohm", "K*m/A^2", "kg/s", "kg^2", "Pa*s", "mm/degC", "1/h"]
    {
        let dimension = unit(text).dimension();
        assert!(unit(&dimension.to_string()).dimension().agrees_with(&dimension), "{text} as {dimension}");
    }
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..ProptestConfig::default() }
}

const SYMBOLS: [&str; 12] = ["m", "kg", "s", "N", "Pa", "V", "ohm", "K", "rad", "mm", "kHz", "min"];

/// A well-formed unit.
fn units() -> impl Strategy<Value = String> {
    let exponent = prop_oneof![
        3 => Just(String::new()),
        1 => (-3..=3_i32).prop_map(|n| format!("^{n}")),
        1 => (1..5_u32, 1..5_u32).prop_map(|(a, b)| format!("^({a}/{b})")),
        1 => Just("^alpha".to_owned()),
    ];
    let factor =
        (prop::sample::select(&SYMBOLS[..]), exponent).prop_map(|(symbol, exponent)| symbol.to_owned() + &exponent);
    factor.prop_recursive(3, 12, 3, |inner| {
        (inner.clone(), prop::sample::select(vec!["*", "/", " / ", "\u{b7}"]), inner, any::<bool>())
            .prop_map(|(a, op, b, group)| if group { format!("{a}{op}({b})") } else { format!("{a}{op}{b}") })
    })
}

/// Anything, and things that look like quantities, with some characters changed.
fn texts() -> impl Strategy<Value = String> {
    let fragments = vec![
        "5",
        "1e",
        "-",
        ".",
        "e9",
        " ",
        "m",
        "k",
        "s^",
        "alpha",
        "(",
        ")",
        "^",
        "*",
        "/",
        "\u{b7}",
        "1",
        "1/2",
        "deg",
        "degC",
        "%",
        "\u{b5}",
        "\u{b0}",
        "\u{2212}",
        "999999999999",
        "^-99",
        "N",
        "min",
        "\u{0}",
        "\u{1f600}",
        "t",
        ",",
    ];
    let pieces = prop::collection::vec(prop::sample::select(fragments), 0..24).prop_map(|pieces| pieces.concat());
    let mutated = (units(), any::<prop::sample::Index>(), any::<char>()).prop_map(|(unit, index, c)| {
        let mut characters: Vec<char> = format!("2.5e1 {unit}").chars().collect();
        let at = index.index(characters.len());
        characters[at] = c;
        characters.into_iter().collect()
    });
    prop_oneof![any::<String>(), pieces, mutated]
}

fn never_panics(cases: u32) {
    let mut runner = proptest::test_runner::TestRunner::new(config(cases));
    let outcome = runner.run(&(texts(), texts()), |(text, expected)| {
        if let Some((number, unit)) = split_quantity(&text) {
            prop_assert!(text.contains(number) && text.contains(unit));
        }
        for wanted in ["", "m", &expected] {
            match parse_quantity(&text, wanted, &alpha) {
                Ok(value) => prop_assert!(value.is_finite()),
                Err(error) => {
                    let span = error.span().unwrap_or_default();
                    prop_assert!(text.get(span).is_some() && !error.to_string().is_empty());
                }
            }
        }
        if let Ok(unit) = Unit::parse(&text, &alpha) {
            prop_assert!(unit.scale() > 0.0 && unit.scale().is_finite() && unit.shift().is_finite());
            prop_assert!(!unit.dimension().to_string().is_empty());
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

proptest! {
    #![proptest_config(config(10_000))]

    #[test]
    fn round_trip(text in units(), number in prop::num::f64::NORMAL.prop_filter("within the range", |x| x.abs().log10().abs() < 200.0)) {
        let unit = unit(&text);
        let back = unit.from_si(unit.to_si(number));
        prop_assert!((back - number).abs() <= 2.0 * f64::EPSILON * number.abs(), "{number} {text} came back as {back}");
        let read = parse_quantity(&format!("{number:e} {text}"), &text, &alpha);
        let direct = unit.to_si(number);
        prop_assert!((read.unwrap() - direct).abs() <= 2.0 * f64::EPSILON * direct.abs());
    }

    #[test]
    fn a_dimension_reads_back(text in units()) {
        let dimension = unit(&text).dimension();
        // Nine decimals are printed.
        let printed = unit(&dimension.to_string()).dimension();
        prop_assert!(printed.agrees_with(&dimension), "{text}: {dimension}");
    }

    #[test]
    fn products_multiply_and_powers_repeat(a in units(), b in units()) {
        let close = |x: f64, y: f64| (x - y).abs() <= 1e-14 * y.abs();
        let (ua, ub) = (unit(&a), unit(&b));
        let product = unit(&format!("({a})*({b})"));
        prop_assert!(close(product.scale(), ua.scale() * ub.scale()));
        let ratio = unit(&format!("({a})/({b})"));
        prop_assert!(close(ratio.scale(), ua.scale() / ub.scale()));
        let square = unit(&format!("({a})^2"));
        prop_assert!(close(square.scale(), ua.scale() * ua.scale()));
        let twice = unit(&format!("({a})*({a})"));
        prop_assert!(square.dimension().agrees_with(&twice.dimension()));
    }
}

/// A natural number of any size, in digits of base 2³², the lowest first.
#[derive(Clone)]
struct Natural(Vec<u32>);

impl Natural {
    /// From decimal digits.
    fn new(digits: &str) -> Self {
        digits
            .bytes()
            .fold(Self(Vec::new()), |number, digit| number.times(10).sum(&Self(vec![u32::from(digit - b'0')])))
    }

    fn times(mut self, factor: u64) -> Self {
        let mut carry = 0_u128;
        for digit in &mut self.0 {
            let product = u128::from(*digit) * u128::from(factor) + carry;
            (*digit, carry) = (product as u32, product >> 32);
        }
        while carry > 0 {
            self.0.push(carry as u32);
            carry >>= 32;
        }
        self
    }

    /// The product, digit by digit.
    fn product(&self, other: &Self) -> Self {
        other
            .0
            .iter()
            .rev()
            .fold(Self(Vec::new()), |sum, digit| sum.times(1 << 32).sum(&self.clone().times(u64::from(*digit))))
    }

    fn sum(&self, other: &Self) -> Self {
        let (mut sum, mut carry) = (Vec::new(), 0);
        for k in 0..self.0.len().max(other.0.len()) {
            let digit = |number: &Self| u64::from(number.0.get(k).copied().unwrap_or(0));
            let total = digit(self) + digit(other) + carry;
            sum.push(total as u32);
            carry = total >> 32;
        }
        sum.extend((carry > 0).then_some(carry as u32));
        Self(sum)
    }

    fn times_power(self, base: u64, exponent: i32) -> Self {
        (0..exponent.max(0)).fold(self, |number, _| number.times(base))
    }

    fn is_at_most(&self, other: &Self) -> bool {
        let (a, b) = (&self.0, &other.0);
        a.len() < b.len() || (a.len() == b.len() && a.iter().rev().le(b.iter().rev()))
    }
}

/// Whether the positive `value` is the double nearest to above·10^decimal/below, the even one of two.
fn is_nearest(value: f64, above: Natural, decimal: i32, below: u64) -> bool {
    let (mantissa, exponent) = (value.to_bits() & ((1 << 52) - 1) | 1 << 52, (value.to_bits() >> 52) as i32 - 1075);
    // Half way to the next double below, and above: (2m ∓ 1)·2^(exponent − 1).
    let scale = |number: Natural, two: i32, ten: i32| number.times_power(2, two).times_power(10, ten);
    let exact = scale(above, 1 - exponent, decimal);
    let half_way = |odd: u64| scale(Natural::new("1").times(odd).times(below), exponent - 1, -decimal);
    let (lower, upper) = (half_way(2 * mantissa - 1), half_way(2 * mantissa + 1));
    if mantissa % 2 == 0 {
        lower.is_at_most(&exact) && exact.is_at_most(&upper)
    } else {
        !exact.is_at_most(&lower) && !upper.is_at_most(&exact)
    }
}

#[test]
fn every_unit_gives_the_nearest_double() {
    const PI: (&str, i32) = ("3141592653589793238462643383279502884197169399375105820974944592", -63);
    const ONE: (&str, i32) = ("1", 0);
    // Unit, what it is in SI: numerator, denominator; and offset in hundredths.
    let mut units: Vec<(String, (&str, i32), u64, u64)> = [
        ("min", ("60", 0), 1, 0),
        ("h", ("3600", 0), 1, 0),
        ("deg", PI, 180, 0),
        ("degC", ONE, 1, 27_315),
        ("degF", ("5", 0), 9, 45_967),
        ("%", ("1", -2), 1, 0),
        ("deg/min", PI, 10_800, 0),
        ("km/h", ("10", 0), 36, 0),
        ("mm/min", ("1", -3), 60, 0),
        ("mm/degF", ("9", -3), 5, 0),
        ("kW*h", ("36", 5), 1, 0),
        ("kN/mm", ("1", 6), 1, 0),
    ]
    .map(|(text, factor, below, offset)| (text.to_owned(), factor, below, offset))
    .into();
    for (prefix, power) in
        [("p", -12), ("n", -9), ("u", -6), ("m", -3), ("c", -2), ("", 0), ("k", 3), ("M", 6), ("G", 9)]
    {
        for symbol in ["m", "g", "s", "rad", "N", "J", "W", "Pa", "Hz", "V", "A", "C", "F", "ohm", "K"] {
            let power = if symbol == "g" { power - 3 } else { power };
            units.push((format!("{prefix}{symbol}"), ("1", power), 1, 0));
        }
    }
    let mut state = 1_u64;
    let mut random = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let mut count = 0;
    for (text, (factor, power), below, offset) in units {
        let parsed = unit(&text);
        let expected = parsed.dimension().to_string();
        let affine = offset > 0;
        for _ in 0..if power == 0 || below > 1 { 4_000 } else { 400 } {
            // Up to six digits as people write them, or up to sixteen.
            let length = if random(4) > 0 { 1 + random(6) } else { 7 + random(10) };
            let digits: String = (0..length)
                .map(|k| char::from(b'0' + (if k == 0 { 1 + random(9) } else { random(10) }) as u8))
                .collect();
            let places = random(length + 2) as i32;
            let shift = if affine { 0 } else { random(9) as i32 - 4 };
            let number = format!("{digits}e{}", shift - places);
            let value = si(&format!("{number} {text}"), &expected).unwrap();
            let tens = places.max(2);
            let exact = Natural::new(&digits);
            let (exact, decimal) = if affine {
                // Offset and number in units of 10^−tens.
                let offset = Natural::new(&offset.to_string()).times_power(10, tens - 2);
                (exact.times_power(10, tens - places).sum(&offset), -tens)
            } else {
                (exact, shift - places)
            };
            let above = exact.product(&Natural::new(factor));
            assert!(!is_nearest(value.next_up(), above.clone(), decimal + power, below), "{number} {text}");
            assert!(is_nearest(value, above, decimal + power, below), "{number} {text}: {value:e}");
            if !affine {
                assert_eq!(si(&format!("-{number} {text}"), &expected), Ok(-value), "{number} {text}");
            }
            count += 1;
        }
    }
    assert!(count > 80_000, "{count}");
}
