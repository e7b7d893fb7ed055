//! What comparisons of time and error share: medians, the best points, curves, the figure's file.

mod median;

use springpot_report::{Curve, Plot};

pub(crate) use median::median;

/// What one run took and by how much it errs.
pub(crate) trait Timed {
    fn seconds(&self) -> f64;
    fn error(&self) -> f64;
}

/// The points that no other one beats in both time and error, fastest first.
pub(crate) fn best<P: Timed>(mut points: Vec<P>) -> Vec<P> {
    points.sort_by(|a, b| a.seconds().total_cmp(&b.seconds()));
    let mut kept: Vec<P> = Vec::new();
    for point in points {
        if kept.last().is_none_or(|last| point.error() < last.error()) {
            kept.push(point);
        }
    }
    kept
}

/// Decades of the error over decades of milliseconds.
pub(crate) fn curve<P: Timed>(label: &str, points: &[P]) -> Curve {
    Curve {
        label: label.into(),
        x: points.iter().map(|p| (1e3 * p.seconds()).log10()).collect(),
        y: points.iter().map(|p| p.error().log10()).collect(),
        ..Curve::default()
    }
}

/// Writes the figure as SVG, or as PNG where the file is called so.
pub(crate) fn save(plot: &Plot, file: &str) {
    let figure = plot.render().expect("finite points");
    let bytes = if file.ends_with(".png") { figure.png } else { figure.svg.into_bytes() };
    std::fs::write(file, bytes).expect("the file can be written");
}
