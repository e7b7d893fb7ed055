//! `past` and `derivative` of an element: what happened before t = 0.

use crate::keys::{HELD, PASTS};
use crate::reader::{Field, Read, Refused, Table};
use crate::text::refusal::{Place, RefusalKind};
use serde_json::{Value, json};
use springpot::law::Derivative;

/// What happened to an element before t = 0.
#[derive(Debug, Clone)]
pub enum PastPlan {
    /// As its derivative says: held since ever, or unloaded.
    OfDerivative,
    /// Stretched to x(0) so long before t = 0, s.
    Held(f64),
    /// The same periodic stroke since ever.
    Steady {
        /// The period, s.
        period: f64,
        /// Where it is written.
        place: Place,
    },
}

impl PastPlan {
    /// Its record; nothing where the derivative says it.
    pub(crate) fn record(&self) -> Option<Value> {
        match self {
            Self::OfDerivative => None,
            Self::Held(age) => Some(json!({ "held": age })),
            Self::Steady { period, .. } => Some(json!({ "steady": period })),
        }
    }

    /// A few words for `check`; nothing where the derivative says it.
    pub fn words(&self) -> Option<String> {
        match self {
            Self::OfDerivative => None,
            Self::Held(age) => Some(format!("held at x(0) for {age} s before t = 0")),
            Self::Steady { period, .. } => Some(format!("periodic since ever, every {period} s")),
        }
    }
}

/// Reads `derivative`, `past` and `period`.
pub(crate) fn read(table: &Table<'_>) -> Read<(Derivative, PastPlan)> {
    let (past, period) = (table.get("past"), table.get("period"));
    let is_steady = past.as_ref().is_some_and(|field| field.node.text() == Some(PASTS[2]));
    if let Some(period) = &period
        && !is_steady
    {
        let help = "write past = \"steady\", or leave the period out".to_owned();
        return Err(period.refuse(RefusalKind::Rule, "has no meaning without past = \"steady\"", Some(help)));
    }
    let Some(field) = past else {
        return Ok((
            table.get("derivative").map_or(Ok(Derivative::Caputo), |field| derivative(&field))?,
            PastPlan::OfDerivative,
        ));
    };
    if let Some(derivative) = table.get("derivative") {
        let help = "leave it out: the past says it".to_owned();
        return Err(derivative.refuse(RefusalKind::Rule, "stands beside a `past`", Some(help)));
    }
    if field.node.entries().is_some() {
        let age = field.table(&HELD)?.number("held")?;
        return Ok((Derivative::RiemannLiouville, PastPlan::Held(age)));
    }
    match field.word("past")? {
        "held" => Ok((Derivative::Caputo, PastPlan::OfDerivative)),
        "unloaded" => Ok((Derivative::RiemannLiouville, PastPlan::OfDerivative)),
        _ => {
            let Some(period) = period else {
                return Err(table.missing("period", "period = \"1 s\" beside past = \"steady\""));
            };
            Ok((Derivative::Caputo, PastPlan::Steady { period: period.quantity()?, place: field.node.place.clone() }))
        }
    }
}

fn derivative(field: &Field<'_>) -> Read<Derivative> {
    let word = field.word("kind of derivative")?;
    [Derivative::Caputo, Derivative::RiemannLiouville].into_iter().find(|kind| kind.name() == word).ok_or(Refused)
}
