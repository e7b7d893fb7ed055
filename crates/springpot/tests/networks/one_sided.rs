//! Parts of a series that let go: ropes, pads, stops and friction in front of what relaxes.
//!
//! The references know where they change sides by closed forms: Mittag-Leffler functions while both carry, convolutions with them while what was
//! stretched comes back, exponentials of dashpots, quadratures of friction.

use crate::{along, departure, force, slider, solved};
use springpot::collocation::{MAX_NODES, Nodes};
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::fractional::mittag_leffler::MittagLeffler;
use springpot::law::{Derivative, Network, NetworkText, Start};
use std::f64::consts::PI;

pub(crate) fn network(text: &str, values: &[f64]) -> Network {
    NetworkText::parse(text).unwrap().entry().build(values, Derivative::Caputo).unwrap()
}

/// Places from `a` to `b`, how far each is from `b`, and its weight, of the double exponential rule: for what may be singular at both ends.
fn nodes(a: f64, b: f64) -> Vec<[f64; 3]> {
    const SPACING: f64 = 0.075;
    let half = 0.5 * (b - a);
    let at = |k: i32| {
        let s = f64::from(k) * SPACING;
        let u = 0.5 * PI * s.sinh();
        let weight = 0.5 * PI * s.cosh() / u.cosh().powi(2) * SPACING;
        // Near an end its distance has all its digits.
        let near = half * (-u.abs()).exp() / u.abs().cosh();
        let left = if u < 0.0 { b - a - near } else { near };
        [if u < 0.0 { a + near } else { b - near }, left, half * weight]
    };
    (-64..=64).map(at).filter(|[_, left, weight]| *weight > 0.0 && *left > 0.0).collect()
}

/// The first zero of a function that is positive at `from` and negative at `to`.
fn zero(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let (mut low, mut high) = (from, to);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    high
}

/// A spring k that pulls only, in series with a springpot c, alpha that has a spring `beside` it, along a motion with corners: up at the rate v,
/// down from `top` at the same, up again from `turn` at twice that.
struct Rope {
    k: f64,
    beside: f64,
    c: f64,
    alpha: f64,
    v: f64,
    top: f64,
    turn: f64,
}

impl Rope {
    fn stroke(&self, t: f64) -> f64 {
        self.v * (t - 2.0 * (t - self.top).max(0.0) + 3.0 * (t - self.turn).max(0.0))
    }

    fn motion(&self, sign: f64) -> String {
        let Self { v, top, turn, .. } = self;
        along(&format!("{}*(t - 2*max(t - {top}, 0) + 3*max(t - {turn}, 0))", sign * v))
    }

    fn law(&self, front: &str) -> Network {
        match self.beside {
            0.0 => network(&format!("series({front}(k), springpot(c, alpha))"), &[self.k, self.c, self.alpha]),
            beside => network(
                &format!("series({front}(k), parallel(spring(b), springpot(c, alpha)))"),
                &[self.k, beside, self.c, self.alpha],
            ),
        }
    }

    /// Forces at these times, and when it goes slack and is taut again.
    fn forces(&self, times: &[f64]) -> (Vec<f64>, [f64; 2]) {
        let Self { k, beside, c, alpha, v, top, .. } = *self;
        let ml = |b: f64, rate: f64| {
            let function = MittagLeffler::new(alpha, b).unwrap();
            move |t: f64| function.real(-rate * t.powf(alpha))
        };
        let (ramp, relaxes, recovers) =
            (ml(2.0 + alpha, (k + beside) / c), ml(alpha, (k + beside) / c), ml(alpha, beside / c));
        // k and (beside + c s^α) in series along a ramp: k t − k²/c t^(1+α) E_{α,2+α}.
        let along_ramp = |t: f64| if t <= 0.0 { 0.0 } else { k * t - k * k / c * t.powf(1.0 + alpha) * ramp(t) };
        let first = |t: f64| v * (along_ramp(t) - 2.0 * along_ramp(t - top));
        let slack = zero(first, top, 2.0 * top + 1.0);
        let pulled: Vec<[f64; 2]> = [nodes(0.0, top), nodes(top, slack)]
            .concat()
            .iter()
            .map(|[s, _, weight]| [*s, weight * first(*s)])
            .collect();
        // How much the springpot is still stretched.
        let left = |t: f64| {
            let back = |s: f64| s.powf(alpha - 1.0) / c * recovers(s);
            pulled.iter().map(|[s, pull]| pull * back(t - s)).sum::<f64>()
        };
        let missing = |t: f64| left(t) - self.stroke(t);
        let taut = zero(missing, self.turn, self.turn + 10.0 * top);
        let second = |t: f64| {
            let memory = |s: f64| k * k / c * s.powf(alpha - 1.0) * relaxes(s);
            let past: f64 = nodes(taut, t).iter().map(|[s, ago, weight]| weight * memory(*ago) * -missing(*s)).sum();
            -k * missing(t) - past
        };
        let at = |t: &f64| match *t {
            t if t <= slack => first(t),
            t if t <= taut => 0.0,
            t => second(t),
        };
        (times.iter().map(at).collect(), [slack, taut])
    }
}

#[test]
fn ropes_and_pads_go_slack_recover_and_are_taut_again() {
    let of = |k: f64, beside: f64, c: f64, alpha: f64| Rope { k, beside, c, alpha, v: 0.2, top: 0.5, turn: 1.1 };
    for rope in [
        of(90.0, 0.0, 40.0, 0.5),
        of(2e4, 0.0, 40.0, 0.3),
        of(90.0, 0.0, 15.0, 0.8),
        of(300.0, 30.0, 40.0, 0.4),
        of(90.0, 60.0, 9.0, 0.7),
    ] {
        for (front, sign) in [("tension", 1.0), ("compression", -1.0)] {
            let rtol = 1e-9;
            let run = slider(&[rope.law(front)], &rope.motion(sign), 2.0, 40, rtol);
            let (wanted, [slack, taut]) = rope.forces(&run.t());
            assert!(rope.top < slack && slack < rope.turn && rope.turn < taut && taut < 1.8, "{slack} {taut}");
            let wanted: Vec<f64> = wanted.iter().map(|force| sign * force).collect();
            let error = departure(&force(&run), &wanted);
            assert!(error < 1e-8, "{front} {} {}: {error:e} in {} steps", rope.k, rope.alpha, run.effort());
            assert!(run.residual() < 10.0 * rtol, "{front}: {:e}", run.residual());
            // Slack is slack to the last bit.
            let is_slack = |t: f64| slack + 1e-6 < t && t < taut - 1e-6;
            let slack = run.t().into_iter().zip(force(&run)).filter(|(t, _)| is_slack(*t));
            slack.for_each(|(t, force)| assert_eq!(force, 0.0, "at {t}"));
        }
    }
}

/// Friction behind a spring along corners: with F = f tanh y, k (x' − v0 y) = f y'/cosh² y, of which the time is a quadrature of y.
#[test]
fn a_spring_slides_on_friction() {
    let (v, top) = (0.2, 0.5);
    for (k, f, v0) in [(90.0, 1.5, 0.01), (90.0, 1.5, 0.1), (2e3, 4.0, 0.02), (40.0, 3.0, 1.0)] {
        let law = network("series(spring(k), friction(f, v0))", &[k, f, v0]);
        let rtol = 1e-9;
        let run = slider(&[law], &along(&format!("{v}*(t - 2*max(t - {top}, 0))")), 1.0, 40, rtol);
        let y_after = |from: f64, rate: f64, time: f64| {
            let passed = |to: f64| {
                let slope = |y: f64| f / k / y.cosh().powi(2) / (rate - v0 * y);
                nodes(from.min(to), from.max(to)).iter().map(|[y, _, weight]| weight * slope(*y)).sum::<f64>()
                    * (to - from).signum()
            };
            // It never comes to where all of the rate is friction's.
            let end = (rate / v0).clamp(-18.0, 18.0);
            if passed(end - 1e-9 * end.signum()) <= time {
                return end;
            }
            from + zero(|share| time - passed(from + share * (end - from)), 0.0, 1.0) * (end - from)
        };
        let turned = y_after(0.0, v, top);
        let at = |t: &f64| match *t {
            t if t <= top => f * y_after(0.0, v, t).tanh(),
            t => f * y_after(turned, -v, t - top).tanh(),
        };
        let wanted: Vec<f64> = run.t().iter().map(at).collect();
        let error = departure(&force(&run), &wanted);
        assert!(error < 1e-8, "{k} {f} {v0}: {error:e} in {} steps", run.effort());
        assert!(run.residual() < 10.0 * rtol, "{k} {f} {v0}: {:e}", run.residual());
    }
}

/// Numbers between 0 and 1 from a fixed seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// Corners of a motion: times, and the rate from each of them on.
type Corners = Vec<[f64; 2]>;

/// A spring k that is free from `lower` to `upper`, in series with a dashpot c: exponentials while it carries, a dashpot that stays while it does not.
fn on_a_dashpot(k: f64, c: f64, [lower, upper]: [f64; 2], corners: &Corners, times: &[f64]) -> Vec<f64> {
    let mut places: Vec<f64> = times.iter().copied().chain(corners.iter().map(|[from, _]| *from)).collect();
    places.sort_by(f64::total_cmp);
    let (mut t, mut own, mut known) = (0.0, 0.0f64, Vec::new());
    for until in places {
        let rate = corners.iter().rev().find(|[from, _]| *from <= t).map_or(0.0, |[_, rate]| *rate);
        let mut left = until - t;
        // Three times at most: to an end, off it, to the other.
        for _ in 0..3 {
            let end = if own > upper || (own == upper && rate > 0.0) {
                upper
            } else if own < lower || (own == lower && rate < 0.0) {
                lower
            } else {
                let way = if rate > 0.0 { upper - own } else { lower - own };
                let time = way / rate;
                if time < left {
                    (own, left) = (if rate > 0.0 { upper } else { lower }, left - time);
                    continue;
                }
                own += rate * left;
                break;
            };
            // F = c v + (F − c v) e^(−k t/c), until it is 0.
            let pull = k * (own - end);
            let gone = c / k * ((pull - c * rate) / (-c * rate)).ln();
            if pull * rate < 0.0 && gone < left {
                (own, left) = (end, left - gone);
                continue;
            }
            own = end + (c * rate + (pull - c * rate) * (-k * left / c).exp()) / k;
            break;
        }
        t = until;
        known.push((t, k * ((own - upper).max(0.0) + (own - lower).min(0.0))));
    }
    times.iter().map(|t| known.iter().find(|(at, _)| at == t).expect("every time is a place").1).collect()
}

/// One of them along a motion with corners, with its dashpot to be the only thing that yields.
fn random_on_a_dashpot(seed: u64) {
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    let (k, c) = (random.within(10.0, 1e4), random.within(1.0, 1e3));
    let (law, ends) = match seed % 3 {
        0 => (network("series(tension(k), dashpot(c))", &[k, c]), [f64::NEG_INFINITY, 0.0]),
        1 => (network("series(dashpot(c), compression(k))", &[c, k]), [0.0, f64::INFINITY]),
        _ => {
            let [lower, upper] = [-random.within(1e-3, 0.05), random.within(1e-3, 0.05)];
            (network("series(stop(k, a, b), dashpot(c))", &[k, lower, upper, c]), [lower, upper])
        }
    };
    let (mut corners, mut motion, mut before) = (Corners::new(), "0".to_owned(), 0.0);
    for part in 0..5 {
        let rate = random.within(0.02, 0.6) * if random.next() < 0.5 { -1.0 } else { 1.0 };
        let from = 0.2 * (f64::from(part) + if part == 0 { 0.0 } else { 0.5 * random.next() });
        corners.push([from, rate]);
        motion += &format!(" + {:e}*max(t - {from:e}, 0)", rate - before);
        before = rate;
    }
    let rtol = 1e-9;
    let run = slider(&[law], &along(&motion), 1.0, 25, rtol);
    let wanted = on_a_dashpot(k, c, ends, &corners, &run.t());
    let largest = wanted.iter().fold(0.0f64, |largest, force| largest.max(force.abs()));
    if largest > 0.0 {
        let error = departure(&force(&run), &wanted);
        assert!(error < 1e-8, "{seed}: {error:e}, {k} {c} {ends:?} along {motion}");
    }
    assert!(run.residual() < 10.0 * rtol, "{seed}: {:e}, {k} {c} {ends:?} along {motion}", run.residual());
}

#[test]
fn stops_on_dashpots_are_exponentials() {
    (0..15).for_each(random_on_a_dashpot);
}

#[test]
#[ignore = "minutes: 400 random stops on dashpots"]
fn many_stops_on_dashpots_are_exponentials() {
    (0..400).for_each(random_on_a_dashpot);
}

/// Where all parts are springs the force is that at which their strokes add up, slack or not.
#[test]
fn springs_with_play_are_statics() {
    let law = network(
        "series(stop(k, a, b), tension(l), polynomial(m, n, o), stop(p, q, r))",
        &[90.0, -0.02, 0.03, 200.0, 40.0, 0.0, 900.0, 60.0, -0.01, 0.01],
    );
    let run = slider(&[law], &along("0.05*t*cos(4*t)"), 4.0, 80, 1e-9);
    let exact = |t: f64| {
        let x = 0.05 * t * (4.0 * t).cos();
        let inner = |force: f64| {
            let y = zero(|y| force - 40.0 * y - 900.0 * y.powi(3), 0.0, 1.0);
            0.04 + force * (1.0 / 90.0 + 1.0 / 200.0 + 1.0 / 60.0) + y
        };
        // The rope pulls only.
        if x <= inner(0.0) { 0.0 } else { zero(|force| x - inner(force), 0.0, 100.0) }
    };
    let wanted: Vec<f64> = run.t().iter().map(|t| exact(*t)).collect();
    assert!(wanted.contains(&0.0));
    let error = departure(&force(&run), &wanted);
    assert!(error < 1e-12, "{error:e}");
    assert!(run.residual() < 1e-8, "{:e}", run.residual());
}

fn forward(q: f64, v: f64, torque: &str) -> String {
    format!("kind = \"forward\"\nstart = {{ q = {{ q = {q} }}, v = {{ q = {v} }} }}\ntorque = {{ q = \"{torque}\" }}")
}

/// Masses that are dropped, thrown and shaken: energy stays, and stricter tolerances change no more than they may.
#[test]
fn masses_on_what_lets_go() {
    for (text, values, motion) in [
        (
            "series(compression(k), parallel(spring(b), springpot(c, alpha)))",
            &[9e3, 500.0, 40.0, 0.4][..],
            forward(0.2, 0.0, "-9.81"),
        ),
        ("series(compression(k), springpot(c, alpha))", &[9e3, 400.0, 0.7], forward(0.2, -1.0, "-9.81")),
        ("series(tension(k), springpot(c, alpha))", &[900.0, 40.0, 0.5], forward(0.0, -1.0, "3 - 4*sin(5*t)")),
        (
            "series(stop(k, a, b), springpot(c, alpha))",
            &[900.0, -0.05, 0.05, 30.0, 0.5],
            forward(0.0, 1.0, "3*sin(5*t)"),
        ),
        ("series(spring(k), friction(f, v0))", &[900.0, 1.5, 0.01], forward(0.0, 1.0, "3*sin(5*t)")),
        (
            "series(tension(k), springpot(c, alpha), friction(f, v0))",
            &[900.0, 40.0, 0.5, 1.5, 0.01],
            forward(0.0, -1.0, "3 - 4*sin(5*t)"),
        ),
    ] {
        let law = network(text, values);
        let [strict, run] = [1e-11, 1e-9].map(|rtol| slider(std::slice::from_ref(&law), &motion, 2.0, 50, rtol));
        for (column, bound) in [("e0.force", 1e-7), ("q.q", 1e-8)] {
            let error = departure(&run.column(column), &strict.column(column));
            assert!(error < bound, "{text}: {column} {error:e}");
        }
        assert!(
            run.residual() < 1e-8 && strict.residual() < 1e-10,
            "{text}: {:e} {:e}",
            run.residual(),
            strict.residual()
        );
        if text.contains("tension") {
            assert!(force(&run).iter().all(|force| *force >= 0.0), "{text}: a rope pushes");
        }
    }
}

/// Thrown up from a pad that comes back more slowly, a mass flies as if there were none.
#[test]
fn what_flies_is_free() {
    let law = network("series(compression(k), dashpot(c))", &[4e4, 50.0]);
    let run = slider(&[law], &forward(0.0, 3.0, "-9.81"), 0.6, 30, 1e-9);
    let q = run.column("q.q");
    let wanted: Vec<f64> = run.t().iter().map(|t| 3.0 * t - 0.5 * 9.81 * t * t).collect();
    assert!(departure(&q, &wanted) < 1e-12 && force(&run).iter().all(|force| *force == 0.0));
}

/// Held since ever what flows has come back to no force, and a play is as near to free as it can; unloaded before t = 0 the springs have it all, but
/// for what friction lets go.
#[test]
fn where_they_start() {
    let at_start = |text: &str, values: &[f64], derivative: Derivative, stroke: f64| {
        let law = NetworkText::parse(text).unwrap().entry().build(values, derivative).unwrap();
        let jump = if derivative == Derivative::RiemannLiouville { stroke } else { 0.0 };
        let state = law.begin(&Start { stroke, jump, inputs: &[] }).unwrap();
        let at = springpot::law::Point { t: 0.0, stroke, rate: 0.0, inputs: &[] };
        let mut leaves = Vec::new();
        law.leaves_now(&at, &state, &mut leaves);
        (law.now(&at, &state).force(), leaves.iter().map(|leaf| leaf.stroke).collect::<Vec<_>>())
    };
    let (caputo, jumped) = (Derivative::Caputo, Derivative::RiemannLiouville);
    let rope = "series(tension(k), springpot(c, alpha))";
    assert_eq!(at_start(rope, &[90.0, 40.0, 0.5], caputo, 0.1), (0.0, vec![0.0, 0.1]));
    assert_eq!(at_start(rope, &[90.0, 40.0, 0.5], caputo, -0.1), (0.0, vec![-0.1, 0.0]));
    assert_eq!(at_start(rope, &[90.0, 40.0, 0.5], jumped, 0.1), (9.0, vec![0.1, 0.0]));
    assert_eq!(at_start(rope, &[90.0, 40.0, 0.5], jumped, -0.1), (0.0, vec![-0.1, 0.0]));
    let stop = "series(stop(k, a, b), parallel(spring(l), springpot(c, alpha)))";
    let (pull, strokes) = at_start(stop, &[90.0, -0.05, 0.05, 30.0, 40.0, 0.5], caputo, 0.25);
    assert!((pull - 0.2 * 22.5).abs() < 1e-13 && (strokes[1] - 0.15).abs() < 1e-14, "{pull} {strokes:?}");
    let slides = "series(spring(k), friction(f, v0))";
    let (pull, strokes) = at_start(slides, &[90.0, 1.5, 0.01], jumped, -0.3);
    assert!((pull + 1.5).abs() < 1e-12 && (strokes[1] + 0.3 - 1.5 / 90.0).abs() < 1e-12, "{pull} {strokes:?}");
    assert_eq!(at_start(slides, &[90.0, 1.5, 0.01], jumped, 0.01).0, 0.9);
}

/// A bank of all of them on a step from 0 with the strokes of a straight way.
fn bank(laws: &[Network], nodes: Nodes, h: f64) -> ElementBank {
    let mut bank = ElementBank::new(laws.to_vec(), nodes, Form::Strokes);
    let start = Start { stroke: 0.0, jump: 0.0, inputs: &[] };
    bank.begin(&vec![start; laws.len()], MemoryRange { tolerance: 1e-9, shortest: h, horizon: 10.0 }).unwrap();
    bank
}

fn laws() -> Vec<Network> {
    vec![
        network("series(tension(k), springpot(c, alpha))", &[90.0, 40.0, 0.5]),
        network("series(parallel(spring(b), springpot(c, alpha)), compression(k))", &[50.0, 40.0, 0.3, 900.0]),
        network("series(stop(k, a, b), dashpot(c))", &[90.0, -0.03, 0.02, 5.0]),
        network("series(spring(k), friction(f, v0))", &[90.0, 1.5, 1e-3]),
        network(
            "series(tension(k), springpot(c, alpha), friction(f, v0), friction(g, w0))",
            &[90.0, 40.0, 0.5, 1.5, 1e-3, 1.6, 1e-2],
        ),
        network("series(stop(k, a, b), polynomial(l, m, n), dashpot(c))", &[90.0, -0.03, 0.02, 30.0, 0.0, 500.0, 5.0]),
        network("parallel(spring(b), series(tension(k), dashpot(c)))", &[5.0, 90.0, 4.0]),
    ]
}

/// Steps that nobody ends on a kink: a rope never pushes, forces are there for any stroke, tangents are those of differences, and what is taken
/// back goes on to the bit.
#[test]
fn a_bank_knows_no_kinks() {
    let laws = laws();
    let (h, mut random) = (0.01, Random(3));
    for shape in [Nodes::Radau, Nodes::One, Nodes::Midpoint] {
        let mut bank = bank(&laws, shape, h);
        let mut other = bank.clone();
        let places: Vec<f64> = std::iter::once(0.0).chain(shape.positions().iter().copied()).collect();
        let mut from = 0.0;
        for n in 0..150 {
            let to = if n % 7 < 5 { from + 0.04 * (random.next() - 0.5) } else { -from };
            let tell = |bank: &mut ElementBank, e: usize, moved: [f64; MAX_NODES]| {
                for (point, c) in places.iter().enumerate() {
                    let more = if point == 0 { 0.0 } else { moved[point - 1] };
                    bank.set(e, point, from + c * (to - from) + more, (to - from) / h, &[]);
                }
            };
            bank.start(f64::from(n) * h, h);
            (0..laws.len()).for_each(|e| tell(&mut bank, e, [0.0; MAX_NODES]));
            bank.evaluate();
            let count = shape.count();
            for (e, sign) in [(0, 1.0), (1, -1.0), (4, 1.0)] {
                let forces = &bank.response(e).force[..count];
                // What a polynomial through four nodes says at three may pass beyond by little where one of them is a kink.
                let largest = forces.iter().fold(1e-3f64, |most, force| most.max(force.abs()));
                assert!(forces.iter().all(|force| sign * force >= -0.3 * largest), "{e} {shape:?}: {forces:?}");
                assert!(
                    shape == Nodes::Radau || forces.iter().all(|force| sign * force >= 0.0),
                    "{e} {shape:?}: {forces:?}"
                );
            }
            if n % 10 == 0 {
                differences(&mut bank, &laws, count, &tell);
            }
            if n == 75 {
                let mut numbers = Vec::new();
                bank.save(&mut numbers);
                assert!(other.load(&numbers));
            }
            bank.commit();
            if n >= 75 {
                other.start(f64::from(n) * h, h);
                (0..laws.len()).for_each(|e| tell(&mut other, e, [0.0; MAX_NODES]));
                other.evaluate();
                (0..laws.len()).for_each(|e| assert_eq!(bank.response(e), other.response(e), "{e} in step {n}"));
                other.commit();
            }
            from = to;
        }
    }
}

/// Tangents by strokes against differences, but where a kink is between them.
fn differences(
    bank: &mut ElementBank,
    laws: &[Network],
    count: usize,
    tell: &dyn Fn(&mut ElementBank, usize, [f64; MAX_NODES]),
) {
    let size = 1e-8;
    for e in 0..laws.len() {
        let exact = *bank.response(e);
        for j in 0..count {
            let [above, below] = [size, -size].map(|size| {
                let mut moved = [0.0; MAX_NODES];
                moved[j] = size;
                tell(bank, e, moved);
                bank.evaluate();
                bank.response(e).force
            });
            for i in 0..count {
                let sides = [above[i] - exact.force[i], exact.force[i] - below[i]].map(|moved| moved / size);
                let own = exact.d_stroke[i][j];
                let between = sides[0].min(sides[1]) - 1e-3 * (1.0 + own.abs())
                    ..=sides[0].max(sides[1]) + 1e-3 * (1.0 + own.abs());
                assert!(between.contains(&own), "{own} is not in {between:?}: {e} {i} {j}");
            }
        }
        tell(bank, e, [0.0; MAX_NODES]);
    }
    bank.evaluate();
}

/// A run of many steps that are too long for its kinks comes to the same as one that ends on them.
#[test]
fn steps_of_one_size_come_to_the_same() {
    let motion = forward(0.1, 0.0, "-9.81");
    let law = network("series(compression(k), parallel(spring(b), springpot(c, alpha)))", &[900.0, 50.0, 40.0, 0.6]);
    let exact = slider(std::slice::from_ref(&law), &motion, 1.0, 20, 1e-9).column("q.q");
    let off = [1e-3, 2.5e-4].map(|h| {
        let solver = format!("method = \"midpoint\"\nstep = {h}");
        departure(&solved(std::slice::from_ref(&law), &motion, 1.0, 20, &solver).column("q.q"), &exact)
    });
    assert!(off[1] < 0.3 * off[0] && off[1] < 1e-3, "{off:?}");
}
