//! A scenario that was looked through.

use crate::sweep::Layout;
use crate::warning::{Warn, robot_warnings};
use springpot::law::Catalog;
use springpot::system::{Stop, System};
use springpot_scenario::{Cases, Plan, Refusals, Scenario};

/// A scenario that was looked through: its cases, the first of them, and the columns.
#[derive(Debug)]
pub struct Planned {
    /// The cases.
    pub cases: Cases,
    /// The first of them.
    pub plan: Plan,
    /// Its system.
    pub system: System,
    /// The columns.
    pub layout: Layout,
}

impl Planned {
    /// Looks a scenario through; a gripper path is followed no further once `stop` is set.
    ///
    /// # Errors
    /// The scenario is refused.
    pub fn of(scenario: &Scenario, catalog: &Catalog, stop: &Stop, warn: Warn<'_>) -> Result<Self, Refusals> {
        let cases = scenario.cases(catalog)?;
        let plan = cases.plan(0)?;
        let system = plan.system_unless(stop).sharing(cases.shared());
        robot_warnings(&cases).into_iter().for_each(warn);
        let layout = Layout::new(&cases, &plan)?;
        Ok(Self { cases, plan, system, layout })
    }
}
