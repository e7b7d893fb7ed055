//! The rows of a run in memory.

use super::observables::Observables;
use super::quantity::Quantity;
use crate::table::Column;
use std::collections::HashMap;

/// Rows in memory, columns by name or by [`Quantity`]. As [`crate::driver::Rows`] it takes those of a run.
///
/// ```
/// use springpot::model::{BodySpec, JointSpec, ModelBuilder, Parent};
/// use springpot::motion::{JointPath, Trajectory};
/// use springpot::observe::Quantity;
/// use springpot::signal::{Expression, Signal};
/// use springpot::system::{RowTimes, Settings, Stop, System};
/// use springpot::driver::run;
///
/// let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
/// builder.push(BodySpec {
///     name: "arm".into(),
///     parent: Parent::World,
///     joint: JointSpec::revolute("q1", [0.0, 1.0, 0.0], [0.0; 3]),
///     mass: 1.0,
///     com: [0.2, 0.0, 0.0],
///     inertia: [[0.0; 3]; 3],
/// })?;
/// let motion = Trajectory::Prescribed(vec![JointPath::Coordinate(Signal::expression(Expression::parse("t^2")?))]);
/// let model = builder.finish()?;
/// let system = System::new(model, Vec::new(), motion);
/// let settings = Settings::new(1.0, RowTimes::Step { step: 0.5, end: 1.0 });
///
/// let mut table = system.table();
/// run(&system, &settings, &mut table, &Stop::new(false)).1?;
/// assert_eq!(table.len(), 3);
/// assert_eq!(table.column("v.q1"), Some(vec![0.0, 1.0, 2.0]));
/// assert_eq!(table.values(Quantity::Coordinate(0)), Some(vec![0.0, 0.25, 1.0]));
/// assert_eq!(table.column("v.q2"), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Table {
    columns: Vec<Column>,
    positions: HashMap<Quantity, usize>,
    /// Row by row.
    values: Vec<f64>,
}

impl Table {
    /// A table without rows.
    pub fn new(observables: &Observables) -> Self {
        let positions = observables.quantities().into_iter().enumerate().map(|(k, quantity)| (quantity, k));
        Self { columns: observables.columns(), positions: positions.collect(), values: Vec::new() }
    }

    /// The columns, in the order of the rows.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.values.len() / self.columns.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Row `k`, in the order of the columns; NaN where it is empty.
    ///
    /// # Panics
    /// Where there is no such row.
    pub fn row(&self, k: usize) -> &[f64] {
        let width = self.columns.len();
        &self.values[k * width..(k + 1) * width]
    }

    /// The rows, one after another.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.values.chunks_exact(self.columns.len())
    }

    /// The values of the column of this name, such as `strut.force`; `None` where there is none.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        self.columns.iter().position(|column| column.name == name).map(|k| self.at(k))
    }

    /// The values of a quantity; `None` where the system has no such quantity.
    pub fn values(&self, quantity: Quantity) -> Option<Vec<f64>> {
        self.positions.get(&quantity).map(|&k| self.at(k))
    }

    /// A quantity in row `k`; `None` where there is no such row or quantity.
    pub fn value(&self, k: usize, quantity: Quantity) -> Option<f64> {
        let position = *self.positions.get(&quantity)?;
        self.values.get(k * self.columns.len() + position).copied()
    }

    /// Adds a row, in the order of the columns.
    ///
    /// # Panics
    /// Where it has not as many values as there are columns.
    pub fn push(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.columns.len(), "a value for each column");
        self.values.extend_from_slice(row);
    }

    fn at(&self, column: usize) -> Vec<f64> {
        self.rows().map(|row| row[column]).collect()
    }
}
