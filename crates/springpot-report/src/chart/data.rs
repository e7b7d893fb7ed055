//! Curves as unbroken runs of finite points, and the ranges they span.

use super::{Curve, Plot, Scale};

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

/// Splits a curve at its gaps; where a scale is logarithmic, what is not above zero is one.
pub(super) fn runs(curve: &Curve, scales: [Scale; 2]) -> Runs {
    let mut runs = Runs::new();
    let mut open = false;
    for point in curve.x.iter().zip(&curve.y).map(|(x, y)| [*x, *y]) {
        let is_drawn = point.iter().zip(scales).all(|(v, scale)| match scale {
            Scale::Linear => v.abs() <= LARGEST,
            Scale::Log => (SMALLEST..=LARGEST).contains(v),
        });
        if is_drawn {
            let point = point.map(|v| if v.abs() < SMALLEST { 0.0 } else { v });
            match runs.last_mut() {
                Some(run) if open => run.push(point),
                _ => runs.push(vec![point]),
            }
        }
        open = is_drawn;
    }
    runs
}

/// How many points of a figure a logarithmic axis has no place for; none where a range says what is drawn.
pub(super) fn not_positive(plot: &Plot) -> Vec<String> {
    let points = || {
        plot.panels.iter().flat_map(|panel| {
            let left = panel.y.as_ref().unwrap_or(&plot.y);
            panel.curves.iter().flat_map(move |curve| {
                let y = plot.right.as_ref().filter(|_| curve.is_right).unwrap_or(left);
                curve.x.iter().zip(&curve.y).map(move |(at, value)| [(&plot.x, *at), (y, *value)])
            })
        })
    };
    let is_drawn = |(_, value): &(&super::Axis, f64)| value.abs() <= LARGEST;
    let is_missing =
        |(axis, value): (&super::Axis, f64)| axis.scale == Scale::Log && axis.range.is_none() && value < SMALLEST;
    let all = || points().filter(|point| point.iter().all(is_drawn));
    let remark = |(name, axis): (&str, usize)| {
        let missing = all().filter(|point| is_missing(point[axis])).count();
        let is = if missing == 1 { "is" } else { "are" };
        let all = all().count();
        (missing > 0)
            .then(|| format!("{missing} of {all} points {is} not above zero: not drawn on the logarithmic {name} axis"))
    };
    [("x", 0), ("y", 1)].into_iter().filter_map(remark).collect()
}

/// Lowest and highest value shown on an axis, and how what lies between becomes a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) lo: f64,
    pub(super) hi: f64,
    pub(super) scale: Scale,
}

impl Range {
    /// Where a value stands: 0 at the lower end, 1 at the upper one.
    pub(super) fn share(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.lo) / (self.hi - self.lo),
            Scale::Log => (value / self.lo).log10() / (self.hi / self.lo).log10(),
        }
    }

    /// What it takes to hold these numbers, with a margin.
    fn around(extent: Extent, scale: Scale, margin: f64) -> Self {
        let (lo, hi) = match scale {
            Scale::Linear => widen(extent, margin),
            Scale::Log => {
                let (lo, hi) = extent;
                let pad = if lo == hi { 2.0 } else { (hi / lo).powf(margin) };
                (lo / pad, hi * pad)
            }
        };
        Self { lo, hi, scale }
    }

    /// Longer by a factor about its middle.
    pub(super) fn stretched(self, factor: f64) -> Self {
        let (middle, half) = (0.5 * (self.lo + self.hi), 0.5 * factor * (self.hi - self.lo));
        Self { lo: middle - half, hi: middle + half, ..self }
    }
}

/// What the curves of a panel reach.
pub(super) struct Reach<'a> {
    /// Those that belong to the axis, each in its runs.
    pub(super) runs: Vec<&'a Runs>,
    /// Panels of the same group have one range where that flattens none of them.
    pub(super) group: usize,
}

/// The range of x for the curves of all panels.
pub(super) fn x_range<'a>(runs: impl Iterator<Item = &'a Runs> + Clone, axis: &super::Axis, has_marks: bool) -> Range {
    if let Some([lo, hi]) = axis.range {
        return Range { lo, hi, scale: axis.scale };
    }
    let forward = runs.clone().flatten().all(|run| run.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    // Marks and curves that turn keep clear of the edges.
    let margin = if forward && !has_marks { 0.0 } else { 0.6 * MARGIN };
    let extent = extent(runs.flatten().flatten().map(|point| point[0]));
    Range::around(extent.unwrap_or((1.0, 2.0)), axis.scale, margin)
}

/// The y range of every panel, `None` for one without data, and whether the panels of each group have one.
pub(super) fn y_ranges(panels: &[Reach<'_>], axes: &[&super::Axis], x: Range) -> (Vec<Option<Range>>, Vec<bool>) {
    let inside = |point: &&[f64; 2]| (x.lo..=x.hi).contains(&point[0]);
    let of = |panel: &Reach<'_>| {
        let points = || panel.runs.iter().copied().flatten().flatten();
        extent(points().filter(inside).map(|p| p[1])).or_else(|| extent(points().map(|p| p[1])))
    };
    let each: Vec<Option<Extent>> = panels.iter().map(of).collect();
    let shared: Vec<bool> = (0..axes.len())
        .map(|group| {
            let own = || panels.iter().zip(&each).filter(move |(p, _)| p.group == group).filter_map(|(_, one)| *one);
            let all = own().reduce(union);
            let width = |(lo, hi): Extent| hi - lo;
            all.is_none_or(|all| own().all(|one| width(one) >= SHARED_Y * width(all)))
        })
        .collect();
    let ranges = panels.iter().zip(&each).map(|(panel, one)| {
        let axis = axes[panel.group];
        let mates = panels.iter().zip(&each).filter(|(mate, _)| mate.group == panel.group);
        let all = mates.filter_map(|(_, one)| *one).reduce(union);
        (*one)?;
        match axis.range {
            Some([lo, hi]) => Some(Range { lo, hi, scale: axis.scale }),
            None => {
                (if shared[panel.group] { all } else { *one }).map(|extent| Range::around(extent, axis.scale, MARGIN))
            }
        }
    });
    (ranges.collect(), axes.iter().zip(&shared).map(|(axis, shared)| *shared || axis.range.is_some()).collect())
}

/// From the lowest to the highest finite number of the cells of a map; somewhat wider where they are one, nothing where there is none.
pub(super) fn bar_range(cells: &[f64]) -> Option<Range> {
    let (lo, hi) = extent(cells.iter().copied().filter(|cell| cell.abs() <= LARGEST))?;
    let is_flat = hi - lo <= FLAT * lo.abs().max(hi.abs());
    let (lo, hi) = if is_flat { widen((lo, hi), 0.0) } else { (lo, hi) };
    Some(Range { lo, hi, scale: Scale::Linear })
}

/// Lowest and highest of some numbers.
type Extent = (f64, f64);

fn extent(values: impl Iterator<Item = f64>) -> Option<Extent> {
    values.map(|v| (v, v)).reduce(union)
}

fn union((lo, hi): Extent, (low, high): Extent) -> Extent {
    (lo.min(low), hi.max(high))
}

fn widen((lo, hi): Extent, margin: f64) -> Extent {
    let size = lo.abs().max(hi.abs());
    let pad = match hi - lo {
        _ if size == 0.0 => 1.0,
        width if width <= FLAT * size => 0.1 * size,
        width => margin * width,
    };
    (lo - pad, hi + pad)
}

/// What curves are called, or points without lines, each name once, in order of appearance; unnamed ones too.
pub(super) fn names<'a>(plot: &'a Plot, are_points: bool, name: impl Fn(&'a Curve) -> &'a str) -> Vec<&'a str> {
    let mut seen = std::collections::HashSet::new();
    let all =
        plot.panels.iter().flat_map(|panel| &panel.curves).filter(|curve| curve.is_points == are_points).map(name);
    all.filter(|name| seen.insert(*name)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    #[test]
    fn gaps_split_curves() {
        let y = vec![f64::NAN, 1.0, 2.0, f64::INFINITY, 1e301, 3.0, f64::NAN, -1.0];
        let curve = Curve { x: (0..8).map(f64::from).collect(), y, ..Curve::default() };
        let linear = [Scale::Linear; 2];
        assert_eq!(runs(&curve, linear), [vec![[1.0, 1.0], [2.0, 2.0]], vec![[5.0, 3.0]], vec![[7.0, -1.0]]]);
        let log = [Scale::Linear, Scale::Log];
        assert_eq!(runs(&curve, log), [vec![[1.0, 1.0], [2.0, 2.0]], vec![[5.0, 3.0]]]);
    }

    #[test]
    fn what_is_not_positive_is_told() {
        let curve = Curve { x: vec![0.0, 1.0, 2.0, 3.0], y: vec![1.0, 0.0, -1.0, f64::NAN], ..Curve::default() };
        let panels = vec![super::super::Panel { curves: vec![curve], ..Default::default() }];
        let log = Axis { scale: Scale::Log, ..Axis::default() };
        let told = |x: &Axis, y: &Axis| {
            not_positive(&Plot { x: x.clone(), y: y.clone(), panels: panels.clone(), ..Plot::default() })
        };
        let linear = Axis::default();
        let y = "2 of 3 points are not above zero: not drawn on the logarithmic y axis";
        assert_eq!(told(&linear, &log), [y]);
        assert_eq!(told(&log, &log), ["1 of 3 points is not above zero: not drawn on the logarithmic x axis", y]);
        let ranged = Axis { range: Some([0.1, 1.0]), ..log };
        assert!(told(&ranged, &ranged).is_empty() && told(&linear, &linear).is_empty());
    }

    #[test]
    fn ranges_of_panels() {
        let run = |values: &[f64]| vec![values.iter().enumerate().map(|(i, y)| [i as f64, *y]).collect()];
        let of = |all: &[Runs], axis: Axis| {
            let x = x_range(all.iter(), &Axis::default(), false);
            let panels: Vec<Reach<'_>> = all.iter().map(|runs| Reach { runs: vec![runs], group: 0 }).collect();
            let (y, shared) = y_ranges(&panels, &[&axis], x);
            let ends = |range: Range| (range.lo, range.hi);
            (ends(x), y.into_iter().map(|y| y.map(ends)).collect::<Vec<_>>(), shared[0])
        };
        let some = [run(&[0.0, 10.0]), run(&[5.0, 6.0]), vec![]];
        let both = Some((-0.5, 10.5));
        assert_eq!(of(&some, Axis::default()), ((0.0, 1.0), vec![both, both, None], true));
        assert!(!of(&[run(&[0.0, 10.0]), run(&[5.0, 5.1])], Axis::default()).2);
        let set = Axis { range: Some([1.0, 2.0]), ..Axis::default() };
        assert_eq!(of(&[run(&[0.0, 10.0]), run(&[5.0, 5.1])], set).1, [Some((1.0, 2.0)); 2]);
        assert_eq!(widen((5.0, 5.0), 0.05), (4.5, 5.5));
        assert_eq!(widen((0.0, 0.0), 0.05), (-1.0, 1.0));
        let log = Range::around((1.0, 100.0), Scale::Log, 0.0);
        assert_eq!((log.share(1.0), log.share(10.0), log.share(100.0)), (0.0, 0.5, 1.0));
    }
}
