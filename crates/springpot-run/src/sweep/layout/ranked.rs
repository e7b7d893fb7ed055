//! Which columns rank the parameters that a run is differentiated by.

use crate::table::Statistics;
use serde::{Deserialize, Serialize};
use springpot::observe::Quantity;
use springpot::table::Column;
use springpot_scenario::SensitivityPlan;

/// What a run is differentiated by, and which columns of a row rank its parameters.
#[derive(Debug, Clone)]
pub(in crate::sweep) struct Differentiated {
    /// How many parameters.
    pub(in crate::sweep) count: usize,
    /// Columns beside the written ones whose size is to be known, by their index in a row.
    pub(in crate::sweep) beside: Vec<usize>,
    ranked: Vec<Pair>,
}

/// A column and its derivative, by their places among the columns whose statistics are known.
#[derive(Debug, Clone)]
struct Pair {
    of: usize,
    derivative: usize,
    by: usize,
    name: String,
}

/// How much a parameter changes a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ranked {
    /// The column.
    pub column: String,
    /// Which parameter.
    pub parameter: usize,
    /// Root mean square over the rows of the derivative, times the typical size of the parameter.
    pub rms: f64,
    /// That over the root mean square of the column; NaN where that is 0.
    pub share: f64,
}

impl Differentiated {
    /// Of a run whose rows have `columns`, the `selected` ones written.
    pub(in crate::sweep) fn of(sensitivity: &SensitivityPlan, columns: &[Column], selected: &[usize]) -> Self {
        let first = columns.len() - sensitivity.columns.len();
        let (mut beside, mut ranked) = (Vec::new(), Vec::new());
        for (k, told) in sensitivity.columns.iter().enumerate() {
            let (name, parameter) = Quantity::of_derivative(&told.name).unwrap_or_default();
            let of = columns.iter().position(|column| column.name == name);
            let by = sensitivity.parameters.iter().position(|own| own.name == parameter);
            let (Some(of), Some(by)) = (of, by) else { continue };
            let known = selected.iter().position(|at| *at == of).unwrap_or_else(|| {
                let there = beside.iter().position(|at| *at == of).unwrap_or_else(|| {
                    beside.push(of);
                    beside.len() - 1
                });
                selected.len() + there
            });
            let derivative = selected.iter().position(|at| *at == first + k);
            let derivative = derivative.expect("derivatives are written, whatever is asked for");
            ranked.push(Pair { of: known, derivative, by, name: name.to_owned() });
        }
        Self { count: sensitivity.parameters.len(), beside, ranked }
    }

    /// What changes columns most of a case with these statistics.
    pub(in crate::sweep) fn rank(&self, plan: &SensitivityPlan, statistics: &[Statistics]) -> Vec<Ranked> {
        let one = |pair: &Pair| {
            let rms = plan.parameters[pair.by].typical * statistics[pair.derivative].rms();
            let size = statistics[pair.of].rms();
            let share = if size > 0.0 { rms / size } else { f64::NAN };
            Ranked { column: pair.name.clone(), parameter: pair.by, rms, share }
        };
        let mut ranked: Vec<Ranked> = self.ranked.iter().map(one).collect();
        // What has no share stands last.
        let key = |ranked: &Ranked| if ranked.share.is_nan() { -1.0 } else { ranked.share };
        ranked.sort_by(|one, other| key(other).total_cmp(&key(one)));
        ranked
    }
}
