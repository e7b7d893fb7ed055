//! What is worked out of the derivatives of a case at its end: gradients of its metrics, and what matters most.

use super::layout::{Layout, Ranked};
use crate::metrics::{End, gradient};
use crate::table::{Statistics, push_fields, push_number, push_text};
use serde::{Deserialize, Serialize};
use springpot::observe::Quantity;
use springpot::sensitivity::Lost;
use springpot_scenario::{MetricPlan, Plan, SensitivityPlan};

/// The columns of ranking.csv behind the swept parameters.
pub(super) const RANKING_COLUMNS: [&str; 4] = ["column", "parameter", "rms", "share"];

/// What is worked out of the derivatives of a case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseDerivatives {
    /// By metric and parameter, in their order: the derivative, SI; NaN where there is none. Empty where nothing is differentiated.
    pub gradients: Vec<Vec<f64>>,
    /// Where derivatives end before the run does.
    pub lost: Vec<Lost>,
    /// What changes columns most, the largest share first.
    pub ranking: Vec<Ranked>,
    /// Their lines in gradient.csv and ranking.csv.
    pub(super) lines: [String; 2],
}

/// Empties the cells of derivatives that a run has lost, and sees where one is lost.
#[derive(Debug)]
pub(super) struct Losses {
    /// Of each derivative its place in a row, that of its column, and its parameter.
    places: Vec<[usize; 3]>,
    /// Those of works among them, which end by themselves.
    works: Vec<usize>,
    lost: Vec<Lost>,
}

impl Losses {
    /// Of rows with these columns; `lost` are those that an earlier run has lost.
    pub(super) fn of(plan: &Plan, lost: Vec<Lost>) -> Option<Self> {
        let sensitivity = plan.sensitivity.as_ref().filter(|plan| plan.is_asked())?;
        let columns = plan.row_columns();
        let at = |name: &str| columns.iter().position(|column| column.name == name);
        let places = columns.iter().enumerate().filter_map(|(k, column)| {
            let (of, by) = Quantity::of_derivative(&column.name)?;
            let parameter = sensitivity.parameters.iter().position(|own| own.name == by)?;
            Some([k, at(of)?, parameter])
        });
        let works = columns.iter().enumerate().filter(|(_, column)| is_of_work(&column.name)).map(|(k, _)| k);
        Some(Self { places: places.collect(), works: works.collect(), lost })
    }

    /// The derivatives by a parameter are lost; what was lost before stays so.
    pub(super) fn lose(&mut self, lost: Lost) {
        if self.lost.iter().all(|earlier| earlier.parameter != lost.parameter) {
            self.lost.push(lost);
        }
    }

    /// Whether a row has cells to be emptied; a derivative that is not finite where its column is ends those by its parameter.
    pub(super) fn see(&mut self, row: &[f64]) -> bool {
        for &[k, of, parameter] in &self.places {
            if self.works.contains(&k) {
                continue;
            }
            if !row[k].is_finite() && row[of].is_finite() && self.lost.iter().all(|lost| lost.parameter != parameter) {
                let why = "a derivative is not finite".to_owned();
                self.lost.push(Lost { parameter, t: row[0], why });
            }
        }
        !self.lost.is_empty()
    }

    /// Empties the cells.
    pub(super) fn clear(&self, row: &mut [f64]) {
        for &[k, _, parameter] in &self.places {
            if self.lost.iter().any(|lost| lost.parameter == parameter) {
                row[k] = f64::NAN;
            }
        }
    }

    /// What is lost.
    pub(super) fn lost(&self) -> &[Lost] {
        &self.lost
    }
}

/// Whether a column is the derivative of a work, whose flow may be unknown where the motion is not.
fn is_of_work(name: &str) -> bool {
    let of = Quantity::of_derivative(name).and_then(|(of, _)| Quantity::read(of));
    of.is_some_and(|of| of.is_work())
}

/// What metrics and their gradients are worked out of.
pub(super) struct Measured<'a> {
    /// The swept values, each with its comma.
    pub(super) lead: &'a str,
    pub(super) t: &'a [f64],
    /// Of each metric.
    pub(super) columns: Vec<OfMetric<'a>>,
    /// Where an event ended the case: of each metric the derivatives of its column along the event, and those of its time.
    pub(super) ended: Option<Ended<'a>>,
    /// What going back through the run found of each metric, where it did.
    pub(super) gradients: Option<Vec<Option<Vec<f64>>>>,
}

/// Of each metric the derivatives of its column where they are known, and those of the time.
pub(super) type Ended<'a> = (Vec<Option<Vec<f64>>>, &'a [f64]);

/// The column of a metric, and its derivatives where they are known.
pub(super) type OfMetric<'a> = (&'a [f64], Option<Vec<&'a [f64]>>);

impl CaseDerivatives {
    /// Of a case whose metrics have these `values`.
    pub(super) fn gradients(
        &mut self,
        layout: &Layout,
        (plans, sensitivity): (&[MetricPlan], &SensitivityPlan),
        measured: &Measured<'_>,
        values: &[f64],
    ) {
        let Some(differentiated) = layout.differentiated() else { return };
        let of = plans.iter().zip(layout.metrics()).zip(&measured.columns);
        for (k, (((plan, wanted), (own, changes)), value)) in of.zip(values).enumerate() {
            let back = measured.gradients.as_ref().and_then(|gradients| gradients[k].clone());
            let slopes = match changes {
                _ if back.is_some() => back.unwrap_or_default(),
                Some(changes) => {
                    let ended = measured.ended.as_ref();
                    let end = ended.and_then(|(of, later)| of[k].as_deref().map(|along| End { along, later }));
                    gradient(&plan.metric, (measured.t, own), changes, end)
                }
                None => vec![f64::NAN; differentiated.count],
            };
            let unit = plan.metric.kind.unit(&wanted.column.unit);
            for (parameter, slope) in sensitivity.parameters.iter().zip(&slopes) {
                let text = &mut self.lines[0];
                text.push_str(measured.lead);
                push_text(text, &plan.metric.name);
                text.push(',');
                push_number(text, *value);
                text.push(',');
                push_text(text, &unit);
                text.push(',');
                push_text(text, &parameter.name);
                text.push(',');
                push_number(text, *slope);
                text.push(',');
                push_text(text, &parameter.over(&unit));
                push_fields(text, [parameter.value * slope / value].into_iter());
                text.push('\n');
            }
            self.gradients.push(slopes);
        }
    }

    /// Ranks what a case with these statistics is differentiated by.
    pub(super) fn rank(&mut self, layout: &Layout, plan: &SensitivityPlan, statistics: &[Statistics], lead: &str) {
        let Some(differentiated) = layout.differentiated() else { return };
        self.ranking = differentiated.rank(plan, statistics);
        for Ranked { column, parameter, rms, share } in &self.ranking {
            let text = &mut self.lines[1];
            text.push_str(lead);
            push_text(text, column);
            text.push(',');
            push_text(text, &plan.parameters[*parameter].name);
            push_fields(text, [*rms, *share].into_iter());
            text.push('\n');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use springpot::law::Catalog;
    use springpot_scenario::Scenario;

    const RUN: &str = r#"
robot.body = [{ name = "mass", joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }, mass = 2 }]
element = [{ name = "pad", joint = "x", law = "kelvin-voigt", parameters = { k = 50, c = 5 } }]
motion = { kind = "forward" }
time = { end = 1, output_step = 0.1 }
sensitivity = { by = ["element.pad.k", "element.pad.c"], of = ["q.x", "pad.force"] }
"#;

    #[test]
    fn cells_are_empty_from_where_derivatives_end() {
        let cases = Scenario::parse(RUN, "run.toml", "").unwrap().cases(&Catalog::standard()).unwrap();
        let plan = cases.plan(0).unwrap();
        let width = plan.row_columns().len();
        let mut losses = Losses::of(&plan, Vec::new()).unwrap();
        let mut row = vec![1.0; width];
        assert!(!losses.see(&row));
        // An empty cell has no derivative, and nothing is lost.
        let force = plan.columns().iter().position(|column| column.name == "pad.force").unwrap();
        row[force] = f64::NAN;
        row[width - 2..].fill(f64::NAN);
        assert!(!losses.see(&row));
        // One by k that is not finite where the force is ends those by k, and no others.
        row = vec![1.0; width];
        (row[0], row[width - 2]) = (0.3, f64::INFINITY);
        assert!(losses.see(&row));
        losses.clear(&mut row);
        let is_empty: Vec<bool> = row[width - 4..].iter().map(|cell| cell.is_nan()).collect();
        assert_eq!(is_empty, [true, false, true, false]);
        assert_eq!((losses.lost()[0].parameter, losses.lost()[0].t), (0, 0.3));
        // What the run says ends the others; it is said once.
        losses.lose(Lost { parameter: 1, t: 0.5, why: "two events act at one time".to_owned() });
        losses.lose(Lost { parameter: 1, t: 0.6, why: "again".to_owned() });
        let mut row = vec![1.0; width];
        assert!(losses.see(&row));
        losses.clear(&mut row);
        assert!(row[width - 4..].iter().all(|cell| cell.is_nan()) && row[..width - 4].iter().all(|cell| *cell == 1.0));
        assert_eq!((losses.lost().len(), losses.lost()[1].t), (2, 0.5));
        // A run that goes on has lost what it had lost.
        let mut on = Losses::of(&plan, losses.lost().to_vec()).unwrap();
        assert!(on.see(&vec![1.0; width]));
    }
}
