//! All elements of a system, step by step.

mod variation;

pub(crate) use variation::LastNode;

use crate::collocation::Nodes;
use crate::collocation::{MAX_NODES, STAGES};
use crate::fractional::{Form, KernelError, Kernels, Shelf};
use crate::law::{
    Course, Guard, InputValue, LeafState, LocalError, Network, Observation, Point, Power, Powers, Response, Start,
    State, Step, Term, Warmth, When,
};
use serde::{Deserialize, Serialize};

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

impl MemoryRange {
    /// The range in the time of a law's memories, which temperature may shift: `inputs` are those at t = 0, `hottest` is how hot its input T gets, K.
    ///
    /// Where that is not known, it counts as 25 K above what it is at t = 0; a temperature that is a state as 150 K above where it starts and
    /// what surrounds it. What gets hotter is remembered less well than `tolerance`.
    #[must_use]
    pub fn reduced(self, law: &Network, inputs: &[InputValue], hottest: Option<f64>) -> Self {
        let Some(heated) = law.as_heated() else { return self };
        let Self { tolerance, shortest, horizon } = self;
        let now = heated.input().and_then(|input| inputs.get(input)).map(|input| input.value);
        let fastest = heated.fastest(hottest.or(now));
        // Shorter lags than are planned cost nothing until they come.
        Self { tolerance, shortest: shortest * heated.pace(inputs), horizon: horizon * fastest }
    }
}

/// Laws with their states, driven by anybody who knows strokes and rates: a time loop, another engine, measured data.
///
/// A step from t to t + h is begun ([`ElementBank::start`]), told the strokes, rates and inputs at its start and at its nodes
/// ([`ElementBank::set`]), evaluated as often as an implicit method likes ([`ElementBank::evaluate`]) and taken into the past once
/// ([`ElementBank::commit`]). Steps may have any size. The bank knows no robot: what strokes are made of is not its matter.
///
/// ```
/// use springpot::elements::{ElementBank, MemoryRange};
/// use springpot::collocation::Nodes;
/// use springpot::fractional::Form;
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
    step: StepShape,
    /// Where memories find what others have made.
    shelf: Shelf,
    elements: Vec<Banked>,
}

/// What the steps of all elements have in common.
#[derive(Debug, Clone, Copy)]
struct StepShape {
    t: f64,
    h: f64,
    nodes: Nodes,
    course: Course,
}

/// One element of a bank.
#[derive(Debug, Clone)]
struct Banked {
    law: Network,
    /// None of an element that takes no part: before it begins.
    kept: Option<Kept>,
    told: Told,
    response: Response,
    energies: StepEnergies,
}

/// What of an element outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Kept {
    state: State,
    /// Dissipated, and supplied by inputs, since t = 0, J.
    dissipated: f64,
    supplied: f64,
    /// Largest regular D^order x so far, of everything that the law has a [`LocalError`] of.
    scales: Vec<f64>,
}

/// What of a bank outlasts its steps: states of the laws, and energies since t = 0; see [`ElementBank::state`].
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BankState(Vec<Option<Kept>>);

/// What an element was told of a step, at its start and at its nodes.
#[derive(Debug, Clone)]
struct Told {
    form: Form,
    stroke: [f64; MAX_NODES + 1],
    rate: [f64; MAX_NODES + 1],
    /// Point by point.
    inputs: Vec<InputValue>,
    resolution: Option<f64>,
}

/// What a step does to the energies of an element, and how well it knows its memories.
#[derive(Debug, Clone)]
struct StepEnergies {
    powers: Powers,
    errors: Vec<LocalError>,
    /// The element at the end of the step.
    end: Observation,
}

impl Told {
    fn step(&self, StepShape { t, h, nodes, course }: StepShape) -> Step<'_> {
        let count = nodes.count() + 1;
        let inputs = self.inputs.len() / (MAX_NODES + 1);
        Step {
            t,
            h,
            nodes,
            places: None,
            form: self.form,
            stroke: &self.stroke[..count],
            rate: &self.rate[..count],
            inputs: &self.inputs[..count * inputs],
            resolution: self.resolution.unwrap_or_else(|| {
                let size = self.stroke[..count].iter().fold(0.0f64, |size, x| size.max(x.abs()));
                4.0 * f64::EPSILON * size
            }),
            course,
        }
    }

    /// Inputs at a point.
    fn inputs_mut(&mut self, point: usize) -> &mut [InputValue] {
        let count = self.inputs.len() / (MAX_NODES + 1);
        &mut self.inputs[point * count..(point + 1) * count]
    }
}

impl ElementBank {
    /// One element for each law, with steps that are asked at `nodes` and told in `form`.
    pub fn new(laws: Vec<Network>, nodes: Nodes, form: Form) -> Self {
        let element = |law| Banked {
            law,
            kept: None,
            told: Told {
                form,
                stroke: [0.0; MAX_NODES + 1],
                rate: [0.0; MAX_NODES + 1],
                inputs: Vec::new(),
                resolution: None,
            },
            response: Response::default(),
            energies: StepEnergies {
                powers: Powers::default(),
                errors: Vec::new(),
                end: Observation { derivative: 0.0, regular: 0.0, singular: 0.0, stored: None },
            },
        };
        let step = StepShape { t: 0.0, h: 0.0, nodes, course: Course::Given };
        Self { step, shelf: Shelf::default(), elements: laws.into_iter().map(element).collect() }
    }

    /// Looks its kernels up among those of other banks first.
    pub(crate) fn share(&mut self, kernels: &Kernels) {
        self.shelf = Shelf::of(kernels.clone());
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
        for (e, start) in starts.iter().enumerate() {
            self.begin_element(e, start)?;
            let memory = memory.reduced(&self.elements[e].law, start.inputs, None);
            self.open_element(e, memory)?;
        }
        (self.step.t, self.step.h) = (0.0, 0.0);
        Ok(())
    }

    /// Takes element `e` to t = 0, its memories without kernels.
    pub(crate) fn begin_element(&mut self, e: usize, start: &Start) -> Result<(), KernelError> {
        let state = self.elements[e].law.begin(start)?;
        self.begin_from(e, start, state);
        Ok(())
    }

    /// Takes element `e` to t = 0 in a state of its law.
    pub(crate) fn begin_from(&mut self, e: usize, start: &Start, state: State) {
        let element = &mut self.elements[e];
        element.kept = Some(Kept { state, dissipated: 0.0, supplied: 0.0, scales: Vec::new() });
        let Told { stroke, rate, inputs, .. } = &mut element.told;
        (*stroke, *rate) = ([start.stroke; MAX_NODES + 1], [0.0; MAX_NODES + 1]);
        *inputs = start.inputs.repeat(MAX_NODES + 1);
        element.response = Response::default();
    }

    /// Builds the kernels of an element that has begun, whose range is that of its law's own time ([`MemoryRange::reduced`]).
    pub(crate) fn open_element(&mut self, e: usize, memory: MemoryRange) -> Result<(), KernelError> {
        let MemoryRange { tolerance, shortest, horizon } = memory;
        let kept = self.elements[e].kept.as_mut();
        // The first node of a step asks for the shortest lag.
        let delta = Nodes::Radau.positions()[0].min(self.step.nodes.positions()[0]) * shortest;
        kept.map_or(Ok(()), |kept| kept.state.open_on(&self.shelf, tolerance, delta, horizon))
    }

    /// Begins a step of the size `h` > 0 at time `t`, s.
    pub fn start(&mut self, t: f64, h: f64) {
        (self.step.t, self.step.h) = (t, h);
    }

    /// Where the step begins, s.
    pub fn from(&self) -> f64 {
        self.step.t
    }

    /// Size of the step, s.
    pub fn size(&self) -> f64 {
        self.step.h
    }

    /// Stroke, rate and inputs of element `e` at the start (0) or at node `point` (1 … s) of the step. Panics beyond them, or where the number
    /// of inputs is not that of the start.
    pub fn set(&mut self, e: usize, point: usize, stroke: f64, rate: f64, inputs: &[InputValue]) {
        self.set_stroke(e, point, stroke, rate);
        self.inputs_mut(e, point).copy_from_slice(inputs);
    }

    /// Stroke and rate alone.
    pub(crate) fn set_stroke(&mut self, e: usize, point: usize, stroke: f64, rate: f64) {
        let told = &mut self.elements[e].told;
        (told.stroke[point], told.rate[point]) = (stroke, rate);
    }

    /// Inputs alone.
    pub(crate) fn inputs_mut(&mut self, e: usize, point: usize) -> &mut [InputValue] {
        self.elements[e].told.inputs_mut(point)
    }

    /// Room for the inputs of an element that has not begun.
    pub(crate) fn reserve_inputs(&mut self, e: usize, count: usize) {
        self.elements[e].told.inputs = vec![InputValue::default(); (MAX_NODES + 1) * count];
    }

    /// Where the following steps are asked.
    pub(crate) fn set_nodes(&mut self, nodes: Nodes) {
        self.step.nodes = nodes;
    }

    /// Whether strokes and rates are those of a known motion, as at first, or are sought so that equations of motion hold.
    pub fn set_course(&mut self, course: Course) {
        self.step.course = course;
    }

    /// Which data make the polynomial of element `e`.
    pub(crate) fn set_form(&mut self, e: usize, form: Form) {
        self.elements[e].told.form = form;
    }

    /// Rounding of the strokes of element `e`, m, where they are differences of larger lengths; else it is that of the strokes themselves.
    pub fn set_resolution(&mut self, e: usize, resolution: f64) {
        self.elements[e].told.resolution = Some(resolution);
    }

    /// Rounding of the strokes of element `e`, m.
    pub(crate) fn resolution(&self, e: usize) -> f64 {
        self.elements[e].told.step(self.step).resolution
    }

    /// What element `e` was told of the start (0) or of a node of the step.
    pub(crate) fn point(&self, e: usize, point: usize) -> Point<'_> {
        self.elements[e].told.step(self.step).point(point)
    }

    /// The strokes and rates that element `e` was told of a step with [`Nodes::Radau`].
    pub(crate) fn told(&self, e: usize) -> [&[f64; STAGES + 1]; 2] {
        let Told { stroke, rate, .. } = &self.elements[e].told;
        [stroke, rate].map(|values| values.first_chunk().expect("as many nodes as the most"))
    }

    /// What the rates that element `e` was told of a step with [`Nodes::Radau`] are at θ, with what its strokes tell of them where both are taken.
    pub(crate) fn rate_within(&self, e: usize, theta: f64) -> f64 {
        let step = self.elements[e].told.step(self.step);
        let form = if step.form == Form::Strokes { Form::Rates } else { step.form };
        Step { form, ..step }.polynomial().rate(theta)
    }

    /// Makes ready what does not change while the step is worked out.
    pub(crate) fn prepare(&mut self) {
        let step = self.step;
        for Banked { law, kept, told, .. } in &mut self.elements {
            if let Some(Kept { state, .. }) = kept {
                law.prepare(&told.step(step), state);
            }
        }
    }

    /// Asks all laws for their forces and tangents; may be done any number of times with other strokes and rates.
    pub fn evaluate(&mut self) {
        self.prepare();
        (0..self.elements.len()).for_each(|e| self.evaluate_element(e));
    }

    /// Asks one law, which is prepared.
    pub(crate) fn evaluate_element(&mut self, e: usize) {
        let Banked { law, kept, told, response, .. } = &mut self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            *response = law.evaluate(&told.step(self.step), state);
        }
    }

    /// Force, N or N·m, and energy flows, W, of element `e`, whose law keeps nothing, at the first node of the step.
    pub(crate) fn at_first_node(&self, e: usize) -> (f64, Power) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        let Some(Kept { state, .. }) = kept else { return (0.0, Power::default()) };
        let step = told.step(StepShape { nodes: Nodes::One, ..self.step });
        let ([force, ..], [_, power, ..]) = (law.evaluate(&step, state).force, law.powers(&step, state));
        (force, power)
    }

    /// Takes what the element is at the end of a step whose energies somebody else integrates, who adds them by [`Self::set_energies`].
    pub(crate) fn account_end(&mut self, e: usize, at: &Point) {
        let Banked { law, kept: Some(Kept { state, .. }), energies, .. } = &mut self.elements[e] else { return };
        energies.powers = Powers::default();
        energies.errors.clear();
        energies.end = law.now(at, state);
    }

    /// Forces of element `e` at the nodes and their tangents, as last evaluated.
    pub fn response(&self, e: usize) -> &Response {
        &self.elements[e].response
    }

    /// ∂F_i/∂u_j of element `e` for its input `input`, at what it was told of the step.
    pub(crate) fn by_input(&self, e: usize, input: usize) -> [[f64; MAX_NODES]; MAX_NODES] {
        let Banked { law, kept, told, .. } = &self.elements[e];
        let state = kept.as_ref().map(|kept| &kept.state);
        state.map_or([[0.0; MAX_NODES]; MAX_NODES], |state| law.by_input(&told.step(self.step), state, input))
    }

    /// The same where the stroke goes on through the step as fast as at its start, and inputs stay: of nodes nobody was told yet.
    pub(crate) fn by_input_at_start(&self, e: usize, input: usize) -> [[f64; MAX_NODES]; MAX_NODES] {
        let Banked { law, kept, told, .. } = &self.elements[e];
        let Some(Kept { state, .. }) = kept else { return Default::default() };
        let mut begun = told.clone();
        let StepShape { h, nodes, .. } = self.step;
        for (k, c) in nodes.positions().iter().enumerate() {
            (begun.stroke[k + 1], begun.rate[k + 1]) = (told.stroke[0] + c * h * told.rate[0], told.rate[0]);
        }
        begun.inputs = told.inputs[..told.inputs.len() / (MAX_NODES + 1)].repeat(MAX_NODES + 1);
        law.by_input(&begun.step(self.step), state, input)
    }

    /// Force of element `e` at the last node of the step, N, as last evaluated.
    pub fn force(&self, e: usize) -> f64 {
        self.elements[e].response.force[self.step.nodes.count() - 1]
    }

    /// Works out what the step does to the energies of element `e` and how well it knows its memories. `false` where it takes no part.
    pub fn account(&mut self, e: usize) -> bool {
        let Banked { law, kept, told, energies, .. } = &mut self.elements[e];
        let Some(Kept { state, .. }) = kept else { return false };
        let step = told.step(self.step);
        law.prepare(&step, state);
        energies.powers = law.powers(&step, state);
        energies.end = law.at(&step, 1.0, &step.point(step.nodes.count()), state);
        energies.errors.clear();
        law.local_errors(&step, state, &mut energies.errors);
        true
    }

    /// Appends functions whose zeros are kinks of the force of element `e`.
    pub(crate) fn guards(&self, e: usize, guards: &mut Vec<Guard>) {
        let Banked { law, kept, told, .. } = &self.elements[e];
        if let Some(Kept { state, .. }) = kept {
            law.guards(&told.step(self.step), state, guards);
        }
    }

    /// Energy flows at the start and at the nodes of the step, as accounted.
    pub(crate) fn powers(&self, e: usize) -> &Powers {
        &self.elements[e].energies.powers
    }

    /// Local errors of the step, as accounted.
    pub(crate) fn errors(&self, e: usize) -> &[LocalError] {
        &self.elements[e].energies.errors
    }

    /// How many of the first local errors of element `e` a motion may show nothing of ([`Network::hidden_errors`]).
    pub(crate) fn hidden_errors(&self, e: usize) -> usize {
        self.elements[e].law.hidden_errors()
    }

    /// The largest regular D^order x so far, the step that was accounted included, of local error `m`.
    pub(crate) fn scale(&self, e: usize, m: usize) -> f64 {
        let Banked { kept, energies, .. } = &self.elements[e];
        let before = kept.as_ref().and_then(|kept| kept.scales.get(m)).copied().unwrap_or(0.0);
        before.max(energies.errors[m].value.abs())
    }

    /// Element `e` at the end of the step, as accounted.
    pub(crate) fn end(&self, e: usize) -> &Observation {
        &self.elements[e].energies.end
    }

    /// Whether element `e` takes part.
    pub(crate) fn takes_part(&self, e: usize) -> bool {
        self.elements[e].kept.is_some()
    }

    /// The law of element `e` at t + θh of the step, 0 < θ ≤ 1, where its exact kinematics are those of `at`; `None` where it takes no part.
    pub(crate) fn at(&self, e: usize, theta: f64, at: &Point) -> Option<Observation> {
        let Banked { law, kept, told, .. } = &self.elements[e];
        kept.as_ref().map(|kept| law.at(&told.step(self.step), theta, at, &kept.state))
    }

    /// The law of element `e` between two steps; `None` where it takes no part.
    pub(crate) fn now(&self, e: usize, at: &Point) -> Option<Observation> {
        let Banked { law, kept, .. } = &self.elements[e];
        kept.as_ref().map(|kept| law.now(at, &kept.state))
    }

    /// Temperature and heat of element `e`, where its law keeps a temperature: at θ of the step that was begun, or between two steps.
    pub fn warmth(&self, e: usize, theta: Option<f64>) -> Option<Warmth> {
        let Banked { law, kept, told, .. } = &self.elements[e];
        law.as_heated()?;
        let step = told.step(self.step);
        law.warmth(theta.map(|theta| (&step, theta)), &kept.as_ref()?.state)
    }

    /// By how much the time of the memories of element `e` runs faster than t, at the end of the step.
    pub(crate) fn pace(&self, e: usize) -> f64 {
        let Banked { law, kept, told, .. } = &self.elements[e];
        let Some((heated, kept)) = law.as_heated().zip(kept.as_ref()) else { return 1.0 };
        let step = told.step(self.step);
        heated.pace_at(&step, kept.state.view())
    }

    /// The leaves of element `e`: at θ of the step that was begun, or between two steps; none where it takes no part.
    pub(crate) fn leaves(&self, e: usize, theta: Option<f64>, at: &Point, leaves: &mut Vec<LeafState>) {
        leaves.clear();
        let Banked { law, kept: Some(kept), told, .. } = &self.elements[e] else { return };
        match theta {
            Some(theta) => law.leaves_at(&told.step(self.step), theta, at, &kept.state, leaves),
            None => law.leaves_now(at, &kept.state, leaves),
        }
    }

    /// What the law of element `e` tells of itself ([`Network::tells`]): at θ of the step that was begun, or between two steps; nothing where it takes
    /// no part.
    pub(crate) fn tell(&self, e: usize, theta: Option<f64>, at: &Point, values: &mut Vec<f64>) {
        values.clear();
        let Banked { law, kept: Some(kept), told, .. } = &self.elements[e] else { return };
        match theta {
            Some(theta) => law.tell(When::Within(&told.step(self.step), theta), at, &kept.state, values),
            None => law.tell(When::Between, at, &kept.state, values),
        }
    }

    /// Energies of element `e` dissipated and supplied by inputs since t = 0, J, of steps that were accounted; unknown where it takes no part.
    pub fn energies(&self, e: usize) -> (f64, f64) {
        self.elements[e].kept.as_ref().map_or((f64::NAN, f64::NAN), |kept| (kept.dissipated, kept.supplied))
    }

    /// Goes on from other energies ([`Self::energies`]), which [`Self::save`] does not write.
    pub fn set_energies(&mut self, e: usize, (dissipated, supplied): (f64, f64)) {
        if let Some(kept) = &mut self.elements[e].kept {
            (kept.dissipated, kept.supplied) = (dissipated, supplied);
        }
    }

    /// Those until θ of the step that was accounted.
    pub(crate) fn energies_until(&self, e: usize, theta: f64) -> (f64, f64) {
        let (dissipated, supplied) = self.energies(e);
        let step = Power::integrate(&self.elements[e].energies.powers, self.step.nodes, self.step.h, theta);
        (dissipated + step.dissipation, supplied + step.input)
    }

    /// Adds to what the inputs of element `e` have supplied, J.
    pub(crate) fn add_supplied(&mut self, e: usize, energy: f64) {
        if let Some(kept) = &mut self.elements[e].kept {
            kept.supplied += energy;
        }
    }

    /// Whether all energies of element `e` are known.
    pub(crate) fn is_accounted(&self, e: usize) -> bool {
        self.elements[e].kept.as_ref().is_some_and(|kept| kept.state.is_accounted())
    }

    /// Whether the force of element `e`, which has made no step, is infinite.
    pub(crate) fn begins_singular(&self, e: usize) -> bool {
        self.elements[e].kept.as_ref().is_some_and(|kept| kept.state.seen_at(0.0).is_singular())
    }

    /// Whether a singular start makes the force of element `e` infinite at t = 0.
    pub(crate) fn is_singular(&self, e: usize) -> bool {
        self.elements[e].kept.as_ref().is_some_and(|kept| kept.state.is_singular())
    }

    /// Whether one of the elements starts so.
    pub(crate) fn has_singular(&self) -> bool {
        (0..self.len()).any(|e| self.is_singular(e))
    }

    /// Hands over s and alpha of every share s·t^−alpha of a singular start in the force of element `e`.
    pub(crate) fn for_each_singularity(&self, e: usize, inputs: &[InputValue], take: &mut dyn FnMut(Term)) {
        let Banked { law, kept, .. } = &self.elements[e];
        if let Some(kept) = kept {
            law.for_each_singularity(inputs, &kept.state, take);
        }
    }

    /// Energy stored in element `e` after the last committed step, J; `None` where it is unknown.
    pub fn stored(&self, e: usize) -> Option<f64> {
        let end = self.point(e, self.step.nodes.count());
        self.now(e, &Point { t: self.step.t + self.step.h, ..end })?.stored
    }

    /// Number of exponentials in all memories.
    pub fn modes(&self) -> usize {
        self.elements.iter().filter_map(|element| element.kept.as_ref()).map(|kept| kept.state.modes()).sum()
    }

    /// Takes the step into the past; the next one starts where it ended.
    pub fn commit(&mut self) {
        let step = self.step;
        for Banked { law, kept, told, .. } in &mut self.elements {
            if let Some(Kept { state, .. }) = kept {
                law.commit(&told.step(step), state);
            }
        }
    }

    /// [`Self::commit`] of a step that was accounted, with its energies.
    pub fn commit_account(&mut self) {
        for e in 0..self.elements.len() {
            let (dissipated, supplied) = self.energies_until(e, 1.0);
            let Banked { kept, energies, .. } = &mut self.elements[e];
            let Some(kept) = kept else { continue };
            (kept.dissipated, kept.supplied) = (dissipated, supplied);
            kept.scales.resize(energies.errors.len(), 0.0);
            for (scale, error) in kept.scales.iter_mut().zip(&energies.errors) {
                *scale = scale.max(error.value.abs());
            }
        }
        self.commit();
    }

    /// What it takes to go on from here to the bit, in this bank or in another one of the same laws.
    pub fn state(&self) -> BankState {
        BankState(self.kept())
    }

    /// Goes on from a state of a bank of the same laws, later or earlier; `false`, and nothing changed, where it is of another one.
    pub fn set_state(&mut self, state: BankState) -> bool {
        self.go_on(state.0)
    }

    /// What outlasts the steps, element by element.
    pub(crate) fn kept(&self) -> Vec<Option<Kept>> {
        self.elements.iter().map(|element| element.kept.clone()).collect()
    }

    /// Goes on from what was kept of a bank of the same laws; `false`, and nothing changed, where it is of another one.
    pub(crate) fn go_on(&mut self, kept: Vec<Option<Kept>>) -> bool {
        let fits = |(element, kept): (&Banked, &Option<Kept>)| match kept {
            Some(kept) => element.law.has_state(&kept.state),
            None => true,
        };
        if kept.len() != self.elements.len() || !self.elements.iter().zip(&kept).all(fits) {
            return false;
        }
        self.elements.iter_mut().zip(kept).for_each(|(element, kept)| element.kept = kept);
        true
    }

    /// Appends the states of all elements to `numbers`.
    pub fn save(&self, numbers: &mut Vec<f64>) {
        self.elements.iter().filter_map(|element| element.kept.as_ref()).for_each(|kept| kept.state.save(numbers));
    }

    /// Takes back what [`Self::save`] wrote of a bank of the same laws that has begun; `false`, and nothing changed, where `numbers` are not
    /// that.
    pub fn load(&mut self, numbers: &[f64]) -> bool {
        let (mut rest, mut states) = (numbers, Vec::with_capacity(self.elements.len()));
        for kept in self.elements.iter().filter_map(|element| element.kept.as_ref()) {
            let mut state = kept.state.clone();
            if state.load(&mut rest).is_none() {
                return false;
            }
            states.push(state);
        }
        let fits = rest.is_empty();
        if fits {
            let kept = self.elements.iter_mut().filter_map(|element| element.kept.as_mut());
            kept.zip(states).for_each(|(kept, state)| kept.state = state);
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
