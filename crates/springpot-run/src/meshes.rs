//! Meshes of a run: which files they are, as run.json says it, and where these are when a page is made.
//!
//! run.json holds no path of the machine: the robot's file relative to the results, meshes relative to the robot's folder. A folder of results may come
//! from a stranger, so it does not say what is read either: the robot's file is taken only while it is the very file that the run read (its mark, which
//! nobody knows who has not seen it there), and meshes are those that this file names, inside its folder and its packages.

use crate::record::{Record, RobotFile};
use springpot::model::description::{DescriptionOptions, RobotDescription, Visual, VisualShape};
use springpot_report::MeshFile;
use springpot_report::scene::{Body, Scene, Shape, Visual as Drawn};
use springpot_scenario::DescriptionPlan;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf, absolute};

/// A robot's file and the folders of its packages, as a plan has them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RobotPlace {
    file: PathBuf,
    package_path: Vec<PathBuf>,
}

impl RobotPlace {
    /// Of a robot that was read from a file.
    pub(crate) fn of(plan: &DescriptionPlan) -> Option<Self> {
        let file = plain(plan.robot.file.as_ref()?);
        // A folder is relative to the scenario, as the file is.
        let written = Path::new(&plan.written);
        let steps = written.components().filter(|part| !matches!(part, Component::CurDir)).count();
        let folder = plan.robot.file.as_ref()?.ancestors().nth(steps).filter(|_| written.is_relative());
        let folder = folder.unwrap_or(Path::new(""));
        let package_path = plan.package_path.iter().map(|path| plain(&folder.join(path))).collect();
        Some(Self { file, package_path })
    }

    /// The folder of the file.
    pub(crate) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(&self.file)
    }

    /// As run.json says it, in that folder of results.
    pub(crate) fn record(&self, results: &Path) -> Option<RobotFile> {
        // Links on the way to the results would lead elsewhere.
        let results = results.canonicalize().ok()?;
        let package_path = self.package_path.iter().map(|path| relative(&results, path)).collect();
        Some(RobotFile { file: relative(&results, &self.file), package_path, mark: mark(&self.file)? })
    }
}

/// The name of a mesh: its path from the folder of the robot, with `/` between.
pub(crate) fn name(folder: &Path, path: &Path) -> String {
    relative(folder, path)
}

/// Where the meshes of a record are, and what is to be said of those that are not drawn.
pub(crate) fn files(record: &Record, results: &Path) -> (BTreeMap<String, MeshFile>, Vec<String>) {
    let (mut files, mut notes) = (BTreeMap::new(), Vec::new());
    let wanted: BTreeSet<&str> = record.scenes.iter().flat_map(names).collect();
    if wanted.is_empty() {
        return (files, notes);
    }
    let Ok(results) = results.canonicalize() else { return (files, notes) };
    let mut base: Option<PathBuf> = None;
    for robot in &record.robots {
        let file = plain(&results.join(&robot.file));
        let base = base.get_or_insert_with(|| file.parent().map(Path::to_path_buf).unwrap_or_default());
        if mark(&file).as_deref() != Some(&robot.mark) {
            notes.push(format!(
                "meshes are not drawn: {} is not the file that the run read; run the scenario again",
                robot.file
            ));
            continue;
        }
        let package_path = robot.package_path.iter().map(|path| plain(&results.join(path))).collect();
        // What the run took is taken.
        let options = DescriptionOptions { accept_inertia: true, package_path, ..DescriptionOptions::default() };
        let Ok(urdf) = RobotDescription::read(&file, &options) else { continue };
        for visual in urdf.visuals.iter().flatten().chain(&urdf.root.visuals) {
            if let Visual { shape: VisualShape::Mesh { place: Some(place), .. }, .. } = visual {
                let file = MeshFile { path: place.path.clone(), folder: place.folder.clone() };
                files.entry(name(base, &place.path)).or_insert(file);
            }
        }
    }
    let strange: Vec<&str> = wanted.into_iter().filter(|name| !files.contains_key(*name)).collect();
    if let ([first, rest @ ..], []) = (&strange[..], &notes[..]) {
        let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        notes.push(format!(
            "{first}{more} not drawn: outside the folder of the robot and its packages, or no mesh that it names"
        ));
    }
    (files, notes)
}

/// Whether a scene has a mesh.
pub(crate) fn has_any(scene: &Scene) -> bool {
    names(scene).next().is_some()
}

fn names(scene: &Scene) -> impl Iterator<Item = &str> {
    let of_bodies = scene.bodies.iter().flat_map(|Body { visuals, .. }| visuals);
    let all = of_bodies.chain(scene.root.iter().flat_map(|root| &root.visuals));
    all.filter_map(|Drawn { shape, .. }| match shape {
        Shape::Mesh { path, .. } => Some(path.as_str()),
        _ => None,
    })
}

/// What a file has that no other has, and that who has not seen it cannot know.
fn mark(file: &Path) -> Option<String> {
    let about = fs::metadata(file).ok().filter(fs::Metadata::is_file)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        Some(format!("{}-{}-{}.{:09}", about.len(), about.ino(), about.ctime(), about.ctime_nsec()))
    }
    #[cfg(not(unix))]
    {
        let since = |time: std::io::Result<std::time::SystemTime>| {
            time.ok()?.duration_since(std::time::UNIX_EPOCH).ok().map(|since| since.as_nanos())
        };
        Some(format!("{}-{}-{}", about.len(), since(about.created())?, since(about.modified())?))
    }
}

/// The way from a folder to a file, with `/` between; both from the root.
fn relative(folder: &Path, to: &Path) -> String {
    let (folder, to) = (plain(folder), plain(to));
    let shared = folder.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(shared).map(|_| "..".into());
    let down = to.components().skip(shared).map(|part| part.as_os_str().to_string_lossy());
    up.chain(down).collect::<Vec<_>>().join("/")
}

/// A path from the root without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in absolute(path).unwrap_or_else(|_| path.to_owned()).components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn ways_from_folder_to_file() {
        for (folder, to, way) in [
            ("/a/b", "/a/b/c.stl", "c.stl"),
            ("/a/b", "/a/c/../d/e.stl", "../d/e.stl"),
            ("/a/./b", "/x", "../../x"),
            ("/", "/x", "x"),
        ] {
            assert_eq!(relative(Path::new(folder), Path::new(to)), way);
        }
    }
}
