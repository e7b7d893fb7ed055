//! Files of a case for other programs: recordings and moving models.

use crate::meshes;
use crate::record::{Listed, written_value};
use crate::results::{Results, ResultsError};
use crate::view::view_columns;
use springpot_report::gltf::{Container, Model};
use springpot_report::recording::{About, Recording};
use springpot_report::scene::Kinematics;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

/// Files that other programs read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// A recording in MCAP, as ROS 2 makes them.
    Mcap,
    /// A moving model in glTF.
    Gltf(Container),
}

impl ExportFormat {
    /// Endings of the files.
    pub const ENDINGS: [&str; 3] = ["mcap", "glb", "gltf"];

    /// What the ending of a file's name says.
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "mcap" => Some(Self::Mcap),
            "glb" => Some(Self::Gltf(Container::Binary)),
            "gltf" => Some(Self::Gltf(Container::Text)),
            _ => None,
        }
    }
}

/// Why a file is not written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The results cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] io::Error),
}

/// Writes the case of that index into `out`; returns what a reader is to know of it.
///
/// # Errors
/// The results cannot be read, the case has no row, or there is no column `t`; what `out` says.
pub fn export(
    results: &Results,
    index: usize,
    format: ExportFormat,
    out: &mut dyn Write,
) -> Result<Vec<String>, ExportError> {
    let with_rows = results.record.with_rows().into_iter().enumerate();
    let (place, case) =
        with_rows.into_iter().find(|(_, case)| case.index == index).ok_or(ResultsError::NoCase(index))?;
    let time = results.columns.iter().position(|column| column.name == "t");
    let time = time.ok_or_else(|| ResultsError::NoColumn { folder: results.folder.clone(), column: "t" })?;
    let mut notes = rest(results, case);
    notes.extend(results.record.scene_note(case));
    match format {
        ExportFormat::Mcap => record(results, place, case, time, out)?,
        ExportFormat::Gltf(container) => model(results, place, case, container, out, &mut notes)?,
    }
    Ok(notes)
}

/// What of the motion is not in the rows.
fn rest(results: &Results, case: &Listed) -> Vec<String> {
    let column = |name: &str| results.columns.iter().position(|column| column.name == name);
    let tree = Kinematics::new(&results.record.scenes[results.record.scene_of(case)], column);
    match tree.missing() {
        [] => Vec::new(),
        [one] => vec![format!("the rows have no coordinate of joint `{one}`, which rests at zero")],
        [one, rest @ ..] => {
            vec![format!("the rows have no coordinates of joint `{one}` and {} more, which rest at zero", rest.len())]
        }
    }
}

/// Calls `take` with the rows of a case, and with the swept values as text of the file of its events.
fn visit(
    results: &Results,
    place: usize,
    mut take: impl FnMut(&str, &[f64]) -> io::Result<()>,
) -> Result<(), ExportError> {
    let (mut failed, mut is_past) = (None, false);
    let read = results.visit(&mut |lead, case, values| {
        let stop = || io::Error::other("enough");
        is_past = case > place;
        if is_past {
            return Err(stop());
        }
        let taken = if case == place { take(lead, values) } else { Ok(()) };
        taken.map_err(|error| {
            failed = Some(error);
            stop()
        })
    });
    match (failed, read) {
        (Some(error), _) => Err(ExportError::Write(error)),
        (None, Err(error)) if !is_past => Err(error.into()),
        (None, _) => Ok(()),
    }
}

fn record(results: &Results, place: usize, case: &Listed, time: usize, out: &mut dyn Write) -> Result<(), ExportError> {
    let record = &results.record;
    let events = results.texts("events.csv");
    let elements: Vec<String> = record.laws.iter().map(|law| law.name.clone()).collect();
    let about = About {
        version: results.record.version(),
        facts: facts(results, case),
        scene: &record.scenes[results.record.scene_of(case)],
        columns: &view_columns(&results.columns),
        elements: &elements,
        has_events: !events.is_empty(),
    };
    let mut recording = Recording::begin(out, &about)?;
    let mut to_come: Option<std::vec::IntoIter<(f64, String)>> = None;
    let mut next: Option<(f64, String)> = None;
    visit(results, place, |lead, values| {
        let to_come = to_come.get_or_insert_with(|| {
            let own = events.iter().filter(|(of, _)| of == lead).filter_map(|(_, fields)| match &fields[..] {
                [name, t, ..] => Some((t.parse().ok()?, name.clone())),
                _ => None,
            });
            let mut own = own.collect::<Vec<(f64, String)>>().into_iter();
            next = own.next();
            own
        });
        recording.row(values)?;
        // Behind the last row that is not later.
        while let Some((t, name)) = next.take_if(|(t, _)| *t <= values[time]) {
            recording.event(t, &name)?;
            next = to_come.next();
        }
        Ok(())
    })?;
    for (t, name) in next.into_iter().chain(to_come.into_iter().flatten()) {
        recording.event(t, &name)?;
    }
    Ok(recording.finish()?)
}

fn model(
    results: &Results,
    place: usize,
    case: &Listed,
    container: Container,
    out: &mut dyn Write,
    notes: &mut Vec<String>,
) -> Result<(), ExportError> {
    let scene = &results.record.scenes[results.record.scene_of(case)];
    let rows = usize::try_from(case.rows).unwrap_or(usize::MAX);
    let (meshes, unseen) = meshes::files(&results.record, &results.folder);
    notes.extend(unseen);
    let mut model = Model::new(scene, &meshes, &view_columns(&results.columns), rows);
    if model.stride() > 1 {
        notes.push(format!("one of {} rows is a keyframe", model.stride()));
    }
    visit(results, place, |_, values| {
        model.row(values);
        Ok(())
    })?;
    let name = results.record.title.clone().unwrap_or_else(|| results.name());
    notes.extend(model.write(&name, results.record.version(), &facts(results, case), container, out)?);
    Ok(())
}

/// What a case is.
fn facts(results: &Results, case: &Listed) -> BTreeMap<String, String> {
    let swept = case.parameters.iter().map(|(path, value)| (format!("parameter {path}"), written_value(value)));
    let known = [
        ("title", results.record.title.clone().unwrap_or_default()),
        ("results", results.name()),
        ("case", case.index.to_string()),
        ("status", case.status.clone()),
        ("version", results.record.version().to_owned()),
    ];
    swept.chain(known.map(|(name, value)| (name.to_owned(), value))).collect()
}
