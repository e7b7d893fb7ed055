//! The page that shows results in motion.

use crate::meshes;
use crate::record::{Listed, MOST_SHOWN, Record};
use crate::results::{Results, ResultsError};
use springpot::table::Column;
use springpot_report::page::{CaseEvent, CaseMetric, View, ViewCase, ViewColumn};

/// Numbers of a page.
pub(crate) const MOST_NUMBERS: usize = 1_200_000;

/// The page of the cases of these indices, or of the first that have rows; of rows that are too many, every so many are taken, and the last.
///
/// # Errors
/// The results cannot be read.
pub fn view(results: &Results, asked: &[usize]) -> Result<View, ResultsError> {
    let record = &results.record;
    let with_rows = record.with_rows();
    let is_shown = |case: &Listed| asked.is_empty() || asked.contains(&case.index);
    let mut notes = Vec::new();
    // By case with rows: its place among those shown.
    let (mut places, mut cases) = (vec![None; with_rows.len()], Vec::new());
    for (place, case) in places.iter_mut().zip(&with_rows).filter(|(_, case)| is_shown(case)) {
        if asked.is_empty() && cases.len() == MOST_SHOWN {
            notes.push(format!("the first {MOST_SHOWN} of {} cases are shown", with_rows.len()));
            break;
        }
        *place = Some(cases.len());
        cases.push(shown(record, case));
        notes.extend(record.scene_note(case));
    }
    let columns = results.columns.len();
    let rows: usize = with_rows
        .iter()
        .zip(&places)
        .filter(|(_, place)| place.is_some())
        .map(|(case, _)| case.rows as usize)
        .fold(0, usize::saturating_add);
    let stride = rows.saturating_mul(columns).div_ceil(MOST_NUMBERS).max(1);
    if stride > 1 {
        notes.push(format!("one of {stride} rows is shown"));
    }
    let mut kept: Vec<Vec<f32>> = vec![Vec::new(); cases.len()];
    let mut leads = vec![String::new(); cases.len()];
    let mut seen = vec![0_usize; cases.len()];
    results.visit(&mut |lead, case, values| {
        let Some(Some(place)) = places.get(case) else { return Ok(()) };
        if seen[*place] == 0 {
            lead.clone_into(&mut leads[*place]);
        }
        seen[*place] += 1;
        let is_last = seen[*place] == with_rows[case].rows as usize;
        if is_last || (seen[*place] - 1) % stride == 0 {
            kept[*place].extend(values.iter().map(|value| *value as f32));
        }
        Ok(())
    })?;
    for (case, kept) in cases.iter_mut().zip(kept) {
        case.rows = kept.len() / columns.max(1);
        case.data = (0..columns)
            .flat_map(|column| (0..case.rows).map(move |row| (column, row)))
            .map(|(column, row)| kept[row * columns + column])
            .collect();
    }
    for (lead, fields) in results.texts("events.csv") {
        if let (Some(place), [name, t, ..]) = (leads.iter().position(|known| *known == lead), &fields[..]) {
            let t = t.parse().unwrap_or(f64::NAN);
            cases[place].events.push(CaseEvent { name: name.clone(), t });
        }
    }
    for (lead, fields) in results.texts("metrics.csv") {
        if let (Some(place), [name, column, value, unit]) = (leads.iter().position(|known| *known == lead), &fields[..])
        {
            let (name, column, unit) = (name.clone(), column.clone(), unit.clone());
            cases[place].metrics.push(CaseMetric { name, column, value: value.parse().ok(), unit });
        }
    }
    let (meshes, unseen) = meshes::files(record, &results.folder);
    notes.extend(unseen);
    Ok(View {
        title: record.title.clone(),
        name: results.name(),
        status: record.status.clone(),
        version: record.version().to_owned(),
        notes,
        columns: view_columns(&results.columns),
        scenes: record.scenes.clone(),
        meshes,
        laws: record.laws.clone(),
        cases,
        follow: None,
    })
}

/// Columns as a page has them.
pub(crate) fn view_columns(columns: &[Column]) -> Vec<ViewColumn> {
    let column = |column: &Column| {
        let Column { name, unit, meaning } = column.clone();
        ViewColumn { name, unit, meaning }
    };
    columns.iter().map(column).collect()
}

/// A case without its rows.
pub(crate) fn shown(record: &Record, case: &Listed) -> ViewCase {
    ViewCase {
        index: case.index,
        name: record.case_name(case),
        parameters: case.parameters.iter().map(|(path, value)| (path.clone(), value.clone())).collect(),
        status: case.status.clone(),
        error: case.error.clone(),
        scene: record.scene_of(case),
        ..ViewCase::default()
    }
}
