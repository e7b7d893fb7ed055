//! A record along whose motion is gone: the free joints of its robot are moved as they were measured.

use super::compared::{Predicted, Record};
use super::smooth::smoothed;
use super::walk::{self, Ask};
use springpot::actuation::{Drive, Forward};
use springpot::identification::{Failed, Parameter};
use springpot::model::Model;
use springpot::motion::JointPath;
use springpot::observe::Quantity;
use springpot::sensitivity::{self, Seed, Sensitivity};
use springpot::signal::Signal;
use springpot::system::{self, Motion, RowTimes, System};
use std::sync::Arc;

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
/// Of forces along the measured motion.
const RTOL: f64 = 1e-5;

/// A record along whose motion is gone.
pub(super) struct Track<'a> {
    record: &'a Record<'a>,
    /// Its first series: a free joint each, then a column each.
    pub(super) first: usize,
    /// The free joints: name, velocity, and how they move.
    joints: Vec<(String, usize, Signal)>,
    /// Columns that are compared along the motion.
    columns: Vec<usize>,
    /// First row and weights of each window.
    pub(super) windows: Vec<(usize, Vec<f64>)>,
}

/// What lacks along a motion.
pub(super) struct Along {
    /// By series, row by row.
    pub(super) gaps: Vec<Vec<f64>>,
    /// By series, row by row, by each parameter of the fit; empty where none was asked for.
    pub(super) slopes: Vec<Vec<f64>>,
}

impl<'a> Track<'a> {
    pub(super) fn new(record: &'a Record<'a>, first: usize, start: &[f64]) -> Option<Self> {
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
    pub(super) fn count(&self) -> usize {
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
    pub(super) fn along(&self, values: &[f64], wanted: &[bool]) -> Result<Along, Failed> {
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
    pub(super) fn begin(&self, parameters: &[Parameter], values: &mut [f64]) -> Result<(), String> {
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
