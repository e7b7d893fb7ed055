//! A scenario that was looked through: its cases, run in memory or into a folder, here or elsewhere.

use super::case::Case;
use super::source::{Called, Keeping, Known, is_same};
use crate::error::{case_error, guarded, run_error_at, scenario_error, springpot_error, value_error};
use crate::interrupt::watched;
use crate::pickle::{self, Reduced, reduced};
use crate::scenario::{CATALOG, asked};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use springpot::system::Stop;
use springpot_run::sweep::{CheckpointError, Outcome, Parcel, Progress, Source, Status, SweepError, Unfinished};
use springpot_run::table::Format;
use springpot_run::table::disk::Disk;
use springpot_run::{Asked, BeginError, NewRun, Planned, Prepared, Surroundings, Warning, labels};
use springpot_scenario::SweptValue;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// What the bytes of a study begin with.
const TAG: &str = "springpot study 2\n";

/// The cases of a scenario, each of which can be run in any process.
#[pyclass(frozen, module = "springpot._springpot")]
pub(crate) struct Study {
    asked: Asked,
    planned: Arc<Planned>,
    /// What deserves a warning, with what to do about it.
    warnings: Vec<(String, Option<String>)>,
}

#[pymethods]
impl Study {
    /// `sweeps`: texts `PATH=v1,v2,…`; `sensitivity`: paths, or names of parameters.
    #[new]
    #[pyo3(signature = (scenario, set = None, sweeps = Vec::new(), sensitivity = Vec::new()))]
    fn new(
        scenario: &Bound<'_, PyAny>,
        set: Option<&Bound<'_, PyAny>>,
        sweeps: Vec<String>,
        sensitivity: Vec<String>,
    ) -> PyResult<Self> {
        let py = scenario.py();
        guarded(py, || Self::of(py, Asked { sweeps, sensitivity, ..asked(scenario, set)? }))
    }

    /// What `to_bytes` made; files that the scenario names must be there too.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let asked = pickle::of_bytes(TAG, "study", bytes)?;
        guarded(py, || Self::of(py, asked))
    }

    /// The scenario with all that was set and swept.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        pickle::to_bytes(py, TAG, &self.asked)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "from_bytes", self.to_bytes(py)?)
    }

    /// Number of cases.
    fn __len__(&self) -> usize {
        self.planned.cases.len()
    }

    /// The title of the scenario.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.planned.plan.title.as_deref()
    }

    /// Name and text of the scenario, and what was set and swept beside it.
    #[getter]
    fn scenario(&self) -> (String, String, Vec<String>, Vec<String>) {
        let Asked { name, text, overrides, sweeps, .. } = self.asked.clone();
        (name, text, overrides, sweeps)
    }

    /// What deserves a warning, each with what to do about it.
    #[getter]
    fn warnings(&self) -> Vec<(String, Option<String>)> {
        self.warnings.clone()
    }

    /// Paths of the swept parameters.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.planned.cases.parameters().to_vec()
    }

    /// By sweep the paths that move together, the number of its values, and what they are called where they have names.
    #[getter]
    fn axes(&self) -> Vec<(Vec<String>, usize, Option<Vec<String>>)> {
        let cases = &self.planned.cases;
        let axis = |axis: usize| {
            let paths = cases.axis_parameters(axis).map(str::to_owned).collect();
            (paths, cases.axis_len(axis), cases.axis_names(axis).map(<[String]>::to_vec))
        };
        (0..cases.axis_count()).map(axis).collect()
    }

    /// Name, paths, value and unit of what the first case is differentiated by.
    #[getter]
    fn differentiated(&self) -> Vec<(String, Vec<String>, f64, String)> {
        let sensitivity = self.planned.plan.sensitivity.iter().filter(|plan| plan.is_asked());
        let parameters = sensitivity.flat_map(|plan| &plan.parameters);
        parameters.map(|own| (own.name.clone(), own.paths.clone(), own.value, own.unit.clone())).collect()
    }

    /// What gives the parameters of the first case values, SI, in their order: `PATH=VALUE`.
    fn assignments(&self, values: Vec<f64>) -> Vec<String> {
        let sensitivity = self.planned.plan.sensitivity.iter();
        let parameters = sensitivity.flat_map(|plan| &plan.parameters).zip(values);
        parameters.flat_map(|(own, value)| own.assignments(value).collect::<Vec<_>>()).collect()
    }

    /// Name, unit and meaning of every column, those of swept parameters first.
    #[getter]
    fn columns(&self) -> Vec<(String, String, String)> {
        let columns = self.planned.layout.written().iter();
        columns.map(|column| (column.name.clone(), column.unit.clone(), column.meaning.clone())).collect()
    }

    /// What stands at an axis that shows a column.
    fn axis(&self, column: usize) -> PyResult<String> {
        let columns = self.planned.layout.written();
        let found = columns.get(column).ok_or_else(|| value_error(format!("column {column} of {}", columns.len())))?;
        Ok(labels::axis(found, None))
    }

    /// Names of the events.
    #[getter]
    fn events(&self) -> Vec<String> {
        self.planned.layout.events().to_vec()
    }

    /// Names and columns of events.csv behind the swept parameters.
    #[getter]
    fn event_columns(&self) -> Vec<String> {
        let layout = &self.planned.layout;
        layout.event_columns().into_iter().skip(layout.swept() + 1).map(|column| column.name).collect()
    }

    /// Name, column and unit of every metric.
    #[getter]
    fn metrics(&self) -> Vec<(String, String, String)> {
        let plans = self.planned.plan.metrics.iter();
        let units = self.planned.layout.metric_units();
        plans.zip(units).map(|(plan, [name, unit])| (name, plan.metric.of.clone(), unit)).collect()
    }

    /// The swept values of a case: numbers in SI units, or texts.
    fn values<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyList>> {
        let index = self.checked(index)?;
        let values = PyList::empty(py);
        for value in self.planned.cases.values(index) {
            match value {
                SweptValue::Number(number) => values.append(number)?,
                SweptValue::Text(text) => values.append(text)?,
            }
        }
        Ok(values)
    }

    /// The swept values of a case as they are written.
    fn name(&self, index: usize) -> PyResult<String> {
        Ok(self.planned.cases.name(self.checked(index)?))
    }

    /// Runs one case.
    fn case(&self, py: Python<'_>, index: usize) -> PyResult<Case> {
        let cases = self.cases(py, vec![index], 1, None)?;
        Ok(Case(cases.into_iter().next().map(|case| case.0).expect("one case")))
    }

    /// Runs cases, `jobs` at a time; `progress` is called now and then with the share that is done.
    #[pyo3(signature = (indices, jobs = 0, progress = None))]
    fn cases(
        &self,
        py: Python<'_>,
        indices: Vec<usize>,
        jobs: usize,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<Case>> {
        indices.iter().try_for_each(|&index| self.checked(index).map(drop))?;
        let (stop, seen) = (Stop::new(false), Progress::default());
        let wanted = (indices.len() as u64).saturating_mul(self.planned.plan.settings.rows.count() as u64);
        let look = |_: Python<'_>| tell(progress, &seen, wanted);
        let found = guarded(py, || {
            let (found, told) = watched(py, &stop, look, || self.run(&indices, workers(jobs), &stop, &seen));
            told.map(|()| found)
        })?;
        found.map(|cases| cases.into_iter().map(Case).collect()).ok_or_else(|| interrupted(py))
    }

    /// Writes a run into the folder `out` as the command does, and gives how it ended, the warnings, and the cases that were run. `cases` are those
    /// that were run before, or a callable that gives one of an index; without them they are run here. With `journal` an interrupted run can be
    /// gone on with (`resume`).
    #[pyo3(signature = (out, cases = None, jobs = 0, format = "csv", figures = true, journal = false, resume = false, progress = None))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword")]
    fn write<'py>(
        &self,
        py: Python<'py>,
        out: PathBuf,
        cases: Option<&Bound<'py, PyAny>>,
        jobs: usize,
        format: &str,
        figures: bool,
        journal: bool,
        resume: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let format = Format::named(format)
            .ok_or_else(|| value_error(format!("format {format:?}: there are \"csv\", \"parquet\" and \"npz\"")))?;
        let stop = Arc::new(Stop::new(false));
        let kept = Arc::new(Mutex::new(vec![None; self.planned.cases.len()]));
        let raised = Arc::new(Mutex::new(None));
        let (source, jobs): (Box<dyn Source>, usize) = match cases {
            None => {
                let keeping = Keeping { planned: self.planned.clone(), stop: stop.clone(), kept: kept.clone() };
                (Box::new(keeping), workers(jobs))
            }
            // One at a time: they come from elsewhere.
            Some(get) if get.is_callable() => {
                let called = Called { get: get.clone().unbind(), raised: raised.clone(), stop: stop.clone() };
                (Box::new(called), 1)
            }
            Some(cases) => (Box::new(self.known(cases)?), workers(jobs)),
        };
        let (disk, seen) = (Disk::default(), Progress::default());
        let mut warnings: Vec<(String, Option<String>)> = Vec::new();
        let with = Surroundings { catalog: &CATALOG, disk: &disk, stop: &stop, holder: "springpot in Python" };
        let mut warn = |warning: Warning| warnings.push((warning.message, warning.help));
        let found = if resume && out.is_dir() { self.resumed(py, &out, figures, with, &mut warn)? } else { None };
        let mut earlier = Vec::new();
        let mut prepared = match found {
            Some((prepared, ended)) => {
                earlier = ended;
                prepared
            }
            None => {
                let checkpoint_every = journal.then_some(f64::INFINITY);
                let new = NewRun {
                    asked: self.asked.clone(),
                    out: Some(out),
                    format,
                    figures,
                    checkpoint_every,
                    shard: None,
                };
                Prepared::begin(new, with, &mut warn).map_err(|error| begin_error(py, error))?
            }
        };
        warnings.clear();
        prepared.source = Some(source);
        let wanted = prepared.rows_wanted();
        let look = |_: Python<'_>| tell(progress, &seen, wanted);
        let (outcome, told) = guarded(py, || Ok(watched(py, &stop, look, || prepared.sweep(jobs, &stop, &seen))))?;
        let raised = raised.lock().unwrap_or_else(PoisonError::into_inner).take().or(told.err());
        let mut warn = |warning: Warning| warnings.push((warning.message, warning.help));
        // What has ended is put in its place before an exception goes on.
        let finished = match outcome {
            Ok(outcome) => {
                py.detach(|| prepared.finish(outcome, &seen, &mut warn)).map_err(|error| springpot_error(py, error))
            }
            Err(SweepError::Refused(refusals)) => Err(scenario_error(py, &refusals)),
            Err(SweepError::Output(error)) => Err(error.into()),
        };
        let finished = raised.map_or(finished, Err)?;
        let told = PyDict::new(py);
        told.set_item("status", status(&finished.outcome))?;
        told.set_item("folder", finished.folder.path())?;
        told.set_item("files", finished.folder.files())?;
        told.set_item("warnings", warnings)?;
        let kept = std::mem::take(&mut *kept.lock().unwrap_or_else(PoisonError::into_inner));
        let earlier = earlier.into_iter().map(Arc::new);
        let kept: PyResult<Vec<Py<Case>>> =
            earlier.chain(kept.into_iter().flatten()).map(|parcel| Py::new(py, Case(parcel))).collect();
        told.set_item("cases", kept?)?;
        Ok(told)
    }
}

impl Study {
    fn of(py: Python<'_>, asked: Asked) -> PyResult<Self> {
        let refused = |refusals| scenario_error(py, &refusals);
        let scenario = asked.scenario().map_err(refused)?;
        let mut warnings = Vec::new();
        let stop = Stop::new(false);
        let mut warn = |warning: Warning| warnings.push((warning.message, warning.help));
        let planned = py.detach(|| Planned::of(&scenario, &CATALOG, &stop, &mut warn)).map_err(refused)?;
        Ok(Self { asked, planned: Arc::new(planned), warnings })
    }

    fn checked(&self, index: usize) -> PyResult<usize> {
        let count = self.planned.cases.len();
        if index < count {
            Ok(index)
        } else {
            Err(pyo3::exceptions::PyIndexError::new_err(format!("case {index} of {count}")))
        }
    }

    /// Cases that were run before, in the places of their indices.
    fn known(&self, cases: &Bound<'_, PyAny>) -> PyResult<Known> {
        let mut known = vec![None; self.planned.cases.len()];
        for case in cases.extract::<Vec<Py<Case>>>()? {
            let parcel = case.get().0.clone();
            if !parcel.is_whole() {
                return Err(value_error("of the cases some columns were kept alone: nothing is written of them"));
            }
            let place = known.get_mut(parcel.index()).ok_or_else(|| value_error("a case of another study"))?;
            *place = Some(parcel);
        }
        Ok(Known(known))
    }

    /// Runs cases on threads; `None` where they were interrupted.
    fn run(&self, indices: &[usize], jobs: usize, stop: &Stop, seen: &Progress) -> Option<Vec<Arc<Parcel>>> {
        let Planned { cases, layout, .. } = &*self.planned;
        let (next, done) = (AtomicUsize::new(0), Mutex::new(vec![None; indices.len()]));
        let work = || {
            while !stop.load(Ordering::Relaxed) {
                let k = next.fetch_add(1, Ordering::Relaxed);
                let Some(&index) = indices.get(k) else { break };
                let Some(parcel) = Parcel::run(cases, layout, index, stop, seen) else { break };
                done.lock().unwrap_or_else(PoisonError::into_inner)[k] = Some(Arc::new(parcel));
            }
        };
        std::thread::scope(|scope| {
            let spawn = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
            let others: Vec<_> = (1..jobs.min(indices.len())).map_while(spawn).collect();
            work();
            others.into_iter().for_each(|other| other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        });
        done.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect()
    }

    /// The run in a folder that can be gone on with, and the cases that have ended in it; `None` where none is there.
    fn resumed(
        &self,
        py: Python<'_>,
        out: &Path,
        figures: bool,
        with: Surroundings<'_>,
        warn: &mut dyn FnMut(Warning),
    ) -> PyResult<Option<(Prepared, Vec<Parcel>)>> {
        let none = |error: &CheckpointError| {
            matches!(
                error,
                CheckpointError::Missing(_) | CheckpointError::Finished(_) | CheckpointError::Settled { .. }
            )
        };
        match Unfinished::read(out, with.disk.clone(), with.holder) {
            Ok(unfinished) if !is_same(&unfinished.origin().asked, &self.asked) => {
                let message = format!("{} holds another run, which is not at its end", out.display());
                return Err(springpot_error(py, message));
            }
            Ok(_) => {}
            Err(error) if none(&error) => return Ok(None),
            Err(error) => return Err(springpot_error(py, error)),
        }
        let failed = |error| springpot_error(py, error);
        let ended = Parcel::under_way(out, with.disk, with.holder, &self.planned.layout).map_err(failed)?;
        Prepared::resume(out, None, figures, with, warn).map(|prepared| Some((prepared, ended))).map_err(failed)
    }
}

/// `jobs`, or all cores.
fn workers(jobs: usize) -> usize {
    if jobs > 0 { jobs } else { std::thread::available_parallelism().map_or(1, usize::from) }
}

/// Tells a callable which share of the rows is there.
fn tell(progress: Option<&Bound<'_, PyAny>>, seen: &Progress, wanted: u64) -> PyResult<()> {
    let Some(progress) = progress else { return Ok(()) };
    let share = seen.rows.load(Ordering::Relaxed) as f64 / wanted.max(1) as f64;
    progress.call1((share.min(1.0),)).map(drop)
}

fn status(outcome: &Outcome) -> &'static str {
    match outcome.status {
        Status::Done => "done",
        Status::Failed => "failed",
        Status::Interrupted => "interrupted",
    }
}

fn interrupted(py: Python<'_>) -> PyErr {
    run_error_at(py, "interrupted", None)
}

fn begin_error(py: Python<'_>, error: BeginError) -> PyErr {
    match error {
        BeginError::Refused(refusals) => scenario_error(py, &refusals),
        BeginError::Hopeless { ref survey, .. } => {
            let first = survey.failures.first();
            first.map_or_else(|| run_error_at(py, &error, None), |(_, why)| case_error(py, why))
        }
        BeginError::Interrupted => interrupted(py),
        BeginError::Folder { .. } => springpot_error(py, error),
    }
}
