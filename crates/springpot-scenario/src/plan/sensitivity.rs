//! By what a run is differentiated, as it is read.

use crate::keys::{ADJOINT, FORWARD};
use crate::text::refusal::Place;
use springpot::identification::{Prior, Scale};
use springpot::sensitivity::Sensitivity;
use springpot::table::Column;
use std::sync::Arc;

/// By what a run is differentiated, and what.
#[derive(Debug, Clone)]
pub struct SensitivityPlan {
    /// The numbers, in the order of the columns.
    pub parameters: Vec<ParameterPlan>,
    /// The derivatives `d(COLUMN)/d(PARAMETER)` that rows tell, behind all other columns.
    pub columns: Vec<Column>,
    /// The derivatives that metrics alone need: a row has them behind all that it tells.
    pub for_metrics: Vec<Column>,
    /// Metrics whose gradient is not known, since no derivative is known of their columns.
    pub no_gradient: Vec<String>,
    /// Columns that are written and that no derivative is known of: nobody asked for them by name.
    pub left_out: Vec<String>,
    /// Where gradients are found by going back through the run: of each metric the place of its column among [`Sensitivity::adjoint`], where that is
    /// known. Rows tell no derivatives then.
    pub adjoint: Option<Vec<Option<usize>>>,
    /// What the engine is told; `None` where nothing is differentiated: the parameters are only there.
    pub(crate) engine: Option<Arc<Sensitivity>>,
}

/// A number that a run is differentiated by.
#[derive(Debug, Clone)]
pub struct ParameterPlan {
    /// Its name, or its path.
    pub name: String,
    /// Its paths.
    pub paths: Vec<String>,
    /// Its value, SI.
    pub value: f64,
    /// The SI unit of its value; empty for a pure number.
    pub unit: String,
    /// What a change of it is measured by, SI.
    pub typical: f64,
    /// Its least and largest value, SI, where its block says them.
    pub bounds: Option<[f64; 2]>,
    /// The variable in which it moves, where its block says it.
    pub scale: Option<Scale>,
    /// Where a search begins, SI, where its block says it.
    pub starts: Vec<f64>,
    /// What is known of it beforehand, SI.
    pub prior: Option<Prior>,
    /// Where it stands: its block, or what asks for it.
    pub place: Place,
}

impl ParameterPlan {
    /// What [`crate::Scenario::set_anew`] takes to give it a value, SI: `PATH=VALUE` for each of its paths.
    pub fn assignments(&self, value: f64) -> impl Iterator<Item = String> {
        self.paths.iter().map(move |path| match &*self.unit {
            // A constant has the unit that it is written in.
            unit if path.starts_with("constants.") && !unit.is_empty() => format!("{path}=\"{value:?} {unit}\""),
            _ => format!("{path}={value:?}"),
        })
    }

    /// The unit of a derivative by it of what is in `unit`.
    pub fn over(&self, unit: &str) -> String {
        over(unit, &self.unit)
    }
}

impl SensitivityPlan {
    /// Whether rows tell derivatives.
    pub fn is_asked(&self) -> bool {
        self.engine.is_some()
    }

    /// How it is differentiated, as a file says it.
    pub fn method(&self) -> &'static str {
        if self.adjoint.is_some() { ADJOINT } else { FORWARD }
    }

    /// The derivatives of the time of an event, `d(t)/d(PARAMETER)`, in the order of the parameters.
    pub fn times(&self) -> impl Iterator<Item = Column> {
        self.parameters.iter().map(|ParameterPlan { name, unit, .. }| {
            let meaning = format!("derivative of the time of the event by {name}");
            Column::new(format!("d(t)/d({name})"), over("s", unit), meaning)
        })
    }

    /// What the derivative of a column by a parameter is called.
    pub fn name(column: &str, parameter: &str) -> String {
        format!("d({column})/d({parameter})")
    }

    /// Where rows have the derivatives of a column by each parameter, counted from the first derivative on; `None` where they do not.
    pub fn places(&self, column: &str) -> Option<Vec<usize>> {
        let place = |parameter: &ParameterPlan| {
            let name = Self::name(column, &parameter.name);
            self.columns.iter().chain(&self.for_metrics).position(|column| column.name == name)
        };
        self.parameters.iter().map(place).collect()
    }
}

/// The unit of a quotient.
pub(crate) fn over(unit: &str, by: &str) -> String {
    match (unit, by) {
        (unit, "" | "1") => unit.to_owned(),
        ("" | "1", by) if by.contains(['*', '/']) => format!("1/({by})"),
        ("" | "1", by) => format!("1/{by}"),
        (unit, by) if by.contains(['*', '/']) => format!("{unit}/({by})"),
        (unit, by) => format!("{unit}/{by}"),
    }
}
