//! The file of materials beside an OBJ file: their colours alone.

use super::sink::{Rgb, rgb};
use super::{bytes_inside, floats};
use std::collections::HashMap;
use std::path::Path;

/// Largest file of materials, bytes.
const LARGEST: u64 = 4 << 20;

/// Colours by name; none of a file that is not there, outside the folder, no ordinary file, or too large: the mesh is drawn without.
pub(super) fn read(path: &Path, folder: &Path) -> HashMap<String, Rgb> {
    let mut colors = HashMap::new();
    let Ok(bytes) = bytes_inside(path, folder, LARGEST) else { return colors };
    let (text, mut name) = (String::from_utf8_lossy(&bytes), None);
    for line in text.lines().map(str::trim) {
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match (word, &name) {
            ("newmtl", _) => name = Some(rest.trim().to_owned()),
            ("Kd", Some(name)) => {
                let parts: Result<Vec<f32>, _> = floats(rest).take(3).collect();
                if let Some(parts) = parts.ok().and_then(|parts| <[f32; 3]>::try_from(parts).ok()) {
                    colors.insert(name.clone(), rgb(parts));
                }
            }
            _ => {}
        }
    }
    colors
}
