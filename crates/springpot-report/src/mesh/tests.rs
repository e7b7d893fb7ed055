//! Files as exporters write them, files as strangers write them, and both with some of their bytes changed.

use super::*;
use std::time::Instant;

mod damaged;
mod written;

/// Reads a text or bytes as the file of a name, in a folder of its own.
fn read_as(name: &str, bytes: impl AsRef<[u8]>) -> Result<Vec<Part>, Unread> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    read(&MeshFile { path, folder: folder.path().to_owned() })
}

/// Why it is not read.
fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> String {
    read_as(name, bytes).expect_err("it is read").to_string()
}

fn triangles(parts: &[Part]) -> usize {
    parts.iter().map(|part| part.surface.triangles.len()).sum()
}

/// Low and high corner of all that is drawn.
fn extent(parts: &[Part]) -> ([f32; 3], [f32; 3]) {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for vertex in parts.iter().flat_map(|part| &part.surface.vertices) {
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(vertex[k]), high[k].max(vertex[k]));
        }
    }
    (low, high)
}

/// A COLLADA file of cubes with an edge of 1, each a geometry and a node with that transformation, and its material.
fn cubes(transformations: &[&str]) -> String {
    let colors = ["0.1 0.2 0.9 1", "1 1 1 1", "0.8 0.2 0.1 1"];
    let (mut effects, mut materials, mut geometries, mut nodes) =
        (String::new(), String::new(), String::new(), String::new());
    for (k, transformation) in transformations.iter().enumerate() {
        let color = colors[k % colors.len()];
        effects += &format!(
            "<effect id=\"e{k}\"><profile_COMMON><technique sid=\"c\"><phong><diffuse><color>{color}</color></diffuse></phong></technique></profile_COMMON></effect>"
        );
        materials += &format!("<material id=\"m{k}\"><instance_effect url=\"#e{k}\"/></material>");
        geometries += &format!(
            "<geometry id=\"g{k}\"><mesh><source id=\"p{k}\"><float_array id=\"a{k}\" count=\"24\">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1</float_array>\
             <technique_common><accessor source=\"#a{k}\" count=\"8\" stride=\"3\"/></technique_common></source>\
             <vertices id=\"v{k}\"><input semantic=\"POSITION\" source=\"#p{k}\"/></vertices>\
             <triangles material=\"own\" count=\"12\"><input semantic=\"VERTEX\" source=\"#v{k}\" offset=\"0\"/><input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/>\
             <p>{}</p></triangles></mesh></geometry>",
            CUBE.iter().flatten().map(|corner| format!("{corner} 0 ")).collect::<String>()
        );
        nodes += &format!(
            "<node id=\"n{k}\">{transformation}<instance_geometry url=\"#g{k}\"><bind_material><technique_common>\
             <instance_material symbol=\"own\" target=\"#m{k}\"/></technique_common></bind_material></instance_geometry></node>"
        );
    }
    format!(
        "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><unit meter=\"1\"/><up_axis>Z_UP</up_axis></asset>\
         <library_effects>{effects}</library_effects><library_materials>{materials}</library_materials><library_geometries>{geometries}</library_geometries>\
         <library_visual_scenes><visual_scene id=\"s\">{nodes}</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
    )
}

/// The triangles of a cube between its corners.
const CUBE: [[u32; 3]; 12] = [
    [0, 2, 1],
    [0, 3, 2],
    [4, 5, 6],
    [4, 6, 7],
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
];

/// The cube as OBJ, and as both forms of STL.
fn cube_obj() -> String {
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    let face = |[a, b, c]: &[u32; 3]| format!("f {} {}//1 {}/2/1\n", a + 1, b + 1, c + 1);
    format!("mtllib cube.mtl\nusemtl blue\n{corners}{}", CUBE.iter().map(face).collect::<String>())
}

fn cube_corner(corner: u32) -> [f32; 3] {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][corner as usize % 4]
        .into_iter()
        .chain([(corner / 4) as f32])
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

fn cube_stl_text() -> String {
    let facet = |triangle: &[u32; 3]| {
        let corners = triangle.map(cube_corner).map(|[x, y, z]| format!("vertex {x} {y} {z:e}\n")).concat();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid cube\n{}endsolid cube\n", CUBE.iter().map(facet).collect::<String>())
}

fn cube_stl_bytes() -> Vec<u8> {
    let mut bytes = b"solid in spite of its bytes".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for triangle in CUBE {
        let corners = triangle.map(cube_corner).concat();
        bytes.extend([0.0_f32; 3].iter().chain(&corners).flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}
