//! The distance of two points.

use super::forces::{Forces, Pull};
use super::{Direction, Measure, Reading};
use crate::dynamics::{Kinematics, PairForce, pair_into};
use crate::model::{Model, Site};

/// y = l = |r_to − r_from|, m. A force F > 0 (tension, N) pulls the two points together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// D_i.
    pub from: Site,
    /// D_j.
    pub to: Site,
}

impl Line {
    #[inline]
    pub(super) fn read_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        gradient: &mut [f64],
        reading: &mut Reading,
    ) {
        let pair = pair_into(model, kinematics, &self.from, &self.to, gradient);
        *reading = Reading { coordinate: pair.length, rate: pair.rate, direction: Direction::Line(pair) };
    }

    #[inline]
    pub(super) fn push(&self, pull: Pull, forces: &mut Forces) {
        let Pull { force, d_coordinate, d_rate } = pull;
        forces.pairs.push(PairForce { from: self.from, to: self.to, force, d_length: d_coordinate, d_rate });
    }
}

impl From<Line> for Measure {
    fn from(line: Line) -> Self {
        Self::Line(line)
    }
}
