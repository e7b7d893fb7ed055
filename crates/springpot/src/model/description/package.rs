//! Where the files are that a URDF file names.

use std::collections::HashMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Longest package.xml that is read, bytes.
const MAX_MANIFEST: u64 = 1 << 20;

/// Finds files by `package://NAME/rest`, `file://` and plain paths.
///
/// Package NAME is looked for, in this order:
/// 1. in the ancestors of the URDF file, the nearest first: the ancestor itself, where it is called NAME or its
///    `package.xml` says so, then its folder NAME; more than three folders above that of the file, only what holds a `package.xml`;
/// 2. in the folders of `package_path`: the folder itself, in the same way, then its folder NAME.
///
/// A file is taken inside its package alone, links followed; one by a plain path or `file://` inside the folder of the
/// URDF file, above it where it is called `urdf`, inside the nearest ancestor with a `package.xml`, or inside a folder
/// of `package_path`. Robots come from strangers: what else is on the machine is none of theirs.
///
/// The environment (`ROS_PACKAGE_PATH`) is not read: the same files give the same answer everywhere. `model://` is
/// read as `package://`.
#[derive(Debug)]
pub(super) struct Packages {
    /// Folder of the URDF file.
    home: PathBuf,
    /// Folders that are packages or hold some.
    places: Vec<Place>,
    /// Folders that hold the files of plain paths.
    own: Vec<PathBuf>,
    /// The folders of every package asked for.
    folders: HashMap<String, Vec<PathBuf>>,
    /// What was found.
    found: HashMap<String, Found>,
}

/// A folder that is a package or holds some.
#[derive(Debug)]
struct Place {
    folder: PathBuf,
    /// The name that its `package.xml` gives.
    manifest: Option<String>,
    /// Whether packages in it need no `package.xml`.
    is_near: bool,
}

/// Whether a file is there.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Found {
    At(MeshPlace),
    /// In the network, where nothing is looked up.
    Elsewhere,
    /// Not in the folder of the robot and not in its package; whether it is there is not looked at.
    Outside,
    Nowhere,
}

/// Where a file of a robot is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshPlace {
    /// The file.
    pub path: PathBuf,
    /// The folder of the robot, or the package, that holds it.
    pub folder: PathBuf,
}

/// Folders above that of the URDF file in which a package needs no `package.xml`.
const NEAR: usize = 3;

impl Packages {
    /// For the URDF file `urdf`.
    pub(super) fn of(urdf: &Path, package_path: &[PathBuf]) -> Self {
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        let home = plain(&absolute(urdf)).parent().map(Path::to_path_buf).unwrap_or_default();
        let place = |folder: PathBuf, is_near| Place { manifest: manifest_name(&folder), folder, is_near };
        let above = home.ancestors().enumerate().filter(|(_, folder)| folder.parent().is_some());
        let above = above.map(|(steps, folder)| place(folder.to_path_buf(), steps <= NEAR));
        let given: Vec<PathBuf> = package_path.iter().map(|path| plain(&absolute(path))).collect();
        let places: Vec<Place> = above.chain(given.iter().map(|folder| place(folder.clone(), true))).collect();
        let package = places.iter().find(|place| place.manifest.is_some() && home.starts_with(&place.folder));
        let of_urdf = home.parent().filter(|_| home.file_name().is_some_and(|name| name == "urdf"));
        let own = [Some(home.as_path()), of_urdf, package.map(|package| package.folder.as_path())];
        let own = own.into_iter().flatten().map(Path::to_path_buf).chain(given.iter().cloned()).collect();
        Self { home, places, own, folders: HashMap::new(), found: HashMap::new() }
    }

    /// Where the file named `name` is.
    pub(super) fn find(&mut self, name: &str) -> Found {
        if let Some(found) = self.found.get(name) {
            return found.clone();
        }
        let found = self.look_for(name);
        self.found.insert(name.to_owned(), found.clone());
        found
    }

    fn look_for(&mut self, name: &str) -> Found {
        let Some((scheme, rest)) = name.split_once("://") else { return self.own_file(name) };
        match scheme {
            "package" | "model" => {
                let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
                let path = path.trim_start_matches('/');
                if [".", ".."].contains(&package) {
                    return Found::Outside;
                }
                let all = self.folders_of(package).iter().map(|folder| inside(&folder.join(path), folder));
                first_of(all)
            }
            "file" => self.own_file(rest),
            _ => Found::Elsewhere,
        }
    }

    /// A file by its path from that of the robot.
    fn own_file(&self, path: &str) -> Found {
        first_of(self.own.iter().map(|folder| inside(&self.home.join(path), folder)))
    }

    fn folders_of(&mut self, package: &str) -> &[PathBuf] {
        let places = &self.places;
        self.folders.entry(package.to_owned()).or_insert_with(|| {
            let candidates = places.iter().flat_map(|Place { folder, manifest, is_near }| {
                let is_called_so = *is_near && folder.file_name().is_some_and(|name| name == package);
                let is_package = is_called_so || manifest.as_deref().is_some_and(|name| name == package);
                let inside = folder.join(package);
                let is_whole = *is_near || inside.join("package.xml").is_file();
                let holds_it = !package.is_empty() && is_whole && inside.is_dir();
                is_package.then(|| folder.clone()).into_iter().chain(holds_it.then_some(inside))
            });
            candidates.collect()
        })
    }
}

/// The first file that is there; else one that is outside, so that it is told.
fn first_of(all: impl Iterator<Item = Found>) -> Found {
    let mut best = Found::Nowhere;
    let mut outside = true;
    for found in all {
        if matches!(found, Found::At(_)) {
            return found;
        }
        // Inside one of the folders and not there: it is missing.
        outside &= found == Found::Outside;
        best = if outside { Found::Outside } else { Found::Nowhere };
    }
    best
}

/// A file, if it is inside a folder, links followed.
fn inside(path: &Path, folder: &Path) -> Found {
    let path = plain(path);
    if !path.starts_with(plain(folder)) {
        return Found::Outside;
    }
    if !path.is_file() {
        return Found::Nowhere;
    }
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(own), Ok(whole)) if own.starts_with(&whole) => Found::At(MeshPlace { path, folder: folder.to_path_buf() }),
        _ => Found::Outside,
    }
}

/// A path without `.` and `..`, by its words alone.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

/// The name in the `package.xml` of a folder.
fn manifest_name(folder: &Path) -> Option<String> {
    let path = folder.join("package.xml");
    let about = fs::metadata(&path).ok()?;
    if !about.is_file() || about.len() > MAX_MANIFEST {
        return None;
    }
    let text = fs::read_to_string(path).ok()?;
    let document = roxmltree::Document::parse(&text).ok()?;
    let name = document.root_element().children().find(|node| node.has_tag_name("name"))?;
    Some(name.text()?.trim().to_owned())
}
