//! The two forms of a glTF 2.0 file: objects of JSON, and one buffer of numbers.

use super::solid::Solid;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::io::{self, Write};

/// How a file is put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Container {
    /// `.glb`: JSON and numbers one behind the other.
    Binary,
    /// `.gltf`: JSON with the numbers as text inside.
    Text,
}

/// Bytes before a number is written are a multiple of this.
const ALIGNMENT: usize = 4;
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const CORNERS: u32 = 34963;
const LINE_STRIP: u32 = 3;

/// A file that grows; lists that stay empty are left out, as the format wants it.
#[derive(Debug, Default)]
pub(super) struct Document {
    lists: Map<String, Value>,
    buffer: Vec<u8>,
    materials: HashMap<String, usize>,
}

impl Document {
    /// Adds an object to a list, and tells its index.
    pub(super) fn push(&mut self, list: &str, object: Value) -> usize {
        let list = self.lists.entry(list).or_insert_with(|| json!([]));
        let list = list.as_array_mut().expect("all lists are arrays");
        list.push(object);
        list.len() - 1
    }

    pub(super) fn node(&mut self, index: usize) -> &mut Value {
        &mut self.lists["nodes"][index]
    }

    /// A material of linear red, green, blue and opacity, once.
    pub(super) fn material(&mut self, name: &str, color: [f64; 4], is_open: bool) -> usize {
        let key = format!("{name} {color:?} {is_open}");
        if let Some(known) = self.materials.get(&key) {
            return *known;
        }
        let mut object = json!({
            "name": name,
            "pbrMetallicRoughness": { "baseColorFactor": color, "metallicFactor": 0.0, "roughnessFactor": 0.6 },
        });
        if color[3] < 1.0 {
            object["alphaMode"] = json!("BLEND");
        }
        if is_open {
            object["doubleSided"] = json!(true);
        }
        let index = self.push("materials", object);
        self.materials.insert(key, index);
        index
    }

    fn view(&mut self, bytes: impl IntoIterator<Item = u8>, target: Option<u32>) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(ALIGNMENT), 0);
        let offset = self.buffer.len();
        self.buffer.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.buffer.len() - offset });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.push("bufferViews", view)
    }

    /// Numbers, `N` together; with their extent where that must be told.
    pub(super) fn numbers<const N: usize>(&mut self, numbers: &[[f32; N]], target: Option<u32>, extent: bool) -> usize {
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N];
        let view = self.view(numbers.iter().flatten().flat_map(|number| number.to_le_bytes()), target);
        let mut object = json!({ "bufferView": view, "componentType": FLOAT, "count": numbers.len(), "type": kind });
        if extent {
            let (mut low, mut high) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
            for (k, number) in numbers.iter().flat_map(|point| point.iter().enumerate()) {
                (low[k], high[k]) = (low[k].min(*number), high[k].max(*number));
            }
            // A float is a double to the bit.
            object["min"] = low.map(f64::from).to_vec().into();
            object["max"] = high.map(f64::from).to_vec().into();
        }
        self.push("accessors", object)
    }

    /// A mesh of solids with their materials; nothing of nothing.
    pub(super) fn mesh(&mut self, name: &str, parts: &[(usize, Solid)]) -> Option<usize> {
        let mut primitives = Vec::new();
        for (material, solid) in parts.iter().filter(|(_, solid)| !solid.triangles.is_empty()) {
            let position = self.numbers(&solid.positions, Some(VERTICES), true);
            let normal = self.numbers(&solid.normals, Some(VERTICES), false);
            let corners = solid.triangles.iter().flatten();
            let is_short = solid.positions.len() < usize::from(u16::MAX);
            let (view, kind) = match is_short {
                true => (
                    self.view(corners.flat_map(|corner| (*corner as u16).to_le_bytes()), Some(CORNERS)),
                    UNSIGNED_SHORT,
                ),
                false => (self.view(corners.flat_map(|corner| corner.to_le_bytes()), Some(CORNERS)), UNSIGNED_INT),
            };
            let count = 3 * solid.triangles.len();
            let indices = self.push(
                "accessors",
                json!({ "bufferView": view, "componentType": kind, "count": count, "type": "SCALAR" }),
            );
            let attributes = json!({ "POSITION": position, "NORMAL": normal });
            primitives.push(json!({ "attributes": attributes, "indices": indices, "material": material }));
        }
        (!primitives.is_empty()).then(|| self.push("meshes", json!({ "name": name, "primitives": primitives })))
    }

    /// A line through points, two or more.
    pub(super) fn line(&mut self, name: &str, points: &[[f32; 3]], material: usize) -> usize {
        let position = self.numbers(points, Some(VERTICES), true);
        let attributes = json!({ "POSITION": position });
        let primitive = json!({ "attributes": attributes, "mode": LINE_STRIP, "material": material });
        self.push("meshes", json!({ "name": name, "primitives": [primitive] }))
    }

    /// Writes the file; `top` are what is no list.
    ///
    /// # Errors
    /// What `out` says; a file above 4 GiB.
    pub(super) fn write(mut self, top: Value, container: Container, out: &mut dyn Write) -> io::Result<()> {
        if let Value::Object(top) = top {
            self.lists.extend(top);
        }
        self.buffer.resize(self.buffer.len().next_multiple_of(ALIGNMENT), 0);
        if !self.buffer.is_empty() {
            let mut buffer = json!({ "byteLength": self.buffer.len() });
            if container == Container::Text {
                buffer["uri"] =
                    json!(format!("data:application/octet-stream;base64,{}", STANDARD.encode(&self.buffer)));
            }
            self.push("buffers", buffer);
        }
        let mut text = serde_json::to_vec(&self.lists)?;
        if container == Container::Text {
            text.push(b'\n');
            return out.write_all(&text);
        }
        text.resize(text.len().next_multiple_of(ALIGNMENT), b' ');
        let of_buffer = if self.buffer.is_empty() { 0 } else { 8 + self.buffer.len() };
        let size =
            |length: usize| u32::try_from(length).map_err(|_| io::Error::other("a .glb file holds no more than 4 GiB"));
        for word in [u32::from_le_bytes(*b"glTF"), 2, size(20 + text.len() + of_buffer)?] {
            out.write_all(&word.to_le_bytes())?;
        }
        for (kind, bytes) in [(b"JSON", &text), (b"BIN\0", &self.buffer)] {
            if !bytes.is_empty() {
                out.write_all(&size(bytes.len())?.to_le_bytes())?;
                out.write_all(kind)?;
                out.write_all(bytes)?;
            }
        }
        Ok(())
    }
}
