//! Rigid-body algorithms on one state at a time and on many side by side, at every level that the processor has.
//!
//! `cargo bench -p springpot --bench batch [-- SAMPLES [ROBOT…]]`: nanoseconds for each state, the median of interleaved samples, and how many times faster
//! than one state at a time a level is. Both begin with q, v and a as they stand in memory and end with the results there.

use std::hint::black_box;
use std::time::Instant;

use springpot::dynamics::batch::{self, BatchWorkspace};
use springpot::dynamics::{
    AbaDerivatives, Kinematics, RneaDerivatives, Workspace, aba_derivatives_into, aba_into, coriolis_into, crba_into,
    frame_jacobian_at_into, mass_inverse_into, pair_into, rnea_derivatives_into, rnea_into,
};
use springpot::model::description::{DescriptionOptions, RobotDescription};
use springpot::model::{Anchor, Frame, Model, Parent, Site};
use springpot::spatial::SimdLevel;

/// States of a batch, whose results stay in the second cache.
const STATES: usize = 32;
/// A sample takes about so long, ns.
const SAMPLE: f64 = 3e5;

type Work<'a> = Box<dyn FnMut() + 'a>;
/// Works on q, v, a of one state, with room for its results.
type OfState<'a> = Box<dyn FnMut([&[f64]; 3], &mut [f64]) + 'a>;

/// A robot with its states, row by row.
struct Case {
    model: Model,
    tip: Frame,
    ends: [Site; 2],
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

impl Case {
    fn new(name: &str, is_floating: bool) -> Self {
        let path = format!("{}/../../testdata/multibody/{name}.urdf", env!("CARGO_MANIFEST_DIR"));
        let options = DescriptionOptions { floating_base: is_floating, ..DescriptionOptions::default() };
        let model = RobotDescription::read(path.as_ref(), &options)
            .and_then(|urdf| urdf.model([0.0, 0.0, -9.81]))
            .expect("a robot");
        let last = Parent::Body(model.joint_body(model.joint_count() - 1));
        let site = |body, point| model.resolve(&Anchor { body, point }).expect("the body exists");
        let ends = [site(Parent::Body(1), [0.14, -0.1, 0.08]), site(last, [0.0, 0.1, 0.1])];
        let numbers = |width: usize, seed: f64| {
            (0..STATES * width)
                .map(|k| 1.5 * (seed + 1.7 * (k / width) as f64 + 0.9 * (k % width) as f64).sin())
                .collect()
        };
        let (nq, nv) = (model.nq(), model.nv());
        let tip = model.frame(last).expect("the body exists");
        Self { tip, ends, q: numbers(nq, 0.1), v: numbers(nv, 0.5), a: numbers(nv, 0.8), model }
    }

    /// One state at a time: a sweep over all states.
    fn single<'a>(&'a self, name: &str) -> Work<'a> {
        let (model, n, nq) = (&self.model, self.model.nv(), self.model.nq());
        let (mut kinematics, mut ws) = (Kinematics::new(model), Workspace::new(model));
        let (mut results, mut factor) = (vec![0.0; STATES * n * n.max(6)], vec![0.0; n * n]);
        let mut each = move |width: usize, mut work: OfState<'a>| -> Work<'a> {
            let mut results = std::mem::take(&mut results);
            Box::new(move || {
                for s in 0..STATES {
                    let state = [&self.q[s * nq..][..nq], &self.v[s * n..][..n], &self.a[s * n..][..n]];
                    work(black_box(state), &mut results[s * width..][..width]);
                }
            })
        };
        match name {
            "placements" => each(0, Box::new(move |[q, ..], _| kinematics.update_position(model, q))),
            "rnea" => each(n, Box::new(move |[q, v, a], tau| rnea_into(model, q, v, a, &[], &mut ws, tau))),
            "crba" => each(
                n * n,
                Box::new(move |[q, ..], mass| {
                    kinematics.update_position(model, q);
                    crba_into(model, &kinematics, &mut ws, mass);
                }),
            ),
            "aba" => each(
                n,
                Box::new(move |[q, v, a], out| {
                    kinematics.update_velocity(model, q, v);
                    aba_into(model, &kinematics, a, &[], &mut ws, out);
                }),
            ),
            "mass inverse" => each(
                n * n,
                Box::new(move |[q, ..], out| {
                    kinematics.update_position(model, q);
                    mass_inverse_into(model, &kinematics, &mut ws, &mut factor, out);
                }),
            ),
            "coriolis" => each(
                n * n,
                Box::new(move |[q, v, _], out| {
                    kinematics.update_velocity(model, q, v);
                    coriolis_into(model, &kinematics, &mut ws, out);
                }),
            ),
            "rnea derivatives" => {
                let mut slopes = RneaDerivatives::new(model);
                each(
                    n,
                    Box::new(move |[q, v, a], _| {
                        kinematics.update_velocity(model, q, v);
                        rnea_derivatives_into(model, &kinematics, a, &[], &mut ws, &mut slopes);
                    }),
                )
            }
            "aba derivatives" => {
                let mut slopes = AbaDerivatives::new(model);
                each(
                    n,
                    Box::new(move |[q, v, a], _| {
                        kinematics.update_velocity(model, q, v);
                        aba_derivatives_into(model, &kinematics, a, &[], &mut ws, &mut slopes);
                    }),
                )
            }
            "frame jacobian" => each(
                6 * n,
                Box::new(move |[q, ..], out| {
                    frame_jacobian_at_into(model, q, &self.tip, &mut ws, out);
                }),
            ),
            "pair" => each(
                n,
                Box::new(move |[q, v, _], out| {
                    kinematics.update_velocity(model, q, v);
                    pair_into(model, &kinematics, &self.ends[0], &self.ends[1], out);
                }),
            ),
            other => unreachable!("{other}"),
        }
    }

    /// All states in one call.
    fn many<'a>(&'a self, name: &'a str, level: SimdLevel) -> Work<'a> {
        let Self { model, q, v, a, tip, ends } = self;
        let n = model.nv();
        let mut ws = BatchWorkspace::at(model, level).expect("the processor has it");
        let mut out = vec![0.0; STATES * n * n.max(6)];
        let mut more = out.clone();
        Box::new(move || {
            let (m, ws, q) = (model, &mut ws, black_box(&q[..]));
            let (vector, square, other) = (STATES * n, STATES * n * n, &mut more[..STATES * n * n]);
            match name {
                "rnea" => batch::rnea_into(m, ws, q, v, a, &mut out[..vector]),
                "crba" => batch::crba_into(m, ws, q, &mut out[..square]),
                "aba" => batch::aba_into(m, ws, q, v, a, &mut out[..vector]),
                "mass inverse" => batch::mass_inverse_into(m, ws, q, &mut out[..square]),
                "coriolis" => batch::coriolis_into(m, ws, q, v, &mut out[..square]),
                "rnea derivatives" => batch::rnea_derivatives_into(m, ws, q, v, a, &mut out[..square], other),
                "aba derivatives" => batch::aba_derivatives_into(m, ws, q, v, a, &mut out[..square], other),
                "frame jacobian" => batch::frame_jacobian_into(m, ws, tip, q, &mut out[..6 * vector]),
                "pair" => {
                    let (lengths, rest) = more.split_at_mut(STATES);
                    let ends = [&ends[0], &ends[1]];
                    batch::pair_into(m, ws, ends, q, v, [lengths, &mut rest[..STATES], &mut out[..vector]])
                }
                _ => Ok(()),
            }
            .expect("finite");
        })
    }
}

/// Nanoseconds for each state of each work: medians of samples that are taken in turn.
fn medians(works: &mut [Work<'_>], samples: usize) -> Vec<f64> {
    let time = |work: &mut Work<'_>, calls: usize| {
        let start = Instant::now();
        (0..calls).for_each(|_| work());
        start.elapsed().as_nanos() as f64 / (calls * STATES) as f64
    };
    let calls: Vec<usize> =
        works.iter_mut().map(|work| (SAMPLE / (time(work, 3) * STATES as f64)).ceil().max(1.0) as usize).collect();
    let mut times = vec![Vec::new(); works.len()];
    for _ in 0..samples {
        for ((work, times), calls) in works.iter_mut().zip(&mut times).zip(&calls) {
            times.push(time(work, *calls));
        }
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    times.into_iter().map(median).collect()
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let samples = words.first().and_then(|word| word.parse().ok()).unwrap_or(21);
    let wanted = |name: &str| words.len() < 2 || words[1..].iter().any(|word| word == name);
    let levels: Vec<SimdLevel> = SimdLevel::ALL.into_iter().filter(|level| level.available().is_ok()).collect();
    for (name, robot, is_floating) in
        [("ur5", "ur5", false), ("humanoid", "simple_humanoid", false), ("floating", "simple_humanoid", true)]
    {
        if !wanted(name) {
            continue;
        }
        let case = Case::new(robot, is_floating);
        println!("{name}: nv = {}; ns a state, one by one, then at the levels, times faster", case.model.nv());
        for algorithm in [
            "placements",
            "rnea",
            "crba",
            "aba",
            "mass inverse",
            "coriolis",
            "rnea derivatives",
            "aba derivatives",
            "frame jacobian",
            "pair",
        ] {
            let many = levels.iter().filter(|_| algorithm != "placements").map(|level| case.many(algorithm, *level));
            let mut works: Vec<Work<'_>> = std::iter::once(case.single(algorithm)).chain(many).collect();
            let times = medians(&mut works, samples);
            let cells: Vec<String> = times
                .iter()
                .skip(1)
                .zip(&levels)
                .map(|(time, level)| format!("{level} {time:7.0} {:5.2}", times[0] / time))
                .collect();
            println!("  {algorithm:<17}{:7.0}   {}", times[0], cells.join("   "));
        }
    }
}
