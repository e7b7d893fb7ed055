//! The force of one element along a measured stroke.

use springpot::elements::Element;
use springpot::elements::Joint;
use springpot::identification::Failed;
use springpot::model::{BodySpec, JointSpec, Model, ModelBuilder, Parent};
use springpot::motion::{JointPath, Trajectory};
use springpot::sensitivity::{Parameter, Seed, Sensitivity};
use springpot::signal::Signal;
use springpot::system::{RowTimes, Settings, System};
use springpot_scenario::{Fitting, MaterialAt, Moved, PastOfStroke};
use std::f64::consts::PI;
use std::sync::Arc;

/// Relative tolerance of D^alpha along the stroke.
const RTOL: f64 = 1e-8;
/// The same where a part of the samples shows where to begin.
const ROUGH_RTOL: f64 = 1e-6;
/// Samples are equally far apart where their distances differ by less, as a share.
const EVEN: f64 = 0.02;
/// Rates of an unknown past, from this over the record to this over the distance of samples.
const SLOWEST: f64 = 0.3;
const FASTEST: f64 = 0.02;
const RATES: usize = 6;
/// Rows of the beginning that an unknown past leaves out, in times of its fastest rate.
const LEFT_OUT: f64 = 2.0;

/// The record of a stroke made ready.
pub(super) struct Stroke {
    model: Arc<Model>,
    joint: Joint,
    signal: Signal,
    /// From the first sample on, s.
    times: Vec<f64>,
    /// Relative tolerances of D^alpha, and of its memory.
    rtol: [f64; 2],
    /// The force where it was filtered.
    pub(super) force: Option<Vec<f64>>,
    /// Rows before this time of the record are not used, s.
    pub(super) unused: f64,
    /// Rates of an unknown past, 1/s.
    pub(super) rates: Vec<f64>,
}

impl Stroke {
    /// With every `step`-th sample.
    pub(super) fn new(fitting: &Fitting, index: usize, step: usize) -> Result<Self, String> {
        let data = &fitting.plan().data[index];
        let name = &data.name;
        let mut stroke = data.told("stroke").unwrap_or_default().to_vec();
        let times: Vec<f64> = data.at.iter().map(|t| t - data.at[0]).collect();
        if times.len() < 3 {
            return Err(format!("data {name:?}: a stroke takes three rows at least"));
        }
        let apart = times[times.len() - 1] / (times.len() - 1) as f64;
        let mut force = None;
        if let Some(corner) = data.low_pass {
            if times.windows(2).any(|pair| ((pair[1] - pair[0]) / apart - 1.0).abs() > EVEN) {
                return Err(format!("data {name:?}: `low_pass` takes samples that are equally far apart in time"));
            }
            if corner * apart >= 0.5 {
                return Err(format!(
                    "data {name:?}: `low_pass` of {corner} Hz is not below half of the {} Hz of the samples",
                    1.0 / apart
                ));
            }
            stroke = low_passed(&stroke, corner * apart);
            force = Some(low_passed(&data.columns[0].measured, corner * apart));
        }
        let thin = |values: &[f64]| values.iter().step_by(step).copied().collect::<Vec<_>>();
        let (coarse, stroke) = (thin(&times), thin(&stroke));
        let signal = Signal::spline(&coarse, &stroke).map_err(|error| format!("data {name:?}: {error}"))?;
        let (mut rates, mut unused) = (Vec::new(), 0.0);
        if data.past == PastOfStroke::Free {
            let span = times[times.len() - 1];
            let (slow, fast) = (SLOWEST / span, (FASTEST / apart).max(10.0 / span));
            rates = (0..RATES).map(|k| slow * (fast / slow).powf(k as f64 / (RATES - 1) as f64)).collect();
            unused = LEFT_OUT / fast;
        } else if data.past == PastOfStroke::Unloaded && stroke[0] != 0.0 {
            // The force is singular at the jump.
            unused = 1e-9 * apart;
        }
        let mut builder = ModelBuilder::new([0.0; 3]);
        builder.accept_idle_joints();
        let joint = JointSpec::prismatic("s", [1.0, 0.0, 0.0], [0.0; 3]);
        let body = BodySpec {
            name: "end".into(),
            parent: Parent::World,
            joint,
            mass: 1.0,
            com: [0.0; 3],
            inertia: [[0.0; 3]; 3],
        };
        builder.push(body).map_err(|error| error.to_string())?;
        let model = builder.finish().map_err(|error| error.to_string())?;
        let joint = Joint::new(&model, 0).map_err(|error| error.to_string())?;
        let rtol = if step > 1 { [ROUGH_RTOL, 0.1 * ROUGH_RTOL] } else { [RTOL, 0.01 * RTOL] };
        Ok(Self { model: model.into(), joint, signal, rtol, times, force, unused, rates })
    }

    /// A slider that follows the stroke with the element on it, and which parameter of the record each of its own is.
    pub(super) fn system(
        &self,
        fitting: &Fitting,
        index: usize,
        values: &[f64],
        wanted: &[bool],
    ) -> Result<(System, Settings, Vec<usize>), Failed> {
        let data = &fitting.plan().data[index];
        let MaterialAt { law, entry, parameters, moved, .. } = fitting.material_at(index, values).map_err(Failed)?;
        let derivative = match data.past {
            PastOfStroke::Unloaded => springpot::law::Derivative::RiemannLiouville,
            _ => springpot::law::Derivative::Caputo,
        };
        let element = Element::new("e", self.joint, 0.0, &entry, &parameters, derivative);
        let mut element = element.map_err(|error| Failed(error.to_string()))?;
        element.law = law;
        for (name, signal) in fitting.inputs(index) {
            let told = data
                .told(&name)
                .map(|values| Signal::linear(&self.times, values).map_err(|error| Failed(error.to_string())));
            element.inputs.push(told.transpose()?.or(signal).unwrap_or_else(|| Signal::constant(0.0)));
        }
        let mut by = Vec::new();
        let mut sought = Vec::new();
        for (k, moved) in moved.into_iter().enumerate().filter(|(k, _)| wanted[data.parameters[*k]]) {
            let law = match moved {
                Moved::Nothing => continue,
                Moved::Law(law) => law,
                Moved::Clock(name) => {
                    return Err(Failed(format!("no derivative by shift.{name} is known along a stroke")));
                }
            };
            by.push(k);
            let own = &fitting.plan().parameters[data.parameters[k]];
            sought.push(Parameter {
                name: own.sought.name.clone(),
                value: values[data.parameters[k]],
                typical: own.sought.typical,
                seeds: vec![Seed::Law { element: 0, law }],
            });
        }
        let sensitivity =
            (!sought.is_empty()).then(|| Arc::new(Sensitivity { parameters: sought, ..Sensitivity::default() }));
        let motion = Trajectory::Prescribed(vec![JointPath::Coordinate(self.signal.clone())]);
        let system = System { sensitivity, ..System::new(self.model.clone(), vec![element], motion) };
        let end = self.times[self.times.len() - 1];
        let settings = Settings {
            rtol: self.rtol[0],
            memory_rtol: self.rtol[1],
            ..Settings::new(end, RowTimes::Times(vec![end].into()))
        };
        Ok((system, settings, by))
    }
}

/// Samples through a Butterworth filter of second order, forwards and then backwards, so that nothing is late; `corner` in cycles a sample. The
/// ends are continued by reflection through the last sample, and the filter begins at rest there.
fn low_passed(samples: &[f64], corner: f64) -> Vec<f64> {
    // The corner of both passes together is where the gain is 1/√2.
    let warped = (PI * corner / (2.0_f64.sqrt() - 1.0).powf(0.25)).min(0.499 * PI).tan();
    let square = warped * warped;
    let whole = 1.0 + 2.0_f64.sqrt() * warped + square;
    let (gain, back) =
        (square / whole, [2.0 * (square - 1.0) / whole, (1.0 - 2.0_f64.sqrt() * warped + square) / whole]);
    let pass = |samples: &mut Vec<f64>| {
        let first = samples[0];
        let (mut x, mut y) = ([first; 2], [first; 2]);
        for sample in samples.iter_mut() {
            let own = gain * (*sample + 2.0 * x[0] + x[1]) - back[0] * y[0] - back[1] * y[1];
            (x, y) = ([*sample, x[0]], [own, y[0]]);
            *sample = own;
        }
        samples.reverse();
    };
    let count = samples.len();
    let beyond = ((3.0 / corner).ceil() as usize).min(count - 1);
    let (first, last) = (samples[0], samples[count - 1]);
    let before = (1..=beyond).rev().map(|k| 2.0 * first - samples[k]);
    let behind = (1..=beyond).map(|k| 2.0 * last - samples[count - 1 - k]);
    let mut all: Vec<f64> = before.chain(samples.iter().copied()).chain(behind).collect();
    pass(&mut all);
    pass(&mut all);
    all[beyond..beyond + count].to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_low_pass_takes_what_is_fast_and_shifts_nothing() {
        let of = |hertz: f64| -> Vec<f64> { (0..2000).map(|k| (2.0 * PI * hertz * k as f64 * 1e-3).sin()).collect() };
        let slow = low_passed(&of(0.5), 0.01);
        assert!(slow.iter().zip(of(0.5)).all(|(a, b)| (a - b).abs() < 2e-3));
        assert!(low_passed(&of(200.0), 0.01)[300..1700].iter().all(|x| x.abs() < 1e-3));
        let corner = low_passed(&of(10.0), 0.01);
        let most = corner[500..1500].iter().fold(0.0, |most: f64, x| most.max(*x));
        assert!((most - 0.5_f64.sqrt()).abs() < 0.01, "{most}");
    }
}
