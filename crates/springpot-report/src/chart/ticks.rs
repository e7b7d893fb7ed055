//! Where an axis has its ticks and what stands beside them.

/// The ticks of one axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    pub(super) values: Vec<f64>,
    pub(super) labels: Vec<String>,
    /// What the labels leave out, such as "×10⁻⁶" or "+ 1000.2"; stands once at the end of the axis.
    pub(super) factor: Option<String>,
    /// Places without labels in between.
    pub(super) minor: Vec<f64>,
}

/// Labels with more significant digits than this leave an offset out; those of larger numbers than 10 to this leave a power of ten
/// out.
const MOST_DIGITS: i32 = 5;

impl Ticks {
    /// Ticks in [lo, hi], lo < hi, at multiples of 1, 2 or 5 times a power of ten: at least two, and at most `most` or five.
    pub(super) fn new(lo: f64, hi: f64, most: usize) -> Self {
        let mut step = Step::above((hi - lo) / (3 * most.max(2)) as f64);
        let (mut first, mut last) = step.inside(lo, hi);
        // A coarser step that leaves a single tick helps nobody.
        while last - first >= most as i64 && step.next().inside(lo, hi).0 < step.next().inside(lo, hi).1 {
            step = step.next();
            (first, last) = step.inside(lo, hi);
        }
        let units: Vec<i64> = (first..=last).map(|i| i * step.mantissa).collect();
        let values: Vec<f64> = units.iter().map(|u| *u as f64 * pow10(step.exponent)).collect();
        let (labels, factor) = label(&units, step.exponent);
        Self { values, labels, factor, minor: Vec::new() }
    }

    /// Ticks of a logarithmic axis, 0 < lo < hi: powers of ten, of which at most some `most` have labels; below two decades 1, 2 and 5
    /// times these, below a third of one as on a linear axis.
    pub(super) fn logarithmic(lo: f64, hi: f64, most: usize) -> Self {
        let decades = (hi / lo).log10();
        if decades < 0.35 {
            return Self::new(lo, hi, most);
        }
        let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
        let inside = |value: &f64| *value >= lo * (1.0 - 1e-9) && *value <= hi * (1.0 + 1e-9);
        let multiples = |digits: &[f64]| -> Vec<f64> {
            let all = (first..=last).flat_map(|exponent| digits.iter().map(move |digit| digit * pow10(exponent)));
            all.filter(inside).collect()
        };
        let each: Vec<i32> = (first..=last).filter(|exponent| inside(&pow10(*exponent))).collect();
        let every = each.len().div_ceil(most.max(2)).max(1);
        let few = decades < 2.0;
        let values = if few {
            multiples(&[1.0, 2.0, 5.0])
        } else {
            each.iter().filter(|exponent| exponent.rem_euclid(every as i32) == 0).map(|k| pow10(*k)).collect()
        };
        let all_plain = first >= -3 && last <= 4;
        let label = |value: &f64| {
            if few || all_plain {
                return plain(*value);
            }
            format!("10{}", superscript(value.log10().round() as i32))
        };
        let minor = match every {
            1 if decades < 8.0 => multiples(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
            1 => Vec::new(),
            _ => each.iter().map(|exponent| pow10(*exponent)).collect(),
        };
        Self { labels: values.iter().map(label).collect(), values, factor: None, minor }
    }

    /// No ticks, for an axis without data.
    pub(super) fn none() -> Self {
        Self { values: Vec::new(), labels: Vec::new(), factor: None, minor: Vec::new() }
    }
}

/// mantissa·10^exponent.
#[derive(Clone, Copy)]
struct Step {
    mantissa: i64,
    exponent: i32,
}

impl Step {
    /// The smallest step of the family not below `size`.
    fn above(size: f64) -> Self {
        let exponent = size.log10().floor() as i32 - 1;
        let mut step = Self { mantissa: 1, exponent };
        while step.size() < size * (1.0 - 1e-9) {
            step = step.next();
        }
        step
    }

    fn next(self) -> Self {
        match self.mantissa {
            1 => Self { mantissa: 2, ..self },
            2 => Self { mantissa: 5, ..self },
            _ => Self { mantissa: 1, exponent: self.exponent + 1 },
        }
    }

    fn size(self) -> f64 {
        self.mantissa as f64 * pow10(self.exponent)
    }

    /// First and last multiple inside [lo, hi], with room for rounding.
    fn inside(self, lo: f64, hi: f64) -> (i64, i64) {
        let slack = 1e-9 * (hi - lo) / self.size();
        ((lo / self.size() - slack).ceil() as i64, (hi / self.size() + slack).floor() as i64)
    }
}

fn pow10(exponent: i32) -> f64 {
    // Parsed, not multiplied up: correctly rounded at every exponent.
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}

/// Labels of the ticks units·10^exponent and what they leave out.
fn label(units: &[i64], exponent: i32) -> (Vec<String>, Option<String>) {
    let largest = units.iter().map(|u| u.abs()).max().unwrap_or(0);
    let digits = largest.checked_ilog10().map_or(1, |d| d as i32 + 1);
    // An offset is worth it only where all ticks are far from zero.
    let nearest = units.iter().map(|u| u.abs()).min().unwrap_or(0);
    if digits > MOST_DIGITS && nearest > largest / 2 {
        let offset = roundest(units[0], units[units.len() - 1]);
        let rest: Vec<i64> = units.iter().map(|u| u - offset).collect();
        let (labels, factor) = label(&rest, exponent);
        let sign = if offset < 0 { '−' } else { '+' };
        let offset = format!("{sign} {}", plain_or_power(offset.abs(), exponent));
        return (labels, Some(factor.map_or(offset.clone(), |factor| format!("{factor} {offset}"))));
    }
    // Exponent of the leading digit of the largest tick.
    let leading = exponent + digits - 1;
    let power = if (-2..=MOST_DIGITS).contains(&leading) || largest == 0 { 0 } else { 3 * leading.div_euclid(3) };
    let labels = units.iter().map(|u| decimal(*u, exponent - power)).collect();
    (labels, (power != 0).then(|| format!("×10{}", superscript(power))))
}

/// The number with the most trailing zeros in [lo, hi].
fn roundest(lo: i64, hi: i64) -> i64 {
    let powers = (0..=18).rev().map(|zeros| 10i64.pow(zeros));
    let mut multiples = powers.map(|power| hi.div_euclid(power) * power);
    multiples.find(|multiple| *multiple >= lo).unwrap_or(lo)
}

/// units·10^exponent as a decimal number; every label of an axis gets the same number of decimals.
fn decimal(units: i64, exponent: i32) -> String {
    let sign = if units < 0 { "−" } else { "" };
    let mut digits = units.unsigned_abs().to_string();
    if exponent >= 0 {
        if units != 0 {
            digits.push_str(&"0".repeat(exponent as usize));
        }
        return format!("{sign}{digits}");
    }
    let decimals = exponent.unsigned_abs() as usize;
    let padded = format!("{digits:0>width$}", width = decimals + 1);
    let (whole, fraction) = padded.split_at(padded.len() - decimals);
    format!("{sign}{whole}.{fraction}")
}

/// A positive offset without trailing zeros, as a power of ten where it is far from one.
fn plain_or_power(mut units: i64, mut exponent: i32) -> String {
    while units != 0 && units % 10 == 0 {
        units /= 10;
        exponent += 1;
    }
    let digits = units.to_string().len() as i32;
    let leading = exponent + digits - 1;
    if (-3..=6).contains(&leading) {
        return decimal(units, exponent);
    }
    format!("{}×10{}", decimal(units, 1 - digits), superscript(leading))
}

/// A number of one digit and a power of ten.
fn plain(value: f64) -> String {
    let exponent = value.log10().floor() as i32;
    let digit = (value / pow10(exponent)).round() as i64;
    plain_or_power(digit, exponent)
}

fn superscript(number: i32) -> String {
    let digit = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        c => char::from_u32('⁴' as u32 + (c as u32 - '4' as u32)).unwrap_or(c),
    };
    number.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(lo: f64, hi: f64, most: usize) -> (String, Option<String>) {
        let ticks = Ticks::new(lo, hi, most);
        (ticks.labels.join(" "), ticks.factor)
    }

    #[test]
    fn usual_ranges() {
        assert_eq!(labels(0.0, 10.0, 6), ("0 2 4 6 8 10".into(), None));
        assert_eq!(labels(-1.3, 1.1, 6), ("−1.0 −0.5 0.0 0.5 1.0".into(), None));
        assert_eq!(labels(0.03, 0.091, 5), ("0.04 0.06 0.08".into(), None));
        assert_eq!(labels(0.0, 9000.0, 6), ("0 2000 4000 6000 8000".into(), None));
    }

    #[test]
    fn small_and_large_numbers_have_a_factor() {
        assert_eq!(labels(-3e-9, 2e-9, 6), ("−3 −2 −1 0 1 2".into(), Some("×10⁻⁹".into())));
        assert_eq!(labels(0.0, 1.1e9, 6), ("0.0 0.2 0.4 0.6 0.8 1.0".into(), Some("×10⁹".into())));
        assert_eq!(labels(0.0, 45e-4, 6), ("0 1 2 3 4".into(), Some("×10⁻³".into())));
        assert_eq!(labels(0.0, 45e12, 6), ("0 10 20 30 40".into(), Some("×10¹²".into())));
        assert_eq!(superscript(-1234567890), "⁻¹²³⁴⁵⁶⁷⁸⁹⁰");
    }

    #[test]
    fn decades() {
        let shown = |lo: f64, hi: f64| Ticks::logarithmic(lo, hi, 6).labels.join(" ");
        assert_eq!(shown(0.1, 10.0), "0.1 1 10");
        assert_eq!(shown(0.9, 30.0), "1 2 5 10 20");
        assert_eq!(shown(1e-9, 1e3), "10⁻⁹ 10⁻⁶ 10⁻³ 10⁰ 10³");
        assert_eq!(shown(1.0, 1.5), "1.0 1.1 1.2 1.3 1.4 1.5");
        assert_eq!(shown(2e5, 8e6), "200000 500000 1000000 2000000 5000000");
        assert_eq!(labels(0.0, 20000.0, 5).1, None);
        assert_eq!(labels(0.0, 2e6, 5).1, Some("×10⁶".into()));
    }

    #[test]
    fn close_numbers_have_an_offset() {
        assert_eq!(labels(1000.2, 1000.200035, 5), ("0 10 20 30".into(), Some("×10⁻⁶ + 1000.2".into())));
        assert_eq!(labels(0.99997, 1.00002, 6).1, Some("×10⁻⁶ + 1".into()));
        assert_eq!(labels(-1e9 - 2.0, -1e9 + 2.0, 5), ("−2 −1 0 1 2".into(), Some("− 1×10⁹".into())));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None,
            rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

        /// Every tick lies in the range, ticks are evenly spaced, and each label says its value to half of the last place.
        #[test]
        fn labels_say_the_values(middle in -1.0..1.0f64, scale in -290..290i32, span in -8.0..0.0f64, most in 2usize..12) {
            let (size, half) = (pow10(scale), 10f64.powf(span));
            let (lo, hi) = ((middle - half) * size, (middle + half) * size);
            let ticks = Ticks::new(lo, hi, most);
            prop_assert!((2..=most.max(5)).contains(&ticks.values.len()));
            let (power, offset) = parse_factor(ticks.factor.as_deref());
            let slack = 1e-6 * (hi - lo);
            for (value, label) in ticks.values.iter().zip(&ticks.labels) {
                prop_assert!(*value >= lo - slack && *value <= hi + slack);
                let said = label.replace('−', "-").parse::<f64>().unwrap() * power + offset;
                prop_assert!((said - value).abs() <= slack, "{label} {:?} for {value}", ticks.factor);
            }
        }
    }

    /// Reads "×10⁻³ + 1.2×10⁶" back.
    fn parse_factor(factor: Option<&str>) -> (f64, f64) {
        let Some(factor) = factor else { return (1.0, 0.0) };
        let plain: String = factor
            .replace("×10", "e")
            .chars()
            .filter(|c| *c != ' ')
            .map(|c| match c {
                '−' | '⁻' => '-',
                '¹' => '1',
                '²' => '2',
                '³' => '3',
                '⁰'..='⁹' => char::from(b'0' + (c as u32 - '⁰' as u32) as u8),
                c => c,
            })
            .collect();
        match (plain.strip_prefix('e'), factor.find(['+', '−'])) {
            (Some(power), None) => (format!("1e{power}").parse().unwrap(), 0.0),
            (Some(rest), Some(_)) => {
                let sign = rest[1..].find(['+', '-']).unwrap() + 1;
                (format!("1e{}", &rest[..sign]).parse().unwrap(), rest[sign..].parse().unwrap())
            }
            (None, _) => (1.0, plain.parse().unwrap()),
        }
    }
}
