//! The figure of a measurement and the law fitted to it.

use crate::{Ending, drawing};
use springpot::law::Entry;
use springpot::law::datasheet::Measured;
use springpot_report::{Axis, Curve, Panel, Plot, Scale};
use std::f64::consts::TAU;
use std::path::Path;

/// Rows that are drawn at most, evenly along the frequencies.
const MOST: usize = 150;
/// Points of the curve.
const POINTS: usize = 200;

/// K' and K'' of the fitted law at an angular frequency.
pub(super) type Stiffness<'a> = dyn Fn(f64) -> [f64; 2] + 'a;

/// Draws storage and loss over the frequency, and writes them as the ending of `file` says.
pub(super) fn write(file: &Path, law: &Entry, stiffness: &Stiffness, rows: &[Measured]) -> Ending {
    drawing::write(file, &plot(law, stiffness, rows))
}

/// Two panels, the rows as marks.
fn plot(law: &Entry, stiffness: &Stiffness, rows: &[Measured]) -> Plot {
    let mut drawn: Vec<&Measured> = rows.iter().collect();
    drawn.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    let (first, last) = (drawn[0].omega / TAU, drawn[drawn.len() - 1].omega / TAU);
    let drawn: Vec<&Measured> = drawn.iter().step_by(rows.len().div_ceil(MOST)).copied().collect();
    let panel = |title: &str, part: usize| {
        let measured = drawn.iter().map(|row| [row.omega / TAU, [row.storage, row.loss][part]]);
        let fitted = (0..POINTS).map(|k| {
            let hertz = first * (last / first).powf(k as f64 / (POINTS - 1) as f64);
            [hertz, stiffness(TAU * hertz)[part]]
        });
        let measured = Curve { is_marked: true, ..curve("measured", measured) };
        Panel { title: Some(title.to_owned()), curves: vec![measured, curve(&law.name, fitted)], ..Panel::default() }
    };
    let axis = |label: &str| Axis { label: label.to_owned(), scale: Scale::Log, ..Axis::default() };
    Plot {
        x: axis("frequency, Hz"),
        y: axis("stiffness, N/m"),
        panels: vec![panel("storage", 0), panel("loss", 1)],
        ..Plot::default()
    }
}

fn curve(label: &str, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    let (x, y) = points.map(|[x, y]| (x, y)).unzip();
    Curve { label: label.to_owned(), x, y, ..Curve::default() }
}
