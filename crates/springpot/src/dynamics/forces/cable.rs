//! The length of a line through points of any bodies.

use super::coordinate::Coordinate;
use super::line::Line;
use super::pair::{Pair, add_gradient};
use crate::dynamics::kinematics::Kinematics;
use crate::model::{Model, Site};
use crate::spatial::{Scalar, Vec3};

/// y = Σ_s |r_{s+1} − r_s| through the points r_0, r_1, …: its derivatives are the sums of those of the segments. NaN where
/// neighbours of two links coincide.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CableLength<'a>(pub(crate) &'a [Site]);

impl CableLength<'_> {
    /// Hands every segment, and whether it is rigid, to `visit` and adds ∂y/∂q to `gradient` (nv); needs velocities.
    #[inline(always)]
    pub(crate) fn read<T: Scalar>(
        self,
        model: &Model,
        kinematics: &Kinematics<T>,
        gradient: &mut [T],
        mut visit: impl FnMut(Pair<T>, bool),
    ) {
        for two in self.0.windows(2) {
            let pair = add_gradient(model, kinematics, &two[0], &two[1], gradient);
            visit(pair, two[0].link() == two[1].link());
        }
    }
}

impl<T: Scalar> Coordinate<T> for CableLength<'_> {
    #[inline(always)]
    fn slopes(&self, model: &Model, kinematics: &Kinematics<T>, mut visit: impl FnMut(usize, T)) {
        for two in self.0.windows(2) {
            let line = Line::new(model, kinematics, &two[0], &two[1]);
            line.slopes(model, kinematics, &mut visit);
        }
    }

    #[inline(always)]
    fn second_derivatives(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        columns: &mut [Vec3<T>],
        mut visit: impl FnMut(usize, usize, T),
    ) {
        let degrees = model.degrees();
        for two in self.0.windows(2) {
            let line = Line::new(model, kinematics, &two[0], &two[1]);
            line.fill_columns(model, kinematics, columns);
            line.second_derivatives(
                model,
                kinematics,
                columns,
                |_, _| true,
                |a, b, second| {
                    visit(degrees[a].index, degrees[b].index, second);
                },
            );
        }
    }
}
