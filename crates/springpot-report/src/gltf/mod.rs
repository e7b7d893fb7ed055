//! Moving models of a run: glTF 2.0 files, which browsers, Blender and engines of games open.
//!
//! A node for every body hangs on that of its parent and moves by keyframes; the first node turns z up into the format's y up. Elements between points
//! are bars that stretch, others rings at their joint or their frames. Colours tell what an element holds: to let them follow its force, the format needs
//! an extension (`KHR_animation_pointer`) that few programs read.

mod document;
mod element;
mod paint;
mod robot;
mod solid;
mod track;

use crate::mesh::MeshFile;
use crate::page::ViewColumn;
use crate::scene::{Kinematics, Placement, Scene};
use crate::surface;
use document::Document;
use element::{Nodes, hang};
use robot::Sizes;
use serde_json::json;
use solid::Solid;
use std::collections::BTreeMap;
use std::io::{self, Write};
use track::{Keys, Tracks};

pub use document::Container;

/// Keyframes of a file, at most.
const MOST_KEYFRAMES: usize = 2000;
/// A body that is farther away is not drawn, m.
const FARTHEST: f64 = 1e9;
/// z up as y up: a quarter of a turn about x.
const UPRIGHT: [f64; 4] = [-std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2];

/// A model whose rows come in.
#[derive(Debug)]
pub struct Model<'a> {
    scene: &'a Scene,
    meshes: &'a BTreeMap<String, MeshFile>,
    tree: Kinematics,
    time: Option<usize>,
    stride: usize,
    seen: usize,
    times: Vec<f32>,
    /// By keyframe, each body in the frame of its parent.
    poses: Vec<Vec<Placement>>,
    /// The last row, if it is not yet a keyframe.
    last: Option<(f32, Vec<Placement>)>,
}

impl<'a> Model<'a> {
    /// Of a robot, from so many rows; `meshes`: where the files are that its meshes are called by.
    pub fn new(scene: &'a Scene, meshes: &'a BTreeMap<String, MeshFile>, columns: &[ViewColumn], rows: usize) -> Self {
        let column = |name: &str| columns.iter().position(|column| column.name == name);
        let stride = rows.saturating_sub(1).div_ceil(MOST_KEYFRAMES - 1).max(1);
        let (tree, time) = (Kinematics::new(scene, column), column("t"));
        Self { scene, meshes, tree, time, stride, seen: 0, times: Vec::new(), poses: Vec::new(), last: None }
    }

    /// Of so many rows one is a keyframe.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Takes a row.
    pub fn row(&mut self, row: &[f64]) {
        let t = self.time.map_or(0.0, |time| row[time]) as f32;
        let pose = self.tree.local(row);
        let is_near = |placed: &Placement| placed.is_finite() && placed.shift.iter().all(|part| part.abs() < FARTHEST);
        self.seen += 1;
        if !(t >= 0.0 && t.is_finite() && pose.iter().all(is_near)) {
            return;
        }
        match (self.seen - 1) % self.stride {
            0 => self.keep(t, pose),
            _ => self.last = Some((t, pose)),
        }
    }

    fn keep(&mut self, t: f32, pose: Vec<Placement>) {
        self.last = None;
        // Times of single precision must rise.
        if self.times.last().is_none_or(|before| t > *before) {
            self.times.push(t);
            self.poses.push(pose);
        }
    }

    /// Writes the model; `facts` say what it is. Returns a word on files of shapes that could not be read.
    ///
    /// # Errors
    /// What `out` says.
    pub fn write(
        mut self,
        name: &str,
        version: &str,
        facts: &BTreeMap<String, String>,
        container: Container,
        out: &mut dyn Write,
    ) -> io::Result<Option<String>> {
        if let Some((t, pose)) = self.last.take() {
            self.keep(t, pose);
        }
        if self.poses.is_empty() {
            self.keep(0.0, vec![Placement::IDENTITY; self.scene.bodies.len()]);
        }
        let (surfaces, unread) = surface::read_all(std::slice::from_ref(self.scene), self.meshes);
        let worlds: Vec<Vec<Placement>> = self.poses.iter().map(|pose| self.tree.world(pose)).collect();
        let sizes = Sizes::new(self.scene, &worlds[0]);
        let mut document = Document::default();
        let mut tracks = Tracks::new(std::mem::take(&mut self.times));
        let top =
            document.push("nodes", json!({ "name": name, "rotation": UPRIGHT.map(|part| f64::from(part as f32)) }));
        document.push("scenes", json!({ "name": name, "nodes": [top] }));

        let still = robot::world(&mut document, self.scene, sizes, &surfaces);
        let mesh = document.mesh("world", &still.0);
        let world =
            document.push("nodes", json!({ "name": self.scene.root.as_ref().map_or("world", |root| &root.name) }));
        mesh.into_iter().for_each(|mesh| document.node(world)["mesh"] = json!(mesh));
        hang(&mut document, top, world);
        let (mut nodes, mut bodies) = (Nodes { world, bodies: Vec::new() }, Vec::new());
        for (index, body) in self.scene.bodies.iter().enumerate() {
            let parts = robot::body(&mut document, self.scene, index, sizes, &surfaces);
            let mesh = document.mesh(&body.name, &parts.0);
            let node = document.push("nodes", json!({ "name": body.name }));
            mesh.into_iter().for_each(|mesh| document.node(node)["mesh"] = json!(mesh));
            hang(&mut document, self.tree.parent(index).map_or(world, |parent| nodes.bodies[parent]), node);
            let keys = Keys {
                shifts: self.poses.iter().map(|pose| pose[index].shift).collect(),
                turns: self.poses.iter().map(|pose| pose[index].turn).collect(),
                scales: Vec::new(),
            };
            tracks.node(&mut document, node, &keys);
            nodes.bodies.push(node);
            bodies.push(parts);
        }
        for drawn in &self.scene.elements {
            element::draw(&mut document, &mut tracks, drawn, sizes, &nodes, &bodies, &worlds);
        }
        self.gripper(&mut document, sizes, &nodes, &worlds);
        tracks.write(&mut document, "run");
        let asset = json!({ "version": "2.0", "generator": format!("Springpot {version}"), "extras": facts });
        document.write(json!({ "asset": asset, "scene": 0 }), container, out)?;
        Ok(unread)
    }

    /// The gripper, its path, and where it is to be.
    fn gripper(&self, document: &mut Document, sizes: Sizes, nodes: &Nodes, worlds: &[Vec<Placement>]) {
        if let Some(spot) = &self.scene.gripper {
            let material = paint::GRIPPER.material(document);
            let at = Placement { shift: spot.point, ..Placement::IDENTITY };
            let ball = Solid::sphere(1.25 * sizes.radius, 24).placed(&at);
            if let Some(mesh) = document.mesh("gripper", &[(material, ball)]) {
                let node = document.push("nodes", json!({ "name": "gripper", "mesh": mesh }));
                let on = spot.body.and_then(|body| nodes.bodies.get(body)).map_or(nodes.world, |node| *node);
                hang(document, on, node);
            }
            let path = worlds.iter().map(|world| robot::point(world, spot.body, spot.point)).collect();
            line(document, nodes.world, paint::PATH, "gripper path", path);
        }
        if let Some(wanted) = &self.scene.wanted {
            let path = wanted.x.iter().zip(&wanted.y).zip(&wanted.z).map(|((x, y), z)| [*x, *y, *z]);
            line(document, nodes.world, paint::WANTED, "wanted path", path.collect());
        }
    }
}

/// A path in the world, where it has two points.
fn line(document: &mut Document, world: usize, paint: paint::Paint, name: &str, path: Vec<[f64; 3]>) {
    let near = path.into_iter().filter(|point| point.iter().all(|part| part.abs() < FARTHEST));
    let points: Vec<[f32; 3]> = near.map(|point| point.map(|part| part as f32)).collect();
    if points.len() > 1 {
        let material = paint.material(document);
        let mesh = document.line(name, &points, material);
        let node = document.push("nodes", json!({ "name": name, "mesh": mesh }));
        hang(document, world, node);
    }
}
