//! run.json, read again.

use crate::labels;
use crate::table::disk::Disk;
use crate::table::{push_number, push_text};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use springpot::table::Column;
use springpot_report::scene::{LawText, Scene};
use springpot_scenario::Metric;
use std::collections::HashMap;
use std::path::Path;

/// What it says; empty where it says nothing of something.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Record {
    pub(crate) status: String,
    pub(crate) title: Option<String>,
    pub(crate) versions: Map<String, Value>,
    columns: Vec<Described>,
    pub(crate) sweeps: Vec<Sweep>,
    pub(crate) cases: Vec<Listed>,
    #[serde(flatten)]
    pub(crate) totals: Totals,
    /// What tells a run under way from others in its folder.
    pub(crate) id: String,
    pub(crate) warnings: Vec<String>,
    pub(crate) plan: Value,
    pub(crate) scenario: Option<Recorded>,
    pub(crate) files: Vec<String>,
    format: Option<String>,
    pub(crate) scenes: Vec<Scene>,
    pub(crate) robots: Vec<RobotFile>,
    pub(crate) laws: Vec<LawText>,
}

/// Where the robot of a run was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct RobotFile {
    /// Relative to the folder of the results.
    pub(crate) file: String,
    /// Folders that are packages or hold some, likewise.
    pub(crate) package_path: Vec<String>,
    /// What tells the file from any other.
    pub(crate) mark: String,
}

/// What came of all cases together.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Totals {
    pub(crate) cases_total: usize,
    pub(crate) cases_done: usize,
    pub(crate) cases_failed: usize,
    pub(crate) rows: Option<u64>,
    pub(crate) energy_residual: Option<f64>,
    pub(crate) energy_turned_over: Option<f64>,
    pub(crate) ledger: Option<String>,
    pub(crate) limits: Vec<Value>,
    pub(crate) steps: u64,
    /// s.
    pub(crate) wall_time: f64,
}

#[derive(Debug, Deserialize)]
struct Described {
    name: String,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    meaning: String,
}

/// Cases that a page shows where none are named: those whose own scene is recorded.
pub(crate) const MOST_SHOWN: usize = 12;

/// What was asked for.
#[derive(Debug, Deserialize)]
pub(crate) struct Recorded {
    pub(crate) name: String,
    pub(crate) text: String,
    #[serde(default)]
    pub(crate) set: Vec<String>,
    #[serde(default)]
    pub(crate) sweep: Vec<String>,
}

/// Parameters that are swept together.
#[derive(Debug, Deserialize)]
#[serde(try_from = "ReadSweep")]
pub(crate) struct Sweep {
    pub(crate) parameters: Vec<String>,
    pub(crate) count: usize,
    /// The values by their names, or as they were written.
    pub(crate) labels: Vec<String>,
    /// Whether these are names.
    are_names: bool,
    /// By value, as it was written for each parameter; nothing where that is not told.
    written: Vec<Vec<String>>,
    /// By parameter, its values as a reader wants them; nothing where only numbers of the rows are known.
    shown: Vec<Vec<String>>,
}

/// A sweep as it stands there.
#[derive(Debug, Deserialize)]
struct ReadSweep {
    parameters: Vec<String>,
    #[serde(default)]
    count: usize,
    #[serde(default)]
    labels: Vec<String>,
    #[serde(default)]
    names: Option<Vec<String>>,
    #[serde(default)]
    written: Vec<Vec<String>>,
}

impl TryFrom<ReadSweep> for Sweep {
    type Error = String;

    fn try_from(read: ReadSweep) -> Result<Self, String> {
        let ReadSweep { parameters, count, labels, names, written } = read;
        match &names {
            Some(names) if *names != labels => {
                let swept = parameters.join(", ");
                Err(format!("the sweep of {swept} has {} labels and other names, {}", labels.len(), names.len()))
            }
            None if parameters.len() == 1 => {
                let shown = vec![labels::values(&labels)];
                let written = labels.iter().map(|label| vec![label.clone()]).collect();
                Ok(Self { parameters, count, labels, are_names: false, written, shown })
            }
            _ => {
                let column =
                    |at| written.iter().map(|row: &Vec<String>| row.get(at).cloned()).collect::<Option<Vec<_>>>();
                let shown = (0..parameters.len()).map(|at| labels::values(&column(at).unwrap_or_default())).collect();
                Ok(Self { parameters, count, labels, are_names: names.is_some(), written, shown })
            }
        }
    }
}

impl Sweep {
    /// What value number `at` is called, where the scenario says so.
    pub(crate) fn name(&self, at: usize) -> Option<&String> {
        self.labels.get(at).filter(|_| self.are_names)
    }

    /// Value number `at` of its parameter number `k` as it was written, where that is told.
    pub(crate) fn written(&self, at: usize, k: usize) -> Option<&String> {
        self.written.get(at)?.get(k)
    }

    /// What it and its values are called: nothing and their names, or its parameters and values as a reader writes them.
    pub(crate) fn words(&self) -> (String, Vec<String>) {
        labels::sweep(self.parameters.iter().map(String::as_str), &self.labels, self.are_names)
    }
}

/// A case as it is listed.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Listed {
    pub(crate) index: usize,
    pub(crate) parameters: Map<String, Value>,
    pub(crate) status: String,
    pub(crate) error: Option<String>,
    pub(crate) rows: u64,
    /// Index of its scene; `None`: it has one of its own that is not recorded.
    #[serde(default = "first_scene")]
    pub(crate) scene: Option<usize>,
    pub(crate) steps: u64,
    /// s.
    pub(crate) wall_time: f64,
    /// s.
    pub(crate) t_reached: Option<f64>,
    /// J.
    pub(crate) energy_residual: Option<f64>,
    /// J.
    pub(crate) energy_turned_over: Option<f64>,
    /// Where they are not those of the first case.
    pub(crate) metrics: Option<Vec<Metric>>,
}

fn first_scene() -> Option<usize> {
    Some(0)
}

impl Record {
    /// The record in a folder of results.
    ///
    /// # Errors
    /// There is none that can be read: nothing, or what is wrong with the one that is there.
    pub(crate) fn read(disk: &Disk, folder: &Path) -> Result<Self, Option<String>> {
        let bytes = disk.read(&folder.join("run.json")).map_err(|_| None)?;
        serde_json::from_slice(&bytes).map_err(|error| Some(error.to_string()))
    }

    /// What the file of the rows is called.
    pub(crate) fn rows_file(&self) -> String {
        format!("results.{}", self.format.as_deref().unwrap_or("csv"))
    }

    /// Unit and meaning of the column of a name; nothing of one that is not known.
    pub(crate) fn column(&self, name: &str) -> Column {
        let found = self.columns.iter().find(|column| column.name == name);
        let (unit, meaning) = found.map_or(("", ""), |column| (&column.unit, &column.meaning));
        Column::new(name, unit, meaning)
    }

    /// All columns as the run wrote them, those of swept parameters first.
    pub(crate) fn columns(&self) -> impl Iterator<Item = Column> {
        self.columns.iter().map(|column| Column::new(&*column.name, &*column.unit, &*column.meaning))
    }

    /// Paths of the swept parameters.
    pub(crate) fn parameters(&self) -> impl Iterator<Item = &String> {
        self.sweeps.iter().flat_map(|sweep| &sweep.parameters)
    }

    /// The metrics of the first case.
    pub(crate) fn metrics(&self) -> Vec<Metric> {
        serde_json::from_value(self.plan["metrics"].clone()).unwrap_or_default()
    }

    /// The cases that have rows, in the order of these.
    pub(crate) fn with_rows(&self) -> Vec<&Listed> {
        self.cases.iter().filter(|case| case.rows > 0).collect()
    }

    /// Swept values of a case as a reader wants them, their names or `α = 0.2`; empty where nothing is swept.
    pub(crate) fn case_name(&self, case: &Listed) -> String {
        let mut words = Vec::new();
        let mut stride: usize = self.sweeps.iter().map(|sweep| sweep.count.max(1)).product();
        for sweep in &self.sweeps {
            let count = sweep.count.max(1);
            stride = (stride / count).max(1);
            let at = case.index / stride % count;
            if let Some(name) = sweep.name(at) {
                words.push(name.clone());
                continue;
            }
            words.extend(sweep.parameters.iter().enumerate().filter_map(|(k, path)| {
                let shown = sweep.shown.get(k).and_then(|values| values.get(at)).cloned();
                let value = shown.or_else(|| case.parameters.get(path).map(written_value))?;
                Some(format!("{} = {value}", labels::parameter(path)))
            }));
        }
        words.join(", ")
    }

    /// What cases are called, by the swept values that lead their lines.
    pub(crate) fn names_by_lead(&self) -> NamesByLead {
        let is_named = self.sweeps.iter().any(|sweep| sweep.are_names);
        let named = self.cases.iter().filter(|_| is_named);
        NamesByLead(named.map(|case| (self.lead(case), self.case_name(case))).collect())
    }

    /// Index of the scene of a case; that of the first where its own is not recorded.
    pub(crate) fn scene_of(&self, case: &Listed) -> usize {
        case.scene.filter(|scene| *scene < self.scenes.len()).unwrap_or(0)
    }

    /// What is said where a case is not drawn as it was.
    pub(crate) fn scene_note(&self, case: &Listed) -> Option<String> {
        let words = || {
            format!(
                "case {} is drawn with the robot and the elements of case 0: of the first {MOST_SHOWN} cases alone they are recorded",
                case.index
            )
        };
        case.scene.is_none().then(words)
    }

    /// The swept values of a case as they lead its rows, each with its comma.
    pub(crate) fn lead(&self, case: &Listed) -> String {
        let mut lead = String::new();
        for path in self.parameters() {
            match case.parameters.get(path) {
                Some(Value::Number(number)) => push_number(&mut lead, number.as_f64().unwrap_or(f64::NAN)),
                Some(Value::String(text)) => push_text(&mut lead, text),
                _ => {}
            }
            lead.push(',');
        }
        lead
    }

    /// The version of Springpot that wrote it.
    pub(crate) fn version(&self) -> &str {
        self.versions.get("springpot").and_then(Value::as_str).unwrap_or_default()
    }
}

/// Names of cases, where some values of sweeps have them.
pub(crate) struct NamesByLead(HashMap<String, String>);

impl NamesByLead {
    /// What the case with these swept values is called: its name, or the values.
    pub(crate) fn of(&self, lead: &str) -> String {
        self.0.get(lead).cloned().unwrap_or_else(|| lead.trim_end_matches(',').replace(',', ", "))
    }
}

/// A swept value as text.
pub(crate) fn written_value(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

/// What results are called: their folder.
pub(crate) fn name(folder: &Path) -> String {
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
