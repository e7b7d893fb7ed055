//! Which columns are written, and which are kept in memory for figures and metrics.

mod curve;
mod figures;
mod ranked;
mod wanted;

pub use curve::{KeptCurve, MAX_CURVES_IN_ALL, most_points};
pub use ranked::Ranked;
pub use wanted::{Abscissa, FigureCurve, FigureData, FigureTotal, LeftOut, MAX_CURVES, Total};
pub(super) use wanted::{WantedMetric, Window};

use ranked::Differentiated;
use springpot::observe::Quantity;
use springpot::table::Column;
use springpot_scenario::{Cases, Plan, Refusals, SensitivityPlan};
use wanted::{Wanted, WantedCurve, WantedTotal};

/// The columns of a sweep.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Swept parameters, then the run's columns that are asked for.
    written: Vec<Column>,
    swept: usize,
    /// Indices in a row of the run's columns that are written.
    selected: Vec<usize>,
    /// The run's columns, and those of them that figures want.
    wanted: Wanted,
    figures: Vec<FigureData>,
    /// The names of the events.
    events: Vec<String>,
    metrics: Vec<WantedMetric>,
    /// The derivatives of the time of an event.
    times: Vec<Column>,
    /// What is differentiated, where anything is.
    differentiated: Option<Differentiated>,
}

impl Layout {
    /// Lays out the columns of a sweep whose first case is `plan`.
    ///
    /// # Errors
    /// Globs that match no column, units that do not fit their column, metrics of columns that no case has.
    pub fn new(cases: &Cases, plan: &Plan) -> Result<Self, Refusals> {
        let mut wanted = Wanted::new(plan.columns());
        let swept = cases.parameters().len();
        let selected = match cases.columns() {
            None => (0..wanted.columns().len()).collect(),
            Some(globs) => {
                let mut selected: Vec<usize> = Vec::new();
                for glob in globs {
                    selected.extend(wanted.found(glob)?);
                }
                // Derivatives stand behind all else, whatever is asked for.
                let columns = wanted.columns().iter().enumerate();
                selected.extend(columns.filter(|(_, column)| is_derivative(column)).map(|(k, _)| k));
                selected.sort_unstable();
                selected.dedup();
                selected
            }
        };
        let named = cases.parameters().iter().zip(cases.units());
        let parameters = named.map(|(name, unit)| Column::new(name.as_str(), unit.as_str(), "swept parameter"));
        let written = parameters.chain(selected.iter().map(|&k| wanted.columns()[k].clone())).collect();
        let figures =
            cases.figures().iter().map(|figure| figures::data(cases, figure, &mut wanted)).collect::<Result<_, _>>()?;
        let mut metrics =
            cases.metrics().iter().map(|plan| wanted.metric(plan)).collect::<Result<Vec<WantedMetric>, _>>()?;
        let sensitivity = plan.sensitivity.as_ref().filter(|sensitivity| sensitivity.is_asked());
        let differentiated = sensitivity.map(|sensitivity| {
            let first = wanted.columns().len() - sensitivity.columns.len();
            for metric in &mut metrics {
                let places = sensitivity.places(&metric.first.of);
                metric.changes = places.map(|places| places.into_iter().map(|k| wanted.keep(first + k)).collect());
            }
            Differentiated::of(sensitivity, wanted.columns(), &selected)
        });
        let events: Vec<String> = plan.events.iter().map(|plan| plan.event.name.clone()).collect();
        let times = sensitivity
            .filter(|own| !events.is_empty() && own.adjoint.is_none())
            .into_iter()
            .flat_map(SensitivityPlan::times)
            .collect();
        Ok(Self { written, swept, selected, wanted, figures, events, metrics, times, differentiated })
    }

    /// Columns of results.csv.
    pub fn written(&self) -> &[Column] {
        &self.written
    }

    /// How many of them, the first ones, are swept parameters.
    pub fn swept(&self) -> usize {
        self.swept
    }

    /// Columns of summary.csv.
    pub(super) fn summary_columns(&self) -> Vec<Column> {
        self.columns_with(&["column", "unit", "min", "max", "rms"])
    }

    /// The names of the events, in the order of the scenario.
    pub fn events(&self) -> &[String] {
        &self.events
    }

    /// The metrics of the first case, and where their columns are kept.
    pub(super) fn metrics(&self) -> &[WantedMetric] {
        &self.metrics
    }

    /// Names of the metrics, and the units of their values.
    pub fn metric_units(&self) -> Vec<[String; 2]> {
        let unit = |wanted: &WantedMetric| wanted.first.kind.unit(&wanted.column.unit).into_owned();
        self.metrics.iter().map(|wanted| [wanted.first.name.clone(), unit(wanted)]).collect()
    }

    /// Where t stands among the kept columns, where there are metrics.
    pub(super) fn kept_time(&self) -> Option<usize> {
        self.metrics.first().map(|metric| metric.t)
    }

    /// What is differentiated, where anything is.
    pub(super) fn differentiated(&self) -> Option<&Differentiated> {
        self.differentiated.as_ref()
    }

    /// Whether there are gradients of metrics.
    pub(super) fn has_gradients(&self) -> bool {
        self.differentiated.is_some() && !self.metrics.is_empty()
    }

    /// Columns of a file with these behind the swept parameters.
    pub(super) fn columns_with(&self, names: &[&str]) -> Vec<Column> {
        let swept = self.written[..self.swept].iter().cloned();
        swept.chain(names.iter().map(|name| Column::new(*name, "", ""))).collect()
    }

    /// Columns of events.csv: all of the run.
    pub fn event_columns(&self) -> Vec<Column> {
        let (time, others) = self.wanted.columns().split_first().expect("a run has a time");
        let (others, derivatives) = others.split_at(others.partition_point(|column| !is_derivative(column)));
        let swept = self.written[..self.swept].iter().cloned();
        swept
            .chain([Column::new("event", "", "name of the event"), time.clone()])
            .chain([others, &self.times[..], derivatives].concat())
            .collect()
    }

    /// The run's columns that are written, with their indices in a row.
    pub(super) fn selected(&self) -> impl Iterator<Item = (usize, &Column)> {
        self.selected.iter().map(|&k| (k, &self.wanted.columns()[k]))
    }

    /// Whether a figure draws `case`.
    pub(super) fn draws(&self, case: usize) -> bool {
        self.drawing(case).next().is_some()
    }

    /// Indices in a row of the columns that `case` keeps for figures and metrics; `None` where there are none.
    pub(super) fn kept(&self, case: usize) -> Option<&[usize]> {
        (self.draws(case) || !self.metrics.is_empty()).then_some(self.wanted.kept())
    }

    /// The curves that figures draw of `case`, with their indices.
    pub(super) fn drawn(&self, case: usize) -> impl Iterator<Item = (usize, WantedCurve)> {
        self.drawing(case).flat_map(|figure| &figure.curves).map(|curve| (curve.index, self.wanted.curve(curve.index)))
    }

    /// The statistics that figures draw of `case`, with their indices.
    pub(super) fn summed(&self, case: usize) -> impl Iterator<Item = (usize, WantedTotal)> {
        let totals = self.drawing(case).flat_map(|figure| &figure.totals);
        totals.filter_map(|total| match total.what {
            Total::Statistic { index, .. } => Some((index, self.wanted.total(index))),
            Total::Metric(_) => None,
        })
    }

    /// The figures that draw `case`.
    fn drawing(&self, case: usize) -> impl Iterator<Item = &FigureData> {
        self.figures.iter().filter(move |figure| figure.cases.binary_search(&case).is_ok())
    }

    /// Points that each curve keeps at most.
    pub fn most_points(&self) -> usize {
        let counts = || self.figures.iter().map(FigureData::count);
        most_points(counts().max().unwrap_or(0), counts().sum())
    }

    /// The data of the figures, in the order of the scenario.
    pub fn figures(&self) -> &[FigureData] {
        &self.figures
    }
}

/// Whether a column is the derivative of another one.
fn is_derivative(column: &Column) -> bool {
    Quantity::of_derivative(&column.name).is_some()
}
