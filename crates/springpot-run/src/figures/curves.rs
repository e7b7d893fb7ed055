//! Columns over a column.

use super::source::Source;
use springpot_report::Rendered;

pub(super) fn draw(source: &Source<'_>) -> Result<Rendered, String> {
    source.plot()?.render().map_err(|error| error.to_string())
}
