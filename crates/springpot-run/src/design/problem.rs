//! What parameters make of the metrics, in variables from 0 to 1.

use crate::sweep::{Layout, Parcel, Progress};
use crate::trial::Varied;
use springpot::identification::Scale;
use springpot::law::Catalog;
use springpot::optimisation::{Slope, Value};
use springpot::system::Stop;
use springpot_scenario::{Constraint, DesignPlan, ParameterPlan, Plan, Scenario};

/// Variables nearer to an end of their range are there.
const AT_END: f64 = 1e-12;

/// The problem of a scenario.
pub(super) struct Problem<'a> {
    /// As it was asked for, and with its derivatives.
    asked: &'a Scenario,
    scenario: &'a Scenario,
    catalog: &'a Catalog,
    plan: &'a Plan,
    stop: &'a Stop,
}

/// Metrics of all cases, and their derivatives by the parameters.
#[derive(Debug, Clone)]
pub(super) struct Evaluated {
    /// By case and metric.
    pub(super) metrics: Vec<Vec<f64>>,
    /// By case, metric and parameter.
    pub(super) gradients: Vec<Vec<Vec<f64>>>,
}

/// What numbers are measured by: the objective, and each constraint of each case.
pub(super) struct Scales {
    objective: f64,
    constraints: Vec<f64>,
}

impl Scales {
    /// Multipliers of constraints as they are measured in SI, those of all cases of a constraint added up.
    pub(super) fn undo(&self, multipliers: &mut Vec<f64>, count: usize) {
        let mut sums = vec![0.0; count];
        for (k, (multiplier, scale)) in multipliers.iter().zip(&self.constraints).enumerate() {
            sums[k % count] += multiplier * self.objective / scale;
        }
        *multipliers = sums;
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        [asked, scenario]: [&'a Scenario; 2],
        catalog: &'a Catalog,
        plan: &'a Plan,
        stop: &'a Stop,
    ) -> Self {
        Self { asked, scenario, catalog, plan, stop }
    }

    pub(super) fn plan(&self) -> &DesignPlan {
        self.plan.design.as_ref().expect("a scenario with a design")
    }

    pub(super) fn case(&self) -> &Plan {
        self.plan
    }

    pub(super) fn parameters(&self) -> &[ParameterPlan] {
        self.plan.sensitivity.as_ref().map_or(&[], |sensitivity| &sensitivity.parameters)
    }

    /// The text of the scenario with these values.
    pub(super) fn text(&self, values: &[f64]) -> String {
        let asked = Varied { scenario: self.asked, ..self.varied() };
        let written = asked.scenario(values).map(|scenario| scenario.with_values(self.catalog));
        written.unwrap_or_else(|_| self.asked.source().text.to_string())
    }

    fn varied(&self) -> Varied<'_> {
        Varied { scenario: self.scenario, catalog: self.catalog, parameters: self.parameters() }
    }

    /// Runs all cases with these values; `None` where one fails, or has a metric without a value.
    pub(super) fn evaluate(&self, values: &[f64]) -> Option<Evaluated> {
        let cases = self.varied().cases(values).ok()?;
        let layout = Layout::new(&cases, &cases.plan(0).ok()?).ok()?;
        let progress = Progress::default();
        let mut found = Evaluated { metrics: Vec::new(), gradients: Vec::new() };
        for index in 0..cases.len() {
            let parcel = Parcel::run(&cases, &layout, index, self.stop, &progress)?;
            if parcel.error().is_some() {
                return None;
            }
            found.metrics.push(parcel.metrics().values.clone());
            found.gradients.push(parcel.metrics().derivatives.gradients.clone());
        }
        Some(found)
    }

    /// The objective, all that is to be small in SI.
    pub(super) fn objective(&self, found: &Evaluated) -> f64 {
        let (design, count) = (self.plan(), found.metrics.len());
        let values = found.metrics.iter().map(|metrics| metrics[design.metric]);
        let sign = self.sign();
        match design.worst {
            true => sign * values.map(|value| sign * value).fold(f64::NEG_INFINITY, f64::max),
            false => values.sum::<f64>() / count as f64,
        }
    }

    /// The metric of a constraint, in the case in which it is nearest to its limit or furthest beyond.
    pub(super) fn constrained(&self, found: &Evaluated, constraint: &Constraint) -> f64 {
        let values = found.metrics.iter().map(|metrics| metrics[constraint.metric]);
        values.fold(f64::NAN, |worst, value| if constraint.is_min { worst.min(value) } else { worst.max(value) })
    }

    /// The derivatives of the objective by the parameters, SI.
    pub(super) fn gradient(&self, found: &Evaluated) -> Vec<f64> {
        let (design, count) = (self.plan(), found.metrics.len());
        let of = |case: usize, p: usize| found.gradients[case][design.metric][p];
        let worst = (0..count).max_by(|one, other| {
            let value = |case: &usize| self.sign() * found.metrics[*case][design.metric];
            value(one).total_cmp(&value(other))
        });
        let each = (0..self.parameters().len()).map(|p| match design.worst {
            true => worst.map_or(f64::NAN, |case| of(case, p)),
            false => (0..count).map(|case| of(case, p)).sum::<f64>() / count as f64,
        });
        each.collect()
    }

    fn sign(&self) -> f64 {
        if self.plan().maximise { -1.0 } else { 1.0 }
    }

    /// The logarithm moves, and not the value.
    fn is_log(parameter: &ParameterPlan) -> bool {
        parameter.scale == Some(Scale::Log) && Self::bounds(parameter)[0] > 0.0
    }

    fn bounds(parameter: &ParameterPlan) -> [f64; 2] {
        parameter.bounds.expect("every parameter of a design has bounds")
    }

    /// The values at variables.
    pub(super) fn values(&self, x: &[f64]) -> Vec<f64> {
        let value = |(parameter, x): (&ParameterPlan, &f64)| {
            let [low, high] = Self::bounds(parameter);
            match *x {
                // Steps end at a bound but for rounding.
                x if x <= AT_END => low,
                x if x >= 1.0 - AT_END => high,
                x if Self::is_log(parameter) => low * (high / low).powf(x),
                x => low + (high - low) * x,
            }
        };
        self.parameters().iter().zip(x).map(value).collect()
    }

    /// The variables at values.
    pub(super) fn variables(&self, values: &[f64]) -> Vec<f64> {
        let variable = |(parameter, value): (&ParameterPlan, &f64)| {
            let [low, high] = Self::bounds(parameter);
            let x = match Self::is_log(parameter) {
                true => (value / low).ln() / (high / low).ln(),
                false => (value - low) / (high - low),
            };
            x.clamp(0.0, 1.0)
        };
        self.parameters().iter().zip(values).map(variable).collect()
    }

    /// dp/dx.
    fn slope(parameter: &ParameterPlan, value: f64) -> f64 {
        let [low, high] = Self::bounds(parameter);
        if Self::is_log(parameter) { value * (high / low).ln() } else { high - low }
    }

    /// Whether a step moves no parameter by more than the tolerance.
    pub(super) fn is_small(&self, x: &[f64], d: &[f64]) -> bool {
        let (values, rtol) = (self.values(x), self.plan().rtol);
        let each = self.parameters().iter().zip(values).zip(d);
        each.into_iter().all(|((parameter, value), d)| {
            let [low, high] = Self::bounds(parameter);
            let size = value.abs().max(1e-3 * (high - low));
            (Self::slope(parameter, value) * d).abs() <= rtol * size
        })
    }

    /// What numbers are measured by, of a first point.
    pub(super) fn scales(&self, found: &Evaluated, x: &[f64]) -> Scales {
        let plain = Scales { objective: 1.0, constraints: vec![1.0; self.limits(found).count()] };
        let value = self.scaled(found, x, &plain);
        let steepest = value.of.iter().flat_map(|one| &one.gradient).fold(0.0f64, |most, slope| most.max(slope.abs()));
        let positive = |size: f64| if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let objective = positive(value.largest().abs().max(0.1 * steepest));
        let constraints = self.limits(found).map(|(constraint, case)| {
            positive(constraint.limit.abs().max(1e-3 * found.metrics[case][constraint.metric].abs()))
        });
        Scales { objective, constraints: constraints.collect() }
    }

    /// Every constraint of every case.
    fn limits<'b>(&'b self, found: &'b Evaluated) -> impl Iterator<Item = (&'b Constraint, usize)> {
        (0..found.metrics.len())
            .flat_map(|case| self.plan().constraints.iter().map(move |constraint| (constraint, case)))
    }

    /// What is to be small, and what must not be above 0, by the variables.
    pub(super) fn scaled(&self, found: &Evaluated, x: &[f64], scales: &Scales) -> Value {
        let (design, parameters) = (self.plan(), self.parameters());
        let slopes: Vec<f64> =
            parameters.iter().zip(self.values(x)).map(|(parameter, value)| Self::slope(parameter, value)).collect();
        let of = |case: usize, metric: usize, factor: f64, less: f64| Slope {
            value: factor * (found.metrics[case][metric] - less),
            gradient: found.gradients[case][metric].iter().zip(&slopes).map(|(g, slope)| factor * g * slope).collect(),
        };
        let factor = self.sign() / scales.objective;
        let each = (0..found.metrics.len()).map(|case| of(case, design.metric, factor, 0.0));
        let of_objective = match design.worst {
            true => each.collect(),
            false => {
                let all: Vec<Slope> = each.collect();
                let mut mean = Slope { value: 0.0, gradient: vec![0.0; slopes.len()] };
                for one in &all {
                    mean.value += one.value / all.len() as f64;
                    let sum = mean.gradient.iter_mut().zip(&one.gradient);
                    sum.for_each(|(mean, slope)| *mean += slope / all.len() as f64);
                }
                vec![mean]
            }
        };
        let constraints = self.limits(found).zip(&scales.constraints).map(|((constraint, case), scale)| {
            let sign = if constraint.is_min { -1.0 } else { 1.0 };
            of(case, constraint.metric, sign / scale, constraint.limit)
        });
        Value { of: of_objective, constraints: constraints.collect() }
    }
}
