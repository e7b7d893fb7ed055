//! The figure of a measurement and the law fitted to it.

use crate::{Ending, diagnostic, output};
use springpot::law::Entry;
use springpot::law::datasheet::{Fitted, Measured};
use springpot_report::{Curve, Panel, Plot, Rendered};
use std::f64::consts::TAU;
use std::path::Path;

/// Rows that are drawn at most, evenly along the frequencies.
const MOST: usize = 150;
/// Points of the curve.
const POINTS: usize = 200;
/// Half width and height of a mark, as shares of the axes.
const MARK: [f64; 2] = [0.008, 0.012];

/// Draws storage and loss over the frequency, and writes them as the ending of `file` says.
pub(super) fn write(file: &Path, law: &Entry, found: &Fitted, rows: &[Measured]) -> Ending {
    let Rendered { svg, png } = match plot(law, found, rows).render() {
        Ok(rendered) => rendered,
        Err(error) => {
            diagnostic::error(format!("the figure is not drawn: {error}"));
            return Ending::Failed;
        }
    };
    let is_png = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    output::written(file, output::write(file, if is_png { &png[..] } else { svg.as_bytes() }))
}

/// Two panels of decimal logarithms, the rows as marks.
fn plot(law: &Entry, found: &Fitted, rows: &[Measured]) -> Plot {
    let mut drawn: Vec<&Measured> = rows.iter().collect();
    drawn.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    let (first, last) = (log_hertz(drawn[0].omega), log_hertz(drawn[drawn.len() - 1].omega));
    let drawn: Vec<&Measured> = drawn.iter().step_by(rows.len().div_ceil(MOST)).copied().collect();
    let height = {
        let all = || drawn.iter().flat_map(|row| [row.storage.log10(), row.loss.log10()]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    let mark = [MARK[0] * (last - first), MARK[1] * height];
    let panel = |title: &str, part: usize| {
        let measured = drawn.iter().map(|row| [log_hertz(row.omega), [row.storage, row.loss][part].log10()]);
        let curve = (0..POINTS).map(|k| {
            let x = first + (last - first) * k as f64 / (POINTS - 1) as f64;
            [x, found.law.complex_stiffness(TAU * 10.0_f64.powf(x))[part].log10()]
        });
        let curves = vec![line("measured", measured.flat_map(|at| diamond(at, mark))), line(&law.name, curve)];
        Panel { title: Some(title.to_owned()), curves }
    };
    Plot {
        x_label: "log₁₀ of the frequency in Hz".to_owned(),
        y_label: "log₁₀ of the stiffness in N/m".to_owned(),
        panels: vec![panel("storage", 0), panel("loss", 1)],
        ..Plot::default()
    }
}

fn log_hertz(omega: f64) -> f64 {
    (omega / TAU).log10()
}

fn line(label: &str, points: impl Iterator<Item = [f64; 2]>) -> Curve {
    let (x, y) = points.map(|[x, y]| (x, y)).unzip();
    Curve { label: label.to_owned(), x, y }
}

/// A mark and the gap behind it.
fn diamond([x, y]: [f64; 2], [width, height]: [f64; 2]) -> [[f64; 2]; 6] {
    let [left, up, right, down] = [[x - width, y], [x, y + height], [x + width, y], [x, y - height]];
    [left, up, right, down, left, [f64::NAN; 2]]
}
