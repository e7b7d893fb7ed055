//! Laws alone along strokes and inputs of which parameters move some numbers: what changes, and differences of the sixth order of it.

use springpot::collocation::Nodes;
use springpot::dual::Dual;
use springpot::fractional::Form;
use springpot::law::variation::{LawVariation, ObservationVariation, PointVariation, PowersVariation, StepVariation};
use springpot::law::{Course, InputValue, Network, Observation, Point, Start, Step, When};

/// A law of numbers, along steps.
pub(crate) struct Replay {
    pub build: fn(&[Dual]) -> Network,
    pub values: Vec<f64>,
    /// Mean, amplitude and frequency of each input.
    pub inputs: Vec<[f64; 3]>,
    /// How many of the inputs, the last of them, no parameter moves.
    pub still: usize,
    /// Sizes of strokes and of their frequencies: amplitude and rad/s.
    pub stroke: [f64; 2],
    pub nodes: Nodes,
    pub form: Form,
    pub course: Course,
    pub steps: Vec<f64>,
    /// The step of differences in units of the numbers.
    pub difference: f64,
    /// What counts as no change, in units of the values over that step: their rounding.
    pub rounding: f64,
    /// Whether numbers move the clock of the law.
    pub moves_clock: bool,
    /// Which of the numbers are orders: their differences are those of kernels that are new, known as well as those know energies.
    pub orders: &'static [usize],
}

/// All that is seen of a replay, by what it is: a block of values for each.
type Seen = Vec<(&'static str, Vec<f64>)>;

/// What is moved besides the numbers of the law: the stroke, and each input.
const MOVED: [&str; 1] = ["stroke"];

const THETA: f64 = 0.37;

impl Replay {
    pub(crate) fn new(build: fn(&[Dual]) -> Network, values: &[f64]) -> Self {
        Self {
            build,
            values: values.to_vec(),
            inputs: Vec::new(),
            still: 0,
            stroke: [0.05, 9.0],
            nodes: Nodes::Radau,
            form: Form::Rates,
            course: Course::Sought,
            steps: vec![0.01, 0.023, 0.04, 0.017, 0.031, 0.05, 0.022, 0.037],
            difference: 4e-4,
            rounding: 1e-6,
            moves_clock: false,
            orders: &[],
        }
    }

    pub(crate) fn with_inputs(self, inputs: &[[f64; 3]]) -> Self {
        Self { inputs: inputs.to_vec(), ..self }
    }

    pub(crate) fn by_orders(self, orders: &'static [usize]) -> Self {
        Self { orders, ..self }
    }

    pub(crate) fn told(self, nodes: Nodes, form: Form) -> Self {
        Self { nodes, form, ..self }
    }

    /// Number of parameters: numbers of the law, the stroke, and the inputs.
    fn count(&self) -> usize {
        self.values.len() + MOVED.len() + self.inputs.len() - self.still
    }

    /// x and x' at t, and what they change by.
    fn course(&self, t: f64, moved: f64) -> [f64; 2] {
        let [size, w] = self.stroke;
        let own = [size * (w * t + 0.4).sin() + 0.3 * size * (2.7 * w * t).cos(), 0.0];
        let rate = size * w * (w * t + 0.4).cos() - 0.81 * size * w * (2.7 * w * t).sin();
        let by = self.stroke_moves(t);
        [own[0] + moved * by[0], rate + moved * by[1]]
    }

    fn stroke_moves(&self, t: f64) -> [f64; 2] {
        let w = 0.8 * self.stroke[1];
        [0.02 * (1.0 + (w * t).sin()), 0.02 * w * (w * t).cos()]
    }

    fn input(&self, i: usize, t: f64, moved: f64) -> InputValue {
        let [mean, size, w] = self.inputs[i];
        let by = Self::input_moves(t);
        InputValue {
            value: mean + size * (w * t).sin() + moved * by[0],
            rate: size * w * (w * t).cos() + moved * by[1],
        }
    }

    fn input_moves(t: f64) -> [f64; 2] {
        [0.2 + (3.0 * t).cos(), -3.0 * (3.0 * t).sin()]
    }

    /// Times of the start and of the nodes.
    fn times(&self, t: f64, h: f64) -> Vec<f64> {
        [0.0].iter().chain(self.nodes.positions()).map(|c| t + c * h).collect()
    }

    /// Hands over every step as it is told, with the law and its state, and takes it into that.
    fn along(&self, law: &Network, moves: &[f64], mut see: impl FnMut(&Network, &Step, &mut springpot::law::State)) {
        let [of_stroke, of_inputs @ ..] = moves else { unreachable!("at least the stroke") };
        let inputs_at = |t: f64| -> Vec<InputValue> {
            (0..self.inputs.len()).map(|i| self.input(i, t, of_inputs.get(i).copied().unwrap_or(0.0))).collect()
        };
        let first = self.course(0.0, *of_stroke)[0];
        let start = inputs_at(0.0);
        let mut state = law.begin(&Start { stroke: first, jump: 0.0, inputs: &start }).unwrap();
        state.open(1e-10, 1e-3, 1.0).unwrap();
        let mut t = 0.0;
        for h in &self.steps {
            let times = self.times(t, *h);
            let [stroke, rate]: [Vec<f64>; 2] =
                [0, 1].map(|k| times.iter().map(|t| self.course(*t, *of_stroke)[k]).collect());
            let inputs: Vec<InputValue> = times.iter().flat_map(|t| inputs_at(*t)).collect();
            let step = Step {
                t,
                h: *h,
                nodes: self.nodes,
                places: None,
                form: self.form,
                stroke: &stroke,
                rate: &rate,
                inputs: &inputs,
                resolution: 1e-15,
                course: self.course,
            };
            law.prepare(&step, &mut state);
            see(law, &step, &mut state);
            law.commit(&step, &mut state);
            t += h;
        }
    }

    /// All that is seen where the numbers have these values.
    fn values_at(&self, parameters: &[f64]) -> Seen {
        let (numbers, moves) = parameters.split_at(self.values.len());
        let numbers: Vec<Dual> = numbers.iter().map(|value| (*value).into()).collect();
        let law = (self.build)(&numbers);
        let mut seen = Seen::new();
        self.along(&law, moves, |law, step, state| {
            push(&mut seen, "variables", state.view().variables);
            let start = step.point(0);
            observe(&mut seen, "now", &law.now(&start, state));
            let response = law.evaluate(step, state);
            push(&mut seen, "force", &response.force[..step.nodes.count()]);
            for theta in self.thetas() {
                let t = step.t + theta * step.h;
                let [stroke, rate] = self.course(t, moves[0]);
                let inputs: Vec<InputValue> = (0..self.inputs.len())
                    .map(|i| self.input(i, t, moves.get(i + 1).copied().unwrap_or(0.0)))
                    .collect();
                observe(&mut seen, "at", &law.at(step, theta, &Point { t, stroke, rate, inputs: &inputs }, state));
            }
            for power in &law.powers(step, state)[..=step.nodes.count()] {
                push(&mut seen, "dissipation", &[power.dissipation]);
                push(&mut seen, "input", &[power.input]);
            }
        });
        seen
    }

    /// Between nodes, where a clock moves, rows change as well as they are known, and not as their digits do.
    fn thetas(&self) -> Vec<f64> {
        if self.nodes == Nodes::Radau && !self.moves_clock { vec![THETA, 1.0] } else { vec![1.0] }
    }

    /// What changes of it by each of these parameters, in the order of [`Self::values_at`].
    fn changes(&self, which: &[usize]) -> Vec<Seen> {
        let count = which.len();
        let plain: Vec<Dual> = self.values.iter().map(|value| (*value).into()).collect();
        let law = (self.build)(&plain);
        let by: Vec<Option<Network>> = which
            .iter()
            .map(|&p| {
                let mut numbers = plain.clone();
                numbers.get_mut(p)?.slope = 1.0;
                Some((self.build)(&numbers))
            })
            .collect();
        let moves = vec![0.0; self.count() - self.values.len()];
        // Blocks of what changes of stroke, rate and inputs at these times.
        let blocks = |times: &[f64]| -> [Vec<f64>; 4] {
            let mut blocks = [vec![], vec![], vec![], vec![]];
            for t in times {
                for p in which {
                    let [stroke, rate] = if *p == self.values.len() { self.stroke_moves(*t) } else { [0.0; 2] };
                    blocks[0].push(stroke);
                    blocks[1].push(rate);
                }
                for i in 0..self.inputs.len() {
                    for p in which {
                        let own = *p == self.values.len() + 1 + i;
                        let [value, rate] = if own { Self::input_moves(*t) } else { [0.0; 2] };
                        blocks[2].push(value);
                        blocks[3].push(rate);
                    }
                }
            }
            blocks
        };
        let mut seen: Vec<Seen> = vec![Seen::new(); count];
        let mut own: Option<LawVariation> = None;
        self.along(&law, &moves, |law, step, state| {
            let of_start = blocks(&[step.t]);
            let told = point(&of_start, None);
            let own = own.get_or_insert_with(|| LawVariation::begin(law, &by, &step.point(0), &told, state).unwrap());
            let column =
                |blocks: &[f64], p: usize| -> Vec<f64> { blocks.iter().skip(p).step_by(count).copied().collect() };
            for (p, seen) in seen.iter_mut().enumerate() {
                push(seen, "variables", &column(own.variables(), p));
            }
            vary_at(law, (When::Between, &step.point(0)), state, &told, own, &mut seen, "now");
            let of_step = blocks(&self.times(step.t, step.h));
            let around = StepVariation {
                count,
                stroke: &of_step[0],
                rate: &of_step[1],
                inputs: [&of_step[2], &of_step[3]],
                passed: None,
            };
            let (response, nodes) = (law.evaluate(step, state), step.nodes.count());
            let mut forces = vec![f64::NAN; nodes * count];
            law.vary(step, state, &around, own, &mut forces);
            for i in 0..nodes {
                for p in 0..count {
                    for j in 0..nodes {
                        forces[i * count + p] += response.d_stroke[i][j] * around.stroke_at(j + 1)[p]
                            + response.d_rate[i][j] * around.rate_at(j + 1)[p];
                    }
                }
            }
            for (p, seen) in seen.iter_mut().enumerate() {
                push(seen, "force", &column(&forces, p));
            }
            for theta in self.thetas() {
                let t = step.t + theta * step.h;
                let [stroke, rate] = self.course(t, 0.0);
                let inputs: Vec<InputValue> = (0..self.inputs.len()).map(|i| self.input(i, t, 0.0)).collect();
                let of_row = blocks(&[t]);
                let told = point(&of_row, Some(around));
                let at = Point { t, stroke, rate, inputs: &inputs };
                vary_at(law, (When::Within(step, theta), &at), state, &told, own, &mut seen, "at");
            }
            let mut powers = [vec![0.0; (nodes + 1) * count], vec![0.0; (nodes + 1) * count]];
            let [dissipation, input] = &mut powers;
            law.vary_powers(step, state, &around, own, &mut PowersVariation { dissipation, input });
            for (p, seen) in seen.iter_mut().enumerate() {
                push(seen, "dissipation", &column(&powers[0], p));
                push(seen, "input", &column(&powers[1], p));
            }
            law.commit_variation(step, state, &around, own);
        });
        seen
    }

    /// How well differences by an order know what they are compared with.
    fn known_by_order(&self, what: &str) -> f64 {
        match what {
            "dissipation" => 1e-4,
            "stored" | "stored now" => 1e-5,
            _ => 1e-7,
        }
    }

    /// Compares what changes by every parameter with differences, and columns together with columns alone.
    pub(crate) fn check(&self, name: &str, known: f64) {
        let all: Vec<usize> = (0..self.count()).collect();
        let base: Vec<f64> = self.values.iter().copied().chain(vec![0.0; self.count() - self.values.len()]).collect();
        let together = self.changes(&all);
        let mut worst = (0.0f64, String::new());
        for (p, found) in together.iter().enumerate() {
            let d = self.difference * if base[p] == 0.0 { 1.0 } else { base[p].abs() };
            let [a, b, c, e, f, g] = [1.0, -1.0, 2.0, -2.0, 3.0, -3.0].map(|steps| {
                let mut moved = base.clone();
                moved[p] += steps * d;
                self.values_at(&moved)
            });
            for (k, (what, found)) in found.iter().enumerate() {
                let apart = |more: &Seen, less: &Seen, i: usize| more[k].1[i] - less[k].1[i];
                let of = |i: usize| (45.0 * apart(&a, &b, i) - 9.0 * apart(&c, &e, i) + apart(&f, &g, i)) / (60.0 * d);
                let truth: Vec<f64> = (0..a[k].1.len()).map(of).collect();
                assert_eq!(found.len(), truth.len(), "{name}: {what}");
                let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                // Rounding of the values is seen in the differences.
                let known = if self.orders.contains(&p) { self.known_by_order(what) } else { known };
                let size = largest(&truth).max(largest(found)).max(self.rounding * largest(&a[k].1) / d);
                for (i, (found, truth)) in found.iter().zip(&truth).enumerate() {
                    let miss = (found - truth).abs() / size.max(f64::MIN_POSITIVE) / known;
                    if !worst.0.is_nan() && (miss.is_nan() || miss > worst.0) {
                        worst = (miss, format!("by {p}: {what} {i}: {found} for {truth}"));
                    }
                }
            }
        }
        assert!(worst.0 < 1.0, "{name} {}: {:e} of what is known", worst.1, worst.0);
        for p in [0, self.count() - 1] {
            assert_eq!(self.changes(&[p])[0], together[p], "{name} by {p} alone");
        }
        let last = self.count() - 1;
        let three = self.changes(&[last, 0, self.values.len()]);
        assert_eq!([&three[0], &three[1], &three[2]], [&together[last], &together[0], &together[self.values.len()]]);
    }
}

fn point<'a>(blocks: &'a [Vec<f64>; 4], step: Option<StepVariation<'a>>) -> PointVariation<'a> {
    let [stroke, rate, values, rates] = blocks;
    PointVariation { stroke, rate, inputs: [values, rates], step, passed: None }
}

fn vary_at(
    law: &Network,
    at: (When, &Point),
    state: &springpot::law::State,
    told: &PointVariation,
    own: &LawVariation,
    seen: &mut [Seen],
    what: &'static str,
) {
    let mut sums = [(); 3].map(|()| vec![0.0; own.count]);
    let [force, stored, derivative] = &mut sums;
    law.vary_at(
        at,
        state,
        told,
        own,
        &mut ObservationVariation { force, stored, derivative, told: &mut Vec::new(), leaves: None },
    );
    for (p, seen) in seen.iter_mut().enumerate() {
        push(seen, what, &[sums[0][p]]);
        // What is unknown has a derivative that is none.
        let stored = if sums[1][p].is_nan() { 0.0 } else { sums[1][p] };
        push(seen, if what == "now" { "stored now" } else { "stored" }, &[stored]);
    }
}

fn observe(seen: &mut Seen, what: &'static str, observation: &Observation) {
    push(seen, what, &[observation.force()]);
    push(seen, if what == "now" { "stored now" } else { "stored" }, &[observation.stored.unwrap_or(0.0)]);
}

fn push(seen: &mut Seen, what: &'static str, values: &[f64]) {
    match seen.iter_mut().find(|(own, _)| *own == what) {
        Some((_, all)) => all.extend_from_slice(values),
        None => seen.push((what, values.to_vec())),
    }
}
