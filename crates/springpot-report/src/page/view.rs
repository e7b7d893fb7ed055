//! The page that shows a run in motion.

use super::{MARK, in_script, mesh};
use crate::mesh::MeshFile;
use crate::scene::{LawText, Scene};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Serialize, Serializer};
use serde_json::json;
use std::collections::BTreeMap;

/// The page without its data.
const PAGE: &str = include_str!("../../assets/viewer.html");
/// What stands in the place of the data.
const DATA: &str = "@DATA@";

/// All that the page shows.
#[derive(Debug, Default)]
pub struct View {
    /// The scenario's title.
    pub title: Option<String>,
    /// What the results are called.
    pub name: String,
    /// done, failed, interrupted or running.
    pub status: String,
    /// The version of Springpot that ran it.
    pub version: String,
    /// What a reader is to know of the page.
    pub notes: Vec<String>,
    /// Columns of the rows, those of swept parameters aside.
    pub columns: Vec<ViewColumn>,
    /// What is drawn.
    pub scenes: Vec<Scene>,
    /// Where the files are that meshes of the scenes are called by; those that are not among them are not drawn.
    pub meshes: BTreeMap<String, MeshFile>,
    /// What is said of the elements' laws.
    pub laws: Vec<LawText>,
    /// The cases shown.
    pub cases: Vec<ViewCase>,
    /// Where a server sends rows as they come.
    pub follow: Option<String>,
}

/// A column of the rows.
#[derive(Debug, Clone, Serialize)]
pub struct ViewColumn {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// What it is.
    pub meaning: String,
}

/// A case with its rows.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ViewCase {
    /// Index in the grid.
    pub index: usize,
    /// Its swept values as a reader wants them; empty where nothing is swept.
    pub name: String,
    /// Swept values by path.
    pub parameters: BTreeMap<String, serde_json::Value>,
    /// How it ended.
    pub status: String,
    /// Why it stopped early.
    pub error: Option<String>,
    /// Index of its scene.
    pub scene: usize,
    /// Number of rows.
    pub rows: usize,
    /// Column after column, in the order of the columns; NaN: empty.
    #[serde(serialize_with = "packed")]
    pub data: Vec<f32>,
    /// When what happened.
    pub events: Vec<CaseEvent>,
    /// What its metrics are.
    pub metrics: Vec<CaseMetric>,
}

/// An event.
#[derive(Debug, Clone, Serialize)]
pub struct CaseEvent {
    /// Its name.
    pub name: String,
    /// s.
    pub t: f64,
}

/// A metric.
#[derive(Debug, Clone, Serialize)]
pub struct CaseMetric {
    /// Its name.
    pub name: String,
    /// The column that it is of.
    pub column: String,
    /// `None`: it has none.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
}

fn packed<S: Serializer>(data: &[f32], serializer: S) -> Result<S::Ok, S::Error> {
    let bytes: Vec<u8> = data.iter().flat_map(|number| number.to_le_bytes()).collect();
    serializer.serialize_str(&STANDARD.encode(bytes))
}

impl View {
    /// The page: one file of HTML that needs nothing else.
    ///
    /// Meshes are read from their files now; those that cannot be are left out, and a note says so.
    pub fn html(&self) -> String {
        let (scenes, meshes, unread) = mesh::embed(&self.scenes, &self.meshes);
        let notes: Vec<String> = self.notes.iter().cloned().chain(unread).collect();
        let data = json!({
            "title": self.title,
            "name": self.name,
            "status": self.status,
            "version": self.version,
            "notes": notes,
            "columns": self.columns,
            "scenes": scenes,
            "meshes": meshes,
            "elements": self.laws,
            "cases": self.cases,
            "follow": self.follow,
        });
        let (before, after) = PAGE.split_once(DATA).expect("the page has a place for its data");
        let before = before.replacen("<head>", &format!("<head>\n{MARK}"), 1);
        [&before, &*in_script(&data.to_string()), after].concat()
    }
}
