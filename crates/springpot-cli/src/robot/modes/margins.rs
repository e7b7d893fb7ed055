//! The margins of a loop as a page, rows, data and figures.

use super::asked::Asked;
use super::{Stopped, Told, response};
use crate::arguments::ModesOptions;
use crate::{diagnostic, frequency, terminal};
use serde_json::{Value, json};
use springpot::linear::{LoopGain, Margins};
use springpot_report::{Axis, Curve, Panel, Plot};
use springpot_run::numbers::brief;
use springpot_scenario::suggest;
use std::f64::consts::TAU;

/// Points of a circle.
const CIRCLE: usize = 181;

pub(super) fn told(asked: &Asked, options: &ModesOptions, joint: &str) -> Result<Told, Stopped> {
    let linear = &asked.about.linear;
    let names = linear.velocity_names();
    let Some(velocity) = names.iter().position(|name| name == joint) else {
        let free = linear.free.iter().map(|&k| &*names[k]);
        return Err((format!("--margins {joint}: there is no such joint"), suggest(joint, free)).into());
    };
    let Some(gain) = linear.loop_gain(velocity) else {
        let help = "take a joint that is neither prescribed nor locked".to_owned();
        return Err((format!("--margins {joint}: forces do not move this joint"), help).into());
    };
    let margins = gain.margins().map_err(|error| Stopped::Refused(super::table::problem(error)))?;
    if margins.is_unstable {
        diagnostic::warning(
            "the closed loop is unstable: its margins do not say how far it is from that".to_owned(),
            None,
        );
    }
    let band = frequency::band(&options.from, &options.to, options.points)?;
    let rows = response::rows(&band, |omega| Ok(gain.at(omega)))?;
    let nyquist = nyquist(joint, &gain, &band, &margins);
    Ok(Told {
        page: page(asked, joint, &margins),
        csv: response::csv("1", &rows),
        json: json_of(asked, joint, &margins, &rows),
        plot: bode(joint, &margins, &rows, options.decibel),
        beside: Some(("nyquist", nyquist)),
    })
}

fn page(asked: &Asked, joint: &str, margins: &Margins) -> String {
    let width = terminal::stdout_width().or(Some(80));
    let hertz = |omega: f64| format!("{} Hz", brief(omega / TAU));
    let none = || "none: |L| never is 1".to_owned();
    let state = if margins.is_unstable { "unstable" } else { "stable" };
    let lines = [
        ("loop", format!("opened at the torque of {joint}, about {}; closed it is {state}", asked.place())),
        (
            "phase",
            margins
                .phase
                .map_or_else(none, |(lag, omega)| format!("{} deg at {}", brief(lag.to_degrees()), hertz(omega))),
        ),
        (
            "gain",
            match margins.gain {
                Some((factor, omega)) => format!("{} at {}", brief(factor), hertz(omega)),
                None => "none: no factor above 1 brings L to -1".to_owned(),
            },
        ),
        ("delay", margins.delay.map_or_else(none, |delay| format!("{} s", brief(delay)))),
        (
            "peak",
            match margins.sensitivity {
                (peak, Some(omega)) => format!("|1/(1 + L)| is at most {}, at {}", brief(peak), hertz(omega)),
                (peak, None) => format!("|1/(1 + L)| comes to {} at ever higher frequencies", brief(peak)),
            },
        ),
    ];
    lines.iter().map(|(lead, words)| terminal::hanging(&format!("{lead:<8}"), words, width)).collect()
}

fn json_of(asked: &Asked, joint: &str, margins: &Margins, rows: &[response::Row]) -> Value {
    let [phase, gain] = [margins.phase, margins.gain].map(|margin| margin.map(|(_, omega)| omega / TAU));
    let mut value = asked.json();
    value["joint"] = joint.into();
    value["unstable"] = margins.is_unstable.into();
    value["margins"] = json!({
        "phase_margin": margins.phase.map(|(lag, _)| lag.to_degrees()), "phase_margin_frequency": phase,
        "gain_margin": margins.gain.map(|(factor, _)| factor), "gain_margin_frequency": gain,
        "delay_margin": margins.delay,
        "sensitivity_peak": margins.sensitivity.0,
        "sensitivity_peak_frequency": margins.sensitivity.1.map(|omega| omega / TAU),
    });
    response::add_arrays(&mut value, rows);
    value
}

/// Gain and phase with the margins between the curves and what they are about.
fn bode(joint: &str, margins: &Margins, rows: &[response::Row], decibel: bool) -> Plot {
    let mut plot = response::bode(format!("Loop through {joint}"), "1", rows, decibel);
    let limit = "|L| = 1, L < 0".to_owned();
    let ends = |y: f64| {
        let [first, last] = [rows.first(), rows.last()].map(|row| row.map_or(1.0, |row| row.hertz));
        Curve { x: vec![first, last], y: vec![y, y], kind: limit.clone(), ..Curve::default() }
    };
    let level = |gain: f64| if decibel { 20.0 * gain.log10() } else { gain };
    let line = |label: String, hertz: f64, y: [f64; 2]| Curve {
        label,
        is_marked: true,
        x: vec![hertz; 2],
        y: y.to_vec(),
        ..Curve::default()
    };
    plot.panels[0].curves.push(ends(level(1.0)));
    if let Some((factor, omega)) = margins.gain.filter(|(_, omega)| *omega > 0.0) {
        let label = format!("gain margin {} at {} Hz", brief(factor), brief(omega / TAU));
        plot.panels[0].curves.push(line(label, omega / TAU, [level(factor.recip()), level(1.0)]));
    }
    if let Some((lag, omega)) = margins.phase {
        let label = format!("phase margin {} deg at {} Hz", brief(lag.to_degrees()), brief(omega / TAU));
        // Beside the curve, whichever turn it is on.
        let near = rows.iter().min_by(|a, b| {
            let off = |row: &response::Row| (row.hertz * TAU / omega).ln().abs();
            off(a).total_cmp(&off(b))
        });
        let own = lag.to_degrees() - 180.0;
        let phase = near.map_or(own, |row| own + 360.0 * ((row.phase - own) / 360.0).round());
        plot.panels[1].curves.push(line(label, omega / TAU, [phase - lag.to_degrees(), phase]));
        plot.panels[1].curves.push(ends(phase - lag.to_degrees()));
    }
    plot
}

/// L(iω) in the plane, with −1 and the circle |L| = 1.
fn nyquist(joint: &str, gain: &LoopGain, band: &[f64], margins: &Margins) -> Plot {
    let (from, to) = (band[0].ln(), band[band.len() - 1].ln());
    let points: Vec<_> =
        (0..=2000).map(|k| gain.at(TAU * (from + (to - from) * f64::from(k) / 2000.0).exp())).collect();
    let curve = |kind: &str, sign: f64| Curve {
        label: "L".to_owned(),
        kind: kind.to_owned(),
        x: points.iter().map(|l| l.re).collect(),
        y: points.iter().map(|l| sign * l.im).collect(),
        ..Curve::default()
    };
    let turn = |k: usize| TAU * k as f64 / (CIRCLE - 1) as f64;
    let circle = Curve {
        label: "|L| = 1".to_owned(),
        x: (0..CIRCLE).map(|k| turn(k).cos()).collect(),
        y: (0..CIRCLE).map(|k| turn(k).sin()).collect(),
        ..Curve::default()
    };
    let mark =
        |label: String, x: f64, y: f64| Curve { label, is_points: true, x: vec![x], y: vec![y], ..Curve::default() };
    let mut curves = vec![circle, curve("", 1.0), curve("f < 0", -1.0), mark("-1".to_owned(), -1.0, 0.0)];
    if let Some((lag, _)) = margins.phase {
        let arc: Vec<f64> = (0..=60).map(|k| std::f64::consts::PI + lag * f64::from(k) / 60.0).collect();
        curves.push(Curve {
            label: format!("phase margin {} deg", brief(lag.to_degrees())),
            x: arc.iter().map(|angle| angle.cos()).collect(),
            y: arc.iter().map(|angle| angle.sin()).collect(),
            ..Curve::default()
        });
    }
    if let Some((factor, _)) = margins.gain {
        curves.push(Curve {
            label: format!("gain margin {}", brief(factor)),
            is_marked: true,
            x: vec![-1.0, -factor.recip()],
            y: vec![0.0, 0.0],
            ..Curve::default()
        });
    }
    Plot {
        title: Some(format!("Loop through {joint}")),
        x: Axis { label: "Re L".to_owned(), range: Some([-2.5, 1.5]), ..Axis::default() },
        y: Axis { label: "Im L".to_owned(), range: Some([-2.0, 2.0]), ..Axis::default() },
        is_equal: true,
        panels: vec![Panel { curves, ..Panel::default() }],
        ..Plot::default()
    }
}
