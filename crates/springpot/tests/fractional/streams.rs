//! Streams give the numbers of arrays.

use super::support::{FUNCTIONS, Function, ORDERS, distance, even, of, uneven};
use springpot::fractional::scheme::Samples;
use springpot::fractional::{Definition, DerivativeError, Method, RatedStream, Row, Stream, derivative};

fn streamed(mut stream: Stream, t: &[f64], x: &[f64]) -> Vec<Row> {
    let mut rows = Vec::new();
    for (k, (t, x)) in t.iter().zip(x).enumerate() {
        rows.extend_from_slice(stream.push(*t, *x).unwrap());
        // Never more than three rows behind, once there are seven samples.
        assert!(rows.len() == if k < 6 { 0 } else { k - 2 });
    }
    rows.extend(stream.finish().unwrap());
    rows
}

#[test]
fn the_same_numbers_as_arrays() {
    let grids = [even(1000, 10.0), uneven(400, 10.0, 9)];
    for t in &grids {
        for (_, function) in &FUNCTIONS[..2] {
            let x: Vec<f64> = t.iter().map(|t| function(*t)).collect();
            for order in ORDERS {
                for definition in [Definition::Caputo, Definition::RiemannLiouville] {
                    let array = of(t, &x, order, definition, Method::Exponential);
                    let bounded = streamed(Stream::until(10.0, order, definition).unwrap(), t, &x);
                    for ((row, value), t) in bounded.iter().zip(&array).zip(t) {
                        assert!(row.t == *t && row.value.to_bits() == value.to_bits());
                    }
                    let endless = streamed(Stream::new(order, definition).unwrap(), t, &x);
                    let values: Vec<f64> = endless.iter().map(|row| row.value).collect();
                    let error = distance(&values[1..], &array[1..]);
                    assert!(error < 2e-11, "a = {order}, {definition}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn few_samples_come_at_the_end() {
    for count in 1..7 {
        let (t, x) = (even(6, 1.0)[..count].to_vec(), vec![1.0, 2.0, 0.5, 0.0, 3.0, 1.0][..count].to_vec());
        let mut stream = Stream::new(0.5, Definition::Caputo).unwrap();
        for (t, x) in t.iter().zip(&x) {
            assert!(stream.push(*t, *x).unwrap().is_empty());
        }
        let finished = stream.finish();
        if count == 1 {
            assert!(matches!(finished, Err(DerivativeError::TooShort { needed: 2, found: 1, .. })));
            continue;
        }
        let values: Vec<f64> = finished.unwrap().iter().map(|row| row.value).collect();
        assert!(distance(&values, &of(&t, &x, 0.5, Definition::Caputo, Method::Exponential)) < 1e-11, "{count}");
    }
}

#[test]
fn rates_answer_at_once() {
    let (f, v): (Function, Function) = (|t| (3.0 * t).cos(), |t| -3.0 * (3.0 * t).sin());
    for t in [even(3000, 10.0), uneven(1500, 10.0, 9)] {
        let (x, rate): (Vec<f64>, Vec<f64>) = t.iter().map(|t| (f(*t), v(*t))).unzip();
        for order in ORDERS {
            let samples = Samples { t: &t, x: &x, rate: Some(&rate) };
            let array = derivative(&samples, order, Definition::RiemannLiouville, Method::Hermite).unwrap();
            let mut stream = RatedStream::new(order, Definition::RiemannLiouville).unwrap();
            let values: Vec<f64> = (0..t.len()).map(|k| stream.push(t[k], x[k], rate[k]).unwrap()).collect();
            // Exact moments of equal steps against exponentials; second differences over 1e-5 s are rounded.
            let bound = if order > 1.0 { 1e-6 } else { 1e-11 };
            assert!(
                distance(&values[1..], &array[1..]) < bound,
                "a = {order}: {:e}",
                distance(&values[1..], &array[1..])
            );
        }
    }
}

#[test]
fn bad_samples_are_refused_and_forgotten() {
    let mut stream = Stream::until(1.0, 0.5, Definition::Caputo).unwrap();
    assert!(matches!(stream.push(0.1, 1.0), Err(DerivativeError::OutOfOrder { row: 0, .. })));
    stream.push(0.0, 1.0).unwrap();
    stream.push(0.1, 1.0).unwrap();
    assert_eq!(stream.push(0.1, 2.0), Err(DerivativeError::OutOfOrder { row: 2, t: 0.1, previous: 0.1 }));
    assert!(matches!(stream.push(0.05, 2.0), Err(DerivativeError::OutOfOrder { row: 2, .. })));
    assert!(matches!(stream.push(0.2, f64::NAN), Err(DerivativeError::NotFinite { column: "x", row: 2, .. })));
    assert!(matches!(stream.push(f64::INFINITY, 0.0), Err(DerivativeError::NotFinite { column: "t", row: 2, .. })));
    assert_eq!(stream.push(1.1, 0.0), Err(DerivativeError::Horizon { t: 1.1, horizon: 1.0 }));
    for k in 2..=10 {
        stream.push(0.1 * k as f64, 1.0).unwrap();
    }
    assert!(stream.finish().unwrap().iter().all(|row| row.value == 0.0));

    assert!(matches!(Stream::new(2.5, Definition::Caputo), Err(DerivativeError::Order(_))));
    assert!(matches!(Stream::until(0.0, 0.5, Definition::Caputo), Err(DerivativeError::Horizon { .. })));
    assert!(matches!(RatedStream::until(f64::NAN, 0.5, Definition::Caputo), Err(DerivativeError::Horizon { .. })));
    let mut stream = RatedStream::new(0.5, Definition::Caputo).unwrap();
    assert!(matches!(stream.push(0.0, 1.0, f64::NAN), Err(DerivativeError::NotFinite { column: "rate", .. })));
}
