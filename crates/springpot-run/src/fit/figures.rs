//! The figures of a fit: what was measured beside the model, residuals, profiles.

use super::outcome::{ColumnScore, Outcome, RecordScore};
use crate::numbers::brief;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_scenario::{DataKind, DataPlan};
use std::f64::consts::TAU;

/// Rows that are drawn at most.
const MOST: usize = 2_000;

/// Frequencies of a strain sweep that differ by less than this share are one.
const SAME: f64 = 1e-6;

/// All of them, and the names of their files.
pub(super) fn all(outcome: &Outcome) -> Vec<(String, Plot)> {
    let mut plots = Vec::new();
    for (data, score) in outcome.fitting.plan().data.iter().zip(&outcome.records) {
        if !score.columns.is_empty() && !score.rows.is_empty() {
            plots.push((data.name.clone(), measured(data, score)));
            plots.push((format!("{}-residuals", data.name), residuals(data, score)));
        }
    }
    if !outcome.profiles.is_empty() {
        plots.push(("profiles".to_owned(), profiles(outcome)));
    }
    plots
}

fn axis(label: impl Into<String>, scale: Scale) -> Axis {
    Axis { label: label.into(), scale, ..Axis::default() }
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { name.to_owned() } else { format!("{name}, {unit}") }
}

/// Along what the rows of a record are drawn.
fn along(data: &DataPlan, score: &RecordScore) -> Axis {
    match data.kind {
        DataKind::Dma { .. } if amplitudes(data, score).is_some() => axis("amplitude, m", Scale::Log),
        DataKind::Dma { .. } => axis("frequency, Hz", Scale::Log),
        DataKind::Relaxation | DataKind::Creep => axis("t, s", Scale::Log),
        DataKind::Run | DataKind::Stroke => axis("t, s", Scale::Linear),
    }
}

/// Amplitudes of a strain sweep, row by row: what such a record is drawn over.
fn amplitudes<'d>(data: &'d DataPlan, score: &RecordScore) -> Option<&'d [f64]> {
    let told = data.told("amplitude").filter(|_| matches!(data.kind, DataKind::Dma { .. }))?;
    let first = told[*score.rows.first()?];
    score.rows.iter().any(|row| told[*row] != first).then_some(told)
}

/// The frequencies of a strain sweep, rising, and the places of the rows of each.
fn by_frequency(data: &DataPlan, score: &RecordScore, places: &[(usize, f64)]) -> Vec<(f64, Vec<(usize, f64)>)> {
    let mut groups: Vec<(f64, Vec<(usize, f64)>)> = Vec::new();
    for &(k, at) in places {
        let frequency = data.at[score.rows[k]];
        match groups.iter_mut().find(|(own, _)| (own - frequency).abs() <= SAME * frequency) {
            Some((_, group)) => group.push((k, at)),
            None => groups.push((frequency, vec![(k, at)])),
        }
    }
    groups.sort_by(|a, b| a.0.total_cmp(&b.0));
    groups
}

/// Where the rows of a record are, in the order of the axis.
fn places(data: &DataPlan, score: &RecordScore) -> Vec<(usize, f64)> {
    let scale = if matches!(data.kind, DataKind::Dma { .. }) { TAU } else { 1.0 };
    let amplitudes = amplitudes(data, score);
    let place = |row: usize| amplitudes.map_or_else(|| data.at[row] / scale, |amplitudes| amplitudes[row]);
    let mut all: Vec<(usize, f64)> = score.rows.iter().enumerate().map(|(k, row)| (k, place(*row))).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    let step = all.len().div_ceil(MOST).max(1);
    all.into_iter().step_by(step).collect()
}

fn measured(data: &DataPlan, score: &RecordScore) -> Plot {
    let places = places(data, score);
    let y_scale = if data.kind.is_relative() { Scale::Log } else { Scale::Linear };
    let panel = |(column, own): (&springpot_scenario::DataColumn, &ColumnScore)| {
        let curve = |label: &str, values: &[f64], places: &[(usize, f64)]| Curve {
            label: label.to_owned(),
            x: places.iter().map(|(_, at)| *at).collect(),
            y: places.iter().map(|(k, _)| values[*k]).collect(),
            ..Curve::default()
        };
        let pair = |[measured, model]: [&str; 2], places: &[(usize, f64)]| {
            let is_dense = places.len() > 200;
            let measured = Curve { is_points: true, is_marked: !is_dense, ..curve(measured, &own.measured, places) };
            // Rows at several temperatures are no one curve.
            let is_one = places.windows(2).all(|pair| pair[1].1 > pair[0].1);
            [measured, Curve { is_points: !is_one, ..curve(model, &own.model, places) }]
        };
        let curves = match amplitudes(data, score) {
            None => pair(["measured", "model"], &places).to_vec(),
            Some(_) => by_frequency(data, score, &places)
                .iter()
                .flat_map(|(frequency, places)| {
                    let label = format!("{} Hz", brief(frequency / TAU));
                    pair(["measured", &label], places)
                })
                .collect(),
        };
        let y = Some(axis(with_unit(&column.name, &column.unit), y_scale));
        Panel { y, curves, ..Panel::default() }
    };
    Plot {
        title: Some(if data.is_fitted { data.name.clone() } else { format!("{}: validation", data.name) }),
        x: along(data, score),
        columns: Some(1),
        panels: data.columns.iter().zip(&score.columns).map(panel).collect(),
        ..Plot::default()
    }
}

fn residuals(data: &DataPlan, score: &RecordScore) -> Plot {
    let places = places(data, score);
    let panel = |(column, own): (&springpot_scenario::DataColumn, &ColumnScore)| {
        let x: Vec<f64> = places.iter().map(|(_, at)| *at).collect();
        let y: Vec<f64> = places.iter().map(|(k, _)| own.residuals[*k]).collect();
        let unit = match (data.kind.is_relative(), column.sd.is_some() || data.relative_sd.is_some()) {
            (_, true) => "in standard deviations",
            (true, false) => "relative",
            (false, false) => &column.unit,
        };
        let curve = Curve { label: "residual".into(), x, y, is_points: true, is_marked: true, ..Curve::default() };
        let y = Some(axis(with_unit(&column.name, unit), Scale::Linear));
        Panel { y, curves: vec![curve], ..Panel::default() }
    };
    Plot {
        title: Some(format!("{}: model less measured", data.name)),
        x: along(data, score),
        columns: Some(1),
        hides_legend: true,
        panels: data.columns.iter().zip(&score.columns).map(panel).collect(),
        ..Plot::default()
    }
}

/// Of all parameters in one scale: how far from the fitted value, in standard deviations.
fn profiles(outcome: &Outcome) -> Plot {
    let plan = outcome.fitting.plan();
    let panel = |(j, points): &(usize, Vec<[f64; 2]>)| {
        let (value, sd) = (outcome.fit.values[*j], outcome.fit.sd(*j));
        let unit = if sd > 0.0 && sd.is_finite() {
            sd
        } else {
            points.iter().map(|[x, _]| (x - value).abs()).fold(0.0, f64::max)
        };
        let (x, y) = points.iter().map(|[x, y]| ((x - value) / unit, y * y)).unzip();
        let curve = Curve { label: "profile".into(), x, y, ..Curve::default() };
        Panel { title: Some(plan.parameters[*j].sought.name.clone()), curves: vec![curve], ..Panel::default() }
    };
    Plot {
        x: axis("value less the fitted one, standard deviations", Scale::Linear),
        y: axis("rise of the cost, variances", Scale::Linear),
        hides_legend: true,
        panels: outcome.profiles.iter().take(16).map(panel).collect(),
        ..Plot::default()
    }
}
