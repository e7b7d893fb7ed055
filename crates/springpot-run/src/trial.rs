//! A scenario whose parameters take other values.

use springpot::law::Catalog;
use springpot::system::Stop;
use springpot::{driver, system::RunError};
use springpot_scenario::{Cases, ParameterPlan, Plan, Refusals, Scenario};

/// A scenario with parameters that are to move.
#[derive(Debug, Clone, Copy)]
pub struct Varied<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The laws.
    pub catalog: &'a Catalog,
    /// Its parameters.
    pub parameters: &'a [ParameterPlan],
}

impl Varied<'_> {
    /// The scenario with these values, SI, of all parameters in order.
    ///
    /// # Errors
    /// A path that takes no value; which it may be is judged by [`Self::cases`].
    pub fn scenario(&self, values: &[f64]) -> Result<Scenario, Refusals> {
        let mut scenario = self.scenario.clone();
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter.assignments(*value).try_for_each(|assignment| scenario.set_anew(&assignment))?;
        }
        Ok(scenario)
    }

    /// Its cases.
    ///
    /// # Errors
    /// A value that its place does not take.
    pub fn cases(&self, values: &[f64]) -> Result<Cases, Refusals> {
        self.scenario(values)?.cases(self.catalog)
    }
}

/// All rows of a case, in the order of its system's columns, and the steps that it took.
///
/// # Errors
/// What keeps it from its end.
pub fn rows(plan: &Plan, stop: &Stop) -> Result<(Vec<Vec<f64>>, u64), RunError> {
    let (system, mut rows) = (plan.system_unless(stop), Vec::new());
    let mut take = |row: &[f64]| {
        rows.push(row.to_vec());
        Ok(())
    };
    let (report, outcome) = driver::run(&system, &plan.settings, &mut take, stop);
    outcome.map(|()| (rows, report.steps))
}
