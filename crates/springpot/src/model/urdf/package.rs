//! Where the files are that a URDF file names.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Longest package.xml that is read, bytes.
const MAX_MANIFEST: u64 = 1 << 20;

/// Finds files by `package://NAME/rest`, `file://` and plain paths.
///
/// Package NAME is looked for, in this order:
/// 1. in the ancestors of the URDF file, the nearest first: the ancestor itself, where it is called NAME or its
///    `package.xml` says so, then its folder NAME;
/// 2. in the folders of `package_path`: the folder itself, in the same way, then its folder NAME.
///
/// The environment (`ROS_PACKAGE_PATH`) is not read: the same files give the same answer everywhere. `model://` is
/// read as `package://`.
#[derive(Debug)]
pub(super) struct Packages {
    /// Folder of the URDF file.
    home: PathBuf,
    /// Folders that are packages or hold some, with the name that their `package.xml` gives.
    places: Vec<(PathBuf, Option<String>)>,
    /// The folders of every package asked for.
    folders: HashMap<String, Vec<PathBuf>>,
    /// What was found.
    found: HashMap<String, Found>,
}

/// Whether a file is there.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Found {
    At(PathBuf),
    /// In the network, where nothing is looked up.
    Elsewhere,
    Nowhere,
}

impl Packages {
    /// For the URDF file `urdf`.
    pub(super) fn of(urdf: &Path, package_path: &[PathBuf]) -> Self {
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        let home = absolute(urdf).parent().map(Path::to_path_buf).unwrap_or_default();
        let folders = home.ancestors().map(Path::to_path_buf).chain(package_path.iter().map(|path| absolute(path)));
        let places = folders.map(|folder| (folder.clone(), manifest_name(&folder))).collect();
        Self { home, places, folders: HashMap::new(), found: HashMap::new() }
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
        let file = |path: PathBuf| if path.is_file() { Found::At(path) } else { Found::Nowhere };
        let Some((scheme, rest)) = name.split_once("://") else { return file(self.home.join(name)) };
        match scheme {
            "package" | "model" => {
                let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
                let path = path.trim_start_matches('/');
                let candidates = self.folders_of(package).iter().map(|folder| file(folder.join(path)));
                candidates.into_iter().find(|found| *found != Found::Nowhere).unwrap_or(Found::Nowhere)
            }
            "file" => file(self.home.join(rest)),
            _ => Found::Elsewhere,
        }
    }

    fn folders_of(&mut self, package: &str) -> &[PathBuf] {
        let places = &self.places;
        self.folders.entry(package.to_owned()).or_insert_with(|| {
            let candidates = places.iter().flat_map(|(folder, manifest)| {
                let is_package = folder.file_name().is_some_and(|name| name == package)
                    || manifest.as_deref().is_some_and(|name| name == package);
                let inside = folder.join(package);
                let holds_it = !package.is_empty() && inside.is_dir();
                is_package.then(|| folder.clone()).into_iter().chain(holds_it.then_some(inside))
            });
            candidates.collect()
        })
    }
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
