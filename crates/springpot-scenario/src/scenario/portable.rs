//! A scenario together with the files that it names, to be put into another folder.

use super::written::Scenario;
use crate::changes::path::{self};
use crate::reader::element;
use crate::text::document::{Node, Value};
use crate::text::quoted::toml_text;
use crate::text::refusal::Source;
use springpot::model::description::{DescriptionOptions, RobotDescription};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Keys whose texts are names of files.
const FILES: [&str; 3] = ["csv", "urdf", "mjcf"];

/// The key whose texts are folders, in which nothing is looked for elsewhere.
const FOLDERS: &str = "package_path";

/// Where the files go, beside the text.
const FOLDER: &str = "files";

/// A scenario as it stands in another folder: its text, what is set in it, and copies of the files that both name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Portable {
    /// The text, its paths relative to its folder: `files/NAME`.
    pub text: String,
    /// What `--set` said, in the same way.
    pub set: Vec<String>,
    /// Where each file goes, relative to the folder of the text with `/` between, and where it is now.
    pub files: Vec<(String, PathBuf)>,
}

impl Scenario {
    /// The scenario for another folder. Names of files are those of the keys `csv`, `urdf` and `mjcf` and of tables of networks, where they lead to
    /// a file; `package_path` is emptied, since meshes count for nothing here. Comments and all other values stay as they are written.
    pub fn portable(&self) -> Portable {
        let mut moved = Moved { folder: &self.folder, tables: Vec::new(), files: Vec::new(), edits: Vec::new() };
        moved.learn_tables(&self.document);
        moved.visit(&self.document);
        for one in &self.overrides {
            let last = path::keys(&one.path).and_then(|keys| keys.last().cloned());
            if let Some(value) = &one.value {
                moved.value(last.as_deref().unwrap_or_default(), value);
            }
        }
        let sets = self.overrides.iter().map(|one| &one.place.source);
        Portable {
            text: moved.edited(&self.source),
            set: sets.map(|source| moved.edited(source)).collect(),
            files: moved.files.clone(),
        }
    }
}

/// What is gathered on the way through a document.
struct Moved<'a> {
    folder: &'a Path,
    /// Parameters of networks that are names of files.
    tables: Vec<String>,
    files: Vec<(String, PathBuf)>,
    /// What takes the place of a stretch of a source.
    edits: Vec<(Arc<Source>, Range<usize>, String)>,
}

impl Moved<'_> {
    fn learn_tables(&mut self, document: &Node) {
        let elements = document.get("element").and_then(|elements| elements.items()).unwrap_or_default();
        for element in elements {
            self.tables.extend(element::files_of(element));
            let parts = element.get("bushing").and_then(|bushing| bushing.entries()).unwrap_or_default();
            parts.iter().for_each(|part| self.tables.extend(element::files_of(&part.node)));
        }
    }

    fn visit(&mut self, node: &Node) {
        match &node.value {
            Value::Table(entries) => entries.iter().for_each(|entry| self.value(&entry.key, &entry.node)),
            Value::Array(items) => items.iter().for_each(|item| self.visit(item)),
            _ => {}
        }
    }

    /// What stands behind a key.
    fn value(&mut self, key: &str, node: &Node) {
        match node.text() {
            _ if key == FOLDERS => self.replace(node, "[]".to_owned()),
            Some(text) if FILES.contains(&key) || self.tables.iter().any(|table| table == key) => {
                if let Some(name) = self.name_of(text) {
                    self.replace(node, toml_text(&name));
                    if key == "mjcf" {
                        self.take_parts(text);
                    }
                }
            }
            _ => self.visit(node),
        }
    }

    fn replace(&mut self, node: &Node, with: String) {
        self.edits.push((node.place.source.clone(), node.place.span.clone(), with));
    }

    /// Where the file that a text leads to goes; `None` where there is none.
    fn name_of(&mut self, text: &str) -> Option<String> {
        let file = self.folder.join(text).canonicalize().ok().filter(|file| file.is_file())?;
        if let Some((name, _)) = self.files.iter().find(|(_, known)| *known == file) {
            return Some(name.clone());
        }
        let plain = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
        let own: String = file.file_name()?.to_string_lossy().chars().map(plain).collect();
        let taken = |name: &str| self.files.iter().any(|(other, _)| other == name);
        let numbered = (2..).map(|n| format!("{FOLDER}/{n}-{own}"));
        let name = [format!("{FOLDER}/{own}")].into_iter().chain(numbered).find(|name| !taken(name))?;
        self.files.push((name.clone(), file));
        Some(name)
    }

    /// Takes what a robot's file includes and its meshes that have mass along, to the same places beside it.
    fn take_parts(&mut self, text: &str) {
        let Ok(file) = self.folder.join(text).canonicalize() else { return };
        let options = DescriptionOptions { accept_inertia: true, ..DescriptionOptions::default() };
        let Ok(robot) = RobotDescription::read(&file, &options) else { return };
        for part in robot.parts.iter().filter_map(|part| part.canonicalize().ok()) {
            let Some(Ok(inside)) = file.parent().map(|folder| part.strip_prefix(folder)) else { continue };
            let steps: Vec<_> = inside.components().map(|step| step.as_os_str().to_string_lossy()).collect();
            let name = format!("{FOLDER}/{}", steps.join("/"));
            if !self.files.iter().any(|(other, _)| *other == name) {
                self.files.push((name, part));
            }
        }
    }

    fn edited(&self, source: &Arc<Source>) -> String {
        let mut text = source.text.to_string();
        let mut own: Vec<_> = self.edits.iter().filter(|(of, ..)| Arc::ptr_eq(of, source)).collect();
        own.sort_by_key(|(_, span, _)| std::cmp::Reverse(span.start));
        for (_, span, with) in own {
            text.replace_range(span.clone(), with);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn files_move_and_everything_else_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("data")).unwrap();
        for name in ["data/a.csv", "a.csv", "pad.csv", "arm.urdf", "pad"] {
            fs::write(at(name), name).unwrap();
        }
        let text = "# robot\nrobot = { urdf = 'arm.urdf', package_path = [\"/somewhere\"] }\n[[element]]\nname = \"pad\" # not the file\n\
                    network = \"table(f)\"\nparameters = { f = \"pad.csv\" }\ninputs = { u = { csv = \"\"\"data/a.csv\"\"\", column = \"u\" } }\n\
                    [motion]\ncsv = \"none.csv\"\n";
        let mut scenario = Scenario::parse(text, "a.toml", folder.path()).unwrap();
        scenario.set(&format!("motion.csv={}", at("a.csv").display())).unwrap();
        scenario.set("element.pad.u={ csv = \"data/a.csv\" }").unwrap();
        scenario.set("element.pad.f='pad.csv'").unwrap();
        let Portable { text, set, files } = scenario.portable();
        assert_eq!(
            text,
            "# robot\nrobot = { urdf = \"files/arm.urdf\", package_path = [] }\n[[element]]\nname = \"pad\" # not the file\n\
             network = \"table(f)\"\nparameters = { f = \"files/pad.csv\" }\ninputs = { u = { csv = \"files/a.csv\", column = \"u\" } }\n\
             [motion]\ncsv = \"none.csv\"\n"
        );
        assert_eq!(
            set,
            [
                "motion.csv=\"files/2-a.csv\"",
                "element.pad.u={ csv = \"files/a.csv\" }",
                "element.pad.f=\"files/pad.csv\""
            ]
        );
        let read: Vec<_> =
            files.iter().map(|(name, file)| (name.as_str(), fs::read_to_string(file).unwrap())).collect();
        let wanted = [
            ("files/arm.urdf", "arm.urdf"),
            ("files/pad.csv", "pad.csv"),
            ("files/a.csv", "data/a.csv"),
            ("files/2-a.csv", "a.csv"),
        ];
        assert_eq!(read, wanted.map(|(name, text)| (name, text.to_owned())));
    }

    #[test]
    fn what_a_robot_includes_moves_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("parts")).unwrap();
        fs::write(at("parts/limb.xml"), "<mujoco><default><geom size=\"0.1\"/></default></mujoco>").unwrap();
        let robot =
            "<mujoco><include file=\"parts/limb.xml\"/><worldbody><body><joint/><geom/></body></worldbody></mujoco>";
        fs::write(at("robot.xml"), robot).unwrap();
        let scenario = Scenario::parse("[robot]\nmjcf = \"robot.xml\"\n", "s.toml", folder.path()).unwrap();
        let names: Vec<String> = scenario.portable().files.into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["files/robot.xml", "files/parts/limb.xml"]);
    }
}
