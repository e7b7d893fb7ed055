//! Columns over a column.

use super::source::Source;
use springpot_report::Drawn;

pub(super) fn draw(source: &Source<'_>) -> Result<Drawn, String> {
    source.plot()?.draw().map_err(|error| error.to_string())
}
