//! Master curves: records of a complex modulus at several temperatures, shifted onto one another.
//!
//! Time and temperature do the same to a thermorheologically simple material: with x = log₁₀ f the curve at T, moved by log₁₀ a_T along x and,
//! on request, multiplied by b_T, is that at T_ref: E*(f·a_T; T_ref) = b_T·E*(f; T) (J. D. Ferry, Viscoelastic Properties of Polymers, 3rd ed.
//! 1980, 11).
//!
//! Each curve is shifted onto its neighbour in temperature. Where both have rows, one polynomial of ln E' and one of ln E'' go through both, with
//! the shift as one more unknown: the least squares of all of it, as shares of |E*|, each modulus weighed by its own scatter there, so that a loss that does not
//! superpose counts little. The shifts from T_ref on are sums of these steps, and so are their variances.
//! The steps are fitted by WLF and by Arrhenius ([`Shift`]); BIC says which.

mod pair;
mod shifts;

pub use shifts::ShiftFit;

use super::heat::{Shift, TEMPERATURE};
use pair::{Pair, Step};

/// Temperatures that differ by less are one, K.
const SAME_TEMPERATURE: f64 = 2.0;

/// One row of a record: a complex modulus at a frequency and a temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Frequency, Hz or rad/s; positive.
    pub frequency: f64,
    /// E', Pa or N/m; positive.
    pub storage: f64,
    /// E'', as E'; positive.
    pub loss: f64,
    /// Temperature, K.
    pub temperature: f64,
}

/// What the curve at one temperature is shifted by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shifted {
    /// Temperature, K: the mean of its rows.
    pub temperature: f64,
    /// log₁₀ a_T.
    pub log_a: f64,
    /// Its standard deviation, from T_ref on; infinite where rows leave it open.
    pub sd: f64,
    /// log₁₀ b_T; 0 without vertical shifts.
    pub log_b: f64,
    /// Its standard deviation.
    pub sd_b: f64,
    /// Rows of the curve.
    pub rows: usize,
}

/// A master curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Master {
    /// T_ref, K.
    pub reference: f64,
    /// The curves, coldest first.
    pub shifts: Vec<Shifted>,
    /// All rows at their reduced frequencies, with b_T·E' and b_T·E'', lowest first.
    pub rows: Vec<Row>,
    /// WLF; `None` where there are fewer than two steps.
    pub wlf: Option<ShiftFit>,
    /// Arrhenius.
    pub arrhenius: ShiftFit,
    /// √ of the mean square of what E' and E'' of neighbours scatter about a common curve where both have rows, as shares of |E*|.
    pub scatter: [f64; 2],
}

impl Master {
    /// The law of the shift that BIC prefers.
    pub fn chosen(&self) -> &ShiftFit {
        match &self.wlf {
            Some(wlf) if wlf.bic < self.arrhenius.bic => wlf,
            _ => &self.arrhenius,
        }
    }
}

/// Why there is no master curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MasterError {
    /// A number that is not positive and finite, or a temperature that no material has.
    #[error("{what} is {value}, but must be {range}")]
    Number {
        /// Its row, from 0.
        row: usize,
        /// `frequency`, `storage`, `loss` or `T`.
        what: &'static str,
        /// The number, SI.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// No rows at all.
    #[error("there are no rows")]
    NoRows,
    /// All rows are at one temperature.
    #[error("all rows are at one temperature, {0:.2} K: there is nothing to shift")]
    OneTemperature(f64),
    /// A temperature with too few rows.
    #[error("at {temperature:.2} K there are rows of {given} frequencies, and a curve has at least 3")]
    TooFewRows {
        /// Which, K.
        temperature: f64,
        /// Different frequencies there.
        given: usize,
    },
    /// T_ref is not among the temperatures.
    #[error("the reference {reference:.2} K is outside of what was measured, {low:.2} K to {high:.2} K")]
    Reference {
        /// T_ref, K.
        reference: f64,
        /// Lowest, K.
        low: f64,
        /// Highest, K.
        high: f64,
    },
    /// Two neighbours have nothing in common.
    #[error("the curves at {colder:.2} K and {warmer:.2} K do not overlap")]
    NoOverlap {
        /// The colder one, K.
        colder: f64,
        /// The warmer one, K.
        warmer: f64,
    },
    /// Two neighbours overlap, but are too flat to be shifted.
    #[error(
        "the curves at {colder:.2} K and {warmer:.2} K do not say how far they are shifted: they are flat where they overlap"
    )]
    Flat {
        /// The colder one, K.
        colder: f64,
        /// The warmer one, K.
        warmer: f64,
    },
}

/// The curve at one temperature, by frequency: log₁₀ f, ln E', ln E''.
#[derive(Debug, Clone)]
struct Curve {
    temperature: f64,
    points: Vec<[f64; 3]>,
}

/// Shifts rows of several temperatures to one master curve at `reference` (K); `vertical` asks for b_T too.
///
/// # Errors
/// [`MasterError`].
pub fn master(rows: &[Row], reference: f64, vertical: bool) -> Result<Master, MasterError> {
    check(rows)?;
    let curves = curves(rows)?;
    let [first, .., last] = &curves[..] else { return Err(MasterError::OneTemperature(curves[0].temperature)) };
    let (low, high) = (first.temperature, last.temperature);
    if !(reference >= low - SAME_TEMPERATURE && reference <= high + SAME_TEMPERATURE) {
        return Err(MasterError::Reference { reference, low, high });
    }
    let steps =
        curves.windows(2).map(|pair| Pair::new(&pair[0], &pair[1], vertical).step()).collect::<Result<Vec<_>, _>>()?;
    let temperatures: Vec<f64> = curves.iter().map(|curve| curve.temperature).collect();
    let wlf = shifts::wlf(&temperatures, &steps, reference);
    let arrhenius = shifts::arrhenius(&temperatures, &steps, reference);
    let mut found =
        Master { reference, shifts: Vec::new(), rows: Vec::new(), wlf, arrhenius, scatter: scatter(&steps) };
    found.shifts = shifted(&curves, &steps, reference, &found.chosen().shift);
    for (curve, shifted) in curves.iter().zip(&found.shifts) {
        let factor = 10.0_f64.powf(shifted.log_b);
        found.rows.extend(curve.points.iter().map(|[x, storage, loss]| Row {
            frequency: 10.0_f64.powf(x + shifted.log_a),
            storage: factor * storage.exp(),
            loss: factor * loss.exp(),
            temperature: curve.temperature,
        }));
    }
    found.rows.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    Ok(found)
}

fn check(rows: &[Row]) -> Result<(), MasterError> {
    for (row, one) in rows.iter().enumerate() {
        for (what, value) in [("frequency", one.frequency), ("storage", one.storage), ("loss", one.loss)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(MasterError::Number { row, what, value, range: "positive and finite" });
            }
        }
        if !TEMPERATURE.contains(one.temperature) {
            return Err(MasterError::Number { row, what: "T", value: one.temperature, range: "150 K to 1500 K" });
        }
    }
    if rows.is_empty() { Err(MasterError::NoRows) } else { Ok(()) }
}

/// The rows by temperature: where two that follow one another differ by more than [`SAME_TEMPERATURE`] a new curve begins.
fn curves(rows: &[Row]) -> Result<Vec<Curve>, MasterError> {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    let groups = sorted.chunk_by(|a, b| b.temperature - a.temperature <= SAME_TEMPERATURE);
    let curve = |group: &[Row]| {
        let temperature = group.iter().map(|row| row.temperature).sum::<f64>() / group.len() as f64;
        let mut points: Vec<[f64; 3]> =
            group.iter().map(|row| [row.frequency.log10(), row.storage.ln(), row.loss.ln()]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let given = points.chunk_by(|a, b| b[0] - a[0] < 1e-9).count();
        if given < 3 { Err(MasterError::TooFewRows { temperature, given }) } else { Ok(Curve { temperature, points }) }
    };
    groups.map(curve).collect()
}

/// Shifts of all curves from T_ref on. Between two curves T_ref is where the law says, corrected by what it misses at both.
fn shifted(curves: &[Curve], steps: &[Step], reference: f64, law: &Shift) -> Vec<Shifted> {
    let (mut log_a, mut log_b) = (vec![0.0], vec![0.0]);
    for (k, step) in steps.iter().enumerate() {
        log_a.push(log_a[k] + step.log_a);
        log_b.push(log_b[k] + step.log_b);
    }
    let temperature = |k: usize| curves[k].temperature;
    // The pair about T_ref, and its share between the two.
    let warmer = curves.partition_point(|curve| curve.temperature < reference).clamp(1, steps.len());
    let colder = warmer - 1;
    let share = ((reference - temperature(colder)) / (temperature(warmer) - temperature(colder))).clamp(0.0, 1.0);
    let law = |k: usize| law.ln_factor(temperature(k)) / std::f64::consts::LN_10;
    let missed = |k: usize| log_a[k] - law(k);
    // The law is 0 at T_ref itself.
    let inside = missed(colder) + share * (missed(warmer) - missed(colder));
    let zero = match share {
        0.0 => log_a[colder],
        1.0 => log_a[warmer],
        _ => inside,
    };
    let zero_b = log_b[colder] + share * (log_b[warmer] - log_b[colder]);
    let spread = |k: usize, of: &dyn Fn(&Step) -> f64| {
        // The part of the step about T_ref that lies between, and whole steps behind it.
        let (part, whole) = if k <= colder { (share, k..colder) } else { (1.0 - share, warmer..k) };
        let whole: f64 = whole.map(|k| of(&steps[k]).powi(2)).sum();
        ((part * of(&steps[colder])).powi(2) * f64::from(part > 0.0) + whole).sqrt()
    };
    (0..curves.len())
        .map(|k| Shifted {
            temperature: temperature(k),
            log_a: log_a[k] - zero,
            sd: spread(k, &|step| step.sd),
            log_b: log_b[k] - zero_b,
            sd_b: spread(k, &|step| step.sd_b),
            rows: curves[k].points.len(),
        })
        .collect()
}

fn scatter(steps: &[Step]) -> [f64; 2] {
    let mean = |m: usize| steps.iter().map(|step| step.scatter[m].powi(2)).sum::<f64>() / steps.len() as f64;
    [mean(0).sqrt(), mean(1).sqrt()]
}
