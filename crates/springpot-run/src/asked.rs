//! What a caller asks to be run: a scenario, and what is changed in it.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use springpot_scenario::{RefusalKind, Refusals, Scenario};
use std::path::{Path, PathBuf};

/// A scenario and what is set and swept beside it; it can be sent to other processes that see the files it names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// What messages call it: its file as it was typed.
    pub name: String,
    /// Its file from the root of the file system; `None` for a text that is no file.
    pub file: Option<PathBuf>,
    /// The folder that paths in it are relative to.
    pub folder: PathBuf,
    /// Its text.
    pub text: String,
    /// Values that are set, `PATH=VALUE`.
    pub overrides: Vec<String>,
    /// Parameters that are swept, `PATH=v1,v2,…` ([`Scenario::sweep`]).
    pub sweeps: Vec<String>,
    /// By what it is differentiated besides, `PATH,PATH` ([`Scenario::differentiate`]).
    #[serde(default)]
    pub sensitivity: Vec<String>,
}

impl Asked {
    /// The scenario in a file, with nothing changed.
    ///
    /// # Errors
    /// As [`Scenario::read`].
    pub fn read(file: &Path) -> Result<Self, Refusals> {
        let scenario = Scenario::read(file)?;
        let name = file.display().to_string();
        let whole = file.canonicalize().unwrap_or_else(|_| file.to_owned());
        let folder = whole.parent().unwrap_or(Path::new("")).to_owned();
        let text = scenario.source().text.to_string();
        Ok(Self { name, file: Some(whole), ..Self::text(text, "", folder) })
    }

    /// A text that messages call `name`; paths in it are relative to `folder`.
    pub fn text(text: impl Into<String>, name: impl Into<String>, folder: impl Into<PathBuf>) -> Self {
        let (overrides, sweeps, sensitivity) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: name.into(), file: None, folder: folder.into(), text: text.into(), overrides, sweeps, sensitivity }
    }

    /// The scenario, with everything set and swept.
    ///
    /// # Errors
    /// As [`Scenario::parse`], [`Scenario::set`] and [`Scenario::sweep`].
    pub fn scenario(&self) -> Result<Scenario, Refusals> {
        // As typed, where that still leads there: messages then name files as those of the first command did.
        let typed = Path::new(&self.name);
        let same = self.file.as_ref().is_some_and(|file| typed.canonicalize().is_ok_and(|typed| typed == *file));
        let folder = if same { typed.parent().unwrap_or(Path::new("")) } else { &self.folder };
        let mut scenario = Scenario::parse(&self.text, &*self.name, folder)?;
        self.overrides.iter().try_for_each(|assignment| scenario.set(assignment))?;
        self.sweeps.iter().try_for_each(|assignment| scenario.sweep(assignment))?;
        self.sensitivity.iter().try_for_each(|paths| scenario.differentiate(paths))?;
        Ok(scenario)
    }

    /// What run.json says of it.
    pub(crate) fn record(&self) -> Value {
        let mut record = json!({ "name": self.name, "text": self.text, "set": self.overrides, "sweep": self.sweeps });
        if !self.sensitivity.is_empty() {
            record["sensitivity"] = json!(self.sensitivity);
        }
        record
    }

    /// Whether its file says something else by now; one that is gone does not matter.
    pub fn has_changed(&self) -> bool {
        match self.file.as_ref().map(Scenario::read) {
            Some(Ok(now)) => *now.source().text != *self.text,
            Some(Err(refusals)) => refusals.iter().any(|refusal| refusal.kind != RefusalKind::File),
            None => false,
        }
    }
}
