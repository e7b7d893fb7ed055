//! `springpot dynamics`.

use crate::Ending;
use crate::arguments::DynamicsOptions;

pub(crate) fn dynamics(_options: &DynamicsOptions) -> Ending {
    Ending::Done
}
