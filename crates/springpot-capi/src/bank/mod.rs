//! Elements from a text, driven on slices by anybody who knows strokes and rates.

mod state;
mod text;

use crate::status::{Problem, Status};
use springpot::collocation::Nodes;
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{Catalog, Course, Derivative, InputValue, Start};
use springpot_scenario::LoneElement;

/// Steps begin where the last one ended, to this share of their size and of the time.
const SAME_TIME: f64 = 1e-9;

/// A bank of elements with all that it takes to check what it is told.
///
/// Arrays hold one row for each element or input: strokes, rates `(n, s + 1)`, inputs `(m, s + 1)`, the start of the step first, then its s
/// nodes; forces `(n, s)`, tangents `(n, s, s)`. Inputs stand in the order of the elements, each in the order of its law.
///
/// ```
/// use springpot_capi::bank::{Answers, Bank, Told};
/// use springpot::collocation::Nodes;
/// use springpot::elements::MemoryRange;
/// use springpot::fractional::Form;
/// use springpot::law::Catalog;
///
/// let text = r#"{ "law": "spring", "parameters": { "k": "2 N/mm" } }"#;
/// let mut bank = Bank::new(text, &Catalog::standard(), Nodes::One, Form::Rates)?;
/// bank.begin(&[0.0], &[], MemoryRange { tolerance: 1e-9, shortest: 1e-3, horizon: 1.0 })?;
/// let mut forces = [0.0];
/// let told = Told { strokes: &[0.0, 0.01], rates: &[10.0, 10.0], ..Told::default() };
/// bank.evaluate(0.0, 1e-3, told, &mut Answers { forces: &mut forces, ..Answers::default() })?;
/// bank.commit()?;
/// assert_eq!(forces, [20.0]);
/// assert_eq!(bank.energies(0)?, [0.1, 0.0, 0.0]);
/// # Ok::<(), springpot_capi::Problem>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bank {
    elements: Vec<LoneElement>,
    /// Element, and place in its law, of every input.
    inputs: Vec<(usize, usize)>,
    bank: ElementBank,
    nodes: Nodes,
    /// The text, by which states are told apart.
    identity: u128,
    stage: Stage,
    /// Where the last committed step ended, s.
    t: f64,
    /// Stored, dissipated, supplied by inputs, J, element by element, after the last commit.
    energies: Vec<[f64; 3]>,
    room: Vec<InputValue>,
}

/// What was done last.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    New,
    Between,
    /// A step to this time was evaluated.
    Evaluated(f64),
}

/// What a bank is told of a step; without `inputs` they are what the text says at those times.
#[derive(Debug, Clone, Copy, Default)]
pub struct Told<'a> {
    /// Strokes x, m, (n, s + 1).
    pub strokes: &'a [f64],
    /// Rates x', m/s, (n, s + 1).
    pub rates: &'a [f64],
    /// Inputs, SI, (m, s + 1).
    pub inputs: Option<&'a [f64]>,
    /// Their rates, (m, s + 1); 0 where they are left out.
    pub input_rates: Option<&'a [f64]>,
}

/// Where a bank writes what it answers.
#[derive(Debug, Default)]
pub struct Answers<'a> {
    /// Forces F_i, N, positive in tension, (n, s).
    pub forces: &'a mut [f64],
    /// ∂F_i/∂x_j, N/m, (n, s, s).
    pub by_stroke: Option<&'a mut [f64]>,
    /// ∂F_i/∂x'_j, N·s/m, (n, s, s).
    pub by_rate: Option<&'a mut [f64]>,
}

impl Bank {
    /// The elements of a text (JSON, or `[[element]]` of a scenario) with laws of `catalog`, in steps that are asked at `nodes` and told in `form`.
    ///
    /// # Errors
    /// [`Status::Text`].
    pub fn new(text: &str, catalog: &Catalog, nodes: Nodes, form: Form) -> Result<Self, Problem> {
        let elements = text::elements(text, catalog)?;
        let all = elements.iter().enumerate();
        let inputs = all.flat_map(|(e, element)| (0..element.inputs.len()).map(move |i| (e, i))).collect();
        let laws = elements.iter().map(|element| element.law.clone()).collect();
        let identity = state::identity(text, nodes, form);
        let energies = vec![[0.0; 3]; elements.len()];
        let bank = ElementBank::new(laws, nodes, form);
        Ok(Self { elements, inputs, bank, nodes, identity, stage: Stage::New, t: 0.0, energies, room: Vec::new() })
    }

    /// Number of elements n.
    pub fn len(&self) -> usize {
        self.elements.len()
    }

    /// Always false.
    pub fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }

    /// Number of inputs of all elements m.
    pub fn inputs(&self) -> usize {
        self.inputs.len()
    }

    /// Element and place in its law of input `input` of all; `None` where there is none.
    pub fn input(&self, input: usize) -> Option<(usize, usize)> {
        self.inputs.get(input).copied()
    }

    /// Name of an element; `None` where there is none.
    pub fn name(&self, e: usize) -> Option<&str> {
        self.elements.get(e).map(|element| element.name.as_str())
    }

    /// Name of an input of all: `ELEMENT.INPUT`; `None` where there is none.
    pub fn input_name(&self, input: usize) -> Option<String> {
        let (e, i) = self.input(input)?;
        let element = &self.elements[e];
        Some(format!("{}.{}", element.name, element.entry.inputs[i].name))
    }

    /// Where a step is asked.
    pub fn nodes(&self) -> Nodes {
        self.nodes
    }

    /// Whether strokes and rates are those of a known motion, as at first, or are sought so that equations of motion hold.
    pub fn set_course(&mut self, course: Course) {
        self.bank.set_course(course);
    }

    /// Goes to t = 0, where the elements have these strokes and inputs; whatever was is forgotten.
    ///
    /// # Errors
    /// [`Status::Argument`], [`Status::Number`], [`Status::Input`]; [`Status::Unsolved`] where a memory cannot be built.
    pub fn begin(&mut self, strokes: &[f64], inputs: &[f64], memory: MemoryRange) -> Result<(), Problem> {
        length("strokes", strokes.len(), self.len())?;
        let inputs = if inputs.is_empty() && self.inputs() > 0 { None } else { Some(inputs) };
        if let Some(inputs) = inputs {
            length("inputs", inputs.len(), self.inputs())?;
        }
        finite("strokes", strokes)?;
        let MemoryRange { tolerance, shortest, horizon } = memory;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if !((1e-13..=0.1).contains(&tolerance) && positive(shortest) && positive(horizon)) {
            let message = format!(
                "tolerance {tolerance} must be 1e-13 to 0.1, the shortest step {shortest} s and the horizon {horizon} s positive"
            );
            return Err(Problem::new(Status::Number, message));
        }
        self.stage = Stage::New;
        let mut values = Vec::with_capacity(self.inputs());
        for k in 0..self.inputs() {
            values.push(self.input_at(k, 0.0, inputs.map(|inputs| (inputs[k], 0.0)))?);
        }
        self.check_rules(0.0, &values)?;
        let mut rest = &values[..];
        let starts: Vec<Start> = (self.elements.iter().zip(strokes))
            .map(|(element, &stroke)| {
                let (own, others) = rest.split_at(element.inputs.len());
                rest = others;
                let jump = if element.derivative == Derivative::RiemannLiouville { stroke } else { 0.0 };
                Start { stroke, jump, inputs: own }
            })
            .collect();
        self.bank.begin(&starts, memory).map_err(|error| Problem::new(Status::Unsolved, error.to_string()))?;
        (self.t, self.stage) = (0.0, Stage::Between);
        for e in 0..self.len() {
            self.energies[e] = [self.bank.stored(e).unwrap_or(f64::NAN), 0.0, 0.0];
        }
        Ok(())
    }

    /// Forces and tangents of a step of size `h` from `t` on, s; may be asked any number of times before [`Self::commit`].
    ///
    /// # Errors
    /// All but [`Status::Text`], [`Status::State`] and [`Status::Defect`]; the last committed step stands.
    pub fn evaluate(&mut self, t: f64, h: f64, told: Told, answers: &mut Answers) -> Result<(), Problem> {
        self.check_begun()?;
        self.stage = Stage::Between;
        if !(h > 0.0 && h.is_finite() && t.is_finite()) {
            return Err(Problem::new(
                Status::Number,
                format!("a step of {h} s from t = {t} s: it must be longer than 0"),
            ));
        }
        if (t - self.t).abs() > SAME_TIME * (h + self.t) {
            let message = format!("a step from t = {t} s, but the last one ended at {} s", self.t);
            return Err(Problem::new(Status::Order, message));
        }
        self.tell(t, h, told)?;
        self.bank.evaluate();
        self.answer(answers)?;
        self.stage = Stage::Evaluated(t + h);
        Ok(())
    }

    /// Takes the step that was evaluated last into the past.
    ///
    /// # Errors
    /// [`Status::Order`] where none was.
    pub fn commit(&mut self) -> Result<(), Problem> {
        let Stage::Evaluated(t) = self.stage else {
            return Err(Problem::new(Status::Order, "no step was evaluated since the last commit"));
        };
        (0..self.len()).for_each(|e| _ = self.bank.account(e));
        self.bank.commit_account();
        (self.t, self.stage) = (t, Stage::Between);
        for e in 0..self.len() {
            let (dissipated, supplied) = self.bank.energies(e);
            self.energies[e] = [self.bank.stored(e).unwrap_or(f64::NAN), dissipated, supplied];
        }
        Ok(())
    }

    /// Energies of an element after the last commit, J: stored, dissipated and supplied by inputs since t = 0; NaN where unknown.
    ///
    /// # Errors
    /// [`Status::Argument`] where there is no such element.
    pub fn energies(&self, e: usize) -> Result<[f64; 3], Problem> {
        let missing = || Problem::new(Status::Argument, format!("there is no element {e}: there are {}", self.len()));
        self.energies.get(e).copied().ok_or_else(missing)
    }

    /// Time at which the last committed step ended, s.
    pub fn t(&self) -> f64 {
        self.t
    }

    fn tell(&mut self, t: f64, h: f64, told: Told) -> Result<(), Problem> {
        let points = self.nodes.count() + 1;
        let (n, m) = (self.len(), self.inputs());
        let Told { strokes, rates, inputs, input_rates } = told;
        length("strokes", strokes.len(), n * points)?;
        length("rates", rates.len(), n * points)?;
        for (what, values) in [("inputs", inputs), ("input_rates", input_rates)] {
            values.map_or(Ok(()), |values| length(what, values.len(), m * points))?;
        }
        finite("strokes", strokes)?;
        finite("rates", rates)?;
        self.bank.start(t, h);
        let mut room = std::mem::take(&mut self.room);
        for k in 0..points {
            let at = if k == 0 { t } else { t + self.nodes.positions()[k - 1] * h };
            room.clear();
            for input in 0..m {
                let place = input * points + k;
                let rate = input_rates.map_or(0.0, |rates| rates[place]);
                room.push(self.input_at(input, at, inputs.map(|inputs| (inputs[place], rate)))?);
            }
            self.check_rules(at, &room)?;
            let mut rest = &room[..];
            for e in 0..n {
                let (own, others) = rest.split_at(self.elements[e].inputs.len());
                rest = others;
                self.bank.set(e, k, strokes[e * points + k], rates[e * points + k], own);
            }
        }
        self.room = room;
        Ok(())
    }

    /// The value of an input at t: what is told, else what the text says.
    fn input_at(&self, input: usize, t: f64, told: Option<(f64, f64)>) -> Result<InputValue, Problem> {
        let (e, i) = self.inputs[input];
        let element = &self.elements[e];
        let refuse = |what: String| {
            let name = self.input_name(input).unwrap_or_default();
            Err(Problem::new(Status::Input, format!("input {name} at t = {t} s {what}")))
        };
        let InputValue { value, rate } = match (told, &element.inputs[i]) {
            (Some((value, rate)), _) => InputValue { value, rate },
            (None, Some(said)) => {
                let jet = said.signal.at(t);
                InputValue { value: jet.value, rate: jet.first }
            }
            (None, None) => return refuse("is neither told nor in the text".to_owned()),
        };
        if !(value.is_finite() && rate.is_finite()) {
            return refuse(format!("is {value} with the rate {rate}"));
        }
        let range = &element.entry.inputs[i].range;
        match range.contains(value) {
            true => Ok(InputValue { value, rate }),
            false => refuse(format!("is {value}, outside {} to {}", range.low, range.high)),
        }
    }

    fn check_rules(&self, t: f64, inputs: &[InputValue]) -> Result<(), Problem> {
        let mut rest = inputs;
        for LoneElement { name, law, inputs, .. } in &self.elements {
            let (own, others) = rest.split_at(inputs.len());
            rest = others;
            law.check_inputs(own)
                .map_err(|broken| Problem::new(Status::Input, format!("element {} at t = {t} s: {broken}", name)))?;
        }
        Ok(())
    }

    fn answer(&self, answers: &mut Answers) -> Result<(), Problem> {
        let (n, s) = (self.len(), self.nodes.count());
        length("forces", answers.forces.len(), n * s)?;
        for (what, room) in [("by_stroke", &answers.by_stroke), ("by_rate", &answers.by_rate)] {
            room.as_ref().map_or(Ok(()), |room| length(what, room.len(), n * s * s))?;
        }
        for e in 0..n {
            let response = self.bank.response(e);
            if let Some(force) = response.force[..s].iter().find(|force| !force.is_finite()) {
                let name = &self.elements[e].name;
                let message =
                    format!("the force of element {name} is {force}: no force fits these strokes; try a shorter step");
                return Err(Problem::new(Status::Unsolved, message));
            }
            answers.forces[e * s..][..s].copy_from_slice(&response.force[..s]);
            let tangents = [(&mut answers.by_stroke, &response.d_stroke), (&mut answers.by_rate, &response.d_rate)];
            for (room, tangent) in tangents {
                let Some(room) = room else { continue };
                for i in 0..s {
                    room[(e * s + i) * s..][..s].copy_from_slice(&tangent[i][..s]);
                }
            }
        }
        Ok(())
    }
}

fn length(what: &str, given: usize, wanted: usize) -> Result<(), Problem> {
    if given == wanted {
        return Ok(());
    }
    Err(Problem::new(Status::Argument, format!("{what} holds {given} numbers, not {wanted}")))
}

fn finite(what: &str, values: &[f64]) -> Result<(), Problem> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(at) => Err(Problem::new(Status::Number, format!("number {at} of {what} is {}", values[at]))),
    }
}
