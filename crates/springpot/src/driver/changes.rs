//! What parameters change of the times at which something happens: events, and where the motion starts anew.

use super::time_loop::Driver;
use crate::account::recorder::Recorder;
use crate::equations::context::Context;
use crate::equations::{Node, Variation};
use crate::observe::{ElementQuantity, Quantity, Snapshot};
use crate::signal::{Jet, Signal};
use crate::system::error::RunError;
use crate::system::sensitivity::{Lost, Switched};
use crate::system::{Event, Motion, System};

/// Rates along a step are differences of five values this far apart, in units of the way to its far end, exact for its polynomials but for rounding.
const APART: f64 = 1.0 / 32.0;
const BACKWARDS: [f64; 4] = [-4.0, 3.0, -4.0 / 3.0, 0.25];

/// Below this share of what it is made of, the rate of a function that passes zero is none.
const GRAZES: f64 = 1e-9;

impl Driver {
    /// Where derivatives ended, but of a run that is gone back through.
    pub(super) fn lost(&self) -> impl Iterator<Item = &Lost> {
        let variation = self.recorder.variation.iter().filter(|_| !self.is_recorded());
        variation.flat_map(|variation| variation.lost()).flatten()
    }

    /// What parameters change on the far side of what was crossed, where velocities and accelerations were `before`; at a change of the robot's own
    /// where `is_own`.
    ///
    /// # Errors
    /// Where derivatives cannot go on.
    pub(super) fn settle_variation(&mut self, before: [&[f64]; 2], is_own: bool) -> Result<(), RunError> {
        let Recorder { evaluations: [at, ..], equations, variation, recording, .. } = &mut self.recorder;
        recording.iter_mut().for_each(|recording| recording.note(false));
        if let Some(variation) = variation {
            let a = self.solver.stepper().starts_with().map_or(&at.a[..], |[_, a]| a);
            variation.settle(equations, Node { t: at.t, q: &at.q, v: &at.v, a }, [before, [&at.v, &at.a]], is_own)?;
        }
        Ok(())
    }

    /// What parameters change where an event set what was set already: the motion goes on as it did, its derivatives by what was set do not.
    ///
    /// # Errors
    /// As of [`Self::settle_variation`].
    pub(super) fn settle_still(&mut self) -> Result<(), RunError> {
        if !self.recorder.variation.as_ref().is_some_and(|variation| variation.is_about_to_change()) {
            return Ok(());
        }
        let [at, ..] = &self.recorder.evaluations;
        let own = [at.v.clone(), at.a.clone()];
        self.settle_variation(own.each_ref().map(|own| &own[..]), false)
    }

    /// How much later joints come to rest and forces of elements jump, for what was noted at the present time, behind a step of size `h`.
    pub(super) fn vary_changes(&mut self, h: f64) {
        let Recorder { evaluations: [at, ..], equations, variation, .. } = &mut self.recorder;
        if let Some(variation) = variation {
            variation.stop(equations.stopping(), at);
            if equations.may_have_jumped() {
                variation.hit(at, h);
            }
        }
    }

    /// How much later functions of time switch that do so between two times.
    pub(super) fn vary_switches(&mut self, cx: Context, [before, after]: [f64; 2]) {
        let Recorder { equations, variation: Some(variation), .. } = &mut self.recorder else { return };
        let sources: Vec<(Switched, &Signal)> = sources(cx.system).filter(|(_, signal)| signal.has_kinks()).collect();
        let switches = |of: Switched| {
            let own = sources.iter().find(|(source, _)| *source == of);
            own.is_some_and(|(_, signal)| signal.branch(before) != signal.branch(after) || signal.turns_at(before))
        };
        let all: Vec<Switched> = sources.iter().map(|(source, _)| *source).collect();
        variation.switch(equations, [before, after], switches, &all);
    }

    /// What an event sets at a time, s, which comes later by so much, parameter by parameter.
    pub(super) fn vary_event(&mut self, cx: Context, number: usize, at: (f64, Vec<f64>)) {
        if let Recorder { equations, variation: Some(variation), .. } = &mut self.recorder {
            variation.set(equations, (number, &cx.system.watched_events()[number]), at);
        }
    }

    /// An input is held from outside at a value that no parameter moves, or given back to its signal.
    pub(super) fn hold_input(&mut self, at: [usize; 2], is_held: bool) {
        if let Some(variation) = &mut self.recorder.variation {
            let still = vec![0.0; variation.count()];
            variation.hold_input(at, is_held.then_some(still));
        }
    }

    /// How much later the function of an event passes zero, which does so at `t`, s, parameter by parameter: δt* = −δγ/γ̇; no number where it
    /// does so in no way or in several. `None` where nobody asks for derivatives.
    ///
    /// # Errors
    /// What a row there may show.
    pub(super) fn passage(&mut self, cx: Context, event: usize, t: f64) -> Result<Option<Vec<f64>>, RunError> {
        let Some(variation) = &self.recorder.variation else { return Ok(None) };
        let count = variation.count();
        if self.step_at_hand().is_none() {
            let crossed = variation.crossed(t);
            // It passed zero in a jump.
            if crossed.iter().any(|later| *later != 0.0) {
                return Ok(Some(crossed));
            }
        }
        let Event { when, columns, .. } = &cx.system.watched_events()[event];
        let mut shown = Snapshot::new(cx.system);
        let theta = self.read(cx, t, 0, &mut shown)?;
        let rates = self.rates(cx, columns, &shown)?;
        let values: Vec<f64> = columns.iter().map(|of| shown.value(*of)).collect();
        let jets: Vec<Jet> =
            values.iter().zip(&rates).map(|(&value, &first)| Jet { value, first, second: 0.0 }).collect();
        let branch = when.branch(t, &jets);
        let mut slopes = Vec::new();
        when.slopes_on(branch, t, &values, &mut slopes);
        let speed = when.jet_on(branch, t, &jets).first;
        let parts = slopes.iter().zip(&rates).map(|(slope, rate)| (slope * rate).abs()).sum::<f64>();
        let Some(variation) =
            self.vary(theta, &shown, columns.iter().all(|of| Variation::is_of_motion(&cx.system.model, *of)))
        else {
            return Ok(None);
        };
        let mut changes = vec![0.0; count];
        for (column, slope) in columns.iter().zip(&slopes) {
            match variation.values(*column, &shown) {
                Some(own) => changes.iter_mut().zip(own).for_each(|(sum, own)| *sum += slope * own),
                None => changes.fill(f64::NAN),
            }
        }
        variation.add_when(event, (branch, t), &values, &mut changes);
        let grazes = speed.abs() <= GRAZES * parts;
        let speed = if grazes { f64::NAN } else { speed };
        Ok(Some(changes.into_iter().map(|change| Variation::later(change, speed)).collect()))
    }

    /// How fast quantities change along the run at the time of `shown`; no number where nothing tells.
    ///
    /// # Errors
    /// What a row of the step at hand may show.
    pub(super) fn rates(&mut self, cx: Context, of: &[Quantity], shown: &Snapshot) -> Result<Vec<f64>, RunError> {
        use ElementQuantity::{Length, Rate, Stroke};
        // Between the ends of steps of one size rows have q and v each in its own way.
        let between = self.has_fixed_steps() && self.step_at_hand().is_some();
        let known = |of: &Quantity| match *of {
            Quantity::Time => Some(1.0),
            _ if between => None,
            Quantity::Coordinate(k) => {
                Some(cx.system.model.coordinate_rate(&shown.evaluation.q, &shown.evaluation.v, k))
            }
            Quantity::Velocity(k) => Some(shown.value(Quantity::Acceleration(k))),
            Quantity::Element(e, Length | Stroke) => Some(shown.value(Quantity::Element(e, Rate))),
            _ => None,
        };
        let mut rates: Vec<f64> = of.iter().map(|of| known(of).unwrap_or(f64::NAN)).collect();
        let Some(step) = self.step_at_hand().filter(|_| of.iter().any(|of| known(of).is_none())) else {
            return Ok(rates);
        };
        let t = shown.t();
        let far = if t - step.from >= step.to - t { step.from } else { step.to };
        let apart = APART * (t - far);
        let mut sums = vec![0.0; of.len()];
        let mut there = Snapshot::new(cx.system);
        for (k, weight) in BACKWARDS.into_iter().enumerate() {
            self.read(cx, t - (k + 1) as f64 * apart, 0, &mut there)?;
            sums.iter_mut().zip(of).for_each(|(sum, of)| *sum += weight * (there.value(*of) - shown.value(*of)));
        }
        let unknown = rates.iter_mut().zip(of).zip(sums).filter(|((_, of), _)| known(of).is_none());
        unknown.for_each(|((rate, _), sum)| *rate = sum / apart);
        Ok(rates)
    }
}

/// What follows from time alone and acts on the motion.
fn sources(system: &System) -> impl Iterator<Item = (Switched, &Signal)> {
    let drives = match &system.motion {
        Motion::Forward(forward) => Some(forward.forces(&system.model)),
        Motion::Given(_) => None,
    };
    let drives = drives.into_iter().flatten().map(|(k, signal)| (Switched::Drive(k), signal));
    let inputs = system.elements.iter().enumerate().flat_map(|(element, own)| {
        own.inputs.iter().enumerate().map(move |(input, signal)| (Switched::Input { element, input }, signal))
    });
    drives.chain(inputs)
}
