//! Elements: bars from point to point that stretch, rings at joints and bushings.

use super::document::Document;
use super::paint::Paint;
use super::robot::{self, Parts, Sizes};
use super::solid::{self, Solid};
use super::track::{Keys, Tracks};
use crate::scene::{Placement, SceneElement, SceneShape};
use crate::vector::{difference, norm};
use serde_json::json;

/// Parts around a bar.
const ROUND: usize = 16;
/// A bar is never shorter, m: what has no length has no direction either.
const LEAST: f64 = 1e-9;
/// What hides a ring is up to so many radii of a bar wide.
const MOST_REACH: f64 = 14.0;

/// Nodes that other nodes hang on.
#[derive(Debug)]
pub(super) struct Nodes {
    /// What stands still.
    pub(super) world: usize,
    /// By body.
    pub(super) bodies: Vec<usize>,
}

impl Nodes {
    fn of(&self, body: Option<usize>) -> usize {
        body.and_then(|body| self.bodies.get(body)).map_or(self.world, |node| *node)
    }
}

/// Draws an element; `worlds` are the placed bodies at every keyframe. Returns nodes that hang on the world.
pub(super) fn draw(
    document: &mut Document,
    tracks: &mut Tracks,
    element: &SceneElement,
    Sizes { radius: r, .. }: Sizes,
    nodes: &Nodes,
    bodies: &[Parts],
    worlds: &[Vec<Placement>],
) {
    let material = Paint::of(&element.sign, element.contact).material(document);
    match &element.shape {
        SceneShape::Points(spots) => {
            let radius = if spots.len() > 2 { 0.35 * r } else { 0.55 * r };
            let Some(mesh) = document.mesh(&element.name, &[(material, Solid::cylinder(radius, 1.0, ROUND))]) else {
                return;
            };
            for (k, pair) in spots.windows(2).enumerate() {
                let name = if spots.len() > 2 { format!("{} {}", element.name, k + 1) } else { element.name.clone() };
                let node = document.push("nodes", json!({ "name": name, "mesh": mesh }));
                hang(document, nodes.world, node);
                let ends = |world: &Vec<Placement>| {
                    [&pair[0], &pair[1]].map(|spot| robot::point(world, spot.body, spot.point))
                };
                tracks.node(document, node, &stretched(worlds.iter().map(ends)));
            }
        }
        SceneShape::Joint { body, axis, .. } => {
            // Around what the body shows there.
            let reach = bodies.get(*body).map_or(0.0, |parts| parts.reach(*axis));
            let radius = (reach.min(MOST_REACH * r) + 0.5 * r).clamp(2.3 * r, MOST_REACH * r);
            let placement = Placement { turn: solid::from_z(*axis), ..Placement::IDENTITY };
            ring(document, &element.name, (material, radius, 0.5 * r), nodes.of(Some(*body)), placement);
        }
        SceneShape::Bushing { from, to, .. } => {
            for (end, radius, tube) in [(from, 2.3 * r, 0.6 * r), (to, 1.25 * r, 0.34 * r)] {
                ring(
                    document,
                    &element.name,
                    (material, radius, tube),
                    nodes.of(end.body),
                    Placement::new(end.point, end.rpy),
                );
            }
        }
    }
}

/// From the first of two points to the other, at every keyframe; what stretches is of length 1 along z.
fn stretched(ends: impl Iterator<Item = [[f64; 3]; 2]>) -> Keys {
    let mut keys = Keys::default();
    let (mut turn, mut before) = (Placement::IDENTITY, [0.0, 0.0, 1.0]);
    for [from, to] in ends {
        let along = difference(to, from);
        let length = norm(along);
        if length > LEAST {
            // On from the last direction: a bar that swings does not twist.
            turn = Placement { turn: solid::between(before, along), ..Placement::IDENTITY }.of(&turn);
            let size = norm(turn.turn);
            turn.turn = turn.turn.map(|part| part / size);
            before = along;
        }
        keys.shifts.push(from);
        keys.turns.push(turn.turn);
        keys.scales.push([1.0, 1.0, length.max(LEAST)]);
    }
    keys
}

fn ring(
    document: &mut Document,
    name: &str,
    (material, radius, tube): (usize, f64, f64),
    on: usize,
    placement: Placement,
) {
    let solid = Solid::ring(radius, tube).placed(&placement);
    if let Some(mesh) = document.mesh(name, &[(material, solid)]) {
        let node = document.push("nodes", json!({ "name": name, "mesh": mesh }));
        hang(document, on, node);
    }
}

/// Makes a node the child of another.
pub(super) fn hang(document: &mut Document, parent: usize, child: usize) {
    match &mut document.node(parent)["children"] {
        serde_json::Value::Array(children) => children.push(child.into()),
        children => *children = json!([child]),
    }
}
