//! What the parts of a series are asked: at nodes of their own, under the stroke of the whole.

use super::Values;
use crate::collocation::inner::{self, TABLEAU_OF_FOUR, Weights};
use crate::collocation::{MAX_NODES, Nodes, Places, RADAU_NODES, STAGES};
use crate::fractional::{Form, RatePolynomial};
use crate::law::step::{Course, InputValue, Point, Response, Step};

/// Square of the product of a place's distances to the nodes below which it is one of them.
const NEXT_TO_NODE: f64 = 1e-8;

/// The stroke of a whole series over a step, or the first share of it, at the nodes of its parts.
pub(super) struct Asked {
    way: Way,
    /// Where the nodes of the step are not where its clock would have them.
    bent: Option<Bent>,
    pub(super) nodes: Nodes,
    pub(super) h: f64,
    pub(super) stroke: Values,
    /// None where they are those of the step.
    inputs: Option<Vec<InputValue>>,
}

/// What brings the nodes of a step, which lie elsewhere, to those of the parts and back.
struct Bent {
    weights: [Weights; MAX_NODES],
    /// The same of inputs, whose rates are known.
    inputs: [Weights; MAX_NODES],
    outer: [[f64; MAX_NODES]; STAGES],
}

/// How the stroke between the nodes of a step follows from what is known at them.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// The nodes are those of the parts.
    Same,
    /// The stroke is sought: it has no more than its values, else a stiff spring would not be stable.
    Strokes,
    /// The stroke is sought, and every part yields: the rates are known one order better.
    Rates,
    /// The stroke is given, with its rates.
    Both,
}

impl Way {
    fn of(step: &Step, is_yielding: bool) -> Self {
        match (step.nodes, step.course, step.form) {
            (Nodes::One | Nodes::Midpoint | Nodes::Inner, ..) => Self::Same,
            (Nodes::Radau, Course::Given, _) => Self::Both,
            (Nodes::Radau, Course::Sought, Form::Rates) if is_yielding => Self::Rates,
            (Nodes::Radau, Course::Sought, _) => Self::Strokes,
        }
    }

    /// The weights at the nodes of the parts.
    fn weights(self) -> &'static [Weights; MAX_NODES] {
        match self {
            Self::Same | Self::Strokes => &TABLEAU_OF_FOUR.by_strokes,
            Self::Rates => &TABLEAU_OF_FOUR.by_rates,
            Self::Both => &TABLEAU_OF_FOUR.by_both,
        }
    }

    /// Those of nodes at `places`.
    fn weights_at(self, places: &Places, theta: f64) -> Weights {
        match self {
            Self::Same | Self::Strokes => Weights::by_strokes_at(places, theta),
            Self::Rates => Weights::by_rates_at(places, theta),
            Self::Both => Weights::by_both_at(places, theta),
        }
    }

    /// The stroke at θ.
    fn stroke(self, step: &Step, theta: f64) -> f64 {
        let weights = match (self, step.places) {
            (Self::Same, _) => {
                let polynomial = RatePolynomial::through_strokes(step.h, step.nodes, step.stroke);
                return step.stroke[0] + polynomial.travel_until(theta);
            }
            (_, Some(places)) => self.weights_at(places, theta),
            (Self::Strokes, None) => Weights::by_strokes(theta),
            (Self::Rates, None) => Weights::by_rates(theta),
            (Self::Both, None) => Weights::by_both(theta),
        };
        weights.apply(|k| step.stroke[k], |k| step.h * step.rate[k])
    }
}

impl Asked {
    /// The whole step; `is_yielding`: no part of the series gives a force that follows from its stroke alone.
    pub(super) fn whole(step: &Step, is_yielding: bool) -> Self {
        let way = Way::of(step, is_yielding);
        let mut stroke = Values::default();
        if way == Way::Same {
            stroke[..step.stroke.len()].copy_from_slice(step.stroke);
            return Self { way, bent: None, nodes: step.nodes, h: step.h, stroke, inputs: None };
        }
        stroke[0] = step.stroke[0];
        let bent = step.places.map(|places| Bent {
            weights: inner::NODES.map(|theta| way.weights_at(places, theta)),
            inputs: inner::NODES.map(|theta| Way::Both.weights_at(places, theta)),
            outer: places.positions().map(inner::outer_row),
        });
        let weights = bent.as_ref().map_or(way.weights(), |bent| &bent.weights);
        for (stroke, weights) in stroke[1..].iter_mut().zip(weights) {
            *stroke = weights.apply(|k| step.stroke[k], |k| step.h * step.rate[k]);
        }
        let inputs = (!step.inputs.is_empty()).then(|| inputs(step));
        Self { way, bent, nodes: Nodes::Inner, h: step.h, stroke, inputs }
    }

    /// The step up to `theta`, where the kinematics are those of `at`.
    pub(super) fn until(step: &Step, is_yielding: bool, theta: f64, at: &Point) -> Self {
        let way = Way::of(step, is_yielding);
        let nodes = if step.nodes == Nodes::Radau { Nodes::Inner } else { step.nodes };
        let mut stroke = Values::default();
        stroke[0] = step.stroke[0];
        // The cubic through the strokes misses what the step's own motion is at θ, and elsewhere by as much as the nodes are away.
        let points = step.places.map_or(&RADAU_NODES, Places::positions);
        let away = |at: f64| at * points.iter().map(|c| at - c).product::<f64>();
        let miss = match way {
            Way::Strokes => (at.stroke - way.stroke(step, theta)) * away(theta) / (away(theta).powi(2) + NEXT_TO_NODE),
            Way::Same | Way::Rates | Way::Both => 0.0,
        };
        for (stroke, c) in stroke[1..].iter_mut().zip(nodes.positions()) {
            *stroke = way.stroke(step, theta * c) + miss * away(theta * c);
        }
        if nodes != Nodes::Midpoint {
            stroke[nodes.count()] = at.stroke;
        }
        // Inputs hardly bend within a step; at the end they are those asked for.
        let start = step.point(0).inputs;
        let mut inputs = start.to_vec();
        for c in nodes.positions() {
            inputs.extend(
                start
                    .iter()
                    .zip(at.inputs)
                    .map(|(from, to)| InputValue { value: from.value + c * (to.value - from.value), rate: to.rate }),
            );
        }
        Self { way, bent: None, nodes, h: theta * step.h, stroke, inputs: Some(inputs) }
    }

    /// Whether it follows from strokes alone.
    pub(super) fn is_of_strokes(&self) -> bool {
        matches!(self.way, Way::Same | Way::Strokes)
    }

    /// d/dθ of what the values at the nodes of the parts are at θ of the step.
    pub(super) fn slope(values: &[f64; MAX_NODES], theta: f64) -> f64 {
        let nodes = inner::NODES;
        let others = |of: &[usize]| (0..MAX_NODES).filter(|j| !of.contains(j)).collect::<Vec<_>>();
        let slope = |m: usize| -> f64 {
            let factor = |j: &usize| (theta - nodes[*j]) / (nodes[m] - nodes[*j]);
            let without = |j: usize| others(&[m, j]).iter().map(factor).product::<f64>() / (nodes[m] - nodes[j]);
            others(&[m]).into_iter().map(without).sum()
        };
        values.iter().enumerate().map(|(m, value)| slope(m) * value).sum()
    }

    /// The step as the parts see it, but for strokes and rates, which are not theirs.
    pub(super) fn step<'a>(&'a self, outer: &Step<'a>) -> Step<'a> {
        let Self { nodes, h, ref stroke, ref inputs, .. } = *self;
        let inputs = inputs.as_deref().unwrap_or(outer.inputs);
        Step {
            h,
            nodes,
            places: None,
            form: Form::Strokes,
            stroke: &stroke[..=nodes.count()],
            rate: &[],
            inputs,
            ..*outer
        }
    }

    /// Adds forces and tangents at the nodes of the parts, as they are at those of the whole.
    pub(super) fn respond(&self, force: &[f64; MAX_NODES], tangent: &super::Matrix, response: &mut Response) {
        if self.way == Way::Same {
            for i in 0..self.nodes.count() {
                response.force[i] += force[i];
                (0..self.nodes.count()).for_each(|j| response.d_stroke[i][j] += tangent[i][j]);
            }
            return;
        }
        let weights = self.bent.as_ref().map_or(self.way.weights(), |bent| &bent.weights);
        for (i, row) in self.rows().iter().enumerate() {
            response.force[i] += outer(row, force);
            for (k, weights) in weights.iter().enumerate() {
                let along: f64 = (0..MAX_NODES).map(|m| row[m] * tangent[m][k]).sum();
                for j in 0..STAGES {
                    response.d_stroke[i][j] += along * weights.stroke[j + 1];
                    response.d_rate[i][j] += self.h * along * weights.rate[j + 1];
                }
            }
        }
    }

    /// Adds how forces at the nodes of the parts follow an input there, as they follow its values at the nodes of the whole.
    pub(super) fn follow_input(&self, inside: &super::Matrix, slopes: &mut super::Matrix) {
        if self.way == Way::Same {
            slopes.iter_mut().flatten().zip(inside.iter().flatten()).for_each(|(slope, own)| *slope += own);
            return;
        }
        let weights = self.bent.as_ref().map_or(Way::Both.weights(), |bent| &bent.inputs);
        for (slopes, row) in slopes.iter_mut().zip(self.rows()) {
            for (n, weights) in weights.iter().enumerate() {
                let along: f64 = (0..MAX_NODES).map(|m| row[m] * inside[m][n]).sum();
                (0..STAGES).for_each(|j| slopes[j] += along * weights.stroke[j + 1]);
            }
        }
    }

    /// The polynomials through the values at the nodes of the parts, at the nodes of the whole.
    fn rows(&self) -> &[[f64; MAX_NODES]; STAGES] {
        self.bent.as_ref().map_or(&TABLEAU_OF_FOUR.outer, |bent| &bent.outer)
    }

    /// What is known at the start and at the nodes of the parts, at those of the whole.
    pub(super) fn outer(&self, values: &Values) -> Values {
        match self.way {
            Way::Same => *values,
            _ => {
                let rows = self.rows();
                let at = |i: usize| outer(&rows[i], &[values[1], values[2], values[3], values[4]]);
                [values[0], at(0), at(1), at(2), values[0]]
            }
        }
    }
}

fn outer(row: &[f64; MAX_NODES], values: &[f64; MAX_NODES]) -> f64 {
    row.iter().zip(values).map(|(weight, value)| weight * value).sum()
}

/// Inputs at the start and at the nodes of the parts.
fn inputs(step: &Step) -> Vec<InputValue> {
    let start = step.point(0).inputs;
    let mut inputs = start.to_vec();
    let bent = step.places.map(|places| {
        inner::NODES.map(|theta| [Weights::by_both_at(places, theta), Weights::by_strokes_at(places, theta)])
    });
    let places = (0..MAX_NODES).map(|m| match &bent {
        None => [&TABLEAU_OF_FOUR.by_both[m], &TABLEAU_OF_FOUR.by_strokes[m]],
        Some(bent) => [&bent[m][0], &bent[m][1]],
    });
    inputs.extend(places.flat_map(|[both, plain]| {
        (0..start.len()).map(|i| {
            let known = |k: usize| step.point(k).inputs[i];
            InputValue {
                value: both.apply(|k| known(k).value, |k| step.h * known(k).rate),
                rate: plain.apply(|k| known(k).rate, |_| 0.0),
            }
        })
    }));
    inputs
}
