//! A first guess for robots: the equations of motion along the measured motion, without integrating it.
//!
//! With the measured coordinates in place of the motion, the forces that the free joints lack follow at once for any values of the parameters. Weighted by
//! φ = (1 − s²)³ over windows of rows, ∫φ(M a + b − Q) dt = −∫φ̇ M v dt + ∫φ(b − Ṁ v − Q) dt: the balance of momentum, in which the noise of accelerations
//! is gone. It is linear in stiffnesses, masses and dampings, and no guess is so far off that a motion runs away from the measured one.

use super::compared::{Predicted, Record};
use super::problem::Problem;
use super::smooth::smoothed;
use super::walk::{self, Ask};
use springpot::actuation::{Drive, Forward};
use springpot::identification::{self, Failed, Parameter, Rows, Scale, Series, Settings, reach};
use springpot::model::Model;
use springpot::motion::JointPath;
use springpot::observe::Quantity;
use springpot::sensitivity::{self, Seed, Sensitivity};
use springpot::signal::Signal;
use springpot::system::{self, Motion, RowTimes, System};
use springpot_scenario::DataKind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rows of a window, how many windows a record has at least, and how many of them begin in the length of one.
const WINDOW: usize = 25;
const WINDOWS: usize = 6;
const APART: usize = 4;
/// Fewest rows of a window.
const LEAST: usize = 7;
/// Rows from one knot of the motion to the next.
const KNOTS: usize = 2;
/// The first row is so early, in distances of rows, that the motion goes on to t = 0.
const EARLY: f64 = 3.0;
/// Of forces along the measured motion, and changes of the cost that do not matter to a guess, as a share.
const RTOL: f64 = 1e-5;
const NOISE: f64 = 1e-3;
/// Halvings of a range towards where a scenario can be read.
const HALVINGS: usize = 8;
/// Fits, each with the scatter of the one before as the size of its residuals.
const PASSES: usize = 2;
const STEPS: usize = 60;

/// Values that the equations of motion ask for, beginning at those of `start`; `None` where no record tells how all free joints move.
pub(super) fn guess(problem: &Problem<'_>, start: &[f64], stop: &AtomicBool) -> Option<Vec<f64>> {
    let mut balance = Balance::new(problem, start)?;
    let mut values = start.to_vec();
    for _ in 0..PASSES {
        if stop.load(Ordering::Relaxed) || !balance.measure(&values) {
            return None;
        }
        balance.parameters.iter_mut().zip(&values).for_each(|(own, value)| own.start = vec![*value]);
        let settings = Settings { starts: 1, steps: STEPS, ..Settings::default() };
        let reached = reach(&balance, &settings, 0, stop).ok().filter(|reached| reached.cost().is_finite())?;
        values = reached.values(&balance.parameters);
    }
    balance.tracks.iter().try_for_each(|track| track.begin(&balance.parameters, &mut values).ok()).map(|()| values)
}

/// Narrows bounds to where scenarios can be read, one parameter at a time from where it begins: inertias that no body has are no trials of a linear problem.
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
        }
    }
}

/// The equations of motion, and what else was measured, over windows of all records that tell how their robots move.
struct Balance<'a> {
    parameters: Vec<Parameter>,
    series: Vec<Series>,
    /// What residuals of each series are measured by.
    sizes: Vec<f64>,
    tracks: Vec<Track<'a>>,
}

/// A record along whose motion is gone.
struct Track<'a> {
    record: &'a Record<'a>,
    /// Its first series: a free joint each, then a column each.
    first: usize,
    /// The free joints: name, velocity, and how they move.
    joints: Vec<(String, usize, Signal)>,
    /// Columns that are compared along the motion.
    columns: Vec<usize>,
    /// First row and weights of each window.
    windows: Vec<(usize, Vec<f64>)>,
}

impl<'a> Balance<'a> {
    fn new(problem: &'a Problem<'a>, start: &[f64]) -> Option<Self> {
        let runs = problem.records.iter().filter(|record| record.data.is_fitted && record.data.kind == DataKind::Run);
        let mut tracks: Vec<Track<'a>> = Vec::new();
        for record in runs {
            let first = tracks.last().map_or(0, |last| last.first + last.count());
            tracks.extend(Track::new(record, first, start));
        }
        let count = tracks.last().map(|last| last.first + last.count())?;
        let series = (0..count).map(|k| Series::new(k.to_string())).collect();
        Some(Self { parameters: problem.parameters.clone(), series, sizes: vec![1.0; count], tracks })
    }

    /// Takes the scatter at these values for the sizes of residuals; whether there is any.
    fn measure(&mut self, values: &[f64]) -> bool {
        self.sizes.fill(1.0);
        let mut sums = vec![(0.0, 0usize); self.series.len()];
        let told = identification::Problem::rows(self, values, &vec![false; values.len()], &mut |own| {
            let (sum, rows) = &mut sums[own.series];
            *sum += own.residuals.iter().map(|r| r * r).sum::<f64>();
            *rows += own.residuals.len();
        });
        self.sizes = sums.into_iter().map(|(sum, rows)| (sum / rows as f64).sqrt().max(f64::MIN_POSITIVE)).collect();
        told.is_ok() && self.sizes.iter().all(|size| size.is_finite())
    }
}

impl identification::Problem for Balance<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn noise(&self) -> f64 {
        NOISE
    }

    fn rows(&self, values: &[f64], wanted: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let n = values.len();
        for track in &self.tracks {
            let along = track.along(values, wanted)?;
            for k in 0..track.count() {
                let size = self.sizes[track.first + k];
                let mut residuals = Vec::with_capacity(track.windows.len());
                let mut jacobian =
                    Vec::with_capacity(if along.slopes.is_empty() { 0 } else { track.windows.len() * n });
                for (first, weights) in &track.windows {
                    let rows = || weights.iter().enumerate().map(|(i, weight)| (weight / size, first + i));
                    residuals.push(rows().map(|(weight, row)| weight * along.gaps[k][row]).sum::<f64>());
                    if let Some(slopes) = along.slopes.get(k) {
                        let sum = |p: usize| rows().map(|(weight, row)| weight * slopes[row * n + p]).sum::<f64>();
                        jacobian.extend((0..n).map(sum));
                    }
                }
                take(Rows { series: track.first + k, residuals: &residuals, jacobian: &jacobian });
            }
        }
        Ok(())
    }
}

/// What lacks along a motion.
struct Along {
    /// By series, row by row.
    gaps: Vec<Vec<f64>>,
    /// By series, row by row, by each parameter of the fit; empty where none was asked for.
    slopes: Vec<Vec<f64>>,
}

impl<'a> Track<'a> {
    fn new(record: &'a Record<'a>, first: usize, start: &[f64]) -> Option<Self> {
        let (data, fitting) = (record.data, record.fitting);
        let plan = fitting.run_at(record.index, start, &vec![false; start.len()]).ok()?;
        let system = plan.system();
        let Motion::Forward(forward) = &system.motion else { return None };
        // What follows from the state is known in no row.
        let control = &system.control;
        if control.controller.is_some() || !control.torques.is_empty() || !control.inputs.is_empty() {
            return None;
        }
        let counted: Vec<f64> = record.rows.iter().map(|row| data.at[*row]).collect();
        let windows = windows(&counted)?;
        let apart = (data.at[data.at.len() - 1] - data.at[0]) / (data.at.len() - 1) as f64;
        if data.at[0] > EARLY * apart {
            return None;
        }
        let quantities = fitting.quantities(record.index);
        // Between these a smooth motion is a cubic.
        let last = data.at.len() - 1;
        let kept: Vec<usize> = (0..last).step_by(KNOTS).chain([last]).collect();
        let mut joints = Vec::new();
        for (j, drive) in system.model.own_joints().zip(&forward.drives) {
            if !matches!(drive, Drive::Force(_)) {
                continue;
            }
            let (q, v) = (system.model.q_range(j), system.model.v_range(j));
            if q.len() != 1 || v.len() != 1 {
                return None;
            }
            let column = quantities.iter().position(|quantity| *quantity == Quantity::Coordinate(q.start))?;
            let smooth = smoothed(&data.at, &data.columns[column].measured);
            let thin = |values: &[f64]| -> Vec<f64> { kept.iter().map(|row| values[*row]).collect() };
            let signal = Signal::spline(&thin(&data.at), &thin(&smooth)).ok()?;
            joints.push((system.model.joint_names()[j].clone(), v.start, signal));
        }
        let is_compared = |quantity: &Quantity| matches!(quantity, Quantity::Element(..) | Quantity::Torque(_));
        let columns = (0..quantities.len()).filter(|k| is_compared(&quantities[*k])).collect();
        (!joints.is_empty()).then_some(Self { record, first, joints, columns, windows })
    }

    /// How many series it has.
    fn count(&self) -> usize {
        self.joints.len() + self.columns.len()
    }

    /// The same with its free joints moved as measured.
    fn moved(&self, forward: &Forward, model: &Model) -> Forward {
        let drives = model.own_joints().zip(&forward.drives).map(|(j, drive)| {
            let own = self.joints.iter().find(|(name, ..)| *name == model.joint_names()[j]);
            own.map_or_else(|| drive.clone(), |(.., signal)| Drive::Prescribed(JointPath::Coordinate(signal.clone())))
        });
        Forward { drives: drives.collect(), ..forward.clone() }
    }

    /// The forces that the equations of motion lack beside those of the actuators, and measured columns, along the measured motion.
    fn along(&self, values: &[f64], wanted: &[bool]) -> Result<Along, Failed> {
        let (data, n) = (self.record.data, values.len());
        let plan = self.record.fitting.run_at(self.record.index, values, wanted).map_err(Failed)?;
        let mut system = plan.system();
        let Motion::Forward(forward) = system.motion.clone() else { return Err(Failed("no forward dynamics".into())) };
        let by = system.sensitivity.take();
        system.motion = self.moved(&forward, &system.model).into();
        system.events.clear();
        let (sensitivity, kept) = by.as_deref().map(|by| self.kept(by)).unwrap_or_default();
        system.sensitivity = (!kept.is_empty()).then(|| Arc::new(sensitivity));
        let sought: Vec<usize> = data.parameters.iter().copied().filter(|at| wanted[*at]).collect();
        let kept: Vec<usize> = kept.iter().map(|k| sought[*k]).collect();
        let (rows, is_differentiated) = (self.record.rows.len(), wanted.contains(&true));
        let room = |width: usize| vec![vec![0.0; rows * width]; self.count()];
        let slopes = room(if is_differentiated { n } else { 0 });
        let mut found = Predicted { is_differentiated, model: room(1), slopes, rates: room(1) };
        let end = data.at[data.at.len() - 1].min(plan.settings.end);
        let model = system.model.clone();
        let settings = system::Settings {
            rtol: RTOL,
            memory_rtol: 0.1 * RTOL,
            ..system::Settings::new(end, RowTimes::Times(vec![end].into()))
        };
        walk::walk(system, settings, self.asks(values), &kept, n, &mut found)?;
        let parameters = by.iter().flat_map(|by| &by.parameters).zip(sought).collect::<Vec<_>>();
        self.take_drives(&forward, &model, &parameters, &mut found);
        self.take_measured(values, wanted, &mut found);
        if found.model.iter().chain(&found.slopes).flatten().any(|x| !x.is_finite()) {
            return Err(Failed("no forces along the measured motion".into()));
        }
        Ok(Along { gaps: found.model, slopes: if is_differentiated { found.slopes } else { Vec::new() } })
    }

    /// What is wanted at the rows: the forces of the free joints, then the columns.
    fn asks(&self, values: &[f64]) -> Vec<Ask> {
        let (record, joints) = (self.record, self.joints.len());
        let quantities = record.fitting.quantities(record.index);
        let mut asks = Vec::new();
        for (row, at) in record.rows.iter().map(|row| record.data.at[*row]).enumerate() {
            asks.extend(self.joints.iter().enumerate().map(|(column, (_, velocity, _))| Ask {
                t: at,
                column,
                row,
                quantity: Quantity::Torque(*velocity),
                wants_rate: false,
            }));
            asks.extend(self.columns.iter().enumerate().map(|(k, &column)| {
                let late = record.data.columns[column].delay.map(|at| values[at]);
                let (t, wants_rate) = (at - late.unwrap_or(0.0), late.is_some());
                Ask { t, column: joints + k, row, quantity: quantities[column], wants_rate }
            }));
        }
        asks
    }

    /// Takes the forces of the actuators away.
    fn take_drives(
        &self,
        forward: &Forward,
        model: &Model,
        parameters: &[(&sensitivity::Parameter, usize)],
        found: &mut Predicted,
    ) {
        let n = found.slopes[0].len() / self.record.rows.len();
        let times: Vec<f64> = self.record.rows.iter().map(|row| self.record.data.at[*row]).collect();
        for (k, (_, own, _)) in self.joints.iter().enumerate() {
            let Some(drive) = force(model, forward, *own) else { continue };
            found.model[k].iter_mut().zip(&times).for_each(|(gap, t)| *gap -= drive.at(*t).value);
            for (parameter, at) in parameters {
                for seed in &parameter.seeds {
                    let Seed::Drive { velocity, by } = seed else { continue };
                    if velocity == own {
                        times.iter().enumerate().for_each(|(row, t)| found.slopes[k][row * n + at] -= by.at(*t).value);
                    }
                }
            }
        }
    }

    /// Takes what was measured away, with its zero and lateness.
    fn take_measured(&self, values: &[f64], wanted: &[bool], found: &mut Predicted) {
        let n = values.len();
        for (k, &column) in self.columns.iter().enumerate() {
            let (k, own) = (self.joints.len() + k, &self.record.data.columns[column]);
            let zero = own.offset.map_or(0.0, |at| values[at]);
            for (row, measured) in self.record.measured[column].iter().enumerate() {
                found.model[k][row] += zero - measured;
                if let Some(at) = own.offset.filter(|at| wanted[*at]) {
                    found.slopes[k][row * n + at] += 1.0;
                }
                if let Some(at) = own.delay.filter(|at| wanted[*at]) {
                    found.slopes[k][row * n + at] -= found.rates[k][row];
                }
            }
        }
    }

    /// What parameters move beside the motion, which is given, and which of them that are.
    fn kept(&self, by: &Sensitivity) -> (Sensitivity, Vec<usize>) {
        let is_given = |seed: &Seed| match seed {
            Seed::Position { velocity, .. } | Seed::Velocity { velocity, .. } | Seed::Drive { velocity, .. } => {
                self.joints.iter().any(|(_, own, _)| own == velocity)
            }
            Seed::Switch { .. } | Seed::When { .. } | Seed::WhenOfTime { .. } | Seed::Set { .. } => true,
            _ => false,
        };
        let mut kept = Vec::new();
        let mut parameters = by.parameters.clone();
        for (k, parameter) in parameters.iter_mut().enumerate() {
            parameter.seeds.retain(|seed| !is_given(seed));
            if !parameter.seeds.is_empty() {
                kept.push(k);
            }
        }
        let parameters = kept.iter().map(|k| parameters[*k].clone()).collect();
        let extended = by.extended.as_ref().map(|system| {
            let motion = match &system.motion {
                Motion::Forward(forward) => self.moved(forward, &system.model).into(),
                given @ Motion::Given(_) => given.clone(),
            };
            Arc::new(System { motion, events: Vec::new(), ..System::clone(system) })
        });
        (Sensitivity { parameters, extended, control: false, columns: Vec::new(), adjoint: None }, kept)
    }

    /// Puts parameters that say where the robot starts, and how fast, to where the record begins.
    fn begin(&self, parameters: &[Parameter], values: &mut [f64]) -> Result<(), String> {
        let data = self.record.data;
        let plan = self.record.fitting.run_at(self.record.index, values, &vec![true; values.len()])?;
        let system = plan.system();
        let (Motion::Forward(forward), Some(by)) = (&system.motion, &system.sensitivity) else { return Ok(()) };
        for (own, &at) in by.parameters.iter().zip(&data.parameters) {
            let [Seed::Position { velocity, by } | Seed::Velocity { velocity, by }] = &own.seeds[..] else { continue };
            let Some((name, _, signal)) = self.joints.iter().find(|(_, own, _)| own == velocity) else { continue };
            let jet = signal.at(0.0);
            let now = match &own.seeds[0] {
                Seed::Position { .. } => {
                    let joint = system.model.joint_index(name).ok_or("a joint that is gone")?;
                    jet.value - forward.q[system.model.q_range(joint).start]
                }
                _ => jet.first - forward.v[*velocity],
            };
            let [low, high] = parameters[at].bounds;
            values[at] = (values[at] + now / by).clamp(low, high);
        }
        Ok(())
    }
}

/// What drives a velocity.
fn force<'a>(model: &Model, forward: &'a Forward, velocity: usize) -> Option<&'a Signal> {
    let mut drives = model.own_joints().zip(&forward.drives);
    drives.find_map(|(j, drive)| match drive {
        Drive::Force(signals) if model.v_range(j).start == velocity => signals.first(),
        _ => None,
    })
}

/// First row and weights of windows over rows at these times; `None` of too few.
fn windows(at: &[f64]) -> Option<Vec<(usize, Vec<f64>)>> {
    let rows = WINDOW.min(at.len() / WINDOWS);
    if rows < LEAST {
        return None;
    }
    let apart = (rows / APART).max(1);
    let own = |first: usize| {
        let last = first + rows - 1;
        let (middle, half) = (0.5 * (at[first] + at[last]), 0.5 * (at[last] - at[first]));
        let weight = |row: usize| {
            let wide = at[(row + 1).min(last)] - at[row.saturating_sub(1).max(first)];
            (1.0 - ((at[row] - middle) / half).powi(2)).max(0.0).powi(3) * wide
        };
        let weights: Vec<f64> = (first..=last).map(weight).collect();
        let size = weights.iter().map(|x| x * x).sum::<f64>().sqrt();
        (first, weights.into_iter().map(|x| x / size).collect())
    };
    Some((0..=at.len() - rows).step_by(apart).map(own).collect())
}
