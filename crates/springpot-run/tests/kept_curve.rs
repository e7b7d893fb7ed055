//! Curves that keep what can be seen of them: bounded points, and as near to the full curve as is said.

use springpot::law::Catalog;
use springpot_run::sweep::{KeptCurve, Layout, LeftOut, MAX_CURVES_IN_ALL, most_points};
use springpot_scenario::Scenario;
use std::f64::consts::TAU;

type Points = Vec<[f64; 2]>;

/// The fewest that a curve may keep: what is bounded by it shows soonest.
const MOST: usize = 1024;
/// Widest column and largest cell, as shares of the extent.
const COLUMN: f64 = 16.5 / MOST as f64;
const CELL: f64 = 1.0 / 512.0;

fn kept(points: &[[f64; 2]]) -> Points {
    let mut curve = KeptCurve::new(MOST);
    for [x, y] in points {
        curve.push(*x, *y);
        assert!(curve.points().len() <= MOST);
    }
    curve.points().to_vec()
}

fn finite(point: &[f64; 2]) -> bool {
    point.iter().all(|v| v.abs() <= 1e300)
}

/// Lowest and highest coordinates.
fn extent(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| {
        let values = points.iter().filter(|point| finite(point)).map(|point| point[axis]);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    })
}

/// Points as shares of `extent`.
fn shares(points: &[[f64; 2]], extent: [[f64; 2]; 2]) -> Points {
    let share = |axis: usize, v: f64| (v - extent[axis][0]) / (extent[axis][1] - extent[axis][0]);
    points.iter().map(|point| [share(0, point[0]), share(1, point[1])]).collect()
}

/// Largest distance of a point of `points` from the line through `line`, in which gaps are no line.
fn farthest(points: &[[f64; 2]], line: &[[f64; 2]]) -> f64 {
    let to_segment = |p: [f64; 2], a: [f64; 2], b: [f64; 2]| {
        let (d, o) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let square = d[0] * d[0] + d[1] * d[1];
        let along = if square > 0.0 { ((o[0] * d[0] + o[1] * d[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
        (o[0] - along * d[0]).hypot(o[1] - along * d[1])
    };
    let segments: Vec<_> =
        line.windows(2).map(|pair| (pair[0], pair[1])).filter(|(a, b)| finite(a) && finite(b)).collect();
    let nearest = |p: &[f64; 2]| segments.iter().map(|(a, b)| to_segment(*p, *a, *b)).fold(f64::INFINITY, f64::min);
    points.iter().filter(|point| finite(point)).map(nearest).fold(0.0, f64::max)
}

/// The points of a line and others between them.
fn along(line: &[[f64; 2]]) -> Points {
    let between = |a: [f64; 2], b: [f64; 2], s: f64| [0, 1].map(|k| a[k] + s * (b[k] - a[k]));
    line.windows(2).flat_map(|pair| [0.0, 0.5].map(|s| between(pair[0], pair[1], s))).collect()
}

/// Checks that nothing of either curve is farther than `near` from the other, as a share of the extent, and that the extremes and
/// ends are kept.
fn same_picture(name: &str, full: &[[f64; 2]], near: f64) -> Points {
    let kept = kept(full);
    let extent_of_full = extent(full);
    assert_eq!(extent(&kept), extent_of_full, "{name}");
    assert_eq!((kept[0], kept[kept.len() - 1]), (full[0], full[full.len() - 1]), "{name}");
    let (few, all) = (shares(&kept, extent_of_full), shares(full, extent_of_full));
    let (lost, added) = (farthest(&all, &few), farthest(&along(&few), &all));
    println!("{name}: {} of {} points, lost {lost:.1e}, added {added:.1e} of {near:.1e}", kept.len(), full.len());
    assert!(lost <= near && added <= near, "{name}: {lost} {added} {near}");
    kept
}

/// Numbers in 0 … 1 that look random and are always the same.
fn noise(count: usize, seed: u64) -> impl Iterator<Item = f64> {
    let mut state = seed;
    (0..count).map(move |_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    })
}

fn sampled(count: usize, at: impl Fn(f64) -> [f64; 2]) -> Points {
    (0..count).map(|k| at(k as f64 / (count - 1) as f64)).collect()
}

#[test]
fn short_curves_are_kept_whole() {
    let points: Points = noise(2 * MOST, 1).zip(noise(2 * MOST, 2)).map(|(x, y)| [x, y]).collect();
    let mut curve = KeptCurve::new(MOST);
    for (k, [x, y]) in points[..MOST].iter().enumerate() {
        curve.push(*x, if k % 7 == 3 { f64::NAN } else { *y });
        assert_eq!(curve.points().len(), k + 1);
    }
    for (k, (kept, [x, y])) in curve.points().iter().zip(&points).enumerate() {
        assert_eq!(kept[0], *x);
        assert!(kept[1] == *y || k % 7 == 3 && kept[1].is_nan());
    }
}

#[test]
fn long_graphs_look_the_same() {
    let count = 6_000;
    same_picture("slow wave", &sampled(count, |t| [t, (20.0 * t).sin()]), COLUMN);
    same_picture("dense wave", &sampled(count, |t| [t, (5000.0 * t).sin()]), COLUMN);
    same_picture(
        "chirp that grows",
        &sampled(count, |t| [1e9 + 1e3 * t, 1e-9 * t * t * (4000.0 * t * t).cos()]),
        COLUMN,
    );
    same_picture("decay", &sampled(count, |t| [t * t, (-500.0 * t).exp()]), COLUMN);
    let scatter: Points = noise(count, 3).enumerate().map(|(k, y)| [k as f64, y.powi(9)]).collect();
    let kept = same_picture("scatter", &scatter, COLUMN);
    assert!(kept.len() > MOST / 4, "{}", kept.len());
    let mut spikes = sampled(count, |t| [t, 0.1 * t]);
    for k in [1, 777, 3_001, 5_998] {
        spikes[k][1] = if k % 2 == 0 { 3.0 } else { -4.0 };
    }
    let kept = same_picture("spikes", &spikes, COLUMN);
    assert!([1, 777, 3_001, 5_998].iter().all(|&k| kept.contains(&spikes[k])));
}

#[test]
fn long_loops_look_the_same() {
    let count = 6_000;
    let near = 3.0 * CELL;
    let turn = |t: f64, size: f64| [size * (TAU * t).cos(), 3.0 + size * (TAU * t + 0.4).sin()];
    same_picture("one ellipse, 60 times", &sampled(count, |t| turn(60.3 * t, 1.0)), near);
    same_picture("few turns", &sampled(count, |t| turn(3.0 * t, 1.0 + t)), near);
    same_picture("a slow turn", &sampled(count, |t| turn(0.7 * t, 1.0)), near);
    same_picture("onto a limit cycle", &sampled(count, |t| turn(60.3 * t, 1.0 + 0.4 * (-30.0 * t).exp())), near);
    same_picture("outwards", &sampled(count, |t| turn(20.0 * t, 1e-3 + t * t * t)), near);
}

#[test]
fn scribbles_stay_within_the_bound() {
    let count = 6_000;
    let scribble: Points = noise(count, 4).zip(noise(count, 5)).map(|(x, y)| [x, y]).collect();
    same_picture("scribble", &scribble, 0.08);
    let mut at = [0.0, 0.0];
    let steps = noise(count, 6).zip(noise(count, 7));
    let walk: Points = steps.map(|(x, y)| [x - 0.5, y - 0.5]).collect();
    let walk: Points = walk
        .iter()
        .map(|[x, y]| {
            at = [at[0] + x, at[1] + y];
            at
        })
        .collect();
    same_picture("walk", &walk, 0.08);
    let dense = sampled(count, |t| [t * (TAU * 300.0 * t).cos(), t * (TAU * 300.0 * t).sin()]);
    same_picture("spiral", &dense, 0.08);
    same_picture("a star", &sampled(count, |t| [(TAU * 7001.0 * t).cos(), (TAU * 7001.0 * t * 5.0).sin()]), 0.08);
}

#[test]
fn gaps_stay_gaps() {
    let mut full = sampled(50_000, |t| [t, (3000.0 * t).sin()]);
    let gaps = [0..1, 10_000..10_001, 20_000..24_000, 24_001..30_000, 49_000..50_000];
    for (k, gap) in gaps.iter().enumerate() {
        for point in &mut full[gap.clone()] {
            point[k % 2] = [f64::NAN, f64::INFINITY, 2e300][k % 3];
        }
    }
    let mut kept = kept(&full);
    assert!(kept.len() < MOST && kept.contains(&full[24_000]));
    kept.push([0.0, 0.0]);
    let place = |point: &[f64; 2]| (point[0] * 49_999.0).round() as usize;
    let crossed = kept
        .windows(2)
        .filter(|pair| pair.iter().all(finite))
        .filter(|pair| gaps.iter().any(|gap| (place(&pair[0])..place(&pair[1])).any(|k| gap.contains(&k))));
    assert_eq!(crossed.count(), 0);
    // Points alone between gaps, more than may be kept.
    let dots: Points =
        (0..40_000).map(|k| [f64::from(k), if k % 2 == 0 { f64::from(k % 2000) } else { f64::NAN }]).collect();
    let mut curve = KeptCurve::new(MOST);
    dots.iter().for_each(|[x, y]| curve.push(*x, *y));
    let extents = extent(&dots);
    let (few, all) = (shares(curve.points(), extents), shares(&dots, extents));
    let reach = |p: &[f64; 2]| {
        few.iter().map(|q| (p[0] - q[0]).hypot(p[1] - q[1])).filter(|d| d.is_finite()).fold(1.0, f64::min)
    };
    let lost = all.iter().filter(|point| finite(point)).map(reach).fold(0.0, f64::max);
    // No fewer cells than a quarter of the points, in powers of two.
    assert!(lost <= 0.125f64.hypot(0.125), "{lost}");
    assert!(few.windows(2).all(|pair| !(finite(&pair[0]) && finite(&pair[1]))));
}

#[test]
fn odd_curves_are_kept() {
    let count = 5 * MOST;
    for point in [[1.0, 2.0], [0.0, 0.0], [-1e300, 1e300], [5e-324, -0.0]] {
        let kept = kept(&vec![point; count]);
        assert!(kept.iter().all(|other| *other == point) && !kept.is_empty());
    }
    assert!(kept(&vec![[f64::NAN, 1.0]; count]).iter().all(|point| !finite(point)));
    let huge = sampled(count, |t| [1e300 * (40.0 * t).cos(), 1e300 * (60.0 * t).sin()]);
    let kept_of_huge = kept(&huge);
    assert_eq!(extent(&kept_of_huge), extent(&huge));
    let tiny = sampled(count, |t| [1e-320 * (40.0 * t).cos(), 1e-320 * (9000.0 * t).sin()]);
    assert!(!kept(&tiny).is_empty());
    let upright = sampled(count, |t| [7.0, (900.0 * t).sin()]);
    assert_eq!(extent(&kept(&upright)), extent(&upright));
}

#[test]
fn all_curves_together_are_bounded() {
    assert_eq!(most_points(0, 0), 65_536);
    assert_eq!(most_points(1, 1), 65_536);
    assert_eq!(most_points(16, 64), 65_536);
    assert_eq!(most_points(17, 64), 32_768);
    assert_eq!(most_points(64, 64), 16_384);
    assert_eq!(most_points(4, 65), 32_768);
    assert_eq!(most_points(64, MAX_CURVES_IN_ALL), 1024);
    for all in 1..=MAX_CURVES_IN_ALL {
        assert!(16 * all * most_points(1, all) <= 64 << 20, "{all}");
    }
}

#[test]
fn figures_beyond_the_bound_are_left_out() {
    let mut text = String::from(
        r#"
motion = { kind = "prescribed", joints = { q1 = "0.1*sin(t)" } }
time = { end = 1, output_step = 1 }
[[robot.body]]
name = "arm"
joint = { name = "q1", kind = "revolute", axis = [0, 1, 0] }
mass = 1
com = [0.2, 0, 0]
[[sweep]]
parameter = "robot.body.arm.mass"
values = { from = 1, to = 2, count = 64 }
"#,
    );
    let figure = "[[figure]]\ny = \"q.q1\"\n";
    text.push_str(&figure.repeat(MAX_CURVES_IN_ALL / 64 + 1));
    text.push_str(
        "[[figure]]\ny = [\"q.q1\", \"v.q1\"]\n[[figure]]\ny = \"v.q1\"\nwhere = { \"robot.body.arm.mass\" = 1 }\n",
    );
    let cases = Scenario::parse(&text, "arm.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
    let layout = Layout::new(&cases, &cases.plan(0).unwrap()).unwrap();
    let (drawn, left_out) = layout.figures().split_at(MAX_CURVES_IN_ALL / 64);
    assert!(drawn.iter().all(|figure| figure.left_out.is_none() && figure.cases.len() == 64));
    let why: Vec<_> = left_out.iter().map(|figure| figure.left_out.clone().unwrap()).collect();
    let in_all = |curves: usize| LeftOut::InAll { curves: MAX_CURVES_IN_ALL + curves };
    assert_eq!(why, [in_all(64), LeftOut::Curves { curves: 128 }, in_all(1)]);
    assert!(left_out.iter().all(|figure| figure.cases.is_empty() && figure.curves.is_empty()));
    assert_eq!(layout.most_points(), 1024);
}

/// Farthest that a point of a curve is from a part of its points, where both are drawn on logarithmic axes, as a share of their height.
fn off_on_logarithmic_axes(all: &[[f64; 2]], kept: &[[f64; 2]]) -> f64 {
    let drawn = |points: &[[f64; 2]]| points.iter().map(|[x, y]| [x.ln(), y.ln()]).collect::<Vec<_>>();
    let (all, kept) = (drawn(all), drawn(kept));
    let (low, high) =
        all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[1]), high.max(p[1])));
    let (mut next, mut farthest) = (1, 0.0f64);
    for [x, y] in &all {
        while next + 1 < kept.len() && kept[next][0] < *x {
            next += 1;
        }
        let [a, b] = [kept[next - 1], kept[next]];
        let line = a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]);
        farthest = farthest.max((line - y).abs() / (high - low));
    }
    farthest
}

#[test]
fn curves_on_logarithmic_axes_are_thinned_as_they_are_drawn() {
    // Six decades of a creep that rings, in a million equal steps.
    let rows: Vec<[f64; 2]> = (1..=1_000_000)
        .map(|k| f64::from(k) * 1e-3)
        .map(|t: f64| [t, t.powf(0.3) * (1.0 + 0.2 * (9.0 * t.ln()).sin())])
        .collect();
    let kept = |is_log: [bool; 2]| {
        let mut curve = KeptCurve::on_axes(1 << 16, is_log);
        rows.iter().for_each(|[x, y]| curve.push(*x, *y));
        curve.points().to_vec()
    };
    let log = kept([true; 2]);
    assert!(log.len() <= 1 << 16 && log.iter().all(|point| rows[(point[0] * 1e3).round() as usize - 1] == *point));
    // A tenth of a pixel of 440.
    let off = off_on_logarithmic_axes(&rows, &log);
    assert!(off < 2.5e-4, "{off}");
    let as_linear = off_on_logarithmic_axes(&rows, &kept([false; 2]));
    assert!(as_linear > 4.0 * off.max(1e-5), "{as_linear} beside {off}");
}

#[test]
fn what_a_logarithmic_axis_has_no_place_for_is_a_gap_that_stays() {
    let mut curve = KeptCurve::on_axes(1024, [false, true]);
    let rows: Vec<[f64; 2]> = (0..20_000).map(f64::from).map(|x| [x, (x * 1e-3).sin()]).collect();
    rows.iter().for_each(|[x, y]| curve.push(*x, *y));
    let points = curve.points();
    assert!(points.len() <= 1024);
    let below: Vec<&[f64; 2]> = points.iter().filter(|point| point[1].is_nan() || point[1] <= 0.0).collect();
    assert!(below.len() >= 3, "{below:?}");
    // Every half wave below zero leaves a gap, of a value that was there, and no line runs across it.
    for wave in 0..3 {
        let (from, to) =
            ((2 * wave + 1) as f64 * std::f64::consts::PI * 1e3, (2 * wave + 2) as f64 * std::f64::consts::PI * 1e3);
        assert!(below.iter().any(|point| point[0] > from && point[0] < to && point[1] < 0.0), "{wave}");
        let middle = 0.5 * (from + to);
        let crosses = |pair: &[[f64; 2]]| pair[0][0] < middle && pair[1][0] > middle && pair.iter().all(|p| p[1] > 0.0);
        assert!(!points.windows(2).any(crosses), "{wave}");
    }
}
