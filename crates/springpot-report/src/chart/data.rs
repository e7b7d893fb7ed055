//! Curves as unbroken runs of finite points, and the ranges they span.

use super::{Curve, Plot};

/// Coordinates beyond this are gaps, so that ranges and margins stay finite.
const LARGEST: f64 = 1e300;
/// Coordinates nearer to zero than this are drawn at zero.
const SMALLEST: f64 = 1e-300;
/// A range narrower than this part of its numbers is rounding: the curve is drawn as constant.
const FLAT: f64 = 1e-12;
/// Free part of the y range above and below the curves.
const MARGIN: f64 = 0.05;
/// Panels share y unless one of them spans less than this part of the whole.
const SHARED_Y: f64 = 0.05;

/// Unbroken pieces of a curve.
pub(super) type Runs = Vec<Vec<[f64; 2]>>;

/// Splits a curve at its gaps.
pub(super) fn runs(curve: &Curve) -> Runs {
    let mut runs = Runs::new();
    let mut open = false;
    for point in curve.x.iter().zip(&curve.y).map(|(x, y)| [*x, *y]) {
        let finite = point.iter().all(|v| v.abs() <= LARGEST);
        if finite {
            let point = point.map(|v| if v.abs() < SMALLEST { 0.0 } else { v });
            match runs.last_mut() {
                Some(run) if open => run.push(point),
                _ => runs.push(vec![point]),
            }
        }
        open = finite;
    }
    runs
}

/// Lowest and highest value shown on an axis.
pub(super) type Range = (f64, f64);

/// The ranges of every panel; `None` for a panel without data.
pub(super) struct Ranges {
    pub(super) x: Range,
    pub(super) y: Vec<Option<Range>>,
    /// All panels have the same y range.
    pub(super) shared_y: bool,
}

impl Ranges {
    /// `panels[i]` holds the runs of the curves of panel i.
    pub(super) fn new(panels: &[Vec<Runs>]) -> Self {
        let extent_of = |panel: &[Runs], axis: usize| extent(panel.iter().flatten().flatten().map(|point| point[axis]));
        let forward = panels.iter().flatten().flatten().all(|run| run.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
        let x = panels.iter().filter_map(|panel| extent_of(panel, 0)).reduce(union);
        let each: Vec<Option<Range>> = panels.iter().map(|panel| extent_of(panel, 1)).collect();
        let all = each.iter().copied().flatten().reduce(union);
        let width = |(lo, hi): Range| hi - lo;
        let shared_y = all.is_none_or(|all| each.iter().flatten().all(|one| width(*one) >= SHARED_Y * width(all)));
        let y = each.iter().map(|one| one.and(if shared_y { all } else { *one }).map(|range| widen(range, MARGIN)));
        Self { x: widen(x.unwrap_or((0.0, 1.0)), if forward { 0.0 } else { 0.6 * MARGIN }), y: y.collect(), shared_y }
    }
}

fn extent(values: impl Iterator<Item = f64>) -> Option<Range> {
    values.map(|v| (v, v)).reduce(union)
}

fn union((lo, hi): Range, (low, high): Range) -> Range {
    (lo.min(low), hi.max(high))
}

fn widen((lo, hi): Range, margin: f64) -> Range {
    let size = lo.abs().max(hi.abs());
    let pad = match hi - lo {
        _ if size == 0.0 => 1.0,
        width if width <= FLAT * size => 0.1 * size,
        width => margin * width,
    };
    (lo - pad, hi + pad)
}

/// The labels of all curves, each once, in order of appearance.
pub(super) fn labels(plot: &Plot) -> Vec<String> {
    let mut seen = std::collections::HashSet::new();
    let all = plot.panels.iter().flat_map(|panel| &panel.curves).map(|curve| &curve.label);
    all.filter(|label| seen.insert(label.as_str())).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_split_curves() {
        let y = vec![f64::NAN, 1.0, 2.0, f64::INFINITY, 1e301, 3.0, f64::NAN];
        let curve = Curve { label: String::new(), x: (0..7).map(f64::from).collect(), y };
        assert_eq!(runs(&curve), [vec![[1.0, 1.0], [2.0, 2.0]], vec![[5.0, 3.0]]]);
    }

    #[test]
    fn ranges_of_panels() {
        let run = |values: &[f64]| vec![vec![values.iter().enumerate().map(|(i, y)| [i as f64, *y]).collect()]];
        let ranges = Ranges::new(&[run(&[0.0, 10.0]), run(&[5.0, 6.0]), vec![]]);
        assert_eq!(ranges.x, (0.0, 1.0));
        assert!(ranges.shared_y);
        assert_eq!(ranges.y, [Some((-0.5, 10.5)), Some((-0.5, 10.5)), None]);
        let ranges = Ranges::new(&[run(&[0.0, 10.0]), run(&[5.0, 5.1])]);
        assert!(!ranges.shared_y);
        assert_eq!(widen((5.0, 5.0), 0.05), (4.5, 5.5));
        assert_eq!(widen((0.0, 0.0), 0.05), (-1.0, 1.0));
    }
}
