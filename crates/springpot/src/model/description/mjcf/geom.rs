//! `<geom>`: the mass of a shape, and what it looks like.

use super::attitude::{self, placement};
use super::element::Element;
use super::error::DescriptionError;
use super::given::{Given, Reader};
use super::meshes::Meshes;
use super::problem::Owner;
use super::settings::Settings;
use crate::model::description::visual::{Visual, VisualShape};
use crate::spatial::{Inertia, Placement, Symmetric3, Vec3};
use std::collections::HashMap;
use std::f64::consts::PI;

/// Density where none is said, kg/m³.
const DENSITY: f64 = 1000.0;

/// Shapes of this group and above are not drawn.
const HIDDEN: f64 = 3.0;

/// The colour of shapes that have none.
const GREY: [f64; 4] = [0.5, 0.5, 0.5, 1.0];

/// The exponent of Thomsen's formula for the surface of an ellipsoid.
const THOMSEN: f64 = 1.6075;

const KNOWN: [&str; 28] = [
    "name",
    "class",
    "type",
    "size",
    "pos",
    "fromto",
    "mass",
    "density",
    "mesh",
    "shellinertia",
    "group",
    "rgba",
    "material",
    "contype",
    "conaffinity",
    "condim",
    "priority",
    "friction",
    "solmix",
    "solref",
    "solimp",
    "margin",
    "gap",
    "fitscale",
    "user",
    "hfield",
    "fluidshape",
    "fluidcoef",
];

const TYPES: [&str; 9] = ["plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"];

/// What a shape is, half sizes in m.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Sphere(f64),
    Capsule(f64, f64),
    Cylinder(f64, f64),
    Ellipsoid([f64; 3]),
    Box([f64; 3]),
}

/// Colours of materials by name.
pub(super) type Materials = HashMap<String, [f64; 4]>;

/// What reads shapes.
pub(super) struct Geoms<'d> {
    pub(super) settings: &'d Settings,
    pub(super) materials: &'d Materials,
    pub(super) meshes: &'d mut Meshes,
}

/// A shape on a body.
#[derive(Debug, Default)]
pub(super) struct Geom {
    /// Its mass and moments in the frame of the body, where it has some that counts.
    pub(super) inertia: Option<Inertia>,
    pub(super) visuals: Vec<Visual>,
}

impl Geoms<'_> {
    /// Reads a shape whose place is seen from `offset` in the body; its mass only where it `counts`.
    pub(super) fn read(
        &mut self,
        reader: &mut Reader<'_>,
        given: &Given<'_>,
        offset: &Placement,
        counts: bool,
    ) -> Result<Geom, DescriptionError> {
        reader.check_attributes(given.element, given.owner, &[&KNOWN, &attitude::WAYS]);
        let mesh = given.text("mesh");
        let written = given.word(reader, "type", &TYPES)?;
        let kind = written.unwrap_or(if mesh.is_some() { "mesh" } else { "sphere" });
        let group = given.number(reader, "group")?.unwrap_or(0.0);
        let counts = counts && (self.settings.groups[0]..=self.settings.groups[1]).contains(&group);
        let mut place = placement(reader, given, self.settings)?;
        let color = self.color(reader, given)?;
        if kind == "mesh" {
            let place = *offset * place;
            let Some(name) = mesh else {
                return Err(reader.refuse(given.element.at, given.owner, "is a mesh and names none"));
            };
            let visuals = if group < HIDDEN { self.mesh(reader, name, &place, color) } else { Vec::new() };
            let inertia = if counts { self.inertia_of_mesh(reader, given, name, &place)? } else { None };
            return Ok(Geom { inertia, visuals });
        }
        if ["plane", "hfield", "sdf"].contains(&kind) {
            if counts && kind == "sdf" {
                return Err(reader.refuse(
                    given.element.at,
                    given.owner,
                    "has the type \"sdf\", which is not supported",
                ));
            }
            return Ok(Geom::default());
        }
        if mesh.is_some() {
            if counts && !self.is_massless(reader, given)? {
                let why = format!("fits a {kind} to a mesh, which is not supported");
                return Err(reader.refuse(given.element.at, given.owner, why));
            }
            return Ok(Geom::default());
        }
        let shape = self.shape(reader, given, kind, &mut place)?;
        let place = *offset * place;
        let inertia = if counts { self.inertia(reader, given, shape, &place)? } else { None };
        let visuals = if group < HIDDEN { visuals(shape, &place, color) } else { Vec::new() };
        Ok(Geom { inertia, visuals })
    }

    /// The sizes of a shape; `fromto` says where it is too.
    fn shape(
        &self,
        reader: &Reader<'_>,
        given: &Given<'_>,
        kind: &str,
        place: &mut Placement,
    ) -> Result<Shape, DescriptionError> {
        let mut size = [0.0; 3];
        let written = given.numbers(reader, "size", 1..=3)?.unwrap_or_default();
        size.iter_mut().zip(&written).for_each(|(slot, size)| *slot = *size);
        let mut needed = match kind {
            "sphere" => 1,
            "capsule" | "cylinder" => 2,
            _ => 3,
        };
        if kind != "sphere"
            && let Some([a, b, c, d, e, f]) = given.array(reader, "fromto")?
        {
            let (from, to) = (Vec3([a, b, c]), Vec3([d, e, f]));
            let way = from - to;
            if way.norm() < 1e-10 {
                return Err(reader.refuse(given.element.at, given.owner, "has a fromto of no length"));
            }
            let half = 0.5 * way.norm();
            *place = Placement { rotation: attitude::along(way), translation: Vec3((from + to).0.map(|x| 0.5 * x)) };
            size = if needed == 2 { [size[0], half, 0.0] } else { [size[0], size[0], half] };
            needed = 1;
        }
        if written.len() < needed || size[..needed].iter().any(|size| *size <= 0.0) {
            let why = format!("is a {kind} and needs {needed} positive numbers of size");
            return Err(reader.refuse(given.element.at, given.owner, why));
        }
        Ok(match kind {
            "sphere" => Shape::Sphere(size[0]),
            "capsule" => Shape::Capsule(size[0], size[1]),
            "cylinder" => Shape::Cylinder(size[0], size[1]),
            "ellipsoid" => Shape::Ellipsoid(size),
            _ => Shape::Box(size),
        })
    }

    fn is_massless(&self, reader: &Reader<'_>, given: &Given<'_>) -> Result<bool, DescriptionError> {
        let mass = given.number(reader, "mass")?;
        Ok(mass.or(given.number(reader, "density")?.filter(|_| mass.is_none())) == Some(0.0))
    }

    /// The mass of a shape of this size, m³ or m², kg; `None` where it has none.
    fn mass(&self, reader: &Reader<'_>, given: &Given<'_>, size: f64) -> Result<Option<f64>, DescriptionError> {
        let mass = match given.attribute("mass") {
            Some(_) => given.not_negative(reader, "mass")?,
            None if given.attribute("density").is_some() => given.not_negative(reader, "density")? * size,
            None => DENSITY * size,
        };
        Ok((mass > 0.0).then_some(mass))
    }

    fn inertia(
        &self,
        reader: &Reader<'_>,
        given: &Given<'_>,
        shape: Shape,
        place: &Placement,
    ) -> Result<Option<Inertia>, DescriptionError> {
        let is_shell = given.flag(reader, "shellinertia")? == Some(true);
        let (size, moments) = if is_shell { shape.shell() } else { shape.solid() };
        let Some(mass) = self.mass(reader, given, size)? else { return Ok(None) };
        let [xx, yy, zz] = moments.map(|moment| mass * moment);
        let central = Symmetric3 { xx, yy, zz, ..Symmetric3::ZERO };
        Ok(Some(Inertia::from_central(mass, Vec3::ZERO, central).to_parent(place)))
    }

    fn inertia_of_mesh(
        &mut self,
        reader: &mut Reader<'_>,
        given: &Given<'_>,
        name: &str,
        place: &Placement,
    ) -> Result<Option<Inertia>, DescriptionError> {
        if self.is_massless(reader, given)? {
            return Ok(None);
        }
        if given.flag(reader, "shellinertia")? == Some(true) {
            return Err(reader.refuse(given.element.at, given.owner, "is the shell of a mesh, which is not supported"));
        }
        let solid = self.meshes.solid(reader, name, (given.element.at, given.owner))?;
        let Some(mass) = self.mass(reader, given, solid.volume)? else { return Ok(None) };
        let density = mass / solid.volume;
        let Symmetric3 { xx, yy, zz, xy, xz, yz } = solid.moments;
        let [xx, yy, zz, xy, xz, yz] = [xx, yy, zz, xy, xz, yz].map(|moment| density * moment);
        let central = Symmetric3 { xx, yy, zz, xy, xz, yz };
        Ok(Some(Inertia::from_central(mass, solid.centre, central).to_parent(place)))
    }

    fn mesh(&mut self, reader: &mut Reader<'_>, name: &str, place: &Placement, color: [f64; 4]) -> Vec<Visual> {
        let Some((file, found, scale)) = self.meshes.file(reader, name) else { return Vec::new() };
        vec![visual(VisualShape::Mesh { file, place: found, scale }, place, [0.0; 3], color)]
    }

    /// A colour of its own before that of its material.
    fn color(&self, reader: &Reader<'_>, given: &Given<'_>) -> Result<[f64; 4], DescriptionError> {
        let own = given.array(reader, "rgba")?.filter(|color| *color != GREY);
        let of_material = || self.materials.get(given.text("material")?).copied();
        Ok(own.or_else(of_material).unwrap_or(GREY))
    }
}

/// Colours of the materials of a file.
pub(super) fn materials(
    reader: &Reader<'_>,
    root: &Element,
    classes: &super::classes::Classes,
) -> Result<Materials, DescriptionError> {
    let owner = Owner::Mujoco;
    let mut colors = Materials::new();
    for element in root.all("asset").flat_map(|asset| asset.all("material")) {
        let Some(name) = element.text("name") else { continue };
        let class = classes.find(reader, element.text("class"), "material", (element.at, &owner))?;
        let color = Given { element, class, owner: &owner }.array(reader, "rgba")?;
        colors.insert(name.to_owned(), color.unwrap_or([1.0; 4]));
    }
    Ok(colors)
}

impl Shape {
    /// Volume, m³, and principal moments of a mass of 1, m².
    fn solid(self) -> (f64, [f64; 3]) {
        match self {
            Self::Sphere(r) => (4.0 / 3.0 * PI * r.powi(3), [0.4 * r * r; 3]),
            Self::Capsule(r, half) => {
                let h = 2.0 * half;
                let volume = PI * r * r * (h + 4.0 / 3.0 * r);
                let ball = 4.0 * r / (4.0 * r + 3.0 * h);
                let tube = 1.0 - ball;
                let across = tube * (3.0 * r * r + h * h) / 12.0 + ball * (0.4 * r * r + h * (3.0 * r + 2.0 * h) / 8.0);
                (volume, [across, across, tube * r * r / 2.0 + ball * 0.4 * r * r])
            }
            Self::Cylinder(r, half) => {
                let h = 2.0 * half;
                let across = (3.0 * r * r + h * h) / 12.0;
                (PI * r * r * h, [across, across, r * r / 2.0])
            }
            Self::Ellipsoid([a, b, c]) => {
                let [a2, b2, c2] = [a, b, c].map(|x| x * x / 5.0);
                (4.0 / 3.0 * PI * a * b * c, [b2 + c2, a2 + c2, a2 + b2])
            }
            Self::Box([a, b, c]) => {
                let [a2, b2, c2] = [a, b, c].map(|x| x * x / 3.0);
                (8.0 * a * b * c, [b2 + c2, a2 + c2, a2 + b2])
            }
        }
    }

    /// Surface, m², and principal moments of a mass of 1 spread over it, m²; over that of an ellipsoid as if it grew by the same thickness
    /// along each axis, its surface by Thomsen's formula.
    fn shell(self) -> (f64, [f64; 3]) {
        match self {
            Self::Sphere(r) => (4.0 * PI * r * r, [2.0 / 3.0 * r * r; 3]),
            Self::Capsule(r, half) => {
                let h = 2.0 * half;
                let [ball, tube] = [4.0 * PI * r * r, 2.0 * PI * r * h];
                let area = ball + tube;
                let [ball, tube] = [ball / area, tube / area];
                // Half shells of spheres, whose centres are r/2 off the ends.
                let (off, end) = (r / 2.0, half + r / 2.0);
                let across = tube * (6.0 * r * r + h * h) / 12.0 + ball * (2.0 / 3.0 * r * r + end * end - off * off);
                (area, [across, across, tube * r * r + ball * 2.0 / 3.0 * r * r])
            }
            Self::Cylinder(r, half) => {
                let h = 2.0 * half;
                let [disks, tube] = [2.0 * PI * r * r, 2.0 * PI * r * h];
                let area = disks + tube;
                let [disks, tube] = [disks / area, tube / area];
                let across = tube * (6.0 * r * r + h * h) / 12.0 + disks * (r * r / 4.0 + half * half);
                (area, [across, across, tube * r * r + disks * r * r / 2.0])
            }
            Self::Ellipsoid([a, b, c]) => {
                let sum = [a * b, b * c, c * a].map(|x| x.powf(THOMSEN)).iter().sum::<f64>() / 3.0;
                let grows = a * b + b * c + c * a;
                // d(a b c (b² + c²)/5) over d(a b c).
                let about = |x: f64, y: f64| {
                    let volume = a * b * c;
                    (grows * (x * x + y * y) + 2.0 * volume * (x + y)) / (5.0 * grows)
                };
                (4.0 * PI * sum.powf(1.0 / THOMSEN), [about(b, c), about(a, c), about(a, b)])
            }
            Self::Box(half) => {
                let [a, b, c] = half;
                let faces = [b * c, a * c, a * b].map(|face| 8.0 * face);
                let area = faces.iter().sum::<f64>();
                // ∫x² over the surface: pairs of faces at ±x, and four that reach from one to the other.
                let squares = [0, 1, 2].map(|k| {
                    let others = area - faces[k];
                    half[k] * half[k] * (faces[k] + others / 3.0) / area
                });
                let [x, y, z] = squares;
                (area, [y + z, x + z, x + y])
            }
        }
    }
}

fn visual(shape: VisualShape, place: &Placement, along: [f64; 3], color: [f64; 4]) -> Visual {
    Visual { origin: place.point(Vec3(along)).0, rpy: attitude::rpy(&place.rotation), color: Some(color), shape }
}

/// A capsule is a cylinder between two balls.
fn visuals(shape: Shape, place: &Placement, color: [f64; 4]) -> Vec<Visual> {
    let one = |shape| vec![visual(shape, place, [0.0; 3], color)];
    match shape {
        Shape::Sphere(radius) => one(VisualShape::Sphere { radius }),
        Shape::Cylinder(radius, half) => one(VisualShape::Cylinder { radius, length: 2.0 * half }),
        Shape::Box(half) => one(VisualShape::Box(half.map(|half| 2.0 * half))),
        Shape::Ellipsoid(radii) => one(VisualShape::Ellipsoid(radii)),
        Shape::Capsule(radius, half) => {
            let ball = |z: f64| visual(VisualShape::Sphere { radius }, place, [0.0, 0.0, z], color);
            let tube = visual(VisualShape::Cylinder { radius, length: 2.0 * half }, place, [0.0; 3], color);
            vec![tube, ball(-half), ball(half)]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Shape;

    /// Moments by sums over points: of a solid over a grid, of a shell as what a solid that grows gains.
    #[test]
    fn moments_are_integrals() {
        let shapes = [
            Shape::Sphere(0.7),
            Shape::Capsule(0.4, 0.6),
            Shape::Cylinder(0.5, 0.8),
            Shape::Ellipsoid([0.4, 0.7, 0.9]),
            Shape::Box([0.3, 0.5, 0.8]),
        ];
        let e = 1e-5;
        let grown = |shape: Shape, e: f64| match shape {
            Shape::Sphere(r) => Shape::Sphere(r + e),
            Shape::Capsule(r, half) => Shape::Capsule(r + e, half),
            Shape::Cylinder(r, half) => Shape::Cylinder(r + e, half + e),
            Shape::Ellipsoid(radii) => Shape::Ellipsoid(radii.map(|r| r + e)),
            Shape::Box(half) => Shape::Box(half.map(|half| half + e)),
        };
        for shape in shapes {
            let (less, more) = (shape.solid().0, grown(shape, e).solid().0);
            let (area, shell) = shape.shell();
            for k in 0..3 {
                let gained = more * grown(shape, e).solid().1[k] - less * shape.solid().1[k];
                let wanted = gained / (more - less);
                assert!((shell[k] / wanted - 1.0).abs() < 1e-4, "{shape:?} {k}: {} {wanted}", shell[k]);
            }
            let gained = (more - less) / e;
            // Of an ellipsoid both are approximations.
            let near = if matches!(shape, Shape::Ellipsoid(_)) { 0.05 } else { 1e-3 };
            assert!((area / gained - 1.0).abs() < near, "{shape:?}: {area} {gained}");
        }
        let n = 60;
        for (shape, inside) in [
            (
                shapes[1],
                (|x: f64, y: f64, z: f64| x.hypot(y).hypot((z.abs() - 0.6).max(0.0)) < 0.4)
                    as fn(f64, f64, f64) -> bool,
            ),
            (shapes[2], |x, y, z| x.hypot(y) < 0.5 && z.abs() < 0.8),
            (shapes[3], |x, y, z| (x / 0.4).hypot(y / 0.7).hypot(z / 0.9) < 1.0),
        ] {
            let (mut count, mut sums) = (0.0, [0.0; 3]);
            let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
            for (i, j, k) in (-n..n).flat_map(|i| (-n..n).flat_map(move |j| (-n..n).map(move |k| (i, j, k)))) {
                let [x, y, z] = [at(i), at(j), at(k)];
                if inside(x, y, z) {
                    count += 1.0;
                    sums = [sums[0] + y * y + z * z, sums[1] + x * x + z * z, sums[2] + x * x + y * y];
                }
            }
            let (volume, moments) = shape.solid();
            assert!((volume * f64::from(n).powi(3) / count - 1.0).abs() < 0.01, "{shape:?}");
            for k in 0..3 {
                assert!((moments[k] / (sums[k] / count) - 1.0).abs() < 0.01, "{shape:?} {k}");
            }
        }
    }
}
