//! Bad samples, orders and names.

use super::support::Random;
use springpot::fractional::scheme::{Samples, Scheme, SchemeError};
use springpot::fractional::{
    Definition, DerivativeError, Method, Piecewise, Stream, derivative, derivative_with_error,
};

const GOOD: [f64; 4] = [0.0, 0.1, 0.2, 0.3];

fn refused(t: &[f64], x: &[f64], rate: Option<&[f64]>, order: f64) -> DerivativeError {
    let samples = Samples { t, x, rate };
    let errors = [Method::Spline, Method::Hermite, Method::Exponential]
        .map(|method| derivative(&samples, order, Definition::Caputo, method).unwrap_err());
    errors.into_iter().next().unwrap()
}

#[test]
fn samples() {
    let samples = |t: &[f64], x: &[f64]| match refused(t, x, None, 0.5) {
        DerivativeError::Samples(error) => error,
        other => panic!("{other}"),
    };
    assert!(matches!(refused(&[], &[], None, 0.5), DerivativeError::TooShort { needed: 2, found: 0, .. }));
    assert!(matches!(refused(&[0.0], &[1.0], None, 0.5), DerivativeError::TooShort { needed: 2, found: 1, .. }));
    assert!(matches!(samples(&GOOD, &[1.0; 3]), SchemeError::Length { column: "x", .. }));
    assert!(matches!(samples(&[0.0, 0.2, 0.1], &[1.0; 3]), SchemeError::NotIncreasing { row: 2, .. }));
    assert!(matches!(samples(&[0.0, 0.1, 0.1], &[1.0; 3]), SchemeError::NotIncreasing { row: 2, .. }));
    assert!(matches!(samples(&[0.1, 0.2], &[1.0; 2]), SchemeError::Start(_)));
    assert!(matches!(samples(&[0.0, f64::NAN], &[1.0; 2]), SchemeError::NotFinite { column: "t", row: 1, .. }));
    assert!(matches!(samples(&[0.0, 1.0], &[1.0, f64::INFINITY]), SchemeError::NotFinite { column: "x", .. }));
    let rate = [1.0, f64::NAN, 0.0, 0.0];
    let error = refused(&GOOD, &GOOD, Some(&rate), 0.5);
    assert!(matches!(error, DerivativeError::Samples(SchemeError::NotFinite { column: "rate", row: 1, .. })));
}

#[test]
fn orders() {
    for order in [-2.000_001, 2.000_001, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(matches!(refused(&GOOD, &GOOD, None, order), DerivativeError::Order(_)), "{order}");
    }
    let samples = Samples { t: &GOOD, x: &GOOD, rate: None };
    for order in [-2.0, -1e-300, 1e-300, 1.0 - f64::EPSILON, 1.0 + f64::EPSILON, 2.0] {
        let y = derivative(&samples, order, Definition::Caputo, Method::Exponential).unwrap();
        assert!(y.iter().all(|y| y.is_finite()), "{order}: {y:?}");
    }
}

#[test]
fn schemes_answer_for_themselves() {
    let samples = Samples { t: &[0.0, 0.1, 0.3], x: &[0.0, 1.0, 2.0], rate: None };
    let scheme = |scheme| derivative(&samples, 0.5, Definition::Caputo, Method::Scheme(scheme));
    assert!(matches!(scheme(Scheme::GrunwaldLetnikov), Err(DerivativeError::Samples(SchemeError::NotUniform { .. }))));
    assert!(matches!(scheme(Scheme::Fbdf(6)), Err(DerivativeError::TooShort { needed: 7, found: 3, .. })));
    assert!(scheme(Scheme::L1).is_ok());
}

/// Any numbers at all: an answer or an error, never a panic.
#[test]
fn random_samples() {
    let mut random = Random(17);
    let mut answered = 0;
    for _ in 0..300 {
        let rows = (random.next() * 14.0) as usize;
        let mut wild = || match (random.next() * 40.0) as usize {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -0.0,
            3 => 10f64.powf(600.0 * random.next() - 300.0),
            _ => 10f64.powf(8.0 * random.next() - 4.0),
        };
        let mut t: Vec<f64> = (0..rows).map(|_| wild()).collect();
        let x: Vec<f64> = (0..rows).map(|_| wild()).collect();
        if let Some(first) = t.first_mut() {
            *first = 0.0;
        }
        if random.next() < 0.9 {
            t.sort_by(f64::total_cmp);
        }
        let order = 4.4 * random.next() - 2.2;
        let definition = Definition::ALL[(random.next() * 3.0) as usize];
        let samples = Samples { t: &t, x: &x, rate: None };
        for method in [Method::Spline, Method::Hermite, Method::Exponential, Method::Scheme(Scheme::L1)] {
            if let Ok(found) = derivative_with_error(&samples, order, definition, method) {
                assert_eq!((found.values.len(), found.error.len()), (rows, rows));
                answered += 1;
            }
        }
        if let Ok(mut stream) = Stream::new(order, definition) {
            for (t, x) in t.iter().zip(&x) {
                let _ = stream.push(*t, *x);
            }
            let _ = stream.finish();
        }
        if let Ok(d) = Piecewise::spline(&t, &x).map(|x| x.derivative(order, definition)) {
            let _ = d.map(|d| d.at(t[rows / 2]));
        }
    }
    assert!(answered > 200, "{answered}");
}

#[test]
fn names() {
    for name in Method::NAMES {
        let name = name.replace('N', "30");
        assert_eq!(name.parse::<Method>().unwrap().to_string(), name);
    }
    assert_eq!("exact".parse::<Method>(), Ok(Method::Exponential));
    for definition in Definition::ALL {
        assert_eq!(definition.to_string().parse::<Definition>(), Ok(definition));
        assert_eq!(serde_json::to_string(&definition).unwrap(), format!("\"{definition}\""));
    }
    let error = "splin".parse::<Method>().unwrap_err().to_string();
    assert!(
        error.contains("\"splin\"")
            && error.contains("spline, hermite, exponential, grunwald-letnikov, grunwald-letnikov(N), l1")
    );
    assert!("fbdf-9".parse::<Method>().unwrap_err().to_string().contains("1 to 6"));
    assert!("rl".parse::<Definition>().unwrap_err().to_string().contains("riemann-liouville"));
}
