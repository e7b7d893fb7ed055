//! D^a from node to node: what arrays on any steps and streams have in common.

pub(super) mod march;

use super::definition::Definition;
use super::error::DerivativeError;
use super::hermite::{Form, Node};
use super::order::{Jump, Order};
use march::March;

/// A Hermite spline that grows by one node at a time.
#[derive(Debug, Clone)]
pub(super) struct Along {
    order: Order,
    form: Form,
    start: Start,
    last: Node,
    tolerance: f64,
    march: Option<March>,
}

/// What the definition makes of the first sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    /// What is taken from x at order 0.
    held: f64,
    jump: Option<Jump>,
    /// The row at t = 0; NaN where D^a x is infinite.
    pub(super) value: f64,
}

impl Start {
    /// A slope up to `negligible` counts as 0, so that the row t = 0 is not infinite by rounding.
    pub(super) fn new(order: &Order, definition: Definition, node: &Node, negligible: f64) -> Self {
        let slope = if node.slope.abs() <= negligible { 0.0 } else { node.slope };
        let jump = Jump::start(order, definition, node.x, slope);
        let held = if order.order == 0.0 && definition == Definition::Caputo { node.x } else { 0.0 };
        let value = match order.whole {
            _ if jump.is_some() => f64::NAN,
            0 if order.is_integer() => node.x - held,
            1 if order.is_integer() => node.slope,
            2 if order.is_integer() => node.bend,
            _ => 0.0,
        };
        Self { held, jump, value }
    }

    /// What the start adds to I^beta x⁽ᵐ⁾ at t > 0.
    pub(super) fn share(&self, t: f64) -> f64 {
        self.jump.as_ref().map_or(0.0, |jump| jump.at(t)) - self.held
    }
}

impl Along {
    pub(super) fn new(order: Order, form: Form, start: Start, node: Node, tolerance: f64) -> Self {
        Self { order, form, start, last: node, tolerance, march: None }
    }

    /// D^a x at the next node; the memory holds times up to `horizon`.
    pub(super) fn row(&mut self, node: Node, horizon: f64) -> Result<f64, DerivativeError> {
        let width = node.t - self.last.t;
        let march = match &mut self.march {
            Some(march) => march,
            none => none.insert(March::new(self.order, width, horizon, self.tolerance)?),
        };
        let piece = self.form.between(&self.last, &node);
        let coefficients = if self.form == Form::Cubic { &piece[..4] } else { &piece[..] };
        self.last = node;
        Ok(march.advance(width, coefficients, node.t) + self.start.share(node.t))
    }
}
