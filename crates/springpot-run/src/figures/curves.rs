//! Columns over a column.

use super::source::Source;
use crate::sweep::{FigureData, Wanted};
use springpot_report::Rendered;
use springpot_scenario::{Cases, ColumnGlob, FigurePlan, RefusalKind, Refusals};

/// A curve for each column that `y` matches, over the one that `x` does.
pub(super) fn data(
    cases: &Cases,
    figure: &FigurePlan,
    wanted: &mut Wanted,
    x: &ColumnGlob,
    y: &[ColumnGlob],
) -> Result<FigureData, Refusals> {
    let [x] = wanted.found(x)?[..] else {
        return Err(x.place.refuse(RefusalKind::Rule, "x matches several columns; it takes one").into());
    };
    let mut curves = Vec::new();
    for glob in y {
        for y in wanted.found(glob)? {
            if !curves.contains(&[x, y]) {
                curves.push([x, y]);
            }
        }
    }
    wanted.curves(cases, figure, &curves)
}

pub(super) fn draw(source: &Source<'_>) -> Result<Rendered, String> {
    source.plot()?.render().map_err(|error| error.to_string())
}
