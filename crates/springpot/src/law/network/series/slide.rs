//! Friction in a series: F = f·tanh(v/v0), whose rate v is what is left over.
//!
//! No force says how fast it slides where it slides fast: its rate is looked for, of several that of the weakest, whose force the others
//! follow at v_k = v0_k·atanh(F/f_k).

use super::Matrix;
use super::solve::invert;
use crate::collocation::MAX_NODES;
use crate::law::leaf::Slide;
use crate::law::network::MOST_IN_SERIES;

/// Beyond this share of its force friction does not tell its rate.
const MOST_SHARE: f64 = 1.0 - 4.0 * f64::EPSILON;

/// Iterations for the rates, and how often one of them is halved.
const MOST_ITERATIONS: usize = 200;
const MOST_HALVINGS: usize = 40;

type Nodes = [f64; MAX_NODES];

/// What all friction of a series does at one node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Friction {
    each: [Option<Slide>; MOST_IN_SERIES],
}

/// Forces and rates of the weakest friction at the nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding {
    pub(super) force: Nodes,
    pub(super) rate: Nodes,
    /// ∂F/∂g.
    pub(super) tangent: Matrix,
}

/// A force, the rate of all friction, and how they follow the rate of the weakest.
struct Flow {
    force: f64,
    rate: f64,
    slopes: [f64; 2],
}

impl Friction {
    /// That of parts by their places in the series.
    pub(super) fn of(each: impl Iterator<Item = (usize, Slide)>) -> Self {
        let mut own = Self::default();
        each.for_each(|(k, slide)| own.each[k] = Some(slide));
        own
    }

    fn weakest(&self) -> Slide {
        let each = self.each.iter().flatten().copied();
        each.reduce(|a, b| if b.force < a.force { b } else { a }).unwrap_or(Slide { force: 0.0, rate: 1.0 })
    }

    /// The rates of the parts where the weakest has the rate `rate`.
    pub(super) fn rates(&self, rate: f64) -> [f64; MOST_IN_SERIES] {
        let weakest = self.weakest();
        self.each.map(|slide| slide.map_or(0.0, |slide| slide.rate * slide.angle(&weakest, rate / weakest.rate)[0]))
    }

    fn flow(&self, rate: f64) -> Flow {
        let weakest = self.weakest();
        let angle = rate / weakest.rate;
        let (mut sum, mut slope) = (0.0, 0.0);
        for slide in self.each.iter().flatten() {
            let [own, by_angle] = slide.angle(&weakest, angle);
            sum += slide.rate * own;
            slope += slide.rate * by_angle / weakest.rate;
        }
        let force = weakest.force * angle.tanh();
        Flow { force, rate: sum, slopes: [weakest.force / weakest.rate * angle.cosh().powi(-2), slope] }
    }
}

impl Slide {
    /// The rate at which it has the force `force`; `None` where that is all it has.
    pub(super) fn rate_under(&self, force: f64) -> Option<f64> {
        let share = force / self.force;
        (share.abs() < MOST_SHARE).then(|| self.rate * share.atanh())
    }

    /// The largest rate that its force tells, in the direction of `force`.
    pub(super) fn most(&self, force: f64) -> f64 {
        self.rate * MOST_SHARE.atanh().copysign(force)
    }

    /// atanh(F/f) under the force of the weakest where its v/v0 is `angle`, and the slope of it.
    fn angle(&self, weakest: &Self, angle: f64) -> [f64; 2] {
        if self.force <= weakest.force {
            return [angle, 1.0];
        }
        let (share, steep) = (weakest.force / self.force, angle.tanh());
        let slope = share * angle.cosh().powi(-2) / (1.0 - (share * steep).powi(2));
        [(share * steep).atanh(), slope]
    }
}

/// The rates at which g = h·A·v + C·F at `count` nodes, `moved` h·A; nodes that are not `carried` have neither force nor rate. `None` where none
/// are found.
pub(super) fn solve(
    friction: &[Friction; MAX_NODES],
    moved: &Matrix,
    compliance: &Matrix,
    gap: &Nodes,
    carried: &[bool; MAX_NODES],
    count: usize,
) -> Option<Sliding> {
    let apart = |rate: &Nodes| -> (Nodes, [Flow; MAX_NODES], f64) {
        let flows: [Flow; MAX_NODES] = std::array::from_fn(|i| match carried[i] && i < count {
            true => friction[i].flow(rate[i]),
            false => Flow { force: 0.0, rate: 0.0, slopes: [0.0, 1.0] },
        });
        let left: Nodes = std::array::from_fn(|i| {
            if !(carried[i] && i < count) {
                return 0.0;
            }
            (0..count).fold(gap[i], |left, j| left - moved[i][j] * flows[j].rate - compliance[i][j] * flows[j].force)
        });
        let size = left.iter().map(|left| left * left).sum::<f64>();
        (left, flows, size)
    };
    let invert_at = |flows: &[Flow; MAX_NODES]| {
        let mut matrix = Matrix::default();
        for i in 0..count {
            for j in 0..count {
                matrix[i][j] = match carried[i] {
                    true if carried[j] => moved[i][j] * flows[j].slopes[1] + compliance[i][j] * flows[j].slopes[0],
                    _ => f64::from(u8::from(i == j)),
                };
            }
        }
        (0..count).filter(|&i| carried[i]).for_each(|i| {
            (0..count).filter(|&j| !carried[j]).for_each(|j| matrix[i][j] = 0.0);
        });
        invert(&mut matrix, count, f64::MIN_POSITIVE);
        matrix
    };
    // From rest: ways there go down all along.
    let mut rate = Nodes::default();
    let (mut left, mut flows, mut size) = apart(&rate);
    for _ in 0..MOST_ITERATIONS {
        let inverse = invert_at(&flows);
        let step: Nodes = inverse.map(|row| row.iter().zip(&left).map(|(entry, left)| entry * left).sum());
        let (mut share, mut is_nearer, before) = (1.0, false, rate);
        for _ in 0..MOST_HALVINGS {
            let next: Nodes = std::array::from_fn(|i| before[i] + share * step[i]);
            let found = apart(&next);
            if found.2 < size {
                (rate, is_nearer) = (next, true);
                (left, flows, size) = found;
                break;
            }
            share *= 0.5;
        }
        let largest = |of: &Nodes| of.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let rounding = 8.0 * f64::EPSILON * largest(gap);
        let is_there = size == 0.0 || largest(&left) <= rounding || largest(&step) <= 1e-14 * largest(&rate);
        if is_there || !is_nearer {
            // Where rounding lets them come no nearer they are there, if they came near at all.
            let is_near = largest(&left) <= 1e-10 * largest(gap);
            let mut tangent = invert_at(&flows);
            for (i, row) in tangent.iter_mut().enumerate() {
                let slope = if carried[i] && i < count { flows[i].slopes[0] } else { 0.0 };
                row.iter_mut().zip(carried).for_each(|(entry, on)| *entry *= if *on { slope } else { 0.0 });
            }
            let force = std::array::from_fn(|i| flows[i].force);
            return (is_there || is_near).then_some(Sliding { force, rate, tangent });
        }
    }
    None
}
