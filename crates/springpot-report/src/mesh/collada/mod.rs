//! COLLADA: the triangles and polygons of the nodes of a scene, with the diffuse colours of their materials, in metres, z up.

mod color;
mod geometry;
mod placement;
mod tree;
mod xml;

use super::Unread;
use super::sink::Sink;

pub(super) fn read(bytes: &[u8], sink: &mut Sink) -> Result<(), Unread> {
    let text = std::str::from_utf8(bytes).map_err(|_| Unread::NotText)?;
    let document = xml::parse(text.trim_start_matches('\u{feff}'))?;
    tree::read(&xml::Index::of(&document), sink)
}
