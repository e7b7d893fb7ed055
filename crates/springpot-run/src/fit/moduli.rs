//! Moduli, relaxation and creep of one element, and their derivatives.

use super::compared::{Predicted, Record};
use num_complex::Complex64;
use springpot::identification::Failed;
use springpot::law::heat::INPUT as TEMPERATURE;
use springpot::law::{InputValue, Network, Point};
use springpot_scenario::{DataKind, MaterialAt, Moved};

/// Of a part of a modulus, as a share of it.
const ROUNDING: f64 = 1e-14;
/// Step of the differences of first harmonics, as a share.
const STEP: f64 = 1e-4;

/// What the law says of every row.
pub(super) fn predict(record: &Record<'_>, values: &[f64], wanted: &[bool]) -> Result<Predicted, Failed> {
    let data = record.data;
    let is_differentiated = record.is_wanted(wanted);
    let material = record.fitting.material_at(record.index, values).map_err(Failed)?;
    let columns = data.columns.len();
    let (rows, count) = (record.rows.len(), data.parameters.len());
    let mut predicted = Predicted {
        is_differentiated,
        model: vec![Vec::with_capacity(rows); columns],
        slopes: vec![vec![0.0; if is_differentiated { rows * count } else { 0 }]; columns],
        rates: vec![Vec::new(); columns],
    };
    let signals = record.fitting.inputs(record.index);
    let amplitude = data.told("amplitude").filter(|_| !material.law.is_linear());
    if amplitude.is_none() && !material.law.is_linear() {
        return Err(Failed(
            "the law is not linear: its modulus depends on the amplitude, which no column tells".into(),
        ));
    }
    let inputs = |row: usize| -> Vec<InputValue> {
        let own = |(name, signal): &(String, Option<springpot::signal::Signal>)| {
            let told = data.told(name).map(|values| values[row]);
            told.or_else(|| signal.as_ref().map(|signal| signal.at(0.0).value)).unwrap_or(0.0)
        };
        signals.iter().map(|input| InputValue { value: own(input), rate: 0.0 }).collect()
    };
    let temperature = signals.iter().position(|(name, _)| name == TEMPERATURE);
    for (k, &row) in record.rows.iter().enumerate() {
        let inputs = inputs(row);
        let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs };
        let own = |law: &Network, clock: f64| answer(data.kind, law, (&at, data.at[row]), clock);
        let asked = || Failed(format!("no modulus of the law \"{}\" is known", material.entry.name));
        let value = match amplitude {
            Some(amplitude) => harmonic(data.kind, &material.law, (&at, data.at[row]), amplitude[row])?,
            None => own(&material.law, 0.0).ok_or_else(asked)?.map(|[value, _]| value),
        };
        for (column, value) in predicted.model.iter_mut().zip(value) {
            if value.is_nan() || value <= 0.0 {
                return Err(Failed(format!("the model is {value} on line {}", data.lines[row])));
            }
            column.push(value);
        }
        if !is_differentiated || amplitude.is_some() {
            continue;
        }
        let unknown = |p: usize| {
            let name = &record.fitting.plan().parameters[data.parameters[p]].sought.name;
            Failed(format!("no derivative by {name} of the modulus of the law \"{}\" is known", material.entry.name))
        };
        let sought = |(p, _): &(usize, &Moved)| wanted[data.parameters[*p]];
        for (p, moved) in material.moved.iter().enumerate().filter(sought) {
            let slopes = match moved {
                Moved::Nothing => continue,
                Moved::Law(law) => own(law, 0.0),
                Moved::Clock(name) => {
                    let temperature = temperature.map_or(f64::NAN, |at| inputs[at].value);
                    own(&material.law, material.clock(name, temperature))
                }
            };
            for (column, [_, slope]) in predicted.slopes.iter_mut().zip(slopes.ok_or_else(|| unknown(p))?) {
                column[k * count + p] = slope;
            }
        }
    }
    if is_differentiated && amplitude.is_some() {
        differences(record, (values, wanted), &material, &mut predicted)?;
    }
    Ok(predicted)
}

/// What a kind is of, of the law and by the parameter that it carries.
fn answer(kind: DataKind, law: &Network, (at, x): (&Point, f64), clock: f64) -> Option<[[f64; 2]; 2]> {
    match kind {
        DataKind::Relaxation => law.relaxation(at, x, clock).map(|own| [own, [0.0; 2]]),
        DataKind::Creep => law.creep(at, x, clock).map(|own| [own, [0.0; 2]]),
        kind => {
            let s = Complex64::new(0.0, x);
            let [own, by] = law.modulus_slope(at, [s, s * clock])?;
            Some(parts(kind, own, by))
        }
    }
}

/// Storage and loss, or modulus and tan δ, with their derivatives.
fn parts(kind: DataKind, own: Complex64, by: Complex64) -> [[f64; 2]; 2] {
    // What is a rounding of the other is nothing: a dashpot stores nothing.
    let size = ROUNDING * own.norm();
    let own =
        Complex64::new(if own.re.abs() < size { 0.0 } else { own.re }, if own.im.abs() < size { 0.0 } else { own.im });
    match kind {
        DataKind::Dma { is_polar: true } => {
            let modulus = own.norm();
            let slope = (own.re * by.re + own.im * by.im) / modulus;
            [[modulus, slope], [own.im / own.re, (by.im * own.re - own.im * by.re) / (own.re * own.re)]]
        }
        _ => [[own.re, by.re], [own.im, by.im]],
    }
}

/// The same of the first harmonic of a law that is not linear.
fn harmonic(kind: DataKind, law: &Network, (at, omega): (&Point, f64), amplitude: f64) -> Result<[f64; 2], Failed> {
    let unsteady = || Failed("its first harmonic does not become steady".to_owned());
    let [re, im] = law.first_harmonic(at, amplitude, omega).ok_or_else(unsteady)?;
    Ok(parts(kind, Complex64::new(re, im), Complex64::ZERO).map(|[value, _]| value))
}

/// Derivatives of first harmonics, of fourth order in the step: there is no formula of all of them.
fn differences(
    record: &Record<'_>,
    (values, wanted): (&[f64], &[bool]),
    own: &MaterialAt,
    into: &mut Predicted,
) -> Result<(), Failed> {
    let count = record.data.parameters.len();
    for (p, &k) in record.data.parameters.iter().enumerate() {
        if matches!(own.moved[p], Moved::Nothing) || !wanted[k] {
            continue;
        }
        let [low, high] = record.fitting.plan().parameters[k].sought.bounds;
        let room = (values[k] - low).min(high - values[k]);
        let step = (STEP * values[k].abs().max(1e-3)).min(0.4 * if room > 0.0 { room } else { f64::INFINITY });
        for (steps, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
            let mut moved = values.to_vec();
            moved[k] += steps * step;
            let at = predict(record, &moved, &vec![false; values.len()])?;
            for (column, model) in into.slopes.iter_mut().zip(&at.model) {
                for (row, value) in model.iter().enumerate() {
                    column[row * count + p] += weight * value / (12.0 * step);
                }
            }
        }
    }
    Ok(())
}
