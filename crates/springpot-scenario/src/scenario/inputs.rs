//! The files that a scenario names.

use super::written::Scenario;
use crate::text::document::{Node, Value};
use std::path::PathBuf;

/// Longest text that is taken for a path.
const LONGEST: usize = 4096;

impl Scenario {
    /// Every file there is that a text of the scenario leads to, be it in the file, swept or set, from the root of the file system.
    pub fn named_files(&self) -> Vec<PathBuf> {
        let mut texts = Vec::new();
        self.overrides
            .iter()
            .chain(&self.sweeps)
            .filter_map(|one| one.value.as_ref())
            .chain([&self.document])
            .for_each(|node| collect(node, &mut texts));
        texts.sort_unstable();
        texts.dedup();
        let paths = texts.into_iter().filter_map(|text| self.folder.join(text).canonicalize().ok());
        paths.filter(|path| path.is_file()).collect()
    }
}

fn collect<'a>(node: &'a Node, texts: &mut Vec<&'a str>) {
    match &node.value {
        Value::Text(text) if text.len() <= LONGEST && !text.contains(['\n', '\0']) => texts.push(text),
        Value::Array(items) => items.iter().for_each(|item| collect(item, texts)),
        Value::Table(entries) => entries.iter().for_each(|entry| collect(&entry.node, texts)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_are_found_wherever_they_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("data")).unwrap();
        for name in ["data/a.csv", "b.csv", "c.csv", "arm.urdf", "d.csv"] {
            fs::write(at(name), "").unwrap();
        }
        let text = "robot.urdf = \"arm.urdf\"\ntitle = \"data\"\n[[element]]\ninputs = { u = { csv = \"data/../data/a.csv\" } }\n\
                    [[sweep]]\nvalues = [\"b.csv\", \"none.csv\", 3]\n";
        let mut scenario = Scenario::parse(text, "a.toml", folder.path()).unwrap();
        scenario.set(&format!("motion.csv={:?}", at("c.csv"))).unwrap();
        let mut wanted: Vec<PathBuf> =
            ["arm.urdf", "b.csv", "c.csv", "data/a.csv"].map(|name| at(name).canonicalize().unwrap()).to_vec();
        let mut found = scenario.named_files();
        wanted.sort();
        found.sort();
        assert_eq!(found, wanted);
    }
}
