//! `<mesh>` of `<asset>`.

use super::classes::Classes;
use super::element::{At, Element};
use super::error::DescriptionError;
use super::given::{Given, Reader};
use super::package::{Found, MeshPlace, Packages};
use super::problem::Owner;
use super::settings::Settings;
use super::triangles::{Solid, Triangles};
use super::warning::DescriptionWarningKind;
use crate::spatial::{Rotation, Vec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

const KNOWN: [&str; 18] = [
    "name",
    "class",
    "content_type",
    "file",
    "vertex",
    "normal",
    "texcoord",
    "face",
    "refpos",
    "refquat",
    "scale",
    "smoothnormal",
    "maxhullvert",
    "inertia",
    "builtin",
    "params",
    "material",
    "octree_maxdepth",
];

/// A mesh of the file.
#[derive(Debug)]
struct Asset {
    at: At,
    /// Path from the folder of the robot; none where its numbers stand in the file itself.
    file: Option<String>,
    scale: [f64; 3],
    /// What is taken off its corners, and how they are turned then.
    from: Vec3,
    turned: Rotation,
    /// What the file asks of its mass.
    asked: Option<&'static str>,
}

/// The meshes by name, and what was found of them.
#[derive(Debug)]
pub(super) struct Meshes {
    assets: BTreeMap<String, Asset>,
    solids: BTreeMap<String, Solid>,
    packages: Option<Packages>,
    /// Files that were told to be missing.
    told: BTreeSet<String>,
    /// Files that masses follow from.
    read: Vec<PathBuf>,
    is_told_of_exact: bool,
}

impl Meshes {
    pub(super) fn of(
        reader: &mut Reader<'_>,
        root: &Element,
        classes: &Classes,
        settings: &Settings,
        packages: Option<Packages>,
    ) -> Result<Self, DescriptionError> {
        let mut assets = BTreeMap::new();
        for element in root.all("asset").flat_map(|asset| asset.all("mesh")) {
            let file = element.text("file").map(|file| settings.mesh_path(file));
            let stem = file.as_deref().and_then(|file| Path::new(file).file_stem()?.to_str());
            let Some(name) = element.text("name").or(stem).map(str::to_owned) else { continue };
            let owner = Owner::Mesh(name.clone());
            reader.check_attributes(element, &owner, &[&KNOWN]);
            let class = classes.find(reader, element.text("class"), "mesh", (element.at, &owner))?;
            let given = Given { element, class, owner: &owner };
            let [w, x, y, z] = given.array(reader, "refquat")?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
            let norm = (w * w + x * x + y * y + z * z).sqrt();
            let asset = Asset {
                at: element.at,
                file: file.filter(|_| element.attribute("vertex").is_none() && element.attribute("builtin").is_none()),
                scale: given.array(reader, "scale")?.unwrap_or([1.0; 3]),
                from: given.array(reader, "refpos")?.map_or(Vec3::ZERO, Vec3),
                turned: Rotation::from_quaternion_components([x, y, z, w].map(|c| c / norm)).transpose(),
                asked: given.word(reader, "inertia", &["convex", "exact", "legacy", "shell"])?,
            };
            assets.insert(name, asset);
        }
        Ok(Self {
            assets,
            solids: BTreeMap::new(),
            packages,
            told: BTreeSet::new(),
            read: Vec::new(),
            is_told_of_exact: false,
        })
    }

    /// The file of a mesh for those who draw it: as it is named, where it is, factors along its axes.
    pub(super) fn file(
        &mut self,
        reader: &mut Reader<'_>,
        name: &str,
    ) -> Option<(String, Option<MeshPlace>, [f64; 3])> {
        let asset = self.assets.get(name)?;
        let file = asset.file.clone()?;
        let place = match self.packages.as_mut()?.find(&file) {
            Found::At(place) => Some(place),
            found => {
                if self.told.insert(file.clone()) {
                    let kind = match found {
                        Found::Outside => DescriptionWarningKind::MeshOutside,
                        _ => DescriptionWarningKind::MeshNotFound,
                    };
                    reader.warn(kind, &Owner::Mesh(name.to_owned()), asset.at, file.clone());
                }
                None
            }
        };
        Some((file, place, asset.scale))
    }

    /// Files that masses follow from.
    pub(super) fn read(&self) -> impl Iterator<Item = &PathBuf> {
        self.read.iter()
    }

    /// What a mesh encloses, of a shape that takes its mass from it.
    pub(super) fn solid(
        &mut self,
        reader: &mut Reader<'_>,
        name: &str,
        (at, owner): (At, &Owner),
    ) -> Result<Solid, DescriptionError> {
        if let Some(solid) = self.solids.get(name) {
            return Ok(*solid);
        }
        let Some(asset) = self.assets.get(name) else {
            return Err(reader.refuse(at, owner, format!("names the mesh {name:?}, and there is none")));
        };
        let refuse = |why: String| reader.refuse(at, owner, format!("takes its mass from mesh {name:?}, {why}"));
        let Some(file) = &asset.file else {
            return Err(refuse("which is no file; only meshes from files have mass here".to_owned()));
        };
        if let Some(kind @ ("convex" | "shell")) = asset.asked {
            return Err(refuse(format!("whose inertia=\"{kind}\" is not supported; \"exact\" is")));
        }
        let found = self.packages.as_mut().map_or(Found::Nowhere, |packages| packages.find(file));
        let place = match found {
            Found::At(place) => place,
            Found::Outside => {
                return Err(refuse(format!(
                    "and its file {file:?} is outside the folder of the robot and its packages (package_path)"
                )));
            }
            Found::Nowhere | Found::Elsewhere => return Err(refuse(format!("and its file {file:?} is not found"))),
        };
        let wrong = |why: String| refuse(format!("and its file {file:?} {why}"));
        let mut triangles = Triangles::read(&place.path).map_err(wrong)?;
        triangles.map(|corner| {
            let turned = asset.turned * (Vec3(corner) - asset.from);
            [0, 1, 2].map(|k| turned.0[k] * asset.scale[k])
        });
        let solid = triangles.solid().map_err(wrong)?;
        if asset.asked == Some("legacy") && !self.is_told_of_exact {
            self.is_told_of_exact = true;
            let what = "inertia=\"legacy\" of <mesh>, exact volumes are taken";
            reader.warn(DescriptionWarningKind::InSimulator, &Owner::Mesh(name.to_owned()), asset.at, what);
        }
        self.solids.insert(name.to_owned(), solid);
        self.read.push(place.path);
        Ok(solid)
    }
}

impl Settings {
    /// The path of a mesh from the folder of the robot.
    fn mesh_path(&self, file: &str) -> String {
        let file = if self.strips_paths { file.rsplit(['/', '\\']).next().unwrap_or(file) } else { file };
        match self.mesh_folder.trim_end_matches('/') {
            _ if Path::new(file).is_absolute() => file.to_owned(),
            "" if self.mesh_folder.is_empty() => file.to_owned(),
            folder => format!("{folder}/{file}"),
        }
    }
}
