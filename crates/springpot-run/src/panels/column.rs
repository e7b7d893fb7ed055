//! The columns of a figure, in the units that they are drawn in.

use crate::labels;
use springpot::table::Column;
use springpot_scenario::Statistic;
use springpot_scenario::units::Unit;

/// A column of a figure.
#[derive(Debug, Clone)]
pub struct FigureColumn {
    /// The column.
    pub column: Column,
    /// The unit it is drawn in and how SI values become numbers of it; `None`: SI.
    pub unit: Option<(String, Unit)>,
    /// What it is called, where its quantity does not say it.
    pub label: Option<String>,
}

impl FigureColumn {
    /// What stands at its axis: its name and its unit.
    pub fn axis(&self) -> String {
        with_unit(&self.name(), self.unit_name())
    }

    /// What it is called.
    pub fn name(&self) -> String {
        self.label.clone().unwrap_or_else(|| labels::quantity(&self.column.name))
    }

    /// A statistic of it.
    pub(crate) fn summed(self, statistic: Statistic) -> Self {
        let name = || format!("{} of {}", statistic.name(), labels::quantity(&self.column.name));
        Self { label: Some(self.label.unwrap_or_else(name)), ..self }
    }

    /// An SI value in the unit that it is drawn in.
    pub fn number(&self, value: f64) -> f64 {
        self.unit.as_ref().map_or(value, |(_, unit)| unit.from_si(value))
    }

    pub(crate) fn unit_name(&self) -> &str {
        self.unit.as_ref().map_or(&self.column.unit, |(text, _)| text)
    }
}

pub(super) fn with_unit(name: &str, unit: &str) -> String {
    match labels::written_unit(unit) {
        unit if unit.is_empty() => name.to_owned(),
        unit => format!("{name}, {unit}"),
    }
}

/// Ordinates of one unit each: indices.
pub(super) fn groups(y: &[FigureColumn]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (k, column) in y.iter().enumerate() {
        match groups.iter_mut().find(|group| y[group[0]].unit_name() == column.unit_name()) {
            Some(group) => group.push(k),
            None => groups.push(vec![k]),
        }
    }
    groups
}
