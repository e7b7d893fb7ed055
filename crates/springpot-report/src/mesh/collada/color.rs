//! Materials: the diffuse colour of their effect.

use super::xml::{Index, Node, children, down, words};
use crate::mesh::sink::{Rgb, rgb};
use std::collections::HashMap;

/// Colours of the materials that were asked for.
#[derive(Debug, Default)]
pub(super) struct Colors(HashMap<roxmltree::NodeId, Option<Rgb>>);

impl Colors {
    /// Colours by the names that the primitives of an instance have for their materials.
    pub(super) fn bound<'a>(&mut self, index: &Index<'a>, instance: Node<'a>) -> HashMap<&'a str, Option<Rgb>> {
        let Some(common) = down(instance, &["bind_material", "technique_common"]) else { return HashMap::new() };
        let bound = children(common, "instance_material").filter_map(|one| {
            let material = index.target(one, "target", "material");
            Some((one.attribute("symbol")?, material.and_then(|material| self.of(index, material))))
        });
        bound.collect()
    }

    /// The colour of the material that a primitive names, where nothing is bound.
    pub(super) fn named(&mut self, index: &Index<'_>, symbol: &str) -> Option<Rgb> {
        self.of(index, index.called(symbol, "material")?)
    }

    fn of<'a>(&mut self, index: &Index<'a>, material: Node<'a>) -> Option<Rgb> {
        *self.0.entry(material.id()).or_insert_with(|| diffuse(index, material))
    }
}

fn diffuse<'a>(index: &Index<'a>, material: Node<'a>) -> Option<Rgb> {
    let effect = index.target(children(material, "instance_effect").next()?, "url", "effect")?;
    let technique = down(effect, &["profile_COMMON", "technique"])?;
    let shading = |name| children(technique, name).next();
    let shader = ["phong", "lambert", "blinn"].into_iter().find_map(shading);
    let color = match shader {
        Some(shader) => down(shader, &["diffuse", "color"])?,
        None => down(shading("constant")?, &["emission", "color"])?,
    };
    let parts: Option<Vec<f32>> = words(color).take(3).map(|word| word.parse().ok()).collect();
    Some(rgb(parts?.try_into().ok()?))
}
