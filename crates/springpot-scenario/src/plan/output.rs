//! What the results of a plan hold and show.

use crate::figures::{ColumnGlob, FigurePlan};
use std::sync::Arc;

/// What the results hold and show.
#[derive(Debug, Clone, Default)]
pub struct OutputPlan {
    /// The figures; the same in every case.
    pub figures: Arc<[FigurePlan]>,
    /// Globs of the columns to write; `None`: all.
    pub columns: Option<Arc<[ColumnGlob]>>,
    /// Whether a joint has damping or friction, in this case or in another one of its sweep: the results tell what is
    /// lost there.
    pub tells_joint_losses: bool,
    /// Whether they tell the leaves of the elements' laws.
    pub tells_leaves: bool,
}
