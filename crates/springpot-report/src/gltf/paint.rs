//! Colours of what is drawn.

use super::document::Document;
use crate::robot::ElementSign;

/// What a surface is: its name, and red, green and blue as screens have them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint(&'static str, u32);

pub(super) const BODY: Paint = Paint("body", 0x00d9_dfe7);
pub(super) const NEXT_BODY: Paint = Paint("next body", 0x00b5_c0cd);
pub(super) const JOINT: Paint = Paint("joint", 0x0045_4d59);
pub(super) const PIVOT: Paint = Paint("anchor", 0x0039_404a);
pub(super) const BRACKET: Paint = Paint("bracket", 0x008d_96a2);
pub(super) const BASE: Paint = Paint("base", 0x007c_8591);
pub(super) const GRIPPER: Paint = Paint("gripper", 0x00b2_3a06);
pub(super) const PATH: Paint = Paint("gripper path", 0x00b2_3a06);
pub(super) const WANTED: Paint = Paint("wanted path", 0x005d_6570);
const CONTACT: Paint = Paint("contact", 0x00f5_b301);
const SPRING: Paint = Paint("spring", 0x0000_72b2);
const DASHPOT: Paint = Paint("dashpot", 0x00d5_5e00);
const SPRINGPOT: Paint = Paint("springpot", 0x0000_9e73);
const SOURCE: Paint = Paint("source", 0x00cc_79a7);
const FRACTIONAL: Paint = Paint("fractional network", 0x0000_9e73);
const NETWORK: Paint = Paint("network", 0x0056_b4e9);

impl Paint {
    pub(super) fn material(self, document: &mut Document) -> usize {
        let Self(name, color) = self;
        let part = |shift: u32| linear(f64::from((color >> shift) & 0xff) / 255.0);
        document.material(name, [part(16), part(8), part(0), 1.0], false)
    }

    /// The colour of what a law holds.
    pub(super) fn of(sign: &ElementSign, contact: bool) -> Self {
        match sign {
            _ if contact => CONTACT,
            ElementSign::Spring => SPRING,
            ElementSign::Dashpot => DASHPOT,
            ElementSign::Springpot => SPRINGPOT,
            ElementSign::Source => SOURCE,
            ElementSign::Parallel(parts) | ElementSign::Series(parts) => {
                if holds_springpot(parts) {
                    FRACTIONAL
                } else {
                    NETWORK
                }
            }
        }
    }
}

fn holds_springpot(parts: &[ElementSign]) -> bool {
    parts.iter().any(|part| match part {
        ElementSign::Springpot => true,
        ElementSign::Parallel(parts) | ElementSign::Series(parts) => holds_springpot(parts),
        _ => false,
    })
}

/// The material of a colour that a robot's file gives: red, green, blue and opacity as screens have them.
pub(super) fn given(document: &mut Document, color: [f64; 4]) -> usize {
    let [red, green, blue, opacity] = color.map(|part| if part.is_finite() { part.clamp(0.0, 1.0) } else { 1.0 });
    document.material("painted", [linear(red), linear(green), linear(blue), opacity], true)
}

/// sRGB to linear.
fn linear(part: f64) -> f64 {
    if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
}
