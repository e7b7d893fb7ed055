//! The length of a cable through points of any bodies.

use super::forces::{Forces, Pull};
use super::{Direction, Measure, NoDirection, Reading};
use crate::dynamics::{CableLength, Kinematics, Pair};
use crate::model::{Model, Site};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Points of one link that are no farther apart than this share of their coordinates are one.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// y = Σ_s |r_{s+1} − r_s|, m, through points of any bodies, which the cable passes without friction: one tension F, N, in all
/// segments.
///
/// It belongs to the [`Model`] that its points were resolved in.
#[derive(Debug, Clone, PartialEq)]
pub struct Cable {
    points: Arc<[Site]>,
}

/// A segment in one state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Segment {
    line: Pair,
    /// Its ends are points of one link: its direction does not matter.
    is_rigid: bool,
}

/// No cable runs through these points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CableError {
    /// It has no segment.
    #[error("a cable runs through at least two points, not {count}")]
    TooFew {
        /// Number of points.
        count: usize,
    },
    /// Neighbours are one point of one body.
    #[error("segment {segment} of the cable begins and ends in one point of one body")]
    Coincident {
        /// The segment, from 1.
        segment: usize,
    },
    /// All points move together.
    #[error("all points of the cable move together: its length cannot change")]
    Rigid,
}

impl Cable {
    /// Through these points, in their order.
    ///
    /// # Errors
    /// [`CableError`].
    pub fn new(points: impl Into<Arc<[Site]>>) -> Result<Self, CableError> {
        let points = points.into();
        if points.len() < 2 {
            return Err(CableError::TooFew { count: points.len() });
        }
        // Fixed joints between bodies leave rounding in their points.
        let coincide = |two: &[Site]| {
            let [a, b] = [two[0].point(), two[1].point()];
            two[0].link() == two[1].link() && (b - a).norm() <= ROUNDING * (a.norm() + b.norm())
        };
        if let Some(k) = points.windows(2).position(coincide) {
            return Err(CableError::Coincident { segment: k + 1 });
        }
        if points.iter().all(|point| point.link() == points[0].link()) {
            return Err(CableError::Rigid);
        }
        Ok(Self { points })
    }

    /// Its points, from end to end.
    pub fn points(&self) -> &[Site] {
        &self.points
    }

    pub(super) fn coordinate(&self) -> CableLength<'_> {
        CableLength(&self.points)
    }

    #[inline]
    pub(super) fn read_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        gradient: &mut [f64],
        reading: &mut Reading,
    ) {
        let gradient = &mut gradient[..model.nv()];
        gradient.fill(0.0);
        // The room of the last reading is used again.
        let mut segments = match std::mem::take(&mut reading.direction) {
            Direction::Cable(segments) => segments,
            _ => Vec::with_capacity(self.points.len() - 1),
        };
        segments.clear();
        self.coordinate().read(model, kinematics, gradient, |line, is_rigid| segments.push(Segment { line, is_rigid }));
        reading.coordinate = segments.iter().map(|segment| segment.line.length).sum();
        reading.rate = segments.iter().map(|segment| segment.line.rate).sum();
        reading.direction = Direction::Cable(segments);
    }

    #[inline]
    pub(super) fn push(&self, pull: Pull, forces: &mut Forces) {
        forces.cables.push((self.clone(), pull));
    }
}

/// Whether every segment has a direction.
pub(super) fn check(segments: &[Segment]) -> Result<(), NoDirection> {
    let missing = segments.iter().position(|segment| !segment.is_rigid && segment.line.check().is_err());
    missing.map_or(Ok(()), |k| Err(NoDirection::Segment { segment: k + 1, length: segments[k].line.length }))
}

/// The first segment whose ends met or passed each other.
pub(super) fn met(before: &[Segment], after: &[Segment]) -> Option<NoDirection> {
    let lost = |(before, after): (&Segment, &Segment)| !before.is_rigid && before.line.lost_until(&after.line);
    let k = before.iter().zip(after).position(lost)?;
    let length = before[k].line.length.min(after[k].line.length);
    Some(NoDirection::Segment { segment: k + 1, length })
}

impl From<Cable> for Measure {
    fn from(cable: Cable) -> Self {
        Self::Cable(cable)
    }
}
