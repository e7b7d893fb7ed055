//! `<compiler>` and `<option>`: what holds for the whole file.

use super::element::Element;
use super::error::DescriptionError;
use super::given::{Given, Reader};
use super::problem::Owner;
use super::warning::DescriptionWarningKind;

/// What a file says of itself.
#[derive(Debug)]
pub(super) struct Settings {
    /// Whether angles are in degrees.
    pub(super) degrees: bool,
    /// Axes of Euler angles: 'x' about the axes as they turn, 'X' about those that stand still.
    pub(super) sequence: [char; 3],
    /// Whether a range by itself is a limit.
    pub(super) limits_by_range: bool,
    /// Whether masses follow from shapes; `None`: where no `<inertial>` is.
    pub(super) from_shapes: Option<bool>,
    /// Groups of shapes that have mass.
    pub(super) groups: [f64; 2],
    /// Least mass, kg, and least principal moment, kg·m², of every body.
    pub(super) least: [f64; 2],
    /// Whether moments that no distribution of mass has become their mean.
    pub(super) balances: bool,
    /// Mass of all bodies together, kg.
    pub(super) total_mass: Option<f64>,
    /// Folder of the meshes.
    pub(super) mesh_folder: String,
    /// Whether meshes are looked for by their last name alone.
    pub(super) strips_paths: bool,
    /// m/s².
    pub(super) gravity: Option<[f64; 3]>,
}

/// Attributes of `<compiler>` that concern nothing that is read.
const OTHER: [&str; 8] = [
    "texturedir",
    "usethread",
    "discardvisual",
    "fusestatic",
    "convexhull",
    "exactmeshinertia",
    "saveinertial",
    "conflict",
];
const USED: [&str; 15] = [
    "angle",
    "eulerseq",
    "autolimits",
    "inertiafromgeom",
    "inertiagrouprange",
    "boundmass",
    "boundinertia",
    "settotalmass",
    "balanceinertia",
    "meshdir",
    "assetdir",
    "strippath",
    "fitaabb",
    "coordinate",
    "alignfree",
];

impl Settings {
    /// Of all `<compiler>` and `<option>`, later ones before earlier ones.
    pub(super) fn of(reader: &mut Reader<'_>, root: &Element) -> Result<Self, DescriptionError> {
        let mut settings = Self {
            degrees: true,
            sequence: ['x', 'y', 'z'],
            limits_by_range: true,
            from_shapes: None,
            groups: [0.0, 5.0],
            least: [0.0; 2],
            balances: false,
            total_mass: None,
            mesh_folder: String::new(),
            strips_paths: false,
            gravity: None,
        };
        for compiler in root.all("compiler") {
            settings.take_compiler(reader, compiler)?;
        }
        for option in root.all("option") {
            settings.take_option(reader, option)?;
        }
        if root.all("option").flat_map(|option| option.all("flag")).any(|flag| flag.text("gravity") == Some("disable"))
        {
            settings.gravity = Some([0.0; 3]);
        }
        Ok(settings)
    }

    fn take_compiler(&mut self, reader: &mut Reader<'_>, compiler: &Element) -> Result<(), DescriptionError> {
        let owner = Owner::Mujoco;
        reader.check_attributes(compiler, &owner, &[&USED, &OTHER]);
        let given = Given::alone(compiler, &owner);
        let refuse = |reader: &Reader<'_>, why: &str| Err(reader.refuse(compiler.at, &owner, why));
        if given.flag(reader, "fitaabb")? == Some(true) {
            return refuse(reader, "fitaabb of <compiler> fits shapes to meshes, which is not supported");
        }
        if given.word(reader, "coordinate", &["local", "global"])? == Some("global") {
            return refuse(
                reader,
                "coordinate=\"global\" of <compiler> is not supported, nor is it in MuJoCo any more",
            );
        }
        if given.flag(reader, "alignfree")? == Some(true) {
            return refuse(reader, "alignfree of <compiler> moves the frames of bodies, which is not supported");
        }
        if let Some(word) = given.word(reader, "angle", &["degree", "radian"])? {
            self.degrees = word == "degree";
        }
        if let Some(attribute) = given.attribute("eulerseq") {
            let letters: Vec<char> = attribute.value.trim().chars().collect();
            let axes = <[char; 3]>::try_from(letters).ok().filter(|axes| axes.iter().all(|c| "xyzXYZ".contains(*c)));
            let Some(axes) = axes else {
                let why = "eulerseq of <compiler> is three letters of x, y, z, X, Y, Z";
                return Err(reader.refuse(attribute.at, &owner, why));
            };
            self.sequence = axes;
        }
        if let Some(flag) = given.flag(reader, "autolimits")? {
            self.limits_by_range = flag;
        }
        if let Some(word) = given.word(reader, "inertiafromgeom", &["true", "false", "auto"])? {
            self.from_shapes = (word != "auto").then_some(word == "true");
        }
        self.groups = given.array(reader, "inertiagrouprange")?.unwrap_or(self.groups);
        for (k, name) in ["boundmass", "boundinertia"].into_iter().enumerate() {
            if given.attribute(name).is_some() {
                self.least[k] = given.not_negative(reader, name)?;
            }
        }
        if let Some(mass) = given.number(reader, "settotalmass")? {
            self.total_mass = (mass > 0.0).then_some(mass);
        }
        if let Some(flag) = given.flag(reader, "balanceinertia")? {
            self.balances = flag;
        }
        if let Some(folder) = given.text("meshdir").or(given.text("assetdir")) {
            folder.clone_into(&mut self.mesh_folder);
        }
        if let Some(flag) = given.flag(reader, "strippath")? {
            self.strips_paths = flag;
        }
        Ok(())
    }

    fn take_option(&mut self, reader: &mut Reader<'_>, option: &Element) -> Result<(), DescriptionError> {
        let owner = Owner::Mujoco;
        let given = Given::alone(option, &owner);
        if let Some(gravity) = given.array(reader, "gravity")? {
            self.gravity = Some(gravity);
        }
        for name in ["density", "viscosity", "wind"] {
            let numbers = given.numbers(reader, name, 1..=3)?.unwrap_or_default();
            if numbers.iter().any(|number| *number != 0.0) {
                let what = format!("{name} of <option>");
                reader.warn(DescriptionWarningKind::InSimulator, &owner, option.at, what);
            }
        }
        Ok(())
    }

    /// An angle of the file, rad.
    pub(super) fn angle(&self, angle: f64) -> f64 {
        if self.degrees { angle.to_radians() } else { angle }
    }
}
