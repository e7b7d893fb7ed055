//! `--check`: derivatives of a run beside fourth-order differences of whole runs.

use super::Untold;
use springpot::observe::Quantity;
use springpot::system::Stop;
use springpot::table::Column;
use springpot_run::trial::{Varied, rows};
use springpot_scenario::Plan;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// What a derivative may differ by, of its largest value.
const CLOSE: f64 = 1e-5;

/// What is left open is told from so many times what is judged on.
const TOLD: f64 = 2.0;

/// Tolerances of the runs that differences are taken of, where those of the file are larger.
const RTOL: f64 = 1e-11;
const MEMORY_RTOL: f64 = 1e-13;

/// The step of a difference, of the size of the parameter; the next one where its place takes no such value, or where this one is too coarse.
const STEPS: [f64; 3] = [1e-3, 1e-4, 1e-5];

/// Tolerance of one more run, beside which these show how far they are from the truth, and how many times that is left open.
const FINER: f64 = 0.2;
const OPEN: f64 = 4.0;

/// A derivative is no better than its column: how many times the share that the column is off by is left open.
const BESIDE: f64 = 10.0;

/// Where a difference is taken, in steps, and the weights of the values there: from both sides, or where the value is at an end of its range from one.
const STENCILS: [(&[f64], &[f64]); 3] = [
    (&[-2.0, -1.0, 1.0, 2.0], &[1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0]),
    (&[0.0, 1.0, 2.0, 3.0, 4.0], &[-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25]),
    (&[0.0, -1.0, -2.0, -3.0, -4.0], &[25.0 / 12.0, -4.0, 3.0, -4.0 / 3.0, 0.25]),
];

/// A second difference that is more than this share of the first one bends there: a row at which something switches, which moves.
const BENDS: f64 = 0.05;

/// The column of t. The row of an event that ends the run stands at another time in every run: it is not compared.
const TIME: usize = 0;

/// What was found of one parameter.
#[derive(Debug, Clone)]
pub(super) struct Compared {
    pub(super) parameter: String,
    /// Largest difference over the largest value of the derivative, of the column in which it is worst; less where differences tell less, or the column
    /// itself is less exact.
    pub(super) off: f64,
    pub(super) column: String,
    /// The step of the differences, SI.
    pub(super) step: f64,
    /// What differences and the column itself leave open, of the largest value, of the column where that is most; 0 where it is less than is judged.
    pub(super) open: f64,
    pub(super) open_column: String,
}

impl Compared {
    /// Whether the derivative is what differences say.
    pub(super) fn is_close(&self) -> bool {
        self.off <= CLOSE
    }
}

/// Compares the case of `plan`, parameter by parameter.
pub(super) fn compare(varied: &Varied<'_>, plan: &Plan, stop: &Stop) -> Result<Vec<Compared>, Untold> {
    let columns = plan.system_at_start().columns();
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let mut finer = tight(plan.clone());
    finer.settings.rtol *= FINER;
    let mut runs = side_by_side(vec![plan.clone(), tight(plan.clone()), finer], stop)?.into_iter();
    let [told, exact, finer] = std::array::from_fn(|_| runs.next().unwrap_or_default());
    let noise = noise(&columns, [&told, &exact, &finer]);
    let values: Vec<f64> = varied.parameters.iter().map(|parameter| parameter.value).collect();
    let each = varied.parameters.iter().enumerate().map(|(p, parameter)| {
        let size = parameter.typical;
        let moved = |by: f64| {
            let mut values = values.clone();
            values[p] += by;
            varied.cases(&values).and_then(|cases| cases.plan(0))
        };
        let mut refused = None;
        let mut best: Option<Compared> = None;
        'steps: for step in STEPS {
            for (at, weights) in STENCILS {
                let plans: Result<Vec<Plan>, _> = at.iter().map(|steps| moved(steps * step * size)).collect();
                let plans = match plans {
                    Ok(plans) => plans,
                    Err(why) => {
                        refused.get_or_insert(why);
                        continue;
                    }
                };
                let runs = side_by_side(plans.into_iter().map(tight).collect(), stop)?;
                let found = one((&names, &noise), [&told, &exact], &runs, (at, weights), (&parameter.name, step, size));
                let is_close = found.is_close();
                best = Some(best.filter(|best| best.off <= found.off).unwrap_or(found));
                if is_close {
                    break 'steps;
                }
                continue 'steps;
            }
        }
        best.ok_or_else(|| {
            refused.map_or_else(|| Untold::Failed(format!("{} cannot be moved", parameter.name)), Untold::Refused)
        })
    });
    each.collect()
}

/// How exact a column is.
#[derive(Debug, Clone, Copy)]
struct Noise {
    /// How far runs that differences are taken of are from the truth, rounding included.
    of_differences: f64,
    /// How far the run itself is, as a share of the largest value.
    of_column: f64,
}

/// Column by column, of a run that has the rows `told`, beside one that is as exact as differences need it, and a still finer one.
fn noise(columns: &[Column], [told, tight, finer]: [&[Vec<f64>]; 3]) -> Vec<Noise> {
    let off = |k: usize, rows: &[Vec<f64>], others: &[Vec<f64>]| {
        let pairs = rows.iter().zip(others).filter(|(one, other)| one[TIME] == other[TIME]);
        pairs.map(|(one, other)| (one[k] - other[k]).abs()).fold(0.0, f64::max)
    };
    let count = tight.first().map_or(0, Vec::len);
    let sizes: Vec<f64> = (0..count).map(|k| tight.iter().map(|row| row[k].abs()).fold(0.0, f64::max)).collect();
    let one = |k: usize| {
        // What is 0 but for rounding is rounded as what it is made of.
        let alike = columns.iter().zip(&sizes).filter(|(column, _)| column.unit == columns[k].unit);
        let largest = alike.map(|(_, size)| *size).fold(0.0, f64::max);
        let of_column = if sizes[k] > 0.0 { off(k, told, tight) / sizes[k] } else { 0.0 };
        Noise { of_differences: off(k, tight, finer).max(4.0 * f64::EPSILON * largest), of_column }
    };
    (0..count).map(one).collect()
}

/// The rows of runs that go on all cores at once.
fn side_by_side(plans: Vec<Plan>, stop: &Stop) -> Result<Vec<Vec<Vec<f64>>>, Untold> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (next, found) = (AtomicUsize::new(0), Mutex::new(plans.iter().map(|_| None).collect::<Vec<_>>()));
    let work = || {
        while let Some((k, plan)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, plans.get(k)?))) {
            let ran = rows(plan, stop);
            found.lock().unwrap_or_else(PoisonError::into_inner)[k] = Some(ran);
        }
    };
    std::thread::scope(|scope| {
        (1..cores.min(plans.len())).for_each(|_| drop(scope.spawn(work)));
        work();
    });
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.into_iter().flatten().map(|ran| Ok(ran?.0)).collect()
}

/// The run without derivatives, as exact as differences need it.
fn tight(mut plan: Plan) -> Plan {
    plan.sensitivity = None;
    plan.settings.rtol = plan.settings.rtol.min(RTOL);
    plan.settings.memory_rtol = plan.settings.memory_rtol.min(MEMORY_RTOL);
    plan
}

/// The worst column of one parameter.
fn one(
    (names, noise): (&[String], &[Noise]),
    [told, exact]: [&[Vec<f64>]; 2],
    runs: &[Vec<Vec<f64>>],
    (at, weights): (&[f64], &[f64]),
    (parameter, relative, size): (&str, f64, f64),
) -> Compared {
    let step = relative * size;
    let (off, open) = (0.0, 0.0);
    let (column, open_column) = (String::new(), String::new());
    let mut found = Compared { parameter: parameter.to_owned(), off, column, step, open, open_column };
    for (k, name) in names.iter().enumerate() {
        let Some((of, _)) = Quantity::of_derivative(name).filter(|(_, by)| *by == parameter) else { continue };
        let Some(column) = names.iter().position(|own| own == of) else { continue };
        let (mut off, mut largest) = (0.0f64, 0.0f64);
        for (row, own) in told.iter().enumerate() {
            let at_once = |rows: &Vec<Vec<f64>>| {
                let row = rows.get(row).filter(|row| row[TIME] == own[TIME]);
                row.map_or(f64::NAN, |row| row[column])
            };
            let there: Vec<f64> = runs.iter().map(at_once).collect();
            let difference = there.iter().zip(weights).map(|(y, weight)| weight * y).sum::<f64>() / step;
            let middle = exact.get(row).map_or(f64::NAN, |row| row[column]);
            if own[k].is_finite() && difference.is_finite() && !bends(at, &there, (middle, noise[column])) {
                off = off.max((own[k] - difference).abs());
                largest = largest.max(own[k].abs()).max(difference.abs());
            }
        }
        let Noise { of_differences, of_column } = noise[column];
        let scale = largest.max(OPEN * of_differences / (step * CLOSE)) * (BESIDE * of_column / CLOSE).max(1.0);
        let share = if off > 0.0 { off / scale } else { 0.0 };
        // Of what is as good as 0 they tell nothing else.
        let open = if off > 0.0 && largest > 0.0 { CLOSE * scale / largest } else { 0.0 };
        if (TOLD * CLOSE..1.0).contains(&open) && open > found.open {
            (found.open, found.open_column) = (open, of.to_owned());
        }
        if found.column.is_empty() || share > found.off {
            (found.off, found.column) = (share, of.to_owned());
        }
    }
    found
}

/// Whether a column bends where the parameter has its value, so that it has a derivative from either side: such rows are not compared.
fn bends(at: &[f64], there: &[f64], (middle, noise): (f64, Noise)) -> bool {
    let of = |steps: f64| at.iter().position(|own| *own == steps).map(|k| there[k]);
    let (Some(before), Some(after)) = (of(-1.0), of(1.0)) else { return false };
    let wide = of(-2.0).zip(of(2.0)).map_or(0.0, |(before, after)| (before - 2.0 * middle + after).abs());
    let narrow = (before - 2.0 * middle + after).abs();
    // What curves does so four times as much over twice the way; what bends twice as much.
    let least = 8.0 * OPEN * noise.of_differences;
    narrow > least.max(BENDS * ((after - middle).abs() + (middle - before).abs())) && wide < 3.0 * narrow
}
