//! The figures of a master curve: both moduli over the reduced frequency, and the shifts over the temperature.

use super::Told;
use crate::{Ending, drawing};
use springpot::law::Shift;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use springpot_run::numbers::short;
use std::f64::consts::{LN_10, TAU};

/// Points of a law's curve.
const POINTS: usize = 200;
/// Temperatures that the legend names at most.
const NAMED: usize = 9;
const ZERO: f64 = 273.15;

/// Draws and writes them.
pub(super) fn written(told: &Told<'_>) -> impl Iterator<Item = Ending> {
    let plots = [("master.svg", moduli(told)), ("shifts.svg", shifts(told))];
    let folder = told.folder.to_owned();
    plots.into_iter().map(move |(name, plot)| drawing::write(&folder.join(name), &plot))
}

fn axis(label: impl Into<String>, scale: Scale) -> Axis {
    Axis { label: label.into(), scale, ..Axis::default() }
}

fn curve(label: &str, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    let (x, y) = points.map(|[x, y]| (x, y)).unzip();
    Curve { label: label.to_owned(), x, y, ..Curve::default() }
}

fn moduli(told: &Told<'_>) -> Plot {
    let found = told.found;
    let unit = if told.table.is_modulus { "Pa" } else { "N/m" };
    let apart = found.shifts.len().div_ceil(NAMED);
    let panel = |title: &str, part: usize| {
        let mut curves: Vec<Curve> = found
            .shifts
            .iter()
            .enumerate()
            .map(|(k, shifted)| {
                let own = found.rows.iter().filter(|row| row.temperature == shifted.temperature);
                let label = match k % apart {
                    0 => format!("{} degC", short((shifted.temperature - ZERO).round())),
                    _ => String::new(),
                };
                let points = own.map(|row| [row.frequency, [row.storage, row.loss][part]]);
                Curve { is_marked: true, ..curve(&label, points) }
            })
            .collect();
        if let Some((law, fitted)) = &told.law {
            let (first, last) = (found.rows[0].frequency, found.rows[found.rows.len() - 1].frequency);
            let points = (0..POINTS).map(|k| {
                let hertz = first * (last / first).powf(k as f64 / (POINTS - 1) as f64);
                [hertz, (fitted.stiffness)(TAU * hertz)[part] / told.sample]
            });
            curves.push(curve(&law.name, points));
        }
        let y = Some(axis(format!("{title}, {unit}"), Scale::Log));
        Panel { y, curves, ..Panel::default() }
    };
    Plot {
        x: axis(format!("reduced frequency at {} degC, Hz", short(found.reference - ZERO)), Scale::Log),
        columns: Some(1),
        panels: vec![panel("storage", 0), panel("loss", 1)],
        ..Plot::default()
    }
}

fn shifts(told: &Told<'_>) -> Plot {
    let found = told.found;
    let (cold, warm) = (found.shifts[0].temperature, found.shifts[found.shifts.len() - 1].temperature);
    let law = |label: &str, shift: Shift| {
        let at = move |k: usize| cold + (warm - cold) * k as f64 / (POINTS - 1) as f64;
        curve(label, (0..POINTS).map(move |k| [at(k) - ZERO, shift.ln_factor(at(k)) / LN_10]))
    };
    let own = found.shifts.iter().map(|one| [one.temperature - ZERO, one.log_a]);
    let mut curves = vec![Curve { is_points: true, ..curve("shifts", own) }];
    curves.extend(found.wlf.as_ref().map(|fit| law("WLF", fit.shift)));
    curves.push(law("Arrhenius", found.arrhenius.shift));
    Plot {
        x: axis("temperature, degC", Scale::Linear),
        y: axis("log₁₀ a_T", Scale::Linear),
        panels: vec![Panel { curves, ..Panel::default() }],
        ..Plot::default()
    }
}
