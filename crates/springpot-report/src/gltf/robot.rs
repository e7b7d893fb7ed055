//! What bodies look like: their own shapes, or bars from joint to joint and to their centre of mass.

use super::document::Document;
use super::paint::{self, Paint};
use super::solid::{self, Solid};
use crate::mesh::Part;
use crate::scene::{Body, Freedom, Placement, Scene, SceneShape, Shape, Visual};
use crate::surface;
use crate::vector::{difference, norm};
use std::collections::HashMap;

/// Parts of round things around their axis.
const ROUND: usize = 24;
const ZERO: [f64; 3] = [0.0; 3];

/// Solids by their material.
#[derive(Debug, Default)]
pub(super) struct Parts(pub(super) Vec<(usize, Solid)>);

impl Parts {
    fn add(&mut self, material: usize, solid: Solid) {
        match self.0.iter_mut().find(|(known, _)| *known == material) {
            Some((_, whole)) => whole.extend(solid),
            None => self.0.push((material, solid)),
        }
    }

    /// A round bar from point to point.
    fn bar(&mut self, material: usize, a: [f64; 3], b: [f64; 3], radius: f64) {
        let along = difference(b, a);
        let placement = Placement { turn: solid::from_z(along), shift: a };
        self.add(material, Solid::rounded(radius, norm(along), ROUND).placed(&placement));
    }

    fn ball(&mut self, material: usize, at: [f64; 3], radius: f64) {
        self.add(material, Solid::sphere(radius, ROUND).placed(&Placement { shift: at, ..Placement::IDENTITY }));
    }

    /// A flat-ended bar about its middle.
    fn rod(&mut self, material: usize, axis: [f64; 3], half: f64, radius: f64) {
        let placement = Placement { turn: solid::from_z(axis), shift: ZERO };
        let centred = Placement { shift: [0.0, 0.0, -half], ..Placement::IDENTITY };
        self.add(material, Solid::cylinder(radius, 2.0 * half, ROUND).placed(&placement.of(&centred)));
    }

    /// How far they surround an axis through the origin.
    pub(super) fn reach(&self, axis: [f64; 3]) -> f64 {
        let turn = Placement { turn: solid::between(axis, [0.0, 0.0, 1.0]), ..Placement::IDENTITY };
        let (mut low, mut high) = ([0.0_f64; 2], [0.0_f64; 2]);
        for point in self.0.iter().flat_map(|(_, solid)| &solid.positions) {
            let across = turn.direction(point.map(f64::from));
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(across[k]), high[k].max(across[k]));
            }
        }
        // What lies on one side alone, as a bar does, surrounds nothing.
        [0, 1].map(|k| high[k].min(-low[k])).into_iter().fold(0.0, f64::max)
    }
}

/// How large what is drawn is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    /// Extent of the robot, m.
    pub(super) size: f64,
    /// Radius of its bars, m.
    pub(super) radius: f64,
}

impl Sizes {
    /// From a scene whose bodies are placed.
    pub(super) fn new(scene: &Scene, world: &[Placement]) -> Self {
        let own = scene.bodies.iter().zip(world).flat_map(|(body, placed)| {
            let visuals = body.visuals.iter().map(|visual| placed.point(visual.origin));
            [placed.shift, placed.point(body.com)].into_iter().chain(visuals).collect::<Vec<_>>()
        });
        let gripper = scene.gripper.iter().map(|spot| point(world, spot.body, spot.point));
        let held = holds(scene).map(|(body, at, _)| point(world, body, at));
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for at in own.chain(gripper).chain(held).filter(|at| at.iter().all(|part| part.is_finite())) {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k]));
            }
        }
        let size = norm(difference(high, low));
        let size = if size > 1e-9 && size.is_finite() { size } else { 0.5 };
        // Many small members need thinner bars than three long ones.
        let bars = scene.bodies.iter().filter(|body| body.visuals.is_empty()).count();
        Self { size, radius: size * if bars > 12 { 0.014 } else { 0.019 } }
    }
}

/// A point of a body in the world.
pub(super) fn point(world: &[Placement], body: Option<usize>, at: [f64; 3]) -> [f64; 3] {
    body.and_then(|body| world.get(body)).map_or(at, |placed| placed.point(at))
}

/// Where elements take hold, and whether that is a bushing's frame.
fn holds(scene: &Scene) -> impl Iterator<Item = (Option<usize>, [f64; 3], bool)> {
    scene.elements.iter().flat_map(|element| match &element.shape {
        SceneShape::Points(spots) => spots.iter().map(|spot| (spot.body, spot.point, false)).collect(),
        SceneShape::Bushing { from, to, .. } => vec![(from.body, from.point, true), (to.body, to.point, true)],
        SceneShape::Joint { .. } => Vec::new(),
    })
}

/// A body in its frame.
pub(super) fn body(
    document: &mut Document,
    scene: &Scene,
    index: usize,
    Sizes { radius: r, .. }: Sizes,
    surfaces: &HashMap<&str, Vec<Part>>,
) -> Parts {
    let (body, mut parts) = (&scene.bodies[index], Parts::default());
    let shade = if index.is_multiple_of(2) { paint::BODY } else { paint::NEXT_BODY };
    let is_far = |at: &[f64; 3]| norm(*at) > 0.35 * r;
    let children = scene.bodies.iter().filter(|child| child.parent == Some(index)).map(|child| child.origin);
    let gripper = scene.gripper.iter().filter(|spot| spot.body == Some(index)).map(|spot| spot.point);
    let mut ends: Vec<[f64; 3]> = children.chain(gripper).filter(is_far).collect();
    visuals(document, &mut parts, &body.visuals, shade, surfaces);
    let is_drawn = !parts.0.is_empty();
    if !is_drawn {
        let material = shade.material(document);
        ends.iter().for_each(|end| parts.bar(material, ZERO, *end, r));
        if ends.is_empty() && is_far(&body.com) {
            ends.push(body.com);
            parts.bar(material, ZERO, body.com, r);
            parts.ball(material, body.com, 1.5 * r);
        } else if ends.is_empty() {
            parts.ball(material, ZERO, 1.35 * r);
        }
    }
    joint(document, &mut parts, body, is_drawn, r);
    for (_, at, _) in holds(scene).filter(|(of, _, is_frame)| *of == Some(index) && !is_frame) {
        let from = nearest(&ends, at);
        if norm(difference(at, from)) > 0.5 * r && !is_drawn {
            parts.bar(paint::BRACKET.material(document), from, at, 0.3 * r);
        }
        parts.ball(paint::PIVOT.material(document), at, 0.6 * r);
    }
    parts
}

/// What stands still: the root's shapes, or feet, and where elements take hold.
pub(super) fn world(
    document: &mut Document,
    scene: &Scene,
    Sizes { size, radius: r }: Sizes,
    surfaces: &HashMap<&str, Vec<Part>>,
) -> Parts {
    let mut parts = Parts::default();
    let base = paint::BASE.material(document);
    let root = scene.root.as_ref().map_or(&[][..], |root| &root.visuals);
    visuals(document, &mut parts, root, paint::BASE, surfaces);
    let stands = |body: &&Body| {
        let kind = body.joint.kind;
        body.parent.is_none() && body.visuals.is_empty() && kind != Freedom::Floating && kind != Freedom::Fixed
    };
    for body in scene.bodies.iter().filter(stands).filter(|_| root.is_empty()) {
        let [x, y, z] = body.origin;
        let height = scene.ground.map(|ground| z - ground[2]).filter(|height| (-1e-6..0.6 * size).contains(height));
        let at = |z: f64| Placement { shift: [x, y, z], ..Placement::IDENTITY };
        match height {
            Some(height) => {
                parts.add(base, Solid::cylinder(3.6 * r, 0.5 * r, 2 * ROUND).placed(&at(z - height)));
                if height > 1.2 * r {
                    parts.add(base, Solid::cylinder(1.5 * r, height, ROUND).placed(&at(z - height)));
                }
            }
            None => parts.add(base, Solid::cuboid([3.0 * r; 3]).placed(&at(z))),
        }
    }
    let is_fixed = |body: Option<usize>| body.is_none_or(|body| body >= scene.bodies.len());
    for (_, at, _) in holds(scene).filter(|(body, _, is_frame)| is_fixed(*body) && !is_frame) {
        parts.ball(paint::PIVOT.material(document), at, 0.6 * r);
        parts.add(base, Solid::ring(0.9 * r, 0.22 * r).placed(&Placement { shift: at, ..Placement::IDENTITY }));
    }
    parts
}

fn visuals(
    document: &mut Document,
    parts: &mut Parts,
    visuals: &[Visual],
    shade: Paint,
    surfaces: &HashMap<&str, Vec<Part>>,
) {
    for visual in visuals.iter().filter(|visual| surface::is_drawable(visual)) {
        let placement = Placement::new(visual.origin, visual.rpy);
        let solid = match &visual.shape {
            Shape::Box(sizes) => Solid::cuboid(*sizes),
            Shape::Sphere(radius) => Solid::sphere(*radius, ROUND),
            Shape::Ellipsoid(radii) => Solid::sphere(1.0, ROUND).stretched(*radii),
            Shape::Cylinder(radius, length) => {
                let centred = Placement { shift: [0.0, 0.0, -0.5 * length], ..Placement::IDENTITY };
                Solid::cylinder(*radius, *length, ROUND).placed(&centred)
            }
            Shape::Mesh { path, scale } => {
                for Part { color, surface } in surfaces.get(path.as_str()).into_iter().flatten() {
                    // The file knows its parts better than the robot, which has one colour for all.
                    let own =
                        color.map(|[red, green, blue]| [red, green, blue, 255].map(|part| f64::from(part) / 255.0));
                    let material = material(document, own.or(visual.color), shade);
                    let solid = Solid::faceted(&surface.vertices, &surface.triangles, *scale);
                    parts.add(material, solid.placed(&placement));
                }
                continue;
            }
        };
        let material = material(document, visual.color, shade);
        parts.add(material, solid.placed(&placement));
    }
}

fn material(document: &mut Document, color: Option<[f64; 4]>, shade: Paint) -> usize {
    match color {
        Some(color) => paint::given(document, color),
        None => shade.material(document),
    }
}

/// The axis of a joint as a dark rod.
fn joint(document: &mut Document, parts: &mut Parts, body: &Body, is_drawn: bool, r: f64) {
    let (half, radius) = match (body.joint.kind, is_drawn) {
        (Freedom::Fixed | Freedom::Floating, _) => return,
        // A spherical joint is as round whichever way.
        (Freedom::Spherical, _) => {
            parts.ball(paint::JOINT.material(document), ZERO, if is_drawn { 0.6 * r } else { 1.6 * r });
            return;
        }
        (Freedom::Prismatic, true) => (1.2 * r, 0.3 * r),
        (_, true) => (1.5 * r, 0.3 * r),
        (Freedom::Prismatic, false) => (1.9 * r, 1.25 * r),
        (_, false) => (1.55 * r, 1.25 * r),
    };
    parts.rod(paint::JOINT.material(document), body.joint.axis, half, radius);
}

/// The point nearest to `at` on the bars from the origin to the ends.
fn nearest(ends: &[[f64; 3]], at: [f64; 3]) -> [f64; 3] {
    let feet = ends.iter().map(|end| {
        let along =
            end.iter().zip(&at).map(|(a, b)| a * b).sum::<f64>() / end.iter().map(|part| part * part).sum::<f64>();
        end.map(|part| part * if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 })
    });
    let far = |from: [f64; 3]| norm(difference(at, from));
    feet.fold(ZERO, |best, foot| if far(foot) < far(best) { foot } else { best })
}
