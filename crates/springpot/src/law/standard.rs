//! The laws that come with Springpot.

use super::catalog::Catalog;
use super::{damper, filled_rubber, kelvin_voigt, magnetorheological, named, piezo, piezo_stack, thermoviscoelastic};
use std::sync::Arc;

impl Catalog {
    /// The laws that come with Springpot.
    pub fn standard() -> Self {
        let entries = [
            kelvin_voigt::spring(),
            kelvin_voigt::dashpot(),
            kelvin_voigt::springpot(),
            kelvin_voigt::kelvin_voigt(),
            kelvin_voigt::fractional_kelvin_voigt(),
            thermoviscoelastic::thermoviscoelastic(),
            piezo::piezo_kelvin_voigt(),
            magnetorheological::magnetorheological(),
            magnetorheological::magnetorheological_bouc_wen(),
            piezo_stack::piezo_stack(),
            piezo_stack::piezo_stack_bouc_wen(),
            piezo_stack::piezo_stack_prandtl_ishlinskii(),
            piezo_stack::piezo_stack_feed_forward(),
            damper::spencer(),
            damper::bouc_wen_damper(),
            damper::fractional_bouc_wen_damper(),
            damper::bingham(),
            damper::fractional_bingham(),
            filled_rubber::filled_rubber(),
        ];
        Self { entries: entries.into_iter().chain(named::entries()).map(Arc::new).collect() }
    }
}
