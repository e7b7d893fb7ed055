//! Where a gripper should be.

/// Where the gripper should be, for motions that say so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// World position, m.
    pub position: [f64; 3],
    /// Its derivative, m/s.
    pub velocity: [f64; 3],
}
