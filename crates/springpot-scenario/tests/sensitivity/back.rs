//! Gradients by going back through a run, against derivatives of every row beside it on the same steps.

use super::{plan, scenario};
use springpot::driver;
use springpot::observe::Quantity;
use springpot::sensitivity::{DerivativeColumn, Lost, Sensitivity, SensitivityError, Share};
use springpot::system::{RunError, Settings, Stop, System};
use springpot::table::Column;
use std::sync::Arc;

/// How far both may be apart, in units of the sum of the sizes of what they are made of.
const KNOWN: f64 = 1e-10;

/// Rounding of changes that cancel, in units of the largest change by a typical value of any parameter.
const ROUNDING: f64 = 1e-13;

/// What is kept of a run at most that is cut into stretches, bytes.
const FEW: usize = 100_000;

/// A weight for a row and a quantity, of either sign.
fn weight(row: usize, quantity: usize) -> f64 {
    // Some rest on a row without counting it.
    if (row + quantity).is_multiple_of(7) {
        0.0
    } else {
        (1.7 * row as f64 + 0.9 * quantity as f64 * quantity as f64 + 0.3).sin()
    }
}

/// All rows of a run.
fn rows(system: &System, settings: &Settings) -> Vec<Vec<f64>> {
    let mut rows = Vec::new();
    let mut keep = |row: &[f64]| {
        rows.push(row.to_vec());
        Ok(())
    };
    driver::run(system, settings, &mut keep, &Stop::new(false)).1.unwrap();
    rows
}

/// Rows of a run, and by which parameters derivatives end in it.
#[derive(Default)]
struct Kept {
    rows: Vec<Vec<f64>>,
    lost: Vec<Lost>,
}

impl driver::Rows for Kept {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn lost(&mut self, lost: Lost) {
        self.lost.push(lost);
    }
}

/// Compares the gradients of sums over all rows of these columns, by the numbers at these paths, found forwards and backwards; one text in three also cut
/// into stretches that are run again. Whether those have changed nothing to the bit.
pub(crate) fn goes_back(text: &str, columns: &[&str], paths: &[&str]) -> bool {
    let mut asked = scenario(text);
    asked.differentiate(&paths.join(",")).unwrap();
    for setting in ["solver.rtol=1e-6", "time.output_step=0.0317"] {
        if !setting.contains("rtol") || text.contains("rtol = 1e-1") || text.contains("rtol = 1e-9") {
            asked.set(setting).unwrap();
        }
    }
    let plan = plan(&asked).unwrap_or_else(|refusals| panic!("{refusals}"));
    let (system, settings) = (plan.system(), &plan.settings);
    let observables = system.observables();
    let find =
        |name: &&str| observables.quantities().into_iter().find(|of| observables.named(*of).to_string() == *name);
    let quantities: Vec<Quantity> = columns.iter().map(|name| find(name).unwrap()).collect();
    let by = Sensitivity { control: false, ..Sensitivity::clone(system.sensitivity.as_ref().unwrap()) };
    let column = |of: Quantity, by: usize| DerivativeColumn { of, by, column: Column::new("d", "1", "d") };
    let count = by.parameters.len();
    let told = quantities.iter().flat_map(|of| (0..count).map(move |p| column(*of, p))).collect();
    let mut forward = system.clone();
    forward.sensitivity = Some(Arc::new(Sensitivity { columns: told, adjoint: None, ..by.clone() }));
    let mut back = system.clone();
    back.sensitivity =
        Some(Arc::new(Sensitivity { columns: Vec::new(), adjoint: Some(quantities.clone()), ..by.clone() }));
    let mut plain = system;
    plain.sensitivity = None;
    let mut kept = Kept::default();
    driver::run(&forward, settings, &mut kept, &Stop::new(false)).1.unwrap();
    let (all, Kept { rows: forward, lost }) = (rows(&plain, settings), kept);
    let width = all[0].len();
    let share = |k: usize| (0..all.len()).map(move |row| Share { row, quantity: k, slope: weight(row, k) }).collect();
    let shares: Vec<Vec<Share>> = (0..quantities.len()).map(share).collect();
    let budgets = if text.len().is_multiple_of(3) { vec![driver::MOST_KEPT, FEW] } else { vec![driver::MOST_KEPT] };
    let found = budgets.into_iter().map(|most| {
        let mut own = Vec::new();
        let mut keep = |row: &[f64]| {
            own.push(row.iter().map(|value| value.to_bits()).collect::<Vec<_>>());
            Ok(())
        };
        let (_, tape) = driver::record_within(&back, settings, &mut keep, &Stop::new(false), most);
        let tape = match tape {
            Err(RunError::Sensitivity(SensitivityError::Backwards { .. })) => {
                // Pasts alone are refused.
                assert!(text.contains("past = "), "{text}");
                return None;
            }
            tape => tape.unwrap_or_else(|error| panic!("{error}")).expect("a recording"),
        };
        assert!(tape.bytes() > 0 && tape.bytes() <= most);
        let bits = |row: &Vec<f64>| row.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(own, all.iter().map(bits).collect::<Vec<_>>(), "rows are those of the plain run");
        let ended = tape.lost(&Stop::new(false)).unwrap();
        for forwards in &lost {
            let own = ended.iter().find(|own| own.parameter == forwards.parameter);
            let own = own.unwrap_or_else(|| panic!("back {forwards:?} does not end"));
            // Of two changes at one time a number may be moved apart by what a parameter moves together.
            assert!(
                own == forwards || own.t <= forwards.t && own.why.starts_with("two changes"),
                "{own:?} {forwards:?}"
            );
        }
        let is_known = |own: &Lost| lost.iter().any(|forwards| forwards.parameter == own.parameter);
        assert!(ended.iter().all(|own| is_known(own) || own.why.starts_with("two changes")), "{ended:?} {lost:?}");
        Some(tape.gradients(&shares, &Stop::new(false)).unwrap())
    });
    let Some(found) = found.collect::<Option<Vec<_>>>() else { return true };
    let bits = |all: &Vec<Vec<f64>>| all.iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>();
    let is_exact = found.iter().all(|own| bits(own) == bits(&found[0]));
    let sums = |k: usize, p: usize| {
        let known = (0..all.len()).filter(|r| !all[*r][place(&observables.quantities(), quantities[k])].is_nan());
        known.fold([0.0, 0.0], |[sum, size], r| {
            let change = weight(r, k) * forward[r][width + k * count + p];
            [sum + change, size + change.abs()]
        })
    };
    let typical = |p: usize| by.parameters[p].typical.abs();
    for (k, name, found) in
        found.iter().flat_map(|found| columns.iter().zip(found).enumerate().map(|(k, (name, own))| (k, name, own)))
    {
        let largest = (0..count).map(|p| sums(k, p)[1] * typical(p)).fold(0.0, f64::max);
        for (p, found) in found.iter().enumerate() {
            let ([sum, size], path) = (sums(k, p), &by.parameters[p].name);
            let known = (KNOWN * size).max(ROUNDING * largest / typical(p));
            let is_equal = (found - sum).abs() <= known || found.is_nan() && sum.is_nan();
            assert!(is_equal, "back from {name} to {path}: {found:e} for {sum:e} of {size:e}");
        }
    }
    is_exact
}

/// Where nothing changes on the way, stretches that are run again are those of the run to the bit.
#[test]
fn stretches_are_run_again_to_the_bit() {
    // So long that it is cut.
    let text = super::ARM.to_owned() + &"\n".repeat(3 - super::ARM.len() % 3);
    assert!(goes_back(&text, &super::COLUMNS, &["element.strut.c", "robot.body.two.mass", "motion.start.q.q1"]));
}

fn place(all: &[Quantity], of: Quantity) -> usize {
    all.iter().position(|own| *own == of).unwrap()
}
