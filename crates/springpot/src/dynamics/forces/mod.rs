//! What forces between bodies do, along lines, cables and the coordinates of one frame in another.

mod cable;
pub(super) mod coordinate;
pub(super) mod line;
pub(super) mod pair;
pub(super) mod pair_stiffness;
mod relative_frame;
pub(super) mod wrench;

pub(crate) use cable::CableLength;
pub(crate) use relative_frame::RelativeCoordinate;
