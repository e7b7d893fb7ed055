//! Stand-ins for `scenario::units` and `crate::signal` until those land.

pub(crate) mod units {
    use std::fmt;
    use std::ops::Range;

    #[derive(Debug, Clone, PartialEq)]
    pub(crate) struct UnitError {
        message: String,
        range: Range<usize>,
    }

    impl UnitError {
        pub(crate) fn span(&self) -> Option<Range<usize>> {
            Some(self.range.clone())
        }
    }

    impl fmt::Display for UnitError {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str(&self.message)
        }
    }

    #[derive(Debug, Clone, Copy, PartialEq)]
    pub(crate) struct Unit {
        dimension: [f64; 5],
        factor: f64,
        offset: f64,
    }

    #[derive(Debug, Clone, Copy, PartialEq)]
    pub(crate) struct Dimension([f64; 5]);

    impl Dimension {
        pub(crate) fn agrees_with(&self, other: &Self) -> bool {
            (0..5).all(|i| (self.0[i] - other.0[i]).abs() < 1e-9)
        }
    }

    impl Unit {
        pub(crate) fn parse(text: &str, exponents: &dyn Fn(&str) -> Option<f64>) -> Result<Self, UnitError> {
            let mut unit = Self { dimension: [0.0; 5], factor: 1.0, offset: 0.0 };
            let mut sign = 1.0;
            for part in text.split_inclusive(['*', '/']) {
                let next = if part.ends_with('/') { -1.0 } else { 1.0 };
                let part = part.trim_end_matches(['*', '/']).trim();
                let (symbol, exponent) = part.split_once('^').unwrap_or((part, "1"));
                let fail = |message: String| UnitError { message, range: 0..text.len() };
                let exponent: f64 = exponent
                    .parse()
                    .ok()
                    .or_else(|| exponents(exponent))
                    .ok_or_else(|| fail(format!("unknown exponent {exponent:?}")))?;
                let (dimension, factor, offset) = match symbol {
                    "" | "1" => ([0.0; 5], 1.0, 0.0),
                    "%" => ([0.0; 5], 0.01, 0.0),
                    "m" => ([1.0, 0.0, 0.0, 0.0, 0.0], 1.0, 0.0),
                    "cm" => ([1.0, 0.0, 0.0, 0.0, 0.0], 0.01, 0.0),
                    "mm" => ([1.0, 0.0, 0.0, 0.0, 0.0], 0.001, 0.0),
                    "kg" => ([0.0, 1.0, 0.0, 0.0, 0.0], 1.0, 0.0),
                    "s" => ([0.0, 0.0, 1.0, 0.0, 0.0], 1.0, 0.0),
                    "ms" => ([0.0, 0.0, 1.0, 0.0, 0.0], 0.001, 0.0),
                    "K" => ([0.0, 0.0, 0.0, 1.0, 0.0], 1.0, 0.0),
                    "degC" => ([0.0, 0.0, 0.0, 1.0, 0.0], 1.0, 273.15),
                    "V" => ([0.0, 0.0, 0.0, 0.0, 1.0], 1.0, 0.0),
                    "rad" => ([0.0; 5], 1.0, 0.0),
                    "deg" => ([0.0; 5], std::f64::consts::PI / 180.0, 0.0),
                    "N" => ([1.0, 1.0, -2.0, 0.0, 0.0], 1.0, 0.0),
                    _ => return Err(fail(format!("unknown unit {symbol:?}"))),
                };
                for i in 0..5 {
                    unit.dimension[i] += sign * exponent * dimension[i];
                }
                unit.factor *= f64::powf(factor, sign * exponent);
                unit.offset = offset;
                sign = next;
            }
            Ok(unit)
        }

        pub(crate) fn to_si(self, value: f64) -> f64 {
            value * self.factor + self.offset
        }

        pub(crate) fn scale(&self) -> f64 {
            self.factor
        }

        pub(crate) fn shift(&self) -> f64 {
            self.offset
        }

        pub(crate) fn dimension(&self) -> Dimension {
            Dimension(self.dimension)
        }
    }

    pub(crate) fn split_quantity(text: &str) -> Option<(&str, &str)> {
        let text = text.trim();
        let at = text
            .char_indices()
            .find(|&(i, c)| {
                !(c.is_ascii_digit()
                    || c == '.'
                    || ((c == '-' || c == '+') && (i == 0 || text[..i].ends_with(['e', 'E'])))
                    || (matches!(c, 'e' | 'E') && text[i + 1..].starts_with(|n: char| n.is_ascii_digit() || n == '-')))
            })
            .map_or(text.len(), |(i, _)| i);
        let (number, unit) = (&text[..at], text[at..].trim());
        (number.parse::<f64>().is_ok()
            && (unit.is_empty() || unit.starts_with(|c: char| c.is_alphabetic() || c == '%')))
        .then_some((number, unit))
    }

    pub(crate) fn parse_quantity(
        text: &str,
        expected: &str,
        exponents: &dyn Fn(&str) -> Option<f64>,
    ) -> Result<f64, UnitError> {
        if let Ok(number) = text.trim().parse() {
            return Ok(number);
        }
        let fail = |message: String| UnitError { message, range: 0..text.len() };
        let (number, unit) = split_quantity(text).ok_or_else(|| fail(format!("{text:?} is not a quantity")))?;
        let unit = Unit::parse(unit, exponents)?;
        if !unit.dimension().agrees_with(&Unit::parse(expected, exponents)?.dimension()) {
            return Err(fail(format!("{text:?} has another dimension than {expected}")));
        }
        Ok(unit.to_si(number.parse().unwrap_or(f64::NAN)))
    }
}

pub(crate) mod signal {
    use crate::signal::Jet;
    use std::collections::BTreeMap;
    use std::ops::Range;
    use std::path::Path;
    use std::sync::Arc;

    #[derive(Debug, Clone, PartialEq)]
    pub(crate) struct Expression(String);

    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    #[error("{0}")]
    pub(crate) struct ExpressionError(String);

    impl ExpressionError {
        pub(crate) fn span(&self) -> Option<Range<usize>> {
            None
        }
    }

    impl Expression {
        pub(crate) fn parse(text: &str) -> Result<Self, ExpressionError> {
            if text.chars().all(|c| "0123456789.+-*/^() tsincopehx".contains(c)) && !text.is_empty() {
                Ok(Self(text.to_owned()))
            } else {
                Err(ExpressionError(format!("unknown name in {text:?}")))
            }
        }
    }

    /// A function of time.
    #[derive(Debug, Clone)]
    pub enum Signal {
        /// A number.
        Constant(f64),
        /// Text of an expression.
        Expression(String),
        /// Samples.
        Samples(Arc<[f64]>, Arc<[f64]>),
        /// Scaled.
        Scaled(Box<Signal>, f64, f64),
    }

    impl Signal {
        pub(crate) fn constant(value: f64) -> Self {
            Self::Constant(value)
        }
        pub(crate) fn expression(expression: Expression) -> Self {
            Self::Expression(expression.0)
        }
        pub(crate) fn scaled(signal: Self, scale: f64, offset: f64) -> Self {
            Self::Scaled(Box::new(signal), scale, offset)
        }
        pub(crate) fn linear(times: &[f64], values: &[f64]) -> Result<Self, String> {
            Ok(Self::Samples(times.into(), values.into()))
        }
        pub(crate) fn spline(times: &[f64], values: &[f64]) -> Result<Self, String> {
            Ok(Self::Samples(times.into(), values.into()))
        }
        /// Value and rates.
        pub fn at(&self, _t: f64) -> Jet {
            match self {
                Self::Constant(value) => Jet { value: *value, ..Jet::default() },
                Self::Expression(text) => {
                    let value = text.split(['+', '*']).next().and_then(|n| n.trim().parse().ok()).unwrap_or(0.0);
                    Jet { value, ..Jet::default() }
                }
                Self::Samples(_, values) => Jet { value: values[0], ..Jet::default() },
                Self::Scaled(signal, scale, offset) => {
                    Jet { value: signal.at(0.0).value * scale + offset, ..Jet::default() }
                }
            }
        }
    }

    #[derive(Debug)]
    pub(crate) struct CsvTable {
        headers: Vec<String>,
        columns: BTreeMap<String, Vec<f64>>,
    }

    impl CsvTable {
        pub(crate) fn read(path: &Path) -> Result<Self, String> {
            let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
            let mut lines = text.lines();
            let headers: Vec<String> = lines.next().unwrap_or("").split(',').map(str::to_owned).collect();
            let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
            for line in lines {
                for (header, cell) in headers.iter().zip(line.split(',')) {
                    let value = cell.trim().parse().map_err(|_| format!("{cell:?} is not a number"))?;
                    columns.entry(header.clone()).or_default().push(value);
                }
            }
            if !columns.contains_key("t") {
                return Err("no column t".to_owned());
            }
            Ok(Self { headers, columns })
        }
        pub(crate) fn time(&self) -> &[f64] {
            &self.columns["t"]
        }
        pub(crate) fn column(&self, name: &str) -> Option<&[f64]> {
            self.columns.get(name).map(Vec::as_slice)
        }
        pub(crate) fn headers(&self) -> &[String] {
            &self.headers
        }
    }
}
