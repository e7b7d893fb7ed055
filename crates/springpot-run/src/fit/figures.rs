//! The figures of a fit: what was measured beside the model, residuals, profiles.

use super::outcome::{ColumnScore, Outcome, RecordScore};
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_scenario::{DataKind, DataPlan};
use std::f64::consts::TAU;

/// Rows that are drawn at most.
const MOST: usize = 2_000;

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
fn along(data: &DataPlan) -> Axis {
    match data.kind {
        DataKind::Dma { .. } => axis("frequency, Hz", Scale::Log),
        DataKind::Relaxation | DataKind::Creep => axis("t, s", Scale::Log),
        DataKind::Run | DataKind::Stroke => axis("t, s", Scale::Linear),
    }
}

/// Where the rows of a record are, in the order of the axis.
fn places(data: &DataPlan, score: &RecordScore) -> Vec<(usize, f64)> {
    let scale = if matches!(data.kind, DataKind::Dma { .. }) { TAU } else { 1.0 };
    let mut all: Vec<(usize, f64)> = score.rows.iter().enumerate().map(|(k, row)| (k, data.at[*row] / scale)).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    let step = all.len().div_ceil(MOST).max(1);
    all.into_iter().step_by(step).collect()
}

fn measured(data: &DataPlan, score: &RecordScore) -> Plot {
    let places = places(data, score);
    let y_scale = if data.kind.is_relative() { Scale::Log } else { Scale::Linear };
    let panel = |(column, own): (&springpot_scenario::DataColumn, &ColumnScore)| {
        let curve = |label: &str, values: &[f64]| Curve {
            label: label.to_owned(),
            x: places.iter().map(|(_, at)| *at).collect(),
            y: places.iter().map(|(k, _)| values[*k]).collect(),
            ..Curve::default()
        };
        let is_dense = places.len() > 200;
        let measured = Curve { is_points: true, is_marked: !is_dense, ..curve("measured", &own.measured) };
        // Rows at several temperatures are no one curve.
        let is_one = places.windows(2).all(|pair| pair[1].1 > pair[0].1);
        let model = Curve { is_points: !is_one, ..curve("model", &own.model) };
        let y = Some(axis(with_unit(&column.name, &column.unit), y_scale));
        Panel { y, curves: vec![measured, model], ..Panel::default() }
    };
    Plot {
        title: Some(if data.is_fitted { data.name.clone() } else { format!("{}: validation", data.name) }),
        x: along(data),
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
        x: along(data),
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
