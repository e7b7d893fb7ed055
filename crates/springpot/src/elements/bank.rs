//! All elements of a system, step by step.

use crate::fractional::step::MAX_NODES;
use crate::fractional::{Form, KernelError, Nodes};
use crate::law::{InputValue, Network, Point, Response, Singular, Start, State, Step};

/// How the memories of a bank are built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemoryRange {
    /// Relative error of the kernels, 1e-13 … 0.1.
    pub tolerance: f64,
    /// The shortest step that is planned, s; shorter ones may follow all the same.
    pub shortest: f64,
    /// The longest past that is remembered to that tolerance, s.
    pub horizon: f64,
}

/// Laws with their states, driven by anybody who knows strokes and rates: a time loop, another engine, measured data.
///
/// A step from t to t + h is begun ([`ElementBank::start`]), told the strokes, rates and inputs at its start and at its nodes
/// ([`ElementBank::set`]), evaluated as often as an implicit method likes ([`ElementBank::evaluate`]) and taken into the past once
/// ([`ElementBank::commit`]). Steps may have any size. The bank knows no robot: what strokes are made of is not its matter.
///
/// ```
/// use springpot::elements::{ElementBank, MemoryRange};
/// use springpot::fractional::{Form, Nodes};
/// use springpot::law::{Derivative, Network, Start};
///
/// // A springpot under x = t²: D^½ t² = 8/(3√π) t^{3/2}.
/// let mut bank = ElementBank::new(vec![Network::springpot(1.0, 0.5, Derivative::Caputo)], Nodes::Radau, Form::Rates);
/// let range = MemoryRange { tolerance: 1e-10, shortest: 0.01, horizon: 1.0 };
/// bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &[] }], range)?;
/// for n in 0..100 {
///     let (t, h) = (0.01 * f64::from(n), 0.01);
///     bank.start(t, h);
///     for (k, c) in [0.0].iter().chain(Nodes::Radau.positions()).enumerate() {
///         let at = t + c * h;
///         bank.set(0, k, at * at, 2.0 * at, &[]);
///     }
///     bank.evaluate();
///     bank.commit();
/// }
/// assert!((bank.force(0) - 8.0 / (3.0 * std::f64::consts::PI.sqrt())).abs() < 1e-9);
/// # Ok::<(), springpot::fractional::KernelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ElementBank {
    nodes: Nodes,
    form: Form,
    t: f64,
    h: f64,
    elements: Vec<Banked>,
}

/// One element of a bank.
#[derive(Debug, Clone)]
struct Banked {
    law: Network,
    state: State,
    told: Told,
    response: Response,
}

/// What an element was told of a step, at its start and at its nodes.
#[derive(Debug, Clone)]
struct Told {
    stroke: [f64; MAX_NODES + 1],
    rate: [f64; MAX_NODES + 1],
    /// Point by point.
    inputs: Vec<InputValue>,
}

impl Told {
    fn step(&self, t: f64, h: f64, nodes: Nodes, form: Form) -> Step<'_> {
        let count = nodes.count() + 1;
        let size = self.stroke[..count].iter().fold(0.0f64, |size, x| size.max(x.abs()));
        Step {
            t,
            h,
            nodes,
            form,
            stroke: &self.stroke[..count],
            rate: &self.rate[..count],
            inputs: &self.inputs,
            resolution: 4.0 * f64::EPSILON * size,
            singular: Singular::Value,
        }
    }
}

impl ElementBank {
    /// One element for each law, with steps that are asked at `nodes` and told in `form`.
    pub fn new(laws: Vec<Network>, nodes: Nodes, form: Form) -> Self {
        let element = |law| Banked {
            law,
            state: State::default(),
            told: Told { stroke: [0.0; MAX_NODES + 1], rate: [0.0; MAX_NODES + 1], inputs: Vec::new() },
            response: Response::default(),
        };
        Self { nodes, form, t: 0.0, h: 0.0, elements: laws.into_iter().map(element).collect() }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.elements.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// Goes to t = 0, where each element has its `starts`; whatever was is forgotten.
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be built. Panics where there are not as many starts as elements.
    pub fn begin(&mut self, starts: &[Start], memory: MemoryRange) -> Result<(), KernelError> {
        assert_eq!(starts.len(), self.elements.len(), "a start for each element");
        for (element, start) in self.elements.iter_mut().zip(starts) {
            let mut state = element.law.begin(start)?;
            // The first node of a step asks for the shortest lag.
            state.open(memory.tolerance, self.nodes.positions()[0] * memory.shortest, memory.horizon)?;
            element.state = state;
            element.told = Told {
                stroke: [start.stroke; MAX_NODES + 1],
                rate: [0.0; MAX_NODES + 1],
                inputs: start.inputs.repeat(self.nodes.count() + 1),
            };
            element.response = Response::default();
        }
        (self.t, self.h) = (0.0, 0.0);
        Ok(())
    }

    /// Begins a step of the size `h` > 0 at time `t`, s.
    pub fn start(&mut self, t: f64, h: f64) {
        (self.t, self.h) = (t, h);
    }

    /// Stroke, rate and inputs of element `e` at the start (0) or at node `point` (1 … s) of the step. Panics beyond them, or where the number
    /// of inputs is not that of the start.
    pub fn set(&mut self, e: usize, point: usize, stroke: f64, rate: f64, inputs: &[InputValue]) {
        let told = &mut self.elements[e].told;
        (told.stroke[point], told.rate[point]) = (stroke, rate);
        told.inputs[point * inputs.len()..(point + 1) * inputs.len()].copy_from_slice(inputs);
    }

    /// Asks all laws for their forces and tangents; may be done any number of times with other strokes and rates.
    pub fn evaluate(&mut self) {
        let (t, h, nodes, form) = (self.t, self.h, self.nodes, self.form);
        for Banked { law, state, told, response } in &mut self.elements {
            let step = told.step(t, h, nodes, form);
            law.prepare(&step, state);
            *response = law.evaluate(&step, state);
        }
    }

    /// Forces of element `e` at the nodes and their tangents, as last evaluated.
    pub fn response(&self, e: usize) -> &Response {
        &self.elements[e].response
    }

    /// Force of element `e` at the last node of the step, N, as last evaluated.
    pub fn force(&self, e: usize) -> f64 {
        self.elements[e].response.force[self.nodes.count() - 1]
    }

    /// Energy stored in element `e` after the last committed step, J; `None` where it is unknown.
    pub fn stored(&self, e: usize) -> Option<f64> {
        let Banked { law, state, told, .. } = &self.elements[e];
        let end = told.step(self.t, self.h, self.nodes, self.form).point(self.nodes.count());
        law.now(&Point { t: self.t + self.h, ..end }, state).stored
    }

    /// Takes the step into the past; the next one starts where it ended.
    pub fn commit(&mut self) {
        let (t, h, nodes, form) = (self.t, self.h, self.nodes, self.form);
        for Banked { law, state, told, .. } in &mut self.elements {
            law.commit(&told.step(t, h, nodes, form), state);
        }
    }

    /// Appends the states of all elements to `numbers`.
    pub fn save(&self, numbers: &mut Vec<f64>) {
        self.elements.iter().for_each(|element| element.state.save(numbers));
    }

    /// Takes back what [`Self::save`] wrote of a bank of the same laws that has begun; `false`, and nothing changed, where `numbers` are not
    /// that.
    pub fn load(&mut self, numbers: &[f64]) -> bool {
        let (mut rest, mut states) = (numbers, Vec::with_capacity(self.elements.len()));
        for element in &self.elements {
            let mut state = element.state.clone();
            if state.load(&mut rest).is_none() {
                return false;
            }
            states.push(state);
        }
        let fits = rest.is_empty();
        if fits {
            self.elements.iter_mut().zip(states).for_each(|(element, state)| element.state = state);
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fractional::gamma::gamma;
    use crate::law::Derivative;

    const H: f64 = 2e-3;

    fn bank() -> ElementBank {
        let springpot = |alpha| Network::springpot(3.0, alpha, Derivative::Caputo);
        let laws = vec![
            springpot(0.4),
            Network::parallel([Network::spring(7.0), springpot(0.8), springpot(0.2)]),
            Network::series([Network::spring(7.0), springpot(0.6)]),
        ];
        let mut bank = ElementBank::new(laws, Nodes::Radau, Form::Rates);
        let start = Start { stroke: 0.0, jump: 0.0, inputs: &[] };
        bank.begin(&[start; 3], MemoryRange { tolerance: 1e-11, shortest: H, horizon: 2.0 }).unwrap();
        bank
    }

    /// One step under x = t².
    fn go_on(bank: &mut ElementBank, n: u32) {
        let t = f64::from(n) * H;
        bank.start(t, H);
        for e in 0..bank.len() {
            for (k, c) in [0.0].iter().chain(Nodes::Radau.positions()).enumerate() {
                let at = t + c * H;
                bank.set(e, k, at * at, 2.0 * at, &[]);
            }
        }
        bank.evaluate();
        bank.commit();
    }

    #[test]
    fn forces_are_those_of_the_derivatives() {
        let mut bank = bank();
        (0..400).for_each(|n| go_on(&mut bank, n));
        let t = 400.0 * H;
        let derivative = |alpha: f64| 2.0 / gamma(3.0 - alpha) * t.powf(2.0 - alpha);
        assert!((bank.force(0) / (3.0 * derivative(0.4)) - 1.0).abs() < 1e-9);
        let sum = 7.0 * t * t + 3.0 * (derivative(0.8) + derivative(0.2));
        assert!((bank.force(1) / sum - 1.0).abs() < 1e-9, "{} {sum}", bank.force(1));
        assert!(0.0 < bank.force(2) && bank.force(2) < 7.0 * t * t);
        assert!(bank.stored(1).unwrap() > 0.5 * 7.0 * t.powi(4));
    }

    #[test]
    fn what_was_saved_goes_on_to_the_bit() {
        let mut bank = bank();
        (0..50).for_each(|n| go_on(&mut bank, n));
        let mut numbers = Vec::new();
        bank.save(&mut numbers);
        let mut other = self::bank();
        assert!(other.load(&numbers));
        for n in 50..80 {
            go_on(&mut bank, n);
            go_on(&mut other, n);
            (0..3).for_each(|e| assert_eq!(bank.response(e), other.response(e), "element {e}, step {n}"));
        }
        // States of another bank, torn ones and empty ones are refused, and nothing changes.
        let before = bank.clone();
        let mut few = ElementBank::new(vec![Network::spring(1.0)], Nodes::Radau, Form::Rates);
        assert!(!few.load(&numbers) && !bank.load(&numbers[1..]) && !bank.load(&[]));
        go_on(&mut bank, 80);
        assert_eq!(before.elements.len(), bank.len());
    }
}
