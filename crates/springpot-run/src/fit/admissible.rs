//! Where scenarios can be read.

use super::problem::Problem;
use springpot::identification::{Parameter, Scale};
use springpot_scenario::DataKind;

/// Halvings of a range towards where a scenario can be read.
const HALVINGS: usize = 8;

/// Narrows bounds, and starts with them, to where scenarios can be read, one parameter at a time from where it begins: inertias that no body has are no trials of a linear problem.
pub(super) fn narrow(problem: &mut Problem<'_>) {
    let start: Vec<f64> = problem.parameters.iter().map(|own| own.start[0]).collect();
    let none = vec![false; start.len()];
    let runs = || problem.records.iter().filter(|record| record.data.is_fitted && record.data.kind == DataKind::Run);
    let is_read = |j: usize, value: f64| {
        let mut values = start.clone();
        values[j] = value;
        runs().all(|record| record.fitting.run_at(record.index, &values, &none).is_ok())
    };
    let limit = |j: usize, end: f64| {
        let (mut inside, mut outside) = (start[j], end);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            *(if is_read(j, middle) { &mut inside } else { &mut outside }) = middle;
        }
        inside
    };
    let narrowed = |(j, own): (usize, &Parameter)| {
        let [low, high] = own.bounds;
        // As far as starts are spread.
        let reach = [start[j] - 10.0 * own.typical, start[j] + 10.0 * own.typical];
        let ends = if own.scale == Scale::Log { [0.1 * start[j], 10.0 * start[j]] } else { reach };
        let [least, most] = [ends[0].max(low), ends[1].min(high)];
        [if is_read(j, least) { low } else { limit(j, least) }, if is_read(j, most) { high } else { limit(j, most) }]
    };
    if !is_read(0, start[0]) {
        return;
    }
    let bounds: Vec<[f64; 2]> = problem.parameters.iter().enumerate().map(narrowed).collect();
    for (own, [low, high]) in problem.parameters.iter_mut().zip(bounds) {
        if low < high {
            own.bounds = [low, high];
            own.start.iter_mut().for_each(|start| *start = start.clamp(low, high));
        }
    }
}
