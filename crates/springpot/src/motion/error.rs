//! Why a gripper path ends early.

/// The gripper cannot follow its path.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PathError {
    /// The path leaves what the robot can reach.
    #[error(
        "the gripper cannot reach its path at t = {t} s: {} it stays {distance:.3e} m{} away; bring the path \
         nearer{}",
        when(*.t, *.at),
        if *.angle == 0.0 { String::new() } else { format!(" and {angle:.3e} rad") },
        if *.at == 0.0 { ", or give a guess that is nearer to it" } else { "" }
    )]
    OutOfReach {
        /// From when on it cannot be followed, s.
        t: f64,
        /// When the gripper is this far away, s; at or after `t`.
        at: f64,
        /// Distance to the wanted point, m.
        distance: f64,
        /// Angle to the wanted orientation, rad; 0 where none is asked for.
        angle: f64,
    },
    /// The path goes through a singular configuration in which the velocities are infinite or not determined.
    #[error(
        "the gripper's path is within reach, but the robot is singular on it at t = {t} s: no smooth motion leads {}; keep the path \
         clear of the limit of the reach{}",
        if *.t == 0.0 { "away from there" } else { "through it" },
        if *.t == 0.0 { ", or give a guess to the side to which the robot is to bend" } else { "" }
    )]
    Singular {
        /// Time of the singular configuration, s.
        t: f64,
    },
    /// The path changes more often than it is followed.
    #[error(
        "the gripper's path takes over {limit} stretches to follow, which lead to t = {t} s; shorten the motion, or take out of \
         the path what swings or switches so often"
    )]
    TooManyStretches {
        /// Time reached, s.
        t: f64,
        /// Stretches that are allowed.
        limit: usize,
    },
    /// Interrupted by the user.
    #[error("interrupted while the gripper's path was followed, at t = {t} s")]
    Interrupted {
        /// Time reached, s.
        t: f64,
    },
}

impl PathError {
    /// From when on the path is not followed, s.
    pub fn t(&self) -> f64 {
        match self {
            Self::OutOfReach { t, .. }
            | Self::Singular { t }
            | Self::TooManyStretches { t, .. }
            | Self::Interrupted { t } => *t,
        }
    }
}

fn when(t: f64, at: f64) -> String {
    if t == at { "there".to_owned() } else { format!("{:.1e} s later", at - t) }
}
